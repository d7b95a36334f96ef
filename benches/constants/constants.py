#!/usr/bin/env python3
"""What half and twice the value of a tuned constant does to runs: their iterations, their time, their results.

    python3 benches/constants/constants.py [NAME ...] [--list] [--runs] [--meshes] [--laws] [--depths]

The sources are copied to target/constants, and in the copy the constants are read from variables of their names; so one
program, built there in a few minutes, has every value of each. The contacts that a constant was tuned on are pressed and
sheared on a coarse mesh, one thread each. A row has Newton iterations, cut-backs, Krylov iterations, seconds of processor time,
and by how much F_N and F_T are then off from those of the constant as it is, in per cent of the largest of each; and a0 and
k_T0 in per cent.

The constants of the mesh change what its error is: with them F_N and F_T are held against the limit of a finer mesh, and a row
has the elements and the scaled Jacobian at the worst corner too.

The constants of a table or a law are not of runs: with them a table is made of the same simulated depths (a composed one of the
tables of both bodies), follows a path, and is held against the simulation of that path. Those that choose the depths of a table
have depths of their own simulated for each value. Standard library only.
"""

import argparse
import csv
import json
import math
import os
import re
import shutil
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PLACE = ROOT / "target/constants"
YIELD, FRICTION, NU = "material.hardening.yield_stress", "contact.friction", "material.poissons_ratio"
CONTACTS = {
    "reference": [],
    "soft": [f"{YIELD}=40.0", f"{FRICTION}=0.5"],
    "long steps": [f"{YIELD}=40.0", f"{FRICTION}=0.5", "solver.press_steps=4", "solver.shear_steps=3"],
    "deep": [f"{YIELD}=20.0", "solver.press_steps=8"],
    "unlike, long steps": [
        "opponent={material={youngs_modulus=600e3, poissons_ratio=0.3, hardening={law=\"ideal\", yield_stress=100.0}}}",
        "solver.press_steps=4", "solver.shear_steps=3"],
    "elastic": ["material.hardening={law=\"elastic\"}"],
    "nu 0.45": [f"{NU}=0.45"],
    "pair": ["opponent.equal=true"],
    "unlike": ["opponent={material={youngs_modulus=600e3, poissons_ratio=0.3, hardening={law=\"ideal\", yield_stress=400.0}}}"],
    "stick": [f"{FRICTION}=stick"],
    "held": ["path.1.hold=normal-force"],
    "rough": [f"{YIELD}=200.0", f"{FRICTION}=0.7"],
    "released": ["path=[{indentation=0.02}, {shear=0.003}, {release=true}]"],
    "released to half": ["path=[{indentation=0.02}, {release=0.5}]"],
    "full slip": ["path=[{indentation=0.02}, {shear=\"full-slip\"}]"],
    "scouted": ["solver.error_estimate=true"],
    "pair, turned": ["opponent.equal=true", "path=[{indentation=0.02}, {shear=[0.002, 0.0]}, {shear=[0.002, 0.002]}]"],
    # Along x so far that points pass the seam.
    "pair, far": ["opponent.equal=true", "path=[{indentation=0.02}, {shear=0.05}]"],
    "pair, far across": ["opponent.equal=true", "path=[{indentation=0.02}, {shear=[0.006, 0.004]}, {shear=[0.0, 0.008]}]"],
    "rigid sphere": ["opponent={rigid=true, radius=2.0}"],
    "free": ["sphere.equator=free", "material.hardening={law=\"elastic\"}",
             "path=[{indentation=0.1}, {shear=0.02}]"],
    "rolled": ["path=[{indentation=0.02}, {roll=0.3}]"],
    "free, plastic": ["sphere.equator=free", "path=[{indentation=0.05}, {shear=0.02}]"],
}
LINALG, CONTACT = "crates/kernels/src/linalg/", "crates/kernels/src/contact/"
# Of these what they have over 1 is halved and doubled.
OVER_ONE = {"RING_GROWTH", "LAYER_GROWTH", "CONTACT_MARGIN", "zone.MARGIN", "BLIND_MARGIN", "RATIO", "LENGTH", "build.NEAR"}
FOOTPRINT = (["src/simulation/footprint.rs"], ["reference", "soft", "elastic"])
# Files (the first has the constant), contacts. A name that several files have follows one of the file.
CONSTANTS = {
    "equator.NEAR": (["src/simulation/equator.rs"], ["free", "free, plastic"]),
    "REPEATS": (["src/simulation/equator.rs"], ["free", "free, plastic"]),
    "equator.TOLERANCE": (["src/solver/iterate/equator.rs"], ["free", "free, plastic"]),
    "RING": FOOTPRINT,
    "RIM": FOOTPRINT,
    "BAND": FOOTPRINT,
    "footprint.NEAR": FOOTPRINT,
    "FEWEST_POINTS": FOOTPRINT,
    "zone.MARGIN": (["src/simulation/zone.rs", "src/simulation/scout.rs"], ["reference", "soft"]),
    "BLIND_MARGIN": (["src/simulation/zone.rs", "src/simulation/follow.rs"], ["reference", "soft"]),
    "FORCING_GAMMA": (["src/solver/newton.rs"], ["reference", "soft"]),
    "KINK": (["src/solver/newton.rs"], ["soft", "stick", "released", "deep"]),
    "CONVERGING": (["src/solver/newton.rs"], ["soft", "stick", "released", "deep"]),
    "TIGHTEST_FIRST": (["src/solver/newton.rs"], ["reference", "soft", "unlike"]),
    "LAST_ITERATIONS": (["src/solver/newton.rs"], ["soft", "stick", "long steps"]),
    "FEW_ITERATIONS": (["src/solver/newton.rs"], ["soft", "stick", "long steps"]),
    "UNLOADED_SCALE": (["src/solver/newton.rs"], ["reference", "soft"]),
    "LOST_SHARE": (["src/solver/newton.rs"], ["released"]),
    "HELD_TOLERANCE": (["src/solver/newton.rs"], ["held"]),
    "HELD_AT_LAST": (["src/solver/newton.rs"], ["held"]),
    "CREEPING": (["src/solver/newton/line_search.rs"], ["soft", "stick", "rough", "deep"]),
    "DOWNHILL_MERIT": (["src/solver/newton/line_search.rs"], ["soft", "stick", "rough", "deep"]),
    "STALLED": (["src/solver/systems/tied.rs"], ["pair", "unlike", "unlike, long steps"]),
    "tied.RESTART": (["src/solver/systems/tied.rs"], ["unlike", "unlike, long steps"]),
    "tied.MAX_ITERATIONS": (["src/solver/systems/tied.rs"], ["unlike", "unlike, long steps"]),
    "solver.RESTART": ([LINALG + "solver.rs"], ["soft", "nu 0.45"]),
    "solver.MAX_ITERATIONS": ([LINALG + "solver.rs"], ["soft", "nu 0.45"]),
    "UNIT_RESPONSE": (["src/solver/iterate/linearise.rs", "src/solver/iterate/resident.rs"], ["held"]),
    "UNIT_MOTION": (["src/solver/iterate/stiffness.rs"], ["reference", "soft"]),
    "MOST_SYSTEMS": (["src/solver/iterate/stiffness.rs"], ["reference", "soft"]),
    "SETTLED": (["src/solver/iterate/stiffness.rs"], ["reference", "soft"]),
    "STIFFNESS_PROBE": (["src/simulation/drive/segments.rs"], ["reference", "soft"]),
    "SAME_TANGENT": (["src/compute/cpu.rs"], ["reference", "soft"]),
    "PRESS_EXTRAPOLATION": (["src/simulation/drive.rs"], ["reference", "soft", "pair"]),
    "EASY": (["src/simulation/drive.rs"], ["soft", "nu 0.45", "unlike", "long steps"]),
    "SLOW": (["src/simulation/drive.rs"], ["stick"]),
    "SHALLOW": (["src/simulation/drive.rs"], ["stick", "long steps"]),
    "FINEST": (["src/simulation/checkpoint.rs", "src/simulation/drive.rs"], ["long steps", "unlike, long steps"]),
    "PLATEAU": (["src/simulation/drive/segments.rs"], ["full slip"]),
    "LANDING": (["src/simulation/drive/segments.rs"], ["released to half"]),
    "STICK_SHARE": (["src/simulation/drive/segments.rs"], ["full slip"]),
    "SHEAR_RANGE": (["src/simulation/path.rs"], ["reference", "elastic"]),
    "LARGEST_SHEAR_STEP": (["src/simulation/path.rs"], ["reference", "rough"]),
    "FRICTION_LIMIT": (["src/simulation/path.rs"], ["reference", "rough"]),
    "GROWING_STEPS": (["src/simulation/path.rs"], ["reference", "elastic"]),
    "LARGEST_TURN": (["src/simulation/path.rs"], ["rolled"]),
    "MOST_LATER_STEPS": (["src/simulation/path.rs"], ["reference", "pair, far"]),
    "PRESS_STEPS": (["src/simulation/problem.rs"], ["reference", "elastic"]),
    "PRESS_STEPS_PER_ELEMENT": (["src/simulation/problem.rs"], ["reference", "elastic"]),
    "SHEAR_STEPS": (["src/simulation/problem.rs"], ["reference", "elastic"]),
    "NEARLY_INCOMPRESSIBLE": (["src/simulation/problem.rs"], ["reference", "nu 0.45"]),
    "UNLIKE_STIFFNESS": (["src/simulation/problem.rs"], ["unlike"]),
    "UNLIKE_PLASTIC": (["src/simulation/problem.rs"], ["unlike"]),
    "COUPLE_LINEAR": (["src/simulation/problem.rs"], ["unlike"]),
    "COUPLE_FIRST": (["src/simulation/problem.rs"], ["unlike"]),
    "ROOM": (["src/simulation/scout.rs"], ["scouted"]),
    "SHEAR_GROWTH": (["src/simulation/path.rs", "src/output/path_share.rs"], ["reference", "soft"]),
    "RELEASE_STEPS": (["src/simulation/path.rs", "src/study/shard.rs"], ["released", "released to half"]),
    "CONTACT_WEIGHT": ([CONTACT + "coulomb.rs", "src/compute/cpu.rs", "src/solver/opponent/joint.rs",
                        "src/solver/opponent/rigid.rs"], ["reference", "soft", "pair", "unlike", "rigid sphere"]),
    "DEGREE": ([LINALG + "multigrid.rs", LINALG + "layout.rs"], ["reference", "soft", "nu 0.45", "unlike"]),
    "LOW": ([LINALG + "chebyshev.rs", LINALG + "multigrid.rs", LINALG + "layout.rs"],
            ["reference", "soft", "nu 0.45", "unlike"]),
    "HIGH": ([LINALG + "chebyshev.rs", LINALG + "layout.rs"], ["reference", "soft", "nu 0.45", "unlike"]),
    "COARSEST_DEGREE": ([LINALG + "multigrid.rs", LINALG + "layout.rs"], ["reference", "soft", "nu 0.45"]),
    "COARSEST_LOW": ([LINALG + "multigrid.rs", LINALG + "layout.rs"], ["reference", "soft", "nu 0.45"]),
    "COVERED": ([CONTACT + "mortar.rs", CONTACT + "inversion.rs"], ["pair", "pair, turned", "unlike"]),
    "NARROW": ([CONTACT + "mortar.rs"], ["pair", "pair, far"]),
    "mortar.MARGIN": ([CONTACT + "mortar.rs"], ["pair", "pair, far"]),
    "OWN_IMAGE": ([CONTACT + "mortar.rs"], ["pair", "pair, far"]),
    "SEAM": ([CONTACT + "pair.rs"], ["pair", "pair, turned"]),
    "SEPARATION": ([CONTACT + "inversion.rs"], ["pair, turned", "pair, far across"]),
    "BEYOND": ([CONTACT + "inversion.rs"], ["pair, turned", "pair, far across"]),
    "WITHIN": ([CONTACT + "inversion.rs"], ["pair, turned", "pair, far across"]),
    "TILT": ([CONTACT + "inversion.rs"], ["pair, turned", "pair, far across"]),
    "THIN": ([CONTACT + "inversion.rs"], ["pair, turned", "pair, far across"]),
}
# Files, contacts.
MESH, ONES = "crates/kernels/src/mesh/", ["reference", "elastic"]
OF_MESHES = {name: ([MESH + file for file in files], ONES) for name, files in {
    "SHELL_DEPTH": ["sphere/layout.rs", "sphere/entry.rs"],
    "RING_GROWTH": ["sphere/layout.rs"],
    "LAYER_GROWTH": ["sphere/layout.rs"],
    "SPREAD": ["sphere/layout.rs"],
    "SQUARENESS": ["sphere/layout.rs"],
    "WALL_ANGLE": ["sphere/geometry.rs"],
    "RIM_INCLINATION": ["sphere/geometry.rs"],
    "WALL_INCLINATION": ["sphere/geometry.rs"],
    "START_LENGTH": ["sphere/geometry.rs"],
    "entry.ROUNDS": ["sphere/entry.rs"],
    "RELAXATION": ["sphere/entry.rs"],
    "REACH": ["sphere/entry.rs"],
    "FADING": ["sphere/entry.rs"],
    "TIE": ["sphere/entry.rs"],
    "CONTACT_MARGIN": ["sphere/mod.rs"],
    "LAYERS": ["sphere/skin.rs"],
    "COARSEST_NODES": ["hierarchy.rs"],
}.items()}
# What laws are held against: the bodies that are tabulated, the path. One body is the law, two are composed.
SOFT, EARLY, IDEAL, STRONGER, HARD = (
    "material.hardening={law=\"ideal\", yield_stress=%s}" % stress for stress in ("40.0", "330.0", "400.0", "800.0", "8000.0"))
