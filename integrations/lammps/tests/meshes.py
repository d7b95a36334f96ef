"""STL files for the tests."""

import math
import struct
from pathlib import Path


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


def tube(count, radius=3.0, half=2.0):
    """A tube about y, of flat faces."""
    at = lambda k, y: (radius * math.cos(2 * math.pi * k / count), y, radius * math.sin(2 * math.pi * k / count))
    return [facet for k in range(count) for facet in quad(at(k, -half), at(k + 1, -half), at(k + 1, half), at(k, half))]
