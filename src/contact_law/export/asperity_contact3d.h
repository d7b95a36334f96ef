/* asperity_contact3d.h: two spheres, or a sphere and a plane wall, in three dimensions: what an engine wraps round the update of asperity_contact.h.
 *
 * Once, for each pair of materials and for each material and wall; what does not fit together is refused here, with a code (ASPERITY_LAW_...):
 *     asperity_pair_law(&law, &table, E, restitution) != 0 || asperity_wall_law(&wall_law, &wall_table, E, restitution) != 0
 * A contact's memory is one asperity_contact: 39 numbers, all zero before first contact; copy it, write it to a restart file as it is, with asperity_fingerprint(&table) beside it.
 * Each step, for each pair that is kept:
 *     asperity_spheres(&law, &i, &j, dt, &contact, &contact, &out);
 * and add out.force_i, out.torque_i, out.force_j, out.torque_j; or asperity_spheres_many() for many pairs of one law, which is faster. With `wall` in place of j:
 * asperity_sphere_wall(). dt = 0 asks for the forces alone, at the same place.
 *
 * - The tangent frame is carried along: e1 is stored with the contact, turned by the mean spin of the two bodies and laid into the new tangent plane, e2 = n x e1. Any rigid motion of
 *   the pair gives the same forces, if velocities and places are of one time. With those of the middle of the step a turn by the angle a slips by
 *   a^3/6 of the distance of the centres.
 * - Exchanged particles: asperity_exchange().
 * - Two radii of one material: R = 2 R_i R_j/(R_i + R_j), as in Hertz's contact, each sphere taking half of the overlap.
 * - A rigid plane wall needs a table of a sphere on a plane, two spheres one of a pair. A table of a plane that is to stand for a pair has to be made into one, by hand:
 *   asperity_stand_in().
 * - What has no answer gets none: where the centres coincide, a place, a velocity or the memory is no number, or the table is of the other kind, the forces are no numbers, a flag
 *   says why, and the memory stays as it was.
 * - Twist and roll: asperity_spheres_turning() and asperity_sphere_wall_turning() take and give a second memory, an asperity_turning, all zero before first contact; the torques
 *   then have the moments of twist and roll. Without it, as in asperity_spheres(), a contact does not feel that the bodies turn against each other at one point.
 * - Cohesion: asperity_law_cohesion() says how surfaces attract each other; asperity_spheres_cohesive() and asperity_sphere_wall_cohesive() take and give a memory of it, an
 *   asperity_cohesion, all zero before first contact. Call them for all pairs that are nearer than asperity_holding_gap() and keep the memories until asperity_may_forget_cohesive().
 * - A body that no force moves (frozen, driven) has the mass INFINITY, one of a rigid body the mass of that: damping goes by it.
 */
#ifndef ASPERITY_CONTACT3D_H
#define ASPERITY_CONTACT3D_H

#include "asperity_frame.h"

/* Flags of asperity_forces. */
enum {
    ASPERITY_TOUCHES = 1,
    ASPERITY_OUT_OF_RANGE = 2, /* has been deeper than the law was made for */
    ASPERITY_WRONG_TABLE = 4,  /* a wall's table between spheres, or a pair's at a wall: no forces */
    ASPERITY_NO_NUMBER = 8,    /* the centres coincide, or something is no number: no forces */
    ASPERITY_HOLDS = 16,       /* the surfaces hold each other by cohesion */
    ASPERITY_UNSOLVED = 32     /* a step so long that nothing found the answer of its equations; the forces are near it */
};

/* What asperity_pair_law() and asperity_wall_law() return. */
enum {
    ASPERITY_LAW_FITS = 0,
    ASPERITY_LAW_OF_A_WALL = 1, /* the table is of a sphere on a plane */
    ASPERITY_LAW_OF_A_PAIR = 2, /* the table is of two spheres */
    ASPERITY_LAW_MODULUS = 3,   /* Young's modulus is not positive or not finite */
    ASPERITY_LAW_RESTITUTION = 4 /* the restitution coefficient is not from 0.1 to 1 */
};

/* The law of a pair of materials, in the units of the engine. */
typedef struct asperity_law3d {
    const asperity_table *table;
    asperity_real modulus;    /* Young's */
    asperity_real damping;    /* of asperity_damping(), 0: none but the law's own losses */
    asperity_real tangential; /* dashpot along the plane over that across it, 0: none. It is bounded by friction */
    asperity_cohesive cohesion; /* of asperity_law_cohesion() */
} asperity_law3d;

