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