POWER = "material.hardening={law=\"power\", yield_stress=100.0, coefficient=300.0, exponent=0.3}"
SHEARED = "path=[{indentation=0.009}, {shear=0.0025}]"
BODY = "{youngs_modulus=200e3, poissons_ratio=0.3, hardening={law=\"ideal\", yield_stress=%s}}"
LAWS = {
    "to and fro": ([[IDEAL]], ["path=[{indentation=0.01}, {shear=0.002}, {shear=-0.001}, {shear=0.002}, {release=0.5}]"]),
    "hardening": ([[POWER]], [POWER, "path=[{indentation=0.01}, {shear=0.002}, {shear=-0.001}, {shear=0.002}, {release=0.5}]"]),
    "oblique": ([[IDEAL]], ["path=[{indentation=0.01, shear=0.003}]"]),
    "composed": ([[IDEAL, "opponent.equal=true"], [STRONGER, "opponent.equal=true"]],
                 ["sphere.radius=2.0", SHEARED, "opponent={radius=2.0, material=" + BODY % "800.0" + "}"]),
    "weak on a flat": ([[IDEAL, "opponent.equal=true"], [STRONGER, "opponent.equal=true"]],
                       [SHEARED, "opponent={flat=true, material=" + BODY % "800.0" + "}"]),
    "weak flat": ([[STRONGER, "opponent.equal=true"], [IDEAL, "opponent.equal=true"]],
                  [STRONGER, SHEARED, "opponent={flat=true, material=" + BODY % "400.0" + "}"]),
}
OF_LAWS = {
    "AGAIN": (["src/law/table/build.rs"], ["to and fro", "hardening"]),
    "MOST_OF_THE_WAY": (["src/law/table/build.rs"], ["to and fro", "hardening"]),
    "LENGTH": (["src/law/table/build.rs", "src/law/table/series.rs"], ["between", "far slip"]),
    "build.NEAR": (["src/law/table/build.rs"], ["at first yield"]),
    "SLOPE_FROM": (["src/law/table/tabulated.rs"], ["to and fro", "hardening"]),
    "SLIDING": (["src/law/table/measure.rs"], ["oblique"]),
    "measure.FEWEST": (["src/law/table/measure.rs"], ["oblique"]),
    "RIPPLE": (["src/law/table/measure.rs"], ["oblique"]),
    "NOTHING": (["src/law/table/measure.rs"], ["oblique"]),
    "RISING": (["src/law/table/body.rs"], ["composed", "weak on a flat", "weak flat"]),
    "CONSTRAINT": (["src/law/table/body.rs"], ["composed", "weak on a flat", "weak flat"]),
    "LEAST": (["src/law/table/body.rs"], ["weak on a flat", "weak flat"]),
    "MOST_CREEP": (["src/law/table/series.rs"], ["composed", "weak on a flat", "weak flat"]),
    "NO_CREEP": (["src/law/table/series.rs"], ["composed", "weak on a flat", "weak flat"]),
}
# The same, with a path of the body that says how deep its table is.
TO_AND_FRO = "path=[{indentation=%s}, {shear=%s}, {shear=%s}]"
UP_TO = "path=[{indentation=%s}]"
OF_DEPTHS = {
    "between": ([[IDEAL, UP_TO % "0.02"]], [TO_AND_FRO % ("0.0062", "0.0015", "-0.0004")]),
    "far slip": ([[IDEAL, UP_TO % "0.02"]], [TO_AND_FRO % ("0.01", "0.005", "0.002")]),
    "shallow, soft": ([[SOFT, UP_TO % "0.002"]], [SOFT, TO_AND_FRO % ("0.000014", "0.000001", "-0.0000003")]),
    "at first yield": ([[EARLY, UP_TO % "0.0002"]], [EARLY, TO_AND_FRO % ("0.000017", "0.000008", "-0.000003")]),
    "shallow, hard": ([[HARD, UP_TO % "0.03"]], [HARD, TO_AND_FRO % ("0.0007", "0.0003", "-0.0001")]),
    "short range": ([[HARD, UP_TO % "0.006"]], [HARD, TO_AND_FRO % ("0.0004", "0.0002", "-0.0001")]),
}
BUILD = "src/law/table/build.rs"
CHOOSING_DEPTHS = {
    "RATIO": ([BUILD], ["between"]),
    "build.FEWEST": ([BUILD], ["short range"]),
    "SPAN": ([BUILD], ["short range"]),
    "SHALLOWEST": ([BUILD], ["shallow, soft"]),
    "HALF_SPACE": ([BUILD], ["shallow, hard"]),
}
ELEMENTS = 5
RUNNER = '''use asperity::law::table::{Tabulated, build, compose, depths, study_text};
use asperity::law::LawFile;
use asperity::session::{DeviceChoice, PrecisionChoice};
use asperity::study::{Options as StudyOptions, Study, StudyProgress};
use asperity::{Case, Earlier, Options, Simulation};
use std::path::{Path, PathBuf};
use std::sync::Arc;

type Answer<T> = Result<T, Box<dyn std::error::Error>>;

/// Simulates a case.
fn simulate(case: &Case, out: &Path) -> Answer<()> {
    let threads = std::num::NonZeroUsize::new(1);
    let options = Options { out: Some(out.into()), earlier: Earlier::Replace, threads, ..Options::default() };
    Simulation::with(case, options)?.run()?;
    Ok(())
}

/// Elements of the mesh of a case, and the scaled Jacobian at the worst corner.
fn mesh(case: &Case, out: &Path) -> Answer<()> {
    let problem = asperity::internals::simulation::problem::Problem::new(case)?;
    let mesh = &problem.model.mesh;
    let quality = |e| asperity::internals::mesh::quality::scaled_jacobian(&mesh.corners(e));
    let worst = (0..mesh.elements.len()).map(quality).fold(1.0, f64::min);
    Ok(std::fs::write(out, format!("{}, {worst:.2}", mesh.elements.len()))?)
}

/// Simulates the depths of a body's table.
fn study(case: &Case, dir: &Path, elements: usize) -> Answer<()> {
    let study = Study::parse(&study_text(case, elements, &depths(case)?), "table")?;
    let (device, precision) = (DeviceChoice::Cpu, PrecisionChoice::Auto);
    let options = StudyOptions { device, precision, threads: 1, shard: None, resume: false, retry: false, force: true };
    asperity::study::run(&study, dir, &options, Arc::new(StudyProgress::new(true)), Arc::default())?;
    Ok(std::fs::write(dir.with_extension("toml"), case.to_toml())?)
}

/// The law of these tables along the path of the case.
fn law(case: &Case, out: &Path, elements: usize, dirs: &[PathBuf]) -> Answer<()> {
    let table = |dir: &PathBuf| -> Answer<Tabulated> {
        Ok(build(dir, &Case::load(&dir.with_extension("toml"), &[])?, elements)?.table)
    };
    let tables: Vec<Tabulated> = dirs.iter().map(table).collect::<Answer<_>>()?;
    let one = match &tables[..] {
        [sphere, opponent] => compose(case, [sphere, opponent])?,
        _ => tables[0].clone(),
    };
    let mut text = String::from("h,delta_T,F_N,F_T\\n");
    for point in LawFile::Table(Box::new(one)).follow(case)?.0 {
        text += &format!("{},{},{},{}\\n", point.h, point.delta_t, point.f_n, point.f_t);
    }
    Ok(std::fs::write(out, text)?)
}

fn main() -> Answer<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [what, case, out, elements, dirs] = [0, 1, 2, 3, 4].map(|i| arguments[i].as_str());
    let (case, out) = (Case::load(Path::new(case), &arguments[5..])?, Path::new(out));
    let elements = elements.parse()?;
    match what {
        "run" => simulate(&case, out),
        "mesh" => mesh(&case, out),
        "study" => study(&case, out, elements),
        _ => law(&case, out, elements, &dirs.split(',').map(PathBuf::from).collect::<Vec<_>>()),
    }
}
'''
MANIFEST = '''[package]
name = "constants"
version = "0.0.0"
edition = "2024"

[dependencies]
asperity = { path = "../source", default-features = false, features = ["law"] }

[profile.release]
debug = false

[workspace]
'''


