"""Copies, pickles, other processes and threads, and the end of the interpreter."""

from __future__ import annotations

import copy
import gc
import multiprocessing
import os
import pickle
import shutil
import signal
import subprocess
import sys
import textwrap
import threading
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import ROOT

import asperity

PROTOCOLS = range(pickle.HIGHEST_PROTOCOL + 1)
METHODS = [method for method in ("fork", "spawn", "forkserver") if method in multiprocessing.get_all_start_methods()]
forks = pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork on this system")


def child(code: str, *arguments: object, limit: float = 60.0) -> subprocess.CompletedProcess[str]:
    """A Python of its own, which must end by itself."""
    return subprocess.run([sys.executable, "-c", textwrap.dedent(code), *map(str, arguments)], capture_output=True, text=True, timeout=limit)


def kept(thing: Any) -> list[Any]:
    """The thing pickled by every protocol, and copied."""
    return [pickle.loads(pickle.dumps(thing, protocol)) for protocol in PROTOCOLS] + [copy.copy(thing), copy.deepcopy(thing)]


def moved(law: asperity.Law, state: asperity.Contacts) -> dict[str, np.ndarray]:
    return dict(law.update(state, np.linspace(0.001, 0.02, len(state)), (2e-4, -1e-4)))


def same(one: Any, other: Any) -> bool:
    return list(one) == list(other) and all(np.array_equal(one[name], other[name], equal_nan=one[name].dtype.kind == "f") for name in one)


@pytest.mark.parametrize("file", sorted((ROOT / "fixtures/cases").glob("*.toml")), ids=lambda file: file.stem)
def test_a_case_comes_back_as_it_was(file: Path) -> None:
    case = asperity.Case.load(file)
    for again in kept(case):
        assert again == case and again.to_toml() == case.to_toml() and again.to_dict() == case.to_dict() and hash(again) == hash(case)


@pytest.mark.parametrize("name", ["formulas", "built_in", "table"])
def test_a_law_comes_back_bit_by_bit(name: str, table: asperity.Law, case: asperity.Case) -> None:
    law = {"formulas": asperity.Law.wear_2014(), "built_in": asperity.Law.built_in(), "table": table}[name]
    curve = law.predict(case)
    equal = asperity.Case.parse(case.to_toml() + "[opponent]\nequal = true\n")
    between = law.predict(equal) if name == "built_in" else None
    for again in kept(law):
        # With the law of equal spheres that the built-in one has beside it.
        assert between is None or same(again.predict(equal), between)
        assert same(again.predict(case), curve) and again.to_dict() == law.to_dict() and repr(again) == repr(law)


def test_contacts_come_back_bit_by_bit_and_go_their_own_way(table: asperity.Law, case: asperity.Case) -> None:
    for law in (table, asperity.Law.wear_2014(), asperity.Law.built_in()):
        state = law.contacts(case, 7)
        moved(law, state)
        before, copies = state.array, [*kept(state), state.copy()]
        after = moved(law, state)
        for again in copies:
            assert np.array_equal(again.array, before)
            assert same(moved(law, again), after) and np.array_equal(again.array, state.array)
    assert len(pickle.loads(pickle.dumps(table.contacts(case, 0)))) == 0
    kind, (cls, parameters, memory) = table.contacts(case, 2).__reduce__()
    for wrong in [(parameters[:-1], memory), (parameters, memory[:, 1:]), (parameters * np.nan, memory)]:
        with pytest.raises(asperity.AsperityError, match="keeps them otherwise"):
            kind(cls, *wrong)


def test_results_come_back_without_their_directory(case: asperity.Case, tmp_path: Path) -> None:
    run = asperity.run(case.replace({"path.1.shear": 0.001}), out=tmp_path / "run")
    history, summary = run.history, run.summary
    pickles = [pickle.dumps(run, protocol) for protocol in PROTOCOLS]
    copies = [copy.copy(run), copy.deepcopy(run)]
    assert all(pickle.loads(kept).contact().rows == run.contact().rows for kept in pickles)
    (tmp_path / "run").rename(tmp_path / "elsewhere")
    for again in [*map(pickle.loads, pickles), *copies]:
        assert again.case == run.case and again.summary == summary and same(again.history, history)
        for ask in (again.contact, again.fields, lambda again=again: again.mesh):
            with pytest.raises(asperity.AsperityError, match="is gone"):
                ask()


