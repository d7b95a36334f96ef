/* Elastic energy of the virgin contact at a knot. */
static inline double asperity_stored_at(const asperity_draft *p, int i) {
    double f_n0 = exp(p->table[i][0]), a = exp(p->table[i][1]);
    double gamma = asperity_unloading_exponent(p->radius, p->effective_modulus, p->table[i][5] * a, f_n0);
    return gamma / (gamma + 1.0) * f_n0 * f_n0 / (2.0 * p->effective_modulus * a);
}

/* Slope of a column at a knot, per step. */
static inline double asperity_knot_slope(const asperity_draft *p, int column, int i) {
    double below, above;
    if (i == 0) {
        return p->table[1][column] - p->table[0][column];
    }
    below = p->table[i][column] - p->table[i - 1][column];
    if (i == ASPERITY_KNOTS - 1) {
        return below;
    }
    above = p->table[i + 1][column] - p->table[i][column];
    if (column == 0) {
        return above > below ? above : below;
    }
    if (column == 1) {
        return above < below ? above : below;
    }
    return 0.5 * (above + below);
}

/* ln F_N0 at the share u of the step before a knot: its cubic. */
static inline double asperity_log_force(const asperity_draft *p, int i, double u) {
    double start = p->table[i - 1][0], rise = p->table[i][0] - start, s0 = asperity_knot_slope(p, 0, i - 1), s1 = asperity_knot_slope(p, 0, i);
    double quadratic = 3.0 * rise - 2.0 * s0 - s1, cubic = s0 + s1 - 2.0 * rise;
    return start + u * (s0 + u * (quadratic + u * cubic));
}

/* Work of a press from the knot before to this one, F_N0 being a power of h on each of some pieces of the way. */
static inline double asperity_work_between(const asperity_draft *p, int i) {
    double work = 0.0, log_f = p->table[i - 1][0], next, u, h0, h1, power;
    int k;
    for (k = 1; k <= @PIECES@; k++) {
        u = k / @PIECES@.0;
        next = k < @PIECES@ ? asperity_log_force(p, i, u) : p->table[i][0];
        h0 = exp(p->log_first + p->log_step * (i - 1 + (u - 1.0 / @PIECES@.0)));
        h1 = exp(p->log_first + p->log_step * (i - 1 + u));
        power = (next - log_f) / (p->log_step / @PIECES@.0);
        work += (exp(next) * h1 - exp(log_f) * h0) / (power + 1.0);
        log_f = next;
    }
    return work;
}

/* Makes the unloading of a knot stiffer by a factor. */
static inline void asperity_stiffen(asperity_draft *p, int i, double factor) {
    p->table[i][1] += log(factor);
    p->table[i][5] /= factor;
}

/* Lets no more than the indentation h be recovered at a knot. */
static inline void asperity_keep_below(asperity_draft *p, int i, double h) {
    double f_n0 = exp(p->table[i][0]), a = exp(p->table[i][1]);
    double depth = asperity_unloading_exponent(p->radius, p->effective_modulus, p->table[i][5] * a, f_n0) * f_n0 / (2.0 * p->effective_modulus * a);
    if (depth > h) {
        asperity_stiffen(p, i, depth / h);
    }
}

/* Stiffens the unloading where F_N0 and a would let a press store more energy than was put in, or the
 * dent rise above where the sphere began; the contact radius stays. */
static inline void asperity_conserve(asperity_draft *p) {
    double before, most, stored;
    int i;
    asperity_keep_below(p, 0, exp(p->log_first));
    before = asperity_stored_at(p, 0);
    for (i = 1; i < ASPERITY_KNOTS; i++) {
        /* What the body adds stays as the contact yields. */
        asperity_stiffen(p, i, 1.0 / p->table[i - 1][5]);
        most = before + asperity_work_between(p, i);
        stored = asperity_stored_at(p, i);
        /* A little is spared for what the cubics between the knots may gain. */
        if (stored > (1.0 + @ROUNDING@) * most) {
            asperity_stiffen(p, i, stored / ((1.0 - @SPARE@) * most));
        }
        asperity_keep_below(p, i, exp(p->log_first + p->log_step * i));
        before = asperity_stored_at(p, i);
    }
}

