/* asperity_contact.h: force-displacement law of an elastic-plastic sphere, as an incremental update of one contact. Written by asperity @VERSION@.
 *
 * C99, C++17, CUDA. No global data, no allocation, no failure at run time. double; with ASPERITY_SINGLE defined before it is included, float: then memory, table and answers are
 * float, and each step is solved in double: forces are within 1e-5 of those in double as a rule, and some 1e-3 where a step is at the edge of yielding.
 *
 * What it needs is an asperity_table: of one hardening curve, one Poisson's ratio and one friction coefficient, for all radii, moduli and units. `asperity law export` writes it
 * as a constant (asperity_law.h) and as a file that asperity_read_table() reads when the program runs (law.asperity).
 *
 * A contact's memory is one asperity_state: all bytes zero before first contact; copy it, write it to a restart file as it is. Lengths are over R, forces over E R^2. Each step:
 *     asperity_update(&table, R, E, &state, h, d, &next, &out, NULL);
 * h: indentation (negative: a gap), d[2]: tangential displacement of the sphere since the last call in two fixed axes, compression and the force along d
 * positive. The answer is a function of `state` alone, which stays as it is: it may be asked twice. For three dimensions, two radii, walls: asperity_contact3d.h.
 *
 * A table is of a sphere on a rigid plane (table.plane is 1) or of two spheres (0): then h and d are `table.share` times what the two centres move. A table for a plane may
 * stand for two equal spheres with a share of 1/2, which is exact without friction only: a plane holds the surface by friction while it is pressed, where two equal spheres
 * move alike.
 *
 * The law is a macro-element. Elastic: F_N = P g^(gamma - 1) (e/D)^gamma, where e = h - dent, and P, D, gamma and the dent go with the depth h_m up to which it has hardened. Along the
 * plane seven sliders, annuli of the contact, each slipping at mu times its share of F_N. It yields at F_N G = rho P, where G grows with r = F_T/F_N and with the distance of r from
 * a vertex that follows it; then the contact hardens, and slips by plastic flow along r and away from the vertex. Each step is solved implicitly by Newton's method.
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

/* Of a pointer: nothing else points there. */
#if defined(__GNUC__) || defined(__CUDACC__) || defined(_MSC_VER)
#define ASPERITY_ALONE __restrict
#else
#define ASPERITY_ALONE
#endif

#ifdef __CUDACC__
#define ASPERITY_FN static inline __host__ __device__
#else
#define ASPERITY_FN static inline
#endif

#ifdef ASPERITY_SINGLE
typedef float asperity_real;
typedef uint32_t asperity_bits;
#define ASPERITY_LOG logf
#define ASPERITY_SQRT sqrtf
#define ASPERITY_ABS fabsf
#define ASPERITY_SIN sinf
#define ASPERITY_COS cosf
#define ASPERITY_INFINITE_BITS 0x7f800000u
#define ASPERITY_MOST 1e15f /* its square is still finite */
#define ASPERITY_ROUNDING 1.2e-7
#else
typedef double asperity_real;
typedef uint64_t asperity_bits;
#define ASPERITY_LOG log
#define ASPERITY_SQRT sqrt
#define ASPERITY_ABS fabs
#define ASPERITY_SIN sin
#define ASPERITY_COS cos
#define ASPERITY_INFINITE_BITS 0x7ff0000000000000ull
#define ASPERITY_MOST 1e140
#define ASPERITY_ROUNDING 2.3e-16
#endif
#define ASPERITY_R(x) ((asperity_real)(x))
#define ASPERITY_LEAST 1e-30 /* an overlap below this is none: the powers of a smaller one are no numbers any more */

/* a b + c, in one operation where the machine has it. */
#ifdef FP_FAST_FMA
#define ASPERITY_FMA(a, b, c) fma(a, b, c)
#else
#define ASPERITY_FMA(a, b, c) ((a) * (b) + (c))
#endif

#define ASPERITY_ROWS @ROWS@
#define ASPERITY_LEVELS @LEVELS@
#define ASPERITY_PLACES @PLACES@ /* of a shape, at 1 - (1 - j/places)^2: denser at full slip */
#define ASPERITY_SLIDERS 7
#define ASPERITY_SECTORS 4       /* of a slider that twists: around the normal, from the first axis on */
#define ASPERITY_PADDED 8        /* lanes of the sliders at work */
#define ASPERITY_ALL_WEIGHTS 0.9999999999999999 /* the sum of their weights */

/* Columns over the hardening depth: those that a step solves with, and those of its start. */
enum { ASPERITY_LN_FORCE, ASPERITY_LN_STIFFNESS, ASPERITY_RECOVERED, ASPERITY_GAMMA, ASPERITY_SOLVED,
       ASPERITY_FIRST_N = ASPERITY_SOLVED, ASPERITY_UNSHEARED_N, ASPERITY_RADIAL_SLIP, ASPERITY_SUDDEN, ASPERITY_SOFTENING, ASPERITY_RADIUS, ASPERITY_COLUMNS };

/* Shapes over r/mu, and that of the vertex over its distance: the steady loss A, the steady flow, the flow with a growing yield factor, the loss B at the vertex. */
enum { ASPERITY_LOST, ASPERITY_FLOW, ASPERITY_MOBILISED, ASPERITY_VERTEX, ASPERITY_SHAPES };

/* A law. Lengths over R, forces over E R^2. */
typedef struct asperity_table {
    int plane;                       /* 1: a sphere on a rigid plane; 0: two spheres */
    asperity_real share;             /* h and d over what the centres move */
    asperity_real poissons_ratio;
    asperity_real friction;          /* mu */
    asperity_real effective_modulus; /* E*, over E: 1/(1 - nu^2) on a plane, half of it between two spheres */
    asperity_real effective_radius;  /* of Hertz's contact, over R: 1 on a plane, 1/2 between two spheres */
    asperity_real deepest;           /* h up to which the law was made */
    asperity_real later;             /* exponent of the sliders after their slip was reversed */
    asperity_real first;             /* depth of the first row, where all is elastic; rows are even in ln h, */
    asperity_real per_step;          /* so many for each e, */
    asperity_real level_start;       /* from this ln(h/first) on the levels, */
    asperity_real per_level;         /* so many for each e */
    asperity_real rows[ASPERITY_ROWS][ASPERITY_COLUMNS];
    asperity_real shapes[ASPERITY_LEVELS][ASPERITY_SHAPES][ASPERITY_PLACES + 1];
    asperity_real reach[ASPERITY_LEVELS];  /* of the vertex: its distance at full slip, */
    asperity_real beyond[ASPERITY_LEVELS]; /* and the slope of its loss beyond that over the mean slope before */
} asperity_table;

/* The memory of a contact, lengths over R. */
typedef struct asperity_state {
    asperity_real h;
    asperity_real h_max;
    asperity_real approach;   /* elastic: what is recovered until contact is lost; negative: the gap over the residual dent */
    asperity_real hardened;   /* h_m less the depth of first yield */
    asperity_real reach;      /* elastic approach at which the sliders are whole */
    asperity_real softened;   /* 1 - rho: what releases took of the yield force */
    asperity_real released;   /* greatest share of F_N released since the contact last yielded */
    asperity_real worn;       /* 0 to 1 sheared so far, to 2 its slip reversed */
    asperity_real stiffened;  /* g - 1: by what the contact is wider than its F_N, as shear took F_N and left its radius */
    asperity_real vertex[2];
    asperity_real slider[3][ASPERITY_SLIDERS]; /* forces along the two axes, and radial */
} asperity_state;

/* What a contact that twists or rolls remembers besides; all zero before first contact. Forces over E R^2, moments over E R^3. */
typedef struct asperity_turning {
    asperity_real sector[ASPERITY_SECTORS][2][ASPERITY_SLIDERS]; /* forces of the sliders' sectors along the two axes: their mean is the slider's */
    asperity_real twisted;   /* the twisting moment over a lever and F_N, as it counts for yield; follows */
    asperity_real vertex;    /* that of the yield surface, likewise */
    asperity_real rolled;    /* 0 to 1: share of the contact that has left what was pressed behind */
    asperity_real moment[2]; /* of the roll, about the two axes */
} asperity_turning;

/* The answer of an increment. */
typedef struct asperity_response {
    asperity_real f_n;          /* compression positive */
    asperity_real f_t[2];       /* along the displacement: what drives the sphere; the plane gives it the opposite */
    asperity_real stiffness;    /* of an unloading, dF_N/dh: 2 E* a */
    asperity_real stored;       /* elastic energy */
    asperity_real plastic;      /* work that this increment dissipated in plastic flow, */
    asperity_real friction;     /* and in slip */
} asperity_response;

/* Derivatives, for implicit engines, and the contact radius. */
typedef struct asperity_tangent {
    asperity_real df_t_ddelta[2][2];
    asperity_real df_n_dh;        /* for the direction in which h last moved */
    asperity_real df_n_ddelta[2];
    asperity_real df_t_dh[2];
    asperity_real a;
} asperity_tangent;

/* The same for all contacts: of simulated paths. */
#define ASPERITY_VERTEX_LENGTH @VERTEX_LENGTH@ /* dh_p over mu P/k_T in which the vertex follows r */
#define ASPERITY_VERTEX_ROUND @VERTEX_ROUND@   /* distance over mu within which its direction is rounded */
#define ASPERITY_RADIAL_MOST @RADIAL_MOST@     /* greatest radial force of a slider over its limit */
#define ASPERITY_NARROWS @NARROWS@             /* dh_p/D in which a press makes the contact as wide as F_N has it */
#define ASPERITY_RECOVERS @RECOVERS@           /* how fast a press gives back what a release took */
#define ASPERITY_FORGETS @FORGETS@             /* how fast a press takes back how far it was sheared, over dh_p/D */
#define ASPERITY_FOLLOWS @FOLLOWS@             /* way over mu F_N/k_T in which the sliders' exponent follows what was sheared */
#define ASPERITY_TWIST_STIFF @TWIST_STIFF@     /* stiffness of the sliders around the normal over that along the plane */
#define ASPERITY_TWIST_LEVER @TWIST_LEVER@     /* M_twist over mu F_N a where all slips, of a plastic contact */
#define ASPERITY_TWIST_WORN @TWIST_WORN@       /* how much more a twist wears than a shear of as much of its limit */
#define ASPERITY_TWIST_FLOW @TWIST_FLOW@       /* what it flows with */
#define ASPERITY_TWIST_MOST @TWIST_MOST@       /* up to here */
#define ASPERITY_TWIST_YIELD @TWIST_YIELD@     /* what M_twist over that lever counts for yield, beside F_T */
#define ASPERITY_STEPS 20                      /* of Newton */
#define ASPERITY_BRACKETS 100                  /* where that does not find the way */
#define ASPERITY_TOLERANCE 1e-12               /* of F_N over the yield force and of F_T/F_N */

/* 1/sqrt(x), x >= 0, finite at 0: a first guess by the exponent's bits and Newton's steps. No call, no division: a compiler does it for several lanes whatever its flags. */
ASPERITY_FN double asperity_inverse_root(double x) {
    double half = 0.5 * x, y;
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    bits = 0x5fe6eb50c7b537a9ull - (bits >> 1);
    memcpy(&y, &bits, sizeof bits);
    y *= ASPERITY_FMA(-half * y, y, 1.5);
    y *= ASPERITY_FMA(-half * y, y, 1.5);
    y *= ASPERITY_FMA(-half * y, y, 1.5);
    y *= ASPERITY_FMA(-half * y, y, 1.5);
    return y;
}

/* ln(1 + r), |r| <= 1/64, by its series. */
ASPERITY_FN double asperity_log_series(double r) {
    double r2 = r * r, p, q;
    p = ASPERITY_FMA(r2, ASPERITY_FMA(r, 1.0 / 9.0, -1.0 / 8.0), ASPERITY_FMA(r, 1.0 / 7.0, -1.0 / 6.0));
    q = ASPERITY_FMA(r2, ASPERITY_FMA(r, 1.0 / 5.0, -1.0 / 4.0), ASPERITY_FMA(r, 1.0 / 3.0, -1.0 / 2.0));
    return ASPERITY_FMA(r2, ASPERITY_FMA(r2 * r2, p, q), r);
}

