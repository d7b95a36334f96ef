// What double precision has to itself; every other module is shared between the precisions.
alias real = f64;

const REAL_EPSILON: real = 2.220446049250313e-16;   // distance from 1 to the next larger number
const SQRT_EPSILON: real = 1.4901161193847656e-8;    // its square root
const REAL_MAX: real = 1.7976931348623157e308;      // largest finite number
const EXP_MAX: real = 709.782712893384;             // ln(REAL_MAX)
const EXP_MIN: real = -745.2;                       // below ln of the smallest subnormal number
const LN2_HIGH: real = 6.93147180369123816490e-01;  // ln 2 in two parts; k * LN2_HIGH is exact for |k| < 2^20 (fdlibm e_log.c)
const LN2_LOW: real = 1.90821492927058770002e-10;
const SCALE_LIMIT: i32 = 2044;                      // two halves of it are exponents of normal numbers

// floor(log2(x)) of x > 0, or one more where x rounds up to a power of two in f32. WGSL has no bits
// of an f64: x is brought into the range of f32 (in no step at all for 1e-30 < x < 1e30) and read
// there.
fn exponent(x: real) -> i32 {
    var y = x;
    var e = 0i;
    for (var i = 0i; i < 11i && y >= 1.2676506002282294e30; i++) {
        y *= 7.888609052210118e-31;
        e += 100i;
    }
    for (var i = 0i; i < 11i && y <= 7.888609052210118e-31; i++) {
        y *= 1.2676506002282294e30;
        e -= 100i;
    }
    return e + i32((bitcast<u32>(f32(y)) >> 23u) & 0xffu) - 127i;
}

// x rounded to the 24 bits of f32 (|x| < 3e38): times an exponent it is exact.
fn head(x: real) -> real {
    return real(f32(x));
}

// Neither infinite nor NaN. A NaN stays one in f32, where a bit test sees it: comparisons may be
// compiled on the assumption that there are none.
fn is_finite(x: real) -> bool {
    return abs(x) <= REAL_MAX && (bitcast<u32>(f32(x)) & 0x7fffffffu) <= 0x7f800000u;
}

// The bits of a number in single precision, in which linear systems are solved.
fn single_bits(x: real) -> u32 {
    return bitcast<u32>(f32(x));
}

// The number that bits of single precision are.
fn real_of_single(bits: u32) -> real {
    return real(bitcast<f32>(bits));
}

const REAL_IS_SINGLE: bool = false;
