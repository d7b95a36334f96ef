#!/usr/bin/env python3
"""The main job's contact, sheared to and fro along turned axes: what the mesh itself adds to the forces.

    python3 benches/turning/axes.py OUT [--meshes 5,10] [--directions 17,30,45,90] [--program target/release/asperity]

Two cycles and a half at 60 % of the slip, on the mesh of the whole, against the same along x on the mesh of the half, step
by step. The table has, for each mesh (elements inside, twice as many at the surface), the differences of F_T along the
path and of F_N, and F_T across the path, greatest / root mean square, in per cent of the greatest F_T and of F_N before
the shear; and the step of the greatest one. Steps are solved to 1e-5 of F_N: with the default of 3e-4, single steps after a
turn are off by 1 %. Standard library only. OUT gets the runs, and what is there is not computed again.
"""

import math

from runs import arguments, case, parsed, rows

DISTANCE = 0.0017
IDEAL = 'law = "ideal"\nyield_stress = 400.0'


def along(args, elements, direction):
    """(segment, way along the path, F_N, F_T along and across it) of each step from the end of the press on."""
    turned = [f"shear_direction = {direction!r}"] if direction else []
    path = [["indentation = 0.02"]] + [[f"shear = {sign * DISTANCE}"] + turned for sign in (1, -1, 1, -1, 1)]
    mesh = f"elements_per_contact_radius = {elements}\nsurface_elements_per_contact_radius = {2 * elements}"
    text = case(IDEAL, 0.3, mesh, path).replace("[solver]", f"[solver]\ntolerance = {args.tolerance}")
    history = rows(args, f"axis-{elements}-{direction:g}-{args.tolerance:g}", text)
    cos, sin = math.cos(math.radians(direction)), math.sin(math.radians(direction))
    both = lambda x, y: (x * cos + y * sin, y * cos - x * sin)
    last = max(i for i, row in enumerate(history) if row["segment"] == 0)
    found = []
    for row in history[last:]:
        way, _ = both(row["delta_T"], row["delta_T_y"])
        found.append((int(row["segment"]), way, row["F_N"], *both(row["F_T"], row["F_T_y"])))
    return found


def main():
    parser = arguments(__doc__, out="needed")
    parser.add_argument("--meshes", default="5,10")
    parser.add_argument("--directions", default="17,30,45,90")
    parser.add_argument("--tolerance", type=float, default=1e-5)
    args = parsed(parser)
    print("| elements | direction | F_T | F_N | across | at |\n|---|---|---|---|---|---|")
    for elements in map(int, args.meshes.split(",")):
        straight = along(args, elements, 0.0)
        peak = max(abs(row[3]) for row in straight)
        for direction in map(float, args.directions.split(",")):
            turned = along(args, elements, direction)
            assert len(turned) == len(straight), "other steps"
            assert all(abs(a[1] - b[1]) < 1e-9 for a, b in zip(straight, turned)), "steps that end elsewhere"
            pairs = list(zip(straight, turned))
            f_t = [100 * abs(b[3] - a[3]) / peak for a, b in pairs]
            f_n = [100 * abs(b[2] - a[2]) / straight[0][2] for a, b in pairs]
            across = [100 * abs(b[4]) / peak for _, b in pairs]
            rms = lambda values: math.sqrt(sum(x * x for x in values) / len(values))
            cells = [f"{max(values):.2f} / {rms(values):.2f}" for values in (f_t, f_n, across)]
            at = straight[f_t.index(max(f_t))]
            print(f"| {elements} + {2 * elements} | {direction:g} | " + " | ".join(cells) + f" | segment {at[0]}, {at[1]:.5f} |")


if __name__ == "__main__":
    main()
