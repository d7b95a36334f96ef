#!/usr/bin/env python3
"""Circles and flips by 90 degrees of an elastic pair of equal spheres, against a boundary-element computation.

    python3 benches/turning/elastic.py OUT [--elements 6] [--program target/release/asperity]
    python3 benches/turning/elastic.py --check

`half_spaces.py` has the boundary elements. `--check` prints the errors of that computation alone: against Cattaneo and
Mindlin at nu = 0, where they are exact, and against itself on more squares. Otherwise the pair is simulated along each path,
and the table has the difference of F_T/(mu F_N), a vector, at the steps of the simulation, root mean square / greatest, in
per cent, where the boundary elements take the same steps; and by how many degrees the direction of F_T differs. What the
hemispheres give way more than half-spaces, F_T times a constant, is taken out of the displacements, but for
--half-spaces. With numpy. OUT gets the runs, and what is there is not computed again.
"""

import math

import numpy as np
from half_spaces import F_N, HalfSpaces
from runs import HELD, E, arguments, case, parsed, rows

NU, MU = 0.3, 0.3
H = 0.0008  # a = 0.02 R
DEEP = 0.02  # a = 0.1 R, where the bodies' own part is a fifth of the compliance and the mesh's error 0.3 %
PARTS = 16  # steps of the boundary elements along a side


def paths(sides=24):
    """Ends of straight lines from the origin, in slip displacements; circles have so many sides."""
    out = lambda r: [(r * share, 0.0) for share in (0.25, 0.5, 0.75, 1.0)]
    angle = lambda i: 2 * math.pi * i / sides
    circle = lambda r: out(r) + [(r * math.cos(angle(i)), r * math.sin(angle(i))) for i in range(1, sides + 1)]
    flip = lambda r: out(r) + [(r, r * share) for share in (0.25, 0.5, 0.75, 1.0)]
    return {
        "circle, 0.5 of the slip": circle(0.5),
        "circle, 0.9 of the slip": circle(0.9),
        "flip by 90 degrees, 0.5": flip(0.5),
        "flip by 90 degrees, 0.9": flip(0.9),
    }


def computed(n, nu, ends, parts=PARTS):
    """Ways along the path, a whole number at each end, and F_T/(mu F_N) there."""
    pair, at, found = HalfSpaces(n, nu, MU), (0.0, 0.0), [(0.0, np.zeros(2))]
    limit, unit = MU * F_N, pair.slip() / parts
    for number, end in enumerate(ends):
        for part in range(1, parts + 1):
            force = pair.shift((end[0] - at[0]) * unit, (end[1] - at[1]) * unit)
            found.append((number + part / parts, force / limit))
        at = end
    return found


def computed_at(n, nu, ours):
    """The same in the steps of a simulation: (way, force, displacement in slip displacements)."""
    pair, at, found = HalfSpaces(n, nu, MU), np.zeros(2), []
    for way, _, place in ours:
        step = (place - at) * pair.slip()
        found.append((way, pair.shift(*step) / (MU * F_N)))
        at = place
    return found


def between(found, way):
    """F_T/(mu F_N) at a way along the path."""
    ways, forces = zip(*found)
    return np.array([np.interp(way, ways, [force[i] for force in forces]) for i in (0, 1)])


def errors(pairs):
    """Of pairs of vectors: the difference, root mean square and greatest, in per cent; the angle, in degrees."""
    size = [math.hypot(*(a - b)) for a, b in pairs]
    angle = [abs(math.degrees(math.atan2(a[0] * b[1] - a[1] * b[0], a @ b))) for a, b in pairs if math.hypot(*b) > 0.2]
    return 100 * math.sqrt(sum(x * x for x in size) / len(size)), 100 * max(size), max(angle)


def check():
    print("| squares along a | Cattaneo and Mindlin, nu = 0, rms / greatest, % |\n|---|---|")
    for n in (10, 20, 40):
        shares = [i / 20 for i in range(1, 21)]
        pair = HalfSpaces(n, 0.0, MU)
        step = 0.05 * pair.slip()
        pairs = [(pair.shift(step, 0.0) / (MU * F_N), np.array([1 - (1 - share) ** 1.5, 0.0])) for share in shares]
        rms, most, _ = errors(pairs)
        print(f"| {n} | {rms:.3f} / {most:.3f} |", flush=True)
    print("\n| path | squares along a, steps a side | from 40 and 4, rms / greatest, % |\n|---|---|---|")
    for name, ends in paths().items():
        best = computed(40, NU, ends, 4)
        for n, parts in ((10, 4), (20, 4), (20, 8), (20, 16)):
            found = computed(n, NU, ends, parts)
            rms, most, _ = errors([(force, between(best, way)) for way, force in found[1:]])
            print(f"| {name} | {n}, {parts} | {rms:.3f} / {most:.3f} |", flush=True)


