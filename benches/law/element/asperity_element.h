/* asperity_element.h: one contact of an elastic-plastic sphere as a macro-element, an implicit update of F_N and F_T. C99, C++17.
 *
 * Lengths over R, forces over E R^2. A contact's memory is one element_state, all bytes zero before first contact. Each step:
 *     element_update(&table, &state, h, d, &next, &out, &tangent);
 * h: indentation (negative: a gap), d[2]: tangential displacement since the last call. The answer is a function of `state` alone, which may be `next`.
 * No global data, no allocation, no failure at run time. element_table.h makes the table; README.md has the equations.
 */
#ifndef ASPERITY_ELEMENT_H
#define ASPERITY_ELEMENT_H

#include <math.h>
#include <string.h>
#include "element_constants.h"

#ifdef ASPERITY_CONTACT_H /* its functions are faster than most libraries' */
#define ELEMENT_EXP asperity_exponential
#define ELEMENT_LOG asperity_logarithm
#else
#define ELEMENT_EXP exp
#define ELEMENT_LOG log
#endif

#define ELEMENT_SLIDERS 7
#define ELEMENT_ROWS 160
#define ELEMENT_LEVELS 24
#define ELEMENT_PLACES 24 /* of a shape, at 1 - (1 - j/24)^2: denser at full slip */
#define ELEMENT_STEPS 40  /* of Newton */
#define ELEMENT_HALVINGS 10
#define ELEMENT_TOLERANCE 1e-12 /* of F_N over the yield force and of F_T/F_N */

/* Columns over the hardening depth: those that a step solves with, and those of its start. */
enum { ELEMENT_LN_FORCE, ELEMENT_LN_STIFFNESS, ELEMENT_APPROACH, ELEMENT_DENT, ELEMENT_GAMMA, ELEMENT_SOLVED,
       ELEMENT_FIRST_N = ELEMENT_SOLVED, ELEMENT_UNSHEARED_N, ELEMENT_RADIAL_SLIP, ELEMENT_SUDDEN, ELEMENT_SOFTENING, ELEMENT_COLUMNS };

/* Shapes over r/mu, and that of the vertex over its distance: the steady loss A, the steady flow, the flow with a growing yield factor, B. */
enum { ELEMENT_LOST, ELEMENT_FLOW, ELEMENT_MOBILISED, ELEMENT_VERTEX, ELEMENT_SHAPES };

typedef struct element_table {
    double friction, later;                      /* later: n of the sliders after their slip was reversed */
    double first, log_first, per_step;           /* first: depth of first yield; rows are even in ln h */
    double per_level;                            /* levels too, from the same place to the deepest */
    double rows[ELEMENT_ROWS][ELEMENT_COLUMNS];
    double shapes[ELEMENT_LEVELS][ELEMENT_SHAPES][ELEMENT_PLACES + 1];
    double reach[ELEMENT_LEVELS], beyond[ELEMENT_LEVELS]; /* of the vertex: its distance at full slip, and its loss beyond that over the mean slope before */
} element_table;

typedef struct element_state {
    double h;
    double hardened;                     /* h_m less the depth of first yield */
    double reach;                        /* elastic approach at which the sliders are whole */
    double softened;                     /* 1 - rho: what releases took of the yield force */
    double released;                     /* greatest share of F_N released since the contact last yielded */
    double worn;                         /* 0 to 1 sheared so far, to 2 its slip reversed */
    double vertex[2];                    /* alpha */
    double stiffened;                    /* g - 1: by what the contact is wider than its F_N, as shear took F_N and left its radius */
    double slider[3][ELEMENT_SLIDERS];   /* forces along the two axes, and radial */
} element_state;

typedef struct element_response {
    double f_n, f_t[2];
    double flow;         /* work that plastic flow dissipated in this step */
    int plastic, tries;  /* whether it yielded; evaluations that it took */
} element_response;

typedef struct element_tangent {
    double f_n[3], f_t[2][3]; /* by h, d[0], d[1] */
} element_tangent;

/* A row of the table at a hardening depth, and its slopes. */
typedef struct element_row {
    double value[ELEMENT_COLUMNS], slope[ELEMENT_COLUMNS];
    int level;
    double share, share_slope; /* between the levels */
} element_row;

