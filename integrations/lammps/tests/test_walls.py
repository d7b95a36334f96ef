"""Walls of all shapes, moved and under loads: cylinders, cones, triangles. Run by run.sh: test_walls.py PLUGIN METAL ELASTIC

Each test compares with what is known without the code that it tests: with planes, with balances of energy, with the load that was asked for.
"""

import math
import os
import struct
import sys
import tempfile
from pathlib import Path

from host import E, HEAD, PAIR, WALL, dump, expect, failures, quiet, refuses, told

EMPTY = """boundary f f f
region box block -10 10 -10 10 -10 10
create_box 1 box
pair_style asperity
pair_coeff 1 1 {pair} {E}
timestep 0.001953125
""".format(pair=PAIR, E=E)
STEP = 0.001953125    # 2**-9: so a path meets corners exactly
LAW = f"type 1 {WALL} {E}"


# ---- meshes

def ascii_stl(path, facets):
    with open(path, "w") as out:
        out.write("solid a mesh of the test\n")
        for facet in facets:
            out.write("facet normal 0 0 0\n outer loop\n" + "".join("  vertex {:.17g} {:.17g} {:.17g}\n".format(*corner) for corner in facet) + " endloop\nendfacet\n")
        out.write("endsolid a mesh of the test\n")
    return path


def binary_stl(path, facets):
    data = b"made by the test".ljust(80) + struct.pack("<I", len(facets))
    for facet in facets:
        data += struct.pack("<12fH", 0, 0, 0, *(v for corner in facet for v in corner), 0)
    Path(path).write_bytes(data)
    return path


def quad(a, b, c, d):
    return [(a, b, c), (a, c, d)]


def grid(count, size, place=lambda u, v: (u, v, 0.0)):
    """A square of count x count squares about the origin, each of two triangles."""
    at = lambda i: size * (i / count - 0.5)
    return [facet for i in range(count) for j in range(count)
            for facet in quad(place(at(i), at(j)), place(at(i + 1), at(j)), place(at(i + 1), at(j + 1)), place(at(i), at(j + 1)))]


def box_faces(lo, hi, open_top=True):
    p = lambda i, j, k: ((lo, hi)[i][0], (lo, hi)[j][1], (lo, hi)[k][2])
    faces = [(p(0, 0, 0), p(1, 0, 0), p(1, 1, 0), p(0, 1, 0)), (p(0, 0, 0), p(1, 0, 0), p(1, 0, 1), p(0, 0, 1)), (p(0, 1, 0), p(1, 1, 0), p(1, 1, 1), p(0, 1, 1)),
             (p(0, 0, 0), p(0, 1, 0), p(0, 1, 1), p(0, 0, 1)), (p(1, 0, 0), p(1, 1, 0), p(1, 1, 1), p(1, 0, 1))]
    if not open_top:
        faces.append((p(0, 0, 1), p(1, 0, 1), p(1, 1, 1), p(0, 1, 1)))
    return [facet for face in faces for facet in quad(*face)]


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
        meshes = (("upright, binary", upright, binary_stl(f"{name}/a.stl", grid(16, 4.0)), ""),
                  ("upright, scaled and shifted", upright, ascii_stl(f"{name}/b.stl", grid(16, 4000.0, lambda u, v: (u, v, 0.0))), "scale 0.001 at 0.25 0.5 0"),
                  ("tilted, ASCII", tilted, ascii_stl(f"{name}/c.stl", grid(16, 4.0, tilted)), ""),
                  ("corners on edges of others", upright, binary_stl(f"{name}/d.stl", junction), ""),
                  ("twice the same", upright, binary_stl(f"{name}/e.stl", grid(16, 4.0) + grid(8, 4.0)), ""))
        for what, frame, file, words in meshes:
            start, turned = frame(-0.0625, -0.03125, 0.5), [(frame(*v), frame(*w), steps) for v, w, steps in legs]
            if frame is upright:
                start = (-0.0625, -0.03125, 0.5)
            normal = frame(0.0, 0.0, 1.0)
            plane = along("0 0 0 {:.17g} {:.17g} {:.17g} ".format(*normal) + LAW, turned, start)
            mesh = along(f"stl {file} {words} {LAW}", turned, start)
            worst, most = apart(plane, mesh), max(row[6] for row in mesh)
            expect(worst < 1e-12 and most == 1 and plane[-1][6] == 0, f"a flat of triangles, {what}: difference from the plane, contacts", f"{worst:.1e} {most:g}")
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


if __name__ == "__main__":
    only = os.environ.get("ASPERITY_ONLY", "").split()
    for test in (flat, moved_flat, edges):
        if not only or test.__name__ in only:
            test()
    sys.exit(1 if failures else 0)
