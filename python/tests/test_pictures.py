"""Pictures, what notebooks show, and the program of the package."""

import pathlib
import signal
import subprocess
import sys
import time

import asperity
import pytest

CASE = """
[sphere]
radius = 1.0
[material]
youngs_modulus = 200e3
poissons_ratio = 0.3
[material.hardening]
law = "ideal"
yield_stress = 400.0
[contact]
friction = 0.3
[mesh]
elements_per_contact_radius = 4
[solver]
press_steps = 4
shear_steps = 4
error_estimate = false
[units]
length = "mm"
force = "N"
[[path]]
indentation = 0.02
[[path]]
shear = 0.001
"""
PROGRAM = pathlib.Path(sys.executable).parent / "asperity"


@pytest.fixture(scope="module")
def run():
    return asperity.run(CASE, device="cpu", progress=False)


def test_a_run_gives_the_pictures_of_the_program(run, tmp_path):
    picture = run.plot()
    assert picture.name == "forces" and picture.svg.startswith("<svg") and "(mm)" in picture.svg
    assert picture._repr_svg_() == picture.svg and picture.caption in repr(picture)
    title = "Forces during the shear"
    assert title in picture.svg and title not in run.plot("forces", title=False).svg
    for ending, head in (("svg", b"<svg"), ("pdf", b"%PDF"), ("png", b"\x89PNG")):
        run.plot("indentation", width="85mm").save(tmp_path / f"h.{ending}")
        assert (tmp_path / f"h.{ending}").read_bytes().startswith(head)
    assert run.plot(law=asperity.Law.built_in()).name == "law"
    with pytest.raises(asperity.CaseError, match='name: is "force".*"forces"'):
        run.plot("force")
    with pytest.raises(asperity.CaseError, match="width: is"):
        run.plot(width="wide")
    with pytest.raises(asperity.CaseError, match=".svg, .pdf or .png"):
        run.plot().save(tmp_path / "picture.bmp")
    with pytest.raises(asperity.CaseError, match="law: is"):
        run.plot(law="built-in")
    with pytest.raises(asperity.CaseError, match="law: is"):
        run.plot(law=run.case)
    # It is the picture that `asperity plot` draws.
    subprocess.run([PROGRAM, "plot", run.directory], check=True, stdout=subprocess.DEVNULL)
    assert (run.directory / "plots/forces.svg").read_text(encoding="utf-8") == picture.svg


def test_a_law_gives_pictures_of_what_it_predicts():
    law = asperity.Law.built_in()
    assert [law.plot(CASE).name, law.plot(CASE, "ratio").name, law.plot(CASE, "indentation").name] == ["forces", "ratio", "indentation"]
    assert law.plot(asperity.Case.parse(CASE).replace({"path.1.shear": 0.0005})).svg != law.plot(CASE).svg
    with pytest.raises(asperity.CaseError, match='"stick".*"forces"'):
        law.plot(CASE, "stick")


def test_notebooks_show_results(run):
    shown = run._repr_html_()
    assert "<td>F_N0</td>" in shown and "<svg" in shown
    assert "<th>delta_T</th>" in run.history._repr_html_()
    assert run.case._repr_html_().startswith("<pre>") and "youngs_modulus" in run.case._repr_html_()
    assert "contacts of" in asperity.Law.built_in()._repr_html_()
    assert "<td>&lt;b&gt;</td>" in asperity.Table({"words": ["<b>"]})._repr_html_()
    assert asperity.Table({"n": range(100)})._repr_html_().count("<tr>") == 22


def test_axes_of_matplotlib_are_named_as_the_pictures_are(run):
    pytest.importorskip("matplotlib").use("agg")
    axes = run.plot_forces()
    assert axes.get_xlabel().endswith(" (mm)") and axes.get_ylabel() == "force (N)"
    assert [line.get_color() for line in axes.lines] == ["#d55e00", "#0072b2"]


def test_a_case_tells_all_its_mistakes_at_once():
    wrong = asperity.Case.parse(CASE).to_dict()
    wrong["contact"]["friction"] = -1.0
    wrong["material"]["poissons_ratio"] = 0.7
    text = CASE.replace("friction = 0.3", "friction = -1").replace("poissons_ratio = 0.3", "poissons_ratio = 0.7")
    for make in (lambda: asperity.Case.from_dict(wrong), lambda: asperity.Case.parse(text)):
        with pytest.raises(asperity.CaseError) as caught:
            make()
        assert "contact.friction" in str(caught.value) and "material.poissons_ratio" in str(caught.value)


def test_messages_are_in_the_words_of_python(run, tmp_path):
    (tmp_path / "mine.txt").write_text("mine", encoding="utf-8")
    with pytest.raises(asperity.AsperityError) as caught:
        asperity.run(CASE, tmp_path, device="cpu", progress=False)
    assert "--" not in str(caught.value) and str(caught.value).startswith("out ")
    named = tmp_path / "q--force"
    named.mkdir()
    (named / "mine.txt").write_text("mine", encoding="utf-8")
    with pytest.raises(asperity.AsperityError, match="q--force"):
        asperity.run(CASE, named, device="cpu", progress=False)
    with pytest.raises(asperity.CaseError) as caught:
        asperity.Case.parse(CASE, set={"contact.friction": -2})
    assert "--set" not in str(caught.value)


def test_the_program_is_there(tmp_path):
    (tmp_path / "case.toml").write_text(CASE, encoding="utf-8")
    call = lambda *arguments: subprocess.run([PROGRAM, *arguments], cwd=tmp_path, capture_output=True, text=True)
    assert call("--version").stdout == f"asperity {asperity.__version__}\n"
    assert call("check", "no-such.toml").returncode == 2
    done = call("run", "case.toml", "--device", "cpu")
    assert done.returncode == 0 and "F_N0" in done.stdout and (tmp_path / "case/history.csv").exists()
    # Slurm's tasks call the program as it was called.
    study = '[base.sphere]\nradius = 1.0\n[base.material]\nyoungs_modulus = 1.0\npoissons_ratio = 0.3\n[base.material.hardening]\nlaw = "elastic"\n'
    study += "[base.contact]\nfriction = 0.3\n[[base.path]]\nindentation = 0.01\n[grid]\n\"contact.friction\" = [0.1, 0.2]\n"
    (tmp_path / "study.toml").write_text(study, encoding="utf-8")
    assert call("study", "study.toml", "--out", "jobs", "--slurm").returncode == 0
    assert any(str(PROGRAM) in script.read_text(encoding="utf-8") for script in (tmp_path / "jobs/slurm").iterdir())


def test_ctrl_c_ends_the_program_after_its_step(tmp_path):
    long = CASE.replace("press_steps = 4", "press_steps = 2000").replace("elements_per_contact_radius = 4", "elements_per_contact_radius = 6")
    (tmp_path / "case.toml").write_text(long, encoding="utf-8")
    child = subprocess.Popen([PROGRAM, "run", "case.toml", "--device", "cpu", "-q"], cwd=tmp_path, stderr=subprocess.PIPE, restore_signals=True)
    deadline = time.monotonic() + 60
    while not (tmp_path / "case/history.csv").exists() and time.monotonic() < deadline:
        time.sleep(0.05)
    time.sleep(0.5)
    ignored = signal.getsignal(signal.SIGINT) is signal.SIG_IGN
    child.send_signal(signal.SIGTERM if ignored else signal.SIGINT)
    message = child.communicate(timeout=60)[1].decode()
    assert child.returncode == 75 and "--resume" in message, message
