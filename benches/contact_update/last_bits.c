/* How far the update amplifies differences in the last bits of its input: random steps of one contact, made twice, the second time with displacements rotated by 1e-15.
   cc -O2 -I LAW benches/contact_update/last_bits.c -o last_bits -lm && ./last_bits DEPTH LAW.asperity ...   (LAW: a folder of `asperity law export --format c`; DEPTH over R) */
#include "asperity_contact.h"

#include <stdlib.h>

enum { RUNS = 200, STEPS = 4000 };

static uint64_t seed = 1;

/* Even between 0 and 1 (xorshift*). */
static double draw(void) {
    seed ^= seed >> 12;
    seed ^= seed << 25;
    seed ^= seed >> 27;
    return (double)((seed * 2685821657736338717ULL) >> 11) / 9007199254740992.0;
}

static int rising(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double difference[RUNS * STEPS], run[STEPS];

int main(int argc, char **argv) {
    const double depth = argc > 1 ? atof(argv[1]) : 0.02;
    for (int file = 2; file < argc; file++) {
        static asperity_table table;
        int count = 0;
        if (asperity_read_table(argv[file], &table) != 0) return fprintf(stderr, "%s is not read\n", argv[file]), 1;
        for (int r = 0; r < RUNS; r++) {
            asperity_state first, second;
            double h = 0, greatest = 0, way = 0, angle = 0, to = 0;
            int left = 0, done = 0;
            memset(&first, 0, sizeof first);
            memset(&second, 0, sizeof second);
            for (int k = 0; k < STEPS; k++) {
                asperity_response one, other;
                double d[2], turned[2];
                if (left == 0) {
                    /* A leg of 5 to 60 steps: at this depth, out of contact, deeper, or somewhere between the dent and the depth; along some direction or none. */
                    const double kind = draw(), dent = first.h - (first.approach > 0 ? first.approach : 0);
                    left = 5 + (int)(55 * draw());
                    to = kind < 0.3 ? h : kind < 0.35 ? dent - 0.01 * depth : kind < 0.5 ? first.h_max + 0.1 * (depth - first.h_max) : dent + (first.h_max - dent) * draw();
                    if (first.h_max == 0) to = 0.1 * depth;
                    way = draw() < 0.3 ? 0 : 0.3 * depth * table.friction * draw() * draw() / left;
                    angle = 6.283185307179586 * draw();
                }
                h += (to - h) / left--;
                d[0] = way * cos(angle);
                d[1] = way * sin(angle);
                turned[0] = d[0] - 1e-15 * d[1];
                turned[1] = d[1] + 1e-15 * d[0];
                asperity_update(&table, 1.0, 1.0, &first, h, d, &first, &one, NULL);
                asperity_update(&table, 1.0, 1.0, &second, h, turned, &second, &other, NULL);
                if (one.f_n > greatest) greatest = one.f_n;
                if (one.f_n > 0 || other.f_n > 0)
                    run[done++] = fmax(fabs(one.f_n - other.f_n), hypot(one.f_t[0] - other.f_t[0], one.f_t[1] - other.f_t[1]));
            }
            for (int k = 0; k < done; k++) difference[count++] = run[k] / greatest;
        }
        qsort(difference, count, sizeof *difference, rising);
        printf("%s: %d steps in contact; difference over the greatest F_N: half %.1e, 99 %% %.1e, 99.9 %% %.1e, greatest %.1e\n", argv[file], count, difference[count / 2],
               difference[(int)(0.99 * count)], difference[(int)(0.999 * count)], difference[count - 1]);
    }
    return 0;
}
