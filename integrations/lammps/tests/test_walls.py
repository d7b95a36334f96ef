"""Walls of all shapes, moved and under loads: cylinders, cones, triangles. Run by run.sh: test_walls.py PLUGIN METAL ELASTIC

Each test compares with what is known without the code that it tests: with planes, with balances of energy, with the load that was asked for.
"""

import math
import os
import struct
import sys
import tempfile
from pathlib import Path

from host import E, HEAD, PAIR, WALL, expect, failures, quiet, refuses
from meshes import ascii_stl, binary_stl, box_faces, grid, quad

EMPTY = """boundary f f f
region box block -10 10 -10 10 -10 10
create_box 1 box
pair_style asperity
pair_coeff 1 1 {pair} {E}
timestep 0.001953125
""".format(pair=PAIR, E=E)
STEP = 0.001953125    # 2**-9: so a path meets corners exactly
LAW = f"type 1 {WALL} {E}"


def along(wall, legs, start, setup="", radius=0.5, box=EMPTY):
    """Forces, torques and outputs of a sphere that is led along legs of (velocity, omega, steps) over a wall."""
    lmp, rows = quiet(), []
    lmp.commands_string(HEAD + box + f"create_atoms 1 single {start[0]:.17g} {start[1]:.17g} {start[2]:.17g} units box\nset group all diameter {2 * radius} density 1\n"
                        + f"fix wall all wall/asperity {wall}\nfix move all nve/noforce\n" + setup)
    for velocity, omega, steps in legs:
        lmp.command("velocity all set {:.17g} {:.17g} {:.17g}".format(*velocity))
        lmp.command("set atom 1 omega {:.17g} {:.17g} {:.17g}".format(*omega))
        for _ in range(steps):
            lmp.command("run 1")
            rows.append([*lmp.numpy.extract_atom("f")[0], *lmp.numpy.extract_atom("torque")[0], lmp.extract_fix("wall", 0, 1, 10), lmp.extract_fix("wall", 0, 1, 9),
                         lmp.extract_fix("wall", 0, 1, 6), lmp.extract_fix("wall", 0, 1, 7)])
    lmp.close()
    return rows


def apart(one, two, columns=range(6)):
    size = max(abs(row[c]) for row in one for c in columns)
    assert size > 0
    return max(abs(a[c] - b[c]) for a, b in zip(one, two) for c in columns) / size


def flat():
    """A sphere pressed onto a triangulated flat, slid and rolled over faces, along an edge, through corners: as on the plane."""
    tilt = ((0.8, 0.0, 0.6), (0.36, 0.8, -0.48), (-0.48, 0.6, 0.64))
    tilted = lambda u, v, w=0.0: tuple(tilt[0][d] * u + tilt[1][d] * v + tilt[2][d] * w for d in range(3))
    upright = lambda u, v, w=0.0: (u, v, w)
    # Through the corner at the origin, back over edges to y = 0, along an edge there and through its next corner, away over faces, and off.
    legs = [((0, 0, -0.5), (0, 0, 0), 10), ((1.0, 0.5, 0), (0, 0.8, 0.3), 60), ((0, 0, 0.05), (0, 0, 0), 20), ((-0.75, -0.125, -0.1), (0.4, 0, 0), 112),
            ((-1.0, 0, 0), (0, -2.0, 0), 90), ((0.7, 0.7, 0), (1.0, -1.0, 0), 60), ((0, 0, 1.0), (0, 0, 0), 22)]
    with tempfile.TemporaryDirectory() as name:
        junction = quad((-2, -2, 0), (2, -2, 0), (2, 0, 0), (-2, 0, 0)) + [((-2, 0, 0), (-0.3, 0, 0), (0, 2, 0)), ((-0.3, 0, 0), (2, 0, 0), (0, 2, 0))]
        # On a tilted one the last bits of both differ, and the update enlarges them next to full slip (docs/dem-lammps.md): there the sphere rolls.
        arm = 0.5 - 10 * 0.5 * STEP
        roll = lambda x, y, steps: ((x, y, 0), (-1.002 * y / arm, 1.002 * x / arm, 0), steps)
        rolled = [legs[0], roll(1.0, 0.5, 60), roll(-0.75, -0.125, 112), roll(-1.0, 0, 90), roll(0.7, 0.7, 60), legs[-1]]
        meshes = (("upright, binary", upright, binary_stl(f"{name}/a.stl", grid(16, 4.0)), ""),
                  ("upright, scaled and shifted", upright, ascii_stl(f"{name}/b.stl", grid(16, 4000.0, lambda u, v: (u, v, 0.0))), "scale 0.001 shift 0.25 0.5 0 at 0.1 0 0"),
                  ("tilted, ASCII, rolled on", tilted, ascii_stl(f"{name}/c.stl", grid(16, 4.0, tilted)), ""),
                  ("corners on edges of others", upright, binary_stl(f"{name}/d.stl", junction), ""),
                  ("twice the same", upright, binary_stl(f"{name}/e.stl", grid(16, 4.0) + grid(8, 4.0)), ""))
        for what, frame, file, words in meshes:
            start, turned = frame(-0.0625, -0.03125, 0.5), [(frame(*v), frame(*w), steps) for v, w, steps in (legs if frame is upright else rolled)]
            if frame is upright:
                start = (-0.0625, -0.03125, 0.5)
            normal = frame(0.0, 0.0, 1.0)
            plane = along("0 0 0 {:.17g} {:.17g} {:.17g} ".format(*normal) + LAW, turned, start)
            mesh = along(f"stl {file} {words} {LAW}", turned, start)
            worst, most = apart(plane, mesh), max(row[6] for row in mesh)
            expect(worst < 1e-12 and most == 1 and plane[-1][6] == 0, f"a flat of triangles, {what}: difference from the plane, contacts", f"{worst:.1e} {most:g}")
            if frame is tilted:
                rounded = along(f"stl {binary_stl(f'{name}/f.stl', grid(16, 4.0, tilted))} {LAW}", turned, start)
                count, off = max(row[6] for row in rounded), apart(plane, rounded)
                expect(count == 1 and off < 1e-3, "    the same in the seven digits of a binary file: difference, contacts", f"{off:.1e} {count:g}")
            work = max(abs(mesh[-1][k] / plane[-1][k] - 1) for k in (8, 9))
            expect(work < 1e-11, "    of the work dissipated", f"{work:.1e}")


