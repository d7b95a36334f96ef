/* element_table.h: the element's table of a contact, from an asperity_table whose shapes are given by numbers (`asperity law tabulate`). C99, C++17.
 *
 * Columns come from that table as they are. Shapes are made so that the element follows the table's own shear at constant h: along it r, F_N and so the
 * hardening are known, the sliders are driven to F_T, and what is left of delta_T has flowed. The steady flow comes from the table's oblique press in the
 * same way. Needs some hundred thousand operations, once.
 */
#ifndef ASPERITY_ELEMENT_TABLE_H
#define ASPERITY_ELEMENT_TABLE_H

#include "asperity_contact.h"
#include "asperity_element.h"

#define ELEMENT_WAY 144          /* points along a shear */
#define ELEMENT_KEPT 0.6         /* share of F_N0 at full slip from which a table's n is not lessened (src/law/table/build.rs) */
#define ELEMENT_LEAST_RISE 0.02  /* of the yield factor over r/mu */

/* What is plastic of a contact, 0 to 1: h over what is recovered of it. */
static inline double element_plastic_share(double depth, double approach) {
    return approach < depth ? 1.0 - approach / depth : 0.0;
}

static inline double element_power(double base, double exponent) {
    return base > 0.0 ? pow(base, exponent) : exponent > 0.0 ? 0.0 : 1.0;
}

/* n of a first reversal, from a table's, which is between it and those after; where much is lost to shear it is nearer to those. Held below a limit. */
static inline double element_first_exponent(double backbone, double kept) {
    double x = ELEMENT_FIRST * (backbone - 1.0) / (kept < ELEMENT_KEPT ? kept / ELEMENT_KEPT : 1.0);
    x /= pow(1.0 + pow(x / ELEMENT_FIRST_MOST, 8.0), 0.125);
    return 1.0 + (x > 0.02 ? x : 0.02);
}

/* The lesser of two, rounded. */
static inline double element_lesser(double a, double b) {
    double q;
    if (!(a > 0.0) || !(b > 0.0)) {
        return 0.0;
    }
    q = a < b ? a / b : b / a;
    return (a < b ? a : b) / pow(1.0 + q * q * q * q, 0.25);
}

/* Share of the yield force that a steady press loses at the ratio r, where c is the flow coefficient. */
static inline double element_steady_loss(double c, double r) {
    return r > 0.0 ? ELEMENT_LOSS * c * r * r * r / (r + ELEMENT_LOSS_SMALL) : 0.0;
}

/* Sliders that are driven by hand. */
typedef struct element_drive {
    double force[ELEMENT_SLIDERS], radial[ELEMENT_SLIDERS];
} element_drive;

static inline double element_move(const element_drive *from, double stiff, double limit, double exponent, double d, double radial, element_drive *to) {
    const double *weight = element_weights();
    double lost[ELEMENT_SLIDERS], sum = 0.0, all = 0.0;
    int i;
    element_lost(exponent, lost);
    for (i = 0; i < ELEMENT_SLIDERS; i++) {
        sum += weight[i] * (1.0 - lost[i]);
    }
    for (i = 0; i < ELEMENT_SLIDERS; i++) {
        double most = limit * weight[i] * (1.0 - lost[i]) / sum, f = from->force[i] + stiff * weight[i] * d, g = from->radial[i] + stiff * weight[i] * radial, size;
        g = g < ELEMENT_RADIAL_MOST * most ? g : ELEMENT_RADIAL_MOST * most;
        size = sqrt(f * f + g * g);
        if (size > most) {
            f *= most / size;
            g *= most / size;
        }
        to->force[i] = f;
        to->radial[i] = g;
        all += f;
    }
    return all;
}

/* The displacement, up to `most`, that brings them to a force; moves them. */
static inline double element_drive_to(element_drive *s, double stiff, double limit, double exponent, double radial, double force, double most) {
    element_drive to;
    double low = 0.0, high = most;
    int k;
    if (element_move(s, stiff, limit, exponent, most, radial, &to) > force) {
        for (k = 0; k < 45; k++) {
            double d = 0.5 * (low + high);
            if (element_move(s, stiff, limit, exponent, d, radial, &to) < force) {
                low = d;
            } else {
                high = d;
            }
        }
    }
    element_move(s, stiff, limit, exponent, high, radial, &to);
    *s = to;
    return high;
}

