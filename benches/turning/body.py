#!/usr/bin/env python3
"""What an elastic body gives way between its contact and the plate that holds it, beyond what a half-space does.

    python3 benches/turning/body.py OUT [--elements 8] [--program target/release/asperity]

Spheres (each of an equal pair, the plate clamped or free) and flats (under a rigid sphere), elastic, mu = 0.01, pressed to a = 0.05,
0.1 and 0.2 R and sheared, with twice the elements at the surface. The table has what h exceeds Hertz's of the same F_N by, over
F_N/(E R), and what the compliance 1/k_T0 exceeds Cattaneo and Mindlin's for Hertz's a by, times G R. The constants of
`src/analytical/body.rs` are its fit, printed last: a parabola in nu for the former, the mean over a = 0.1 and 0.2 R, and a line in
ln(a/R) for the latter, over all. A rigid sphere on an elastic flat sticks to more than it would without the coupling of normal and
tangential tractions, by a share of its compliance: of a flat the limit of that line in R/a counts, as the mean over nu.
"""

import json
import math

from runs import E, arguments, parsed, rows

KINDS = {
    "sphere": ("", "equal = true"),
    "sphere, free": ('equator = "free"\n', "equal = true"),
    "flat": ("flat = true\n", "rigid = true\nradius = 1.0"),
}
RATIOS = (0.0, 0.15, 0.3, 0.45)
RADII = (0.05, 0.1, 0.2)


def text(args, kind, nu, a):
    own, opponent = KINDS[kind]
    h = a * a * (1 if kind == "flat" else 2)
    return f"""[sphere]
radius = 1.0
{own}[material]
youngs_modulus = {E}
poissons_ratio = {nu}
[material.hardening]
law = "elastic"
[contact]
friction = 0.01
[opponent]
{opponent}
[mesh]
elements_per_contact_radius = {args.elements}
surface_elements_per_contact_radius = {2 * args.elements}
[solver]
error_estimate = false
[output]
plots = false
fields = "none"
[[path]]
indentation = {h}
[[path]]
shear = {h / 1000}
"""


def line(points):
    """Intercept and slope of least squares."""
    n = len(points)
    x, y = (sum(p[i] for p in points) / n for i in (0, 1))
    slope = sum((p[0] - x) * (p[1] - y) for p in points) / sum((p[0] - x) ** 2 for p in points)
    return y - slope * x, slope


def parabola(points):
    """Coefficients of 1, x and x^2 by least squares (normal equations, Cramer)."""
    s = [sum(x**k for x, _ in points) for k in range(5)]
    b = [sum(y * x**k for x, y in points) for k in range(3)]
    rows = [[s[i + j] for j in range(3)] for i in range(3)]
    det = lambda m: sum(m[0][i] * (m[1][(i + 1) % 3] * m[2][(i + 2) % 3] - m[1][(i + 2) % 3] * m[2][(i + 1) % 3]) for i in range(3))
    return [det([[b[i] if j == k else rows[i][j] for j in range(3)] for i in range(3)]) / det(rows) for k in range(3)]


def main():
    parser = arguments(__doc__, out="needed")
    parser.add_argument("--elements", type=int, default=8)
    args = parsed(parser)
    print("| body | nu | a/R | along the normal | along the surface |\n|---|---|---|---|---|")
    for kind in KINDS:
        bodies = 1 if kind == "flat" else 2
        normal, tangential, limits = [], [], []
        for nu in RATIOS:
            for a in RADII:
                name = f"{kind.replace(', ', '-')}-{nu}-{a}"
                rows(args, name, text(args, kind, nu, a))
                found = json.loads((args.out / name / "summary.json").read_text())
                modulus, shear, radius = E / (1 - nu * nu) / bodies, E / (2 + 2 * nu), 1 / bodies
                hertz = (3 * found["F_N0"] * radius / (4 * modulus)) ** (1 / 3)
                c_n = (found["h0"] - hertz**2 / radius) / bodies * E / found["F_N0"]
                c_t = (1 / found["k_T0"] - bodies * (2 - nu) / (8 * shear * hertz)) / bodies * shear
                print(f"| {kind} | {nu} | {a} | {c_n:.3f} | {c_t:.3f} |", flush=True)
                if a > 0.05:
                    normal.append((nu, c_n))
                tangential.append((math.log(a), c_t))
            limits.append(line([(math.exp(-x), y) for x, y in tangential[-len(RADII) :]])[0])
        of_flat = sum(limits) / len(limits), 0.0
        fits = parabola(normal), of_flat if kind == "flat" else line(tangential)
        print(f"\n{kind}: normal {', '.join(f'{x:.3f}' for x in fits[0])}; tangential {fits[1][0]:.3f}, {fits[1][1]:.3f}\n", flush=True)


if __name__ == "__main__":
    main()