typedef struct asperity_body {
    asperity_real position[3], velocity[3], spin[3]; /* spin: angular velocity */
    asperity_real radius, mass;                      /* mass: INFINITY of what no force moves */
} asperity_body;

/* A rigid plane through `point`; the unit normal points to where the spheres are. */
typedef struct asperity_wall {
    asperity_real point[3], normal[3], velocity[3], spin[3]; /* velocity: that of `point` */
} asperity_wall;

typedef struct asperity_forces {
    asperity_real force_i[3], torque_i[3], force_j[3], torque_j[3];
    asperity_real f_n, f_t, overlap;
    asperity_real stored; /* elastic energy; with cohesion also that, which is negative */
    asperity_real damped; /* work that the damping has taken in this step */
    asperity_real parted; /* work that cohesion has dissipated in this step, as surfaces met, parted or were flattened */
    int flags;
} asperity_forces;

/* The factor of a dashpot, force = factor sqrt(m k) v, with k = 2 E* a the stiffness of an unloading, that gives an impact which stays elastic the restitution coefficient e,
 * 0.1 <= e <= 1. The dashpot never pulls. A fit to the integrated motion, to 1e-5 in e. */
ASPERITY_FN asperity_real asperity_damping(asperity_real restitution) {
    asperity_real l = -ASPERITY_LOG(restitution);
    return l * (ASPERITY_R(0.581190906) + l * (ASPERITY_R(0.117495308) + l * (ASPERITY_R(0.0188778198) + l * (ASPERITY_R(0.00178313741) + l * ASPERITY_R(0.000432561374)))));
}

/* The critical time step of a sphere that makes one contact of the indentation h over R (0: as deep as the law goes) with an immovable body: 2 sqrt(m/k), k the greater of the
 * normal stiffness and of the tangential one, which also turns the sphere. A packing has several contacts a sphere: take a tenth. */
ASPERITY_FN asperity_real asperity_time_step(const asperity_law3d *law, asperity_real radius, asperity_real mass, asperity_real h) {
    double at = h > ASPERITY_R(0.0) ? (double)h : (double)law->table->deepest, first = (double)law->table->first, depth = at > first ? at : first, force, gamma, gap;
    asperity_real normal, tangential, pressing;
    asperity_row row;
    asperity_read(law->table, depth, asperity_logarithm(depth / first), &row);
    force = asperity_exponential(row.value[ASPERITY_LN_FORCE]);
    gamma = row.value[ASPERITY_GAMMA];
    gap = row.approach;
    normal = ASPERITY_R(gamma * force / gap * (at < first ? asperity_exponential((gamma - 1.0) * asperity_logarithm(at / first)) : 1.0));
    pressing = ASPERITY_R(at < first ? 0.0 : force * row.slope[ASPERITY_LN_FORCE]);
    normal = pressing > normal ? pressing : normal;
    tangential = ASPERITY_R(3.5 * asperity_exponential(row.value[ASPERITY_LN_STIFFNESS]));
    return ASPERITY_R(2.0) * ASPERITY_SQRT(mass / ((normal > tangential ? normal : tangential) * law->modulus * radius * law->table->share));
}

/* A table of a plane as that of two equal spheres. They do not hold each other's surface as a plane does: see the head of asperity_contact.h. */
ASPERITY_FN void asperity_stand_in(asperity_table *table) {
    table->plane = 0;
    table->share = ASPERITY_R(0.5);
}

/* What both kinds of set-up share. */
ASPERITY_FN int asperity_make_law(asperity_law3d *law, const asperity_table *table, asperity_real modulus, asperity_real restitution) {
    law->table = table;
    law->modulus = modulus;
    law->damping = law->tangential = ASPERITY_R(0.0);
    asperity_make_cohesion(&law->cohesion, table, ASPERITY_R(0.0), ASPERITY_R(0.0));
    if (!asperity_is_finite(modulus) || !(modulus > ASPERITY_R(0.0))) {
        return ASPERITY_LAW_MODULUS;
    }
    if (!asperity_is_finite(restitution) || !(restitution >= ASPERITY_R(0.1) && restitution <= ASPERITY_R(1.0))) {
        return ASPERITY_LAW_RESTITUTION;
    }
    law->damping = restitution < ASPERITY_R(1.0) ? asperity_damping(restitution) : ASPERITY_R(0.0);
    return ASPERITY_LAW_FITS;
}

