/* Vectors of the machine's width, with what the update does with a number. No guard: included once. */

/* How many: of GNU's vectors; 1 without them. May be set before the header is included. */
#ifndef ASPERITY_WIDTH
#if !defined(__GNUC__) || defined(__CUDACC__)
#define ASPERITY_WIDTH 1
#elif defined(__AVX512F__) && defined(__AVX512DQ__)
#define ASPERITY_WIDTH 8
#elif defined(__AVX__)
#define ASPERITY_WIDTH 4
#elif defined(__SSE2__) || defined(__ARM_NEON)
#define ASPERITY_WIDTH 2
#else
#define ASPERITY_WIDTH 1
#endif
#endif

#if ASPERITY_WIDTH > 1

typedef double asperity_wide_v __attribute__((vector_size(8 * ASPERITY_WIDTH)));
typedef int64_t asperity_wide_m __attribute__((vector_size(8 * ASPERITY_WIDTH))); /* 0 or all bits */
typedef int64_t asperity_wide_i __attribute__((vector_size(8 * ASPERITY_WIDTH)));
typedef uint64_t asperity_wide_bits __attribute__((vector_size(8 * ASPERITY_WIDTH)));
typedef int32_t asperity_wide_short __attribute__((vector_size(4 * ASPERITY_WIDTH)));

/* Both sides are computed. */
#ifdef __cplusplus
#define asperity_wide_choose(mask, yes, no) ((mask) ? (yes) : (no))
#else
#define asperity_wide_choose(mask, yes, no) asperity_wide_mix(mask, yes, no)
ASPERITY_FN asperity_wide_v asperity_wide_mix(asperity_wide_m mask, asperity_wide_v yes, asperity_wide_v no) {
    return (asperity_wide_v)((mask & (asperity_wide_m)yes) | (~mask & (asperity_wide_m)no));
}
#endif
#define asperity_wide_put(mask, place, value) ((place) = asperity_wide_choose(mask, value, place))
#define asperity_wide_not(mask) (~(mask))
#define asperity_wide_fma(a, b, c) ((a) * (b) + (c))

ASPERITY_FN asperity_wide_v asperity_wide_all(double x) {
    asperity_wide_v zero = {0.0};
    return zero + x;
}

ASPERITY_FN asperity_wide_m asperity_wide_every(void) {
    asperity_wide_m none = {0};
    return ~none;
}

/* No place. */
ASPERITY_FN asperity_wide_i asperity_wide_nowhere(void) {
    asperity_wide_i none = {0};
    return ~none;
}

ASPERITY_FN int asperity_wide_any(asperity_wide_m mask) {
#if ASPERITY_WIDTH == 8 && defined(__AVX512DQ__)
    return _mm512_movepi64_mask((__m512i)mask) != 0;
#elif ASPERITY_WIDTH == 4 && defined(__AVX__)
    return _mm256_movemask_pd((__m256d)mask) != 0;
#else
    int64_t any = 0;
    int i;
    for (i = 0; i < ASPERITY_WIDTH; i++) {
        any |= mask[i];
    }
    return any != 0;
#endif
}

ASPERITY_FN asperity_wide_v asperity_wide_size(asperity_wide_v x) {
    return (asperity_wide_v)((asperity_wide_m)x & 0x7fffffffffffffffll);
}

ASPERITY_FN asperity_wide_m asperity_wide_are_finite(asperity_wide_v x) {
    return ((asperity_wide_m)x & 0x7ff0000000000000ll) != 0x7ff0000000000000ll;
}

