#!/usr/bin/env python3
"""ROUNDNESS of src/contact_law/cohesion.rs: the shape c of a flattened contact from the exponent gamma of its unloading.

    python3 benches/law/fit_roundness.py

The area of the contact goes with y (1 + c - c y), y = e/D, and the stiffness with its root, so that 1/gamma is the integral of
sqrt(y (1 + c - c y)) from 0 to 1: 2/3 of a sphere (c = 0), pi/4 of a uniform pressure taken off (c = 1). With g from 0 to 1 as
gamma goes from 3/2 to 4/pi, c = g + g (1 - g) (r0 + r1 g + r2 g^2). Prints r0, r1, r2 of least squares and what c is then off
at most. Standard library only.
"""

import math

PLACES = 200


def gamma(c):
    """By Simpson's rule in the root of y, in which the integrand is smooth."""
    n = 400
    inside = lambda s: 2 * s * s * math.sqrt(1 + c * (1 - s * s))
    odd, even = (sum(inside(i / n) for i in range(first, n, 2)) for first in (1, 2))
    return 3 * n / (inside(0) + inside(1) + 4 * odd + 2 * even)


def solved(matrix, right):
    """Gauss's elimination of a small, definite system."""
    rows = [[*row, value] for row, value in zip(matrix, right)]
    for i in range(len(rows)):
        rows[i] = [x / rows[i][i] for x in rows[i]]
        for k in range(len(rows)):
            if k != i:
                rows[k] = [a - rows[k][i] * b for a, b in zip(rows[k], rows[i])]
    return [row[-1] for row in rows]


def main():
    points = []
    for i in range(1, PLACES):
        c = i / PLACES
        points.append(((1.5 - gamma(c)) / (1.5 - 4 / math.pi), c))
    basis = [([g * (1 - g) * g**k for k in range(3)], c - g) for g, c in points]
    matrix = [[sum(b[i] * b[j] for b, _ in basis) for j in range(3)] for i in range(3)]
    found = solved(matrix, [sum(b[i] * rest for b, rest in basis) for i in range(3)])
    off = max(abs(sum(r * x for r, x in zip(found, b)) - rest) for b, rest in basis)
    print(", ".join(f"{r:.8f}" for r in found), f"off by {off:.1e} at most")


if __name__ == "__main__":
    main()