/* The law of two spheres: Young's modulus (of two materials that of the sphere in the table's case), and the restitution coefficient of an impact that stays elastic, 1: no damping. */
ASPERITY_FN int asperity_pair_law(asperity_law3d *law, const asperity_table *table, asperity_real modulus, asperity_real restitution) {
    int code = asperity_make_law(law, table, modulus, restitution);
    return table->plane ? ASPERITY_LAW_OF_A_WALL : code;
}

/* The same of a sphere and a rigid plane wall. */
ASPERITY_FN int asperity_wall_law(asperity_law3d *law, const asperity_table *table, asperity_real modulus, asperity_real restitution) {
    int code = asperity_make_law(law, table, modulus, restitution);
    return table->plane ? code : ASPERITY_LAW_OF_A_PAIR;
}

/* Cohesion of a law that is made: work of adhesion w (energy over area, 0: none) and the range over which surfaces that do not touch attract each other (0: none). Returns 0, or 1 if one
 * of them is not 0 or more. */
ASPERITY_FN int asperity_law_cohesion(asperity_law3d *law, asperity_real work, asperity_real range) {
    return asperity_make_cohesion(&law->cohesion, law->table, work * law->table->share, range * law->table->share);
}

/* The radius of the table's sphere, whose R* is effective_radius, for R* of a contact; a plane that stands in is that of each sphere by itself. */
ASPERITY_FN asperity_real asperity_table_radius(const asperity_table *table, asperity_real effective) {
    return effective / ((table->plane ? ASPERITY_R(1.0) : table->share) * table->effective_radius);
}

/* Greatest gap over which two spheres may hold each other, or a sphere and a wall, where radius_j is 0. It grows with the radii. */
ASPERITY_FN asperity_real asperity_holding_gap(const asperity_law3d *law, asperity_real radius_i, asperity_real radius_j) {
    asperity_real effective = radius_j > ASPERITY_R(0.0) ? radius_i * radius_j / (radius_i + radius_j) : radius_i;
    return asperity_greatest_gap(&law->cohesion, law->table, asperity_table_radius(law->table, effective), law->modulus) / law->table->share;
}

/* The mass of a body against one that does not move. 0, which is no damping, where no force moves it either. */
ASPERITY_FN asperity_real asperity_damped_mass(asperity_real mass) {
    return asperity_is_finite(mass) && mass > ASPERITY_R(0.0) ? mass : ASPERITY_R(0.0);
}

/* The mass of two bodies against each other. */
ASPERITY_FN asperity_real asperity_effective_mass(asperity_real one, asperity_real other) {
    if (!asperity_is_finite(one)) {
        return asperity_damped_mass(other);
    }
    if (!asperity_is_finite(other)) {
        return asperity_damped_mass(one);
    }
    return one > ASPERITY_R(0.0) && other > ASPERITY_R(0.0) ? one / (ASPERITY_R(1.0) + one / other) : ASPERITY_R(0.0);
}

/* No answer, and why. */
ASPERITY_FN void asperity_no_answer(int flag, const asperity_contact *before, asperity_contact *after, asperity_forces *out) {
    asperity_real bad = asperity_no_number();
    int k;
    for (k = 0; k < 3; k++) {
        out->force_i[k] = out->torque_i[k] = out->force_j[k] = out->torque_j[k] = bad;
    }
    out->f_n = out->f_t = out->overlap = out->stored = out->damped = out->parted = bad;
    out->flags = flag;
    *after = *before;
}

/* The share of the dashpot d along the plane that friction leaves beside f: as much as keeps the sum within the bound. */
ASPERITY_FN asperity_real asperity_allowed(const asperity_real f[2], const asperity_real d[2], asperity_real bound) {
    asperity_real a = d[0] * d[0] + d[1] * d[1], b = f[0] * d[0] + f[1] * d[1], c = f[0] * f[0] + f[1] * f[1] - bound * bound, share;
    if (!(a > ASPERITY_R(0.0)) || !(c < ASPERITY_R(0.0))) {
        return ASPERITY_R(0.0);
    }
    share = (ASPERITY_SQRT(b * b - a * c) - b) / a;
    return share < ASPERITY_R(1.0) ? share : ASPERITY_R(1.0);
}