/* ln x, x > 0, in line: of 2^k c (1 + r), with c from 32 places and |r| <= 1/64. */
ASPERITY_FN double asperity_logarithm(double x) {
    static const double inverse[32] = {
        1.4223978268922088, 1.391468746307456, 1.3618562535370686, 1.3334780249593055, 1.3062584608976362, 1.2801280128012802, 1.2550225896376046, 1.2308830328247804,
        1.207654650645305, 1.1852868044242475, 1.163732539879329, 1.1429482579925057, 1.122893420546364, 1.1035302861389817, 1.084823673058967, 1.066740745885131,
        1.0492508230867432, 1.0323252032520325, 1.0159370078740158, 1.0, 0.9699196326061997, 0.9413800562405364, 0.9144723412941417, 0.8890603897356743,
        0.8650228310502284, 0.8422510822510821, 0.8206477067236561, 0.8001250195343023, 0.7806038970697605, 0.7620127569099929, 0.7442866801893171, 0.7273666537517758};
    static const double log_c[32] = {
        -0.3523440580008923, -0.3303598412985515, -0.3088486614358244, -0.28779058528352974, -0.26716691395221637, -0.2469600829318592, -0.2271535721329931,
        -0.2077318246738307, -0.18868017341225488, -0.1699847743527869, -0.1516325461705557, -0.1336111151900369, -0.11590876523852209, -0.09851439186497558,
        -0.08141746047599635, -0.06460796799339279, -0.0480764076837151, -0.03181373684993537, -0.01581134711020277, 0.0, 0.030542063900505807, 0.06040833545244689,
        0.08940805622954394, 0.11759011581397946, 0.1449993781208599, 0.1716771117439915, 0.1976613642714418, 0.22298728910590676, 0.24768743184511172,
        0.2717919820839289, 0.2953289955317206, 0.31832459054884527};
    const uint64_t from = 0x3fe6400000000000ull;
    const int digits = 52;
    const double least = 1e-300, greatest = 1e300;
    int64_t away;
    uint64_t bits;
    double z, r, k;
    int place;
    if (!(x > least && x < greatest)) {
        return log(x);
    }
    memcpy(&bits, &x, sizeof bits);
    away = (int64_t)bits - (int64_t)from;
    place = (int)(away >> (digits - 5)) & 31;
    k = (double)(int)(away >> digits);
    bits -= (uint64_t)((away >> digits) * ((int64_t)1 << digits));
    memcpy(&z, &bits, sizeof z);
    r = ASPERITY_FMA(z, inverse[place], -1.0);
    return ASPERITY_FMA(k, 0.6931471805599453, log_c[place]) + asperity_log_series(r);
}

/* e^x of one number, in the range of the other: 2^(k/32) e^r. */
ASPERITY_FN double asperity_exponential(double x) {
    static const double root[32] = {
        1.0, 1.0218971486541166, 1.0442737824274138, 1.0671404006768237, 1.0905077326652577, 1.1143867425958924, 1.1387886347566916, 1.1637248587775775,
        1.189207115002721, 1.215247359980469, 1.241857812073484, 1.2690509571917332, 1.2968395546510096, 1.3252366431597413, 1.3542555469368927, 1.383909881963832,
        1.4142135623730951, 1.4451808069770467, 1.4768261459394993, 1.5091644275934228, 1.5422108254079407, 1.5759808451078865, 1.6104903319492543, 1.645755478153965,
        1.681792830507429, 1.718619298122478, 1.7562521603732995, 1.7947090750031072, 1.8340080864093424, 1.8741676341103, 1.9152065613971474, 1.9571441241754002};
    const double most = 700.0, high = 0.021660849335603416, low = 5.689487495325457e-11;
    const int digits = 52;
    double r = x, r2, scaled;
    uint64_t bits;
    int k;
    r = r < most ? r : most;
    r = r > -most ? r : -most;
    k = (int)(r * 46.16624130844683 + 32768.5) - 32768;
    r = ASPERITY_FMA((double)k, -low, ASPERITY_FMA((double)k, -high, r));
    r2 = r * r;
    scaled = root[k & 31];
    memcpy(&bits, &scaled, sizeof bits);
    bits += (uint64_t)(k >> 5) << digits;
    memcpy(&scaled, &bits, sizeof bits);
    x = ASPERITY_FMA(r2, ASPERITY_FMA(r2, 1.0 / 720.0, ASPERITY_FMA(r, 1.0 / 120.0, 1.0 / 24.0)), ASPERITY_FMA(r, 1.0 / 6.0, 1.0 / 2.0));
    return ASPERITY_FMA(scaled, ASPERITY_FMA(r2, x, r), scaled);
}

