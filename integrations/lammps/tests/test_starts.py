"""LAMMPS as its users start it, with its defaults: empty boxes, inserted, deleted and renumbered spheres, frozen and rigid ones, periodic images, restarts.

Run by run.sh: test_starts.py PLUGIN METAL ELASTIC, the second and third what `asperity law export ... --for lammps` wrote for equal.toml and for elastic.toml.
"""

import math
import os
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

from host import E, ELASTIC, ELASTIC_PAIR, ELASTIC_WALL, HEAD, METAL, PAIR, PLUGIN, WALL, dump, expect, failures, quiet, refuses, told


def by_place(rows):
    """Rows that are the same spheres whatever their IDs."""
    return sorted(rows, key=lambda row: [round(v, 6) for v in row[1:4]])


# ---- spheres that come in the run

BOX = """boundary p p f
region box block 0 5 0 5 -0.1 20
create_box 2 box
pair_style asperity
pair_coeff * * {pair} {E} restitution 0.3
fix floor all wall/asperity 0 0 0 0 0 1 type * {wall} {E} restitution 0.3
timestep 0.01
fix move all nve/sphere
fix down all gravity 0.01 vector 0 0 -1
"""
CONTACTS = """compute c all pair/local p1 p3
compute touching all reduce sum c_c[1] inputs local
compute deepest all reduce max c_c[2] inputs local
variable touching equal c_touching
variable deepest equal c_deepest
"""


def poured(ranks):
    out, dumps = told(BOX.format(pair=PAIR, wall=WALL, E=E) + """region top block 0 5 0 5 12 19
fix in all pour 60 1 4711 region top diam one 1.0 dens 1.0 1.0
run 8000
""" + CONTACTS + 'run 0\nprint "found $(v_touching) $(v_deepest)"\n' + dump("end"), ranks)
    touching, deepest = (float(word) for word in out.split("found ")[-1].split()[:2])
    lowest = min(row[3] for row in dumps["end.dump"])
    expect(len(dumps["end.dump"]) == 60 and touching > 0.1 and deepest < 0.05 and lowest > 0.45,
           f"60 spheres poured into an empty box, {ranks} rank(s): number, sum of F_N, overlap", f"{len(dumps['end.dump'])} {touching:.3g} {deepest:.2g}")


def larger_ones_poured():
    out, dumps = told(BOX.format(pair=PAIR, wall=WALL, E=E) + """create_atoms 1 single 2.5 2.5 0.1
set type 1 diameter 0.2 density 1.0
region top block 0 5 0 5 10 19
fix in all pour 12 2 4711 region top diam one 2.0 dens 1.0 1.0
run 8000
""" + CONTACTS + 'run 0\nprint "found $(v_touching) $(v_deepest)"\n' + dump("end"))
    touching, deepest = (float(word) for word in out.split("found ")[-1].split()[:2])
    expect(len(dumps["end.dump"]) == 13 and touching > 0.0 and deepest < 0.1, "ten times larger ones poured on a small one: sum of F_N, overlap", f"{touching:.3g} {deepest:.2g}")


def deposited():
    out, dumps = told(BOX.format(pair=PAIR, wall=WALL, E=E) + """region top block 2.4 2.6 2.4 2.6 8 9
fix in all deposit 4 1 1200 4711 region top near 1.0 vz -0.3 -0.3
compute pairs all pair asperity
thermo_style custom step c_pairs[3]
run 8000
variable lost equal c_pairs[3]
print "found $(v_lost)"
""" + dump("end"))
    lost = float(out.split("found ")[-1].split()[0])
    rows = dumps["end.dump"]
    lowest, nearest = min(row[3] for row in rows), min(math.dist(a[1:4], b[1:4]) for a in rows for b in rows if a is not b)
    expect(len(rows) == 4 and lost > 0.0 and nearest > 0.95 and lowest > 0.4,
           "4 spheres deposited on each other: work of damping, nearest two, lowest", f"{lost:.2g} {nearest:.2f} {lowest:.3f}")