/* Columns of the element's rows. */
static inline void element_columns(const asperity_table *law, element_table *t) {
    double last = -1.0;
    int i;
    t->friction = law->friction > 1e-9 ? law->friction : 1e-9;
    t->later = 1.0 + ELEMENT_LATER * pow(t->friction / 0.3, ELEMENT_LATER_MU);
    t->first = law->first;
    t->log_first = log(law->first);
    t->per_step = (ELEMENT_ROWS - 1) / log(1.5 * law->deepest / law->first);
    t->per_level = (ELEMENT_LEVELS - 1) / log(law->deepest / law->first);
    for (i = 0; i < ELEMENT_ROWS; i++) {
        double h = law->first * exp(i / t->per_step), *row = t->rows[i], widens, plastic, approach, dent;
        asperity_curve v;
        asperity_first_loading(law, h, 1, &v);
        /* A table is of a contact that slid to the end: before that it was narrower, the more the further it slid for its radius. */
        widens = v.per_a / v.radii / v.per_slip;
        approach = v.depth * (1.0 + ELEMENT_WIDENS * widens);
        approach = approach < h ? approach : h;
        dent = i == 0 ? 0.0 : h - approach;
        dent = i > 0 && dent < last + 1e-7 * h / t->per_step ? last + 1e-7 * h / t->per_step : dent;
        last = dent;
        approach = h - dent;
        plastic = element_plastic_share(h, approach);
        row[ELEMENT_LN_FORCE] = log(v.f_n0);
        row[ELEMENT_LN_STIFFNESS] = log(v.k_t) - ELEMENT_STIFFENS * log(1.0 + ELEMENT_WIDENS * widens);
        row[ELEMENT_APPROACH] = approach;
        row[ELEMENT_DENT] = dent;
        row[ELEMENT_GAMMA] = v.gamma;
        row[ELEMENT_FIRST_N] = element_first_exponent(v.backbone, v.f_n_slip / v.f_n0);
        row[ELEMENT_UNSHEARED_N] = plastic * (ELEMENT_UNSHEARED > row[ELEMENT_FIRST_N] ? ELEMENT_UNSHEARED - row[ELEMENT_FIRST_N] : 0.0);
        row[ELEMENT_RADIAL_SLIP] = ELEMENT_RADIAL * element_power(plastic, ELEMENT_RADIAL_FADES);
        row[ELEMENT_SUDDEN] = ELEMENT_VERTEX_FLOW * exp(-ELEMENT_VERTEX_FADES * (1.0 - plastic) * (1.0 - plastic));
        row[ELEMENT_SOFTENING] = ELEMENT_RELEASED * plastic * plastic * plastic * plastic * law->friction / (law->friction + 0.01);
    }
}

static inline double element_at(const element_table *t, int column, double h) {
    double x = (log(h) - t->log_first) * t->per_step;
    int i = x > 0.0 ? (int)x : 0;
    i = i < ELEMENT_ROWS - 2 ? i : ELEMENT_ROWS - 2;
    x = x > 0.0 ? x - i : 0.0;
    return t->rows[i][column] + x * (t->rows[i + 1][column] - t->rows[i][column]);
}

/* The flow coefficient c of each row, and the ratio at which it was measured, from the oblique press of the table: d(delta_T)/dh is mu/(1/2 + mu^2/4) there, and its ratio r is
 * written as slope = 2 c r/(1 - c r^2) of total displacements. Here it is of plastic ones: flow = 2 c r/(1 - A). */