def test_a_study_comes_back_without_its_directory(study: asperity.Study, tmp_path: Path) -> None:
    assert all(same(again.table, study.table) and again[0].summary == study[0].summary for again in kept(study))
    shutil.copytree(study.directory, tmp_path / "study")
    again = pickle.loads(pickle.dumps(asperity.Study.load(tmp_path / "study")))
    shutil.rmtree(tmp_path / "study")
    assert same(again.table, study.table)
    with pytest.raises(asperity.AsperityError, match="is gone"):
        again[0]


def test_a_copy_keeps_a_temporary_directory(case: asperity.Case) -> None:
    run = asperity.run(case.replace({"path.1.shear": 0.001}))
    place, copies = run.directory, [copy.copy(run), copy.deepcopy(run)]
    del run
    gc.collect()
    assert copies.pop().contact().rows and copies.pop().contact().rows
    gc.collect()
    assert not place.exists()


def test_tables_fields_and_errors_come_back(done: asperity.Run, case: asperity.Case) -> None:
    for again in kept(done.history):
        assert same(again, done.history)
    fields = done.fields()
    for again in kept(fields):
        assert np.array_equal(again.points, fields.points) and same(again.cell_data, fields.cell_data)
    with pytest.raises(asperity.NotConverged) as error:
        asperity.run(case.replace({"solver.max_iterations": 1, "solver.max_cutbacks": 0}))
    for again in kept(error.value):
        assert str(again) == str(error.value) and again.run.summary["status"] == "not-converged"
    for again in kept(asperity.Interrupted("interrupted", run=done)):
        assert str(again) == "interrupted" and again.run.summary == done.summary and again.study is None


def work(given: tuple[asperity.Law, asperity.Contacts, asperity.Case]) -> tuple[Any, ...]:
    """In a worker: what has threads of its own, each kind once."""
    law, state, case = given
    run = asperity.run(case)
    study = asperity.study(case, {"contact.friction": [0.1, 0.3]}, threads=2)
    return dict(law.update(state, 0.01, (1e-4, 0.0))), state, run, study, law.table(case).predict(case)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.filterwarnings("ignore:.*multi-threaded.*fork.*:DeprecationWarning")
def test_workers_compute_after_the_parent_has(method: str, case: asperity.Case) -> None:
    small = case.replace({"path.1.shear": 0.001, "output.plots": False})
    law = asperity.Law.built_in()
    state = law.contacts(small, 1000)
    law.update(state, 0.005, (0.0, 0.0))
    here = asperity.run(small)
    with multiprocessing.get_context(method).Pool(2) as pool:
        answers = pool.map_async(work, [(law, state, small)] * 2).get(90)
    forces = law.update(state, 0.01, (1e-4, 0.0))
    for there, their_state, run, study, curve in answers:
        assert same(there, forces) and np.array_equal(their_state.array, state.array)
        assert same(run.history, here.history) and list(study.table["status"]) == ["done", "done"]
        assert same(curve, law.predict(small))


@pytest.mark.filterwarnings("ignore:.*multi-threaded.*fork.*:DeprecationWarning")
@pytest.mark.parametrize("method", METHODS)
def test_the_functions_themselves_go_to_workers(method: str, case: asperity.Case) -> None:
    hopeless = case.replace({"solver.max_iterations": 1, "solver.max_cutbacks": 0})
    with multiprocessing.get_context(method).Pool(1) as pool:
        with pytest.raises(asperity.NotConverged) as error:
            pool.apply_async(asperity.run, (hopeless,)).get(60)
        assert error.value.run.summary["status"] == "not-converged"
        assert pool.apply_async(asperity.run, (case.replace({"path.1.shear": 0.001}),)).get(60).summary["status"] == "done"