static inline void element_read(const element_table *t, double depth, int count, element_row *row) {
    double log_h = ELEMENT_LOG(depth) - t->log_first, x = log_h * t->per_step, u, level = log_h * t->per_level;
    int i = x > 0.0 ? (int)x : 0, c;
    i = i < ELEMENT_ROWS - 2 ? i : ELEMENT_ROWS - 2;
    u = x > 0.0 ? x - i : 0.0;
    for (c = 0; c < count; c++) {
        double low = t->rows[i][c], rise = t->rows[i + 1][c] - low;
        /* Beyond the last row only forces, stiffnesses and depths go on. */
        double v = c >= ELEMENT_GAMMA && u > 1.0 ? 1.0 : u;
        row->value[c] = low + v * rise;
        row->slope[c] = v < u || x <= 0.0 ? 0.0 : rise * t->per_step / depth;
    }
    row->value[ELEMENT_LN_FORCE] = ELEMENT_EXP(row->value[ELEMENT_LN_FORCE]); /* with the slopes of their logarithms */
    row->value[ELEMENT_LN_STIFFNESS] = ELEMENT_EXP(row->value[ELEMENT_LN_STIFFNESS]);
    i = level > 0.0 ? (int)level : 0;
    row->level = i < ELEMENT_LEVELS - 2 ? i : ELEMENT_LEVELS - 2;
    u = level - row->level;
    row->share = u > 0.0 ? (u < 1.0 ? u : 1.0) : 0.0;
    row->share_slope = u > 0.0 && u < 1.0 ? t->per_level / depth : 0.0;
}

/* Place j of the shapes. */
static inline double element_place(int j) {
    return 1.0 - (1.0 - (double)j / ELEMENT_PLACES) * (1.0 - (double)j / ELEMENT_PLACES);
}

/* A shape at x: value, and slopes by x and by the share between levels. */
static inline double element_shape(const element_table *t, const element_row *row, int shape, double x, double slope[2]) {
    const double *low = t->shapes[row->level][shape], *high = t->shapes[row->level + 1][shape];
    int j = x < 1.0 ? (int)(ELEMENT_PLACES * (1.0 - sqrt(1.0 - x))) : ELEMENT_PLACES - 1;
    double from, width, u, a, b;
    j = j < ELEMENT_PLACES - 1 ? j : ELEMENT_PLACES - 1;
    from = element_place(j);
    width = element_place(j + 1) - from;
    if (x >= 1.0) { /* the vertex goes on straight, by a share of its mean slope; the others stay */
        a = low[ELEMENT_PLACES];
        b = high[ELEMENT_PLACES];
        if (shape == ELEMENT_VERTEX) {
            double on = a * t->beyond[row->level], rise = b * t->beyond[row->level + 1] - on;
            slope[0] = on + row->share * rise;
            slope[1] = b - a + rise * (x - 1.0);
            return a + row->share * (b - a) + slope[0] * (x - 1.0);
        }
        slope[0] = 0.0;
    } else {
        double rise = low[j + 1] - low[j], rise_b = high[j + 1] - high[j];
        u = (x - from) / width;
        a = low[j] + u * rise;
        b = high[j] + u * rise_b;
        slope[0] = (rise + row->share * (rise_b - rise)) / width;
    }
    slope[1] = b - a;
    return a + row->share * (b - a);
}

/* Shares of the sliders in k_T: (i/7)^0.65 inside the end of cell i. */
static inline const double *element_weights(void) {
    static const double weight[ELEMENT_SLIDERS] = {0.28228007246945605, 0.16067234912498195, 0.1335715962968834, 0.11854658577836137,
                                                   0.10849433246541654, 0.10110285024062748, 0.09533221362427317};
    return weight;
}

/* Approach, over that of the whole contact, at which each slider's annulus is lost, for the backbone 1 - (1 - x)^n (Jaeger). Cells end at (i/7)^(0.65/(n - 1)). */
static inline void element_lost(double n, double lost[ELEMENT_SLIDERS]) {
    const double *weight = element_weights();
    double p = 0.65 / (n - 1.0), two = ELEMENT_EXP(0.6931471805599453 * p), three = ELEMENT_EXP(1.0986122886681098 * p), five = ELEMENT_EXP(1.6094379124341003 * p);
    double seventh = ELEMENT_EXP(-1.9459101490553132 * p), inside = 0.0, before = 0.0;
    double end[ELEMENT_SLIDERS] = {seventh, two * seventh, three * seventh, two * two * seventh, five * seventh, two * three * seventh, 1.0};
    int i;
    for (i = 0; i < ELEMENT_SLIDERS; i++) {
        double above = (inside += weight[i]) * end[i];
        lost[i] = (n - 1.0) / n * (above - before) / weight[i];
        before = above;
    }
}

