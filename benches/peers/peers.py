#!/usr/bin/env python3
"""Runs one case with Asperity, then with other codes on the same mesh and path, and prints how far each came.

    python3 benches/peers/peers.py OUT [--asperity PROGRAM] [--set KEY=VALUE]... [--peers NAME,NAME...] [--limit SECONDS]
        [--increment SHARE] [--stick-slope N] [--overclosure N] [--python PROGRAM] [--peer-set KEY=VALUE]... [--kept]

The nodes and elements are read from the fields that Asperity writes. Each peer has one thread and a limit on its processor time.
Differences along the shear are those at ten places, root mean square / largest, in per cent of F_N before the shear and of the
largest F_T: from Asperity on the same mesh, and from the limits that it extrapolates on its default mesh. --kept runs nothing and
prints from what lies in OUT.
"""

import argparse
import base64
import csv
import json
import os
import re
import resource
import struct
import subprocess
import sys
import tomllib
import xml.etree.ElementTree as ElementTree
from pathlib import Path

HERE = Path(__file__).resolve().parent

# Faces S1 to S6 of CalculiX' hexahedron, nodes counted from 0.
FACES = [(0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0)]


def ccx(element="C3D8", contact="SURFACE TO SURFACE", solver="SPOOLES", behaviour="LINEAR"):
    return {"element": element, "contact": contact, "solver": solver, "behaviour": behaviour}


PEERS = {
    "surface": ccx(),
    "surface-c3d8r": ccx(element="C3D8R"),
    "surface-c3d8i": ccx(element="C3D8I"),
    "surface-cholesky": ccx(solver="ITERATIVE CHOLESKY"),
    "surface-c3d8r-cholesky": ccx(element="C3D8R", solver="ITERATIVE CHOLESKY"),
    "surface-c3d8i-cholesky": ccx(element="C3D8I", solver="ITERATIVE CHOLESKY"),
    "node": ccx(contact="NODE TO SURFACE"),
    "node-c3d8r": ccx(element="C3D8R", contact="NODE TO SURFACE"),
    "mortar": ccx(contact="MORTAR"),
    "mortar-hard": ccx(contact="MORTAR", behaviour="HARD"),
    "mortar-c3d8r": ccx(element="C3D8R", contact="MORTAR"),
    "getfem": {},
    "kratos": {"contact": "ALMContactFrictional"},
    "kratos-keep": {"contact": "ALMContactFrictional", "reset": "0"},
    "kratos-augmented": {"contact": "ALMContactFrictional", "augment": "1", "tangent": "1"},
    "kratos-penalty": {"contact": "PenaltyContactFrictional", "tangent": "0.1", "reset": "0"},
    "kratos-frictionless": {"contact": "ALMContactFrictionless"},
    "tamaas": {},
}

# Those that are a script: the module it needs and where that comes from.
SCRIPTS = {
    "getfem": ("getfem_sphere.py", "getfem", "apt install python3-getfem"),
    "kratos": ("kratos_sphere.py", "KratosMultiphysics.ContactStructuralMechanicsApplication", "see kratos_sphere.py"),
    "tamaas": ("tamaas_sphere.py", "tamaas", "pip install tamaas"),
}


class Mesh:
    """Nodes and hexahedra of a .vtu file, with the sets that carry conditions; everything counts from 0."""

    def __init__(self, file):
        piece = ElementTree.parse(file).getroot().find(".//Piece")
        arrays = {array.get("Name"): array for array in piece.iter("DataArray")}
        points = piece.find("Points/DataArray")
        flat = numbers(points)
        self.nodes = [tuple(flat[i : i + 3]) for i in range(0, len(flat), 3)]
        flat = numbers(arrays["connectivity"])
        self.elements = [tuple(flat[i : i + 8]) for i in range(0, len(flat), 8)]
        on_surface = [gap != -1.0 for gap in numbers(arrays["gap"])]
        top = max(z for *_, z in self.nodes)
        self.equator = [i for i, (*_, z) in enumerate(self.nodes) if abs(z - top) < 1e-9]
        held = set(self.equator)
        self.symmetry = [i for i, (_, y, _) in enumerate(self.nodes) if abs(y) < 1e-12 and i not in held]
        count = {}
        for element in self.elements:
            for face in FACES:
                key = tuple(sorted(element[k] for k in face))
                count[key] = count.get(key, 0) + 1
        self.contact = [
            (e, s)
            for e, element in enumerate(self.elements)
            for s, face in enumerate(FACES)
            if all(on_surface[element[k]] for k in face) and count[tuple(sorted(element[k] for k in face))] == 1
            and any(abs(self.nodes[element[k]][1]) > 1e-12 for k in face)
        ]


