/* What engines do at their start and at their edges, with asperity_contact3d.h: set-up, masses, places that have no answer, damping. The law is in asperity_law.h, of a
 * sphere on a plane. Prints what it measures; exits 0 if all is within bounds. */
#include "asperity_law.h"
#include "asperity_contact3d.h"

static int failures = 0;

static void expect(int good, const char *what, double value) {
    printf("%-70s %.3g%s\n", what, value, good ? "" : "   FAILED");
    failures += !good;
}

/* Whether an answer is none, and says so; the memory has to be as it was. */
static int is_none(const asperity_forces *out, int flag, const asperity_contact *before, const asperity_contact *after) {
    return out->flags == flag && !asperity_is_finite(out->f_n) && !asperity_is_finite(out->force_i[0]) && !asperity_is_finite(out->force_j[2]) &&
           !asperity_is_finite(out->torque_i[1]) && memcmp(before, after, sizeof *before) == 0;
}

static void start(asperity_body *i, asperity_body *j) {
    memset(i, 0, sizeof *i);
    i->radius = i->mass = 1.0;
    *j = *i;
    i->position[2] = 1.99;
    i->velocity[2] = -0.01;
    i->velocity[0] = 0.003;
}

static void set_up(const asperity_table *plane, const asperity_table *pair) {
    asperity_law3d law;
    asperity_contact before, after;
    asperity_forces out;
    asperity_wall wall = {{0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
    asperity_body i, j;
    const double bad[] = {0.0, -1.0, HUGE_VAL, -HUGE_VAL};
    int k, refused = 0;
    start(&i, &j);
    memset(&before, 0, sizeof before);
    k = asperity_pair_law(&law, pair, 70e3, 1.0);
    expect(k == ASPERITY_LAW_FITS && law.damping == 0.0, "a pair's table between spheres", law.damping);
    expect(asperity_wall_law(&law, pair, 70e3, 1.0) == ASPERITY_LAW_OF_A_PAIR, "a pair's table at a wall is refused at set-up", ASPERITY_LAW_OF_A_PAIR);
    asperity_sphere_wall(&law, &i, &wall, 1e-3, &before, &after, &out);
    expect(is_none(&out, ASPERITY_WRONG_TABLE, &before, &after), "    and has no force", (double)out.flags);
    expect(asperity_pair_law(&law, plane, 70e3, 0.5) == ASPERITY_LAW_OF_A_WALL, "a wall's table between spheres is refused at set-up", ASPERITY_LAW_OF_A_WALL);
    asperity_spheres(&law, &i, &j, 1e-3, &before, &after, &out);
    expect(is_none(&out, ASPERITY_WRONG_TABLE, &before, &after), "    and has no force", (double)out.flags);
    for (k = 0; k < 4; k++) {
        refused += asperity_pair_law(&law, pair, bad[k], 1.0) == ASPERITY_LAW_MODULUS;
        refused += asperity_wall_law(&law, plane, 70e3, bad[k]) == ASPERITY_LAW_RESTITUTION;
    }
    refused += asperity_pair_law(&law, pair, 70e3, 0.09) == ASPERITY_LAW_RESTITUTION;
    expect(refused == 9, "impossible moduli and restitution coefficients are refused", refused);
}

/* Places, velocities and memories that have no answer. */
static void no_answers(const asperity_table *pair) {
    asperity_law3d law;
    asperity_contact before, after, loaded;
    asperity_forces out;
    asperity_body i, j;
    double *numbers = (double *)&before;
    const double bad[] = {HUGE_VAL, -HUGE_VAL, asperity_no_number()};
    const int hostile[] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 20, 31};
    int k, n, found = 0;
    start(&i, &j);
    memset(&before, 0, sizeof before);
    asperity_pair_law(&law, pair, 70e3, 0.5);
    asperity_spheres(&law, &i, &j, 1e-3, &before, &loaded, &out);
    memcpy(i.position, j.position, sizeof i.position);
    asperity_spheres(&law, &i, &j, 1e-3, &loaded, &after, &out);
    expect(is_none(&out, ASPERITY_NO_NUMBER, &loaded, &after), "coincident centres have no force, and a flag", (double)out.flags);
    for (k = 0; k < 3; k++) {
        start(&i, &j);
        i.position[1] = bad[k];
        asperity_spheres(&law, &i, &j, 1e-3, &loaded, &after, &out);
        found += is_none(&out, ASPERITY_NO_NUMBER, &loaded, &after);
        start(&i, &j);
        j.velocity[0] = bad[k];
        asperity_spheres(&law, &i, &j, 1e-3, &loaded, &after, &out);
        found += is_none(&out, ASPERITY_NO_NUMBER, &loaded, &after);
        start(&i, &j);
        j.spin[1] = bad[k];
        asperity_spheres(&law, &i, &j, 1e-3, &loaded, &after, &out);
        found += is_none(&out, ASPERITY_NO_NUMBER, &loaded, &after);
    }
    expect(found == 9, "places, velocities and spins that are no numbers", found);
    found = 0;
    start(&i, &j);
    for (n = 0; n < 12; n++) {
        for (k = 0; k < 3; k++) {
            before = loaded;
            numbers[hostile[n]] = bad[k];
            asperity_spheres(&law, &i, &j, 1e-3, &before, &after, &out);
            found += is_none(&out, ASPERITY_NO_NUMBER, &before, &after) && !asperity_is_finite(asperity_stored_energy(pair, 1.0, 1.0, &before.state));
        }
    }
    before = loaded;
    before.state.worn = -1.0;
    asperity_spheres(&law, &i, &j, 1e-3, &before, &after, &out);
    found += is_none(&out, ASPERITY_NO_NUMBER, &before, &after);
    expect(found == 37, "memories that no contact has", found);
    /* A dent of 1e-200 is one; what is pressed to the end of numbers from there has no crash. */
    before = loaded;
    before.state.h_max = 1e-200;
    {
        asperity_state next;
        asperity_response answer;
        const double still[2] = {0.0, 0.0};
        asperity_update(pair, 1.0, 1.0, &before.state, 1.7e308, still, &next, &answer, NULL);
        asperity_update(pair, 1.0, 1.0, &before.state, 0.02, still, &next, &answer, NULL);
        expect(asperity_is_finite(answer.f_n) && answer.f_n > 0.0, "pressed from a dent of 1e-200", answer.f_n);
    }
}

/* The rebound of a light elastic impact on a body of this mass, j; which does not move if `held`. */
static double rebound(const asperity_law3d *law, double mass, double told, int held) {
    asperity_body i, j;
    asperity_contact c;
    asperity_forces out;
    double speed = 2e-7 * sqrt(law->modulus), dt = 2e-3 * asperity_time_step(law, 1.0, 1.0, 4e-6);
    int step;
    start(&i, &j);
    memset(&c, 0, sizeof c);
    memset(i.velocity, 0, sizeof i.velocity);
    i.position[2] = 2.0;
    i.velocity[2] = -speed;
    j.mass = told;
    for (step = 0; step < 100000; step++) {
        i.position[2] += i.velocity[2] * dt;
        j.position[2] += j.velocity[2] * dt;
        asperity_spheres(law, &i, &j, dt, &c, &c, &out);
        i.velocity[2] += out.force_i[2] / i.mass * dt;
        j.velocity[2] += held ? 0.0 : out.force_j[2] / mass * dt;
        if (i.velocity[2] > j.velocity[2] && out.f_n == 0.0) {
            break;
        }
    }
    return (i.velocity[2] - j.velocity[2]) / speed;
}

static void masses(const asperity_table *pair) {
    asperity_law3d law;
    double e, limit = 0.0;
    asperity_pair_law(&law, pair, 70e3, 0.5);
    e = rebound(&law, 1.0, 1.0, 0);
    expect(fabs(e - 0.5) < 0.03, "restitution 0.5 of two equal spheres", e);
    e = rebound(&law, 7.0, 7.0, 0);
    expect(fabs(e - 0.5) < 0.03, "    of one that is seven times as heavy", e);
    e = rebound(&law, 1.0, HUGE_VAL, 1);
    expect(fabs(e - 0.5) < 0.03, "    of one that no force moves, mass INFINITY", e);
    e = rebound(&law, 1.0, 1.0, 1);
    expect(fabs(e - 0.5) > 0.05, "    what its own mass would make of that", e);
    limit = asperity_effective_mass(HUGE_VAL, HUGE_VAL) + asperity_effective_mass(0.0, 1.0) + asperity_effective_mass(asperity_no_number(), 0.0);
    expect(limit == 0.0, "two that no force moves are not damped", limit);
    expect(fabs(asperity_effective_mass(3.0, 6.0) - 2.0) < 1e-15, "effective mass of 3 and 6", asperity_effective_mass(3.0, 6.0));
}

/* Tangential damping: it takes energy from a swing along the plane, stays within friction, and is accounted for. */
static void tangential(const asperity_table *plane) {
    asperity_law3d law;
    asperity_wall wall = {{0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
    double taken[2], lost = 0.0, unaccounted = 0.0, beyond = 0.0;
    int damped, step, k;
    for (damped = 0; damped < 2; damped++) {
        asperity_body i;
        asperity_contact c;
        asperity_forces out;
        double dt, begin, before[3] = {0.0, 0.0, 0.0}, swing, done = 0.0, energy;
        memset(&i, 0, sizeof i);
        memset(&c, 0, sizeof c);
        asperity_wall_law(&law, plane, 70e3, 0.5);
        law.tangential = damped ? 1.0 : 0.0;
        i.radius = i.mass = 1.0;
        i.position[2] = 0.995;
        dt = 0.002 * asperity_time_step(&law, 1.0, 1.0, 0.0);
        asperity_sphere_wall(&law, &i, &wall, dt, &c, &c, &out);
        begin = c.plastic + c.slip + out.stored;
        i.velocity[0] = swing = 0.01 * sqrt(2.0 * out.stored);
        lost = 0.0;
        for (step = 0; step < 20000; step++) {
            /* Held at its depth: it swings along the plane alone. */
            i.velocity[0] += 0.5 * dt * before[0];
            i.position[0] += dt * i.velocity[0];
            asperity_sphere_wall(&law, &i, &wall, dt, &c, &c, &out);
            for (k = 0; k < 3; k++) {
                before[k] = out.force_i[k];
            }
            i.velocity[0] += 0.5 * dt * before[0];
            lost += out.damped;
            beyond = fmax(beyond, out.f_t - law.table->friction * out.f_n * (1.0 + 1e-9));
        }
        energy = 0.5 * i.velocity[0] * i.velocity[0] + out.stored + c.plastic + c.slip + lost - begin;
        done = 0.5 * swing * swing;
        unaccounted = fmax(unaccounted, fabs(energy / done - 1.0));
        taken[damped] = lost / done;
    }
    /* The rest is slip, which begins with the shear. */
    expect(taken[0] == 0.0 && taken[1] > 0.8, "share of a swing along the plane that its damping takes", taken[1]);
    expect(beyond <= 0.0, "    friction's bound holds", beyond);
    expect(unaccounted < 0.02, "    energy that is unaccounted for", unaccounted);
}

/* One turn of a loaded pair in steps of 3e-3 rad, places and velocities as velocity Verlet has them: the velocities are those of the middle of the step. */
static void turned(const asperity_table *pair, int steps, double *change) {
    asperity_law3d law;
    asperity_body i, j;
    asperity_contact c;
    asperity_forces first, out;
    const double a = 6.283185307179586 / steps, dt = 1e-3;
    int step, k;
    start(&i, &j);
    memset(&c, 0, sizeof c);
    asperity_pair_law(&law, pair, 70e3, 1.0);
    for (step = 0; step < 100; step++) {
        i.position[2] = 2.0 - 1e-4 * (step + 1);
        i.velocity[2] = -0.1;
        i.velocity[0] = 0.001;
        i.position[0] += 1e-6;
        asperity_spheres(&law, &i, &j, dt, &c, &c, &first);
    }
    memset(j.velocity, 0, sizeof j.velocity);
    for (step = 0; step < steps; step++) {
        double x = i.position[0], z = i.position[2];
        i.position[0] = cos(a) * x + sin(a) * z;
        i.position[2] = cos(a) * z - sin(a) * x;
        i.velocity[0] = (i.position[0] - x) / dt;
        i.velocity[2] = (i.position[2] - z) / dt;
        i.spin[1] = j.spin[1] = a / dt;
        asperity_spheres(&law, &i, &j, dt, &c, &c, &out);
    }
    *change = 0.0;
    for (k = 0; k < 3; k++) {
        *change += (out.force_i[k] - first.force_i[k]) * (out.force_i[k] - first.force_i[k]);
    }
    *change = sqrt(*change) / first.f_n;
}

int main(void) {
    static asperity_table plane, pair;
    double coarse, fine;
    plane = pair = asperity_law;
    asperity_stand_in(&pair);
    set_up(&plane, &pair);
    no_answers(&pair);
    masses(&pair);
    tangential(&plane);
    turned(&pair, 2094, &coarse);
    turned(&pair, 20940, &fine);
    expect(coarse < 0.03, "one turn in steps of 3e-3 rad, mid-step velocities: change over F_N", coarse);
    expect(fine < 0.02 * coarse, "    in steps of 3e-4 rad", fine);
    return failures != 0;
}
