"""The results of one run."""

from __future__ import annotations

import contextlib
import json
import operator
import os
from functools import cached_property
from typing import Any

import numpy as np

from . import _asperity, _table
from ._arguments import described, path
from ._errors import AsperityError, CaseError
from ._html import summary_table
from ._kept import Directory, Scratch
from ._law import AnyLaw
from ._optional import need
from ._table import Table
from .case import Case
from .fields import Fields, Mesh, read_vtu
from .picture import Picture, asked

__all__ = ["Run"]

# Of the program's pictures, with their names of forces and lengths.
_BLUE, _VERMILION = "#0072b2", "#d55e00"
_F_N, _F_T, _DELTA_T, _H = "$F_\\mathrm{N}$", "$F_\\mathrm{T}$", "$\\delta_\\mathrm{T}$", "$h$"


class Run(Directory):
    """The results of a run: a view of its directory.

    Forces are of the whole sphere, normal ones positive in compression. Everything is in the units of the case. A pickle has ``case``, ``summary`` and ``history``;
    contact tables and fields stay in the directory, and so are gone where that was a temporary one of another process.
    """

    _carried = ("summary", "history")

    def __init__(self, directory: str | os.PathLike[str]) -> None:
        self.directory = path("directory", directory)
        case = _asperity.resolved_case(self.directory)
        if case is None:
            raise AsperityError(f"{self.directory}: is not a result of an Asperity run. Give the directory of `asperity run --out`")
        # A name of any bytes is shown as well as can be.
        self.case = Case.parse(case, name=os.fsencode(self.directory / "case.toml").decode(errors="replace"))
        self._kept: Scratch | None = None

    @classmethod
    def load(cls, directory: str | os.PathLike[str]) -> Run:
        """The results in a directory, of this package or of ``asperity run``."""
        return cls(directory)

    def __repr__(self) -> str:
        return f"<Run: {self.history.rows} steps, {self.summary['status']}, in {self.directory}>"

    @cached_property
    def history(self) -> Table:
        """A row a step: ``h``, ``delta_T``, ``a``, lengths; ``F_N``, ``F_T``, forces; ``segment``, iterations, energies, ..."""
        self._file("history.csv")
        return Table(dict(_asperity.history(self.directory)))

    @cached_property
    def summary(self) -> dict[str, Any]:
        """The run in some numbers: ``F_N0``, ``a0``, ``F_N_slip``, ``F_T_max``, ``delta_T_slip``, ``k_T0``, their estimated errors, ``status``, ..."""
        file = self._file("summary.json")
        try:
            summary = json.loads(file.read_text(encoding="utf-8"))
        except (ValueError, RecursionError) as error:
            raise AsperityError(f"{file}: is not the summary of a run ({error}). Run the case again") from None
        if not isinstance(summary, dict):
            raise AsperityError(f"{file}: is not the summary of a run. Run the case again")
        return summary

    def _steps(self, folder: str, suffix: str) -> list[int]:
        names = [name.stem.removeprefix("step_") for name in (self.directory / folder).glob(f"step_*{suffix}")]
        return sorted(int(name) for name in names if name.isascii() and name.isdecimal())

    @property
    def contact_steps(self) -> list[int]:
        """Steps of which there is a contact table."""
        return self._steps("contact", ".csv")

    @property
    def field_steps(self) -> list[int]:
        """Steps of which there are fields: the ends of segments, or all with ``output={"fields": "all"}``."""
        return self._steps("fields", ".vtu")

    def _choose(self, step: int | None, steps: list[int], what: str) -> int:
        if not self.directory.is_dir():
            raise self._gone()
        if not steps:
            raise AsperityError(f'{self.directory}: has no {what}. run the case with output.fields = "segments" or "all"')
        if step is not None and (isinstance(step, (bool, np.bool_)) or not hasattr(step, "__index__")):
            raise CaseError(f"step: is {described(step)}. Allowed: the number of a step, None")
        chosen = steps[-1] if step is None else operator.index(step)
        if chosen not in steps:
            raise AsperityError(f"{self.directory}: has no {what} of step {chosen}. there are those of {', '.join(map(str, steps))}")
        return chosen

    def contact(self, step: int | None = None) -> Table:
        """Every contact point, both halves, after a step (by default the last that was saved).

        ``X``, ``Y`` before and ``x``, ``y`` after deformation and ``gap``, lengths; ``pressure``, ``traction_x``, ``traction_y``, stresses, forces over the area
        before deformation; ``area``; ``status`` (``open``, ``stick``, ``slip``) and ``half``. Pressure times area adds up to F_N.
        """
        step = self._choose(step, self.contact_steps, "contact table")
        return _table.read(self.directory / f"contact/step_{step:04}.csv", whole=["point"], words=["status", "half"])

    def fields(self, step: int | None = None) -> Fields:
        """Displacement, stress, plastic strain and contact on the meshed half after a step (by default the last that was saved)."""
        step = self._choose(step, self.field_steps, "fields")
        return read_vtu(self.directory / f"fields/step_{step:04}.vtu")

    @cached_property
    def mesh(self) -> Mesh:
        """The meshed half before deformation."""
        fields = self.fields()
        return Mesh(fields.points, fields.cells)

    def plot(self, name: str | None = None, *, law: AnyLaw | None = None, width: str | None = None, title: bool = True) -> Picture:
        """A picture as ``asperity plot`` draws it, which a notebook shows and ``save`` writes.

        :param name: ``"forces"``, ``"ratio"``, ``"stick"``, ``"slip"``, ``"indentation"``, ``"pressure"``, ``"contact"``, ``"plane"``, ``"moments"`` or, with
            ``law``, ``"law"``; by default the last of these with a law, else the forces of the shear or, without one, of the press.
        :param law: a :class:`Law` to draw beside the run.
        :param width: as ``"85mm"``, ``"3.3in"`` or ``"640px"``; the picture is laid out for it.
        :param title: whether diagrams have titles.
        """
        if law is not None and not isinstance(law, AnyLaw):
            raise CaseError(f"law: is {described(law)}. Allowed: a Law, None")
        chosen = asked(name, width, title)
        self._file("history.csv")
        return Picture(_asperity.run_picture(self.directory, chosen[0], None if law is None else law._native, chosen[1], chosen[2]))

    def _repr_html_(self) -> str:
        picture = ""
        with contextlib.suppress(AsperityError, OSError):
            picture = self.plot(width="640px").svg
        return summary_table(self.summary) + picture

    def plot_forces(self, ax: Any = None) -> Any:
        """F_N and F_T over delta_T in shear, or F_N over h where there is none; gives the axes of matplotlib."""
        ax = _axes(ax)
        history = self.history
        sheared = np.flatnonzero(history["delta_T"] != 0.0)
        if len(sheared):
            # From the last step before it moves along the plane.
            rows = slice(max(sheared[0] - 1, 0), None)
            x, label = history["delta_T"][rows], _DELTA_T
            ax.plot(x, history["F_T"][rows], color=_VERMILION, linestyle="--", marker="o", markerfacecolor="none", label=f"{_F_T}, tangential")
        else:
            rows = slice(None)
            x, label = history["h"], _H
        ax.plot(x, history["F_N"][rows], color=_BLUE, marker=".", label=f"{_F_N}, normal")
        ax.set_xlabel(self._labelled(label, "length"))
        ax.set_ylabel(self._labelled("force", "force"))
        ax.legend()
        return ax

    def _labelled(self, what: str, dimension: str) -> str:
        """With the unit that the case names."""
        unit = self.case.to_dict().get("units", {}).get(dimension)
        return what if unit is None else f"{what} ({unit})"

    def plot_press(self, ax: Any = None) -> Any:
        """F_N over h, as far as the sphere is not sheared; gives the axes of matplotlib."""
        ax = _axes(ax)
        history = self.history
        pressed = history["delta_T"] == 0.0
        ax.plot(history["h"][pressed], history["F_N"][pressed], color=_BLUE, marker=".")
        ax.set_xlabel(self._labelled(_H, "length"))
        ax.set_ylabel(self._labelled(_F_N, "force"))
        return ax

    def plot_pressure(self, step: int | None = None, ax: Any = None) -> Any:
        """The contact pressure as a map of the contact surface; gives the axes of matplotlib."""
        ax = _axes(ax)
        contact = self.contact(step)
        closed = contact["status"] != "open"
        shown = ax.scatter(contact["x"][closed], contact["y"][closed], c=contact["pressure"][closed], s=12)
        ax.figure.colorbar(shown, ax=ax, label=self._labelled("pressure", "stress"))
        ax.set_aspect("equal")
        ax.set_xlabel(self._labelled("$x$", "length"))
        ax.set_ylabel(self._labelled("$y$", "length"))
        return ax


def _axes(ax: Any) -> Any:
    if ax is not None:
        return ax
    return need("matplotlib.pyplot", "matplotlib", "a plot").subplots()[1]
