#!/usr/bin/env python3
"""Squares the numbers of tables as pandas reads them: what is no count must not be a whole number.

usage: check_numbers.py STUDY.csv HISTORY.csv CONTACT.csv
"""
import sys

import numpy as np
import pandas as pd

counts = {
    "step", "segment", "newton_iterations", "cutbacks", "krylov_iterations", "contact_points", "slipping_points", "relaxed", "landed_again", "point",
    "elements_per_contact_radius", "surface_elements_per_contact_radius", "mesh.elements_per_contact_radius",
}
for name in sys.argv[1:]:
    for column, values in pd.read_csv(name).items():
        if values.dtype.kind == "i":
            assert column in counts, (name, column, values.dtype)
        elif values.dtype.kind == "f":
            assert np.array_equal(values**2, [float(value) * float(value) for value in values], equal_nan=True), (name, column)
study = pd.read_csv(sys.argv[1])
assert (study["E"] ** 2).min() == 7e10**2 and (study["material.youngs_modulus"] ** 2).max() == 2e11**2, study["E"] ** 2
print("no square overflows")
