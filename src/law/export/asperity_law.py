"""Force-displacement law of an elastic-plastic sphere on a rigid plane, as an incremental contact update.

Written by asperity @VERSION@ from @SOURCE@. Python 3.8 or later, standard library only; the twin of asperity_law.h, with
the same functions in the same order, for reading, checking and small models: one contact a call.

    steel = Material(200e3, 0.3, IDEAL, (400.0, 0.0, 0.0))
    pair = setup(steel, radius, friction)
    state = State()                                     # before first contact
    state, response = update(pair, state, h, (d0, d1))  # each step: the indentation, the tangential increment
    state = State.from_bytes(state.to_bytes())          # a restart; the bytes are those of the C struct on a little-endian machine

Any one consistent system of units. For two equal spheres h and the increment are half of the overlap and of the relative displacement (exact
without friction only, see asperity_law.h). f_t points along the displacement: it is what drives the sphere. asperity_law.h says what the model is and where it holds; `python3 asperity_law.py
VECTORS.csv` compares this module with the test vectors.
"""

import math
import struct

NORMAL_CURVE = @NORMAL_CURVE@  # f_N: 1 is 1 - (1 - x^M)^N, 2 by numbers
KNOTS = @KNOTS@
COLUMNS = @COLUMNS@
SLIDERS = @SLIDERS@
POINTS = @POINTS@  # of a shape that is given by numbers, x = (j/POINTS)^2
LEVELS = @LEVELS@

# Hardening laws, with their numbers.
@HARDENING_CODES@


class Material:
    """A sphere's material."""

    __slots__ = ("youngs_modulus", "poissons_ratio", "hardening", "hardening_numbers", "points")

    def __init__(self, youngs_modulus, poissons_ratio, hardening, hardening_numbers=(0.0, 0.0, 0.0), points=()):
        self.youngs_modulus = youngs_modulus
        self.poissons_ratio = poissons_ratio
        self.hardening = hardening
        self.hardening_numbers = hardening_numbers
        self.points = points


@CONTACT_TYPES@@CONTACT_TABLE@@SETUP@@CONTACT_UPDATE@# ---- check against the test vectors ----


def check(path, tolerance=1e-12):
    """Runs the test vectors of a CSV file; returns the number of rows and the greatest error, relative to each path's greatest value."""
    import csv

    with open(path, newline="") as file:
        lines = [{key: float(value) for key, value in line.items()} for line in csv.DictReader(file)]
    errors, greatest, current, state, pair = [], {}, None, None, None
    for line in lines:
        if line["path"] != current:
            current = line["path"]
            numbers = (line["stress"], line["second"], line["third"])
            material = Material(line["E"], line["nu"], int(line["hardening"]), numbers)
            pair = setup(material, line["R"], line["mu"])
            state = State()
        state = rotate(state, line["cosine"], line["sine"])
        state, out = update(pair, state, line["h"], (line["d0"], line["d1"]))
        state = State.from_bytes(state.to_bytes())
        ours = {
            "f_n": out.f_n, "f_t0": out.f_t[0], "f_t1": out.f_t[1],
            "k00": out.df_t_ddelta[0][0], "k01": out.df_t_ddelta[0][1], "k10": out.df_t_ddelta[1][0], "k11": out.df_t_ddelta[1][1],
            "kn": out.df_n_dh, "kn0": out.df_n_ddelta[0], "kn1": out.df_n_ddelta[1],
            "a": out.a, "energy": stored_energy(pair, state),
        }  # fmt: skip
        for key, value in ours.items():
            if not math.isfinite(value - line[key]):
                return len(lines), math.inf
            place = (current, key)
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
    sys.exit(0 if count > 0 and worst <= 1e-12 else 1)
