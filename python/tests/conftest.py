"""One small run that most tests look at."""

from __future__ import annotations

from pathlib import Path

import pytest

import asperity

ROOT = Path(__file__).parents[2]
IDEAL = ROOT / "fixtures/cases/ideal.toml"
COARSE = {"mesh.elements_per_contact_radius": 4, "solver.error_estimate": False}


@pytest.fixture(scope="session")
def case() -> asperity.Case:
    return asperity.Case.load(IDEAL, set=COARSE)


@pytest.fixture(scope="session")
def done(case: asperity.Case) -> asperity.Run:
    return asperity.run(case)


GRID = {"material.hardening.yield_stress": [200.0, 800.0], "contact.friction": [0.1, "stick"], "path.1.shear": [0.002]}


@pytest.fixture(scope="session")
def study(case: asperity.Case) -> asperity.Study:
    return asperity.study(case.replace({"output.fields": "contact", "output.plots": False}), GRID)


@pytest.fixture(scope="session")
def table_directory(case: asperity.Case, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Of a table of the case: its study and its `law.json`."""
    directory = tmp_path_factory.mktemp("laws") / "table"
    asperity.Law.tabulate(case, out=directory, elements=4)
    return directory


@pytest.fixture(scope="session")
def table(table_directory: Path) -> asperity.Law:
    return asperity.Law.load(table_directory / "law.json")


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--long", action="store_true", help="100,000 hostile calls instead of 2,000")