def copied():
    """The sources, in a place of their own; what has not changed keeps its time."""
    names = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True).stdout.split("\n")
    for name in filter(None, names):
        source, to = ROOT / name, PLACE / "source" / name
        if source.is_file() and (not to.exists() or to.read_bytes() != source.read_bytes()):
            to.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(source, to)
    runner = PLACE / "runner"
    (runner / "src").mkdir(parents=True, exist_ok=True)
    (runner / "Cargo.toml").write_text(MANIFEST)
    (runner / "src/main.rs").write_text(RUNNER)
    if not (runner / "Cargo.lock").exists():
        shutil.copyfile(ROOT / "Cargo.lock", runner / "Cargo.lock")


def variable(key):
    """Of the environment."""
    return key.replace(".", "_")


def given_from_outside(key, files):
    """Makes a constant of the copy one that is read from the variable of its name; its value, as it is written."""
    name = key.split(".")[-1]
    for i, file in enumerate(files):
        path = PLACE / "source" / file
        lines = path.read_text().split("\n")
        for k, line in enumerate(lines):
            if line.lstrip().startswith(("//", "use ")):
                continue
            found = re.match(rf"(.*)const {name}: (\w+) = ([^;]+);$", line)
            if found:
                before, kind, value = found.groups()
                lines[k] = (f"{before}static {name}: std::sync::LazyLock<{kind}> = std::sync::LazyLock::new(|| "
                            f'std::env::var("{variable(key)}").map_or({value}, |given| given.parse().unwrap()));')
            else:
                lines[k] = re.sub(rf"\b{name}\b", f"(*{name})", line)
        path.write_text("\n".join(lines))
    return kind, value