/* e^x of a number that is small in most steps of time: then its series. */
ASPERITY_FN double asperity_exponential_near(double x) {
    double x2 = x * x, near, far;
    if (fabs(x) > 0.03125) {
        return asperity_exponential(x);
    }
    near = ASPERITY_FMA(x, 1.0 / 6.0, 1.0 / 2.0);
    far = ASPERITY_FMA(x2, ASPERITY_FMA(x, 1.0 / 5040.0, 1.0 / 720.0), ASPERITY_FMA(x, 1.0 / 120.0, 1.0 / 24.0));
    return 1.0 + ASPERITY_FMA(x2, ASPERITY_FMA(x2, far, near), x);
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

/* ---- the update ---- */

/* The memory in double, with lanes for the sliders. */
typedef struct asperity_work {
    double h, h_max, approach, hardened, reach, softened, released, worn, stiffened, vertex[2];
    double slider[3][ASPERITY_PADDED];
} asperity_work;

/* A twist within a step: displacement at the contact's radius, what the memory holds of it, the ratio were nothing to flow, and by how much slip takes from it; and what a roll
 * leaves of the yield force and of the flow. */
typedef struct asperity_twist {
    double along, ratio, vertex, trial, gives, kept, flows;
    double sector[ASPERITY_SECTORS][2][ASPERITY_PADDED];
} asperity_twist;

/* A row of the table at a hardening depth, and its slopes; those of force and stiffness are of their logarithms. */
typedef struct asperity_row {
    double value[ASPERITY_SOLVED], slope[ASPERITY_SOLVED];
    double approach, approach_slope, dent, dent_slope; /* elastic approach D of first loading, and what is left of h */
    double wide, wide_slope; /* share of a growing yield factor that makes the contact stiffer: one that recovers all of its indentation has no dent that could grow instead */
    double force, stiff, share, share_slope; /* share: between the levels */
    int level;
} asperity_row;

/* Where a shape is read: after place j, and how far. */
typedef struct asperity_spot {
    int j;
    double u, per_width;
} asperity_spot;

/* What does not change within a step. */
typedef struct asperity_step {
    const asperity_table *t;
    const asperity_work *s;
    const asperity_twist *twist; /* or none */
    asperity_row row; /* at its start */
    double friction, per_friction, h, d[2], depth, per_depth, log_h, dent, approach; /* depth: h_m at its start, log_h of it over the first row's; approach: D there */
    double e, level, f_n, wide, log_wide;                     /* of the elastic trial, level: ln(e/D); wide: g at its start */
    double worn, worn_by[3], share_worn[ASPERITY_PADDED];     /* how far sheared, slopes by h and d, and by it of a slider's share of what all carry */
    double radial, sudden, rho, rho_log, rho_slope, growing, growing_slope; /* slopes by h */
    double twisted, kept;                                     /* of the twist, over F_N; what a roll has left of the yield force */
    int rises;                                                /* whether the yield factor of the elastic trial is above the one from which it grows */
    double old_f_n, old_f_t[2], old_stored[2];                  /* stored across and along the plane */
    double per_exponent, lost[ASPERITY_PADDED], limit[ASPERITY_PADDED], sum; /* of the sliders; the limits of a contact that is not released */
} asperity_step;

/* Everything at a guess of the hardening y and the ratio r. */
typedef struct asperity_guess {
    asperity_row row;
    double r[2], f_n, f_t[2], factor, rho, width, reach, hardens, vertex[2], residual[3], slip[2], friction, stored, stiffness;
    int plastic;
    double e, level, log_width, scale, move[3];
    double slider[3][ASPERITY_PADDED];
    /* Of a slider: its limit, its radial force and the square of all before they give way, whether it does, and the share of its force that it keeps. */
    double most[ASPERITY_PADDED], radially[ASPERITY_PADDED], squared[ASPERITY_PADDED], over[ASPERITY_PADDED], keep[ASPERITY_PADDED];
    int slips;
    /* Of the sliders: how much a contact carries that is released (the share that is whole, as a logarithm times gamma; slopes by y and h), and each one's share of it. */
    double eta, log_share, eta_y, eta_h, own[ASPERITY_PADDED], sum;
    const double *limit;
    /* Of plastic flow, and slopes by y, r and the factor. */
    double ratio, x[2], per_length, q, c, round, far, part[3], width_factor, width_y, rho_y, rho_h, mobile, mobile_r, grown, flow, flow_y, flow_r, sudden, sudden_y;
    double m[3], radial[2], stiffer[2], wider[2];
    double by[6][3], n_by[6], t_by[6][2]; /* of the residuals and the forces, by y, r, h, d */
    double tangent[3][3];                 /* of F_N and F_T, by h and d */
    double sector[ASPERITY_SECTORS][2][ASPERITY_PADDED], turn, untwisted, twist_vertex, turned, per_turn, by_turn[2], pushed[2][ASPERITY_PADDED]; /* of the twist: forces, displacement, distance from the vertex, the vertex, slopes of F_T */
} asperity_guess;

/* The row, or the level, before a place; 0 to last. */
ASPERITY_FN int asperity_before(double x, int last) {
    int i = x > 0.0 ? (x < (double)last ? (int)x : last) : 0;
    return i > 0 ? (i < last ? i : last) : 0;
}

/* The columns that are solved with, between the rows; force and stiffness still as logarithms. Beyond the last row only these two go on. */
ASPERITY_FN void asperity_read(const asperity_table *t, double depth, double log_h, asperity_row *row) {
    double x = log_h * (double)t->per_step, level = (log_h - (double)t->level_start) * (double)t->per_level, u, v, per = (double)t->per_step / depth, plastic;
    int i = asperity_before(x, ASPERITY_ROWS - 2), c;
    u = x > 0.0 ? x - i : 0.0;
    v = u < 1.0 ? u : 1.0;
    for (c = 0; c < ASPERITY_SOLVED; c++) {
        double low = (double)t->rows[i][c], rise = (double)t->rows[i + 1][c] - low;
        row->value[c] = low + (c < ASPERITY_RECOVERED ? u : v) * rise;
        row->slope[c] = c < ASPERITY_RECOVERED || !(v < u) ? rise * per : 0.0;
    }
    row->approach = row->value[ASPERITY_RECOVERED] * depth;
    row->approach_slope = row->value[ASPERITY_RECOVERED] + row->slope[ASPERITY_RECOVERED] * depth;
    row->dent = depth - row->approach;
    row->dent_slope = 1.0 - row->approach_slope;
    plastic = 1.0 - row->value[ASPERITY_RECOVERED];
    row->wide = 2.0 * plastic < 1.0 ? 2.0 * plastic : 1.0;
    row->wide_slope = 2.0 * plastic < 1.0 ? -2.0 * row->slope[ASPERITY_RECOVERED] : 0.0;
    i = asperity_before(level, ASPERITY_LEVELS - 2);
    row->level = i;
    u = level - i;
    row->share = u > 0.0 ? (u < 1.0 ? u : 1.0) : 0.0;
    row->share_slope = u >= 0.0 && u < 1.0 ? (double)t->per_level / depth : 0.0;
}

/* One of the other columns. */
ASPERITY_FN double asperity_column(const asperity_table *t, double log_h, int column) {
    double x = log_h * (double)t->per_step, u;
    int i = asperity_before(x, ASPERITY_ROWS - 2);
    u = x > 0.0 ? x - i : 0.0;
    return (double)t->rows[i][column] + (u < 1.0 ? u : 1.0) * ((double)t->rows[i + 1][column] - (double)t->rows[i][column]);
}

/* 1 over what is between the places of a shape. */
ASPERITY_FN const double *asperity_per_widths(void) {
    static const double per_width[ASPERITY_PLACES] = {
        12.25531914893617, 12.8, 13.395348837209303, 14.048780487804878, 14.76923076923077, 15.567567567567568, 16.457142857142856, 17.454545454545453,
        18.580645161290324, 19.862068965517242, 21.333333333333332, 23.04, 25.043478260869566, 27.428571428571427, 30.31578947368421, 33.88235294117647, 38.4,
        44.30769230769231, 52.36363636363637, 64.0, 82.28571428571429, 115.2, 192.0, 576.0};
    return per_width;
}

/* Where the shapes are read at x. */
ASPERITY_FN asperity_spot asperity_find(double x) {
    asperity_spot at;
    double rest;
    if (!(x < 1.0)) {
        at.j = ASPERITY_PLACES - 1;
        at.u = 1.0;
        at.per_width = 0.0;
        return at;
    }
    at.j = (int)(ASPERITY_PLACES * (1.0 - sqrt(1.0 - x)));
    at.j = at.j < ASPERITY_PLACES - 1 ? (at.j > 0 ? at.j : 0) : ASPERITY_PLACES - 1;
    rest = 1.0 - at.j * (1.0 / ASPERITY_PLACES);
    at.per_width = asperity_per_widths()[at.j];
    at.u = (x - (1.0 - rest * rest)) * at.per_width;
    return at;
}

/* A shape there: value, and slopes by x and by the share between levels. */
ASPERITY_FN double asperity_shape(const asperity_table *t, const asperity_row *row, int shape, asperity_spot at, double slope[2]) {
    const asperity_real *low = t->shapes[row->level][shape] + at.j, *high = t->shapes[row->level + 1][shape] + at.j;
    double rise = (double)low[1] - (double)low[0], rise_b = (double)high[1] - (double)high[0];
    double a = (double)low[0] + at.u * rise, b = (double)high[0] + at.u * rise_b;
    slope[0] = (rise + row->share * (rise_b - rise)) * at.per_width;
    slope[1] = b - a;
    return a + row->share * slope[1];
}

/* Shares of the sliders in k_T: (i/7)^0.65 inside the end of cell i. */
ASPERITY_FN const double *asperity_weights(void) {
    static const double weight[ASPERITY_PADDED] = {
        0.28228007246945605, 0.16067234912498195, 0.1335715962968834, 0.11854658577836137, 0.10849433246541654, 0.10110285024062748, 0.09533221362427317, 0.0};
    return weight;
}

ASPERITY_FN const double *asperity_per_weights(void) {
    static const double per_weight[ASPERITY_PADDED] = {
        3.5425809241571757, 6.223846265060402, 7.486621615102558, 8.435502325386521, 9.21707131862172, 9.890917987178138, 10.489633692355417, 0.0};
    return per_weight;
}

/* Levers of the sliders in a twist, over the contact's radius: those of punches as wide as their cells. */
ASPERITY_FN const double *asperity_levers(void) {
    static const double lever[ASPERITY_PADDED] = {@LEVERS@, 0.0};
    return lever;
}

/* Approach, over that of the whole contact, at which each slider's annulus is lost, for the backbone 1 - (1 - x)^n (Jaeger). Cells end at (i/7)^(0.65/(n - 1)). */
ASPERITY_FN void asperity_lost(double n, double lost[ASPERITY_PADDED]) {
    static const double inside[ASPERITY_SLIDERS] = {0.282280072469456, 0.442952421594438, 0.5765240178913213, 0.6950706036696828, 0.8035649361350993, 0.9046677863757268, 0.9999999999999999};
    const double *per_weight = asperity_per_weights();
    double p = 0.65 / (n - 1.0), two = asperity_exponential(0.6931471805599453 * p), three = asperity_exponential(1.0986122886681098 * p);
    double five = asperity_exponential(1.6094379124341003 * p), seventh = asperity_exponential(-1.9459101490553132 * p), share = (n - 1.0) / n;
    double end[ASPERITY_PADDED];
    int i;
    end[0] = seventh * inside[0];
    end[1] = two * seventh * inside[1];
    end[2] = three * seventh * inside[2];
    end[3] = two * two * seventh * inside[3];
    end[4] = five * seventh * inside[4];
    end[5] = two * three * seventh * inside[5];
    end[6] = inside[6];
    lost[0] = share * end[0] * per_weight[0];
    for (i = 1; i < ASPERITY_SLIDERS; i++) {
        lost[i] = share * (end[i] - end[i - 1]) * per_weight[i];
    }
    lost[ASPERITY_SLIDERS] = 2.0;
}

/* Exponent of the backbone: of a contact that was not sheared, of its first reversal, of those after. */
ASPERITY_FN double asperity_exponent(double first, double unsheared, double later, double worn) {
    double rest = worn < 1.0 ? 1.0 - worn : 0.0;
    return worn <= 1.0 ? first + unsheared * rest * sqrt(rest) : first > later ? first + (worn - 1.0) * (later - first) : first;
}

/* The yield factor at a ratio, whose spot is `at`, and a distance from the vertex. */
ASPERITY_FN double asperity_factor(const asperity_table *t, double per_friction, const asperity_row *row, asperity_spot at, double distance, double slope[3]) {
    double low = (double)t->reach[row->level], rise = (double)t->reach[row->level + 1] - low, per = 1.0 / (low + row->share * rise), x = distance * per, a[2], b[2];
    double lost = asperity_shape(t, row, ASPERITY_LOST, at, a), more = asperity_shape(t, row, ASPERITY_VERTEX, asperity_find(x), b);
    if (x >= 1.0) { /* the vertex goes on straight, by a share of its mean slope; the others stay */
        double on = (double)t->shapes[row->level][ASPERITY_VERTEX][ASPERITY_PLACES] * (double)t->beyond[row->level];
        double on_b = (double)t->shapes[row->level + 1][ASPERITY_VERTEX][ASPERITY_PLACES] * (double)t->beyond[row->level + 1];
        b[0] = on + row->share * (on_b - on);
        b[1] += (on_b - on) * (x - 1.0);
        more += b[0] * (x - 1.0);
    }
    slope[0] = a[0] * per_friction;
    slope[1] = b[0] * per;
    slope[2] = (a[1] + b[1] - b[0] * x * rise * per) * row->share_slope; /* by depth */
    return 1.0 + lost + more;
}

/* No less than any yield factor at a row. */
ASPERITY_FN double asperity_most_factor(const asperity_table *t, const asperity_row *row, double friction) {
    double most = 0.0;
    int i;
    for (i = row->level; i <= row->level + 1; i++) {
        double over = 2.0 * friction / (double)t->reach[i] - 1.0, bound = (double)t->shapes[i][ASPERITY_VERTEX][ASPERITY_PLACES];
        bound = 1.0 + (double)t->shapes[i][ASPERITY_LOST][ASPERITY_PLACES] + bound * (1.0 + (over > 0.0 ? over * (double)t->beyond[i] : 0.0));
        most = most > bound ? most : bound;
    }
    return most;
}

/* The same at the start of a step. */
ASPERITY_FN double asperity_factor_at(const asperity_step *p, const double r[2]) {
    double slope[3], x = r[0] - p->s->vertex[0], y = r[1] - p->s->vertex[1], m = p->twisted, z = p->twist ? m - p->twist->vertex : 0.0;
    return asperity_factor(p->t, p->per_friction, &p->row, asperity_find(sqrt(r[0] * r[0] + r[1] * r[1] + m * m) * p->per_friction), sqrt(x * x + y * y + z * z), slope);
}

ASPERITY_FN double asperity_sum(const double x[ASPERITY_PADDED]) {
    return ((x[0] + x[2]) + (x[4] + x[6])) + ((x[1] + x[3]) + (x[5] + x[7]));
}

/* What each slider may carry at eta, over what all carry that are whole: the innermost carries what little force there is. Returns their sum by weight. */
ASPERITY_FN double asperity_limits(const double *ASPERITY_ALONE lost, double eta, double *ASPERITY_ALONE limit) {
    const double *weight = asperity_weights();
    double carried[ASPERITY_PADDED];
    int i;
    ASPERITY_LANES
    for (i = 0; i < ASPERITY_PADDED; i++) {
        double x = eta - lost[i];
        limit[i] = x > 0.0 ? x : 0.0;
    }
    limit[0] = limit[0] < 0.1 * eta ? 0.1 * eta : limit[0];
    ASPERITY_LANES
    for (i = 0; i < ASPERITY_PADDED; i++) {
        carried[i] = weight[i] * limit[i];
    }
    return asperity_sum(carried);
}

/* Where the sectors are pulled by a twist. */
ASPERITY_FN const double *asperity_around(int sector) {
    static const double around[ASPERITY_SECTORS][2] = {{0.0, 1.0}, {-1.0, 0.0}, {0.0, -1.0}, {1.0, 0.0}};
    return around[sector];
}

/* Moves the sectors of the sliders of a contact that twists, each within the limit; a radial force is the same in all. With the slopes of their force. */
ASPERITY_FN void asperity_slide_sectors(const asperity_step *p, double stiff, asperity_guess *ASPERITY_ALONE o) {
    const double *weight = asperity_weights(), *lever = asperity_levers(), share = 1.0 / ASPERITY_SECTORS;
    int i, j, c;
    memset(o->by_turn, 0, sizeof o->by_turn);
    memset(o->m, 0, sizeof o->m);
    memset(o->radial, 0, sizeof o->radial);
    memset(o->stiffer, 0, sizeof o->stiffer);
    memset(o->wider, 0, sizeof o->wider);
    o->slips = 1;
    for (i = 0; i < ASPERITY_PADDED; i++) {
        double k = stiff * weight[i], most = weight[i] * o->limit[i] * o->scale, bound = ASPERITY_RADIAL_MOST * most, turn = ASPERITY_TWIST_STIFF * lever[i];
        double radially = p->s->slider[2][i] + k * o->move[2], radial = radially < bound ? radially : bound, left = 1.0;
        o->most[i] = most;
        o->radially[i] = radially;
        o->slider[0][i] = o->slider[1][i] = o->pushed[0][i] = o->pushed[1][i] = 0.0;
        for (j = 0; j < ASPERITY_SECTORS; j++) {
            const double *around = asperity_around(j);
            double d[2], f[2], square, keep = 1.0, u[3] = {0.0, 0.0, 0.0}, grows, moved;
            for (c = 0; c < 2; c++) {
                d[c] = o->move[c] + turn * o->turn * around[c];
                f[c] = p->twist->sector[j][c][i] + k * d[c];
            }
            square = f[0] * f[0] + f[1] * f[1] + radial * radial;
            if (square > most * most) {
                double per = 1.0 / sqrt(square);
                keep = most * per;
                u[0] = f[0] * per;
                u[1] = f[1] * per;
                u[2] = radial * per;
            }
            left = left < keep ? left : keep;
            grows = radially > bound ? 1.0 - keep * u[2] * ASPERITY_RADIAL_MOST : 1.0;
            moved = u[0] * d[0] + u[1] * d[1] + (radially > bound ? 0.0 : u[2] * o->move[2]);
            k = keep * share * weight[i];
            o->m[0] += k * stiff * (1.0 - u[0] * u[0]);
            o->m[1] -= k * stiff * u[0] * u[1];
            o->m[2] += k * stiff * (1.0 - u[1] * u[1]);
            for (c = 0; c < 2; c++) {
                o->sector[j][c][i] = keep * f[c];
                o->slider[c][i] += share * keep * f[c];
                o->radial[c] -= radially > bound ? 0.0 : k * stiff * u[c] * u[2];
                o->stiffer[c] += k * (d[c] - u[c] * moved);
                o->pushed[c][i] += share * u[c] * grows;
                o->by_turn[c] += k * stiff * turn * (around[c] - u[c] * (u[0] * around[0] + u[1] * around[1]));
            }
            k = stiff * weight[i];
        }
        o->slider[2][i] = left * radial; /* what the sector that gives way most leaves, so that none is beyond its limit */
        for (c = 0; c < 2; c++) {
            o->wider[c] += o->pushed[c][i] * most;
        }
    }
    o->f_t[0] = asperity_sum(o->slider[0]);
    o->f_t[1] = asperity_sum(o->slider[1]);
}

/* Moves the sliders within their limits. Loops of their own: a compiler makes lanes of short ones. */
ASPERITY_FN void asperity_slide(const asperity_step *p, double stiff, asperity_guess *ASPERITY_ALONE o) {
    const double *weight = asperity_weights(), *limit = o->limit;
    const double *f0 = p->s->slider[0], *f1 = p->s->slider[1], *f2 = p->s->slider[2];
    double scale = p->friction * o->f_n / o->sum, d0 = stiff * o->move[0], d1 = stiff * o->move[1], d2 = stiff * o->move[2];
    double *t0 = o->slider[0], *t1 = o->slider[1], *t2 = o->slider[2];
    int i;
    o->scale = scale;
    if (p->twist) {
        asperity_slide_sectors(p, stiff, o);
        return;
    }
    ASPERITY_LANES
    for (i = 0; i < ASPERITY_PADDED; i++) {
        o->most[i] = weight[i] * limit[i] * scale;
        t0[i] = f0[i] + weight[i] * d0;
        t1[i] = f1[i] + weight[i] * d1;
        o->radially[i] = f2[i] + weight[i] * d2;
    }
    ASPERITY_LANES
    for (i = 0; i < ASPERITY_PADDED; i++) {
        double bound = ASPERITY_RADIAL_MOST * o->most[i], f = o->radially[i];
        t2[i] = f < bound ? f : bound;
    }
    ASPERITY_LANES
    for (i = 0; i < ASPERITY_PADDED; i++) {
        o->squared[i] = t0[i] * t0[i] + t1[i] * t1[i] + t2[i] * t2[i];
    }
    ASPERITY_LANES
    for (i = 0; i < ASPERITY_PADDED; i++) {
        double most = o->most[i];
        o->over[i] = o->squared[i] > most * most ? 1.0 : 0.0;
    }
    o->slips = asperity_sum(o->over) > 0.0;
    if (o->slips) {
        ASPERITY_LANES
        for (i = 0; i < ASPERITY_PADDED; i++) {
            double root = asperity_inverse_root(o->squared[i] + 1e-200), keep = o->over[i] > 0.0 ? o->most[i] * root : 1.0; /* no sum: of a large step the share is below a last digit of 1 */
            o->keep[i] = keep;
            t0[i] *= keep;
            t1[i] *= keep;
            t2[i] *= keep;
        }
    }
    o->f_t[0] = asperity_sum(t0);
    o->f_t[1] = asperity_sum(t1);
}

/* Slopes of their force: by the displacement (m, radial), by the stiffness, by the limit. Those that stick have no direction of slip. */
ASPERITY_FN void asperity_slide_slopes(const asperity_step *p, double stiff, asperity_guess *ASPERITY_ALONE o) {
    const double *weight = asperity_weights(), *t0 = o->slider[0], *t1 = o->slider[1], *t2 = o->slider[2];
    double sums[9][ASPERITY_PADDED], free[ASPERITY_PADDED], d0 = o->move[0], d1 = o->move[1], d2 = o->move[2];
    int i;
    if (p->twist) {
        return; /* those of the sectors are known */
    }
    o->by_turn[0] = o->by_turn[1] = 0.0;
    o->radial[0] = o->radial[1] = o->wider[0] = o->wider[1] = o->m[1] = 0.0;
    if (!o->slips) {
        o->m[0] = o->m[2] = stiff * ASPERITY_ALL_WEIGHTS;
        o->stiffer[0] = d0 * ASPERITY_ALL_WEIGHTS;
        o->stiffer[1] = d1 * ASPERITY_ALL_WEIGHTS;
        return;
    }
    ASPERITY_LANES
    for (i = 0; i < ASPERITY_PADDED; i++) {
        double bound = ASPERITY_RADIAL_MOST * o->most[i], f = o->radially[i];
        free[i] = f > bound ? 0.0 : 1.0;
    }
    ASPERITY_LANES
    for (i = 0; i < ASPERITY_PADDED; i++) {
        double keep = o->keep[i], most = o->most[i], per = o->over[i] / (most + 1e-300), k = keep * weight[i];
        double u0 = per * t0[i], u1 = per * t1[i], u2 = per * t2[i];
        double along = most * (1.0 - keep * u2 * (1.0 - free[i]) * ASPERITY_RADIAL_MOST), moved = u0 * d0 + u1 * d1 + free[i] * u2 * d2;
        sums[0][i] = k * (1.0 - u0 * u0);
        sums[1][i] = k * u0 * u1;
        sums[2][i] = k * (1.0 - u1 * u1);
        sums[3][i] = k * free[i] * u0 * u2;
        sums[4][i] = k * free[i] * u1 * u2;
        sums[5][i] = k * (d0 - u0 * moved);
        sums[6][i] = k * (d1 - u1 * moved);
        sums[7][i] = u0 * along;
        sums[8][i] = u1 * along;
    }
    o->m[0] = stiff * asperity_sum(sums[0]);
    o->m[1] = -stiff * asperity_sum(sums[1]);
    o->m[2] = stiff * asperity_sum(sums[2]);
    for (i = 0; i < 2; i++) {
        o->radial[i] = -stiff * asperity_sum(sums[3 + i]);
        o->stiffer[i] = asperity_sum(sums[5 + i]);
        o->wider[i] = asperity_sum(sums[7 + i]);
    }
}

/* An elastic step. Returns 0 where contact is lost. */
ASPERITY_FN int asperity_elastic(const asperity_step *p, asperity_guess *ASPERITY_ALONE o) {
    int i;
    o->slip[0] = o->slip[1] = o->hardens = 0.0;
    o->move[0] = p->d[0];
    o->move[1] = p->d[1];
    o->move[2] = 0.0;
    o->turn = p->twist ? p->twist->along : 0.0;
    o->width = p->wide;
    if (!(p->e > 0.0)) {
        o->f_n = o->f_t[0] = o->f_t[1] = 0.0;
        o->e = p->e;
        o->reach = p->s->reach;
        for (i = 0; i < ASPERITY_PADDED; i++) {
            o->slider[0][i] = o->slider[1][i] = o->slider[2][i] = 0.0;
        }
        if (p->twist) {
            memset(o->sector, 0, sizeof o->sector);
        }
        return 0;
    }
    o->reach = p->e > p->s->reach ? p->e : p->s->reach;
    o->e = p->e;
    o->f_n = p->f_n;
    o->sum = asperity_limits(p->lost, o->eta, o->own);
    o->limit = o->own;
    asperity_slide(p, p->row.stiff, o);
    return 1;
}

/* Slopes of the sliders' force by how far it was sheared. */
ASPERITY_FN void asperity_worn_slopes(const asperity_step *p, const asperity_guess *o, double by[2]) {
    int i;
    by[0] = by[1] = 0.0;
    for (i = 0; p->twist && i < ASPERITY_SLIDERS; i++) {
        by[0] += o->pushed[0][i] * asperity_weights()[i] * p->friction * o->f_n * p->share_worn[i];
        by[1] += o->pushed[1][i] * asperity_weights()[i] * p->friction * o->f_n * p->share_worn[i];
    }
    for (i = 0; !p->twist && i < ASPERITY_SLIDERS; i++) {
        if (o->slips && o->over[i] > 0.0 && o->most[i] > 0.0) {
            double held = o->radially[i] > ASPERITY_RADIAL_MOST * o->most[i] ? ASPERITY_RADIAL_MOST : 0.0;
            double along = (1.0 - o->keep[i] * o->slider[2][i] / o->most[i] * held) * asperity_weights()[i] * p->friction * o->f_n * p->share_worn[i] / o->most[i];
            by[0] += o->slider[0][i] * along;
            by[1] += o->slider[1][i] * along;
        }
    }
}

/* Slopes of the sliders' force by eta. */
ASPERITY_FN void asperity_eta_slopes(const asperity_step *p, const asperity_guess *o, double by[2]) {
    const double *weight = asperity_weights();
    double opening[ASPERITY_PADDED], open = 0.0;
    int i;
    by[0] = by[1] = 0.0;
    if (!o->slips || !(o->eta < 1.0)) {
        return;
    }
    for (i = 0; i < ASPERITY_SLIDERS; i++) {
        opening[i] = i == 0 && o->eta - p->lost[0] < 0.1 * o->eta ? 0.1 : o->eta > p->lost[i] ? 1.0 : 0.0;
        open += weight[i] * opening[i];
    }
    for (i = 0; p->twist && i < ASPERITY_SLIDERS; i++) {
        by[0] += o->pushed[0][i] * weight[i] * o->scale * (opening[i] - o->limit[i] * open / o->sum);
        by[1] += o->pushed[1][i] * weight[i] * o->scale * (opening[i] - o->limit[i] * open / o->sum);
    }
    for (i = 0; !p->twist && i < ASPERITY_SLIDERS; i++) {
        if (o->over[i] > 0.0 && o->most[i] > 0.0) {
            double held = o->radially[i] > ASPERITY_RADIAL_MOST * o->most[i] ? ASPERITY_RADIAL_MOST : 0.0;
            double along = (1.0 - o->keep[i] * o->slider[2][i] / o->most[i] * held) * weight[i] * o->scale * (opening[i] - o->limit[i] * open / o->sum) / o->most[i];
            by[0] += o->slider[0][i] * along;
            by[1] += o->slider[1][i] * along;
        }
    }
}

/* Slopes of the forces of an elastic step, by h and d. */
ASPERITY_FN void asperity_elastic_slopes(const asperity_step *p, asperity_guess *ASPERITY_ALONE o) {
    double rise = p->row.value[ASPERITY_GAMMA] / p->e, opens[2], by_worn[2];
    int j;
    asperity_slide_slopes(p, p->row.stiff, o);
    asperity_eta_slopes(p, o, opens);
    asperity_worn_slopes(p, o, by_worn);
    o->tangent[0][0] = o->f_n * rise;
    o->tangent[1][0] = o->tangent[2][0] = 0.0;
    for (j = 0; j < 2; j++) {
        o->tangent[0][1 + j] = o->wider[j] * rise + opens[j] * o->eta_h + by_worn[j] * p->worn_by[0];
        o->tangent[1][1 + j] = o->m[j] + by_worn[j] * p->worn_by[1];
        o->tangent[2][1 + j] = o->m[j + 1] + by_worn[j] * p->worn_by[2];
    }
}

/* Plastic slip at a guess: the steady flow along r and the flow away from the vertex, sudden while the yield factor grows. */
ASPERITY_FN void asperity_flow(const asperity_step *p, asperity_spot at, double rate, asperity_guess *ASPERITY_ALONE o) {
    const asperity_row *row = &o->row;
    double flow_s[2], mobile_s[2], gap = row->approach, per = 1.0 / (o->ratio + 1e-9), per_round = 1.0 / o->round;
    double steady = asperity_shape(p->t, row, ASPERITY_FLOW, at, flow_s), grown = o->factor - p->growing;
    int i;
    o->mobile = asperity_shape(p->t, row, ASPERITY_MOBILISED, at, mobile_s);
    o->mobile_r = mobile_s[0] * p->per_friction;
    o->grown = grown > 0.0 ? grown : 0.0;
    o->sudden = o->hardens * p->sudden + o->grown * gap * o->mobile;
    o->flow = o->hardens * steady * per;
    o->flow_y = (rate * steady + o->hardens * flow_s[1] * row->share_slope) * per;
    o->flow_r = o->hardens * (flow_s[0] * p->per_friction - steady * per) * per;
    o->sudden_y = rate * p->sudden + o->grown * (row->approach_slope * o->mobile + gap * mobile_s[1] * row->share_slope);
    if (p->twist) {
        o->flow *= p->twist->flows;
        o->flow_y *= p->twist->flows;
        o->flow_r *= p->twist->flows;
    }
    for (i = 0; i < 2; i++) {
        o->slip[i] = o->flow * o->r[i] + o->sudden * o->x[i] * per_round;
        o->move[i] = p->d[i] - o->slip[i];
    }
    o->move[2] = p->radial * o->hardens;
    if (p->twist) { /* by the ratio after the flow, were all to stick: by the one before it, flow would overshoot */
        double sudden = o->sudden * o->c * per_round, gives = p->twist->gives, vertex = p->twist->vertex;
        o->per_turn = 1.0 / (1.0 + gives * (o->flow + sudden));
        o->turned = (p->twist->trial + gives * sudden * vertex) * o->per_turn;
        o->turn = p->twist->along - ASPERITY_TWIST_FLOW / ASPERITY_TWIST_LEVER * (o->flow * o->turned + sudden * (o->turned - vertex));
    }
}

/* The yield factor at a guess, and the elastic force that goes with it. Returns 0 where contact is lost. */
ASPERITY_FN int asperity_yield(const asperity_step *p, double y, const double r[2], asperity_guess *ASPERITY_ALONE o) {
    const asperity_table *t = p->t;
    const asperity_work *s = p->s;
    asperity_row *row = &o->row;
    double z = y * p->per_depth, rate, ln_force, ln_stiff, eps = ASPERITY_VERTEX_ROUND * p->friction;
    asperity_spot at;
    int i;
    asperity_read(t, p->depth + y, p->log_h + (fabs(z) < 0.015625 ? asperity_log_series(z) : asperity_logarithm(1.0 + z)), row);
    ln_force = row->value[ASPERITY_LN_FORCE] - p->row.value[ASPERITY_LN_FORCE];
    ln_stiff = row->value[ASPERITY_LN_STIFFNESS] - p->row.value[ASPERITY_LN_STIFFNESS];
    row->force = p->row.force * asperity_exponential_near(ln_force);
    row->stiff = p->row.stiff * asperity_exponential_near(ln_stiff);
    o->hardens = row->dent - p->dent;
    rate = row->dent_slope;
    /* The vertex follows r. */
    o->per_length = p->row.stiff / p->row.force * (1.0 / ASPERITY_VERTEX_LENGTH) * p->per_friction * asperity_exponential_near(ln_stiff - ln_force);
    o->q = o->hardens * o->per_length;
    o->c = 1.0 / (1.0 + o->q);
    for (i = 0; i < 2; i++) {
        o->r[i] = r[i];
        o->x[i] = (r[i] - s->vertex[i]) * o->c;
        o->vertex[i] = r[i] - o->x[i];
    }
    o->untwisted = p->twist ? (p->twisted - p->twist->vertex) * o->c : 0.0;
    o->twist_vertex = p->twisted - o->untwisted;
    o->ratio = sqrt(r[0] * r[0] + r[1] * r[1] + p->twisted * p->twisted);
    o->far = sqrt(o->x[0] * o->x[0] + o->x[1] * o->x[1] + o->untwisted * o->untwisted);
    o->round = sqrt(o->far * o->far + eps * eps);
    at = asperity_find(o->ratio * p->per_friction);
    o->factor = asperity_factor(t, p->per_friction, row, at, o->far, o->part);
    o->e = p->e - o->hardens;
    if (!(o->e > 0.0)) {
        return 0;
    }
    /* g follows the yield factor, by the share that is wide, as the contact hardens: at once, F_N would jump where it yields. */
    {
        double per = 1.0 / (ASPERITY_NARROWS * p->approach), kept = asperity_exponential(-o->hardens * per), grown = o->factor - 1.0;
        double away = (s->stiffened - row->wide * grown) * kept;
        o->width = 1.0 + row->wide * grown + away;
        o->width_factor = row->wide * (1.0 - kept);
        o->width_y = row->wide_slope * grown * (1.0 - kept) - away * rate * per;
    }
    z = (o->width - p->wide) / p->wide; /* most steps are small */
    o->log_width = fabs(z) < 0.015625 ? p->log_wide + asperity_log_series(z) : asperity_logarithm(o->width);
    o->level = asperity_logarithm(o->e / row->approach);
    o->f_n = row->force * asperity_exponential_near(row->value[ASPERITY_GAMMA] * o->level + (row->value[ASPERITY_GAMMA] - 1.0) * o->log_width);
    asperity_flow(p, at, rate, o);
    return 1;
}

/* The residuals at a guess. Returns 0 where contact is lost. */
ASPERITY_FN int asperity_evaluate(const asperity_step *p, double y, const double r[2], asperity_guess *ASPERITY_ALONE o) {
    double per;
    if (!asperity_yield(p, y, r, o)) {
        return 0;
    }
    o->reach = o->e;
    o->limit = p->limit;
    o->sum = p->sum;
    o->eta = 1.0;
    o->log_share = o->eta_y = o->eta_h = 0.0;
    if (p->e < p->s->reach) { /* the annuli that a release took come back as the contact hardens */
        double per_length = 1.0 / (ASPERITY_NARROWS * p->approach), away = 1.0 - p->e / p->s->reach, kept = asperity_exponential(-o->hardens * per_length), whole = 1.0 - away * kept;
        double gamma = o->row.value[ASPERITY_GAMMA], log_whole = asperity_logarithm(whole);
        o->reach = o->e / whole;
        o->log_share = gamma * log_whole;
        o->eta = asperity_exponential(o->log_share * p->per_exponent);
        o->eta_y = o->eta * p->per_exponent * (gamma * away * kept * o->row.dent_slope * per_length / whole + o->row.slope[ASPERITY_GAMMA] * log_whole);
        o->eta_h = o->eta * p->per_exponent * gamma * kept / (p->s->reach * whole);
        o->sum = asperity_limits(p->lost, o->eta, o->own);
        o->limit = o->own;
    }
    asperity_slide(p, o->row.stiff, o);
    o->rho = p->rho;
    o->rho_y = 0.0;
    o->rho_h = p->rho_slope;
    if (p->rho_log > 0.0) { /* what releases took comes back with flow */
        double per_dent = ASPERITY_RECOVERS / p->approach, missing = 1.0 / (p->rho_log + per_dent * o->hardens);
        o->rho = asperity_exponential(-missing);
        o->rho_y = o->rho * missing * missing * per_dent * o->row.dent_slope;
        o->rho_h *= o->rho * missing * missing * p->rho_log * p->rho_log / p->rho;
    }
    per = 1.0 / o->f_n;
    o->residual[0] = o->f_n * o->factor / o->row.force - o->rho * p->kept;
    o->residual[1] = o->f_t[0] * per - r[0];
    o->residual[2] = o->f_t[1] * per - r[1];
    return 1;
}

/* Slopes of the residuals and forces at the guess that was evaluated last, along y and r and, where all six are asked for, along h and d. */
ASPERITY_FN void asperity_guess_slopes(const asperity_step *p, int count, asperity_guess *ASPERITY_ALONE o) {
    const asperity_row *row = &o->row;
    double gamma = row->value[ASPERITY_GAMMA], gap = row->approach, rate = row->dent_slope, per = 1.0 / o->f_n, per_round = 1.0 / o->round;
    double y_of_force = row->slope[ASPERITY_LN_FORCE] + row->slope[ASPERITY_GAMMA] * (o->level + o->log_width) - gamma * (rate / o->e + row->approach_slope / gap);
    double q_y = rate * o->per_length + o->q * (row->slope[ASPERITY_LN_STIFFNESS] - row->slope[ASPERITY_LN_FORCE]);
    double v[2] = {o->x[0] * per_round, o->x[1] * per_round}, per_ratio = o->ratio > 0.0 ? 1.0 / o->ratio : 0.0, far = o->far > 0.0 ? o->round / o->far : 0.0;
    double by_worn[2] = {0.0, 0.0}, opens[2], load = o->f_n * o->factor / row->force, by_width = (gamma - 1.0) / o->width;
    const int grows = o->grown > 0.0 || (count == 3 && p->rises && o->factor > p->growing - 1e-9); /* where it begins to, Newton's first step has to know */
    int i, j;
    asperity_slide_slopes(p, row->stiff, o);
    asperity_eta_slopes(p, o, opens);
    if (count > 3) {
        asperity_worn_slopes(p, o, by_worn);
    }
    for (j = 0; j < count; j++) { /* along y, r, h, d */
        double dy = j == 0 ? 1.0 : 0.0, dr[2] = {j == 1 ? 1.0 : 0.0, j == 2 ? 1.0 : 0.0}, dx[2], dn[2], dmove[3], dz, dround, dfar, dratio, dfactor, df, dsudden, dflow, dturn;
        dx[0] = o->c * (dr[0] - o->x[0] * q_y * dy);
        dx[1] = o->c * (dr[1] - o->x[1] * q_y * dy);
        dz = -o->c * o->untwisted * q_y * dy;
        dround = v[0] * dx[0] + v[1] * dx[1] + o->untwisted * per_round * dz;
        dfar = dround * far;
        dratio = (o->r[0] * dr[0] + o->r[1] * dr[1]) * per_ratio;
        dfactor = o->part[0] * dratio + o->part[1] * dfar + o->part[2] * dy;
        df = (j == 0 ? y_of_force : j == 3 ? gamma / o->e : 0.0) + by_width * (o->width_factor * dfactor + o->width_y * dy); /* over F_N */
        dsudden = o->sudden_y * dy;
        if (grows) {
            dsudden += gap * ((dfactor - (j == 3 ? p->growing_slope : 0.0)) * o->mobile + o->grown * o->mobile_r * dratio);
        }
        dflow = o->flow_y * dy + o->flow_r * dratio;
        for (i = 0; i < 2; i++) {
            dn[i] = dflow * o->r[i] + o->flow * dr[i] + dsudden * v[i] + o->sudden * (dx[i] - v[i] * dround) * per_round;
            dmove[i] = (j == 4 + i ? 1.0 : 0.0) - dn[i];
        }
        dmove[2] = p->radial * rate * dy;
        dturn = 0.0;
        if (p->twist) {
            dz = o->c * per_round * (dsudden - o->sudden * (o->c * q_y * dy + dround * per_round));
            dturn = -ASPERITY_TWIST_FLOW / ASPERITY_TWIST_LEVER * o->per_turn * (dflow * o->turned + dz * (o->turned - p->twist->vertex));
        }
        o->n_by[j] = o->f_n * df;
        for (i = 0; i < 2; i++) {
            double across = o->m[i] * dmove[0] + o->m[i + 1] * dmove[1];
            o->t_by[j][i] = across + o->radial[i] * dmove[2] + o->stiffer[i] * row->stiff * row->slope[ASPERITY_LN_STIFFNESS] * dy + o->wider[i] * df + (j > 2 ? by_worn[i] * p->worn_by[j - 3] : 0.0) +
                            opens[i] * (o->eta_y * dy + (j == 3 ? o->eta_h : 0.0)) + o->by_turn[i] * dturn;
            o->by[j][1 + i] = (o->t_by[j][i] - o->f_t[i] * df) * per - dr[i];
        }
        o->by[j][0] = load * (df + dfactor / o->factor - row->slope[ASPERITY_LN_FORCE] * dy) - p->kept * (j == 0 ? o->rho_y : j == 3 ? o->rho_h : 0.0);
    }
}

/* Moves y and r by x so that the three equations, off by `right`, are met. */
ASPERITY_FN int asperity_solve(const asperity_guess *o, const double right[3], double x[3]) {
    const double *a = o->by[0], *b = o->by[1], *c = o->by[2]; /* columns */
    double bc[3] = {b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]};
    double whole = -(a[0] * bc[0] + a[1] * bc[1] + a[2] * bc[2]), per;
    if (!(fabs(whole) > 0.0)) {
        return 0;
    }
    per = 1.0 / whole;
    x[0] = (right[0] * bc[0] + right[1] * bc[1] + right[2] * bc[2]) * per;
    x[1] = (a[0] * (right[1] * c[2] - right[2] * c[1]) + a[1] * (right[2] * c[0] - right[0] * c[2]) + a[2] * (right[0] * c[1] - right[1] * c[0])) * per;
    x[2] = (a[0] * (b[1] * right[2] - b[2] * right[1]) + a[1] * (b[2] * right[0] - b[0] * right[2]) + a[2] * (b[0] * right[1] - b[1] * right[0])) * per;
    return 1;
}

