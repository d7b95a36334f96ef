"""Arguments that are no numbers, no paths, no cases; and a great many at random (`fuzz.py`)."""

from __future__ import annotations

import inspect
import math
import os
import shutil
import subprocess
import sys
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any

import fuzz
import numpy as np
import pytest
from conftest import IDEAL

import asperity

FUZZ = Path(__file__).with_name("fuzz.py")
# Calls of one process: one that fails is found again in a few seconds.
SHARE = 1000


@pytest.fixture(scope="module")
def law() -> asperity.Law:
    return asperity.Law.wear_2014()


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory, done: asperity.Run, study: asperity.Study, table_directory: Path) -> Path:
    """What the fuzz asks about."""
    place = tmp_path_factory.mktemp("fuzz")
    for name, directory in [("run", done.directory), ("study", study.directory), ("table", table_directory)]:
        shutil.copytree(directory, place / name)
    return place


def fuzzed(place: Path, seed: int, count: int, *names: str) -> None:
    """Runs the fuzz in a process of its own, so that its end and its stop are failures as well."""
    environment = os.environ | {"MPLBACKEND": "agg"}
    ended = subprocess.run(
        [sys.executable, FUZZ, place, str(seed), str(count), *names], capture_output=True, text=True, errors="replace", env=environment, timeout=600
    )
    said = [line for line in ended.stdout.splitlines() if line.startswith("WRONG")] or ended.stdout.splitlines()[-2:]
    assert ended.returncode == 0, "\n".join(said) + "\n" + ended.stderr[-2000:]
    # A panic of another thread is heard of here alone.
    assert "panicked" not in ended.stderr, ended.stderr[-2000:]


def test_hostile_arguments_are_refused_by_an_exception(place: Path, request: pytest.FixtureRequest) -> None:
    calls = 100_000 if request.config.getoption("--long") or os.environ.get("ASPERITY_LONG") == "1" else 2_000
    for seed in range(0, calls, SHARE):
        fuzzed(place, seed, SHARE)


def test_the_fuzz_sees_a_panic_an_end_a_stop_and_memory(place: Path) -> None:
    faults = {
        "panic": "raise type('PanicException', (BaseException,), {})('index out of bounds')",
        "caught": "raise asperity.AsperityError('the computation panicked')",
        "abort": "os.abort()",
        "slow": "sum(range(10**9)) if time.thread_time() > 0 else 0",
        "stop": "threading.Event().wait()",
        "memory": "[bytes(2**20) for _ in range(1500)] and bytearray(3 << 29).find(b'x')",
        "kind": "raise AttributeError('x')",
    }
    for fault, code in faults.items():
        patched = (
            "import sys, fuzz, os, time, threading, asperity\n"
            "fuzz.HANGS = 3.0\nfuzz.LONGEST = 0.5\n"
            f"def fault(dice):\n    {code}\n"
            "of = fuzz.Fuzz.of_errors\nfuzz.Fuzz.of_errors = lambda itself: {'fault': fault}\n"
            "sys.exit(fuzz.main())"
        )
        arguments = [sys.executable, "-c", patched, str(place), "0", "1", "fault"]
        ended = subprocess.run(arguments, capture_output=True, text=True, timeout=100, env=os.environ | {"PYTHONPATH": str(FUZZ.parent)})
        assert ended.returncode != 0, f"{fault}: {ended.stdout}"


def test_the_fuzz_has_every_public_name(place: Path) -> None:
    called = set(fuzz.Fuzz(place).calls)
    # Without arguments, or asked for by others.
    plain = {
        "Run.history",
        "Run.summary",
        "Run.mesh",
        "Run.contact_steps",
        "Run.field_steps",
        "Picture.name",
        "Picture.caption",
        "Picture.svg",
        "Study.table",
        "Table.keys",
        "Table.items",
        "Table.values",
        "Table.get",
    }
    for name in asperity.__all__:
        thing = getattr(asperity, name)
        if not callable(thing):
            continue
        assert name in called, f"{name} has no hostile call in fuzz.py"
        if not inspect.isclass(thing) or issubclass(thing, BaseException):
            continue
        methods = {method for method, found in inspect.getmembers_static(thing) if not method.startswith("_") and not inspect.ismemberdescriptor(found)}
        missing = {f"{name}.{method}" for method in methods} - called - plain
        assert not missing, f"{missing} have no hostile call in fuzz.py"


