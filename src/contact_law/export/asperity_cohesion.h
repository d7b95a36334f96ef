/* asperity_cohesion.h: cohesion of one contact, beside the update of asperity_contact.h.
 *
 * Once, for each pair of materials:
 *     asperity_make_cohesion(&cohesion, &table, w, range);
 * w: work of adhesion, energy over area (for two surfaces of one material twice its surface energy), 0: none; range: distance over which surfaces that do not touch attract each
 * other, 0: none. A contact's memory is then an asperity_state and an asperity_cohesion, both zero before first contact. Each step, after the update (turning or not) has led `state`
 * to `next`:
 *     asperity_cohere(&cohesion, &table, R, E, &state, &next, &memory, d, &next_memory, &pull);
 * and pull.f_n (0 or less) and pull.f_t are added to those of the update. asperity_greatest_gap() tells over what gap surfaces may still hold each other.
 *
 * The law is driven at h, as without cohesion. Beside it stands the attraction of the surfaces, of Johnson, Kendall & Roberts over the elastic curve F(e) of an unloading. The contact's
 * radius a is that of the approach x = e + delta without attraction, S' delta^2/2 = w A' with S = dF/de, A = pi a^2; its force is F(x) - S(x) delta, its energy that of the body less w A.
 * a^2 goes with eta (1 + c - c eta), eta = e/D, from a sphere (c = 0) to one that is flat (c = 1).
 *
 * - Flow closes without attraction: x goes no further than the approach D at which the contact yields; F_N of a press is the law's.
 * - D, the dent and a(e) are those of the hardening depth `flattened`, which follows that of the law only where that takes energy from the attraction.
 * - The surfaces meet where e = 0 and part where x has no answer.
 * - What F(x) presses more than F(e) lets the contact bear mu times as much, by a slider of the stiffness that the wider contact has more.
 * - With a range z the stress w/z holds surfaces that are less than z apart and does not deform them, as Derjaguin, Muller & Toporov have it.
 *
 * No closed path gains: the law alone returns no work; attraction has a potential, which meeting, parting and flattening only lower; the slider gives back at most what it took.
 */
#ifndef ASPERITY_COHESION_H
#define ASPERITY_COHESION_H

#include "asperity_contact.h"

#define ASPERITY_COHESION_STEPS 100      /* of Newton, many where the surfaces are about to part; and halvings */
#define ASPERITY_COHESION_NEAR 1e-15     /* of the approach */
#define ASPERITY_COHESION_ELASTIC 0.97   /* share of what is recovered of the shallowest indentation, down to which a contact is elastic: some tables recover a little less than all */
#define ASPERITY_PI 3.141592653589793

/* The attraction between two materials, in the units of the engine. */
typedef struct asperity_cohesive {
    asperity_real work, range;
    double elastic; /* greatest depth of first loading that leaves no dent, over R */
} asperity_cohesive;

/* What a contact with cohesion remembers besides; all zero before first contact. Lengths over R, forces over E R^2, work over E R^3. */
typedef struct asperity_cohesion {
    asperity_real flattened; /* hardening depth of its shape, less that of the table's first row */
    asperity_real joined;    /* 1 where the surfaces hold each other, else 0 */
    asperity_real slider[2]; /* force of the slider along the two axes, */
    asperity_real stiffness; /* and its stiffness */
    asperity_real f_n;       /* normal force of the attraction, */
    asperity_real energy;    /* and its energy */
} asperity_cohesion;

/* What cohesion adds to the answer of an increment. */
typedef struct asperity_attraction {
    asperity_real f_n;    /* compression positive: 0 or less */
    asperity_real f_t[2]; /* along the displacement */
    asperity_real stored; /* of an attraction that holds, negative */
    asperity_real lost;   /* work that this increment dissipated as the surfaces met, parted or were flattened, */
    asperity_real slip;   /* and by slip */
} asperity_attraction;

/* The elastic contact of one hardening depth, and how it is attracted. Lengths over R, stiffness over E R, w over E R. */
typedef struct asperity_shape_of {
    double dent, approach, stiff, area, delta; /* elastic approach D of first loading; stiffness, area and delta there */
    double round, along, work, range, most;    /* c; k_T over the stiffness; w and its range; x at the most */
    double radius;                             /* of the undeformed contact */
} asperity_shape_of;

/* An attracted contact: its energy and normal force beside those of the law, and by how much F_N and the stiffness at x are more. */
typedef struct asperity_held {
    double energy, f_n, presses, stiffer;
} asperity_held;

