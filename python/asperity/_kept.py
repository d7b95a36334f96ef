"""Results that are a directory: what of them is kept, copied and pickled."""

from __future__ import annotations

import contextlib
import copy
import os
import shutil
import tempfile
import weakref
from pathlib import Path
from typing import Any, ClassVar, TypeVar

from ._errors import AsperityError

__all__ = ["Directory", "Scratch"]

_Self = TypeVar("_Self", bound="Directory")


def _remove(name: str, process: int) -> None:
    # A child of `fork` has a copy of every object, and must not take the directory from its parent.
    if os.getpid() == process:
        shutil.rmtree(name, ignore_errors=True)


class Scratch:
    """A temporary directory that goes with this object."""

    def __init__(self) -> None:
        self.name = tempfile.mkdtemp(prefix="asperity-")
        self._finalizer = weakref.finalize(self, _remove, self.name, os.getpid())

    def __enter__(self) -> str:
        return self.name

    def __exit__(self, *_: object) -> None:
        self._finalizer()


class Directory:
    """A view of a directory of results.

    A pickle has what is small (``_carried``) and the place of the directory, which it does not keep: a temporary one goes with the answer that it was made for.
    """

    _carried: ClassVar[tuple[str, ...]] = ()
    directory: Path
    _kept: Scratch | None

    def __getstate__(self) -> dict[str, Any]:
        for name in self._carried:
            # What is not there, as of an unfinished run, is missed when it is asked for.
            with contextlib.suppress(AsperityError, OSError):
                getattr(self, name)
        return self.__dict__ | {"directory": Path(os.path.abspath(self.directory)), "_kept": None}

    def __copy__(self: _Self) -> _Self:
        return self._with(dict(self.__dict__))

    def __deepcopy__(self: _Self, memo: dict[int, Any]) -> _Self:
        return self._with({name: value if name == "_kept" else copy.deepcopy(value, memo) for name, value in self.__dict__.items()})

    def _with(self: _Self, state: dict[str, Any]) -> _Self:
        # The copy keeps a temporary directory as well.
        copied = type(self).__new__(type(self))
        copied.__dict__.update(state)
        return copied

    def _file(self, name: str) -> Path:
        """A file of the directory, which is there."""
        file = self.directory / name
        if file.is_file():
            return file
        if not self.directory.is_dir():
            raise self._gone()
        raise AsperityError(f"{file}: is not there. Let the computation go on with resume=True, or do it again")

    def _gone(self) -> AsperityError:
        return AsperityError(f"{self.directory}: is gone, with what is not in memory. Compute into a directory that stays, with out=...")
