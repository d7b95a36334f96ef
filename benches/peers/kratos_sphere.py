"""The job that peers.py writes, with Kratos Multiphysics: hexahedra, finite strains, mortar contact.

    python3 kratos_sphere.py JOB.json [KEY=VALUE]...

Keys and defaults are those of SETTINGS. The plane is one layer of elements with all nodes held. Prints
`reached TIME F_N F_T ITERATIONS` for each increment; the time counts the segments. An increment that
does not converge is taken back and halved. Written for Kratos 10.4.4 under Python 3.11:

    pip install KratosMultiphysics==10.4.4 KratosStructuralMechanicsApplication==10.4.4 \\
        KratosConstitutiveLawsApplication==10.4.4 KratosLinearSolversApplication==10.4.4 \\
        KratosContactStructuralMechanicsApplication==10.4.4
"""

import json
import sys

import KratosMultiphysics as KM
import KratosMultiphysics.ConstitutiveLawsApplication
import KratosMultiphysics.ContactStructuralMechanicsApplication as CSMA
import KratosMultiphysics.LinearSolversApplication
import KratosMultiphysics.StructuralMechanicsApplication as SMA
from KratosMultiphysics.StructuralMechanicsApplication.structural_mechanics_analysis import StructuralMechanicsAnalysis

FACES = [(0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0)]
SETTINGS = {
    "element": "UpdatedLagrangianElement3D8N",
    "law": "FiniteStrainIsotropicPlasticity3DVonMisesVonMises",
    "yield": "0",  # the yield stress; 0 for that of the case
    "contact": "ALMContactFrictional",  # or ALMContactFrictionless, PenaltyContactFrictional, ...
    "penalty": "0",  # in E/R; 0 leaves it to Kratos
    "scale": "0",  # of the multipliers, in E/R; 0 leaves it to Kratos
    "tangent": "0",  # tangential penalty over the normal one; 0 leaves it to Kratos
    "augment": "0",  # share of the tangential penalty that slipping nodes have
    "reset": "1",  # all nodes stick at the start of each that many increments
    "reset_later": "",  # the same after the press, if it differs
    "normals": "no_derivatives_computation",
    "criterion": "contact_residual_criterion",
    "tolerance": "1e-4",
    "iterations": "30",
    "least": "64",  # an increment is halved down to its first size over this
    "mixed": "0",
    "search": "3.5",
    "active": "0.01",
    "threshold": "0.02",
    "solver": "LinearSolversApplication.sparse_lu",
    "spring": "100",  # in E R: holds slave nodes on the plane of symmetry against vectors
    "whole": "0",  # 1 for the whole sphere instead of its half
    "builder": "block",
    "reach": "0.35",  # faces whose nodes lie within this distance of the axis, in R, may touch
    "squares": "16",  # of the plane, along x
    "echo": "0",
}


def material(options, case):
    """Kratos' properties of the sphere."""
    variables = {"YOUNG_MODULUS": case["material"]["youngs_modulus"], "POISSON_RATIO": case["material"]["poissons_ratio"],
                 "DENSITY": 1.0}
    if "Plasticity" in options["law"]:
        yielding = float(options["yield"]) or case["material"]["hardening"]["yield_stress"]
        variables |= {"YIELD_STRESS": yielding, "YIELD_STRESS_TENSION": yielding, "YIELD_STRESS_COMPRESSION": yielding,
                      "FRACTURE_ENERGY": 1e16, "HARDENING_CURVE": 3, "ISOTROPIC_HARDENING_MODULUS": 0.0,
                      "EXPONENTIAL_SATURATION_YIELD_STRESS": yielding, "HARDENING_EXPONENT": 0.0}
    return variables


