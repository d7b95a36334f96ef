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
ELASTIC = 0
IDEAL = 1  # yield stress
LINEAR = 2  # yield stress, modulus: sigma_Y + H alpha
POWER = 3  # yield stress, coefficient, exponent: sigma_Y + K alpha^n
HOLLOMON = 4  # coefficient, exponent: sigma_0 eps^(1/m), eps the total strain
VOCE = 5  # yield stress, saturation stress, rate
TABLE = 6  # none; pairs of plastic strain and stress in points


class Material:
    """A sphere's material."""

    __slots__ = ("youngs_modulus", "poissons_ratio", "hardening", "hardening_numbers", "points")

    def __init__(self, youngs_modulus, poissons_ratio, hardening, hardening_numbers=(0.0, 0.0, 0.0), points=()):
        self.youngs_modulus = youngs_modulus
        self.poissons_ratio = poissons_ratio
        self.hardening = hardening
        self.hardening_numbers = hardening_numbers
        self.points = points


class Parameters:
    """A pair of materials, shared by its contacts."""

    __slots__ = ("radius", "effective_modulus", "friction", "log_first", "log_step", "gentle", "table", "shapes")


class State:
    """The memory of a contact; as constructed, that before first contact."""

    __slots__ = ("h", "h_max", "approach", "x", "sheared", "deflection")
    _LAYOUT = struct.Struct("<%dd" % (5 + 2 * SLIDERS))

    def __init__(self, h=0.0, h_max=0.0, approach=0.0, x=0.0, sheared=0.0, deflection=None):
        self.h = h
        self.h_max = h_max
        self.approach = approach
        self.x = x
        self.sheared = sheared
        self.deflection = [[0.0, 0.0] for _ in range(SLIDERS)] if deflection is None else deflection

    def copy(self):
        """An independent copy."""
        return State(self.h, self.h_max, self.approach, self.x, self.sheared, [list(q) for q in self.deflection])

    def to_bytes(self):
        """The memory as bytes."""
        return self._LAYOUT.pack(self.h, self.h_max, self.approach, self.x, self.sheared, *(v for q in self.deflection for v in q))

    @classmethod
    def from_bytes(cls, data):
        """The memory from its bytes."""
        v = cls._LAYOUT.unpack(data)
        return cls(v[0], v[1], v[2], v[3], v[4], [[v[5 + 2 * i], v[6 + 2 * i]] for i in range(SLIDERS)])


class Response:
    """The answer of an increment."""

    __slots__ = ("f_n", "f_t", "df_t_ddelta", "df_n_dh", "df_n_ddelta", "a")

    def __init__(self):
        self.f_n = 0.0
        self.f_t = [0.0, 0.0]
        self.df_t_ddelta = [[0.0, 0.0], [0.0, 0.0]]
        self.df_n_dh = 0.0
        self.df_n_ddelta = [0.0, 0.0]
        self.a = 0.0


# ---- set-up: the material, the normal model, the law ----


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


def unloading_exponent(radius, modulus, a, f_n0):
    """3/2 for Hertz, 4/pi for a uniform pressure (Mesarovic & Johnson 2000), by how far the force has fallen below Hertz's at that radius."""
    hertz = 4.0 * modulus * a * a * a / (3.0 * radius)
    share = f_n0 / hertz if f_n0 < hertz else 1.0
    return 1.2732395447351628 + (1.5 - 1.2732395447351628) * share


def stored_at(p, i):
    """Elastic energy of the virgin contact at a knot."""
    f_n0 = math.exp(p.table[i][0])
    a = math.exp(p.table[i][1])
    gamma = unloading_exponent(p.radius, p.effective_modulus, p.table[i][5] * a, f_n0)
    return gamma / (gamma + 1.0) * f_n0 * f_n0 / (2.0 * p.effective_modulus * a)


def work_between(p, i):
    """Work of a press from the knot before to this one, F_N0 being a power of h on each of some pieces of the way."""
    work = 0.0
    log_f = p.table[i - 1][0]
    for k in range(1, @PIECES@ + 1):
        u = k / @PIECES@.0
        log_next = column_at(p, 0, i - 1 + u)[0]
        h0 = math.exp(p.log_first + p.log_step * (i - 1 + (u - 1.0 / @PIECES@.0)))
        h1 = math.exp(p.log_first + p.log_step * (i - 1 + u))
        power = (log_next - log_f) / (p.log_step / @PIECES@.0)
        work += (math.exp(log_next) * h1 - math.exp(log_f) * h0) / (power + 1.0)
        log_f = log_next
    return work


