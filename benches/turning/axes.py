#!/usr/bin/env python3
"""The reference case, sheared along turned axes: what the mesh itself adds to the forces.

    python3 benches/turning/axes.py OUT [--path main|cycle] [--meshes 5,10] [--directions 0,17,30,45,90] [--tolerance 1e-5]
        [--laid x|path]

The mesh of a whole sphere is laid along the first shear of the path, so that a path which keeps to its direction has the forces
of the x axis (`--laid path`). To see what the mesh adds to a path that leaves its first direction, all paths here begin with a
shear along x by 1e-9 R.

`main` is the main job, a shear to full slip; `cycle` two cycles and a half at 60 % of the slip. Both are on the mesh of the
whole, against the same along x on the mesh of the half, step by step. (0 is the whole mesh along x: 1e-9 degrees.) The table
has, for each mesh (elements inside, twice as many at the surface; with --same-surface as many), the differences of F_T along
the path and of F_N, and F_T across the path, greatest / root mean square, in per cent of the greatest F_T and of F_N before
the shear; the steps of the greatest ones; and how many steps there are. Steps are solved to 1e-5 of F_N: with 3e-4,
single steps after a turn are off by 1 %. Standard library only. OUT gets the runs, and what is there is not computed
again.
"""

import math

from runs import arguments, case, parsed, rows

DISTANCE = 0.0017
IDEAL = 'law = "ideal"\nyield_stress = 400.0'


def along(args, elements, direction):
    """(segment, way along the path, F_N, F_T along and across it) of each step from the end of the press on; none: half."""
    turned = [] if direction is None else [f"shear_direction = {direction or 1e-9!r}"]
    press = [["indentation = 0.02"]]
    if args.laid == "x":
        press.append(["shear = 1e-9"])
    if args.path == "main":
        path = press + [['shear = "full-slip"'] + turned]
    else:
        path = press + [[f"shear = {sign * DISTANCE}"] + turned for sign in (1, -1, 1, -1, 1)]
    surface = elements if args.same_surface else 2 * elements
    mesh = f"elements_per_contact_radius = {elements}\nsurface_elements_per_contact_radius = {surface}"
    text = case(IDEAL, 0.3, mesh, path).replace("[solver]", f"[solver]\ntolerance = {args.tolerance}{args.solver}")
    way = "half" if direction is None else f"{direction:g}"
    label = f"{args.laid}-{args.path}-{elements}-{surface}-{way}-{args.tolerance:g}"
    history = rows(args, label, text)
    angle = math.radians(direction or 0.0)
    cos, sin = math.cos(angle), math.sin(angle)
    both = lambda x, y: (x * cos + y * sin, y * cos - x * sin)
    last = max(i for i, row in enumerate(history) if row["segment"] == len(press) - 1)
    found = []
    for row in history[last:]:
        way, _ = both(row["delta_T"], row["delta_T_y"])
        found.append((int(row["segment"]), way, row["F_N"], *both(row["F_T"], row["F_T_y"])))
    return found


def there(found, i, way):
    """Row i of `found` at the same way as the other's: steps to full slip are as long as the first stiffness is small, which
    the tolerance changes a little."""
    row = found[i]
    assert abs(row[1] - way) < 1e-3 * DISTANCE, "steps that end elsewhere"
    if row[1] == way:
        return row
    before = found[i - 1] if i > 0 else found[i + 1]
    share = (way - row[1]) / (row[1] - before[1])
    return (row[0], way, *(b + share * (b - a) for a, b in zip(before[2:], row[2:])))


def main():
    parser = arguments(__doc__, out="needed")
    parser.add_argument("--path", choices=["main", "cycle"], default="cycle")
    parser.add_argument("--laid", choices=["x", "path"], default="x")
    parser.add_argument("--meshes", default="5,10")
    parser.add_argument("--directions", default="0,17,30,45,90")
    parser.add_argument("--tolerance", type=float, default=1e-5)
    parser.add_argument("--same-surface", action="store_true")
    parser.add_argument("--solver", default="", help="one more line of [solver]")
    parser.add_argument("--steps", action="store_true", help="every step: differences along, in F_N and across, signed")
    args = parsed(parser)
    args.solver = f"\n{args.solver}" if args.solver else ""
    print("| elements | direction | F_T | F_N | across | at | across at | steps |\n" + "|---" * 8 + "|")
    for elements in map(int, args.meshes.split(",")):
        straight = along(args, elements, None)
        peak = max(abs(row[3]) for row in straight)
        for direction in map(float, args.directions.split(",")):
            turned = along(args, elements, direction)
            # One may come to full slip a step earlier.
            pairs = list(zip(straight, turned))
            assert args.path == "main" or len(turned) == len(straight), "other steps"
            assert abs(len(turned) - len(straight)) < 3, "other steps"
            pairs = [(a, there(turned, i, a[1])) for i, (a, _) in enumerate(pairs)]
            f_t = [100 * (b[3] - a[3]) / peak for a, b in pairs]
            f_n = [100 * (b[2] - a[2]) / straight[0][2] for a, b in pairs]
            across = [100 * b[4] / peak for _, b in pairs]
            greatest = lambda values: max(map(abs, values))
            rms = lambda values: math.sqrt(sum(x * x for x in values) / len(values))
            cells = [f"{greatest(values):.2f} / {rms(values):.2f}" for values in (f_t, f_n, across)]
            for values in (f_t, across):
                at = straight[max(range(len(values)), key=lambda i: abs(values[i]))]
                cells.append(f"segment {at[0]}, {at[1]:.5f}")
            print(f"| {elements} + {2 * elements} | {direction:g} | " + " | ".join(cells) + f" | {len(pairs)} |", flush=True)
            if args.steps:
                for (a, b), t, n, x in zip(pairs, f_t, f_n, across):
                    share = math.hypot(b[3], b[4]) / (0.3 * b[2])
                    print(f"    {a[0]} {a[1]:+.5f}  {t:+.3f} {n:+.3f} {x:+.3f}  F_T/(mu F_N) {share:.4f}")


if __name__ == "__main__":
    main()
