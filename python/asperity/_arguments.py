"""Arguments as they are given: paths, texts and arrays, each refused by its name."""

from __future__ import annotations

import itertools
import os
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ._errors import CaseError

__all__ = ["as_array", "described", "items", "numbers", "path", "text", "truth"]

# Most keys of a mapping.
_MOST = 10_000


def described(value: Any) -> str:
    """What a value is, in words."""
    return "None" if value is None else f"a {type(value).__name__}"


def path(name: str, value: Any) -> Path:
    """A path: ``str``, ``bytes`` or ``os.PathLike``."""
    try:
        given = os.fsdecode(value)
        os.fsencode(given)
    except TypeError:
        raise CaseError(f"{name}: is {described(value)}. Allowed: a path") from None
    except UnicodeError:
        raise CaseError(f"{name}: is {value!r}, which cannot be the name of a file here. Allowed: a path") from None
    if not given or "\0" in given:
        raise CaseError(f"{name}: is {given!r}. Allowed: a path, not empty and without NUL")
    return Path(given)


def text(name: str, value: Any) -> str:
    """A string that is Unicode throughout."""
    if not isinstance(value, str):
        raise CaseError(f"{name}: is {described(value)}. Allowed: a string")
    try:
        value.encode()
    except UnicodeError:
        raise CaseError(f"{name}: has half a surrogate pair. Allowed: a string of Unicode") from None
    return str(value)


def truth(name: str, value: Any) -> bool:
    """``True`` or ``False``; a number or a text is neither."""
    if not isinstance(value, (bool, np.bool_)):
        raise CaseError(f"{name}: is {described(value)}. Allowed: True, False")
    return bool(value)


def items(name: str, value: Any, allowed: str) -> list[tuple[Any, Any]]:
    """What is in a mapping, if that has an end."""
    if not isinstance(value, Mapping):
        raise CaseError(f"{name}: is {described(value)}. Allowed: {allowed}")
    keys = list(itertools.islice(value, _MOST + 1))
    if len(keys) > _MOST:
        raise CaseError(f"{name}: has more than {_MOST} keys. Allowed: {allowed}")
    return [(key, value[key]) for key in keys]


def numbers(name: str, value: Any, shape: tuple[int, ...], *, one: str | None = None, finite: bool = False) -> np.ndarray:
    """Real numbers as float64 of a shape, in a row in memory.

    What is masked, ``None``, text, complex or a boolean is refused with its index, and with ``finite`` also what is infinite or no number.

    :param one: what may be given for all rows of the shape at once, in words; without it only the whole shape.
    """
    array = _numbers(name, value)
    if array.shape != shape and (one is None or array.shape != shape[1:]):
        whole = str(shape).replace(" ", "") if len(shape) == 1 else str(shape)
        allowed = whole if one is None else f"{one}, or an array of the shape {whole}"
        raise CaseError(f"{name}: {_shape(array)}. Allowed: {allowed}")
    mask = np.asarray(np.ma.getmask(array))
    if mask.any():
        raise CaseError(f"{_at(name, mask)}: is masked. Allowed: numbers")
    array = np.asarray(array)
    if array.dtype.kind == "O":
        array = _of_objects(name, array)
    with np.errstate(over="ignore"):
        array = np.require(np.broadcast_to(array, shape), np.float64, ["C_CONTIGUOUS", "ALIGNED"])
    if finite:
        wrong = ~np.isfinite(array)
        if wrong.any():
            raise CaseError(f"{_at(name, wrong)}: is {array[wrong][0]}. Allowed: finite numbers")
    return array


def as_array(name: str, value: Any) -> np.ndarray:
    """What is an array, or can be one; its mask is kept."""
    # NumPy would take a mapping for a sequence, as long as it says that it is.
    if isinstance(value, Mapping):
        raise CaseError(f"{name}: is {described(value)}. Allowed: an array")
    if isinstance(value, (list, tuple)) and _has_masked_row(value):
        raise CaseError(f"{name}: is masked in one of its rows. Allowed: numbers")
    try:
        # Lists may have masked values in them, which NumPy itself makes NaN.
        return np.ma.asarray(value) if isinstance(value, (list, tuple)) else np.asanyarray(value)
    except (TypeError, ValueError, RecursionError, UserWarning) as error:
        raise CaseError(f"{name}: is no array ({error}). Allowed: an array") from None


def _has_masked_row(value: list[Any] | tuple[Any, ...], deepest: int = 3) -> bool:
    """A masked value in a list within the list, which NumPy makes NaN; no argument has more than two dimensions."""
    rows = (row for row in value if isinstance(row, (list, tuple)))
    return deepest > 0 and any(any(item is np.ma.masked for item in row) or _has_masked_row(row, deepest - 1) for row in rows)


def _numbers(name: str, value: Any) -> np.ndarray:
    """An array of real numbers or of objects, of any shape; its mask is kept."""
    if isinstance(value, (str, bytes, bytearray, bool, type(None))):
        raise CaseError(f"{name}: is {described(value)}. Allowed: numbers")
    array = as_array(name, value)
    if array.dtype.kind not in "fiuO":
        raise CaseError(f"{name}: has the type {array.dtype}. Allowed: real numbers")
    return array


def _of_objects(name: str, array: np.ndarray) -> np.ndarray:
    """The numbers of an array of Python's objects."""
    found = np.empty(array.shape, dtype=np.float64)
    for index, item in np.ndenumerate(array):
        try:
            if isinstance(item, (str, bytes, bytearray, bool, np.bool_)):
                raise TypeError
            found[index] = float(item)
        except (TypeError, ValueError, OverflowError):
            raise CaseError(f"{_place(name, index)}: is {described(item)}. Allowed: numbers") from None
    return found


def _place(name: str, index: Iterable[int]) -> str:
    """A name with an index, of which a single number has none."""
    place = ", ".join(map(str, index))
    return f"{name}[{place}]" if place else name


def _at(name: str, wrong: np.ndarray) -> str:
    """The name with the first index at which something is wrong."""
    return _place(name, np.argwhere(wrong)[0]) if wrong.ndim else name


def _shape(array: np.ndarray) -> str:
    return f"has the shape {array.shape}" if array.ndim else "is a single number"