/* Exponent of the backbone: of a contact that was not sheared, of its first reversal, of those after. */
static inline double element_exponent(double first, double unsheared, double later, double worn) {
    double rest = worn < 1.0 ? 1.0 - worn : 0.0;
    return worn <= 1.0 ? first + unsheared * rest * sqrt(rest) : first > later ? first + (worn - 1.0) * (later - first) : first;
}

/* What does not change within a step. */
typedef struct element_step {
    const element_table *t;
    const element_state *s;
    const element_row *row; /* at its start */
    double h, d[2], depth, dent, approach; /* depth: h_m at its start */
    double exponent, radial, sudden, rho, rho_slope, growing, growing_slope; /* slopes by h */
    double lost[ELEMENT_SLIDERS];
} element_step;

/* Everything at a guess of the hardening y and the ratio r, and slopes by y, r, h, d as what they are made of. */
typedef struct element_guess {
    double f_n, f_t[2], factor, rho, width, hardens, vertex[2], slider[3][ELEMENT_SLIDERS], reach, residual[3], slip[2];
    double by[6][3]; /* slopes of the residuals */
    double n_by[6], t_by[6][2];
} element_guess;

/* The yield factor at a ratio and a distance from the vertex. */
static inline double element_factor(const element_table *t, const element_row *row, double ratio, double distance, double slope[3]) {
    double low = t->reach[row->level], rise = t->reach[row->level + 1] - low, reach = low + row->share * rise, a[2], b[2], x = distance / reach;
    double factor = 1.0 + element_shape(t, row, ELEMENT_LOST, ratio / t->friction, a) + element_shape(t, row, ELEMENT_VERTEX, x, b);
    slope[0] = a[0] / t->friction;
    slope[1] = b[0] / reach;
    slope[2] = (a[1] + b[1] - b[0] * x * rise / reach) * row->share_slope; /* by depth */
    return factor;
}

/* The same at the start of a step. */
static inline double element_factor_at(const element_step *p, const double r[2]) {
    double slope[3], x = r[0] - p->s->vertex[0], y = r[1] - p->s->vertex[1];
    return element_factor(p->t, p->row, sqrt(r[0] * r[0] + r[1] * r[1]), sqrt(x * x + y * y), slope);
}

