"""Types: of the package, and of what its pages tell users to write."""

import pathlib
import re
import subprocess
import sys

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGES = ["docs/python.md", "python/README.md"]


def mypy(*arguments):
    pytest.importorskip("mypy")
    command = [sys.executable, "-m", "mypy", "--strict", "--ignore-missing-imports", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True)


@pytest.mark.parametrize("page", PAGES)
def test_the_snippets_of_a_page_are_typed(page, tmp_path):
    # As one file: each goes on where the one before it ended.
    blocks = re.findall(r"^```python\n(.*?)^```$", (ROOT / page).read_text(encoding="utf-8"), re.M | re.S)
    assert blocks, page
    (tmp_path / "snippets.py").write_text("\n".join(blocks), encoding="utf-8")
    answer = mypy(tmp_path / "snippets.py")
    assert answer.returncode == 0, answer.stdout + answer.stderr


def test_a_wrong_type_is_found(tmp_path):
    (tmp_path / "wrong.py").write_text("import asperity\nasperity.run(1.5).plot(3)\n", encoding="utf-8")
    answer = mypy(tmp_path / "wrong.py")
    assert answer.returncode == 1 and answer.stdout.count("arg-type") == 2, answer.stdout


def test_the_package_is_typed():
    answer = mypy("-p", "asperity")
    assert answer.returncode == 0, answer.stdout + answer.stderr
