# ---- virgin curves ----


class Virgin:
    """First loading at one indentation."""

    __slots__ = (
        "f_n0", "a", "f_n_slip", "delta_t_slip", "k_t", "n", "m_exponent", "n_exponent", "slope", "gamma", "depth", "first", "backbone", "weight", "lost", "shapes"
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


def sharpen(v, sheared, reversed):
    """Gives it the sliders of a contact that has yielded to shear at the place `sheared`, and whose slip was reversed so far."""
    v.backbone = v.first
    if not is_elastic(v):
        again = reversed * min((1.0 - v.f_n_slip / v.f_n0) / HARDLY, 1.0)
        if v.backbone > LATER:
            v.backbone += (LATER - v.backbone) * again
        if v.backbone < UNSHEARED:
            rest = 1.0 - sheared if sheared < 1.0 else 0.0
            rest = rest * rest
            rest = rest * rest
            v.backbone += (UNSHEARED - v.backbone) * (rest * rest)
    v.weight, v.lost = sliders(v.backbone)


def virgin(p, h, sheared=1.0, reversed=0.0):
    """First loading at the indentation h > 0, with the sliders of a contact that was sheared."""
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
    v.k_t = math.exp(column_at(p, 7, position)[0])
    if NORMAL_CURVE == 2:
        v.backbone = steep
        v.shapes = shapes_at(p, position)
    else:
        v.k_t = max(v.k_t, v.n * p.friction * v.f_n_slip / v.delta_t_slip)
    end = v.backbone * p.friction * v.f_n0 / v.delta_t_slip
    if v.k_t < end:
        v.k_t = end
    v.first = 1.0 + FIRST * (v.backbone - 1.0) if NORMAL_CURVE == 2 and not is_elastic(v) else v.backbone
    sharpen(v, sheared, reversed)
    v.slope = v.f_n0 * log_slope / (p.log_step * h)
    v.depth = v.gamma * v.f_n0 / (2.0 * p.effective_modulus * v.a)
    v.a = radii * v.a
    return v


# ---- update ----

# Of simulated oblique presses, rebounds and reversals; asperity's model of the update says what they are.
PRESSED = 0.9
LEAST_NORMAL = 0.25
SUDDEN = 0.2
FORGETS = 4.0
GONE = 1e-5
LEAST_TRAVEL = 0.4
RELAXATION = 0.1
REVERSED = 0.05
LEAST_REVERSED = 1e-6
SLIDING = 0.98
GATHERED = 0.7
MOST = 2.0  # x after all of what reversed slip costs
UNSHEARED = 2.0
TAKEN_BACK = 0.9
NO_CHANGE = 0.15
FIRST = 1.5
LATER = 1.15
HARDLY = 0.02
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
    """c of the yield curve: a table's own, or that of F_N0/F_N = 1 + b r + c r^2, r = F_T/F_N, which the virgin curve follows."""
    if NORMAL_CURVE == 2:
        return v.n
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


def recovered(v):
    """Share of an indentation that unloading recovers."""
    return v.slope * v.depth / (v.gamma * v.f_n0)


def yield_share(v, c):
    """s c of the yield curve F_N (1 + s c r^2) = F_N0."""
    return PRESSED * (1.0 - recovered(v)) * c


def flow_coefficient(p, v, c, r):
    """c of the flow at the ratio r of F_T to F_N, from the c that was measured where d(delta_T)/dh is mu/(1/2 + mu^2/4)."""
    slope = 2.0 * p.friction / (1.0 + 0.5 * p.friction * p.friction)
    measured = (math.sqrt(1.0 + slope * slope / c) - 1.0) / slope
    share = r / measured if r < 2.0 * measured else 2.0
    return c * (1.0 + (recovered(v) - NO_CHANGE) * (share - 1.0))


def pressed_cap(v, share, f_t):
    """Greatest F_N of a contact that is pressed with the tangential force f_t, on the yield curve of this s c, and the square of its root."""
    force = f_t / v.f_n0
    q = 1.0 - 4.0 * share * (force * force)
    return (0.5 * v.f_n0 * (1.0 + math.sqrt(q)), q) if q > 0.0 else (0.5 * v.f_n0, 0.0)


def yielding_at(v, share, ratio):
    """F_N on that curve at a ratio F_T/F_N."""
    return v.f_n0 / (1.0 + share * (ratio * ratio))


def reversed_share(v):
    """Share of F_N_slip that reversals cost: no more than what the slip itself has cost."""
    return max(min(v.f_n0 / v.f_n_slip - 1.0, REVERSED), LEAST_REVERSED)


def mobilisation(v, f_n):
    """The x of the virgin curve that has the normal force f_n."""
    if f_n >= AT_CAP * v.f_n0:
        return 0.0
    if AT_SLIP * f_n <= v.f_n_slip:
        return min(MOST, 1.0 + max(0.0, 1.0 - f_n / v.f_n_slip) / reversed_share(v))
    return normal_shape_inverse(v, (v.f_n0 - f_n) / (v.f_n0 - v.f_n_slip))


def reversed_cap(v, x):
    """F_N at x, with what a reversed slip costs."""
    return normal_cap(v, x) if x < 1.0 else v.f_n_slip * (1.0 - reversed_share(v) * (x - 1.0))


def per_reach(v):
    """F_N over the reach of a contact: 2 E* a/gamma."""
    return v.f_n0 / v.depth


def force_at(v, reach, e):
    """F_N at the elastic approach e of a contact with this reach. An unloading starts with 2 E* a from any F_N: what shear takes of F_N leaves the contact as wide as it was."""
    return 0.0 if e <= 0.0 else per_reach(v) * reach * (e / reach) ** v.gamma


def elastic_at(old, v, grown, reach, e):
    """The elastic response of a contact with this reach at the approach e, on its way from the greatest h of `old` to that of `v`: F_N, dF_N/dh, that of an unloading, approach, reach.
    Beyond its reach the contact stores the work of the step, with the mean of the forces before and after; the energy is F_N^2/(k (gamma + 1)), k = F_N/reach. Where shear has made
    the reach smaller than D, it stores sqrt(reach/D) of the work only."""
    if e <= reach and not grown:
        f_n = force_at(v, reach, e)
        stiffness = v.gamma * f_n / e if e > 0.0 else 0.0
        return f_n, stiffness, stiffness, e, reach
    began = per_reach(old) * reach
    half = 0.5 * (e - reach) if e > reach else 0.0
    softness = 1.0 / (per_reach(v) * (v.gamma + 1.0))
    kept = half * math.sqrt(reach / old.depth)
    stored = began * reach / (old.gamma + 1.0) + began * kept
    f_n = (kept + math.sqrt(kept * kept + 4.0 * softness * stored)) / (2.0 * softness)
    unloading = old.gamma * per_reach(old)
    stiffness = 0.5 * (f_n - began) / half if half > 0.0 else unloading
    reach = f_n / per_reach(v)
    return f_n, stiffness, unloading, reach, reach


def lower(s, share):
    """F_N falls to a share of what it was, without an unloading."""
    s.approach *= share
    s.reach *= share


def extent(v, s):
    """What is left of the contact's extent as it is released: eta of the sliders, 1 at its reach."""
    if s.approach <= 0.0:
        return 0.0
    return (s.approach / s.reach) ** (v.gamma / v.backbone) if s.approach < s.reach else 1.0


def slider_limits(p, v, f_n, eta):
    """Greatest deflection of each slider under the normal force f_n at the extent eta: their forces then add up to mu F_N."""
    limit = [0.0] * SLIDERS
    if f_n <= 0.0:
        return limit
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


def press(p, s, v, h, increment):
    """Moves h with delta_T held, while `increment` brings some of F_T back. Returns F_N, x, dF_N/dh, by how many e-folds F_T has flowed, and the displacement that hardens
    nothing."""
    dh = h - s.h
    grown = h > s.h_max
    first = grown and (s.x == 0.0 or not s.h_max > 0.0)
    e = s.approach + dh
    answer = v.f_n0, v.slope, v.gamma * v.f_n0 / v.depth, v.depth, v.depth
    if grown and s.h_max > 0.0:
        old = virgin(p, s.h_max)
        keep = old.k_t / v.k_t
        if keep < 1.0:
            s.deflection = [[keep * q[0], keep * q[1]] for q in s.deflection]
        if not first:
            answer = elastic_at(old, v, True, s.reach, e)
    elif not grown:
        answer = elastic_at(v, v, False, s.reach, e)
    trial, stiffness, elastic_stiffness, approach, reach = answer
    f_n = trial if trial < v.f_n0 else v.f_n0
    if dh != 0.0:
        s.approach, s.reach = (approach, reach) if trial < v.f_n0 else (v.depth, v.depth)
    eta = extent(v, s)
    if dh == 0.0:
        return f_n, s.x, v.slope if s.x == 0.0 and s.h == s.h_max else stiffness, 0.0, 0.0
    elastic = mobilisation(v, f_n)
    if dh < 0.0:
        return f_n, elastic if elastic > s.x else s.x, stiffness, 0.0, 0.0
    if trial >= v.f_n0 and grown:
        stiffness = v.slope
    s.deflection = slide(s.deflection, slider_limits(p, v, f_n, eta), (0.0, 0.0))
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
    share = yield_share(v, c)
    highest = pressed_cap(v, share, f_t)[0]
    r = f_t / f_n
    c = flow_coefficient(p, v, c, r)
    normal = max(1.0 - c * (r * r), LEAST_NORMAL)
    tangential = 2.0 * c * r
    across = max(1.0 - share * (r * r), LEAST_NORMAL)
    turn = 2.0 * share * r
    part = min((trial - cap) / (highest - cap), 1.0) if highest > cap else 1.0
    softer = 1.0 - v.slope * f_n / (v.f_n0 * elastic_stiffness) if grown else 1.0
    plastic = min(softer * dh if softer > 0.0 else 0.0, (trial - cap) / elastic_stiffness)
    forward = max((force[0] * increment[0] + force[1] * increment[1]) / f_t, 0.0)
    # What of delta_T flows. Where the contact does not move as far, F_T falls, and F_N rises along the yield curve: that takes some of the press.
    steady = part * (tangential / normal) * plastic
    if grown and softer > 0.0:
        # In a steady press the sliders' force grows too, and c is of all of delta_T over all of h.
        all_of_it = plastic / softer
        grows = r * v.slope * (f_n / v.f_n0) / v.k_t
        steady = max(min(part * ((tangential / normal - grows) * all_of_it), forward), steady)
    flows, taken_back = steady, 0.0
    if forward < steady:
        stiff = normal * across * elastic_stiffness
        soft = tangential * turn * v.k_t
        flows = forward + TAKEN_BACK * (steady - forward) * (stiff / (stiff + soft))
        taken_back = 1.0 - forward / steady
    flow = v.k_t * flows / f_t
    # The linear part of the virgin curve flows too, and what it takes of delta_T does not harden.
    linear = (v.f_n0 / v.f_n_slip - 1.0) / p.friction - c * p.friction
    sudden = min(linear / normal * plastic if linear > 0.0 else 0.0, SUDDEN * forward)
    keep = math.exp(-flow)
    left = keep * f_t / slip_force
    x = tangential_shape_back(v, left, before) if left < tangential_shape(v, place)[0] else place
    pressed, q = pressed_cap(v, share, keep * f_t)
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
    x = elastic if f_n < on_curve else x  # where F_N is below the curve, it is F_N that tells the place
    if raised < f_n:
        lower(s, raised / f_n)
        f_n = raised
    back = (1.0 - keep) / v.k_t
    s.deflection = slide(s.deflection, slider_limits(p, v, f_n, eta), (-back * force[0], -back * force[1]))
    if taken_back > 0.0 and left < GONE:
        s.deflection = [[0.0, 0.0] for _ in range(SLIDERS)]
    x = x if x < s.x else s.x
    # It forgets with the growth of the contact, and as F_T is taken back.
    kept = math.exp(-plastic / h - FORGETS * (taken_back * taken_back) * flow)
    s.sheared = x + (s.sheared - x) * kept if s.sheared > x else x
    s.reversed *= kept
    return f_n, x, slope, flow, sudden


def reverse(p, s, out, v, before, force_before, increment):
    """The sliders slip and stick at the F_N of full slip or next to it, or the contact was released: it loses what a reversal of the slip costs besides."""
    size = math.sqrt(increment[0] * increment[0] + increment[1] * increment[1])
    held = math.sqrt(force_before[0] * force_before[0] + force_before[1] * force_before[1])
    if s.x >= MOST or not size > 0.0 or held > SLIDING * (p.friction * out.f_n):
        return
    rise = [out.f_t[0] - force_before[0], out.f_t[1] - force_before[1]]
    risen = math.sqrt(rise[0] * rise[0] + rise[1] * rise[1])
    stick = risen / (v.k_t * size)
    if not 0.0 < stick < 1.0:
        return
    # What F_N is above that of its x stays above it.
    stands = reversed_cap(v, s.x)
    above = max(out.f_n - stands, 0.0)
    rate = 4.0 * GATHERED * (v.k_t / (p.friction * v.f_n_slip))
    falling = reversed_share(v) * v.f_n_slip
    if s.x < 1.0:
        # Next to full slip alone: F_T/F_N over mu to the power 24.
        near = tangential_shape(v, s.x)[0] * v.f_n_slip / stands
        near = near * near * near
        near = near * near
        near = near * near
        rate *= near * near
        falling = (v.f_n0 - v.f_n_slip) * normal_shape(v, s.x)[1]
    gain = rate * (stick * (1.0 - stick)) * size
    rate = rate * (MOST - s.x)
    s.x = min(s.x + (MOST - s.x) * gain, MOST)
    s.reversed = min(s.reversed + (1.0 - s.reversed) * gain, 1.0)
    # The sliders of a contact at rest are those that it came to rest with.
    sharpen(v, s.sheared, s.reversed)
    eta = extent(v, s)
    cap = reversed_cap(v, s.x) + above
    lowers = cap < out.f_n
    if lowers:
        lower(s, cap / out.f_n)
        out.f_n = cap
    limit = slider_limits(p, v, out.f_n, eta)
    s.deflection = slide(before, limit, increment)
    out.f_t = slider_force(v, s.deflection)
    loss = falling * rate if lowers and s.x < MOST else 0.0
    for j in range(2):
        stiffer = (rise[0] * out.df_t_ddelta[0][j] + rise[1] * out.df_t_ddelta[1][j]) / (risen * v.k_t)
        out.df_n_ddelta[j] = -loss * ((1.0 - 2.0 * stick) * stiffer + stick * stick * increment[j] / size)
    out.df_t_ddelta = slider_stiffness(v, before, limit, increment)
    for j in range(2):
        falls = (1.0 - stick) * out.df_n_ddelta[j] / out.f_n
        for i in range(2):
            out.df_t_ddelta[i][j] += falls * out.f_t[i]


def shear(p, s, out, v, f_n, sudden, increment):
    """Moves delta_T with h held."""
    before = s.deflection
    force_before = slider_force(v, before)
    eta = extent(v, s)
    limit = slider_limits(p, v, f_n, eta)
    s.deflection = slide(before, limit, increment)
    out.f_n = f_n
    out.f_t = slider_force(v, s.deflection)
    out.df_t_ddelta = slider_stiffness(v, before, limit, increment)
    if is_elastic(v):
        return
    if s.x >= 1.0 and not AT_CAP * f_n > v.f_n_slip:
        reverse(p, s, out, v, before, force_before, increment)
        return
    slip_force = p.friction * v.f_n_slip
    at = min(max(s.x, s.sheared), 1.0)
    before_cap = normal_cap(v, at)
    # After a press F_N may be above the virgin curve, but not above the yield curve; F_T/F_N is that of the virgin curve there too.
    raised = AT_CAP * f_n > before_cap
    share = yield_share(v, yield_coefficient(p, v)) if raised else 0.0
    bound = slip_force * tangential_shape(v, at)[0]
    if raised:
        ratio = bound / before_cap
        top = max(min(yielding_at(v, share, ratio), f_n), before_cap)
        bound = min(ratio, p.friction) * top
    trial = math.sqrt(out.f_t[0] * out.f_t[0] + out.f_t[1] * out.f_t[1])
    # Where everything slides F_T rises by nothing but rounding; there the displacement tells what is beyond.
    forward = max((out.f_t[0] * increment[0] + out.f_t[1] * increment[1]) / trial, 0.0) if trial > 0.0 else 0.0
    travel = trial - (out.f_t[0] * force_before[0] + out.f_t[1] * force_before[1]) / trial if trial > 0.0 else 0.0
    ahead = max(LEAST_TRAVEL * (v.k_t * forward) - travel, 0.0)
    if trial + ahead <= AT_BOUND * bound:
        highest, q = pressed_cap(v, share, trial)
        if raised and AT_CAP * highest < f_n:
            cap = min(highest if highest > before_cap else before_cap, f_n)
            falls = 2.0 * share / (v.f_n0 * math.sqrt(q)) if highest > before_cap and q > 0.0 and trial > 0.0 else 0.0
            for j in range(2):
                out.df_n_ddelta[j] = -falls * (out.f_t[0] * out.df_t_ddelta[0][j] + out.f_t[1] * out.df_t_ddelta[1][j])
            lower(s, cap / f_n)
            out.f_n = cap
            limit = slider_limits(p, v, cap, eta)
            s.deflection = slide(before, limit, increment)
            out.f_t = slider_force(v, s.deflection)
            out.df_t_ddelta = slider_stiffness(v, before, limit, increment)
        elif s.x >= 1.0 or (s.x > 0.0 and not raised):
            reverse(p, s, out, v, before, force_before, increment)
        return
    direction = [out.f_t[0] / trial, out.f_t[1] / trial]
    excess = max(trial - bound + ahead, 0.0)
    travel += ahead
    beyond = excess / travel if excess < travel else 1.0
    hardens = max(beyond * forward - sudden, 0.5 * (beyond * forward))  # in a long step, half of it at the least
    dx = hardens / v.delta_t_slip
    x = at + dx if at + dx < 1.0 else 1.0
    cap = normal_cap(v, x)
    shape, shape_slope = tangential_shape(v, x)
    falls = (v.f_n0 - v.f_n_slip) * normal_shape(v, x)[1]
    ratio = slip_force * shape / cap
    steeper = (slip_force * shape_slope + ratio * falls) / cap
    above = (f_n - before_cap) * math.exp(-dx / RELAXATION) if raised else 0.0
    lowered = cap + above
    loss = falls + above / RELAXATION
    if raised:
        highest = yielding_at(v, share, ratio)
        if cap < highest < lowered:
            lowered = highest
            loss = 2.0 * share * ratio * steeper * highest * (highest / v.f_n0)
        elif highest < lowered:
            lowered, loss = cap, falls
    out.f_n = lowered if lowered < f_n else f_n
    s.x = 1.0 if AT_SLIP * out.f_n <= v.f_n_slip else x
    s.sheared = x
    lower(s, out.f_n / f_n)
    limit = slider_limits(p, v, out.f_n, eta)
    s.deflection = slide(before, limit, increment)
    held = slider_force(v, s.deflection)
    stiffness = slider_stiffness(v, before, limit, increment)
    bound = min(ratio, p.friction) * out.f_n
    per_x = beyond / v.delta_t_slip if hardens > 0.0 else 0.0
    rate = (steeper * out.f_n - ratio * loss) * per_x
    size = math.sqrt(held[0] * held[0] + held[1] * held[1])
    out.f_t = held
    out.df_n_ddelta = [-loss * per_x * direction[0], -loss * per_x * direction[1]]
    out.df_t_ddelta = stiffness
    if AT_BOUND * size <= bound:  # at full slip the two are the same but for rounding
        return
    keep = bound / size if size > bound else 1.0
    s.deflection = scale(s.deflection, keep)
    m = [held[0] / size, held[1] / size]
    out.f_t = [keep * held[0], keep * held[1]]
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

    Where h or the increment is not finite, or the state is not sound, nothing in the response is a number and the state stays as it was."""
    s = state.copy()
    out = Response()
    if not (math.isfinite(h) and math.isfinite(increment[0]) and math.isfinite(increment[1]) and state.is_sound()):
        nan = math.nan
        out.f_n, out.f_t, out.df_n_dh, out.df_n_ddelta, out.a = nan, [nan, nan], nan, [nan, nan], nan
        out.df_t_ddelta = [[nan, nan], [nan, nan]]
        return s, out
    increment = bounded(increment)
    greatest = h if h > state.h_max else state.h_max
    if not greatest > 0.0:
        s.h = h
        return s, out
    v = virgin(p, greatest, state.sheared, state.reversed)
    f_n, x, df_n_dh, flow, sudden = press(p, s, v, h, increment)
    s.h = h
    s.h_max = greatest
    s.x = x
    if not f_n > 0.0:
        s.deflection = [[0.0, 0.0] for _ in range(SLIDERS)]
        return s, out
    out.df_n_dh = df_n_dh
    share = taken(flow)
    shear(p, s, out, v, f_n, sudden, (share * increment[0], share * increment[1]))
    out.df_t_ddelta = [[share * k for k in row] for row in out.df_t_ddelta]
    out.df_n_ddelta = [share * k for k in out.df_n_ddelta]
    out.a = v.a * (s.approach / s.reach) ** (v.gamma - 1.0)
    return s, out


def stored_energy(p, state):
    """Elastic energy that the contact stores: no path gives back more than it. No number where the state is not sound."""
    if not state.is_sound():
        return math.nan
    if not state.h_max > 0.0 or state.approach <= 0.0:
        return 0.0
    v = virgin(p, state.h_max)
    total = 0.0
    for w, q in zip(v.weight, state.deflection):
        total += w * (q[0] * q[0] + q[1] * q[1])
    return force_at(v, state.reach, state.approach) * state.approach / (v.gamma + 1.0) + 0.5 * v.k_t * total


