#!/usr/bin/env python3
"""What a mesh gets wrong, over drawn contacts: goals, and on how many contacts each is met.

    cargo build --release && python3 benches/limits/judge.py OUT [--drawn 20] [--seed 1] [--mesh default] [--reference 16/32]
                                                             [--steps 96] [--most 600] [--program PATH]

The four contacts below and as many as asked, drawn by the seed (E/sigma_Y, mu, nu, h/R and the hardening), pressed and
sheared to full slip. The truth is the limit that the reference mesh finds with its companion of half as many elements,
with four times the default's steps of a shear (twice in its companion). The shares of F_T_error (shares.py) and the
steps of a shear were chosen on contacts of seeds 1 and 2.
Rows count from a tenth of the greatest indentation on. Errors are in per cent: of the greatest F_N and F_T for curves, of
the value itself for the others. `told` is the run's own error. What was computed before is taken from OUT. Some hours of
processor time. Standard library only.
"""

import argparse
import json
import math
import random
import statistics
import subprocess
from pathlib import Path

from measure import CASES, H, LAW, MU, NU, ROOT, mesh, missing, run

# Root mean square and largest error that a curve may have, or one bound for a number.
GOALS = {"F_T_limit": (1.2, 2.0), "F_T": (2.0, 3.0), "F_N": (0.5, None), "F_T_max": (None, 0.5), "delta_T_95": (None, 1.5),
         "a0": (None, 1.0), "ripple": (None, 0.5)}
NAMED = {
    "ideal 400, mu 0.3, h 0.02": CASES["ideal 400, mu 0.3, h 0.02"],
    "linear 400 + 2000 alpha, mu 0.3, h 0.02": [LAW + '{law="linear",yield_stress=400.0,modulus=2000.0}'],
    "power 300 + 1000 alpha^0.4, mu 0.4, h 0.02": CASES["power 300 + 1000 alpha^0.4, mu 0.4, h 0.02"],
    "Voce 250 to 600, mu 0.3, h 0.03": [LAW + '{law="voce",yield_stress=250.0,saturation_stress=600.0,rate=20.0}', f"{H}=0.03"],
}
MODULUS = 200e3
RATIO, FRICTION, POISSON, INDENTATION = (20.0, 3000.0), (0.1, 0.8), (0.0, 0.45), (0.003, 0.06)


def log_uniform(rng, low, high):
    return math.exp(rng.uniform(math.log(low), math.log(high)))


def drawn(count, seed):
    """Contacts by a seed: their names and settings."""
    rng, cases = random.Random(seed), {}
    for i in range(count):
        sigma, mu, nu, h = (float(f"{value:.3g}") for value in (
            MODULUS / log_uniform(rng, *RATIO), rng.uniform(*FRICTION), rng.uniform(*POISSON), log_uniform(rng, *INDENTATION)))
        law = ("ideal", "linear", "power", "hollomon", "voce")[i % 5]
        keys = {"yield_stress": sigma}
        if law == "linear":
            keys["modulus"] = MODULUS * log_uniform(rng, 1e-3, 0.1)
        elif law == "power":
            keys |= {"coefficient": sigma * log_uniform(rng, 0.5, 5.0), "exponent": rng.uniform(0.1, 0.7)}
        elif law == "hollomon":
            # sigma_Y lies where sigma_0 eps^(1/m) meets Hooke's line.
            m = log_uniform(rng, 2.5, 10.0)
            keys = {"coefficient": (sigma ** (m - 1) * MODULUS) ** (1 / m), "exponent": m}
        elif law == "voce":
            keys |= {"saturation_stress": sigma * rng.uniform(1.2, 3.0), "rate": log_uniform(rng, 3.0, 100.0)}
        table = ",".join(f"{key}={float(f'{value:.4g}')}" for key, value in keys.items())
        name = f"{law}, E/sigma_Y {MODULUS / sigma:.0f}, nu {nu:g}, mu {mu:g}, h {h:g}"
        cases[name] = [f'{LAW}{{law="{law}",{table}}}', f"{MU}={mu}", f"{NU}={nu}", f"{H}={h}"]
    return cases


def summary(out):
    return json.loads((out / "summary.json").read_text())


def number(found, right, told=None):
    """A value's error in per cent of what is right, with the run's own."""
    error = 100 * (found / right - 1)
    held = {} if told is None else {"held": [abs(error) <= 100 * told / right], "over": [100 * told / right / max(abs(error), 1e-9)]}
    return {"rms": abs(error), "max": abs(error), **held}


def peak_to_peak(rows):
    """F_N(h) of the press over its own parabola in ln h through twelve steps: greatest less least, in per cent."""
    points = [(math.log(row["h"]), math.log(row["F_N"])) for row in rows if row["segment"] == 0][-12:]
    if len(points) < 8:
        return None
    x = [p[0] - points[-1][0] for p in points]
    sums = [sum(v ** k for v in x) for k in range(5)]
    matrix = [[sums[i + j] for j in range(3)] + [sum(v ** i * p[1] for v, p in zip(x, points))] for i in range(3)]
    for i in range(3):
        for j in range(3):
            if j != i:
                factor = matrix[j][i] / matrix[i][i]
                matrix[j] = [b - factor * a for a, b in zip(matrix[i], matrix[j])]
    c = [row[3] / row[i] for i, row in enumerate(matrix)]
    rest = [p[1] - c[0] - c[1] * v - c[2] * v * v for v, p in zip(x, points)]
    return 100 * (max(rest) - min(rest))


