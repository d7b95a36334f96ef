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