def stiffen(p, i, factor):
    """Makes the unloading of a knot stiffer by a factor."""
    p.table[i][1] += math.log(factor)
    p.table[i][5] /= factor


def keep_below(p, i, h):
    """Lets no more than the indentation h be recovered at a knot."""
    f_n0 = math.exp(p.table[i][0])
    a = math.exp(p.table[i][1])
    depth = unloading_exponent(p.radius, p.effective_modulus, p.table[i][5] * a, f_n0) * f_n0 / (2.0 * p.effective_modulus * a)
    if depth > h:
        stiffen(p, i, depth / h)


def conserve(p):
    """Stiffens the unloading where F_N0 and a would let a press store more energy than was put in, or the dent rise above where the sphere began; the contact radius
    stays."""
    keep_below(p, 0, math.exp(p.log_first))
    before = stored_at(p, 0)
    for i in range(1, KNOTS):
        # What the body adds stays as the contact yields.
        stiffen(p, i, 1.0 / p.table[i - 1][5])
        most = before + work_between(p, i)
        stored = stored_at(p, i)
        # A little is spared for what the cubics between the knots may gain.
        if stored > (1.0 + @ROUNDING@) * most:
            stiffen(p, i, stored / ((1.0 - @SPARE@) * most))
        keep_below(p, i, math.exp(p.log_first + p.log_step * i))
        before = stored_at(p, i)


def setup(m, radius, friction):
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


@TABLE@# ---- virgin curves ----


class Virgin:
    """First loading at one indentation."""

    __slots__ = (
        "f_n0", "a", "f_n_slip", "delta_t_slip", "k_t", "n", "m_exponent", "n_exponent", "slope", "gamma", "depth", "backbone", "weight", "lost", "shapes"
    )  # fmt: skip


def knot_slope(p, column, i):
    """Slope of a column at a knot, per step."""
    table = p.table
    if i == 0:
        return table[1][column] - table[0][column]
    below = table[i][column] - table[i - 1][column]
    if i == KNOTS - 1:
        return below
    above = table[i + 1][column] - table[i][column]
    if column == 0:
        return above if above > below else below
    if column == 1:
        return above if above < below else below
    return 0.5 * (above + below)


_POWERS = (1.5, 0.5, 0.0, 1.0, 0.0, 0.0, 0.0, 0.5)


def column_at(p, column, position):
    """A column of the table and its slope per step."""
    end = KNOTS - 1
    if position < 0.0:
        slope = _POWERS[column] * p.log_step
        return p.table[0][column] + slope * position, slope
    if position >= end:
        slope = knot_slope(p, column, end) if _POWERS[column] > 0.0 else 0.0
        return p.table[end][column] + slope * (position - end), slope
    i = int(position)
    u = position - i
    y0 = p.table[i][column]
    y1 = p.table[i + 1][column]
    s0 = knot_slope(p, column, i)
    s1 = knot_slope(p, column, i + 1)
    rise = y1 - y0
    quadratic = 3.0 * rise - 2.0 * s0 - s1
    cubic = s0 + s1 - 2.0 * rise
    return y0 + u * (s0 + u * (quadratic + u * cubic)), s0 + u * (2.0 * quadratic + 3.0 * u * cubic)


# (k/16)^0.65: shares of k_T of the annuli inside the end of cell k.
INSIDE = (
    0.0, 0.16493848884661177, 0.25881623096034434, 0.3368610723585669, 0.40612619817811774, 0.46951828924049643,
    0.5285916811459566, 0.5842997994985654, 0.6372803136596311, 0.6879860659818012, 0.7367531668195612, 0.7838397013217092,
    0.8294492546152544, 0.8737459792985665, 0.9168646621816685, 0.9589176881122033, 1.0,
)


