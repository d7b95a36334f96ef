/* asperity_law.h: force-displacement law of an elastic-plastic sphere on a rigid plane, as an incremental contact update.
 *
 * Written by asperity @VERSION@ from @SOURCE@. C99 and C++17; needs the C mathematics library only.
 * No global data, no allocation, no failure at run time. Any one consistent system of units.
 *
 * Once a pair of materials:
 *     asperity_material steel = {200e3, 0.3, ASPERITY_IDEAL, {400.0, 0.0, 0.0}, 0, 0};
 *     asperity_parameters pair;
 *     if (asperity_setup(&pair, &steel, R, mu) != 0) ...           nonzero: a number is missing or out of range
 *
 * A contact's memory is one asperity_state: all bytes zero before first contact; memcpy it, write it to a restart file as it is.
 *
 * Each step, as in LIGGGHTS' surfacesIntersect or YADE's Law2::go, for two equal spheres, of which each takes half of the overlap and half of the
 * relative displacement, and both carry the same force. That is exact without friction only: nothing slips between equal spheres that are pressed, but a
 * rigid plane, for which the law is, holds the surface by friction (F_N 3 % and a 5 % lower at mu = 0.3, h = 0.02 R, E/sigma_Y = 500), and the elastic
 * shear compliance is 4 to 25 % larger on it:
 *     double h = 0.5 * (r_i + r_j - distance);                     negative: a gap; keep calling while the state is kept
 *     double d[2] = {0.5 * dot(v_t, e1) * dt, 0.5 * dot(v_t, e2) * dt};    v_t: tangential velocity of i relative to j there
 *     asperity_rotate(&state, cos(spin), sin(spin));               if e1, e2 have turned about the normal, by spin
 *     asperity_update(&pair, &state, h, d, &state, &out);
 *     force_on_i = out.f_n * n - out.f_t[0] * e1 - out.f_t[1] * e2;         n from j to i; force_on_j is the opposite
 * For a sphere on a wall h is the whole overlap and d the whole displacement.
 *
 * f_t points along the displacement: it is what drives the sphere. Stiffnesses are those for h and d as passed in. Exchanging the
 * particles turns the sign of d and of f_t; turning the axes turns both.
 *
 * The law: on first loading at constant h, with x = |delta_T|/delta_T_slip,
 *     F_T = mu F_N_slip [1 - (1 - x)^n],     F_N = F_N0 - (F_N0 - F_N_slip) f_N(x).
 * Inside that curve the contact is elastic with friction: @SLIDERS@ sliders in parallel (Iwan 1967; a discrete Cattaneo-Mindlin contact,
 * which obeys Masing's rule on reversal). On it plastic flow follows the law in x; F_N lost to shear returns only by pressing on, which in
 * turn takes F_T. Unloading in h is elastic from 2 E* a on and ends at the residual dent. No path returns more energy than
 * asperity_stored_energy had. Contacts whose law is elastic have F_T to 0.3 % of mu F_N.
 *
 * @FITTED@:
 * asperity_out_of_range tells.
 */
#ifndef ASPERITY_LAW_H
#define ASPERITY_LAW_H