def grown():
    grows = """atom_style sphere 1
boundary f f f
region box block -5 5 -5 5 -5 5
create_box 1 box
create_atoms 1 single 0 0 0
create_atoms 1 single 1.5 0 0
set group all diameter 1 density 1
pair_style asperity {words}
pair_coeff 1 1 {pair} {E}
fix move all nve/sphere
timestep 0.001
variable size equal 1+0.001*step
fix grow all adapt 1 atom diameter v_size
run 600
"""
    refuses(grows.format(words="", pair=PAIR, E=E), "the greatest one known when the run began was 0.5")
    out, _ = told(grows.format(words="largest 0.9", pair=PAIR, E=E) + CONTACTS + 'run 0\nprint "found $(v_touching)"\n')
    force = float(out.split("found ")[-1].split()[0])
    expect(force > 0.0, "spheres that grow into each other, with `largest`: F_N", f"{force:.3g}")


def types_without_tables():
    refuses(BOX.format(pair=PAIR, wall=WALL, E=E).replace("type *", "type 1") + """region top block 0 5 0 5 2 6
fix in all pour 5 2 4711 region top diam one 1.0 dens 1.0 1.0
run 2000
""", "is of type 2, for which there is no table")


# ---- IDs

PACKED = """boundary p p p
region box block 0 3.92 0 3.92 0 3.92
create_box 1 box
lattice custom 1.0625 a1 1 0 0 a2 0 1 0 a3 0 0 1 basis 0.5 0.5 0.5
create_atoms 1 box
set group all diameter 1 density 1
displace_atoms all random 0.01 0.01 0.01 8711
velocity all create 0.05 87287 loop geom
pair_style asperity
pair_coeff 1 1 {pair} {E}
timestep 0.005
fix move all nve/sphere
"""


def packed():
    return PACKED.format(pair=PAIR, E=E)


def standing():
    """The same with room above, and none below but for a wall."""
    tall = packed().replace("boundary p p p", "boundary p p f").replace("0 3.92\ncreate_box", "-1 9\ncreate_box")
    return tall.replace("create_atoms 1 box\n", "region low block 0 3.92 0 3.92 0 3.9 units box\ncreate_atoms 1 region low\n")


def renumbered():
    for ranks in (1, 2):
        for command in ("reset_atoms id\n", "reset_atoms id sort yes\n"):
            # Every third sphere is gone first, so that the numbers have gaps.
            gaps = "group third id 1:64:3\ndelete_atoms group third compress no\nrun 0\n" + dump("gaps")
            out, dumps = told(packed() + "run 400\nrun 0\n" + gaps + command + "run 0\n" + dump("after"), ranks)
            before, after = by_place(dumps["gaps.dump"]), by_place(dumps["after.dump"])
            size = max(abs(v) for row in before for v in row[4:7])
            worst = max(abs(a - b) for one, two in zip(before, after) for a, b in zip(one[4:7], two[4:7])) / size
            moved = sum(one[0] != two[0] for one, two in zip(before, after))
            expect(worst < 1e-12 and moved > 30 and size > 0.0, f"{command.strip()}, {ranks} rank(s): change of forces, new IDs", f"{worst:.1e} {moved}")


LONE = "region high block INF INF INF INF 6 8 units box\ngroup lone region high\n"


def with_a_lone_one():
    """The same with a far sphere that touches nobody and has the lowest ID: if it goes, all others get new ones."""
    return standing().replace("create_atoms 1 region low\n", "create_atoms 1 single 1.9 1.9 7.0 units box\ncreate_atoms 1 region low\n")


def deleted():
    lone = with_a_lone_one()
    for ranks in (1, 2):
        script = lone + "fix floor all wall/asperity 0 0 -0.03 0 0 1 type 1 " + f"{WALL} {E}\nrun 400\nrun 0\n" + dump("before")
        script += f"{LONE}delete_atoms group lone\nrun 0\n" + dump("after")
        _, dumps = told(script, ranks)
        before, after = [row for row in by_place(dumps["before.dump"]) if row[3] < 6.0], by_place(dumps["after.dump"])
        size = max(abs(v) for row in before for v in row[4:7])
        worst = max(abs(a - b) for one, two in zip(before, after) for a, b in zip(one[4:7], two[4:7])) / size
        moved = sum(one[0] != two[0] for one, two in zip(before, after))
        expect(worst < 1e-12 and len(after) == len(before) and moved > 50, f"delete_atoms (compress), {ranks} rank(s): change of forces, new IDs", f"{worst:.1e} {moved}")
    number_of_one_that_is_gone()


