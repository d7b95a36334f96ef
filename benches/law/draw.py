#!/usr/bin/env python3
"""Draws the studies of the laws by interpolation: materials of every hardening law at random, by a seed.

    python3 benches/law/draw.py --out fixtures/studies              # wide.toml, wide-unseen.toml
    python3 benches/law/draw.py --out fixtures/studies --equal      # wide-pair.toml, wide-pair-unseen.toml
    python3 benches/law/draw.py --out fixtures/studies --oblique    # oblique.toml, oblique-unseen.toml; with --equal oblique-pair.toml, ...
    python3 benches/law/draw.py --out DIR --seed 1                  # other materials, that no law has seen

A study has the materials below five times, and twice once more with mu above 0.5, where contacts differ
most (on an equal sphere three times, and once). All are pressed, sheared, sheared back (on a plane) and
released. For the oblique presses, which tell how a contact yields under F_T, other materials are drawn,
and each meets one friction and one indentation, as a press has all that are less deep: finer meshes, as F_T
of a press falls more slowly with the elements than that of a shear.

Every material meets CASES pairs of friction and indentation. Poisson's ratio, ln(E/sigma_Y), ln(mu)
and ln(h/R) are each cut into as many strata as there are draws, one draw a stratum. A fifth of the
materials goes into a study of its own, before anything is fitted to the rest. Standard library only,
so that a seed means the same numbers anywhere.
"""

import argparse
import math
import random
from pathlib import Path

YOUNGS_MODULUS = 200e3
SEED = 2026
CASES = 4
# How many materials of each hardening law, and how many of those are set aside.
KINDS = {
    "elastic": (4, 1),
    "ideal": (8, 2),
    "linear": (7, 1),
    "power": (8, 2),
    "hollomon": (8, 2),
    "voce": (7, 1),
    "table": (6, 1),
}
RATIO = (12.0, 5000.0)  # E/sigma_Y
POISSON = (0.0, 0.49)
FRICTION = (0.05, 1.0)
STRONG = (0.5, 1.0)  # mu of the second part of a study
TIMES = (5, 2)  # how many times as many materials its two parts have
PAIR_TIMES = (3, 1)  # the same on an equal sphere
INDENTATION = (0.001, 0.15)  # h/R
OBLIQUE_TIMES = 3  # the same of the oblique presses, on a plane
OBLIQUE_PAIR_TIMES = 2  # and on an equal sphere
OBLIQUE_DEPTH = (0.01, 0.15)  # h/R


def strata(rng, count, low, high):
    """`count` numbers of [low, high], one in each of `count` equal parts, in random order."""
    values = [low + (high - low) * (i + rng.random()) / count for i in range(count)]
    rng.shuffle(values)
    return values


def log_strata(rng, count, low, high):
    """As `strata`, in the logarithm."""
    return [math.exp(v) for v in strata(rng, count, math.log(low), math.log(high))]


def log_uniform(rng, low, high):
    """One number, its logarithm uniform."""
    return math.exp(rng.uniform(math.log(low), math.log(high)))


def number(value):
    """Four digits, as TOML has a float."""
    text = f"{value:.4g}"
    return text if any(c in text for c in ".e") else text + ".0"


def hardening(rng, law, yield_stress):
    """The inline table of one material."""
    if law == "elastic":
        return '{ law = "elastic" }'
    keys = {"yield_stress": yield_stress}
    if law == "linear":
        keys["modulus"] = YOUNGS_MODULUS * log_uniform(rng, 1e-3, 0.1)
    elif law == "power":
        keys["coefficient"] = yield_stress * log_uniform(rng, 0.5, 5.0)
        keys["exponent"] = rng.uniform(0.1, 0.7)
    elif law == "hollomon":
        # sigma_Y lies where sigma_0 eps^(1/m) meets Hooke's line.
        m = log_uniform(rng, 2.5, 10.0)
        keys = {"coefficient": (yield_stress ** (m - 1.0) * YOUNGS_MODULUS) ** (1.0 / m), "exponent": m}
    elif law == "voce":
        keys["saturation_stress"] = yield_stress * rng.uniform(1.2, 4.0)
        keys["rate"] = log_uniform(rng, 4.0, 100.0)
    elif law == "table":
        # Concave: each part is less steep than the one before.
        strain, stress, points = 0.0, yield_stress, []
        slope = yield_stress * log_uniform(rng, 5.0, 60.0)
        for step in (0.02, 0.08, 0.3, 0.6):
            points.append((strain, stress))
            strain, stress = strain + step, stress + slope * step
            slope *= rng.uniform(0.1, 0.5)
        points.append((strain, stress))
        body = ", ".join(f"[{number(x)}, {number(y)}]" for x, y in points)
        return f'{{ law = "table", points = [{body}] }}'
    body = ", ".join(f"{key} = {number(value)}" for key, value in keys.items())
    return f'{{ law = "{law}", {body} }}'


