#!/usr/bin/env python3
"""Opens the fields of one step of a run as its users would and holds them against its contact table and its normal force.

usage: check_fields.py FILE.vtu CONTACT.csv F_N FILE.pvd
"""
import csv
import os
import sys
import xml.etree.ElementTree as ElementTree

import meshio
import numpy as np

vtu, contact, force, pvd = sys.argv[1], list(csv.DictReader(open(sys.argv[2]))), float(sys.argv[3]), sys.argv[4]


def require(holds, what):
    if not holds:
        sys.exit(f"{vtu}: {what}")


mesh = meshio.read(vtu)
require([block.type for block in mesh.cells] == ["hexahedron"], f"cells {[block.type for block in mesh.cells]}")
on_points = {"displacement", "contact_pressure", "contact_traction", "gap", "contact_status"}
on_cells = {"stress", "mises", "alpha", "plastic"}
require(on_points <= set(mesh.point_data), f"point fields {sorted(mesh.point_data)}")
require(on_cells <= set(mesh.cell_data), f"cell fields {sorted(mesh.cell_data)}")
for name, values in list(mesh.point_data.items()) + [(name, blocks[0]) for name, blocks in mesh.cell_data.items()]:
    require(np.isfinite(values).all(), f"{name} is not finite")

# The deformed elements: Jacobian at the centre of each, from its eight corners.
corners = (mesh.points + mesh.point_data["displacement"])[mesh.cells[0].data]
signs = np.array([[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]])
jacobian = np.linalg.det(np.einsum("ni,enj->eij", signs, corners))
require((jacobian > 0).all(), f"{(jacobian <= 0).sum()} inverted elements")

status = {"open": 0, "stick": 1, "slip": 2}
total = 0.0
require(np.ravel(mesh.field_data["half_model_mirrored_at_y"]).tolist() == [0.0], f"field data {mesh.field_data}")
require((mesh.points[:, 1] >= 0).all(), "the file should hold the half y >= 0")
require({row["half"] for row in contact} == {"meshed", "both", "mirrored"}, "the table should hold both halves")
for row in contact:
    # A mirrored point has the number of the node whose image it is.
    node, sign = int(row["point"]), -1.0 if row["half"] == "mirrored" else 1.0
    require((row["half"] == "both") == (mesh.points[node][1] == 0.0), f"point {node} is on the symmetry plane or not")
    require(float(row["Y"]) == sign * mesh.points[node][1], f"Y of point {node}")
    require(mesh.point_data["contact_traction"][node][1] == sign * float(row["traction_y"]), f"traction of point {node}")
    require(mesh.point_data["contact_pressure"][node] == float(row["pressure"]), f"pressure of point {node}")
    require(mesh.point_data["contact_status"][node] == status[row["status"]], f"status of point {node}")
    total += float(row["pressure"]) * float(row["area"])
require(abs(total - force) <= 1e-9 * abs(force), f"the pressure adds up to {total}, and F_N is {force}")

files = [entry.get("file") for entry in ElementTree.parse(pvd).iter("DataSet")]
require(os.path.basename(vtu) in files, f"not in {pvd}: {files}")
require(all(os.path.exists(os.path.join(os.path.dirname(pvd), file)) for file in files), f"{pvd} names files that are not there")

mises = mesh.cell_data["mises"][0]
print(f"{len(mesh.points)} points, {len(jacobian)} elements, mises up to {mises.max():.4g}, F_N {total:.6g}: as written")
