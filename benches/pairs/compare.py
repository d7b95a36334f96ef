#!/usr/bin/env python3
"""Six contacts of unlike spheres: simulated, by what DEM codes put in their place, and by a composition of tables.

    cargo build --release && python3 benches/pairs/compare.py OUT

The stand-ins have R*, E* and the weaker yield stress, as a sphere on a rigid plane or as two equal spheres. The
composition (Olsson & Larsson 2016) puts the two bodies in series: 1/R1' + 1/R2' = 1/R1 + 1/R2, the same F_N and a in
both, h = h1 + h2, with each body's F_N(a) and h(a) from a table of two equal spheres of its material. Six elements
along the contact radius, h = 0.02 R*, mu = 0.3, nu = 0.3, ideal plasticity; the first sphere has E = 200 GPa and
sigma_Y = 400 MPa, R = 1. Half an hour of processor time at the most. Standard library only.
"""

import json
import math
import subprocess
import sys
from pathlib import Path

PROGRAM = Path(__file__).resolve().parents[2] / "target/release/asperity"
E, SIGMA = 200e3, 400.0
# Radius of the second body (None: flat), its E and sigma_Y over those of the first.
PAIRS = [(1.0, 3, 2), (1.0, 1, 2), (3.0, 1, 1), (3.0, 3, 2), (None, 1, 1), (None, 3, 2)]


def case(radius, modulus, stress, opponent, path):
    return f"""[sphere]
radius = {radius}
[material]
youngs_modulus = {modulus}
poissons_ratio = 0.3
[material.hardening]
law = "ideal"
yield_stress = {stress}
[contact]
friction = 0.3
[mesh]
elements_per_contact_radius = 6
[solver]
error_estimate = false
[output]
plots = false
fields = "none"
{opponent}
{path}
"""


def asperity(*arguments):
    subprocess.run([PROGRAM, *map(str, arguments), "-q"], check=True, stdout=subprocess.DEVNULL)


def run(out, text):
    """F_N0, a0 and the greatest F_T of a case."""
    file = out.with_suffix(".toml")
    file.write_text(text)
    asperity("run", file, "--out", out, "--force")
    summary = json.loads((out / "summary.json").read_text())
    return [summary[name] for name in ("F_N0", "a0", "F_T_max")]


def tabulate(out, modulus, stress):
    """h, a and F_N of two equal spheres, over R and E R^2, as logarithms."""
    file = out.with_suffix(".toml")
    file.write_text(case(1.0, modulus, stress, "[opponent]\nequal = true", "[[path]]\nindentation = 0.06"))
    asperity("law", "tabulate", file, "--out", out, "--elements", 6, "--force")
    levels = json.loads((out / "law.json").read_text())["levels"]
    return modulus, [[math.log(level[name]) for name in ("a0", "h", "F_N0")] for level in levels]


def of_one_body(table, a, radius):
    """F_N, and h of one of the two, at the contact radius a; below the table Hertz's."""
    modulus, rows = table
    x = math.log(a / radius)
    if x < rows[0][0]:
        h, force = rows[0][1] + 2 * (x - rows[0][0]), rows[0][2] + 3 * (x - rows[0][0])
    else:
        i = next((i for i in range(1, len(rows) - 1) if rows[i][0] >= x), len(rows) - 1)
        share = (x - rows[i - 1][0]) / (rows[i][0] - rows[i - 1][0])
        h, force = (rows[i - 1][k] + share * (rows[i][k] - rows[i - 1][k]) for k in (1, 2))
    return modulus * radius**2 * math.exp(force), 0.5 * radius * math.exp(h)


def bisect(low, high, rises):
    """Where a rising function becomes positive."""
    for _ in range(100):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if rises(middle) > 0 else (middle, high)
    return 0.5 * (low + high)


def composed(first, second, curvature, h):
    """F_N and a of two bodies in series, whose curvatures add up to `curvature`."""

    def at(a):
        # With a greater curvature a body is at a greater strain, and its force at this a is greater.
        k = bisect(1e-6 * curvature, (1 - 1e-6) * curvature,
                   lambda k: of_one_body(first, a, 1 / k)[0] - of_one_body(second, a, 1 / (curvature - k))[0])
        (force, h1), (_, h2) = of_one_body(first, a, 1 / k), of_one_body(second, a, 1 / (curvature - k))
        return force, h1 + h2

    a = bisect(1e-3 / curvature, 1 / curvature, lambda a: at(a)[1] - h)
    return at(a)[0], a


def main():
    out = Path(sys.argv[1])
    out.mkdir(parents=True, exist_ok=True)
    tables = {(e, s): tabulate(out / f"equal-{e}-{s}", e * E, s * SIGMA) for e, s in {(1, 1)} | {(e, s) for _, e, s in PAIRS}}
    print("R2/R1 E2/E1 sigma2/sigma1 |   F_N0     a0  F_T_max | plane: F_N0 a0 F_T % | equal spheres % | in series: F_N0 a0 %")
    for i, (radius, e, s) in enumerate(PAIRS):
        shape = "flat = true" if radius is None else f"radius = {radius}"
        other = f"[opponent]\n{shape}\n[opponent.material]\nyoungs_modulus = {e * E}\npoissons_ratio = 0.3\n" \
                f"[opponent.material.hardening]\nlaw = \"ideal\"\nyield_stress = {s * SIGMA}"
        star = 1.0 if radius is None else radius / (1 + radius)
        modulus = E / (1 + 1 / e)
        path = f"[[path]]\nindentation = {0.02 * star}\n[[path]]\nshear = \"full-slip\""
        pair = run(out / f"pair-{i}", case(1.0, E, SIGMA, other, path))
        plane = run(out / f"plane-{i}", case(star, modulus, SIGMA, "", path))
        equal = run(out / f"equal-{i}", case(2 * star, 2 * modulus, SIGMA, "[opponent]\nequal = true", path))
        series = composed(tables[1, 1], tables[e, s], 1 / star, 0.02 * star)
        off = [" ".join(f"{100 * (x / y - 1):+5.1f}" for x, y in zip(other, pair)) for other in (plane, equal, series)]
        print(f"{radius or 'flat':>5} {e:>5} {s:>13} | {pair[0]:6.2f} {pair[1]:.4f} {pair[2]:8.3f} | {off[0]} | {off[1]} | {off[2]}", flush=True)


main()
