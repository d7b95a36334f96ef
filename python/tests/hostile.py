"""Values that nobody should give, for `fuzz.py`: numbers, texts, paths, arrays and objects of every wrong kind."""

from __future__ import annotations

import datetime
import fractions
import itertools
import math
import os
import random
from collections.abc import Callable, Iterator, Mapping
from decimal import Decimal
from pathlib import Path
from typing import Any

import numpy as np


class Own(Exception):
    """What the hostile objects raise themselves; it may come out."""


def fails(*_: object, **__: object) -> Any:
    raise Own("hostile")


def made(name: str, **methods: Any) -> Any:
    """An object of a class with such methods."""
    return type(name, (), methods)()


class Endless(Mapping[str, int]):
    """A mapping without end."""

    def __getitem__(self, key: str) -> int:
        return 1

    def __iter__(self) -> Iterator[str]:
        return (f"key{i}" for i in itertools.count())

    def __len__(self) -> int:
        return 10**9


class Text(str):
    """A string of the user's own."""


class Whole(int):
    """A whole number of the user's own."""


class Real(float):
    """A number of the user's own."""


class Listed(list):  # type: ignore[type-arg]
    """A list of the user's own."""


def deep(kind: str, levels: int) -> Any:
    value: Any = 1.0
    for _ in range(levels):
        value = [value] if kind == "list" else {"a": value}
    return value


def cyclic(kind: str) -> Any:
    if kind == "list":
        listed: list[Any] = []
        listed.append(listed)
        return listed
    table: dict[str, Any] = {}
    table["a"] = table
    return table


def misaligned(count: int) -> np.ndarray:
    return np.frombuffer(bytearray(8 * count + 1), dtype=np.uint8)[1:].view(np.float64)


NUMBERS: list[Any] = [
    0, 1, 2, 3, 4, 33, -1, 2**31, 2**53 + 1, 2**63 - 1, 2**63, 2**64, -(2**63), -(2**63) - 1, 10**12, 10**30, 10**400, -(10**400),
    0.0, -0.0, 0.5, 1.0, -1.0, 1e-300, 5e-324, 1e300, 1.7976931348623157e308, -1e308, float("nan"), float("inf"), -float("inf"),
    True, False, 1 + 2j, complex("nan"), Decimal("0.1"), Decimal("NaN"), Decimal("sNaN"), fractions.Fraction(1, 3), Whole(3), Real(0.1),
    np.float16(0.1), np.float32(0.1), np.longdouble("1e4000"), np.int8(3), np.uint64(2**63), np.bool_(True), np.complex128(1j),
    np.datetime64("2020-01-01"), np.timedelta64(3), np.str_("x"), np.bytes_(b"x"), np.void(b"x"), np.ma.masked,
]  # fmt: skip
TEXTS: list[Any] = [
    "", " ", "x", "x" * 5000, "\n", "a\nb", "\0", "a\0b", "\ud800", "\udc80", "a\n\ud800", "é", "\u202e", "=", "a=b", ".", "..", "/", "//", "[", "{", '"',
    "'''", "#", "0.3", "nan", "true", "[1, 2]", "{a = 1}", "[" * 5000, "a." * 5000, "built-in", "none", "auto", "cpu", "f64", "c", "python", "1/2", "0/0", "9/2",
    "/dev/null", "/dev/full", "/dev/zero", "/proc/self/mem", "/nowhere/at/all", "stick", "full-slip", Text("c"), b"", b"x", b"\xff", b"a\0b", b"/nowhere",
    bytearray(b"x"), memoryview(b"abc"),
]  # fmt: skip
OBJECTS: list[Callable[[], Any]] = [
    lambda: None, object, lambda: object, lambda: fails, lambda: np, lambda: ..., lambda: NotImplemented, lambda: slice(1), lambda: range(3), lambda: iter([]),
    itertools.count, lambda: datetime.date(2020, 1, 1), lambda: Path("x"), lambda: Path("/nowhere/x"), lambda: Path("a\0b"), set, lambda: {1, 2}, dict, list, tuple,
    lambda: {1: 2}, lambda: {None: None}, lambda: {"\ud800": 1}, lambda: {"a": {1: 2}}, lambda: {"a=b": 1}, lambda: {"": 1}, lambda: {"a\n": "\n"}, Endless,
    lambda: deep("list", 30), lambda: deep("list", 300), lambda: deep("list", 20_000), lambda: deep("dict", 300), lambda: deep("dict", 20_000),
    lambda: cyclic("list"), lambda: cyclic("dict"), lambda: [[1.0], [1.0, 2.0]], lambda: [None, 1.0], lambda: ["1", "2"], lambda: Listed([1.0]),
    lambda: made("Fspath", __fspath__=lambda _: 7), lambda: made("Fspath", __fspath__=lambda _: b"\xff\0"), lambda: made("Fspath", __fspath__=fails),
    lambda: made("Array", __array__=fails), lambda: made("Array", __array__=lambda *_, **__: 7), lambda: made("Float", __float__=fails),
    lambda: made("Float", __float__=lambda _: "x"), lambda: made("Index", __index__=lambda _: 10**30), lambda: made("Index", __index__=fails),
    lambda: made("Index", __index__=lambda _: "x"), lambda: made("List", tolist=lambda itself: itself, size=1), lambda: made("List", tolist=fails, size=1),
    lambda: made("List", tolist=7, size=10**30), lambda: made("Str", __str__=fails, __repr__=lambda _: "x"), lambda: made("Bool", __bool__=fails),
    lambda: made("Eq", __eq__=fails, __hash__=lambda _: 1), lambda: made("Len", __len__=lambda _: -1, __getitem__=fails), lambda: open(os.devnull, "rb"),
]  # fmt: skip
ARRAYS: list[Callable[[int], Any]] = [
    lambda n: np.zeros(n), lambda n: np.zeros((n, 2)), lambda n: np.zeros((n, 1)), lambda n: np.zeros((1, n)), lambda n: np.zeros((n, 2, 2)),
    lambda n: np.zeros(n + 1), lambda n: np.zeros(0), lambda n: np.zeros((0, 2)), lambda n: np.zeros((n, 0)), lambda n: np.array(0.01),
    lambda n: np.array(None), lambda n: np.full(n, np.nan), lambda n: np.full((n, 2), np.inf), lambda n: np.full(n, 1e308), lambda n: np.full((n, 2), -1e308),
    lambda n: np.zeros(n, dtype=complex), lambda n: np.zeros((n, 2), dtype=complex), lambda n: np.zeros(n, dtype=bool), lambda n: np.zeros(n, dtype="U3"),
    lambda n: np.zeros(n, dtype="S3"), lambda n: np.zeros(n, dtype="V8"), lambda n: np.zeros(n, dtype="M8[s]"), lambda n: np.zeros(n, dtype="m8[s]"),
    lambda n: np.zeros(n, dtype=[("a", float)]), lambda n: np.ma.zeros(n, dtype=[("a", float)]), lambda n: np.full(n, None, dtype=object),
    lambda n: np.array([object()] * n), lambda n: np.array([10**400] * n), lambda n: np.array(["0.01"] * n, dtype=object), lambda n: np.full(n, 0.01, dtype=">f8"),
    lambda n: np.full(n, 1e-2, dtype=np.float16), lambda n: np.full(n, np.longdouble("1e4000")), lambda n: np.ones((n, 2), dtype=np.uint64),
    lambda n: np.full((n, 4), 0.001)[:, ::2], lambda n: np.full((2, n), 0.001).T, lambda n: np.full(2 * n, 0.01)[::-2], lambda n: misaligned(n),
    lambda n: misaligned(2 * n).reshape(n, 2), lambda n: np.broadcast_to(0.01, (n,)), lambda n: np.broadcast_to(0.01, (10**12,)),
    lambda n: np.broadcast_to(0.01, (10**9, 2)), lambda n: np.ma.array(np.zeros(n), mask=True), lambda n: np.ma.array(np.zeros((n, 2)), mask=False),
    lambda n: np.ma.masked_array(np.zeros((n, 2)), mask=[[i == 0, False] for i in range(n)]), lambda n: [0.01] * (n - 1) + [np.ma.masked],
    lambda n: [0.01] * (n - 1) + [None], lambda n: np.asmatrix(np.zeros(n)), lambda n: np.rec.array(np.zeros(n, dtype=[("a", float)])), lambda n: list(range(n)),
    lambda n: [np.zeros(2)] * n, lambda n: tuple([0.0] * n),
]  # fmt: skip


