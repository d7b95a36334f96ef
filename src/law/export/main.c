/* Two spheres that collide obliquely, and a sphere that hits a wall, by a computed law. Written by `asperity law export`.
 *     cc -std=c99 -O2 main.c -o main -lm && ./main
 * Keep your changes under another name: the next export replaces this file. Run it where the tables are. Lengths and stresses are in the units of the case.
@DESCRIBED@
 */
#include "asperity_contact3d.h"

enum { WALL = -1 };

/* Name, radius, Young's modulus, density: put yours in. Speeds go with sqrt(E/density), so that any will do to begin with. */
static const struct material {
    const char *name;
    double radius, modulus, density;
} materials[] = {
@MATERIALS@};

/* Table, and the materials that meet. */
static const struct contact {
    const char *table;
    int first, second;
} contacts[] = {
@CONTACTS@};

static asperity_body sphere(const struct material *m) {
    asperity_body s;
    memset(&s, 0, sizeof s);
    s.radius = m->radius;
    s.mass = 4.1887902047863905 * m->density * m->radius * m->radius * m->radius;
    return s;
}

static double energy(const asperity_body *s) {
    double rim = s->radius * s->radius * asperity_dot(s->spin, s->spin);
    return 0.5 * s->mass * (asperity_dot(s->velocity, s->velocity) + 0.4 * rim);
}

/* Half a kick, of velocity and spin. */
static void kick(asperity_body *s, const double force[3], const double torque[3], double dt) {
    int k;
    for (k = 0; k < 3; k++) {
        s->velocity[k] += 0.5 * dt * force[k] / s->mass;
        s->spin[k] += 0.5 * dt * torque[k] / (0.4 * s->mass * s->radius * s->radius);
    }
}

/* A sphere comes down with 0.0015 sqrt(E/density), and a third of that along, on another one that rests, or on a wall. */
static int collide(const struct contact *where, const asperity_table *table) {
    const int on_wall = where->second == WALL;
    const struct material *m = &materials[where->first], *other = on_wall ? m : &materials[where->second];
    const asperity_wall wall = {{0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
    asperity_body i = sphere(m), j = sphere(other);
    asperity_law3d law;
    asperity_contact contact;
    asperity_forces out;
    double speed = 0.0015 * sqrt(m->modulus / m->density), before, after, missing, dt;
    int step, k, touched = 0, flags = 0;
    const int code = on_wall ? asperity_wall_law(&law, table, m->modulus, 1.0) : asperity_pair_law(&law, table, m->modulus, 1.0);
    if (code != ASPERITY_LAW_FITS) {
        fprintf(stderr, "%s: does not fit this contact, code %d\n", where->table, code);
        return 2;
    }
    memset(&contact, 0, sizeof contact);
    memset(&out, 0, sizeof out);
    i.position[2] = i.radius + (on_wall ? 0.0 : j.radius);
    i.velocity[0] = speed / 3.0;
    i.velocity[2] = -speed;
    dt = 0.05 * asperity_time_step(&law, m->radius, i.mass < j.mass ? i.mass : j.mass, 0.0);
    before = energy(&i);
    for (step = 0; step < 1000000 && !(touched && asperity_may_forget(&contact)); step++) {
        kick(&i, out.force_i, out.torque_i, dt);
        kick(&j, out.force_j, out.torque_j, dt);
        for (k = 0; k < 3; k++) {
            i.position[k] += dt * i.velocity[k];
            j.position[k] += dt * j.velocity[k];
        }
        if (on_wall) {
            asperity_sphere_wall(&law, &i, &wall, dt, &contact, &contact, &out);
            memset(out.force_j, 0, sizeof out.force_j); /* the wall stays */
            memset(out.torque_j, 0, sizeof out.torque_j);
        } else {
            asperity_spheres(&law, &i, &j, dt, &contact, &contact, &out);
        }
        if (out.flags & (ASPERITY_NO_NUMBER | ASPERITY_WRONG_TABLE)) {
            fprintf(stderr, "%s: no force, flags %d\n", where->table, out.flags);
            return 3;
        }
        kick(&i, out.force_i, out.torque_i, dt);
        kick(&j, out.force_j, out.torque_j, dt);
        touched |= out.flags & ASPERITY_TOUCHES;
        flags |= out.flags;
    }
    after = energy(&i) + energy(&j);
    missing = fabs(before - after - contact.plastic - contact.slip) / before;
    printf("%s on %s: restitution %.3f, deepest h/R %.4f%s\n", m->name, on_wall ? "a wall" : other->name,
           (i.velocity[2] - j.velocity[2]) / speed, contact.state.h_max, flags & ASPERITY_OUT_OF_RANGE ? " (beyond the table)" : "");
    printf("    of the energy %.3f left, %.3f plastic, %.3f slip; %.0e unaccounted for\n", after / before, contact.plastic / before,
           contact.slip / before, missing);
    return touched && missing < 0.01 ? 0 : 1;
}

int main(void) {
    static asperity_table table;
    static const char *const problems[] = {"", "cannot be opened", "is no contact table of this version", "is damaged"};
    size_t n;
    int worst = 0;
    for (n = 0; n < sizeof contacts / sizeof *contacts; n++) {
        const int code = asperity_read_table(contacts[n].table, &table);
        const int status = code == 0 ? collide(&contacts[n], &table) : 2;
        if (code != 0) {
            fprintf(stderr, "%s: %s\n", contacts[n].table, problems[code]);
        }
        worst = status > worst ? status : worst;
    }
    return worst;
}
