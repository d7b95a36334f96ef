/* asperity_contact.h: force-displacement law of an elastic-plastic sphere, as an incremental update of one contact. Written by asperity @VERSION@.
 *
 * C99, C++17, CUDA. No global data, no allocation, no failure at run time. double; with ASPERITY_SINGLE defined before it is included, float.
 *
 * What it needs is an asperity_table: of one hardening curve, one Poisson's ratio and one friction coefficient, for all radii, moduli and units. `asperity law export` writes it
 * as a constant (asperity_law.h) and as a file that asperity_read_table() reads when the program runs (law.asperity).
 *
 * A contact's memory is one asperity_state: all bytes zero before first contact; copy it, write it to a restart file as it is. Its lengths are over R. Each step:
 *     asperity_update(&table, R, E, &state, h, d, &next, &out, NULL);
 * h: indentation (negative: a gap), d[2]: tangential displacement of the sphere since the last call in two fixed axes, compression and the force along d
 * positive. The answer is a function of `state` alone, which stays as it is: it may be asked twice. For three dimensions, two radii, walls: asperity_contact3d.h.
 *
 * A table is of a sphere on a rigid plane (table.plane is 1) or of two spheres (0): then h and d are `table.share` times what the two centres move. A table for a plane may
 * stand for two equal spheres with a share of 1/2, which is exact without friction only: a plane holds the surface by friction while it is pressed, where two equal spheres
 * move alike.
 *
 * The law: on first loading at constant h, with x = |delta_T|/delta_T_slip, F_T = mu F_N_slip f_T(x), F_N = F_N0 - (F_N0 - F_N_slip) f_N(x). Inside that curve the contact is
 * elastic with friction: @SLIDERS@ sliders in parallel (Iwan 1967), which obey Masing's rule on reversal. On it plastic flow follows the law in x. Unloading in h is elastic and
 * ends at the residual dent. No path returns more energy than was stored.
 */
#ifndef ASPERITY_CONTACT_H
#define ASPERITY_CONTACT_H

#ifndef __CUDACC_RTC__
#include <math.h>
#include <stdint.h>
#include <string.h>
#ifndef ASPERITY_NO_FILES
#include <stdio.h>
#endif
#else
#define ASPERITY_NO_FILES
typedef unsigned int uint32_t;
typedef unsigned long long uint64_t;
typedef long long int64_t;
#endif

/* Before a loop over sliders: gcc would take it apart before it thinks of lanes. */
#if defined(__GNUC__) && !defined(__clang__) && !defined(__CUDACC__) && __GNUC__ >= 8
#define ASPERITY_LANES _Pragma("GCC unroll 1")
#else
#define ASPERITY_LANES
#endif

#ifdef __CUDACC__
#define ASPERITY_FN static inline __host__ __device__
#else
#define ASPERITY_FN static inline
#endif

#ifdef ASPERITY_SINGLE
typedef float asperity_real;
typedef uint32_t asperity_bits;
#define ASPERITY_EXP expf
#define ASPERITY_LOG logf
#define ASPERITY_SQRT sqrtf
#define ASPERITY_ABS fabsf
#define ASPERITY_SIN sinf
#define ASPERITY_COS cosf
#define ASPERITY_INFINITE_BITS 0x7f800000u
#define ASPERITY_ROOT_BITS 0x5f375a86u
#define ASPERITY_MOST 1e15f      /* its square is still finite */
#define ASPERITY_AT_CAP (1.0f - 1e-6f)
#define ASPERITY_AT_BOUND (1.0f + 1e-6f)
#else
typedef double asperity_real;
typedef uint64_t asperity_bits;
#define ASPERITY_EXP exp
#define ASPERITY_LOG log
#define ASPERITY_SQRT sqrt
#define ASPERITY_ABS fabs
#define ASPERITY_SIN sin
#define ASPERITY_COS cos
#define ASPERITY_INFINITE_BITS 0x7ff0000000000000ull
#define ASPERITY_ROOT_BITS 0x5fe6eb50c7b537a9ull
#define ASPERITY_MOST 1e150
#define ASPERITY_AT_CAP (1.0 - 1e-9) /* rounding is not taken for unloading */
#define ASPERITY_AT_BOUND (1.0 + 1e-10)
#endif
#define ASPERITY_R(x) ((asperity_real)(x))

#define ASPERITY_KNOTS @KNOTS@
#define ASPERITY_COLUMNS @COLUMNS@
#define ASPERITY_SLIDERS 16 /* asperity_weights() and asperity_sliders() are written for this number */
#define ASPERITY_POINTS @POINTS@   /* of a shape that is given by numbers, x = (j/points)^2 */
#define ASPERITY_LEVELS @LEVELS@

/* A law. Lengths over R, forces over E R^2. */
typedef struct asperity_table {
    int plane;                       /* 1: a sphere on a rigid plane; 0: two equal spheres */
    int form;                        /* of f_N: 0 [1 - (1 - x)^M]^N, 1 1 - (1 - x^M)^N; 2 f_T and f_N by numbers */
    asperity_real share;             /* h and d over what the centres move */
    asperity_real poissons_ratio;
    asperity_real friction;          /* mu */
    asperity_real effective_modulus; /* E*, over E: 1/(1 - nu^2) on a plane, half of it between two spheres */
    asperity_real effective_radius;  /* of Hertz's contact, over R: 1 on a plane, 1/2 between two spheres */
    asperity_real deepest;           /* h up to which the law was made */
    asperity_real log_first;         /* ln h of the first knot */
    asperity_real log_step;
    /* ln F_N0, ln a, F_N_slip/F_N0, ln delta_T_slip, n, M, N, ln k_T, and their slopes a step */
    asperity_real knots[ASPERITY_KNOTS][2][ASPERITY_COLUMNS];
    asperity_real shapes[ASPERITY_LEVELS][2][ASPERITY_POINTS];
} asperity_table;

/* The memory of a contact, lengths over R. */
typedef struct asperity_state {
    asperity_real h;
    asperity_real h_max;
    asperity_real approach; /* elastic: what is recovered until contact is lost; negative: the gap over the residual dent */
    asperity_real x;        /* place on the virgin curves: the measure of F_N lost to shear */
    asperity_real deflection[2][ASPERITY_SLIDERS];
} asperity_state;

/* The answer of an increment. */
typedef struct asperity_response {
    asperity_real f_n;          /* compression positive */
    asperity_real f_t[2];       /* along the displacement: what drives the sphere; the plane gives it the opposite */
    asperity_real stiffness;    /* of an unloading, dF_N/dh: 2 E* a */
    asperity_real stored;       /* elastic energy: no path gives back more */
    asperity_real plastic;      /* work that this increment dissipated in plastic flow, */
    asperity_real friction;     /* and in slip */
} asperity_response;

/* Derivatives, for implicit engines, and the contact radius. */
typedef struct asperity_tangent {
    asperity_real df_t_ddelta[2][2];
    asperity_real df_n_dh;        /* for the direction in which h last moved */
    asperity_real df_n_ddelta[2];
    asperity_real a;
} asperity_tangent;

/* What a virgin contact answers at one indentation. */
typedef struct asperity_curve {
    asperity_real f_n0, f_n_slip, delta_t_slip, n, m, big_n, k_t, contact_radius;
    asperity_real slope;    /* dF_N0/dh */
    asperity_real gamma;    /* unloading: F_N = F_N0 (e/depth)^gamma */
    asperity_real depth;
    asperity_real backbone; /* exponent of the sliders' */
    int elastic;            /* whether shear costs no normal force */
    asperity_real lost[ASPERITY_SLIDERS]; /* approach over depth at which a slider's annulus loses contact */
    const asperity_real (*shallow)[ASPERITY_POINTS]; /* shapes by numbers: those of the level above and of the one below, */
    const asperity_real (*deep)[ASPERITY_POINTS];
    asperity_real between;                           /* and the place between them */
} asperity_curve;

