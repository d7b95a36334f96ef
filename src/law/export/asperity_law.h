/* asperity_law.h: force-displacement law of an elastic-plastic sphere on a rigid plane, for any material: makes the tables of asperity_contact.h, which has the update.
 *
 * Written by asperity @VERSION@ from @SOURCE@. C99, C++17 and CUDA (the set-up on the host); double, or with ASPERITY_SINGLE float.
 * No global data, no allocation, no failure at run time. Lies beside asperity_contact.h.
 *
 * Once a material and a friction coefficient, for all radii:
 *     asperity_material steel = {200e3, 0.3, ASPERITY_IDEAL, {400.0, 0.0, 0.0}, 0, 0};
 *     asperity_table table;
 *     if (asperity_setup(&table, &steel, mu) != 0) ...             nonzero: a number is missing or out of range
 * Then, with E = steel.youngs_modulus, asperity_update(&table, R, E, ...) as asperity_contact.h tells, or asperity_contact3d.h with two radii and walls in three dimensions.
 * The table is of a plane: asperity_contact.h says when it may stand for two equal spheres.
 *
 * @FITTED@:
 * asperity_outside tells.
 */
#ifndef ASPERITY_LAW_H
#define ASPERITY_LAW_H

#include "asperity_contact.h"

#define ASPERITY_ANY_MATERIAL 1

/* The constants of the formulas. */
@CONSTANTS@
#define ASPERITY_PI 3.141592653589793

/* Hardening laws: the stresses and numbers of asperity_material.hardening_numbers. */
enum {
@HARDENING_CODES@
};

/* A sphere's material. */
typedef struct asperity_material {
    double youngs_modulus;
    double poissons_ratio;
    int hardening;
    double hardening_numbers[3];
    const double *points; /* of ASPERITY_TABLE: alpha_0, sigma_0, alpha_1, ...; needed during the set-up only */
    int point_count;      /* pairs */
} asperity_material;

@CONTACT_DRAFT@/* ---- set-up: the material, the normal model, the law ---- */

/* Flow stress at the plastic strain `plastic`. */
static inline double asperity_flow_stress(const asperity_material *m, double plastic) {
    const double *c = m->hardening_numbers;
    double low, high, middle;
    int i;
    switch (m->hardening) {
    case ASPERITY_IDEAL:
        return c[0];
    case ASPERITY_LINEAR:
        return c[0] + c[1] * plastic;
    case ASPERITY_POWER:
        return c[0] + c[1] * pow(plastic, c[2]);
    case ASPERITY_HOLLOMON:
        low = m->youngs_modulus * pow(c[0] / m->youngs_modulus, c[1] / (c[1] - 1.0));
        if (plastic <= 0.0) {
            return low;
        }
        high = low + plastic * m->youngs_modulus / (c[1] - 1.0);
        for (i = 0; i < 200; i++) {
            middle = 0.5 * (low + high);
            if (middle <= low || middle >= high) {
                break;
            }
            if (pow(middle / c[0], c[1]) - middle / m->youngs_modulus < plastic) {
                low = middle;
            } else {
                high = middle;
            }
        }
        return 0.5 * (low + high);
    case ASPERITY_VOCE:
        return c[0] - (c[1] - c[0]) * expm1(-(c[2] * plastic));
    case ASPERITY_TABLE:
        for (i = 1; i < m->point_count; i++) {
            const double *p = m->points + 2 * i;
            if (plastic < p[0]) {
                return p[-1] + (p[1] - p[-1]) / (p[0] - p[-2]) * (plastic - p[-2]);
            }
        }
        return m->points[2 * m->point_count - 1];
    default:
        return HUGE_VAL;
    }
}