def built():
    """The program of the copied sources."""
    command = ["cargo", "build", "--release", "--quiet", "--target-dir", PLACE / "build"]
    ended = subprocess.run(command, cwd=PLACE / "runner", capture_output=True, text=True)
    if ended.returncode:
        raise SystemExit(ended.stderr)
    return PLACE / "build/release/constants"


def halved_and_doubled(key, kind, value):
    number = eval(value.replace("_", ""))
    if key in OVER_ONE:
        return [1.0 + by * (number - 1.0) for by in (0.5, 2.0)]
    if 0.9 <= number < 1.0:
        # A share of nearly all: what is missing of it.
        return [1.0 - 2.0 * (1.0 - number), 1.0 - 0.5 * (1.0 - number)]
    return [max(1, round(number * by)) if kind in ("usize", "u32") else number * by for by in (0.5, 2.0)]


FINER = (8, 16)
COARSE = ["mesh.elements_per_contact_radius=4", "mesh.surface_elements_per_contact_radius=8", "output.plots=false",
          "output.fields=none"]


def called(program, what, out, settings, given=(), dirs=()):
    """Calls the program."""
    arguments = [program, what, ROOT / "fixtures/cases/ideal.toml", out, str(ELEMENTS), ",".join(map(str, dirs)), *settings]
    return subprocess.run(arguments, env=os.environ | {"RAYON_NUM_THREADS": "1"} | dict(given), capture_output=True, text=True)


