"""Contact laws: from studies to forces in other programs."""

from __future__ import annotations

import json
import os
import tempfile
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ._asperity import NativeContacts, NativeLaw, fit_law, interpolate_law, table_law, table_study
from ._table import Table
from .case import Case, as_case
from .errors import Interrupted
from .study import Study
from .study import study as run_study

__all__ = ["Check", "Contacts", "Law"]


class Check:
    """A law beside simulations of a set of paths; made by :meth:`Law.check`.

    ``table`` has a row a path: ``path``, its name; ``F_T_rms``, ``F_T_worst``, ``F_N_rms``, ``F_N_worst``, errors over the greatest size of the force on the path;
    ``dissipated`` by the simulation and ``law_dissipated``, energies; ``within``, whether the errors are at most 5 % (rms) and 12 %; ``failure``, why a simulation did
    not come to the end of its path, or nothing. ``paths`` has the columns ``segment``, ``h``, ``delta_T``, ``F_N``, ``F_T``, ``law_F_N``, ``law_F_T`` of each path by its name,
    in the units of the case.
    """

    def __init__(self, paths: list[dict[str, Any]]) -> None:
        self.paths: dict[str, Table] = {path["path"]: Table(path["columns"]) for path in paths}
        names = [name for name in paths[0] if name != "columns"] if paths else []
        self.table = Table({name: np.array([path[name] for path in paths]) for name in names})

    def __repr__(self) -> str:
        return f"<Check: {int(self.table['within'].sum())} of {len(self.paths)} paths within 5 % rms and 12 %>"


class Contacts:
    """The memory of many contacts of one pair of materials, for :meth:`Law.update`; made by :meth:`Law.contacts`."""

    __slots__ = ("_native",)

    def __init__(self, native: NativeContacts) -> None:
        self._native = native

    def __len__(self) -> int:
        return len(self._native)

    def copy(self) -> Contacts:
        """A copy, to try a step on."""
        return Contacts(self._native.copy())

    @property
    def array(self) -> np.ndarray:
        """A copy of the memory, a row a contact: h, the greatest h, the elastic approach and the one it is released from, lengths; x and the place of
        hardening, on the virgin curves; how far its slip was reversed; the deflections of the sliders, lengths. What is assigned here is put back."""
        return self._native.to_array()

    @array.setter
    def array(self, memory: ArrayLike) -> None:
        self._native.set_array(np.ascontiguousarray(memory, dtype=np.float64))

    def rotate(self, angle: ArrayLike) -> None:
        """Turns the tangential memory into axes that are turned by ``angle`` (radians), where the frame follows the contact's normal."""
        angles = np.broadcast_to(np.asarray(angle, dtype=np.float64), (len(self),))
        self._native.rotate(np.cos(angles), np.sin(angles))