def scores(rows, here, reference, there):
    """Per quantity: rms and largest error; what was told of it (`held`), and told over true error (`over`)."""
    found, result = missing(rows, reference), {}
    for name in ("F_N", "F_T"):
        for kind, label in enumerate((name, f"{name}_limit")):
            errors = [row[kind] for row in found[name]]
            result[label] = {"rms": math.sqrt(statistics.fmean(x * x for x in errors)), "max": max(map(abs, errors))}
        result[name] |= {"held": [abs(raw) <= told for raw, _, told in found[name]],
                         "over": [told / max(abs(raw), 1e-9) for raw, _, told in found[name]]}
    if here["F_T_max"] and there.get("F_T_max_limit"):
        result["F_T_max"] = number(here["F_T_max"], there["F_T_max_limit"], here["F_T_max_error"])
        result["F_T_max_limit"] = number(here["F_T_max_limit"] or here["F_T_max"], there["F_T_max_limit"])
    if here.get("k_T0_error") is not None and there.get("k_T0_error") is not None:
        # What the reference lacks at first order, without the half that an error has more.
        lacking = there["k_T0_error"] / 1.5 * (1 if there["k_T0"] >= here["k_T0"] else -1)
        result["k_T0"] = number(here["k_T0"], there["k_T0"] + lacking, here["k_T0_error"])
    result["a0"] = number(here["a0"], there["a0"], here["a0_error"])
    for share in ("90", "95"):
        right, limit = there[f"delta_T_{share}_limit"], here[f"delta_T_{share}_limit"]
        if right and limit and here[f"delta_T_{share}"]:
            result[f"delta_T_{share}"] = number(here[f"delta_T_{share}"], right, here[f"delta_T_{share}_error"])
            result[f"delta_T_{share}_limit"] = number(limit, right)
    ripple = peak_to_peak(rows)
    if ripple is not None:
        result["ripple"] = {"rms": ripple, "max": ripple}
    return result


def met(score, goal):
    rms, largest = goal
    return (rms is None or score["rms"] <= rms) and (largest is None or score["max"] <= largest)


def cell(score):
    if score is None:
        return "-"
    return f"{score['max']:.2f}" if score["rms"] == score["max"] else f"{score['rms']:.2f} / {score['max']:.2f}"


def conclude(goals, everything):
    """On how many contacts each goal is met, and each error covers what it is of."""
    print()
    for name, goal in goals.items():
        of = [one[name] for one in everything if name in one]
        bounds = " / ".join("-" if bound is None else f"{bound:g}" for bound in goal)
        median = statistics.median(score["max" if goal[0] is None else "rms"] for score in of)
        print(f"{name}: {sum(met(score, goal) for score in of)} of {len(of)} within {bounds} % (median {median:.2f})")
    print()
    for name in ("F_N", "F_T", "F_T_max", "a0", "k_T0", "delta_T_90", "delta_T_95"):
        of = [one[name] for one in everything if "held" in one.get(name, {})]
        # A curve is covered if nine in ten of its rows are.
        held = sum(statistics.fmean(score["held"]) >= 0.9 for score in of)
        if not of:
            continue
        over = statistics.median(statistics.median(score["over"]) for score in of)
        print(f"error of {name}: covers {held} of {len(of)}, {over:.1f} times the true one (median)")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("out", type=Path)
    parser.add_argument("--drawn", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--mesh", default="default")
    parser.add_argument("--reference", default="16/32")
    parser.add_argument("--steps", type=int, default=96, help="solver.shear_steps of the reference")
    parser.add_argument("--most", type=float, default=600.0, help="seconds that a run may take; of one that takes more nothing is said")
    parser.add_argument("--program", default=ROOT / "target/release/asperity")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    columns = [*GOALS, "F_N_limit", "F_T_max_limit", "delta_T_90", "delta_T_95_limit"]
    print(f"| case | {' | '.join(columns)} | CPU s |\n|{'---|' * (len(columns) + 2)}")
    everything = []
    for i, (name, settings) in enumerate({**NAMED, **drawn(options.drawn, options.seed)}.items()):
        computed = []
        for made, steps in ((options.reference, options.steps), (options.mesh, None)):
            drawn_by = options.seed if i >= len(NAMED) else "named"
            place = options.out / "-".join([f"{drawn_by}-{i}", made.replace("/", "-"), *([f"{steps}"] if steps else [])])
            more = ([f"solver.shear_steps={steps}"] if steps else []) + ([] if made == "default" else mesh(made))
            try:
                rows, seconds = run(options.program, place, [*settings, *more], options.most)
            except subprocess.CalledProcessError as failed:
                print(f"| {name} | {made}: exit code {failed.returncode} |", flush=True)
                break
            except subprocess.TimeoutExpired:
                print(f"| {name} | {made}: not done in {options.most:.0f} s, left out |", flush=True)
                break
            computed.append((rows, summary(place)))
        else:
            (reference, there), (rows, here) = computed
            everything.append(scores(rows, here, reference, there))
            cells = [cell(everything[-1].get(column)) for column in columns]
            print(f"| {name} | {' | '.join(cells)} | {seconds:.1f} |", flush=True)
    conclude(GOALS, everything)


if __name__ == "__main__":
    main()