/* Contacts in a step, each in a lane: what they see of their bodies, and the answers of the update. */
typedef struct asperity_block {
    asperity_lanes n[3], v[3], spin_i[3], spin_j[3];       /* n from j to i; v that of i's point of contact relative to j's */
    asperity_lanes radius, mass, overlap, arm_i, arm_j;    /* radius: that of the table's sphere */
    asperity_lanes e1[3], e2[3], axis[2], along[2];        /* frame, and v in it */
    asperity_lanes h, d[2], turn[3];                       /* increment of the update */
    asperity_lanes f_n, f_t[2], stiffness, stored, plastic, friction; /* its answer; later all that acts */
    asperity_lanes unsolved, pressed, damped, force[3], lever[3], size; /* pressed: f_n of the update */
    asperity_moments moments[ASPERITY_TOGETHER];
    asperity_attraction pull[ASPERITY_TOGETHER];
    asperity_cohesion joined[ASPERITY_TOGETHER];
    asperity_state state[ASPERITY_TOGETHER]; /* after the update */
    int flags[ASPERITY_TOGETHER];            /* of those that have no answer */
} asperity_block;

/* Two spheres into a lane. */
ASPERITY_FN void asperity_load_pair(const asperity_body *i, const asperity_body *j, int l, asperity_block *m) {
    int k;
    for (k = 0; k < 3; k++) {
        m->n[k][l] = i->position[k] - j->position[k];
        m->v[k][l] = i->velocity[k] - j->velocity[k];
        m->spin_i[k][l] = i->spin[k];
        m->spin_j[k][l] = j->spin[k];
    }
    m->arm_i[l] = i->radius;
    m->arm_j[l] = j->radius;
    m->mass[l] = asperity_effective_mass(i->mass, j->mass);
}

/* Normals, lever arms and relative velocities of pairs of spheres. */
ASPERITY_FN void asperity_kinematics(const asperity_law3d *law, int count, asperity_block *m) {
    asperity_real per_radius = (law->table->plane ? ASPERITY_R(1.0) : law->table->share) * law->table->effective_radius;
    int l;
    for (l = 0; l < count; l++) {
        asperity_real n[3], v[3], spin_i[3], spin_j[3], across_i[3], across_j[3], radius_i = m->arm_i[l], radius_j = m->arm_j[l], distance, overlap, arm_i, arm_j;
        asperity_of_lane(m->n, l, n);
        asperity_of_lane(m->v, l, v);
        asperity_of_lane(m->spin_i, l, spin_i);
        asperity_of_lane(m->spin_j, l, spin_j);
        distance = ASPERITY_SQRT(asperity_dot(n, n));
        overlap = radius_i + radius_j - distance;
        arm_i = radius_i - ASPERITY_R(0.5) * overlap;
        arm_j = radius_j - ASPERITY_R(0.5) * overlap;
        n[0] /= distance;
        n[1] /= distance;
        n[2] /= distance;
        asperity_cross(spin_i, n, across_i);
        asperity_cross(spin_j, n, across_j);
        v[0] = v[0] - arm_i * across_i[0] - arm_j * across_j[0];
        v[1] = v[1] - arm_i * across_i[1] - arm_j * across_j[1];
        v[2] = v[2] - arm_i * across_i[2] - arm_j * across_j[2];
        asperity_into_lane(n, l, m->n);
        asperity_into_lane(v, l, m->v);
        m->size[l] = distance;
        m->overlap[l] = overlap;
        m->arm_i[l] = arm_i;
        m->arm_j[l] = arm_j;
        m->radius[l] = radius_i * radius_j / (radius_i + radius_j) / per_radius;
    }
}

/* The turn of the frame, and its memory. */
ASPERITY_INLINE void asperity_turn_of_lane(asperity_block *m, int l, asperity_real dt, asperity_real turn[3], asperity_real packed[2]) {
    turn[0] = ASPERITY_R(0.5) * (m->spin_i[0][l] + m->spin_j[0][l]) * dt;
    turn[1] = ASPERITY_R(0.5) * (m->spin_i[1][l] + m->spin_j[1][l]) * dt;
    turn[2] = ASPERITY_R(0.5) * (m->spin_i[2][l] + m->spin_j[2][l]) * dt;
    packed[0] = m->axis[0][l];
    packed[1] = m->axis[1][l];
}

