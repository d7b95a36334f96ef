/* A table in the making: of a sphere of this radius, in the units of its material. */
typedef struct asperity_draft {
    double radius;
    double effective_modulus; /* E* = E/(1 - nu^2) */
    double log_first;         /* ln h of the first knot */
    double log_step;
    /* ln F_N0, ln a, F_N_slip/F_N0, ln delta_T_end, n, M, N, ln k_T */
    double table[ASPERITY_KNOTS][ASPERITY_COLUMNS];
} asperity_draft;

/* 3/2 for Hertz, 4/pi for a uniform pressure (Mesarovic & Johnson 2000), by how far the force has fallen below Hertz's at that radius. */
static inline double asperity_unloading_exponent(double radius, double effective_modulus, double a, double f_n0) {
    double hertz = 4.0 * effective_modulus * a * a * a / (3.0 * radius);
    double share = f_n0 < hertz ? f_n0 / hertz : 1.0;
    return 1.2732395447351628 + (1.5 - 1.2732395447351628) * share;
}