/* With `flows` 0 an elastic step, y = 0; with the first 3 or all 6 of its slopes. Returns 0 where the contact is lost. */
static inline int element_evaluate(const element_step *p, double y, const double r[2], int flows, int slopes, element_guess *o) {
    const element_table *t = p->t;
    const element_state *s = p->s;
    const double *weight = element_weights();
    element_row row;
    double force, stiff, gap, gamma, width, width_factor, width_y, old = 1.0 + s->stiffened, hardening, rate, x[2], v[2], q, c, ratio, far, round, part[3], e, level, sudden, sudden_y = 0.0, flow, flow_y, flow_r, limit[ELEMENT_SLIDERS], opening[ELEMENT_SLIDERS], sum = 0.0, open = 0.0, eta = 1.0, eta_h = 0.0, scale, move[3];
    double rho_by[6] = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0}, m[3] = {0.0, 0.0, 0.0}, radial[2] = {0.0, 0.0}, stiffer[2] = {0.0, 0.0}, wider[2] = {0.0, 0.0}, opens[2] = {0.0, 0.0};
    double flow_s[2] = {0.0, 0.0}, mobile_s[2] = {0.0, 0.0}, mobile, grown, y_of_force, eps = ELEMENT_VERTEX_ROUND * t->friction;
    int i, j, on = 0;
    if (flows) {
        element_read(t, p->depth + y, ELEMENT_SOLVED, &row);
    } else {
        row = *p->row;
    }
    force = row.value[ELEMENT_LN_FORCE];
    stiff = row.value[ELEMENT_LN_STIFFNESS];
    gamma = row.value[ELEMENT_GAMMA];
    gap = row.value[ELEMENT_APPROACH];
    o->hardens = hardening = row.value[ELEMENT_DENT] - p->dent;
    rate = row.slope[ELEMENT_DENT];
    /* The vertex follows r. */
    q = hardening * stiff / (force * ELEMENT_VERTEX_LENGTH * t->friction);
    c = 1.0 / (1.0 + q);
    for (i = 0; i < 2; i++) {
        x[i] = (r[i] - s->vertex[i]) * c;
        o->vertex[i] = r[i] - x[i];
    }
    ratio = sqrt(r[0] * r[0] + r[1] * r[1]);
    far = sqrt(x[0] * x[0] + x[1] * x[1]);
    round = sqrt(far * far + eps * eps);
    part[0] = part[1] = part[2] = 0.0;
    o->factor = flows ? element_factor(t, &row, ratio, far, part) : 1.0;
    e = p->h - row.value[ELEMENT_DENT];
    o->reach = s->reach;
    o->f_n = o->f_t[0] = o->f_t[1] = 0.0;
    memset(o->slider, 0, sizeof o->slider);
    if (!(e > 0.0)) {
        return 0;
    }
    /* g follows the yield factor up at once, and down as the contact hardens. */
    width = old;
    width_factor = width_y = 0.0;
    if (flows) {
        width = o->factor;
        width_factor = 1.0;
        if (o->factor < old) {
            double kept = ELEMENT_EXP(-hardening / (ELEMENT_NARROWS * p->approach));
            width += (old - o->factor) * kept;
            width_factor -= kept;
            width_y = -(old - o->factor) * kept * rate / (ELEMENT_NARROWS * p->approach);
        }
    }
    o->width = width;
    level = ELEMENT_LOG(e / gap);
    o->f_n = force * ELEMENT_EXP(gamma * level + (gamma - 1.0) * ELEMENT_LOG(width));
    /* Plastic slip. */
    sudden = flow = flow_y = flow_r = grown = mobile = 0.0;
    if (flows) {
        double steady = element_shape(t, &row, ELEMENT_FLOW, ratio / t->friction, flow_s), per = 1.0 / (ratio + 1e-9);
        mobile = element_shape(t, &row, ELEMENT_MOBILISED, ratio / t->friction, mobile_s);
        grown = o->factor - p->growing;
        on = grown > 0.0;
        sudden = hardening * p->sudden + (on ? grown * gap * mobile : 0.0);
        flow = hardening * steady * per;
        flow_y = (rate * steady + hardening * flow_s[1] * row.share_slope) * per;
        flow_r = hardening * (flow_s[0] / t->friction - steady * per) * per;
        sudden_y = rate * p->sudden + (on ? grown * (row.slope[ELEMENT_APPROACH] * mobile + gap * mobile_s[1] * row.share_slope) : 0.0);
    }
    for (i = 0; i < 2; i++) {
        v[i] = x[i] / round;
        o->slip[i] = flow * r[i] + sudden * v[i];
        move[i] = p->d[i] - o->slip[i];
    }
    move[2] = p->radial * hardening;
    /* Sliders. */
    if (flows || e >= s->reach) {
        o->reach = e;
    } else {
        eta = ELEMENT_EXP(gamma / p->exponent * ELEMENT_LOG(e / s->reach));
        eta_h = eta * gamma / (p->exponent * e);
    }
    for (i = 0; i < ELEMENT_SLIDERS; i++) {
        opening[i] = eta > p->lost[i] ? 1.0 : 0.0;
        limit[i] = opening[i] * (eta - p->lost[i]);
        if (i == 0 && limit[0] < 0.1 * eta) { /* the innermost carries what little force there is */
            limit[0] = 0.1 * eta;
            opening[0] = 0.1;
        }
        sum += weight[i] * limit[i];
        open += weight[i] * opening[i];
    }
    scale = t->friction * o->f_n / sum;
    for (i = 0; i < ELEMENT_SLIDERS; i++) {
        double k = stiff * weight[i], most = weight[i] * limit[i] * scale, f[3], size, keep = 1.0, u[3], held = 0.0;
        double most_eta = weight[i] * scale * (opening[i] - limit[i] * open / sum);
        for (j = 0; j < 3; j++) {
            f[j] = s->slider[j][i] + k * move[j];
        }
        if (f[2] > ELEMENT_RADIAL_MOST * most) {
            f[2] = ELEMENT_RADIAL_MOST * most;
            held = ELEMENT_RADIAL_MOST;
        }
        size = f[0] * f[0] + f[1] * f[1] + f[2] * f[2];
        if (size > most * most) {
            size = sqrt(size);
            keep = most / size;
        }
        for (j = 0; j < 3; j++) {
            o->slider[j][i] = keep * f[j];
        }
        o->f_t[0] += o->slider[0][i];
        o->f_t[1] += o->slider[1][i];
        if (!slopes) {
            continue;
        }
        if (keep < 1.0) {
            double along, moved;
            u[0] = f[0] / size;
            u[1] = f[1] / size;
            u[2] = f[2] / size;
            m[0] += keep * k * (1.0 - u[0] * u[0]);
            m[1] -= keep * k * u[0] * u[1];
            m[2] += keep * k * (1.0 - u[1] * u[1]);
            along = held > 0.0 ? 1.0 - keep * u[2] * held : 1.0; /* dF = u dL */
            moved = u[0] * move[0] + u[1] * move[1] + (held > 0.0 ? 0.0 : u[2] * move[2]);
            for (j = 0; j < 2; j++) {
                radial[j] -= held > 0.0 ? 0.0 : keep * k * u[j] * u[2];
                stiffer[j] += keep * weight[i] * (move[j] - u[j] * moved);
                wider[j] += u[j] * along * most;
                opens[j] += u[j] * along * most_eta;
            }
        } else {
            m[0] += k;
            m[2] += k;
            stiffer[0] += weight[i] * move[0];
            stiffer[1] += weight[i] * move[1];
        }
    }
    if (flows) {
        double rho = p->rho;
        rho_by[3] = p->rho_slope;
        if (rho < 1.0 - 1e-12) { /* what releases took comes back with flow */
            double missing = -1.0 / ELEMENT_LOG(rho) + ELEMENT_RECOVERS / p->approach * hardening;
            rho_by[3] *= ELEMENT_EXP(-1.0 / missing) / (missing * missing * ELEMENT_LOG(rho) * ELEMENT_LOG(rho) * rho);
            rho = ELEMENT_EXP(-1.0 / missing);
            rho_by[0] = rho / (missing * missing) * (ELEMENT_RECOVERS / p->approach) * rate;
        }
        o->residual[0] = o->f_n * o->factor / force - rho;
        o->rho = rho;
        o->residual[1] = o->f_t[0] / o->f_n - r[0];
        o->residual[2] = o->f_t[1] / o->f_n - r[1];
    }
    y_of_force = row.slope[ELEMENT_LN_FORCE] + row.slope[ELEMENT_GAMMA] * (level + ELEMENT_LOG(width)) - gamma * (rate / e + row.slope[ELEMENT_APPROACH] / gap);
    for (j = 0; j < slopes; j++) { /* along y, r, h, d */
        double dy = j == 0, dr[2], dx[2], dn[2], df, dmove[3], dfactor, dround, dsudden, dflow, dfar, dratio, dq;
        dr[0] = j == 1;
        dr[1] = j == 2;
        dq = dy * (rate * stiff / (force * ELEMENT_VERTEX_LENGTH * t->friction) + q * (row.slope[ELEMENT_LN_STIFFNESS] - row.slope[ELEMENT_LN_FORCE]));
        dx[0] = c * (dr[0] - x[0] * dq);
        dx[1] = c * (dr[1] - x[1] * dq);
        dround = (x[0] * dx[0] + x[1] * dx[1]) / round;
        dfar = far > 0.0 ? dround * round / far : 0.0;
        dratio = ratio > 0.0 ? (r[0] * dr[0] + r[1] * dr[1]) / ratio : 0.0;
        dfactor = part[0] * dratio + part[1] * dfar + part[2] * dy;
        df = o->f_n * ((j == 0 ? y_of_force : j == 3 ? gamma / e : 0.0) + (gamma - 1.0) / width * (width_factor * dfactor + width_y * dy));
        dsudden = sudden_y * dy;
        if (on) {
            dsudden += gap * ((dfactor - (j == 3 ? p->growing_slope : 0.0)) * mobile + grown * mobile_s[0] / t->friction * dratio);
        }
        dflow = flow_y * dy + flow_r * dratio;
        for (i = 0; i < 2; i++) {
            dn[i] = dflow * r[i] + flow * dr[i] + dsudden * v[i] + sudden * (dx[i] - v[i] * dround) / round;
            dmove[i] = (j == 4 + i ? 1.0 : 0.0) - dn[i];
        }
        dmove[2] = p->radial * rate * dy;
        o->n_by[j] = df;
        for (i = 0; i < 2; i++) {
            double across = i == 0 ? m[0] * dmove[0] + m[1] * dmove[1] : m[1] * dmove[0] + m[2] * dmove[1];
            o->t_by[j][i] = across + radial[i] * dmove[2] + stiffer[i] * stiff * row.slope[ELEMENT_LN_STIFFNESS] * dy + wider[i] * df / o->f_n + (j == 3 ? opens[i] * eta_h : 0.0);
            o->by[j][1 + i] = (o->t_by[j][i] - o->f_t[i] * df / o->f_n) / o->f_n - dr[i];
        }
        o->by[j][0] = -rho_by[j] + o->f_n * o->factor / force * (df / o->f_n + dfactor / o->factor - row.slope[ELEMENT_LN_FORCE] * dy);
    }
    return 1;
}