def number_of_one_that_is_gone():
    """A new sphere with the number of one that is gone, in its place: its contacts are new, as if there had been none."""
    script = packed() + "run 400\ngroup last id 64\n"
    script += "".join(f"variable m{c} equal xcm(last,{c})\nvariable g{c} equal ${{m{c}}}\n" for c in "xyz")
    script += ("delete_atoms group last compress no\ncreate_atoms 1 single ${gx} ${gy} ${gz} units box\n"
               "set group all diameter 1 density 1\nrun 0\n") + dump("after")
    _, dumps = told(script)
    rows = dumps["after.dump"]
    start = PACKED.format(pair=PAIR, E=E).split("lattice")[0] + "".join("create_atoms 1 single {:.17g} {:.17g} {:.17g} units box\n".format(*row[1:4]) for row in rows)
    _, dumps = told(start + "set group all diameter 1 density 1\npair_style asperity\npair_coeff 1 1 " + f"{PAIR} {E}\nrun 0\n" + dump("fresh"))
    last, fresh = rows[-1], dumps["fresh.dump"][-1]
    size = max(abs(v) for v in fresh[4:7])
    worst = max(abs(a - b) for a, b in zip(last[4:7], fresh[4:7])) / size
    expect(worst < 1e-12 and last[0] == 64, "a new sphere with the ID of one that is gone has new contacts: forces", f"{worst:.1e}")


# ---- masses

def rebound(setup, mover):
    """Velocity after over before of a light elastic impact along z."""
    lmp = quiet()
    lmp.commands_string(HEAD + f"""atom_modify map array
boundary f f f
region box block -5 5 -5 5 -5 5
create_box 1 box
timestep 0.002
pair_style asperity
pair_coeff 1 1 {ELASTIC_PAIR} {E} restitution 0.5
""" + setup)
    lmp.command("run 0")
    find = {int(tag): k for k, tag in enumerate(lmp.numpy.extract_atom("id"))}
    speed = lmp.numpy.extract_atom("v")[find[mover]][2]
    touched = False
    for _ in range(4000):
        lmp.command("run 20 pre no post no")
        find = {int(tag): k for k, tag in enumerate(lmp.numpy.extract_atom("id"))}
        force = abs(lmp.numpy.extract_atom("f")[find[mover]][2])
        now = lmp.numpy.extract_atom("v")[find[mover]][2]
        touched |= now * speed < 0
        if touched and force < 1e-12:
            break
    others = [lmp.numpy.extract_atom("v")[k][2] for tag, k in find.items() if tag != mover]
    lmp.close()
    return -(now - (max(others) if others else 0.0)) / speed


def masses():
    spheres = "create_atoms 1 single 0 0 0\ncreate_atoms 1 single 0 0 1.0001\nset group all diameter 1 density 1\ngroup one id 1\ngroup two id 2\nvelocity two set 0 0 -0.001\n"
    e = rebound(spheres + "fix move all nve/sphere\n", 2)
    expect(abs(e - 0.5) < 0.02, "restitution 0.5 of two spheres", f"{e:.3f}")
    e = rebound(spheres + "fix move two nve/sphere\nfix hold one freeze\n", 2)
    expect(abs(e - 0.5) < 0.02, "    against a frozen one", f"{e:.3f}")
    dimer = ("create_atoms 1 single 0 0 0\ncreate_atoms 1 single 0 0 1.0001\ncreate_atoms 1 single 0 0 1.9001\nset group all diameter 1 density 1\n"
             "group one id 1\ngroup body id 2 3\nvelocity one set 0 0 0.001\nneigh_modify exclude group body body\n")
    for style in ("rigid group 1 body", "rigid/small molecule"):
        if style.startswith("rigid/small"):
            setup = dimer.replace("set group all", "fix number all property/atom mol ghost yes\nset group all") + "set group body mol 1\nset group one mol 2\n"
        else:
            setup = dimer
        e = rebound(setup + f"fix move one nve/sphere\nfix stiff body {style}\n", 1)
        expect(abs(e - 0.5) < 0.02, f"    against a body of two, fix {style.split()[0]}", f"{e:.3f}")
    falls = ("create_atoms 1 single 0 0 0.5001\ncreate_atoms 1 single 0 0 1.4\nset group all diameter 1 density 1\nvelocity all set 0 0 -0.001\n"
             f"neigh_modify exclude group all all\nfix floor all wall/asperity 0 0 0 0 0 1 type 1 {ELASTIC_WALL} {E} restitution 0.5\nfix stiff all rigid group 1 all\n")
    lmp = quiet()
    lmp.commands_string(HEAD + f"boundary f f f\nregion box block -5 5 -5 5 -5 5\ncreate_box 1 box\ntimestep 0.002\npair_style asperity\n"
                        f"pair_coeff 1 1 {ELASTIC_PAIR} {E}\n" + falls + "thermo_style custom step\nrun 4000\n")
    e = lmp.numpy.extract_atom("v")[0][2] / 0.001
    lmp.close()
    expect(abs(e - 0.5) < 0.02, "    of a body of two on a wall", f"{e:.3f}")