def parameters(options, case):
    """Kratos' project parameters."""
    frictional, mu = "Frictional" in options["contact"], case["contact"]["friction"]
    radius, e = case["sphere"]["radius"], case["material"]["youngs_modulus"]
    kind = options["contact"].removeprefix("ALMContact").removeprefix("PenaltyContact")
    augmentation = {}
    if float(options["penalty"]):
        augmentation = {"manual_ALM": True, "penalty": float(options["penalty"]) * e / radius,
                        "scale_factor": (float(options["scale"]) or float(options["penalty"])) * e / radius}
    process = {"model_part_name": "Structure", "contact_model_part": {"0": ["Slave", "Master"]},
               "assume_master_slave": {"0": ["Slave"]}, "contact_type": kind, "normal_variation": options["normals"],
               "friction_coefficients": {"0": mu if frictional else 0.0}, "slip_threshold": float(options["threshold"]),
               "search_parameters": {"search_factor": float(options["search"]), "active_check_factor": float(options["active"])},
               "advance_ALM_parameters": augmentation}
    if frictional:
        process |= {"slip_augmentation_coefficient": float(options["augment"]),
                    "slip_step_reset_frequency": int(options["reset"])}
    if float(options["tangent"]):
        process["tangent_factor"] = float(options["tangent"])
    tolerance = float(options["tolerance"])
    contact = {"mortar_type": options["contact"], "use_mixed_ulm_solver": options["mixed"] == "1",
               "fancy_convergence_criterion": False, "print_convergence_criterion": False}
    contact |= {key: tolerance for key in (
        "contact_displacement_relative_tolerance", "contact_residual_relative_tolerance",
        "frictional_stick_contact_displacement_relative_tolerance", "frictional_stick_contact_residual_relative_tolerance",
        "frictional_slip_contact_displacement_relative_tolerance", "frictional_slip_contact_residual_relative_tolerance")}
    solver = {"solver_type": "static", "model_part_name": "Structure", "domain_size": 3, "echo_level": int(options["echo"]),
              "analysis_type": "non_linear", "model_import_settings": {"input_type": "use_input_model_part"},
              "material_import_settings": {"materials_filename": ""}, "time_stepping": {"time_step": 1.0}, "buffer_size": 3,
              "clear_storage": True, "reform_dofs_at_each_step": True, "builder_and_solver_settings": {"type": options["builder"], "advanced_settings": {}}, "compute_reactions": True,
              "solving_strategy_settings": {"type": "newton_raphson", "advanced_settings": {}},
              "convergence_criterion": options["criterion"], "max_iteration": int(options["iterations"]),
              "displacement_relative_tolerance": tolerance, "residual_relative_tolerance": tolerance,
              "contact_settings": contact, "linear_solver_settings": {"solver_type": options["solver"]}}
    name = "penalty" if options["contact"].startswith("Penalty") else "alm"
    contacts = {"python_module": f"{name}_contact_process", "process_name": "contact", "Parameters": process,
                "kratos_module": "KratosMultiphysics.ContactStructuralMechanicsApplication"}
    problem = {"problem_name": "sphere", "parallel_type": "OpenMP", "echo_level": int(options["echo"]), "start_time": 0.0,
               "end_time": 2.0}
    return KM.Parameters(json.dumps({"problem_data": problem, "solver_settings": solver,
                                     "processes": {"contact_process_list": [contacts]}, "output_processes": {}}))


def fill(part, job, options):
    """Nodes, elements and faces of the sphere and of the plane, which is one layer of hexahedra with all nodes held."""
    nodes, radius = job["nodes"], job["case"]["sphere"]["radius"]
    sphere, plane = part.CreateNewProperties(1), part.CreateNewProperties(2)
    part.CreateNewProperties(3)
    parts = {name: part.CreateSubModelPart(name) for name in ("Sphere", "Plane", "Slave", "Master")}
    for i, (x, y, z) in enumerate(nodes):
        part.CreateNewNode(i + 1, x, y, z)
    for i, element in enumerate(job["elements"]):
        part.CreateNewElement(options["element"], i + 1, [n + 1 for n in element], sphere)
    parts["Sphere"].AddElements(list(range(1, len(job["elements"]) + 1)))
    faces = []
    for e, s in job["contact"]:
        element = job["elements"][e]
        face = [element[k] for k in FACES[s]]
        if max(sum(x * x for x in nodes[n][:2]) ** 0.5 for n in face) > float(options["reach"]) * radius:
            continue
        faces.append(outward(nodes, face, element))
    below = sorted({n + 1 for face in faces for n in face})
    parts["Slave"].AddNodes(below)
    for i, face in enumerate(faces):
        parts["Slave"].CreateNewCondition("SurfaceCondition3D4N", i + 1, [n + 1 for n in face], sphere)
    grid(part, parts, plane, options, radius, len(nodes), len(job["elements"]), len(faces))
    for name in ("Sphere", "Plane"):
        parts[name].AddNodes(sorted({node.Id for element in parts[name].Elements for node in element.GetNodes()}))
    return below