/* The frame of one lane, whatever it is. */
ASPERITY_FN void asperity_carry_lane(int l, asperity_real dt, asperity_block *m) {
    asperity_real packed[2], turn[3], n[3], e1[3], e2[3];
    asperity_turn_of_lane(m, l, dt, turn, packed);
    asperity_of_lane(m->n, l, n);
    asperity_carry(packed, turn, n, e1, e2);
    asperity_into_lane(e1, l, m->e1);
    asperity_into_lane(e2, l, m->e2);
    m->axis[0][l] = packed[0];
    m->axis[1][l] = packed[1];
}

/* Before the update: the frames, whose memories are in `axis`, and what the points of contact move by in them. */
ASPERITY_FN void asperity_increments(const asperity_law3d *law, asperity_real dt, int count, int turning, asperity_block *m) {
    asperity_real share = law->table->share;
    asperity_lanes axis[2], odd;
    int l;
    for (l = 0; l < count; l++) {
        asperity_real n[3], turn[3], packed[2], angle2, s, c, size, e1[3], e2[3];
        int lies;
        asperity_of_lane(m->n, l, n);
        asperity_turn_of_lane(m, l, dt, turn, packed);
        angle2 = asperity_dot(turn, turn);
        asperity_small_turn(angle2, &s, &c);
        lies = asperity_lay(packed, turn, s, c, n, e1, &size);
        odd[l] = angle2 < ASPERITY_R(ASPERITY_SMALL_TURN) && lies ? ASPERITY_R(0.0) : ASPERITY_R(1.0);
        asperity_complete(n, size, e1, e2, packed);
        asperity_into_lane(e1, l, m->e1);
        asperity_into_lane(e2, l, m->e2);
        axis[0][l] = packed[0];
        axis[1][l] = packed[1];
    }
    for (l = 0; l < count; l++) {
        if (odd[l] > ASPERITY_R(0.0)) {
            asperity_carry_lane(l, dt, m);
        } else {
            m->axis[0][l] = axis[0][l];
            m->axis[1][l] = axis[1][l];
        }
    }
    for (l = 0; l < count; l++) {
        asperity_real v[3], e1[3], e2[3];
        asperity_of_lane(m->v, l, v);
        asperity_of_lane(m->e1, l, e1);
        asperity_of_lane(m->e2, l, e2);
        m->along[0][l] = asperity_dot(v, e1);
        m->along[1][l] = asperity_dot(v, e2);
        m->d[0][l] = share * m->along[0][l] * dt;
        m->d[1][l] = share * m->along[1][l] * dt;
        m->h[l] = share * m->overlap[l];
    }
    for (l = 0; turning && l < count; l++) {
        asperity_real turns[3] = {m->spin_i[0][l] - m->spin_j[0][l], m->spin_i[1][l] - m->spin_j[1][l], m->spin_i[2][l] - m->spin_j[2][l]}, n[3], e1[3], e2[3];
        asperity_of_lane(m->n, l, n);
        asperity_of_lane(m->e1, l, e1);
        asperity_of_lane(m->e2, l, e2);
        m->turn[0][l] = share * asperity_dot(turns, e1) * dt;
        m->turn[1][l] = share * asperity_dot(turns, e2) * dt;
        m->turn[2][l] = share * asperity_dot(turns, n) * dt;
    }
}

/* The answer of the update into a lane. */
ASPERITY_INLINE void asperity_store_answer(const asperity_response *answer, int l, asperity_block *m) {
    m->f_n[l] = answer->f_n;
    m->f_t[0][l] = answer->f_t[0];
    m->f_t[1][l] = answer->f_t[1];
    m->stiffness[l] = answer->stiffness;
    m->stored[l] = answer->stored;
    m->plastic[l] = answer->plastic;
    m->friction[l] = answer->friction;
    m->unsolved[l] = answer->unsolved;
}

