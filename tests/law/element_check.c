/* Holds the update of asperity_contact.h to what it promises, on one contact: element_check LAW.asperity. Prints what it measures; exits 0 if all is within bounds.
 *
 * Tangents against differences, 100 increments against 10^4, what paths dissipate and closed ones gain, turned axes, a step that goes nowhere, random steps of all sizes. */
#include "asperity_contact.h"

static asperity_table law;
static double deepest, slip;
static int failures = 0;
static unsigned long long seed = 88172645463325252ull;

static void expect(int good, const char *what, double value) {
    printf("%-70s %.3g%s\n", what, value, good ? "" : "   FAILED");
    failures += !good;
}

static double uniform(double from, double to) { /* xorshift */
    seed ^= seed << 13;
    seed ^= seed >> 7;
    seed ^= seed << 17;
    return from + (to - from) * (double)(seed >> 11) / 9007199254740992.0;
}

static double larger(double a, double b) { return a > b ? a : b; }

/* What a path has done, stored and dissipated. */
typedef struct account {
    double work, all, plastic, friction, least; /* least: the smallest of both dissipations in a step, over E R^3 */
} account;

/* Goes straight to (h, d) from (h0, d0). */
static void go(asperity_state *s, asperity_response *out, double h0, const double d0[2], double h, const double d[2], int steps, account *sum) {
    double step[2], f[3];
    int k;
    step[0] = (d[0] - d0[0]) / steps;
    step[1] = (d[1] - d0[1]) / steps;
    f[0] = out->f_n;
    f[1] = out->f_t[0];
    f[2] = out->f_t[1];
    for (k = 1; k <= steps; k++) {
        double from = s->h, one;
        asperity_update(&law, 1.0, 1.0, s, h0 + (h - h0) * k / steps, step, s, out, NULL);
        one = 0.5 * ((f[0] + out->f_n) * (s->h - from) + (f[1] + out->f_t[0]) * step[0] + (f[2] + out->f_t[1]) * step[1]);
        if (sum) {
            sum->work += one;
            sum->all += fabs(one);
            sum->plastic += out->plastic;
            sum->friction += out->friction;
            sum->least = fmin(sum->least, fmin(out->plastic, out->friction));
        }
        f[0] = out->f_n;
        f[1] = out->f_t[0];
        f[2] = out->f_t[1];
    }
}

/* A contact with some history; where it stands in h and d. */
static double random_contact(asperity_state *s, asperity_response *out, double d[2]) {
    double h = 0.0, to[2];
    int legs = 1 + (int)uniform(0.0, 4.0), j;
    memset(s, 0, sizeof *s);
    memset(out, 0, sizeof *out);
    d[0] = d[1] = 0.0;
    for (j = 0; j < legs; j++) {
        double next = j == 0 ? deepest * uniform(0.2, 1.0) : h + uniform(-0.03, 0.07) * deepest;
        to[0] = d[0] + uniform(-1.0, 1.0) * slip;
        to[1] = d[1] + uniform(-0.5, 0.5) * slip;
        go(s, out, h, d, next, to, 40, NULL);
        h = next;
        d[0] = to[0];
        d[1] = to[1];
    }
    return h;
}

/* Greatest difference of a tangent from four-point differences, over the greatest stiffness. */
static double tangent_error(const asperity_state *s, double h, const double step[2]) {
    asperity_state to;
    asperity_response out;
    asperity_tangent by;
    double most, largest = 0.0;
    int j, k;
    asperity_update(&law, 1.0, 1.0, s, h, step, &to, &out, &by);
    most = larger(fabs(by.df_n_dh), larger(fabs(by.df_t_ddelta[0][0]), fabs(by.df_t_ddelta[1][1])));
    for (k = 0; k < 3 && out.f_n > 0.0; k++) {
        double move = 1e-6 * slip, f[4][3];
        for (j = 0; j < 4; j++) {
            double at = (j == 0 ? -2.0 : j == 1 ? -1.0 : j == 2 ? 1.0 : 2.0) * move, d[2];
            d[0] = step[0] + (k == 1 ? at : 0.0);
            d[1] = step[1] + (k == 2 ? at : 0.0);
            asperity_update(&law, 1.0, 1.0, s, h + (k == 0 ? at : 0.0), d, &to, &out, NULL);
            f[j][0] = out.f_n;
            f[j][1] = out.f_t[0];
            f[j][2] = out.f_t[1];
        }
        for (j = 0; j < 3; j++) {
            double difference = (f[0][j] - 8.0 * f[1][j] + 8.0 * f[2][j] - f[3][j]) / (12.0 * move);
            double told = k == 0 ? (j == 0 ? by.df_n_dh : by.df_t_dh[j - 1]) : j == 0 ? by.df_n_ddelta[k - 1] : by.df_t_ddelta[j - 1][k - 1];
            largest = larger(largest, fabs(difference - told) / most);
        }
    }
    return largest;
}