class Law:
    """A contact law: F_N and F_T of an elastic-plastic sphere that is pressed and sheared."""

    __slots__ = ("_native",)

    def __init__(self, native: NativeLaw) -> None:
        self._native = native

    @classmethod
    def fit(cls, study: Study | str | os.PathLike[str], prior: str = "built-in", *, interpolate: bool = False, reversal: Law | None = None) -> Law:
        """Fits a law to a study and writes ``law.json`` into its directory.

        :param prior: constants to start from: ``"built-in"``, ``"none"``, or the path of another ``law.json``.
        :param interpolate: a law by interpolation between the contacts of the study, of many materials, instead of formulas.
        :param reversal: with ``interpolate``, where cases were not sheared back or released: the law by interpolation that knows the stiffness of a reversal and
            of an unloading, as :meth:`built_in` does.
        """
        if reversal is not None and not interpolate:
            raise ValueError("reversal: is given, and interpolate is False. Allowed: None")
        directory = os.fspath(study.directory if isinstance(study, Study) else study)
        if interpolate:
            return cls(interpolate_law(directory, None if reversal is None else reversal._native))
        return cls(fit_law(directory, prior))

    @classmethod
    def tabulate(
        cls,
        case: Case | Mapping[str, Any] | str | os.PathLike[str],
        out: str | os.PathLike[str] | None = None,
        elements: int = 8,
        device: str = "auto",
        threads: int | None = None,
        progress: bool | None = None,
        *,
        precision: str = "auto",
        resume: bool = False,
        force: bool = False,
    ) -> Law:
        """The law of one material, one friction and one opponent (a plane or an equal sphere) as curves over h, from a simulation at each of some ten to twenty
        depths up to the greatest indentation of the case. A minute or two of processor time.

        :param out: directory for the simulations and ``law.json``; without one nothing is kept but the law.
        :param elements: elements along the contact radius, at every depth, 4 to 32.
        :param device: as of :func:`asperity.study`, like ``threads``, ``progress``, ``precision``, ``resume`` and ``force``.
        :raises CaseError: the case has no law (``friction = "stick"``, a rigid sphere as the opponent), or an argument is refused.
        :raises Interrupted: as :func:`asperity.study`; with ``resume`` it goes on.
        """
        native = as_case(case)._native
        text = table_study(native, elements)
        with tempfile.TemporaryDirectory(prefix="asperity-") as scratch:
            directory = Path(scratch) / "table" if out is None else Path(out)
            run_study(text, None, directory, device, threads, progress, precision=precision, resume=resume, force=force)
            law, missing = table_law(os.fspath(directory), native, elements)
        if missing:
            warnings.warn(f"the table does without depths that were not reached: {'; '.join(missing)}", stacklevel=2)
        return cls(law)

    @classmethod
    def load(cls, file: str | os.PathLike[str]) -> Law:
        """Reads a ``law.json``, of ``asperity law fit`` or ``law tabulate``."""
        return cls(NativeLaw.load(os.fspath(file)))

    @classmethod
    def built_in(cls, formulas: bool = False) -> Law:
        """The law that comes with the program, for any material: it interpolates between simulated contacts, of a sphere with a plane and of two equal spheres.

        :param formulas: the one with formulas instead, fitted to 240 cases of 15 materials, Poisson's ratio 0.3.
        """
        return cls(NativeLaw.built_in(formulas))

    def save(self, file: str | os.PathLike[str]) -> None:
        """Writes a ``law.json``."""
        self._native.save(os.fspath(file))

    def to_dict(self) -> dict[str, Any]:
        """The content of ``law.json``: forms, constants, where they come from, where they hold and how well."""
        law: dict[str, Any] = json.loads(self._native.to_json())
        return law

    def table(self, case: Case | Mapping[str, Any] | str | os.PathLike[str]) -> Law:
        """The table of a case's contact, a plane's or a pair's, as a law by interpolation makes it; another law as it is."""
        return Law(self._native.table(as_case(case)._native))

    def formulas(self) -> str:
        """The formulas with their constants; a table and a law by interpolation have none."""
        return self._native.formulas()

    def predict(self, case: Case | Mapping[str, Any] | str | os.PathLike[str], press: bool = False) -> Table:
        """``segment``, ``h``, ``delta_T``, ``F_N``, ``F_T`` along the whole path of a case, in its units, without simulating any of it: what ``asperity law predict`` prints.

        Warns where the case lies outside of what the law was fitted to.

        :param press: take F_N0 and a0 from a simulation of the press, not from the law's formulas, and give the shear alone; for a case that is pressed once and
            sheared once at constant indentation.
        """
        columns, outside = self._native.predict(as_case(case)._native, press)
        if outside:
            warnings.warn(f"the case lies outside of what the law was fitted to: {', '.join(outside)}. compare with a run", stacklevel=2)
        return Table(columns)

    def export(
        self,
        format: str,
        out: str | os.PathLike[str] | None = None,
        case: Case | Mapping[str, Any] | str | os.PathLike[str] | None = None,
    ) -> str | list[Path]:
        """The law for other programs, ``"c"`` (of the material and the friction of ``case``) or ``"python"``: its source, or with ``out`` the files that were written
        there, with test vectors."""
        native = None if case is None else as_case(case)._native
        if out is None:
            return self._native.source(format, native)
        return [Path(file) for file in self._native.export(format, os.fspath(out), native)]

    def check(self, case: Case | Mapping[str, Any] | str | os.PathLike[str] | None = None, elements: int = 6) -> Check:
        """Simulates eleven paths (presses, shears, reversals, unloadings, oblique ones) with the material, the friction and the greatest indentation of a case, and
        follows them with :meth:`update`. Some minutes of processor time at 6 elements.

        :param case: for a table by default its own material, friction and greatest indentation.
        :param elements: elements along the contact radius of the simulations, 4 to 32.
        :raises Interrupted: a :class:`KeyboardInterrupt`; of the paths nothing is kept.
        """
        paths, raised = self._native.check(None if case is None else as_case(case)._native, elements)
        if raised is not None:
            raise Interrupted("interrupted; a check cannot go on") if isinstance(raised, KeyboardInterrupt) else raised
        return Check(paths)

    def contacts(self, case: Case | Mapping[str, Any] | str | os.PathLike[str], number: int = 1) -> Contacts:
        """``number`` contacts of a case's sphere, material and friction, before first touch."""
        return Contacts(self._native.contacts(as_case(case)._native, number))

    def update(self, state: Contacts, h: ArrayLike, delta: ArrayLike) -> Table:
        """Moves every contact to the indentation ``h`` (n,) and then along the plane by the increment ``delta`` (n, 2), lengths, and keeps that in ``state``.

        Contacts are independent of each other and computed side by side. Gives ``F_N`` (n,), compression positive; ``F_T`` (n, 2), along the displacement; the
        contact radius ``a`` (n,); and the tangents ``dF_N_dh`` (n,), ``dF_N_ddelta`` (n, 2), ``dF_T_ddelta`` (n, 2, 2). Where ``h`` or ``delta`` is not finite, neither is
        the answer, and that contact stays as it was.
        """
        number = len(state)
        depth = np.ascontiguousarray(np.broadcast_to(np.asarray(h, dtype=np.float64), (number,)))
        increment = np.ascontiguousarray(np.broadcast_to(np.asarray(delta, dtype=np.float64), (number, 2)))
        return Table(state._native.update(depth, increment))

    def __repr__(self) -> str:
        law = self.to_dict()
        if "levels" in law:
            return f"<Law: a table of {len(law['levels'])} depths>"
        if "source" in law:
            return f"<Law: by interpolation between {law['source']['cases']} contacts of {law['source']['materials']} materials>"
        provenance = law["provenance"]
        return f"<Law: fitted to {provenance['cases']} cases of {provenance['materials']} materials>"
