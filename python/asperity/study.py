"""Studies: grids of cases."""

from __future__ import annotations

import json
import operator
import os
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any

from . import _asperity, _table
from ._arguments import items, path, text, truth
from ._asperity import toml_value
from ._kept import Directory, Scratch
from ._progress import bar_wanted
from ._table import Table
from .case import Case, as_case
from .errors import AsperityError, CaseError, Interrupted
from .run import Run

__all__ = ["Study", "study"]

# Most bytes of a study file.
_MOST = 16 << 20


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


def _lines(name: str, table: Mapping[str, Any], allowed: str) -> str:
    """A table as lines of a TOML file, in its order."""
    values = [(text(name, key), value) for key, value in items(name, table, allowed)]
    return "\n".join(f"{json.dumps(key, ensure_ascii=False)} = {toml_value(value, key)}" for key, value in values if value is not None)


def _text(base: Case | Mapping[str, Any] | str | os.PathLike[str], grid: Mapping[str, Sequence[Any]]) -> str:
    values = _lines("grid", grid, "a dictionary of lists of values by their dotted keys")
    case = base if isinstance(base, Mapping) else as_case(base).to_dict()
    return f"[base]\n{_lines('base', case, 'a dictionary of tables')}\n\n[grid]\n{values}\n"


def _read(file: Path) -> str:
    """A study file; a longer one than that would be refused is not read whole."""
    with file.open("rb") as opened:
        read = opened.read(_MOST + 1)
    try:
        return read.decode()
    except UnicodeError:
        raise CaseError(f"{file}: is not text in UTF-8. Give a study file") from None


def study(
    base: Case | Mapping[str, Any] | str | os.PathLike[str],
    grid: Mapping[str, Sequence[Any]] | None = None,
    out: str | os.PathLike[str] | None = None,
    device: str = "auto",
    threads: int | None = None,
    progress: bool | None = None,
    *,
    precision: str = "auto",
    shard: str | None = None,
    resume: bool = False,
    retry: bool = False,
    force: bool = False,
) -> Study:
    """Simulates every combination of a grid of cases, with the files of ``asperity study``.

    A case that fails stops no other: its row says why.

    :param base: with a ``grid`` a case in any of the ways of :func:`asperity.run`; without one the path or the text of a study file.
    :param grid: lists of values by dotted keys of the case, as in ``{"contact.friction": [0.1, 0.3]}``; the last key runs fastest.
    :param out: directory for the results; without one they are in a temporary directory that lives as long as the answer.
    :param device: ``"auto"``, ``"cpu"`` or ``"gpu"``.
    :param threads: cases at a time, by default as many as the machine has threads.
    :param progress: by default a bar in terminals.
    :param shard: only this share of the cases, as in ``"2/4"``.
    :param resume: go on in a directory with results of this study.
    :param retry: with ``resume``, compute also those cases again that did not converge.
    :param force: replace an earlier study in ``out``.
    :raises CaseError: the study or an argument is refused; nothing was computed.
    :raises Interrupted: a :class:`KeyboardInterrupt` with the results up to there in ``study``.
    """
    name = "study"
    if grid is not None:
        written = _text(base, grid)
    elif isinstance(base, str) and "\n" in base:
        written = text("study", base)
    elif isinstance(base, (str, bytes, os.PathLike)):
        file = path("study", base)
        name, written = os.fsencode(file).decode(errors="replace"), _read(file)
    else:
        raise AsperityError("study: has no grid. Give a grid beside the case, or the path or the text of a study file")
    words = text("device", device), text("precision", precision)
    shard = None if shard is None else text("shard", shard)
    again = truth("resume", resume), truth("retry", retry), truth("force", force)
    quiet = not (bar_wanted() if progress is None else truth("progress", progress))
    # One that is made here goes with the answer.
    kept = Scratch() if out is None else None
    directory = Path(kept.name) if kept is not None else path("out", out)
    _, _, raised = _asperity.study(written, name, directory, *words, threads, shard, *again, quiet)
    result = Study(directory)
    result._kept = kept
    if raised is not None:
        if isinstance(raised, KeyboardInterrupt):
            raise Interrupted("interrupted; to go on, run the same study with resume", study=result) from raised
        raise raised
    return result