/* At an approach without attraction. */
typedef struct asperity_bare {
    double f_n, energy, stiff;
} asperity_bare;

/* The attraction `work` over the distance `range`, both 0 or more. Returns 0, or 1 if they are not. */
ASPERITY_FN int asperity_make_cohesion(asperity_cohesive *cohesion, const asperity_table *t, asperity_real work, asperity_real range) {
    double least = ASPERITY_COHESION_ELASTIC * (double)t->rows[1][ASPERITY_RECOVERED];
    int i = 1;
    cohesion->work = cohesion->range = ASPERITY_R(0.0);
    cohesion->elastic = 1e300;
    while (i < ASPERITY_ROWS && !((double)t->rows[i][ASPERITY_RECOVERED] < least)) {
        i++;
    }
    if (i < ASPERITY_ROWS) {
        cohesion->elastic = (double)t->first * asperity_exponential((i - 1) / (double)t->per_step);
    }
    if (!asperity_is_finite(work) || !asperity_is_finite(range) || !(work >= ASPERITY_R(0.0)) || !(range >= ASPERITY_R(0.0))) {
        return 1;
    }
    cohesion->work = work;
    cohesion->range = range;
    return 0;
}

/* a^2 over that at D; its slope by eta. */
ASPERITY_FN double asperity_wide(const asperity_shape_of *s, double eta, double *slope) {
    *slope = 1.0 + s->round * (1.0 - 2.0 * eta);
    return eta * (1.0 + s->round * (1.0 - eta));
}

/* delta at x; its slope. */
ASPERITY_FN double asperity_delta_at(const asperity_shape_of *s, double x, double *slope) {
    double by_eta, wide = asperity_wide(s, x / s->approach, &by_eta), delta = s->delta * sqrt(sqrt(wide));
    *slope = 0.25 * delta * by_eta / (wide * s->approach);
    return delta;
}

ASPERITY_FN asperity_bare asperity_bare_at(const asperity_shape_of *s, double e) {
    /* Gauss' places and weights for the integral of sqrt(y) f(y) from 0 to 1. */
    static const double places[6] = {0.05311103539287674, 0.2011457477322403, 0.41261267387944145, 0.6425274355436583, 0.8419868222565716, 0.9686162851952115};
    static const double shares[6] = {0.024036267991510898, 0.08360262854513247, 0.14701057892612374, 0.17846008077293196, 0.15513017981975708, 0.07842693261121042};
    asperity_bare bare;
    double eta = e / s->approach, f_n = 0.0, energy = 0.0, force, unused;
    int i;
    bare.f_n = bare.energy = bare.stiff = 0.0;
    if (!(e > 0.0)) {
        return bare;
    }
    for (i = 0; i < 6; i++) {
        double part = shares[i] * sqrt(1.0 + s->round * (1.0 - eta * places[i]));
        f_n += part;
        energy += (1.0 - places[i]) * part;
    }
    force = s->stiff * e * sqrt(eta);
    bare.f_n = force * f_n;
    bare.energy = force * e * energy;
    bare.stiff = s->stiff * sqrt(asperity_wide(s, eta, &unused));
    return bare;
}

/* x at which delta changes as fast as x, over `times`, of a sphere. */
ASPERITY_FN double asperity_turns(const asperity_shape_of *s, double times) {
    return s->approach * asperity_exponential(asperity_logarithm(0.25 * times * s->delta / s->approach) / 0.75);
}