def read(file, of=""):
    """h, delta_T along x and y, F_N, F_T along x and y; without what lies in y it is none."""
    columns = ("h", "delta_T", "delta_T_y", f"F_N{of}", f"F_T{of}", f"F_T_y{of}")
    with file.open() as opened:
        return [(0.0,) * 6, *(tuple(float(row.get(column) or 0.0) for column in columns) for row in csv.DictReader(opened))]


def run(program, contact, given, more=()):
    """What a run took, and its history."""
    settings = CONTACTS[contact]
    path = [] if any(setting.startswith("path=") for setting in settings) else ["path.1.shear=0.003"]
    out = PLACE / "run"
    shutil.rmtree(out, ignore_errors=True)
    ended = called(program, "run", out, [*COARSE, "solver.error_estimate=false", *path, *settings, *more], given)
    try:
        return json.loads((out / "summary.json").read_text()), read(out / "history.csv")
    except FileNotFoundError:
        raise SystemExit(f"{contact}: {ended.stderr}") from None


def simulated(program, name, given=()):
    """The depths of a law's bodies, and the path that it is held against; made once."""
    bodies, settings = (LAWS | OF_DEPTHS)[name]
    place = PLACE / "laws"
    dirs = []
    for body in bodies:
        words = [*body, *(f"{variable}={value}" for variable, value in dict(given).items())]
        dirs.append(place / re.sub(r"\W+", "-", " ".join(words)).strip("-"))
        if not dirs[-1].with_suffix(".toml").exists():
            ended = called(program, "study", dirs[-1], body, given)
            if ended.returncode:
                raise SystemExit(f"{name}: {ended.stderr}")
    out = place / re.sub(r"\W+", "-", name)
    if not (out / "summary.json").exists():
        ended = called(program, "run", out, [*COARSE, *settings])
        if ended.returncode:
            raise SystemExit(f"{name}: {ended.stderr}")
    # In the limit of fine meshes, as the tables are.
    return dirs, read(out / "history.csv", "_limit")


