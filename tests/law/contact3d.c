/* Holds asperity_contact3d.h to what it promises, with the law in asperity_law.h. Prints what it measures; exits 0 if all is within bounds. */
#include "asperity_law.h"
#include "asperity_contact3d.h"

#include <stdlib.h>

static int failures = 0;
static asperity_table pair_table;
static unsigned long long seed = 1;

static double uniform(double from, double to) {
    seed = seed * 6364136223846793005ull + 1442695040888963407ull;
    return from + (to - from) * (double)(seed >> 11) / 9007199254740992.0;
}

static void expect(int good, const char *what, double value) {
    printf("%-70s %.3g%s\n", what, value, good ? "" : "   FAILED");
    failures += !good;
}

/* Turns v by the rotation vector w. */
static void rotate(const double w[3], const double v[3], double out[3]) {
    double a = sqrt(asperity_dot(w, w)), once[3], twice[3];
    int k;
    asperity_cross(w, v, once);
    asperity_cross(w, once, twice);
    for (k = 0; k < 3; k++) {
        out[k] = v[k] + (a > 0.0 ? sin(a) / a * once[k] + (1.0 - cos(a)) / (a * a) * twice[k] : 0.0);
    }
}

static double length(const double v[3]) { return sqrt(asperity_dot(v, v)); }

