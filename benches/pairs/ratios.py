#!/usr/bin/env python3
"""How much a pair hangs on more than R*: the same materials at other ratios of the radii, R* and h alike.

    asperity study fixtures/studies/ratios.toml --out ratios && python3 benches/pairs/ratios.py ratios

Each row against two spheres of one size: F_N0, a0, F_T along the shear (of its peak, rms and greatest), in per cent.
That is what a table of two spheres of one size is off by where it is scaled by R*. Standard library only.
"""

import csv
import math
import sys
import tomllib
from pathlib import Path


def history(directory):
    rows = list(csv.DictReader((directory / "history.csv").open()))
    pressed = [row for row in rows if row["segment"] == "0"][-1]
    shear = [row for row in rows if row["segment"] == "1"]
    curve = [(0.0, 0.0)] + [(float(row["delta_T"]), float(row["F_T"])) for row in shear]
    return float(pressed["F_N"]), float(pressed["a"]), curve


def at(curve, delta):
    for (d0, f0), (d1, f1) in zip(curve, curve[1:]):
        if d1 >= delta:
            return f0 + (f1 - f0) * (delta - d0) / (d1 - d0)
    return curve[-1][1]


def main():
    study = Path(sys.argv[1])
    base = {}
    print("| weaker material | R_2/R_1 | h/R* | F_N0 | a0 | F_T rms | worst |\n|---|---|---|---|---|---|---|")
    for row in csv.DictReader((study / "study.csv").open()):
        directory = study / row["directory"]
        case = tomllib.loads((directory / "case.toml").read_text())
        bodies = [case["material"], case["opponent"]["material"]]
        weak = min(bodies, key=lambda m: m["hardening"]["yield_stress"])
        other = case["opponent"].get("radius")
        ratio = f"{other / case['sphere']['radius']:.0f}" if other else ("flat" if weak == bodies[0] else "flat, the weaker")
        h, name = case["path"][0]["indentation"], weak["hardening"]["law"]
        f_n, a, curve = history(directory)
        if ratio == "1":
            base[name, h] = f_n, a, curve
            continue
        table_f, table_a, table = base[name, h]
        peak = max(f for _, f in curve)
        off = [(at(table, d) - f) / peak for d, f in curve[1:]]
        rms = math.sqrt(sum(x * x for x in off) / len(off))
        numbers = [100 * x for x in (table_f / f_n - 1, table_a / a - 1, rms, max(map(abs, off)))]
        print(f"| {name} | {ratio} | {h} | {numbers[0]:+.1f} | {numbers[1]:+.1f} | {numbers[2]:.1f} | {numbers[3]:.1f} |")


main()