/* e^x of several numbers at once, |x| < 700 (80 in float; beyond it what it has there): 2^k e^r with |r| <= ln(2)/2, e^r by its series. No call, no branch: a compiler does it for
 * several lanes. To 2 in the last place. */
ASPERITY_FN void asperity_exponentials(asperity_real *x, int count) {
#ifdef ASPERITY_SINGLE
    const float most = 80.0f;
#else
    const double most = 700.0;
#endif
    int i;
    /* Loops of their own: beside what follows, a bound that is a constant becomes a branch. */
    ASPERITY_LANES
    for (i = 0; i < count; i++) {
        asperity_real y = x[i];
        x[i] = y < most ? y : most;
    }
    ASPERITY_LANES
    for (i = 0; i < count; i++) {
        asperity_real y = x[i];
        x[i] = y > -most ? y : -most;
    }
#ifdef ASPERITY_SINGLE
    ASPERITY_LANES
    for (i = 0; i < count; i++) {
        float y = x[i], r, p;
        int k = (int)(y * 1.44269504f + 128.5f) - 128;
        uint32_t bits;
        r = (y - (float)k * 0.693359375f) + (float)k * 2.12194440e-4f;
        p = 1.0f + r * (1.0f + r * (0.5f + r * (1.6666667e-1f + r * (4.1666667e-2f + r * (8.3333333e-3f + r * (1.3888889e-3f + r * 1.984127e-4f))))));
        memcpy(&bits, &p, sizeof bits);
        bits += (uint32_t)k << 23;
        memcpy(&p, &bits, sizeof bits);
        x[i] = p;
    }
#else
    ASPERITY_LANES
    for (i = 0; i < count; i++) {
        double y = x[i], r, r2, r4, p;
        int k = (int)(y * 1.4426950408889634 + 1024.5) - 1024;
        uint64_t bits;
        r = (y - (double)k * 6.93147180369123816490e-01) - (double)k * 1.90821492927058770002e-10;
        r2 = r * r;
        r4 = r2 * r2;
        p = ((1.0 + r) + r2 * (1.0 / 2.0 + r * (1.0 / 6.0))) + r4 * ((1.0 / 24.0 + r * (1.0 / 120.0)) + r2 * (1.0 / 720.0 + r * (1.0 / 5040.0))) +
            r4 * r4 * ((1.0 / 40320.0 + r * (1.0 / 362880.0)) + r2 * (1.0 / 3628800.0 + r * (1.0 / 39916800.0)) + r4 * (1.0 / 479001600.0 + r * (1.0 / 6227020800.0)));
        memcpy(&bits, &p, sizeof bits);
        bits += (uint64_t)(int64_t)k << 52;
        memcpy(&p, &bits, sizeof bits);
        x[i] = p;
    }
#endif
}

/* Sum of a[i] b[i] over the sliders, in a fixed order that compilers do in lanes. */
ASPERITY_FN asperity_real asperity_sum(const asperity_real a[ASPERITY_SLIDERS], const asperity_real b[ASPERITY_SLIDERS]) {
    asperity_real lane[4];
    int i;
    ASPERITY_LANES
    for (i = 0; i < 4; i++) {
        lane[i] = (a[i] * b[i] + a[i + 4] * b[i + 4]) + (a[i + 8] * b[i + 8] + a[i + 12] * b[i + 12]);
    }
    return (lane[0] + lane[2]) + (lane[1] + lane[3]);
}

/* 1/sqrt(x), x >= 0, finite at 0: a first guess by the exponent's bits and Newton's steps. No call, no division: a compiler does it for several lanes whatever its flags. */
ASPERITY_FN asperity_real asperity_inverse_root(asperity_real x) {
    asperity_real half = ASPERITY_R(0.5) * x, y;
    asperity_bits bits;
    memcpy(&bits, &x, sizeof bits);
    bits = ASPERITY_ROOT_BITS - (bits >> 1);
    memcpy(&y, &bits, sizeof bits);
    y *= ASPERITY_R(1.5) - half * y * y;
    y *= ASPERITY_R(1.5) - half * y * y;
    y *= ASPERITY_R(1.5) - half * y * y;
#ifndef ASPERITY_SINGLE
    y *= ASPERITY_R(1.5) - half * y * y;
#endif
    return y;
}

/* base^exponent, 0 <= base. */
ASPERITY_FN asperity_real asperity_power(asperity_real base, asperity_real exponent) {
    return base > ASPERITY_R(0.0) ? ASPERITY_EXP(exponent * ASPERITY_LOG(base)) : ASPERITY_R(0.0);
}

/* e^x. */
ASPERITY_FN asperity_real asperity_exponential(asperity_real x) {
    asperity_exponentials(&x, 1);
    return x;
}

/* ln(a/b), a, b > 0: by its series where they are near to each other, as from one step of time to the next. */
ASPERITY_FN asperity_real asperity_log_ratio(asperity_real a, asperity_real b) {
    asperity_real z = (a - b) / b, z2 = z * z, z4 = z2 * z2;
    if (ASPERITY_ABS(z) > ASPERITY_R(0.015625)) {
        return ASPERITY_LOG(a / b);
    }
    return z - z2 * ((ASPERITY_R(1.0 / 2.0) - z * ASPERITY_R(1.0 / 3.0)) + z2 * (ASPERITY_R(1.0 / 4.0) - z * ASPERITY_R(1.0 / 5.0)) +
                     z4 * ((ASPERITY_R(1.0 / 6.0) - z * ASPERITY_R(1.0 / 7.0)) + z2 * (ASPERITY_R(1.0 / 8.0) - z * ASPERITY_R(1.0 / 9.0))));
}

/* Whether a number is finite, also where the compiler was told that all are. */
ASPERITY_FN int asperity_is_finite(asperity_real x) {
    asperity_bits bits;
    memcpy(&bits, &x, sizeof bits);
    return (bits & ASPERITY_INFINITE_BITS) != ASPERITY_INFINITE_BITS;
}

