"""Computed contact laws through `fix external`, in any LAMMPS that Python can load: no plug-in, nothing of LAMMPS compiled.

    lmp = lammps()
    ...                                    # atom_style sphere, comm_modify vel yes, box, spheres
    contacts = External(lmp, "libasperity_external.so", cutoff=1.0)
    contacts.law(1, 1, "copper.asperity", 120e3, restitution=0.5)
    lmp.command("run 1000")
    print(contacts.plastic, contacts.slip, contacts.damped, contacts.stored)

One process: contacts do not move from one to another. Masses are those of the spheres, also in rigid bodies. Its licence is the repository's (MIT or Apache-2.0).
"""

import ctypes

NEIGHBOURS = "lammps_neighlist_element_neighbors"
PLACES = ctypes.POINTER(ctypes.POINTER(ctypes.c_double))
NUMBERS = ctypes.POINTER(ctypes.c_double)
COUNTS = ctypes.POINTER(ctypes.c_int)


class Atoms(ctypes.Structure):
    """asperity_atoms of asperity_external.cpp."""

    _fields_ = [("count", ctypes.c_int), ("id", COUNTS), ("type", COUNTS), ("x", PLACES), ("v", PLACES), ("omega", PLACES), ("radius", NUMBERS), ("mass", NUMBERS), ("torque", PLACES),
                ("lammps", ctypes.c_void_p), ("neighbours", ctypes.c_void_p), ("list", ctypes.c_int), ("length", ctypes.c_int)]


class External:
    """Contacts of all spheres of a LAMMPS instance. cutoff: the greatest distance of the centres of two spheres that touch."""

    def __init__(self, lmp, library, cutoff, fix="asperity"):
        if lmp.extract_setting("world_size") != 1:
            raise RuntimeError("asperity: contacts through fix external are for one process")
        self.lmp, self.fix, self.failure = lmp, fix, None
        self.stored = self.plastic = self.slip = self.damped = 0.0
        self.library = ctypes.CDLL(library)
        self.library.asperity_open.restype = ctypes.c_void_p
        self.library.asperity_close.argtypes = [ctypes.c_void_p]
        self.library.asperity_add_law.argtypes = [ctypes.c_void_p, ctypes.c_int, ctypes.c_int, ctypes.c_char_p, ctypes.c_double, ctypes.c_double]
        self.library.asperity_forces_of_all.argtypes = [ctypes.c_void_p, ctypes.POINTER(Atoms), ctypes.c_double, NUMBERS, NUMBERS]
        self.engine = self.library.asperity_open(lmp.extract_setting("ntypes"))
        self.step = lmp.extract_global("ntimestep")
        # A pair style without forces keeps the neighbour list; each pair stands in it twice.
        lmp.commands_string(f"pair_style zero {cutoff!r} full\npair_coeff * *\nfix {fix} all external pf/callback 1 1\nfix_modify {fix} energy yes")
        lmp.set_fix_external_callback(fix, self.forces, None)

    def law(self, one, other, table, modulus, restitution=1.0):
        """The table of two spheres of these types, Young's modulus, and the restitution coefficient of an impact that stays elastic."""
        code = self.library.asperity_add_law(self.engine, one, other, str(table).encode(), modulus, restitution)
        if code:
            raise ValueError(f"asperity: {table}: " + {-1: "cannot be opened", -2: "is no contact table of this version", -3: "is damaged", 1: "is the table of a sphere on a plane",
                                                      3: f"Young's modulus {modulus} is not positive", 4: f"a restitution of {restitution} is not between 0.1 and 1"}.get(code, f"code {code}"))

    def forces(self, _, step, count, ids, x, f):
        """What LAMMPS calls in every step, and once before a run, when no contact may move on."""
        lmp = self.lmp
        atom = lmp.extract_atom
        lists = lmp.find_pair_neighlist("zero")
        atoms = Atoms(count, atom("id"), atom("type"), atom("x"), atom("v"), atom("omega"), atom("radius"), atom("rmass"), atom("torque"), lmp.lmp,
                      ctypes.cast(getattr(lmp.lib, NEIGHBOURS), ctypes.c_void_p), lists, lmp.get_neighlist_size(lists))
        sums = (ctypes.c_double * 4)()
        moved = step > self.step
        f[:] = 0.0
        culprit = self.library.asperity_forces_of_all(self.engine, ctypes.byref(atoms), lmp.extract_global("dt") if moved else 0.0, f.ctypes.data_as(NUMBERS), sums)
        if culprit:
            # An exception does not come out of a callback: the run is stopped, and the caller told by `check`.
            self.failure = f"asperity: there is no force or no law for a contact of sphere {culprit}"
            lmp.force_timeout()
            return
        self.stored = sums[0]
        if moved:
            self.plastic += sums[1]
            self.slip += sums[2]
            self.damped += sums[3]
        self.step = step
        lmp.fix_external_set_energy_global(self.fix, self.stored)

    def check(self):
        """Raises what stopped the last run."""
        if self.failure:
            raise RuntimeError(self.failure)

    def close(self):
        if self.engine:
            self.library.asperity_close(self.engine)
            self.engine = None