/* The update of one lane. `turning` is NULL where twist and roll are left out, `cohesion` where that is. */
ASPERITY_FN void asperity_update_lane(
    const asperity_law3d *law, const asperity_state *before, const asperity_turning *turning, asperity_turning *turning_after, const asperity_cohesion *cohesion, int l,
    asperity_block *m) {
    const asperity_real d[2] = {m->d[0][l], m->d[1][l]};
    asperity_real turn[3];
    asperity_response answer;
    if (turning) {
        asperity_of_lane(m->turn, l, turn);
        asperity_update_turning(law->table, m->radius[l], law->modulus, before, turning, m->h[l], d, turn, &m->state[l], turning_after, &answer, &m->moments[l], NULL);
        answer.stored += m->moments[l].stored;
        answer.friction += m->moments[l].lost;
    } else {
        asperity_update(law->table, m->radius[l], law->modulus, before, m->h[l], d, &m->state[l], &answer, NULL);
    }
    if (cohesion) {
        asperity_cohere(&law->cohesion, law->table, m->radius[l], law->modulus, before, &m->state[l], cohesion, d, &m->joined[l], &m->pull[l]);
    }
    asperity_store_answer(&answer, l, m);
}

/* After the update: the forces, from what it answered. `cohesion`: whether that adds to them. */
ASPERITY_FN void asperity_block_forces(const asperity_law3d *law, asperity_real dt, int count, int cohesion, asperity_block *m) {
    asperity_real share = law->table->share, damping = law->damping, zero = ASPERITY_R(0.0), damps = damping > zero ? zero : asperity_no_number();
    asperity_lanes factor, bound;
    int l;
    for (l = 0; l < count; l++) {
        asperity_real f_n = m->f_n[l], approaching = -(m->v[0][l] * m->n[0][l] + m->v[1][l] * m->n[1][l] + m->v[2][l] * m->n[2][l]), dashpot;
        m->pressed[l] = f_n;
        factor[l] = damping * ASPERITY_SQRT(m->mass[l] * m->stiffness[l] * share);
        dashpot = factor[l] * approaching;
        dashpot = dashpot < -f_n ? -f_n : dashpot; /* never a pull */
        dashpot = f_n > damps ? dashpot : zero;
        m->damped[l] = dashpot * approaching * dt;
        m->f_n[l] = f_n + dashpot;
        bound[l] = dashpot < zero ? f_n + dashpot : f_n;
    }
    for (l = 0; law->tangential > zero && damping > zero && l < count; l++) {
        if (m->pressed[l] > zero) {
            const asperity_real f[2] = {m->f_t[0][l], m->f_t[1][l]};
            const asperity_real d[2] = {law->tangential * factor[l] * m->along[0][l], law->tangential * factor[l] * m->along[1][l]};
            asperity_real allowed = asperity_allowed(f, d, law->table->friction * bound[l]);
            m->f_t[0][l] += allowed * d[0];
            m->f_t[1][l] += allowed * d[1];
            m->damped[l] += allowed * (d[0] * m->along[0][l] + d[1] * m->along[1][l]) * dt;
        }
    }
    for (l = 0; cohesion && l < count; l++) {
        m->f_n[l] += m->pull[l].f_n;
        m->f_t[0][l] += m->pull[l].f_t[0];
        m->f_t[1][l] += m->pull[l].f_t[1];
    }
    for (l = 0; l < count; l++) {
        asperity_real n[3], e1[3], e2[3], tangential[3], lever[3], f_t0 = m->f_t[0][l], f_t1 = m->f_t[1][l];
        asperity_of_lane(m->n, l, n);
        asperity_of_lane(m->e1, l, e1);
        asperity_of_lane(m->e2, l, e2);
        tangential[0] = -(f_t0 * e1[0] + f_t1 * e2[0]);
        tangential[1] = -(f_t0 * e1[1] + f_t1 * e2[1]);
        tangential[2] = -(f_t0 * e1[2] + f_t1 * e2[2]);
        asperity_cross(n, tangential, lever);
        m->size[l] = ASPERITY_SQRT(f_t0 * f_t0 + f_t1 * f_t1);
        m->force[0][l] = m->f_n[l] * n[0] + tangential[0];
        m->force[1][l] = m->f_n[l] * n[1] + tangential[1];
        m->force[2][l] = m->f_n[l] * n[2] + tangential[2];
        asperity_into_lane(lever, l, m->lever);
        m->stored[l] /= share; /* the law's work is that of h and d: of what the centres move, `share` */
        m->plastic[l] /= share;
        m->friction[l] /= share;
    }
}

