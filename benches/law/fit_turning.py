#!/usr/bin/env python3
"""Scores twist and roll of the contact update, and fits their universal constants to simulated paths.

    python3 benches/law/fit_turning.py [--program target/release/asperity] [--fit] [--rounds N] [--held-out] [--write] [--detail]

From the paths of fixtures/paths/vector that twist or roll and the tables of fixtures/paths to src/contact_law/turning_constants.rs:
--fit --write. What drives the update is its C header, compiled with gcc and with the constants as variables. What is made small is
the mean of e^2/(1 + e^2/12), where e = 1 is the aim of `asperity law check`, 5 % rms and 12 % at worst: of F_N, F_T and M_twist of
what twists, for the constants of the twist; of F_N, F_T and M_roll of the roll and F_N, F_T and M_twist of the impact, for those of
the roll. Constants move in turns by steps that shrink. --held-out leaves out one material at a time, and scores it by the constants
of the others. Levers and stiffness of a twist come from closed forms, which are printed first. Standard library only.
"""

import argparse
import csv
import ctypes
import math
import pathlib
import re
import subprocess
import tempfile

import fitted

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
LAW = ROOT / "src" / "contact_law"
SOURCE = LAW / "turning_constants.rs"
PATHS = ROOT / "fixtures" / "paths"
AIMS = 0.05, 0.12
PLACE = "h", "delta_T", "delta_T_y", "twist", "roll_x", "roll_y"
FORCES = "F_N", "F_T", "F_T_y", "M_twist", "M_roll_x", "M_roll_y"
# The range in which each constant means something, in the order of the source.
CONSTANTS = {
    "twist_yield": (0.1, 1.5),
    "twist_flow": (0.1, 1.5),
    "twist_worn": (1.0, 3.0),
    "twist_most": (0.5, 2.0),
    "roll_way": (0.02, 2.0),
    "roll_traction": (0.05, 5.0),
    "roll_leaves": (0.0, 3.0),
    "roll_moment": (0.1, 1.0),
    "roll_fades": (0.0, 3.0),
    "roll_stiff": (0.05, 1.0),
    "roll_softens": (0.0, 2.0),
    "roll_loss": (0.0, 0.8),
    "roll_loss_fades": (0.0, 4.0),
    "roll_slip": (0.0, 4.0),
    "roll_press": (0.0, 20.0),
    "roll_flow": (0.01, 4.0),
}
DRIVER = r"""
#include "asperity_turning.h"
double asperity_fit[%d];
static asperity_table tables[64];
int load(int k, const char *file) { return asperity_read_table(file, &tables[k]); }
void drive(int k, int count, const double *place, int increments, double *out) {
    asperity_state state;
    asperity_turning turning;
    asperity_response f;
    asperity_moments m;
    double at[6] = {0.0};
    int i, j, q;
    memset(&state, 0, sizeof state);
    memset(&turning, 0, sizeof turning);
    for (i = 0; i < count; i++, place += 6, out += 6) {
        double step[6];
        for (q = 0; q < 6; q++) {
            step[q] = (place[q] - at[q]) / increments;
        }
        for (j = 1; j <= increments; j++) {
            double turn[3] = {step[4], step[5], step[3]};
            asperity_update_turning(&tables[k], 1.0, 1.0, &state, &turning, at[0] + step[0] * j, step + 1, turn, &state, &turning, &f, &m, NULL);
        }
        memcpy(at, place, sizeof at);
        out[0] = f.f_n;
        out[1] = f.f_t[0];
        out[2] = f.f_t[1];
        out[3] = m.m_twist;
        out[4] = m.m_roll[0];
        out[5] = m.m_roll[1];
    }
}
"""


def closed_forms():
    """Levers, the sum of their weights times squares, the stiffness beside that along the plane, and the lever of a plastic contact."""
    ends = [(i / 7) ** 0.65 for i in range(1, 8)]
    total = ends[-1]
    ends = [0.0] + [end / total for end in ends]
    weights = [b - a for a, b in zip(ends, ends[1:])]
    raw = [math.sqrt((b**3 - a**3) / (b - a)) for a, b in zip(ends, ends[1:])]

    def held(levers, n):
        cells = [(i / 7) ** (0.65 / (n - 1)) for i in range(1, 8)]
        above = [end * cell for end, cell in zip(ends[1:], cells)]
        lost = [(n - 1) / n * (b - a) / w for a, b, w in zip([0.0] + above, above, weights)]
        limits = [w * (1 - x) for w, x in zip(weights, lost)]
        return sum(limit * lever for limit, lever in zip(limits, levers)) / sum(limits)

    scale = 3 * math.pi / 16 / held(raw, 1.5)
    levers = [scale * lever for lever in raw]
    squared = sum(w * lever**2 for w, lever in zip(weights, levers))
    return levers, squared, (16 / 3) / (8 / 1.7) / squared, held(levers, 1.25)