def numbers(array):
    """The values of a DataArray: base64 of their size in bytes and themselves."""
    raw = base64.b64decode(array.text)
    size = struct.unpack_from("<Q", raw)[0]
    kinds = {"Float64": "d", "Float32": "f", "Int64": "q", "UInt64": "Q", "Int32": "i", "UInt32": "I", "UInt8": "B"}
    kind = kinds[array.get("type")]
    return struct.unpack_from(f"<{size // struct.calcsize(kind)}{kind}", raw, 8)


def lines(values, width=12):
    return "".join(", ".join(map(str, values[i : i + width])) + ",\n" for i in range(0, len(values), width))


def deck(case, mesh, peer, options):
    """CalculiX' input: an ideally plastic half sphere on a plane that is one element with all nodes held."""
    e, nu = case["material"]["youngs_modulus"], case["material"]["poissons_ratio"]
    radius, mu = case["sphere"]["radius"], case["contact"]["friction"]
    count, far = len(mesh.nodes), 2.0 * radius
    text = "*NODE, NSET=BODY\n"
    text += "".join(f"{i + 1}, {x:.12e}, {y:.12e}, {z:.12e}\n" for i, (x, y, z) in enumerate(mesh.nodes))
    text += f"*ELEMENT, TYPE={peer['element']}, ELSET=SPHERE\n"
    text += "".join(f"{i + 1}, {', '.join(str(n + 1) for n in nodes)}\n" for i, nodes in enumerate(mesh.elements))
    square = [(-far, -far), (far, -far), (far, far), (-far, far)]
    corners = [(x, y, z) for z in (-0.5 * radius, 0.0) for x, y in square]
    text += "*NODE, NSET=HELD\n" + "".join(f"{count + 1 + i}, {x}, {y}, {z}\n" for i, (x, y, z) in enumerate(corners))
    last = len(mesh.elements) + 1
    text += f"*ELEMENT, TYPE=C3D8, ELSET=PLANE\n{last}, {', '.join(str(count + 1 + i) for i in range(8))}\n"
    text += "*NSET, NSET=EQUATOR\n" + lines([n + 1 for n in mesh.equator])
    text += "*NSET, NSET=SYMMETRY\n" + lines([n + 1 for n in mesh.symmetry])
    text += "*SURFACE, NAME=BELOW, TYPE=ELEMENT\n" + "".join(f"{i + 1}, S{s + 1}\n" for i, s in mesh.contact)
    text += f"*SURFACE, NAME=ABOVE, TYPE=ELEMENT\n{last}, S2\n"
    text += f"*MATERIAL, NAME=METAL\n*ELASTIC\n{e}, {nu}\n*PLASTIC\n{case['material']['hardening']['yield_stress']}, 0.\n"
    text += f"*MATERIAL, NAME=STIFF\n*ELASTIC\n{e}, {nu}\n"
    text += "*SOLID SECTION, ELSET=SPHERE, MATERIAL=METAL\n*SOLID SECTION, ELSET=PLANE, MATERIAL=STIFF\n"
    text += f"*SURFACE INTERACTION, NAME=TOUCH\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE={peer['behaviour']}\n"
    if peer["behaviour"] == "LINEAR":
        # Node to surface also wants the tension at a large clearance, here 1/400 of the yield stress.
        tension = ", 1., 1e-3" if peer["contact"].startswith("NODE") else ""
        text += f"{options.overclosure * e / radius}{tension}\n"
    text += f"*FRICTION\n{mu}, {options.stick_slope * e / radius}\n"
    text += f"*CONTACT PAIR, INTERACTION=TOUCH, TYPE={peer['contact']}\nBELOW, ABOVE\n*BOUNDARY\nHELD, 1, 3\nSYMMETRY, 2, 2\n"
    h = shear = 0.0
    for segment in case["path"]:
        h, shear = segment.get("indentation", h), segment.get("shear", shear)
        text += f"*STEP, NLGEOM, INC=1000\n*STATIC, SOLVER={peer['solver']}\n{options.increment}, 1., 1e-6, {options.increment}\n"
        text += f"*BOUNDARY\nEQUATOR, 1, 1, {shear}\nEQUATOR, 2, 2\nEQUATOR, 3, 3, {-h}\n"
        text += "*NODE PRINT, NSET=EQUATOR, TOTALS=ONLY\nRF\n*END STEP\n"
    return text