ASPERITY_FN void asperity_shape_at(const asperity_cohesive *cohesion, const asperity_table *t, double scale, double range, double flattened, asperity_shape_of *s) {
    double depth = (double)t->first + flattened, log_h, gamma, a, u, y, pull;
    int whole = depth <= cohesion->elastic, i;
    asperity_row row;
    depth = whole ? (double)t->first : depth;
    log_h = asperity_logarithm(depth / (double)t->first);
    asperity_read(t, depth, log_h, &row);
    u = log_h * (double)t->per_step;
    i = asperity_before(u, ASPERITY_ROWS - 2);
    u = u > 0.0 ? u - i : 0.0;
    a = asperity_exponential((double)t->rows[i][ASPERITY_RADIUS] + u * ((double)t->rows[i + 1][ASPERITY_RADIUS] - (double)t->rows[i][ASPERITY_RADIUS]));
    gamma = row.value[ASPERITY_GAMMA];
    s->dent = row.dent;
    s->approach = row.approach;
    s->stiff = gamma * asperity_exponential(row.value[ASPERITY_LN_FORCE]) / row.approach;
    if (whole) {
        s->dent = 0.0;
        s->approach = (double)t->first;
        a = sqrt((double)t->effective_radius * (double)t->first);
        s->stiff = 2.0 * (double)t->effective_modulus * a;
    }
    s->area = ASPERITY_PI * a * a;
    s->work = (double)cohesion->work * scale;
    s->range = range;
    s->radius = (double)t->effective_radius;
    s->delta = a * sqrt(4.0 * ASPERITY_PI * s->work / s->stiff);
    s->along = asperity_exponential(row.value[ASPERITY_LN_STIFFNESS]) / s->stiff;
    s->round = 0.0;
    s->most = s->approach;
    if (whole) {
        /* Attraction by itself makes no dent: up to where F has its least value there is none. */
        pull = range > 0.0 ? range : asperity_turns(s, 3.0);
        s->most = cohesion->elastic > pull ? cohesion->elastic : pull;
    } else {
        /* By how far gamma has come from 3/2 to 4/pi; to 1e-5. */
        y = (1.5 - gamma) / (1.5 - 4.0 / ASPERITY_PI);
        y = y > 0.0 ? (y < 1.0 ? y : 1.0) : 0.0;
        s->round = y + y * (1.0 - y) * (-0.24433305 + y * (-0.04673567 + y * -0.01232952));
    }
}

/* The elastic approach at which the surfaces part: the least of x - delta. */
ASPERITY_FN double asperity_parts(const asperity_shape_of *s) {
    double low = 0.0, high = s->most, middle, slope;
    int i;
    if (s->round == 0.0) {
        middle = asperity_turns(s, 1.0);
        high = high < middle ? high : middle;
    } else {
        asperity_delta_at(s, high, &slope);
        for (i = 0; slope < 1.0 && i < ASPERITY_COHESION_STEPS; i++) {
            double here;
            middle = 0.5 * (low + high);
            asperity_delta_at(s, middle, &here);
            if (here < 1.0) {
                high = middle;
            } else {
                low = middle;
            }
        }
    }
    return high - asperity_delta_at(s, high, &slope);
}

/* Greatest gap, of what h is negative, over which the surfaces may hold each other; in the units of R. */
ASPERITY_FN asperity_real asperity_greatest_gap(const asperity_cohesive *cohesion, const asperity_table *t, asperity_real radius, asperity_real modulus) {
    double gap = 0.0, scale = 1.0 / ((double)modulus * (double)radius), h;
    asperity_shape_of s;
    int i;
    if (!(cohesion->work > ASPERITY_R(0.0)) || cohesion->range > ASPERITY_R(0.0)) {
        return cohesion->work > ASPERITY_R(0.0) ? cohesion->range : ASPERITY_R(0.0);
    }
    for (i = 0; i < ASPERITY_ROWS; i++) {
        asperity_shape_at(cohesion, t, scale, 0.0, (double)t->first * (asperity_exponential(i / (double)t->per_step) - 1.0), &s);
        h = s.dent + asperity_parts(&s);
        gap = -h > gap ? -h : gap;
    }
    return ASPERITY_R(gap * (double)radius);
}

/* x at the elastic approach e < most: the greater root of x - delta = e, from above. 0 where the surfaces part. */
ASPERITY_FN double asperity_joined(const asperity_shape_of *s, double e) {
    double x = s->most, delta, slope, step;
    int i;
    if (e >= x - asperity_delta_at(s, x, &slope)) {
        return x;
    }
    if (s->round == 0.0) {
        double above = asperity_turns(s, 4.0);
        above = e > 0.0 ? 3.0 * (e > above ? e : above) : above;
        x = above < x ? above : x;
    }
    for (i = 0; i < ASPERITY_COHESION_STEPS; i++) {
        delta = asperity_delta_at(s, x, &slope);
        step = (x - delta - e) / (1.0 - slope);
        if (!(slope < 1.0 && step < x)) {
            return 0.0;
        }
        if (!(step > ASPERITY_COHESION_NEAR * x)) {
            return x;
        }
        x -= step;
    }
    return x;
}