def headers(folder):
    """The C headers with their places filled, the constants as variables."""
    element = (LAW / "constants.rs").read_text()
    numbers = {name.upper(): value for name, value in re.findall(r"^ +(\w+): ([-0-9.e]+),", element, re.M)}
    numbers |= dict(re.findall(r"pub const (ROWS|LEVELS|PLACES): usize = (\d+);", (LAW / "table.rs").read_text()))
    source = SOURCE.read_text()
    numbers |= dict(re.findall(r"const (\w+): f64 = ([0-9.]+);", source))
    levers = re.search(r"LEVERS: \[f64; SLIDERS\] = \[(.*?)\]", source, re.S).group(1)
    numbers |= {"LEVERS": levers.strip().rstrip(","), "VERSION": "fitted"}
    numbers |= {name.upper(): f"asperity_fit[{i}]" for i, name in enumerate(CONSTANTS)}
    export = LAW / "export"
    names = re.findall(r"^#define (\w+) ", (export / "asperity_wide_names.h").read_text(), re.M)
    numbers["WIDE_END"] = "\n".join(f"#undef {name}" for name in names)
    for header in export.glob("*.h"):
        text = re.sub(r"@(\w+)@", lambda found: numbers[found.group(1)], header.read_text())
        (folder / header.name).write_text(f"extern double asperity_fit[{len(CONSTANTS)}];\n" + text)


class Driver:
    """The update in C with its constants as variables, and all paths that twist or roll."""

    def __init__(self, program, increments):
        self.folder = tempfile.TemporaryDirectory()
        folder = pathlib.Path(self.folder.name)
        headers(folder)
        (folder / "drive.c").write_text(DRIVER % len(CONSTANTS))
        subprocess.run(["gcc", "-std=c99", "-O2", "-shared", "-fPIC", "drive.c", "-o", "drive.so", "-lm"], cwd=folder, check=True)
        self.library = ctypes.CDLL(str(folder / "drive.so"))
        self.fit = (ctypes.c_double * len(CONSTANTS)).in_dll(self.library, "asperity_fit")
        self.increments, self.paths = increments, []
        for number, file in enumerate(sorted((PATHS / "vector").glob("*-mu-*.csv"))):
            command = [program, "law", "export", str((PATHS / file.name).with_suffix(".json")), "--format", "c", "--out", str(folder / file.stem)]
            subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
            if self.library.load(number, str(folder / file.stem / "law.asperity").encode()) != 0:
                raise SystemExit(f"{file.stem}: no table")
            found = {}
            with open(file, newline="") as table:
                for row in csv.DictReader(table):
                    found.setdefault(row["path"], []).append([float(row[name]) for name in PLACE + FORCES])
            for path, rows in found.items():
                if any(abs(angle) > 1e-12 for row in rows for angle in row[3:6]):
                    self.paths.append((number, file.stem, path, rows))

    def scores(self, values, wanted):
        """Of each path that is wanted (rms, worst) of F_N, F_T, M_twist and M_roll, over their greatest."""
        for i, name in enumerate(CONSTANTS):
            self.fit[i] = values[name]
        return [self.score(*path) if want else None for path, want in zip(self.paths, wanted)]

    def score(self, number, _name, _path, rows):
        place = (ctypes.c_double * (6 * len(rows)))(*(x for row in rows for x in row[:6]))
        out = (ctypes.c_double * (6 * len(rows)))()
        self.library.drive(number, len(rows), place, self.increments, out)
        greatest = max(row[6] for row in rows)
        found = []
        for columns, least in ((0,), 0.01), ((1, 2), 0.01), ((3,), 0.002), ((4, 5), 0.002):
            simulated = [[row[6 + k] for k in columns] for row in rows]
            peak = max(least * greatest, max(math.hypot(*force) for force in simulated))
            errors = [math.dist([out[6 * i + k] for k in columns], force) / peak for i, force in enumerate(simulated)]
            errors = [error if error < 10 else 10 for error in errors]
            found.append((math.sqrt(sum(e * e for e in errors) / len(errors)), max(errors)))
        return found