def followed(program, name, dirs, given):
    """The law along the path; the words with which it is refused."""
    out = PLACE / "laws/followed.csv"
    ended = called(program, "law", out, (LAWS | OF_DEPTHS)[name][1], given, dirs)
    return ended.stderr.strip() if ended.returncode else read(out)


def off(rows, reference, of=max):
    """Largest difference from a curve over the way of the plate, in per cent of its largest F_N and F_T; or their mean."""
    def way(rows):
        length, before, ways = 0.0, rows[0], []
        for row in rows:
            length += abs(row[0] - before[0]) + math.hypot(row[1] - before[1], row[2] - before[2])
            ways.append(length)
            before = row
        return ways

    def at(ways, s):
        for i in range(1, len(ways)):
            if s <= ways[i]:
                span = ways[i] - ways[i - 1]
                share = 1.0 if span == 0.0 else (s - ways[i - 1]) / span
                return [a + (b - a) * share for a, b in zip(rows[i - 1], rows[i])]
        return rows[-1]

    ways = way(rows)
    # What only turns is at one place; steps that are the same need none between them.
    same = [row[:3] for row in rows] == [row[:3] for row in reference]
    pairs = list(zip(reference, rows)) if same else [(row, at(ways, s)) for s, row in zip(way(reference), reference)]
    normal = max(abs(row[3]) for row in reference)
    largest = max(math.hypot(row[4], row[5]) for row in reference)
    # Without a shear F_T is rounding.
    tangential = largest if largest > 1e-3 * normal else normal
    return [100 * of([abs(a[3] - b[3]) for a, b in pairs]) / normal,
            100 * of([math.hypot(a[4] - b[4], a[5] - b[5]) for a, b in pairs]) / tangential]