/* Area over which undeformed surfaces are less than z apart, by their curvature, and beyond what is flattened by that of the sphere; its integral from 0 on. */
ASPERITY_FN double asperity_near(const asperity_shape_of *s, double z, double *sum) {
    double eta = 2.0 * z / s->approach, to = eta < 1.0 ? eta : 1.0, beyond, around, unused;
    if (s->round == 0.0) {
        *sum = 0.5 * s->area * eta * z;
        return s->area * eta;
    }
    beyond = 0.5 * s->approach * (eta - to);
    around = ASPERITY_PI * s->radius * beyond;
    *sum = s->area * (0.5 * s->approach * to * to * (0.5 * (1.0 + s->round) - s->round * to / 3.0) + beyond) + around * beyond;
    return s->area * asperity_wide(s, to, &unused) + 2.0 * around;
}

/* What a range adds at the elastic approach e: as much in contact as at its beginning, but less and less over the last of the way to where the contact yields. */
ASPERITY_FN void asperity_attracted(const asperity_shape_of *s, double e, asperity_held *held) {
    double stress = s->work / s->range, sum, area = asperity_near(s, s->range - (e < 0.0 ? -e : 0.0), &sum), last, left, share, way;
    held->f_n = -stress * area;
    held->energy = -stress * sum;
    held->presses = held->stiffer = 0.0;
    if (e > 0.0) {
        last = s->range < s->most ? s->range : s->most;
        left = e < s->most ? s->most - e : 0.0;
        share = left < last ? left / last : 1.0;
        way = left < last ? s->most - 0.5 * (last + left * share) : e;
        held->energy += held->f_n * way;
        held->f_n *= share;
    }
}

/* What holds at the elastic approach e; 0 where the surfaces part. */
ASPERITY_FN int asperity_hold(const asperity_shape_of *s, double e, asperity_held *held) {
    asperity_bare wide, bare;
    double x, delta, unused;
    held->f_n = held->energy = held->presses = held->stiffer = 0.0;
    if (s->range > 0.0) {
        if (!(e > -s->range)) {
            return 0;
        }
        asperity_attracted(s, e, held);
        return 1;
    }
    if (e >= s->most) {
        held->energy = -s->work * s->area * asperity_wide(s, s->most / s->approach, &unused);
        return 1;
    }
    x = asperity_joined(s, e);
    if (!(x > 0.0)) {
        return 0;
    }
    wide = asperity_bare_at(s, x);
    bare = asperity_bare_at(s, e);
    delta = x - e;
    held->energy = wide.energy - wide.f_n * delta + 0.5 * wide.stiff * delta * delta - s->work * s->area * asperity_wide(s, x / s->approach, &unused) - bare.energy;
    held->f_n = wide.f_n - wide.stiff * delta - bare.f_n;
    held->presses = wide.f_n - bare.f_n;
    held->stiffer = wide.stiff - bare.stiff;
    return 1;
}

/* Work of a step, by the mean of its forces, that the energy after it has not. */
ASPERITY_FN double asperity_lost_work(const asperity_cohesion *before, const asperity_held *after, double dh) {
    return 0.5 * ((double)before->f_n + after->f_n) * dh - (after->energy - (double)before->energy);
}

/* The shape that a contact has at the indentation h, after one that dh led there, and what holds there: that of before, or that of the law's hardening where it has less energy, by more
 * than the work of the step. Surfaces meet where the law's hardened shape touches. */
ASPERITY_FN void asperity_join(
    const asperity_cohesive *cohesion, const asperity_table *t, double scale, double range, asperity_cohesion *memory, const asperity_state *contact, double dh,
    asperity_shape_of *shape, asperity_held *held) {
    double h = (double)contact->h, e;
    int hardens = contact->hardened > memory->flattened, joined = memory->joined == ASPERITY_R(1.0), meets, holds;
    asperity_shape_of flat;
    asperity_held less;
    asperity_shape_at(cohesion, t, scale, range, (double)contact->hardened, &flat);
    e = h - flat.dent;
    if (hardens) {
        asperity_shape_at(cohesion, t, scale, range, (double)memory->flattened, shape);
    } else {
        *shape = flat;
    }
    holds = asperity_hold(shape, h - shape->dent, held);
    meets = !joined && e >= -range;
    holds = holds && (joined || (meets && held->energy <= 0.0));
    if (!holds) {
        held->f_n = held->energy = held->presses = held->stiffer = 0.0;
    }
    if (hardens && (holds || meets) && asperity_hold(&flat, e, &less) && less.energy <= held->energy && asperity_lost_work(memory, &less, dh) >= 0.0) {
        memory->flattened = contact->hardened;
        *shape = flat;
        *held = less;
        holds = 1;
    }
    memory->joined = ASPERITY_R(holds ? 1.0 : 0.0);
}