def mirrored(job):
    """The whole sphere: the half of the job and its image in the plane of symmetry."""
    nodes, elements, image = list(job["nodes"]), list(job["elements"]), {}
    for n, (x, y, z) in enumerate(job["nodes"]):
        image[n] = n if abs(y) < 1e-12 else len(nodes)
        if image[n] != n:
            nodes.append((x, -y, z))
    # The image turns elements inside out: their two layers of nodes are exchanged.
    elements += [[image[element[k]] for k in (4, 5, 6, 7, 0, 1, 2, 3)] for element in job["elements"]]
    same = (1, 0, 2, 3, 4, 5)
    contact = job["contact"] + [(e + len(job["elements"]), same[s]) for e, s in job["contact"]]
    equator = sorted(set(job["equator"]) | {image[n] for n in job["equator"]})
    return job | {"nodes": nodes, "elements": elements, "contact": contact, "equator": equator, "symmetry": []}


def outward(nodes, face, element):
    """The face's nodes, counterclockwise from outside."""
    p = [nodes[n] for n in face]
    a, b = ([p[k][i] - p[0][i] for i in range(3)] for k in (1, 3))
    normal = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    inside = [sum(nodes[n][i] for n in element) / 8 - p[0][i] for i in range(3)]
    return face if sum(x * y for x, y in zip(normal, inside)) < 0.0 else face[::-1]


def grid(part, parts, plane, options, radius, nodes, elements, faces):
    """The layer under z = 0, a little wider than the faces that may touch."""
    across, wide = int(options["squares"]), 1.5 * float(options["reach"]) * radius
    side = 2 * wide / across
    along = across if options["whole"] == "1" else across // 2 + 1
    low = -wide if options["whole"] == "1" else -side
    name = {}
    for k in range(2):
        for j in range(along + 1):
            for i in range(across + 1):
                nodes += 1
                name[i, j, k] = nodes
                node = part.CreateNewNode(nodes, -wide + i * side, low + j * side, (k - 1) * 0.1 * radius)
    for j in range(along):
        for i in range(across):
            corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
            elements, faces = elements + 1, faces + 1
            hexahedron = [name[a, b, k] for k in (0, 1) for a, b in corners]
            part.CreateNewElement(options["element"], elements, hexahedron, plane)
            parts["Plane"].AddElements([elements])
            parts["Master"].AddNodes(hexahedron[4:])
            parts["Master"].CreateNewCondition("SurfaceCondition3D4N", faces, hexahedron[4:], plane)


def laws(model, options, case):
    e, nu = case["material"]["youngs_modulus"], case["material"]["poissons_ratio"]
    stiff = {"YOUNG_MODULUS": e, "POISSON_RATIO": nu, "DENSITY": 1.0}
    entries = [(1, "Sphere", options["law"], material(options, case)), (2, "Plane", "LinearElastic3DLaw", stiff)]
    properties = [{"model_part_name": f"Structure.{name}", "properties_id": i,
                   "Material": {"constitutive_law": {"name": law}, "Variables": variables, "Tables": {}}}
                  for i, name, law, variables in entries]
    KM.ReadMaterialsUtility(model).ReadMaterials(KM.Parameters(json.dumps({"properties": properties})))