#include <math.h>
#include <stdint.h>
#include <string.h>
#ifdef __cplusplus
extern "C" {
#endif

/* Forms of the law and their constants. */
#define ASPERITY_VARIABLE @VARIABLE@     /* z: 0 ln(Lambda/Lambda_Y), 1 ln(1 + mu (Lambda - Lambda_Y)), 2 stiffness, 3 area */
#define ASPERITY_SLIP_FORM @SLIP_FORM@    /* 0 direct, 1 through the initial stiffness */
#define ASPERITY_NORMAL_CURVE @NORMAL_CURVE@ /* f_N: 0 [1 - (1 - x)^M]^N, 1 1 - (1 - x^M)^N; 2 a table of one material, f_T and f_N by numbers */
#define ASPERITY_NORMAL_FORM @NORMAL_FORM@  /* F_N0(h), a(h): 0 Olsson & Larsson 2016, 1 the same corrected, 2 smooth curves */
@CONSTANTS@
#define ASPERITY_PI 3.141592653589793
#define ASPERITY_KNOTS @KNOTS@
#define ASPERITY_COLUMNS @COLUMNS@
#define ASPERITY_SLIDERS @SLIDERS@
#define ASPERITY_POINTS @POINTS@ /* of a shape that is given by numbers, x = (j/points)^2 */
#define ASPERITY_LEVELS @LEVELS@

/* Hardening laws: the stresses and numbers of asperity_material.hardening_numbers. */
enum {
    ASPERITY_ELASTIC = 0,
    ASPERITY_IDEAL = 1,    /* yield stress */
    ASPERITY_LINEAR = 2,   /* yield stress, modulus: sigma_Y + H alpha */
    ASPERITY_POWER = 3,    /* yield stress, coefficient, exponent: sigma_Y + K alpha^n */
    ASPERITY_HOLLOMON = 4, /* coefficient, exponent: sigma_0 eps^(1/m), eps the total strain */
    ASPERITY_VOCE = 5,     /* yield stress, saturation stress, rate */
    ASPERITY_TABLE = 6     /* none; pairs of plastic strain and stress in `points` */
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

/* A pair of materials, shared by its contacts. */
typedef struct asperity_parameters {
    double radius;
    double effective_modulus; /* E* = E/(1 - nu^2) */
    double friction;          /* mu */
    double log_first;         /* ln h of the first knot */
    double log_step;
    /* ln F_N0, ln a, F_N_slip/F_N0, ln delta_T_slip, n, M, N, ln k_T */
    double table[ASPERITY_KNOTS][ASPERITY_COLUMNS];
#if ASPERITY_NORMAL_CURVE == 2
    double shapes[ASPERITY_LEVELS][2][ASPERITY_POINTS]; /* f_T and f_N, levels equidistant in ln h */
#endif
} asperity_parameters;

/* The memory of a contact. */
typedef struct asperity_state {
    double h;
    double h_max;
    double approach; /* elastic approach: what is recovered until contact is lost; negative: the gap over the residual dent */
    double x;        /* place on the virgin curves: the measure of F_N lost to shear */
    double deflection[ASPERITY_SLIDERS][2];
} asperity_state;

/* The answer of an increment. */
typedef struct asperity_response {
    double f_n;              /* compression positive */
    double f_t[2];           /* along the displacement */
    double df_t_ddelta[2][2];
    double df_n_dh;          /* for the direction in which h last moved */
    double df_n_ddelta[2];
    double a;                /* contact radius */
} asperity_response;

/* 3/2 for Hertz, 4/pi for a uniform pressure (Mesarovic & Johnson 2000), by how far the force has fallen below Hertz's at that radius. */
static inline double asperity_unloading_exponent(double radius, double effective_modulus, double a, double f_n0) {
    double hertz = 4.0 * effective_modulus * a * a * a / (3.0 * radius);
    double share = f_n0 < hertz ? f_n0 / hertz : 1.0;
    return 1.2732395447351628 + (1.5 - 1.2732395447351628) * share;
}

#if ASPERITY_NORMAL_CURVE != 2
/* ---- set-up: the material, the normal model, the law ---- */

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

/* c^2 (Olsson & Larsson 2016); `plastic` is its end. */
static inline double asperity_c_squared(double lambda, double plastic) {
    double span = log(1527.0 / 4.005), x, slope, growth, value;
    x = log(lambda / 4.005) / span;
    x = x < 0.0 ? 0.0 : x > 1.0 ? 1.0 : x;
    slope = 0.191 * span;
    growth = plastic - 0.5;
    value = 0.5 + x * (slope + x * ((3.0 * growth - 2.0 * slope) - x * (2.0 * growth - slope)));
    return value < plastic ? value : plastic;
}

/* Olsson & Larsson's contact radius. */
static inline double asperity_published_radius(const asperity_material *m, double radius, double h) {
    double reach = 2.0 * radius * h, low = sqrt(0.5 * reach), high = sqrt(1.43 * reach), a;
    int i;
    for (i = 0; i < 200; i++) {
        a = 0.5 * (low + high);
        if (a <= low || a >= high) {
            break;
        }
        if (a * a - asperity_c_squared(asperity_lambda(m, radius, a), 1.43 * exp(-0.97 * asperity_hardening_exponent(m, radius, a))) * reach
            < 0.0) {
            low = a;
        } else {
            high = a;
        }
    }
    return 0.5 * (low + high);
}

/* Olsson & Larsson's force. */
static inline double asperity_published_force(const asperity_material *m, double radius, double a) {
    double stress = asperity_representative_stress(m, radius, a), lambda = asperity_lambda(m, radius, a);
    double maximum = asperity_hardening_exponent(m, radius, a) > 0.2 ? 2.8 : 3.0;
    double q = log(a / radius / 0.041), factor = 1.0, below, hardness;
    if (q > 0.0) {
        factor = 1.0 - 0.0460789 * pow(q, 2.2139);
        factor = factor > 0.0 ? factor : 0.0;
    }
    hardness = 4.0 * lambda / (3.0 * ASPERITY_PI);
    if (lambda >= 2.0) {
        below = log(160.0 / lambda);
        below = below > 0.0 ? below : 0.0;
        below = factor * (maximum - 0.0965 * below * below);
        hardness = hardness < below ? hardness : below;
    }
    return hardness * ASPERITY_PI * a * a * stress;
}

/* a and F_N0 at the indentation h > 0; Hertz below first yield. */
static inline void asperity_normal(const asperity_material *m, double radius, double h, double *a, double *f_n) {
    double hertz = sqrt(radius * h);
    double force = 4.0 / 3.0 * asperity_effective_modulus(m) * sqrt(radius) * pow(h, 1.5);
    double yield = asperity_yield_lambda(m->poissons_ratio), published, ratio, ramp, hardening;
    *a = hertz;
    *f_n = force;
    if (asperity_lambda(m, radius, hertz) <= yield) {
        return;
    }
    if (ASPERITY_NORMAL_FORM == 2) {
        double growth, c_squared, plastic, size;
        ratio = asperity_lambda(m, radius, hertz) / yield;
        ratio = ratio > 1.0 ? ratio : 1.0;
        ramp = 1.0 - 1.0 / ratio;
        hardening = asperity_hardening_exponent(m, radius, hertz);
        growth = 1.43 * exp(-ASPERITY_NORMAL_RADIUS_0 * hardening) - 0.5;
        c_squared = 0.5 + growth * (1.0 - exp(-pow(ASPERITY_NORMAL_RADIUS_1 * log(ratio), ASPERITY_NORMAL_RADIUS_2)));
        *a = hertz * sqrt(2.0 * c_squared * exp(ASPERITY_NORMAL_RADIUS_3 * ramp * hertz / radius));
        plastic = pow(ASPERITY_NORMAL_FORCE_0 * pow(ratio - 1.0, ASPERITY_NORMAL_FORCE_1), ASPERITY_NORMAL_FORCE_2);
        size = (ASPERITY_NORMAL_FORCE_3 - ASPERITY_NORMAL_FORCE_4 * log(ratio)) * hertz / radius;
        *f_n = force * pow(1.0 + plastic, -1.0 / ASPERITY_NORMAL_FORCE_2) * exp(ramp * (size - ASPERITY_NORMAL_FORCE_5 * hardening));
        return;
    }
    published = asperity_published_radius(m, radius, h);
    *a = published;
    *f_n = asperity_published_force(m, radius, published);
    if (ASPERITY_NORMAL_FORM == 1) {
        ratio = asperity_lambda(m, radius, published) / yield;
        ratio = ratio > 1.0 ? ratio : 1.0;
        ramp = 1.0 - 1.0 / ratio;
        hardening = asperity_hardening_exponent(m, radius, published);
        *a = published * exp(ramp * (ASPERITY_NORMAL_RADIUS_0 + ASPERITY_NORMAL_RADIUS_1 * log(ratio)));
        *f_n *= exp(ramp
                    * (ASPERITY_NORMAL_FORCE_0 + ASPERITY_NORMAL_FORCE_1 * *a / radius + ASPERITY_NORMAL_FORCE_2 * hardening
                       + ASPERITY_NORMAL_FORCE_3 * log(ratio)));
    }
}

/* mu^p z^q. */
static inline double asperity_product(double p, double q, double friction, double z) {
    if (z <= 0.0) {
        return 0.0;
    }
    return (ASPERITY_VARIABLE == 1 ? 1.0 : pow(friction, p)) * pow(z, q);
}

/* A row of the table: the law at the indentation h. */
static inline void asperity_row(const asperity_material *m, double radius, double friction, double h, double row[ASPERITY_COLUMNS]) {
    double a, f_n, stress, lambda, yield, ratio, ramp, z = 0.0, growth = 0.0, n, power, size, share, body, factor, steep, gentle, mindlin;
    asperity_normal(m, radius, h, &a, &f_n);
    stress = asperity_representative_stress(m, radius, a);
    lambda = asperity_effective_modulus(m) * a / (stress * radius);
    yield = asperity_yield_lambda(m->poissons_ratio);
    if (lambda > yield) {
        ratio = lambda / yield;
        ramp = 1.0 - 1.0 / (ratio * ratio);
        if (ASPERITY_VARIABLE == 0) {
            z = log(ratio);
        } else if (ASPERITY_VARIABLE == 1) {
            z = log1p(friction * (lambda - yield));
        } else if (ASPERITY_VARIABLE == 2) {
            z = ramp * log(4.0 * lambda / (3.0 * ASPERITY_PI * (f_n / (ASPERITY_PI * a * a * stress))));
        } else {
            z = ramp * (2.0 * (a * a / (2.0 * radius * h)) - 1.0);
        }
        z = z > 0.0 ? z : 0.0;
        growth = ramp * (2.0 * (a * a / (2.0 * radius * h)) - 1.0) / log(ratio);
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
    if (ASPERITY_SLIP_FORM == 0) {
        factor = body + ASPERITY_SLIP_1 * asperity_product(ASPERITY_SLIP_2, ASPERITY_SLIP_3, friction, z);
    } else {
        factor = n / 1.5 * share * (body + ASPERITY_SLIP_1 * pow(z, ASPERITY_SLIP_3));
    }
    steep = 1.0 + ASPERITY_CURVE_0 + ASPERITY_CURVE_1 * (n - 1.5);
    gentle = 1.0 + ASPERITY_CURVE_2 * pow(friction, ASPERITY_CURVE_3);
    mindlin = 8.0 * (0.5 * m->youngs_modulus / (1.0 + m->poissons_ratio)) * a / (2.0 - m->poissons_ratio);
    row[0] = log(f_n);
    row[1] = log(a);
    row[2] = share * f_n / f_n;
    row[2] = row[2] < 1.0 ? row[2] : 1.0;
    row[3] = log(factor * (1.5 * friction * f_n / mindlin));
    row[4] = n;
    row[5] = ASPERITY_NORMAL_CURVE == 0 ? steep : gentle;
    row[6] = ASPERITY_NORMAL_CURVE == 0 ? gentle : steep;
    row[7] = log(mindlin / body);
}

/* Elastic energy of the virgin contact at a knot. */
static inline double asperity_stored_at(const asperity_parameters *p, int i) {
    double f_n0 = exp(p->table[i][0]), a = exp(p->table[i][1]);
    double gamma = asperity_unloading_exponent(p->radius, p->effective_modulus, a, f_n0);
    return gamma / (gamma + 1.0) * f_n0 * f_n0 / (2.0 * p->effective_modulus * a);
}

/* Widens the contact where F_N0 and a would let a press store more energy than was put in, or the
 * dent rise above where the sphere began. */
static inline void asperity_conserve(asperity_parameters *p) {
    double before = asperity_stored_at(p, 0), h0, h1, power, most, stored, f_n0, a, depth;
    int i;
    for (i = 1; i < ASPERITY_KNOTS; i++) {
        h0 = exp(p->log_first + p->log_step * (i - 1));
        h1 = exp(p->log_first + p->log_step * i);
        power = (p->table[i][0] - p->table[i - 1][0]) / p->log_step;
        most = before + (exp(p->table[i][0]) * h1 - exp(p->table[i - 1][0]) * h0) / (power + 1.0);
        stored = asperity_stored_at(p, i);
        if (stored > most) {
            p->table[i][1] += log(stored / most);
        }
        f_n0 = exp(p->table[i][0]);
        a = exp(p->table[i][1]);
        depth = asperity_unloading_exponent(p->radius, p->effective_modulus, a, f_n0) * f_n0 / (2.0 * p->effective_modulus * a);
        if (depth > h1) {
            p->table[i][1] += log(depth / h1);
        }
        before = asperity_stored_at(p, i);
    }
}

/* The parameters of a sphere of the material `m` and the radius `radius` with Coulomb friction `friction` >= 0. Returns 0, or nonzero if
 * a number is out of its range: then `p` is not to be used. */
static inline int asperity_setup(asperity_parameters *p, const asperity_material *m, double radius, double friction) {
    double first = 1e-6 * radius, a, h;
    int i, j;
    if (!(m->youngs_modulus > 0.0 && m->poissons_ratio >= 0.0 && m->poissons_ratio <= 0.5 && radius > 0.0 && friction >= 0.0)
        || (m->hardening == ASPERITY_TABLE && (m->point_count < 1 || !m->points)) || m->hardening < 0 || m->hardening > ASPERITY_TABLE) {
        return 1;
    }
    if (m->hardening != ASPERITY_ELASTIC) {
        if (!(asperity_flow_stress(m, 0.0) > 0.0)) {
            return 2;
        }
        a = asperity_yield_lambda(m->poissons_ratio) * asperity_flow_stress(m, 0.0) * radius / asperity_effective_modulus(m);
        h = 0.98 * a * a / radius;
        first = h < first ? h : first;
    }
    p->radius = radius;
    p->effective_modulus = asperity_effective_modulus(m);
    p->friction = friction;
    p->log_first = log(first);
    p->log_step = (log(0.1 * radius) - p->log_first) / (ASPERITY_KNOTS - 1.0);
    for (i = 0; i < ASPERITY_KNOTS; i++) {
        asperity_row(m, radius, friction > 0.0 ? friction : 1e-6, exp(p->log_first + p->log_step * i), p->table[i]);
        for (j = 0; j < ASPERITY_COLUMNS; j++) {
            if (!(fabs(p->table[i][j]) < HUGE_VAL)) {
                return 3;
            }
        }
    }
    asperity_conserve(p);
    return 0;
}

/* Which quantities lie outside of what the law was fitted to, at the indentation h > 0: a sum of 1 Lambda, 2 mu, 4 a/R, 8 c^2, 16 nu,
 * 32 hardening exponent at the representative strain. */
static inline int asperity_out_of_range(const asperity_material *m, double radius, double friction, double h) {
    double a, f_n, lambda, yield = asperity_yield_lambda(m->poissons_ratio), c_squared, exponent, from;
    int outside = 0;
    asperity_normal(m, radius, h, &a, &f_n);
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

#else
@TABLE@#endif

/* ---- virgin curves ---- */

/* First loading at one indentation. */
typedef struct asperity_virgin_curve {
    double f_n0, a, f_n_slip, delta_t_slip, k_t, n, m_exponent, n_exponent;
    double slope;    /* dF_N0/dh */
    double gamma;    /* elastic unloading: F_N = F_N0 eta^gamma */
    double depth;    /* elastic approach at F_N0 */
    double backbone; /* exponent of the sliders' backbone */
    double weight[ASPERITY_SLIDERS];
    double lost[ASPERITY_SLIDERS];
#if ASPERITY_NORMAL_CURVE == 2
    double shapes[2][ASPERITY_POINTS]; /* f_T and f_N */
#endif
} asperity_virgin_curve;

/* Slope of a column at a knot, per step. */
static inline double asperity_knot_slope(const asperity_parameters *p, int column, int i) {
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

/* A column of the table; its slope per step to *slope. */
static inline double asperity_column(const asperity_parameters *p, int column, double position, double *slope) {
    const double powers[ASPERITY_COLUMNS] = {1.5, 0.5, 0.0, 1.0, 0.0, 0.0, 0.0, 0.5};
    const int end = ASPERITY_KNOTS - 1;
    double u, y0, y1, s0, s1, rise, quadratic, cubic;
    int i;
    if (position < 0.0) {
        *slope = powers[column] * p->log_step;
        return p->table[0][column] + *slope * position;
    }
    if (position >= end) {
        *slope = powers[column] > 0.0 ? asperity_knot_slope(p, column, end) : 0.0;
        return p->table[end][column] + *slope * (position - end);
    }
    i = (int)position;
    u = position - i;
    y0 = p->table[i][column];
    y1 = p->table[i + 1][column];
    s0 = asperity_knot_slope(p, column, i);
    s1 = asperity_knot_slope(p, column, i + 1);
    rise = y1 - y0;
    quadratic = 3.0 * rise - 2.0 * s0 - s1;
    cubic = s0 + s1 - 2.0 * rise;
    *slope = s0 + u * (2.0 * quadratic + 3.0 * u * cubic);
    return y0 + u * (s0 + u * (quadratic + u * cubic));
}

/* Shares and points of loss of the sliders. */
static inline void asperity_sliders(double backbone, double weight[ASPERITY_SLIDERS], double lost[ASPERITY_SLIDERS]) {
    double below = 0.0, below_moment = 0.0, end, above, above_moment;
    int i;
    for (i = 0; i < ASPERITY_SLIDERS; i++) {
        end = (double)(i + 1) / ASPERITY_SLIDERS;
        end = end * sqrt(end);
        above = i == ASPERITY_SLIDERS - 1 ? 1.0 : pow(end, backbone - 1.0);
        above_moment = above * end;
        weight[i] = above - below;
        lost[i] = (backbone - 1.0) / backbone * (above_moment - below_moment) / weight[i];
        below = above;
        below_moment = above_moment;
    }
}

#if ASPERITY_NORMAL_CURVE == 2
/* f_T and f_N at a place between the levels; straight between them. */
static inline void asperity_shapes_at(const asperity_parameters *p, double position, double shapes[2][ASPERITY_POINTS]) {
    double level = position * (ASPERITY_LEVELS - 1.0) / (ASPERITY_KNOTS - 1.0), last = ASPERITY_LEVELS - 1, u;
    int i, j, kind;
    memcpy(shapes, p->shapes[0], sizeof p->shapes[0]);
    if (position <= 0.0) {
        return;
    }
    level = level < last ? level : last;
    i = (int)level < ASPERITY_LEVELS - 2 ? (int)level : ASPERITY_LEVELS - 2;
    u = level - i;
    for (kind = 0; kind < 2; kind++) {
        for (j = 0; j < ASPERITY_POINTS; j++) {
            double low = p->shapes[i][kind][j], high = p->shapes[i + 1][kind][j];
            shapes[kind][j] = low + u * (high - low);
        }
    }
}
#endif

/* First loading at the indentation h > 0. */
static inline void asperity_virgin(const asperity_parameters *p, double h, asperity_virgin_curve *v) {
    double position = (log(h) - p->log_first) / p->log_step, log_slope, unused, start, end;
    v->f_n0 = exp(asperity_column(p, 0, position, &log_slope));
    v->a = exp(asperity_column(p, 1, position, &unused));
    v->gamma = asperity_unloading_exponent(p->radius, p->effective_modulus, v->a, v->f_n0);
    v->f_n_slip = asperity_column(p, 2, position, &unused) * v->f_n0;
    v->delta_t_slip = exp(asperity_column(p, 3, position, &unused));
    v->n = asperity_column(p, 4, position, &unused);
    v->m_exponent = asperity_column(p, 5, position, &unused);
    v->n_exponent = asperity_column(p, 6, position, &unused);
    v->backbone = v->gamma < v->n ? v->gamma : v->n;
#if ASPERITY_NORMAL_CURVE == 2
    v->backbone = v->n_exponent;
    asperity_shapes_at(p, position, v->shapes);
#endif
    v->k_t = exp(asperity_column(p, 7, position, &unused));
    start = v->n * p->friction * v->f_n_slip / v->delta_t_slip;
    end = v->backbone * p->friction * v->f_n0 / v->delta_t_slip;
    if (v->k_t < start) {
        v->k_t = start;
    }
    if (v->k_t < end) {
        v->k_t = end;
    }
    asperity_sliders(v->backbone, v->weight, v->lost);
    v->slope = v->f_n0 * log_slope / (p->log_step * h);
    v->depth = v->gamma * v->f_n0 / (2.0 * p->effective_modulus * v->a);
#if ASPERITY_NORMAL_CURVE == 2
    v->a = v->m_exponent * v->a;
#endif
}

/* ---- update ---- */

#if ASPERITY_NORMAL_CURVE == 2
/* x at point j of a shape that is given by numbers. */
static inline double asperity_point_x(int j) {
    double share = (double)j / ASPERITY_POINTS;
    return share * share;
}

/* A shape that is given by numbers and its derivative, straight from point to point. */
static inline double asperity_given(const double shape[ASPERITY_POINTS], double x, double *derivative) {
    double below;
    int j;
    *derivative = 0.0;
    if (x >= 1.0) {
        return shape[ASPERITY_POINTS - 1];
    }
    j = (int)(ASPERITY_POINTS * sqrt(x));
    if (j > ASPERITY_POINTS - 1) {
        j = ASPERITY_POINTS - 1;
    }
    below = j == 0 ? 0.0 : shape[j - 1];
    *derivative = (shape[j] - below) / (asperity_point_x(j + 1) - asperity_point_x(j));
    return below + *derivative * (x - asperity_point_x(j));
}

/* The least x at which it has the value f, or that of its peak. */
static inline double asperity_given_inverse(const double shape[ASPERITY_POINTS], double f) {
    double below = 0.0, peak = 0.0, place = 0.0;
    int j;
    if (f <= 0.0) {
        return 0.0;
    }
    for (j = 0; j < ASPERITY_POINTS; j++) {
        if (shape[j] >= f) {
            return asperity_point_x(j) + (f - below) / (shape[j] - below) * (asperity_point_x(j + 1) - asperity_point_x(j));
        }
        below = shape[j];
        if (below > peak) {
            peak = below;
            place = asperity_point_x(j + 1);
        }
    }
    return place;
}

static inline double asperity_tangential_shape(const asperity_virgin_curve *v, double x, double *derivative) {
    return asperity_given(v->shapes[0], x, derivative);
}

static inline double asperity_tangential_shape_inverse(const asperity_virgin_curve *v, double f) {
    return asperity_given_inverse(v->shapes[0], f);
}

static inline double asperity_normal_shape(const asperity_virgin_curve *v, double x, double *derivative) {
    *derivative = 0.0;
    if (x <= 0.0) {
        return 0.0;
    }
    return x >= 1.0 ? 1.0 : asperity_given(v->shapes[1], x, derivative);
}

static inline double asperity_normal_shape_inverse(const asperity_virgin_curve *v, double f) {
    return f <= 0.0 ? 0.0 : f >= 1.0 ? 1.0 : asperity_given_inverse(v->shapes[1], f);
}
#else
/* f_T(x) and its derivative. */
static inline double asperity_tangential_shape(const asperity_virgin_curve *v, double x, double *derivative) {
    double rest = 1.0 - x, power;
    *derivative = 0.0;
    if (rest <= 0.0) {
        return 1.0;
    }
    power = pow(rest, v->n - 1.0);
    *derivative = v->n * power;
    return 1.0 - power * rest;
}

/* The x at which f_T has the value f. */
static inline double asperity_tangential_shape_inverse(const asperity_virgin_curve *v, double f) {
    return f >= 1.0 ? 1.0 : 1.0 - pow(1.0 - f, 1.0 / v->n);
}

/* f_N(x) and its derivative, 0 at both ends. */
static inline double asperity_normal_shape(const asperity_virgin_curve *v, double x, double *derivative) {
    double m = v->m_exponent, n = v->n_exponent, rest, risen, power;
    *derivative = 0.0;
    if (x <= 0.0) {
        return 0.0;
    }
    if (x >= 1.0) {
        return 1.0;
    }
    if (ASPERITY_NORMAL_CURVE == 0) {
        rest = pow(1.0 - x, m);
        risen = 1.0 - rest;
        power = pow(risen, n - 1.0);
        *derivative = n * power * m * rest / (1.0 - x);
        return power * risen;
    }
    risen = pow(x, m);
    rest = 1.0 - risen;
    power = pow(rest, n - 1.0);
    *derivative = n * power * m * risen / x;
    return 1.0 - power * rest;
}

/* The x at which f_N has the value f. */
static inline double asperity_normal_shape_inverse(const asperity_virgin_curve *v, double f) {
    if (f <= 0.0) {
        return 0.0;
    }
    if (f >= 1.0) {
        return 1.0;
    }
    if (ASPERITY_NORMAL_CURVE == 0) {
        return 1.0 - pow(1.0 - pow(f, 1.0 / v->n_exponent), 1.0 / v->m_exponent);
    }
    return pow(1.0 - pow(1.0 - f, 1.0 / v->n_exponent), 1.0 / v->m_exponent);
}

#endif

/* F_N on the virgin curve at x. */
static inline double asperity_normal_cap(const asperity_virgin_curve *v, double x) {
    double unused;
    return v->f_n0 - (v->f_n0 - v->f_n_slip) * asperity_normal_shape(v, x, &unused);
}

/* Whether shear costs no normal force. */
static inline int asperity_is_elastic(const asperity_virgin_curve *v) {
    return v->f_n_slip >= (1.0 - 1e-6) * v->f_n0;
}

/* The x of the virgin curve that has the normal force f_n. */
static inline double asperity_mobilisation(const asperity_virgin_curve *v, double f_n) {
    if (f_n >= (1.0 - 1e-9) * v->f_n0) {
        return 0.0;
    }
    if (f_n <= v->f_n_slip) {
        return 1.0;
    }
    return asperity_normal_shape_inverse(v, (v->f_n0 - f_n) / (v->f_n0 - v->f_n_slip));
}

/* F_N at the elastic approach e. */
static inline double asperity_force_at(const asperity_virgin_curve *v, double e) {
    return e <= 0.0 ? 0.0 : v->f_n0 * pow(e / v->depth, v->gamma);
}

/* Its inverse. */
static inline double asperity_approach_at(const asperity_virgin_curve *v, double f_n) {
    return f_n >= v->f_n0 ? v->depth : v->depth * pow(f_n / v->f_n0, 1.0 / v->gamma);
}

/* Greatest deflection of each slider under the normal force f_n: their forces then add up to mu F_N. */
static inline void asperity_slider_limits(const asperity_parameters *p, const asperity_virgin_curve *v, double f_n, double limit[ASPERITY_SLIDERS]) {
    double eta, sum = 0.0, scale;
    int i;
    for (i = 0; i < ASPERITY_SLIDERS; i++) {
        limit[i] = 0.0;
    }
    if (f_n <= 0.0) {
        return;
    }
    eta = pow(f_n / v->f_n0, 1.0 / v->backbone);
    for (i = 0; i < ASPERITY_SLIDERS; i++) {
        limit[i] = eta > v->lost[i] ? eta - v->lost[i] : 0.0;
        if (i == 0 && limit[i] < 0.1 * eta) {
            limit[i] = 0.1 * eta; /* the innermost carries what little force there is */
        }
        sum += v->weight[i] * limit[i];
    }
    scale = p->friction * f_n / (v->k_t * sum);
    for (i = 0; i < ASPERITY_SLIDERS; i++) {
        limit[i] *= scale;
    }
}

/* Whether x is neither infinite nor NaN; from its bits, as compilers that are told to take every number for finite leave out isfinite. */
static inline int asperity_is_finite(double x) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return ((bits >> 52) & 0x7ff) != 0x7ff;
}

/* An increment in the same direction, of at most 1e150: far beyond full slip, and its square is still finite. */
static inline void asperity_bound(double *d0, double *d1) {
    double a = fabs(*d0), b = fabs(*d1), size = a > b ? a : b;
    if (size > 1e150) {
        *d0 = *d0 / size * 1e150;
        *d1 = *d1 / size * 1e150;
    }
}

/* Moves the sliders and holds each to its limit. */
static inline void asperity_slide(double deflection[ASPERITY_SLIDERS][2], const double limit[ASPERITY_SLIDERS], double d0, double d1) {
    double q0, q1, size, keep;
    int i;
    for (i = 0; i < ASPERITY_SLIDERS; i++) {
        q0 = deflection[i][0] + d0;
        q1 = deflection[i][1] + d1;
        size = sqrt(q0 * q0 + q1 * q1);
        keep = size > limit[i] ? limit[i] / size : 1.0;
        deflection[i][0] = keep * q0;
        deflection[i][1] = keep * q1;
    }
}

/* Tangential force of the sliders. */
static inline void asperity_slider_force(const asperity_virgin_curve *v, double deflection[ASPERITY_SLIDERS][2], double force[2]) {
    double sum0 = 0.0, sum1 = 0.0;
    int i;
    for (i = 0; i < ASPERITY_SLIDERS; i++) {
        sum0 += v->weight[i] * deflection[i][0];
        sum1 += v->weight[i] * deflection[i][1];
    }
    force[0] = v->k_t * sum0;
    force[1] = v->k_t * sum1;
}

/* Stiffness of the sliders after the increment: a slider at its limit only turns. */
static inline void asperity_slider_stiffness(
    const asperity_virgin_curve *v, double before[ASPERITY_SLIDERS][2], const double limit[ASPERITY_SLIDERS], double d0, double d1, double stiffness[2][2]) {
    double sum0 = 0.0, sum1 = 0.0, sum2 = 0.0, q0, q1, size, k, m0, m1;
    int i;
    for (i = 0; i < ASPERITY_SLIDERS; i++) {
        q0 = before[i][0] + d0;
        q1 = before[i][1] + d1;
        size = sqrt(q0 * q0 + q1 * q1);
        k = v->k_t * v->weight[i];
        if (size > (1.0 + 1e-10) * limit[i]) {
            k = k * limit[i] / size;
            m0 = q0 / size;
            m1 = q1 / size;
            sum0 += k * m1 * m1;
            sum1 -= k * m0 * m1;
            sum2 += k * m0 * m0;
        } else {
            sum0 += k;
            sum2 += k;
        }
    }
    stiffness[0][0] = sum0;
    stiffness[0][1] = sum1;
    stiffness[1][0] = sum1;
    stiffness[1][1] = sum2;
}

/* Multiplies all deflections. */
static inline void asperity_scale(double deflection[ASPERITY_SLIDERS][2], double keep) {
    int i;
    for (i = 0; i < ASPERITY_SLIDERS; i++) {
        deflection[i][0] = keep * deflection[i][0];
        deflection[i][1] = keep * deflection[i][1];
    }
}

/* Moves h with delta_T held: the normal force, x to *x, dF_N/dh to *df_n_dh. */
static inline double asperity_press(
    const asperity_parameters *p, asperity_state *s, const asperity_virgin_curve *v, double h, double *x, double *df_n_dh) {
    double dh = h - s->h, e = s->approach + dh, trial = v->f_n0, stiffness = v->slope, f_n, elastic, f_t, slip_force, bound, cap, share, soft, rate, flow, most, rises, falls, gain, along, slope, raised;
    double limit[ASPERITY_SLIDERS], force[2], derivative, keep;
    int grown = h > s->h_max, first = grown && (s->x == 0.0 || !(s->h_max > 0.0)), i;
    if (grown && s->h_max > 0.0) {
        asperity_virgin_curve old;
        asperity_virgin(p, s->h_max, &old);
        for (i = 0; i < ASPERITY_SLIDERS; i++) {
            keep = old.k_t * old.weight[i] / (v->k_t * v->weight[i]);
            if (keep < 1.0) {
                s->deflection[i][0] = keep * s->deflection[i][0];
                s->deflection[i][1] = keep * s->deflection[i][1];
            }
        }
        if (!first) {
            trial = asperity_force_at(&old, e);
            stiffness = e > 0.0 ? old.gamma * trial / e : 0.0;
        }
    } else if (!grown) {
        trial = asperity_force_at(v, e);
        stiffness = e > 0.0 ? v->gamma * trial / e : 0.0;
    }
    f_n = trial < v->f_n0 ? trial : v->f_n0;
    if (dh == 0.0) {
        *x = s->x;
        *df_n_dh = s->x == 0.0 && s->h == s->h_max ? v->slope : stiffness;
        return f_n;
    }
    elastic = asperity_mobilisation(v, f_n);
    if (dh < 0.0) {
        *x = elastic > s->x ? elastic : s->x;
        *df_n_dh = stiffness;
        return f_n;
    }
    if (trial >= v->f_n0 && grown) {
        stiffness = v->slope;
    }
    asperity_slider_limits(p, v, f_n, limit);
    asperity_slide(s->deflection, limit, 0.0, 0.0);
    asperity_slider_force(v, s->deflection, force);
    f_t = sqrt(force[0] * force[0] + force[1] * force[1]);
    slip_force = p->friction * v->f_n_slip;
    *x = elastic;
    *df_n_dh = stiffness;
    if (f_t <= slip_force * asperity_tangential_shape(v, elastic, &derivative) || asperity_is_elastic(v)) {
        return f_n;
    }
    bound = asperity_tangential_shape_inverse(v, f_t / slip_force);
    cap = asperity_normal_cap(v, bound);
    share = f_t < slip_force ? f_t / slip_force : 1.0;
    soft = 1.0 - v->slope * v->depth / (v->gamma * v->f_n0);
    soft = soft > 0.0 ? soft * soft : 0.0;
    rate = 2.6 * (soft * soft) * (1.0 - 0.5 * (share * share));
    flow = trial > cap ? rate * (trial - cap) / v->f_n0 : 0.0;
    most = slip_force * asperity_tangential_shape(v, bound, &derivative);
    keep = exp(-flow) * (most < f_t ? most / f_t : 1.0);
    *x = asperity_tangential_shape_inverse(v, keep * f_t / slip_force);
    raised = asperity_normal_cap(v, *x);
    asperity_tangential_shape(v, *x, &derivative);
    rises = slip_force * derivative;
    asperity_normal_shape(v, *x, &derivative);
    falls = (v->f_n0 - v->f_n_slip) * derivative;
    gain = rises > 0.0 ? falls * keep * f_t / (v->f_n0 * rises) : 0.0;
    along = v->slope * (raised / v->f_n0 + gain);
    slope = along + rate * gain * (stiffness - along);
    *df_n_dh = raised < f_n && slope < stiffness ? slope : stiffness;
    f_n = raised < f_n ? raised : f_n;
    asperity_scale(s->deflection, keep);
    return f_n;
}

/* Moves delta_T with h held. */
static inline void asperity_shear(
    const asperity_parameters *p, asperity_state *s, asperity_response *out, const asperity_virgin_curve *v, double f_n, double d0, double d1) {
    double before[ASPERITY_SLIDERS][2], force_before[2], limit[ASPERITY_SLIDERS], held[2], stiffness[2][2], direction[2], m[2];
    double slip_force, bound, trial, along, excess, travel, beyond, forward, x, cap, shape_slope, normal_slope, size, per_x, loss, keep, rate, radial;
    int i, j;
    for (i = 0; i < ASPERITY_SLIDERS; i++) {
        before[i][0] = s->deflection[i][0];
        before[i][1] = s->deflection[i][1];
    }
    asperity_slider_force(v, before, force_before);
    asperity_slider_limits(p, v, f_n, limit);
    asperity_slide(s->deflection, limit, d0, d1);
    out->f_n = f_n;
    asperity_slider_force(v, s->deflection, out->f_t);
    asperity_slider_stiffness(v, before, limit, d0, d1, out->df_t_ddelta);
    slip_force = p->friction * v->f_n_slip;
    bound = slip_force * asperity_tangential_shape(v, s->x, &shape_slope);
    trial = sqrt(out->f_t[0] * out->f_t[0] + out->f_t[1] * out->f_t[1]);
    if (s->x >= 1.0 || trial <= (1.0 + 1e-10) * bound || asperity_is_elastic(v)) {
        return;
    }
    direction[0] = out->f_t[0] / trial;
    direction[1] = out->f_t[1] / trial;
    along = direction[0] * force_before[0] + direction[1] * force_before[1];
    excess = trial - bound;
    travel = trial - along;
    beyond = excess < travel ? excess / travel : 1.0;
    forward = direction[0] * d0 + direction[1] * d1;
    forward = forward > 0.0 ? forward : 0.0;
    x = s->x + beyond * forward / v->delta_t_slip;
    s->x = x < 1.0 ? x : 1.0;
    cap = asperity_normal_cap(v, s->x);
    out->f_n = cap < f_n ? cap : f_n;
    s->approach = asperity_approach_at(v, out->f_n);
    asperity_slider_limits(p, v, out->f_n, limit);
    for (i = 0; i < ASPERITY_SLIDERS; i++) {
        s->deflection[i][0] = before[i][0];
        s->deflection[i][1] = before[i][1];
    }
    asperity_slide(s->deflection, limit, d0, d1);
    asperity_slider_force(v, s->deflection, held);
    asperity_slider_stiffness(v, before, limit, d0, d1, stiffness);
    bound = slip_force * asperity_tangential_shape(v, s->x, &shape_slope);
    size = sqrt(held[0] * held[0] + held[1] * held[1]);
    per_x = beyond / v->delta_t_slip;
    asperity_normal_shape(v, s->x, &normal_slope);
    loss = (v->f_n0 - v->f_n_slip) * normal_slope;
    for (i = 0; i < 2; i++) {
        out->f_t[i] = held[i];
        out->df_n_ddelta[i] = -loss * per_x * direction[i];
        for (j = 0; j < 2; j++) {
            out->df_t_ddelta[i][j] = stiffness[i][j];
        }
    }
    if (size <= bound) {
        return;
    }
    keep = bound / size;
    asperity_scale(s->deflection, keep);
    m[0] = held[0] / size;
    m[1] = held[1] / size;
    out->f_t[0] = bound * m[0];
    out->f_t[1] = bound * m[1];
    rate = slip_force * shape_slope * per_x;
    for (j = 0; j < 2; j++) {
        radial = m[0] * stiffness[0][j] + m[1] * stiffness[1][j];
        for (i = 0; i < 2; i++) {
            out->df_t_ddelta[i][j] = rate * m[i] * direction[j] + keep * (stiffness[i][j] - m[i] * radial);
        }
    }
}

/* Turns the memory into axes that are turned by an angle: new components of a vector v are (c v0 + s v1, -s v0 + c v1). */
static inline void asperity_rotate(asperity_state *state, double cosine, double sine) {
    double q0, q1;
    int i;
    for (i = 0; i < ASPERITY_SLIDERS; i++) {
        q0 = state->deflection[i][0];
        q1 = state->deflection[i][1];
        state->deflection[i][0] = cosine * q0 + sine * q1;
        state->deflection[i][1] = -sine * q0 + cosine * q1;
    }
}

/* Moves a contact to the indentation h and along the plane by `increment`, the press first. `next` may be `state`. Where h or the
 * increment is not finite, nothing in the answer is a number and the state stays as it was. */
static inline void asperity_update(
    const asperity_parameters *p, const asperity_state *state, double h, const double increment[2], asperity_state *next, asperity_response *out) {
    asperity_state s = *state;
    asperity_virgin_curve v;
    double greatest = h > state->h_max ? h : state->h_max, h_before = state->h, f_n, x, df_n_dh;
    double d0 = increment[0], d1 = increment[1];
    int i;
    if (!asperity_is_finite(h) || !asperity_is_finite(d0) || !asperity_is_finite(d1)) {
        out->f_n = out->f_t[0] = out->f_t[1] = out->df_n_dh = out->df_n_ddelta[0] = out->df_n_ddelta[1] = out->a = NAN;
        out->df_t_ddelta[0][0] = out->df_t_ddelta[0][1] = out->df_t_ddelta[1][0] = out->df_t_ddelta[1][1] = NAN;
        *next = s;
        return;
    }
    asperity_bound(&d0, &d1);
    out->f_n = out->f_t[0] = out->f_t[1] = out->df_n_dh = out->df_n_ddelta[0] = out->df_n_ddelta[1] = out->a = 0.0;
    out->df_t_ddelta[0][0] = out->df_t_ddelta[0][1] = out->df_t_ddelta[1][0] = out->df_t_ddelta[1][1] = 0.0;
    if (!(greatest > 0.0)) {
        s.h = h;
        *next = s;
        return;
    }
    asperity_virgin(p, greatest, &v);
    f_n = asperity_press(p, &s, &v, h, &x, &df_n_dh);
    if (h != h_before) {
        s.approach = f_n > 0.0 ? asperity_approach_at(&v, f_n) : s.approach + (h - h_before);
    }
    s.h = h;
    s.h_max = greatest;
    s.x = x;
    if (!(f_n > 0.0)) {
        for (i = 0; i < ASPERITY_SLIDERS; i++) {
            s.deflection[i][0] = s.deflection[i][1] = 0.0;
        }
        *next = s;
        return;
    }
    out->df_n_dh = df_n_dh;
    asperity_shear(p, &s, out, &v, f_n, d0, d1);
    out->a = v.a * pow(s.approach / v.depth, v.gamma - 1.0);
    *next = s;
}

/* Elastic energy that the contact stores: no path gives back more than it. */
static inline double asperity_stored_energy(const asperity_parameters *p, const asperity_state *state) {
    asperity_virgin_curve v;
    double sum = 0.0;
    int i;
    if (!(state->h_max > 0.0) || state->approach <= 0.0) {
        return 0.0;
    }
    asperity_virgin(p, state->h_max, &v);
    for (i = 0; i < ASPERITY_SLIDERS; i++) {
        const double *q = state->deflection[i];
        sum += v.weight[i] * (q[0] * q[0] + q[1] * q[1]);
    }
    return asperity_force_at(&v, state->approach) * state->approach / (v.gamma + 1.0) + 0.5 * v.k_t * sum;
}

#ifdef __cplusplus
}
#endif
#endif
