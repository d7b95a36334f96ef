"""Stick radius over contact radius of an elastic sphere pressed onto a rigid plane with friction.

The problem of Spence (1968, 1975), solved independently of Asperity: an elastic half-space, axisymmetric
tractions p (pressure) and q (radial, outwards), rings of linear tractions, Coulomb friction. Lengths in a, the
sphere of radius 1 (1/R = 1), and stresses such that 2 (1 - nu^2)/E = 1. Then only beta, Dundurs' constant of the
body against a rigid one, is left of the elasticity, and

    u_z(r) = int_0^a p s L0(r, s) ds - beta int_r^a q ds
    u_r(r) = int_0^a q s L1(r, s) ds - (beta/r) int_0^r p s ds
    L0 = int_0^inf J0(kr) J0(ks) dk = (2/pi) K(m)/max,   L1 = int_0^inf J1(kr) J1(ks) dk = (2/pi) (K(m) - E(m))/min

with m = (min/max)^2 of r and s. The press is self-similar: u_r(r, a) = a^2 U(r/a). A stuck point keeps the u_r that
it has, from one contact radius to the next: U(x1)/x1^2 = U(x2)/x2^2 of two neighbours of which the inner one sticks.
A slipping point has q = mu p. For every stick radius on a node, the mu is sought at which the traction there has
just come off Coulomb's bound. Run it with numpy:

    python3 benches/pairs/spence.py            the checks against known limits, then the table
    python3 benches/pairs/spence.py 0.3 0.2    c/a of one nu and mu
"""

import sys

import numpy as np


def elliptic(m):
    """K(m) and K(m) - E(m) of the parameter m = k^2 < 1, by the arithmetic-geometric mean."""
    a, b = np.ones_like(m), np.sqrt(1.0 - m)
    c, power, total = np.sqrt(m), 0.5, 0.5 * m
    for _ in range(12):
        a, b, c = 0.5 * (a + b), np.sqrt(a * b), 0.5 * (a - b)
        power *= 2.0
        total = total + power * c * c
    k = np.pi / (2.0 * a)
    return k, k * total


def kernels(r, s):
    """L0 and L1."""
    low, high = np.minimum(r, s), np.maximum(r, s)
    k, difference = elliptic(np.minimum((low / high) ** 2, 1.0 - 1e-15))
    return 2.0 / np.pi * k / high, 2.0 / np.pi * difference / np.maximum(low, 1e-300)


def toward(x, w):
    """Gauss's points on [0, 1], drawn to 0, where a logarithm is."""
    return x**4, 4.0 * x**3 * w


class HalfSpace:
    """Displacements at nodes x on [0, 1] by tractions that are linear between them."""

    def __init__(self, x):
        n = len(x)
        self.x = x
        gauss, weight = np.polynomial.legendre.leggauss(10)
        gauss, weight = 0.5 * (gauss + 1.0), 0.5 * weight
        near, near_weight = toward(gauss, weight)
        self.normal, self.radial = np.zeros((n, n)), np.zeros((n, n))
        for e in range(n - 1):
            length = x[e + 1] - x[e]
            for i in range(n):
                # The point's own elements have its logarithm at one end.
                t, w = (gauss, weight) if i not in (e, e + 1) else (near, near_weight)
                t = 1.0 - t if i == e + 1 else t
                s = x[e] + length * t
                if x[i] == 0.0:
                    zero, one = 1.0 / s, np.zeros_like(s)
                else:
                    zero, one = kernels(x[i], s)
                for node, shape in ((e, 1.0 - t), (e + 1, t)):
                    self.normal[i, node] += np.sum(w * length * shape * s * zero)
                    self.radial[i, node] += np.sum(w * length * shape * s * one)
        # int_0^r p s ds and int_r^1 q ds, exact for linear tractions.
        inside, outside = np.zeros((n, n)), np.zeros((n, n))
        for e in range(n - 1):
            left, length = x[e], x[e + 1] - x[e]
            inside[e + 1 :, e] += length * (left / 2.0 + length / 6.0)
            inside[e + 1 :, e + 1] += length * (left / 2.0 + length / 3.0)
            outside[: e + 1, e] += length / 2.0
            outside[: e + 1, e + 1] += length / 2.0
        self.inside, self.outside = inside, outside
        self.force = 2.0 * np.pi * inside[-1]


def press(body, beta, mu, stuck, coupled=True):
    """p, q and the approach with the nodes 1 to `stuck` stuck and the others slipping.

    Not `coupled`, the pressure does not feel the shear."""
    x, n = body.x, len(body.x)
    # Unknown: p of all nodes but the last, where it is 0; q of all; the approach.
    rows, right = np.zeros((2 * n, 2 * n)), np.zeros(2 * n)
    p, q, approach = slice(0, n - 1), slice(n - 1, 2 * n - 1), 2 * n - 1
    rows[:n, p] = body.normal[:, : n - 1]
    rows[:n, q] = -beta * body.outside if coupled else 0.0
    rows[:n, approach] = -1.0
    right[:n] = -0.5 * x**2
    # u_r/x^2 but at the centre.
    scale = np.concatenate(([0.0], x[1:] ** -2.0))
    by_q = scale[:, None] * body.radial
    by_p = -beta * np.concatenate(([0.0], x[1:] ** -3.0))[:, None] * body.inside[:, : n - 1]
    for i in range(n):
        row = n + i
        if i == 0 or i == n - 1:
            rows[row, n - 1 + i] = 1.0
        elif i <= stuck:
            rows[row, q], rows[row, p] = by_q[i] - by_q[i + 1], by_p[i] - by_p[i + 1]
        else:
            rows[row, n - 1 + i], rows[row, i] = 1.0, -mu
    solution = np.linalg.solve(rows, right)
    return np.append(solution[p], 0.0), solution[q], solution[approach]