def sliders(backbone):
    """Shares and points of loss of the sliders."""
    weight, lost = [], []
    power = 0.65 / (backbone - 1.0)
    below_moment = 0.0
    for i in range(SLIDERS):
        end = 1.0 if i == SLIDERS - 1 else (float(i + 1) / SLIDERS) ** power
        above_moment = INSIDE[i + 1] * end
        weight.append(INSIDE[i + 1] - INSIDE[i])
        lost.append((backbone - 1.0) / backbone * (above_moment - below_moment) / weight[i])
        below_moment = above_moment
    return weight, lost


def shapes_at(p, position):
    """f_T and f_N of a table at a place between the levels; straight between them."""
    if position <= 0.0:
        return p.shapes[0]
    level = position * (LEVELS - 1.0) / (KNOTS - 1.0)
    level = level if level < LEVELS - 1 else LEVELS - 1.0
    i = int(level) if int(level) < LEVELS - 2 else LEVELS - 2
    u = level - i
    return [[low + u * (high - low) for low, high in zip(p.shapes[i][kind], p.shapes[i + 1][kind])] for kind in range(2)]


def virgin(p, h, sheared=1.0):
    """First loading at the indentation h > 0, with the sliders of a contact that has yielded to shear at the place `sheared`."""
    v = Virgin()
    position = (math.log(h) - p.log_first) / p.log_step
    log_f, log_slope = column_at(p, 0, position)
    v.f_n0 = math.exp(log_f)
    v.a = math.exp(column_at(p, 1, position)[0])
    radii = column_at(p, 5, position)[0]
    v.gamma = unloading_exponent(p.radius, p.effective_modulus, v.a if NORMAL_CURVE == 2 else radii * v.a, v.f_n0)
    v.f_n_slip = column_at(p, 2, position)[0] * v.f_n0
    v.delta_t_slip = math.exp(column_at(p, 3, position)[0])
    v.n = column_at(p, 4, position)[0]
    steep = column_at(p, 6, position)[0]
    v.m_exponent, v.n_exponent = (steep, p.gentle) if NORMAL_CURVE == 0 else (p.gentle, steep)
    v.backbone = v.gamma if v.gamma < v.n else v.n
    if NORMAL_CURVE == 2:
        v.backbone = steep
        v.shapes = shapes_at(p, position)
    v.k_t = math.exp(column_at(p, 7, position)[0])
    start = v.n * p.friction * v.f_n_slip / v.delta_t_slip
    end = v.backbone * p.friction * v.f_n0 / v.delta_t_slip
    if v.k_t < start:
        v.k_t = start
    if v.k_t < end:
        v.k_t = end
    if v.backbone < UNSHEARED and not is_elastic(v):
        rest = 1.0 - sheared if sheared < 1.0 else 0.0
        rest = rest * rest
        rest = rest * rest
        v.backbone += (UNSHEARED - v.backbone) * (rest * rest)
    v.weight, v.lost = sliders(v.backbone)
    v.slope = v.f_n0 * log_slope / (p.log_step * h)
    v.depth = v.gamma * v.f_n0 / (2.0 * p.effective_modulus * v.a)
    v.a = radii * v.a
    return v


# ---- update ----

# Of simulated oblique presses, rebounds and reversals; asperity's model of the update says what they are.
PRESSED = 0.8
RECOVERED = 0.8
LEAST_NORMAL = 0.25
BETWEEN = 0.5
CARRIED = 0.3
RELAXATION = 0.1
REVERSED = 0.05
SLIDING = 0.98
GATHERED = 0.7
MOST = 2.0  # x after all of what reversed slip costs
UNSHEARED = 1.8
AT_BOUND = 1.0 + 1e-10
AT_CAP = 1.0 - 1e-9
AT_SLIP = 1.0 - 1e-13


def point_x(j):
    """x at point j of a shape that is given by numbers."""
    share = float(j) / POINTS
    return share * share


def given(shape, x):
    """A shape that is given by numbers and its derivative, straight from point to point."""
    if x >= 1.0:
        return shape[POINTS - 1], 0.0
    j = int(POINTS * math.sqrt(x))
    j = j if j < POINTS - 1 else POINTS - 1
    below = 0.0 if j == 0 else shape[j - 1]
    slope = (shape[j] - below) / (point_x(j + 1) - point_x(j))
    return below + slope * (x - point_x(j)), slope


