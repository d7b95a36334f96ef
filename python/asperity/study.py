"""The results of a study, a grid of cases."""

from __future__ import annotations

import operator
import os
from collections.abc import Iterator
from functools import cached_property

from . import _table
from ._arguments import path
from ._errors import AsperityError
from ._kept import Directory, Scratch
from ._table import Table
from .run import Run

__all__ = ["Study"]


class Study(Directory):
    """The results of a study: a view of its directory. A pickle has ``table``; the runs stay in the directory."""

    _carried = ("table",)

    def __init__(self, directory: str | os.PathLike[str]) -> None:
        self.directory = path("directory", directory)
        if not (self.directory / "study.csv").is_file():
            raise AsperityError(f"{self.directory}: is not a study. Give the directory of `asperity study --out`, with its study.csv")
        self._kept: Scratch | None = None

    @classmethod
    def load(cls, directory: str | os.PathLike[str]) -> Study:
        """The results in a directory, of this package or of ``asperity study``."""
        return cls(directory)

    @cached_property
    def table(self) -> Table:
        """``study.csv``, a row a case: ``case``, ``directory``, ``status``, ``reason``, the grid's keys, and the numbers of the run in the units of the case.
        What does not exist is NaN."""
        return _table.read(self._file("study.csv"), words=["case", "directory", "status", "reason"])

    def __len__(self) -> int:
        return self.table.rows

    def __getitem__(self, row: int) -> Run:
        """The run of a row of the table."""
        where = str(self.table["directory"][range(len(self))[operator.index(row)]])
        if not self.directory.is_dir():
            raise self._gone()
        return Run(self.directory / where)

    def __iter__(self) -> Iterator[Run]:
        """The runs that are done."""
        return (self[row] for row, status in enumerate(self.table["status"]) if status == "done")

    def __repr__(self) -> str:
        done = int((self.table["status"] == "done").sum())
        return f"<Study: {done} of {len(self)} cases done, in {self.directory}>"
