#!/usr/bin/env python3
"""Scores the macro-element of benches/law/element, and fits its universal constants to simulated paths.

    python3 benches/law/fit_element.py [--program target/release/asperity] [--more RUN TABLE]... [--strict RUN TABLE]...
        [--vector] [--fit] [--rounds N] [--held-out] [--write] [--detail]

From the paths and tables of fixtures/paths, and runs with a table each besides, to element/element_constants.h in one command: --fit
--write. What is made small is the mean over all paths of e^8/(1 + e^8), where e = 1 is the aim of `asperity law check`, 5 % rms and
12 % at worst in F_T and F_N, of a --strict run a third of it: a path far outside of it pulls no more than one that may come in.
Paths with a mesh error above 2.5 % (fixtures/paths/errors.csv) are told and not counted. Constants move in turns by steps that
shrink. --held-out leaves out one material at a time, and scores it by the constants of the others. Needs gcc.
"""

import argparse
import csv
import json
import math
import pathlib
import re
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
ELEMENT = HERE / "element"
PATHS = HERE.parent.parent / "fixtures" / "paths"
sys.path.insert(0, str(PATHS))
from make import at_the_limit  # noqa: E402

AIMS = 0.05, 0.12
STRICT = 1 / 3
# h, the two of delta_T, F_N, the two of F_T; what has no name is 0.
ROW = "h", "delta_T", "", "F_N", "F_T", ""
MESH = 2.5  # per cent
# What each constant is, and the range in which it means something.
CONSTANTS = {
    "LOSS": (0.1, 3.0, "A = this c r^3/(r + the next): share of the yield force that a steady press loses at r = F_T/F_N"),
    "LOSS_SMALL": (0.0, 1.0, "the r below which it loses less than with r^2"),
    "LOSS_MOST": (0.1, 1.0, "greatest A over what the table's shear loses at the same r"),
    "VERTEX_FLOW": (0.0, 3.0, "slip at the vertex over dh_p, of a contact that is all plastic"),
    "VERTEX_FADES": (0.0, 40.0, "it fades with exp(-this (D/h)^2)"),
    "VERTEX_LENGTH": (0.2, 8.0, "dh_p over mu P/k_T in which the vertex follows r"),
    "VERTEX_ROUND": (0.05, 0.6, "distance over mu within which its direction is rounded"),
    "BEYOND": (0.0, 2.0, "slope of its loss beyond the shear's end, over the mean slope before"),
    "BEYOND_FADES": (0.0, 4.0, "its power of 1 - D/h"),
    "RADIAL": (0.0, 0.5, "radial slip of a press over dh_p, of a contact that is all plastic"),
    "RADIAL_FADES": (0.0, 4.0, "its power of 1 - D/h"),
    "RADIAL_MOST": (0.0, 1.0, "greatest radial force of a slider over its limit"),
    "FIRST": (0.3, 2.0, "n - 1 of a first reversal over that of the table"),
    "FIRST_MOST": (0.1, 0.6, "the greatest such n - 1"),
    "LATER": (0.05, 0.5, "n - 1 of reversals after the first, at most, at mu = 0.3"),
    "LATER_MU": (0.0, 1.5, "its power of mu"),
    "UNSHEARED": (1.0, 5.0, "n of a contact that is not sheared and all plastic"),
    "FORGETS": (0.0, 10.0, "how fast a press takes back how far it was sheared, over dh_p/D"),
    "RELEASED": (0.0, 0.4, "share of the yield force that a whole release takes, of a contact that is all plastic"),
    "RECOVERS": (10.0, 3000.0, "how fast a press gives it back"),
    "WIDENS": (0.0, 0.5, "growth of the contact radius over delta_T_end/a0 that is in a table's unloading"),
    "STIFFENS": (0.0, 3.0, "power of that growth that is in its k_T"),
    "NARROWS": (0.02, 10.0, "dh_p/D in which a press makes the contact as wide as F_N has it"),
    "COARSE": (-0.2, 0.5, "power of (h/D over the next) by which the c of a table on a coarse mesh is too small, times 1 - 0.1/mu"),
    "COARSE_FROM": (2.0, 12.0, "the h/D at which it is right"),
    "BEND": (0.0, 3.0, "how c changes with r, over what is recovered of h"),
    "BEND_FROM": (0.0, 0.4, "the recovered share at which it does not"),
}


def exported(args, law, folder):
    """The table's file that `law export` writes of a law, and the header beside it."""
    folder.mkdir()
    command = [args.program, "law", "export", law, "--format", "c", "--out", folder]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return folder / "law.asperity", folder / "asperity_contact.h"


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


def constants():
    text = (ELEMENT / "element_constants.h").read_text()
    return {name: float(re.search(rf"#define ELEMENT_{name} (\S+)", text).group(1)) for name in CONSTANTS}


