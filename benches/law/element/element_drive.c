/* Drives the element along paths, for fit_element.py: element_drive INCREMENTS LAW.asperity... < paths and sets of constants.
 *
 * First the number of paths, then each as `law places` and its places `h d[0] d[1]`. Then, until the end of the input, sets of constants (where it is built with
 * ELEMENT_FIT; one number that is not used otherwise): each answers F_N and both of F_T at all places. */
#include <stdio.h>
#include <stdlib.h>
#ifdef ELEMENT_FIT
static double constants[ELEMENT_FIT];
#else
#define ELEMENT_FIT 1
static double constants[ELEMENT_FIT];
#endif
#include "element_table.h"

static asperity_table laws[64];
static element_table tables[64];
static double (*places)[3];
static int *of, *counts;

int main(int argc, char **argv) {
    int increments = argc > 1 ? atoi(argv[1]) : 0, contacts = argc - 2, paths, i, k, n, all = 0, room = 1 << 16;
    places = malloc(room * sizeof *places);
    if (increments < 1 || contacts < 1 || contacts > 64 || scanf("%d", &paths) != 1 || !places) {
        return 2;
    }
    of = malloc(paths * sizeof *of);
    counts = malloc(paths * sizeof *counts);
    for (i = 0; i < contacts; i++) {
        if (asperity_read_table(argv[i + 2], &laws[i]) != 0) {
            fprintf(stderr, "%s cannot be read\n", argv[i + 2]);
            return 2;
        }
    }
    for (n = 0; n < paths; n++) {
        if (scanf("%d %d", &of[n], &counts[n]) != 2) {
            return 2;
        }
        for (i = 0; i < counts[n]; i++, all++) {
            if (all == room) {
                places = realloc(places, (room *= 2) * sizeof *places);
            }
            if (!places || scanf("%lf %lf %lf", &places[all][0], &places[all][1], &places[all][2]) != 3) {
                return 2;
            }
        }
    }
    for (;;) {
        for (i = 0; i < ELEMENT_FIT; i++) {
            if (scanf("%lf", &constants[i]) != 1) {
                return 0;
            }
        }
        for (i = 0; i < contacts; i++) {
            if (!element_make_table(&laws[i], &tables[i])) {
                return 2;
            }
        }
        for (n = 0, all = 0; n < paths; n++) {
            element_state state;
            element_response out;
            double at[3] = {0.0, 0.0, 0.0};
            memset(&state, 0, sizeof state);
            for (i = 0; i < counts[n]; i++, all++) {
                const double *to = places[all];
                double step[2] = {(to[1] - at[1]) / increments, (to[2] - at[2]) / increments};
                for (k = 1; k <= increments; k++) {
                    element_update(&tables[of[n]], &state, at[0] + (to[0] - at[0]) * k / increments, step, &state, &out, NULL);
                }
                printf("%.9g %.9g %.9g\n", out.f_n, out.f_t[0], out.f_t[1]);
                memcpy(at, to, sizeof at);
            }
        }
        fflush(stdout);
    }
}
