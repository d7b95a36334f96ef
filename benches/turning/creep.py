#!/usr/bin/env python3
"""An elastic sphere that rolls over a flat of its own material and creeps, against Kalker's linear theory.

    python3 benches/turning/creep.py OUT [--elements 6] [--surface 12] [--shares 0.03,0.06,0.12] [--kinds spin]
    python3 benches/turning/creep.py --check

Between bodies of one material no shear changes the pressure, as between two equal spheres; those would roll off each
other. The sphere is pressed, rolled back by two contact radii, sheared by some of what is to come, and then rolled on by
four, with a creepage of one kind: longitudinal (the shear goes on along the way), lateral (the shear goes on across it) or
spin (a twist goes on). All are small: the force of the linear theory is 6 % of mu F_N, or another share of it; mu = 1. Pure
rolling is by about R d phi, and here delta_T is counted from (R - h) d phi: so the shear has h phi in it. About, as it is
off by a part of h/R, of second order in a/R, and no less than a fifth of these creepages: the longitudinal one is simulated
to both sides, and half of the difference counts. Kalker (Three-Dimensional Elastic Bodies in Rolling Contact, Kluwer 1990;
the coefficients as programs for wheels on rails have them), nu = 0.25, a circle:

    F_x = C11 G a^2 longitudinal,  F_y = C22 G a^2 lateral,  F_y = C23 G a^3 spin     C11 = 4.12, C22 = 3.67, C23 = 1.47

The table has C at each contact radius of the way, of the simulation and of boundary elements (`half_spaces.py`) that roll
in the same way, on squares of two sizes and in the limit of small ones, an error of first order: how far the steady state
is. a is Hertz's, of F_N. `--check` prints the latter alone, and what they are without the shear ahead. With numpy.
"""

import math

import numpy as np
from half_spaces import F_N, HalfSpaces
from runs import E, arguments, case, parsed, rows, segment

NU, MU = 0.25, 1.0
G = E / (2 * (1 + NU))
A = 0.02
H = A * A
LIMIT = 4 / 3 * G * A**3 / (1 - NU)  # Hertz's F_N of a sphere on a flat of its material
KINDS = {"longitudinal": 4.12, "lateral": 3.67, "spin": 1.47}
SHARE = 0.06  # of the force in mu F_N
AHEAD = 0.8  # of the force, before the roll: without it the transient is three times as long
BACK, ON = 2.0, 4.0
ZONE = 1.06  # the contact reaches three radii, and the zone has to be wider, or the mesh is made anew with larger elements
WAYS = (1, 2, 3, 4)


def creepage(kind, share):
    """With which linear theory has that force; spin is times a."""
    return share * MU * LIMIT / (KINDS[kind] * G * A * A)


def simulated(args, kind, share):
    """C along the way."""
    found = one_side(args, kind, share, 1.0)
    if kind != "longitudinal":
        return found
    ways = [way for way, _ in found]
    other = one_side(args, kind, share, -1.0)
    both = [(at(found, way), at(other, way)) for way in ways]
    end = both[-1]
    offset = 0.5 * (end[0] + end[1]) / (0.5 * (end[0] - end[1])) * creepage(kind, share) / H
    print(f"pure rolling is by R - {offset:.2f} h", flush=True)
    return [(way, 0.5 * (plus - minus)) for way, (plus, minus) in zip(ways, both)]


