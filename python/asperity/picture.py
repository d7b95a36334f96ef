"""The program's pictures."""

from __future__ import annotations

import os

from ._arguments import described, path, text, truth
from ._asperity import NativePicture
from ._errors import CaseError

__all__ = ["Picture"]


class Picture:
    """A picture as ``asperity plot`` draws it, which notebooks show; made by :meth:`Run.plot` and :meth:`Law.plot`.

    ``name`` is that of its file, ``caption`` says what it shows and how to read it, ``svg`` is the picture.
    """

    __slots__ = ("_native",)

    def __init__(self, native: NativePicture) -> None:
        if not isinstance(native, NativePicture):
            raise CaseError(f"picture: is made of {described(native)}. Allowed: what Run.plot() and Law.plot() give")
        self._native = native

    @property
    def name(self) -> str:
        """The name of its file, less the ending."""
        return self._native.name()

    @property
    def caption(self) -> str:
        """What it shows and how to read it."""
        return self._native.caption()

    @property
    def svg(self) -> str:
        """The whole ``<svg>`` element."""
        return self._native.svg()

    def save(self, file: str | os.PathLike[str]) -> None:
        """Writes a file, by its ending SVG, PDF or PNG."""
        self._native.save(path("file", file))

    def _repr_svg_(self) -> str:
        return self.svg

    def __repr__(self) -> str:
        return f"<Picture {self.name}: {self.caption}>"


def asked(name: str | None, width: str | None, title: bool) -> tuple[str | None, str | None, bool]:
    """The arguments of a picture, checked."""
    return None if name is None else text("name", name), None if width is None else text("width", width), truth("title", title)
