"""Force-displacement law of an elastic-plastic sphere: @SOURCE@, h/R up to @DEEPEST@.

Written by asperity @VERSION@. Python 3.8 or later; a C compiler (cc, or what CC names) compiles the update when the module is imported.
One contact a call: for reading, checking and small models.

    pair = setup(200e3, radius)                         # Young's modulus and radius, in any one consistent system of units
    state = State()                                     # before first contact
    state, response = update(pair, state, h, (d0, d1))  # each step: the indentation, the tangential increment
    state = State.from_bytes(state.to_bytes())          # a restart; the bytes are those of the C struct

f_t points along the displacement: it is what drives the sphere. asperity_contact.h, which is in this file, says what the model is;
`python3 asperity_law.py VECTORS.csv` compares this module with the test vectors.
"""

import ctypes
import math
import os
import pathlib
import shlex
import subprocess
import tempfile

SLIDERS = @SLIDERS@

HEADER = r"""
@HEADER@"""

TABLE = """@TABLE@"""

SHIM = r"""
#include "asperity_contact.h"
int law_read(const char *path, asperity_table *t) { return asperity_read_table(path, t); }
int law_table_size(void) { return (int)sizeof(asperity_table); }
void law_update(const asperity_table *t, double r, double e, asperity_state *s, double h, const double *d, asperity_response *out, asperity_tangent *by) {
    asperity_update(t, r, e, s, h, d, s, out, by);
}
void law_rotate(asperity_state *s, double c, double n) { asperity_rotate(s, c, n); }
double law_stored(const asperity_table *t, double r, double e, const asperity_state *s) { return asperity_stored_energy(t, r, e, s); }
int law_beyond(const asperity_table *t, const asperity_state *s) { return asperity_out_of_range(t, s); }
"""


class State(ctypes.Structure):
    """The memory of a contact, lengths over R; as constructed, that before first contact."""

    _fields_ = [
        *((name, ctypes.c_double) for name in ("h", "h_max", "approach", "hardened", "reach", "softened", "released", "worn", "stiffened")),
        ("vertex", ctypes.c_double * 2),
        ("slider", ctypes.c_double * SLIDERS * 3),
        ("hint", ctypes.c_double * 3),
    ]

    def copy(self):
        """An independent copy."""
        return State.from_buffer_copy(self)

    def to_bytes(self):
        """The memory as bytes."""
        return bytes(self)

    @classmethod
    def from_bytes(cls, data):
        """The memory from its bytes."""
        if len(data) != ctypes.sizeof(cls):
            raise ValueError("the memory of a contact has %d bytes, not %d" % (ctypes.sizeof(cls), len(data)))
        return cls.from_buffer_copy(data)


class Response(ctypes.Structure):
    """The answer of an increment: forces, the stiffness of an unloading, elastic energy, work dissipated by plastic flow and by slip, and what the step
    lacks where nothing solves it, over F_N."""

    _fields_ = [
        ("f_n", ctypes.c_double),
        ("f_t", ctypes.c_double * 2),
        *((name, ctypes.c_double) for name in ("stiffness", "stored", "plastic", "friction", "unsolved")),
    ]


class Tangent(ctypes.Structure):
    """Derivatives of the forces, and the contact radius."""

    _fields_ = [
        ("df_t_ddelta", ctypes.c_double * 2 * 2),
        ("df_n_dh", ctypes.c_double),
        ("df_n_ddelta", ctypes.c_double * 2),
        ("df_t_dh", ctypes.c_double * 2),
        ("a", ctypes.c_double),
    ]