@pytest.mark.filterwarnings("ignore:.*converting a masked element to nan")
@pytest.mark.parametrize(
    ("argument", "given", "text"),
    [
        ("h", np.ma.array([0.01, 0.02, 0.01], mask=[0, 1, 1]), r"h\[1\]: is masked"),
        ("h", [0.01, 0.01, np.ma.masked], r"h\[2\]: is masked"),
        ("h", [0.01, None, None], r"h\[1\]: is None"),
        ("h", None, "h: is None"),
        ("h", ["0.01"] * 3, "h: has the type <U4"),
        ("h", np.array([0.01, "x", 0.01], dtype=object), r"h\[1\]: is a str"),
        ("h", [0.01, 10**400, 0.01], r"h\[1\]: is a int"),
        ("h", np.zeros(3, dtype=complex), "h: has the type complex128"),
        ("h", True, "h: is a bool"),
        ("h", np.zeros(3, dtype=bool), "h: has the type bool"),
        ("h", np.zeros(3, dtype="M8[s]"), "h: has the type datetime64"),
        ("h", np.zeros(4), r"h: has the shape \(4,\). Allowed: a number, or an array of the shape \(3,\)"),
        ("h", np.zeros((3, 1)), r"h: has the shape \(3, 1\)"),
        ("h", np.broadcast_to(0.01, (10**12,)), r"h: has the shape \(1000000000000,\)"),
        ("h", [[0.01], [0.01, 0.02]], "h: is no array"),
        ("h", {"a": 1.0}, "h: is a dict"),
        ("delta", 1e-3, r"delta: is a single number. Allowed: the two components \(x, y\), or an array of the shape \(3, 2\)"),
        ("delta", np.float64(1e-3), "delta: is a single number"),
        ("delta", [1e-3], r"delta: has the shape \(1,\)"),
        ("delta", np.zeros(3), r"delta: has the shape \(3,\)"),
        ("delta", np.zeros((3, 1)), r"delta: has the shape \(3, 1\)"),
        ("delta", [(0.0, np.ma.masked), (0.0, 0.0), (0.0, 0.0)], r"delta: is masked in one of its rows"),
        ("delta", np.ma.array(np.zeros((3, 2)), mask=[[0, 0], [0, 1], [0, 0]]), r"delta\[1, 1\]: is masked"),
        ("delta", [(0.0, 0.0), (0.0, None), (0.0, 0.0)], r"delta\[1, 1\]: is None"),
        ("angle", [0.0, np.nan, 0.0], r"angle\[1\]: is nan. Allowed: finite numbers"),
        ("angle", np.ma.array([0.0, 0.0, 0.0], mask=True), r"angle\[0\]: is masked"),
        ("angle", np.zeros(2), r"angle: has the shape \(2,\)"),
    ],
)
def test_what_is_no_array_of_numbers_is_refused_with_its_first_index(law: asperity.Law, case: asperity.Case, argument: str, given: Any, text: str) -> None:
    state = law.contacts(case, 3)
    law.update(state, 0.01, (1e-4, 0.0))
    before = state.array
    with pytest.raises(ValueError, match=text) as error:
        state.rotate(given) if argument == "angle" else law.update(state, **{"h": 0.01, "delta": (0.0, 0.0), argument: given})
    assert isinstance(error.value, asperity.CaseError) and (state.array == before).all()


def test_the_memory_of_contacts_is_finite(law: asperity.Law, case: asperity.Case) -> None:
    state = law.contacts(case, 3)
    before = state.array
    for wrong, text in [(np.nan, "nan"), (np.inf, "inf"), (-np.inf, "-inf")]:
        memory = before.copy()
        memory[1, 4] = wrong
        with pytest.raises(asperity.CaseError, match=rf"state\[1, 4\]: is {text}. Allowed: finite numbers"):
            state.array = memory
    with pytest.raises(asperity.CaseError, match=r"state\[2, 0\]: is masked"):
        state.array = np.ma.array(before, mask=[[row == 2] * before.shape[1] for row in range(3)])
    assert (state.array == before).all()


