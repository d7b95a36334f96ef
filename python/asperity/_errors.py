"""The errors that know nothing of results; :mod:`asperity.errors` has all."""

from __future__ import annotations

__all__ = ["AsperityError", "CaseError", "MissingPackage"]


class AsperityError(Exception):
    """Anything that this package raises, but for :class:`Interrupted`."""

    __module__ = "asperity.errors"


class CaseError(AsperityError, ValueError):
    """A case, a study or an argument that is refused: what, where, and what is allowed."""

    __module__ = "asperity.errors"


class MissingPackage(AsperityError, ImportError):
    """An optional package that is not installed."""

    __module__ = "asperity.errors"
