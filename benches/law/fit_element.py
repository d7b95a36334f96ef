#!/usr/bin/env python3
"""Scores the contact update, and fits its universal constants to simulated paths.

    python3 benches/law/fit_element.py [--more RUN TABLE]... [--strict RUN TABLE]... [--vector] [--random FOLDER]...
        [--no-random] [--fit] [--evaluations N] [--held-out] [--write] [--detail]

From the paths and tables of fixtures/paths, its random paths by the built-in law, and runs with a table each besides, to
src/contact_law/constants.rs in one command: --fit --write. What is made small is the mean over all paths of e^8/(1 + e^8), where e = 1 is the aim of `asperity law check`, 5 % rms and
12 % at worst in F_T and F_N, of a --strict run a third of it: a path far outside of it pulls no more than one that may come in.
Paths with a mesh error above 2.5 % (fixtures/paths/errors.csv) are told and not counted. Constants are searched for by CMA-ES
(`pip install cma`), from those of the source. --held-out leaves out one material at a time, or one seed of the random paths, and
scores it by the constants of the others. Builds benches/law_element.rs.
"""

import argparse
import csv
import json
import math
import pathlib
import re
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
SOURCE = ROOT / "src" / "contact_law" / "constants.rs"
PATHS = ROOT / "fixtures" / "paths"
sys.path.insert(0, str(PATHS))
import fitted  # noqa: E402
from make import at_the_limit  # noqa: E402

AIMS = 0.05, 0.12
STRICT = 1 / 3
# h, the two of delta_T, F_N, the two of F_T; what has no name is 0.
ROW = "h", "delta_T", "", "F_N", "F_T", ""
MESH = 2.5  # per cent
# The range in which each constant means something, in the order of the source.
CONSTANTS = {
    "loss": (0.1, 3.0),
    "loss_small": (0.0, 1.0),
    "loss_most": (0.1, 1.0),
    "vertex_flow": (0.0, 3.0),
    "vertex_fades": (0.0, 40.0),
    "vertex_length": (0.2, 8.0),
    "vertex_round": (0.05, 0.6),
    "beyond": (0.0, 2.0),
    "beyond_fades": (0.0, 4.0),
    "radial": (0.0, 0.5),
    "radial_fades": (0.0, 4.0),
    "radial_most": (0.0, 1.0),
    "first": (0.3, 2.0),
    "first_most": (0.1, 0.6),
    "later": (0.05, 0.5),
    "later_mu": (0.0, 1.5),
    "unsheared": (1.0, 5.0),
    "forgets": (0.0, 10.0),
    "follows": (0.02, 0.02),
    "released": (0.0, 0.4),
    "recovers": (10.0, 3000.0),
    "widens": (0.0, 0.5),
    "stiffens": (0.0, 3.0),
    "narrows": (0.02, 10.0),
    "bend": (0.0, 3.0),
    "bend_from": (0.0, 0.4),
}


def protocol():
    """(contact, table, {path: rows}) of fixtures/paths."""
    for file in sorted(PATHS.glob("*-mu-*.csv")):
        found = {}
        with open(file, newline="") as table:
            for row in csv.DictReader(table):
                found.setdefault(row["path"], []).append([float(row[name]) if name else 0.0 for name in ROW])
        yield file.stem, file.with_suffix(".json"), found


def more(run, table):
    """The same of a run, over the R and the E of its case. That the line of centres of a pair turns as it is sheared is left out."""
    text = (pathlib.Path(run) / "case.toml").read_text()
    number = lambda key: float(re.search(rf"^{key} = (\S+)", text, re.M).group(1))
    radius, modulus = number("radius"), number("youngs_modulus")
    with open(pathlib.Path(run) / "history.csv", newline="") as history:
        rows = [row for row in csv.DictReader(history) if int(row["step"]) > 0]
    found, _ = at_the_limit(rows)
    units = 1 / radius, 1 / radius, 1 / (modulus * radius**2), 1 / (modulus * radius**2)
    rows = [[float(x) * unit for x, unit in zip(row[1:], units)] for row in found]
    return pathlib.Path(run).name, table, {"other runs": [[h, d, 0.0, f_n, f_t, 0.0] for h, d, f_n, f_t in rows]}


