/* Checks the element on one contact: element_check LAW.asperity [F_N of a press and half the stroke of a fretting, over E R^2 and R].
 *
 * Tangents against differences, 100 increments against 10^5, what closed paths gain, turned axes, random steps of all sizes, cost, the sink-in under held F_N. */
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include "element_table.h"

static asperity_table law;
static element_table table;
static unsigned long long seed = 88172645463325252ull;

static double uniform(void) { /* xorshift */
    seed ^= seed << 13;
    seed ^= seed >> 7;
    seed ^= seed << 17;
    return (double)(seed >> 11) / 9007199254740992.0;
}

static double now(void) {
    return (double)clock() / CLOCKS_PER_SEC;
}

/* Goes straight to (h, d) from (h0, d0); returns the work that was done by the trapezoidal rule. */
static double go(element_state *s, element_response *out, double h0, const double d0[2], double h, const double d[2], int steps) {
    double work = 0.0, step[2] = {(d[0] - d0[0]) / steps, (d[1] - d0[1]) / steps}, f[3] = {out->f_n, out->f_t[0], out->f_t[1]};
    int k;
    for (k = 1; k <= steps; k++) {
        element_update(&table, s, h0 + (h - h0) * k / steps, step, s, out, NULL);
        work += 0.5 * ((f[0] + out->f_n) * (h - h0) / steps + (f[1] + out->f_t[0]) * step[0] + (f[2] + out->f_t[1]) * step[1]);
        f[0] = out->f_n;
        f[1] = out->f_t[0];
        f[2] = out->f_t[1];
    }
    return work;
}

/* Energy that the contact gives back: of the dent and of the sliders. */
static double stored(const element_state *s, const element_response *out) {
    element_row row;
    double e, energy;
    int i;
    element_read(&table, table.first + s->hardened, ELEMENT_COLUMNS, &row);
    e = s->h - row.value[ELEMENT_DENT];
    energy = e > 0.0 ? out->f_n * e / (row.value[ELEMENT_GAMMA] + 1.0) : 0.0;
    for (i = 0; i < ELEMENT_SLIDERS; i++) {
        energy += 0.5 * (s->slider[0][i] * s->slider[0][i] + s->slider[1][i] * s->slider[1][i]) / (row.value[ELEMENT_LN_STIFFNESS] * element_weights()[i]);
    }
    return energy;
}

