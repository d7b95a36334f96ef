"""Columns of numbers and words."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ._arguments import as_array, items
from ._errors import AsperityError, CaseError
from ._html import table
from ._optional import need

__all__ = ["Table"]

_MOST_SHOWN = 20


class Table(Mapping[str, np.ndarray]):
    """A mapping from the names of columns to NumPy arrays of one length.

    Every column is also an attribute: ``table.F_N`` is ``table["F_N"]``.
    """

    def __init__(self, columns: Mapping[str, Any]) -> None:
        self._columns: dict[str, np.ndarray] = {
            name: np.asarray(as_array(f"columns.{name}", column)) for name, column in items("columns", columns, "a mapping of names to columns")
        }
        if any(not column.ndim for column in self._columns.values()) or len({len(column) for column in self._columns.values()}) > 1:
            raise CaseError("columns: are not of one length. Allowed: one value a row in each")

    def __getitem__(self, name: str) -> np.ndarray:
        try:
            return self._columns[name]
        except KeyError:
            raise KeyError(f"{name}: no such column. there are {', '.join(self._columns)}") from None

    def __getattr__(self, name: str) -> np.ndarray:
        columns: dict[str, np.ndarray] = self.__dict__.get("_columns", {})
        if name in columns:
            return columns[name]
        raise AttributeError(f"{name}: no such column. there are {', '.join(columns)}")

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._columns]

    @property
    def rows(self) -> int:
        """Number of rows."""
        return len(next(iter(self._columns.values()), ()))

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {self.rows} rows of {', '.join(self._columns)}>"

    def _repr_html_(self) -> str:
        # The first and the last rows of a long one.
        rows = list(range(self.rows))
        if self.rows > _MOST_SHOWN:
            rows = [*rows[: _MOST_SHOWN // 2], *rows[-_MOST_SHOWN // 2 :]]

        def cell(value: Any) -> str:
            return f"{value:.6g}" if isinstance(value, float) else str(value)

        lines = [tuple(cell(column[row]) for column in self._columns.values()) for row in rows]
        if self.rows > _MOST_SHOWN:
            lines.insert(_MOST_SHOWN // 2, ("...",) * len(self._columns))
        return table(lines, tuple(self._columns))

    def to_pandas(self) -> Any:
        """A ``pandas.DataFrame``."""
        return need("pandas", "pandas", "to_pandas()").DataFrame(self._columns)

    def to_arrow(self) -> Any:
        """A ``pyarrow.Table``."""
        return need("pyarrow", "pyarrow", "to_arrow()").table(dict(self._columns))


def read(path: Path, whole: Sequence[str] = (), words: Sequence[str] = ()) -> Table:
    """A CSV file: the columns ``whole`` as int64, ``words`` as text, all others as float64 with NaN where nothing stands.

    A column that holds something else is text as a whole.
    """
    bad = AsperityError(f"{path}: is not a table as Asperity writes it. Compute it again")
    try:
        with path.open(newline="", encoding="utf-8") as file:
            names, *rows = list(csv.reader(file))
    except (ValueError, csv.Error):
        raise bad from None
    if any(len(row) != len(names) for row in rows):
        raise bad
    columns: dict[str, Any] = {}
    for name, values in zip(names, zip(*rows) if rows else [()] * len(names)):
        try:
            if name in whole:
                columns[name] = np.array([int(value) for value in values], dtype=np.int64)
                continue
        except (ValueError, OverflowError):
            raise bad from None
        try:
            if name in words:
                raise ValueError(name)
            columns[name] = np.array([float(value) if value else np.nan for value in values], dtype=np.float64)
        except ValueError:
            columns[name] = np.array(values, dtype=np.str_)
    return Table(columns)
