from __future__ import annotations

import numpy as np
import pytest
from conftest import IDEAL

import asperity

TABLES = {
    "sphere": {"radius": 1.0},
    "material": {"youngs_modulus": 200e3, "poissons_ratio": 0.3, "hardening": {"law": "ideal", "yield_stress": 400.0}},
    "contact": {"friction": 0.3},
    "path": [{"indentation": 0.02}, {"shear": "full-slip"}],
}


def test_all_ways_lead_to_one_case() -> None:
    case = asperity.Case.load(IDEAL)
    assert asperity.Case.parse(IDEAL.read_text()) == case
    assert asperity.Case.parse(case.to_toml()) == case
    assert asperity.Case.from_dict(case.to_dict()) == case
    assert asperity.Case(**case.to_dict()) == case
    assert eval(repr(case), {"Case": asperity.Case}) == case
    assert len({case, asperity.Case.load(IDEAL)}) == 1


def test_numpy_numbers_and_tuples_are_numbers_and_lists() -> None:
    plain = asperity.Case(**TABLES)
    other = TABLES | {
        "contact": {"friction": np.float64(0.3)},
        "mesh": {"elements_per_contact_radius": np.int64(10), "surface_elements_per_contact_radius": np.int64(20)},
        "path": tuple(TABLES["path"]),
    }
    assert asperity.Case(**other) == plain
    points = np.array([[0.0, 400.0], [0.1, 500.0]])
    table = TABLES | {"material": TABLES["material"] | {"hardening": {"law": "table", "points": points}}}
    assert asperity.Case(**table)["material.hardening.points"] == points.tolist()


def test_values_by_their_keys() -> None:
    case = asperity.Case(**TABLES)
    assert case["path.1.shear"] == "full-slip" and case["mesh.elements_per_contact_radius"] == 10
    softer = case.replace({"contact.friction": "stick", "path.1.shear": 0.001, "output.plots": False})
    assert (softer["contact.friction"], softer["path.1.shear"], softer["output.plots"]) == ("stick", 0.001, False)
    with pytest.raises(KeyError):
        case["path.7"]
    deep = ()
    for _ in range(100_000):
        deep = (deep,)
    for key in [("path", 0), None, object(), [deep]]:
        with pytest.raises(KeyError, match="a key is a dotted string"):
            case[key]


@pytest.mark.parametrize(
    ("tables", "text"),
    [
        ({"contact": {"friction": -0.1}}, 'case: contact.friction: is -0.1. Allowed: a number >= 0, or "stick"'),
        ({"contact": {"friktion": 0.1}}, "case: contact.friktion: unknown key, did you mean `friction`? Allowed: friction"),
        ({"contact": {}}, 'case: contact.friction: missing. Allowed: a number >= 0, or "stick"'),
        ({"mesh": {"elements_per_contact_radius": 2.5}}, "case: mesh.elements_per_contact_radius: is the number 2.5, which is the wrong type."),
        ({"contact": {"friction": object()}}, "case: contact.friction: is a object, which is the wrong type."),
        ({"contact": {1: 2}}, "case: contact: has a key that is not a string."),
        ({"spher": {"radius": 1.0}}, "case: spher: unknown key, did you mean `sphere`?"),
    ],
)
def test_what_is_wrong_is_told_by_its_key(tables: dict, text: str) -> None:
    with pytest.raises(asperity.CaseError) as error:
        asperity.Case.from_dict(TABLES | tables)
    assert str(error.value).startswith(text)
    assert isinstance(error.value, ValueError) and isinstance(error.value, asperity.AsperityError)


def test_a_file_is_named_with_its_line(tmp_path) -> None:
    file = tmp_path / "case.toml"
    file.write_text("[sphere]\nradius = -1\n")
    with pytest.raises(asperity.CaseError, match=r"case\.toml:2: sphere\.radius"):
        asperity.Case.load(file)
    with pytest.raises(FileNotFoundError, match="nowhere.toml"):
        asperity.run(tmp_path / "nowhere.toml")
    with pytest.raises(asperity.CaseError, match="Allowed: a Case, a dictionary"):
        asperity.run(7)


def test_what_is_odd_is_noted() -> None:
    assert asperity.Case(**TABLES).notes == []
    (note,) = asperity.Case(**TABLES).replace({"material.hardening.yield_stress": 0.4}).notes
    assert note.startswith("material.hardening.yield_stress: puts E/sigma_Y at 5.000e5")