def test_a_number_that_overflows_leaves_the_contact(table: asperity.Law, case: asperity.Case) -> None:
    state = table.contacts(case, 2)
    table.update(state, 0.01, (1e-4, 0.0))
    before = state.array
    answer = table.update(state, [sys.float_info.max, 0.01], (1e-4, 0.0))
    assert all(np.isnan(column[0]).all() for column in answer.values()) and np.isfinite(answer["F_T"][1]).all()
    assert (state.array[0] == before[0]).all() and np.isfinite(state.array).all()


def test_numbers_of_any_kind_and_layout_are_the_same_numbers(law: asperity.Law, case: asperity.Case) -> None:
    h, delta = np.array([0.25, 0.5, 0.125]) / 16, np.array([[1.0, 2.0], [0.0, -1.0], [4.0, 0.5]]) / 2**14
    wanted = law.update(law.contacts(case, 3), h, delta)

    def misaligned(array: np.ndarray) -> np.ndarray:
        return np.frombuffer(b"x" + array.tobytes(), dtype=np.uint8)[1:].view(np.float64).reshape(array.shape)

    def read_only(array: np.ndarray) -> np.ndarray:
        array = array.copy()
        array.flags.writeable = False
        return array

    layouts = [
        np.asfortranarray, read_only, misaligned, lambda a: a.astype(">f8"), lambda a: a.astype(np.float32), lambda a: a.astype(np.longdouble), np.ma.asarray,
        lambda a: np.repeat(a, 2, axis=0)[::2], lambda a: np.flip(np.flip(a, axis=0).copy(), axis=0), np.ndarray.tolist, lambda a: a.astype(object),
        lambda a: [tuple(row) if isinstance(row, list) else row for row in a.tolist()], lambda a: np.vectorize(Fraction, otypes=[object])(a),
        lambda a: np.vectorize(Decimal, otypes=[object])(a),
    ]  # fmt: skip
    for layout in layouts:
        found = law.update(law.contacts(case, 3), layout(h), layout(delta))
        assert all((found[name] == wanted[name]).all() for name in wanted)
    one, two = law.contacts(case, 2), law.contacts(case, 2)
    whole = law.update(one, [0.01, 0.01], [[1e-4, 0.0]] * 2)
    for_all = law.update(two, 0.01, (1e-4, 0.0))
    assert all((for_all[name] == whole[name]).all() for name in whole)


@pytest.mark.parametrize("given", ["", b"", "a\0b", b"a\0b", "\ud800", 7, 1.5, None, object(), ["x"], np.zeros(2)], ids=repr)
def test_what_is_no_path_is_refused_by_the_name_of_its_argument(case: asperity.Case, law: asperity.Law, study: asperity.Study, given: Any) -> None:
    asked = {
        "case": lambda: asperity.Case.load(given),
        "directory": lambda: asperity.Run.load(given),
        "study": lambda: asperity.Law.fit(given),
        "law": lambda: asperity.Law.load(given),
        "file": lambda: law.save(given),
    }
    if given is not None:
        asked["out"] = lambda: law.export("c", given, case)
        with pytest.raises(asperity.CaseError, match="^out: is "):
            asperity.run(case, out=given)
        with pytest.raises(asperity.CaseError, match="^out: is "):
            asperity.study(case, {"contact.friction": [0.1]}, out=given)
    for name, ask in asked.items():
        with pytest.raises(asperity.CaseError, match=f"^{name}: is "):
            ask()


@pytest.mark.skipif(os.name != "posix", reason="names of any bytes")
def test_paths_of_any_kind_and_bytes_are_paths(case: asperity.Case, law: asperity.Law, tmp_path: Path) -> None:
    assert asperity.Case.load(os.fsencode(IDEAL)) == asperity.Case.load(str(IDEAL)) == asperity.Case.load(IDEAL)
    odd = os.fsencode(tmp_path) + b"/\xff\xfe name=\n"
    small = case.replace({"path.1.shear": 0.001})
    run = asperity.run(small, out=odd)
    assert os.fsencode(run.directory) == odd and asperity.Run.load(odd).history.rows == run.history.rows == asperity.Run.load(os.fsdecode(odd)).history.rows
    assert asperity.Case.load(odd + b"/case.toml") == small
    law.save(odd + b"/law.json")
    assert asperity.Law.load(odd + b"/law.json").to_dict() == law.to_dict()
    assert all(file.is_file() for file in law.export("c", odd + b"/export", case))