static inline void element_coefficients(const asperity_table *law, const element_table *t, double c[ELEMENT_ROWS], double measured[ELEMENT_ROWS]) {
    double mu = t->friction, slope = 2.0 * mu / (1.0 + 0.5 * mu * mu), slipped = 0.0, before = 0.0, dents = 0.0, flowed[ELEMENT_ROWS], given[ELEMENT_ROWS];
    element_drive s;
    int i, k, whole = (int)(log(law->deepest / law->first) * t->per_step) - 2;
    memset(&s, 0, sizeof s);
    for (i = 0; i < ELEMENT_ROWS; i++) {
        const double *row = t->rows[i];
        double first = law->first * exp(i / t->per_step), h = first, r = 0.0, loss = 0.0, force, plastic;
        given[i] = 1.0;
        for (k = 0; k < 6; k++) {
            asperity_curve v;
            double at = h < law->deepest ? h : law->deepest, coarse = 1.0 - 0.1 / mu;
            asperity_first_loading(law, at > law->first ? at : law->first, 0, &v);
            /* r that is small has an error of the mesh that the table was made on. */
            given[i] = v.n * (coarse > 0.0 ? pow(first / row[ELEMENT_APPROACH] / ELEMENT_COARSE_FROM, ELEMENT_COARSE * coarse) : 1.0);
            r = (sqrt(1.0 + slope * slope / given[i]) - 1.0) / slope;
            r = r < 0.97 * mu ? r : 0.97 * mu;
            loss = element_steady_loss(given[i], r);
            h = row[ELEMENT_DENT] + row[ELEMENT_APPROACH] / (1.0 + loss);
        }
        force = exp(row[ELEMENT_LN_FORCE]) / (1.0 + loss);
        plastic = row[ELEMENT_DENT] - dents;
        dents = row[ELEMENT_DENT];
        slipped += element_drive_to(&s, exp(row[ELEMENT_LN_STIFFNESS]), mu * force, element_exponent(row[ELEMENT_FIRST_N], row[ELEMENT_UNSHEARED_N], t->later, r / mu),
                                    row[ELEMENT_RADIAL_SLIP] * plastic, r * force, slope * (h - before));
        before = h;
        measured[i] = r;
        flowed[i] = slope * h - slipped;
    }
    for (i = 0; i < ELEMENT_ROWS; i++) {
        int from = i - 4 > 0 ? i - 4 : 0, to = i + 4 < whole ? i + 4 : whole, at = i < to ? i : to;
        double flow, r = measured[at], one, least = 0.3 * given[i], most = 3.0 * given[i];
        from = from < to - 8 ? from : to - 8 > 0 ? to - 8 : 0;
        flow = (flowed[to] - flowed[from]) / (t->rows[to][ELEMENT_DENT] - t->rows[from][ELEMENT_DENT]);
        one = flow / (2.0 * r + flow * element_steady_loss(1.0, r));
        c[i] = one > least ? (one < most ? one : most) : least;
        measured[i] = r;
    }
}

/* Straight between the points of a curve with increasing x. */
static inline double element_between(const double *x, const double *y, int last, double at) {
    int i = 0;
    double u;
    while (i < last - 1 && x[i + 1] < at) {
        i++;
    }
    u = (at - x[i]) / (x[i + 1] - x[i]);
    u = i == last - 1 && u > 1.0 ? 1.0 : u;
    return y[i] + u * (y[i + 1] - y[i]);
}

