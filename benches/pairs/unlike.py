#!/usr/bin/env python3
"""Two bodies that are not alike: the built-in law, which puts them in series, against simulations.

    cargo build --release && python3 benches/pairs/unlike.py OUT [--program target/release/asperity] [--law LAW.json]

Twelve pairs, six of one material with other radii or a flat, six of two materials; 5 elements along the contact radius and 10 at
the surface, extrapolated to the limit of fine meshes. F_N0, F_T over its peak and F_N over F_N0 along the shear, per cent: rms
and the largest. OUT gets the runs; what is there is not computed again. Four minutes of processor time. Standard library only.
"""

import argparse
import csv
import io
import math
import pathlib
import subprocess

VOCE = 'law = "voce", yield_stress = {}, saturation_stress = {}, rate = {}'
POWER = 'law = "power", yield_stress = {}, coefficient = {}, exponent = {}'


def ideal(stress):
    return f'law = "ideal", yield_stress = {stress}'


def material(modulus, nu, hardening):
    return f"youngs_modulus = {modulus}\npoissons_ratio = {nu}\nhardening = {{ {hardening} }}\n"


STEEL = (200e3, 0.3, ideal(400.0))
# Name, material, mu, opponent's radius or flat, its material or None, h, delta_T.
PAIRS = [
    ("ideal, R_2 = R_1", STEEL, 0.3, "radius = 1.0", None, 0.04, 0.006),
    ("ideal, R_2 = 3 R_1", STEEL, 0.3, "radius = 3.0", None, 0.03, 0.006),
    ("ideal, strong, mu 0.6, R_2 = 2 R_1", (200e3, 0.3, ideal(2000.0)), 0.6, "radius = 2.0", None, 0.02, 0.02),
    ("ideal, on a flat, mu 0.4", STEEL, 0.4, "flat = true", None, 0.02, 0.006),
    ("power, mu 0.2, R_2 = R_1/2", (100e3, 0.35, POWER.format(100.0, 400.0, 0.4)), 0.2, "radius = 0.5", None, 0.015, 0.004),
    ("on softer, R_2 = 2 R_1", STEEL, 0.3, "radius = 2.0", (70e3, 0.34, ideal(200.0)), 0.03, 0.006),
    ("on 1.5 times as strong", STEEL, 0.3, "radius = 1.0", (200e3, 0.3, ideal(600.0)), 0.03, 0.006),
    ("on 4 times as strong", STEEL, 0.3, "radius = 1.0", (200e3, 0.3, ideal(1600.0)), 0.03, 0.006),
    ("on stiffer and stronger, mu 0.2", (100e3, 0.3, ideal(200.0)), 0.2, "radius = 2.0", (300e3, 0.25, ideal(900.0)), 0.02, 0.004),
    ("Voce on ideal, mu 0.4", (70e3, 0.34, VOCE.format(100.0, 250.0, 12.0)), 0.4, "radius = 1.0", (200e3, 0.3, ideal(350.0)), 0.02, 0.006),
    ("on a softer flat, mu 0.5", (200e3, 0.3, ideal(300.0)), 0.5, "flat = true", (120e3, 0.35, ideal(150.0)), 0.02, 0.006),
    ("power on Voce", (120e3, 0.35, POWER.format(60.0, 290.0, 0.45)), 0.3, "radius = 1.5", (210e3, 0.3, VOCE.format(350.0, 700.0, 10.0)), 0.02, 0.005),
]


def case(own, mu, opponent, other, h, delta):
    there = "" if other is None else "[opponent.material]\n" + material(*other)
    return f"""[sphere]
radius = 1.0
[material]
{material(*own)}[contact]
friction = {mu}
[mesh]
elements_per_contact_radius = 5
surface_elements_per_contact_radius = 10
[output]
fields = "none"
plots = false
[opponent]
{opponent}
{there}[[path]]
indentation = {h}
[[path]]
shear = {delta}
"""


def straight(x, places):
    """The second column at x of the first."""
    for (x0, y0), (x1, y1) in zip(places, places[1:]):
        if x <= x1:
            return y0 + (y1 - y0) * (x - x0) / (x1 - x0) if x1 > x0 else y1
    return places[-1][1]


def errors(args, file, out):
    """F_N0; rms and largest of F_T; of F_N."""
    with open(out / "history.csv", newline="") as table:
        rows = list(csv.DictReader(table))
    shear = [row for row in rows if row["segment"] == "1"]
    f_n0 = float([row for row in rows if row["segment"] == "0"][-1]["F_N"])
    answer = subprocess.run([args.program, "law", "predict", args.law, file], capture_output=True, text=True, check=True)
    path = list(csv.DictReader(io.StringIO(answer.stdout)))
    pressed = [row for row in path if row["segment"] == "0"][-1]
    along = [pressed] + [row for row in path if row["segment"] == "1"]
    found = [100 * (float(pressed["F_N"]) / f_n0 - 1)]
    for name in ("F_T", "F_N"):
        limit = [float(row[f"{name}_limit"]) for row in shear]
        scale = f_n0 if name == "F_N" else max(limit)
        places = [(float(row["delta_T"]), float(row[name])) for row in along]
        off = [100 * (straight(float(row["delta_T"]), places) - truth) / scale for row, truth in zip(shear, limit)]
        found += [math.sqrt(sum(x * x for x in off) / len(off)), max(off, key=abs)]
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--program", default="target/release/asperity")
    parser.add_argument("--law", default="built-in")
    args = parser.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    print("| pair | F_N0 | F_T rms (worst) | F_N rms (worst) |\n|---|---|---|---|")
    for number, (name, *numbers) in enumerate(PAIRS):
        file, out = args.out / f"{number}.toml", args.out / str(number)
        file.write_text(case(*numbers))
        if not (out / "summary.json").exists():
            subprocess.run([args.program, "run", file, "--out", out, "--force", "--quiet", "--device", "cpu"], check=True)
        f_n0, f_t, f_t_most, f_n, f_n_most = errors(args, file, out)
        print(f"| {name} | {f_n0:+.1f} | {f_t:.1f} ({f_t_most:+.0f}) | {f_n:.1f} ({f_n_most:+.0f}) |", flush=True)


if __name__ == "__main__":
    main()
