#!/usr/bin/env python3
"""How far F_T and F_N of runs are from the limit of fine meshes and short steps, and how often their own errors cover it.

    cargo build --release && python3 benches/limits/measure.py OUT [--meshes 8,12,8/16] [--reference 16] [--cases 14] [--program PATH]

Fourteen contacts, pressed and sheared to full slip, on the given meshes and on the reference mesh, of which the columns
F_T_limit and F_N_limit are taken for the truth. A mesh is given by its elements along the contact radius, 8/16 has 16 at
the surface and 8 inside. Rows count from a tenth of the greatest indentation on; errors are in
per cent of the greatest F_N and F_T. What was computed before is taken from OUT. Ten minutes of processor time.
Standard library only.
"""

import argparse
import csv
import json
import math
import statistics
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
LAW = "material.hardening="
SIGMA, MU, H, NU = "material.hardening.yield_stress", "contact.friction", "path.0.indentation", "material.poissons_ratio"
CASES = {
    "ideal 400, mu 0.3, h 0.02": [],
    "power 300 + 1000 alpha^0.4, mu 0.4, h 0.02": [
        LAW + '{law="power",yield_stress=300.0,coefficient=1000.0,exponent=0.4}', f"{MU}=0.4"],
    "linear 300 + 5000 alpha, mu 0.3, h 0.01": [LAW + '{law="linear",yield_stress=300.0,modulus=5000.0}', f"{H}=0.01"],
    "ideal 400, mu 0.8, h 0.02": [f"{MU}=0.8"],
    "ideal 400, mu 0.2, h 0.05": [f"{MU}=0.2", f"{H}=0.05"],
    "ideal 400, mu 0.3, h 0.005": [f"{H}=0.005"],
    "ideal 1600, mu 0.2, h 0.01": [f"{SIGMA}=1600.0", f"{MU}=0.2", f"{H}=0.01"],
    "Hollomon 1000 eps^(1/5), nu 0, mu 0.3, h 0.01": [
        LAW + '{law="hollomon",coefficient=1000.0,exponent=5.0}', f"{H}=0.01", f"{NU}=0.0"],
    "Voce 250 to 600, nu 0.45, mu 0.5, h 0.03": [
        LAW + '{law="voce",yield_stress=250.0,saturation_stress=600.0,rate=20.0}', f"{MU}=0.5", f"{H}=0.03", f"{NU}=0.45"],
    "ideal 800, nu 0, mu 0.6, h 0.005": [f"{SIGMA}=800.0", f"{MU}=0.6", f"{H}=0.005", f"{NU}=0.0"],
    "elastic, mu 0.3, h 0.005": [LAW + '{law="elastic"}', f"{H}=0.005"],
    "linear 400 + 20000 alpha, mu 0.6, h 0.05": [
        LAW + '{law="linear",yield_stress=400.0,modulus=20000.0}', f"{MU}=0.6", f"{H}=0.05"],
    "ideal 400, nu 0.45, mu 0.6, h 0.01": [f"{NU}=0.45", f"{MU}=0.6", f"{H}=0.01"],
    "ideal 100, mu 0.3, h 0.02": [f"{SIGMA}=100.0"],
}


def run(program, out, settings, most=None):
    """The rows of a run, computed unless they are there."""
    if not (out / "summary.json").exists() or json.loads((out / "summary.json").read_text())["status"] != "done":
        common = ["output.plots=false", 'output.fields="none"', "output.keep_checkpoint=false"]
        sets = [word for setting in [*settings, *common] for word in ("--set", setting)]
        case = ROOT / "fixtures/cases/ideal.toml"
        subprocess.run([program, "run", case, "--out", out, "--force", "-q", "--threads", "1", *sets], check=True, timeout=most)
    with (out / "history.csv").open() as file:
        rows = [{key: float(value) if value else None for key, value in row.items()} for row in csv.DictReader(file)]
    return rows, json.loads((out / "summary.json").read_text())["cpu_s"]