def given_inverse(shape, f):
    """The least x at which it has the value f, or that of its peak; and the point before it."""
    if f <= 0.0:
        return 0.0, 0
    peak, place = 0.0, (0.0, 0)
    for j in range(POINTS):
        if shape[j] >= f:
            return given_between(shape, f, j), j
        if shape[j] > peak:
            peak, place = shape[j], (point_x(j + 1), j)
    return place


def given_between(shape, f, j):
    """The x between point j and the next at which it has the value f."""
    below = 0.0 if j == 0 else shape[j - 1]
    return point_x(j) + (f - below) / (shape[j] - below) * (point_x(j + 1) - point_x(j))


def given_back(shape, f, j):
    """As given_inverse of a lesser f, back along the curve from after point j."""
    if f <= 0.0:
        return 0.0
    while j > 0 and shape[j - 1] >= f:
        j -= 1
    return given_between(shape, f, j)


def tangential_shape(v, x):
    """f_T(x) and its derivative."""
    if NORMAL_CURVE == 2:
        return given(v.shapes[0], x)
    rest = 1.0 - x
    if rest <= 0.0:
        return 1.0, 0.0
    power = rest ** (v.n - 1.0)
    return 1.0 - power * rest, v.n * power


def tangential_slope(v, x, j):
    """The derivative of f_T at x, which is after point j."""
    if NORMAL_CURVE == 2:
        shape = v.shapes[0]
        return (shape[j] - (0.0 if j == 0 else shape[j - 1])) / (point_x(j + 1) - point_x(j))
    return tangential_shape(v, x)[1]


def tangential_shape_inverse(v, f):
    """The x at which f_T has the value f, and the point before it of a shape by numbers."""
    if NORMAL_CURVE == 2:
        return given_inverse(v.shapes[0], f)
    return (1.0 if f >= 1.0 else 1.0 - (1.0 - f) ** (1.0 / v.n)), 0


def tangential_shape_back(v, f, j):
    """As tangential_shape_inverse of a lesser f, back along the curve from after point j."""
    if NORMAL_CURVE == 2:
        return given_back(v.shapes[0], f, j)
    return tangential_shape_inverse(v, f)[0]


def normal_shape(v, x):
    """f_N(x) and its derivative, 0 at both ends."""
    if x <= 0.0:
        return 0.0, 0.0
    if x >= 1.0:
        return 1.0, 0.0
    if NORMAL_CURVE == 2:
        return given(v.shapes[1], x)
    m, n = v.m_exponent, v.n_exponent
    if NORMAL_CURVE == 0:
        rest = (1.0 - x) ** m
        risen = 1.0 - rest
        power = risen ** (n - 1.0)
        return power * risen, n * power * m * rest / (1.0 - x)
    risen = x**m
    rest = 1.0 - risen
    power = rest ** (n - 1.0)
    return 1.0 - power * rest, n * power * m * risen / x


def normal_shape_inverse(v, f):
    """The x at which f_N has the value f."""
    if f <= 0.0:
        return 0.0
    if f >= 1.0:
        return 1.0
    if NORMAL_CURVE == 2:
        return given_inverse(v.shapes[1], f)[0]
    if NORMAL_CURVE == 0:
        return 1.0 - (1.0 - f ** (1.0 / v.n_exponent)) ** (1.0 / v.m_exponent)
    return (1.0 - (1.0 - f) ** (1.0 / v.n_exponent)) ** (1.0 / v.m_exponent)


def normal_cap(v, x):
    """F_N on the virgin curve at x."""
    return v.f_n0 - (v.f_n0 - v.f_n_slip) * normal_shape(v, x)[0]


def is_elastic(v):
    """Whether shear costs no normal force."""
    return v.f_n_slip >= (1.0 - 1e-6) * v.f_n0


def yield_coefficient(p, v):
    """c of F_N0/F_N = 1 + b r + c r^2, r = F_T/F_N, which the virgin curve follows."""
    if not p.friction > 0.0:
        return 0.0
    loss = v.f_n0 - v.f_n_slip
    at_slip = loss / (v.f_n_slip * p.friction)
    x, _ = tangential_shape_inverse(v, 0.4)
    lost = loss * normal_shape(v, x)[0]
    f_n = v.f_n0 - lost
    r = 0.4 * p.friction * v.f_n_slip / f_n
    before = lost / (f_n * r)
    return max((at_slip - before) / (p.friction - r), 0.5 * at_slip / p.friction)


