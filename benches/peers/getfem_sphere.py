"""The job that peers.py writes, with GetFEM: Q1/P0 hexahedra, Simo and Miehe's plasticity, an integral contact condition with
Coulomb friction (augmented Lagrangian). Prints `reached TIME F_N F_T` for each increment; the time counts the segments.

    python3 getfem_sphere.py JOB.json
"""

import json
import sys

import getfem as gf
import numpy as np

CONTACT, EQUATOR, SYMMETRY = 1, 2, 3
# Augmentation parameter of the contact, in E/R.
AUGMENTATION = 10.0
# VTK's order of a hexahedron's nodes in GetFEM's, x fastest.
ORDER = [0, 1, 3, 2, 4, 5, 7, 6]
# The line search of GetFEM's own example of this plasticity.
SEARCH = ["lsearch", "simplest", "alpha max ratio", 1.5, "alpha min", 0.05, "alpha mult", 0.6]
FACES = [(0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0)]


def meshed(job, nodes):
    """The mesh with its three regions."""
    mesh = gf.Mesh("empty", 3)
    hexahedron = gf.GeoTrans("GT_QK(3,1)")
    for element in job["elements"]:
        mesh.add_convex(hexahedron, nodes[[element[k] for k in ORDER]].T)
    key = {tuple(np.round(x, 9)): i for i, x in enumerate(nodes)}
    pids = mesh.pid()
    original = dict(zip(pids, (key[tuple(np.round(x, 9))] for x in mesh.pts(list(pids)).T)))
    touching = {frozenset(job["elements"][e][k] for k in FACES[s]) for e, s in job["contact"]}
    equator, symmetry = set(job["equator"]), set(job["symmetry"]) | {n for n in job["equator"] if abs(nodes[n][1]) < 1e-12}
    regions = {CONTACT: [], EQUATOR: [], SYMMETRY: []}
    for element, face in mesh.outer_faces().T:
        own = frozenset(original[p] for p in mesh.pid_in_faces(np.array([[element], [face]])))
        if own in touching:
            regions[CONTACT].append((element, face))
        elif own <= equator:
            regions[EQUATOR].append((element, face))
        elif own <= symmetry:
            regions[SYMMETRY].append((element, face))
    for region, faces in regions.items():
        print(f"region {region}: {len(faces)} faces", file=sys.stderr)
        mesh.set_region(region, np.array(faces).T)
    return mesh


def main():
    gf.util_trace_level(1)
    with open(sys.argv[1]) as file:
        job = json.load(file)
    case, nodes = job["case"], np.array(job["nodes"])
    mesh = meshed(job, nodes)
    whole, scalar, pressure, multiplier = (gf.MeshFem(mesh, n) for n in (3, 1, 1, 1))
    whole.set_fem(gf.Fem("FEM_QK(3,1)"))
    # u_y = 0 on the symmetry plane.
    held = whole.basic_dof_on_region(SYMMETRY)
    held = held[np.abs(whole.basic_dof_nodes(held)[1]) < 1e-12]
    displacements = gf.MeshFem("partial", whole, np.setdiff1d(np.arange(whole.nb_basic_dof()), held[1::3]))
    scalar.set_fem(gf.Fem("FEM_QK(3,1)"))
    pressure.set_fem(gf.Fem("FEM_QK(3,0)"))
    multiplier.set_fem(gf.Fem("FEM_QK_DISCONTINUOUS(3,1)"))
    points = gf.MeshIm(mesh, gf.Integ("IM_GAUSS_PARALLELEPIPED(3,3)"))
    states = gf.MeshImData(points, -1, 1), gf.MeshImData(points, -1, 6)

    # Stresses over E: the equations are then of like size.
    unit, nu = case["material"]["youngs_modulus"], case["material"]["poissons_ratio"]
    e, sigma = 1.0, case["material"]["hardening"]["yield_stress"] / unit
    gf.asm_define_function("yield_limit", 1, f"({np.sqrt(2 / 3) * sigma}+0*t)")
    model = gf.Model("real")
    model.add_fem_variable("u", displacements)
    model.add_fem_variable("ksi", multiplier)
    model.add_fem_variable("p", pressure)
    model.add_im_data("gamma0", states[0])
    model.add_im_data("invCp0", states[1])
    count = states[1].nbpts()
    model.set_variable("invCp0", np.tile([1.0, 1.0, 1.0, 0.0, 0.0, 0.0], count))
    law = ("Simo_Miehe", "displacement_and_plastic_multiplier_and_pressure", "u", "ksi", "p", "gamma0", "invCp0",
           repr(e / (3 * (1 - 2 * nu))), repr(e / (2 * (1 + nu))), "yield_limit")
    model.add_finite_strain_elastoplasticity_brick(points, *law)

    model.add_filtered_fem_variable("stress", displacements, CONTACT)
    model.add_initialized_fem_data("gap", scalar, scalar.eval("z"))
    model.add_initialized_data("r", [AUGMENTATION * e / case["sphere"]["radius"]])
    model.add_initialized_data("mu", [case["contact"]["friction"]])
    model.add_initialized_data("alpha", [1.0])
    model.add_fem_data("before", displacements)
    model.add_integral_contact_with_rigid_obstacle_brick(points, "u", "stress", "gap", "r", "mu", CONTACT, 1, "alpha", "before")

    model.add_initialized_data("plate", [0.0, 0.0, 0.0])
    model.add_Dirichlet_condition_with_multipliers(points, "u", displacements, EQUATOR, "plate")
    print(f"{displacements.nbdof()} displacements, {model.nbdof()} unknowns", file=sys.stderr)

    h = shear = 0.0
    last = None
    for number, segment in enumerate(case["path"]):
        goal_h, goal_shear = segment.get("indentation", h), segment.get("shear", shear)
        done, step = 0.0, job["increment"]
        while done < 1.0 - 1e-9:
            share = min(1.0, done + step)
            kept = model.from_variables()
            start = model.variable("u")
            model.set_variable("before", start)
            # The last increment again, as a first guess.
            if last is not None and done > 0.0:
                model.set_variable("u", start + last[0] * (share - done) / last[1])
            model.set_variable("plate", [shear + share * (goal_shear - shear), 0.0, -(h + share * (goal_h - h))])
            iterations, converged = model.solve("max_iter", 40, "max_res", 1e-8, "lsolver", "mumps", *SEARCH, *sys.argv[2:])
            if not converged:
                model.to_variables(kept)
                step /= 2
                print(f"halved to {step:.4g} at {number + done:.4f} after {iterations} iterations", flush=True)
                if step < job["increment"] / 64:
                    sys.exit(f"no convergence in increments of {2 * step:.4g} at {number + done:.4f}")
                continue
            model.finite_strain_elastoplasticity_next_iter(points, *law)
            last = model.variable("u") - start, share - done
            done = share
            step = min(2 * step, job["increment"]) if iterations < 10 else step
            fx, _, fz = (gf.asm_generic(points, 0, f"stress({k})", CONTACT, model) for k in (1, 2, 3))
            print(f"reached {number + done:.6f} {2 * unit * fz:.6g} {-2 * unit * fx:.6g} {iterations}", flush=True)
        h, shear = goal_h, goal_shear


main()
