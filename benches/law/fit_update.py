#!/usr/bin/env python3
"""Fits the universal constants of the contact update to simulated paths.

    python3 benches/law/fit_update.py [--program target/release/asperity] [--more RUN TABLE]... [--rounds N] [--held-out]

From the paths and tables of fixtures/paths (and runs with a table each besides) to the constants of src/contact_law, in one
command. The update is the exported C header, in which the constants are made variables, driven by 64 increments between two
simulated places. What is made small is the mean over all paths of e^2/(1 + e^2), where e = 1 is the aim of `asperity law check`,
5 % rms and 12 % at worst in F_T and F_N: a path far outside of it pulls no more than one that may come in. Constants move in
turns by steps that shrink. --held-out leaves out one material at a time, and scores it by the constants of the others. Needs gcc.
"""

import argparse
import csv
import math
import pathlib
import re
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
PATHS = HERE.parent.parent / "fixtures" / "paths"
sys.path.insert(0, str(PATHS))
from make import at_the_limit  # noqa: E402

INCREMENTS = 64
AIMS = 0.05, 0.12
# Each with the range in which it means something.
CONSTANTS = {
    "PRESSED": (0.0, 1.5),
    "LEAST_NORMAL": (0.02, 0.8),
    "SUDDEN": (0.0, 0.6),
    "FORGETS": (0.0, 20.0),
    "RELAXATION": (0.005, 50.0),
    "REVERSED": (0.0, 0.3),
    "GATHERED": (0.05, 3.0),
    "TAKEN_BACK": (0.0, 1.2),
    "NO_CHANGE": (-0.5, 0.8),
    "FIRST": (1.0, 3.0),
    "LATER": (1.0, 2.0),
    "UNSHEARED": (1.2, 4.0),
}
DRIVER = r"""
static double constants[%d];
#include "asperity_contact.h"
static asperity_table tables[64];
static double places[400000][2];
static int of[1000], counts[1000];
int main(int argc, char **argv) {
    int n, i, k, contacts = argc - 1, paths = 0, all = 0;
    for (i = 0; i < contacts; i++) {
        if (asperity_read_table(argv[i + 1], &tables[i]) != 0) {
            fprintf(stderr, "%%s cannot be read\n", argv[i + 1]);
            return 2;
        }
    }
    if (scanf("%%d", &paths) != 1) {
        return 2;
    }
    for (n = 0; n < paths; n++) {
        if (scanf("%%d %%d", &of[n], &counts[n]) != 2) {
            return 2;
        }
        for (i = 0; i < counts[n]; i++, all++) {
            if (scanf("%%lf %%lf", &places[all][0], &places[all][1]) != 2) {
                return 2;
            }
        }
    }
    for (;;) {
        for (i = 0; i < %d; i++) {
            if (scanf("%%lf", &constants[i]) != 1) {
                return 0;
            }
        }
        for (n = 0, all = 0; n < paths; n++) {
            asperity_state state;
            asperity_response out;
            double h0 = 0.0, d0 = 0.0;
            memset(&state, 0, sizeof state);
            for (i = 0; i < counts[n]; i++, all++) {
                double h = places[all][0], d = places[all][1];
                for (k = 1; k <= %d; k++) {
                    double increment[2] = {(d - d0) / %d, 0.0};
                    asperity_update(&tables[of[n]], 1.0, 1.0, &state, h0 + (h - h0) * k / %d, increment, &state, &out, NULL);
                }
                printf("%%.9g %%.9g\n", out.f_n, out.f_t[0]);
                h0 = h;
                d0 = d;
            }
        }
        fflush(stdout);
    }
}
"""


def text_of(args, law, folder):
    """The table's file and the header that `law export` writes of a law."""
    folder.mkdir()
    command = [args.program, "law", "export", law, "--format", "c", "--out", folder]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return folder / "law.asperity", (folder / "asperity_contact.h").read_text()


def protocol():
    """(contact, table, {path: rows}) of fixtures/paths."""
    for file in sorted(PATHS.glob("*-mu-*.csv")):
        found = {}
        with open(file, newline="") as table:
            for row in csv.DictReader(table):
                found.setdefault(row["path"], []).append([float(row[name]) for name in ("h", "delta_T", "F_N", "F_T")])
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
    return pathlib.Path(run).name, table, {"path": [[float(x) * unit for x, unit in zip(row[1:], units)] for row in found]}


