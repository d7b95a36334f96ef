/* Coarse steps: up to six slips long, with sudden turns. How many plastic ones end off their equations, and by how much: ./unsolved law.asperity */
#include "asperity_contact.h"

static unsigned seed = 7;

static double drawn(void) {
    seed = seed * 1664525u + 1013904223u;
    return (seed >> 8) / 16777216.0;
}

int main(int argc, char **argv) {
    static asperity_table table;
    long flows = 0, unsolved = 0;
    double worst = 0.0;
    int contact, step;
    if (argc != 2 || asperity_read_table(argv[1], &table) != 0) {
        fprintf(stderr, "usage: unsolved law.asperity\n");
        return 2;
    }
    for (contact = 0; contact < 2000; contact++) {
        asperity_state state;
        asperity_response out;
        double h = 0.0, size = 3e-5 * (1 + contact % 8), x = 0.0, y = 0.0;
        memset(&state, 0, sizeof state);
        for (step = 0; step < 300; step++) {
            asperity_real d[2], before = state.hardened;
            if (step % 40 == 0) {
                x = 6.0 * (drawn() - 0.5);
                y = 6.0 * (drawn() - 0.5);
            }
            h += (drawn() - 0.35) * size;
            d[0] = ASPERITY_R(x * size);
            d[1] = ASPERITY_R(y * size);
            asperity_update(&table, ASPERITY_R(1.0), ASPERITY_R(1.0), &state, ASPERITY_R(h), d, &state, &out, NULL);
            flows += state.hardened > before;
            unsolved += out.unsolved > ASPERITY_R(0.0);
            worst = worst > (double)out.unsolved ? worst : (double)out.unsolved;
        }
    }
    printf("%ld plastic steps, %ld not solved, by at most %.3g\n", flows, unsolved, worst);
    return flows > 100000 && unsolved * 10000 < flows && worst < 0.1 ? 0 : 1;
}
