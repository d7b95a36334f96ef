#!/usr/bin/env python3
"""Newton iterations of runs that are easy and hard for the solver, for one program or several beside each other.

    cargo build --release && python3 benches/newton/iterations.py OUT [--programs A,B] [--cases soft,flat] [--meshes 5/10,5/20]

Each contact is pressed and sheared to 0.003 R on each mesh (elements inside / at the surface), one thread a run. The table has,
for each program, Newton iterations, Krylov iterations and seconds of processor time; the last row is the sum of the seconds.
To try another value of a constant of `src/solver`, build the program with it, copy the file, and give both. What is in OUT is
computed again. Ten minutes for two programs. Standard library only.
"""

import argparse
import json
import os
import subprocess
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BASE = [ROOT / "fixtures/cases/ideal.toml"]
YIELD, FRICTION, NU = "material.hardening.yield_stress", "contact.friction", "material.poissons_ratio"
CASES = {
    "reference": [],
    "hard": [f"{YIELD}=3300.0", f"{FRICTION}=0.1"],
    "soft": [f"{YIELD}=40.0", f"{FRICTION}=0.5"],
    "rough": [f"{YIELD}=200.0", f"{FRICTION}=0.7"],
    "nu 0.45": [f"{NU}=0.45"],
    "pair": ["opponent.equal=true"],
    "unlike": ["opponent.radius=2.0"],
    "stick": [f"{FRICTION}=stick"],
    "held": ["path.1.hold=normal-force"],
    "oblique": [f"{YIELD}=200.0", f"{FRICTION}=0.6", "path=[{indentation=0.02, shear=0.02}]"],
}


def run(program, out, settings, mesh):
    """Newton and Krylov iterations and seconds of a run, or how it ended."""
    inside, surface = mesh.split("/")
    fixed = [f"mesh.elements_per_contact_radius={inside}", f"mesh.surface_elements_per_contact_radius={surface}",
             "solver.error_estimate=false", "output.plots=false"]
    path = [] if any(setting.startswith("path=") for setting in settings) else ["path.1.shear=0.003"]
    sets = [word for setting in path + settings + fixed for word in ("--set", setting)]
    command = [program, "run", *BASE, "--out", out, "--force", "--quiet", "--device", "cpu", "--threads", "1", *sets]
    ended = subprocess.run(command, capture_output=True, text=True)
    if ended.returncode:
        return None, f"exit {ended.returncode}"
    summary = json.loads((out / "summary.json").read_text())
    seconds = summary["cpu_s"]
    return seconds, f"{summary['newton_iterations']}, {summary['krylov_iterations']}, {seconds:.1f}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path)
    parser.add_argument("--programs", default=str(ROOT / "target/release/asperity"))
    parser.add_argument("--cases", default=",".join(CASES))
    parser.add_argument("--meshes", default="5/10,5/20")
    options = parser.parse_args()
    programs, meshes, names = (text.split(",") for text in (options.programs, options.meshes, options.cases))
    jobs = [(name, mesh, program) for name in names for mesh in meshes for program in programs]

    def one(job):
        name, mesh, program = job
        place = options.out / f"{name}-{mesh}-{programs.index(program)}".replace("/", "-").replace(" ", "-")
        return run(program, place, CASES[name], mesh)

    options.out.mkdir(parents=True, exist_ok=True)
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        results = list(pool.map(one, jobs))
    print(f"| contact | mesh | {' | '.join(Path(program).name for program in programs)} |\n|{'---|' * (len(programs) + 2)}")
    for at in range(0, len(jobs), len(programs)):
        name, mesh, _ = jobs[at]
        print(f"| {name} | {mesh} | {' | '.join(told for _, told in results[at:at + len(programs)])} |")
    sums = [sum(seconds or 0.0 for seconds, _ in results[i::len(programs)]) for i in range(len(programs))]
    print(f"| sum, s | | {' | '.join(f'{seconds:.1f}' for seconds in sums)} |")


if __name__ == "__main__":
    main()
