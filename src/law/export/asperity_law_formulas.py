# ---- set-up: the material, the normal model, the law ----

@CONSTANTS@


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
    """a and F_N0 at the indentation h > 0."""
    hertz = math.sqrt(radius * h)
    force = 4.0 / 3.0 * effective_modulus(m) * math.sqrt(radius) * h**1.5
    first = yield_lambda(m.poissons_ratio)
    value = johnson_lambda(m, radius, hertz)
    elastic = stiffening(m.poissons_ratio, friction, hertz / radius)
    if value <= first:
        return hertz, force * math.exp(elastic)
    ratio = value / first
    ratio = ratio if ratio > 1.0 else 1.0
    ramp = 1.0 - 1.0 / ratio
    hardening = hardening_exponent(m, radius, hertz)
    growth = 1.43 * math.exp(-NORMAL_RADIUS_0 * hardening) - 0.5
    area = 0.5 + growth * (1.0 - math.exp(-((NORMAL_RADIUS_1 * math.log(ratio)) ** NORMAL_RADIUS_2)))
    a = hertz * math.sqrt(2.0 * area * math.exp(NORMAL_RADIUS_3 * ramp * hertz / radius))
    plastic = (NORMAL_FORCE_0 * (value - first) ** NORMAL_FORCE_1) ** NORMAL_FORCE_2
    size = (NORMAL_FORCE_5 - NORMAL_FORCE_3 * math.log(ratio)) * (hertz / radius)
    size = (1.0 - ramp) * elastic + ramp * (size - NORMAL_FORCE_4 * hardening)
    return a, force * (1.0 + plastic) ** (-1.0 / NORMAL_FORCE_2) * math.exp(size)


def product(p, q, friction, z):
    """mu^p z^q."""
    return 0.0 if z <= 0.0 else friction**p * z**q


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
        z = ramp * (2.0 * (a * a / (2.0 * radius * h)) - 1.0)
        growth = z / math.log(ratio)
        z = z if z > 0.0 else 0.0
        growth = growth if growth > 0.0 else 0.0
    power = EXPONENT_2 * math.exp(-EXPONENT_4 * friction)
    size = math.exp(EXPONENT_5 * friction * growth - EXPONENT_3 * (a / radius))
    n = 1.5 + EXPONENT_SPAN * math.tanh(EXPONENT_0 * product(EXPONENT_1, power, friction, z) * size / EXPONENT_SPAN)
    size = math.exp(FALL_4 * friction * growth - FALL_5 * (a / radius))
    share = 1.0 - math.tanh(FALL_0 * friction) * math.tanh(FALL_1 * product(FALL_2, FALL_3, friction, z) * size)
    body = 1.0 + SLIP_0 * (a / radius)
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


