#!/usr/bin/env python3
"""The stiffness in twist of an elastic sphere that sticks to a plane, over Reissner and Sagoci's 16/3 G a^3.

    python3 benches/turning/torsion.py OUT [--meshes 6,10,16] [--depths 0.0001,0.0004,0.0016,0.0064]

A sphere (nu = 0.3, full stick) is pressed and twisted by a thousandth of a/R. The table has, for each mesh (elements inside
and at the surface) at the second of the depths, and for each depth on the first mesh: a/R of Hertz, and what the stiffness
lacks, in per cent, with a of the history and with that of Hertz, sqrt(R h). What grows with a/R is the body's own part.
Standard library only. OUT gets the runs, and what is there is not computed again.
"""

import math

from runs import E, arguments, case, parsed, rows, segment

NU = 0.3
G = E / (2 * (1 + NU))


def lacks(args, mesh, h):
    """What the stiffness lacks, in per cent, with either radius."""
    inside, surface = mesh
    lines = f"elements_per_contact_radius = {inside}"
    if surface > inside:
        lines += f"\nsurface_elements_per_contact_radius = {surface}"
    a = math.sqrt(h)
    text = case('law = "elastic"', '"stick"', lines, [[f"indentation = {h}"], [f"twist = {1e-3 * a!r}"]], NU)
    text = text.replace("[solver]", "[solver]\ntolerance = 1e-5")
    pressed, first = segment(rows(args, f"torsion-{inside}-{surface}-{h:g}", text), 1)[:2]
    stiffness = first["M_twist"] / first["twist"]
    return [100 * (1 - stiffness / (16 / 3 * G * radius**3)) for radius in (pressed["a"], a)]


def main():
    parser = arguments(__doc__, out="needed")
    parser.add_argument("--meshes", default="6,10,16,6/12")
    parser.add_argument("--depths", default="0.0001,0.0004,0.0016,0.0064")
    args = parsed(parser)
    meshes = [tuple(map(int, (mesh.split("/") * 2)[:2])) for mesh in args.meshes.split(",")]
    depths = [float(h) for h in args.depths.split(",")]
    print("| elements | a/R | lacks | with Hertz's a |\n|---|---|---|---|")
    wanted = [(mesh, depths[1]) for mesh in meshes] + [(meshes[0], h) for h in depths if h != depths[1]]
    for mesh, h in wanted:
        found, of_hertz = lacks(args, mesh, h)
        print(f"| {mesh[0]} / {mesh[1]} | {math.sqrt(h):.3f} | {found:.1f} | {of_hertz:.1f} |", flush=True)


if __name__ == "__main__":
    main()