def mesh(n):
    """Nodes that come closer towards the edge."""
    return np.sin(0.5 * np.pi * np.linspace(0.0, 1.0, n + 1))


def friction_of(body, beta, stuck, coupled=True):
    """The mu at which the outermost stuck node has come to q = mu p."""

    def excess(mu):
        p, q, _ = press(body, beta, mu, stuck, coupled)
        return q[stuck] / p[stuck] - mu

    low, high = 1e-4, 5.0
    for _ in range(50):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if excess(middle) > 0.0 else (low, middle)
    return 0.5 * (low + high)


def beta_of(nu):
    return (1.0 - 2.0 * nu) / (2.0 * (1.0 - nu))


def ratio(body, beta, mu, coupled=True):
    """c/a, and F_N over the frictionless one at the same h.

    The stick radius ends halfway between the last stuck node and the first that slips."""
    half = 0.5 * (body.x[1:] + body.x[:-1])
    low, high = 1, len(body.x) - 2
    of = {}

    def friction(stuck):
        of[stuck] = of.get(stuck) or friction_of(body, beta, stuck, coupled)
        return of[stuck]

    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if friction(middle) < mu else (low, middle)
    share = (mu - friction(low)) / (friction(high) - friction(low))
    p, _, approach = press(body, beta, mu, low, coupled)
    # Hertz: F_N = 8/3 h^(3/2).
    return np.array([half[low] + share * (half[high] - half[low]), 0.375 * body.force @ p / approach**1.5])


def extrapolated(bodies, nu, mu, coupled=True):
    """What `ratio` has of both meshes, and the limit: growth by an element a step is of first order."""
    coarse, fine = (ratio(body, beta_of(nu), mu, coupled) for body in bodies)
    return coarse, fine, 2.0 * fine - coarse


def uncoupled(nu, mu):
    """c/a by the closed form for pressures that do not feel the shear,

    (a/2c) ln((a+c)/(a-c)) = (mu/beta) K(sqrt(1 - c^2/a^2))."""
    low, high = 1e-9, 1.0 - 1e-12
    for _ in range(200):
        c = 0.5 * (low + high)
        complete, _unused = elliptic(np.array(1.0 - c * c))
        stuck = np.log((1.0 + c) / (1.0 - c)) / (2.0 * c) < mu / beta_of(nu) * complete
        low, high = (c, high) if stuck else (low, c)
    return 0.5 * (low + high)


def checks(bodies):
    body = bodies[-1]
    p, _, approach = press(body, 0.0, 0.1, 0)
    print("without coupling (nu = 0.5, beta = 0): p_0, F_N and the approach over Hertz's")
    print(f"    {p[0] * np.pi / 4.0:.5f} {body.force @ p * 3.0 / 8.0:.5f} {approach:.5f}")
    print("full adhesion: dF_N/dh over the frictionless one, and (1 - nu) ln(3 - 4 nu)/(1 - 2 nu) (Johnson 5.4)")
    for nu in (0.0, 0.3):
        p, _, approach = press(body, beta_of(nu), 1.0, len(body.x) - 2)
        # F_N ~ a^3 and h ~ a^2; 2 E* a = 4.
        stiffness = 1.5 * body.force @ p / approach / 4.0
        print(f"    nu = {nu}: {stiffness:.5f} {(1.0 - nu) * np.log(3.0 - 4.0 * nu) / (1.0 - 2.0 * nu):.5f}")
    print("pressures that do not feel the shear: c/a of two meshes, their limit, and the closed form")
    for nu, mu in CASES:
        coarse, fine, limit = (of[0] for of in extrapolated(bodies, nu, mu, coupled=False))
        print(f"    nu = {nu}, mu = {mu}: {coarse:.4f} {fine:.4f} {limit:.4f} {uncoupled(nu, mu):.4f}")


CASES = [(0.0, 0.2), (0.0, 0.3), (0.0, 0.5), (0.3, 0.1), (0.3, 0.2)]

if __name__ == "__main__":
    asked = [float(number) for number in sys.argv[1:3]]
    bodies = [HalfSpace(mesh(n)) for n in (100, 200)]
    if not asked:
        checks(bodies)
    print("c/a of two meshes and their limit; the same of F_N over the frictionless one at the same h")
    for nu, mu in [tuple(asked)] if asked else CASES:
        (c0, f0), (c1, f1), (c, f) = extrapolated(bodies, nu, mu)
        print(f"    nu = {nu}, mu = {mu}: {c0:.4f} {c1:.4f} {c:.4f}; {f0:.5f} {f1:.5f} {f:.5f}")
