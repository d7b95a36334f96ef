/* Processor time of one contact update, alone and of several at once, and of Hertz and Mindlin's with a spring cut off at mu F_N beside them, each in a loop over many contacts as in
 * an engine. */
#define _POSIX_C_SOURCE 199309L
#include "asperity_law.h"

#include <stdlib.h>
#include <time.h>

enum { CONTACTS = 512, STEPS = 200 };

static double seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Mindlin's spring with history, Hertz's force; R = 1, E = 1. */
static void hertz_mindlin(asperity_real spring[2], asperity_real h, const asperity_real d[2], asperity_real mu, asperity_real f[3]) {
    asperity_real a, k, most, size;
    f[0] = f[1] = f[2] = 0;
    if (h <= 0) {
        spring[0] = spring[1] = 0;
        return;
    }
    a = ASPERITY_SQRT(h);
    f[0] = ASPERITY_R(4.0 / 3.0 * 1.0989) * a * h;
    k = ASPERITY_R(8.0 * 0.2263) * a;
    spring[0] += d[0];
    spring[1] += d[1];
    size = k * ASPERITY_SQRT(spring[0] * spring[0] + spring[1] * spring[1]);
    most = mu * f[0];
    if (size > most) {
        spring[0] *= most / size;
        spring[1] *= most / size;
    }
    f[1] = k * spring[0];
    f[2] = k * spring[1];
}

static asperity_state state[CONTACTS];
static asperity_increment several[CONTACTS];
static asperity_real spring[CONTACTS][2], depth[CONTACTS];

/* h and d of step k of contact i. */
static void path(int kind, int i, int k, asperity_real *h, asperity_real d[2]) {
    asperity_real t = ASPERITY_R(k + 1) / ASPERITY_R(STEPS), way = ASPERITY_R(0.05) * depth[i] / ASPERITY_R(STEPS);
    d[0] = way * ASPERITY_R(0.8);
    d[1] = way * ASPERITY_R(0.6);
    *h = depth[i] * t;
    if (kind == 1) {
        *h = depth[i];
    } else if (kind == 2) {
        *h = depth[i] * (k < STEPS / 2 ? t : ASPERITY_R(1.0) - ASPERITY_R(0.02) * t);
        d[0] = k < 3 * STEPS / 4 ? d[0] : -d[0];
    } else if (kind == 3) {
        *h = k == 0 ? depth[i] : ASPERITY_R(-0.01) * depth[i] * t;
    } else if (kind == 4) {
        *h = ASPERITY_R(-0.01) * depth[i] * t;
    }
}

static int less(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static asperity_real sum = 0;

/* A path of all contacts by the update of one. */
static void alone(int kind) {
    int i, k;
    for (k = 0; k < STEPS; k++) {
        for (i = 0; i < CONTACTS; i++) {
            asperity_response out;
            asperity_real h, d[2];
            path(kind, i, k, &h, d);
            asperity_update(&asperity_law, ASPERITY_R(1.0), ASPERITY_R(1.0), &state[i], h, d, &state[i], &out, NULL);
            sum += out.f_n + out.f_t[0] + out.plastic;
        }
    }
}

/* The same by that of several. */
static void together(int kind) {
    int i, k;
    for (k = 0; k < STEPS; k++) {
        for (i = 0; i < CONTACTS; i++) {
            several[i].state = several[i].next = &state[i];
            several[i].radius = ASPERITY_R(1.0);
            path(kind, i, k, &several[i].h, several[i].d);
        }
        asperity_update_many(&asperity_law, ASPERITY_R(1.0), CONTACTS, several);
        for (i = 0; i < CONTACTS; i++) {
            sum += several[i].out.f_n + several[i].out.f_t[0] + several[i].out.plastic;
        }
    }
}

/* And by Hertz and Mindlin. */
static void beside(int kind) {
    int i, k;
    for (k = 0; k < STEPS; k++) {
        for (i = 0; i < CONTACTS; i++) {
            asperity_real h, d[2], f[3];
            path(kind, i, k, &h, d);
            hertz_mindlin(spring[i], h, d, asperity_law.friction, f);
            sum += f[0] + f[1];
        }
    }
}

int main(int argc, char **argv) {
    static const char *const names[] = {"press with shear", "shear at constant depth", "press, unload, reverse", "open gap over a dent", "open gap, never touched"};
    static void (*const ways[])(int) = {alone, together, beside};
    int repeats = argc > 1 ? atoi(argv[1]) : 9, kind, way, r, i;
    repeats = repeats < 64 ? repeats : 64;
    printf("%d contacts at once; ns an update (median)\n%-26s %8s %8s %16s %8s %8s\n", ASPERITY_WIDTH, "", "alone", "at once", "Hertz-Mindlin", "alone/", "at once/");
    for (kind = 0; kind < 5; kind++) {
        double took[3][64];
        for (r = 0; r < repeats; r++) {
            for (way = 0; way < 3; way++) {
                double from;
                for (i = 0; i < CONTACTS; i++) {
                    depth[i] = ASPERITY_R(0.0005) * (ASPERITY_R(1.0) + ASPERITY_R(60.0) * ASPERITY_R(i) / ASPERITY_R(CONTACTS));
                    memset(&state[i], 0, sizeof state[i]);
                    spring[i][0] = spring[i][1] = 0;
                }
                from = seconds();
                ways[way](kind);
                took[way][r] = (seconds() - from) * 1e9 / CONTACTS / STEPS;
            }
        }
        for (way = 0; way < 3; way++) {
            qsort(took[way], (size_t)repeats, sizeof took[way][0], less);
        }
        r = repeats / 2;
        printf("%-26s %8.1f %8.1f %16.1f %8.1f %8.1f\n", names[kind], took[0][r], took[1][r], took[2][r], took[0][r] / took[2][r], took[1][r] / took[2][r]);
    }
    printf("state of a contact: %d numbers (sum %g)\n", (int)(sizeof(asperity_state) / sizeof(asperity_real)), (double)sum);
    return 0;
}