FORKED = """
import asperity, os, signal, sys, threading
case, out = asperity.Case.load(sys.argv[1]), sys.argv[2]
law = asperity.Law.wear_2014()
state = law.contacts(case, 100_000)
law.update(state, 0.01, (0.0, 0.0))
asperity.run(case)
going = threading.Event()
def computing():
    while not going.is_set():
        law.update(state, 0.01, (1e-4, 0.0))
thread = threading.Thread(target=computing)
thread.start()
for attempt in range(20):
    child = os.fork()
    if child == 0:
        signal.alarm(20)
        law.update(law.contacts(case, 1000), 0.01, (0.0, 0.0))
        # Moved by a thread of the parent, which is not here: free, or refused.
        try:
            law.update(state, 0.01, (0.0, 0.0))
        except asperity.AsperityError as error:
            assert "another thread" in str(error)
        if attempt == 0:
            asperity.run(case, out=out)
        os._exit(0)
    assert os.waitpid(child, 0)[1] == 0, attempt
going.set()
thread.join()
assert asperity.Run.load(out).summary["status"] == "done"
"""


@forks
def test_a_fork_while_threads_compute_is_free_of_them(case: asperity.Case, tmp_path: Path) -> None:
    file = tmp_path / "case.toml"
    file.write_text(case.replace({"path.1.shear": 0.001}).to_toml())
    ended = child(FORKED, file, tmp_path / "out", limit=120)
    assert ended.returncode == 0, ended.stderr


@forks
def test_a_child_of_fork_does_not_take_the_results_away(case: asperity.Case) -> None:
    code = """
    import asperity, os, sys
    run = asperity.run(asperity.Case.parse(sys.argv[1]))
    child = os.fork()
    if child == 0:
        sys.exit(0)
    assert os.waitpid(child, 0)[1] == 0
    assert run.contact().rows
    place = run.directory
    del run
    assert not place.exists()
    """
    ended = child(code, case.replace({"path.1.shear": 0.001}).to_toml())
    assert ended.returncode == 0, ended.stderr


@forks
def test_a_fork_from_the_progress_of_a_run_ends_in_the_child(case: asperity.Case) -> None:
    code = """
    import asperity, os, signal, sys
    children = []
    def fork(share, step, text):
        if not children:
            children.append(os.fork())
            if children[0] == 0:
                signal.alarm(20)
    try:
        run = asperity.run(asperity.Case.parse(sys.argv[1]), progress=fork)
    except asperity.AsperityError as error:
        os._exit(7 if children == [0] and "forked" in str(error) else 1)
    assert os.waitpid(children[0], 0)[1] == 7 << 8 and run.summary["status"] == "done"
    """
    ended = child(code, case.replace({"path.1.shear": 0.001}).to_toml())
    assert ended.returncode == 0, ended.stderr


LEFT = """
import asperity, sys, threading, time
case, what = asperity.Case.parse(sys.argv[1]), sys.argv[2]
law = asperity.Law.wear_2014()
begun = threading.Event()
def compute():
    if what == "run":
        asperity.run(case, out=sys.argv[3], progress=lambda *news: begun.set())
    elif what == "study":
        begun.set()
        asperity.study(case, {"contact.friction": [0.1, 0.2, 0.3]}, out=sys.argv[3])
    elif what == "check":
        begun.set()
        asperity.Law.built_in().check(case, 6)
    state = law.contacts(case, 20_000)
    while True:
        law.update(state, 0.01, (1e-4, 0.0))
        begun.set()
threading.Thread(target=compute, daemon=True).start()
begun.wait()
time.sleep(float(sys.argv[4]))
"""


@pytest.mark.parametrize("what", ["run", "study", "check", "update"])
def test_the_interpreter_closes_while_a_thread_computes(what: str, case: asperity.Case, tmp_path: Path) -> None:
    for attempt in range(3 if what == "update" else 1):
        ended = child(LEFT, case.to_toml(), what, tmp_path / "out", 0.05 + 0.013 * attempt)
        assert (ended.returncode, ended.stderr) == (0, "")
    if what == "run":
        # As after a run that was killed.
        assert asperity.run(case, out=tmp_path / "out", resume=True).summary["status"] == "done"


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
def test_ctrl_c_reaches_the_main_thread_and_a_run_beside_it_goes_on(case: asperity.Case, tmp_path: Path) -> None:
    code = """
    import asperity, sys, threading, time
    case, runs = asperity.Case.parse(sys.argv[1]), []
    thread = threading.Thread(target=lambda: runs.append(asperity.run(case, out=sys.argv[2], progress=lambda *news: print("step", flush=True))))
    thread.start()
    try:
        while not runs:
            time.sleep(0.05)
    except KeyboardInterrupt:
        print("interrupted", flush=True)
    while not runs:
        time.sleep(0.05)
    print(runs[0].summary["status"])
    """
    running = subprocess.Popen([sys.executable, "-c", textwrap.dedent(code), case.to_toml(), tmp_path / "out"], stdout=subprocess.PIPE, text=True)
    assert running.stdout is not None and running.stdout.readline() == "step\n"
    running.send_signal(signal.SIGINT)
    said = running.stdout.read().split()
    assert running.wait(60) == 0 and "interrupted" in said and said[-1] == "done"