/* Moves r by x[1], x[2] so that its two equations are met where y moves by dy, x[0]. */
ASPERITY_FN void asperity_solve_at(const asperity_guess *o, double dy, double x[3]) {
    const double *a = o->by[0], *b = o->by[1], *c = o->by[2];
    double right[2], whole = b[1] * c[2] - c[1] * b[2];
    right[0] = -o->residual[1] - a[1] * dy;
    right[1] = -o->residual[2] - a[2] * dy;
    x[0] = dy;
    if (fabs(whole) > 0.0) {
        x[1] = (right[0] * c[2] - c[1] * right[1]) / whole;
        x[2] = (b[1] * right[1] - right[0] * b[2]) / whole;
    }
}

/* Elastic energy of the sliders. */
ASPERITY_FN double asperity_slider_energy(const double x[ASPERITY_PADDED], const double y[ASPERITY_PADDED], double stiff) {
    const double *per_weight = asperity_per_weights();
    double energy[ASPERITY_PADDED];
    int i;
    ASPERITY_LANES
    for (i = 0; i < ASPERITY_PADDED; i++) {
        energy[i] = (x[i] * x[i] + y[i] * y[i]) * per_weight[i];
    }
    return 0.5 * asperity_sum(energy) / stiff;
}

/* What a step starts from: the row, the elastic trial's place, the forces and energy so far. */
ASPERITY_FN void asperity_prepare(const asperity_table *t, const asperity_work *s, double h, const double d[2], asperity_step *p) {
    asperity_row *row = &p->row;
    double e0, gamma, level;
    p->t = t;
    p->s = s;
    p->twisted = p->twist ? p->twist->ratio : 0.0;
    p->kept = p->twist ? p->twist->kept : 1.0;
    p->friction = (double)t->friction > 1e-9 ? (double)t->friction : 1e-9;
    p->per_friction = 1.0 / p->friction;
    p->h = h;
    p->d[0] = d[0];
    p->d[1] = d[1];
    p->depth = (double)t->first + s->hardened;
    p->per_depth = 1.0 / p->depth;
    p->log_h = s->hardened > 0.0 ? asperity_logarithm(1.0 + s->hardened / (double)t->first) : 0.0;
    asperity_read(t, p->depth, p->log_h, row);
    row->force = asperity_exponential(row->value[ASPERITY_LN_FORCE]);
    row->stiff = asperity_exponential(row->value[ASPERITY_LN_STIFFNESS]);
    p->approach = row->approach;
    /* The dent that the memory has, where it has one, and the approach by differences: so float does not lose what hardens less in a step than a last digit. */
    p->dent = s->h - s->approach;
    if (s->approach > 0.0 && fabs(p->dent - row->dent) <= 16.0 * ASPERITY_ROUNDING * p->depth) {
        e0 = s->approach;
        p->e = e0 + (h - s->h);
    } else {
        p->dent = row->dent;
        e0 = s->approach > 0.0 ? s->h - p->dent : 0.0;
        p->e = h - p->dent;
    }
    p->wide = 1.0 + s->stiffened;
    p->log_wide = s->stiffened > 0.0 ? asperity_logarithm(p->wide) : 0.0;
    gamma = row->value[ASPERITY_GAMMA];
    p->level = p->e > 0.0 ? asperity_logarithm(p->e / p->approach) : 0.0;
    p->old_f_n = p->old_f_t[0] = p->old_f_t[1] = p->old_stored[0] = p->old_stored[1] = 0.0;
    if (e0 > 0.0) {
        double z = p->e > 0.0 ? (e0 - p->e) / p->e : 1.0;
        level = fabs(z) < 0.015625 ? p->level + asperity_log_series(z) : asperity_logarithm(e0 / p->approach);
        p->old_f_n = row->force * asperity_exponential(gamma * level + (gamma - 1.0) * p->log_wide);
        p->old_f_t[0] = asperity_sum(s->slider[0]);
        p->old_f_t[1] = asperity_sum(s->slider[1]);
        p->old_stored[0] = p->old_f_n * e0 / (gamma + 1.0);
        p->old_stored[1] = asperity_slider_energy(s->slider[0], s->slider[1], row->stiff);
        p->f_n = p->e > 0.0 ? p->old_f_n * asperity_exponential_near(gamma * (p->level - level)) : 0.0;
    } else {
        p->f_n = p->e > 0.0 ? row->force * asperity_exponential(gamma * p->level + (gamma - 1.0) * p->log_wide) : 0.0;
    }
}