static void tangents(void) {
    int i, off = 0;
    double worst = 0.0;
    for (i = 0; i < 1000; i++) {
        asperity_state s;
        asperity_response out;
        double d[2], h = random_contact(&s, &out, d), step[2], error;
        step[0] = uniform(-0.025, 0.025) * slip;
        step[1] = uniform(-0.025, 0.025) * slip;
        error = tangent_error(&s, h + uniform(-0.0006, 0.0014) * deepest, step);
        off += error > 1e-5;
        worst = error <= 1e-5 ? larger(worst, error) : worst;
    }
    /* The others stand where a slider begins to slip or a shape has a corner. */
    expect(off <= 10, "tangents: states of 1000 that are off by more than 1e-5", off);
    expect(worst <= 1e-5, "    the greatest error of the others", worst);
}

/* An oblique press, or a press and two shears, in 100 increments a way and in 100 times as many. */
static void increments(void) {
    const double slope[4] = {0.3, 1.0, 3.0, 0.0};
    double worst[2] = {0.0, 0.0};
    int i, k;
    for (k = 0; k < 4; k++) {
        double most[2] = {0.0, 0.0}, error[2] = {0.0, 0.0}, h = 0.0, d[2] = {0.0, 0.0};
        asperity_state coarse, fine;
        asperity_response a, b;
        memset(&coarse, 0, sizeof coarse);
        memset(&a, 0, sizeof a);
        fine = coarse;
        b = a;
        for (i = 1; i <= (k < 3 ? 10 : 40); i++) {
            double next = i < 10 ? 0.1 * i * deepest : deepest, to[2] = {0.0, 0.0};
            to[0] = k < 3 ? slope[k] * next : i <= 10 ? 0.0 : i <= 20 ? slip * 0.1 * (i - 10) : i <= 30 ? slip * (1.0 - 0.2 * (i - 20)) : slip * (0.2 * (i - 30) - 1.0);
            go(&coarse, &a, h, d, next, to, 10, NULL);
            go(&fine, &b, h, d, next, to, 1000, NULL);
            most[0] = larger(most[0], b.f_n);
            most[1] = larger(most[1], fabs(b.f_t[0]));
            error[0] = larger(error[0], fabs(a.f_n - b.f_n));
            error[1] = larger(error[1], fabs(a.f_t[0] - b.f_t[0]));
            h = next;
            d[0] = to[0];
        }
        worst[0] = larger(worst[0], error[0] / most[0]);
        worst[1] = larger(worst[1], error[1] / most[1]);
    }
    expect(worst[0] < 0.01, "100 increments against 10^4: F_N", worst[0]);
    /* Where slip is reversed, the sliders' exponent is one step late. */
    expect(worst[1] < 0.06, "    F_T", worst[1]);
}

/* Random paths, and the same in turned axes. */
static void paths(void) {
    double gain = 1.0, lowest = 1.0, closed = 0.0, least = 0.0, worst = 0.0, turned, co = cos(0.7), si = sin(0.7);
    int i, j, apart = 0;
    for (i = 0; i < 100; i++) {
        asperity_state s, other;
        asperity_response out, twin;
        account sum = {0.0, 0.0, 0.0, 0.0, 0.0}, before;
        double h = 0.0, d[2] = {0.0, 0.0}, e[2] = {0.0, 0.0}, force = 0.0, a[2], b[2];
        memset(&s, 0, sizeof s);
        memset(&out, 0, sizeof out);
        other = s;
        twin = out;
        turned = 0.0;
        for (j = 0; j < 12; j++) {
            double to = j == 0 ? deepest * uniform(0.2, 0.9) : h + uniform(-0.05, 0.05) * deepest * (uniform(0.0, 1.0) < 0.5 ? 1.0 : 0.1), d1[2], e1[2];
            d1[0] = uniform(-1.0, 1.0) * slip;
            d1[1] = uniform(-1.0, 1.0) * slip;
            e1[0] = co * d1[0] - si * d1[1];
            e1[1] = si * d1[0] + co * d1[1];
            go(&s, &out, h, d, to, d1, 500, &sum);
            go(&other, &twin, h, e, to, e1, 500, NULL);
            force = larger(force, out.f_n);
            turned = larger(turned, hypot(co * out.f_t[0] - si * out.f_t[1] - twin.f_t[0], si * out.f_t[0] + co * out.f_t[1] - twin.f_t[1]) / (law.friction * force));
            turned = larger(turned, fabs(out.f_n - twin.f_n) / force);
            lowest = fmin(lowest, (sum.work - out.stored) / sum.all);
            h = to;
            memcpy(d, d1, sizeof d);
            memcpy(e, e1, sizeof e);
        }
        /* Where a step is halved, or yields, in one and not in the other, the last digit decides. */
        apart += turned > 1e-10;
        worst = turned > 1e-10 ? worst : larger(worst, turned);
        closed = larger(closed, fabs(sum.work - out.stored - sum.plastic - sum.friction) / sum.all);
        least = fmin(least, sum.least / sum.all);
        a[0] = d[0] + 0.3 * slip;
        a[1] = d[1];
        b[0] = d[0];
        b[1] = d[1] + 0.3 * slip;
        for (j = 0; j < 2; j++) { /* round and round: the second round of a loop gives back no more than it takes */
            before = sum;
            go(&s, &out, h, d, h - 0.02 * deepest, a, 500, &sum);
            go(&s, &out, h - 0.02 * deepest, a, h, b, 500, &sum);
            go(&s, &out, h, b, h, d, 500, &sum);
        }
        gain = fmin(gain, (sum.work - before.work) / (sum.all - before.all + 1e-300));
    }
    expect(lowest > 0.0, "random paths: work less what is stored, at least, over the work", lowest);
    expect(closed < 1e-6, "    work that is neither stored nor dissipated", closed);
    /* What a light contact stores by widening under strong shear is more than that takes. */
    expect(least > -1e-3, "    the least that a step dissipates, by flow or slip", least);
    expect(gain > -1e-6, "    closed loops: the work of the second round, at least", gain);
    expect(apart <= 5, "    paths of 100 that differ in turned axes by more than 1e-10", apart);
    expect(worst < 1e-10, "    the greatest difference of the others", worst);
}