def mean_square(values):
    return math.sqrt(sum(value * value for value in values) / len(values))


def numbers(distances):
    return ", ".join("-" if x is None else f"{x:.2g}" if abs(x) > 1e-9 else "0" for x in distances)


def apart(summary, other):
    """a0 and k_T0 against others, in per cent."""
    pairs = [(summary.get(key), other.get(key)) for key in ("a0", "k_T0")]
    return [100 * abs(ours / theirs - 1) if ours and theirs else None for ours, theirs in pairs]


def cost(contact, summary):
    counts = ", ".join(str(summary[key]) for key in ("newton_iterations", "cutbacks", "krylov_iterations"))
    status = "" if summary["status"] == "done" else f" ({summary['status']})"
    return f"{contact}{status} | {counts} | {summary['cpu_s']:.1f}"


def told(contact, summary, rows, reference):
    other, others = reference
    distance = "" if rows is others else numbers([*off(rows, others), *apart(summary, other)])
    return f"{cost(contact, summary)} | {distance}"


def runs(program, values, names):
    reference = {}
    heads = ["constant", "value", "contact", "Newton, cut-backs, Krylov", "CPU s", "F_N, F_T, a0, k_T0 off by, %"]
    print(f"| {' | '.join(heads)} |\n|{'---|' * len(heads)}", flush=True)
    for name in names:
        for contact in CONSTANTS[name][1]:
            if contact not in reference:
                reference[contact] = run(program, contact, {})
            summary, rows = reference[contact]
            print(f"| `{name}` | {values[name][1]} | {told(contact, summary, rows, reference[contact])} |", flush=True)
            for value in halved_and_doubled(name, *values[name]):
                there = run(program, contact, {variable(name): repr(value)})
                print(f"| | {value:g} | {told(contact, *there, reference[contact])} |", flush=True)


