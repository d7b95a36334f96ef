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

# Forms of the law (see asperity_law.h) and their constants.
VARIABLE = @VARIABLE@
SLIP_FORM = @SLIP_FORM@
NORMAL_CURVE = @NORMAL_CURVE@
NORMAL_FORM = @NORMAL_FORM@
@CONSTANTS@
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


@CONTACT_TYPES@# ---- set-up: the material, the normal model, the law ----


def _bisect(low, high, increasing):
    """Root of an increasing function, down to neighbouring numbers."""
    for _ in range(200):
        middle = 0.5 * (low + high)
        if middle <= low or middle >= high:
            break
        if increasing(middle) < 0.0:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


def flow_stress(m, plastic):
    """Flow stress at the plastic strain `plastic`."""
    c = m.hardening_numbers
    if m.hardening == IDEAL:
        return c[0]
    if m.hardening == LINEAR:
        return c[0] + c[1] * plastic
    if m.hardening == POWER:
        return c[0] + c[1] * plastic ** c[2]
    if m.hardening == HOLLOMON:
        low = m.youngs_modulus * (c[0] / m.youngs_modulus) ** (c[1] / (c[1] - 1.0))
        if plastic <= 0.0:
            return low
        high = low + plastic * m.youngs_modulus / (c[1] - 1.0)
        return _bisect(low, high, lambda stress: (stress / c[0]) ** c[1] - stress / m.youngs_modulus - plastic)
    if m.hardening == VOCE:
        return c[0] - (c[1] - c[0]) * math.expm1(-(c[2] * plastic))
    if m.hardening == TABLE:
        for (alpha_0, stress_0), (alpha_1, stress_1) in zip(m.points, m.points[1:]):
            if plastic < alpha_1:
                return stress_0 + (stress_1 - stress_0) / (alpha_1 - alpha_0) * (plastic - alpha_0)
        return m.points[-1][1]
    return math.inf


def plastic_share(m, strain):
    """Plastic part of a total strain."""
    if strain * m.youngs_modulus <= flow_stress(m, 0.0):
        return 0.0
    if m.hardening == HOLLOMON:
        return strain - m.hardening_numbers[0] * strain ** (1.0 / m.hardening_numbers[1]) / m.youngs_modulus
    return _bisect(0.0, strain, lambda plastic: plastic + flow_stress(m, plastic) / m.youngs_modulus - strain)


def representative_stress(m, radius, a):
    """sigma_rep: the flow stress at the total strain 0.2 a/R (Tabor 1951)."""
    if m.hardening == ELASTIC:
        return math.inf
    return flow_stress(m, plastic_share(m, 0.2 * a / radius))


def effective_modulus(m):
    """E* = E/(1 - nu^2)."""
    return m.youngs_modulus / (1.0 - m.poissons_ratio * m.poissons_ratio)


def johnson_lambda(m, radius, a):
    """Lambda = E* a/(sigma_rep R) (Johnson 1970)."""
    return effective_modulus(m) * a / (representative_stress(m, radius, a) * radius)


def hardening_exponent(m, radius, a):
    """Local hardening exponent, the 1/m of the closed forms."""
    if m.hardening == ELASTIC:
        return 0.0
    plastic = plastic_share(m, 0.2 * a / radius)
    secant = math.log(flow_stress(m, plastic) / flow_stress(m, 0.25 * plastic)) / math.log(4.0)
    return 0.0 if secant < 0.0 else 1.0 if secant > 1.0 else secant


def yield_lambda(nu):
    """Lambda at first yield, from Huber's stresses on the axis."""

    def rising_slope(zeta):
        fall = 1.0 / (1.0 + zeta * zeta)
        return -(-3.0 * zeta * fall * fall + (1.0 + nu) * (math.atan(1.0 / zeta) - zeta * fall))

    zeta = _bisect(0.2, 1.0, rising_slope)
    fall = 1.0 / (1.0 + zeta * zeta)
    return 0.5 * math.pi * (1.0 / abs(1.5 * fall - (1.0 + nu) * (1.0 - zeta * math.atan(1.0 / zeta))))


