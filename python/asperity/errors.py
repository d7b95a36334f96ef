"""What can go wrong. The texts are those of the program."""

from __future__ import annotations

from typing import Any

from ._errors import AsperityError, CaseError, MissingPackage
from .run import Run
from .study import Study

__all__ = ["AsperityError", "CaseError", "Interrupted", "MissingPackage", "NotConverged"]


class NotConverged(AsperityError):
    """A run that did not get to the end of its path. What was computed is in ``run``."""

    def __init__(self, message: str, run: Run) -> None:
        super().__init__(message)
        self.run = run

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (*self.args, self.run)


class Interrupted(KeyboardInterrupt):
    """Ctrl-C, after the step that was under way. What was computed is in ``run`` or ``study``; with ``resume=True`` it goes on."""

    def __init__(self, message: str, run: Run | None = None, study: Study | None = None) -> None:
        super().__init__(message)
        self.run = run
        self.study = study

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (*self.args, self.run, self.study)
