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
 * positive. The answer is a function of `state` alone, which stays as it is: it may be asked twice. For three dimensions, two radii, walls: asperity_contact3d.h. Many contacts of one law
 * go three times as fast through asperity_update_many().
 *
 * A table is of a sphere on a rigid plane (table.plane is 1) or of two spheres (0): then h and d are `table.share` times what the two centres move. A table for a plane may
 * stand for two equal spheres with a share of 1/2, which is exact without friction only: a plane holds the surface by friction while it is pressed, where two equal spheres
 * move alike.
 *
 * The law is a macro-element. Elastic: F_N = P g^(gamma - 1) (e/D)^gamma, where e = h - dent, and P, D, gamma and the dent go with the depth h_m up to which it has hardened. Along the
 * plane seven sliders, annuli of the contact, each slipping at mu times its share of F_N. It yields at F_N G = rho P, where G grows with r = F_T/F_N and with the distance of r from
 * a vertex that follows it; then the contact hardens, and slips by plastic flow along r and away from the vertex. Each step is solved implicitly by Newton's method, and one that is too
 * long for it in parts.
 */
#ifndef ASPERITY_CONTACT_H
#define ASPERITY_CONTACT_H

#ifndef __CUDACC_RTC__
#include <math.h>
#include <stdint.h>
#include <string.h>
#if defined(__AVX__) && defined(__GNUC__) && !defined(__CUDACC__)
#include <immintrin.h>
#endif
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

/* Before a loop over the sliders of one contact: gcc would take it apart before it thinks of lanes. */
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

/* What a step is to find: the forces, also their slopes, or of several contacts only those that do not yield. */
enum { ASPERITY_FORCES, ASPERITY_SLOPES, ASPERITY_ELASTIC };

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
    asperity_real hint[3];    /* how the last plastic step went; it only tells Newton's method where to begin */
} asperity_state;
#define ASPERITY_NUMBERS (14 + 3 * ASPERITY_SLIDERS) /* of a memory */

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
    asperity_real unsolved;     /* 0; or what is left of the equations, over F_N, of a step at which nothing finds their answer */
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
#define ASPERITY_GUESSES 4096                  /* at the most, of one of these (tests/law/unsolved.c, as the next two) */
#define ASPERITY_ALL_GUESSES 65536             /* and of all in a step */
#define ASPERITY_PARTS 256                     /* of a step where neither does (tests/law/unsolved.c counts what is left) */
#define ASPERITY_SHORT (1.0 / 15.0)            /* greatest step over mu on the way to a ratio (the same) */
#define ASPERITY_HINT_SHORT 0.06               /* greatest way to the trial's ratio over mu of a step that begins by its hint (benches/law/fit_hint.py) */
#define ASPERITY_TOLERANCE 1e-12               /* of F_N over the yield force and of F_T/F_N */

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

/* ---- one contact ---- */

#define asperity_v double
#define asperity_m int
#define asperity_i int
#define asperity_choose(is, yes, no) ((is) ? (yes) : (no))
#define asperity_put(is, place, value) ((place) = (is) ? (value) : (place))
#define asperity_not(is) (!(is))
#define asperity_any(is) (is)
#define asperity_all(x) (x)
#define asperity_size(x) fabs(x)
#define asperity_root(x) sqrt(x)
#define asperity_whole(x) ((int)(x))
#define asperity_number(i) ((double)(i))
#define asperity_gather(from, place) ((double)(from)[place])
#define asperity_fma(a, b, c) ASPERITY_FMA(a, b, c)
#define ASPERITY_SEVERAL 0
#define ASPERITY_EVERY 1
#define ASPERITY_CELLS ASPERITY_PADDED /* lanes for the sliders */
#define ASPERITY_LAST_TWO(x) ((x)[5] + (x)[7])
#define ASPERITY_TWISTS(p) ((p)->twist)
#define ASPERITY_KEPT ASPERITY_SOLVED /* columns of a row */
#define ASPERITY_TRIES ASPERITY_STEPS
#define ASPERITY_NEAR ASPERITY_TOLERANCE
#define ASPERITY_ENOUGH 1e-14 /* square of the residuals where rounding leaves no better */
#define ASPERITY_LOOP ASPERITY_LANES
#define ASPERITY_UNROLL
/* A loop of its own: a compiler makes lanes of short ones. */
#define ASPERITY_NEXT } ASPERITY_LANES for (i = 0; i < ASPERITY_PADDED; i++) {

ASPERITY_FN double asperity_logarithm(double x);
ASPERITY_FN double asperity_exponential(double x);
#include "asperity_series.h"

#include "asperity_numbers.h"
#include "asperity_sliders.h"
#include "asperity_guess.h"
#include "asperity_move.h"

#undef asperity_v
#undef asperity_m
#undef asperity_i
#undef asperity_choose
#undef asperity_put
#undef asperity_not
#undef asperity_any
#undef asperity_all
#undef asperity_size
#undef asperity_root
#undef asperity_whole
#undef asperity_number
#undef asperity_gather
#undef asperity_fma
#undef ASPERITY_SEVERAL
#undef ASPERITY_EVERY
#undef ASPERITY_CELLS
#undef ASPERITY_LAST_TWO
#undef ASPERITY_TWISTS
#undef ASPERITY_KEPT
#undef ASPERITY_TRIES
#undef ASPERITY_NEAR
#undef ASPERITY_ENOUGH
#undef ASPERITY_LOOP
#undef ASPERITY_UNROLL
#undef ASPERITY_NEXT

