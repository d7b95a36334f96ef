/* asperity_law_check.c: compares asperity_law.h with the test vectors, as C99 or C++17.
 *     cc -std=c99 -O2 asperity_law_check.c -lm && ./a.out asperity_law_vectors.csv
 * Prints the rows and the greatest error relative to each path's greatest value of the quantity; exits 0 if it is at most 1e-12. */
#include "asperity_law.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { INPUTS = 14, OUTPUTS = 12, TOTAL = INPUTS + OUTPUTS };

/* Greatest error of the path that ends, over the greatest value there. */
static double close_path(double worst, double error[OUTPUTS], double size[OUTPUTS]) {
    int k;
    for (k = 0; k < OUTPUTS; k++) {
        double relative = size[k] > 0.0 ? error[k] / size[k] : error[k];
        if (relative > worst) {
            worst = relative;
        }
        error[k] = size[k] = 0.0;
    }
    return worst;
}

int main(int argc, char **argv) {
    char line[4096];
    double column[TOTAL], error[OUTPUTS] = {0.0}, size[OUTPUTS] = {0.0}, worst = 0.0, path = -1.0;
    asperity_parameters *pair = (asperity_parameters *)malloc(sizeof(asperity_parameters));
    asperity_state state;
    long rows = 0;
    FILE *file = argc == 2 ? fopen(argv[1], "r") : NULL;
    if (!file || !pair || !fgets(line, sizeof line, file)) {
        fprintf(stderr, "usage: asperity_law_check VECTORS.csv\n");
        return 2;
    }
    memset(&state, 0, sizeof state);
    while (fgets(line, sizeof line, file)) {
        char *at = line;
        double ours[OUTPUTS];
        asperity_response out;
        asperity_state saved;
        int k;
        for (k = 0; k < TOTAL; k++) {
            char *end;
            column[k] = strtod(at, &end);
            if (end == at) {
                fprintf(stderr, "row %ld: column %d is no number\n", rows + 1, k + 1);
                return 2;
            }
            at = *end == ',' ? end + 1 : end;
        }
        if (column[0] != path) {
            asperity_material material;
            memset(&material, 0, sizeof material);
            material.youngs_modulus = column[1];
            material.poissons_ratio = column[2];
            material.hardening = (int)column[3];
            memcpy(material.hardening_numbers, column + 4, sizeof material.hardening_numbers);
            if (asperity_setup(pair, &material, column[7], column[8]) != 0) {
                fprintf(stderr, "row %ld: no set-up\n", rows + 1);
                return 1;
            }
            worst = close_path(worst, error, size);
            path = column[0];
            memset(&state, 0, sizeof state);
        }
        asperity_rotate(&state, column[12], column[13]);
        asperity_update(pair, &state, column[9], column + 10, &saved, &out);
        memcpy(&state, &saved, sizeof state);
        ours[0] = out.f_n;
        ours[1] = out.f_t[0];
        ours[2] = out.f_t[1];
        ours[3] = out.df_t_ddelta[0][0];
        ours[4] = out.df_t_ddelta[0][1];
        ours[5] = out.df_t_ddelta[1][0];
        ours[6] = out.df_t_ddelta[1][1];
        ours[7] = out.df_n_dh;
        ours[8] = out.df_n_ddelta[0];
        ours[9] = out.df_n_ddelta[1];
        ours[10] = out.a;
        ours[11] = asperity_stored_energy(pair, &state);
        for (k = 0; k < OUTPUTS; k++) {
            double difference = fabs(ours[k] - column[INPUTS + k]), value = fabs(column[INPUTS + k]);
            if (!(difference < HUGE_VAL)) {
                fprintf(stderr, "row %ld: not a finite number\n", rows + 1);
                return 1;
            }
            if (difference > error[k]) {
                error[k] = difference;
            }
            if (value > size[k]) {
                size[k] = value;
            }
        }
        rows++;
    }
    worst = close_path(worst, error, size);
    fclose(file);
    free(pair);
    printf("%ld rows, greatest relative error %.3g\n", rows, worst);
    return rows > 0 && worst <= 1e-12 ? 0 : 1;
}
