"""The press of the job that peers.py writes, with Tamaas: a rigid sphere on an elastic-plastic half-space.

    python3 tamaas_sphere.py JOB.json [KEY=VALUE]...

Keys and defaults are those of SETTINGS. Written for Tamaas 2.9.0 under Python 3.11: `pip install tamaas==2.9.0`.

Tamaas has half-spaces only: the sphere is a rigid paraboloid here, and the flat yields, with the E of the
case, small strains and no friction. It is driven by its mean pressure: forces rise by equal steps until the
approach is that of the case. Its half-space is periodic; the approach is corrected to a single contact.
Prints what the solvers with friction say to the model, then `step APPROACH F_N A` and `reached TIME F_N 0`
for each step of the press.
"""

import json
import sys

import numpy as np
import tamaas as tm
from tamaas.nonlinear_solvers import DFSANECXXSolver

SETTINGS = {
    "squares": "28",  # of the surface, along each side
    "layers": "12",
    "width": "1.4",  # of the period, in R
    "depth": "0.5",  # of the layers that may yield, in R
    "yield": "0",  # the yield stress; 0 for that of the case
    "hardening": "0",  # in E
    "scheme": "anderson",  # or relaxed
    "tolerance": "1e-4",
    "inner": "1e-9",
    "steps": "4",
}
# A square lattice of point forces: under each, the half-space moves by LATTICE F/(pi E* width) less
# than under a single one.
LATTICE = 3.900264920


def half_space(case, options):
    """The model, the surface of the sphere and its elastic-plastic solver; stresses are over E, lengths over R."""
    width, depth = float(options["width"]), float(options["depth"])
    across, layers = int(options["squares"]), int(options["layers"])
    model = tm.Model(tm.model_type.volume_2d, [depth, width, width], [layers, across, across])
    model.E, model.nu = 1.0, case["material"]["poissons_ratio"]
    x = (np.arange(across) - across // 2) * width / across
    surface = -(x[:, None] ** 2 + x[None, :] ** 2) / 2
    yielding = float(options["yield"]) or case["material"]["hardening"]["yield_stress"]
    unit = case["material"]["youngs_modulus"]
    material = tm.materials.IsotropicHardening(model, yielding / unit, float(options["hardening"]))
    inner = DFSANECXXSolver(tm.Residual(model, material))
    inner.tolerance = float(options["inner"])
    contact = tm.PolonskyKeerRey(model, surface, 1e-12)
    tolerance = float(options["tolerance"])
    if options["scheme"] == "anderson":
        return model, surface, inner, tm.AndersonMixing(contact, inner, tolerance)
    return model, surface, inner, tm.EPICSolver(contact, inner, tolerance, 0.3)


def press(case, options, model, surface, inner, scheme):
    """Forces up to the approach of the case."""
    unit, radius = case["material"]["youngs_modulus"], case["sphere"]["radius"]
    yielding = case["material"]["hardening"]["yield_stress"]
    goal = case["path"][0]["indentation"] / radius
    width = float(options["width"])
    stiffness = unit / (1.0 - model.nu**2)
    # The last force, guessed: 2.8 times the yield stress on what the sphere cuts from the plane.
    step = 2.8 * yielding * np.pi * 2.0 * goal / int(options["steps"])
    before, force = (0.0, 0.0), 0.0
    while before[0] < goal:
        force += step
        # The scheme takes what has stayed behind off the surface itself; a solution holds the rest.
        start = surface.copy()
        error = scheme.solve(force / unit / width**2)
        if not error <= float(options["tolerance"]):
            sys.exit(f"no convergence at F_N {force * radius**2:.4g}: error {error:.2g}")
        inner.updateState()
        touching = model.traction[..., 2] > 0.0
        area = np.count_nonzero(touching) * (width / int(options["squares"])) ** 2
        reached = np.mean((model.displacement[0, ..., 2] - start)[touching]) + LATTICE * force / (np.pi * stiffness * width)
        print(f"step {reached:.5f} {force * radius**2:.6g} {np.sqrt(area / np.pi):.4f}", flush=True)
        if reached > goal:
            share = (goal - before[0]) / (reached - before[0])
            between = before[1] + share * (force - before[1])
            print(f"reached 1.000000 {between * radius**2:.6g} 0", flush=True)
        else:
            print(f"reached {reached / goal:.6f} {force * radius**2:.6g} 0", flush=True)
        before = reached, force


def friction(case, model, surface):
    """Hands the model to the solvers with friction; the last refusal."""
    said = ""
    for solver in (tm.Kato, tm.Condat, tm.BeckTeboulle):
        try:
            solver(model, surface, 1e-6, case["contact"]["friction"])
        except Exception as error:
            said = f"{solver.__name__}: {str(error).rsplit(': ', 1)[-1]}"
            print(said, flush=True)
    return said


def main():
    with open(sys.argv[1]) as file:
        case = json.load(file)["case"]
    given = dict(word.split("=", 1) for word in sys.argv[2:])
    unknown = set(given) - set(SETTINGS)
    if unknown:
        sys.exit(f"unknown: {', '.join(sorted(unknown))}")
    tm.set_log_level(tm.LogLevel.error)
    print(f"Tamaas {tm.__version__}", flush=True)
    options = SETTINGS | given
    model, surface, inner, scheme = half_space(case, options)
    said = friction(case, model, surface)
    press(case, options, model, surface, inner, scheme)
    if said:
        sys.exit(said)


main()
