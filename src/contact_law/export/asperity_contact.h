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
 * The law: on first loading at constant h, with x = |delta_T|/delta_T_end, F_T = mu F_N_slip f_T(x), F_N = F_N0 - (F_N0 - F_N_slip) f_N(x). Inside that curve the contact is
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
#include <locale.h>
#include <stdio.h>
#include <stdlib.h>
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

/* Lanes that straddle lines of the cache cost twice. */
#if defined(__GNUC__) && !defined(__CUDACC__)
#define ASPERITY_ALIGNED __attribute__((aligned(64)))
#else
#define ASPERITY_ALIGNED
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
#define ASPERITY_AT_SLIP (1.0f - 2e-7f)
#define ASPERITY_AT_BOUND (1.0f + 2.4e-7f) /* two roundings: a wider one lets a contact that begins to slip wait for a step */
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
#define ASPERITY_AT_SLIP (1.0 - 1e-13)
#define ASPERITY_AT_CAP (1.0 - 1e-9) /* rounding is not taken for unloading */
#define ASPERITY_AT_BOUND (1.0 + 1e-10)
#endif
#define ASPERITY_R(x) ((asperity_real)(x))

/* a b + c, in one operation where the machine has it. */
#if defined(FP_FAST_FMA) && !defined(ASPERITY_SINGLE)
#define ASPERITY_FMA(a, b, c) fma(a, b, c)
#elif defined(FP_FAST_FMAF) && defined(ASPERITY_SINGLE)
#define ASPERITY_FMA(a, b, c) fmaf(a, b, c)
#else
#define ASPERITY_FMA(a, b, c) ((a) * (b) + (c))
#endif

#define ASPERITY_KNOTS @KNOTS@
#define ASPERITY_COLUMNS @COLUMNS@
#define ASPERITY_SLIDERS 16 /* asperity_weights() and asperity_sliders() are written for this number */
#define ASPERITY_POINTS @POINTS@ /* of a shape that is given by numbers, x = (j/points)^2; asperity_given_search() is written for 24 */
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
    asperity_real first;             /* h of the first knot */
    asperity_real log_step;
    asperity_real gentle;            /* exponent of f_N: N of form 0, M of form 1 */
    /* F_N0, 1/a (2 E* a is the stiffness of an unloading), 1/delta_T_end, k_T, F_N_slip/F_N0, n (with form 2 c of the yield curve), the contact radius over a, the
     * steep exponent of f_N (with form 2 that of the sliders' backbone) at a knot; towards the next, of the logarithms of the first four and of the others, the
     * coefficients of u, u^2 and u^3, where u is the share of a step. So nothing is lost to the size of a logarithm in float. */
    asperity_real knots[ASPERITY_KNOTS][4][ASPERITY_COLUMNS];
    asperity_real shapes[ASPERITY_LEVELS][2][ASPERITY_POINTS];
} asperity_table;