def pressed_cap(v, c, f_t):
    """Greatest F_N of a contact that is pressed with the tangential force f_t, and the square of its root."""
    share = PRESSED * (1.0 - RECOVERED * (v.slope * v.depth / (v.gamma * v.f_n0)))
    force = f_t / v.f_n0
    q = 1.0 - 4.0 * share * c * (force * force)
    return (0.5 * v.f_n0 * (1.0 + math.sqrt(q)), q) if q > 0.0 else (0.5 * v.f_n0, 0.0)


def mobilisation(v, f_n):
    """The x of the virgin curve that has the normal force f_n."""
    if f_n >= AT_CAP * v.f_n0:
        return 0.0
    if AT_SLIP * f_n <= v.f_n_slip:
        return min(MOST, 1.0 + max(0.0, 1.0 - f_n / v.f_n_slip) / REVERSED)
    return normal_shape_inverse(v, (v.f_n0 - f_n) / (v.f_n0 - v.f_n_slip))


def force_at(v, e):
    """F_N at the elastic approach e."""
    return 0.0 if e <= 0.0 else v.f_n0 * (e / v.depth) ** v.gamma


def approach_at(v, f_n):
    """Its inverse."""
    return v.depth if f_n >= v.f_n0 else v.depth * (f_n / v.f_n0) ** (1.0 / v.gamma)


def slider_limits(p, v, f_n):
    """Greatest deflection of each slider under the normal force f_n: their forces then add up to mu F_N."""
    limit = [0.0] * SLIDERS
    if f_n <= 0.0:
        return limit
    eta = (f_n / v.f_n0) ** (1.0 / v.backbone)
    total = 0.0
    for i in range(SLIDERS):
        limit[i] = eta - v.lost[i] if eta > v.lost[i] else 0.0
        if i == 0 and limit[i] < 0.1 * eta:
            limit[i] = 0.1 * eta  # the innermost carries what little force there is
        total += v.weight[i] * limit[i]
    scale = p.friction * f_n / (v.k_t * total)
    return [scale * value for value in limit]


def bounded(increment):
    """An increment in the same direction, of at most 1e150: far beyond full slip, and its square is still finite."""
    size = max(abs(increment[0]), abs(increment[1]))
    return (increment[0] / size * 1e150, increment[1] / size * 1e150) if size > 1e150 else increment


def slide(deflection, limit, increment):
    """Moves the sliders and holds each to its limit."""
    moved = []
    for q, most in zip(deflection, limit):
        q0 = q[0] + increment[0]
        q1 = q[1] + increment[1]
        size = math.sqrt(q0 * q0 + q1 * q1)
        keep = most / size if size > most else 1.0
        moved.append([keep * q0, keep * q1])
    return moved


def slider_force(v, deflection):
    """Tangential force of the sliders."""
    total = [0.0, 0.0]
    for w, q in zip(v.weight, deflection):
        total[0] += w * q[0]
        total[1] += w * q[1]
    return [v.k_t * total[0], v.k_t * total[1]]


def slider_stiffness(v, before, limit, increment):
    """Stiffness of the sliders after the increment: a slider at its limit only turns."""
    s0 = s1 = s2 = 0.0
    for i in range(SLIDERS):
        q0 = before[i][0] + increment[0]
        q1 = before[i][1] + increment[1]
        size = math.sqrt(q0 * q0 + q1 * q1)
        k = v.k_t * v.weight[i]
        if size > (1.0 + 1e-10) * limit[i]:
            k = k * limit[i] / size
            m0 = q0 / size
            m1 = q1 / size
            s0 += k * m1 * m1
            s1 -= k * m0 * m1
            s2 += k * m0 * m0
        else:
            s0 += k
            s2 += k
    return [[s0, s1], [s1, s2]]


def scale(deflection, keep):
    """Multiplies all deflections."""
    return [[keep * q[0], keep * q[1]] for q in deflection]


def taken(flow):
    """Share of a displacement that the sliders take where their force meanwhile flows by `flow` e-folds."""
    if flow < 0.05:
        return 1.0 - flow * (0.5 - flow * (1.0 / 6.0 - flow * (1.0 / 24.0 - flow / 120.0)))
    return (1.0 - math.exp(-flow)) / flow