def c_squared(value, plastic):
    """c^2 at Lambda = `value` (Olsson & Larsson 2016); `plastic` is its end."""
    span = math.log(1527.0 / 4.005)
    x = math.log(value / 4.005) / span
    x = 0.0 if x < 0.0 else 1.0 if x > 1.0 else x
    slope = 0.191 * span
    growth = plastic - 0.5
    result = 0.5 + x * (slope + x * ((3.0 * growth - 2.0 * slope) - x * (2.0 * growth - slope)))
    return result if result < plastic else plastic


def published_radius(m, radius, h):
    """Olsson & Larsson's contact radius."""
    reach = 2.0 * radius * h

    def excess(a):
        plastic = 1.43 * math.exp(-0.97 * hardening_exponent(m, radius, a))
        return a * a - c_squared(johnson_lambda(m, radius, a), plastic) * reach

    return _bisect(math.sqrt(0.5 * reach), math.sqrt(1.43 * reach), excess)


def published_force(m, radius, a):
    """Olsson & Larsson's force."""
    stress = representative_stress(m, radius, a)
    value = johnson_lambda(m, radius, a)
    maximum = 2.8 if hardening_exponent(m, radius, a) > 0.2 else 3.0
    q = math.log(a / radius / 0.041)
    factor = 1.0
    if q > 0.0:
        factor = 1.0 - 0.0460789 * q**2.2139
        factor = factor if factor > 0.0 else 0.0
    hardness = 4.0 * value / (3.0 * math.pi)
    if value >= 2.0:
        below = math.log(160.0 / value)
        below = below if below > 0.0 else 0.0
        below = factor * (maximum - 0.0965 * below * below)
        hardness = hardness if hardness < below else below
    return hardness * math.pi * a * a * stress


def stick(nu, friction):
    """S tanh(mu/beta); it vanishes with beta at nu = 1/2."""
    beta = (1.0 - 2.0 * nu) / (2.0 * (1.0 - nu))
    if beta < 1e-9:
        return 0.0 * friction
    return ((1.0 - nu) * math.log(3.0 - 4.0 * nu) / (1.0 - 2.0 * nu) - 1.0) * math.tanh(friction / beta)


def stiffening(nu, friction, size):
    """ln of an elastic sphere's force over Hertz's; size is a_H/R."""
    return stick(nu, friction) * (BODY_0 + BODY_1 * size) + size * (BODY_2 + BODY_3 * size + BODY_4 * nu)


