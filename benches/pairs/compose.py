#!/usr/bin/env python3
"""The study of pairs against what may stand in for each pair.

    cargo build --release
    asperity study fixtures/studies/pairs.toml --out pairs
    python3 benches/pairs/compose.py pairs OUT [--base plane] [--own 2,7]

For each pair and friction: two equal spheres with R*, E* and the hardening of the weaker body, simulated; the two
bodies in series, `asperity law compose`, from tables of each body against its equal (--base plane: on a rigid plane);
and for the pairs named by --own the pair's own table, `asperity law tabulate`. Errors in per cent: F_N0 of itself, a0
likewise, F_T along the shear of its peak (rms and greatest), F_N of F_N0. The series and the tables are asked for h
alone. Half an hour of processor time; what is in OUT already is not computed again. Standard library only.
"""

import argparse
import csv
import json
import math
import subprocess
import tomllib
from pathlib import Path

PROGRAM = Path(__file__).resolve().parents[2] / "target/release/asperity"
ASIDE = (7, 10)


def asperity(*arguments):
    command = [str(PROGRAM), *map(str, arguments)]
    return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout


def inline(value):
    """A TOML value on one line."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {inline(item)}" for key, item in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(inline, value)) + "]"
    if isinstance(value, bool):
        return str(value).lower()
    return json.dumps(value) if isinstance(value, str) else repr(float(value)) if isinstance(value, float) else str(value)


def text_of(radius, material, friction, opponent, path, zone=1.3):
    lines = ["[sphere]", f"radius = {radius!r}", "[contact]", f"friction = {friction!r}"]
    top = [f"material = {inline(material)}", f"path = {inline(path)}"]
    if opponent:
        top.append(f"opponent = {inline(opponent)}")
    settings = ["[mesh]", "elements_per_contact_radius = 6", f"fine_zone = {zone}", "[solver]", "error_estimate = false",
                "[output]", "plots = false", "fields = \"none\""]
    return "\n".join(top + lines + settings) + "\n"


def tabulated(out, text):
    """The law.json of a case, made once."""
    law = out / "law.json"
    if not law.exists():
        out.parent.mkdir(parents=True, exist_ok=True)
        file = out.with_name(out.name + ".toml")
        file.write_text(text)
        asperity("law", "tabulate", file, "--out", out, "--elements", 6, "--force", "-q")
    return law


def yield_stress(material):
    hardening, e = material["hardening"], material["youngs_modulus"]
    if hardening["law"] == "elastic":
        return math.inf
    if hardening["law"] == "hollomon":
        m = hardening["exponent"]
        return e * (hardening["coefficient"] / e) ** (m / (m - 1))
    return hardening["yield_stress"]


def history(directory):
    """a0, F_N0, and delta_T, F_T, F_N of the shear, its start first."""
    rows = list(csv.DictReader((directory / "history.csv").open()))
    pressed = [row for row in rows if row["segment"] == "0"][-1]
    shear = [row for row in rows if row["segment"] == "1"]
    curve = [(0.0, 0.0, float(pressed["F_N"]))] + [tuple(float(row[k]) for k in ("delta_T", "F_T", "F_N")) for row in shear]
    return float(pressed["a"]), curve


def predicted(law, file):
    rows = [row for row in csv.DictReader(asperity("law", "predict", law, file).splitlines()) if row["segment"] == "1"]
    return [tuple(float(row[k]) for k in ("delta_T", "F_T", "F_N")) for row in rows]


def radius_at(law, h):
    """a0 of a table at h over R, straight between the logarithms."""
    levels = json.loads(law.read_text())["levels"]
    points = [(math.log(level["h"]), math.log(level["a0"])) for level in levels]
    i = next((i for i in range(1, len(points) - 1) if points[i][0] >= math.log(h)), len(points) - 1)
    (x0, y0), (x1, y1) = points[i - 1], points[i]
    return math.exp(y0 + (y1 - y0) * (math.log(h) - x0) / (x1 - x0))


def at(curve, delta):
    for before, after in zip(curve, curve[1:]):
        if after[0] >= delta:
            u = (delta - before[0]) / (after[0] - before[0]) if after[0] > before[0] else 1.0
            return [before[k] + u * (after[k] - before[k]) for k in (1, 2)]
    return curve[-1][1:]


def rms(values):
    return math.sqrt(sum(value * value for value in values) / len(values))


def errors(simulated, a, curve):
    """F_N0, a0, F_T rms and greatest, F_N rms, in per cent."""
    a0, truth = simulated
    f_n0, peak = truth[0][2], max(point[1] for point in truth)
    off = [[(ours - theirs) / scale for ours, theirs, scale in zip(at(curve, d), forces, (peak, f_n0))] for d, *forces in truth[1:]]
    f_t, f_n = zip(*off)
    return [100 * x for x in (curve[0][2] / f_n0 - 1, a / a0 - 1, rms(f_t), max(map(abs, f_t)), rms(f_n))]


def stand_in(case):
    """Two equal spheres with R*, E* and the hardening of the weaker body."""
    one, two = case["material"], case["opponent"]["material"]
    weaker = min((one, two), key=yield_stress)
    compliance = sum((1 - m["poissons_ratio"] ** 2) / m["youngs_modulus"] for m in (one, two))
    modulus = 2 * (1 - weaker["poissons_ratio"] ** 2) / compliance
    other = case["opponent"].get("radius")
    star = case["sphere"]["radius"] if other is None else 1 / (1 / case["sphere"]["radius"] + 1 / other)
    return text_of(2 * star, dict(weaker, youngs_modulus=modulus), case["contact"]["friction"], {"equal": True}, case["path"], 1.6)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("study", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--base", choices=("equal", "plane"), default="equal")
    parser.add_argument("--own", default="")
    parser.add_argument("--each", action="store_true", help="print every case")
    arguments = parser.parse_args()
    out, own = arguments.out, [int(n) for n in arguments.own.split(",") if n]
    pairs, results = [], {}
    for row in csv.DictReader((arguments.study / "study.csv").open()):
        directory = arguments.study / row["directory"]
        case = tomllib.loads((directory / "case.toml").read_text())
        key = (row["material"], row["opponent"])
        pairs += [key] * (key not in pairs)
        number, mu, h = pairs.index(key) + 1, case["contact"]["friction"], case["path"][0]["indentation"]
        simulated = history(directory)
        ours = {}
        # R*, E* and the weaker.
        place = out / "stand-ins" / row["case"]
        if not (place / "summary.json").exists():
            place.parent.mkdir(parents=True, exist_ok=True)
            file = place.with_name(place.name + ".toml")
            file.write_text(stand_in(case))
            asperity("run", file, "--out", place, "--force", "-q")
        ours["weaker"] = errors(simulated, *history(place))
        # In series.
        base = {"equal": {"equal": True}, "plane": None}[arguments.base]
        tables = []
        for material in (case["material"], case["opponent"]["material"]):
            name = "-".join(str(x) for x in (arguments.base, mu, material["youngs_modulus"], *material["hardening"].values()))
            deepest = [{"indentation": 0.06 if base else 0.04}]
            tables.append(tabulated(out / "bodies" / name, text_of(1.0, material, mu, base, deepest)))
        composed = out / "series" / f"{arguments.base}-{number}-{mu}"
        deepest = [{"indentation": 0.03}]
        pair = text_of(case["sphere"]["radius"], case["material"], mu, case["opponent"], deepest)
        if not (composed / "law.json").exists():
            composed.parent.mkdir(parents=True, exist_ok=True)
            file = composed.with_name(composed.name + ".toml")
            file.write_text(pair)
            asperity("law", "compose", file, *tables, "--out", composed)
        laws = {"series": composed / "law.json"}
        if number in own and mu == 0.3:
            laws["own"] = tabulated(out / "own" / f"{number}-{mu}", pair)
        for name, law in laws.items():
            a = radius_at(law, h / case["sphere"]["radius"]) * case["sphere"]["radius"]
            ours[name] = errors(simulated, a, predicted(law, directory / "case.toml"))
        for name, values in ours.items():
            results.setdefault(name, {}).setdefault(number, []).append(values)
            if arguments.each:
                told = f"{values[0]:+6.1f} {values[1]:+6.1f} {values[2]:6.1f} {values[3]:6.1f} {values[4]:6.1f}"
                print(f"{number:>2} mu {mu} h {h:.3f} {name:>7}: {told}", flush=True)
    count = len(pairs)
    groups = [(str(n), [n]) for n in range(1, count + 1)]
    groups += [("all", range(1, count + 1)), ("set aside", ASIDE), ("the others", [n for n in range(1, count + 1) if n not in ASIDE])]
    print("rms over the cases of a pair (greatest), per cent\n")
    print("| pair | law | F_N0 | a0 | F_T along the shear | F_N along the shear |\n|---|---|---|---|---|---|")
    for title, members in groups:
        for name, found in results.items():
            rows = [values for n in members for values in found.get(n, [])]
            if rows:
                column = [[row[k] for row in rows] for k in range(5)]
                told = [f"{rms(column[k]):.1f} ({max(map(abs, column[worst])):.1f})" for k, worst in ((0, 0), (1, 1), (2, 3), (4, 4))]
                print(f"| {title} | {name} | {' | '.join(told)} |")


main()