def measured(command, log, limit, **options):
    """Runs a command; its exit code (negative if it was killed) and processor seconds."""

    def limited():
        os.nice(15)
        if limit:
            resource.setrlimit(resource.RLIMIT_CPU, (limit, limit))

    before = os.times()
    with open(log, "w") as out:
        words = [str(word) for word in command]
        code = subprocess.run(words, stdout=out, stderr=subprocess.STDOUT, preexec_fn=limited, **options).returncode
    after = os.times()
    return code, after.children_user - before.children_user + after.children_system - before.children_system


def forces(folder):
    """F_N and F_T of the whole sphere at the end of each increment, with the time, which counts the segments."""
    totals = r"total force .* for set EQUATOR and time\s+(\S+)\s+(\S+)\s+\S+\s+(\S+)"
    found = re.findall(totals, (folder / "deck.dat").read_text())
    return [(float(time), -2.0 * float(fz), 2.0 * float(fx)) for time, fx, fz in found]


def calculix(name, case, mesh, options, out):
    folder = out / name
    folder.mkdir(exist_ok=True)
    (folder / "deck.inp").write_text(deck(case, mesh, PEERS[name], options))
    for left in ("deck.dat", "deck.sta", "spooles.out"):
        (folder / left).write_text("")
    environment = os.environ | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    code, cpu = measured(["ccx", "-i", "deck"], folder / "log", options.limit, cwd=folder, env=environment)
    said = (folder / "log").read_text()
    singular = (folder / "spooles.out").exists() and "singular" in (folder / "spooles.out").read_text()
    errors = ["SPOOLES: matrix found to be singular"] if singular else []
    errors += [" ".join(line.split()) for line in said.splitlines() if "*ERROR" in line or "diverged" in line]
    rows = [line.split() for line in (folder / "deck.sta").read_text().splitlines() if re.match(r"\s+\d", line)]
    return code, cpu, forces(folder), len(rows), errors[-1] if errors else ""


def scripted(name, case, mesh, options, out):
    """Runs the script of a peer on the job; a code of None says that its package is missing."""
    script, module, source = SCRIPTS[name.split("-")[0]]
    # Debian's module belongs to Debian's Python.
    python = "/usr/bin/python3" if module == "getfem" else options.python
    environment = os.environ | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    found = subprocess.run([python, "-c", f"import {module}"], capture_output=True, env=environment)
    if found.returncode:
        return None, 0.0, [], 0, f"skipped: {python} has no {module.split('.')[0]} ({source})"
    folder = out / name
    folder.mkdir(exist_ok=True)
    (folder / "job.json").write_text(
        json.dumps({"case": case, "nodes": mesh.nodes, "elements": mesh.elements, "equator": mesh.equator,
                    "symmetry": mesh.symmetry, "contact": mesh.contact, "increment": options.increment})
    )
    words = [f"{key}={value}" for key, value in PEERS[name].items()] + options.peer_set
    code, cpu = measured([python, HERE / script, folder / "job.json", *words], folder / "log", options.limit, env=environment)
    said = (folder / "log").read_text().splitlines()
    curve = [tuple(map(float, line.split()[1:4])) for line in said if line.startswith("reached ")]
    others = [line for line in said if line.strip() and not line.startswith(("reached ", "step ", "Deregistering "))]
    return code, cpu, curve, len(curve), others[-1] if others else ""


def shear(rows, normal="F_N", tangential="F_T"):
    """(delta_T, F_N, F_T) along the shear of a history, from its start."""
    start = [row for row in rows if row["segment"] == "0"][-1]
    along = [(float(row["delta_T"]), float(row[normal]), float(row[tangential])) for row in rows if row["segment"] == "1"]
    return [(0.0, float(start["F_N"]), 0.0), *along]


def at(curve, place):
    for (x0, *y0), (x1, *y1) in zip(curve, curve[1:]):
        if x0 <= place <= x1:
            return [a + (place - x0) / (x1 - x0) * (b - a) for a, b in zip(y0, y1)]
    return curve[-1][1:]


