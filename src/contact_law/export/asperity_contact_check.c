/* @NAME@: compares asperity_contact.h with the test vectors, as C99 or C++17, in double or (-DASPERITY_SINGLE) in float.
 *     cc -std=c99 -O2 @NAME@ -lm && ./a.out asperity_law_vectors.csv [law.asperity]
 * Uses the constant of asperity_law.h, or the file. Prints the rows and the greatest errors of forces and energy, and of derivatives and radius, relative to each path's greatest value of
 * the quantity; and the greatest by which a contact that asperity_update_many() moves among others, to the same bits in every place, is off one that asperity_update() moves, over F_N,
 * which is at most 1e-8 in double. Exits 0 if they are at most 1e-9 and 1e-6 in double, but for derivatives of one row in 200, and if the former are
 * at most 5e-3 in float, which is 1e-5 as a rule and more where a step is at the edge of yielding. */
#include "asperity_law.h"

#include <stdlib.h>

enum { INPUTS = 14, OUTPUTS = 14, TOTAL = INPUTS + OUTPUTS };

/* Greatest errors of the path that ends, over the greatest value there: 1 of the derivatives and the radius (columns 3 to 12), 0 of forces and energy. */
static void close_path(double worst[2], double error[OUTPUTS], double size[OUTPUTS]) {
    int k;
    double slip = size[1] > size[2] ? size[1] : size[2], stiffness = size[3] > size[6] ? size[3] : size[6];
    stiffness = stiffness > size[7] ? stiffness : size[7];
    size[1] = size[2] = slip;
    for (k = 3; k <= 11; k++) {
        size[k] = stiffness;
    }
    for (k = 0; k < OUTPUTS; k++) {
        double relative = size[k] > 0.0 ? error[k] / size[k] : error[k];
        int derivative = k >= 3 && k <= 12;
        if (relative > worst[derivative]) {
            worst[derivative] = relative;
        }
        error[k] = size[k] = 0.0;
    }
}

/* By how much a contact that is moved among others is off the one that is moved alone, over the force; huge where its place or its neighbours matter. */
static double among_others(const asperity_table *table, const double column[TOTAL], const asperity_state *state, const asperity_state *alone, const asperity_response *answer) {
    enum { SEVERAL = 11 };
    static asperity_state rest;
    asperity_state next[SEVERAL];
    asperity_increment one[SEVERAL];
    double worst, size = fabs((double)answer->f_n);
    int k;
    for (k = 0; k < SEVERAL; k++) {
        const int other = k % 5 == 1;
        one[k].state = other ? &rest : state;
        one[k].next = &next[k];
        one[k].radius = ASPERITY_R(column[7]);
        one[k].h = ASPERITY_R(other ? 0.5 * column[9] : column[9]);
        one[k].d[0] = ASPERITY_R(column[10]);
        one[k].d[1] = ASPERITY_R(column[11]);
    }
    asperity_update_many(table, ASPERITY_R(column[1]), SEVERAL, one);
    rest = next[1];
    for (k = 1; k < SEVERAL; k++) {
        if (one[k].state == state && (memcmp(&one[k].out, &one[0].out, sizeof one[k].out) != 0 || memcmp(&next[k], &next[0], sizeof next[k]) != 0)) {
            return HUGE_VAL;
        }
    }
    worst = fabs((double)(one[0].out.f_n - answer->f_n));
    for (k = 0; k < 2; k++) {
        double off = fabs((double)(one[0].out.f_t[k] - answer->f_t[k]));
        worst = worst > off ? worst : off;
    }
    return size > 0.0 && alone->approach > ASPERITY_R(0.0) ? worst / size : worst;
}

int main(int argc, char **argv) {
    char line[4096];
    double column[TOTAL], error[OUTPUTS] = {0.0}, size[OUTPUTS] = {0.0}, worst[2] = {0.0, 0.0}, path = -1.0;
    static asperity_table read;
    const asperity_table *table = &asperity_law;
    asperity_state state;
    long rows = 0, kinks = 0;
    double many = 0.0, off;
    FILE *file = argc == 2 || argc == 3 ? fopen(argv[1], "r") : NULL;
    if (!file || !fgets(line, sizeof line, file)) {
        fprintf(stderr, "usage: asperity_contact_check VECTORS.csv [law.asperity]\n");
        return 2;
    }
    if (argc == 3) {
        int code = asperity_read_table(argv[2], &read);
        if (code != 0) {
            fprintf(stderr, "%s: %s\n", argv[2], code == 1 ? "cannot be opened" : code == 2 ? "is no contact table of this version" : "is damaged");
            return 2;
        }
        table = &read;
    }
    memset(&state, 0, sizeof state);
    while (fgets(line, sizeof line, file)) {
        char *at = line;
        double ours[OUTPUTS];
        int kink = 0;
        asperity_real d[2];
        asperity_response out;
        asperity_tangent tangent;
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
            close_path(worst, error, size);
            path = column[0];
            memset(&state, 0, sizeof state);
        }
        asperity_rotate(&state, ASPERITY_R(column[12]), ASPERITY_R(column[13]));
        d[0] = ASPERITY_R(column[10]);
        d[1] = ASPERITY_R(column[11]);
        asperity_update(table, ASPERITY_R(column[7]), ASPERITY_R(column[1]), &state, ASPERITY_R(column[9]), d, &saved, &out, &tangent);
        off = among_others(table, column, &state, &saved, &out);
        many = off > many ? off : many;
        memcpy(&state, &saved, sizeof state);
        ours[0] = out.f_n;
        ours[1] = out.f_t[0];
        ours[2] = out.f_t[1];
        ours[3] = tangent.df_t_ddelta[0][0];
        ours[4] = tangent.df_t_ddelta[0][1];
        ours[5] = tangent.df_t_ddelta[1][0];
        ours[6] = tangent.df_t_ddelta[1][1];
        ours[7] = tangent.df_n_dh;
        ours[8] = tangent.df_n_ddelta[0];
        ours[9] = tangent.df_n_ddelta[1];
        ours[10] = tangent.df_t_dh[0];
        ours[11] = tangent.df_t_dh[1];
        ours[12] = tangent.a;
        ours[13] = asperity_stored_energy(table, ASPERITY_R(column[7]), ASPERITY_R(column[1]), &state);
        for (k = 0; k < OUTPUTS; k++) {
            double difference = fabs(ours[k] - column[INPUTS + k]), value = fabs(column[INPUTS + k]);
            if (!(difference < HUGE_VAL)) {
                fprintf(stderr, "row %ld: not a finite number\n", rows + 1);
                return 1;
            }
            /* Where a slider begins to slip, rounding chooses the side that the derivatives are of. */
            if (k >= 3 && k <= 12 && difference > 1e-6 * (value > size[k] ? value : size[k])) {
                kink = 1;
            } else if (difference > error[k]) {
                error[k] = difference;
            }
            if (value > size[k]) {
                size[k] = value;
            }
        }
        rows++;
        kinks += kink;
    }
    close_path(worst, error, size);
    fclose(file);
    printf("%ld rows, greatest relative error of forces %.3g, of derivatives %.3g but for %ld rows; of several at once, over those of each alone, %.3g\n", rows, worst[0], worst[1], kinks, many);
    if (sizeof(asperity_real) == sizeof(float)) {
        return rows > 0 && worst[0] <= 5e-3 && many <= 5e-3 ? 0 : 1;
    }
    return rows > 0 && worst[0] <= 1e-9 && many <= 1e-8 && worst[1] <= 1e-6 && 200 * kinks <= rows ? 0 : 1;
}
