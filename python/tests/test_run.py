from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest
from conftest import COARSE, IDEAL, ROOT

import asperity


def program() -> Path:
    """The program of this repository: what ASPERITY_PROGRAM names, or the one that was built last."""
    named = os.environ.get("ASPERITY_PROGRAM")
    built = [Path(named)] if named else [ROOT / f"target/{profile}/asperity" for profile in ("release", "debug")]
    found = [path for path in built if path.is_file()]
    if not found:
        missing = "the program is not built: cargo build, or ASPERITY_PROGRAM=PATH"
        pytest.fail(missing) if os.environ.get("ASPERITY_REQUIRE_PYTHON") == "1" else pytest.skip(missing)
    return max(found, key=lambda path: path.stat().st_mtime)


def test_history_and_summary(done: asperity.Run) -> None:
    history = done.history
    assert list(history)[:6] == ["step", "segment", "h", "delta_T", "F_N", "F_T"]
    assert history["step"].dtype == np.int64 and history.F_N.dtype == np.float64
    assert (history["step"] == np.arange(1, history.rows + 1)).all()
    assert history.rows == done.summary["steps"] and done.summary["status"] == "done"
    assert 130.0 < done.summary["F_N0"] < 155.0
    with pytest.raises(KeyError, match="there are step"):
        history["F_X"]


def test_contact_adds_up_to_the_forces(done: asperity.Run) -> None:
    contact = done.contact()
    assert contact["point"].dtype == np.int64 and set(contact["status"]) <= {"open", "stick", "slip"}
    for column, force, sign in [("pressure", "F_N", 1.0), ("traction_x", "F_T", -1.0)]:
        total = sign * (contact[column] * contact["area"]).sum()
        assert total == pytest.approx(done.history[force][-1], rel=1e-10)
    assert done.contact(done.contact_steps[0])["traction_x"].max() > 0.0
    with pytest.raises(asperity.AsperityError, match="has no contact table of step 999"):
        done.contact(999)


def test_fields_are_on_the_mesh(done: asperity.Run) -> None:
    fields = done.fields()
    assert fields.points.shape[1] == 3 and fields.cells.shape == (done.summary["elements"], 8)
    assert fields["displacement"].shape == fields.points.shape and fields["stress"].shape == (len(fields.cells), 6)
    assert fields["mises"].max() == pytest.approx(400.0, rel=0.02)
    assert fields["contact_status"].dtype == np.int32 and set(fields["contact_status"]) <= {0, 1, 2}
    assert done.mesh.points[:, 2].min() == pytest.approx(0.0, abs=1e-12)
    with pytest.raises(KeyError, match="there are displacement"):
        fields["strain"]


def test_bits_and_files_are_the_programs(case: asperity.Case, tmp_path: Path) -> None:
    binary = program()
    theirs, ours = tmp_path / "theirs", tmp_path / "ours"
    arguments = [f"--set={key}={str(value).lower()}" for key, value in COARSE.items()]
    subprocess.run([binary, "run", IDEAL, "--out", theirs, "-q", "--device", "cpu", *arguments], check=True)
    run = asperity.run(case, out=ours, device="cpu", threads=1)
    assert (ours / "history.csv").read_bytes() == (theirs / "history.csv").read_bytes()
    names = lambda of: sorted(str(path.relative_to(of)) for path in of.rglob("*") if path.is_file())
    # The program keeps a log of what it said besides.
    assert names(ours) == [name for name in names(theirs) if name != "run.log"]
    for name in names(ours):
        # These two have times.
        if name not in ("summary.json", "checkpoint.bin"):
            assert (ours / name).read_bytes() == (theirs / name).read_bytes(), name
    other = asperity.Run.load(theirs)
    assert all(np.array_equal(other.history[name], run.history[name], equal_nan=True) for name in run.history)
    assert other.case == run.case


def test_an_earlier_result_is_neither_lost_nor_computed_twice(done: asperity.Run, tmp_path: Path) -> None:
    out = tmp_path / "out"
    shutil.copytree(done.directory, out)
    with pytest.raises(asperity.AsperityError, match="holds a run that is done, of this very case"):
        asperity.run(done.case, out=out)
    before = (out / "summary.json").stat().st_mtime_ns
    assert asperity.run(done.case, out=out, resume=True).history.rows == done.history.rows
    assert (out / "summary.json").stat().st_mtime_ns == before
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine/thesis.tex").write_text("mine")
    with pytest.raises(asperity.AsperityError, match='holds "thesis.tex", and is not an Asperity result'):
        asperity.run(done.case, out=tmp_path / "mine")
    with pytest.raises(asperity.AsperityError, match="is not a result of an Asperity run"):
        asperity.Run.load(tmp_path / "mine")


def test_a_finished_run_goes_on_along_a_longer_path(done: asperity.Run, tmp_path: Path) -> None:
    out = tmp_path / "out"
    shutil.copytree(done.directory, out)
    longer = done.case.replace({"path": [*done.case["path"], {"release": 0.5}]})
    run = asperity.run(longer, out=out, extend=True)
    assert run.case == longer and run.history.rows > done.history.rows
    assert (run.history["F_N"][: done.history.rows] == done.history["F_N"]).all()
    with pytest.raises(asperity.AsperityError, match="cannot be extended"):
        asperity.run(done.case, out=out, extend=True)


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ({"device": "tpu"}, 'device: is "tpu"'),
        ({"precision": "f16"}, 'precision: is "f16"'),
        ({"threads": 0}, "threads: is 0"),
        ({"resume": True, "force": True}, "force: stands beside resume"),
        ({"resume": True, "extend": True}, "extend: stands beside resume"),
    ],
)
def test_arguments_are_checked(case: asperity.Case, arguments: dict, text: str) -> None:
    with pytest.raises(asperity.CaseError, match=text):
        asperity.run(case, **arguments)