def tangential():
    """A sphere that is drawn along a wall at its depth: only a dashpot along the wall takes work that is damping's."""
    taken = []
    for words in ("", "tangential 1.0"):
        lmp = quiet()
        lmp.commands_string(HEAD + f"""boundary f f f
region box block -5 5 -5 5 -5 5
create_box 1 box
create_atoms 1 single 0 0 0.495
set group all diameter 1 density 1
velocity all set 0.01 0 0
pair_style asperity
pair_coeff 1 1 {PAIR} {E}
fix floor all wall/asperity 0 0 0 0 0 1 type 1 {WALL} {E} restitution 0.5 {words}
fix move all nve/noforce
timestep 0.002
run 20
""")
        f = lmp.numpy.extract_atom("f")[0]
        taken.append(lmp.extract_fix("floor", 0, 1, 8))
        bound = math.hypot(f[0], f[1]) / f[2]
        lmp.close()
    expect(taken[0] == 0.0 and taken[1] > 0.0 and bound <= 0.3 * (1 + 1e-12), "a dashpot along a wall: its work, F_T/F_N", f"{taken[1]:.2g} {bound:.3f}")
    refuses("boundary f f f\nregion box block -5 5 -5 5 -5 5\ncreate_box 1 box\npair_style asperity\n"
            f"pair_coeff 1 1 {PAIR} {E} restitution 0.5 tangential -1\n", "a tangential damping of -1 times the normal one is not 0 or more")


# ---- output, restart, what has no answer

def normalised():
    lmp = quiet()
    lmp.commands_string(HEAD + f"""boundary f f f
region box block -5 5 -5 5 -5 5
create_box 1 box
create_atoms 1 single 0 0 0.495
create_atoms 1 single 2 0 0.495
create_atoms 1 single -2 0 0.495
set group all diameter 1 density 1
pair_style asperity
pair_coeff 1 1 {PAIR} {E}
fix floor all wall/asperity 0 0 0 0 0 1 type 1 {WALL} {E}
fix lid all wall/asperity 0 0 4 0 0 -1 type 1 {WALL} {E}
fix move all nve/noforce
thermo_style custom step f_lid[6] f_floor[3] f_floor[11]
run 1
""")
    row = lmp.last_thermo()
    force = -sum(f[2] for f in lmp.numpy.extract_atom("f"))
    lmp.close()
    expect(row["f_lid[6]"] == 4.0, "the lid's place in the thermo output of units lj", row["f_lid[6]"])
    expect(abs(row["f_floor[3]"] / (force / 3) - 1) < 1e-12 and row["f_floor[11]"] == 1.0, "    force and contacts, a sphere", f"{row['f_floor[3]']:.6g} {row['f_floor[11]']:g}")