/* A NaN that no compiler folds away. */
ASPERITY_FN asperity_real asperity_no_number(void) {
    asperity_bits bits = ASPERITY_INFINITE_BITS | (ASPERITY_INFINITE_BITS >> 1);
    asperity_real x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* Shares of the sliders in k_T, the same for every backbone: (k/16)^0.65 is that of the annuli inside the end of cell k. So a contact that grows keeps the forces of all its
 * sliders by one factor. */
ASPERITY_FN const asperity_real *asperity_weights(void) {
    static const asperity_real weight[ASPERITY_SLIDERS] = {
        ASPERITY_R(0.16493848884661177), ASPERITY_R(0.09387774211373257), ASPERITY_R(0.07804484139822254), ASPERITY_R(0.06926512581955085), ASPERITY_R(0.0633920910623787),
        ASPERITY_R(0.059073391905460126), ASPERITY_R(0.055708118352608804), ASPERITY_R(0.05298051416106575), ASPERITY_R(0.05070575232217012), ASPERITY_R(0.048767100837759925),
        ASPERITY_R(0.04708653450214806), ASPERITY_R(0.04560955329354521), ASPERITY_R(0.04429672468331203), ASPERITY_R(0.043118682883102055), ASPERITY_R(0.04205302593053484),
        ASPERITY_R(0.04108231188779665)};
    return weight;
}

/* Points of loss of sliders whose backbone is 1 - (1 - x)^backbone: each stands for a cell of the annuli at its centre of gravity. The cells end at (k/16)^(0.65/(backbone - 1)); the
 * powers of k come from those of the primes. */
ASPERITY_FN void asperity_sliders(asperity_real backbone, asperity_real lost[ASPERITY_SLIDERS]) {
    /* What is inside the end of a cell, and inside its beginning, over its weight. */
    static const asperity_real to[ASPERITY_SLIDERS] = {
        ASPERITY_R(1.0), ASPERITY_R(2.7569498917729547), ASPERITY_R(4.316250328958178), ASPERITY_R(5.86335754642467), ASPERITY_R(7.406575195295008),
        ASPERITY_R(8.948050282805905), ASPERITY_R(10.488593346488479), ASPERITY_R(12.028579256936597), ASPERITY_R(13.568205469283463), ASPERITY_R(15.10758593730263),
        ASPERITY_R(16.64679105415904), ASPERITY_R(18.18586665992715), ASPERITY_R(19.724843891849506), ASPERITY_R(21.263744643298974), ASPERITY_R(22.802584758019282),
        ASPERITY_R(24.34137598514864)};
    static const asperity_real from[ASPERITY_SLIDERS] = {
        ASPERITY_R(0.0), ASPERITY_R(1.7569498917729547), ASPERITY_R(3.316250328958178), ASPERITY_R(4.86335754642467), ASPERITY_R(6.406575195295008),
        ASPERITY_R(7.948050282805905), ASPERITY_R(9.488593346488479), ASPERITY_R(11.028579256936597), ASPERITY_R(12.568205469283463), ASPERITY_R(14.10758593730263),
        ASPERITY_R(15.646791054159038), ASPERITY_R(17.18586665992715), ASPERITY_R(18.724843891849506), ASPERITY_R(20.263744643298974), ASPERITY_R(21.802584758019282),
        ASPERITY_R(23.34137598514864)};
    asperity_real p = ASPERITY_R(0.65) / (backbone - ASPERITY_R(1.0)), end[ASPERITY_SLIDERS + 1], share = (backbone - ASPERITY_R(1.0)) / backbone;
    /* (1/2)^p, (3/4)^p, (5/8)^p, (7/8)^p, (11/16)^p, (13/16)^p, and two for the lanes */
    asperity_real prime[8] = {
        ASPERITY_R(-0.6931471805599453), ASPERITY_R(-0.2876820724517809), ASPERITY_R(-0.4700036292457356), ASPERITY_R(-0.13353139262452263),
        ASPERITY_R(-0.3746934494414107), ASPERITY_R(-0.2076393647782445), ASPERITY_R(0.0), ASPERITY_R(0.0)};
    asperity_real half, quarter, three, five, seven;
    int k;
    for (k = 0; k < 8; k++) {
        prime[k] *= p;
    }
    asperity_exponentials(prime, 8);
    half = prime[0];
    quarter = half * half;
    three = prime[1];
    five = prime[2];
    seven = prime[3];
    end[0] = ASPERITY_R(0.0);
    end[1] = quarter * quarter;
    end[2] = half * quarter;
    end[3] = three * quarter;
    end[4] = quarter;
    end[5] = five * half;
    end[6] = three * half;
    end[7] = seven * half;
    end[8] = half;
    end[9] = three * three;
    end[10] = five;
    end[11] = prime[4];
    end[12] = three;
    end[13] = prime[5];
    end[14] = seven;
    end[15] = three * five / half;
    end[16] = ASPERITY_R(1.0);
    ASPERITY_LANES
    for (k = 0; k < ASPERITY_SLIDERS; k++) {
        lost[k] = share * (to[k] * end[k + 1] - from[k] * end[k]);
    }
}

/* A row of the table at ln h: its position, its columns, the slope of the first, and the logarithms among them, whose exponentials are then taken together. */
typedef struct asperity_row {
    asperity_real position, slope, column[ASPERITY_COLUMNS];
} asperity_row;

ASPERITY_FN void asperity_read_row(const asperity_table *t, asperity_real log_h, asperity_row *row, asperity_real logarithm[4]) {
    /* Powers of h in Hertz's contact, for what lies below the first knot. */
    static const asperity_real hertz[ASPERITY_COLUMNS] = {
        ASPERITY_R(1.5), ASPERITY_R(0.5), ASPERITY_R(0.0), ASPERITY_R(1.0), ASPERITY_R(0.0), ASPERITY_R(0.0), ASPERITY_R(0.0), ASPERITY_R(0.5)};
    asperity_real position = (log_h - t->log_first) / t->log_step, last = ASPERITY_R(ASPERITY_KNOTS - 1), slope, *column = row->column;
    int c;
    if (position < ASPERITY_R(0.0)) {
        for (c = 0; c < ASPERITY_COLUMNS; c++) {
            column[c] = t->knots[0][0][c] + hertz[c] * t->log_step * position;
        }
        slope = hertz[0] * t->log_step;
    } else if (position >= last) {
        /* Logarithms go on straight, the others stay. */
        for (c = 0; c < ASPERITY_COLUMNS; c++) {
            column[c] = t->knots[ASPERITY_KNOTS - 1][0][c];
            column[c] += hertz[c] > ASPERITY_R(0.0) ? t->knots[ASPERITY_KNOTS - 1][1][c] * (position - last) : ASPERITY_R(0.0);
        }
        slope = t->knots[ASPERITY_KNOTS - 1][1][0];
    } else {
        int i = (int)position;
        asperity_real u = position - ASPERITY_R(i);
        const asperity_real *y0 = t->knots[i][0], *s0 = t->knots[i][1], *y1 = t->knots[i + 1][0], *s1 = t->knots[i + 1][1];
        for (c = 0; c < ASPERITY_COLUMNS; c++) {
            asperity_real rise = y1[c] - y0[c], quadratic = ASPERITY_R(3.0) * rise - ASPERITY_R(2.0) * s0[c] - s1[c], cubic = s0[c] + s1[c] - ASPERITY_R(2.0) * rise;
            column[c] = y0[c] + u * (s0[c] + u * (quadratic + u * cubic));
        }
        {
            asperity_real rise = y1[0] - y0[0], quadratic = ASPERITY_R(3.0) * rise - ASPERITY_R(2.0) * s0[0] - s1[0], cubic = s0[0] + s1[0] - ASPERITY_R(2.0) * rise;
            slope = s0[0] + u * (ASPERITY_R(2.0) * quadratic + ASPERITY_R(3.0) * u * cubic);
        }
    }
    row->position = position;
    row->slope = slope;
    logarithm[0] = column[0];
    logarithm[1] = column[1];
    logarithm[2] = column[3];
    logarithm[3] = column[7];
}

/* First loading at the indentation h > 0, over R, from a row and its exponentials; where it is not to be `whole`, without what only sliding and shapes need. */
ASPERITY_FN void asperity_make_curve(const asperity_table *t, asperity_real h, const asperity_row *row, const asperity_real exponential[4], int whole, asperity_curve *v) {
    const asperity_real *column = row->column;
    asperity_real a, start, end, force;
    v->f_n0 = exponential[0];
    a = exponential[1];
    v->f_n_slip = column[2] * v->f_n0;
    v->delta_t_slip = exponential[2];
    v->n = column[4];
    v->m = column[5];
    v->big_n = column[6];
    v->k_t = exponential[3];
    /* 3/2 for Hertz, 4/pi for a uniform pressure (Mesarovic & Johnson 2000), by how far the force has fallen below Hertz's at that radius. */
    force = ASPERITY_R(4.0) * t->effective_modulus * a * a * a / (ASPERITY_R(3.0) * t->effective_radius);
    v->gamma = ASPERITY_R(1.2732395447351628) + ASPERITY_R(1.5 - 1.2732395447351628) * (v->f_n0 < force ? v->f_n0 / force : ASPERITY_R(1.0));
    v->depth = v->gamma * v->f_n0 / (ASPERITY_R(2.0) * t->effective_modulus * a);
    v->slope = v->f_n0 * row->slope / (t->log_step * h);
    if (t->form == 2) {
        v->backbone = v->big_n;
        v->contact_radius = v->m * a;
    } else {
        v->backbone = v->gamma < v->n ? v->gamma : v->n;
        v->contact_radius = a;
    }
    v->elastic = v->f_n_slip >= ASPERITY_R(1.0 - 1e-6) * v->f_n0;
    /* The sliders must be able to follow the virgin curve: neither softer at its start nor slower to slip. */
    start = v->n * t->friction * v->f_n_slip / v->delta_t_slip;
    end = v->backbone * t->friction * v->f_n0 / v->delta_t_slip;
    v->k_t = v->k_t < start ? start : v->k_t;
    v->k_t = v->k_t < end ? end : v->k_t;
    if (!whole) {
        return;
    }
    asperity_sliders(v->backbone, v->lost);
    if (t->form == 2) {
        asperity_real level = row->position * (ASPERITY_R(ASPERITY_LEVELS - 1) / ASPERITY_R(ASPERITY_KNOTS - 1)), most = ASPERITY_R(ASPERITY_LEVELS - 1);
        int i;
        level = level < most ? level : most;
        level = level > ASPERITY_R(0.0) ? level : ASPERITY_R(0.0);
        i = (int)level < ASPERITY_LEVELS - 2 ? (int)level : ASPERITY_LEVELS - 2;
        v->between = level - ASPERITY_R(i);
        v->shallow = t->shapes[i];
        v->deep = t->shapes[i + 1];
    }
}

/* First loading at the indentation h > 0, over R. */
ASPERITY_FN void asperity_first_loading(const asperity_table *t, asperity_real h, int whole, asperity_curve *v) {
    asperity_row row;
    asperity_real exponential[4];
    asperity_read_row(t, ASPERITY_LOG(h), &row, exponential);
    asperity_exponentials(exponential, 4);
    asperity_make_curve(t, h, &row, exponential, whole, v);
}

/* x at point j of a shape that is given by numbers, */
ASPERITY_FN asperity_real asperity_point_x(int j) {
    return ASPERITY_R(j * j) * (ASPERITY_R(1.0) / ASPERITY_R(ASPERITY_POINTS * ASPERITY_POINTS));
}

/* and the shape there: 0 is f_T, 1 is f_N. */
ASPERITY_FN asperity_real asperity_point(const asperity_curve *v, int kind, int j) {
    asperity_real low;
    if (j == 0) {
        return ASPERITY_R(0.0);
    }
    low = v->shallow[kind][j - 1];
    return low + v->between * (v->deep[kind][j - 1] - low);
}

/* It at an x between point j and the next. */
ASPERITY_FN asperity_real asperity_given_after(const asperity_curve *v, int kind, asperity_real x, int j, asperity_real *derivative) {
    asperity_real below = asperity_point(v, kind, j);
    *derivative = (asperity_point(v, kind, j + 1) - below) * (ASPERITY_R(ASPERITY_POINTS * ASPERITY_POINTS) / ASPERITY_R(2 * j + 1));
    return below + *derivative * (x - asperity_point_x(j));
}

/* It anywhere, 0 <= x <= 1. */
ASPERITY_FN asperity_real asperity_given(const asperity_curve *v, int kind, asperity_real x, asperity_real *derivative) {
    int j;
    if (x >= ASPERITY_R(1.0)) {
        *derivative = ASPERITY_R(0.0);
        return asperity_point(v, kind, ASPERITY_POINTS);
    }
    j = (int)(ASPERITY_R(ASPERITY_POINTS) * ASPERITY_SQRT(x));
    j = j > ASPERITY_POINTS - 1 ? ASPERITY_POINTS - 1 : j;
    return asperity_given_after(v, kind, x, j, derivative);
}

/* The least x at which it has the value f, or that of its peak; `after`: the point before it, -1 at a peak. */
ASPERITY_FN asperity_real asperity_given_inverse(const asperity_curve *v, int kind, asperity_real f, int *after) {
    const asperity_real *shallow = v->shallow[kind], *deep = v->deep[kind];
    asperity_real between = v->between, below, peak = ASPERITY_R(0.0), place = ASPERITY_R(0.0);
    int j, first = ASPERITY_POINTS;
    *after = 0;
    if (f <= ASPERITY_R(0.0)) {
        return ASPERITY_R(0.0);
    }
    ASPERITY_LANES
    for (j = 0; j < ASPERITY_POINTS; j++) {
        int here = shallow[j] + between * (deep[j] - shallow[j]) >= f ? j : ASPERITY_POINTS;
        first = here < first ? here : first;
    }
    *after = first < ASPERITY_POINTS ? first : -1;
    if (first < ASPERITY_POINTS) {
        below = asperity_point(v, kind, first);
        return asperity_point_x(first) + (f - below) / (asperity_point(v, kind, first + 1) - below) * (asperity_point_x(first + 1) - asperity_point_x(first));
    }
    for (j = 1; j <= ASPERITY_POINTS; j++) {
        below = asperity_point(v, kind, j);
        if (below > peak) {
            peak = below;
            place = asperity_point_x(j);
        }
    }
    return place;
}

/* f_T(x), 0 <= x <= 1. */
ASPERITY_FN asperity_real asperity_tangential_shape(int form, const asperity_curve *v, asperity_real x, asperity_real *derivative) {
    asperity_real rest = ASPERITY_R(1.0) - x, power;
    if (form == 2) {
        return asperity_given(v, 0, x, derivative);
    }
    *derivative = ASPERITY_R(0.0);
    if (rest <= ASPERITY_R(0.0)) {
        return ASPERITY_R(1.0);
    }
    power = asperity_power(rest, v->n - ASPERITY_R(1.0));
    *derivative = v->n * power;
    return ASPERITY_R(1.0) - power * rest;
}

ASPERITY_FN asperity_real asperity_tangential_shape_inverse(int form, const asperity_curve *v, asperity_real f, int *after) {
    *after = -1;
    if (form == 2) {
        return asperity_given_inverse(v, 0, f, after);
    }
    return f >= ASPERITY_R(1.0) ? ASPERITY_R(1.0) : ASPERITY_R(1.0) - asperity_power(ASPERITY_R(1.0) - f, ASPERITY_R(1.0) / v->n);
}

/* f_N(x), 0 <= x <= 1; its derivative is 0 at both ends. `after`: the point before x of a shape by numbers, -1 where it is not known. */
ASPERITY_FN asperity_real asperity_normal_shape(int form, const asperity_curve *v, asperity_real x, int after, asperity_real *derivative) {
    asperity_real rest, risen, power;
    *derivative = ASPERITY_R(0.0);
    if (x <= ASPERITY_R(0.0)) {
        return ASPERITY_R(0.0);
    }
    if (x >= ASPERITY_R(1.0)) {
        return ASPERITY_R(1.0);
    }
    if (form == 2) {
        return after < 0 ? asperity_given(v, 1, x, derivative) : asperity_given_after(v, 1, x, after, derivative);
    }
    if (form == 0) {
        rest = asperity_power(ASPERITY_R(1.0) - x, v->m);
        risen = ASPERITY_R(1.0) - rest;
        power = asperity_power(risen, v->big_n - ASPERITY_R(1.0));
        *derivative = v->big_n * power * v->m * rest / (ASPERITY_R(1.0) - x);
        return power * risen;
    }
    risen = asperity_power(x, v->m);
    rest = ASPERITY_R(1.0) - risen;
    power = rest > ASPERITY_R(0.0) ? asperity_power(rest, v->big_n - ASPERITY_R(1.0)) : ASPERITY_R(0.0);
    *derivative = v->big_n * power * v->m * risen / x;
    return ASPERITY_R(1.0) - power * rest;
}

ASPERITY_FN asperity_real asperity_normal_shape_inverse(int form, const asperity_curve *v, asperity_real f) {
    asperity_real one = ASPERITY_R(1.0), inner;
    int after;
    if (f <= ASPERITY_R(0.0)) {
        return ASPERITY_R(0.0);
    }
    if (f >= one) {
        return one;
    }
    if (form == 2) {
        return asperity_given_inverse(v, 1, f, &after);
    }
    if (form == 0) {
        inner = one - asperity_power(f, one / v->big_n);
        return inner > ASPERITY_R(0.0) ? one - asperity_power(inner, one / v->m) : one;
    }
    inner = one - asperity_power(one - f, one / v->big_n);
    return inner > ASPERITY_R(0.0) ? asperity_power(inner, one / v->m) : ASPERITY_R(0.0);
}

/* F_N on the virgin curve at x. */
ASPERITY_FN asperity_real asperity_cap(int form, const asperity_curve *v, asperity_real x, int after) {
    asperity_real derivative;
    return v->f_n0 - (v->f_n0 - v->f_n_slip) * asperity_normal_shape(form, v, x, after, &derivative);
}

/* The x of the virgin curve that has the normal force f_n. */
ASPERITY_FN asperity_real asperity_mobilisation(int form, const asperity_curve *v, asperity_real f_n) {
    if (f_n >= ASPERITY_AT_CAP * v->f_n0) {
        return ASPERITY_R(0.0);
    }
    if (f_n <= v->f_n_slip) {
        return ASPERITY_R(1.0);
    }
    return asperity_normal_shape_inverse(form, v, (v->f_n0 - f_n) / (v->f_n0 - v->f_n_slip));
}

/* Elastic unloading: ln(F_N/F_N0) at the approach e > 0. */
ASPERITY_FN asperity_real asperity_level_at(const asperity_curve *v, asperity_real e) {
    return e == v->depth ? ASPERITY_R(0.0) : v->gamma * ASPERITY_LOG(e / v->depth);
}

/* F_N at the approach e. */
ASPERITY_FN asperity_real asperity_force_at(const asperity_curve *v, asperity_real e) {
    return e <= ASPERITY_R(0.0) ? ASPERITY_R(0.0) : v->f_n0 * asperity_exponential(asperity_level_at(v, e));
}

/* Greatest deflection of each slider under the normal force f_n > 0, so that their forces add up to mu F_N; eta = (F_N/F_N0)^(1/backbone). */
ASPERITY_FN void asperity_limits(asperity_real friction, const asperity_curve *v, asperity_real f_n, asperity_real eta, asperity_real limit[ASPERITY_SLIDERS]) {
    asperity_real scale;
    int i;
    ASPERITY_LANES
    for (i = 0; i < ASPERITY_SLIDERS; i++) {
        limit[i] = (eta > v->lost[i] ? eta : v->lost[i]) - v->lost[i];
    }
    limit[0] = limit[0] < ASPERITY_R(0.1) * eta ? ASPERITY_R(0.1) * eta : limit[0]; /* the innermost carries what little force there is */
    scale = friction * f_n / (v->k_t * asperity_sum(asperity_weights(), limit));
    ASPERITY_LANES
    for (i = 0; i < ASPERITY_SLIDERS; i++) {
        limit[i] *= scale;
    }
}

/* Moves the sliders from `from` and holds each to its limit; returns what they dissipate over k_T. */
ASPERITY_FN asperity_real asperity_slide(
    asperity_real from[2][ASPERITY_SLIDERS], const asperity_real limit[ASPERITY_SLIDERS], asperity_real d0, asperity_real d1,
    asperity_real to[2][ASPERITY_SLIDERS]) {
    asperity_real q0[ASPERITY_SLIDERS], q1[ASPERITY_SLIDERS], square[ASPERITY_SLIDERS], over[ASPERITY_SLIDERS];
    int i, beyond = 0;
    ASPERITY_LANES
    for (i = 0; i < ASPERITY_SLIDERS; i++) {
        asperity_real p0 = from[0][i] + d0, p1 = from[1][i] + d1, size = p0 * p0 + p1 * p1, most = limit[i] * limit[i];
        q0[i] = p0;
        q1[i] = p1;
        beyond |= size > most;
        square[i] = size > most ? size : most;
    }
    if (!beyond) {
        ASPERITY_LANES
        for (i = 0; i < ASPERITY_SLIDERS; i++) {
            to[0][i] = q0[i];
            to[1][i] = q1[i];
        }
        return ASPERITY_R(0.0);
    }
    ASPERITY_LANES
    for (i = 0; i < ASPERITY_SLIDERS; i++) {
        /* 1, but for rounding, of one within its limit. */
        asperity_real inverse = asperity_inverse_root(square[i]), keep = limit[i] * inverse;
        over[i] = limit[i] * (square[i] * inverse - limit[i]);
        to[0][i] = keep * q0[i];
        to[1][i] = keep * q1[i];
    }
    return asperity_sum(asperity_weights(), over);
}

/* Whether a slider is beyond its limit. */
ASPERITY_FN int asperity_exceeds(asperity_real deflection[2][ASPERITY_SLIDERS], const asperity_real limit[ASPERITY_SLIDERS]) {
    int i, beyond = 0;
    ASPERITY_LANES
    for (i = 0; i < ASPERITY_SLIDERS; i++) {
        beyond |= deflection[0][i] * deflection[0][i] + deflection[1][i] * deflection[1][i] > limit[i] * limit[i];
    }
    return beyond;
}

/* Tangential force of the sliders. */
ASPERITY_FN void asperity_slider_force(const asperity_curve *v, asperity_real deflection[2][ASPERITY_SLIDERS], asperity_real force[2]) {
    force[0] = v->k_t * asperity_sum(asperity_weights(), deflection[0]);
    force[1] = v->k_t * asperity_sum(asperity_weights(), deflection[1]);
}

/* Their energy. */
ASPERITY_FN asperity_real asperity_slider_energy(const asperity_curve *v, asperity_real deflection[2][ASPERITY_SLIDERS]) {
    asperity_real square[ASPERITY_SLIDERS];
    int i;
    ASPERITY_LANES
    for (i = 0; i < ASPERITY_SLIDERS; i++) {
        square[i] = (deflection[0][i] * deflection[0][i] + deflection[1][i] * deflection[1][i]);
    }
    return ASPERITY_R(0.5) * v->k_t * asperity_sum(asperity_weights(), square);
}

/* Their stiffness after an increment: a slider at its limit only turns. */
ASPERITY_FN void asperity_slider_stiffness(
    const asperity_curve *v, asperity_real before[2][ASPERITY_SLIDERS], const asperity_real limit[ASPERITY_SLIDERS], asperity_real d0, asperity_real d1,
    asperity_real stiffness[2][2]) {
    const asperity_real *weight = asperity_weights();
    asperity_real sum0 = ASPERITY_R(0.0), sum1 = ASPERITY_R(0.0), sum2 = ASPERITY_R(0.0);
    int i;
    ASPERITY_LANES
    for (i = 0; i < ASPERITY_SLIDERS; i++) {
        asperity_real q0 = before[0][i] + d0, q1 = before[1][i] + d1, size = ASPERITY_SQRT(q0 * q0 + q1 * q1), k = v->k_t * weight[i];
        if (size > ASPERITY_AT_BOUND * limit[i]) {
            asperity_real m0 = q0 / size, m1 = q1 / size;
            k = k * limit[i] / size;
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

ASPERITY_FN void asperity_scale(asperity_real deflection[2][ASPERITY_SLIDERS], asperity_real keep) {
    int i;
    ASPERITY_LANES
    for (i = 0; i < ASPERITY_SLIDERS; i++) {
        deflection[0][i] *= keep;
        deflection[1][i] *= keep;
    }
}

/* What the press leaves for the shear. */
typedef struct asperity_pressed {
    asperity_real f_n, x, df_n_dh, slip; /* slip: dissipated by the sliders */
    asperity_real level;                 /* ln(F_N/F_N0) */
    asperity_real approach;              /* elastic, of that F_N; negative: not asked yet */
    asperity_real force[2];              /* of the sliders */
    asperity_real limit[ASPERITY_SLIDERS];
} asperity_pressed;

/* Moves h with delta_T held. `old` is the curve at the h_max before, `level` ln(F_N/F_N0) there. */
ASPERITY_FN void asperity_press(
    const asperity_table *t, asperity_state *s, const asperity_curve *v, const asperity_curve *old, asperity_real level, asperity_real h, int derivatives, asperity_pressed *p) {
    const asperity_real zero = ASPERITY_R(0.0);
    int grown = h > s->h_max, first = grown && (s->x == zero || !(s->h_max > zero)), after;
    asperity_real dh = h - s->h, e = s->approach + dh, trial = v->f_n0, stiffness = v->slope, elastic, f_t, slip_force, bound, cap, share, soft, rate, flow, most;
    asperity_real rises, falls, gain, along, slope, raised, keep, derivative, shape, at_trial = zero;
    p->slip = zero;
    if (grown && s->h_max > zero) {
        /* The sliders keep their forces as the contact grows (Mindlin & Deresiewicz 1953), and never gain energy by it. */
        keep = old->k_t / v->k_t;
        if (keep < ASPERITY_R(1.0)) {
            asperity_scale(s->deflection, keep);
        }
    }
    if (!first) {
        /* Most steps are small: what F_N was is near to what it is. */
        at_trial = e > zero ? (s->approach > zero ? level + old->gamma * asperity_log_ratio(e, s->approach) : asperity_level_at(old, e)) : zero;
        trial = e > zero ? old->f_n0 * asperity_exponential(at_trial) : zero;
        stiffness = e > zero ? old->gamma * trial / e : zero;
    }
    p->f_n = trial < v->f_n0 ? trial : v->f_n0;
    p->level = trial < v->f_n0 ? (grown ? asperity_log_ratio(trial, v->f_n0) : at_trial) : zero;
    p->approach = trial < v->f_n0 ? (grown ? -ASPERITY_R(1.0) : e) : v->depth;
    p->df_n_dh = stiffness;
    asperity_limits(t->friction, v, p->f_n, p->level < zero ? asperity_exponential(p->level / v->backbone) : ASPERITY_R(1.0), p->limit);
    if (dh <= zero) {
        asperity_slider_force(v, s->deflection, p->force);
    }
    if (dh == zero) {
        p->x = s->x;
        p->df_n_dh = s->x == zero && s->h == s->h_max ? v->slope : stiffness;
        return;
    }
    if (dh < zero) {
        elastic = asperity_mobilisation(t->form, v, p->f_n);
        p->x = elastic > s->x ? elastic : s->x;
        return;
    }
    if (trial >= v->f_n0 && grown) {
        stiffness = v->slope;
    }
    if (asperity_exceeds(s->deflection, p->limit)) {
        p->slip = v->k_t * asperity_slide(s->deflection, p->limit, zero, zero, s->deflection);
    }
    p->df_n_dh = stiffness;
    asperity_slider_force(v, s->deflection, p->force);
    f_t = ASPERITY_SQRT(p->force[0] * p->force[0] + p->force[1] * p->force[1]);
    slip_force = t->friction * v->f_n_slip;
    if (t->form == 2 || v->elastic) {
        p->x = asperity_mobilisation(t->form, v, p->f_n);
        /* Pressing leaves F_T as it is in an elastic contact, and below the virgin curve. */
        if (v->elastic || f_t <= slip_force * asperity_tangential_shape(t->form, v, p->x, &derivative)) {
            return;
        }
    }
    bound = asperity_tangential_shape_inverse(t->form, v, f_t / slip_force, &after);
    cap = asperity_cap(t->form, v, bound, after);
    if (t->form != 2 && p->f_n <= cap) {
        p->x = asperity_mobilisation(t->form, v, p->f_n); /* the same, as these curves only rise, and cheaper on it */
        return;
    }
    share = f_t < slip_force ? f_t / slip_force : ASPERITY_R(1.0);
    soft = ASPERITY_R(1.0) - v->slope * v->depth / (v->gamma * v->f_n0);
    soft = soft > zero ? soft * soft : zero;
    rate = ASPERITY_R(2.6) * (soft * soft) * (ASPERITY_R(1.0) - ASPERITY_R(0.5) * (share * share));
    flow = trial > cap ? rate * (trial - cap) / v->f_n0 : zero;
    most = t->form == 2 && after < 0 ? slip_force * asperity_tangential_shape(t->form, v, bound, &derivative) : (t->form == 2 ? f_t : slip_force);
    keep = asperity_exponential(-flow) * (most < f_t ? most / f_t : ASPERITY_R(1.0));
    p->x = asperity_tangential_shape_inverse(t->form, v, keep * f_t / slip_force, &after);
    shape = asperity_normal_shape(t->form, v, p->x, after, &derivative);
    raised = v->f_n0 - (v->f_n0 - v->f_n_slip) * shape;
    if (derivatives) {
        falls = (v->f_n0 - v->f_n_slip) * derivative;
        asperity_tangential_shape(t->form, v, p->x, &derivative);
        rises = slip_force * derivative;
        gain = rises > zero ? falls * keep * f_t / (v->f_n0 * rises) : zero;
        along = v->slope * (raised / v->f_n0 + gain);
        slope = along + rate * gain * (stiffness - along);
        p->df_n_dh = raised < p->f_n && slope < stiffness ? slope : stiffness;
    }
    asperity_scale(s->deflection, keep);
    p->force[0] *= keep;
    p->force[1] *= keep;
    if (raised < p->f_n) {
        p->level += asperity_log_ratio(raised, p->f_n);
        p->f_n = raised;
        p->approach = -ASPERITY_R(1.0);
        asperity_limits(t->friction, v, p->f_n, asperity_exponential(p->level / v->backbone), p->limit);
    }
}

/* Moves delta_T with h held; returns what the sliders dissipate. */
ASPERITY_FN asperity_real asperity_shear(
    const asperity_table *t, asperity_state *s, asperity_response *out, asperity_tangent *tangent, const asperity_curve *v, asperity_pressed *p,
    asperity_real d0, asperity_real d1) {
    asperity_real before[2][ASPERITY_SLIDERS], held[2], stiffness[2][2], direction[2], m[2], slip;
    asperity_real slip_force, bound, trial, along, excess, travel, beyond, forward, x, cap, shape_slope, normal_slope, size, per_x, loss, keep, rate, radial, f_n = p->f_n;
    int i, j;
    ASPERITY_LANES
    for (i = 0; i < ASPERITY_SLIDERS; i++) {
        before[0][i] = s->deflection[0][i];
        before[1][i] = s->deflection[1][i];
    }
    slip = v->k_t * asperity_slide(before, p->limit, d0, d1, s->deflection);
    out->f_n = f_n;
    asperity_slider_force(v, s->deflection, out->f_t);
    if (tangent) {
        asperity_slider_stiffness(v, before, p->limit, d0, d1, tangent->df_t_ddelta);
    }
    if (s->x >= ASPERITY_R(1.0) || v->elastic) {
        return slip;
    }
    slip_force = t->friction * v->f_n_slip;
    bound = slip_force * asperity_tangential_shape(t->form, v, s->x, &shape_slope);
    trial = ASPERITY_SQRT(out->f_t[0] * out->f_t[0] + out->f_t[1] * out->f_t[1]);
    if (trial <= ASPERITY_AT_BOUND * bound) {
        return slip;
    }
    direction[0] = out->f_t[0] / trial;
    direction[1] = out->f_t[1] / trial;
    along = direction[0] * p->force[0] + direction[1] * p->force[1];
    excess = trial - bound;
    travel = trial - along;
    beyond = excess < travel ? excess / travel : ASPERITY_R(1.0); /* share of the increment that is beyond the curve */
    forward = direction[0] * d0 + direction[1] * d1;
    forward = forward > ASPERITY_R(0.0) ? forward : ASPERITY_R(0.0);
    x = s->x + beyond * forward / v->delta_t_slip;
    s->x = x < ASPERITY_R(1.0) ? x : ASPERITY_R(1.0);
    cap = v->f_n0 - (v->f_n0 - v->f_n_slip) * asperity_normal_shape(t->form, v, s->x, -1, &normal_slope);
    out->f_n = cap < f_n ? cap : f_n;
    if (out->f_n != f_n) {
        asperity_real levels[2];
        p->level += asperity_log_ratio(out->f_n, f_n);
        levels[0] = p->level / v->backbone;
        levels[1] = p->level / v->gamma;
        asperity_exponentials(levels, 2);
        p->approach = v->depth * levels[1];
        asperity_limits(t->friction, v, out->f_n, levels[0], p->limit);
        slip = v->k_t * asperity_slide(before, p->limit, d0, d1, s->deflection);
    }
    asperity_slider_force(v, s->deflection, held);
    bound = slip_force * asperity_tangential_shape(t->form, v, s->x, &shape_slope);
    size = ASPERITY_SQRT(held[0] * held[0] + held[1] * held[1]);
    out->f_t[0] = held[0];
    out->f_t[1] = held[1];
    keep = size > bound ? bound / size : ASPERITY_R(1.0);
    if (tangent) {
        per_x = beyond / v->delta_t_slip;
        loss = (v->f_n0 - v->f_n_slip) * normal_slope;
        asperity_slider_stiffness(v, before, p->limit, d0, d1, stiffness);
        m[0] = held[0] / size;
        m[1] = held[1] / size;
        rate = slip_force * shape_slope * per_x;
        for (j = 0; j < 2; j++) {
            tangent->df_n_ddelta[j] = -loss * per_x * direction[j];
            radial = m[0] * stiffness[0][j] + m[1] * stiffness[1][j];
            for (i = 0; i < 2; i++) {
                tangent->df_t_ddelta[i][j] = size > bound ? rate * m[i] * direction[j] + keep * (stiffness[i][j] - m[i] * radial) : stiffness[i][j];
            }
        }
    }
    if (size > bound) {
        asperity_scale(s->deflection, keep);
        out->f_t[0] = keep * held[0];
        out->f_t[1] = keep * held[1];
    }
    return slip;
}

/* Turns the memory into axes that are turned by an angle: new components of a vector v are (c v0 + s v1, -s v0 + c v1). */
ASPERITY_FN void asperity_rotate(asperity_state *state, asperity_real cosine, asperity_real sine) {
    int i;
    ASPERITY_LANES
    for (i = 0; i < ASPERITY_SLIDERS; i++) {
        asperity_real q0 = state->deflection[0][i], q1 = state->deflection[1][i];
        state->deflection[0][i] = cosine * q0 + sine * q1;
        state->deflection[1][i] = -sine * q0 + cosine * q1;
    }
}

/* Energy that a state stores on its curve. */
ASPERITY_FN asperity_real asperity_energy(const asperity_curve *v, asperity_real f_n, asperity_real approach, asperity_real deflection[2][ASPERITY_SLIDERS]) {
    return f_n * approach / (v->gamma + ASPERITY_R(1.0)) + asperity_slider_energy(v, deflection);
}

/* *to = *from, without the string instruction that compilers make of it. */
ASPERITY_FN void asperity_copy(const asperity_state *from, asperity_state *to) {
    int i;
    to->h = from->h;
    to->h_max = from->h_max;
    to->approach = from->approach;
    to->x = from->x;
    ASPERITY_LANES
    for (i = 0; i < ASPERITY_SLIDERS; i++) {
        to->deflection[0][i] = from->deflection[0][i];
        to->deflection[1][i] = from->deflection[1][i];
    }
}

/* Moves a contact to the indentation h and along the plane by `increment`, the press first. `next` may be `state`; `tangent` may be NULL. Where h or the increment is not finite,
 * nothing in the answer is a number and the state stays as it was. */
ASPERITY_FN void asperity_update(
    const asperity_table *t, asperity_real radius, asperity_real modulus, const asperity_state *state, asperity_real h, const asperity_real increment[2],
    asperity_state *next, asperity_response *out, asperity_tangent *tangent) {
    const asperity_real zero = ASPERITY_R(0.0);
    asperity_state s;
    asperity_row row, old_row;
    asperity_curve v, old;
    const asperity_curve *before = &v;
    asperity_pressed p;
    asperity_real inverse = ASPERITY_R(1.0) / radius, force = modulus * radius * radius, work = force * radius, d0, d1, size, greatest, dh, log_h, exponential[8], level, old_n, old_t[2], stored, total, slip;
    memset(out, 0, sizeof *out);
    if (tangent) {
        memset(tangent, 0, sizeof *tangent);
    }
    h *= inverse;
    d0 = increment[0] * inverse;
    d1 = increment[1] * inverse;
    if (!asperity_is_finite(h) || !asperity_is_finite(d0) || !asperity_is_finite(d1)) {
        asperity_real bad = asperity_no_number();
        out->f_n = out->f_t[0] = out->f_t[1] = out->stiffness = out->stored = out->plastic = out->friction = bad;
        if (tangent) {
            tangent->df_t_ddelta[0][0] = tangent->df_t_ddelta[0][1] = tangent->df_t_ddelta[1][0] = tangent->df_t_ddelta[1][1] = bad;
            tangent->df_n_dh = tangent->df_n_ddelta[0] = tangent->df_n_ddelta[1] = tangent->a = bad;
        }
        *next = *state;
        return;
    }
    size = ASPERITY_ABS(d0) > ASPERITY_ABS(d1) ? ASPERITY_ABS(d0) : ASPERITY_ABS(d1);
    if (size > ASPERITY_MOST) {
        d0 = d0 / size * ASPERITY_MOST;
        d1 = d1 / size * ASPERITY_MOST;
    }
    greatest = h > state->h_max ? h : state->h_max;
    dh = h - state->h;
    if (!(greatest > zero) || (h <= state->h_max && state->approach <= zero && state->approach + dh <= zero)) {
        /* An open gap, before the first contact or over a dent: no slider is deflected. */
        asperity_real h_max = state->h_max, approach = state->approach, place = state->x;
        if (greatest > zero) {
            place = dh == zero ? place : ASPERITY_R(1.0);
            approach += dh;
        }
        if (next != state) {
            memset(next->deflection, 0, sizeof next->deflection);
        }
        next->h = h;
        next->h_max = h_max;
        next->approach = approach;
        next->x = place;
        return;
    }
    asperity_copy(state, &s);
    log_h = ASPERITY_LOG(greatest);
    asperity_read_row(t, log_h, &row, exponential);
    if (h > s.h_max && s.h_max > zero) {
        asperity_read_row(t, log_h + asperity_log_ratio(s.h_max, h), &old_row, exponential + 4);
        asperity_exponentials(exponential, 8);
        asperity_make_curve(t, s.h_max, &old_row, exponential + 4, 0, &old);
        before = &old;
    } else {
        asperity_exponentials(exponential, 4);
    }
    asperity_make_curve(t, greatest, &row, exponential, 1, &v);
    level = s.h_max > zero && s.approach > zero ? asperity_level_at(before, s.approach) : zero;
    old_n = s.h_max > zero && s.approach > zero ? before->f_n0 * asperity_exponential(level) : zero;
    asperity_slider_force(before, s.deflection, old_t);
    stored = old_n > zero ? asperity_energy(before, old_n, s.approach, s.deflection) : zero;
    if (h <= s.h_max && s.approach + dh <= zero) {
        /* Contact is lost: what it stored was given back or slipped away. */
        total = ASPERITY_R(0.5) * (old_n * dh + old_t[0] * d0 + old_t[1] * d1) + stored;
        out->friction = total > zero ? work * total : zero;
        next->h = h;
        next->h_max = s.h_max;
        next->x = dh == zero ? s.x : ASPERITY_R(1.0);
        next->approach = s.approach + dh;
        memset(next->deflection, 0, sizeof next->deflection);
        return;
    }
    asperity_press(t, &s, &v, before, level, h, tangent != NULL, &p);
    s.h = h;
    s.h_max = greatest;
    s.x = p.x;
    slip = p.slip + asperity_shear(t, &s, out, tangent, &v, &p, d0, d1);
    if (dh != zero || out->f_n != p.f_n) {
        s.approach = p.approach >= zero ? p.approach : v.depth * asperity_exponential(p.level / v.gamma);
    }
    if (tangent) {
        tangent->df_n_dh = p.df_n_dh * modulus * radius;
        tangent->a = v.contact_radius * asperity_power(s.approach / v.depth, v.gamma - ASPERITY_R(1.0)) * radius;
        tangent->df_n_ddelta[0] *= modulus * radius;
        tangent->df_n_ddelta[1] *= modulus * radius;
        tangent->df_t_ddelta[0][0] *= modulus * radius;
        tangent->df_t_ddelta[0][1] *= modulus * radius;
        tangent->df_t_ddelta[1][0] *= modulus * radius;
        tangent->df_t_ddelta[1][1] *= modulus * radius;
    }
    out->stored = asperity_energy(&v, out->f_n, s.approach, s.deflection);
    /* What was done (by the mean of the forces before and after) and is not stored. The sliders' share is friction's, all of it in an elastic contact; the rest plastic flow's. */
    total = ASPERITY_R(0.5) * ((old_n + out->f_n) * dh + (old_t[0] + out->f_t[0]) * d0 + (old_t[1] + out->f_t[1]) * d1) - (out->stored - stored);
    slip = v.elastic ? total : slip;
    out->friction = work * slip;
    out->plastic = work * (total - slip);
    out->stiffness = v.gamma * out->f_n / s.approach * modulus * radius;
    out->stored *= work;
    out->f_n *= force;
    out->f_t[0] *= force;
    out->f_t[1] *= force;
    asperity_copy(&s, next);
}

/* Elastic energy that a contact stores. */
ASPERITY_FN asperity_real asperity_stored_energy(const asperity_table *t, asperity_real radius, asperity_real modulus, const asperity_state *state) {
    asperity_curve v;
    asperity_state s = *state;
    if (!(s.h_max > ASPERITY_R(0.0)) || s.approach <= ASPERITY_R(0.0)) {
        return ASPERITY_R(0.0);
    }
    asperity_first_loading(t, s.h_max, 0, &v);
    return modulus * radius * radius * radius * asperity_energy(&v, asperity_force_at(&v, s.approach), s.approach, s.deflection);
}

/* Whether a contact has been deeper than the law was made for. */
ASPERITY_FN int asperity_out_of_range(const asperity_table *t, const asperity_state *state) {
    return state->h_max > t->deepest * ASPERITY_R(1.0 + 1e-6);
}

#ifndef ASPERITY_NO_FILES
/* One line "name value" of a table's file. */
static inline int asperity_read_number(FILE *file, const char *name, asperity_real *value) {
    char found[32];
    double number;
    if (fscanf(file, "%31s %lf", found, &number) != 2 || strcmp(found, name) != 0) {
        return 0;
    }
    *value = ASPERITY_R(number);
    return asperity_is_finite(*value);
}

/* Reads a file that `asperity law export` wrote. Returns 0; 1: it cannot be opened, 2: it is no such file or of another version, 3: it is cut short or damaged. */
static inline int asperity_read_table(const char *path, asperity_table *t) {
    char body[32];
    asperity_real form;
    int version, i, j, k, good;
    double number;
    FILE *file = fopen(path, "r");
    if (!file) {
        return 1;
    }
    if (fscanf(file, "asperity-contact-table %d body %31s", &version, body) != 2 || version != 1) {
        fclose(file);
        return 2;
    }
    t->plane = strcmp(body, "plane") == 0;
    good = asperity_read_number(file, "share", &t->share) && asperity_read_number(file, "poissons_ratio", &t->poissons_ratio) &&
           asperity_read_number(file, "friction", &t->friction) && asperity_read_number(file, "effective_modulus", &t->effective_modulus) &&
           asperity_read_number(file, "effective_radius", &t->effective_radius) &&
           asperity_read_number(file, "deepest", &t->deepest) && asperity_read_number(file, "form", &form) &&
           asperity_read_number(file, "log_first", &t->log_first) && asperity_read_number(file, "log_step", &t->log_step);
    t->form = good ? (int)form : 0;
    good = good && fscanf(file, " %31s", body) == 1 && strcmp(body, "knots") == 0;
    for (i = 0; good && i < ASPERITY_KNOTS; i++) {
        for (j = 0; good && j < 2; j++) {
            for (k = 0; good && k < ASPERITY_COLUMNS; k++) {
                good = fscanf(file, "%lf", &number) == 1;
                t->knots[i][j][k] = ASPERITY_R(number);
            }
        }
    }
    good = good && fscanf(file, " %31s", body) == 1 && strcmp(body, "shapes") == 0;
    for (i = 0; good && i < ASPERITY_LEVELS; i++) {
        for (j = 0; good && j < 2; j++) {
            for (k = 0; good && k < ASPERITY_POINTS; k++) {
                good = fscanf(file, "%lf", &number) == 1;
                t->shapes[i][j][k] = ASPERITY_R(number);
            }
        }
    }
    good = good && fscanf(file, " %31s", body) == 1 && strcmp(body, "end") == 0;
    fclose(file);
    return good ? 0 : 3;
}
#endif

#endif
