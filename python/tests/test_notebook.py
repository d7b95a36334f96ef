"""The notebook runs, and still says what it shows."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import Any

import pytest

NOTEBOOK = Path(__file__).parents[1] / "notebooks" / "contact.ipynb"
NUMBER = re.compile(r"-?\d+\.\d+")


def _text(cell: Any) -> str:
    """What a cell has printed and shown as text."""
    shown = [output.get("text") or output.get("data", {}).get("text/plain", "") for output in cell.outputs]
    return "".join(text for text in shown if not text.startswith("<Figure"))


def _pictures(cell: Any) -> int:
    return sum("image/png" in output.get("data", {}) for output in cell.outputs)


def test_the_notebook_says_what_it_shows(tmp_path: Path) -> None:
    if os.environ.get("ASPERITY_REQUIRE_PYTHON") != "1":
        for package in ["nbclient", "ipykernel", "matplotlib", "pandas"]:
            pytest.importorskip(package)
    import nbclient
    import nbformat

    assert NOTEBOOK.stat().st_size < 200_000
    stored = nbformat.read(NOTEBOOK, as_version=4)
    fresh = nbformat.read(NOTEBOOK, as_version=4)
    nbclient.NotebookClient(fresh, timeout=600, kernel_name="python3", resources={"metadata": {"path": str(tmp_path)}}).execute()
    cells = [(old, new) for old, new in zip(stored.cells, fresh.cells) if old.cell_type == "code"]
    assert sum(_pictures(new) for _, new in cells) == 4
    for old, new in cells:
        assert _pictures(old) == _pictures(new)
        assert NUMBER.sub("0", _text(old)) == NUMBER.sub("0", _text(new))
        said, says = ([float(number) for number in NUMBER.findall(_text(cell))] for cell in (old, new))
        assert says == pytest.approx(said, rel=2e-3, abs=2e-3)