def restarted():
    with tempfile.TemporaryDirectory() as name:
        file = Path(name, "kept.restart")
        wall = f"fix floor all wall/asperity 0 0 -0.03 0 0 1 type 1 {WALL} {{}}\n"
        lmp = quiet()
        lmp.commands_string(HEAD + with_a_lone_one() + wall.format(E) + f"run 300\nwrite_restart {file}\n")
        lmp.close()

        def again(pair=f"{PAIR} {E}", floor=f"{E}", kept=file):
            return f"read_restart {kept}\ncomm_modify vel yes\npair_style asperity\npair_coeff 1 1 {pair}\n" + wall.format(floor) + "run 0\n"

        refuses(again(pair=f"{PAIR} {1000 * E}"), "Young's modulus is 1000000, and the restart file was written with 1000")
        refuses(again(pair=f"{ELASTIC_PAIR} {E}"), "is another table than the one with which the restart file was written, for spheres")
        refuses(again(floor=f"{1000 * E}"), "was written with 1000, in fix wall/asperity floor for type 1")
        data = file.read_bytes()
        mark = b"ASPERITY" + struct.pack("d", 6.0)
        assert data.count(mark) == 2
        old = Path(name, "old.restart")
        old.write_bytes(data.replace(mark, b"ASPERITY" + struct.pack("d", 2.0)))
        refuses(again(kept=old), "contacts are of another version of the plug-in")
        old.write_bytes(data.replace(mark + struct.pack("d", 39.0), mark + struct.pack("d", 40.0)))
        refuses(again(kept=old), "contacts are of another version of the plug-in")
        lmp = quiet()
        lmp.commands_string(HEAD + again(pair=f"{PAIR} {2 * E} changed", floor=f"{2 * E} changed"))
        lmp.close()
        expect(True, "with `changed` another modulus is taken", "yes")
        # IDs that were changed between reading the file and naming the style.
        forces = []
        for command in ("", f"{LONE}delete_atoms group lone\n"):
            lmp = quiet()
            lmp.commands_string(HEAD + again().replace("comm_modify", command + "comm_modify"))
            x, f = lmp.numpy.extract_atom("x"), lmp.numpy.extract_atom("f")
            forces.append(by_place([[0, *x[k], *f[k]] for k in range(len(x)) if x[k][2] < 6.0]))
            lmp.close()
        size = max(abs(v) for row in forces[0] for v in row[4:7])
        worst = max(abs(a - b) for p, q in zip(*forces) for a, b in zip(p[4:7], q[4:7])) / size
        expect(worst < 1e-12 and len(forces[0]) == len(forces[1]), "restart, then delete_atoms before the style is named: change of forces", f"{worst:.1e}")


def no_answers():
    refuses(f"""boundary f f f
region box block -5 5 -5 5 -5 5
create_box 1 box
create_atoms 1 single 0 0 0
create_atoms 1 single 0 0 0
set group all diameter 1 density 1
pair_style asperity
pair_coeff 1 1 {PAIR} {E}
run 0
""", "there is no force between spheres 1 and 2: their centres coincide")


# ---- neighbours, ranks, balance

def neighbours():
    """Against one rank that stops half-way too: a set-up wraps places, and the update enlarges a last bit now and then."""
    _, reference = told(packed() + "run 300\nrun 300\n" + dump("end"))
    size = max(abs(v) for row in reference["end.dump"] for v in row[4:7])
    for what, words, between, ranks in (
        ("lists made anew in every step", "neigh_modify every 1 delay 0 check no\n", "", 1),
        ("a wide skin", "neighbor 1.0 bin\n", "", 1),
        ("2 ranks", "", "", 2),
        ("2 ranks, balanced as they run", "fix even all balance 50 1.0 shift xyz 10 1.02\n", "", 2),
        ("2 ranks, balanced by a command", "", "balance 1.0 shift xyz 10 1.01\n", 2),
    ):
        _, dumps = told(packed() + words + "run 300\n" + between + "run 300\n" + dump("end"), ranks)
        worst = max(abs(a - b) for one, two in zip(reference["end.dump"], dumps["end.dump"]) for a, b in zip(one[4:7], two[4:7])) / size
        expect(worst < 1e-6 and len(dumps["end.dump"]) == 64, f"{what}: change of forces after 600 steps", f"{worst:.1e}")


# ---- memory: images, rebuilt lists, restarts

def images():
    """In a box two cells wide a sphere touches several images of another: each contact is by itself, as in eight such boxes side by side."""
    small = packed().replace("0 3.92", "0 1.96")
    for words in ("", "neigh_modify every 1 delay 0 check no\n"):
        _, one = told(small + words + "run 150\nrun 150\n" + dump("end"))
        _, eight = told(small.replace("pair_style", "replicate 2 2 2\npair_style") + words + "run 150\nrun 150\n" + dump("end"))
        size = max(abs(v) for row in one["end.dump"] for v in row[4:7])
        worst = max(min(max(abs(a - b) for a, b in zip(row[4:7], other[4:7])) for other in one["end.dump"]) for row in eight["end.dump"]) / size
        expect(worst < 1e-9 and len(one["end.dump"]) == 8 and len(eight["end.dump"]) == 64, f"a box two cells wide against eight of them{', lists made anew' if words else ''}: forces", f"{worst:.1e}")