/* Towards zero, of what an int holds; and back. */
ASPERITY_FN asperity_wide_i asperity_wide_whole(asperity_wide_v x) {
#if ASPERITY_WIDTH == 8 && defined(__AVX512DQ__)
    return __builtin_convertvector(x, asperity_wide_i);
#else
    return __builtin_convertvector(__builtin_convertvector(x, asperity_wide_short), asperity_wide_i);
#endif
}
ASPERITY_FN asperity_wide_v asperity_wide_number(asperity_wide_i i) {
#if ASPERITY_WIDTH == 8 && defined(__AVX512DQ__)
    return __builtin_convertvector(i, asperity_wide_v);
#else
    return __builtin_convertvector(__builtin_convertvector(i, asperity_wide_short), asperity_wide_v);
#endif
}

ASPERITY_FN asperity_wide_v asperity_wide_gather(const asperity_real *from, asperity_wide_i place) {
#if ASPERITY_WIDTH == 8 && defined(__AVX512F__) && !defined(ASPERITY_SINGLE)
    return (asperity_wide_v)_mm512_mask_i64gather_pd(_mm512_setzero_pd(), 0xff, (__m512i)place, from, 8);
#else
    asperity_wide_v x = {0.0};
    int i;
    for (i = 0; i < ASPERITY_WIDTH; i++) {
        x[i] = (double)from[place[i]];
    }
    return x;
#endif
}

ASPERITY_FN asperity_wide_v asperity_wide_inverse_root(asperity_wide_v x) {
#if ASPERITY_WIDTH == 8 && defined(__AVX512F__)
    asperity_wide_v half = 0.5 * x, y = (asperity_wide_v)_mm512_maskz_rsqrt14_pd(0xff, (__m512d)x);
    y *= 1.5 - half * y * y;
    y *= 1.5 - half * y * y;
#else
    asperity_wide_v half = 0.5 * x, y = (asperity_wide_v)(0x5fe6eb50c7b537a9ull - ((asperity_wide_bits)x >> 1));
    y *= 1.5 - half * y * y;
    y *= 1.5 - half * y * y;
    y *= 1.5 - half * y * y;
    y *= 1.5 - half * y * y;
#endif
    return y;
}

ASPERITY_FN asperity_wide_v asperity_wide_root(asperity_wide_v x) {
#if ASPERITY_WIDTH == 8 && defined(__AVX512F__)
    return (asperity_wide_v)_mm512_maskz_sqrt_pd(0xff, (__m512d)x);
#elif ASPERITY_WIDTH == 4 && defined(__AVX__)
    return (asperity_wide_v)_mm256_sqrt_pd((__m256d)x);
#else
    asperity_wide_v y;
    int i;
    for (i = 0; i < ASPERITY_WIDTH; i++) {
        y[i] = sqrt(x[i]);
    }
    return y;
#endif
}

/* e^x: of 2^k e^r, |r| <= ln 2/2, by the series. */
ASPERITY_FN asperity_wide_v asperity_wide_exponential(asperity_wide_v x) {
    asperity_wide_v r, r2, r4, a, b, c, k;
    asperity_wide_i whole;
    r = asperity_wide_choose(x < 700.0, x, asperity_wide_all(700.0));
    r = asperity_wide_choose(r > -700.0, r, asperity_wide_all(-700.0));
    whole = asperity_wide_whole(r * 1.4426950408889634 + 1024.5) - 1024;
    k = asperity_wide_number(whole);
    r = r - k * 0.6931471803691238;
    r = r - k * 1.9082149292705877e-10;
    r2 = r * r;
    r4 = r2 * r2;
    a = (1.0 / 6.0 * r + 0.5) + r2 * (1.0 / 120.0 * r + 1.0 / 24.0);
    b = (1.0 / 5040.0 * r + 1.0 / 720.0) + r2 * (1.0 / 362880.0 * r + 1.0 / 40320.0);
    c = (1.0 / 39916800.0 * r + 1.0 / 3628800.0) + r2 * (1.0 / 6227020800.0 * r + 1.0 / 479001600.0);
    a = a + r4 * (b + r4 * c);
    a = 1.0 + (r + r2 * a);
    return a * (asperity_wide_v)((asperity_wide_bits)(whole + 1023) << 52);
}