def normal(m, radius, friction, h):
    """a and F_N0 at the indentation h > 0; Hertz below first yield, but for F_N0 of form 3."""
    hertz = math.sqrt(radius * h)
    force = 4.0 / 3.0 * effective_modulus(m) * math.sqrt(radius) * h**1.5
    first = yield_lambda(m.poissons_ratio)
    elastic = stiffening(m.poissons_ratio, friction, hertz / radius) if NORMAL_FORM == 3 else 0.0
    if johnson_lambda(m, radius, hertz) <= first:
        return hertz, force * math.exp(elastic) if NORMAL_FORM == 3 else force
    if NORMAL_FORM >= 2:
        ratio = johnson_lambda(m, radius, hertz) / first
        ratio = ratio if ratio > 1.0 else 1.0
        ramp = 1.0 - 1.0 / ratio
        hardening = hardening_exponent(m, radius, hertz)
        growth = 1.43 * math.exp(-NORMAL_RADIUS_0 * hardening) - 0.5
        area = 0.5 + growth * (1.0 - math.exp(-((NORMAL_RADIUS_1 * math.log(ratio)) ** NORMAL_RADIUS_2)))
        a = hertz * math.sqrt(2.0 * area * math.exp(NORMAL_RADIUS_3 * ramp * hertz / radius))
        if NORMAL_FORM == 3:
            excess = johnson_lambda(m, radius, hertz) - first
            plastic = (NORMAL_FORCE_0 * excess**NORMAL_FORCE_1) ** NORMAL_FORCE_2
            size = (NORMAL_FORCE_5 - NORMAL_FORCE_3 * math.log(ratio)) * (hertz / radius)
            size = (1.0 - ramp) * elastic + ramp * (size - NORMAL_FORCE_4 * hardening)
            return a, force * (1.0 + plastic) ** (-1.0 / NORMAL_FORCE_2) * math.exp(size)
        plastic = (NORMAL_FORCE_0 * (ratio - 1.0) ** NORMAL_FORCE_1) ** NORMAL_FORCE_2
        size = (NORMAL_FORCE_3 - NORMAL_FORCE_4 * math.log(ratio)) * hertz / radius
        f_n = force * (1.0 + plastic) ** (-1.0 / NORMAL_FORCE_2) * math.exp(ramp * (size - NORMAL_FORCE_5 * hardening))
        return a, f_n
    a = published_radius(m, radius, h)
    f_n = published_force(m, radius, a)
    if NORMAL_FORM == 1:
        ratio = johnson_lambda(m, radius, a) / first
        ratio = ratio if ratio > 1.0 else 1.0
        ramp = 1.0 - 1.0 / ratio
        hardening = hardening_exponent(m, radius, a)
        a = a * math.exp(ramp * (NORMAL_RADIUS_0 + NORMAL_RADIUS_1 * math.log(ratio)))
        f_n *= math.exp(ramp * (NORMAL_FORCE_0 + NORMAL_FORCE_1 * a / radius + NORMAL_FORCE_2 * hardening + NORMAL_FORCE_3 * math.log(ratio)))
    return a, f_n


def product(p, q, friction, z):
    """mu^p z^q."""
    if z <= 0.0:
        return 0.0
    return (1.0 if VARIABLE == 1 else friction**p) * z**q


def row(m, radius, friction, h):
    """A row of the table: the law at the indentation h."""
    a, f_n = normal(m, radius, friction, h)
    # Without friction there is no displacement at full slip, and none is asked for.
    friction = friction if friction > 0.0 else 1e-6
    stress = representative_stress(m, radius, a)
    value = effective_modulus(m) * a / (stress * radius)
    first = yield_lambda(m.poissons_ratio)
    z = growth = 0.0
    if value > first:
        ratio = value / first
        ramp = 1.0 - 1.0 / (ratio * ratio)
        if VARIABLE == 0:
            z = math.log(ratio)
        elif VARIABLE == 1:
            z = math.log1p(friction * (value - first))
        elif VARIABLE == 2:
            z = ramp * math.log(4.0 * value / (3.0 * math.pi * (f_n / (math.pi * a * a * stress))))
        else:
            z = ramp * (2.0 * (a * a / (2.0 * radius * h)) - 1.0)
        z = z if z > 0.0 else 0.0
        growth = ramp * (2.0 * (a * a / (2.0 * radius * h)) - 1.0) / math.log(ratio)
        growth = growth if growth > 0.0 else 0.0
    power = EXPONENT_2 * math.exp(-EXPONENT_4 * friction)
    size = math.exp(EXPONENT_5 * friction * growth - EXPONENT_3 * (a / radius))
    n = 1.5 + EXPONENT_SPAN * math.tanh(EXPONENT_0 * product(EXPONENT_1, power, friction, z) * size / EXPONENT_SPAN)
    size = math.exp(FALL_4 * friction * growth - FALL_5 * (a / radius))
    share = 1.0 - math.tanh(FALL_0 * friction) * math.tanh(FALL_1 * product(FALL_2, FALL_3, friction, z) * size)
    body = 1.0 + SLIP_0 * (a / radius)
    if SLIP_FORM == 0:
        factor = body + SLIP_1 * product(SLIP_2, SLIP_3, friction, z)
    else:
        factor = n / 1.5 * share * (body + SLIP_1 * z**SLIP_3)
    steep = 1.0 + CURVE_0 + CURVE_1 * (n - 1.5)
    mindlin = 8.0 * (0.5 * m.youngs_modulus / (1.0 + m.poissons_ratio)) * a / (2.0 - m.poissons_ratio)
    fall = share * f_n / f_n
    return [
        math.log(f_n),
        math.log(a),
        fall if fall < 1.0 else 1.0,
        math.log(factor * (1.5 * friction * f_n / mindlin)),
        n,
        1.0,
        steep,
        math.log(mindlin / body),
    ]


