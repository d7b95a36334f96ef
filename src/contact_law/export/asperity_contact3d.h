/* asperity_contact3d.h: two spheres, or a sphere and a plane wall, in three dimensions: what an engine wraps round the update of asperity_contact.h.
 *
 * Once, for each pair of materials and for each material and wall; what does not fit together is refused here, with a code (ASPERITY_LAW_...):
 *     asperity_pair_law(&law, &table, E, restitution) != 0 || asperity_wall_law(&wall_law, &wall_table, E, restitution) != 0
 * A contact's memory is one asperity_contact: 36 numbers, all zero before first contact; copy it, write it to a restart file as it is, with asperity_fingerprint(&table) beside it.
 * Each step, for each pair that is kept:
 *     asperity_spheres(&law, &i, &j, dt, &contact, &contact, &out);
 * and add out.force_i, out.torque_i, out.force_j, out.torque_j. With `wall` in place of j: asperity_sphere_wall(). dt = 0 asks for the forces alone, at the same place.
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

#include "asperity_cohesion.h"
#include "asperity_turning.h"

#define ASPERITY_TOGETHER 8 /* contacts that asperity_spheres_many() takes in one go */

/* Flags of asperity_forces. */
enum {
    ASPERITY_TOUCHES = 1,
    ASPERITY_OUT_OF_RANGE = 2, /* has been deeper than the law was made for */
    ASPERITY_WRONG_TABLE = 4,  /* a wall's table between spheres, or a pair's at a wall: no forces */
    ASPERITY_NO_NUMBER = 8,    /* the centres coincide, or something is no number: no forces */
    ASPERITY_HOLDS = 16        /* the surfaces hold each other by cohesion */
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

/* The memory of a contact: lengths over R, work in the engine's units. */
typedef struct asperity_contact {
    asperity_state state;
    asperity_real axis[2]; /* e1, packed */
    asperity_real plastic; /* work dissipated since first contact: by plastic flow, */
    asperity_real slip;    /* by slip */
} asperity_contact;

typedef struct asperity_forces {
    asperity_real force_i[3], torque_i[3], force_j[3], torque_j[3];
    asperity_real f_n, f_t, overlap;
    asperity_real stored; /* elastic energy; with cohesion also that, which is negative */
    asperity_real damped; /* work that the damping has taken in this step */
    asperity_real parted; /* work that cohesion has dissipated in this step, as surfaces met, parted or were flattened */
    int flags;
} asperity_forces;

ASPERITY_FN asperity_real asperity_dot(const asperity_real a[3], const asperity_real b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

ASPERITY_FN void asperity_cross(const asperity_real a[3], const asperity_real b[3], asperity_real c[3]) {
    asperity_real c0 = a[1] * b[2] - a[2] * b[1], c1 = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
    c[0] = c0;
    c[1] = c1;
}

/* A direction as two numbers: the octahedron |x| + |y| + |z| = 1, its lower half folded out. (0, 0) is the direction z. */
ASPERITY_FN void asperity_pack(const asperity_real v[3], asperity_real packed[2]) {
    asperity_real one = ASPERITY_R(1.0), inverse = one / (ASPERITY_ABS(v[0]) + ASPERITY_ABS(v[1]) + ASPERITY_ABS(v[2])), p = v[0] * inverse, q = v[1] * inverse;
    packed[0] = v[2] < ASPERITY_R(0.0) ? (one - ASPERITY_ABS(q)) * (p < ASPERITY_R(0.0) ? -one : one) : p;
    packed[1] = v[2] < ASPERITY_R(0.0) ? (one - ASPERITY_ABS(p)) * (q < ASPERITY_R(0.0) ? -one : one) : q;
}

/* The direction, of any length. */
ASPERITY_FN void asperity_unpack(const asperity_real packed[2], asperity_real v[3]) {
    asperity_real one = ASPERITY_R(1.0), p = packed[0], q = packed[1];
    v[2] = one - ASPERITY_ABS(p) - ASPERITY_ABS(q);
    v[0] = v[2] < ASPERITY_R(0.0) ? (one - ASPERITY_ABS(q)) * (p < ASPERITY_R(0.0) ? -one : one) : p;
    v[1] = v[2] < ASPERITY_R(0.0) ? (one - ASPERITY_ABS(p)) * (q < ASPERITY_R(0.0) ? -one : one) : q;
}

/* Carries the frame of a contact into the step: e1 turned by spin dt and laid into the plane across n. */
ASPERITY_FN void asperity_carry(asperity_real axis[2], const asperity_real spin[3], asperity_real dt, const asperity_real n[3], asperity_real e1[3], asperity_real e2[3]) {
    asperity_real v[3], turn[3], once[3], twice[3], angle2 = ASPERITY_R(0.0), s, c, along, size;
    int k;
    asperity_unpack(axis, v);
    for (k = 0; k < 3; k++) {
        turn[k] = spin[k] * dt;
        angle2 += turn[k] * turn[k];
    }
    /* Rodrigues; (sin a)/a and (1 - cos a)/a^2 by their series while the angle of a step is small. */
    if (angle2 < ASPERITY_R(1e-4)) {
        s = ASPERITY_R(1.0) - angle2 / ASPERITY_R(6.0) * (ASPERITY_R(1.0) - angle2 / ASPERITY_R(20.0) * (ASPERITY_R(1.0) - angle2 / ASPERITY_R(42.0)));
        c = ASPERITY_R(0.5) - angle2 / ASPERITY_R(24.0) * (ASPERITY_R(1.0) - angle2 / ASPERITY_R(30.0) * (ASPERITY_R(1.0) - angle2 / ASPERITY_R(56.0)));
    } else {
        asperity_real angle = ASPERITY_SQRT(angle2);
        s = ASPERITY_SIN(angle) / angle;
        c = (ASPERITY_R(1.0) - ASPERITY_COS(angle)) / angle2;
    }
    asperity_cross(turn, v, once);
    asperity_cross(turn, once, twice);
    for (k = 0; k < 3; k++) {
        v[k] += s * once[k] + c * twice[k];
    }
    along = asperity_dot(v, n);
    for (k = 0; k < 3; k++) {
        e1[k] = v[k] - along * n[k];
    }
    size = ASPERITY_SQRT(asperity_dot(e1, e1));
    if (!(size > ASPERITY_R(1e-3) * ASPERITY_SQRT(asperity_dot(v, v)))) {
        /* e1 would be n, as in a fresh contact along z: any other will do. */
        v[0] = ASPERITY_R(1.0);
        v[1] = v[2] = ASPERITY_R(0.0);
        if (ASPERITY_ABS(n[0]) > ASPERITY_R(0.9)) {
            v[0] = ASPERITY_R(0.0);
            v[1] = ASPERITY_R(1.0);
        }
        along = asperity_dot(v, n);
        for (k = 0; k < 3; k++) {
            e1[k] = v[k] - along * n[k];
        }
        size = ASPERITY_SQRT(asperity_dot(e1, e1));
    }
    for (k = 0; k < 3; k++) {
        e1[k] /= size;
    }
    asperity_cross(n, e1, e2);
    asperity_pack(e1, axis);
}

/* The memory as the other particle has it, where an engine has exchanged i and j: n, and with it e2, turns round and so do displacements. */
ASPERITY_FN void asperity_exchange(asperity_contact *contact) {
    int k;
    contact->state.vertex[0] = -contact->state.vertex[0];
    for (k = 0; k < ASPERITY_SLIDERS; k++) {
        contact->state.slider[0][k] = -contact->state.slider[0][k];
    }
}

/* The same of the memory of twist and roll. */
ASPERITY_FN void asperity_exchange_turning(asperity_turning *turning) {
    int j, k;
    for (k = 0; k < ASPERITY_SLIDERS; k++) {
        for (j = 0; j < ASPERITY_SECTORS; j++) {
            turning->sector[j][0][k] = -turning->sector[j][0][k];
        }
        for (j = 0; j < 2; j++) { /* those on the second axis change places */
            asperity_real kept = turning->sector[1][j][k];
            turning->sector[1][j][k] = turning->sector[3][j][k];
            turning->sector[3][j][k] = kept;
        }
    }
    turning->moment[0] = -turning->moment[0];
}

/* Whether a contact's memory may go: it never touched, or the gap is wider than the dent is deep, so that a next contact lands elsewhere. */
ASPERITY_FN int asperity_may_forget(const asperity_contact *contact) {
    return contact->state.h < ASPERITY_R(0.0) && -contact->state.h >= contact->state.h_max;
}

/* The memory of cohesion as the other particle has it. */
ASPERITY_FN void asperity_exchange_cohesion(asperity_cohesion *cohesion) {
    cohesion->slider[0] = -cohesion->slider[0];
}

/* Whether both memories may go. */
ASPERITY_FN int asperity_may_forget_cohesive(const asperity_contact *contact, const asperity_cohesion *cohesion) {
    return asperity_may_forget(contact) && cohesion->joined == ASPERITY_R(0.0);
}

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

/* A contact in a step: what it sees of its bodies, and the answer of the update. */
typedef struct asperity_meeting {
    asperity_real radius, mass, overlap, arm_i, arm_j; /* radius: of the table's sphere */
    asperity_real n[3], v[3], spin[3], turns[3];       /* n from j to i; v of i's point of contact relative to j's; turns: spin of i relative to j */
    asperity_real e1[3], e2[3], axis[2], along[2], d[2], turn[3]; /* frame; v along the plane; increments of the update */
    asperity_state state; /* after the update */
    asperity_cohesion joined;
    asperity_response answer;
    asperity_moments moments;
    asperity_attraction pull;
} asperity_meeting;

/* Normal, lever arms and relative velocity of two spheres; the flag of what has no answer, or 0. */
ASPERITY_FN int asperity_meet_sphere(const asperity_law3d *law, const asperity_body *i, const asperity_body *j, asperity_meeting *m) {
    asperity_real across_i[3], across_j[3], distance;
    int k;
    if (law->table->plane) {
        return ASPERITY_WRONG_TABLE;
    }
    for (k = 0; k < 3; k++) {
        m->n[k] = i->position[k] - j->position[k];
        m->spin[k] = ASPERITY_R(0.5) * (i->spin[k] + j->spin[k]);
        m->turns[k] = i->spin[k] - j->spin[k];
    }
    distance = ASPERITY_SQRT(asperity_dot(m->n, m->n));
    if (!asperity_is_finite(distance) || !(distance > ASPERITY_R(0.0))) {
        return ASPERITY_NO_NUMBER;
    }
    m->overlap = i->radius + j->radius - distance;
    m->arm_i = i->radius - ASPERITY_R(0.5) * m->overlap;
    m->arm_j = j->radius - ASPERITY_R(0.5) * m->overlap;
    m->radius = asperity_table_radius(law->table, i->radius * j->radius / (i->radius + j->radius));
    m->mass = asperity_effective_mass(i->mass, j->mass);
    for (k = 0; k < 3; k++) {
        m->n[k] /= distance;
    }
    asperity_cross(i->spin, m->n, across_i);
    asperity_cross(j->spin, m->n, across_j);
    for (k = 0; k < 3; k++) {
        m->v[k] = i->velocity[k] - j->velocity[k] - m->arm_i * across_i[k] - m->arm_j * across_j[k];
    }
    return 0;
}

/* Before the update: the frame, and what the points of contact move by in it. */
ASPERITY_FN void asperity_set_out(const asperity_law3d *law, asperity_real dt, const asperity_contact *before, int turning, asperity_meeting *m) {
    asperity_real share = law->table->share;
    m->axis[0] = before->axis[0];
    m->axis[1] = before->axis[1];
    asperity_carry(m->axis, m->spin, dt, m->n, m->e1, m->e2);
    m->along[0] = asperity_dot(m->v, m->e1);
    m->along[1] = asperity_dot(m->v, m->e2);
    m->d[0] = share * m->along[0] * dt;
    m->d[1] = share * m->along[1] * dt;
    if (turning) {
        m->turn[0] = share * asperity_dot(m->turns, m->e1) * dt;
        m->turn[1] = share * asperity_dot(m->turns, m->e2) * dt;
        m->turn[2] = share * asperity_dot(m->turns, m->n) * dt;
    }
}

/* The update. `turning` is NULL where twist and roll are left out, `cohesion` where that is. */
ASPERITY_FN void asperity_press(
    const asperity_law3d *law, const asperity_contact *before, const asperity_turning *turning, asperity_turning *turning_after, const asperity_cohesion *cohesion,
    asperity_meeting *m) {
    asperity_real h = law->table->share * m->overlap;
    if (turning) {
        asperity_update_turning(law->table, m->radius, law->modulus, &before->state, turning, h, m->d, m->turn, &m->state, turning_after, &m->answer, &m->moments, NULL);
    } else {
        asperity_update(law->table, m->radius, law->modulus, &before->state, h, m->d, &m->state, &m->answer, NULL);
    }
    if (cohesion) {
        asperity_cohere(&law->cohesion, law->table, m->radius, law->modulus, &before->state, &m->state, cohesion, m->d, &m->joined, &m->pull);
    }
}

/* The share of the dashpot, and what it takes; F_N with it. */
ASPERITY_FN asperity_real asperity_damp(const asperity_law3d *law, asperity_real dt, asperity_meeting *m, asperity_forces *out) {
    asperity_real f_n = m->answer.f_n, approaching = -asperity_dot(m->v, m->n), factor, dashpot, d[2];
    if (!(f_n > ASPERITY_R(0.0)) || !(law->damping > ASPERITY_R(0.0))) {
        return f_n;
    }
    factor = law->damping * ASPERITY_SQRT(m->mass * m->answer.stiffness * law->table->share);
    dashpot = factor * approaching;
    dashpot = dashpot < -f_n ? -f_n : dashpot; /* never a pull */
    out->damped = dashpot * approaching * dt;
    f_n += dashpot;
    if (law->tangential > ASPERITY_R(0.0)) {
        d[0] = law->tangential * factor * m->along[0];
        d[1] = law->tangential * factor * m->along[1];
        factor = asperity_allowed(m->answer.f_t, d, law->table->friction * (f_n < m->answer.f_n ? f_n : m->answer.f_n));
        m->answer.f_t[0] += factor * d[0];
        m->answer.f_t[1] += factor * d[1];
        out->damped += factor * (d[0] * m->along[0] + d[1] * m->along[1]) * dt;
    }
    return f_n;
}

/* After the update: forces, and the memories. */
ASPERITY_FN void asperity_settle(
    const asperity_law3d *law, asperity_real dt, const asperity_contact *before, asperity_contact *after, int turning, asperity_cohesion *cohesion_after, asperity_meeting *m,
    asperity_forces *out) {
    asperity_real share = law->table->share, tangential[3], lever[3], plastic, slip, f_n, touches;
    int k;
    if (cohesion_after && !asperity_is_finite(m->pull.f_n)) {
        m->answer.f_n = m->pull.f_n;
    }
    if (!asperity_is_finite(m->answer.f_n) || !asperity_is_finite(m->answer.f_t[0] + m->answer.f_t[1])) {
        asperity_no_answer(ASPERITY_NO_NUMBER, before, after, out);
        return;
    }
    /* The law's work is that of h and d: of what the centres move, `share`. */
    plastic = before->plastic + m->answer.plastic / share;
    slip = before->slip + (turning ? m->answer.friction + m->moments.lost : m->answer.friction) / share;
    out->overlap = m->overlap;
    out->stored = (turning ? m->answer.stored + m->moments.stored : m->answer.stored) / share;
    out->damped = out->parted = ASPERITY_R(0.0);
    touches = m->answer.f_n;
    f_n = asperity_damp(law, dt, m, out);
    if (cohesion_after) {
        f_n += m->pull.f_n;
        m->answer.f_t[0] += m->pull.f_t[0];
        m->answer.f_t[1] += m->pull.f_t[1];
        slip += m->pull.slip / share;
        out->stored += m->pull.stored / share;
        out->parted = m->pull.lost / share;
    }
    out->f_n = f_n;
    out->f_t = ASPERITY_SQRT(m->answer.f_t[0] * m->answer.f_t[0] + m->answer.f_t[1] * m->answer.f_t[1]);
    out->flags = (touches > ASPERITY_R(0.0) ? ASPERITY_TOUCHES : 0) | (asperity_out_of_range(law->table, &m->state) ? ASPERITY_OUT_OF_RANGE : 0) |
                 (cohesion_after && m->joined.joined > ASPERITY_R(0.0) ? ASPERITY_HOLDS : 0);
    for (k = 0; k < 3; k++) {
        tangential[k] = -(m->answer.f_t[0] * m->e1[k] + m->answer.f_t[1] * m->e2[k]);
        out->force_i[k] = f_n * m->n[k] + tangential[k];
        out->force_j[k] = -out->force_i[k];
    }
    asperity_cross(m->n, tangential, lever);
    for (k = 0; k < 3; k++) {
        out->torque_i[k] = -m->arm_i * lever[k];
        out->torque_j[k] = -m->arm_j * lever[k];
        if (turning) {
            asperity_real moment = m->moments.m_roll[0] * m->e1[k] + m->moments.m_roll[1] * m->e2[k] + m->moments.m_twist * m->n[k];
            out->torque_i[k] -= moment;
            out->torque_j[k] += moment;
        }
    }
    after->state = m->state;
    after->axis[0] = m->axis[0];
    after->axis[1] = m->axis[1];
    after->plastic = plastic;
    after->slip = slip;
    if (cohesion_after) {
        *cohesion_after = m->joined;
    }
}

/* Two spheres of one material that hold each other by cohesion and, unless `turning` is NULL, twist and roll. What is after may be what is before, and they must be kept or dropped
 * together. */
ASPERITY_FN void asperity_spheres_cohesive(
    const asperity_law3d *law, const asperity_body *i, const asperity_body *j, asperity_real dt, const asperity_contact *before, asperity_contact *after,
    const asperity_turning *turning, asperity_turning *turning_after, const asperity_cohesion *cohesion, asperity_cohesion *cohesion_after, asperity_forces *out) {
    asperity_meeting m;
    int flag = asperity_meet_sphere(law, i, j, &m);
    if (flag) {
        asperity_no_answer(flag, before, after, out);
        return;
    }
    asperity_set_out(law, dt, before, turning != NULL, &m);
    asperity_press(law, before, turning, turning_after, cohesion, &m);
    asperity_settle(law, dt, before, after, turning != NULL, cohesion ? cohesion_after : NULL, &m, out);
}

/* Two spheres that meet, for asperity_spheres_many(). `after` may be `before`; turning and cohesion change in place, and are NULL where they are left out. */
typedef struct asperity_pair {
    const asperity_body *i, *j;
    const asperity_contact *before;
    asperity_contact *after;
    asperity_turning *turning;
    asperity_cohesion *cohesion;
    asperity_forces out;
} asperity_pair;

/* Many pairs of one law, each by itself. No two share a memory. */
ASPERITY_FN void asperity_spheres_many(const asperity_law3d *law, asperity_real dt, int count, asperity_pair *pairs) {
    asperity_meeting meetings[ASPERITY_TOGETHER];
    int flags[ASPERITY_TOGETHER], first, k;
    for (first = 0; first < count; first += ASPERITY_TOGETHER) {
        int size = count - first < ASPERITY_TOGETHER ? count - first : ASPERITY_TOGETHER;
        asperity_pair *some = pairs + first;
        for (k = 0; k < size; k++) {
            flags[k] = asperity_meet_sphere(law, some[k].i, some[k].j, &meetings[k]);
            if (!flags[k]) {
                asperity_set_out(law, dt, some[k].before, some[k].turning != NULL, &meetings[k]);
            }
        }
        for (k = 0; k < size; k++) {
            if (!flags[k]) {
                asperity_press(law, some[k].before, some[k].turning, some[k].turning, some[k].cohesion, &meetings[k]);
            }
        }
        for (k = 0; k < size; k++) {
            if (flags[k]) {
                asperity_no_answer(flags[k], some[k].before, some[k].after, &some[k].out);
            } else {
                asperity_settle(law, dt, some[k].before, some[k].after, some[k].turning != NULL, some[k].cohesion, &meetings[k], &some[k].out);
            }
        }
    }
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
    asperity_meeting m;
    int k;
    if (!law->table->plane) {
        asperity_no_answer(ASPERITY_WRONG_TABLE, before, after, out);
        return;
    }
    for (k = 0; k < 3; k++) {
        m.n[k] = wall->normal[k];
        from[k] = i->position[k] - wall->point[k];
        m.spin[k] = ASPERITY_R(0.5) * (i->spin[k] + wall->spin[k]);
        m.turns[k] = i->spin[k] - wall->spin[k];
    }
    distance = asperity_dot(from, m.n);
    arm = distance < i->radius ? distance : i->radius;
    for (k = 0; k < 3; k++) {
        from[k] -= arm * m.n[k];
    }
    asperity_cross(i->spin, m.n, across_i);
    asperity_cross(wall->spin, from, across_wall);
    for (k = 0; k < 3; k++) {
        m.v[k] = i->velocity[k] - arm * across_i[k] - wall->velocity[k] - across_wall[k];
    }
    m.radius = i->radius / law->table->effective_radius;
    m.mass = asperity_damped_mass(i->mass);
    m.overlap = i->radius - distance;
    m.arm_i = arm;
    m.arm_j = ASPERITY_R(0.0);
    asperity_set_out(law, dt, before, turning != NULL, &m);
    asperity_press(law, before, turning, turning_after, cohesion, &m);
    asperity_settle(law, dt, before, after, turning != NULL, cohesion ? cohesion_after : NULL, &m, out);
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
