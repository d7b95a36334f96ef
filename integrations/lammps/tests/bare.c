/* The bare update as a library, to hold the plug-in against. */
#include "asperity_contact.h"

static asperity_table table;
static asperity_state state;

int bare_start(const char *path) {
    memset(&state, 0, sizeof state);
    return asperity_read_table(path, &table);
}

void bare_step(double radius, double modulus, double h, double d0, double d1, double *out) {
    asperity_response answer;
    double d[2];
    d[0] = d0;
    d[1] = d1;
    asperity_update(&table, radius, modulus, &state, h, d, &state, &answer, NULL);
    out[0] = answer.f_n;
    out[1] = answer.f_t[0];
    out[2] = answer.f_t[1];
    out[3] = answer.stored;
}
