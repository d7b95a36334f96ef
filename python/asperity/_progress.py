"""How far a run is: a bar in terminals and notebooks."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import TypeAlias

Listener: TypeAlias = Callable[[float, int, str], object]

_WIDTH = 30


class Bar:
    """A line that is written over itself."""

    def __init__(self) -> None:
        self._length = 0

    def __call__(self, share: float, step: int, text: str) -> None:
        if share < 0.0:
            self._write(text)
            sys.stderr.write("\n")
            self._length = 0
            return
        full = round(_WIDTH * min(share, 1.0))
        self._write(f"[{'#' * full}{' ' * (_WIDTH - full)}] {100 * share:3.0f} %  step {step}  {text}")

    def _write(self, line: str) -> None:
        sys.stderr.write("\r" + line.ljust(self._length))
        sys.stderr.flush()
        self._length = len(line)

    def close(self) -> None:
        """Ends the line."""
        if self._length:
            sys.stderr.write("\n")
            self._length = 0


def bar_wanted() -> bool:
    """Whether somebody looks: a terminal, or a notebook."""
    try:
        return sys.stderr.isatty() or "ipykernel" in sys.modules
    except (AttributeError, ValueError):
        return False
