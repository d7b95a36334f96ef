/* asperity_turning.h: twist and roll of one contact, beside the update of asperity_contact.h.
 *
 * A contact's memory is then an asperity_state and an asperity_turning, both zero before first contact. Each step, in place of asperity_update():
 *     asperity_update_turning(&table, R, E, &state, &turning, h, d, turn, &next, &next_turning, &out, &moments, NULL);
 * turn[3]: how far the sphere has turned since the last call against what it is pressed on, about the two axes of d (a roll) and about the normal (a twist), rad; moments of the
 * tractions about the contact's point, in the direction of the turn: what turns the sphere; the plane gives it the opposite. The axes and the normal are right-handed, the normal
 * points from the plane to the sphere: a roll about the second axis carries the contact along the first, d is what the sphere slips without it. A contact that never turned has
 * the forces of asperity_update() to the last bit.
 *
 * - Twist: each slider has a force around the normal beside those along the plane, within the one limit mu times its share of F_N. So a shear takes the moment of an earlier twist
 *   and a twist the force of an earlier shear. M_twist counts for yield as F_T does.
 * - Roll: what rolls leaves its dent behind. The share `rolled` grows with the way over the contact's radius; it takes yield force and is the limit of the rolling moment, whose
 *   rule is Armstrong and Frederick's: dM = k dtheta - (k/M_max) |dtheta| M, which loses energy on every way. Tractions are left behind, too.
 */
#ifndef ASPERITY_TURNING_H
#define ASPERITY_TURNING_H

#include "asperity_contact.h"

#define ASPERITY_LEVERS_SQUARED @LEVERS_SQUARED@ /* the sum of their weights times levers squared */
#define ASPERITY_TWIST_FOLLOWS @TWIST_FOLLOWS@ /* way over mu F_N/k_T in which the twist's part in yield follows its moment */
#define ASPERITY_ROLL_WAY @ROLL_WAY@           /* way over a in which the contact leaves what was pressed, */
#define ASPERITY_ROLL_TRACTION @ROLL_TRACTION@ /* and its tractions */
#define ASPERITY_ROLL_MOMENT @ROLL_MOMENT@     /* greatest M_roll over F_N a, of a contact that is all plastic, */
#define ASPERITY_ROLL_FADES @ROLL_FADES@       /* its power of 1 - D/h */
#define ASPERITY_ROLL_STIFF @ROLL_STIFF@       /* stiffness over that of a flat punch, of a contact that is all elastic, */
#define ASPERITY_ROLL_SOFTENS @ROLL_SOFTENS@   /* its power of D/h */
#define ASPERITY_ROLL_LOSS @ROLL_LOSS@         /* share of the yield force that a roll takes, of a contact that is all plastic, */
#define ASPERITY_ROLL_LOSS_FADES @ROLL_LOSS_FADES@ /* its power of 1 - D/h */
#define ASPERITY_ROLL_SLIP @ROLL_SLIP@         /* slip of a roll over its angle, over h */
#define ASPERITY_ROLL_LEAVES @ROLL_LEAVES@     /* power of D/h of the way on which tractions are left behind */
#define ASPERITY_ROLL_FLOW @ROLL_FLOW@         /* way over a, for dh/h, on which the flow of a press is half of what it is without a roll */
#define ASPERITY_ROLL_PRESS @ROLL_PRESS@       /* how fast a press takes back what was rolled, over dh_p/h */

/* The answer: moments in the direction of the turn, and besides those of asperity_response elastic energy and work that this increment dissipated. */
typedef struct asperity_moments {
    asperity_real m_twist, m_roll[2], stored, lost;
} asperity_moments;

/* Of a contact at one time: its whole radius, F_N, stiffness in a roll, greatest moment, and of its row D, dent and k_T. */
typedef struct asperity_rolling {
    double radius, f_n, stiff, most, approach, dent, along;
} asperity_rolling;