def press(p, s, v, h):
    """Moves h with delta_T held: F_N, x, dF_N/dh, by how many e-folds F_T has flowed, and the stiffness by which it may rise beyond the virgin curve."""
    dh = h - s.h
    grown = h > s.h_max
    first = grown and (s.x == 0.0 or not s.h_max > 0.0)
    trial = v.f_n0
    stiffness = v.slope
    elastic_stiffness = v.gamma * v.f_n0 / v.depth
    e = s.approach + dh
    if grown and s.h_max > 0.0:
        old = virgin(p, s.h_max)
        keep = old.k_t / v.k_t
        if keep < 1.0:
            s.deflection = [[keep * q[0], keep * q[1]] for q in s.deflection]
        if not first:
            trial = force_at(old, e)
            stiffness = elastic_stiffness = old.gamma * trial / e if e > 0.0 else 0.0
    elif not grown:
        trial = force_at(v, e)
        stiffness = elastic_stiffness = v.gamma * trial / e if e > 0.0 else 0.0
    f_n = trial if trial < v.f_n0 else v.f_n0
    if dh == 0.0:
        return f_n, s.x, v.slope if s.x == 0.0 and s.h == s.h_max else stiffness, 0.0, 0.0
    elastic = mobilisation(v, f_n)
    if dh < 0.0:
        return f_n, elastic if elastic > s.x else s.x, stiffness, 0.0, 0.0
    if trial >= v.f_n0 and grown:
        stiffness = v.slope
    s.deflection = slide(s.deflection, slider_limits(p, v, f_n), (0.0, 0.0))
    force = slider_force(v, s.deflection)
    f_t = math.sqrt(force[0] * force[0] + force[1] * force[1])
    if is_elastic(v):
        return f_n, elastic, stiffness, 0.0, 0.0
    slip_force = p.friction * v.f_n_slip
    place, before = tangential_shape_inverse(v, f_t / slip_force)
    cap = normal_cap(v, place)
    if trial <= cap or f_t == 0.0:
        if f_n >= AT_CAP * v.f_n0:
            s.sheared = 0.0
        return f_n, elastic, stiffness, 0.0, 0.0
    c = yield_coefficient(p, v)
    highest = pressed_cap(v, c, f_t)[0]
    r = f_t / f_n
    normal = max(1.0 - c * (r * r), LEAST_NORMAL)
    tangential = 2.0 * c * r
    sticking = (1.0 - r / p.friction) ** ((v.backbone - 1.0) / v.backbone) if r < p.friction else 0.0
    k_t = v.k_t * sticking
    normal_part = normal * normal * elastic_stiffness
    yielding = normal_part * k_t / (normal_part + tangential * tangential * k_t)
    rises = slip_force * tangential_slope(v, place, before) / v.delta_t_slip
    rises = min(max(rises, 0.0), v.k_t)
    part = min((trial - cap) / (highest - cap), 1.0) if highest > cap else 1.0
    softer = 1.0 - v.slope * f_n / (v.f_n0 * elastic_stiffness) if grown else 1.0
    plastic = min(softer * dh if softer > 0.0 else 0.0, (trial - cap) / elastic_stiffness)
    flow = 2.0 * c / normal * (rises + BETWEEN * (yielding - rises)) * part * plastic / f_n
    keep = math.exp(-flow)
    left = keep * f_t / slip_force
    x = tangential_shape_back(v, left, before) if left < tangential_shape(v, place)[0] else place
    pressed, q = pressed_cap(v, c, keep * f_t)
    on_curve = normal_cap(v, x)
    raised = pressed if pressed > on_curve else on_curve
    rate = flow / dh
    if pressed > on_curve:
        root = math.sqrt(q)
        turns = 0.5 * (1.0 - q) / root if root > 0.0 else 0.0
        slope = v.slope * (0.5 * (1.0 + root) + turns) + v.f_n0 * turns * rate
    else:
        steep = slip_force * tangential_shape(v, x)[1]
        falls = (v.f_n0 - v.f_n_slip) * normal_shape(v, x)[1]
        gain = falls * keep * f_t / (v.f_n0 * steep) if steep > 0.0 else 0.0
        slope = v.slope * (raised / v.f_n0 + gain) + v.f_n0 * gain * rate
    slope = slope if raised < f_n and slope < stiffness else stiffness
    f_n = raised if raised < f_n else f_n
    s.deflection = scale(s.deflection, keep)
    s.sheared = x
    return f_n, x, slope, flow, CARRIED * part * (yielding - rises) if yielding > rises else 0.0