/* Moves y and r by x so that the three equations, off by `right`, are met. */
static inline int element_solve(const element_guess *o, const double right[3], double x[3]) {
    const double *a = o->by[0], *b = o->by[1], *c = o->by[2]; /* columns */
    double bc[3] = {b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]};
    double whole = -(a[0] * bc[0] + a[1] * bc[1] + a[2] * bc[2]);
    if (!(fabs(whole) > 0.0)) {
        return 0;
    }
    x[0] = (right[0] * bc[0] + right[1] * bc[1] + right[2] * bc[2]) / whole;
    x[1] = (a[0] * (right[1] * c[2] - right[2] * c[1]) + a[1] * (right[2] * c[0] - right[0] * c[2]) + a[2] * (right[0] * c[1] - right[1] * c[0])) / whole;
    x[2] = (a[0] * (b[1] * right[2] - b[2] * right[1]) + a[1] * (b[2] * right[0] - b[0] * right[2]) + a[2] * (b[0] * right[1] - b[1] * right[0])) / whole;
    return 1;
}

/* Slopes of the forces by h or d, where y and r move by x with it. */
static inline void element_slopes(const element_guess *o, int j, const double x[3], element_tangent *tangent) {
    tangent->f_n[j] = o->n_by[3 + j] + o->n_by[0] * x[0] + o->n_by[1] * x[1] + o->n_by[2] * x[2];
    tangent->f_t[0][j] = o->t_by[3 + j][0] + o->t_by[0][0] * x[0] + o->t_by[1][0] * x[1] + o->t_by[2][0] * x[2];
    tangent->f_t[1][j] = o->t_by[3 + j][1] + o->t_by[0][1] * x[0] + o->t_by[1][1] * x[1] + o->t_by[2][1] * x[2];
}