@CONTACT_TABLE@def setup(m, radius, friction):
    """The parameters of a sphere of the material `m` with Coulomb friction `friction` >= 0; ValueError for a number out of its range."""
    if not (m.youngs_modulus > 0.0 and 0.0 <= m.poissons_ratio <= 0.5 and radius > 0.0 and 0.0 <= friction < math.inf):
        raise ValueError("give E > 0, 0 <= nu <= 0.5, R > 0 and a finite friction >= 0")
    if m.hardening not in range(TABLE + 1) or (m.hardening == TABLE and len(m.points) < 1):
        raise ValueError("give one of the hardening laws, a table with its points")
    first = 1e-6 * radius
    if m.hardening != ELASTIC:
        if not flow_stress(m, 0.0) > 0.0:
            raise ValueError("give a yield stress > 0")
        a = yield_lambda(m.poissons_ratio) * flow_stress(m, 0.0) * radius / effective_modulus(m)
        h = 0.98 * a * a / radius
        first = h if h < first else first
    p = Parameters()
    p.radius = radius
    p.effective_modulus = effective_modulus(m)
    p.friction = friction
    p.log_first = math.log(first)
    p.log_step = (math.log(@LAST@ * radius) - p.log_first) / (KNOTS - 1.0)
    p.table = [row(m, radius, friction, math.exp(p.log_first + p.log_step * i)) for i in range(KNOTS)]
    if not all(math.isfinite(value) for line in p.table for value in line):
        raise ValueError("the law has no positive numbers for this material")
    p.gentle = 1.0 + CURVE_2 * (friction if friction > 0.0 else 1e-6) ** CURVE_3
    conserve(p)
    return p


def out_of_range(m, radius, friction, h):
    """Which quantities lie outside of what the law was fitted to, at the indentation h > 0: a sum of 1 Lambda, 2 mu, 4 a/R, 8 c^2, 16 nu,
    32 hardening exponent at the representative strain."""
    a, _ = normal(m, radius, friction, h)
    value = johnson_lambda(m, radius, a)
    first = yield_lambda(m.poissons_ratio)
    outside = 0
    if a / radius > RADIUS_TO * 1.02:
        outside |= 4
    if value <= first:
        return outside
    if value < 0.98 * min(LAMBDA_FROM, first) or value > LAMBDA_TO * 1.02:
        outside |= 1
    if friction > FRICTION_TO * 1.02:
        outside |= 2
    if a / radius < 0.98 * RADIUS_FROM:
        outside |= 4
    area = a * a / (2.0 * radius * h)
    if area < 0.98 * min(AREA_FROM, 0.5) or area > AREA_TO * 1.02:
        outside |= 8
    if m.poissons_ratio < 0.98 * NU_FROM or m.poissons_ratio > NU_TO * 1.02:
        outside |= 16
    exponent = hardening_exponent(m, radius, a)
    if exponent < 0.98 * HARDENING_FROM or exponent > HARDENING_TO * 1.02:
        outside |= 32
    return outside


@TABLE@@CONTACT_UPDATE@# ---- check against the test vectors ----


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