def _compiled():
    """The update as a library, and its table."""
    with tempfile.TemporaryDirectory(prefix="asperity-law-") as folder:
        place = pathlib.Path(folder)
        (place / "asperity_contact.h").write_text(HEADER)
        (place / "law.asperity").write_text(TABLE)
        (place / "shim.c").write_text(SHIM)
        command = [*shlex.split(os.environ.get("CC", "cc")), "-std=c99", "-O2", "-shared", "-fPIC", "-o", "law.so", "shim.c", "-lm"]
        try:
            subprocess.run(command, cwd=folder, check=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        except FileNotFoundError:
            raise ImportError("asperity_law needs a C compiler: there is no %s. Install one, or name it in CC" % command[0]) from None
        except subprocess.CalledProcessError as failed:
            raise ImportError("asperity_law: %s failed: %s" % (command[0], failed.stderr.decode(errors="replace").strip())) from None
        library = ctypes.CDLL(str(place / "law.so"))
        table = ctypes.create_string_buffer(library.law_table_size())
        code = library.law_read(str(place / "law.asperity").encode(), table)
    if code != 0:
        raise ImportError("asperity_law: its table is damaged (%d)" % code)
    real, at = ctypes.c_double, ctypes.c_void_p
    library.law_update.argtypes = [at, real, real, at, real, at, at, at]
    library.law_update.restype = None
    library.law_rotate.argtypes = [at, real, real]
    library.law_rotate.restype = None
    library.law_stored.argtypes = [at, real, real, at]
    library.law_stored.restype = real
    library.law_beyond.argtypes = [at, at]
    return library, table


_LIBRARY, _TABLE = _compiled()


class Pair:
    """The bodies of a contact."""

    __slots__ = ("youngs_modulus", "radius")


def setup(youngs_modulus, radius):
    """The bodies of a contact: the sphere's Young's modulus and radius; ValueError for a number out of its range."""
    if not (0.0 < youngs_modulus < math.inf and 0.0 < radius < math.inf):
        raise ValueError("give E > 0 and R > 0")
    pair = Pair()
    pair.youngs_modulus = youngs_modulus
    pair.radius = radius
    return pair


def update(pair, state, h, increment):
    """Moves a contact to the indentation h and along the plane by `increment`. Returns the new state, and the response with its `tangent`.

    Where h or the increment is not finite, or the state is not sound, nothing in the response is a number and the state stays as it was."""
    after, out, by = state.copy(), Response(), Tangent()
    moved = (ctypes.c_double * 2)(*increment)
    _LIBRARY.law_update(_TABLE, pair.radius, pair.youngs_modulus, ctypes.byref(after), h, moved, ctypes.byref(out), ctypes.byref(by))
    out.tangent = by
    return after, out


def rotate(state, cosine, sine):
    """The state in axes that are turned by an angle: new components of a vector v are (c v0 + s v1, -s v0 + c v1)."""
    turned = state.copy()
    _LIBRARY.law_rotate(ctypes.byref(turned), cosine, sine)
    return turned


def stored_energy(pair, state):
    """Elastic energy that the contact stores: no path gives back more than it. No number where the state is not sound."""
    return _LIBRARY.law_stored(_TABLE, pair.radius, pair.youngs_modulus, ctypes.byref(state))


def out_of_range(state):
    """Whether a contact has been deeper than the law was made for."""
    return bool(_LIBRARY.law_beyond(_TABLE, ctypes.byref(state)))


def check(path):
    """Runs the test vectors of a CSV file; returns the number of rows and the greatest error, relative to each path's greatest value."""
    import csv

    with open(path, newline="") as file:
        lines = [{key: float(value) for key, value in line.items()} for line in csv.DictReader(file)]
    errors, greatest, current, state, pair = [], {}, None, None, None
    for line in lines:
        if line["path"] != current:
            current, pair, state = line["path"], setup(line["E"], line["R"]), State()
        state = rotate(state, line["cosine"], line["sine"])
        state, out = update(pair, state, line["h"], (line["d0"], line["d1"]))
        state = State.from_bytes(state.to_bytes())
        ours = {"f_n": out.f_n, "f_t0": out.f_t[0], "f_t1": out.f_t[1], "a": out.tangent.a, "energy": stored_energy(pair, state)}
        for key, value in ours.items():
            if not math.isfinite(value - line[key]):
                return len(lines), math.inf
            place = (current, key[:3])
            greatest[place] = max(greatest.get(place, 0.0), abs(line[key]))
            errors.append((place, abs(value - line[key])))
    worst = max((error / greatest[place] if greatest[place] > 0.0 else error) for place, error in errors)
    return len(lines), worst


if __name__ == "__main__":
    import sys

    if len(sys.argv) != 2:
        sys.exit("usage: python3 asperity_law.py VECTORS.csv")
    count, worst = check(sys.argv[1])
    print("%d rows, greatest relative error %.3g" % (count, worst))
    sys.exit(0 if count > 0 and worst <= 1e-9 else 1)