def moved_flat():
    """The same mesh moved under a sphere that stands, and turned with it."""
    with tempfile.TemporaryDirectory() as name:
        file = binary_stl(f"{name}/a.stl", grid(16, 4.0))
        press = [((0, 0, -0.5), (0, 0, 0), 10)]
        legs = press + [((0, 0, 0), (0, 0, 0), 100)]
        words = "fix_modify wall velocity 0.7 0.4 0"
        setup = f"run 0\n{words}\n"
        plane, mesh = (along(f"{wall} {LAW}", legs, (0.0, 0.0, 0.5), setup) for wall in ("0 0 0 0 0 1", f"stl {file}"))
        worst = apart(plane, mesh)
        expect(worst < 1e-12, "a flat of triangles that moves: difference from the plane", f"{worst:.1e}")
        spun = [along(f"{wall} {LAW} spin 0 0 0.3", legs, (0.4, 0.1, 0.5)) for wall in ("0 0 0 0 0 1", f"stl {file}")]
        worst = apart(*spun)
        expect(worst < 1e-12, "    that spins", f"{worst:.1e}")
        # Turned by a right angle together with the sphere, the force turns too.
        turn, steps = 0.5 * math.pi, 4000
        values = []
        for wall in (f"stl {file}", "0 0 0 0 0 1", "cylinder 0 0 0.98 0 1 0 0.98 inside"):
            lmp = quiet()
            lmp.commands_string(HEAD + EMPTY + f"create_atoms 1 single 0 0 0.5\nset group all diameter 1 density 1\nfix wall all wall/asperity {wall} {LAW}\n"
                                "fix move all nve/noforce\nvelocity all set 0.2 0.1 -0.2\nrun 40\nvelocity all set 0 0 0\nunfix move\n"
                                f"fix_modify wall spin 0 {turn / (steps * STEP):.17g} 0\n"
                                f"fix move all move rotate {'0 0 0.98' if 'cyl' in wall else '0 0 0'} 0 1 0 {2 * math.pi / (turn / (steps * STEP)):.17g}\nrun 0\n")
            before = lmp.numpy.extract_atom("f")[0].copy()
            lmp.command(f"run {steps}")
            after = lmp.numpy.extract_atom("f")[0].copy()
            lmp.close()
            # By a right angle about y: x becomes -z, z becomes x.
            wanted = (before[2], before[1], -before[0])
            values.append(max(abs(a - b) for a, b in zip(wanted, after)) / max(abs(before)))
        expect(max(values) < 1e-5, "mesh, plane, cylinder turned by a right angle with their sphere: change of force", " ".join(f"{v:.1e}" for v in values))


