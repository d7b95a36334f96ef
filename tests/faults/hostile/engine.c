/* Reads the table whose path comes in by line, follows contacts with what it takes, and answers each line with 1 or 0. */
#define ASPERITY_FROM_FILE
#include "asperity_contact.h"

#include <stdlib.h>

static asperity_table table;

static int follow(void) {
    static const double steps[][2] = {{0.0, 0.0}, {1e-12, 1e-12}, {1e-4, 0.0}, {1e-3, 1e-5}, {0.01, 1e-3}, {0.008, -1e-3}, {0.02, 0.02},
                                      {0.02, -0.1}, {0.3, 0.0}, {10.0, 1.0}, {1e300, 1e300}, {-1e300, 0.0}, {0.01, 1e-3}};
    asperity_state state;
    asperity_response response;
    size_t i;
    memset(&state, 0, sizeof state);
    for (i = 0; i < sizeof steps / sizeof *steps; i++) {
        double increment[2];
        increment[0] = steps[i][1];
        increment[1] = 0.3 * steps[i][1];
        asperity_update(&table, 1.0, 1.0, &state, steps[i][0], increment, &state, &response, NULL);
    }
    return 1;
}

int main(void) {
    char path[4096];
    while (fgets(path, sizeof path, stdin)) {
        path[strcspn(path, "\n")] = 0;
        printf("%d\n", asperity_read_table(path, &table) == 0 && follow());
        fflush(stdout);
    }
    return 0;
}