/* Whether a memory is one that an update may have left. */
ASPERITY_FN int asperity_is_sound_cohesion(const asperity_cohesion *c) {
    const asperity_real zero = ASPERITY_R(0.0);
    const asperity_real most = ASPERITY_R(ASPERITY_MOST);
    return asperity_is_finite(c->flattened + c->stiffness) && asperity_is_finite(c->slider[0] + c->slider[1]) && asperity_is_finite(c->f_n + c->energy) && c->flattened >= zero &&
           c->flattened <= most && c->stiffness >= zero && c->stiffness <= most && ASPERITY_ABS(c->slider[0]) <= most && ASPERITY_ABS(c->slider[1]) <= most &&
           ASPERITY_ABS(c->f_n) <= most && ASPERITY_ABS(c->energy) <= most && (c->joined == zero || c->joined == ASPERITY_R(1.0));
}

/* What cohesion adds to an increment that the update has made of a contact, `contact` before and `after`; d: the tangential increment. `next` may be `memory`. Where something is no
 * number nothing in the answer is, and the memory stays as it was. */
ASPERITY_FN void asperity_cohere(
    const asperity_cohesive *cohesion, const asperity_table *t, asperity_real radius, asperity_real modulus, const asperity_state *contact, const asperity_state *after,
    const asperity_cohesion *memory, const asperity_real d[2], asperity_cohesion *next, asperity_attraction *out) {
    double force = (double)modulus * (double)radius * (double)radius, work = force * (double)radius, scale = 1.0 / ((double)modulus * (double)radius);
    double range = (double)cohesion->range / (double)radius, dh, lost, stiff, share, along[2], size, limit, kept, done, before;
    asperity_cohesion c = *memory;
    asperity_shape_of shape;
    asperity_held held;
    int i;
    memset(out, 0, sizeof *out);
    if (!(cohesion->work > ASPERITY_R(0.0))) {
        *next = *memory;
        return;
    }
    if (!asperity_is_sound_cohesion(memory) || !asperity_is_sound(contact) || !asperity_is_sound(after) || !asperity_is_finite(d[0] + d[1])) {
        out->f_n = out->f_t[0] = out->f_t[1] = out->stored = out->lost = out->slip = asperity_no_number();
        *next = *memory;
        return;
    }
    dh = (double)after->h - (double)contact->h;
    if (memory->joined == ASPERITY_R(0.0) && contact->h_max == ASPERITY_R(0.0) && contact->h == ASPERITY_R(0.0)) { /* what never touched comes from where attraction begins */
        dh += range;
    }
    asperity_join(cohesion, t, scale, range, &c, after, dh, &shape, &held);
    lost = asperity_lost_work(memory, &held, dh);
    /* A stiffness that falls takes force with it, one that grows none: neither adds energy. */
    stiff = shape.along * (held.stiffer > 0.0 ? held.stiffer : 0.0);
    before = (double)memory->stiffness;
    share = stiff < before ? stiff / before : 1.0;
    for (i = 0; i < 2; i++) {
        along[i] = share * (double)memory->slider[i] + stiff * (double)(d[i] / radius);
    }
    size = sqrt(along[0] * along[0] + along[1] * along[1]);
    limit = (double)t->friction * held.presses;
    kept = size > limit ? (limit > 0.0 ? limit / size : 0.0) : 1.0;
    done = before > 0.0 ? 0.5 * ((double)memory->slider[0] * (double)memory->slider[0] + (double)memory->slider[1] * (double)memory->slider[1]) / before : 0.0;
    for (i = 0; i < 2; i++) {
        along[i] *= kept;
        done += 0.5 * ((double)memory->slider[i] + along[i]) * (double)(d[i] / radius);
        c.slider[i] = ASPERITY_R(along[i]);
    }
    size = stiff > 0.0 ? 0.5 * (along[0] * along[0] + along[1] * along[1]) / stiff : 0.0;
    c.stiffness = ASPERITY_R(stiff);
    c.f_n = ASPERITY_R(held.f_n);
    c.energy = ASPERITY_R(held.energy);
    out->f_n = ASPERITY_R(held.f_n * force);
    out->f_t[0] = ASPERITY_R(along[0] * force);
    out->f_t[1] = ASPERITY_R(along[1] * force);
    out->stored = ASPERITY_R((held.energy + size) * work);
    out->lost = ASPERITY_R(lost * work);
    out->slip = ASPERITY_R((done - size) * work);
    *next = c;
}

#endif