/* The memory after a step. */
static inline void element_keep(const element_step *p, const element_guess *o, double y, double softened, double released, element_state *next) {
    const element_state *s = p->s;
    double worn = s->worn, mu = p->t->friction, r[2], size, length, back;
    element_state to = *s;
    to.h = p->h;
    to.hardened += y;
    to.reach = o->reach;
    to.softened = softened;
    to.released = released;
    to.stiffened = o->f_n > 0.0 ? o->width - 1.0 : s->stiffened;
    memcpy(to.slider, o->slider, sizeof to.slider);
    if (o->f_n > 0.0) {
        memcpy(to.vertex, y > 0.0 ? o->vertex : s->vertex, sizeof to.vertex);
        r[0] = o->f_t[0] / (o->f_n * mu);
        r[1] = o->f_t[1] / (o->f_n * mu);
        size = fmin(1.0, sqrt(r[0] * r[0] + r[1] * r[1]));
        if (worn > size && o->hardens > 0.0) {
            worn = size + (worn - size) * ELEMENT_EXP(-ELEMENT_FORGETS * o->hardens / p->approach);
        }
        worn = worn > size ? worn : size;
        length = sqrt(to.vertex[0] * to.vertex[0] + to.vertex[1] * to.vertex[1]);
        back = length > 0.0 ? -(r[0] * to.vertex[0] + r[1] * to.vertex[1]) / length : 0.0;
        if (back > 0.0) { /* slip against the vertex of a contact that was sheared */
            double sheared = worn < 1.0 ? worn : 1.0, reversed;
            back = back < 1.0 ? back : 1.0;
            reversed = sheared + (2.0 - sheared) * sheared * sheared * sheared * sheared * back * back * length / (length + 0.02 * mu);
            worn = worn > reversed ? worn : reversed;
        }
    }
    to.worn = worn;
    *next = to;
}