def one_side(args, kind, share, sign):
    """F over G a^2 and the creepage, without its sign."""
    size = creepage(kind, share)
    c = sign * size
    mesh = f"elements_per_contact_radius = {args.elements}\nfine_zone = 3.0\ncontact_radius = {ZONE * A!r}"
    if args.surface > args.elements:
        mesh += f"\nsurface_elements_per_contact_radius = {args.surface}"
    back, on = -BACK * A, (ON - BACK) * A
    way = ON * A
    ahead = sign * AHEAD * share * MU * LIMIT * (2 - NU) / (4 * G * A)  # Mindlin's stiffness of two bodies
    shear, then = {
        "longitudinal": (f"shear = {H * back + ahead!r}", f"shear = {H * on + ahead + c * way!r}"),
        "lateral": (f"shear = [{H * back!r}, {ahead!r}]", f"shear = [{H * on!r}, {ahead + c * way!r}]"),
        "spin": (f"shear = [{H * back!r}, {ahead!r}]", f"shear = [{H * on!r}, {ahead!r}]\ntwist = {c / A * way!r}"),
    }[kind]
    path = [[f"indentation = {H}"], [f"roll = {back!r}", f"shear = {H * back!r}"], [shear], [f"roll = {on!r}", then]]
    text = case('law = "elastic"', MU, mesh, path, NU, "[opponent]\nflat = true")
    text = text.replace("error_estimate = false", "error_estimate = false\ntolerance = 1e-5")
    found = []
    name = f"{kind}-{args.elements}-{args.surface}-{share:g}" + ("-back" if sign < 0 else "")
    for row in segment(rows(args, name, text), 3):
        a = (3 * row["F_N"] * (1 - NU) / (4 * G)) ** (1 / 3)
        force = row["F_T"] if kind == "longitudinal" else row["F_T_y"]
        # The creepage is over A where it is a spin.
        scale = G * a * a * size * (a / A if kind == "spin" else 1.0)
        found.append(((row["roll_y"] - back) / A, force / scale))
    return found


def computed(n, kind, share, ahead=AHEAD):
    """The same by boundary elements; the unit of stress there is the greatest pressure's."""
    top = 2 * A / (math.pi * (1 - NU))  # over G
    c = creepage(kind, share) / top
    pair = HalfSpaces(n, NU, MU)
    creeps = [c if kind == name else 0.0 for name in KINDS]
    axis = 0 if kind == "longitudinal" else 1
    shift = [0.0, 0.0]
    shift[axis] = ahead * share * MU * F_N * (2 - NU) / 4
    return [(0.0, pair.shift(*shift)[axis] / c)] + [((i + 1) / n, pair.roll(*creeps)[axis] / c) for i in range(int(ON * n))]


def at(found, way):
    ways, values = zip(*found)
    return np.interp(way, ways, values)


def line(name, values):
    print(f"| {name} | " + " | ".join(f"{value:.3f}" for value in values) + " |", flush=True)


def boundary(kind, share, squares, ahead):
    """Lines of both sizes, and of the limit."""
    coarse, fine = ([at(computed(n, kind, share, ahead), way) for way in WAYS] for n in squares)
    for n, values in zip(squares, (coarse, fine)):
        line(f"{kind}, {n} squares, {100 * share:g} %", values)
    line(f"{kind}, in the limit, {100 * share:g} %", [2 * b - a for a, b in zip(coarse, fine)])


def main():
    parser = arguments(__doc__)
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--elements", type=int, default=6)
    parser.add_argument("--surface", type=int, default=0)
    parser.add_argument("--squares", default="10,20")
    parser.add_argument("--kinds", default=",".join(KINDS))
    parser.add_argument("--shares", default=f"{SHARE}")
    parser.add_argument("--alone", action="store_true", help="the simulation without the boundary elements")
    args = parsed(parser)
    squares = [int(n) for n in args.squares.split(",")]
    shares = [float(share) for share in args.shares.split(",")]
    print("| creepage, share of mu F_N | 1 a | 2 a | 3 a | 4 a |\n|---|---|---|---|---|")
    for kind in args.kinds.split(","):
        for share in shares:
            if args.check or args.out is None:
                line(f"{kind}, nothing ahead", [at(computed(squares[0], kind, share, 0.0), way) for way in WAYS])
            if not args.alone:
                boundary(kind, share, squares, AHEAD)
            if args.out is not None:
                found = simulated(args, kind, share)
                line(f"{kind}, simulated, {100 * share:g} %", [at(found, way) for way in WAYS])
        line(f"{kind}, Kalker", [KINDS[kind]] * len(WAYS))


if __name__ == "__main__":
    main()