def reverse(p, s, out, v, before, force_before, increment):
    """The sliders slip and stick at the F_N of full slip, or the contact was released: it loses what a reversal of the slip costs besides."""
    size = math.sqrt(increment[0] * increment[0] + increment[1] * increment[1])
    held = math.sqrt(force_before[0] * force_before[0] + force_before[1] * force_before[1])
    if s.x >= MOST or not size > 0.0 or held > SLIDING * (p.friction * out.f_n):
        return
    rise = [out.f_t[0] - force_before[0], out.f_t[1] - force_before[1]]
    risen = math.sqrt(rise[0] * rise[0] + rise[1] * rise[1])
    stick = risen / (v.k_t * size)
    if not 0.0 < stick < 1.0:
        return
    rate = 4.0 * GATHERED * (MOST - s.x) * (v.k_t / (p.friction * v.f_n_slip))
    s.x = min(s.x + rate * (stick * (1.0 - stick)) * size, MOST)
    cap = v.f_n_slip * (1.0 - REVERSED * (s.x - 1.0))
    if not cap < out.f_n:
        return
    out.f_n = cap
    s.approach = approach_at(v, cap)
    limit = slider_limits(p, v, cap)
    s.deflection = slide(before, limit, increment)
    out.f_t = slider_force(v, s.deflection)
    loss = REVERSED * v.f_n_slip * rate if s.x < MOST else 0.0
    for j in range(2):
        stiffer = (rise[0] * out.df_t_ddelta[0][j] + rise[1] * out.df_t_ddelta[1][j]) / (risen * v.k_t)
        out.df_n_ddelta[j] = -loss * ((1.0 - 2.0 * stick) * stiffer + stick * stick * increment[j] / size)
    out.df_t_ddelta = slider_stiffness(v, before, limit, increment)
    for j in range(2):
        falls = (1.0 - stick) * out.df_n_ddelta[j] / cap
        for i in range(2):
            out.df_t_ddelta[i][j] += falls * out.f_t[i]


def shear(p, s, out, v, f_n, carried, increment):
    """Moves delta_T with h held."""
    before = s.deflection
    force_before = slider_force(v, before)
    limit = slider_limits(p, v, f_n)
    s.deflection = slide(before, limit, increment)
    out.f_n = f_n
    out.f_t = slider_force(v, s.deflection)
    out.df_t_ddelta = slider_stiffness(v, before, limit, increment)
    if is_elastic(v):
        return
    if s.x >= 1.0 and carried == 0.0:
        reverse(p, s, out, v, before, force_before, increment)
        return
    slip_force = p.friction * v.f_n_slip
    at = s.x if s.x < 1.0 else 1.0
    bound = slip_force * tangential_shape(v, at)[0]
    trial = math.sqrt(out.f_t[0] * out.f_t[0] + out.f_t[1] * out.f_t[1])
    if trial <= AT_BOUND * bound:
        return
    held_before = math.sqrt(force_before[0] * force_before[0] + force_before[1] * force_before[1])
    if held_before > AT_BOUND * bound:
        at = max(at, tangential_shape_inverse(v, held_before / slip_force)[0])
        bound = slip_force * tangential_shape(v, at)[0]
    beyond_peak = held_before > AT_BOUND * bound
    if beyond_peak:
        bound = held_before
    if trial <= AT_BOUND * bound:
        return
    direction = [out.f_t[0] / trial, out.f_t[1] / trial]
    along = direction[0] * force_before[0] + direction[1] * force_before[1]
    excess = trial - bound
    travel = trial - along
    beyond = excess / travel if excess < travel else 1.0
    forward = direction[0] * increment[0] + direction[1] * increment[1]
    forward = forward if forward > 0.0 else 0.0
    dx = beyond * forward / v.delta_t_slip
    x = at + dx if at + dx < 1.0 else 1.0
    cap = normal_cap(v, x)
    before_cap = normal_cap(v, at)
    above = (f_n - before_cap) * math.exp(-dx / RELAXATION) if AT_CAP * f_n > before_cap else 0.0
    lowered = cap + above
    out.f_n = lowered if lowered < f_n else f_n
    s.x = 1.0 if AT_SLIP * out.f_n <= v.f_n_slip else x
    s.sheared = x
    s.approach = approach_at(v, out.f_n)
    limit = slider_limits(p, v, out.f_n)
    s.deflection = slide(before, limit, increment)
    held = slider_force(v, s.deflection)
    stiffness = slider_stiffness(v, before, limit, increment)
    shape, shape_slope = tangential_shape(v, x)
    rate = slip_force * shape_slope / v.delta_t_slip
    bound = slip_force * shape
    if beyond_peak and held_before > bound:
        bound = held_before
        rate = 0.0
    bound += carried * (beyond * forward)
    rate = (rate + carried) * beyond
    size = math.sqrt(held[0] * held[0] + held[1] * held[1])
    per_x = beyond / v.delta_t_slip
    loss = (v.f_n0 - v.f_n_slip) * normal_shape(v, x)[1] + above / RELAXATION
    out.f_t = held
    out.df_n_ddelta = [-loss * per_x * direction[0], -loss * per_x * direction[1]]
    out.df_t_ddelta = stiffness
    if size <= bound:
        return
    keep = bound / size
    s.deflection = scale(s.deflection, keep)
    m = [held[0] / size, held[1] / size]
    out.f_t = [bound * m[0], bound * m[1]]
    out.df_t_ddelta = [[0.0, 0.0], [0.0, 0.0]]
    for j in range(2):
        radial = m[0] * stiffness[0][j] + m[1] * stiffness[1][j]
        for i in range(2):
            out.df_t_ddelta[i][j] = rate * m[i] * direction[j] + keep * (stiffness[i][j] - m[i] * radial)