def meshes(program, values, names):
    """Of many steps, so that what is between them does not count."""
    heads = ["constant", "value", "contact", "Newton, cut-backs, Krylov", "CPU s", "elements, worst corner",
             "F_N, F_T off the limit by, % rms; a0, k_T0 off the finer mesh by, %"]
    print(f"| {' | '.join(heads)} |\n|{'---|' * len(heads)}", flush=True)
    steps = ["solver.press_steps=40", "solver.shear_steps=30"]
    finer = [f"mesh.elements_per_contact_radius={FINER[0]}", f"mesh.surface_elements_per_contact_radius={FINER[1]}",
             "solver.error_estimate=true"]
    reference, out = {}, PLACE / "mesh"
    for name in names:
        for contact in OF_MESHES[name][1]:
            if contact not in reference:
                summary = run(program, contact, {}, [*steps, *finer])[0]
                reference[contact] = summary, read(PLACE / "run/history.csv", "_limit")
            other, others = reference[contact]
            kept, halved, doubled = None, *halved_and_doubled(name, *values[name])
            for value in (kept, halved, doubled):
                given = {} if value is kept else {variable(name): repr(value)}
                ended = called(program, "mesh", out, [*COARSE, *CONTACTS[contact]], given)
                head = f"| `{name}` | {values[name][1]}" if value is kept else f"| | {value:g}"
                if ended.returncode:
                    print(f"{head} | {contact} | {ended.stderr.strip().splitlines()[0]} | | | |", flush=True)
                    continue
                summary, rows = run(program, contact, given, steps)
                distance = numbers([*off(rows, others, mean_square), *apart(summary, other)])
                print(f"{head} | {cost(contact, summary)} | {out.read_text()} | {distance} |", flush=True)


def laws(program, values, names):
    heads = ["constant", "value", "law", "F_N, F_T off the simulation by, % rms", "off the law as it is by, % rms"]
    print(f"| {' | '.join(heads)} |\n|{'---|' * len(heads)}", flush=True)
    for name in names:
        for law in OF_LAWS[name][1]:
            dirs, path = simulated(program, law)
            rows = followed(program, law, dirs, {})
            print(f"| `{name}` | {values[name][1]} | {law} | {distance(rows, path)} | |", flush=True)
            for value in halved_and_doubled(name, *values[name]):
                there = followed(program, law, dirs, {variable(name): repr(value)})
                print(f"| | {value:g} | {law} | {distance(there, path)} | {distance(there, rows)} |", flush=True)


def distance(rows, others):
    return rows if isinstance(rows, str) else numbers(off(rows, others, mean_square))


def depths(program, values, names):
    heads = ["constant", "value", "law", "simulations", "F_N, F_T off the simulation by, % rms"]
    print(f"| {' | '.join(heads)} |\n|{'---|' * len(heads)}", flush=True)
    for name in names:
        for law in CHOOSING_DEPTHS[name][1]:
            for value in (None, *halved_and_doubled(name, *values[name])):
                given = {} if value is None else {variable(name): repr(value)}
                dirs, path = simulated(program, law, given)
                count = len((dirs[0] / "study.csv").read_text().splitlines()) - 1
                head = f"| `{name}` | {values[name][1]}" if value is None else f"| | {value:g}"
                print(f"{head} | {law} | {count} | {distance(followed(program, law, dirs, given), path)} |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", help="constants; by default all")
    parser.add_argument("--list", action="store_true", help="the constants, and nothing else")
    kinds = {"runs": (runs, CONSTANTS), "meshes": (meshes, OF_MESHES), "laws": (laws, OF_LAWS),
             "depths": (depths, CHOOSING_DEPTHS)}
    for kind in kinds:
        parser.add_argument(f"--{kind}", action="store_true", help=f"those of {kind}; by default all kinds")
    options = parser.parse_args()
    everything = CONSTANTS | OF_MESHES | OF_LAWS | CHOOSING_DEPTHS
    if options.list:
        return print("\n".join(f"{name:20} {files[0]}" for name, (files, _) in everything.items()))
    copied()
    values = {name: given_from_outside(name, files) for name, (files, _) in everything.items()}
    program = built()
    wanted = options.names or everything
    asked = [kind for kind in kinds if getattr(options, kind)] or kinds
    for table, of in map(kinds.get, asked):
        names = [name for name in wanted if name in of]
        if names:
            table(program, values, names)


if __name__ == "__main__":
    main()