/* Forces and memories of one lane. */
ASPERITY_FN void asperity_store_lane(
    const asperity_law3d *law, const asperity_contact *before, asperity_contact *after, int turning, asperity_cohesion *cohesion, int l, const asperity_block *m,
    asperity_forces *out) {
    asperity_real share = law->table->share;
    int k;
    if (!asperity_is_finite(m->f_n[l]) || !asperity_is_finite(m->f_t[0][l] + m->f_t[1][l])) {
        asperity_no_answer(ASPERITY_NO_NUMBER, before, after, out);
        return;
    }
    after->state = m->state[l];
    after->axis[0] = m->axis[0][l];
    after->axis[1] = m->axis[1][l];
    after->plastic = before->plastic + m->plastic[l];
    after->slip = before->slip + m->friction[l];
    for (k = 0; k < 3; k++) {
        out->force_i[k] = m->force[k][l];
        out->force_j[k] = -m->force[k][l];
        out->torque_i[k] = -m->arm_i[l] * m->lever[k][l];
        out->torque_j[k] = -m->arm_j[l] * m->lever[k][l];
    }
    out->f_n = m->f_n[l];
    out->f_t = m->size[l];
    out->overlap = m->overlap[l];
    out->stored = m->stored[l];
    out->damped = m->damped[l];
    out->parted = ASPERITY_R(0.0);
    out->flags = (m->pressed[l] > ASPERITY_R(0.0) ? ASPERITY_TOUCHES : 0) | (m->unsolved[l] > ASPERITY_R(0.0) ? ASPERITY_UNSOLVED : 0) | (asperity_out_of_range(law->table, &m->state[l]) ? ASPERITY_OUT_OF_RANGE : 0);
    for (k = 0; turning && k < 3; k++) {
        asperity_real moment = m->moments[l].m_roll[0] * m->e1[k][l] + m->moments[l].m_roll[1] * m->e2[k][l] + m->moments[l].m_twist * m->n[k][l];
        out->torque_i[k] -= moment;
        out->torque_j[k] += moment;
    }
    if (cohesion) {
        out->stored += m->pull[l].stored / share;
        out->parted = m->pull[l].lost / share;
        out->flags |= m->joined[l].joined > ASPERITY_R(0.0) ? ASPERITY_HOLDS : 0;
        after->slip += m->pull[l].slip / share;
        *cohesion = m->joined[l];
    }
}

/* Two spheres that meet. `after` may be `before`; turning and cohesion change in place, and are NULL where they are left out. */
typedef struct asperity_pair {
    const asperity_body *i, *j;
    const asperity_contact *before;
    asperity_contact *after;
    asperity_turning *turning;
    asperity_cohesion *cohesion;
    asperity_forces out;
} asperity_pair;

/* The flag of a pair that has no answer, or 0. */
ASPERITY_FN int asperity_unanswered(const asperity_law3d *law, asperity_real distance) {
    return law->table->plane ? ASPERITY_WRONG_TABLE : !asperity_is_finite(distance) || !(distance > ASPERITY_R(0.0)) ? ASPERITY_NO_NUMBER : 0;
}

#include "asperity_many.h"

/* Two spheres of one material that hold each other by cohesion and, unless `turning` is NULL, twist and roll. What is after may be what is before, and they must be kept or dropped
 * together. */
ASPERITY_FN void asperity_spheres_cohesive(
    const asperity_law3d *law, const asperity_body *i, const asperity_body *j, asperity_real dt, const asperity_contact *before, asperity_contact *after,
    const asperity_turning *turning, asperity_turning *turning_after, const asperity_cohesion *cohesion, asperity_cohesion *cohesion_after, asperity_forces *out) {
    asperity_block m;
    int flag;
    asperity_load_pair(i, j, 0, &m);
    m.axis[0][0] = before->axis[0];
    m.axis[1][0] = before->axis[1];
    asperity_kinematics(law, 1, &m);
    flag = asperity_unanswered(law, m.size[0]);
    if (flag) {
        asperity_no_answer(flag, before, after, out);
        return;
    }
    asperity_increments(law, dt, 1, turning != NULL, &m);
    asperity_update_lane(law, &before->state, turning, turning_after, cohesion, 0, &m);
    asperity_block_forces(law, dt, 1, cohesion != NULL, &m);
    asperity_store_lane(law, before, after, turning != NULL, cohesion ? cohesion_after : NULL, 0, &m, out);
}