/* The memory after a step. */
ASPERITY_FN void asperity_keep(const asperity_step *p, const asperity_guess *o, double y, double softened, double released, asperity_work *next) {
    const asperity_work *s = p->s;
    int i, j;
    next->h = p->h;
    next->h_max = p->h > s->h_max ? p->h : s->h_max;
    next->approach = o->e;
    next->hardened = s->hardened + y;
    next->reach = o->reach;
    next->softened = softened;
    next->released = released;
    next->stiffened = s->stiffened;
    next->worn = p->worn;
    next->vertex[0] = s->vertex[0];
    next->vertex[1] = s->vertex[1];
    if (o->f_n > 0.0) {
        if (o->plastic) {
            next->stiffened = o->width > 1.0 ? o->width - 1.0 : 0.0;
            next->vertex[0] = o->vertex[0];
            next->vertex[1] = o->vertex[1];
        }
    }
    for (j = 0; j < 3; j++) {
        for (i = 0; i < ASPERITY_PADDED; i++) {
            next->slider[j][i] = o->slider[j][i];
        }
    }
}

/* No contact hardens more in a step. */
ASPERITY_FN double asperity_most(const asperity_step *p) {
    return 3.0 * (p->e + p->depth);
}

/* Newton's method for the hardening y and the ratio r, from a guess. Returns whether they are found, and o is of them. */
ASPERITY_FN int asperity_newton(const asperity_step *p, double *y, double r[2], asperity_guess *ASPERITY_ALONE o) {
    double from[3] = {0.0, 0.0, 0.0}, step[3] = {0.0, 0.0, 0.0}, least = 1e300, bound = 0.5 * p->friction + 0.01, most = asperity_most(p);
    int tries, back = 0, known = 0, i;
    for (tries = 1;; tries++) {
        int touches = asperity_evaluate(p, *y, r, o);
        double norm = touches ? o->residual[0] * o->residual[0] + o->residual[1] * o->residual[1] + o->residual[2] * o->residual[2] : 1e300, size;
        if (norm < ASPERITY_TOLERANCE * ASPERITY_TOLERANCE) {
            return 1;
        }
        if (tries == 1 && !touches) {
            *y = 0.0;
            continue;
        }
        if (tries > 1 && !(norm <= 1.1 * least) && back < 6) {
            back++;
            for (i = 0; i < 3; i++) {
                step[i] *= 0.4;
            }
        } else {
            if (!touches || tries >= ASPERITY_STEPS) {
                return norm < 1e-14;
            }
            /* Near to it the slopes of before are good enough: what they leave is norm^2/least, of the squares. */
            if (!(known && norm * norm < 1e-26 * least)) {
                asperity_guess_slopes(p, 3, o);
                known = 1;
            }
            if (!asperity_solve(o, o->residual, step)) {
                return norm < 1e-14;
            }
            back = 0;
            least = norm;
            from[0] = *y;
            from[1] = r[0];
            from[2] = r[1];
            if (*y + step[0] < 0.0) {
                asperity_solve_at(o, -0.7 * *y, step);
            } else if (*y + step[0] > most) {
                asperity_solve_at(o, 0.7 * (most - *y), step);
            }
            size = sqrt(step[1] * step[1] + step[2] * step[2]);
            size = size > bound ? bound / size : 1.0;
            step[1] *= size;
            step[2] *= size;
        }
        *y = from[0] + step[0];
        r[0] = from[1] + step[1];
        r[1] = from[2] + step[2];
    }
}

