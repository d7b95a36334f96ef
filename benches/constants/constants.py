#!/usr/bin/env python3
"""What half and twice the value of a tuned constant does to runs: their iterations, their time, their results.

    python3 benches/constants/constants.py [NAME ...] [--list]

The sources are copied to target/constants, and in the copy the constants are read from variables of their names; so one program,
built there in a few minutes, has every value of each. The contacts that a constant was tuned on are pressed and sheared on a
coarse mesh, one thread each. A row has Newton iterations, cut-backs, Krylov iterations, seconds of processor time, and by how much
F_N and F_T are then off from those of the constant as it is, in per cent of the largest of each. Standard library only.
"""

import argparse
import csv
import json
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
    "unlike, long steps": ["opponent={material={youngs_modulus=600e3, poissons_ratio=0.3, hardening={law=\"ideal\", yield_stress=100.0}}}",
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
    "free": ["sphere.equator=free", "material.hardening={law=\"elastic\"}",
             "path=[{indentation=0.1}, {shear=0.02}]"],
    "free, plastic": ["sphere.equator=free", "path=[{indentation=0.05}, {shear=0.02}]"],
}
# Files (the first has the constant), contacts.
CONSTANTS = {
    "NEAR": (["src/simulation/equator.rs"], ["free", "free, plastic"]),
    "REPEATS": (["src/simulation/equator.rs"], ["free", "free, plastic"]),
    "FORCING_GAMMA": (["src/solver/newton.rs"], ["reference", "soft"]),
    "KINK": (["src/solver/newton.rs"], ["soft", "stick", "released", "deep"]),
    "CONVERGING": (["src/solver/newton.rs"], ["soft", "stick", "released", "deep"]),
    "HELD_TOLERANCE": (["src/solver/newton.rs"], ["held"]),
    "CREEPING": (["src/solver/newton/line_search.rs"], ["soft", "stick", "rough", "deep"]),
    "DOWNHILL_MERIT": (["src/solver/newton/line_search.rs"], ["soft", "stick", "rough", "deep"]),
    "STALLED": (["src/solver/systems/tied.rs"], ["pair", "unlike", "unlike, long steps"]),
    "UNIT_RESPONSE": (["src/solver/iterate/linearise.rs", "src/solver/iterate/resident.rs"], ["held"]),
    "UNIT_MOTION": (["src/solver/iterate/stiffness.rs"], ["reference", "soft"]),
    "SAME_TANGENT": (["src/compute/cpu.rs"], ["reference", "soft"]),
    "PRESS_EXTRAPOLATION": (["src/simulation/drive.rs"], ["reference", "soft", "pair"]),
    "EASY": (["src/simulation/drive.rs"], ["soft", "nu 0.45", "unlike", "long steps"]),
    "SLOW": (["src/simulation/drive.rs"], ["stick"]),
    "LANDING": (["src/simulation/drive/segments.rs"], ["released to half"]),
    "STICK_SHARE": (["src/simulation/drive/segments.rs"], ["full slip"]),
    "SHEAR_RANGE": (["src/simulation/path.rs"], ["reference", "elastic"]),
    "LARGEST_SHEAR_STEP": (["src/simulation/path.rs"], ["reference", "rough"]),
    "PRESS_STEPS": (["src/simulation/problem.rs"], ["reference", "elastic"]),
    "SHEAR_STEPS": (["src/simulation/problem.rs"], ["reference", "elastic"]),
    "COUPLE_LINEAR": (["src/simulation/problem.rs"], ["unlike"]),
    "COUPLE_FIRST": (["src/simulation/problem.rs"], ["unlike"]),
    "ROOM": (["src/simulation/scout.rs"], ["scouted"]),
}
RUNNER = '''use asperity::{Case, Earlier, Options, Simulation};
use std::path::{Path, PathBuf};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let case = Case::load(Path::new(&arguments[0]), &arguments[2..])?;
    let out = Some(PathBuf::from(&arguments[1]));
    let options = Options { out, earlier: Earlier::Replace, threads: std::num::NonZeroUsize::new(1), ..Options::default() };
    Simulation::with(&case, options)?.run()?;
    Ok(())
}
'''
MANIFEST = '''[package]
name = "constants"
version = "0.0.0"
edition = "2024"

[dependencies]
asperity = { path = "../source", default-features = false }

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


def given_from_outside(name, files):
    """Makes a constant of the copy one that is read from the variable of its name; its value, as it is written."""
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
                            f'std::env::var("{name}").map_or({value}, |given| given.parse().unwrap()));')
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


def halved_and_doubled(kind, value):
    number = eval(value.replace("_", ""))
    return [max(1, round(number * by)) if kind in ("usize", "u32") else number * by for by in (0.5, 2.0)]


def run(program, contact, given):
    """What a run took, and its history."""
    mesh = ["mesh.elements_per_contact_radius=4", "mesh.surface_elements_per_contact_radius=8", "solver.error_estimate=false",
            "output.plots=false", "output.fields=none"]
    settings = CONTACTS[contact]
    path = [] if any(setting.startswith("path=") for setting in settings) else ["path.1.shear=0.003"]
    out = PLACE / "run"
    shutil.rmtree(out, ignore_errors=True)
    ended = subprocess.run([program, ROOT / "fixtures/cases/ideal.toml", out, *mesh, *path, *settings], env=os.environ | given,
                           capture_output=True, text=True)
    try:
        summary = json.loads((out / "summary.json").read_text())
        with (out / "history.csv").open() as file:
            rows = [tuple(float(row[column]) for column in ("h", "delta_T", "F_N", "F_T")) for row in csv.DictReader(file)]
        rows.insert(0, (0.0, 0.0, 0.0, 0.0))
    except FileNotFoundError:
        raise SystemExit(f"{contact}: {ended.stderr}") from None
    return summary, rows


def off(rows, reference):
    """Largest difference from a curve over the way of the plate, in per cent of its largest F_N and F_T."""
    def way(rows):
        length, before, ways = 0.0, rows[0], []
        for row in rows:
            length += abs(row[0] - before[0]) + abs(row[1] - before[1])
            ways.append(length)
            before = row
        return ways

    def at(ways, values, s):
        for i in range(1, len(ways)):
            if s <= ways[i]:
                span = ways[i] - ways[i - 1]
                return values[i] if span == 0.0 else values[i - 1] + (values[i] - values[i - 1]) * (s - ways[i - 1]) / span
        return values[-1]

    own, theirs, worst = way(rows), way(reference), []
    normal = max(abs(row[2]) for row in reference)
    for column in (2, 3):
        values, found = ([row[column] for row in rows] for rows in (reference, rows))
        largest = max(map(abs, values))
        # Without a shear F_T is rounding.
        scale = largest if largest > 1e-3 * normal else normal
        worst.append(100 * max(abs(value - at(own, found, s)) for s, value in zip(theirs, values)) / scale)
    return worst


def told(contact, summary, rows, reference):
    counts = ", ".join(str(summary[key]) for key in ("newton_iterations", "cutbacks", "krylov_iterations"))
    status = "" if summary["status"] == "done" else f" ({summary['status']})"
    distance = "" if rows is reference else ", ".join(f"{x:.2g}" if x > 1e-9 else "0" for x in off(rows, reference))
    return f"{contact}{status} | {counts} | {summary['cpu_s']:.1f} | {distance}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", help="constants; by default all")
    parser.add_argument("--list", action="store_true", help="the constants, and nothing else")
    options = parser.parse_args()
    if options.list:
        return print("\n".join(f"{name:20} {files[0]}" for name, (files, _) in CONSTANTS.items()))
    copied()
    values = {name: given_from_outside(name, files) for name, (files, _) in CONSTANTS.items()}
    program = built()
    reference = {}
    heads = ["constant", "value", "contact", "Newton, cut-backs, Krylov", "CPU s", "F_N, F_T off by, %"]
    print(f"| {' | '.join(heads)} |\n|{'---|' * len(heads)}", flush=True)
    for name in options.names or CONSTANTS:
        for contact in CONSTANTS[name][1]:
            if contact not in reference:
                reference[contact] = run(program, contact, {})
            summary, rows = reference[contact]
            print(f"| `{name}` | {values[name][1]} | {told(contact, summary, rows, rows)} |", flush=True)
            for value in halved_and_doubled(*values[name]):
                print(f"| | {value:g} | {told(contact, *run(program, contact, {name: repr(value)}), rows)} |", flush=True)


if __name__ == "__main__":
    main()