class Update:
    """The driver, with all paths in it."""

    def __init__(self, args, work):
        contacts = list(protocol()) + [more(*pair) for pair in args.more]
        self.paths, tables, lines = [], [], []
        for number, (name, law, paths) in enumerate(contacts):
            table, header = text_of(args, law, work / f"contact-{number}")
            tables.append(table)
            for path, rows in paths.items():
                self.paths.append((name, path, rows))
                lines.append(f"{number} {len(rows)}")
                lines.extend(f"{row[0]!r} {row[1]!r}" for row in rows)
        self.start = []
        for index, name in enumerate(CONSTANTS):
            line = re.compile(rf"#define ASPERITY_{name} ASPERITY_R\(([-0-9.e]+)\)")
            self.start.append(float(line.search(header).group(1)))
            header = line.sub(f"#define ASPERITY_{name} ASPERITY_R(constants[{index}])", header)
        (work / "asperity_contact.h").write_text(header)
        count = len(CONSTANTS)
        (work / "driver.c").write_text(DRIVER % (count, count, INCREMENTS, INCREMENTS, INCREMENTS))
        command = ["gcc", "-std=c99", "-O2", "-march=native", "-I", work, work / "driver.c", "-o", work / "driver", "-lm"]
        subprocess.run(command, check=True)
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
        self.driver = subprocess.Popen([work / "driver", *tables], **pipes)
        self.driver.stdin.write(f"{len(self.paths)}\n" + "\n".join(lines) + "\n")

    def scores(self, constants):
        """(F_T rms, worst, F_N rms, worst) of each path."""
        self.driver.stdin.write(" ".join(map(repr, constants)) + "\n")
        self.driver.stdin.flush()
        return [score(rows, [self.driver.stdout.readline() for _ in rows]) for _, _, rows in self.paths]


def score(rows, lines):
    """Errors over the greatest force of the path."""
    greatest = max(row[2] for row in rows)
    answers = [[float(word) for word in line.split()] for line in lines]
    found = []
    for force, component in ((3, 1), (2, 0)):
        peak = max(0.01 * greatest, max(abs(row[force]) for row in rows))
        errors = [abs(answer[component] - row[force]) / peak for row, answer in zip(rows, answers)]
        found += [math.sqrt(sum(e * e for e in errors) / len(errors)), max(errors)]
    return found


def beyond(one):
    """1 at the aim."""
    return max(one[0] / AIMS[0], one[1] / AIMS[1], one[2] / AIMS[0], one[3] / AIMS[1])


def cost(scores):
    squares = [beyond(one) ** 2 for one in scores]
    return sum(x / (1 + x) for x in squares) / len(squares)


def fit(update, start, taken, rounds):
    """Constants that make the cost of the paths `taken` small."""
    at = lambda constants: cost([one for one, counts in zip(update.scores(constants), taken) if counts])
    best, least = list(start), at(start)
    steps = [0.3 * max(abs(value), 0.1) for value in start]
    for _ in range(rounds):
        for index, (low, high) in enumerate(CONSTANTS.values()):
            for sign in (1, -1):
                trial = list(best)
                trial[index] = min(max(trial[index] + sign * steps[index], low), high)
                found = at(trial) if trial != best else least
                if found < least - 1e-9:
                    best, least, steps[index] = trial, found, 1.5 * steps[index]
                    break
            else:
                steps[index] *= 0.5
    return best, least


def told(update, scores):
    """By kind of path, and of all."""
    kinds = {}
    for (name, path, _), one in zip(update.paths, scores):
        kinds.setdefault(path, []).append(one)
    for kind, ones in kinds.items():
        within = sum(beyond(one) <= 1 for one in ones)
        rms = [100 * math.sqrt(sum(one[i] ** 2 for one in ones) / len(ones)) for i in (0, 2)]
        worst = [100 * max(one[i] for one in ones) for i in (1, 3)]
        print(f"{kind:32} {within:3} of {len(ones):3}  F_T {rms[0]:5.2f} ({worst[0]:5.1f})  F_N {rms[1]:5.2f} ({worst[1]:5.1f})")
    rms = [100 * math.sqrt(sum(one[i] ** 2 for one in scores) / len(scores)) for i in (0, 2)]
    print(f"all: {sum(beyond(one) <= 1 for one in scores)} of {len(scores)}, F_T {rms[0]:.2f}, F_N {rms[1]:.2f} % rms\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="target/release/asperity")
    parser.add_argument("--more", nargs=2, action="append", default=[], metavar=("RUN", "TABLE"))
    parser.add_argument("--rounds", type=int, default=12)
    parser.add_argument("--held-out", action="store_true")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        update = Update(args, pathlib.Path(folder))
        start = update.start
        print("as they are")
        told(update, update.scores(start))
        if args.held_out:
            materials = sorted({name.split("-mu-")[0] for name, _, _ in update.paths})
            held = [None] * len(update.paths)
            for material in materials:
                taken = [name.split("-mu-")[0] != material for name, _, _ in update.paths]
                constants, _ = fit(update, start, taken, args.rounds)
                for index, one in enumerate(update.scores(constants)):
                    held[index] = held[index] if taken[index] else one
            print("each material by the constants of the others")
            told(update, held)
        constants, least = fit(update, start, [True] * len(update.paths), args.rounds)
        print(f"fitted, cost {least:.4f}")
        told(update, update.scores(constants))
        for name, before, value in zip(CONSTANTS, start, constants):
            print(f"{name:14} {before:9.4g} -> {value:.4g}")


if __name__ == "__main__":
    main()