int main(int argc, char **argv) {
    double deepest, slip, worst = 0.0, gain = 0.0, lowest = 1.0, turned = 0.0, f, n;
    int i, j, k, states = 0, off = 0, halved = 0;
    asperity_curve v;
    if (argc < 2 || asperity_read_table(argv[1], &law) != 0 || !element_make_table(&law, &table)) {
        fprintf(stderr, "no table that is given by numbers\n");
        return 2;
    }
    deepest = law.deepest;
    asperity_first_loading(&law, deepest, 1, &v);
    slip = 0.5 / v.per_slip;
    printf("state %zu bytes, table %zu kB\n", sizeof(element_state), sizeof(element_table) / 1024);

    /* Tangents, by four-point differences, at the states of random paths. */
    for (i = 0; i < 400; i++) {
        element_state s, to;
        element_response out;
        element_tangent by;
        double h = 0.0, d[2] = {0.0, 0.0}, greatest, error, here, step[2], next, largest = 0.0;
        int legs = 1 + (int)(4.0 * uniform());
        memset(&s, 0, sizeof s);
        memset(&out, 0, sizeof out);
        for (j = 0; j < legs; j++) {
            double h1 = j == 0 ? deepest * (0.2 + 0.8 * uniform()) : h + (uniform() - 0.3) * 0.1 * deepest, d1[2] = {d[0] + (uniform() - 0.5) * 2.0 * slip, d[1] + (uniform() - 0.5) * slip};
            go(&s, &out, h, d, h1, d1, 40);
            h = h1;
            d[0] = d1[0];
            d[1] = d1[1];
        }
        step[0] = (uniform() - 0.5) * 0.05 * slip;
        step[1] = (uniform() - 0.5) * 0.05 * slip;
        next = h + (uniform() - 0.3) * 0.002 * deepest;
        element_update(&table, &s, next, step, &to, &out, &by);
        here = out.f_n;
        if (out.tries > ELEMENT_STEPS) { /* a step that was halved has the tangent of its last part */
            halved++;
            continue;
        }
        if (!(here > 0.0)) {
            continue;
        }
        greatest = by.f_n[0] > by.f_t[0][1] ? fabs(by.f_n[0]) : fabs(by.f_t[0][1]);
        for (k = 0; k < 3; k++) {
            double move = 1e-6 * slip, answers[4][3];
            for (j = 0; j < 4; j++) {
                double at = (j == 0 ? -2.0 : j == 1 ? -1.0 : j == 2 ? 1.0 : 2.0) * move, d1[2] = {step[0] + (k == 1 ? at : 0.0), step[1] + (k == 2 ? at : 0.0)};
                element_update(&table, &s, next + (k == 0 ? at : 0.0), d1, &to, &out, NULL);
                answers[j][0] = out.f_n;
                answers[j][1] = out.f_t[0];
                answers[j][2] = out.f_t[1];
            }
            for (j = 0; j < 3; j++) {
                double difference = (answers[0][j] - 8.0 * answers[1][j] + 8.0 * answers[2][j] - answers[3][j]) / (12.0 * move);
                error = fabs(difference - (j == 0 ? by.f_n[k] : by.f_t[j - 1][k])) / greatest;
                largest = error > largest ? error : largest;
            }
        }
        states++;
        off += largest > 1e-5;
        worst = largest <= 1e-5 && largest > worst ? largest : worst;
    }
    printf("tangents: %d of %d states within 1e-5 of differences, those to %.1e; %d steps had to be halved\n", states - off, states, worst, halved);

    /* An oblique press in 100 increments, and a cycle in 100 each, against a thousand times as many. */
    for (k = 0; k < 4; k++) {
        double slope[4] = {0.3, 1.0, 3.0, 0.0}, zero[2] = {0.0, 0.0}, most[2] = {0.0, 0.0}, error[2] = {0.0, 0.0};
        element_state coarse, fine;
        element_response a, b;
        memset(&coarse, 0, sizeof coarse);
        memset(&fine, 0, sizeof fine);
        memset(&a, 0, sizeof a);
        memset(&b, 0, sizeof b);
        for (i = 0; i < (k < 3 ? 10 : 40); i++) {
            double from = i * 0.1, to = from + 0.1, d0[2] = {slope[k] * deepest * from, 0.0}, d1[2] = {slope[k] * deepest * to, 0.0}, h0 = deepest * from, h1 = deepest * to;
            if (k == 3) { /* press, shear to slip, back, and again */
                h0 = i < 10 ? deepest * from : deepest;
                h1 = i < 10 ? deepest * to : deepest;
                d0[0] = i < 10 ? 0.0 : i < 20 ? slip * 0.1 * (i - 10) : i < 30 ? slip * (1.0 - 0.2 * (i - 20)) : slip * (0.2 * (i - 30) - 1.0);
                d1[0] = i < 10 ? 0.0 : i < 20 ? slip * 0.1 * (i - 9) : i < 30 ? slip * (1.0 - 0.2 * (i - 19)) : slip * (0.2 * (i - 29) - 1.0);
            }
            go(&coarse, &a, h0, d0, h1, d1, 10);
            go(&fine, &b, h0, d0, h1, d1, 10000);
            most[0] = fabs(b.f_n) > most[0] ? fabs(b.f_n) : most[0];
            most[1] = fabs(b.f_t[0]) > most[1] ? fabs(b.f_t[0]) : most[1];
            error[0] = fabs(a.f_n - b.f_n) > error[0] ? fabs(a.f_n - b.f_n) : error[0];
            error[1] = fabs(a.f_t[0] - b.f_t[0]) > error[1] ? fabs(a.f_t[0] - b.f_t[0]) : error[1];
            (void)zero;
        }
        printf("%s: 100 increments against 10^5: F_N %.2f %%, F_T %.2f %% of the greatest\n", k == 0 ? "oblique, slope 0.3" : k == 1 ? "oblique, slope 1" : k == 2 ? "oblique, slope 3" : "press, two shears", 100.0 * error[0] / most[0], 100.0 * error[1] / most[1]);
    }

    /* Random paths: no closed loop gains, what is stored is never above the work, nothing hangs or is no number; the same in turned axes. */
    for (i = 0; i < 200; i++) {
        element_state s, other;
        element_response out, twin;
        double h = 0.0, d[2] = {0.0, 0.0}, work = 0.0, all = 0.0, co = cos(0.7), si = sin(0.7), e[2] = {0.0, 0.0};
        memset(&s, 0, sizeof s);
        memset(&out, 0, sizeof out);
        other = s;
        twin = out;
        for (j = 0; j < 12; j++) {
            double h1 = j == 0 ? deepest * (0.2 + 0.7 * uniform()) : h + (uniform() - 0.5) * 0.1 * deepest * (uniform() < 0.5 ? 1.0 : 0.1), d1[2] = {(uniform() - 0.5) * 2.0 * slip, (uniform() - 0.5) * 2.0 * slip}, e1[2], one;
            e1[0] = co * d1[0] - si * d1[1];
            e1[1] = si * d1[0] + co * d1[1];
            one = go(&s, &out, h, d, h1, d1, 2000);
            go(&other, &twin, h, e, h1, e1, 2000);
            work += one;
            all += fabs(one);
            f = fabs(co * out.f_t[0] - si * out.f_t[1] - twin.f_t[0]) / (v.f_n0 * law.friction);
            turned = f > turned ? f : turned;
            n = (work - stored(&s, &out)) / all;
            lowest = n < lowest ? n : lowest;
            h = h1;
            memcpy(d, d1, sizeof d);
            memcpy(e, e1, sizeof e);
        }
        { /* round and round: the second round of a loop gives back no more than it takes */
            double a[2] = {d[0] + 0.3 * slip, d[1]}, b[2] = {d[0], d[1] + 0.3 * slip}, round;
            for (j = 0; j < 2; j++) {
                double one = go(&s, &out, h, d, h - 0.02 * deepest, a, 2000);
                double two = go(&s, &out, h - 0.02 * deepest, a, h, b, 2000), three = go(&s, &out, h, b, h, d, 2000);
                round = one + two + three;
                f = round / (fabs(one) + fabs(two) + fabs(three) + 1e-300);
                if (j == 1 && f < gain) {
                    gain = f;
                }
            }
        }
    }
    printf("random paths: work less what is stored at least %.1e of the work; closed loops at least %.1e; turned axes to %.1e of mu F_N0\n", lowest, gain, turned);
    {
        element_state s;
        element_response out;
        int bad = 0, hard = 0;
        memset(&s, 0, sizeof s);
        for (i = 0; i < 300000; i++) {
            double size = exp(-12.0 * uniform()), h = s.h + (uniform() - 0.5) * size * 0.5 * deepest, d[2] = {(uniform() - 0.5) * size * 4.0 * slip, (uniform() - 0.5) * size * 4.0 * slip};
            h = h < 1.2 * deepest ? (h > -0.1 * deepest ? h : -0.1 * deepest) : 1.2 * deepest;
            element_update(&table, &s, h, d, &s, &out, NULL);
            bad += !(out.f_n >= 0.0 && fabs(out.f_t[0]) + fabs(out.f_t[1]) <= 1.5 * law.friction * out.f_n + 1e-300);
            hard += out.tries > 40;
            if (i % 1000 == 999) {
                memset(&s, 0, sizeof s);
            }
        }
        printf("random steps of all sizes: %d of 300000 without sense, %d had to be halved\n", bad, hard);
    }

    /* Cost. */
    for (k = 0; k < 3; k++) {
        element_state s;
        element_response out;
        element_tangent by;
        double start, d[2] = {0.0, 0.0}, none[2] = {0.0, 0.0}, sum = 0.0;
        int count = 300000, tries = 0;
        memset(&s, 0, sizeof s);
        memset(&out, 0, sizeof out);
        go(&s, &out, 0.0, none, 0.5 * deepest, none, 100);
        start = now();
        for (i = 0; i < count; i++) {
            double h = k == 0 ? 0.5 * deepest - 0.1 * v.depth * (1.0 - cos(i * 0.001)) * 0.5 : 0.5 * deepest * (1.0 + (double)i / count);
            d[0] = k == 0 ? 1e-6 * slip * cos(i * 0.001) : 0.5 * deepest / count;
            element_update(&table, &s, h, d, &s, &out, k == 2 ? &by : NULL);
            sum += out.f_n;
            tries += out.tries;
        }
        printf("%s: %.0f ns, %.2f evaluations (sum %.3g)\n", k == 0 ? "elastic" : k == 1 ? "plastic, oblique" : "plastic, with tangents", (now() - start) / count * 1e9, (double)tries / count, sum);
    }

    if (argc > 3) { /* pressed to F_N, sheared to and fro under it */
        element_state s, to;
        element_response out;
        double held = atof(argv[2]), stroke = atof(argv[3]), h = 0.0, none[2] = {0.0, 0.0}, pressed, at = 0.0;
        memset(&s, 0, sizeof s);
        do {
            h += 1e-4 * deepest;
            element_update(&table, &s, h, none, &s, &out, NULL);
        } while (out.f_n < held && h < 2.0 * deepest);
        pressed = h;
        printf("sink-in under F_N = %.4g, shear +-%.4g:", held, stroke);
        for (i = 0; i < 9; i++) {
            double target = i == 8 ? 0.0 : i % 2 == 0 ? stroke : -stroke, step[2] = {(target - at) / 100.0, 0.0};
            for (j = 0; j < 100; j++) {
                double low = h - 0.05 * deepest, high = h + 0.05 * deepest;
                for (k = 0; k < 50; k++) {
                    double middle = 0.5 * (low + high);
                    element_update(&table, &s, middle, step, &to, &out, NULL);
                    if (out.f_n < held) {
                        low = middle;
                    } else {
                        high = middle;
                    }
                }
                h = 0.5 * (low + high);
                element_update(&table, &s, h, step, &s, &out, NULL);
            }
            at = target;
            printf(" %.6f", h - pressed);
        }
        printf("\n");
    }
    return 0;
}