/* Two spheres of one material that twist and roll on each other. */
ASPERITY_FN void asperity_spheres_turning(
    const asperity_law3d *law, const asperity_body *i, const asperity_body *j, asperity_real dt, const asperity_contact *before, asperity_contact *after,
    const asperity_turning *turning, asperity_turning *turning_after, asperity_forces *out) {
    asperity_spheres_cohesive(law, i, j, dt, before, after, turning, turning_after, NULL, NULL, out);
}

/* Two spheres of one material. `after` may be `before`. */
ASPERITY_FN void asperity_spheres(
    const asperity_law3d *law, const asperity_body *i, const asperity_body *j, asperity_real dt, const asperity_contact *before, asperity_contact *after,
    asperity_forces *out) {
    asperity_spheres_turning(law, i, j, dt, before, after, NULL, NULL, out);
}

/* A sphere that holds to a rigid plane by cohesion and, unless `turning` is NULL, twists and rolls on it; force_j and torque_j are those on the wall, about the point of contact. */
ASPERITY_FN void asperity_sphere_wall_cohesive(
    const asperity_law3d *law, const asperity_body *i, const asperity_wall *wall, asperity_real dt, const asperity_contact *before, asperity_contact *after,
    const asperity_turning *turning, asperity_turning *turning_after, const asperity_cohesion *cohesion, asperity_cohesion *cohesion_after, asperity_forces *out) {
    asperity_real across_i[3], across_wall[3], from[3], distance, arm;
    asperity_block m;
    int k;
    if (!law->table->plane) {
        asperity_no_answer(ASPERITY_WRONG_TABLE, before, after, out);
        return;
    }
    for (k = 0; k < 3; k++) {
        from[k] = i->position[k] - wall->point[k];
    }
    distance = asperity_dot(from, wall->normal);
    arm = distance < i->radius ? distance : i->radius;
    for (k = 0; k < 3; k++) {
        from[k] -= arm * wall->normal[k];
    }
    asperity_cross(i->spin, wall->normal, across_i);
    asperity_cross(wall->spin, from, across_wall);
    for (k = 0; k < 3; k++) {
        m.n[k][0] = wall->normal[k];
        m.v[k][0] = i->velocity[k] - arm * across_i[k] - wall->velocity[k] - across_wall[k];
        m.spin_i[k][0] = i->spin[k];
        m.spin_j[k][0] = wall->spin[k];
    }
    m.axis[0][0] = before->axis[0];
    m.axis[1][0] = before->axis[1];
    m.radius[0] = i->radius / law->table->effective_radius;
    m.mass[0] = asperity_damped_mass(i->mass);
    m.overlap[0] = i->radius - distance;
    m.arm_i[0] = arm;
    m.arm_j[0] = ASPERITY_R(0.0);
    asperity_increments(law, dt, 1, turning != NULL, &m);
    asperity_update_lane(law, &before->state, turning, turning_after, cohesion, 0, &m);
    asperity_block_forces(law, dt, 1, cohesion != NULL, &m);
    asperity_store_lane(law, before, after, turning != NULL, cohesion ? cohesion_after : NULL, 0, &m, out);
}

/* A sphere that twists and rolls on a rigid plane. */
ASPERITY_FN void asperity_sphere_wall_turning(
    const asperity_law3d *law, const asperity_body *i, const asperity_wall *wall, asperity_real dt, const asperity_contact *before, asperity_contact *after,
    const asperity_turning *turning, asperity_turning *turning_after, asperity_forces *out) {
    asperity_sphere_wall_cohesive(law, i, wall, dt, before, after, turning, turning_after, NULL, NULL, out);
}

/* A sphere on a rigid plane. */
ASPERITY_FN void asperity_sphere_wall(
    const asperity_law3d *law, const asperity_body *i, const asperity_wall *wall, asperity_real dt, const asperity_contact *before, asperity_contact *after,
    asperity_forces *out) {
    asperity_sphere_wall_turning(law, i, wall, dt, before, after, NULL, NULL, out);
}

#endif
