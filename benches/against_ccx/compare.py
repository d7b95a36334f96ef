#!/usr/bin/env python3
"""Runs one case with Asperity and with CalculiX on the same mesh and prints processor seconds, iterations and curves side by side.

    python3 benches/against_ccx/compare.py [CASE.toml] [--out DIR] [--set KEY=VALUE]... [--profile release|dev] [--threads N]
        [--deck "--stick-slope 20"] [--finer N] [--kept]

Needs cargo, and `ccx` (Debian and Ubuntu: apt-get install calculix-ccx). Without ccx it leaves the deck, says so and ends with 1.
--deck has further words for the example ccx_deck, such as --element C3D8I or --solver 'ITERATIVE CHOLESKY'; --finer runs
Asperity with N elements along the contact radius too; --kept runs nothing and prints from what lies in DIR.
"""

import argparse
import csv
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent


def measured(command, log, **options):
    """Runs a command with its output in a file; processor seconds and wall seconds of it."""
    before = os.times()
    with open(log, "w") as out:
        code = subprocess.run([str(word) for word in command], stdout=out, stderr=subprocess.STDOUT, **options).returncode
    after = os.times()
    if code != 0:
        sys.exit(f"error: {command[0]} ended with {code}; its output is in {log}")
    cpu = after.children_user - before.children_user + after.children_system - before.children_system
    return cpu, after.elapsed - before.elapsed


def build(profile):
    flags = ["--release"] if profile == "release" else []
    subprocess.run(["cargo", "build", "--quiet", *flags, "--bin", "asperity", "--example", "ccx_deck"], cwd=ROOT, check=True)
    folder = ROOT / (os.environ.get("CARGO_TARGET_DIR") or "target") / ("release" if profile == "release" else "debug")
    return folder / "asperity", folder / "examples" / "ccx_deck"


def segments(case):
    """Ends (h, delta_T) of the path's segments, from the resolved case."""
    ends, h, shear = [(0.0, 0.0)], 0.0, 0.0
    for segment in tomllib.loads(case.read_text())["path"]:
        h, shear = segment.get("indentation", h), segment.get("shear", shear)
        ends.append((h, shear))
    return ends


def ccx_curve(dat, ends):
    """(segment, h, delta_T, F_N, F_T) of each increment, whole sphere; total time counts the segments."""
    total = re.compile(r"total force .* for set EQUATOR and time\s+(\S+)\s+(\S+)\s+(\S+)\s+(\S+)")
    curve = []
    for time, fx, _, fz in (map(float, found) for found in total.findall(dat.read_text())):
        segment = min(int(time - 1e-9), len(ends) - 2)
        (h0, s0), (h1, s1), share = ends[segment], ends[segment + 1], time - segment
        curve.append((segment, h0 + share * (h1 - h0), s0 + share * (s1 - s0), -2.0 * fz, 2.0 * fx))
    return curve


def ccx_counts(sta):
    """Increments, attempts that were cut back, and iterations."""
    rows = [line.split() for line in sta.read_text().splitlines() if re.match(r"\s+\d", line)]
    accepted = [row for row in rows if not row[2].endswith("U")]
    return len(accepted), len(rows) - len(accepted), sum(int(row[3]) for row in rows)


def asperity_at(rows, segment, h, shear):
    """F_N and F_T of Asperity's history at a place of a segment, linear between steps."""
    before = {"h": "0", "delta_T": "0", "F_N": "0", "F_T": "0"}
    for row in rows:
        if int(row["segment"]) == segment:
            start, end = (float(r["h"]) + float(r["delta_T"]) for r in (before, row))
            if min(start, end) - 1e-12 <= h + shear <= max(start, end) + 1e-12 and end != start:
                share = (h + shear - start) / (end - start)
                return [float(before[key]) + share * (float(row[key]) - float(before[key])) for key in ("F_N", "F_T")]
        before = row
    return [float("nan")] * 2


def history(folder):
    with open(folder / "history.csv") as file:
        return list(csv.DictReader(file))


