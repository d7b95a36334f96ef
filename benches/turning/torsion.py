#!/usr/bin/env python3
"""The stiffness in twist of an elastic sphere, and the moment of a pair that slips, against closed forms.

    python3 benches/turning/torsion.py OUT [--meshes 6,10,16] [--depths 0.0001,0.0004,0.0016,0.0064] [--pair 10]

A sphere (nu = 0.3, full stick) is pressed onto a plane in nine parts, and twisted by a thousandth of a/R after each of the
last six. The table has, for each mesh (elements inside and at the surface) at the second of the depths, and for each depth on
the second mesh: a/R of Hertz at the end, and what the stiffness lacks of Reissner and Sagoci's 16/3 G a^3, in per cent, mean
and standard deviation of the six: a, which counts to the third power, moves in parts of an element. What grows with a/R is
the body's own part.

With --pair, two equal spheres with mu = 0.3 are pressed to 0.002 R and twisted until all slips: the moment at the first steps
beyond a quarter, half and nine tenths of its limit over that of Lubkin (J. Appl. Mech. 18 (1951) 183) at the same angle,
and the last over the limit, 3 pi/16 mu F_N a. Standard library only. OUT gets the runs, and what is there is not computed
again.
"""

import math

from runs import E, arguments, case, parsed, rows, segment

NU, MU = 0.3, 0.3
PARTS, FIRST = 9, 4
G = E / (2 * (1 + NU))


def lacks(args, mesh, h):
    """What the stiffness lacks, in per cent: mean and standard deviation."""
    inside, surface = mesh
    lines = f"elements_per_contact_radius = {inside}"
    if surface > inside:
        lines += f"\nsurface_elements_per_contact_radius = {surface}"
    path, angle = [], 0.0
    for part in range(1, PARTS + 1):
        path.append([f"indentation = {h * part / PARTS!r}"])
        if part >= FIRST:
            angle += 1e-3 * math.sqrt(h)
            path.append([f"twist = {angle!r}"])
    text = case('law = "elastic"', '"stick"', lines, path, NU).replace("[solver]", "[solver]\ntolerance = 1e-5")
    history = rows(args, f"torsion-{inside}-{surface}-{h:g}", text)
    found = []
    for number, lines in enumerate(path):
        if lines[0].startswith("twist"):
            pressed, *_, end = segment(history, number)
            stiffness = (end["M_twist"] - pressed["M_twist"]) / (end["twist"] - pressed["twist"])
            found.append(100 * (1 - stiffness / (16 / 3 * G * pressed["a"] ** 3)))
    mean = sum(found) / len(found)
    return mean, math.sqrt(sum((x - mean) ** 2 for x in found) / (len(found) - 1))


def k_less_e(c):
    """K - E, the complete elliptic integrals, at k^2 = 1 - c^2, by the arithmetic-geometric mean."""
    a, b, power, total = 1.0, c, 0.5, 0.5 * (1 - c * c)
    for _ in range(40):
        half = 0.5 * (a - b)
        a, b = 0.5 * (a + b), math.sqrt(a * b)
        power *= 2
        total += power * half * half
    return total * math.pi / (2 * a)


def lubkin(a, f_n, modulus, angle):
    """The moment at an angle, with `modulus` of both bodies: what sticks within c turns by all discs of radius s > c."""
    low, high = 0.0, 1.0
    for _ in range(60):
        c = 0.5 * (low + high)
        low, high = (low, c) if 0.75 * MU * f_n / (math.pi * modulus * a * a) * k_less_e(c) < angle else (c, high)
    n = 400
    way = lambda t: 1 - (1 - c) * t * t  # s of the ring, smooth in t at s = a
    inside = lambda t: 3 * way(t) ** 2 * k_less_e(way(t)) * 2 * (1 - c) * t
    ring = sum(inside((i + 0.5) / n) for i in range(n)) / n
    return 4 * MU * f_n * a / math.pi * (c**3 * k_less_e(c) + ring)


def pair(args):
    """Shares of Lubkin's moment."""
    text = case('law = "elastic"', MU, f"elements_per_contact_radius = {args.pair}",
                [["indentation = 0.002"], ["twist = 0.25"]], NU, "[opponent]\nequal = true")
    history = segment(rows(args, f"pair-{args.pair}", text), 1)
    a = history[0]["a"]
    limit = lambda row: 3 * math.pi / 16 * MU * row["F_N"] * a
    cells = []
    for share in (0.25, 0.5, 0.9):
        row = next(row for row in history if row["M_twist"] > share * limit(row))
        cells.append(row["M_twist"] / lubkin(a, row["F_N"], G / 2, row["twist"]))
    cells.append(history[-1]["M_twist"] / limit(history[-1]))
    print("\n| pair, elements | a quarter | half | nine tenths | limit |\n|---|---|---|---|---|")
    print(f"| {args.pair} | " + " | ".join(f"{cell:.4f}" for cell in cells) + " |", flush=True)


def main():
    parser = arguments(__doc__, out="needed")
    parser.add_argument("--meshes", default="6,10,16,10/20")
    parser.add_argument("--depths", default="0.0001,0.0004,0.0016,0.0064")
    parser.add_argument("--pair", type=int, default=10)
    args = parsed(parser)
    meshes = [tuple(map(int, (mesh.split("/") * 2)[:2])) for mesh in args.meshes.split(",")]
    depths = [float(h) for h in args.depths.split(",")]
    print("| elements | a/R | lacks |\n|---|---|---|")
    wanted = [(mesh, depths[1]) for mesh in meshes] + [(meshes[1], h) for h in depths if h != depths[1]]
    for mesh, h in wanted:
        mean, scatter = lacks(args, mesh, h)
        print(f"| {mesh[0]} / {mesh[1]} | {math.sqrt(h):.3f} | {mean:.1f} +- {scatter:.1f} |", flush=True)
    if args.pair:
        pair(args)


if __name__ == "__main__":
    main()
