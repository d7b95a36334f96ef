"""Contact laws: from studies to forces in other programs."""

from __future__ import annotations

import json
import os
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ._arguments import described, numbers, path, text, truth
from ._asperity import NativeContacts, NativeLaw, fit_law, interpolate_law, table_law, table_study
from ._compute import study as run_study
from ._html import table
from ._kept import Scratch
from ._law import AnyLaw
from ._table import Table
from .case import Case, as_case
from .errors import CaseError, Interrupted
from .picture import Picture, asked
from .study import Study

__all__ = ["Check", "Contacts", "Law"]


class Check:
    """A law beside simulations of a set of paths; made by :meth:`Law.check`.

    ``table`` has a row a path: ``path``, its name; ``F_T_rms``, ``F_T_worst``, ``F_N_rms``, ``F_N_worst``, errors over the greatest size of the force on the path;
    ``dissipated`` by the simulation and ``law_dissipated``, energies; ``within``, whether the errors are at most 5 % (rms) and 12 %; ``counts``, whether
    the simulation is good enough to judge by, its mesh's own error being at most 2.5 %; ``failure``, why it did not come to the end of its path, or nothing. ``paths`` has the columns ``segment``, ``h``, ``delta_T``, ``F_N``, ``F_T``, ``law_F_N``, ``law_F_T`` of each path by its name,
    in the units of the case.
    """

    def __init__(self, paths: list[dict[str, Any]]) -> None:
        self.paths: dict[str, Table] = {path["path"]: Table(path["columns"]) for path in paths}
        names = [name for name in paths[0] if name != "columns"] if paths else []
        self.table = Table({name: np.array([path[name] for path in paths]) for name in names})

    def __repr__(self) -> str:
        counts = self.table["counts"]
        left_out = f"; {len(counts) - counts.sum()} not counted" if not counts.all() else ""
        return f"<Check: {(self.table['within'] & counts).sum()} of {counts.sum()} paths within 5 % rms and 12 %{left_out}>"


class Contacts:
    """The memory of many contacts of one pair of materials, for :meth:`Law.update`; made by :meth:`Law.contacts`.

    Copied and pickled they are independent of each other, and go on bit by bit alike. One thread at a time moves them.
    """

    __slots__ = ("_native",)

    def __init__(self, native: NativeContacts) -> None:
        if not isinstance(native, NativeContacts):
            raise CaseError(f"contacts: are made of {described(native)}. Allowed: those of Law.contacts()")
        self._native = native

    def __len__(self) -> int:
        return len(self._native)

    def copy(self) -> Contacts:
        """A copy, to try a step on."""
        return type(self)(self._native.copy())

    __copy__ = copy

    def __deepcopy__(self, memo: dict[int, Any]) -> Contacts:
        return self.copy()

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (type(self), self._native.parameters(), self.array)

    @property
    def array(self) -> np.ndarray:
        """A copy of the memory, a row a contact: h, the greatest h, the elastic approach, the hardening and the approach at which the sliders are whole,
        lengths; the share of the yield force that releases took, the share of F_N released last, how far it was sheared (to 1) and its slip reversed (to 2),
        by what share it is wider than its F_N; the vertex (2); the forces of the sliders along x, along y and radial; how the
        last plastic step went (3), which only tells where the next solution begins. What is assigned here is put back; all
        of it must be finite."""
        return self._native.to_array()

    @array.setter
    def array(self, memory: ArrayLike) -> None:
        self._native.set_array(numbers("state", memory, (len(self), NativeContacts.width()), finite=True))

    def rotate(self, angle: ArrayLike) -> None:
        """Turns the tangential memory into axes that are turned by ``angle`` (radians; one number, or one a contact), where the frame follows the contact's
        normal. An angle that is not finite is refused, and nothing is turned."""
        angles = numbers("angle", angle, (len(self),), one="a number", finite=True)
        self._native.rotate(np.cos(angles), np.sin(angles))


def _restored(kind: type[Contacts], parameters: np.ndarray, memory: np.ndarray) -> Contacts:
    """Contacts of a pickle."""
    return kind(NativeContacts.restore(parameters, memory))


