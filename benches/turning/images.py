#!/usr/bin/env python3
"""Processor time of a path on the whole mesh over that on half of it, and of an equal pair by its image over two bodies.

    python3 benches/turning/images.py OUT [--elements 4] [--repeats 3] [--images-only] [--program target/release/asperity]

Ideally plastic, E/sigma_Y = 500, mu = 0.3, pressed to h = 0.02 R and then moved, on one thread, with twice the elements at
the surface. Of so many runs the fastest counts. `whole` is a shear along x with a displacement across it of 1e-14 R: the
same contact, meshed whole. The table has F_N and F_T (M_twist of a twist, M_roll,x of a roll) at the end, too.
"""

import os
import resource
import subprocess

from runs import E, arguments, case, parsed, rows

LAW = 'law = "ideal"\nyield_stress = 400.0'
EQUAL = "[opponent]\nequal = true"
TWO = f"[opponent]\nradius = 1.0\n[opponent.material]\nyoungs_modulus = {E}\npoissons_ratio = 0.3\n[opponent.material.hardening]\n{LAW}"
MOVES = {
    "shear along x": ("shear = 0.004", "F_T"),
    "shear along x, whole": ("shear = [0.004, 1e-14]", "F_T"),
    "shear at 45 degrees": ("shear = 0.004\nshear_direction = 45.0", "F_T"),
    "twist": ("twist = 0.04", "M_twist"),
    "roll about x": ("roll = [0.04, 0.0]", "M_roll_x"),
}
RUNS = [  # name, opponent, moves
    ("plane", "", list(MOVES)[:3]),
    ("pair, image", EQUAL, list(MOVES)),
    ("pair, two bodies", TWO, list(MOVES)),
]


def timed(args, name, text):
    """Processor time in s, and the last row."""
    best = float("inf")
    for _ in range(args.repeats):
        (args.out / f"{name}.toml").unlink(missing_ok=True)
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        history = rows(args, name, text)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        best = min(best, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    return best, history[-1]


def main():
    parser = arguments(__doc__, out="needed")
    parser.add_argument("--elements", type=int, default=4)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--images-only", action="store_true", help="no two bodies, which take most of the time")
    args = parsed(parser)
    os.environ["RAYON_NUM_THREADS"] = "1"
    mesh = f"elements_per_contact_radius = {args.elements}\nsurface_elements_per_contact_radius = {2 * args.elements}"
    print("| opponent | path | processor time, s | over a shear along x | F_N | F_T or moment |\n|---|---|---|---|---|---|")
    for i, (opponent, table, moves) in enumerate(RUNS[: 2 if args.images_only else 3]):
        first = None
        for j, name in enumerate(moves):
            motion, column = MOVES[name]
            text = case(LAW, 0.3, mesh, [["indentation = 0.02"], [motion]], opponent=table)
            time, end = timed(args, f"image-{i}-{j}-{args.elements}", text)
            first = first or time
            value = abs(complex(end["F_T"], end["F_T_y"])) if column == "F_T" else end[column]
            print(f"| {opponent} | {name} | {time:.2f} | {time / first:.2f} | {end['F_N']:.2f} | {value:.3f} |", flush=True)


if __name__ == "__main__":
    main()
