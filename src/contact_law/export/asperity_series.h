/* Series: of one number or, where asperity_v is several, of each of them. No guard: included once for each form. */

/* ln(1 + r), |r| <= 1/64, by its series. */
ASPERITY_FN asperity_v asperity_log_series(asperity_v r) {
    asperity_v r2 = r * r, p, q;
    p = asperity_fma(r2, asperity_fma(r, 1.0 / 9.0, -1.0 / 8.0), asperity_fma(r, 1.0 / 7.0, -1.0 / 6.0));
    q = asperity_fma(r2, asperity_fma(r, 1.0 / 5.0, -1.0 / 4.0), asperity_fma(r, 1.0 / 3.0, -1.0 / 2.0));
    return asperity_fma(r2, asperity_fma(r2 * r2, p, q), r);
}

/* ln(1 + r) of a number that is small in most steps of time: then its series. */
ASPERITY_FN asperity_v asperity_log_near(asperity_v r) {
    asperity_m small = asperity_size(r) < 0.015625;
    asperity_v near = asperity_log_series(r);
    if (asperity_any(asperity_not(small))) {
        near = asperity_choose(small, near, asperity_logarithm(1.0 + r));
    }
    return near;
}

/* e^x of such a number. */
ASPERITY_FN asperity_v asperity_exponential_near(asperity_v x) {
    asperity_m small = asperity_size(x) <= 0.03125;
    asperity_v x2 = x * x, near, far;
    near = asperity_fma(x, 1.0 / 6.0, 1.0 / 2.0);
    far = asperity_fma(x2, asperity_fma(x, 1.0 / 5040.0, 1.0 / 720.0), asperity_fma(x, 1.0 / 120.0, 1.0 / 24.0));
    near = 1.0 + asperity_fma(x2, asperity_fma(x2, far, near), x);
    if (asperity_any(asperity_not(small))) {
        near = asperity_choose(small, near, asperity_exponential(x));
    }
    return near;
}
