// Elementary functions in either precision, from + - * / sqrt and ldexp alone: naga accepts WGSL's
// own transcendental functions in f64 and miscompiles them, and in f32 drivers are free to be wrong
// in the fourth digit. Names end in an underscore so that they shadow no builtin. Errors are
// measured against the CPU in tests/shader_math.rs.

const INVERSE_LN2: real = 1.4426950408889634;

// x 2^k in two steps, so that neither factor leaves the range of exponents.
fn scale_(x: real, k: i32) -> real {
    let bounded = clamp(k, -SCALE_LIMIT, SCALE_LIMIT);
    let half = bounded / 2i;
    return ldexp(ldexp(x, half), bounded - half);
}

// exp(r) - 1 for |r| <= 0.3466 by Taylor's series; the first term left out is r^15/15! < 1e-19.
fn expm1_series(r: real) -> real {
    var s: real = 1.0 / 87178291200.0;
    s = s * r + 1.0 / 6227020800.0;
    s = s * r + 1.0 / 479001600.0;
    s = s * r + 1.0 / 39916800.0;
    s = s * r + 1.0 / 3628800.0;
    s = s * r + 1.0 / 362880.0;
    s = s * r + 1.0 / 40320.0;
    s = s * r + 1.0 / 5040.0;
    s = s * r + 1.0 / 720.0;
    s = s * r + 1.0 / 120.0;
    s = s * r + 1.0 / 24.0;
    s = s * r + 1.0 / 6.0;
    s = s * r + 0.5;
    return r + r * r * s;
}

// exp(x) 2^k for |x| < 4000.
fn exp_scaled(x: real, k: i32) -> real {
    let n = round(x * INVERSE_LN2);
    let r = (x - n * LN2_HIGH) - n * LN2_LOW;
    return scale_(1.0 + expm1_series(r), i32(n) + k);
}

// exp(x): infinite above EXP_MAX, 0 below EXP_MIN, NaN for NaN.
fn exp_(x: real) -> real {
    if x > EXP_MAX {
        return REAL_MAX * x;
    }
    if x < EXP_MIN {
        return real(0.0);
    }
    return exp_scaled(x, 0i);
}

// exp(x) - 1, without cancellation near 0.
fn expm1_(x: real) -> real {
    if x > EXP_MAX {
        return REAL_MAX * x;
    }
    if x < -40.0 {
        return real(-1.0);
    }
    let n = round(x * INVERSE_LN2);
    let r = (x - n * LN2_HIGH) - n * LN2_LOW;
    if n == 0.0 {
        return expm1_series(r);
    }
    // 2^n (exp(r) - 1) + (2^n - 1), halved while 2^n itself may overflow
    let power = ldexp(real(0.5), i32(n));
    return 2.0 * (power * expm1_series(r) + (power - 0.5));
}

// ln(1 + f) for sqrt(1/2) <= 1 + f <= sqrt(2): f - (f^2/2 - s (f^2/2 + R)), s = f/(2 + f) (fdlibm
// e_log.c, with the series of 2 atanh(s) in place of its fitted polynomial); the first term left
// out is 2 s^24/25 < 1e-19.
fn log1p_series(f: real) -> real {
    let s = f / (2.0 + f);
    let z = s * s;
    var r: real = 2.0 / 23.0;
    r = r * z + 2.0 / 21.0;
    r = r * z + 2.0 / 19.0;
    r = r * z + 2.0 / 17.0;
    r = r * z + 2.0 / 15.0;
    r = r * z + 2.0 / 13.0;
    r = r * z + 2.0 / 11.0;
    r = r * z + 2.0 / 9.0;
    r = r * z + 2.0 / 7.0;
    r = r * z + 2.0 / 5.0;
    r = r * z + 2.0 / 3.0;
    let h = 0.5 * f * f;
    return f - (h - s * (h + z * r));
}

// x > 0 as (1 + fraction) 2^exponent with sqrt(1/2) <= 1 + fraction <= sqrt(2).
struct Split {
    fraction: real,
    exponent: i32,
}

fn split_(x: real) -> Split {
    var e = exponent(x);
    var m = scale_(x, -e);
    if m > 1.4142135623730951 {
        m *= 0.5;
        e += 1i;
    }
    return Split(m - 1.0, e);
}

// ln(x): -infinity at 0, NaN below. Subnormal x counts as 0 in f32.
fn log_(x: real) -> real {
    if x == 0.0 {
        return -1.0 / abs(x);
    }
    if !(x > 0.0) {
        return sqrt(x);
    }
    if x > REAL_MAX {
        return x;
    }
    let split = split_(x);
    let k = real(split.exponent);
    return k * LN2_HIGH + (log1p_series(split.fraction) + k * LN2_LOW);
}

// x^y for x >= 0: 0^0 = 1, 0^y = 0 for y > 0 and infinite for y < 0, NaN for x < 0 unless y = 0.
// With x = m 2^e the power of two is taken exactly, 2^(e y) = 2^k 2^(e y - k), so that for |y| <= 1
// (every hardening exponent) the error is that of exp and log over the whole range of x; beyond
// that it grows as |y|.
fn pow_(x: real, y: real) -> real {
    if y == 0.0 {
        return real(1.0);
    }
    if x == 0.0 {
        if y > 0.0 {
            return real(0.0);
        }
        return 1.0 / abs(x);
    }
    if !(x > 0.0) {
        return sqrt(x);
    }
    if abs(y) > 1000.0 || x > REAL_MAX {
        return exp_(y * log_(x));
    }
    let split = split_(x);
    let e = real(split.exponent);
    let k = round(e * y);
    if abs(k) > 4000.0 {
        return exp_(k);
    }
    let y_head = head(y);
    let rest = (e * y_head - k) + e * (y - y_head);
    return exp_scaled(rest * 0.6931471805599453 + y * log1p_series(split.fraction), i32(k));
}