def test_a_run_in_a_thread_is_ended_by_its_progress(case: asperity.Case, tmp_path: Path) -> None:
    raised: list[BaseException] = []

    def stop(share: float, step: int, text: str) -> None:
        raise KeyboardInterrupt

    def compute() -> None:
        try:
            asperity.run(case, out=tmp_path / "out", progress=stop)
        except BaseException as error:
            raised.append(error)

    thread = threading.Thread(target=compute)
    thread.start()
    thread.join(60)
    assert isinstance(raised[0], asperity.Interrupted) and raised[0].run.summary["status"] == "interrupted"


def test_contacts_are_moved_by_one_thread_at_a_time(case: asperity.Case) -> None:
    law = asperity.Law.wear_2014()
    state, told, answers = law.contacts(case, 300_000), [], []
    law.update(state, 0.01, (0.0, 0.0))
    barrier = threading.Barrier(2)

    def move() -> None:
        barrier.wait()
        for _ in range(3):
            try:
                answers.append(law.update(state, 0.01, (1e-4, 0.0)))
            except asperity.AsperityError as error:
                told.append(str(error))

    threads = [threading.Thread(target=move) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert answers and told and all("another thread is moving these contacts" in text for text in told)
    alone = law.contacts(case, 1)
    law.update(alone, 0.01, (0.0, 0.0))
    for _ in answers:
        law.update(alone, 0.01, (1e-4, 0.0))
    assert (state.array == alone.array).all()


def test_a_subinterpreter_is_refused(tmp_path: Path) -> None:
    code = """
    try:
        import _xxsubinterpreters as interpreters
    except ImportError:
        import _interpreters as interpreters
    import asperity
    inner = interpreters.create()
    text = "import sys\\ntry:\\n    import asperity\\nexcept ImportError as error:\\n    print('refused', error, flush=True)\\n"
    try:
        print(interpreters.run_string(inner, text))
    except Exception as error:
        print("refused", error)
    law = asperity.Law.wear_2014()
    """
    ended = child(code)
    assert ended.returncode == 0 and "refused" in ended.stdout, ended.stdout + ended.stderr


LIMITED = """
import resource, sys
import asperity
case, law = asperity.Case.load(sys.argv[1]), asperity.Law.wear_2014()
law.update(law.contacts(case, 1000), 0.01, (0.0, 0.0))
def refused(call, *arguments):
    try:
        call(*arguments)
    except MemoryError as error:
        return str(error)
    raise AssertionError(call)
for number in (10**12, 10**15, 2**62):
    assert f"{number} contacts need" in refused(law.contacts, case, number)
used = int(open("/proc/self/statm").read().split()[0]) * resource.getpagesize()
number = 1_000_000
each = law.contacts(case, 1).array.nbytes
# Room for the contacts and half a copy: neither copy, array nor answer (88 bytes a contact) fits.
resource.setrlimit(resource.RLIMIT_AS, (used + number * (each + 60), -1))
state = law.contacts(case, number)
for call in (state.copy, lambda: state.array, lambda: law.update(state, 0.01, (0.0, 0.0))):
    refused(call)
resource.setrlimit(resource.RLIMIT_AS, (-1, -1))
assert (state.array == 0.0).all()
law.update(state, 0.01, (0.0, 0.0))
"""


@pytest.mark.skipif(sys.platform != "linux", reason="a limit of memory")
def test_memory_that_is_not_there_is_a_memory_error() -> None:
    ended = child(LIMITED, ROOT / "fixtures/cases/ideal.toml")
    assert ended.returncode == 0, ended.stderr