def judged(path):
    """Which of F_N, F_T, M_twist and M_roll count."""
    return (0, 1, 3) if path.startswith("roll") else (0, 1, 2)


def cost(driver, values, taken, kinds):
    wanted = [take and any(kind in path[2] for kind in kinds) for take, path in zip(taken, driver.paths)]
    found = [
        max(one[k][0] / AIMS[0], one[k][1] / AIMS[1]) ** 2
        for one, path in zip(driver.scores(values, wanted), driver.paths)
        if one
        for k in judged(path[2])
    ]
    return sum(x / (1 + x / 12) for x in found) / len(found)


def fit(driver, start, taken, rounds):
    """Constants that make the cost of the paths `taken` small: those of the twist, then those of the roll."""
    best = dict(start)
    for prefix, kinds in ("twist_", ("then", "spin")), ("roll_", ("roll", "spin")):
        names = [name for name in CONSTANTS if name.startswith(prefix)]
        steps, least = dict.fromkeys(names, 0.2), cost(driver, best, taken, kinds)
        for _ in range(rounds):
            for name in names:
                low, high = CONSTANTS[name]
                for sign in (1, -1):
                    trial = best | {name: float(f"{min(max(best[name] * math.exp(sign * steps[name]), low), high):.4g}")}
                    found = cost(driver, trial, taken, kinds) if trial != best else least
                    if found < least - 1e-6:
                        best, least, steps[name] = trial, found, 1.4 * steps[name]
                        break
                else:
                    steps[name] *= 0.5
        print(f"{prefix}: {least:.4f}", flush=True)
    return best


def told(driver, scores, detail):
    """By kind of path."""
    kinds = {}
    for path, one in zip(driver.paths, scores):
        kinds.setdefault(path[2], []).append((path[1], one))
    for kind, found in kinds.items():
        good = sum(all(one[k][0] <= AIMS[0] and one[k][1] <= AIMS[1] for k in (0, 1, 2)) for _, one in found)
        means = [100 * math.sqrt(sum(one[k][0] ** 2 for _, one in found) / len(found)) for k in range(4)]
        print(f"{kind:32} {good} of {len(found)}  F_N {means[0]:5.2f}  F_T {means[1]:5.2f}  M_twist {means[2]:5.2f}  M_roll {means[3]:5.2f}")
        for name, one in found if detail else []:
            print(f"    {name:20} " + "  ".join(f"{100 * rms:5.1f} ({100 * worst:5.1f})" for rms, worst in one))
    print()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="target/release/asperity", help="exports the tables")
    parser.add_argument("--increments", type=int, default=16, help="between two simulated places")
    parser.add_argument("--rounds", type=int, default=10)
    parser.add_argument("--fit", action="store_true")
    parser.add_argument("--held-out", action="store_true")
    parser.add_argument("--write", action="store_true", help="the fitted constants into the source")
    parser.add_argument("--detail", action="store_true", help="each path: F_N, F_T, M_twist and M_roll, per cent rms (worst)")
    args = parser.parse_args()
    levers, squared, stiff, lever = closed_forms()
    print(f"closed forms: levers {levers}, their squares {squared!r}, stiffness {stiff!r}, lever {lever!r}\n")
    driver = Driver(str((ROOT / args.program).resolve()), args.increments)
    start, everything = fitted.read(SOURCE, CONSTANTS), [True] * len(driver.paths)
    print("as it is")
    told(driver, driver.scores(start, everything), args.detail)
    if args.held_out:
        held = [None] * len(driver.paths)
        group = lambda path: path[1].split("-mu-")[0]
        for material in sorted({group(path) for path in driver.paths}):
            taken = [group(path) != material for path in driver.paths]
            values = fit(driver, start, taken, args.rounds)
            for index, one in enumerate(driver.scores(values, [not take for take in taken])):
                held[index] = one or held[index]
        print("each material by the constants of the others")
        told(driver, held, args.detail)
    if args.fit:
        values = fit(driver, start, everything, args.rounds)
        told(driver, driver.scores(values, everything), args.detail)
        for name, value in values.items():
            print(f"{name:16} {start[name]:9.4g} -> {value:.4g}")
        if args.write:
            fitted.write(SOURCE, values)


if __name__ == "__main__":
    main()