def test_progress_is_told_and_may_end_the_run(case: asperity.Case, tmp_path: Path) -> None:
    told: list[tuple[float, int, str]] = []
    run = asperity.run(case, progress=lambda *news: told.append(news))
    steps, shares = [step for share, step, _ in told if share >= 0.0], [share for share, _, _ in told if share >= 0.0]
    assert steps == list(run.history["step"])
    # Where full slip will be is not known before.
    assert shares == sorted(shares) and 0.5 < shares[-1] <= 1.0

    def enough(share: float, step: int, text: str) -> None:
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        asperity.run(case, out=tmp_path / "out", progress=enough)
    left = asperity.Run.load(tmp_path / "out")
    assert left.summary["status"] == "interrupted"
    assert left.history.rows < run.history.rows


def test_the_bar_is_a_line_that_is_written_over(case: asperity.Case, capfd: pytest.CaptureFixture[str]) -> None:
    asperity.run(case, progress=False)
    assert capfd.readouterr().out == ""
    run = asperity.run(case, progress=True)
    said = capfd.readouterr().err
    lines = [line for line in said.split("\r") if line.startswith("[")]
    assert len(lines) == run.history.rows and "step 1 " in lines[0] and said.endswith("\n")


def test_a_run_that_does_not_converge_is_an_exception_with_the_results(case: asperity.Case) -> None:
    hopeless = case.replace({"solver.max_iterations": 1, "solver.max_cutbacks": 0})
    with pytest.raises(asperity.NotConverged, match="no convergence: step 1 of segment 0") as error:
        asperity.run(hopeless)
    assert error.value.run.summary["status"] == "not-converged"


INTERRUPTED = """
import asperity, sys
try:
    asperity.run(sys.argv[1], out=sys.argv[2], progress=lambda share, step, text: print(step, flush=True))
except asperity.Interrupted as interrupted:
    assert isinstance(interrupted, KeyboardInterrupt)
    print("kept", interrupted.run.history.rows, flush=True)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
def test_ctrl_c_keeps_what_there_is_and_the_run_goes_on(case: asperity.Case, done: asperity.Run, tmp_path: Path) -> None:
    file, out = tmp_path / "case.toml", tmp_path / "out"
    file.write_text(case.to_toml())
    child = subprocess.Popen([sys.executable, "-c", INTERRUPTED, file, out], stdout=subprocess.PIPE, text=True)
    assert child.stdout is not None
    # Notes come before the first step.
    while int(child.stdout.readline()) == 0:
        pass
    child.send_signal(signal.SIGINT)
    last = child.stdout.read().split("\n")[-2]
    assert child.wait(60) == 0 and last.startswith("kept ")
    rows = int(last.split()[1])
    assert 0 < rows < done.history.rows and (out / "checkpoint.bin").is_file()
    run = asperity.run(case, out=out, resume=True)
    assert all(np.array_equal(run.history[name], done.history[name], equal_nan=True) for name in done.history)


def test_other_threads_go_on_meanwhile(case: asperity.Case) -> None:
    counted, over = 0, threading.Event()

    def count() -> None:
        nonlocal counted
        while not over.is_set():
            counted += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    begun = time.monotonic()
    asperity.run(case, threads=1)
    took = time.monotonic() - begun
    over.set()
    thread.join()
    # Were the interpreter held, it would be a few.
    assert counted > 20 * took


def test_optional_packages_are_asked_for_by_name(done: asperity.Run, monkeypatch: pytest.MonkeyPatch) -> None:
    for module in ["pandas", "pyarrow", "matplotlib", "matplotlib.pyplot", "pyvista", "meshio"]:
        monkeypatch.setitem(sys.modules, module, None)
    for use, package in [
        (done.history.to_pandas, "pandas"),
        (done.history.to_arrow, "pyarrow"),
        (done.plot_forces, "matplotlib"),
        (done.fields().to_pyvista, "pyvista"),
        (done.mesh.to_meshio, "meshio"),
    ]:
        with pytest.raises(asperity.MissingPackage, match=f"`pip install {package}`"):
            use()


def test_plots(done: asperity.Run) -> None:
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    forces = done.plot_forces()
    assert [line.get_label().split(", ")[1] for line in forces.get_lines()] == ["tangential", "normal"]
    assert forces.get_lines()[0].get_xdata()[0] == 0.0
    assert done.plot_press().get_xlabel() == "$h$"
    assert done.plot_pressure().get_aspect() == 1.0


def test_pandas(done: asperity.Run) -> None:
    pytest.importorskip("pandas")
    frame = done.history.to_pandas()
    assert list(frame.columns) == list(done.history) and (frame["F_N"] == done.history["F_N"]).all()


def test_meshio(done: asperity.Run) -> None:
    meshio = pytest.importorskip("meshio")
    fields = done.fields()
    theirs = meshio.read(done.directory / f"fields/step_{done.field_steps[-1]:04}.vtu")
    assert (theirs.points == fields.points).all() and (theirs.cells[0].data == fields.cells).all()
    assert all((theirs.point_data[name].reshape(fields[name].shape) == fields[name]).all() for name in fields.point_data)
    assert all((theirs.cell_data[name][0].reshape(fields[name].shape) == fields[name]).all() for name in fields.cell_data)
    assert fields.to_meshio().cells[0].type == "hexahedron"