def edges():
    """Grooves, ridges and corners: which contacts there are, and their forces."""
    def roof(degrees, sign):
        s, c = math.sin(math.radians(0.5 * degrees)), math.cos(math.radians(0.5 * degrees))
        return (quad((0, -3, 0), (0, 3, 0), (3 * c, 3, -sign * 3 * s), (3 * c, -3, -sign * 3 * s))
                + quad((0, -3, 0), (0, 3, 0), (-3 * c, 3, -sign * 3 * s), (-3 * c, -3, -sign * 3 * s))), (s, c)

    with tempfile.TemporaryDirectory() as name:
        # A groove of a right angle: two contacts, each as the plane's.
        facets, (s, c) = roof(90, -1)
        groove = ascii_stl(f"{name}/groove.stl", facets)
        height = 0.49 / c
        still = [((0, 0.1, 0), (0, 0, 0), 20)]
        mesh = along(f"stl {groove} {LAW}", still, (0.0, 0.1, height))
        planes = along(f"0 0 0 {s:.17g} 0 {c:.17g} {LAW}", still, (0.0, 0.1, height), f"fix other all wall/asperity 0 0 0 {-s:.17g} 0 {c:.17g} {LAW}\n")
        worst = apart(planes, mesh)
        expect(worst < 1e-12 and mesh[-1][6] == 2, "a groove of a right angle: difference from two planes, contacts", f"{worst:.1e} {mesh[-1][6]:g}")
        shallow = ascii_stl(f"{name}/shallow.stl", roof(10, -1)[0])
        counts = [along(f"stl {shallow} {words} {LAW}", still, (0.001, 0.1, 0.496))[-1][6] for words in ("", "merge 5")]
        expect(counts == [1, 2], "    of 170 degrees, merged within 15 and within 5 degrees: contacts", f"{counts[0]:g} {counts[1]:g}")
        # A ridge: once, whatever the faces, and radial; the force of the plane at that overlap.
        ridge = ascii_stl(f"{name}/ridge.stl", roof(60, 1)[0])
        plane = along(f"0 0 0 0 0 1 {LAW}", [((0, 0, -0.5), (0, 0, 0), 10)], (0.0, 0.0, 0.5))
        there = along(f"stl {ridge} {LAW}", [((0, 0, -0.5), (0, 0, 0), 10)], (0.0, 0.3, 0.5))
        expect(apart(plane, there) < 1e-12 and there[-1][6] == 1, "a ridge: difference from the plane, contacts", f"{apart(plane, there):.1e} {there[-1][6]:g}")
        # Over the ridge at constant overlap: one contact all the way, and what it has dissipated is kept.
        lmp = quiet()
        lmp.commands_string(HEAD + EMPTY + f"create_atoms 1 single 0 0 0.495\nset group all diameter 1 density 1\nfix wall all wall/asperity stl {ridge} {LAW}\n"
                            "fix move all move rotate 0 0 0 0 1 0 40\nrun 0\n")
        forces, counts = [], []
        for _ in range(100):
            lmp.command("run 20")
            f = lmp.numpy.extract_atom("f")[0]
            forces.append(math.dist(f, (0, 0, 0)))
            counts.append(lmp.extract_fix("wall", 0, 1, 10))
        lost = lmp.extract_fix("wall", 0, 1, 8)
        lmp.close()
        # It turns by 9 degrees a time unit about the edge: after 80 by 28, where the face's normal is at 30; then it rolls on to the face.
        even = max(forces[:80]) / min(forces[:80]) - 1
        expect(set(counts) == {1.0} and lost == 0.0 and even < 1e-9 and forces[-1] > 1.2 * forces[0], "rolled over a ridge: contacts, damping, change of force on the edge",
               f"{counts[-1]:g} {lost:g} {even:.1e}")
        cube = binary_stl(f"{name}/cube.stl", box_faces((-1, -1, -1), (0, 0, 0), False))
        out = 0.49 / math.sqrt(3)
        corner = along(f"stl {cube} {LAW}", [((0, 0, 0), (0, 0, 0), 1)], (out, out, out))
        plane = along(f"0 0 0 0 0 1 {LAW}", [((0, 0, 0), (0, 0, 0), 1)], (0, 0, 0.49))
        force = math.dist(corner[-1][:3], (0, 0, 0))
        radial = max(corner[-1][:3]) - min(corner[-1][:3])
        expect(corner[-1][6] == 1 and abs(force / plane[-1][2] - 1) < 1e-12 and radial < 1e-12 * force, "a corner of a cube: contacts, force over the plane's less 1",
               f"{corner[-1][6]:g} {force / plane[-1][2] - 1:.1e}")