def apart(curve, reference):
    end, scales = reference[-1][0], (reference[0][1], max(tangential for *_, tangential in reference))
    pairs = [(at(curve, end * i / 10), at(reference, end * i / 10)) for i in range(1, 11)]
    columns = [[100 * (a[k] - b[k]) / scales[k] for a, b in pairs] for k in (0, 1)]
    return [f"{(sum(x * x for x in column) / len(column)) ** 0.5:.1f} / {max(map(abs, column)):.1f}" for column in columns]


def asperity(options, folder, *sets):
    words = [word for value in (*options.set, *sets) for word in ("--set", value)]
    command = [options.asperity, "run", options.case, "--out", folder, "--force", "--device", "cpu", "--threads", "1", *words]
    code, cpu = measured(command, f"{folder}.log", None)
    if code:
        sys.exit(f"error: asperity ended with {code}; see {folder}.log")
    return cpu


def history(folder):
    with open(folder / "history.csv") as file:
        return list(csv.DictReader(file))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path)
    parser.add_argument("--case", type=Path, default=HERE / "case.toml")
    parser.add_argument("--asperity", default="asperity", metavar="PROGRAM")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE")
    parser.add_argument("--peers", default=",".join(PEERS), metavar="NAME,...")
    parser.add_argument("--limit", type=int, default=480, metavar="SECONDS")
    parser.add_argument("--increment", type=float, default=0.1, metavar="SHARE")
    parser.add_argument("--stick-slope", type=float, default=50.0, metavar="N", help="in E/R")
    parser.add_argument("--overclosure", type=float, default=100.0, metavar="N", help="in E/R")
    parser.add_argument("--python", default=sys.executable, metavar="PROGRAM", help="that has Kratos and Tamaas")
    parser.add_argument("--peer-set", action="append", default=[], metavar="KEY=VALUE", help="for the script of a peer")
    parser.add_argument("--kept", action="store_true")
    options = parser.parse_args()
    out = options.out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    results = out / "results.json"
    found = json.loads(results.read_text()) if options.kept else {}
    if not options.kept:
        fine = ("elements_per_contact_radius=10", "surface_elements_per_contact_radius=20")
        asperity(options, out / "default-mesh", *(f"mesh.{key}" for key in fine), "solver.error_estimate=true")
        found["Asperity"] = [0, asperity(options, out / "asperity"), [], 0, ""]
    rows = history(out / "asperity")
    case = tomllib.loads((out / "asperity" / "case.toml").read_text())
    mesh = Mesh(next((out / "asperity" / "fields").glob("*.vtu")))
    own, limit = shear(rows), shear(history(out / "default-mesh"), "F_N_limit", "F_T_limit")
    print(f"{3 * len(mesh.nodes)} displacements, {len(mesh.elements)} elements\n")
    print("| code | processor s | over Asperity's | increments | time reached | F_N0 | F_N, F_T at the end "
          "| same mesh: F_N | F_T | limit: F_N | F_T | end |")
    print("|---" * 12 + "|")
    ours = found["Asperity"][1]
    last = f"{own[0][1]:.1f} | {own[-1][1]:.1f}, {own[-1][2]:.2f}"
    print(f"| Asperity | {ours:.1f} | 1 | {len(rows)} | 2 | {last} | | | {' | '.join(apart(own, limit))} | done |", flush=True)
    for name in [name for name in found if name != "Asperity"] if options.kept else options.peers.split(","):
        if not options.kept:
            runner = scripted if name.split("-")[0] in SCRIPTS else calculix
            found[name] = runner(name, case, mesh, options, out)
            results.write_text(json.dumps(found))
        code, cpu, curve, tries, error = found[name]
        time, normal, tangential = curve[-1] if curve else (0.0, 0.0, 0.0)
        finished = code == 0 and time > 2.0 - 1e-9
        start = next((f"{n:.1f}" for t, n, _ in curve if abs(t - 1.0) < 1e-6), "")
        along = [(own[-1][0] * (t - 1.0), n, f) for t, n, f in curve if t > 1.0 - 1e-6]
        cells = [*apart(along, own), *apart(along, limit)] if finished else [""] * 4
        cells += ["done" if finished else error if code is None else f"code {code}; {error}"]
        head = f"{cpu:.1f} | {cpu / ours:.0f} | {tries} | {time:.3f} | {start} | {normal:.1f}, {tangential:.2f}"
        print(f"| {name} | {head} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