def continued():
    """The second half of a run from its restart file, to the last bit."""
    styles = "pair_style" + packed().split("pair_style")[1]
    for width in ("3.92", "1.96"):
        for ranks in (1, 2):
            with tempfile.TemporaryDirectory() as name:
                file = Path(name, "half.restart")
                _, whole = told(packed().replace("0 3.92", f"0 {width}") + f"run 200\nwrite_restart {file}\nrun 200\n" + dump("end"), ranks)
                _, half = told(f"read_restart {file}\ncomm_modify vel yes\n" + styles + "run 200\n" + dump("end"), ranks)
            count = round(float(width) / 0.98) ** 3
            expect(whole == half and len(whole["end.dump"]) == count, f"{count} spheres, {ranks} rank(s), the second half from a restart file", "equal" if whole == half else "different")


def near():
    """Two spheres, one on each rank, pressed, drawn apart by less than the dent is deep and pressed again: the dent is still there."""
    start = f"""boundary p p p
region box block -5 5 -5 5 -5 5
create_box 1 box
create_atoms 1 single -0.499 0 0
create_atoms 1 single 0.502 0 0
set group all diameter 1 density 1
group moved id 2
pair_style asperity
pair_coeff 1 1 {PAIR} {E}
timestep 0.001
fix move all nve/noforce
"""
    lead = "velocity moved set {} 0.002 0\nrun {}\n"
    press = lead.format(-0.1, 210) + lead.format(0.1, 220) + lead.format(0, 50) + lead.format(-0.1, 210)
    fresh = lead.format(0, 480) + lead.format(-0.1, 200)
    forces = []
    for words, moves, ranks in (("every 1 delay 0 check no", press, 1), ("every 1 delay 0 check no", press, 2), ("every 1000 delay 1000 check no", press, 1), ("every 1 delay 0 check no", fresh, 1)):
        _, dumps = told(start + f"neigh_modify {words}\n" + moves + dump("end"), ranks)
        forces.append(dumps["end.dump"][0][4:7])
    same = max(math.dist(one, forces[0]) for one in forces[1:3]) / math.hypot(*forces[0])
    other = math.dist(forces[0], forces[3]) / math.hypot(*forces[0])
    expect(same < 1e-9 and other > 0.05, "a dent outlives new lists while spheres are near, 1 and 2 ranks: forces", f"{same:.1e} (without a dent {other:.2f})")


# ---- the input that the program writes

def input_runs():
    """As it is, and with another density."""
    for folder, types, words in ((METAL, 2, []), (ELASTIC, 1, []), (ELASTIC, 1, ["-var", "density1", "7.8e-9"])):
        command = [str(Path(sys.prefix, "bin", "lmp")), "-in", "in.asperity", "-log", "none", "-var", "plugin", PLUGIN, *words]
        run = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=900)
        assert run.returncode == 0, run.stdout[-3000:] + run.stderr[-1000:]
        forces = [float(line.split("F_N = ")[1].split(",")[0]) for line in run.stdout.splitlines() if "F_N = " in line and "$" not in line]
        assert len(forces) == 4 and forces[-1] > 0, f"{words}: F_N {forces}"
        friction = float(run.stdout.split("F_T = ")[-1].split()[0]) / forces[-1]
        good = forces[1] < 0.1 * forces[0] and 0.4 * forces[0] < forces[2] < 0.7 * forces[0] and 0 < abs(friction) < 0.31
        expect(good, f"in.asperity, {types} material(s) {' '.join(words[1:])}: pressed, released, pressed; F_T/F_N", " ".join(f"{f:.4g}" for f in forces[:3]) + f" {friction:.2f}")


if __name__ == "__main__":
    only = os.environ.get("ASPERITY_ONLY", "").split()
    tests = [lambda: poured(1), lambda: poured(2), larger_ones_poured, deposited, grown, types_without_tables, renumbered, deleted, masses, tangential, normalised, restarted,
             no_answers, neighbours, images, continued, near, input_runs]
    names = ["poured", "poured2", "larger", "deposited", "grown", "types", "renumbered", "deleted", "masses", "tangential", "normalised", "restarted", "no_answers", "neighbours", "images", "continued", "near", "input"]
    for name, test in zip(names, tests):
        if not only or name in only:
            test()
    sys.exit(1 if failures else 0)
