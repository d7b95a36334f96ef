"""What simulates: one case, or a grid of them."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from . import _asperity
from ._arguments import described, items, path, text, truth
from ._asperity import toml_value
from ._kept import Scratch
from ._progress import Bar, Listener, bar_wanted
from .case import Case, as_case
from .errors import AsperityError, CaseError, Interrupted, NotConverged
from .run import Run
from .study import Study

__all__ = ["run", "study"]

# Most bytes of a study file.
_MOST = 16 << 20


def run(
    case: Case | Mapping[str, Any] | str | os.PathLike[str],
    out: str | os.PathLike[str] | None = None,
    device: str = "auto",
    threads: int | None = None,
    progress: Listener | bool | None = None,
    *,
    precision: str = "auto",
    resume: bool = False,
    extend: bool = False,
    force: bool = False,
) -> Run:
    """Simulates a case, with the bits and files of ``asperity run``.

    Other threads of Python go on meanwhile. Ctrl-C ends the run after its present step and keeps what there is.

    :param case: a :class:`Case`, a dictionary, the path of a case file, or its text.
    :param out: directory for the results: a new or an empty one, or one with an earlier result and ``resume``, ``extend`` or ``force``. Without one they are in a
        temporary directory that lives as long as the answer.
    :param device: ``"auto"``, ``"cpu"`` or ``"gpu"``.
    :param threads: threads to use, by default all of the machine's; results do not depend on it.
    :param progress: by default a bar in terminals and notebooks; ``True`` or ``False``, or a function that is called with the share of the path that is
        behind, the number of the step and a text (a note has the share -1). What it raises ends the run like Ctrl-C.
    :param precision: ``"auto"``, ``"f32"``, ``"f64"`` or ``"mixed"`` (see ``asperity run --help``).
    :param resume: go on with an unfinished run of the same case in ``out``.
    :param extend: go on from the end of the finished run in ``out`` along a longer path: its case with segments added after the last one.
    :param force: replace an earlier result in ``out``.
    :raises CaseError: the case or an argument is refused.
    :raises NotConverged: a step failed, or the contact outgrew its mesh; the results up to there are in ``run`` of the exception.
    :raises Interrupted: a :class:`KeyboardInterrupt` with the results up to there in ``run``.
    :raises AsperityError: anything else.
    """
    case = as_case(case)
    if not (progress is None or callable(progress) or isinstance(progress, bool)):
        raise CaseError(f"progress: is {described(progress)}. Allowed: True, False, or a function of a share, a step and a text")
    words = text("device", device), text("precision", precision)
    resume, extend, force = truth("resume", resume), truth("extend", extend), truth("force", force)
    # One that is made here goes with the answer.
    kept = Scratch() if out is None else None
    directory = Path(kept.name) if kept is not None else path("out", out)
    bar = Bar() if progress is True or (progress is None and bar_wanted()) else None
    listener: Listener | None = bar if bar is not None else (progress if callable(progress) else None)
    try:
        status, message, raised = _asperity.run(case._native, directory, *words, threads, resume, extend, force, listener)
    finally:
        if bar is not None:
            bar.close()
    if status == "interrupted" and not (directory / "summary.json").exists():
        raise raised or Interrupted(message or "interrupted")
    result = Run(directory)
    result._kept = kept
    if raised is not None:
        if isinstance(raised, KeyboardInterrupt):
            raise Interrupted(message or "interrupted after the last step", run=result) from raised
        raise raised
    if status != "done":
        raise NotConverged(message or status, result)
    return result


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