/* Presses i onto j (at the origin, or a wall there) and slides it, in the frame given by its axes. */
static void load(const asperity_law3d *law, int wall, asperity_contact *c, asperity_forces *out, asperity_body *i, asperity_body *j) {
    asperity_wall plane = {{0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
    const double dt = 1e-3;
    int step;
    memset(c, 0, sizeof *c);
    memset(i, 0, sizeof *i);
    memset(j, 0, sizeof *j);
    i->radius = 1.3;
    j->radius = 0.7;
    i->mass = j->mass = 1.0;
    i->position[2] = wall ? i->radius : i->radius + j->radius;
    for (step = 0; step < 400; step++) {
        int k;
        i->velocity[0] = step < 100 ? 0.0 : 0.004;
        i->velocity[1] = step < 200 ? 0.0 : -0.007;
        i->velocity[2] = step < 300 ? -0.05 : 0.01;
        i->spin[1] = step < 250 ? 0.0 : 0.003;
        for (k = 0; k < 3; k++) {
            i->position[k] += i->velocity[k] * dt;
        }
        if (wall) {
            asperity_sphere_wall(law, i, &plane, dt, c, c, out);
        } else {
            asperity_spheres(law, i, j, dt, c, c, out);
        }
    }
}

/* A loaded pair is carried through rigid motions: its forces turn with it and nothing else. */
static void objectivity(const asperity_law3d *law, int wall) {
    double worst = 0.0, worst_energy = 0.0;
    int motion;
    for (motion = 0; motion < 20; motion++) {
        asperity_contact c, start;
        asperity_forces first, out;
        asperity_body i, j;
        asperity_wall plane = {{0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
        double w[3], pull[3], force[3], torque[3], dt = 1e-2;
        int step, k;
        load(law, wall, &c, &first, &i, &j);
        start = c;
        for (k = 0; k < 3; k++) {
            pull[k] = uniform(-3.0, 3.0);
            force[k] = first.force_i[k];
            torque[k] = first.torque_i[k];
        }
        for (step = 0; step < 500; step++) {
            double by[3], v[3], moved[3], error;
            if (step % 50 == 0) {
                for (k = 0; k < 3; k++) {
                    w[k] = uniform(-4.0, 4.0) * (motion == 0 ? (k == 2) : 1.0);
                }
            }
            for (k = 0; k < 3; k++) {
                by[k] = w[k] * dt;
            }
            rotate(by, i.position, moved);
            memcpy(i.position, moved, sizeof moved);
            rotate(by, j.position, moved);
            memcpy(j.position, moved, sizeof moved);
            rotate(by, plane.normal, moved);
            memcpy(plane.normal, moved, sizeof moved);
            rotate(by, force, moved);
            memcpy(force, moved, sizeof moved);
            rotate(by, torque, moved);
            memcpy(torque, moved, sizeof moved);
            asperity_cross(w, i.position, v);
            for (k = 0; k < 3; k++) {
                i.velocity[k] = v[k] + pull[k];
                i.spin[k] = j.spin[k] = plane.spin[k] = w[k];
            }
            asperity_cross(w, j.position, v);
            for (k = 0; k < 3; k++) {
                j.velocity[k] = v[k] + pull[k];
                plane.velocity[k] = pull[k]; /* its point is the origin */
            }
            if (wall) {
                asperity_sphere_wall(law, &i, &plane, dt, &c, &c, &out);
            } else {
                asperity_spheres(law, &i, &j, dt, &c, &c, &out);
            }
            for (k = 0; k < 3; k++) {
                v[k] = out.force_i[k] - force[k];
                moved[k] = out.torque_i[k] - torque[k];
            }
            error = length(v) / length(force) + length(moved) / length(torque);
            worst = error > worst ? error : worst;
        }
        worst_energy = fabs(c.plastic + c.slip - start.plastic - start.slip) / start.plastic;
    }
    expect(worst < 1e-9, wall ? "wall: error of forces after rigid motions" : "pair: error of forces after rigid motions", worst);
    expect(worst_energy < 1e-9, "    work dissipated meanwhile", worst_energy);
}

/* i and j exchanged half-way: the same forces, the other way round. */
static void exchange(const asperity_law3d *law) {
    asperity_contact c, kept;
    asperity_forces one, two;
    asperity_body i, j;
    double worst = 0.0;
    int step, k;
    load(law, 0, &c, &one, &i, &j);
    kept = c;
    asperity_exchange(&kept);
    for (step = 0; step < 100; step++) {
        i.velocity[0] = 0.02;
        i.velocity[2] = step < 50 ? 0.0 : -0.01;
        i.spin[0] = 0.01;
        j.spin[2] = 0.3;
        for (k = 0; k < 3; k++) {
            i.position[k] += 1e-3 * i.velocity[k];
        }
        asperity_spheres(law, &i, &j, 1e-3, &c, &c, &one);
        asperity_spheres(law, &j, &i, 1e-3, &kept, &kept, &two);
        for (k = 0; k < 3; k++) {
            double error = (fabs(one.force_i[k] - two.force_j[k]) + fabs(one.torque_i[k] - two.torque_j[k]) + fabs(one.torque_j[k] - two.torque_i[k])) / length(one.force_i);
            worst = error > worst ? error : worst;
        }
    }
    expect(worst < 1e-12, "exchange of i and j: difference of forces", worst);
}

/* An impact that stays elastic bounces with the coefficient that the damping was made for. */
static void restitution(asperity_law3d law) {
    const double wanted[] = {0.3, 0.6, 0.9, 1.0};
    int w;
    for (w = 0; w < 4; w++) {
        asperity_contact c;
        asperity_forces out;
        asperity_body i;
        asperity_wall plane = {{0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
        double dt, got;
        law.damping = asperity_damping(wanted[w]);
        memset(&c, 0, sizeof c);
        memset(&i, 0, sizeof i);
        i.radius = 1.0;
        i.mass = 1.0;
        i.position[2] = 1.0;
        i.velocity[2] = -2e-7 * sqrt(law.modulus);
        dt = 2e-3 * asperity_time_step(&law, 1.0, 1.0, 4e-6);
        do {
            i.position[2] += i.velocity[2] * dt;
            asperity_sphere_wall(&law, &i, &plane, dt, &c, &c, &out);
            i.velocity[2] += out.force_i[2] / i.mass * dt;
        } while (i.position[2] < 1.0 || i.velocity[2] < 0.0);
        got = i.velocity[2] / (2e-7 * sqrt(law.modulus));
        /* Plastic flow, where the law has it, takes its own share. */
        expect(fabs(got - wanted[w]) < 0.03 && c.plastic < 0.01 * 2e-14 * law.modulus, "restitution coefficient of an elastic impact (0.3, 0.6, 0.9, 1)", got);
    }
}

/* What is done on a sphere is stored, dissipated or still in its motion. */
static void energy(const asperity_law3d *law) {
    asperity_contact c;
    asperity_forces out;
    asperity_body i;
    asperity_wall plane = {{0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
    const double inertia = 0.4;
    double dt = 0.02 * asperity_time_step(law, 1.0, 1.0, 0.0), start, left, half[3];
    int step, k;
    memset(&c, 0, sizeof c);
    memset(&i, 0, sizeof i);
    memset(&out, 0, sizeof out);
    i.radius = i.mass = 1.0;
    i.position[2] = 1.0;
    i.velocity[0] = 0.005 * sqrt(law->modulus);
    i.velocity[2] = -0.008 * sqrt(law->modulus);
    start = 0.5 * asperity_dot(i.velocity, i.velocity);
    for (step = 0; step < 4000; step++) {
        for (k = 0; k < 3; k++) {
            half[k] = i.velocity[k] + 0.5 * dt * out.force_i[k];
            i.spin[k] += 0.5 * dt * out.torque_i[k] / inertia;
            i.position[k] += dt * half[k];
            i.velocity[k] = half[k];
        }
        asperity_sphere_wall(law, &i, &plane, dt, &c, &c, &out);
        for (k = 0; k < 3; k++) {
            i.velocity[k] += 0.5 * dt * out.force_i[k];
            i.spin[k] += 0.5 * dt * out.torque_i[k] / inertia;
        }
    }
    left = 0.5 * asperity_dot(i.velocity, i.velocity) + 0.5 * inertia * asperity_dot(i.spin, i.spin) + out.stored + c.plastic + c.slip;
    expect(out.f_n == 0.0 && i.velocity[2] > 0.0, "oblique impact: normal restitution", i.velocity[2] / (0.008 * sqrt(law->modulus)));
    expect(c.slip > 0.0 && c.plastic > 0.0, "    share of friction in the loss", c.slip / (c.slip + c.plastic));
    expect(fabs(left / start - 1.0) < 1e-3, "    energy that is unaccounted for", left / start - 1.0);
    expect(asperity_may_forget(&c), "    and forgotten once it is far off", -c.state.h / c.state.h_max);
}

/* Many pairs in one call have the forces and memories of each by itself; one whose centres coincide has no answer, and the others do not mind. */
static void many(asperity_law3d law, int turns, double cohesion) {
    enum { PAIRS = 150, LOST = 71 }; /* more than go in one window, and no multiple of the lanes */
    asperity_body bodies[PAIRS][2];
    asperity_contact each[PAIRS], memory[PAIRS], kept;
    asperity_turning each_turning[PAIRS], turning[PAIRS];
    asperity_cohesion each_cohesion[PAIRS], joined[PAIRS];
    asperity_pair pairs[PAIRS];
    double worst = 0.0, apart;
    int k, n, step, lost = 0;
    memset(pairs, 0, sizeof pairs);
    (void)asperity_law_cohesion(&law, cohesion, 0.0);
    memset(each, 0, sizeof each);
    memset(each_turning, 0, sizeof each_turning);
    memset(each_cohesion, 0, sizeof each_cohesion);
    memset(bodies, 0, sizeof bodies);
    memcpy(memory, each, sizeof each);
    memcpy(turning, each_turning, sizeof turning);
    memcpy(joined, each_cohesion, sizeof joined);
    for (n = 0; n < PAIRS; n++) {
        bodies[n][0].radius = uniform(0.5, 1.5);
        bodies[n][1].radius = uniform(0.5, 1.5);
        bodies[n][0].mass = uniform(0.5, 1.5);
        bodies[n][1].mass = n % 5 == 0 ? INFINITY : 1.0;
        for (k = 0; k < 3; k++) {
            bodies[n][0].position[k] = n % 4 == 0 ? (k == 2) : uniform(0.2, 1.0);
            bodies[n][0].spin[k] = n % 3 == 0 ? uniform(-30.0, 30.0) : uniform(-0.01, 0.01);
        }
        apart = n == LOST ? 0.0 : (bodies[n][0].radius + bodies[n][1].radius) * 1.001 / length(bodies[n][0].position);
        for (k = 0; k < 3; k++) {
            bodies[n][0].velocity[k] = -bodies[n][0].position[k] * uniform(0.5, 1.5);
            bodies[n][0].position[k] *= apart;
        }
    }
    for (step = 0; step < 40; step++) {
        for (n = 0; n < PAIRS; n++) {
            asperity_body *i = &bodies[n][0], *j = &bodies[n][1];
            asperity_pair pair = {i, j, &memory[n], &memory[n], turns ? &turning[n] : NULL, cohesion > 0.0 ? &joined[n] : NULL, pairs[n].out};
            for (k = 0; k < 3; k++) {
                i->position[k] += n == LOST ? 0.0 : 1e-3 * i->velocity[k];
            }
            pairs[n] = pair;
        }
        kept = memory[LOST];
        asperity_spheres_many(&law, 1e-3, PAIRS, pairs);
        lost += pairs[LOST].out.flags == ASPERITY_NO_NUMBER && memcmp(&kept, &memory[LOST], sizeof kept) == 0;
        for (n = 0; n < PAIRS; n++) {
            asperity_turning *turned = turns ? &each_turning[n] : NULL;
            asperity_cohesion *holds = cohesion > 0.0 ? &each_cohesion[n] : NULL;
            asperity_forces out;
            asperity_spheres_cohesive(&law, &bodies[n][0], &bodies[n][1], 1e-3, &each[n], &each[n], turned, turned, holds, holds, &out);
            for (k = 0; n != LOST && k < 3; k++) {
                double error = fabs(out.force_i[k] - pairs[n].out.force_i[k]) + fabs(out.torque_j[k] - pairs[n].out.torque_j[k]) + fabs(each[n].state.slider[0][k] - memory[n].state.slider[0][k]);
                worst = error > worst || !(error >= 0.0) ? error : worst;
            }
            worst = n != LOST && out.flags != pairs[n].out.flags ? 1.0 : worst;
        }
    }
    expect(worst < 1e-9 && lost == 40, "many pairs at once: forces against those of each by itself", worst);
}

int main(void) {
    asperity_law3d wall, pair;
    asperity_forces out;
    asperity_contact c;
    asperity_body i, j;
    double packed[2], v[3], back[3], worst = 0.0;
    int k, n;
    pair_table = asperity_law;
    asperity_stand_in(&pair_table);
    expect(asperity_wall_law(&wall, &asperity_law, 70e3, 1.0) == 0 && asperity_pair_law(&pair, &pair_table, 70e3, 1.0) == 0, "laws of a wall and of a pair", 0.0);
    for (n = 0; n < 1000; n++) {
        double size = 0.0;
        for (k = 0; k < 3; k++) {
            v[k] = uniform(-1.0, 1.0);
        }
        size = length(v);
        asperity_pack(v, packed);
        asperity_unpack(packed, back);
        for (k = 0; k < 3; k++) {
            double error = fabs(back[k] / length(back) - v[k] / size);
            worst = error > worst ? error : worst;
        }
    }
    expect(worst < 1e-15, "a direction packed and unpacked", worst);
    expect(sizeof(asperity_contact) == 39 * sizeof(asperity_real), "numbers of a contact", (double)(sizeof(asperity_contact) / sizeof(asperity_real)));
    load(&pair, 0, &c, &out, &i, &j);
    expect((out.flags & ASPERITY_TOUCHES) != 0 && out.f_n > 0.0 && out.f_t > 0.0, "F_T/F_N of a pair", out.f_t / out.f_n);
    objectivity(&pair, 0);
    objectivity(&wall, 1);
    exchange(&pair);
    many(pair, 0, 0.0);
    many(pair, 1, 0.0);
    many(pair, 1, 1e-2);
    restitution(wall);
    energy(&wall);
    return failures != 0;
}