/* ---- several contacts at once: the same, with a vector of the machine's width in place of a number ---- */

#include "asperity_wide.h"

#if ASPERITY_WIDTH > 1
#define ASPERITY_SEVERAL 1
#define ASPERITY_EVERY asperity_wide_every()
#define ASPERITY_CELLS ASPERITY_SLIDERS
#define ASPERITY_LAST_TWO(x) (x)[5]
#define ASPERITY_TWISTS(p) 0
#define ASPERITY_KEPT ASPERITY_SOFTENING
#define ASPERITY_TRIES 8 /* of 10,000 contacts about four need more (in benches/lammps_speed) and are moved by themselves */
#define ASPERITY_NEAR ASPERITY_TOLERANCE
#define ASPERITY_ENOUGH 0.0
#define ASPERITY_LOOP ASPERITY_UNROLL
#if defined(__GNUC__) && !defined(__clang__) && __GNUC__ >= 8
#define ASPERITY_UNROLL _Pragma("GCC unroll 7")
#else
#define ASPERITY_UNROLL
#endif
#define ASPERITY_NEXT
#include "asperity_wide_names.h"
#include "asperity_series.h"
#include "asperity_sliders.h"
#include "asperity_guess.h"
#include "asperity_move.h"
@WIDE_END@
#endif

/* ---- the functions to call ---- */

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
        to->hint[j] = (double)from->hint[j];
    }
}

/* What hardened is never rounded up: a contact only hardens on. */
ASPERITY_FN void asperity_round_down(asperity_real *rounded, double from) {
    asperity_bits bits;
    if ((double)*rounded > from) {
        memcpy(&bits, rounded, sizeof bits);
        bits--;
        memcpy(rounded, &bits, sizeof bits);
    }
}

ASPERITY_FN void asperity_end(const asperity_work *from, asperity_state *to) {
    int i, j;
    to->h = ASPERITY_R(from->h);
    to->h_max = ASPERITY_R(from->h_max);
    to->approach = ASPERITY_R(from->approach);
    to->hardened = ASPERITY_R(from->hardened);
    asperity_round_down(&to->hardened, from->hardened);
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
        to->hint[j] = ASPERITY_R(from->hint[j]);
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
    return asperity_is_finite(s->h) && asperity_is_finite(s->approach) && asperity_is_finite(sum + (s->vertex[0] + s->vertex[1]) + (s->hint[0] + s->hint[1] + s->hint[2])) &&
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
    out->f_n = out->f_t[0] = out->f_t[1] = out->stiffness = out->stored = out->plastic = out->friction = out->unsolved = bad;
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
    return asperity_exponential(asperity_column(t, &row, ASPERITY_RADIUS) +
                                (row.value[ASPERITY_GAMMA] - 1.0) * asperity_logarithm((1.0 + s->stiffened) * s->approach / row.approach));
}

/* What a step that needs solving starts with. */
typedef struct asperity_entry {
    double h, d[2];
} asperity_entry;

/* Whether a contact's step has to be solved, from the increment over R. What has not is answered: what has no answer, and an open gap, where no slider has a force. `known`: whether
 * the memory is sound is seen to elsewhere. */
ASPERITY_FN int asperity_enter(
    asperity_real radius, const asperity_state *state, int known, asperity_real h, const asperity_real increment[2], asperity_state *next, asperity_response *out,
    asperity_tangent *tangent, asperity_entry *to) {
    const asperity_real zero = ASPERITY_R(0.0);
    asperity_real d0 = increment[0] / radius, d1 = increment[1] / radius, size;
    int open;
    h /= radius;
    if (ASPERITY_ABS(h) < ASPERITY_R(ASPERITY_LEAST)) {
        h = zero;
    }
    open = h <= zero && state->approach <= zero;
    if (!asperity_is_finite(h) || !asperity_is_finite(d0) || !asperity_is_finite(d1) || ((open || !known) && !asperity_is_sound(state))) {
        asperity_refuse(out, tangent);
        *next = *state;
        return 0;
    }
    if (open) {
        asperity_real approach = state->approach + (h - state->h);
        memset(out, 0, sizeof *out);
        if (tangent) {
            memset(tangent, 0, sizeof *tangent);
        }
        *next = *state;
        next->h = h;
        next->approach = approach;
        return 0;
    }
    size = ASPERITY_ABS(d0) > ASPERITY_ABS(d1) ? ASPERITY_ABS(d0) : ASPERITY_ABS(d1);
    if (size > ASPERITY_MOST) {
        d0 = d0 / size * ASPERITY_MOST;
        d1 = d1 / size * ASPERITY_MOST;
    }
    to->h = (double)h;
    to->d[0] = (double)d0;
    to->d[1] = (double)d1;
    return 1;
}

#include "asperity_advance.h"

/* Moves a contact to the indentation h and along the plane by `increment`. `next` may be `state`; `tangent` may be NULL. Where h or the increment is not finite,
 * or the state is not sound, nothing in the answer is a number and the state stays as it was. */
ASPERITY_FN void asperity_update(
    const asperity_table *t, asperity_real radius, asperity_real modulus, const asperity_state *state, asperity_real h, const asperity_real increment[2],
    asperity_state *next, asperity_response *out, asperity_tangent *tangent) {
    asperity_advance(t, radius, modulus, state, NULL, h, increment, next, out, tangent);
}

#include "asperity_several.h"

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

#include "asperity_file.h"

#endif
