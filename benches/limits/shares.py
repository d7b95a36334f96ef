#!/usr/bin/env python3
"""Which shares make F_T_error cover the true error: the constants TANGENTIAL_SHARE and UNSEEN_SHARE of src/output/limit.rs.

    python3 benches/limits/shares.py OUT [--told 1.5,0.005] [--reference 16-32-96]

OUT has runs and references of judge.py. F_T_error is the root of the sum of squares of three parts: TANGENTIAL_SHARE times
what F_T/F_N lacks times F_N, F_T/F_N times the ripple of F_N, and UNSEEN_SHARE times mu F_N. `--told` are the shares with
which the runs were made; the first two parts follow from F_T_error and F_N_error, and other shares are put in their place.
A curve is covered if nine in ten of its rows are. Standard library only.
"""

import argparse
import math
import statistics
from pathlib import Path

from judge import MU, NAMED, drawn, summary
from measure import at, curve, run

# F_N_error has COUPLED_SHARE times F_T/F_N times what F_T/F_N lacks, in squares.
COUPLED = 4.0
TANGENTIAL, UNSEEN = (1.5, 1.75, 2.0, 2.5, 3.0), (0.0, 0.003, 0.004, 0.005, 0.007)
DRAWN = 100


def parts(row, told, mu):
    """Of a row: what F_T/F_N lacks, the ripple of F_N, both in units of force, and mu F_N."""
    tangential, unseen = told
    ratio = row["F_T"] / row["F_N"]
    squares = row["F_T_error"] ** 2 - (unseen * mu * row["F_N"]) ** 2
    lacks = (squares - (ratio * row["F_N_error"]) ** 2) / (tangential ** 2 - COUPLED ** 2 * ratio ** 4)
    lacks = math.sqrt(max(lacks, 0.0))
    ripple = math.sqrt(max(row["F_N_error"] ** 2 - (COUPLED * ratio * lacks) ** 2, 0.0))
    return lacks, ratio * ripple, mu * row["F_N"]


def contacts(out, reference, told):
    """Per contact: the parts of its rows and their true errors."""
    for place in sorted(out.glob("*-default")):
        made_with = place.with_name(place.name.replace("default", reference))
        if not all((each / "summary.json").exists() and summary(each)["status"] == "done" for each in (place, made_with)):
            continue
        seed, number = place.name.split("-")[:2]
        # The first contacts that a seed draws do not depend on how many it draws.
        settings = list({**NAMED, **drawn(DRAWN, 1 if seed == "named" else int(seed))}.values())[int(number)]
        mu = next((float(word.split("=")[1]) for word in settings if word.startswith(MU)), 0.3)
        truth = curve(run(None, made_with, [])[0], 1, "F_T_limit")
        rows = [row for row in run(None, place, [])[0] if row["segment"] == 1 and row["F_T_error"] is not None]
        found = [(parts(row, told, mu), at(truth, row["delta_T"]), row["F_T"]) for row in rows]
        yield [(of, abs(f_t - right)) for of, right, f_t in found if right is not None]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("out", type=Path)
    parser.add_argument("--told", default="1.5,0.005")
    parser.add_argument("--reference", default="16-32-96")
    options = parser.parse_args()
    every = list(contacts(options.out, options.reference, tuple(map(float, options.told.split(",")))))
    print(f"| tangential | unseen | curves of {len(every)} | rows, % | over the true error (median) |\n|{'---|' * 5}")
    for tangential in TANGENTIAL:
        for unseen in UNSEEN:
            held, over = [], []
            for rows in every:
                told = [math.hypot(tangential * lacks, ripple, unseen * scale) for (lacks, ripple, scale), _ in rows]
                held.append(statistics.fmean(error <= of for of, (_, error) in zip(told, rows)))
                over.append(statistics.median(of / max(error, 1e-9) for of, (_, error) in zip(told, rows)))
            print(f"| {tangential:g} | {unseen:g} | {sum(share >= 0.9 for share in held)} | "
                  f"{100 * statistics.fmean(held):.0f} | {statistics.median(over):.1f} |")


if __name__ == "__main__":
    main()
