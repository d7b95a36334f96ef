"""Studies: grids of cases."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any

from . import _asperity, _table
from ._progress import bar_wanted
from ._table import Table
from .case import Case, as_case
from .errors import AsperityError, Interrupted
from .run import Run

__all__ = ["Study", "study"]


class Study:
    """The results of a study: a view of its directory."""

    def __init__(self, directory: str | os.PathLike[str]) -> None:
        self.directory = Path(directory)
        if not (self.directory / "study.csv").is_file():
            raise AsperityError(f"{self.directory}: is not a study. give the directory of `asperity study --out`, with its study.csv")
        self._kept: tempfile.TemporaryDirectory[str] | None = None

    @classmethod
    def load(cls, directory: str | os.PathLike[str]) -> Study:
        """The results in a directory, of this package or of ``asperity study``."""
        return cls(directory)

    @cached_property
    def table(self) -> Table:
        """``study.csv``, a row a case: ``case``, ``directory``, ``status``, ``reason``, the grid's keys, and the numbers of the run in the units of the case.
        What does not exist is NaN."""
        return _table.read(self.directory / "study.csv", words=["case", "directory", "status", "reason"])

    def __len__(self) -> int:
        return self.table.rows

    def __getitem__(self, row: int) -> Run:
        """The run of a row of the table."""
        return Run(self.directory / str(self.table["directory"][row]))

    def __iter__(self) -> Iterator[Run]:
        """The runs that are done."""
        return (self[row] for row, status in enumerate(self.table["status"]) if status == "done")

    def __repr__(self) -> str:
        done = int((self.table["status"] == "done").sum())
        return f"<Study: {done} of {len(self)} cases done, in {self.directory}>"


def _toml(value: Any) -> str:
    """A value of the grid as inline TOML."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{_toml(str(key))} = {_toml(item)}" for key, item in value.items()) + " }"
    if isinstance(value, Sequence):
        return "[" + ", ".join(_toml(item) for item in value) + "]"
    if hasattr(value, "tolist"):
        return _toml(value.tolist())
    return repr(value)


def _text(base: Case | Mapping[str, Any] | str | os.PathLike[str], grid: Mapping[str, Sequence[Any]]) -> str:
    case = base if isinstance(base, Mapping) else as_case(base).to_dict()
    tables = "\n".join(f"{_toml(str(key))} = {_toml(value)}" for key, value in case.items())
    keys = "\n".join(f"{_toml(key)} = {_toml(values)}" for key, values in grid.items())
    return f"[base]\n{tables}\n\n[grid]\n{keys}\n"


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
        text = _text(base, grid)
    elif isinstance(base, str) and "\n" in base:
        text = base
    elif isinstance(base, (str, os.PathLike)):
        name = os.fspath(base)
        text = Path(base).read_text(encoding="utf-8")
    else:
        raise AsperityError("study: has no grid. give a grid beside the case, or the path or the text of a study file")
    kept = None
    if out is None:
        kept = tempfile.TemporaryDirectory(prefix="asperity-")
        out = kept.name
    quiet = not (bar_wanted() if progress is None else progress)
    _, _, raised = _asperity.study(text, name, os.fspath(out), device, precision, threads, shard, resume, retry, force, quiet)
    result = Study(out)
    result._kept = kept
    if raised is not None:
        if isinstance(raised, KeyboardInterrupt):
            raise Interrupted("interrupted; to go on, run the same study with resume", study=result) from raised
        raise raised
    return result