class Law(AnyLaw):
    """A contact law: F_N and F_T of an elastic-plastic sphere that is pressed and sheared."""

    __slots__ = ()

    def __copy__(self) -> Law:
        # It never changes.
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> Law:
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        return _of_json, (type(self), *self._native.to_json())

    @classmethod
    def fit(cls, study: Study | str | os.PathLike[str], prior: str = "wear-2014", *, interpolate: bool = False, reversal: Law | None = None) -> Law:
        """Fits a law to a study and writes ``law.json`` into its directory.

        :param prior: constants to start from: ``"wear-2014"``, ``"none"``, or the path of another ``law.json``.
        :param interpolate: an interpolated law between the contacts of the study, of many materials, instead of formulas.
        :param reversal: with ``interpolate``, where cases were not sheared back or released: the interpolated law that knows the stiffness of a reversal and
            of an unloading, as :meth:`built_in` does.
        """
        interpolate = truth("interpolate", interpolate)
        if reversal is not None and not isinstance(reversal, Law):
            raise CaseError(f"reversal: is {described(reversal)}. Allowed: a Law, None")
        if reversal is not None and not interpolate:
            raise CaseError("reversal: is given, and interpolate is False. Allowed: None")
        directory = path("study", study.directory if isinstance(study, Study) else study)
        if interpolate:
            return cls(interpolate_law(directory, None if reversal is None else reversal._native))
        return cls(fit_law(directory, text("prior", prior)))

    @classmethod
    def tabulate(
        cls,
        case: Case | Mapping[str, Any] | str | os.PathLike[str],
        out: str | os.PathLike[str] | None = None,
        elements: int = 5,
        device: str = "auto",
        threads: int | None = None,
        progress: bool | None = None,
        *,
        precision: str = "auto",
        resume: bool = False,
        force: bool = False,
    ) -> Law:
        """The law of one material, one friction coefficient and one opponent as curves over h. The opponent may be a plane, an equal or rigid sphere, or another body
        that deforms. Simulates 13 to 23 depths up to the greatest indentation of the case, at the limit of fine meshes; half a minute of processor time on a plane.

        :param out: directory for the simulations and ``law.json``; without one nothing is kept but the law.
        :param elements: elements along the contact radius, at every depth, 4 to 16; twice as many at the surface.
        :param device: as of :func:`asperity.study`, like ``threads``, ``progress``, ``precision``, ``resume`` and ``force``.
        :raises CaseError: the case has no law (``friction = "stick"``), or an argument is refused.
        :raises Interrupted: as :func:`asperity.study`; with ``resume`` it goes on.
        """
        native = as_case(case)._native
        written = table_study(native, elements)
        with Scratch() as scratch:
            directory = Path(scratch) / "table" if out is None else path("out", out)
            run_study(written, None, directory, device, threads, progress, precision=precision, resume=resume, force=force)
            law, missing = table_law(directory, native, elements)
        if missing:
            warnings.warn(f"the table does without depths that were not reached: {'; '.join(missing)}", stacklevel=2)
        return cls(law)

    @classmethod
    def load(cls, file: str | os.PathLike[str]) -> Law:
        """Reads a ``law.json``, of ``asperity law fit`` or ``law tabulate``."""
        return cls(NativeLaw.load(path("law", file)))

    @classmethod
    def built_in(cls) -> Law:
        """The law that comes with the program, for any material: it interpolates between simulated contacts, of a sphere with a plane and of two equal spheres."""
        return cls(NativeLaw.built_in())

    @classmethod
    def wear_2014(cls) -> Law:
        """The formulas that a small study starts from, fitted to 240 cases of 15 materials on a plane, Poisson's ratio 0.3: :meth:`built_in` covers more and is more accurate."""
        return cls(NativeLaw.wear_2014())

    def save(self, file: str | os.PathLike[str]) -> None:
        """Writes a ``law.json``."""
        self._native.save(path("file", file))

    def to_dict(self) -> dict[str, Any]:
        """The content of ``law.json``: forms, constants, where they come from, where they hold and how well."""
        law: dict[str, Any] = json.loads(self._native.to_json()[0])
        return law

    def table(self, case: Case | Mapping[str, Any] | str | os.PathLike[str]) -> Law:
        """The table of a case's contact, a plane's or a pair's, as an interpolated law makes it; another law as it is."""
        return Law(self._native.table(as_case(case)._native))

    def formulas(self) -> str:
        """The formulas with their constants; a table and an interpolated law have none."""
        return self._native.formulas()

    def predict(self, case: Case | Mapping[str, Any] | str | os.PathLike[str], press: bool = False) -> Table:
        """``segment``, ``h``, ``delta_T``, ``F_N``, ``F_T`` along the whole path of a case, in its units, without simulating any of it: what ``asperity law predict`` prints. Where the path leaves the x axis,
        ``delta_T_y`` and ``F_T_y`` too; where it twists or rolls, ``twist``, ``roll_x``, ``roll_y`` and ``M_twist``, ``M_roll_x``, ``M_roll_y``.

        Warns where the case lies outside of what the law was fitted to.

        :param press: take F_N0 and a0 from a simulation of the press, not from the law's formulas, and give the shear alone; for a case that is pressed once and
            sheared once at constant indentation.
        """
        columns, outside = self._native.predict(as_case(case)._native, truth("press", press))
        _warn_outside(outside)
        return Table(columns)

    def plot(
        self,
        case: Case | Mapping[str, Any] | str | os.PathLike[str],
        name: str | None = None,
        *,
        width: str | None = None,
        title: bool = True,
    ) -> Picture:
        """A picture, as ``asperity plot`` draws it, of what :meth:`predict` gives for a case.

        :param name: ``"forces"`` of the shear, ``"ratio"`` F_T/F_N, or ``"indentation"``, F_N over h; by default the forces, without a shear F_N over h.
        :param width: as ``"85mm"``, ``"3.3in"`` or ``"640px"``; the picture is laid out for it.
        :param title: whether it has a title.
        """
        picture, outside = self._native.plot(as_case(case)._native, *asked(name, width, title))
        _warn_outside(outside)
        return Picture(picture)

    def export(
        self,
        format: str,
        out: str | os.PathLike[str] | None = None,
        case: Case | Mapping[str, Any] | str | os.PathLike[str] | None = None,
    ) -> str | list[Path]:
        """The law of the material and the friction of ``case`` for other programs, ``"c"`` or ``"python"``: its source, or with ``out`` the files that were written
        there, with test vectors. A table needs no case."""
        native = None if case is None else as_case(case)._native
        if out is None:
            return self._native.source(text("format", format), native)
        return [Path(file) for file in self._native.export(text("format", format), path("out", out), native)]

    def check(self, case: Case | Mapping[str, Any] | str | os.PathLike[str] | None = None, elements: int = 5) -> Check:
        """Simulates eleven paths (presses, shears, reversals, unloadings, oblique ones) with the material, the friction and the greatest indentation of a case, and
        follows them with :meth:`update`. Half a minute of processor time at 5 elements.

        :param case: for a table by default its own material, friction and greatest indentation.
        :param elements: elements along the contact radius of the simulations, 4 to 16; twice as many at the surface.
        :raises Interrupted: a :class:`KeyboardInterrupt`; of the paths nothing is kept.
        """
        paths, raised = self._native.check(None if case is None else as_case(case)._native, elements)
        if raised is not None:
            raise Interrupted("interrupted; a check cannot go on") if isinstance(raised, KeyboardInterrupt) else raised
        return Check(paths)

    def contacts(self, case: Case | Mapping[str, Any] | str | os.PathLike[str], number: int = 1) -> Contacts:
        """``number`` contacts of a case's sphere, material and friction, before first touch; a ``MemoryError`` if they do not fit."""
        return Contacts(self._native.contacts(as_case(case)._native, number))

    def update(self, state: Contacts, h: ArrayLike, delta: ArrayLike) -> Table:
        """Moves every contact to the indentation ``h`` and along the plane by the increment ``delta``, lengths, and keeps that in ``state``.

        Contacts are independent of each other and computed side by side, with the material, the friction and the law that ``state`` was made for.

        :param h: one number for all contacts, or one a contact, (n,).
        :param delta: the two components (x, y) for all contacts, or those of each, (n, 2). A single number is refused: an increment along x alone is (x, 0).
        :returns: ``F_N`` (n,), compression positive; ``F_T`` (n, 2), along the displacement; the contact radius ``a`` (n,); and the tangents ``dF_N_dh`` (n,),
            ``dF_T_dh`` (n, 2), ``dF_N_ddelta`` (n, 2), ``dF_T_ddelta`` (n, 2, 2). Where ``h`` or ``delta`` is infinite or NaN, or so large that the forces
            overflow, the whole answer of that contact is NaN, and it stays as it was.
        :raises CaseError: another shape, or what is not a number (masked, ``None``, text, complex, a boolean), with the argument and the first index; nothing has
            moved. So it is with the ``MemoryError`` of an answer that does not fit, and where another thread moves these contacts.
        """
        if not isinstance(state, Contacts):
            raise CaseError(f"state: is {described(state)}. Allowed: Contacts, as Law.contacts() makes them")
        number = len(state)
        depth = numbers("h", h, (number,), one="a number")
        increment = numbers("delta", delta, (number, 2), one="the two components (x, y)")
        return Table(state._native.update(depth, increment))

    def _repr_html_(self) -> str:
        law = self.to_dict()
        rows = [("law", repr(self).removeprefix("<Law: ").removesuffix(">"))]
        if "levels" in law:
            rows += [("h", f"{law['range']['from']:.3g} to {law['range']['to']:.3g} R")]
        return table(rows)

    def __repr__(self) -> str:
        law = self.to_dict()
        if "levels" in law:
            return f"<Law: a table of {len(law['levels'])} depths>"
        if "source" in law:
            return f"<Law: by interpolation between {law['source']['cases']} contacts of {law['source']['materials']} materials>"
        provenance = law["provenance"]
        return f"<Law: fitted to {provenance['cases']} cases of {provenance['materials']} materials>"


def _warn_outside(outside: list[str]) -> None:
    if outside:
        warnings.warn(f"the case lies outside of what the law was fitted to: {', '.join(outside)}. compare with a run", stacklevel=3)


def _of_json(kind: type[Law], law: str, pair: str | None = None) -> Law:
    """The law of a pickle, with that of equal spheres that the built-in one has beside it."""
    return kind(NativeLaw.from_json(law, pair))