/* ln x: of 2^k m, 1/sqrt(2) <= m < sqrt(2), by the series of ln((1 + s)/(1 - s)) = ln m. */
ASPERITY_FN asperity_wide_v asperity_wide_logarithm(asperity_wide_v x) {
    asperity_wide_v least = asperity_wide_all(1e-300), m, s, z, z2, p, q;
    asperity_wide_i k;
    x = asperity_wide_choose(x > least, x, least);
    /* Biased by 2048, so that a shift without a sign does. */
    k = (asperity_wide_i)(((asperity_wide_bits)x - 0x3fe6a09e667f3bcdull + (2048ull << 52)) >> 52) - 2048;
    m = (asperity_wide_v)((asperity_wide_bits)x - ((asperity_wide_bits)k << 52));
    s = (m - 1.0) / (m + 1.0);
    z = s * s;
    z2 = z * z;
    p = (1.0 / 3.0 + z * (1.0 / 5.0)) + z2 * ((1.0 / 7.0 + z * (1.0 / 9.0)) + z2 * (1.0 / 11.0 + z * (1.0 / 13.0)));
    q = (1.0 / 15.0 + z * (1.0 / 17.0)) + z2 * (1.0 / 19.0 + z * (1.0 / 21.0));
    p = p + z2 * z2 * z2 * q;
    s = 2.0 * s;
    return asperity_wide_number(k) * 0.6931471805599453 + (s + s * z * p);
}

#if ASPERITY_WIDTH == 8 && defined(__AVX512F__) && !defined(ASPERITY_SINGLE)
#define ASPERITY_TRANSPOSES 1 /* gcc 12 warns of its own intrinsics unless they are the masked ones; all ones cost nothing */
/* Eight rows of eight numbers to eight columns. */
ASPERITY_FN void asperity_transpose(__m512d x[8]) {
    __m512d y[8];
    int i;
    for (i = 0; i < 4; i++) {
        y[2 * i] = _mm512_maskz_unpacklo_pd(0xff, x[2 * i], x[2 * i + 1]);
        y[2 * i + 1] = _mm512_maskz_unpackhi_pd(0xff, x[2 * i], x[2 * i + 1]);
    }
    for (i = 0; i < 2; i++) {
        x[i] = _mm512_maskz_shuffle_f64x2(0xff, y[i], y[2 + i], 0x88);
        x[2 + i] = _mm512_maskz_shuffle_f64x2(0xff, y[i], y[2 + i], 0xdd);
        x[4 + i] = _mm512_maskz_shuffle_f64x2(0xff, y[4 + i], y[6 + i], 0x88);
        x[6 + i] = _mm512_maskz_shuffle_f64x2(0xff, y[4 + i], y[6 + i], 0xdd);
    }
    for (i = 0; i < 4; i++) {
        y[i] = _mm512_maskz_shuffle_f64x2(0xff, x[i], x[4 + i], 0x88);
        y[4 + i] = _mm512_maskz_shuffle_f64x2(0xff, x[i], x[4 + i], 0xdd);
    }
    for (i = 0; i < 8; i++) {
        x[i] = y[i];
    }
}
#endif

/* Of each contact the numbers from a place on, up to 8. */
ASPERITY_FN void asperity_wide_gather_row(const asperity_real *from, asperity_wide_i place, int count, asperity_wide_v *to) {
#ifdef ASPERITY_TRANSPOSES
    __m512d x[8];
    int i;
    for (i = 0; i < 8; i++) {
        x[i] = _mm512_loadu_pd(from + place[i]);
    }
    asperity_transpose(x);
    for (i = 0; i < count; i++) {
        to[i] = (asperity_wide_v)x[i];
    }
#else
    int i;
    for (i = 0; i < count; i++) {
        to[i] = asperity_wide_gather(from + i, place);
    }
#endif
}

#endif
