"""The case: what one simulation is told."""

from __future__ import annotations

import html
import os
from collections.abc import Mapping, Sequence
from typing import Any

from ._arguments import described, items, path
from ._arguments import text as _text
from ._asperity import NativeCase, toml_value
from ._errors import CaseError

__all__ = ["Case"]


def _settings(settings: Mapping[str, Any] | None) -> list[str]:
    if settings is None:
        return []

    def setting(key: Any, value: Any) -> str:
        key = _text("set", key)
        if "=" in key:
            raise CaseError(f"set: has the key {key!r}. Allowed: dotted keys, as in contact.friction")
        # What stands alone may be without quotes, as on the command line.
        return f"{key}={_text(key, value) if isinstance(value, str) else toml_value(value, key)}"

    return [setting(key, value) for key, value in items("set", settings, "a dictionary of values by their dotted keys")]


class Case:
    """A sphere, its material, its friction, and the path it is taken along, checked by the rules of a case file.

    The keywords are the tables of a case file, with its keys; what is left out has its default. Any one consistent system of units:
    lengths in those of ``sphere["radius"]``, stresses in those of ``material["youngs_modulus"]``.

    :param sphere: ``radius`` R, a length.
    :param material: ``youngs_modulus`` E, a stress; ``poissons_ratio`` nu; ``hardening``, a table with ``law``: ``"elastic"``, ``"ideal"``,
        ``"linear"``, ``"power"``, ``"hollomon"``, ``"voce"`` or ``"table"``, and its numbers.
    :param contact: ``friction``, a number or ``"stick"``.
    :param path: segments, each ``{"indentation": h}``, ``{"shear": delta_T or "full-slip", "hold": "indentation" or "normal-force"}`` or
        ``{"release": True}``; lengths.
    :param mesh: ``elements_per_contact_radius`` (10), ``surface_elements_per_contact_radius`` (20, but as many as inside where these are
        given), ``first_layer_thickness``, ``fine_zone``, ``contact_radius``.
    :param solver: ``tolerance``, ``press_steps``, ``shear_steps``, ``error_estimate``, ...
    :param output: ``fields`` (``"none"``, ``"contact"``, ``"segments"``, ``"all"``), ``plots``.
    :raises CaseError: what is wrong, with the key and what is allowed.
    """

    __slots__ = ("_native",)

    def __init__(
        self,
        *,
        sphere: Mapping[str, Any],
        material: Mapping[str, Any],
        contact: Mapping[str, Any],
        path: Sequence[Mapping[str, Any]],
        mesh: Mapping[str, Any] | None = None,
        solver: Mapping[str, Any] | None = None,
        output: Mapping[str, Any] | None = None,
        **others: Any,
    ) -> None:
        tables = {"sphere": sphere, "material": material, "contact": contact, "path": path}
        tables |= {"mesh": mesh, "solver": solver, "output": output} | others
        self._native = NativeCase.from_dict(tables)

    @classmethod
    def _of(cls, native: NativeCase) -> Case:
        case = cls.__new__(cls)
        case._native = native
        return case

    @classmethod
    def from_dict(cls, tables: Mapping[str, Any]) -> Case:
        """A case from a dictionary with the keys of a case file."""
        return cls._of(NativeCase.from_dict(tables))

    @classmethod
    def parse(cls, text: str, set: Mapping[str, Any] | None = None, name: str = "case") -> Case:
        """A case from the text of a case file; ``set`` replaces values, as in ``{"contact.friction": 0.1}``."""
        return cls._of(NativeCase.parse(_text("case", text), _text("name", name), _settings(set)))

    @classmethod
    def load(cls, file: str | os.PathLike[str], set: Mapping[str, Any] | None = None) -> Case:
        """A case from a case file; ``set`` replaces values, as in ``{"path.0.indentation": 0.01}``."""
        return cls._of(NativeCase.load(path("case", file), _settings(set)))

    def replace(self, values: Mapping[str, Any]) -> Case:
        """A copy with other values, by their dotted keys."""
        return self.parse(self.to_toml(), set=values)

    @property
    def notes(self) -> list[str]:
        """What is allowed and yet odd about the case, two systems of units in it say; each begins with its key."""
        return self._native.notes()

    def to_dict(self) -> dict[str, Any]:
        """The case with every default written out."""
        return self._native.to_dict()

    def to_toml(self) -> str:
        """The case file with every default written out."""
        return self._native.to_toml()

    def __getitem__(self, key: str) -> Any:
        """A value by its dotted key, as in ``case["path.0.indentation"]``."""
        value: Any = self.to_dict()
        if not isinstance(key, str):
            # Not every object has a text.
            raise KeyError(f"a key is a dotted string, as in 'path.0.indentation', and not a {type(key).__name__}")
        for part in key.split("."):
            try:
                value = value[int(part)] if isinstance(value, list) else value[part]
            except (KeyError, IndexError, ValueError, TypeError):
                raise KeyError(key) from None
        return value

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Case) and self.to_toml() == other.to_toml()

    def __hash__(self) -> int:
        return hash(self.to_toml())

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self).parse, (self.to_toml(),)

    def _repr_html_(self) -> str:
        return f"<pre>{html.escape(self.to_toml())}</pre>"

    def __repr__(self) -> str:
        return f"Case.parse('''{self.to_toml()}''')"


def as_case(case: Case | Mapping[str, Any] | str | os.PathLike[str]) -> Case:
    """A case in any of the ways in which one may be given: itself, a dictionary, the path of a file, or its text."""
    if isinstance(case, Case):
        return case
    if isinstance(case, Mapping):
        return Case.from_dict(case)
    if isinstance(case, str) and "\n" in case:
        return Case.parse(case)
    if isinstance(case, (str, bytes, os.PathLike)):
        return Case.load(case)
    raise CaseError(f"case: is {described(case)}. Allowed: a Case, a dictionary, the path of a case file, or its text")