/* What F_N G has over the yield force at a hardening, for the ratio that belongs to it: Newton's steps, halved where they do not bring it nearer. */
ASPERITY_FN double asperity_excess(const asperity_step *p, double y, double r[2], asperity_guess *ASPERITY_ALONE o) {
    double bound = 0.5 * p->friction + 0.01, from[2] = {r[0], r[1]}, by[2] = {0.0, 0.0}, x[3] = {0.0, 0.0, 0.0}, least = 1e300, size;
    int k, back = 0;
    for (k = 0; k < 100; k++) {
        double norm;
        if (!asperity_evaluate(p, y, r, o)) {
            return -1.0;
        }
        norm = o->residual[1] * o->residual[1] + o->residual[2] * o->residual[2];
        if (norm < ASPERITY_TOLERANCE * ASPERITY_TOLERANCE) {
            return o->residual[0];
        }
        if (norm > least && back < 12) {
            back++;
            by[0] *= 0.5;
            by[1] *= 0.5;
        } else {
            asperity_guess_slopes(p, 3, o);
            x[1] = x[2] = 0.0;
            asperity_solve_at(o, 0.0, x);
            size = sqrt(x[1] * x[1] + x[2] * x[2]);
            size = size > bound ? bound / size : 1.0;
            from[0] = r[0];
            from[1] = r[1];
            by[0] = size * x[1];
            by[1] = size * x[2];
            least = norm;
            back = 0;
        }
        r[0] = from[0] + by[0];
        r[1] = from[1] + by[1];
    }
    return asperity_evaluate(p, y, r, o) ? o->residual[0] : -1.0;
}

/* The hardening, where Newton does not find the way: r is solved for at each, and what F_N G has over the yield force falls from above zero at 0 to below it. */
ASPERITY_FN double asperity_bracket(const asperity_step *p, double guess, double r[2], asperity_guess *ASPERITY_ALONE o) {
    double most = asperity_most(p), low = 0.0, at_low = asperity_excess(p, 0.0, r, o), high = guess > 1e-3 * most ? guess : 1e-3 * most, at_high = asperity_excess(p, high, r, o), y;
    int side = 0, k;
    while (at_high > 0.0 && high < most) {
        low = high;
        at_low = at_high;
        high = 4.0 * high < most ? 4.0 * high : most;
        at_high = asperity_excess(p, high, r, o);
    }
    y = high;
    for (k = 0; k < ASPERITY_BRACKETS && at_low > 0.0 && at_high < 0.0 && high - low > 1e-15 * p->depth; k++) {
        double here;
        y = high - at_high * (high - low) / (at_high - at_low);
        here = asperity_excess(p, y, r, o);
        if (fabs(here) < ASPERITY_TOLERANCE) {
            break;
        }
        if (here > 0.0) {
            low = y;
            at_low = here;
            at_high *= side == 1 ? 0.5 : 1.0;
            side = 1;
        } else {
            high = y;
            at_high = here;
            at_low *= side == -1 ? 0.5 : 1.0;
            side = -1;
        }
    }
    return y;
}

/* The yield factor from which it grows: that of the start, or the one that F_N and the yield force would have there. The ratio r becomes that of the start, where there is one:
 * a better guess than the trial's for what flows on. Returns the yield factor there. */
ASPERITY_FN double asperity_grow_from(asperity_step *p, double softening, double factor, double r[2]) {
    const asperity_work *s = p->s;
    double before = p->kept * (1.0 - s->softened) * (1.0 - softening * s->released * s->released) * p->row.force / p->f_n, at = factor;
    p->growing = 1.0;
    p->growing_slope = 0.0;
    if (p->old_f_n > 0.0) {
        r[0] = p->old_f_t[0] / p->old_f_n;
        r[1] = p->old_f_t[1] / p->old_f_n;
        at = asperity_factor_at(p, r);
        p->growing = at;
    }
    p->rises = factor > p->growing;
    if (before > p->growing * (1.0 + 1e-10)) { /* where h stays they are the same, and rounding is not to choose its slope */
        p->growing = before;
        p->growing_slope = -before * p->row.value[ASPERITY_GAMMA] / p->e;
    }
    return at;
}

/* The hardening that brings F_N to the yield force, where the dent and D go on straight and r stays: `load` is F_N G/P, `factor` its G. */
ASPERITY_FN double asperity_first_guess(const asperity_step *p, double load) {
    double gamma = p->row.value[ASPERITY_GAMMA], left, y;
    left = asperity_exponential(-asperity_logarithm(load / (p->rho * p->kept)) / gamma);
    y = p->e * (1.0 - left) / (p->row.dent_slope + left * p->e / p->approach * p->row.approach_slope);
    return y > 0.0 ? (y < asperity_most(p) ? y : asperity_most(p)) : 0.0;
}

/* The sliders' exponent when it is sheared so far. */
ASPERITY_FN double asperity_sliders_n(const asperity_step *p, double worn) {
    return asperity_exponent(asperity_column(p->t, p->log_h, ASPERITY_FIRST_N), asperity_column(p->t, p->log_h, ASPERITY_UNSHEARED_N), (double)p->t->later, worn);
}

/* How far it was sheared and its slip reversed, as this step goes on from there: it follows r over a little way of d or F_N, and a press takes it back. A step that goes nowhere
 * leaves it, and with it the sliders. Slopes by h and d, for the tangent. */