def header(values):
    """element_constants.h, of numbers or of C expressions."""
    lines = ["/* Universal constants of the element, as benches/law/fit_element.py --fit --write has made them. */"]
    lines += ["#ifndef ASPERITY_ELEMENT_CONSTANTS_H", "#define ASPERITY_ELEMENT_CONSTANTS_H", ""]
    lines += [f"#define ELEMENT_{name} {values[name]} /* {CONSTANTS[name][2]} */" for name in CONSTANTS]
    return "\n".join([*lines, "", "#endif", ""])


class Driver:
    """The element with its constants as variables, and all paths in it."""

    def __init__(self, args, work):
        contacts = [(*contact, 1.0) for contact in protocol()]
        contacts += [(*contact, 1.0) for contact in vectors()] if args.vector else []
        contacts += [(*more(*pair), 1.0) for pair in args.more] + [(*more(*pair), STRICT) for pair in args.strict]
        mesh = {}
        with open(PATHS / "errors.csv", newline="") as table:
            for row in csv.DictReader(table):
                mesh[row["contact"], row["path"]] = max(float(row["F_N"]), float(row["F_T"]))
        self.paths, tables, lines = [], [], []
        for number, (name, law, paths, aim) in enumerate(contacts):
            table, contact = exported(args, law, work / f"contact-{number}")
            tables.append(table)
            for path, rows in paths.items():
                self.paths.append((name, path, rows, aim, mesh.get((name, path), 0.0) <= MESH))
                lines.append(f"{number} {len(rows)}")
                lines.extend(f"{row[0]!r} {row[1]!r} {row[2]!r}" for row in rows)
        sources = [contact, ELEMENT / "asperity_element.h", ELEMENT / "element_table.h", ELEMENT / "element_drive.c"]
        for source in sources:
            (work / source.name).write_text(source.read_text())
        (work / "element_constants.h").write_text(header({name: f"constants[{i}]" for i, name in enumerate(CONSTANTS)}))
        command = ["gcc", "-std=c99", "-O2", "-march=native", f"-DELEMENT_FIT={len(CONSTANTS)}", work / "element_drive.c"]
        subprocess.run([*command, "-o", work / "drive", "-lm"], check=True)
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
        self.driver = subprocess.Popen([work / "drive", str(args.increments), *tables], **pipes)
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


def fit(driver, start, taken, rounds):
    """Constants that make the cost of the paths `taken` small."""
    best, least = dict(start), cost(driver, driver.scores(start), taken)
    steps = {name: 0.12 * max(abs(value), 0.1) for name, value in start.items()}
    for number in range(rounds):
        for name, (low, high, _) in CONSTANTS.items():
            for sign in (1, -1):
                trial = dict(best)
                trial[name] = float(f"{min(max(best[name] + sign * steps[name], low), high):.5g}")
                found = cost(driver, driver.scores(trial), taken) if trial != best else least
                if found < least - 1e-7:
                    best, least, steps[name] = trial, found, 1.4 * sign * steps[name]
                    break
            else:
                steps[name] *= 0.5
        print(f"round {number + 1}: {least:.4f}", file=sys.stderr, flush=True)
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
    parser.add_argument("--program", default="target/release/asperity")
    parser.add_argument("--more", nargs=2, action="append", default=[], metavar=("RUN", "TABLE"))
    parser.add_argument("--strict", nargs=2, action="append", default=[], metavar=("RUN", "TABLE"))
    parser.add_argument("--vector", action="store_true", help="the paths of fixtures/paths/vector too, where nothing twists or rolls")
    parser.add_argument("--increments", type=int, default=8, help="between two simulated places")
    parser.add_argument("--rounds", type=int, default=8)
    parser.add_argument("--fit", action="store_true")
    parser.add_argument("--held-out", action="store_true")
    parser.add_argument("--write", action="store_true", help="the fitted constants into element_constants.h")
    parser.add_argument("--detail", action="store_true", help="each path: F_T rms, worst, F_N rms, worst in per cent")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        driver = Driver(args, pathlib.Path(folder))
        start, everything = constants(), [True] * len(driver.paths)
        scores = driver.scores(start)
        print(f"as it is, cost {cost(driver, scores, everything):.4f}")
        told(driver, scores, args.detail)
        if args.held_out:
            held = [None] * len(driver.paths)
            group = lambda name: name.split("-mu-")[0] if "-mu-" in name else "other"
            for material in sorted({group(path[0]) for path in driver.paths}):
                taken = [group(path[0]) != material for path in driver.paths]
                values, _ = fit(driver, start, taken, args.rounds)
                for index, one in enumerate(driver.scores(values)):
                    held[index] = held[index] if taken[index] else one
            print("each material by the constants of the others")
            told(driver, held, args.detail)
        if args.fit:
            values, least = fit(driver, start, everything, args.rounds)
            print(f"fitted, cost {least:.4f}")
            told(driver, driver.scores(values), args.detail)
            for name, value in values.items():
                print(f"{name:14} {start[name]:9.4g} -> {value:.4g}")
            if args.write:
                (ELEMENT / "element_constants.h").write_text(header(values))


if __name__ == "__main__":
    main()
