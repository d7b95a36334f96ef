"""Packages that are asked for only when they are used."""

from __future__ import annotations

import importlib
from types import ModuleType

from ._errors import MissingPackage


def need(module: str, package: str, what: str) -> ModuleType:
    """The module, or an error that says how to get it."""
    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise MissingPackage(f"{what} needs {package}, which is not installed. get it with `pip install {package}`") from error