static void nowhere(void) {
    double worst = 0.0, none[2] = {0.0, 0.0};
    int i, off = 0;
    for (i = 0; i < 1000; i++) {
        double change;
        asperity_state s, to;
        asperity_response out, again;
        double d[2], h = random_contact(&s, &out, d);
        asperity_update(&law, 1.0, 1.0, &s, h, none, &to, &again, NULL);
        if (out.f_n > 0.0) {
            change = (fabs(out.f_n - again.f_n) + fabs(out.f_t[0] - again.f_t[0]) + fabs(out.f_t[1] - again.f_t[1])) / out.f_n;
            off += change > 2e-3;
            worst = change > 2e-3 ? worst : larger(worst, change);
        }
    }
    /* After a coarse step the exponent of the sliders is of the row from which that began. */
    expect(off <= 20, "a step that goes nowhere: contacts of 1000 whose forces change by 2e-3 F_N", off);
    expect(worst < 2e-3, "    the greatest change of the others", worst);
}

static void sizes(void) {
    asperity_state s;
    asperity_response out;
    asperity_tangent by;
    int i, bad = 0, beyond = 0;
    memset(&s, 0, sizeof s);
    for (i = 0; i < 1000000; i++) {
        double size = exp(-14.0 * uniform(0.0, 1.0)) * (i % 7 == 0 ? 30.0 : 1.0), h = s.h + uniform(-0.25, 0.25) * size * deepest, d[2];
        d[0] = uniform(-2.0, 2.0) * size * slip;
        d[1] = uniform(-2.0, 2.0) * size * slip;
        h = fmax(-0.1 * deepest, fmin(1.2 * deepest, h));
        asperity_update(&law, 1.0, 1.0, &s, h, d, &s, &out, i % 5 == 0 ? &by : NULL);
        bad += !asperity_is_finite(out.f_n) || !asperity_is_sound(&s) || !(out.f_n >= 0.0) || !(out.stored >= 0.0);
        bad += i % 5 == 0 && !asperity_is_finite(by.df_n_dh + by.df_t_dh[0] + by.df_t_dh[1] + by.df_t_ddelta[0][0] + by.df_t_ddelta[1][0] + by.a);
        beyond += !(hypot(out.f_t[0], out.f_t[1]) <= law.friction * out.f_n * (1.0 + 1e-9) + 1e-300);
        if (i % 1000 == 999) {
            memset(&s, 0, sizeof s);
        }
    }
    expect(bad == 0, "random steps of all sizes: answers without sense, of a million", bad);
    expect(beyond == 0, "    beyond friction's bound", beyond);
}

int main(int argc, char **argv) {
    int code = argc > 1 ? asperity_read_table(argv[1], &law) : 1;
    if (code != 0) {
        fprintf(stderr, "no table: code %d\n", code);
        return 2;
    }
    deepest = law.deepest;
    slip = 2.5 * law.friction * exp(law.rows[ASPERITY_ROWS - 20][ASPERITY_LN_FORCE] - law.rows[ASPERITY_ROWS - 20][ASPERITY_LN_STIFFNESS]);
    tangents();
    increments();
    paths();
    nowhere();
    sizes();
    return failures != 0;
}
