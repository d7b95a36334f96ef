"""A law, as those know it that are given one."""

from __future__ import annotations

from ._arguments import described
from ._asperity import NativeLaw
from ._errors import CaseError


class AnyLaw:
    """The native law; what is done with it is of :class:`Law`, which is the only one there is."""

    __slots__ = ("_native",)

    def __init__(self, native: NativeLaw) -> None:
        if not isinstance(native, NativeLaw):
            raise CaseError(f"law: is made of {described(native)}. Allowed: what Law.built_in(), load(), fit() and tabulate() give")
        self._native = native