/* The memory of a contact, lengths over R. */
typedef struct asperity_state {
    asperity_real h;
    asperity_real h_max;
    asperity_real approach; /* elastic: what is recovered until contact is lost; negative: the gap over the residual dent */
    asperity_real reach;    /* elastic approach from which it is released: F_N = 2 E* a reach/gamma (approach/reach)^gamma; falls with F_N where shear takes that */
    asperity_real x;        /* place on the virgin curves: the measure of F_N lost to shear; beyond 1, up to 2, of what reversed slip costs besides */
    asperity_real sheared;  /* the place up to which the contact has hardened in shear */
    asperity_real reversed; /* 0 to 1: how far its slip was reversed, after which it turns more sharply */
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

/* Of simulated oblique presses, rebounds and reversals; asperity's model of the update says what they are. */
#define ASPERITY_PRESSED ASPERITY_R(0.9)
#define ASPERITY_LEAST_NORMAL ASPERITY_R(0.25)
#define ASPERITY_SUDDEN ASPERITY_R(0.2)
#define ASPERITY_FORGETS ASPERITY_R(4.0)
#define ASPERITY_GONE ASPERITY_R(1e-5)
#define ASPERITY_LEAST_TRAVEL ASPERITY_R(0.4)
#define ASPERITY_RELAXATION ASPERITY_R(0.1)
#define ASPERITY_REVERSED ASPERITY_R(0.05)
#define ASPERITY_LEAST_REVERSED ASPERITY_R(1e-6)
#define ASPERITY_SLIDING ASPERITY_R(0.98)
#define ASPERITY_GATHERED ASPERITY_R(0.7)
#define ASPERITY_ALL_LOST ASPERITY_R(2.0) /* x after all of what reversed slip costs */
#define ASPERITY_UNSHEARED ASPERITY_R(2.0)
#define ASPERITY_TAKEN_BACK ASPERITY_R(0.9)
#define ASPERITY_NO_CHANGE ASPERITY_R(0.15)
#define ASPERITY_FIRST ASPERITY_R(1.5)
#define ASPERITY_LATER ASPERITY_R(1.15)
#define ASPERITY_HARDLY ASPERITY_R(0.02)

/* What a virgin contact answers at one indentation. */
typedef struct asperity_curve {
    asperity_real first; /* exponent of the sliders' backbone in a first reversal of a contact that was sheared */
    asperity_real f_n0, f_n_slip, m, big_n, k_t;
    asperity_real n;             /* of f_T; with form 2 c of the yield curve */
    asperity_real radii;         /* contact radius over a */
    asperity_real per_slip;      /* 1/delta_T_end, */
    asperity_real per_a;         /* 1/a, of F_N0 */
    asperity_real per_force, per_gamma, per_backbone, per_n; /* and 1/F_N0, ... */
    asperity_real slope;    /* dF_N0/dh */
    asperity_real gamma;    /* unloading: F_N = F_N0 (e/depth)^gamma */
    asperity_real depth;
    asperity_real backbone; /* exponent of the sliders' */
    int elastic;            /* whether shear costs no normal force */
    ASPERITY_ALIGNED asperity_real lost[ASPERITY_SLIDERS]; /* approach over depth at which a slider's annulus loses contact */
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
        r = ASPERITY_FMA((float)k, 2.12194440e-4f, ASPERITY_FMA((float)k, -0.693359375f, y));
        p = ASPERITY_FMA(r, 1.984127e-4f, 1.3888889e-3f);
        p = ASPERITY_FMA(r, ASPERITY_FMA(r, p, 8.3333333e-3f), 4.1666667e-2f);
        p = ASPERITY_FMA(r, ASPERITY_FMA(r, p, 1.6666667e-1f), 0.5f);
        p = ASPERITY_FMA(r, ASPERITY_FMA(r, p, 1.0f), 1.0f);
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
        r = ASPERITY_FMA((double)k, -1.90821492927058770002e-10, ASPERITY_FMA((double)k, -6.93147180369123816490e-01, y));
        r2 = r * r;
        r4 = r2 * r2;
        p = ASPERITY_FMA(r2, ASPERITY_FMA(r, 1.0 / 39916800.0, 1.0 / 3628800.0), ASPERITY_FMA(r, 1.0 / 362880.0, 1.0 / 40320.0));
        p = ASPERITY_FMA(r4, ASPERITY_FMA(r, 1.0 / 6227020800.0, 1.0 / 479001600.0), p);
        p = ASPERITY_FMA(r4, p, ASPERITY_FMA(r2, ASPERITY_FMA(r, 1.0 / 5040.0, 1.0 / 720.0), ASPERITY_FMA(r, 1.0 / 120.0, 1.0 / 24.0)));
        p = ASPERITY_FMA(r4, p, ASPERITY_FMA(r2, ASPERITY_FMA(r, 1.0 / 6.0, 1.0 / 2.0), 1.0 + r));
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
    y *= ASPERITY_FMA(-half * y, y, ASPERITY_R(1.5));
    y *= ASPERITY_FMA(-half * y, y, ASPERITY_R(1.5));
    y *= ASPERITY_FMA(-half * y, y, ASPERITY_R(1.5));
#ifndef ASPERITY_SINGLE
    y *= ASPERITY_FMA(-half * y, y, ASPERITY_R(1.5));
#endif
    return y;
}

/* ln(1 + r), |r| <= 1/64, by its series. */
ASPERITY_FN asperity_real asperity_log_series(asperity_real r) {
    asperity_real r2 = r * r, p, q;
    p = ASPERITY_FMA(r2, ASPERITY_FMA(r, ASPERITY_R(1.0 / 9.0), ASPERITY_R(-1.0 / 8.0)), ASPERITY_FMA(r, ASPERITY_R(1.0 / 7.0), ASPERITY_R(-1.0 / 6.0)));
    q = ASPERITY_FMA(r2, ASPERITY_FMA(r, ASPERITY_R(1.0 / 5.0), ASPERITY_R(-1.0 / 4.0)), ASPERITY_FMA(r, ASPERITY_R(1.0 / 3.0), ASPERITY_R(-1.0 / 2.0)));
    return ASPERITY_FMA(r2, ASPERITY_FMA(r2 * r2, p, q), r);
}

/* ln x, x > 0, in line: of 2^k c (1 + r), with c from 32 places and |r| <= 1/64. */
ASPERITY_FN asperity_real asperity_logarithm(asperity_real x) {
    static const asperity_real inverse[32] = {
        ASPERITY_R(1.4223978268922088), ASPERITY_R(1.391468746307456), ASPERITY_R(1.3618562535370686), ASPERITY_R(1.3334780249593055),
        ASPERITY_R(1.3062584608976362), ASPERITY_R(1.2801280128012802), ASPERITY_R(1.2550225896376046), ASPERITY_R(1.2308830328247804),
        ASPERITY_R(1.207654650645305), ASPERITY_R(1.1852868044242475), ASPERITY_R(1.163732539879329), ASPERITY_R(1.1429482579925057),
        ASPERITY_R(1.122893420546364), ASPERITY_R(1.1035302861389817), ASPERITY_R(1.084823673058967), ASPERITY_R(1.066740745885131),
        ASPERITY_R(1.0492508230867432), ASPERITY_R(1.0323252032520325), ASPERITY_R(1.0159370078740158), ASPERITY_R(1.0),
        ASPERITY_R(0.9699196326061997), ASPERITY_R(0.9413800562405364), ASPERITY_R(0.9144723412941417), ASPERITY_R(0.8890603897356743),
        ASPERITY_R(0.8650228310502284), ASPERITY_R(0.8422510822510821), ASPERITY_R(0.8206477067236561), ASPERITY_R(0.8001250195343023),
        ASPERITY_R(0.7806038970697605), ASPERITY_R(0.7620127569099929), ASPERITY_R(0.7442866801893171), ASPERITY_R(0.7273666537517758)};
    static const asperity_real log_c[32] = {
        ASPERITY_R(-0.3523440580008923), ASPERITY_R(-0.3303598412985515), ASPERITY_R(-0.3088486614358244), ASPERITY_R(-0.28779058528352974),
        ASPERITY_R(-0.26716691395221637), ASPERITY_R(-0.2469600829318592), ASPERITY_R(-0.2271535721329931), ASPERITY_R(-0.2077318246738307),
        ASPERITY_R(-0.18868017341225488), ASPERITY_R(-0.1699847743527869), ASPERITY_R(-0.1516325461705557), ASPERITY_R(-0.1336111151900369),
        ASPERITY_R(-0.11590876523852209), ASPERITY_R(-0.09851439186497558), ASPERITY_R(-0.08141746047599635), ASPERITY_R(-0.06460796799339279),
        ASPERITY_R(-0.0480764076837151), ASPERITY_R(-0.03181373684993537), ASPERITY_R(-0.01581134711020277), ASPERITY_R(0.0),
        ASPERITY_R(0.030542063900505807), ASPERITY_R(0.06040833545244689), ASPERITY_R(0.08940805622954394), ASPERITY_R(0.11759011581397946),
        ASPERITY_R(0.1449993781208599), ASPERITY_R(0.1716771117439915), ASPERITY_R(0.1976613642714418), ASPERITY_R(0.22298728910590676),
        ASPERITY_R(0.24768743184511172), ASPERITY_R(0.2717919820839289), ASPERITY_R(0.2953289955317206), ASPERITY_R(0.31832459054884527)};
#ifdef ASPERITY_SINGLE
    const asperity_bits from = 0x3f320000u;
    const int digits = 23;
    const float least = 1e-30f, greatest = 1e30f;
    int64_t away;
#else
    const asperity_bits from = 0x3fe6400000000000ull;
    const int digits = 52;
    const double least = 1e-300, greatest = 1e300;
    int64_t away;
#endif
    asperity_bits bits;
    asperity_real z, r, k;
    int place;
    if (!(x > least && x < greatest)) {
        return ASPERITY_LOG(x);
    }
    memcpy(&bits, &x, sizeof bits);
    away = (int64_t)bits - (int64_t)from;
    place = (int)(away >> (digits - 5)) & 31;
    k = ASPERITY_R((int)(away >> digits));
    bits -= (asperity_bits)((away >> digits) * ((int64_t)1 << digits));
    memcpy(&z, &bits, sizeof z);
    r = ASPERITY_FMA(z, inverse[place], ASPERITY_R(-1.0));
    return ASPERITY_FMA(k, ASPERITY_R(0.6931471805599453), log_c[place]) + asperity_log_series(r);
}

/* e^x of one number, in the range of the other: 2^(k/32) e^r. */
ASPERITY_FN asperity_real asperity_exponential(asperity_real x) {
    static const asperity_real root[32] = {
        ASPERITY_R(1.0), ASPERITY_R(1.0218971486541166), ASPERITY_R(1.0442737824274138), ASPERITY_R(1.0671404006768237),
        ASPERITY_R(1.0905077326652577), ASPERITY_R(1.1143867425958924), ASPERITY_R(1.1387886347566916), ASPERITY_R(1.1637248587775775),
        ASPERITY_R(1.189207115002721), ASPERITY_R(1.215247359980469), ASPERITY_R(1.241857812073484), ASPERITY_R(1.2690509571917332),
        ASPERITY_R(1.2968395546510096), ASPERITY_R(1.3252366431597413), ASPERITY_R(1.3542555469368927), ASPERITY_R(1.383909881963832),
        ASPERITY_R(1.4142135623730951), ASPERITY_R(1.4451808069770467), ASPERITY_R(1.4768261459394993), ASPERITY_R(1.5091644275934228),
        ASPERITY_R(1.5422108254079407), ASPERITY_R(1.5759808451078865), ASPERITY_R(1.6104903319492543), ASPERITY_R(1.645755478153965),
        ASPERITY_R(1.681792830507429), ASPERITY_R(1.718619298122478), ASPERITY_R(1.7562521603732995), ASPERITY_R(1.7947090750031072),
        ASPERITY_R(1.8340080864093424), ASPERITY_R(1.8741676341103), ASPERITY_R(1.9152065613971474), ASPERITY_R(1.9571441241754002)};
#ifdef ASPERITY_SINGLE
    const asperity_real most = 80.0f, high = 0.02165985107421875f, low = 9.983182795409192e-07f;
    const int digits = 23;
#else
    const asperity_real most = 700.0, high = 0.021660849335603416, low = 5.689487495325457e-11;
    const int digits = 52;
#endif
    asperity_real r = x, r2, scaled;
    asperity_bits bits;
    int k;
    r = r < most ? r : most;
    r = r > -most ? r : -most;
    k = (int)(r * ASPERITY_R(46.16624130844683) + ASPERITY_R(32768.5)) - 32768;
    r = ASPERITY_FMA(ASPERITY_R(k), -low, ASPERITY_FMA(ASPERITY_R(k), -high, r));
    r2 = r * r;
    scaled = root[k & 31];
    memcpy(&bits, &scaled, sizeof bits);
    bits += (asperity_bits)(k >> 5) << digits;
    memcpy(&scaled, &bits, sizeof bits);
    x = ASPERITY_FMA(r2, ASPERITY_FMA(r2, ASPERITY_R(1.0 / 720.0), ASPERITY_FMA(r, ASPERITY_R(1.0 / 120.0), ASPERITY_R(1.0 / 24.0))), ASPERITY_FMA(r, ASPERITY_R(1.0 / 6.0), ASPERITY_R(1.0 / 2.0)));
    return ASPERITY_FMA(scaled, ASPERITY_FMA(r2, x, r), scaled);
}

/* e^x of a number that is small in most steps of time: then its series. */
ASPERITY_FN asperity_real asperity_exponential_near(asperity_real x) {
    asperity_real x2 = x * x, near, far;
    if (ASPERITY_ABS(x) > ASPERITY_R(0.03125)) {
        return asperity_exponential(x);
    }
    near = ASPERITY_FMA(x, ASPERITY_R(1.0 / 6.0), ASPERITY_R(1.0 / 2.0));
    far = ASPERITY_FMA(x2, ASPERITY_FMA(x, ASPERITY_R(1.0 / 5040.0), ASPERITY_R(1.0 / 720.0)), ASPERITY_FMA(x, ASPERITY_R(1.0 / 120.0), ASPERITY_R(1.0 / 24.0)));
    return ASPERITY_R(1.0) + ASPERITY_FMA(x2, ASPERITY_FMA(x2, far, near), x);
}

/* base^exponent, 0 <= base. */
ASPERITY_FN asperity_real asperity_power(asperity_real base, asperity_real exponent) {
    return base > ASPERITY_R(0.0) ? asperity_exponential(exponent * asperity_logarithm(base)) : ASPERITY_R(0.0);
}

/* Whether a number is finite, also where the compiler was told that all are. */
ASPERITY_FN int asperity_is_finite(asperity_real x) {
    asperity_bits bits;
    memcpy(&bits, &x, sizeof bits);
    return (bits & ASPERITY_INFINITE_BITS) != ASPERITY_INFINITE_BITS;
}

/* ln(a/b), a, b > 0: by its series where they are near to each other, as from one step of time to the next. */
ASPERITY_FN asperity_real asperity_log_ratio(asperity_real a, asperity_real b) {
    asperity_real z = (a - b) / b, ratio;
    if (ASPERITY_ABS(z) <= ASPERITY_R(0.015625)) {
        return asperity_log_series(z);
    }
    ratio = a / b;
    return ratio > ASPERITY_R(0.0) && asperity_is_finite(ratio) ? ASPERITY_LOG(ratio) : ASPERITY_LOG(a) - ASPERITY_LOG(b);
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

/* A row of the table: its position, its columns, the slope of the first; and what the first four have grown by from their knot, as logarithms. */
typedef struct asperity_row {
    asperity_real position, slope, column[ASPERITY_COLUMNS];
} asperity_row;

/* The row at ln(h/first). */
ASPERITY_FN void asperity_read_row(const asperity_table *t, asperity_real log_h, asperity_row *row, asperity_real growth[4]) {
    /* Powers of h in Hertz's contact, for what lies below the first knot. */
    static const asperity_real hertz[ASPERITY_COLUMNS] = {
        ASPERITY_R(1.5), ASPERITY_R(-0.5), ASPERITY_R(-1.0), ASPERITY_R(0.5), ASPERITY_R(0.0), ASPERITY_R(0.0), ASPERITY_R(0.0), ASPERITY_R(0.0)};
    asperity_real per_step = ASPERITY_R(1.0) / t->log_step, position = log_h * per_step, last = ASPERITY_R(ASPERITY_KNOTS - 1);
    asperity_real slope, u, grown[ASPERITY_COLUMNS] ASPERITY_ALIGNED;
    int c, i = 0;
    if (position < ASPERITY_R(0.0)) {
        for (c = 0; c < ASPERITY_COLUMNS; c++) {
            grown[c] = hertz[c] * log_h;
        }
        slope = hertz[0];
    } else if (!(position < last)) {
        /* Logarithms go on straight, the others stay. What is no number comes here too. */
        i = ASPERITY_KNOTS - 1;
        for (c = 0; c < ASPERITY_COLUMNS; c++) {
            grown[c] = c < 4 ? t->knots[i][1][c] * (position - last) : ASPERITY_R(0.0);
        }
        slope = t->knots[i][1][0] * per_step;
    } else {
        const asperity_real *k1, *k2, *k3;
        i = (int)position;
        k1 = t->knots[i][1];
        k2 = t->knots[i][2];
        k3 = t->knots[i][3];
        u = position - ASPERITY_R(i);
        ASPERITY_LANES
        for (c = 0; c < ASPERITY_COLUMNS; c++) {
            grown[c] = u * ASPERITY_FMA(u, ASPERITY_FMA(u, k3[c], k2[c]), k1[c]);
        }
        slope = (k1[0] + u * (ASPERITY_R(2.0) * k2[0] + ASPERITY_R(3.0) * u * k3[0])) * per_step;
    }
    row->position = position;
    row->slope = slope;
    for (c = 0; c < 4; c++) {
        growth[c] = grown[c];
        row->column[c] = t->knots[i][0][c];
        row->column[c + 4] = t->knots[i][0][c + 4] + grown[c + 4];
    }
}

/* The sliders of a contact that has yielded to shear at the place `sheared`, and whose slip was reversed: those of the first reversal of a contact that was sheared, where it was hardly
 * sheared those of which tractions are lost sooner as it is released, and where its slip was reversed those that turn more sharply. */
ASPERITY_FN void asperity_sharpen(asperity_curve *v, asperity_real sheared, asperity_real reversed) {
    asperity_real rest, lost = (ASPERITY_R(1.0) - v->f_n_slip / v->f_n0) / ASPERITY_HARDLY;
    v->backbone = v->first;
    if (!v->elastic) {
        lost = reversed * (lost < ASPERITY_R(1.0) ? lost : ASPERITY_R(1.0));
        v->backbone += v->backbone > ASPERITY_LATER ? (ASPERITY_LATER - v->backbone) * lost : ASPERITY_R(0.0);
        if (v->backbone < ASPERITY_UNSHEARED) {
            rest = sheared < ASPERITY_R(1.0) ? ASPERITY_R(1.0) - sheared : ASPERITY_R(0.0);
            rest *= rest;
            rest *= rest;
            v->backbone += (ASPERITY_UNSHEARED - v->backbone) * (rest * rest);
        }
    }
    v->per_backbone = ASPERITY_R(1.0) / v->backbone;
    asperity_sliders(v->backbone, v->lost);
}

/* First loading at the indentation h > 0, over R, from a row and its exponentials; where it is not to be `whole`, without what only sliding and shapes need. */
ASPERITY_FN void asperity_make_curve(const asperity_table *t, asperity_real h, const asperity_row *row, const asperity_real exponential[4], int whole, asperity_real sheared, asperity_real reversed, asperity_curve *v) {
    const asperity_real *column = row->column;
    asperity_real softness = ASPERITY_R(0.5) / t->effective_modulus, start, end, share, per_contact;
    v->f_n0 = column[0] * exponential[0];
    v->per_a = column[1] * exponential[1];
    v->f_n_slip = column[4] * v->f_n0;
    v->per_slip = column[2] * exponential[2];
    v->n = column[5];
    v->radii = column[6];
    v->m = t->form == 0 ? column[7] : t->gentle;
    v->big_n = t->form == 0 ? t->gentle : column[7];
    v->k_t = column[3] * exponential[3];
    /* 3/2 for Hertz, 4/pi for a uniform pressure (Mesarovic & Johnson 2000), by how far the force has fallen below Hertz's at that radius. */
    per_contact = t->form == 2 ? v->per_a : v->per_a / v->radii;
    share = v->f_n0 * (ASPERITY_R(1.5) * t->effective_radius * softness) * (per_contact * per_contact * per_contact);
    v->gamma = ASPERITY_R(1.2732395447351628) + ASPERITY_R(1.5 - 1.2732395447351628) * (share < ASPERITY_R(1.0) ? share : ASPERITY_R(1.0));
    v->depth = v->gamma * (v->f_n0 * v->per_a * softness);
    v->slope = v->f_n0 * row->slope / h;
    v->backbone = t->form == 2 ? v->big_n : (v->gamma < v->n ? v->gamma : v->n);
    v->elastic = v->f_n_slip >= ASPERITY_R(1.0 - 1e-6) * v->f_n0;
    /* The sliders must be able to follow the virgin curve: neither softer at its start, as a table's are, nor slower to slip. */
    start = t->form == 2 ? ASPERITY_R(0.0) : t->friction * v->per_slip * v->n * v->f_n_slip;
    end = t->friction * v->per_slip * v->backbone * v->f_n0;
    v->k_t = v->k_t < start ? start : v->k_t;
    v->k_t = v->k_t < end ? end : v->k_t;
    if (!whole) {
        return;
    }
    v->first = t->form == 2 && !v->elastic ? ASPERITY_R(1.0) + ASPERITY_FIRST * (v->backbone - ASPERITY_R(1.0)) : v->backbone;
    asperity_sharpen(v, sheared, reversed);
    v->per_force = ASPERITY_R(1.0) / v->f_n0;
    v->per_gamma = ASPERITY_R(1.0) / v->gamma;
    v->per_n = t->form == 2 ? ASPERITY_R(0.0) : ASPERITY_R(1.0) / v->n;
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
    asperity_read_row(t, ASPERITY_LOG(h / t->first), &row, exponential);
    asperity_exponentials(exponential, 4);
    asperity_make_curve(t, h, &row, exponential, whole, ASPERITY_R(1.0), ASPERITY_R(0.0), v);
}

/* Radius of the contact of first loading. */
ASPERITY_FN asperity_real asperity_radius(const asperity_curve *v) {
    return v->radii / v->per_a;
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

/* x at point j > 0, of the last one exactly 1: whether a contact slips as a whole is asked by it. */
ASPERITY_FN asperity_real asperity_peak_x(int j) {
    asperity_real share = ASPERITY_R(j) / ASPERITY_R(ASPERITY_POINTS);
    return share * share;
}

/* The last point that is not beyond x, of those that have one after them. */
ASPERITY_FN int asperity_point_before(asperity_real x) {
    int j = (int)(ASPERITY_R(ASPERITY_POINTS) * ASPERITY_SQRT(x));
    return j > ASPERITY_POINTS - 1 ? ASPERITY_POINTS - 1 : j;
}

/* The shape at an x between point j and the next, */
ASPERITY_FN asperity_real asperity_given(const asperity_curve *v, int kind, asperity_real x, int j) {
    asperity_real below = asperity_point(v, kind, j), rise = asperity_point(v, kind, j + 1) - below;
    return below + rise * ((x - asperity_point_x(j)) * (ASPERITY_R(ASPERITY_POINTS * ASPERITY_POINTS) / ASPERITY_R(2 * j + 1)));
}

/* its derivative there, */
ASPERITY_FN asperity_real asperity_given_slope(const asperity_curve *v, int kind, int j) {
    return (asperity_point(v, kind, j + 1) - asperity_point(v, kind, j)) * (ASPERITY_R(ASPERITY_POINTS * ASPERITY_POINTS) / ASPERITY_R(2 * j + 1));
}

/* and the x between point j and the next at which it is f. */
ASPERITY_FN asperity_real asperity_given_between(const asperity_curve *v, int kind, asperity_real f, int j) {
    asperity_real below = asperity_point(v, kind, j);
    return asperity_point_x(j) + (f - below) / (asperity_point(v, kind, j + 1) - below) * (ASPERITY_R(2 * j + 1) * (ASPERITY_R(1.0) / ASPERITY_R(ASPERITY_POINTS * ASPERITY_POINTS)));
}

/* A place on the virgin curves. */
typedef struct asperity_place {
    asperity_real x, f_t, f_n;
    int after; /* the point of the shapes by numbers before it */
} asperity_place;

/* The lesser and the greater of two numbers. */
ASPERITY_FN asperity_real asperity_least(asperity_real a, asperity_real b) {
    return a < b ? a : b;
}

ASPERITY_FN asperity_real asperity_most(asperity_real a, asperity_real b) {
    return a > b ? a : b;
}

/* The point before the least x at which a shape by numbers has the value f > 0; ASPERITY_POINTS where it stays below. */
ASPERITY_FN int asperity_given_search(const asperity_curve *v, int kind, asperity_real f) {
    static const asperity_real ramp[8] = {
        ASPERITY_R(0.0), ASPERITY_R(1.0), ASPERITY_R(2.0), ASPERITY_R(3.0), ASPERITY_R(4.0), ASPERITY_R(5.0), ASPERITY_R(6.0), ASPERITY_R(7.0)};
    const asperity_real *shallow = v->shallow[kind], *deep = v->deep[kind];
    asperity_real between = v->between, lane[8];
    int j;
    ASPERITY_LANES
    for (j = 0; j < 8; j++) {
        asperity_real near = shallow[j] + between * (deep[j] - shallow[j]), middle = shallow[j + 8] + between * (deep[j + 8] - shallow[j + 8]);
        asperity_real far = shallow[j + 16] + between * (deep[j + 16] - shallow[j + 16]), place = ASPERITY_R(ASPERITY_POINTS);
        place = far >= f ? ramp[j] + ASPERITY_R(16.0) : place;
        place = middle >= f ? ramp[j] + ASPERITY_R(8.0) : place;
        lane[j] = near >= f ? ramp[j] : place;
    }
    return (int)asperity_least(
        asperity_least(asperity_least(lane[0], lane[1]), asperity_least(lane[2], lane[3])), asperity_least(asperity_least(lane[4], lane[5]), asperity_least(lane[6], lane[7])));
}

/* The point before the first peak of a shape by numbers. */
ASPERITY_FN int asperity_given_peak(const asperity_curve *v, int kind) {
    asperity_real peak = ASPERITY_R(0.0);
    int j, place = 0;
    for (j = 1; j <= ASPERITY_POINTS; j++) {
        asperity_real here = asperity_point(v, kind, j);
        if (here > peak) {
            peak = here;
            place = j - 1;
        }
    }
    return place;
}

/* f_N of a law of formulas at x, 0 < x < 1, with the logarithm of 1 - x. */
ASPERITY_FN asperity_real asperity_complements(int form, const asperity_curve *v, asperity_real x, asperity_real log_rest) {
    const asperity_real one = ASPERITY_R(1.0);
    if (form == 0) {
        return asperity_power(one - asperity_exponential(v->m * log_rest), v->big_n);
    }
    return one - asperity_power(one - asperity_power(x, v->m), v->big_n);
}

/* f_T and f_N at x, 0 <= x <= 1. */
ASPERITY_FN void asperity_shapes(int form, const asperity_curve *v, asperity_real x, asperity_place *place) {
    const asperity_real one = ASPERITY_R(1.0);
    asperity_real log_rest;
    place->x = x;
    place->after = 0;
    place->f_t = place->f_n = ASPERITY_R(0.0);
    if (x <= ASPERITY_R(0.0)) {
        return;
    }
    if (form == 2) {
        place->after = asperity_point_before(x);
        place->f_t = asperity_given(v, 0, x, place->after);
        place->f_n = x < one ? asperity_given(v, 1, x, place->after) : one;
        return;
    }
    place->f_t = place->f_n = one;
    if (x >= one) {
        return;
    }
    log_rest = asperity_logarithm(one - x);
    place->f_t = one - asperity_exponential(v->n * log_rest);
    place->f_n = asperity_complements(form, v, x, log_rest);
}

/* The derivatives of f_T and f_N; those of f_N, and at x = 1 both, are 0 at the ends. */
ASPERITY_FN void asperity_slopes(int form, const asperity_curve *v, asperity_real x, asperity_real slope[2]) {
    const asperity_real one = ASPERITY_R(1.0), zero = ASPERITY_R(0.0);
    asperity_real rest, risen;
    slope[0] = slope[1] = zero;
    if (x >= one) {
        return;
    }
    if (form == 2) {
        int j = asperity_point_before(x);
        slope[0] = asperity_given_slope(v, 0, j);
        slope[1] = x > zero ? asperity_given_slope(v, 1, j) : zero;
        return;
    }
    slope[0] = v->n * asperity_power(one - x, v->n - one);
    if (x <= zero) {
        return;
    }
    if (form == 0) {
        rest = asperity_power(one - x, v->m);
        slope[1] = v->big_n * asperity_power(one - rest, v->big_n - one) * v->m * rest / (one - x);
    } else {
        risen = asperity_power(x, v->m);
        slope[1] = v->big_n * asperity_power(one - risen, v->big_n - one) * v->m * risen / x;
    }
}

/* The least x at which f_T has the value f, or its peak where it stays below. */
ASPERITY_FN void asperity_place_of(int form, const asperity_curve *v, asperity_real f, asperity_place *place) {
    const asperity_real one = ASPERITY_R(1.0);
    place->after = 0;
    place->f_t = f;
    if (f <= ASPERITY_R(0.0)) {
        place->x = place->f_t = place->f_n = ASPERITY_R(0.0);
    } else if (form == 2) {
        int j = asperity_given_search(v, 0, f);
        if (j == ASPERITY_POINTS) {
            j = asperity_given_peak(v, 0);
            place->f_t = asperity_point(v, 0, j + 1);
        }
        place->after = j;
        place->x = f > place->f_t ? asperity_peak_x(j + 1) : asperity_given_between(v, 0, place->f_t, j);
        place->f_n = asperity_given(v, 1, place->x, j);
    } else if (f >= one) {
        place->x = place->f_t = place->f_n = one;
    } else {
        asperity_real log_rest = asperity_logarithm(one - f) * v->per_n;
        place->x = one - asperity_exponential(log_rest);
        place->f_n = asperity_complements(form, v, place->x, log_rest);
    }
}

/* From a place back along the curve to where f_T is f, which is less. */
ASPERITY_FN void asperity_back(int form, const asperity_curve *v, asperity_real f, asperity_place *place) {
    if (form == 2 && f > ASPERITY_R(0.0)) {
        int j = place->after;
        while (j > 0 && asperity_point(v, 0, j) >= f) {
            j--;
        }
        place->after = j;
        place->f_t = f;
        place->x = asperity_given_between(v, 0, f, j);
        place->f_n = asperity_given(v, 1, place->x, j);
    } else {
        asperity_place_of(form, v, f, place);
    }
}

/* The least x at which f_N has the value f. */
ASPERITY_FN asperity_real asperity_normal_inverse(int form, const asperity_curve *v, asperity_real f) {
    asperity_real one = ASPERITY_R(1.0), inner;
    if (f <= ASPERITY_R(0.0)) {
        return ASPERITY_R(0.0);
    }
    if (f >= one) {
        return one;
    }
    if (form == 2) {
        int j = asperity_given_search(v, 1, f);
        return j < ASPERITY_POINTS ? asperity_given_between(v, 1, f, j) : asperity_peak_x(asperity_given_peak(v, 1) + 1);
    }
    if (form == 0) {
        inner = one - asperity_power(f, one / v->big_n);
        return inner > ASPERITY_R(0.0) ? one - asperity_power(inner, one / v->m) : one;
    }
    inner = one - asperity_power(one - f, one / v->big_n);
    return inner > ASPERITY_R(0.0) ? asperity_power(inner, one / v->m) : ASPERITY_R(0.0);
}

/* Share of F_N_slip that reversals cost: no more than what the slip itself has cost. */
ASPERITY_FN asperity_real asperity_reversed_share(const asperity_curve *v) {
    return asperity_most(asperity_least(v->f_n0 / v->f_n_slip - ASPERITY_R(1.0), ASPERITY_REVERSED), ASPERITY_LEAST_REVERSED);
}

/* The x of the virgin curve that has the normal force f_n. */
ASPERITY_FN asperity_real asperity_mobilisation(int form, const asperity_curve *v, asperity_real f_n) {
    if (f_n >= ASPERITY_AT_CAP * v->f_n0) {
        return ASPERITY_R(0.0);
    }
    if (ASPERITY_AT_SLIP * f_n <= v->f_n_slip) {
        asperity_real x = ASPERITY_R(1.0) + asperity_most(ASPERITY_R(1.0) - f_n / v->f_n_slip, ASPERITY_R(0.0)) / asperity_reversed_share(v);
        return x < ASPERITY_ALL_LOST ? x : ASPERITY_ALL_LOST;
    }
    return asperity_normal_inverse(form, v, (v->f_n0 - f_n) / (v->f_n0 - v->f_n_slip));
}

/* F_N at x, with what a reversed slip costs. */
ASPERITY_FN asperity_real asperity_reversed_cap(const asperity_curve *v, asperity_real x, const asperity_place *place) {
    return x < ASPERITY_R(1.0) ? v->f_n0 - (v->f_n0 - v->f_n_slip) * place->f_n : v->f_n_slip * (ASPERITY_R(1.0) - asperity_reversed_share(v) * (x - ASPERITY_R(1.0)));
}

/* F_N over the reach of a contact: 2 E* a/gamma. */
ASPERITY_FN asperity_real asperity_per_reach(const asperity_curve *v) {
    return v->f_n0 / v->depth;
}

/* Elastic unloading: F_N at the approach e > 0 of a contact with this reach, from ln(e/reach). It starts with 2 E* a from any F_N: what shear takes of F_N leaves the contact as wide as it was. */
ASPERITY_FN asperity_real asperity_force_at(const asperity_curve *v, asperity_real reach, asperity_real level) {
    return asperity_per_reach(v) * reach * (level == ASPERITY_R(0.0) ? ASPERITY_R(1.0) : asperity_exponential(v->gamma * level));
}

/* Greatest deflection of each slider under the normal force f_n > 0, so that their forces add up to mu F_N; eta is what is left of its extent as it is released. */
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

/* The sliders as they would be, were they not held to their limits. */
typedef struct asperity_moved {
    ASPERITY_ALIGNED asperity_real q[2][ASPERITY_SLIDERS];
    asperity_real square[ASPERITY_SLIDERS];                           /* of the deflection's length */
    asperity_real size[ASPERITY_SLIDERS], per_size[ASPERITY_SLIDERS]; /* it and its inverse, once asked */
} asperity_moved;

ASPERITY_FN void asperity_move(asperity_real from[2][ASPERITY_SLIDERS], asperity_real d0, asperity_real d1, asperity_moved *moved) {
    int i;
    ASPERITY_LANES
    for (i = 0; i < ASPERITY_SLIDERS; i++) {
        asperity_real q0 = from[0][i] + d0, q1 = from[1][i] + d1;
        moved->q[0][i] = q0;
        moved->q[1][i] = q1;
        moved->square[i] = q0 * q0 + q1 * q1;
    }
}

/* Whether a slider is beyond its limit. */
ASPERITY_FN int asperity_exceeds(const asperity_moved *moved, const asperity_real limit[ASPERITY_SLIDERS]) {
    asperity_real lane[4];
    int i;
    ASPERITY_LANES
    for (i = 0; i < 4; i++) {
        asperity_real a = moved->square[i] - limit[i] * limit[i], b = moved->square[i + 4] - limit[i + 4] * limit[i + 4];
        asperity_real c = moved->square[i + 8] - limit[i + 8] * limit[i + 8], d = moved->square[i + 12] - limit[i + 12] * limit[i + 12];
        a = a > b ? a : b;
        c = c > d ? c : d;
        lane[i] = a > c ? a : c;
    }
    return asperity_most(asperity_most(lane[0], lane[2]), asperity_most(lane[1], lane[3])) > ASPERITY_R(0.0);
}

ASPERITY_FN void asperity_measure(asperity_moved *moved) {
    int i;
    ASPERITY_LANES
    for (i = 0; i < ASPERITY_SLIDERS; i++) {
        asperity_real inverse = asperity_inverse_root(moved->square[i]);
        moved->per_size[i] = inverse;
        moved->size[i] = moved->square[i] * inverse;
    }
}

/* Holds each slider to its limit; returns what they dissipate over k_T. */
ASPERITY_FN asperity_real asperity_hold(const asperity_moved *moved, const asperity_real limit[ASPERITY_SLIDERS], asperity_real to[2][ASPERITY_SLIDERS]) {
    ASPERITY_ALIGNED asperity_real over[ASPERITY_SLIDERS];
    int i;
    ASPERITY_LANES
    for (i = 0; i < ASPERITY_SLIDERS; i++) {
        asperity_real most = limit[i], keep = most * moved->per_size[i], beyond = moved->size[i] - most;
        keep = keep < ASPERITY_R(1.0) ? keep : ASPERITY_R(1.0);
        over[i] = most * (beyond > ASPERITY_R(0.0) ? beyond : ASPERITY_R(0.0));
        to[0][i] = keep * moved->q[0][i];
        to[1][i] = keep * moved->q[1][i];
    }
    return asperity_sum(asperity_weights(), over);
}

/* Tangential force of the sliders. */
ASPERITY_FN void asperity_slider_force(const asperity_curve *v, asperity_real deflection[2][ASPERITY_SLIDERS], asperity_real force[2]) {
    force[0] = v->k_t * asperity_sum(asperity_weights(), deflection[0]);
    force[1] = v->k_t * asperity_sum(asperity_weights(), deflection[1]);
}

/* Their energy. */
ASPERITY_FN asperity_real asperity_slider_energy(const asperity_curve *v, asperity_real deflection[2][ASPERITY_SLIDERS]) {
    ASPERITY_ALIGNED asperity_real square[ASPERITY_SLIDERS];
    int i;
    ASPERITY_LANES
    for (i = 0; i < ASPERITY_SLIDERS; i++) {
        square[i] = (deflection[0][i] * deflection[0][i] + deflection[1][i] * deflection[1][i]);
    }
    return ASPERITY_R(0.5) * v->k_t * asperity_sum(asperity_weights(), square);
}

/* Their stiffness after an increment: a slider at its limit only turns. */
ASPERITY_FN void asperity_slider_stiffness(
    const asperity_curve *v, const asperity_moved *moved, const asperity_real limit[ASPERITY_SLIDERS], asperity_real stiffness[2][2]) {
    const asperity_real *weight = asperity_weights();
    asperity_real sum0 = ASPERITY_R(0.0), sum1 = ASPERITY_R(0.0), sum2 = ASPERITY_R(0.0);
    int i;
    ASPERITY_LANES
    for (i = 0; i < ASPERITY_SLIDERS; i++) {
        asperity_real size = ASPERITY_SQRT(moved->square[i]), k = v->k_t * weight[i];
        if (size > ASPERITY_AT_BOUND * limit[i]) {
            asperity_real m0 = moved->q[0][i] / size, m1 = moved->q[1][i] / size;
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

/* A contact at work: an asperity_state. */
typedef struct asperity_work {
    ASPERITY_ALIGNED asperity_real deflection[2][ASPERITY_SLIDERS];
    asperity_real h, h_max, approach, reach, x, sheared, reversed;
} asperity_work;

/* What the press leaves for the shear. */
typedef struct asperity_pressed {
    asperity_real f_n, x, df_n_dh, slip; /* slip: dissipated by the sliders */
    asperity_real flow;                  /* by how many e-folds F_T has flowed */
    asperity_real sudden;                /* displacement that hardens nothing */
    asperity_real eta;                   /* what is left of the extent: (approach/reach)^(gamma/backbone) */
    asperity_real approach, reach;       /* elastic, of that F_N */
    asperity_real force[2], f_t;         /* of the sliders, and its size */
    asperity_place place;                /* on the virgin curves, of that force */
    ASPERITY_ALIGNED asperity_real limit[ASPERITY_SLIDERS];
} asperity_pressed;

/* What the sliders hold, and where that is on the virgin curves. */
ASPERITY_FN void asperity_stand(const asperity_table *t, const asperity_curve *v, asperity_real deflection[2][ASPERITY_SLIDERS], asperity_pressed *p) {
    asperity_slider_force(v, deflection, p->force);
    p->f_t = ASPERITY_SQRT(p->force[0] * p->force[0] + p->force[1] * p->force[1]);
    asperity_place_of(t->form, v, p->f_t * (ASPERITY_R(1.0) / (t->friction * v->f_n_slip)), &p->place);
}

/* Share of a displacement that the sliders take where their force meanwhile flows by `flow` e-folds, (1 - e^-flow)/flow. Without it a press under shear would keep more of F_T the longer its steps are. */
ASPERITY_FN asperity_real asperity_taken(asperity_real flow) {
    if (flow < ASPERITY_R(0.05)) {
        return ASPERITY_R(1.0) - flow * (ASPERITY_R(0.5) - flow * (ASPERITY_R(1.0 / 6.0) - flow * (ASPERITY_R(1.0 / 24.0) - flow * ASPERITY_R(1.0 / 120.0))));
    }
    return (ASPERITY_R(1.0) - asperity_exponential_near(-flow)) / flow;
}

/* c of the yield curve: a table's own, or that of F_N0/F_N = 1 + b r + c r^2, r = F_T/F_N, which the virgin curve follows; by its points at 40 % and all of the slip force. */
ASPERITY_FN asperity_real asperity_yield_coefficient(const asperity_table *t, const asperity_curve *v) {
    asperity_real loss, lost, at_slip, f_n, r, before, c, least;
    asperity_place place;
    if (t->form == 2) {
        return v->n;
    }
    if (!(t->friction > ASPERITY_R(0.0))) {
        return ASPERITY_R(0.0);
    }
    loss = v->f_n0 - v->f_n_slip;
    at_slip = loss / (v->f_n_slip * t->friction);
    asperity_place_of(t->form, v, ASPERITY_R(0.4), &place);
    lost = loss * place.f_n;
    f_n = v->f_n0 - lost;
    r = ASPERITY_R(0.4) * t->friction * v->f_n_slip / f_n;
    before = lost / (f_n * r);
    c = (at_slip - before) / (t->friction - r);
    least = ASPERITY_R(0.5) * at_slip / t->friction;
    return c > least ? c : least;
}

/* Share of an indentation that unloading recovers. */
ASPERITY_FN asperity_real asperity_recovered(const asperity_curve *v) {
    return v->slope * v->depth * (v->per_gamma * v->per_force);
}

/* s c of the yield curve F_N (1 + s c r^2) = F_N0. */
ASPERITY_FN asperity_real asperity_yield_share(const asperity_curve *v, asperity_real c) {
    return ASPERITY_PRESSED * (ASPERITY_R(1.0) - asperity_recovered(v)) * c;
}

/* c of the flow at the ratio r of F_T to F_N, from the c that was measured where d(delta_T)/dh is mu/(1/2 + mu^2/4). */
ASPERITY_FN asperity_real asperity_flow_coefficient(const asperity_table *t, const asperity_curve *v, asperity_real c, asperity_real r) {
    asperity_real slope = ASPERITY_R(2.0) * t->friction / (ASPERITY_R(1.0) + ASPERITY_R(0.5) * t->friction * t->friction);
    asperity_real measured = (ASPERITY_SQRT(ASPERITY_R(1.0) + slope * slope / c) - ASPERITY_R(1.0)) / slope;
    asperity_real share = r < ASPERITY_R(2.0) * measured ? r / measured : ASPERITY_R(2.0);
    return c * (ASPERITY_R(1.0) + (asperity_recovered(v) - ASPERITY_NO_CHANGE) * (share - ASPERITY_R(1.0)));
}

/* Greatest F_N of a contact that is pressed with the tangential force f_t, on the yield curve of this s c; at its apex F_N0/2. `root`: of the discriminant. */
ASPERITY_FN asperity_real asperity_pressed_cap(const asperity_curve *v, asperity_real share, asperity_real f_t, asperity_real *root) {
    asperity_real force = f_t * v->per_force, q = ASPERITY_R(1.0) - ASPERITY_R(4.0) * share * (force * force);
    *root = q > ASPERITY_R(0.0) ? ASPERITY_SQRT(q) : ASPERITY_R(0.0);
    return ASPERITY_R(0.5) * v->f_n0 * (ASPERITY_R(1.0) + *root);
}

/* F_N on that curve at a ratio F_T/F_N. */
ASPERITY_FN asperity_real asperity_yielding_at(const asperity_curve *v, asperity_real share, asperity_real ratio) {
    return v->f_n0 / (ASPERITY_R(1.0) + share * (ratio * ratio));
}

/* F_N falls to f_n without an unloading: approach, reach and the sliders' limits with it. */
ASPERITY_FN void asperity_lower(const asperity_table *t, const asperity_curve *v, asperity_real f_n, asperity_pressed *p) {
    asperity_real share = f_n / p->f_n;
    p->f_n = f_n;
    p->approach *= share;
    p->reach *= share;
    asperity_limits(t->friction, v, f_n, p->eta, p->limit);
}

/* Moves h with delta_T held, while the displacement (d0, d1) brings some of F_T back. `p` has what asperity_stand() gives, F_N, eta and approach of the elastic response; `trial` is F_N were it not capped by first loading, `stiffness` its
 * slope, and `elastic_stiffness` that of the elastic response. */
ASPERITY_FN void asperity_press(
    const asperity_table *t, asperity_work *s, const asperity_curve *v, asperity_real trial, asperity_real stiffness, asperity_real elastic_stiffness, asperity_real h, asperity_real d0, asperity_real d1,
    int derivatives, asperity_pressed *p) {
    const asperity_real zero = ASPERITY_R(0.0), one = ASPERITY_R(1.0);
    int grown = h > s->h_max;
    asperity_real dh = h - s->h, elastic, f_t, slip_force, per_slip_force, cap, c, share, highest, r, normal, tangential, across, turn, part, softer, plastic, most, forward, steady, flows, taken_back, all;
    asperity_real stiff, soft, flow, linear, falls, gain, turns, along, slope[2], raised, pressed, on_curve, root, keep, left, back, change;
    asperity_place place;
    asperity_moved moved;
    p->slip = p->flow = p->sudden = zero;
    p->df_n_dh = stiffness;
    asperity_limits(t->friction, v, p->f_n, p->eta, p->limit);
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
    asperity_move(s->deflection, zero, zero, &moved);
    if (asperity_exceeds(&moved, p->limit)) {
        asperity_measure(&moved);
        p->slip = v->k_t * asperity_hold(&moved, p->limit, s->deflection);
        if (!v->elastic) {
            asperity_stand(t, v, s->deflection, p);
        } else {
            asperity_slider_force(v, s->deflection, p->force);
        }
    }
    p->df_n_dh = stiffness;
    if (v->elastic) {
        p->x = asperity_mobilisation(t->form, v, p->f_n);
        return; /* pressing leaves F_T as it is */
    }
    place = p->place;
    f_t = p->f_t;
    cap = v->f_n0 - (v->f_n0 - v->f_n_slip) * place.f_n;
    if (trial <= cap || f_t == zero) {
        p->x = asperity_mobilisation(t->form, v, p->f_n);
        s->sheared = p->f_n >= ASPERITY_AT_CAP * v->f_n0 ? zero : s->sheared;
        return;
    }
    slip_force = t->friction * v->f_n_slip;
    per_slip_force = one / slip_force;
    c = asperity_yield_coefficient(t, v);
    share = asperity_yield_share(v, c);
    highest = asperity_pressed_cap(v, share, f_t, &root);
    /* The direction of the flow, and the yield curve's normal. */
    r = f_t / p->f_n;
    c = asperity_flow_coefficient(t, v, c, r);
    normal = asperity_most(one - c * (r * r), ASPERITY_LEAST_NORMAL);
    tangential = ASPERITY_R(2.0) * c * r;
    across = asperity_most(one - share * (r * r), ASPERITY_LEAST_NORMAL);
    turn = ASPERITY_R(2.0) * share * r;
    /* Between the virgin curve and the yield curve the contact yields in part. */
    part = highest > cap ? asperity_least((trial - cap) / (highest - cap), one) : one;
    softer = grown ? one - v->slope * p->f_n / (v->f_n0 * elastic_stiffness) : one;
    plastic = softer > zero ? softer * dh : zero;
    most = (trial - cap) / elastic_stiffness;
    plastic = plastic < most ? plastic : most;
    forward = (p->force[0] * d0 + p->force[1] * d1) / f_t;
    forward = forward > zero ? forward : zero;
    /* What of delta_T flows. Where the contact does not move as far, F_T falls, and F_N rises along the yield curve: that takes some of the press. */
    steady = part * (tangential / normal) * plastic;
    if (grown && softer > zero) {
        /* In a steady press the sliders' force grows too, and c is of all of delta_T over all of h. */
        all = plastic / softer;
        flows = part * ((tangential / normal - r * v->slope * (p->f_n * v->per_force) / v->k_t) * all);
        flows = flows < forward ? flows : forward;
        steady = flows > steady ? flows : steady;
    }
    flows = steady;
    taken_back = zero;
    if (forward < steady) {
        stiff = normal * across * elastic_stiffness;
        soft = tangential * turn * v->k_t;
        flows = forward + ASPERITY_TAKEN_BACK * (steady - forward) * (stiff / (stiff + soft));
        taken_back = one - forward / steady;
    }
    flow = v->k_t * flows / f_t;
    p->flow = flow;
    /* The linear part of the virgin curve flows too, and what it takes of delta_T does not harden. */
    linear = (v->f_n0 / v->f_n_slip - one) / t->friction - c * t->friction;
    p->sudden = asperity_least(linear > zero ? linear / normal * plastic : zero, ASPERITY_SUDDEN * forward);
    keep = asperity_exponential_near(-flow);
    left = keep * f_t * per_slip_force;
    if (left < place.f_t) { /* a force beyond the peak of the virgin curve stays at its place */
        asperity_back(t->form, v, left, &place);
    }
    pressed = asperity_pressed_cap(v, share, keep * f_t, &root);
    on_curve = v->f_n0 - (v->f_n0 - v->f_n_slip) * place.f_n;
    raised = pressed > on_curve ? pressed : on_curve;
    /* Where F_N is below the curve, it is F_N that tells the place. */
    p->x = p->f_n < on_curve ? asperity_mobilisation(t->form, v, p->f_n) : place.x;
    p->x = p->x < s->x ? p->x : s->x;
    if (derivatives) {
        if (pressed > on_curve) {
            turns = root > zero ? ASPERITY_R(0.5) * (one - root * root) / root : zero;
            along = v->slope * (ASPERITY_R(0.5) * (one + root) + turns) + v->f_n0 * turns * (flow / dh);
        } else {
            asperity_slopes(t->form, v, place.x, slope);
            falls = (v->f_n0 - v->f_n_slip) * slope[1];
            gain = slope[0] > zero ? falls * keep * f_t / (v->f_n0 * slip_force * slope[0]) : zero;
            along = v->slope * (raised / v->f_n0 + gain) + v->f_n0 * gain * (flow / dh);
        }
        p->df_n_dh = raised < p->f_n && along < stiffness ? along : stiffness;
    }
    if (raised < p->f_n) {
        asperity_lower(t, v, raised, p);
    }
    back = (one - keep) / v->k_t;
    asperity_move(s->deflection, -back * p->force[0], -back * p->force[1], &moved);
    if (asperity_exceeds(&moved, p->limit)) {
        asperity_measure(&moved);
        p->slip += v->k_t * asperity_hold(&moved, p->limit, s->deflection);
    } else {
        memcpy(s->deflection, moved.q, sizeof moved.q);
    }
    if (taken_back > zero && left < ASPERITY_GONE) {
        memset(s->deflection, 0, sizeof s->deflection);
    }
    asperity_slider_force(v, s->deflection, p->force);
    /* It forgets with the growth of the contact, and as F_T is taken back. */
    change = asperity_exponential_near(-plastic / h - ASPERITY_FORGETS * (taken_back * taken_back) * flow);
    s->sheared = s->sheared > p->x ? p->x + (s->sheared - p->x) * change : p->x;
    s->reversed *= change;
}

/* By how much the sliders' force is beyond the curve at x. Where both are near to each other float has too few digits: there it is done in double. */
ASPERITY_FN asperity_real asperity_excess(
    int form, const asperity_curve *v, asperity_real deflection[2][ASPERITY_SLIDERS], asperity_real slip_force, asperity_real x, asperity_real plain) {
#ifdef ASPERITY_SINGLE
    if (form != 2) {
        const asperity_real *weight = asperity_weights();
        double sum[2] = {0.0, 0.0};
        int i;
        for (i = 0; i < ASPERITY_SLIDERS; i++) {
            sum[0] += (double)weight[i] * (double)deflection[0][i];
            sum[1] += (double)weight[i] * (double)deflection[1][i];
        }
        return (float)((double)v->k_t * sqrt(sum[0] * sum[0] + sum[1] * sum[1]) - (double)slip_force * (1.0 - exp((double)v->n * log(1.0 - (double)x))));
    }
#else
    (void)form;
    (void)v;
    (void)deflection;
    (void)slip_force;
    (void)x;
#endif
    return plain;
}

/* The sliders slip and stick while F_N is at that of full slip or next to it, or the contact was released: it loses what a reversal of the slip costs besides. Returns what the sliders dissipate. */
ASPERITY_FN asperity_real asperity_reverse(
    const asperity_table *t, asperity_work *s, asperity_response *out, asperity_tangent *tangent, asperity_curve *v, asperity_pressed *p, asperity_moved *moved, int measured,
    asperity_real d0, asperity_real d1, asperity_real slip) {
    const asperity_real zero = ASPERITY_R(0.0), one = ASPERITY_R(1.0);
    asperity_real size = ASPERITY_SQRT(d0 * d0 + d1 * d1), most = ASPERITY_SLIDING * (t->friction * out->f_n), rise[2], risen, stick, above, rate, gain, level, cap, loss, falling, near, stiffer, falls, slope[2];
    asperity_place place;
    int i, j, lowers;
    if (s->x >= ASPERITY_ALL_LOST || !(size > zero) || p->force[0] * p->force[0] + p->force[1] * p->force[1] > most * most) {
        return slip;
    }
    rise[0] = out->f_t[0] - p->force[0];
    rise[1] = out->f_t[1] - p->force[1];
    risen = ASPERITY_SQRT(rise[0] * rise[0] + rise[1] * rise[1]);
    stick = risen / (v->k_t * size);
    if (!(stick > zero && stick < one)) {
        return slip;
    }
    /* What F_N is above that of its x stays above it. */
    asperity_shapes(t->form, v, asperity_least(s->x, one), &place);
    cap = asperity_reversed_cap(v, s->x, &place);
    above = asperity_most(out->f_n - cap, zero);
    rate = ASPERITY_R(4.0) * ASPERITY_GATHERED * (v->k_t / (t->friction * v->f_n_slip));
    falling = asperity_reversed_share(v) * v->f_n_slip;
    if (s->x < one) {
        /* Next to full slip alone: F_T/F_N over mu to the power 24. */
        near = place.f_t * v->f_n_slip / cap;
        near = near * near * near;
        near = near * near;
        near = near * near;
        rate *= near * near;
        if (tangent) {
            asperity_slopes(t->form, v, s->x, slope);
            falling = (v->f_n0 - v->f_n_slip) * slope[1];
        }
    }
    gain = rate * (stick * (one - stick)) * size;
    rate *= ASPERITY_ALL_LOST - s->x;
    s->x = asperity_least(s->x + (ASPERITY_ALL_LOST - s->x) * gain, ASPERITY_ALL_LOST);
    s->reversed = asperity_least(s->reversed + (one - s->reversed) * gain, one);
    /* The sliders of a contact at rest are those that it came to rest with. */
    level = p->eta < one && p->eta > zero ? asperity_logarithm(p->eta) * v->backbone : zero;
    asperity_sharpen(v, s->sheared, s->reversed);
    p->eta = level < zero ? asperity_exponential(level * v->per_backbone) : p->eta;
    if (s->x < one) {
        asperity_shapes(t->form, v, s->x, &place);
    }
    cap = asperity_reversed_cap(v, s->x, &place) + above;
    lowers = cap < out->f_n;
    out->f_n = lowers ? cap : out->f_n;
    asperity_lower(t, v, out->f_n, p);
    if (!measured) {
        asperity_measure(moved);
    }
    slip = v->k_t * asperity_hold(moved, p->limit, s->deflection);
    asperity_slider_force(v, s->deflection, out->f_t);
    if (tangent) {
        loss = lowers && s->x < ASPERITY_ALL_LOST ? falling * rate : zero;
        for (j = 0; j < 2; j++) {
            stiffer = (rise[0] * tangent->df_t_ddelta[0][j] + rise[1] * tangent->df_t_ddelta[1][j]) / (risen * v->k_t);
            tangent->df_n_ddelta[j] = -loss * ((one - ASPERITY_R(2.0) * stick) * stiffer + stick * stick * (j ? d1 : d0) / size);
        }
        asperity_slider_stiffness(v, moved, p->limit, tangent->df_t_ddelta);
        for (j = 0; j < 2; j++) {
            falls = (one - stick) * tangent->df_n_ddelta[j] / out->f_n; /* the limits of what slips fall with F_N */
            for (i = 0; i < 2; i++) {
                tangent->df_t_ddelta[i][j] += falls * out->f_t[i];
            }
        }
    }
    return slip;
}

/* Moves delta_T with h held; returns what the sliders dissipate. */
ASPERITY_FN asperity_real asperity_shear(
    const asperity_table *t, asperity_work *s, asperity_response *out, asperity_tangent *tangent, asperity_curve *v, asperity_pressed *p,
    asperity_real d0, asperity_real d1) {
    const asperity_real zero = ASPERITY_R(0.0), one = ASPERITY_R(1.0);
    asperity_real held[2], stiffness[2][2], direction[2], m[2], slope[2], slip = zero, f_n = p->f_n, root;
    asperity_real slip_force, bound, over, share, trial, excess, travel, ahead, beyond, forward, hardens, at, dx, cap, before_cap, highest, ratio, steeper, falls, rises, above, lowered, size;
    asperity_real per_x, loss, keep, rate, radial;
    asperity_moved moved;
    asperity_place place, from;
    int i, j, measured, raised, on_yield;
    asperity_move(s->deflection, d0, d1, &moved);
    measured = asperity_exceeds(&moved, p->limit);
    if (measured) {
        asperity_measure(&moved);
        slip = v->k_t * asperity_hold(&moved, p->limit, s->deflection);
    } else {
        memcpy(s->deflection, moved.q, sizeof moved.q);
    }
    out->f_n = f_n;
    asperity_slider_force(v, s->deflection, out->f_t);
    if (tangent) {
        asperity_slider_stiffness(v, &moved, p->limit, tangent->df_t_ddelta);
    }
    if (v->elastic) {
        return slip;
    }
    if (s->x >= one && !(ASPERITY_AT_CAP * f_n > v->f_n_slip)) {
        return asperity_reverse(t, s, out, tangent, v, p, &moved, measured, d0, d1, slip);
    }
    slip_force = t->friction * v->f_n_slip;
    at = asperity_least(asperity_most(s->x, s->sheared), one);
    asperity_shapes(t->form, v, at, &from);
    before_cap = v->f_n0 - (v->f_n0 - v->f_n_slip) * from.f_n;
    /* After a press F_N may be above the virgin curve, but not above the yield curve; F_T/F_N is that of the virgin curve there too. */
    raised = ASPERITY_AT_CAP * f_n > before_cap;
    share = raised ? asperity_yield_share(v, asperity_yield_coefficient(t, v)) : zero;
    bound = slip_force * from.f_t;
    over = one;
    if (raised && bound > zero) {
        ratio = bound / before_cap;
        cap = asperity_most(asperity_least(asperity_yielding_at(v, share, ratio), f_n), before_cap);
        over = asperity_least(ratio, t->friction) * cap / bound;
    }
    bound *= over;
    trial = ASPERITY_SQRT(out->f_t[0] * out->f_t[0] + out->f_t[1] * out->f_t[1]);
    /* Where everything slides F_T rises by nothing but rounding; there the displacement tells what is beyond. */
    forward = trial > zero ? asperity_most((out->f_t[0] * d0 + out->f_t[1] * d1) / trial, zero) : zero;
    travel = trial > zero ? trial - (out->f_t[0] * p->force[0] + out->f_t[1] * p->force[1]) / trial : zero;
    ahead = asperity_most(ASPERITY_LEAST_TRAVEL * (v->k_t * forward) - travel, zero);
    if (trial + ahead <= ASPERITY_AT_BOUND * bound) {
        highest = asperity_pressed_cap(v, share, trial, &root);
        if (raised && ASPERITY_AT_CAP * highest < f_n) {
            cap = asperity_least(asperity_most(highest, before_cap), f_n);
            if (tangent) {
                falls = highest > before_cap && root > zero && trial > zero ? ASPERITY_R(2.0) * share * v->per_force / root : zero;
                for (j = 0; j < 2; j++) {
                    rises = out->f_t[0] * tangent->df_t_ddelta[0][j] + out->f_t[1] * tangent->df_t_ddelta[1][j];
                    tangent->df_n_ddelta[j] = -falls * rises;
                }
            }
            out->f_n = cap;
            asperity_lower(t, v, cap, p);
            if (measured || asperity_exceeds(&moved, p->limit)) {
                if (!measured) {
                    asperity_measure(&moved);
                }
                slip = v->k_t * asperity_hold(&moved, p->limit, s->deflection);
            }
            asperity_slider_force(v, s->deflection, out->f_t);
            if (tangent) {
                asperity_slider_stiffness(v, &moved, p->limit, tangent->df_t_ddelta);
            }
        } else if (s->x >= one || (s->x > zero && !raised)) {
            slip = asperity_reverse(t, s, out, tangent, v, p, &moved, measured, d0, d1, slip);
        }
        return slip;
    }
    direction[0] = out->f_t[0] / trial;
    direction[1] = out->f_t[1] / trial;
    excess = asperity_excess(t->form, v, s->deflection, slip_force * over, at, trial - bound);
    excess = asperity_most(excess + ahead, zero);
    travel += ahead;
    beyond = excess < travel ? excess / travel : one; /* share of the increment that is beyond the curve */
    hardens = asperity_most(beyond * forward - p->sudden, ASPERITY_R(0.5) * (beyond * forward)); /* in a long step, half of it at the least */
    dx = hardens * v->per_slip;
    asperity_shapes(t->form, v, asperity_least(at + dx, one), &place);
    cap = v->f_n0 - (v->f_n0 - v->f_n_slip) * place.f_n;
    ratio = slip_force * place.f_t / cap;
    above = raised ? (f_n - before_cap) * asperity_exponential_near(-dx / ASPERITY_RELAXATION) : zero;
    lowered = cap + above;
    on_yield = 0;
    if (raised) {
        highest = asperity_yielding_at(v, share, ratio);
        if (highest < lowered) {
            on_yield = highest > cap;
            above = zero;
            lowered = on_yield ? highest : cap;
        }
    }
    out->f_n = lowered < f_n ? lowered : f_n;
    s->x = ASPERITY_AT_SLIP * out->f_n <= v->f_n_slip ? one : place.x;
    s->sheared = place.x;
    if (out->f_n != f_n) {
        asperity_lower(t, v, out->f_n, p);
        if (measured || asperity_exceeds(&moved, p->limit)) {
            if (!measured) {
                asperity_measure(&moved);
            }
            slip = v->k_t * asperity_hold(&moved, p->limit, s->deflection);
        }
    }
    asperity_slider_force(v, s->deflection, held);
    bound = asperity_least(ratio, t->friction) * out->f_n;
    size = ASPERITY_SQRT(held[0] * held[0] + held[1] * held[1]);
    out->f_t[0] = held[0];
    out->f_t[1] = held[1];
    keep = size > bound ? bound / size : one;
    if (tangent) {
        asperity_slopes(t->form, v, place.x, slope);
        per_x = hardens > zero ? beyond * v->per_slip : zero;
        falls = (v->f_n0 - v->f_n_slip) * slope[1];
        steeper = (slip_force * slope[0] + ratio * falls) / cap;
        loss = on_yield ? ASPERITY_R(2.0) * share * ratio * steeper * out->f_n * (out->f_n * v->per_force) : falls + above / ASPERITY_RELAXATION;
        asperity_slider_stiffness(v, &moved, p->limit, stiffness);
        m[0] = held[0] / size;
        m[1] = held[1] / size;
        rate = (steeper * out->f_n - ratio * loss) * per_x;
        for (j = 0; j < 2; j++) {
            tangent->df_n_ddelta[j] = -loss * per_x * direction[j];
            radial = m[0] * stiffness[0][j] + m[1] * stiffness[1][j];
            for (i = 0; i < 2; i++) {
                tangent->df_t_ddelta[i][j] = ASPERITY_AT_BOUND * size > bound ? rate * m[i] * direction[j] + keep * (stiffness[i][j] - m[i] * radial) : stiffness[i][j];
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

/* To work and back, without the string instruction that compilers make of a copy. */
ASPERITY_FN void asperity_begin(const asperity_state *from, asperity_work *to) {
    int i;
    to->h = from->h;
    to->h_max = from->h_max;
    to->approach = from->approach;
    to->reach = from->reach;
    to->x = from->x;
    to->sheared = from->sheared;
    to->reversed = from->reversed;
    ASPERITY_LANES
    for (i = 0; i < ASPERITY_SLIDERS; i++) {
        to->deflection[0][i] = from->deflection[0][i];
        to->deflection[1][i] = from->deflection[1][i];
    }
}

ASPERITY_FN void asperity_end(const asperity_work *from, asperity_state *to) {
    int i;
    to->h = from->h;
    to->h_max = from->h_max;
    to->approach = from->approach;
    to->reach = from->reach;
    to->x = from->x;
    to->sheared = from->sheared;
    to->reversed = from->reversed;
    ASPERITY_LANES
    for (i = 0; i < ASPERITY_SLIDERS; i++) {
        to->deflection[0][i] = from->deflection[0][i];
        to->deflection[1][i] = from->deflection[1][i];
    }
}

/* Whether a state is one that the update may have left: all its numbers finite, and each within its bounds. */
ASPERITY_FN int asperity_is_sound(const asperity_state *s) {
    const asperity_real zero = ASPERITY_R(0.0), one = ASPERITY_R(1.0);
    /* A sum of products is finite only if all of its factors are. */
    return asperity_is_finite(s->h) && asperity_is_finite(s->approach) && asperity_is_finite(s->h_max + s->reach + s->x + s->sheared + s->reversed) &&
           asperity_is_finite(asperity_sum(s->deflection[0], s->deflection[1])) && s->h_max >= zero && s->reach >= zero && s->x >= zero &&
           s->x <= ASPERITY_ALL_LOST && s->sheared >= zero && s->sheared <= ASPERITY_ALL_LOST && s->reversed >= zero && s->reversed <= one;
}

/* Moves a contact to the indentation h and along the plane by `increment`, the press first. `next` may be `state`; `tangent` may be NULL. Where h or the increment is not finite,
 * or the state is not sound, nothing in the answer is a number and the state stays as it was. */
ASPERITY_FN void asperity_update(
    const asperity_table *t, asperity_real radius, asperity_real modulus, const asperity_state *state, asperity_real h, const asperity_real increment[2],
    asperity_state *next, asperity_response *out, asperity_tangent *tangent) {
    const asperity_real zero = ASPERITY_R(0.0), one = ASPERITY_R(1.0);
    asperity_work s;
    asperity_row row, old_row;
    asperity_curve v, old;
    const asperity_curve *before = &v;
    asperity_pressed p;
    asperity_real inverse = one / radius, force = modulus * radius * radius, work = force * radius, d0, d1, size, greatest, dh, e, log_h, exponential[4] ASPERITY_ALIGNED, old_exponential[4] ASPERITY_ALIGNED;
    asperity_real level, at_trial, began, half, kept, softness, trial, stiffness, elastic_stiffness, old_n, old_t[2], stored, total, slip, keep, share;
    int grown, touched, first;
    memset(out, 0, sizeof *out);
    if (tangent) {
        memset(tangent, 0, sizeof *tangent);
    }
    h /= radius; /* not by its inverse: an unloading takes small differences of it */
    d0 = increment[0] * inverse;
    d1 = increment[1] * inverse;
    if (!asperity_is_finite(h) || !asperity_is_finite(d0) || !asperity_is_finite(d1) || !asperity_is_sound(state)) {
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
    grown = h > state->h_max;
    greatest = grown ? h : state->h_max;
    dh = h - state->h;
    e = state->approach + dh;
    if (!(greatest > zero) || (!grown && state->approach <= zero && e <= zero)) {
        /* An open gap, before the first contact or over a dent: no slider is deflected. */
        asperity_real h_max = state->h_max, approach = state->approach, reach = state->reach, place = state->x;
        if (greatest > zero) {
            place = dh == zero ? place : ASPERITY_ALL_LOST;
            approach += dh;
        }
        if (next != state) {
            memset(next->deflection, 0, sizeof next->deflection);
        }
        next->sheared = state->sheared;
        next->reversed = state->reversed;
        next->h = h;
        next->h_max = h_max;
        next->approach = approach;
        next->reach = reach;
        next->x = place;
        return;
    }
    touched = state->h_max > zero;
    keep = one;
    log_h = asperity_logarithm(greatest * (one / t->first));
    asperity_read_row(t, log_h, &row, exponential);
    if (grown && touched) {
        asperity_read_row(t, log_h + asperity_log_ratio(state->h_max, h), &old_row, old_exponential);
        asperity_exponentials(exponential, 4);
        asperity_exponentials(old_exponential, 4);
        asperity_make_curve(t, greatest, &row, exponential, 1, state->sheared, state->reversed, &v);
        asperity_make_curve(t, state->h_max, &old_row, old_exponential, 0, one, zero, &old);
        before = &old;
        /* The sliders keep their forces as the contact grows (Mindlin & Deresiewicz 1953), and never gain energy by it. */
        keep = old.k_t / v.k_t;
        keep = keep < one ? keep : one;
    } else {
        asperity_exponentials(exponential, 4);
        asperity_make_curve(t, greatest, &row, exponential, 1, state->sheared, state->reversed, &v);
    }
    asperity_begin(state, &s);
    asperity_slider_force(before, s.deflection, old_t);
    stored = asperity_slider_energy(before, s.deflection);
    if (keep < one) {
        asperity_scale(s.deflection, keep);
    }
    /* Early: it does not wait for what comes next. */
    if (dh > zero && !v.elastic) {
        asperity_stand(t, &v, s.deflection, &p);
    } else {
        asperity_slider_force(&v, s.deflection, p.force);
    }
    first = grown && (state->x == zero || !touched);
    level = zero;
    old_n = zero;
    trial = v.f_n0;
    stiffness = v.slope;
    elastic_stiffness = v.gamma * v.f_n0 / v.depth;
    p.eta = one;
    p.approach = p.reach = v.depth;
    if (touched && state->approach > zero) {
        level = state->approach == state->reach ? zero : asperity_logarithm(state->approach / state->reach);
        old_n = asperity_force_at(before, state->reach, level);
    }
    if (!first) {
        if (e <= state->reach && !grown) {
            /* Most steps are small: what ln(approach/reach) was is near to what it is. */
            at_trial = e == state->reach || !(e > zero) ? zero : state->approach > zero ? level + asperity_log_ratio(e, state->approach) : asperity_logarithm(e / state->reach);
            trial = e > zero ? asperity_force_at(&v, state->reach, at_trial) : zero;
            stiffness = e > zero ? v.gamma * trial / e : zero;
            elastic_stiffness = stiffness;
            if (trial < v.f_n0) {
                p.approach = e;
                p.reach = state->reach;
                p.eta = e < state->reach ? (e > zero ? asperity_exponential(at_trial * v.gamma * v.per_backbone) : zero) : one;
            }
        } else {
            /* Beyond its reach the contact stores the work of the step, with the mean of the forces before and after; the energy is F_N^2/(k (gamma + 1)), k = F_N/reach. Where shear has
             * made the reach smaller than D, it stores sqrt(reach/D) of the work only. */
            began = asperity_per_reach(before) * state->reach;
            half = e > state->reach ? ASPERITY_R(0.5) * (e - state->reach) : zero;
            softness = one / (asperity_per_reach(&v) * (v.gamma + one));
            kept = half * ASPERITY_SQRT(state->reach / before->depth);
            trial = (kept + ASPERITY_SQRT(kept * kept + ASPERITY_R(4.0) * softness * (began * state->reach / (before->gamma + one) + began * kept))) / (ASPERITY_R(2.0) * softness);
            elastic_stiffness = before->gamma * asperity_per_reach(before);
            stiffness = half > zero ? ASPERITY_R(0.5) * (trial - began) / half : elastic_stiffness;
            if (trial < v.f_n0) {
                p.approach = p.reach = trial / asperity_per_reach(&v);
            }
        }
    }
    p.f_n = trial < v.f_n0 ? trial : v.f_n0;
    stored = old_n > zero ? old_n * s.approach / (before->gamma + one) + stored : zero;
    if (!grown && e <= zero) {
        /* Contact is lost: what it stored was given back or slipped away. */
        total = ASPERITY_R(0.5) * (old_n * dh + old_t[0] * d0 + old_t[1] * d1) + stored;
        out->friction = total > zero ? work * total : zero;
        next->h = h;
        next->h_max = s.h_max;
        next->x = dh == zero ? s.x : ASPERITY_ALL_LOST;
        next->sheared = s.sheared;
        next->reversed = s.reversed;
        next->approach = e;
        next->reach = s.reach;
        memset(next->deflection, 0, sizeof next->deflection);
        return;
    }
    asperity_press(t, &s, &v, trial, stiffness, elastic_stiffness, h, d0, d1, tangent != NULL, &p);
    s.h = h;
    s.h_max = greatest;
    s.x = p.x;
    size = p.f_n;
    share = asperity_taken(p.flow);
    slip = p.slip + asperity_shear(t, &s, out, tangent, &v, &p, share * d0, share * d1);
    if (dh != zero || out->f_n != size) {
        s.approach = p.approach;
        s.reach = p.reach;
    }
    if (tangent) {
        tangent->df_n_dh = p.df_n_dh * modulus * radius;
        tangent->a = asperity_radius(&v) * asperity_power(s.approach / s.reach, v.gamma - one) * radius;
        tangent->df_n_ddelta[0] *= share * modulus * radius;
        tangent->df_n_ddelta[1] *= share * modulus * radius;
        tangent->df_t_ddelta[0][0] *= share * modulus * radius;
        tangent->df_t_ddelta[0][1] *= share * modulus * radius;
        tangent->df_t_ddelta[1][0] *= share * modulus * radius;
        tangent->df_t_ddelta[1][1] *= share * modulus * radius;
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
    asperity_end(&s, next);
}

/* Elastic energy that a contact stores. */
ASPERITY_FN asperity_real asperity_stored_energy(const asperity_table *t, asperity_real radius, asperity_real modulus, const asperity_state *state) {
    asperity_curve v;
    asperity_state s = *state;
    if (!asperity_is_sound(state)) {
        return asperity_no_number();
    }
    if (!(s.h_max > ASPERITY_R(0.0)) || s.approach <= ASPERITY_R(0.0)) {
        return ASPERITY_R(0.0);
    }
    asperity_first_loading(t, s.h_max, 0, &v);
    return modulus * radius * radius * radius * asperity_energy(&v, asperity_force_at(&v, s.reach, asperity_logarithm(s.approach / s.reach)), s.approach, s.deflection);
}

/* A number by which a table is told from others, for restart files: FNV-1a of the bits of all that it has, plane or pair included. */
ASPERITY_FN uint64_t asperity_mix(uint64_t hash, const void *numbers, size_t bytes) {
    const unsigned char *at = (const unsigned char *)numbers;
    size_t i;
    for (i = 0; i < bytes; i++) {
        hash = (hash ^ at[i]) * 0x100000001b3ull;
    }
    return hash;
}

ASPERITY_FN uint64_t asperity_fingerprint(const asperity_table *t) {
    uint64_t hash = asperity_mix(0xcbf29ce484222325ull, &t->plane, sizeof t->plane);
    hash = asperity_mix(hash, &t->form, sizeof t->form);
    hash = asperity_mix(hash, &t->share, sizeof t->share);
    hash = asperity_mix(hash, &t->poissons_ratio, sizeof t->poissons_ratio);
    hash = asperity_mix(hash, &t->friction, sizeof t->friction);
    hash = asperity_mix(hash, &t->effective_modulus, sizeof t->effective_modulus);
    hash = asperity_mix(hash, &t->effective_radius, sizeof t->effective_radius);
    hash = asperity_mix(hash, &t->deepest, sizeof t->deepest);
    hash = asperity_mix(hash, &t->first, sizeof t->first);
    hash = asperity_mix(hash, &t->log_step, sizeof t->log_step);
    hash = asperity_mix(hash, &t->gentle, sizeof t->gentle);
    hash = asperity_mix(hash, t->knots, sizeof t->knots);
    return asperity_mix(hash, t->shapes, sizeof t->shapes);
}

/* Whether a contact has been deeper than the law was made for. */
ASPERITY_FN int asperity_out_of_range(const asperity_table *t, const asperity_state *state) {
    return state->h_max > t->deepest * ASPERITY_R(1.0 + 1e-6);
}

#ifndef ASPERITY_NO_FILES
/* A number as the files have it, whatever the decimal point of the program's locale is. Whether there was one, and nothing else in the word. */
static inline int asperity_scan_number(FILE *file, asperity_real *value) {
    char word[48], local[64], *end, *dot;
    const char *point = localeconv()->decimal_point;
    double number;
    if (fscanf(file, "%47s", word) != 1) {
        return 0;
    }
    dot = strchr(word, '.');
    if (dot && strcmp(point, ".") != 0 && strlen(point) < sizeof local - sizeof word) {
        size_t before = (size_t)(dot - word), size = strlen(point);
        memcpy(local, word, before);
        memcpy(local + before, point, size);
        memcpy(local + before + size, dot + 1, strlen(dot + 1) + 1);
    } else {
        memcpy(local, word, sizeof word);
    }
    number = strtod(local, &end);
    *value = ASPERITY_R(number);
    return end != local && *end == '\0' && asperity_is_finite(*value);
}

/* One line "name value" of a table's file. */
static inline int asperity_scan_named(FILE *file, const char *name, asperity_real *value) {
    char found[32];
    return fscanf(file, "%31s", found) == 1 && strcmp(found, name) == 0 && asperity_scan_number(file, value);
}

static inline int asperity_scan_word(FILE *file, const char *word) {
    char found[32];
    return fscanf(file, "%31s", found) == 1 && strcmp(found, word) == 0;
}

static inline int asperity_is_within(asperity_real x, double least, double most) {
    return asperity_is_finite(x) && (double)x >= least && (double)x <= most;
}

/* Whether the numbers of a table are such that the update may count on them. */
static inline int asperity_is_sound_table(const asperity_table *t) {
    int i, j, k;
    int good = (t->plane == 0 || t->plane == 1) && t->form >= 0 && t->form <= 2 && asperity_is_within(t->share, 1e-6, 1e6) &&
               asperity_is_within(t->poissons_ratio, -1.0, 0.5) && asperity_is_within(t->friction, 0.0, 1e9) &&
               asperity_is_within(t->effective_modulus, 1e-30, 1e30) && asperity_is_within(t->effective_radius, 1e-30, 1e30) &&
               asperity_is_within(t->deepest, 0.0, 10.0) && asperity_is_within(t->first, 1e-30, 10.0) &&
               asperity_is_within(t->log_step, 1e-6, 10.0) && asperity_is_within(t->gentle, -1e9, 1e9);
    for (i = 0; good && i < ASPERITY_KNOTS; i++) {
        for (j = 0; good && j < 4; j++) {
            for (k = 0; good && k < ASPERITY_COLUMNS; k++) {
                good = asperity_is_within(t->knots[i][j][k], -1e15, 1e15);
            }
        }
    }
    for (i = 0; good && i < ASPERITY_LEVELS; i++) {
        for (j = 0; good && j < 2; j++) {
            for (k = 0; good && k < ASPERITY_POINTS; k++) {
                good = asperity_is_within(t->shapes[i][j][k], -1e6, 1e6);
            }
        }
    }
    return good;
}

/* Reads a file that `asperity law export` wrote. Returns 0; 1: it cannot be opened, 2: it is no such file or of another version, 3: it is cut short, damaged, or has numbers that no law has. */
static inline int asperity_read_table(const char *path, asperity_table *t) {
    char body[32];
    asperity_real form;
    int version, i, j, k, good;
    FILE *file = fopen(path, "r");
    memset(t, 0, sizeof *t);
    if (!file) {
        return 1;
    }
    if (fscanf(file, "asperity-contact-table %d body %31s", &version, body) != 2 || version != 4) {
        fclose(file);
        return 2;
    }
    t->plane = strcmp(body, "plane") == 0;
    good = asperity_scan_named(file, "share", &t->share) && asperity_scan_named(file, "poissons_ratio", &t->poissons_ratio) &&
           asperity_scan_named(file, "friction", &t->friction) && asperity_scan_named(file, "effective_modulus", &t->effective_modulus) &&
           asperity_scan_named(file, "effective_radius", &t->effective_radius) &&
           asperity_scan_named(file, "deepest", &t->deepest) && asperity_scan_named(file, "form", &form) &&
           asperity_scan_named(file, "first", &t->first) && asperity_scan_named(file, "log_step", &t->log_step) &&
           asperity_scan_named(file, "gentle", &t->gentle);
    good = good && (form == ASPERITY_R(0.0) || form == ASPERITY_R(1.0) || form == ASPERITY_R(2.0));
    t->form = good ? (int)form : 0;
    good = good && asperity_scan_word(file, "knots");
    for (i = 0; good && i < ASPERITY_KNOTS; i++) {
        for (j = 0; good && j < 4; j++) {
            for (k = 0; good && k < ASPERITY_COLUMNS; k++) {
                good = asperity_scan_number(file, &t->knots[i][j][k]);
            }
        }
    }
    good = good && asperity_scan_word(file, "shapes");
    for (i = 0; good && i < ASPERITY_LEVELS; i++) {
        for (j = 0; good && j < 2; j++) {
            for (k = 0; good && k < ASPERITY_POINTS; k++) {
                good = asperity_scan_number(file, &t->shapes[i][j][k]);
            }
        }
    }
    good = good && asperity_scan_word(file, "end");
    fclose(file);
    return good && asperity_is_sound_table(t) ? 0 : 3;
}
#endif

#endif
