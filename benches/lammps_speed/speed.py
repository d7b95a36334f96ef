"""What a contact costs in LAMMPS: this law beside Hertz and Mindlin's and beside MDR, on one packing.

    bash benches/lammps_speed/run.sh OUT [--spheres 100000] [--ranks 2] [--steps 400] [--rounds 3] [--styles ...] [--rest]

A jittered cubic packing in a periodic box is pressed along z and sheared along x at a constant rate, so that nearly all contacts
load, slide and turn in each step, most of them plastically: the dear case. With --rest it is pressed and sheared before, and
left to itself while it is timed: spheres ring, most contacts are elastic. All styles have the same spheres, the same neighbour
lists and the same number of steps. LAMMPS' own account of a run gives the time of `Pair` and of the whole; of the rounds, which
take turns, the fastest counts. Prints a table: nanoseconds of processor time for each contact and step, its ratio to Hertz and
Mindlin's and to MDR's, and the ratio of whole steps. Writes OUT/speed.json.
"""

import argparse
import json
import math
import os
import pathlib
import re
import shutil
import subprocess
import sys

MODULUS, NU, YIELD, MU, DENSITY = 200e3, 0.3, 400.0, 0.3, 1.0
RADIUS = 0.5
# The overlap of the lattice, over R, and by how much spheres are beside their places, over R.
OVERLAP, JITTER = 0.004, 0.002
# What the spheres approach each other by during the timed steps, over R, and how far layers move beside each other.
PRESS, SHEAR = 0.01, 0.01
SHEAR_MODULUS = MODULUS / (2 * (1 + NU))
STYLES = {
    "asperity": "pair_style asperity\npair_coeff * * {table} {e} restitution 0.5",
    "hertz-mindlin": "pair_style granular\n"
    "pair_coeff * * hertz/material {e} 0.5 {nu} tangential mindlin NULL 1.0 {mu} damping tsuji",
    "mdr": "pair_style granular\n"
    "pair_coeff * * mdr {e} {nu} {y} 0.0 0.5 0.5 tangential linear_history {k_t} 0.0 {mu} damping mdr 1",
}


def input_text(style, args):
    """The input: `warm` steps in which contacts come to be, and the timed ones."""
    side = round(args.spheres ** (1 / 3))
    spacing = 2 * RADIUS - OVERLAP * RADIUS
    length = side * spacing
    step = 0.1 * RADIUS * math.sqrt(DENSITY / MODULUS)
    # A strain of the box moves neighbours by that share of their distance.
    rate = PRESS * RADIUS / spacing / (args.steps * step)
    shear = SHEAR * RADIUS / spacing / (args.steps * step)
    k_t = 8 * SHEAR_MODULUS / (2 * (2 - NU)) * 0.05 * RADIUS
    pair = STYLES[style].format(table=args.table, e=MODULUS, nu=NU, y=YIELD, mu=MU, k_t=k_t)
    stop = f"run {args.steps}\nunfix press\nrun {args.warm}\n" if args.rest else ""
    load = f"plugin load {args.plugin}\n" if style == "asperity" else ""
    return f"""{load}units lj
atom_style sphere
comm_modify vel yes
newton off
boundary p p p
processors * * *
region box prism 0 {length} 0 {length} 0 {length} 0 0 0 units box
create_box 1 box
lattice sc {spacing ** -3}
create_atoms 1 region box
set group all diameter {2 * RADIUS}
set group all density {DENSITY}
displace_atoms all random {JITTER * RADIUS} {JITTER * RADIUS} {JITTER * RADIUS} 4711 units box
{pair}
neighbor 0.1 bin
neigh_modify every 1 delay 0 check yes
timestep {step}
fix move all nve/sphere
fix press all deform 1 z erate {-rate} xz erate {shear} remap v
compute touching all contact/atom
compute contacts all reduce sum c_touching
thermo_style custom step atoms c_contacts press
thermo_modify norm no lost error
thermo {args.steps}
run {args.warm}
{stop}print "TIMED"
run {args.steps}
"""