static inline void element_tell(const element_guess *o, element_response *out) {
    out->f_n = o->f_n;
    memcpy(out->f_t, o->f_t, sizeof out->f_t);
}

/* One step; 0 where Newton does not find the way and it must be halved; with `last` it takes what it has. */
static inline int element_try(const element_table *t, const element_state *s, double h, const double d[2], int last, element_state *next, element_response *out, element_tangent *tangent) {
    element_step p;
    element_guess o;
    element_row row;
    double r[2] = {0.0, 0.0}, start[2], e, before, released = s->released, y = 0.0, norm, least = 1e300, from[3] = {0.0, 0.0, 0.0}, step[3] = {0.0, 0.0, 0.0}, most, none[3] = {0.0, 0.0, 0.0};
    int touches, i, j, tries, back = 0;
    memset(&o, 0, sizeof o);
    memset(out, 0, sizeof *out);
    p.t = t;
    p.s = s;
    p.row = &row;
    p.h = h;
    memcpy(p.d, d, sizeof p.d);
    p.depth = t->first + s->hardened;
    element_read(t, p.depth, ELEMENT_COLUMNS, &row);
    p.dent = row.value[ELEMENT_DENT];
    p.approach = row.value[ELEMENT_APPROACH];
    p.radial = row.value[ELEMENT_RADIAL_SLIP];
    p.sudden = row.value[ELEMENT_SUDDEN];
    p.growing = p.growing_slope = p.rho_slope = 0.0;
    p.exponent = element_exponent(row.value[ELEMENT_FIRST_N], row.value[ELEMENT_UNSHEARED_N], t->later, s->worn);
    element_lost(p.exponent, p.lost);
    e = h - p.dent;
    before = (1.0 - s->softened) * (1.0 - row.value[ELEMENT_SOFTENING] * s->released * s->released);
    if (e < s->reach && s->reach > 0.0) {
        double share = e > 0.0 ? ELEMENT_EXP(row.value[ELEMENT_GAMMA] * ELEMENT_LOG(e / s->reach)) : 0.0;
        if (1.0 - share > released) {
            released = 1.0 - share;
            p.rho_slope = e > 0.0 ? (1.0 - s->softened) * 2.0 * row.value[ELEMENT_SOFTENING] * released * row.value[ELEMENT_GAMMA] * share / e : 0.0;
        }
    }
    p.rho = (1.0 - s->softened) * (1.0 - row.value[ELEMENT_SOFTENING] * released * released);
    touches = element_evaluate(&p, 0.0, r, 0, tangent ? 6 : 0, &o);
    if (touches) {
        r[0] = o.f_t[0] / o.f_n;
        r[1] = o.f_t[1] / o.f_n;
        o.factor = element_factor_at(&p, r);
    }
    if (!touches || o.f_n * o.factor <= p.rho * row.value[ELEMENT_LN_FORCE] * (1.0 + 1e-11)) {
        o.hardens = 0.0;
        element_keep(&p, &o, 0.0, s->softened, released, next);
        element_tell(&o, out);
        for (j = 0; j < 3 && tangent; j++) {
            element_slopes(&o, j, none, tangent);
        }
        return 1;
    }
    out->plastic = 1;
    { /* the yield factor from which it grows */
        double f[2] = {0.0, 0.0}, e0 = s->h - p.dent, f_n;
        p.growing = 1.0;
        if (e0 > 0.0) {
            f_n = row.value[ELEMENT_LN_FORCE] * ELEMENT_EXP(row.value[ELEMENT_GAMMA] * ELEMENT_LOG(e0 / p.approach) + (row.value[ELEMENT_GAMMA] - 1.0) * ELEMENT_LOG(1.0 + s->stiffened));
            for (i = 0; i < ELEMENT_SLIDERS; i++) {
                f[0] += s->slider[0][i] / f_n;
                f[1] += s->slider[1][i] / f_n;
            }
            p.growing = element_factor_at(&p, f);
        }
        before *= row.value[ELEMENT_LN_FORCE] / o.f_n;
        if (before > p.growing) {
            p.growing = before;
            p.growing_slope = -before * row.value[ELEMENT_GAMMA] / e;
        }
    }
    most = e + p.depth;
    memcpy(start, r, sizeof start);
    for (tries = 1;; tries++) {
        double size, bound = 0.5 * t->friction + 0.01;
        out->tries++;
        touches = element_evaluate(&p, y, r, 1, 3, &o);
        norm = touches ? fabs(o.residual[0]) + fabs(o.residual[1]) + fabs(o.residual[2]) : 1e300;
        if (norm < ELEMENT_TOLERANCE) {
            break;
        }
        if (tries > 1 && !(norm <= 1.05 * least) && back < 6) {
            back++;
            for (i = 0; i < 3; i++) {
                step[i] *= 0.4;
            }
        } else {
                if (!touches || tries >= ELEMENT_STEPS || !element_solve(&o, o.residual, step)) {
                break;
            }
            back = 0;
            least = norm;
            from[0] = y;
            from[1] = r[0];
            from[2] = r[1];
            step[0] = y + step[0] < 0.0 ? -0.7 * y : y + step[0] > most ? 0.7 * (most - y) : step[0];
            size = fabs(step[1]) > fabs(step[2]) ? fabs(step[1]) : fabs(step[2]);
            size = size > bound ? bound / size : 1.0;
            step[1] *= size;
            step[2] *= size;
        }
        y = from[0] + step[0];
        r[0] = from[1] + step[1];
        r[1] = from[2] + step[2];
    }
    if (!(norm < 1e-7)) {
        double low = 0.0, high = most;
        if (!last) {
            return 0;
        }
        /* The depth that carries the force at the ratio of the start, by halving: F_N over the yield force falls with it. No flow but that of the press. */
        p.growing = 1e9;
        memcpy(r, start, sizeof r);
        for (i = 0; i < 60; i++) {
            y = 0.5 * (low + high);
            touches = element_evaluate(&p, y, r, 1, 0, &o);
            if (touches && o.residual[0] > 0.0) {
                low = y;
            } else {
                high = y;
            }
        }
        y = low;
        element_evaluate(&p, y, r, 1, 0, &o);
    }
    element_tell(&o, out);
    out->flow = o.f_n * o.hardens + o.f_t[0] * o.slip[0] + o.f_t[1] * o.slip[1];
    if (tangent) {
        element_evaluate(&p, y, r, 1, 6, &o);
        for (j = 0; j < 3; j++) {
            double x[3] = {0.0, 0.0, 0.0};
            element_solve(&o, o.by[3 + j], x);
            element_slopes(&o, j, x, tangent);
        }
    }
    element_keep(&p, &o, y, 1.0 - o.rho, 0.0, next);
    return 1;
}

/* Halves a step that is not found. */
static inline void element_update(const element_table *t, const element_state *state, double h, const double d[2], element_state *next, element_response *out, element_tangent *tangent) {
    int depth = 1, tries = 0, plastic = 0;
    double d0[2] = {d[0], d[1]}, done = 0.0, from = state->h, flow = 0.0;
    element_state now = *state;
    if (element_try(t, state, h, d, 0, next, out, tangent)) {
        return;
    }
    while (done < 1.0) {
        double part = ldexp(1.0, -depth), end = done + part, move[2] = {d0[0] * part, d0[1] * part};
        tries += out->tries;
        if (element_try(t, &now, end < 1.0 ? from + (h - from) * end : h, move, depth >= ELEMENT_HALVINGS, &now, out, end < 1.0 ? NULL : tangent)) {
            done = end;
            flow += out->flow;
            plastic |= out->plastic;
            while (depth > 1 && fmod(done, ldexp(1.0, -(depth - 1))) == 0.0) {
                depth--;
            }
        } else {
            depth++;
        }
    }
    *next = now;
    out->tries += tries;
    out->flow = flow;
    out->plastic = plastic; /* of the parts together */
}

#endif
