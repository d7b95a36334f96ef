// What single precision has to itself; every other module is shared between the precisions.
alias real = f32;

const REAL_EPSILON: real = 1.1920929e-7;      // distance from 1 to the next larger number
const SQRT_EPSILON: real = 3.4526698e-4;       // its square root
const REAL_MAX: real = 3.4028234e38;          // largest finite number
const EXP_MAX: real = 88.72284;               // ln(REAL_MAX)
const EXP_MIN: real = -104.0;                 // below ln of the smallest subnormal number
const LN2_HIGH: real = 0.693359375;           // ln 2 in two parts; k * LN2_HIGH is exact for |k| < 2^15 (Cody & Waite 1980)
const LN2_LOW: real = -2.1219444e-4;
const SCALE_LIMIT: i32 = 252;                 // two halves of it are exponents of normal numbers

// floor(log2(x)) of a normal x > 0.
fn exponent(x: real) -> i32 {
    return i32((bitcast<u32>(x) >> 23u) & 0xffu) - 127;
}

// x with its last 12 bits dropped: times an exponent it is exact.
fn head(x: real) -> real {
    return bitcast<f32>(bitcast<u32>(x) & 0xfffff000u);
}

// Neither infinite nor NaN. A bit test: comparisons may be compiled on the assumption that there
// are no NaNs.
fn is_finite(x: real) -> bool {
    return (bitcast<u32>(x) & 0x7f800000u) != 0x7f800000u;
}

// The bits of a number in single precision, in which linear systems are solved.
fn single_bits(x: real) -> u32 {
    return bitcast<u32>(f32(x));
}

// The number that bits of single precision are.
fn real_of_single(bits: u32) -> real {
    return real(bitcast<f32>(bits));
}

const REAL_IS_SINGLE: bool = true;