def draw(seed, times, frictions=FRICTION, count_of_cases=CASES, depths=INDENTATION):
    """(law, hardening, nu, mu, h, set aside) of every case: first one case of each material, then
    a second of each, so that the first part of a study is a study too."""
    rng = random.Random(seed)
    laws = [(law, i < times * aside) for law, (count, aside) in KINDS.items() for i in range(times * count)]
    rng.shuffle(laws)
    count = len(laws)
    ratios = log_strata(rng, count, *RATIO)
    poisson = strata(rng, count, *POISSON)
    materials = [
        (law, hardening(rng, law, YOUNGS_MODULUS / ratio), nu, aside)
        for (law, aside), ratio, nu in zip(laws, ratios, poisson)
    ]
    cases = []
    for _ in range(count_of_cases):
        friction = log_strata(rng, count, *frictions)
        depth = log_strata(rng, count, *depths)
        cases += [(*m[:3], mu, h, m[3]) for m, mu, h in zip(materials, friction, depth)]
    return cases


def wrapped(key, values):
    """A TOML list, ten numbers a line."""
    lines = [", ".join(values[i : i + 10]) for i in range(0, len(values), 10)]
    return f'"{key}" = [\n' + "".join(f"    {line},\n" for line in lines) + "]\n"


def study(cases, equal, what, seed, oblique=False):
    """The text of the study file."""
    elements = 8 if oblique else 5
    text = (
        f"# {what} Drawn by benches/law/draw.py, seed {seed}; see there for the ranges.\n"
        "[base.sphere]\nradius = 1.0\n\n"
        f"[base.material]\nyoungs_modulus = {YOUNGS_MODULUS / 1e3:.0f}e3\n\n"
        "[base.contact]\n\n"
        f"[base.mesh]\nelements_per_contact_radius = {elements}\nsurface_elements_per_contact_radius = {2 * elements}\n\n"
        "# Companions: what a law is made of are the curves at the limit of fine meshes.\n"
        "[base.solver]\nerror_estimate = true\n\n"
        '[base.output]\nfields = "none"\n\n'
        + ("[base.opponent]\nequal = true\n\n" if equal else "")
        + ("[[base.path]]\n\n" if oblique else sheared(equal))
        + "[zip]\n"
    )
    # Between equal spheres h is the approach of their centres, twice what each is pressed in.
    depth = [(2.0 if equal else 1.0) * case[4] for case in cases]
    text += '"material.hardening" = [\n' + "".join(f"    {case[1]},\n" for case in cases) + "]\n"
    text += wrapped("material.poissons_ratio", [number(case[2]) for case in cases])
    text += wrapped("contact.friction", [number(case[3]) for case in cases])
    text += wrapped("path.0.indentation", [number(h) for h in depth])
    if oblique:
        # The slope at which a contact with c = 2 has half of mu; see `measured_slope` in src/contact_law.
        slopes = [2 * case[3] / (1 + 0.5 * case[3] ** 2) for case in cases]
        text += wrapped("path.0.shear", [number(slope * h) for slope, h in zip(slopes, depth)])
    return text


def sheared(equal):
    """The path of a contact that is pressed, sheared to the end, and released."""
    back = "" if equal else '[[base.path]]\nshear = 0.0\nhold = "indentation"\n\n'
    return '[[base.path]]\n\n[[base.path]]\nshear = "full-slip"\nhold = "indentation"\n\n' + back + "[[base.path]]\nrelease = 0.5\n\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, required=True, help="where the two study files go")
    parser.add_argument("--seed", type=int, default=SEED, help=f"of the draw (those of fixtures/studies: {SEED})")
    parser.add_argument("--equal", action="store_true", help="on an equal sphere instead of the plane")
    parser.add_argument("--oblique", action="store_true", help="the oblique presses instead")
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    seed, equal = arguments.seed, arguments.equal
    against = "an equal sphere" if equal else "a plane"
    if arguments.oblique:
        times, of = OBLIQUE_PAIR_TIMES if equal else OBLIQUE_TIMES, "oblique presses of the law by interpolation"
        cases = draw(seed + 2, times, count_of_cases=1, depths=OBLIQUE_DEPTH)
        cases = [case for case in cases if case[0] != "elastic"]
        stem = "oblique-pair" if equal else "oblique"
    else:
        times, of = PAIR_TIMES if equal else TIMES, "study of the law by interpolation"
        cases = draw(seed, times[0]) + draw(seed + 1, times[1], STRONG)
        stem = "wide-pair" if equal else "wide"
    for aside, name, what in [
        (False, stem, f"The {of} on {against}: what it is made from."),
        (True, f"{stem}-unseen", f"The materials set aside from the {of} on {against}."),
    ]:
        chosen = [case for case in cases if case[5] == aside]
        (arguments.out / f"{name}.toml").write_text(study(chosen, equal, what, seed, arguments.oblique))


if __name__ == "__main__":
    main()