def drawn(folder):
    """(contact, contact, {path: rows}) of random paths as fixtures/paths/random has them, and the errors of their mesh in per cent."""
    errors, found = {}, {}
    with open(folder / "errors.csv", newline="") as table:
        for row in csv.DictReader(table):
            known = row["F_N"] != "unknown"
            errors[row["seed"], row["number"]] = row["path"], max(float(row["F_N"]), float(row["F_T"])) if known else math.inf
    with open(folder / "paths.csv", newline="") as table:
        for row in csv.DictReader(table):
            found.setdefault((row["seed"], row["number"]), []).append([float(row[name]) if name else 0.0 for name in ROW])
    for (seed, number), rows in found.items():
        path, error = errors[seed, number]
        yield (f"seed {seed}, number {number}", f"drawn:{seed}:{number}", {path: rows}), error


def vectors():
    """(contact, table, {path: rows}) of fixtures/paths/vector, as far as nothing twists or rolls."""
    for file in sorted((PATHS / "vector").glob("*-mu-*.csv")):
        found, turned = {}, set()
        with open(file, newline="") as table:
            for row in csv.DictReader(table):
                if any(abs(float(row[name])) > 1e-12 for name in ("twist", "roll_x", "roll_y")):
                    turned.add(row["path"])
                names = "h", "delta_T", "delta_T_y", "F_N", "F_T", "F_T_y"
                found.setdefault(row["path"], []).append([float(row[name]) for name in names])
        yield file.stem, (PATHS / file.name).with_suffix(".json"), {k: v for k, v in found.items() if k not in turned}


def program():
    """The program that drives the update, built."""
    command = ["cargo", "build", "--bench", "law_element", "--message-format", "json"]
    built = subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True).stdout.splitlines()
    found = [json.loads(line) for line in built if '"law_element"' in line]
    return next(one["executable"] for one in found if one.get("executable"))


class Driver:
    """The update with its constants as variables, and all paths in it."""

    def __init__(self, args):
        contacts, mesh = [(*contact, 1.0) for contact in protocol()], {}
        contacts += [(*contact, 1.0) for contact in vectors()] if args.vector else []
        for folder in [] if args.no_random else args.random or [PATHS / "random"]:
            for contact, error in drawn(folder):
                contacts.append((*contact, 1.0))
                mesh[contact[0], next(iter(contact[2]))] = error
        contacts += [(*more(*pair), 1.0) for pair in args.more] + [(*more(*pair), STRICT) for pair in args.strict]
        with open(PATHS / "errors.csv", newline="") as table:
            for row in csv.DictReader(table):
                mesh[row["contact"], row["path"]] = max(float(row["F_N"]), float(row["F_T"]))
        self.paths, tables, lines = [], [], []
        for number, (name, law, paths, aim) in enumerate(contacts):
            tables.append(law)
            for path, rows in paths.items():
                self.paths.append((name, path, rows, aim, mesh.get((name, path), 0.0) <= MESH))
                lines.append(f"{number} {len(rows)}")
                lines.extend(f"{row[0]!r} {row[1]!r} {row[2]!r}" for row in rows)
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
        self.driver = subprocess.Popen([program(), str(args.increments), *tables], **pipes)
        self.driver.stdin.write(f"{len(self.paths)}\n" + "\n".join(lines) + "\n")

    def scores(self, values):
        """(F_T rms, worst, F_N rms, worst) of each path."""
        self.driver.stdin.write(" ".join(repr(values[name]) for name in CONSTANTS) + "\n")
        self.driver.stdin.flush()
        return [score(path[2], [self.driver.stdout.readline() for _ in path[2]]) for path in self.paths]


def score(rows, lines):
    """Errors over the greatest force of the path."""
    greatest = max(row[3] for row in rows)
    found, answers = [], [[float(word) for word in line.split()] for line in lines]
    for what in (slice(1, 3), slice(0, 1)):
        simulated = [row[3:][what] for row in rows]
        peak = max(0.01 * greatest, max(math.hypot(*force) for force in simulated))
        errors = [math.dist(answer[what], force) / peak for answer, force in zip(answers, simulated)]
        errors = [error if error < 10 else 10 for error in errors]
        found += [math.sqrt(sum(e * e for e in errors) / len(errors)), max(errors)]
    return found


def beyond(one):
    """1 at the aim."""
    return max(one[0] / AIMS[0], one[1] / AIMS[1], one[2] / AIMS[0], one[3] / AIMS[1])


def cost(driver, scores, taken):
    powers = [(beyond(one) / path[3]) ** 8 for one, path, counts in zip(scores, driver.paths, taken) if counts and path[4]]
    return sum(x / (1 + x) for x in powers) / len(powers)