/* Where a contact is that was rolled so far; `e` is the elastic approach to take where it has not yet touched. */
ASPERITY_FN void asperity_rolling_of(const asperity_table *t, const asperity_state *s, double e, double rolled, asperity_rolling *o) {
    double depth = (double)t->first + (double)s->hardened, log_h = asperity_logarithm(depth / (double)t->first), recovered, gamma, force, wide, a;
    double reach = (double)s->reach > 0.0 ? (double)s->reach : e;
    asperity_row row;
    int i;
    memset(o, 0, sizeof *o);
    asperity_read(t, depth, log_h, &row);
    gamma = row.value[ASPERITY_GAMMA];
    wide = 1.0 + (double)s->stiffened;
    o->approach = row.approach;
    o->dent = row.dent;
    o->along = asperity_exponential(row.value[ASPERITY_LN_STIFFNESS]);
    a = log_h * (double)t->per_step;
    i = asperity_before(a, ASPERITY_ROWS - 2);
    a = a > 0.0 ? a - i : 0.0;
    a = asperity_exponential((double)t->rows[i][ASPERITY_RADIUS] + a * ((double)t->rows[i + 1][ASPERITY_RADIUS] - (double)t->rows[i][ASPERITY_RADIUS]));
    if (reach > 0.0) {
        o->radius = a * asperity_exponential((gamma - 1.0) * asperity_logarithm(wide * reach / row.approach));
    }
    if ((double)s->approach > 0.0) {
        e = (double)s->approach;
        force = asperity_exponential(row.value[ASPERITY_LN_FORCE]);
        o->f_n = force * asperity_exponential(gamma * asperity_logarithm(e / row.approach) + (gamma - 1.0) * asperity_logarithm(wide));
        a *= asperity_exponential((gamma - 1.0) * asperity_logarithm(wide * e / row.approach));
        recovered = row.value[ASPERITY_RECOVERED] < 1.0 ? row.value[ASPERITY_RECOVERED] : 1.0;
        if (recovered < 1.0) {
            double plastic = asperity_logarithm(1.0 - recovered);
            o->most = ASPERITY_ROLL_MOMENT * rolled * asperity_exponential(ASPERITY_ROLL_FADES * plastic) * o->f_n * a;
            o->stiff = ASPERITY_ROLL_STIFF * asperity_exponential(ASPERITY_ROLL_SOFTENS * asperity_logarithm(recovered)) * (2.0 / 3.0) * gamma * o->f_n / e * a * a;
        }
    }
}

/* Share of the yield force that a roll has left. */
ASPERITY_FN double asperity_left_by_roll(const asperity_rolling *at, double rolled) {
    double plastic = at->dent / (at->dent + at->approach);
    return plastic > 0.0 ? 1.0 - ASPERITY_ROLL_LOSS * rolled * asperity_exponential(ASPERITY_ROLL_LOSS_FADES * asperity_logarithm(plastic)) : 1.0;
}

/* M_twist of the sectors' forces. */
ASPERITY_FN double asperity_twisting(double sector[ASPERITY_SECTORS][2][ASPERITY_PADDED], double radius) {
    const double *lever = asperity_levers();
    double sum = 0.0;
    int i, j;
    for (j = 0; j < ASPERITY_SECTORS; j++) {
        for (i = 0; i < ASPERITY_SLIDERS; i++) {
            sum += lever[i] * (asperity_around(j)[0] * sector[j][0][i] + asperity_around(j)[1] * sector[j][1][i]);
        }
    }
    return radius / ASPERITY_SECTORS * sum;
}

/* Elastic energy of the twist and the roll. */
ASPERITY_FN double asperity_turning_energy(const asperity_rolling *at, double sector[ASPERITY_SECTORS][2][ASPERITY_PADDED], const double moment[2]) {
    const double *per_weight = asperity_per_weights();
    double sum = 0.0, square = moment[0] * moment[0] + moment[1] * moment[1];
    int i, j, c;
    for (i = 0; i < ASPERITY_SLIDERS; i++) {
        for (c = 0; c < 2; c++) {
            double mean = 0.0, squares = 0.0;
            for (j = 0; j < ASPERITY_SECTORS; j++) {
                mean += sector[j][c][i] / ASPERITY_SECTORS;
                squares += sector[j][c][i] * sector[j][c][i] / ASPERITY_SECTORS;
            }
            sum += (squares - mean * mean) * per_weight[i];
        }
    }
    return 0.5 * (sum / (ASPERITY_TWIST_STIFF * at->along) + (at->stiff > 0.0 ? square / at->stiff : 0.0));
}

/* The twist's part in yield as a step goes on: it follows its moment over a little way, so that a step that goes nowhere leaves it. */
ASPERITY_FN double asperity_follow_twist(const asperity_table *t, const asperity_rolling *at, asperity_twist *twist, double before, double way, double change) {
    double mu = (double)t->friction > 1e-9 ? (double)t->friction : 1e-9, to;
    if (!(at->f_n > 0.0) || !(at->radius > 0.0)) {
        return before;
    }
    to = ASPERITY_TWIST_YIELD * asperity_twisting(twist->sector, 1.0) / (ASPERITY_TWIST_LEVER * at->f_n);
    return to - (to - before) * asperity_exponential(-(at->along * way / mu + change) / (ASPERITY_TWIST_FOLLOWS * at->f_n));
}