/* The shapes of one level from the shear at constant h that the table has there; `s` is what the press has left in the sliders. */
static inline void element_shapes(const asperity_table *law, element_table *t, int level, double h, double c, double measured, element_drive s) {
    double x[ELEMENT_WAY + 1], factor[ELEMENT_WAY + 1], far[ELEMENT_WAY + 1], dent[ELEMENT_WAY + 1], along[ELEMENT_WAY + 1], left[ELEMENT_WAY + 1], inelastic[ELEMENT_WAY + 1];
    double mu = t->friction, eps = ELEMENT_VERTEX_ROUND * mu, vertex = 0.0, depth = h, moved = 0.0, slipped = 0.0, recovered, approach, (*shape)[ELEMENT_PLACES + 1] = t->shapes[level];
    asperity_curve v;
    int j, k, last = 0;
    asperity_first_loading(law, h, 1, &v);
    recovered = v.slope * v.depth / (v.gamma * v.f_n0);
    approach = element_at(t, ELEMENT_APPROACH, h);
    x[0] = far[0] = left[0] = inelastic[0] = 0.0;
    factor[0] = 1.0;
    dent[0] = element_at(t, ELEMENT_DENT, h);
    along[0] = 0.0;
    for (k = 1; k <= ELEMENT_WAY; k++) {
        double at = (double)k / ELEMENT_WAY, f_n, f_t, r, low = depth, high = depth + h, stiff, force, q, d, now;
        at *= at;
        f_n = v.f_n0 - (v.f_n0 - v.f_n_slip) * asperity_given(&v, 1, at, asperity_point_before(at));
        f_t = law->friction * v.f_n_slip * asperity_given(&v, 0, at, asperity_point_before(at));
        r = f_t / f_n;
        r = r < 0.999 * mu ? r : 0.999 * mu;
        if (r <= (x[last] + 1e-9) * mu) {
            if (x[last] > 0.99) {
                break;
            }
            continue;
        }
        for (j = 0; j < 50; j++) { /* the hardening that leaves this F_N at constant h */
            double middle = 0.5 * (low + high), e = h - element_at(t, ELEMENT_DENT, middle);
            double here = exp(element_at(t, ELEMENT_LN_FORCE, middle)) * e / element_at(t, ELEMENT_APPROACH, middle);
            if (here > f_n) {
                low = middle;
            } else {
                high = middle;
            }
        }
        depth = 0.5 * (low + high);
        now = element_at(t, ELEMENT_DENT, depth);
        force = exp(element_at(t, ELEMENT_LN_FORCE, depth));
        stiff = exp(element_at(t, ELEMENT_LN_STIFFNESS, depth));
        q = (now > dent[last] ? now - dent[last] : 0.0) * stiff / (force * ELEMENT_VERTEX_LENGTH * mu);
        d = at / v.per_slip;
        slipped += element_drive_to(&s, stiff, mu * f_n, element_exponent(element_at(t, ELEMENT_FIRST_N, depth), element_at(t, ELEMENT_UNSHEARED_N, depth), t->later, x[last]), 0.0, r * f_n, d - moved);
        moved = d;
        last++;
        x[last] = r / mu;
        far[last] = (r - vertex) / (1.0 + q);
        vertex = r - far[last];
        far[last] = far[last] > far[last - 1] + 1e-6 * mu ? far[last] : far[last - 1] + 1e-6 * mu;
        factor[last] = force / f_n;
        /* At constant r and F_N there is no place on the curve: it must rise a little. */
        factor[last] = factor[last] > factor[last - 1] + ELEMENT_LEAST_RISE * (x[last] - x[last - 1]) ? factor[last] : factor[last - 1] + ELEMENT_LEAST_RISE * (x[last] - x[last - 1]);
        dent[last] = now > dent[last - 1] ? now : dent[last - 1];
        along[last] = far[last] / sqrt(far[last] * far[last] + eps * eps);
        left[last] = d - slipped;
        inelastic[last] = d - r * f_n / stiff;
        if (x[last] > 0.9985) {
            break;
        }
    }
    if (last == 0) {
        last = 1;
        x[1] = 1.0;
        factor[1] = 1.0 + ELEMENT_LEAST_RISE;
        far[1] = mu;
        dent[1] = dent[0];
        along[1] = 1.0;
        left[1] = inelastic[1] = 0.0;
    }
    for (j = 0; j <= ELEMENT_PLACES; j++) {
        double end = x[last], place = element_place(j), r = place * mu, low = 0.5 * (place + element_place(j > 0 ? j - 1 : 0)) * end, high = 0.5 * (place + element_place(j < ELEMENT_PLACES ? j + 1 : j)) * end;
        double hardens = element_between(x, dent, last, high) - element_between(x, dent, last, low), grows = element_between(x, factor, last, high) - element_between(x, factor, last, low);
        double way = element_between(x, left, last, high) - element_between(x, left, last, low), all = element_between(x, inelastic, last, high) - element_between(x, inelastic, last, low);
        double direction = element_between(x, along, last, place * end), loss = element_steady_loss(c, r), bend = r / measured, flow;
        shape[ELEMENT_LOST][j] = element_lesser(loss, ELEMENT_LOSS_MOST * (element_between(x, factor, last, place * end) - 1.0));
        /* c rises with r where more is elastic, and falls where less is; and a steady press flows no more than this shear. */
        bend = 1.0 + ELEMENT_BEND * (recovered - ELEMENT_BEND_FROM) * ((bend < 2.0 ? bend : 2.0) - 1.0);
        loss = shape[ELEMENT_LOST][j];
        flow = 2.0 * c * (bend > 0.2 ? bend : 0.2) * r / (loss < 0.98 ? 1.0 - loss : 0.02);
        flow = hardens > 1e-12 * approach ? element_lesser(flow, all / hardens) : flow;
        way -= hardens * (element_at(t, ELEMENT_SUDDEN, h) * direction + flow);
        shape[ELEMENT_FLOW][j] = flow;
        shape[ELEMENT_MOBILISED][j] = way > 0.0 && direction > 0.0 ? way / (grows > 1e-6 ? grows : 1e-6) / approach / direction : 0.0;
    }
    shape[ELEMENT_MOBILISED][0] = shape[ELEMENT_MOBILISED][1];
    shape[ELEMENT_MOBILISED][ELEMENT_PLACES] = shape[ELEMENT_MOBILISED][ELEMENT_PLACES - 1];
    if (shape[ELEMENT_FLOW][ELEMENT_PLACES] < shape[ELEMENT_FLOW][ELEMENT_PLACES - 1]) {
        shape[ELEMENT_FLOW][ELEMENT_PLACES] = shape[ELEMENT_FLOW][ELEMENT_PLACES - 1];
    }
    t->reach[level] = far[last];
    t->beyond[level] = ELEMENT_BEYOND * element_power(element_plastic_share(h, approach), ELEMENT_BEYOND_FADES);
    shape[ELEMENT_VERTEX][0] = 0.0;
    for (j = 1; j <= ELEMENT_PLACES; j++) {
        double distance = element_place(j) * far[last], at = element_between(far, x, last, distance), place = at / x[last], u, lost, lost_far;
        k = 0;
        while (k < ELEMENT_PLACES - 1 && element_place(k + 1) < place) {
            k++;
        }
        u = (place - element_place(k)) / (element_place(k + 1) - element_place(k));
        lost = shape[ELEMENT_LOST][k] + (u < 1.0 ? u : 1.0) * (shape[ELEMENT_LOST][k + 1] - shape[ELEMENT_LOST][k]);
        lost_far = element_between(far, factor, last, distance) - 1.0 - lost;
        shape[ELEMENT_VERTEX][j] = lost_far > shape[ELEMENT_VERTEX][j - 1] ? lost_far : shape[ELEMENT_VERTEX][j - 1];
    }
}