def value(dice: random.Random, count: int = 3) -> Any:
    """Any of them."""
    kind = dice.randrange(4)
    if kind == 0:
        return dice.choice(NUMBERS)
    if kind == 1:
        return dice.choice(TEXTS)
    return dice.choice(OBJECTS)() if kind == 2 else array(dice, count)


def array(dice: random.Random, count: int) -> Any:
    """An array for so many contacts, usually not fit for them."""
    return dice.choice(ARRAYS)(count)


def numbers(dice: random.Random, *shapes: tuple[int, ...]) -> np.ndarray:
    """Numbers of a shape that fits, of any size."""
    shape, greatest = dice.choice(shapes), dice.choice([-1, -1, -1, 0, 10, 150, 308])
    found = np.array([dice.choice([-1.0, 1.0, 1.0]) * 10.0 ** dice.uniform(dice.choice([-4, -320]), greatest) for _ in range(math.prod(shape))]).reshape(shape)
    if dice.random() < 0.2 and found.size:
        found.flat[dice.randrange(found.size)] = dice.choice([np.nan, np.inf, -np.inf, 0.0, 5e-324, 1.7976931348623157e308])
    return found


def mutated(dice: random.Random, table: Any) -> Any:
    """A copy of the tables of a case in which something is hostile."""
    if isinstance(table, dict) and table and dice.random() < 0.9:
        key = dice.choice(list(table))
        copied = dict(table)
        copied[key] = mutated(dice, table[key])
        if dice.random() < 0.1:
            copied[dice.choice([*(text for text in TEXTS if isinstance(text, str)), *table])] = copied.pop(key)
        return copied
    if isinstance(table, list) and table and dice.random() < 0.9:
        place = dice.randrange(len(table))
        return [mutated(dice, item) if i == place else item for i, item in enumerate(table)] + table[: dice.choice([0, 0, 1])]
    if isinstance(table, float) and dice.random() < 0.5:
        return table * 10.0 ** dice.uniform(-3, 3)
    return value(dice)


def damaged(dice: random.Random, content: bytes) -> bytes:
    """A file of which something is cut, turned over or put in."""
    place, end = sorted(dice.randrange(len(content) + 1) for _ in range(2))
    bad = dice.choice([b"", b"\0", b"\xff\xfe", b"nan", b"1e999", b"-1", b'"', b",", b"\n", b"<", b"[" * 3000, b"99999999999999999999", b"{}"])
    return dice.choice([content[:place], content[end:], content[:place] + bad + content[place:], content[:place] + bad + content[min(end, place + 9) :]])