/* The rolling moment along a roll, and its work. */
ASPERITY_FN double asperity_roll_moment(const asperity_rolling *at, const double roll[2], double moment[2]) {
    double angle = sqrt(roll[0] * roll[0] + roll[1] * roll[1]), kept, work = 0.0, to[2];
    int i;
    if (!(angle > 0.0)) {
        return 0.0;
    }
    if (!(at->most > 0.0) || !(at->stiff > 0.0)) {
        moment[0] = moment[1] = 0.0;
        return 0.0;
    }
    kept = asperity_exponential(-at->stiff * angle / at->most);
    for (i = 0; i < 2; i++) {
        to[i] = at->most * roll[i] / angle;
        work += to[i] * roll[i] + (moment[i] - to[i]) * (at->most / at->stiff) * (1.0 - kept) * roll[i] / angle;
        moment[i] = to[i] + (moment[i] - to[i]) * kept;
    }
    return work;
}

/* What the part of a twist in yield were if all stuck, and by how much slip takes from it. */
ASPERITY_FN void asperity_try_twist(const asperity_table *t, const asperity_rolling *at, asperity_twist *twist) {
    twist->trial = twist->ratio;
    twist->gives = 0.0;
    if (at->f_n > 0.0) {
        double slope = ASPERITY_TWIST_YIELD / (ASPERITY_TWIST_LEVER * at->f_n) * ASPERITY_TWIST_STIFF * at->along * ASPERITY_LEVERS_SQUARED;
        double most = 1.1 * ASPERITY_TWIST_YIELD * (double)t->friction;
        twist->gives = slope * ASPERITY_TWIST_FLOW / ASPERITY_TWIST_LEVER;
        twist->trial += slope * twist->along;
        twist->trial = twist->trial < most ? twist->trial > -most ? twist->trial : -most : most;
    }
}

/* What a roll by `far` contact radii does before a step that presses by the share `pressed` of h: tractions stay behind. Returns their energy. */
ASPERITY_FN double asperity_leave_behind(const asperity_rolling *at, double far, double pressed, double *rolled, asperity_state *state, asperity_twist *twist) {
    double recovered = at->approach / (at->approach + at->dent), lost = 0.0;
    double kept = asperity_exponential(-far / ASPERITY_ROLL_TRACTION * asperity_exponential(-ASPERITY_ROLL_LEAVES * asperity_logarithm(recovered)));
    int i, j;
    twist->flows = pressed > 0.0 ? pressed / (pressed + far / ASPERITY_ROLL_FLOW) : 0.0;
    *rolled = 1.0 - (1.0 - *rolled) * asperity_exponential(-far / ASPERITY_ROLL_WAY);
    for (i = 0; i < ASPERITY_SLIDERS; i++) {
        for (j = 0; j < 2; j++) {
            double held = (double)state->slider[j][i];
            state->slider[j][i] = ASPERITY_R(held * kept);
            lost += 0.5 * held * held * (1.0 - kept * kept) * asperity_per_weights()[i] / at->along;
        }
        for (j = 0; j < ASPERITY_SECTORS; j++) {
            twist->sector[j][0][i] *= kept;
            twist->sector[j][1][i] *= kept;
        }
    }
    return lost;
}

/* Whether a contact has turned. */
ASPERITY_FN int asperity_has_turned(const asperity_turning *turning) {
    asperity_real sum = ASPERITY_ABS(turning->twisted) + ASPERITY_ABS(turning->vertex) +
                        turning->rolled + ASPERITY_ABS(turning->moment[0]) + ASPERITY_ABS(turning->moment[1]);
    int i, j;
    for (i = 0; i < ASPERITY_SLIDERS; i++) {
        for (j = 0; j < ASPERITY_SECTORS; j++) {
            sum += ASPERITY_ABS(turning->sector[j][0][i]) + ASPERITY_ABS(turning->sector[j][1][i]);
        }
    }
    return !(sum == ASPERITY_R(0.0));
}

/* The sectors to work with; those of a contact that begins to turn are alike. */
ASPERITY_FN void asperity_begin_turning(const asperity_state *state, const asperity_turning *turning, asperity_twist *twist) {
    const int has = asperity_has_turned(turning);
    int i, j;
    memset(twist->sector, 0, sizeof twist->sector);
    for (i = 0; i < ASPERITY_SLIDERS; i++) {
        for (j = 0; j < ASPERITY_SECTORS; j++) {
            twist->sector[j][0][i] = (double)(has ? turning->sector[j][0][i] : state->slider[0][i]);
            twist->sector[j][1][i] = (double)(has ? turning->sector[j][1][i] : state->slider[1][i]);
        }
    }
}