/* Makes the table; 0 if the law's shapes are not given by numbers. */
static inline int element_make_table(const asperity_table *law, element_table *t) {
    double c[ELEMENT_ROWS], measured[ELEMENT_ROWS], before = 0.0, dents = 0.0;
    element_drive s, to;
    int level, k;
    memset(t, 0, sizeof *t);
    memset(&s, 0, sizeof s);
    if (law->form != 2) {
        return 0;
    }
    element_columns(law, t);
    element_coefficients(law, t, c, measured);
    for (level = 0; level < ELEMENT_LEVELS; level++) {
        double end = law->first * exp(level / t->per_level), at;
        for (k = 1; k <= 8; k++) { /* the press up to here */
            double h = level > 0 ? before * pow(end / before, k / 8.0) : end * k / 8.0, share = h < law->first ? h / law->first : 1.0, depth = h < law->first ? law->first : h;
            double dent = share < 1.0 ? 0.0 : element_at(t, ELEMENT_DENT, depth), force = exp(element_at(t, ELEMENT_LN_FORCE, depth)) * pow(share, 1.5);
            element_move(&s, exp(element_at(t, ELEMENT_LN_STIFFNESS, depth)), t->friction * force, element_exponent(element_at(t, ELEMENT_FIRST_N, depth), element_at(t, ELEMENT_UNSHEARED_N, depth), t->later, 0.0), 0.0,
                         element_at(t, ELEMENT_RADIAL_SLIP, depth) * (dent - dents), &to);
            s = to;
            dents = dent;
        }
        before = end;
        at = log(end / law->first) * t->per_step;
        k = (int)at < ELEMENT_ROWS - 2 ? (int)at : ELEMENT_ROWS - 2;
        element_shapes(law, t, level, end, c[k] + (at - k) * (c[k + 1] - c[k]), measured[k], s);
    }
    return 1;
}

#endif