class Sphere:
    """The run: increments along the path, halved where Kratos does not converge."""

    def __init__(self, job, options):
        self.job, self.options, case = job, options, job["case"]
        self.model = KM.Model()
        self.analysis = StructuralMechanicsAnalysis(self.model, parameters(options, case))
        self.part = self.model["Structure"]
        below = set(fill(self.part, job, options))
        # A multiplier across a held displacement has no equation: springs hold those nodes.
        vectors = options["contact"].startswith("ALM") and options["contact"] != "ALMContactFrictionless"
        self.springs = [n for n in job["symmetry"] if vectors and n + 1 in below]
        laws(self.model, options, case)
        stiffness = float(options["spring"]) * case["material"]["youngs_modulus"] * case["sphere"]["radius"]
        for i, n in enumerate(self.springs):
            spring = self.part.CreateNewElement("NodalConcentratedElement3D1N", 10**6 + i, [n + 1], self.part.GetProperties()[3])
            spring.SetValue(SMA.NODAL_DISPLACEMENT_STIFFNESS, KM.Array3([0.0, stiffness, 0.0]))
        self.analysis.Initialize()
        self.solver = self.analysis._GetSolver()
        self.equator = [self.part.Nodes[n + 1] for n in job["equator"]]
        for node in [*self.equator, *self.part.GetSubModelPart("Plane").Nodes]:
            for variable in (KM.DISPLACEMENT_X, KM.DISPLACEMENT_Y, KM.DISPLACEMENT_Z):
                node.Fix(variable)
        for n in job["symmetry"]:
            if n not in self.springs:
                self.part.Nodes[n + 1].Fix(KM.DISPLACEMENT_Y)

    def increment(self, time, plate, retry):
        """One increment to the plate's displacement; the number of iterations, 0 if it did not converge."""
        analysis, info = self.analysis, self.part.ProcessInfo
        if retry:
            self.part.ReduceTimeStep(self.part, time)
        else:
            info[KM.STEP] += 1
            self.part.CloneTimeStep(time)
        analysis.time = time
        for node in self.equator:
            node.SetSolutionStepValue(KM.DISPLACEMENT, 0, plate)
        analysis.InitializeSolutionStep()
        try:
            converged = analysis.SolveSolutionStep()
        except RuntimeError as error:
            print(" ".join(str(error).split())[:150], flush=True)
            converged = False
        if converged:
            analysis.FinalizeSolutionStep()
            return info[KM.NL_ITERATION_NUMBER]
        for process in analysis._GetListOfProcesses():
            process.ExecuteFinalizeSolutionStep()
        self.part.OverwriteSolutionStepData(1, 0)
        KM.VariableUtils().UpdateCurrentPosition(self.part.Nodes, KM.DISPLACEMENT)
        return 0

    def run(self):
        h = shear = 0.0
        both = 1 if self.options["whole"] == "1" else 2
        for number, segment in enumerate(self.job["case"]["path"]):
            if number and self.options["reset_later"]:
                self.analysis._GetListOfProcesses()[0].slip_step_reset_frequency = int(self.options["reset_later"])
            goal_h, goal_shear = segment.get("indentation", h), segment.get("shear", shear)
            done, step, retry = 0.0, self.job["increment"], False
            while done < 1.0 - 1e-9:
                share = min(1.0, done + step)
                plate = [shear + share * (goal_shear - shear), 0.0, -(h + share * (goal_h - h))]
                iterations = self.increment(number + share, KM.Array3(plate), retry)
                retry = iterations == 0
                if retry:
                    step /= 2
                    print(f"halved to {step:.4g} at {number + done:.4f}", flush=True)
                    if step < self.job["increment"] / float(self.options["least"]):
                        sys.exit(f"no convergence in increments of {2 * step:.4g} at {number + done:.4f}")
                    continue
                done = share
                step = min(2 * step, self.job["increment"]) if iterations < 10 else step
                force = [sum(node.GetSolutionStepValue(KM.REACTION)[k] for node in self.equator) for k in range(3)]
                print(f"reached {number + done:.6f} {-both * force[2]:.6g} {both * force[0]:.6g} {iterations}", flush=True)
            h, shear = goal_h, goal_shear


def main():
    with open(sys.argv[1]) as file:
        job = json.load(file)
    given = dict(word.split("=", 1) for word in sys.argv[2:])
    unknown = set(given) - set(SETTINGS)
    if unknown:
        sys.exit(f"unknown: {', '.join(sorted(unknown))}")
    print(f"Kratos {KM.Kernel.Version()}", flush=True)
    options = SETTINGS | given
    Sphere(mirrored(job) if options["whole"] == "1" else job, options).run()


main()