ASPERITY_FN void asperity_wear(asperity_step *p) {
    const double *vertex = p->s->vertex;
    double gamma = p->row.value[ASPERITY_GAMMA], rate = p->row.dent_slope, per, r[2], size, turned, to, length, back, pressed;
    p->worn = p->s->worn;
    p->worn_by[0] = p->worn_by[1] = p->worn_by[2] = 0.0;
    if (!(p->old_f_n > 0.0)) {
        return;
    }
    per = p->per_friction / p->old_f_n;
    r[0] = p->old_f_t[0] * per;
    r[1] = p->old_f_t[1] * per;
    size = p->twisted * p->per_friction / ASPERITY_TWIST_YIELD;
    turned = fabs(size) * ASPERITY_TWIST_WORN;
    turned = turned < ASPERITY_TWIST_MOST ? turned : ASPERITY_TWIST_MOST;
    size = sqrt(r[0] * r[0] + r[1] * r[1] + size * size);
    size = size < 1.0 ? size : 1.0;
    to = p->worn > size ? p->worn : size;
    to = to > turned ? to : turned;
    back = -(r[0] * vertex[0] + r[1] * vertex[1]);
    if (back > 0.0) { /* slip against the vertex of a contact that was sheared */
        double sheared = to < 1.0 ? to : 1.0, reversed;
        length = sqrt(vertex[0] * vertex[0] + vertex[1] * vertex[1]);
        back = back < length ? back / length : 1.0;
        reversed = sheared + (2.0 - sheared) * sheared * sheared * sheared * sheared * back * back * length / (length + 0.02 * p->friction);
        to = to > reversed ? to : reversed;
    }
    if (to > p->worn) {
        double k = per / ASPERITY_FOLLOWS, turn = p->twist ? p->twist->along : 0.0, d = sqrt(p->d[0] * p->d[0] + p->d[1] * p->d[1] + turn * turn), kd = p->row.stiff * k, kn = (p->f_n < p->old_f_n ? -k : k) * p->friction;
        double left = asperity_exponential_near(-kd * d - kn * (p->f_n - p->old_f_n)), slope = (to - p->worn) * left;
        p->worn = to - slope;
        p->worn_by[0] = p->e > 0.0 ? slope * kn * gamma * p->f_n / p->e : 0.0;
        p->worn_by[1] = d > 0.0 ? slope * kd * p->d[0] / d : 0.0;
        p->worn_by[2] = d > 0.0 ? slope * kd * p->d[1] / d : 0.0;
    }
    if (p->worn > size && p->e > p->s->reach) {
        double per_pressed = ASPERITY_FORGETS / p->approach * rate / (rate + p->row.approach_slope + 1e-12);
        pressed = asperity_exponential_near((p->s->reach - p->e) * per_pressed);
        p->worn = size + (p->worn - size) * pressed;
        p->worn_by[0] = p->worn_by[0] * pressed - (p->worn - size) * per_pressed;
        p->worn_by[1] *= pressed;
        p->worn_by[2] *= pressed;
    }
}

/* Slopes by it of each slider's share of what all carry, for the tangent. */
ASPERITY_FN void asperity_wear_slopes(asperity_step *p, const asperity_guess *o) {
    const double less = -1e-6;
    double lost[ASPERITY_PADDED], limit[ASPERITY_PADDED], n = asperity_sliders_n(p, p->worn + less), sum;
    int i;
    asperity_lost(n, lost);
    sum = asperity_limits(lost, o->log_share < 0.0 ? asperity_exponential(o->log_share / n) : 1.0, limit);
    for (i = 0; i < ASPERITY_PADDED; i++) {
        p->share_worn[i] = (limit[i] / sum - o->limit[i] / o->sum) / less;
    }
}

/* What is released of F_N: how much the sliders carry (eta, its slope by h), and what that takes of the yield force. Returns the greatest share so far. */
ASPERITY_FN double asperity_release(asperity_step *p, double softening, asperity_guess *o) {
    const asperity_work *s = p->s;
    double gamma = p->row.value[ASPERITY_GAMMA], exponent = asperity_sliders_n(p, p->worn), released = s->released, share = 0.0;
    asperity_lost(exponent, p->lost);
    p->per_exponent = 1.0 / exponent;
    o->eta = 1.0;
    o->eta_h = o->log_share = p->rho_slope = 0.0;
    if (p->e < s->reach) {
        o->log_share = p->e > 0.0 ? gamma * asperity_logarithm(p->e / s->reach) : -1e9;
        if (p->e > 0.0) {
            o->eta = asperity_exponential(o->log_share / exponent);
            o->eta_h = o->eta * gamma / (exponent * p->e);
        }
        if (-o->log_share > released) { /* else the share released is less, too */
            share = p->e > 0.0 ? asperity_exponential(o->log_share) : 0.0;
            if (1.0 - share > released) {
                released = 1.0 - share;
                p->rho_slope = p->e > 0.0 ? (1.0 - s->softened) * 2.0 * softening * released * gamma * share / p->e : 0.0;
            }
        }
    }
    p->rho = (1.0 - s->softened) * (1.0 - softening * released * released);
    return released;
}

/* Slopes of the forces by h and d along the solution. */
ASPERITY_FN void asperity_solution_slopes(const asperity_step *p, asperity_guess *ASPERITY_ALONE o) {
    int j;
    asperity_guess_slopes(p, 6, o);
    for (j = 0; j < 3; j++) {
        double x[3] = {0.0, 0.0, 0.0};
        asperity_solve(o, o->by[3 + j], x);
        o->tangent[j][0] = o->n_by[3 + j] + o->n_by[0] * x[0] + o->n_by[1] * x[1] + o->n_by[2] * x[2];
        o->tangent[j][1] = o->t_by[3 + j][0] + o->t_by[0][0] * x[0] + o->t_by[1][0] * x[1] + o->t_by[2][0] * x[2];
        o->tangent[j][2] = o->t_by[3 + j][1] + o->t_by[0][1] * x[0] + o->t_by[1][1] * x[1] + o->t_by[2][1] * x[2];
    }
}

/* One step. What was stored and done before is left in p. */
ASPERITY_FN void asperity_move(
    const asperity_table *t, const asperity_work *s, const asperity_twist *twist, double h, const double d[2], int slopes, asperity_step *p, asperity_work *next,
    asperity_guess *ASPERITY_ALONE o) {
    double softening, released, r[2] = {0.0, 0.0}, start[2], y, guess, gamma, load = 0.0, factor;
    int touches;
    p->twist = twist;
    asperity_prepare(t, s, h, d, p);
    asperity_wear(p);
    gamma = p->row.value[ASPERITY_GAMMA];
    softening = asperity_column(t, p->log_h, ASPERITY_SOFTENING);
    released = asperity_release(p, softening, o);
    o->plastic = 0;
    o->friction = o->factor = 0.0;
    touches = asperity_elastic(p, o);
    if (touches) {
        r[0] = o->f_t[0] / o->f_n;
        r[1] = o->f_t[1] / o->f_n;
        load = o->f_n / p->row.force;
        o->factor = load * asperity_most_factor(t, &p->row, p->friction) <= p->rho * p->kept ? 0.0 : asperity_factor_at(p, r);
    }
    if (load * o->factor <= p->rho * p->kept * (1.0 + 1e-11)) {
        memset(o->tangent, 0, sizeof o->tangent);
        if (slopes && touches) {
            asperity_wear_slopes(p, o);
            asperity_elastic_slopes(p, o);
        }
        o->stored = touches ? o->f_n * o->e / (gamma + 1.0) + asperity_slider_energy(o->slider[0], o->slider[1], p->row.stiff) : 0.0;
        o->stiffness = touches ? gamma * o->f_n / o->e : 0.0;
        asperity_keep(p, o, 0.0, s->softened, released, next);
        return;
    }
    o->plastic = 1;
    p->radial = asperity_column(t, p->log_h, ASPERITY_RADIAL_SLIP);
    p->sudden = asperity_column(t, p->log_h, ASPERITY_SUDDEN);
    start[0] = r[0];
    start[1] = r[1];
    factor = asperity_grow_from(p, softening, o->factor, r);
    p->rho_log = p->rho < 1.0 - 1e-12 ? -1.0 / asperity_logarithm(p->rho) : 0.0;
    p->sum = asperity_limits(p->lost, 1.0, p->limit);
    y = guess = asperity_first_guess(p, load * factor);
    if (!asperity_newton(p, &y, r, o)) {
        y = asperity_bracket(p, guess, start, o);
    }
    if (slopes) {
        asperity_wear_slopes(p, o);
        asperity_solution_slopes(p, o);
    }
    gamma = o->row.value[ASPERITY_GAMMA];
    load = asperity_slider_energy(o->slider[0], o->slider[1], o->row.stiff);
    o->stored = o->f_n * o->e / (gamma + 1.0) + load;
    o->friction = 0.5 * ((p->old_f_t[0] + o->f_t[0]) * o->move[0] + (p->old_f_t[1] + o->f_t[1]) * o->move[1]) - (load - p->old_stored[1]);
    o->stiffness = gamma * o->f_n / o->e;
    load = 1.0 - o->rho;
    released = 0.0;
    if (o->reach > o->e) { /* what is still released: so a next step that goes nowhere finds the same */
        softening = asperity_column(t, asperity_logarithm((p->depth + y) / (double)t->first), ASPERITY_SOFTENING);
        released = 1.0 - asperity_exponential(gamma * asperity_logarithm(o->e / o->reach));
        load = 1.0 - o->rho / (1.0 - softening * released * released);
        load = load > 0.0 ? load : 0.0;
    }
    asperity_keep(p, o, y, load, released, next);
}

/* To work and back. */
ASPERITY_FN void asperity_begin(const asperity_state *from, asperity_work *to) {
    int i, j;
    to->h = (double)from->h;
    to->h_max = (double)from->h_max;
    to->approach = (double)from->approach;
    to->hardened = (double)from->hardened;
    to->reach = (double)from->reach;
    to->softened = (double)from->softened;
    to->released = (double)from->released;
    to->worn = (double)from->worn;
    to->stiffened = (double)from->stiffened;
    to->vertex[0] = (double)from->vertex[0];
    to->vertex[1] = (double)from->vertex[1];
    for (j = 0; j < 3; j++) {
        ASPERITY_LANES
        for (i = 0; i < ASPERITY_SLIDERS; i++) {
            to->slider[j][i] = (double)from->slider[j][i];
        }
        to->slider[j][ASPERITY_SLIDERS] = 0.0;
    }
}

ASPERITY_FN void asperity_end(const asperity_work *from, asperity_state *to) {
    asperity_bits bits;
    int i, j;
    to->h = ASPERITY_R(from->h);
    to->h_max = ASPERITY_R(from->h_max);
    to->approach = ASPERITY_R(from->approach);
    to->hardened = ASPERITY_R(from->hardened);
    if ((double)to->hardened > from->hardened) { /* never rounded up: a contact only hardens on */
        memcpy(&bits, &to->hardened, sizeof bits);
        bits--;
        memcpy(&to->hardened, &bits, sizeof bits);
    }
    to->reach = ASPERITY_R(from->reach);
    to->softened = ASPERITY_R(from->softened);
    to->released = ASPERITY_R(from->released);
    to->worn = ASPERITY_R(from->worn);
    to->stiffened = ASPERITY_R(from->stiffened);
    to->vertex[0] = ASPERITY_R(from->vertex[0]);
    to->vertex[1] = ASPERITY_R(from->vertex[1]);
    for (j = 0; j < 3; j++) {
        ASPERITY_LANES
        for (i = 0; i < ASPERITY_SLIDERS; i++) {
            to->slider[j][i] = ASPERITY_R(from->slider[j][i]);
        }
    }
}

/* Whether a state is one that the update may have left: all its numbers finite, and each within its bounds. */
ASPERITY_FN int asperity_is_sound(const asperity_state *s) {
    const asperity_real zero = ASPERITY_R(0.0), one = ASPERITY_R(1.0);
    asperity_real sum = zero;
    int i;
    for (i = 0; i < ASPERITY_SLIDERS; i++) {
        sum += s->slider[0][i] + s->slider[1][i] + s->slider[2][i];
    }
    /* A sum is finite only if all that it is made of are. */
    return asperity_is_finite(s->h) && asperity_is_finite(s->approach) && asperity_is_finite(sum + (s->vertex[0] + s->vertex[1])) &&
           asperity_is_finite(s->h_max + s->hardened + s->reach + s->softened + s->released + s->worn + s->stiffened) && s->h_max >= zero && s->hardened >= zero &&
           s->reach >= zero && s->softened >= zero && s->softened < one && s->released >= zero && s->released <= one && s->worn >= zero &&
           s->worn <= ASPERITY_R(2.0) && s->stiffened >= zero;
}

/* Turns the memory into axes that are turned by an angle: new components of a vector v are (c v0 + s v1, -s v0 + c v1). */
ASPERITY_FN void asperity_rotate(asperity_state *state, asperity_real cosine, asperity_real sine) {
    asperity_real q0 = state->vertex[0], q1 = state->vertex[1];
    int i;
    state->vertex[0] = cosine * q0 + sine * q1;
    state->vertex[1] = -sine * q0 + cosine * q1;
    for (i = 0; i < ASPERITY_SLIDERS; i++) {
        q0 = state->slider[0][i];
        q1 = state->slider[1][i];
        state->slider[0][i] = cosine * q0 + sine * q1;
        state->slider[1][i] = -sine * q0 + cosine * q1;
    }
}

/* Nothing in the answer is a number. */
ASPERITY_FN void asperity_refuse(asperity_response *out, asperity_tangent *tangent) {
    asperity_real bad = asperity_no_number();
    out->f_n = out->f_t[0] = out->f_t[1] = out->stiffness = out->stored = out->plastic = out->friction = bad;
    if (tangent) {
        tangent->df_t_ddelta[0][0] = tangent->df_t_ddelta[0][1] = tangent->df_t_ddelta[1][0] = tangent->df_t_ddelta[1][1] = bad;
        tangent->df_n_dh = tangent->df_n_ddelta[0] = tangent->df_n_ddelta[1] = tangent->df_t_dh[0] = tangent->df_t_dh[1] = tangent->a = bad;
    }
}

