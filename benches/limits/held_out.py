#!/usr/bin/env python3
"""Whether the errors that runs tell of F_N and F_T cover the truth on contacts on which their factors were not chosen.

    cargo build --release && python3 benches/limits/held_out.py OUT [--seed 1] [--count 8] [--meshes 6,8,4/8] [--references 12,8/16]

Contacts drawn by a seed: every hardening law, nu 0 to 0.45, mu 0.1 to 0.8, h/R 0.003 to 0.06, E/sigma_Y 100 to 2000,
pressed and sheared to full slip. Each is computed on the meshes and on two finer ones, whose limits are taken for the
truth, one after the other: where these two disagree, the share that is covered says little. What was computed before is
taken from OUT. Half an hour of processor time. Standard library only.
"""

import argparse
import math
import random
import statistics
from pathlib import Path

import measure

LAWS = ("ideal", "linear", "power", "voce")


def settings(draw):
    """A contact by its name and its settings."""
    even = lambda low, high: low + (high - low) * draw.random()
    logarithmic = lambda low, high: math.exp(even(math.log(low), math.log(high)))
    law, stress = draw.choice(LAWS), 200e3 / logarithmic(100, 2000)
    more = {
        "ideal": "",
        "linear": f",modulus={logarithmic(1e-3, 0.1) * 200e3:.1f}",
        "power": f",coefficient={stress * logarithmic(0.3, 5):.1f},exponent={even(0.2, 0.9):.3f}",
        "voce": f",saturation_stress={stress * even(1.2, 2.5):.1f},rate={logarithmic(3, 50):.2f}",
    }[law]
    nu, mu, h = even(0.0, 0.45), even(0.1, 0.8), logarithmic(0.003, 0.06)
    name = f"{law} {stress:.0f}, nu {nu:.2f}, mu {mu:.2f}, h {h:.4f}"
    return name, [f'{measure.LAW}{{law="{law}",yield_stress={stress:.1f}{more}}}', f"{measure.NU}={nu:.4f}",
                  f"{measure.MU}={mu:.4f}", f"{measure.H}={h:.6f}"]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("out", type=Path)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=8)
    parser.add_argument("--meshes", default="6,8,4/8")
    parser.add_argument("--references", default="12,8/16")
    parser.add_argument("--program", default=measure.ROOT / "target/release/asperity")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    draw = random.Random(options.seed)
    references = options.references.split(",")
    print("| contact | elements | reference | F_N covered | F_T covered | estimate over error: F_N | F_T |")
    print("|---|---|---|---|---|---|---|")
    total = {(reference, key): [] for reference in references for key in ("F_N", "F_T")}
    for i in range(options.count):
        name, sets = settings(draw)
        run = lambda mesh: measure.run(
            options.program, options.out / f"{options.seed}-{i}-{mesh.replace('/', '-')}", [*sets, *measure.mesh(mesh)])[0]
        truths = {reference: run(reference) for reference in references}
        for mesh in options.meshes.split(","):
            rows = run(mesh)
            for reference, truth in truths.items():
                found = measure.missing(rows, truth)
                if not all(found.values()):
                    print(f"| {name} | {mesh} | {reference} | nothing to compare | | | |", flush=True)
                    continue
                (held_n, over_n), (held_t, over_t) = (measure.cover(found[key]) for key in ("F_N", "F_T"))
                print(f"| {name} | {mesh} | {reference} | {held_n} | {held_t} | {over_n:.1f} | {over_t:.1f} |", flush=True)
                for key, of in found.items():
                    total[reference, key] += of
    for (reference, key), rows in total.items():
        covered = sum(abs(raw) <= error for raw, _, error in rows)
        ratio = statistics.median(error / max(abs(raw), 1e-9) for raw, _, error in rows)
        print(f"{key} against {reference}: {covered} of {len(rows)} errors ({100 * covered / len(rows):.0f} %) are within their "
              f"estimates, which are {ratio:.1f} times as large (median).")


if __name__ == "__main__":
    main()