def body(args, mesh):
    """What two hemispheres held at their equators give way more than half-spaces, times G R: from the stiffness with full
    stick of another contact, of which friction and path know nothing."""
    text = case('law = "elastic"', '"stick"', mesh, [[f"indentation = {DEEP}"], ["shear = 2e-5"]], NU, "[opponent]\nequal = true")
    history = rows(args, f"stick-{args.elements}", text.replace("[solver]", "[solver]\nshear_steps = 2"))
    pressed = [row for row in history if row["segment"] == 0][-1]
    stiffness = [row for row in history if row["segment"] == 1][0]["k_T"]
    modulus, shear = E / (2 * (1 - NU**2)), E / (2 * (1 + NU))
    a = (3 * pressed["F_N"] * 0.5 / (4 * modulus)) ** (1 / 3)
    return shear * (1 / stiffness - (2 - NU) / (4 * shear * a))


def simulated(args, ends, name):
    """Of an equal pair: ways, F_T/(mu F_N), and displacements over those of the slip, without the bodies' own part."""
    mesh = f"elements_per_contact_radius = {args.elements}\nsurface_elements_per_contact_radius = {2 * args.elements}"
    text = lambda path: case('law = "elastic"', MU, mesh, path, NU, "[opponent]\nequal = true")
    make = lambda name, path: rows(args, name, text(path).replace("[solver]", f"[solver]\nshear_steps = {args.steps}"))
    press = [f"indentation = {H}"]
    pressed = make(f"press-{args.elements}", [press])[-1]
    modulus, shear = E / (2 * (1 - NU**2)), E / (2 * (1 + NU))
    a = (3 * pressed["F_N"] * 0.5 / (4 * modulus)) ** (1 / 3)  # Hertz's, of the force
    slip = 2 * 3 * MU * pressed["F_N"] * (2 - NU) / (16 * shear * a)
    own = body(args, mesh) if args.body else 0.0
    name = f"{name}-{args.elements}-{args.sides}-{args.steps}"
    history = make(name, [press] + [[f"shear = [{x * slip!r}, {y * slip!r}]", HELD] for x, y in ends])
    found = []
    for row in history:
        number = int(row["segment"]) - 1
        if number < 0:
            continue
        start, end = ([(0.0, 0.0)] + ends)[number], ends[number]
        length = math.hypot(end[0] - start[0], end[1] - start[1]) * slip
        share = math.hypot(row["delta_T"] - start[0] * slip, row["delta_T_y"] - start[1] * slip) / length
        force = np.array([row["F_T"], row["F_T_y"]])
        place = (np.array([row["delta_T"], row["delta_T_y"]]) - own * force / shear) / slip
        found.append((number + share, force / (MU * row["F_N"]), place))
    return found


def main():
    parser = arguments(__doc__)
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--elements", type=int, default=6)
    parser.add_argument("--sides", type=int, default=24)
    parser.add_argument("--steps", type=int, default=15)
    parser.add_argument("--paths", default="0,1,2,3")
    parser.add_argument("--squares", type=int, default=20)
    parser.add_argument("--half-spaces", dest="body", action="store_false", help="with the bodies' own part in the displacements")
    args = parsed(parser)
    if args.check or args.out is None:
        return check()
    print("| path | F_T | direction, degrees |\n|---|---|---|")
    for number, (name, ends) in enumerate(paths(args.sides).items()):
        if str(number) not in args.paths.split(","):
            continue
        ours = simulated(args, ends, f"path-{number}")
        same = computed_at(args.squares, NU, ours)
        rms, most, angle = errors([(force, there) for (_, force, _), (_, there) in zip(ours, same)])
        print(f"| {name} | {rms:.2f} / {most:.2f} | {angle:.1f} |", flush=True)


if __name__ == "__main__":
    main()