/* The contact radius over R: that of first loading, and narrower as it is released. */
ASPERITY_FN double asperity_radius(const asperity_table *t, const asperity_work *s) {
    double depth = (double)t->first + s->hardened, log_h = asperity_logarithm(depth / (double)t->first);
    asperity_row row;
    if (!(s->approach > 0.0)) {
        return 0.0;
    }
    asperity_read(t, depth, log_h, &row);
    return asperity_exponential(asperity_column(t, log_h, ASPERITY_RADIUS) +
                                (row.value[ASPERITY_GAMMA] - 1.0) * asperity_logarithm((1.0 + s->stiffened) * s->approach / row.approach));
}

/* The update with a twist, or none; its forces around the normal are left there. */
ASPERITY_FN void asperity_advance(
    const asperity_table *t, asperity_real radius, asperity_real modulus, const asperity_state *state, asperity_twist *twist, asperity_real h,
    const asperity_real increment[2], asperity_state *next, asperity_response *out, asperity_tangent *tangent) {
    const asperity_real zero = ASPERITY_R(0.0);
    asperity_real d0 = increment[0] / radius, d1 = increment[1] / radius, size;
    double force = (double)modulus * (double)radius * (double)radius, work = force * (double)radius, stiff = (double)modulus * (double)radius, d[2], total, slip;
    asperity_work s, after;
    asperity_step first;
    asperity_guess o;
    h /= radius;
    if (!asperity_is_finite(h) || !asperity_is_finite(d0) || !asperity_is_finite(d1) || !asperity_is_sound(state)) {
        asperity_refuse(out, tangent);
        *next = *state;
        return;
    }
    if (ASPERITY_ABS(h) < ASPERITY_R(ASPERITY_LEAST)) {
        h = zero;
    }
    memset(out, 0, sizeof *out);
    if (tangent) {
        memset(tangent, 0, sizeof *tangent);
    }
    if (h <= zero && state->approach <= zero) { /* an open gap: no slider has a force */
        asperity_real approach = state->approach + (h - state->h);
        *next = *state;
        next->h = h;
        next->approach = approach;
        if (twist) {
            memset(twist->sector, 0, sizeof twist->sector);
        }
        return;
    }
    size = ASPERITY_ABS(d0) > ASPERITY_ABS(d1) ? ASPERITY_ABS(d0) : ASPERITY_ABS(d1);
    if (size > ASPERITY_MOST) {
        d0 = d0 / size * ASPERITY_MOST;
        d1 = d1 / size * ASPERITY_MOST;
    }
    d[0] = (double)d0;
    d[1] = (double)d1;
    asperity_begin(state, &s);
    asperity_move(t, &s, twist, (double)h, d, tangent != NULL, &first, &after, &o);
    if (!asperity_is_finite(ASPERITY_R(o.stored)) || !asperity_is_finite(ASPERITY_R(o.f_n + o.f_t[0] + o.f_t[1]))) {
        asperity_refuse(out, tangent);
        *next = *state;
        return;
    }
    /* What was done (by the mean of the forces before and after) and is not stored. The sliders' share is friction's, all of it in an elastic step; the rest plastic flow's. */
    total = 0.5 * ((first.old_f_n + o.f_n) * ((double)h - s.h) + (first.old_f_t[0] + o.f_t[0]) * d[0] + (first.old_f_t[1] + o.f_t[1]) * d[1]);
    total -= o.stored - (first.old_stored[0] + first.old_stored[1]);
    if (!(o.f_n > 0.0) && total < 0.0) {
        total = 0.0; /* contact was lost within the step */
    }
    slip = !o.plastic || total < 0.0 || o.friction > total ? total : o.friction > 0.0 ? o.friction : 0.0;
    out->f_n = ASPERITY_R(o.f_n * force);
    out->f_t[0] = ASPERITY_R(o.f_t[0] * force);
    out->f_t[1] = ASPERITY_R(o.f_t[1] * force);
    out->stiffness = ASPERITY_R(o.stiffness * stiff);
    out->stored = ASPERITY_R(o.stored * work);
    out->friction = ASPERITY_R(slip * work);
    out->plastic = ASPERITY_R((total - slip) * work);
    if (tangent) {
        tangent->df_n_dh = ASPERITY_R(o.tangent[0][0] * stiff);
        tangent->df_t_dh[0] = ASPERITY_R(o.tangent[0][1] * stiff);
        tangent->df_t_dh[1] = ASPERITY_R(o.tangent[0][2] * stiff);
        tangent->df_n_ddelta[0] = ASPERITY_R(o.tangent[1][0] * stiff);
        tangent->df_n_ddelta[1] = ASPERITY_R(o.tangent[2][0] * stiff);
        tangent->df_t_ddelta[0][0] = ASPERITY_R(o.tangent[1][1] * stiff);
        tangent->df_t_ddelta[0][1] = ASPERITY_R(o.tangent[2][1] * stiff);
        tangent->df_t_ddelta[1][0] = ASPERITY_R(o.tangent[1][2] * stiff);
        tangent->df_t_ddelta[1][1] = ASPERITY_R(o.tangent[2][2] * stiff);
        tangent->a = ASPERITY_R(asperity_radius(t, &after) * (double)radius);
    }
    asperity_end(&after, next);
    if (twist) {
        memcpy(twist->sector, o.sector, sizeof o.sector);
        twist->vertex = o.plastic && o.f_n > 0.0 ? o.twist_vertex : twist->vertex;
    }
}

/* Moves a contact to the indentation h and along the plane by `increment`. `next` may be `state`; `tangent` may be NULL. Where h or the increment is not finite,
 * or the state is not sound, nothing in the answer is a number and the state stays as it was. */
ASPERITY_FN void asperity_update(
    const asperity_table *t, asperity_real radius, asperity_real modulus, const asperity_state *state, asperity_real h, const asperity_real increment[2],
    asperity_state *next, asperity_response *out, asperity_tangent *tangent) {
    asperity_advance(t, radius, modulus, state, NULL, h, increment, next, out, tangent);
}

/* Elastic energy that a contact stores. */
ASPERITY_FN asperity_real asperity_stored_energy(const asperity_table *t, asperity_real radius, asperity_real modulus, const asperity_state *state) {
    const double none[2] = {0.0, 0.0};
    asperity_work s;
    asperity_step p;
    if (!asperity_is_sound(state)) {
        return asperity_no_number();
    }
    asperity_begin(state, &s);
    p.twist = NULL;
    asperity_prepare(t, &s, s.h, none, &p);
    return ASPERITY_R((p.old_stored[0] + p.old_stored[1]) * (double)modulus * (double)radius * (double)radius * (double)radius);
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
    const asperity_real single[11] = {t->share, t->poissons_ratio, t->friction, t->effective_modulus, t->effective_radius, t->deepest, t->later, t->first, t->per_step, t->level_start, t->per_level};
    uint64_t hash = asperity_mix(asperity_mix(0xcbf29ce484222325ull, &t->plane, sizeof t->plane), single, sizeof single);
    hash = asperity_mix(asperity_mix(hash, t->rows, sizeof t->rows), t->shapes, sizeof t->shapes);
    return asperity_mix(asperity_mix(hash, t->reach, sizeof t->reach), t->beyond, sizeof t->beyond);
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

static inline int asperity_scan_numbers(FILE *file, asperity_real *value, int count) {
    int i, good = 1;
    for (i = 0; good && i < count; i++) {
        good = asperity_scan_number(file, &value[i]);
    }
    return good;
}

static inline int asperity_scan_word(FILE *file, const char *word) {
    char found[32];
    return fscanf(file, "%31s", found) == 1 && strcmp(found, word) == 0;
}

static inline int asperity_is_within(asperity_real x, double least, double most) {
    return asperity_is_finite(x) && (double)x >= least && (double)x <= most;
}

/* Whether the numbers of a table are such that the update may count on them: n and gamma above 1, a dent that deepens, no loss below 0. */
static inline int asperity_is_sound_table(const asperity_table *t) {
    static const double least[ASPERITY_COLUMNS] = {-150.0, -150.0, 1e-30, 1.0 + 1e-3, 1.0 + 1e-3, 0.0, 0.0, 0.0, 0.0, -100.0};
    static const double most[ASPERITY_COLUMNS] = {30.0, 30.0, 1.0, 2.0, 100.0, 100.0, 100.0, 100.0, 0.999, 30.0};
    int i, j, k;
    int good = (t->plane == 0 || t->plane == 1) && asperity_is_within(t->share, 1e-6, 1e6) && asperity_is_within(t->poissons_ratio, -1.0, 0.5) &&
               asperity_is_within(t->friction, 0.0, 1e9) && asperity_is_within(t->effective_modulus, 1e-30, 1e30) && asperity_is_within(t->effective_radius, 1e-30, 1e30) &&
               asperity_is_within(t->deepest, 0.0, 10.0) && asperity_is_within(t->later, 1.0 + 1e-3, 100.0) && asperity_is_within(t->first, 1e-30, 10.0) &&
               asperity_is_within(t->per_step, 1e-3, 1e6) && asperity_is_within(t->level_start, 0.0, 100.0) && asperity_is_within(t->per_level, 1e-4, 1e6);
    for (i = 0; good && i < ASPERITY_ROWS; i++) {
        for (k = 0; good && k < ASPERITY_COLUMNS; k++) {
            good = asperity_is_within(t->rows[i][k], least[k], most[k]);
        }
        good = good && (i == 0 || t->rows[i][ASPERITY_RECOVERED] <= t->rows[i - 1][ASPERITY_RECOVERED]);
    }
    for (i = 0; good && i < ASPERITY_LEVELS; i++) {
        for (j = 0; good && j < ASPERITY_SHAPES; j++) {
            for (k = 0; good && k <= ASPERITY_PLACES; k++) {
                good = asperity_is_within(t->shapes[i][j][k], 0.0, 1e9);
            }
        }
        good = good && asperity_is_within(t->reach[i], 1e-12, 1e9) && asperity_is_within(t->beyond[i], 0.0, 1e6);
    }
    return good;
}

/* Reads a file that `asperity law export` wrote. Returns 0; 1: it cannot be opened, 2: it is no such file or of another version, 3: it is cut short, damaged, or has numbers that no law has. */
static inline int asperity_read_table(const char *path, asperity_table *t) {
    char body[32];
    int version, i, good;
    FILE *file = fopen(path, "r");
    memset(t, 0, sizeof *t);
    if (!file) {
        return 1;
    }
    if (fscanf(file, "asperity-contact-table %d body %31s", &version, body) != 2 || version != 5) {
        fclose(file);
        return 2;
    }
    t->plane = strcmp(body, "plane") == 0;
    good = asperity_scan_named(file, "share", &t->share) && asperity_scan_named(file, "poissons_ratio", &t->poissons_ratio) &&
           asperity_scan_named(file, "friction", &t->friction) && asperity_scan_named(file, "effective_modulus", &t->effective_modulus) &&
           asperity_scan_named(file, "effective_radius", &t->effective_radius) && asperity_scan_named(file, "deepest", &t->deepest) &&
           asperity_scan_named(file, "later", &t->later) && asperity_scan_named(file, "first", &t->first) && asperity_scan_named(file, "per_step", &t->per_step) &&
           asperity_scan_named(file, "level_start", &t->level_start) && asperity_scan_named(file, "per_level", &t->per_level) && asperity_scan_word(file, "rows");
    for (i = 0; good && i < ASPERITY_ROWS; i++) {
        good = asperity_scan_numbers(file, t->rows[i], ASPERITY_COLUMNS);
    }
    good = good && asperity_scan_word(file, "shapes");
    for (i = 0; good && i < ASPERITY_LEVELS * ASPERITY_SHAPES; i++) {
        good = asperity_scan_numbers(file, t->shapes[i / ASPERITY_SHAPES][i % ASPERITY_SHAPES], ASPERITY_PLACES + 1);
    }
    good = good && asperity_scan_word(file, "vertex");
    for (i = 0; good && i < ASPERITY_LEVELS; i++) {
        good = asperity_scan_number(file, &t->reach[i]) && asperity_scan_number(file, &t->beyond[i]);
    }
    good = good && asperity_scan_word(file, "end");
    fclose(file);
    return good && asperity_is_sound_table(t) ? 0 : 3;
}
#endif

#endif
