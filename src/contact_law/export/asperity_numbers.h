/* Functions of one number, and what is the same for all contacts. No guard: included once. */

/* 1/sqrt(x), x >= 0, finite at 0: a first guess by the exponent's bits and Newton's steps. No call, no division: a compiler does it for several lanes whatever its flags. */
ASPERITY_FN double asperity_inverse_root(double x) {
    double half = 0.5 * x, y;
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    bits = 0x5fe6eb50c7b537a9ull - (bits >> 1);
    memcpy(&y, &bits, sizeof bits);
    y *= ASPERITY_FMA(-half * y, y, 1.5);
    y *= ASPERITY_FMA(-half * y, y, 1.5);
    y *= ASPERITY_FMA(-half * y, y, 1.5);
    y *= ASPERITY_FMA(-half * y, y, 1.5);
    return y;
}

/* ln x, x > 0, in line: of 2^k c (1 + r), with c from 32 places and |r| <= 1/64. */
ASPERITY_FN double asperity_logarithm(double x) {
    static const double inverse[32] = {
        1.4223978268922088, 1.391468746307456, 1.3618562535370686, 1.3334780249593055, 1.3062584608976362, 1.2801280128012802, 1.2550225896376046, 1.2308830328247804,
        1.207654650645305, 1.1852868044242475, 1.163732539879329, 1.1429482579925057, 1.122893420546364, 1.1035302861389817, 1.084823673058967, 1.066740745885131,
        1.0492508230867432, 1.0323252032520325, 1.0159370078740158, 1.0, 0.9699196326061997, 0.9413800562405364, 0.9144723412941417, 0.8890603897356743,
        0.8650228310502284, 0.8422510822510821, 0.8206477067236561, 0.8001250195343023, 0.7806038970697605, 0.7620127569099929, 0.7442866801893171, 0.7273666537517758};
    static const double log_c[32] = {
        -0.3523440580008923, -0.3303598412985515, -0.3088486614358244, -0.28779058528352974, -0.26716691395221637, -0.2469600829318592, -0.2271535721329931,
        -0.2077318246738307, -0.18868017341225488, -0.1699847743527869, -0.1516325461705557, -0.1336111151900369, -0.11590876523852209, -0.09851439186497558,
        -0.08141746047599635, -0.06460796799339279, -0.0480764076837151, -0.03181373684993537, -0.01581134711020277, 0.0, 0.030542063900505807, 0.06040833545244689,
        0.08940805622954394, 0.11759011581397946, 0.1449993781208599, 0.1716771117439915, 0.1976613642714418, 0.22298728910590676, 0.24768743184511172,
        0.2717919820839289, 0.2953289955317206, 0.31832459054884527};
    const uint64_t from = 0x3fe6400000000000ull;
    const int digits = 52;
    const double least = 1e-300, greatest = 1e300;
    int64_t away;
    uint64_t bits;
    double z, r, k;
    int place;
    if (!(x > least && x < greatest)) {
        return log(x);
    }
    memcpy(&bits, &x, sizeof bits);
    away = (int64_t)bits - (int64_t)from;
    place = (int)(away >> (digits - 5)) & 31;
    k = (double)(int)(away >> digits);
    bits -= (uint64_t)((away >> digits) * ((int64_t)1 << digits));
    memcpy(&z, &bits, sizeof z);
    r = ASPERITY_FMA(z, inverse[place], -1.0);
    return ASPERITY_FMA(k, 0.6931471805599453, log_c[place]) + asperity_log_series(r);
}

/* e^x of one number, in the range of the other: 2^(k/32) e^r. */
ASPERITY_FN double asperity_exponential(double x) {
    static const double root[32] = {
        1.0, 1.0218971486541166, 1.0442737824274138, 1.0671404006768237, 1.0905077326652577, 1.1143867425958924, 1.1387886347566916, 1.1637248587775775,
        1.189207115002721, 1.215247359980469, 1.241857812073484, 1.2690509571917332, 1.2968395546510096, 1.3252366431597413, 1.3542555469368927, 1.383909881963832,
        1.4142135623730951, 1.4451808069770467, 1.4768261459394993, 1.5091644275934228, 1.5422108254079407, 1.5759808451078865, 1.6104903319492543, 1.645755478153965,
        1.681792830507429, 1.718619298122478, 1.7562521603732995, 1.7947090750031072, 1.8340080864093424, 1.8741676341103, 1.9152065613971474, 1.9571441241754002};
    const double most = 700.0, high = 0.021660849335603416, low = 5.689487495325457e-11;
    const int digits = 52;
    double r = x, r2, scaled;
    uint64_t bits;
    int k;
    r = r < most ? r : most;
    r = r > -most ? r : -most;
    k = (int)(r * 46.16624130844683 + 32768.5) - 32768;
    r = ASPERITY_FMA((double)k, -low, ASPERITY_FMA((double)k, -high, r));
    r2 = r * r;
    scaled = root[k & 31];
    memcpy(&bits, &scaled, sizeof bits);
    bits += (uint64_t)(k >> 5) << digits;
    memcpy(&scaled, &bits, sizeof bits);
    x = ASPERITY_FMA(r2, ASPERITY_FMA(r2, 1.0 / 720.0, ASPERITY_FMA(r, 1.0 / 120.0, 1.0 / 24.0)), ASPERITY_FMA(r, 1.0 / 6.0, 1.0 / 2.0));
    return ASPERITY_FMA(scaled, ASPERITY_FMA(r2, x, r), scaled);
}

ASPERITY_FN void asperity_gather_row(const asperity_real *from, int place, int count, double *to) {
    int i;
    for (i = 0; i < count; i++) {
        to[i] = (double)from[place + i];
    }
}

/* Shares of the sliders in k_T: (i/7)^0.65 inside the end of cell i. */
ASPERITY_FN const double *asperity_weights(void) {
    static const double weight[ASPERITY_PADDED] = {
        0.28228007246945605, 0.16067234912498195, 0.1335715962968834, 0.11854658577836137, 0.10849433246541654, 0.10110285024062748, 0.09533221362427317, 0.0};
    return weight;
}

ASPERITY_FN const double *asperity_per_weights(void) {
    static const double per_weight[ASPERITY_PADDED] = {
        3.5425809241571757, 6.223846265060402, 7.486621615102558, 8.435502325386521, 9.21707131862172, 9.890917987178138, 10.489633692355417, 0.0};
    return per_weight;
}

/* Levers of the sliders in a twist, over the contact's radius: those of punches as wide as their cells. */
ASPERITY_FN const double *asperity_levers(void) {
    static const double lever[ASPERITY_PADDED] = {@LEVERS@, 0.0};
    return lever;
}

/* Where the sectors are pulled by a twist. */
ASPERITY_FN const double *asperity_around(int sector) {
    static const double around[ASPERITY_SECTORS][2] = {{0.0, 1.0}, {-1.0, 0.0}, {0.0, -1.0}, {1.0, 0.0}};
    return around[sector];
}