def rotate(state, cosine, sine):
    """The state in axes that are turned by an angle: new components of a vector v are (c v0 + s v1, -s v0 + c v1)."""
    turned = state.copy()
    turned.deflection = [[cosine * q[0] + sine * q[1], -sine * q[0] + cosine * q[1]] for q in state.deflection]
    return turned


def update(p, state, h, increment):
    """Moves a contact to the indentation h and along the plane by `increment`, the press first. Returns the new state and the response.

    Where h or the increment is not finite, nothing in the response is a number and the state stays as it was."""
    s = state.copy()
    out = Response()
    if not (math.isfinite(h) and math.isfinite(increment[0]) and math.isfinite(increment[1])):
        nan = math.nan
        out.f_n, out.f_t, out.df_n_dh, out.df_n_ddelta, out.a = nan, [nan, nan], nan, [nan, nan], nan
        out.df_t_ddelta = [[nan, nan], [nan, nan]]
        return s, out
    increment = bounded(increment)
    greatest = h if h > state.h_max else state.h_max
    if not greatest > 0.0:
        s.h = h
        return s, out
    v = virgin(p, greatest, state.sheared)
    f_n, x, df_n_dh, flow, carried = press(p, s, v, h)
    if h != state.h:
        s.approach = approach_at(v, f_n) if f_n > 0.0 else state.approach + (h - state.h)
    s.h = h
    s.h_max = greatest
    s.x = x
    if not f_n > 0.0:
        s.deflection = [[0.0, 0.0] for _ in range(SLIDERS)]
        return s, out
    out.df_n_dh = df_n_dh
    share = taken(flow)
    shear(p, s, out, v, f_n, carried, (share * increment[0], share * increment[1]))
    out.df_t_ddelta = [[share * k for k in row] for row in out.df_t_ddelta]
    out.df_n_ddelta = [share * k for k in out.df_n_ddelta]
    out.a = v.a * (s.approach / v.depth) ** (v.gamma - 1.0)
    return s, out


def stored_energy(p, state):
    """Elastic energy that the contact stores: no path gives back more than it."""
    if not state.h_max > 0.0 or state.approach <= 0.0:
        return 0.0
    v = virgin(p, state.h_max)
    total = 0.0
    for w, q in zip(v.weight, state.deflection):
        total += w * (q[0] * q[0] + q[1] * q[1])
    return force_at(v, state.approach) * state.approach / (v.gamma + 1.0) + 0.5 * v.k_t * total


# ---- check against the test vectors ----


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