@pytest.mark.parametrize(
    ("ask", "text"),
    [
        (lambda case: asperity.run(case, threads=-1), "threads: is -1. Allowed: a number of threads from 1 to"),
        (lambda case: asperity.run(case, threads=10**30), "threads: is 1000000000000000000000000000000. Allowed"),
        (lambda case: asperity.run(case, threads=True), "threads: is a bool, which is the wrong type"),
        (lambda case: asperity.run(case, threads=2.0), "threads: is a float, which is the wrong type"),
        (lambda case: asperity.run(case, device=b"cpu"), "device: is a bytes. Allowed: a string"),
        (lambda case: asperity.run(case, device="\ud800"), "device: has half a surrogate pair"),
        (lambda case: asperity.run(case, progress="no"), "progress: is a str"),
        (lambda case: asperity.run(case, force=1), "force: is a int. Allowed: True, False"),
        (lambda case: asperity.study(case, [0.1]), "grid: is a list"),
        (lambda case: asperity.study(case, {"contact.friction": [0.1]}, shard=2), "shard: is a int"),
        (lambda case: asperity.Law.tabulate(case, elements=True), "elements: is a bool"),
        (lambda case: asperity.Law.built_in().contacts(case, -1), "number: is -1. Allowed: a number of contacts"),
        (lambda case: asperity.Law.built_in().update([1.0], 0.01, (0.0, 0.0)), "state: is a list. Allowed: Contacts"),
        (lambda case: case.replace({"contact.friction=0.1 #": 1}), "set: has the key"),
        (lambda case: case.replace([1]), "set: is a list"),
        (lambda case: asperity.Case.from_dict({"sphere": {"radius": 10**400}}), "case: sphere.radius: is a number beyond"),
        (lambda case: asperity.Case.from_dict({"sphere": fuzz.value.__globals__["cyclic"]("dict")}), "in more than 64 tables and lists"),
        (lambda case: asperity.Case.from_dict({"path": np.broadcast_to(0.01, (10**12,))}), "case: path: has too many values"),
        (lambda case: asperity.Case.from_dict([1]), "case: is a list, which is the wrong type"),
        (lambda case: asperity.Case.parse("x" * (17 << 20)), "case: has 17825792 bytes. Allowed: at most 16 MiB"),
    ],
)
def test_arguments_of_the_wrong_kind_are_refused_by_name(case: asperity.Case, ask: Any, text: str) -> None:
    with pytest.raises(asperity.CaseError, match=text):
        ask(case)


def test_a_list_that_contains_itself_and_one_that_unpacks_to_itself_are_refused(case: asperity.Case) -> None:
    class Unpacked:
        def tolist(self) -> Unpacked:
            return self

    endless: list[Any] = []
    endless.append(endless)
    for value in (Unpacked(), endless):
        for ask in (lambda value=value: case.replace({"path": value}), lambda value=value: asperity.Case.from_dict(case.to_dict() | {"path": value})):
            with pytest.raises(asperity.CaseError, match="in more than 64 tables and lists"):
                ask()


def test_settings_are_the_same_values_as_in_a_case(case: asperity.Case) -> None:
    points = np.array([[0.0, 400.0], [0.1, 500.0]])
    table = case.replace({"material.hardening": {"law": "table", "points": points}})
    assert table["material.hardening.points"] == points.tolist()
    assert case.replace({"contact.friction": np.float32(0.25)})["contact.friction"] == 0.25
    assert case.replace({"mesh.elements_per_contact_radius": np.int8(5)})["mesh.elements_per_contact_radius"] == 5
    assert math.isclose(case.replace({"contact.friction": "0.3"})["contact.friction"], 0.3)
