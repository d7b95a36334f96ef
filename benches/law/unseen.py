#!/usr/bin/env python3
"""How far a law is, from h alone, from the cases of a study that it has not seen.

    python3 benches/law/unseen.py LAW.json STUDY_DIR [--program target/release/asperity] [--worst N]

Every case of the study, pressed and sheared once, is predicted by `asperity law predict` and
compared with its simulated history, at the limit of fine meshes where the shear has one: F_N0, F_T
over its peak and F_N over F_N0 along the shear, root mean squares over points and cases, and the
greatest. Beside them stands half of what the limit has added to F_T, which it may still lack: where
that is above 2.5 %, a case is told and not counted. A share of a study is read too. Standard library
only.
"""

import argparse
import csv
import io
import math
import subprocess
import tomllib
from pathlib import Path


# Of what the extrapolation adds so much may still be missing (see src/law/check), and with so much a case is not counted.
STILL_MISSING = 0.5
COARSEST = 0.025


def columns(rows, *names):
    return [[float(row[name]) for row in rows] for name in names]


def straight(x, xs, ys):
    """ys at x, straight between the places xs and constant beyond."""
    if x >= xs[-1]:
        return ys[-1]
    i = next(i for i, place in enumerate(xs) if place > x)
    if i == 0:
        return ys[0]
    return ys[i - 1] + (ys[i] - ys[i - 1]) * (x - xs[i - 1]) / (xs[i] - xs[i - 1])


def compare(program, law, folder):
    """Errors of one case: F_N0, rms and greatest of F_T, of F_N; None if it is not of this kind."""
    history = list(csv.DictReader((folder / "history.csv").open()))
    shear = [row for row in history if row["segment"] == "1"]
    if not shear:
        return None
    case = tomllib.loads((folder / "case.toml").read_text())
    # The law is asked for the first two segments alone, as far as the simulation went.
    command = [program, "law", "predict", law, folder / "case.toml"]
    answer = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    if answer.returncode:
        raise SystemExit(f"{folder}: {answer.stderr}")
    path = list(csv.DictReader(io.StringIO(answer.stdout)))
    pressed = [row for row in path if row["segment"] == "0"]
    along = [row for row in path if row["segment"] == "1"]
    # Formulas are asked for the shear alone.
    start = pressed[-1] if pressed else along[0]
    delta, f_t, f_n = columns([{**start, "delta_T": 0.0, "F_T": 0.0}] + along, "delta_T", "F_T", "F_N")
    f_n0 = float([row for row in history if row["segment"] == "0"][-1]["F_N"])
    limits = [f"{name}_limit" if all(row.get(f"{name}_limit") for row in shear) else name for name in ("F_T", "F_N")]
    sheared, own_t, own_n, raw = columns(shear, "delta_T", *limits, "F_T")
    peak = max(own_t)
    missing = [STILL_MISSING * (own - f) / peak for own, f in zip(own_t, raw)]
    t = [(straight(d, delta, f_t) - own) / peak for d, own in zip(sheared, own_t)]
    n = [(straight(d, delta, f_n) - own) / f_n0 for d, own in zip(sheared, own_n)]
    rms = lambda errors: math.sqrt(sum(e * e for e in errors) / len(errors))
    material = case["material"]
    what = f"{material['hardening']['law']}, nu {material['poissons_ratio']:.2f}, mu {case['contact']['friction']:.2f}, "
    what += f"h {case['path'][0]['indentation']:.4f}"
    return float(start["F_N"]) / f_n0 - 1.0, rms(t), max(map(abs, t)), rms(n), max(map(abs, n)), what, rms(missing)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("law", type=Path)
    parser.add_argument("study", type=Path)
    parser.add_argument("--program", default="target/release/asperity")
    parser.add_argument("--worst", type=int, default=5, help="how many of the worst cases to name")
    parser.add_argument("--friction", type=float, default=math.inf, help="leave out the cases with more than this mu")
    arguments = parser.parse_args()
    tables = sorted(arguments.study.glob("study*.csv"))
    rows = [row for table in tables for row in csv.DictReader(table.open()) if row["status"] == "done"]
    done = {row["directory"]: row for row in rows if float(row["contact.friction"]) <= arguments.friction}.values()
    all_errors = [compare(arguments.program, arguments.law, arguments.study / row["directory"]) for row in done]
    coarse = [one for one in all_errors if one and one[6] > COARSEST]
    errors = [one for one in all_errors if one and one[6] <= COARSEST]
    rms = lambda i: 100 * math.sqrt(sum(e[i] ** 2 for e in errors) / len(errors))
    most = lambda i: 100 * max(abs(e[i]) for e in errors)
    print(f"{len(errors)} cases, errors in per cent: rms (greatest); mesh, F_T: {rms(6):.2f} ({most(6):.1f})")
    print(f"F_N0 {rms(0):.2f} ({most(0):.1f})  F_T {rms(1):.2f} ({most(2):.1f})  F_N {rms(3):.2f} ({most(4):.1f})")
    for e in sorted(errors, key=lambda e: -e[2])[: arguments.worst]:
        print(f"  F_T {100 * e[2]:5.1f}  F_N {100 * e[4]:5.1f}  F_N0 {100 * e[0]:+5.1f}  mesh {100 * e[6]:.1f}  {e[5]}")
    for e in coarse:
        print(f"  not counted, mesh {100 * e[6]:.1f}: F_T {100 * e[2]:5.1f}  {e[5]}")


if __name__ == "__main__":
    main()