/* Plastic part of a total strain. */
static inline double asperity_plastic_share(const asperity_material *m, double strain) {
    double low = 0.0, high = strain, middle;
    int i;
    if (strain * m->youngs_modulus <= asperity_flow_stress(m, 0.0)) {
        return 0.0;
    }
    if (m->hardening == ASPERITY_HOLLOMON) {
        return strain - m->hardening_numbers[0] * pow(strain, 1.0 / m->hardening_numbers[1]) / m->youngs_modulus;
    }
    for (i = 0; i < 200; i++) {
        middle = 0.5 * (low + high);
        if (middle <= low || middle >= high) {
            break;
        }
        if (middle + asperity_flow_stress(m, middle) / m->youngs_modulus - strain < 0.0) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return 0.5 * (low + high);
}

/* sigma_rep: the flow stress at the total strain 0.2 a/R (Tabor 1951). */
static inline double asperity_representative_stress(const asperity_material *m, double radius, double a) {
    if (m->hardening == ASPERITY_ELASTIC) {
        return HUGE_VAL;
    }
    return asperity_flow_stress(m, asperity_plastic_share(m, 0.2 * a / radius));
}

/* E* = E/(1 - nu^2). */
static inline double asperity_effective_modulus(const asperity_material *m) {
    return m->youngs_modulus / (1.0 - m->poissons_ratio * m->poissons_ratio);
}

/* Lambda = E* a/(sigma_rep R) (Johnson 1970). */
static inline double asperity_lambda(const asperity_material *m, double radius, double a) {
    return asperity_effective_modulus(m) * a / (asperity_representative_stress(m, radius, a) * radius);
}

/* Local hardening exponent, the 1/m of the closed forms. */
static inline double asperity_hardening_exponent(const asperity_material *m, double radius, double a) {
    double plastic, secant;
    if (m->hardening == ASPERITY_ELASTIC) {
        return 0.0;
    }
    plastic = asperity_plastic_share(m, 0.2 * a / radius);
    secant = log(asperity_flow_stress(m, plastic) / asperity_flow_stress(m, 0.25 * plastic)) / log(4.0);
    return secant < 0.0 ? 0.0 : secant > 1.0 ? 1.0 : secant;
}

/* Lambda at first yield, from Huber's stresses on the axis. */
static inline double asperity_yield_lambda(double nu) {
    double low = 0.2, high = 1.0, zeta, fall, slope;
    int i;
    for (i = 0; i < 200; i++) {
        zeta = 0.5 * (low + high);
        if (zeta <= low || zeta >= high) {
            break;
        }
        fall = 1.0 / (1.0 + zeta * zeta);
        slope = -3.0 * zeta * fall * fall + (1.0 + nu) * (atan(1.0 / zeta) - zeta * fall);
        if (-slope < 0.0) {
            low = zeta;
        } else {
            high = zeta;
        }
    }
    zeta = 0.5 * (low + high);
    fall = 1.0 / (1.0 + zeta * zeta);
    return 0.5 * ASPERITY_PI * (1.0 / fabs(1.5 * fall - (1.0 + nu) * (1.0 - zeta * atan(1.0 / zeta))));
}

/* S tanh(mu/beta); it vanishes with beta at nu = 1/2. */
static inline double asperity_stick(double nu, double friction) {
    double beta = (1.0 - 2.0 * nu) / (2.0 * (1.0 - nu));
    if (beta < 1e-9) {
        return 0.0 * friction;
    }
    return ((1.0 - nu) * log(3.0 - 4.0 * nu) / (1.0 - 2.0 * nu) - 1.0) * tanh(friction / beta);
}

/* ln of an elastic sphere's force over Hertz's; size is a_H/R. */
static inline double asperity_stiffening(double nu, double friction, double size) {
    return asperity_stick(nu, friction) * (ASPERITY_BODY_0 + ASPERITY_BODY_1 * size)
        + size * (ASPERITY_BODY_2 + ASPERITY_BODY_3 * size + ASPERITY_BODY_4 * nu);
}

/* a and F_N0 at the indentation h > 0. */
static inline void asperity_normal(const asperity_material *m, double radius, double friction, double h, double *a, double *f_n) {
    double hertz = sqrt(radius * h);
    double force = 4.0 / 3.0 * asperity_effective_modulus(m) * sqrt(radius) * pow(h, 1.5);
    double yield = asperity_yield_lambda(m->poissons_ratio), lambda = asperity_lambda(m, radius, hertz);
    double elastic = asperity_stiffening(m->poissons_ratio, friction, hertz / radius);
    double ratio, ramp, hardening, growth, c_squared, plastic, size;
    *a = hertz;
    *f_n = force * exp(elastic);
    if (lambda <= yield) {
        return;
    }
    ratio = lambda / yield;
    ratio = ratio > 1.0 ? ratio : 1.0;
    ramp = 1.0 - 1.0 / ratio;
    hardening = asperity_hardening_exponent(m, radius, hertz);
    growth = 1.43 * exp(-ASPERITY_NORMAL_RADIUS_0 * hardening) - 0.5;
    c_squared = 0.5 + growth * (1.0 - exp(-pow(ASPERITY_NORMAL_RADIUS_1 * log(ratio), ASPERITY_NORMAL_RADIUS_2)));
    *a = hertz * sqrt(2.0 * c_squared * exp(ASPERITY_NORMAL_RADIUS_3 * ramp * hertz / radius));
    plastic = pow(ASPERITY_NORMAL_FORCE_0 * pow(lambda - yield, ASPERITY_NORMAL_FORCE_1), ASPERITY_NORMAL_FORCE_2);
    size = (ASPERITY_NORMAL_FORCE_5 - ASPERITY_NORMAL_FORCE_3 * log(ratio)) * (hertz / radius);
    size = (1.0 - ramp) * elastic + ramp * (size - ASPERITY_NORMAL_FORCE_4 * hardening);
    *f_n = force * pow(1.0 + plastic, -1.0 / ASPERITY_NORMAL_FORCE_2) * exp(size);
}

/* mu^p z^q. */
static inline double asperity_product(double p, double q, double friction, double z) {
    return z <= 0.0 ? 0.0 : pow(friction, p) * pow(z, q);
}

/* A row of the table: the law at the indentation h. Without friction there is no displacement at full slip, and none is asked for. */
static inline void asperity_table_row(const asperity_material *m, double radius, double friction, double h, double row[ASPERITY_COLUMNS]) {
    double a, f_n, stress, lambda, yield, ratio, ramp, z = 0.0, growth = 0.0, n, power, size, share, body, factor, steep, mindlin;
    asperity_normal(m, radius, friction, h, &a, &f_n);
    friction = friction > 0.0 ? friction : 1e-6;
    stress = asperity_representative_stress(m, radius, a);
    lambda = asperity_effective_modulus(m) * a / (stress * radius);
    yield = asperity_yield_lambda(m->poissons_ratio);
    if (lambda > yield) {
        ratio = lambda / yield;
        ramp = 1.0 - 1.0 / (ratio * ratio);
        z = ramp * (2.0 * (a * a / (2.0 * radius * h)) - 1.0);
        growth = z / log(ratio);
        z = z > 0.0 ? z : 0.0;
        growth = growth > 0.0 ? growth : 0.0;
    }
    power = ASPERITY_EXPONENT_2 * exp(-ASPERITY_EXPONENT_4 * friction);
    size = exp(ASPERITY_EXPONENT_5 * friction * growth - ASPERITY_EXPONENT_3 * (a / radius));
    n = 1.5
        + ASPERITY_EXPONENT_SPAN * tanh(ASPERITY_EXPONENT_0 * asperity_product(ASPERITY_EXPONENT_1, power, friction, z) * size / ASPERITY_EXPONENT_SPAN);
    size = exp(ASPERITY_FALL_4 * friction * growth - ASPERITY_FALL_5 * (a / radius));
    share = 1.0
        - tanh(ASPERITY_FALL_0 * friction) * tanh(ASPERITY_FALL_1 * asperity_product(ASPERITY_FALL_2, ASPERITY_FALL_3, friction, z) * size);
    body = 1.0 + ASPERITY_SLIP_0 * (a / radius);
    factor = n / 1.5 * share * (body + ASPERITY_SLIP_1 * pow(z, ASPERITY_SLIP_3));
    steep = 1.0 + ASPERITY_CURVE_0 + ASPERITY_CURVE_1 * (n - 1.5);
    mindlin = 8.0 * (0.5 * m->youngs_modulus / (1.0 + m->poissons_ratio)) * a / (2.0 - m->poissons_ratio);
    row[0] = log(f_n);
    row[1] = log(a);
    row[2] = share * f_n / f_n;
    row[2] = row[2] < 1.0 ? row[2] : 1.0;
    row[3] = log(factor * (1.5 * friction * f_n / mindlin));
    row[4] = n;
    row[5] = 1.0;
    row[6] = steep;
    row[7] = log(mindlin / body);
}

@CONTACT_CONSERVE@/* Which quantities lie outside of what the law was fitted to, at the indentation h > 0: a sum of 1 Lambda, 2 mu, 4 a/R, 8 c^2, 16 nu,
 * 32 hardening exponent at the representative strain. */
static inline int asperity_outside(const asperity_material *m, double radius, double friction, double h) {
    double a, f_n, lambda, yield = asperity_yield_lambda(m->poissons_ratio), c_squared, exponent, from;
    int outside = 0;
    asperity_normal(m, radius, friction, h, &a, &f_n);
    lambda = asperity_lambda(m, radius, a);
    if (a / radius > ASPERITY_RADIUS_TO * 1.02) {
        outside |= 4;
    }
    if (lambda <= yield) {
        return outside;
    }
    from = ASPERITY_LAMBDA_FROM < yield ? ASPERITY_LAMBDA_FROM : yield;
    if (lambda < 0.98 * from || lambda > ASPERITY_LAMBDA_TO * 1.02) {
        outside |= 1;
    }
    if (friction > ASPERITY_FRICTION_TO * 1.02) {
        outside |= 2;
    }
    if (a / radius < 0.98 * ASPERITY_RADIUS_FROM) {
        outside |= 4;
    }
    c_squared = a * a / (2.0 * radius * h);
    from = ASPERITY_AREA_FROM < 0.5 ? ASPERITY_AREA_FROM : 0.5;
    if (c_squared < 0.98 * from || c_squared > ASPERITY_AREA_TO * 1.02) {
        outside |= 8;
    }
    if (m->poissons_ratio < 0.98 * ASPERITY_NU_FROM || m->poissons_ratio > ASPERITY_NU_TO * 1.02) {
        outside |= 16;
    }
    exponent = asperity_hardening_exponent(m, radius, a);
    if (exponent < 0.98 * ASPERITY_HARDENING_FROM || exponent > ASPERITY_HARDENING_TO * 1.02) {
        outside |= 32;
    }
    return outside;
}

/* The table of the material `m` with Coulomb friction `friction` >= 0. Returns 0, or nonzero if a number is out of its range: then `t` is not to be used. */
static inline int asperity_setup(asperity_table *t, const asperity_material *m, double friction) {
    static const int place[ASPERITY_COLUMNS] = {0, 1, 4, 2, 5, 6, 7, 3};
    double first = 1e-6, log_modulus, a, h;
    asperity_draft draft, *p = &draft;
    int i, j;
    if (!(m->youngs_modulus > 0.0 && m->poissons_ratio >= 0.0 && m->poissons_ratio <= 0.5 && friction >= 0.0)
        || (m->hardening == ASPERITY_TABLE && (m->point_count < 1 || !m->points)) || m->hardening < 0 || m->hardening > ASPERITY_TABLE) {
        return 1;
    }
    if (m->hardening != ASPERITY_ELASTIC) {
        if (!(asperity_flow_stress(m, 0.0) > 0.0)) {
            return 2;
        }
        a = asperity_yield_lambda(m->poissons_ratio) * asperity_flow_stress(m, 0.0) / asperity_effective_modulus(m);
        h = 0.98 * a * a;
        first = h < first ? h : first;
    }
    p->radius = 1.0;
    p->effective_modulus = asperity_effective_modulus(m);
    p->log_first = log(first);
    p->log_step = (log(@LAST@) - p->log_first) / (ASPERITY_KNOTS - 1.0);
    for (i = 0; i < ASPERITY_KNOTS; i++) {
        asperity_table_row(m, 1.0, friction, exp(p->log_first + p->log_step * i), p->table[i]);
        for (j = 0; j < ASPERITY_COLUMNS; j++) {
            if (!(fabs(p->table[i][j]) < HUGE_VAL)) {
                return 3;
            }
        }
    }
    asperity_conserve(p);
    memset(t, 0, sizeof *t);
    t->plane = 1;
    t->form = 1;
    t->share = ASPERITY_R(1.0);
    t->poissons_ratio = ASPERITY_R(m->poissons_ratio);
    t->friction = ASPERITY_R(friction);
    t->effective_modulus = ASPERITY_R(p->effective_modulus / m->youngs_modulus);
    t->effective_radius = ASPERITY_R(1.0);
    t->first = ASPERITY_R(exp(p->log_first));
    t->log_step = ASPERITY_R(p->log_step);
    t->gentle = ASPERITY_R(1.0 + ASPERITY_CURVE_2 * pow(friction > 0.0 ? friction : 1e-6, ASPERITY_CURVE_3));
    log_modulus = log(m->youngs_modulus);
    for (i = 0; i < ASPERITY_KNOTS; i++) {
        h = exp(p->log_first + p->log_step * i);
        if (asperity_outside(m, 1.0, friction, h) == 0) {
            t->deepest = ASPERITY_R(h);
        }
        for (j = 0; j < ASPERITY_COLUMNS; j++) {
            /* The update needs 1/a and 1/delta_T_end, and first what has a logarithm in the table. */
            double sign = j == 1 || j == 3 ? -1.0 : 1.0, value = p->table[i][j], slope = asperity_knot_slope(p, j, i);
            int k = place[j];
            double start = sign * (value - (j == 0 || j == 7 ? log_modulus : 0.0));
            t->knots[i][0][k] = ASPERITY_R(k < 4 ? exp(start) : start);
            t->knots[i][1][k] = ASPERITY_R(sign * slope);
            if (i + 1 < ASPERITY_KNOTS) {
                double rise = p->table[i + 1][j] - value, next = asperity_knot_slope(p, j, i + 1);
                t->knots[i][2][k] = ASPERITY_R(sign * (3.0 * rise - 2.0 * slope - next));
                t->knots[i][3][k] = ASPERITY_R(sign * (slope + next - 2.0 * rise));
            }
        }
    }
    return 0;
}

#endif