def mesh(name):
    """The settings of a mesh by its name, 8 or 8/16."""
    keys = ["mesh.elements_per_contact_radius", "mesh.surface_elements_per_contact_radius"]
    return [f"{key}={elements}" for key, elements in zip(keys, name.split("/"))]


def curve(rows, segment, name):
    """Points of a column over h or delta_T, from the start of the segment on."""
    place = "delta_T" if segment else "h"
    before = [row for row in rows if row["segment"] < segment][-1:]
    start = [(0.0, 0.0 if name.startswith("F_T") or not before else before[-1][name])]
    return start + [(row[place], row[name]) for row in rows if row["segment"] == segment and row[name] is not None]


def at(points, x):
    """The parabola through the three points around x; None beyond the end."""
    if x > points[-1][0] * (1 + 1e-9):
        return None
    i = min(max(next((k for k, point in enumerate(points) if point[0] >= x), len(points) - 1), 1), len(points) - 2)
    (a, fa), (b, fb), (c, fc) = points[i - 1:i + 2]
    return (fa * (x - b) * (x - c) / ((a - b) * (a - c)) + fb * (x - a) * (x - c) / ((b - a) * (b - c))
            + fc * (x - a) * (x - b) / ((c - a) * (c - b)))


def missing(rows, reference):
    """Of F_N and of F_T: what is missing of the curve and of its limit, and the run's own error, in per cent."""
    h0, found = rows[-1]["h"], {"F_N": [], "F_T": []}
    for name in found:
        scale = max(row[name] for row in rows) / 100
        curves = [curve(reference, segment, f"{name}_limit") for segment in (0, 1)]
        for row in rows:
            segment = int(row["segment"])
            if row["h"] < 0.1 * h0 or row[f"{name}_error"] is None or row[f"{name}_limit"] is None or (name, segment) == ("F_T", 0):
                continue
            truth = at(curves[segment], row["delta_T"] if segment else row["h"])
            if truth is not None:
                values = row[name] - truth, row[f"{name}_limit"] - truth, row[f"{name}_error"]
                found[name].append([value / scale for value in values])
    return found


def cell(values):
    return f"{math.sqrt(statistics.fmean(x * x for x in values)):.2f} / {max(map(abs, values)):.2f}"


def cover(all_rows):
    """Share of the rows whose error is covered, and the median of estimate over error."""
    covered = sum(abs(raw) <= error for raw, _, error in all_rows)
    return f"{covered} of {len(all_rows)}", statistics.median(error / max(abs(raw), 1e-9) for raw, _, error in all_rows)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("out", type=Path)
    parser.add_argument("--meshes", default="8,12")
    parser.add_argument("--reference", default="16")
    parser.add_argument("--cases", type=int, default=len(CASES))
    parser.add_argument("--program", default=ROOT / "target/release/asperity")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    print("| case | elements | F_N | F_N_limit | F_T | F_T_limit | F_N covered | F_T covered | estimate over error: F_N | F_T | CPU s |")
    print("|---|---|---|---|---|---|---|---|---|---|---|")
    total = {"F_N": [], "F_T": []}
    for i, (name, settings) in enumerate(list(CASES.items())[:options.cases]):
        place = lambda name: options.out / f"{i}-{name.replace('/', '-')}"
        reference, _ = run(options.program, place(options.reference), [*settings, *mesh(options.reference)])
        for n in options.meshes.split(","):
            rows, seconds = run(options.program, place(n), [*settings, *mesh(n)])
            found = missing(rows, reference)
            (held_n, over_n), (held_t, over_t) = cover(found["F_N"]), cover(found["F_T"])
            lacking = [cell([row[kind] for row in found[key]]) for key in ("F_N", "F_T") for kind in (0, 1)]
            print(f"| {name} | {n} | {' | '.join(lacking)} | {held_n} | {held_t} | {over_n:.1f} | {over_t:.1f} | {seconds:.1f} |", flush=True)
            for key, rows in found.items():
                total[key] += rows
    for key, rows in total.items():
        held, over = cover(rows)
        print(f"{key}: {held} errors are within their estimates, which are {over:.1f} times as large (median).")


if __name__ == "__main__":
    main()