def timed(style, args, launcher):
    """Seconds of Pair and of the loop, over all ranks, and contacts at the start and the end of the timed steps."""
    file = args.out / f"{style}.in"
    file.write_text(input_text(style, args))
    run = subprocess.run([*launcher, sys.executable, __file__, "--follow", str(file)], capture_output=True, text=True)
    if run.returncode != 0 or "TIMED" not in run.stdout:
        sys.exit(f"{style}: LAMMPS ended with {run.returncode}\n{run.stdout[-3000:]}{run.stderr[-2000:]}")
    text = run.stdout.split("TIMED", 1)[1]
    loop = float(re.search(r"Loop time of ([0-9.e+-]+)", text).group(1))
    pair = float(re.search(r"^Pair +\| *[0-9.e+-]+ *\| *([0-9.e+-]+)", text, re.M).group(1))
    rows = re.findall(r"^ *(\d+) +(\d+) +([0-9.e+]+) +(\S+) *$", text, re.M)
    contacts = [float(row[2]) / 2 for row in rows]
    rebuilt = int(re.search(r"Neighbor list builds = (\d+)", text).group(1))
    return {
        "pair": pair * args.ranks,
        "loop": loop * args.ranks,
        "contacts": sum(contacts) / len(contacts),
        "rebuilt": rebuilt,
        "pressure": float(rows[-1][3]),
    }


def follow(file):
    """One rank."""
    from lammps import lammps

    one = lammps(cmdargs=["-log", "none"])
    one.file(file)
    one.close()


def table_of(best, steps):
    """The rows of the table: ns for a contact and step, ratios of them and of whole steps."""
    of = lambda style, key: best[style][key] / (best[style]["contacts"] * steps) * 1e9
    lines = ["| law | contacts | ns a contact and step | over Hertz-Mindlin | over MDR | whole step over MDR |", "|---" * 6 + "|"]
    for style in best:
        ratio = lambda other, key="pair": f"{of(style, key) / of(other, key):.2f}" if other in best else "-"
        cells = [style, f"{best[style]['contacts']:.0f}", f"{of(style, 'pair'):.0f}"]
        cells += [ratio("hertz-mindlin"), ratio("mdr"), ratio("mdr", "loop")]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def main():
    if len(sys.argv) == 3 and sys.argv[1] == "--follow":
        return follow(sys.argv[2])
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("plugin", type=pathlib.Path)
    parser.add_argument("table", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--spheres", type=int, default=100_000)
    parser.add_argument("--ranks", type=int, default=2)
    parser.add_argument("--steps", type=int, default=400)
    parser.add_argument("--warm", type=int, default=50)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--rest", action="store_true")
    parser.add_argument("--styles", default=",".join(STYLES))
    args = parser.parse_args()
    args.plugin, args.table = args.plugin.resolve(), args.table.resolve()
    args.out.mkdir(parents=True, exist_ok=True)
    mpiexec = shutil.which("mpiexec", path=os.path.dirname(sys.executable)) or shutil.which("mpiexec")
    if args.ranks > 1 and mpiexec is None:
        sys.exit("--ranks needs mpiexec")
    launcher = [mpiexec, "-n", str(args.ranks)] if args.ranks > 1 else []
    styles = args.styles.split(",")
    rounds = [{style: timed(style, args, launcher) for style in styles} for _ in range(args.rounds)]
    best = {style: min((one[style] for one in rounds), key=lambda one: one["pair"]) for style in styles}
    report = {"spheres": args.spheres, "ranks": args.ranks, "steps": args.steps, "rest": args.rest, "rounds": rounds}
    (args.out / "speed.json").write_text(json.dumps(report, indent=1) + "\n")
    print(table_of(best, args.steps))


if __name__ == "__main__":
    main()