def curved():
    """Spheres at rest on cylinders and cones: the force of the plane at that overlap, along the radius."""
    press = [((0, 0, 0), (0, 0, 0), 1)]
    wanted = along(f"0 0 0 0 0 1 {LAW}", press, (0, 0, 0.49))[-1][2]
    axis = (2 / 3, 1 / 3, 2 / 3)
    across = (1 / math.sqrt(5), -2 / math.sqrt(5), 0.0)
    about = lambda along_axis, r: tuple(0.3 + along_axis * axis[d] + r * across[d] for d in range(3))
    back = tuple(-v for v in across)
    slope = math.atan2(1.0, 2.0)
    tilt = lambda sense: tuple(sense * (-math.cos(slope) * across[d] + math.sin(slope) * axis[d]) for d in range(3))
    cone = "cone 0.3 0.3 0.3 1 {:.17g} {:.17g} {:.17g} 2".format(*about(2.0, 0.0))
    cylinder = f"cylinder 0.3 0.3 0.3 2 1 2 3"
    rim = about(0.0, 1.0)
    for what, wall, place, normal in (
        ("in a cylinder", f"{cylinder} inside", about(1.7, 3 - 0.49), back),
        ("on a cylinder", f"{cylinder} outside", about(-1.7, 3 + 0.49), across),
        ("in a cone", cone, tuple(a + 0.49 * b for a, b in zip(about(1.0, 1.5), tilt(1))), tilt(1)),
        ("on a cone", cone, tuple(a + 0.49 * b for a, b in zip(about(1.0, 1.5), tilt(-1))), tilt(-1)),
        ("on the rim of a cone", cone, tuple(a - 0.49 * b for a, b in zip(rim, axis)), tuple(-v for v in axis)),
    ):
        force = along(f"{wall} {LAW}", press, place)[-1][:3]
        worst = max(abs(force[d] - wanted * normal[d]) for d in range(3)) / wanted
        expect(worst < 1e-11, f"a sphere {what}: difference from the plane's force", f"{worst:.1e}")
    one = f"create_atoms 1 single {{}} {{}} {{}} units box\nset group all diameter {{}} density 1\nfix wall all wall/asperity {{}} {LAW}\nrun 0\n"
    for place, size, wall, words in (
        ((0, 0, 0), 2.0, "cylinder 0 0 0 0 0 1 0.9 inside", "is not smaller than the cylinder that it is to be in"),
        ((0, 0, 0), 2.0, "cylinder 0 0 0 0 0 1 0.9 outside", "has its centre on the axis of the cylinder"),
        ((0, 0, 0.0), 2.0, "cone 0 0 -1 0.8 0 0 1 1.0", "plugs the cone"),
        ((0, 0, 0), 1.0, "cylinder 0 0 0 0 0 0 1 inside", "the axis is zero"),
        ((0, 0, 0), 1.0, "cylinder 0 0 0 0 0 1 -1 inside", "the radius of the cylinder is not positive"),
        ((0, 0, 0), 1.0, "cylinder 0 0 0 0 0 1 1 under", "fix ID group wall/asperity SHAPE"),
        ((0, 0, 0), 1.0, "cone 0 0 0 1 0 0 0 2", "both ends of the cone are the same"),
        ((0, 0, 0), 1.0, "cone 0 0 0 0 0 0 1 0", "the radii of the cone"),
        ((0, 0, 0), 1.0, "0 0 0 0 0 0", "the normal is zero"),
        ((0, 0, 0), 1.0, f"0 0 0 0 0 1 {LAW} load 0 0 -1 5", "a wall under a load needs a mass"),
        ((0, 0, 0), 1.0, f"0 0 0 0 0 1 {LAW} load 0 0 0 5 mass 1", "the direction of the load is zero"),
        ((0, 0, 0), 1.0, f"0 0 0 0 0 1 {LAW} load 0 0 1 5 mass -1", "the mass of the wall is not positive"),
    ):
        refuses(EMPTY + one.format(*place, size, wall), words)


