#!/usr/bin/env python3
"""Opens a .vtu with meshio, and with pyvista where there is one, and compares it with the JSON that the writer says it wrote.

usage: check_vtu.py FILE.vtu EXPECTED.json [FILE.pvd]
EXPECTED.json: {"points": [...], "cells": [...], "point_data": {name: flat list}, "cell_data": {name: flat list}}
"""
import json
import sys

import meshio
import numpy as np


def same(what, ours, expected):
    ours, expected = np.asarray(ours), np.asarray(expected)
    if ours.size != expected.size or not np.array_equal(ours.ravel(), expected.ravel()):
        sys.exit(f"{what} differs:\n{ours}\ninstead of\n{expected}")


vtu, expected = sys.argv[1], json.load(open(sys.argv[2]))

mesh = meshio.read(vtu)
same("points", mesh.points, expected["points"])
if [block.type for block in mesh.cells] != ["hexahedron"]:
    sys.exit(f"cell types {[block.type for block in mesh.cells]}")
same("cells", mesh.cells[0].data, expected["cells"])
if set(mesh.point_data) != set(expected["point_data"]) or set(mesh.cell_data) != set(expected["cell_data"]):
    sys.exit(f"fields {sorted(mesh.point_data)} and {sorted(mesh.cell_data)}")
for name, values in expected["point_data"].items():
    same(f"meshio: {name}", mesh.point_data[name], values)
for name, values in expected["cell_data"].items():
    same(f"meshio: {name}", mesh.cell_data[name][0], values)
same("meshio: field data", mesh.field_data["half_model_mirrored_at_y"], [0.0])
print(f"meshio {meshio.__version__}: {len(mesh.points)} points, {len(mesh.cells[0].data)} hexahedra, all fields equal")

try:
    import pyvista
except ImportError:
    print("pyvista: not installed, not checked")
    sys.exit()
grid = pyvista.read(vtu)
same("pyvista: points", grid.points, expected["points"])
if set(grid.celltypes) != {12}:
    sys.exit(f"pyvista: cell types {set(grid.celltypes)}")
for name, values in expected["point_data"].items():
    same(f"pyvista: {name}", grid.point_data[name], values)
for name, values in expected["cell_data"].items():
    same(f"pyvista: {name}", grid.cell_data[name], values)
volumes = grid.compute_cell_sizes()["Volume"]
if not (volumes > 0).all():
    sys.exit(f"pyvista: an inverted cell, volumes {volumes}")
if len(sys.argv) > 3:
    reader = pyvista.PVDReader(sys.argv[3])
    reader.set_active_time_value(reader.time_values[-1])
    same("pyvista: points of the collection's last entry", reader.read()[0].points, expected["points"])
    print(f"pyvista: collection with times {reader.time_values}")
print(f"pyvista {pyvista.__version__}: equal too")