def run(options, out):
    """Both programs, with what they took in times.json."""
    sets = [word for value in options.set for word in ("--set", value)]
    asperity, deck = build(options.profile)

    def ours(folder, *more):
        command = [asperity, "run", options.case, "--out", out / folder, "--force", "--device", "cpu", "--threads", options.threads]
        return measured([*command, *sets, *more], out / f"{folder}.log")

    times = {"asperity": ours("asperity")}
    if options.finer:
        times["finer"] = ours("finer", "--set", f"mesh.elements_per_contact_radius={options.finer}")
    measured([deck, options.case, out / "deck.inp", *sets, *shlex.split(options.deck)], out / "deck.log")
    if shutil.which("ccx") is None:
        summary = json.loads((out / "asperity" / "summary.json").read_text())
        took = f"{summary['steps']} steps, {summary['newton_iterations']} iterations, {times['asperity'][0]:.1f} CPU s"
        print(f"asperity: {summary['unknowns']} unknowns, {took}")
        sys.exit(
            f"ccx is not installed, so there is nothing to compare with: the deck is {out / 'deck.inp'}. "
            "On Debian and Ubuntu: apt-get install --no-install-recommends calculix-ccx"
        )
    for left in ("deck.dat", "deck.sta"):
        (out / left).unlink(missing_ok=True)
    environment = os.environ | {"OMP_NUM_THREADS": str(options.threads)}
    times["ccx"] = measured(["ccx", "-i", "deck"], out / "ccx.log", cwd=out, env=environment)
    (out / "times.json").write_text(json.dumps(times))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("case", nargs="?", type=Path, default=HERE / "case.toml")
    parser.add_argument("--out", type=Path, default=ROOT / "target" / "against_ccx")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE")
    parser.add_argument("--profile", choices=["release", "dev"], default="release")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--deck", default="", metavar="WORDS")
    parser.add_argument("--finer", type=int, metavar="N")
    parser.add_argument("--kept", action="store_true")
    options = parser.parse_args()
    out = options.out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    if not options.kept:
        run(options, out)
    folder = out / "asperity"
    summary, rows = json.loads((folder / "summary.json").read_text()), history(folder)
    times = json.loads((out / "times.json").read_text())
    (our_cpu, our_wall), (ccx_cpu, ccx_wall) = times["asperity"], times["ccx"]
    equations = int(re.search(r"number of equations\s+(\d+)", (out / "ccx.log").read_text()).group(1))
    increments, cuts, iterations = ccx_counts(out / "deck.sta")
    ends = segments(out / "asperity" / "case.toml")
    curve = ccx_curve(out / "deck.dat", ends)
    if not curve or abs(curve[-1][1] - ends[-1][0]) + abs(curve[-1][2] - ends[-1][1]) > 1e-9:
        print(f"CalculiX did not reach the end of the path; its output is {out / 'ccx.log'}", file=sys.stderr)

    version = subprocess.run(["ccx", "-v"], capture_output=True, text=True).stdout.strip().removeprefix("This is ")
    print(f"| {options.threads} thread(s), {options.profile} profile | unknowns | steps | cut-backs | Newton | CPU s | wall s | CPU s / Newton |")
    print("|---|---|---|---|---|---|---|---|")
    ours = (summary["unknowns"], summary["steps"], summary["cutbacks"], summary["newton_iterations"], our_cpu, our_wall)
    theirs = (equations, increments, cuts, iterations, ccx_cpu, ccx_wall)
    for name, (size, steps, cut, newton, cpu, wall) in ((f"Asperity {summary['version']}", ours), (f"CalculiX {version}", theirs)):
        print(f"| {name} | {size} | {steps} | {cut} | {newton} | {cpu:.1f} | {wall:.1f} | {cpu / newton:.3f} |")
    finer = history(out / "finer") if options.finer else None
    beside = f" F_N Asperity, {options.finer} elements | F_T Asperity, {options.finer} elements |" if finer else ""
    print("\n| h | delta_T | F_N Asperity | F_N CalculiX | % | F_T Asperity | F_T CalculiX | % |" + beside)
    print("|---|---|---|---|---|---|---|---|" + ("---|---|" if finer else ""))
    for segment, h, shear, normal, tangential in curve:
        ours_normal, ours_tangential = asperity_at(rows, segment, h, shear)
        cells = [f"{ours_normal:.4g}", f"{normal:.4g}", f"{100 * (normal / ours_normal - 1):+.1f}"]
        if shear == 0.0:
            cells += ["", "", ""]
        else:
            cells += [f"{ours_tangential:.4g}", f"{tangential:.4g}", f"{100 * (tangential / ours_tangential - 1):+.1f}"]
        if finer:
            fine_normal, fine_tangential = asperity_at(finer, segment, h, shear)
            cells += [f"{fine_normal:.4g}", f"{fine_tangential:.4g}" if shear else ""]
        print(f"| {h:.4g} | {shear:.4g} | {' | '.join(cells)} |")
    peak = max((abs(tangential) for *_, tangential in curve), default=0.0)
    if summary["F_T_max"] and peak:
        print(f"\npeak F_T: Asperity {summary['F_T_max']:.4g}, CalculiX {peak:.4g}")


if __name__ == "__main__":
    main()