def through():
    """A sphere that is driven through a shell or a facet is told of, and so is what cannot be in a periodic box."""
    with tempfile.TemporaryDirectory() as name:
        file = binary_stl(f"{name}/a.stl", grid(4, 4.0))
        driven = "set group all diameter 1 density 1\nfix wall all wall/asperity {} " + LAW + "\nfix move all nve/noforce\nvelocity all set 0 0 -5\nrun 200\n"
        refuses(EMPTY + "create_atoms 1 single 0.1 0.2 0.6 units box\n" + driven.format(f"stl {file}"), "has gone through the wall")
        refuses(EMPTY + "create_atoms 1 single 1.5 0.2 0.9 units box\n" + driven.format("cone 0 0 -0.5 3 0 0 0.5 0.5"), "has gone through the wall")
        box = EMPTY.replace("boundary f f f", "boundary p p f")
        rest = "create_atoms 1 single 0 0 0.495 units box\nset group all diameter 1 density 1\nfix wall all wall/asperity {} " + LAW + " {}\nrun 0\n"
        refuses(box + rest.format(f"stl {file}", "spin 0 0 1"), "facets cannot turn in a box that is periodic")
        refuses(box + rest.format("cylinder 0 0 0 1 1 0 5 inside", ""), "the axis of a cylinder lies along it or across")


def hostile():
    """Files that are none, or damaged."""
    with tempfile.TemporaryDirectory() as name:
        good = Path(binary_stl(f"{name}/good.stl", grid(2, 4.0))).read_bytes()
        text = Path(ascii_stl(f"{name}/text.stl", grid(2, 4.0))).read_text()
        corner = lambda v: good[:84 + 12] + struct.pack("<f", v) + good[84 + 16:]
        huge = Path(name, "huge.stl")
        with open(huge, "wb") as out:
            out.write(b" " * 80 + struct.pack("<I", 20000000))
            out.truncate(84 + 50 * 20000000)
        cases = [(None, "missing.stl cannot be opened"), (b"", "is empty"), (b"solid", "ends or is damaged within facet 1"), (b"rubbish", "is no STL file"),
                 (good[:-1], "its head tells of 8 facets, which take 484 bytes, and it has 483"), (good + b"x", "and it has 485"), (good[:80] + b"\xff" * 4 + good[84:], "of 4294967295 facets"),
                 (good[:80] + bytes(4), "has no facets"), (corner(math.nan), "facet 1 has a corner that is no place"), (corner(math.inf), "facet 1 has a corner that is no place"),
                 (corner(3e38), "facet 1 has a corner that is no place"), (good[:84 + 24] + good[84 + 12:84 + 24] + good[84 + 36:], "facet 1 is degenerate"),
                 (text[:len(text) // 2].encode(), "ends or is damaged within facet"), (text.replace("vertex -2", "vertex nan", 1).encode(), "has a corner that is no place: nan"),
                 (text.replace("vertex -2", "vertex 1e999", 1).encode(), "has a corner that is no place"), (text.replace("vertex -2", "vertex -2,5", 1).encode(), "no place: -2,5"),
                 (text.replace("endloop", "endlop", 1).encode(), "ends or is damaged within facet 1"), (text.replace("endsolid", "", 1).encode(), "ends or is damaged within facet"),
                 (b"solid nothing\nendsolid nothing\n", "has no facets")]
        for k, (data, words) in enumerate(cases):
            path = Path(name, "missing.stl" if data is None else f"case{k}.stl")
            if data is not None:
                path.write_bytes(data)
            refuses(EMPTY + f"fix wall all wall/asperity stl {path} {LAW}\n", words)
        refuses(EMPTY + f"fix wall all wall/asperity stl {huge} {LAW}\n", "has 20000000 facets, and 10 million are the most")
        refuses(EMPTY + f"fix wall all wall/asperity stl {name} {LAW}\n", f"the file {name} cannot be")
        for words, said in (("scale 0", "the scale is not positive"), ("merge 0.1", "merge is not from 1 to 60 degrees"), ("scale 1e300", "is no place")):
            refuses(EMPTY + f"fix wall all wall/asperity stl {name}/good.stl {words} {LAW}\n", said)
        # What other programs write: capitals, no spaces at the beginning, several solids, normals that are none.
        odd = text.upper().replace("  ", "").replace("NORMAL 0 0 0", "NORMAL NAN NAN NAN") + text
        Path(name, "odd.stl").write_text(odd)
        rows = along(f"stl {name}/odd.stl {LAW}", [((0, 0, -0.5), (0, 0, 0), 5)], (0.1, 0.2, 0.5))
        expect(rows[-1][2] > 0 and rows[-1][6] == 1, "capitals, two solids, normals that are no numbers: contacts", f"{rows[-1][6]:g}")


if __name__ == "__main__":
    only = os.environ.get("ASPERITY_ONLY", "").split()
    for test in (flat, moved_flat, edges, curved, through, hostile):
        if not only or test.__name__ in only:
            test()
    sys.exit(1 if failures else 0)
