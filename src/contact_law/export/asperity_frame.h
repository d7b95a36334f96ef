/* asperity_frame.h: the memory of a contact in three dimensions, and its tangent frame, which turns with the two bodies. */
#ifndef ASPERITY_FRAME_H
#define ASPERITY_FRAME_H

#include "asperity_cohesion.h"
#include "asperity_turning.h"

/* The memory of a contact: lengths over R, work in the engine's units. */
typedef struct asperity_contact {
    asperity_state state;
    asperity_real axis[2]; /* e1, packed */
    asperity_real plastic; /* work dissipated since first contact: by plastic flow, */
    asperity_real slip;    /* by slip */
} asperity_contact;

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

/* Of a function that is to become lanes of the loop in which it stands. */
#if defined(__GNUC__) && !defined(__CUDACC__)
#define ASPERITY_INLINE static inline __attribute__((always_inline))
#else
#define ASPERITY_INLINE ASPERITY_FN
#endif

/* Contacts whose geometry is in lanes, and how many such blocks asperity_spheres_many() takes in one go; a thread of a GPU has one contact. */
#ifdef __CUDACC__
#define ASPERITY_TOGETHER 1
#define ASPERITY_BLOCKS 1
#else
#define ASPERITY_TOGETHER 8
#define ASPERITY_BLOCKS 16
#endif

typedef asperity_real asperity_lanes[ASPERITY_TOGETHER];

/* A vector out of a lane and into it. */
ASPERITY_INLINE void asperity_of_lane(asperity_lanes from[3], int l, asperity_real to[3]) {
    to[0] = from[0][l];
    to[1] = from[1][l];
    to[2] = from[2][l];
}

ASPERITY_INLINE void asperity_into_lane(const asperity_real from[3], int l, asperity_lanes to[3]) {
    to[0][l] = from[0];
    to[1][l] = from[1];
    to[2][l] = from[2];
}

ASPERITY_INLINE asperity_real asperity_dot(const asperity_real a[3], const asperity_real b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

ASPERITY_INLINE void asperity_cross(const asperity_real a[3], const asperity_real b[3], asperity_real c[3]) {
    asperity_real c0 = a[1] * b[2] - a[2] * b[1], c1 = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
    c[0] = c0;
    c[1] = c1;
}

/* A direction as two numbers: the octahedron |x| + |y| + |z| = 1, its lower half folded out. (0, 0) is the direction z. */
ASPERITY_INLINE void asperity_pack(const asperity_real v[3], asperity_real packed[2]) {
    asperity_real one = ASPERITY_R(1.0), inverse = one / (ASPERITY_ABS(v[0]) + ASPERITY_ABS(v[1]) + ASPERITY_ABS(v[2])), p = v[0] * inverse, q = v[1] * inverse;
    packed[0] = v[2] < ASPERITY_R(0.0) ? (one - ASPERITY_ABS(q)) * (p < ASPERITY_R(0.0) ? -one : one) : p;
    packed[1] = v[2] < ASPERITY_R(0.0) ? (one - ASPERITY_ABS(p)) * (q < ASPERITY_R(0.0) ? -one : one) : q;
}

/* The direction, of any length. */
ASPERITY_INLINE void asperity_unpack(const asperity_real packed[2], asperity_real v[3]) {
    asperity_real one = ASPERITY_R(1.0), p = packed[0], q = packed[1];
    v[2] = one - ASPERITY_ABS(p) - ASPERITY_ABS(q);
    v[0] = v[2] < ASPERITY_R(0.0) ? (one - ASPERITY_ABS(q)) * (p < ASPERITY_R(0.0) ? -one : one) : p;
    v[1] = v[2] < ASPERITY_R(0.0) ? (one - ASPERITY_ABS(p)) * (q < ASPERITY_R(0.0) ? -one : one) : q;
}

/* What carries the frame of a contact: e1 turned by `turn`, a spin times dt, where s and c are (sin a)/a and (1 - cos a)/a^2 of its angle (Rodrigues), and laid into the plane
 * across n. Whether it has a length there. */
ASPERITY_INLINE int asperity_lay(
    const asperity_real packed[2], const asperity_real turn[3], asperity_real s, asperity_real c, const asperity_real n[3], asperity_real e1[3], asperity_real *size) {
    asperity_real v[3], once[3], twice[3], along;
    asperity_unpack(packed, v);
    asperity_cross(turn, v, once);
    asperity_cross(turn, once, twice);
    v[0] += s * once[0] + c * twice[0];
    v[1] += s * once[1] + c * twice[1];
    v[2] += s * once[2] + c * twice[2];
    along = asperity_dot(v, n);
    e1[0] = v[0] - along * n[0];
    e1[1] = v[1] - along * n[1];
    e1[2] = v[2] - along * n[2];
    *size = ASPERITY_SQRT(asperity_dot(e1, e1));
    return *size > ASPERITY_R(1e-3) * ASPERITY_SQRT(asperity_dot(v, v));
}

/* s and c of a small angle, by their series. */
ASPERITY_INLINE void asperity_small_turn(asperity_real angle2, asperity_real *s, asperity_real *c) {
    *s = ASPERITY_R(1.0) - angle2 / ASPERITY_R(6.0) * (ASPERITY_R(1.0) - angle2 / ASPERITY_R(20.0) * (ASPERITY_R(1.0) - angle2 / ASPERITY_R(42.0)));
    *c = ASPERITY_R(0.5) - angle2 / ASPERITY_R(24.0) * (ASPERITY_R(1.0) - angle2 / ASPERITY_R(30.0) * (ASPERITY_R(1.0) - angle2 / ASPERITY_R(56.0)));
}
#define ASPERITY_SMALL_TURN 1e-4 /* its square */

/* e1 made a unit, and e2 and the memory from it. */
ASPERITY_INLINE void asperity_complete(const asperity_real n[3], asperity_real size, asperity_real e1[3], asperity_real e2[3], asperity_real axis[2]) {
    e1[0] /= size;
    e1[1] /= size;
    e1[2] /= size;
    asperity_cross(n, e1, e2);
    asperity_pack(e1, axis);
}

/* Carries the frame of a contact into the step, whatever it is. */
ASPERITY_FN void asperity_carry(asperity_real axis[2], const asperity_real turn[3], const asperity_real n[3], asperity_real e1[3], asperity_real e2[3]) {
    asperity_real angle2 = asperity_dot(turn, turn), s, c, along, size, v[3];
    int k;
    if (angle2 < ASPERITY_R(ASPERITY_SMALL_TURN)) {
        asperity_small_turn(angle2, &s, &c);
    } else {
        asperity_real angle = ASPERITY_SQRT(angle2);
        s = ASPERITY_SIN(angle) / angle;
        c = (ASPERITY_R(1.0) - ASPERITY_COS(angle)) / angle2;
    }
    if (!asperity_lay(axis, turn, s, c, n, e1, &size)) {
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
    asperity_complete(n, size, e1, e2, axis);
}

#endif