def fit(driver, start, taken, evaluations):
    """Constants that make the cost of the paths `taken` small, by CMA-ES (Hansen, arXiv:1604.00772); the same each time."""
    import cma  # https://pypi.org/project/cma, needs numpy

    names = [name for name, (low, high) in CONSTANTS.items() if low < high]
    trial = lambda x: {**start, **{name: float(f"{value:.5g}") for name, value in zip(names, x)}}
    options = {
        "bounds": [list(ends) for ends in zip(*(CONSTANTS[name] for name in names))],
        "CMA_stds": [0.12 * max(abs(start[name]), 0.1) for name in names],
        "popsize": 16,
        "seed": 1,
        "maxfevals": evaluations,
        "verbose": -9,
    }
    best, least = dict(start), cost(driver, driver.scores(start), taken)
    search = cma.CMAEvolutionStrategy([start[name] for name in names], 0.5, options)
    while not search.stop():
        asked = search.ask()
        found = [cost(driver, driver.scores(trial(x)), taken) for x in asked]
        search.tell(asked, found)
        if min(found) < least:
            best, least = trial(asked[found.index(min(found))]), min(found)
        if search.countiter % 10 == 0:
            print(f"{search.countevals} evaluations: {least:.4f}", file=sys.stderr, flush=True)
    return best, least


def told(driver, scores, detail):
    """By kind of path, and of all."""
    kinds, counted = {}, []
    for path, one in zip(driver.paths, scores):
        kinds.setdefault(path[1], []).append((path, one))
        if path[4]:
            counted.append(one)
    line = lambda ones: (
        f"F_T {100 * math.sqrt(sum(one[0] ** 2 for one in ones) / len(ones)):5.2f} ({100 * max(one[1] for one in ones):5.1f})  "
        f"F_N {100 * math.sqrt(sum(one[2] ** 2 for one in ones) / len(ones)):5.2f} ({100 * max(one[3] for one in ones):5.1f})"
    )
    for kind, found in kinds.items():
        ones = [one for path, one in found if path[4]]
        print(f"{kind:32} {sum(beyond(one) <= 1 for one in ones):3} of {len(ones):3}  {line(ones)}")
        for path, one in found if detail or kind == "other runs" else []:
            note = "" if path[4] else "  not counted"
            print(f"    {path[0]:28} " + " ".join(f"{100 * x:5.1f}" for x in one) + (" *" if beyond(one) > 1 else "") + note)
    print(f"all: {sum(beyond(one) <= 1 for one in counted)} of {len(counted)}, {line(counted)}\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--more", nargs=2, action="append", default=[], metavar=("RUN", "TABLE"))
    parser.add_argument("--strict", nargs=2, action="append", default=[], metavar=("RUN", "TABLE"))
    parser.add_argument("--vector", action="store_true", help="the paths of fixtures/paths/vector too, where nothing twists or rolls")
    parser.add_argument("--random", type=pathlib.Path, action="append", help="folders of random paths in place of fixtures/paths/random")
    parser.add_argument("--no-random", action="store_true", help="the nine contacts alone")
    parser.add_argument("--increments", type=int, default=8, help="between two simulated places")
    parser.add_argument("--evaluations", type=int, default=1600, help="of all paths, for a fit; three in two seconds")
    parser.add_argument("--fit", action="store_true")
    parser.add_argument("--held-out", action="store_true")
    parser.add_argument("--write", action="store_true", help="the fitted constants into the source")
    parser.add_argument("--detail", action="store_true", help="each path: F_T rms, worst, F_N rms, worst in per cent")
    args = parser.parse_args()
    driver = Driver(args)
    start, everything = fitted.read(SOURCE, CONSTANTS), [True] * len(driver.paths)
    scores = driver.scores(start)
    print(f"as it is, cost {cost(driver, scores, everything):.4f}")
    told(driver, scores, args.detail)
    if args.held_out:
        held = [None] * len(driver.paths)
        group = lambda name: re.split("-mu-|, number", name)[0] if "-mu-" in name or ", number" in name else "other"
        for material in sorted({group(path[0]) for path in driver.paths}):
            taken = [group(path[0]) != material for path in driver.paths]
            values, _ = fit(driver, start, taken, args.evaluations)
            for index, one in enumerate(driver.scores(values)):
                held[index] = held[index] if taken[index] else one
        print("each material by the constants of the others")
        told(driver, held, args.detail)
    if args.fit:
        values, least = fit(driver, start, everything, args.evaluations)
        print(f"fitted, cost {least:.4f}")
        told(driver, driver.scores(values), args.detail)
        for name, value in values.items():
            print(f"{name:14} {start[name]:9.4g} -> {value:.5g}")
        if args.write:
            fitted.write(SOURCE, values)


if __name__ == "__main__":
    main()
