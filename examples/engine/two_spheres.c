/* Two spheres that collide obliquely, with a computed contact law: all that an engine needs, in sixty lines.
 *     asperity law export fixtures/law/law.json fixtures/cases/ideal.toml --format c --out law
 *     cc -std=c99 -O2 -Ilaw examples/engine/two_spheres.c -o two_spheres -lm && ./two_spheres law/law.asperity */
#include "asperity_contact3d.h"

static double energy(const asperity_body *s, double inertia) {
    return 0.5 * s->mass * asperity_dot(s->velocity, s->velocity) + 0.5 * inertia * asperity_dot(s->spin, s->spin);
}

/* Half a kick, of velocity and spin. */
static void kick(asperity_body *s, double inertia, const double force[3], const double torque[3], double dt) {
    int k;
    for (k = 0; k < 3; k++) {
        s->velocity[k] += 0.5 * dt * force[k] / s->mass;
        s->spin[k] += 0.5 * dt * torque[k] / inertia;
    }
}

int main(int argc, char **argv) {
    static asperity_table table;
    asperity_law3d law;                              /* E in MPa; lengths in mm, so masses in tonnes */
    asperity_body i = {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, 1.0, 3.3e-8}, j = i;
    asperity_contact contact = {0};                  /* all zero: before first contact */
    asperity_forces out = {0};
    double inertia = 0.4 * i.mass * i.radius * i.radius, before, after, dt;
    int step = 0, touched = 0, k, code = asperity_read_table(argc > 1 ? argv[1] : "law.asperity", &table);
    if (code != 0) {
        fprintf(stderr, "no table: code %d\n", code);
        return 2;
    }
    if (table.plane) {
        printf("the table is of a sphere on a plane; it stands in for the pair\n");
        asperity_stand_in(&table);
    }
    if (asperity_pair_law(&law, &table, 200e3, 1.0) != ASPERITY_LAW_FITS) {
        return 2;
    }
    j.position[2] = 2.001;
    j.velocity[0] = 300.0; /* mm/s */
    j.velocity[2] = -1000.0;
    dt = 0.05 * asperity_time_step(&law, i.radius, i.mass, 0.0);
    before = energy(&i, inertia) + energy(&j, inertia);
    while (!(touched && asperity_may_forget(&contact)) && step < 1000000) {
        kick(&i, inertia, out.force_i, out.torque_i, dt);
        kick(&j, inertia, out.force_j, out.torque_j, dt);
        for (k = 0; k < 3; k++) {
            i.position[k] += dt * i.velocity[k];
            j.position[k] += dt * j.velocity[k];
        }
        asperity_spheres(&law, &i, &j, dt, &contact, &contact, &out);
        kick(&i, inertia, out.force_i, out.torque_i, dt);
        kick(&j, inertia, out.force_j, out.torque_j, dt);
        touched |= out.flags & ASPERITY_TOUCHES;
        step++;
    }
    after = energy(&i, inertia) + energy(&j, inertia);
    printf("%d steps of %.3g s; rebound %.1f mm/s, spin %.1f 1/s; deepest h/R %.4f\n", step, dt, j.velocity[2] - i.velocity[2], j.spin[1], contact.state.h_max);
    printf("energy %.4g mJ = %.4g left + %.4g plastic + %.4g slip, %.1e unaccounted for\n", before, after, contact.plastic, contact.slip,
           (before - after - contact.plastic - contact.slip) / before);
    return fabs(before - after - contact.plastic - contact.slip) < 1e-3 * before && touched ? 0 : 1;
}