/* Moves a contact that twists and rolls: asperity_update() with its turn, its memory of that and its moments besides. `next_turning` may be `turning`. */
ASPERITY_FN void asperity_update_turning(
    const asperity_table *t, asperity_real radius, asperity_real modulus, const asperity_state *state, const asperity_turning *turning, asperity_real h,
    const asperity_real increment[2], const asperity_real turn[3], asperity_state *next, asperity_turning *next_turning, asperity_response *out, asperity_moments *moments,
    asperity_tangent *tangent) {
    double torque = (double)modulus * (double)radius * (double)radius * (double)radius, roll[2], moment[2], way, angle, kept, rolled, e, slip, shrinks, most, lost;
    asperity_state from = *state;
    asperity_real d[2];
    asperity_rolling before, after;
    asperity_twist twist;
    int i, j;
    memset(moments, 0, sizeof *moments);
    if ((!asperity_has_turned(turning) && turn[0] == ASPERITY_R(0.0) && turn[1] == ASPERITY_R(0.0) && turn[2] == ASPERITY_R(0.0)) || !asperity_is_sound(state)) {
        asperity_turning same = *turning;
        asperity_update(t, radius, modulus, state, h, increment, next, out, tangent);
        *next_turning = same;
        return;
    }
    rolled = (double)turning->rolled;
    e = (double)state->approach + (double)h / (double)radius - (double)state->h;
    asperity_rolling_of(t, state, e, rolled, &before);
    twist.vertex = (double)turning->vertex;
    asperity_begin_turning(state, turning, &twist);
    for (j = 0; j < 2; j++) {
        roll[j] = (double)turn[j];
        moment[j] = (double)turning->moment[j];
        d[j] = increment[j];
    }
    lost = asperity_turning_energy(&before, twist.sector, moment) + 0.5 * asperity_twisting(twist.sector, before.radius) * (double)turn[2];
    angle = sqrt(roll[0] * roll[0] + roll[1] * roll[1]);
    twist.along = before.radius * (double)turn[2];
    way = sqrt((double)d[0] * (double)d[0] + (double)d[1] * (double)d[1]) / (double)radius;
    slip = ASPERITY_ROLL_SLIP * (before.approach + before.dent);
    twist.flows = 1.0;
    if (angle > 0.0 && before.radius > 0.0) {
        lost += asperity_leave_behind(
            &before, angle * (double)t->effective_radius / before.radius, ((double)h / (double)radius - (double)state->h) / (before.approach + before.dent), &rolled, &from,
            &twist);
        d[0] += ASPERITY_R(slip * roll[1] * (double)radius);
        d[1] -= ASPERITY_R(slip * roll[0] * (double)radius);
    }
    way = sqrt(way * way + twist.along * twist.along + slip * slip * angle * angle);
    twist.ratio = asperity_follow_twist(t, &before, &twist, (double)turning->twisted, way, before.f_n * fabs(e > 0.0 && state->approach > 0 ? e / (double)state->approach - 1.0 : 0.0));
    twist.kept = asperity_left_by_roll(&before, rolled);
    asperity_try_twist(t, &before, &twist);
    asperity_advance(t, radius, modulus, &from, &twist, h, d, next, out, tangent);
    if (!asperity_is_finite(out->f_n)) {
        *next = *state;
        *next_turning = *turning;
        moments->m_twist = moments->m_roll[0] = moments->m_roll[1] = moments->stored = moments->lost = asperity_no_number();
        return;
    }
    asperity_rolling_of(t, next, 0.0, rolled, &after);
    if (after.dent > before.dent) {
        rolled *= asperity_exponential(-ASPERITY_ROLL_PRESS * (after.dent - before.dent) / (after.dent + after.approach));
    }
    shrinks = before.stiff > 0.0 && after.stiff < before.stiff ? after.stiff / before.stiff : after.stiff > 0.0 ? 1.0 : 0.0;
    moment[0] *= shrinks;
    moment[1] *= shrinks;
    lost += asperity_roll_moment(&after, roll, moment);
    for (i = 0; i < ASPERITY_SLIDERS; i++) {
        for (j = 0; j < ASPERITY_SECTORS; j++) {
            next_turning->sector[j][0][i] = ASPERITY_R(twist.sector[j][0][i]);
            next_turning->sector[j][1][i] = ASPERITY_R(twist.sector[j][1][i]);
        }
    }
    next_turning->twisted = ASPERITY_R(out->f_n > ASPERITY_R(0.0) ? twist.ratio : 0.0);
    next_turning->vertex = ASPERITY_R(twist.vertex);
    next_turning->rolled = ASPERITY_R(rolled);
    for (j = 0; j < 2; j++) {
        next_turning->moment[j] = ASPERITY_R(moment[j]);
        moments->m_roll[j] = ASPERITY_R(moment[j] * torque);
    }
    moments->m_roll[0] -= ASPERITY_R(slip * (double)radius) * out->f_t[1];
    moments->m_roll[1] += ASPERITY_R(slip * (double)radius) * out->f_t[0];
    most = asperity_twisting(twist.sector, after.radius);
    moments->m_twist = ASPERITY_R(most * torque);
    kept = asperity_turning_energy(&after, twist.sector, moment);
    moments->stored = ASPERITY_R(kept * torque);
    moments->lost = ASPERITY_R((lost + 0.5 * most * (double)turn[2] - kept) * torque);
}

#endif
