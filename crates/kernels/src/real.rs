//! The two floating-point precisions in which every mechanics kernel exists.
//!
//! The kernels (material, element, contact) are written once, generic over [`Real`], and
//! instantiated for `f64` (the reference) and `f32` (the twin of the device's single-precision
//! kernels).

use std::fmt::{Debug, Display};
use std::iter::Sum;
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

use wide::{f32x4, f32x8, f64x4, f64x8};

/// A floating-point number: `f32` or `f64`.
pub trait Real:
    Copy
    + Debug
    + Display
    + Default
    + PartialOrd
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + DivAssign
    + Sum
{
    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// The distance from 1 to the next larger number.
    const EPSILON: Self;
    /// The smallest positive normal number.
    const MIN_POSITIVE: Self;
    /// `"f32"` or `"f64"`.
    const NAME: &'static str;

    /// Rounds from `f64`.
    fn of(x: f64) -> Self;
    /// Widens (or keeps) to `f64`.
    fn to_f64(self) -> f64;
    /// Square root.
    fn sqrt(self) -> Self;
    /// Absolute value.
    fn abs(self) -> Self;
    /// The larger of two; a NaN argument is dropped.
    fn max(self, other: Self) -> Self;
    /// The smaller of two; a NaN argument is dropped.
    fn min(self, other: Self) -> Self;
    /// exp(x) - 1 without cancellation near 0.
    fn exp_m1(self) -> Self;
    /// ln(x).
    fn ln(self) -> Self;
    /// x^y.
    fn powf(self, y: Self) -> Self;
    /// a * b + self, fused where the machine can.
    fn mul_add(self, a: Self, b: Self) -> Self;
    /// Neither infinite nor NaN.
    fn is_finite(self) -> bool;

    /// Eight sums `a[q] + b[q]` at once; as the next five the same bits as one by one.
    #[inline(always)]
    fn add_eight(a: [Self; 8], b: [Self; 8]) -> [Self; 8] {
        std::array::from_fn(|q| a[q] + b[q])
    }
    /// Eight differences.
    #[inline(always)]
    fn sub_eight(a: [Self; 8], b: [Self; 8]) -> [Self; 8] {
        std::array::from_fn(|q| a[q] - b[q])
    }
    /// Eight products.
    #[inline(always)]
    fn mul_eight(a: [Self; 8], b: [Self; 8]) -> [Self; 8] {
        std::array::from_fn(|q| a[q] * b[q])
    }
    /// Eight quotients.
    #[inline(always)]
    fn div_eight(a: [Self; 8], b: [Self; 8]) -> [Self; 8] {
        std::array::from_fn(|q| a[q] / b[q])
    }
    /// Eight times `a[q] * b[q] + c[q]`, fused where the machine can.
    #[inline(always)]
    fn mul_add_eight(a: [Self; 8], b: [Self; 8], c: [Self; 8]) -> [Self; 8] {
        std::array::from_fn(|q| a[q].mul_add(b[q], c[q]))
    }
    /// Four times `a[i] * b[i] + c[i]`, fused where the machine can.
    #[inline(always)]
    fn mul_add_four(a: [Self; 4], b: [Self; 4], c: [Self; 4]) -> [Self; 4] {
        std::array::from_fn(|i| a[i].mul_add(b[i], c[i]))
    }
    /// Eight square roots.
    #[inline(always)]
    fn sqrt_eight(a: [Self; 8]) -> [Self; 8] {
        a.map(Self::sqrt)
    }
}

macro_rules! real {
    ($t:ident, $four:ident, $eight:ident) => {
        impl Real for $t {
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const EPSILON: Self = $t::EPSILON;
            const MIN_POSITIVE: Self = $t::MIN_POSITIVE;
            const NAME: &'static str = stringify!($t);
            #[inline(always)]
            fn of(x: f64) -> Self {
                x as $t
            }
            #[inline(always)]
            fn to_f64(self) -> f64 {
                f64::from(self)
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                $t::sqrt(self)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                $t::abs(self)
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                $t::max(self, other)
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                $t::min(self, other)
            }
            #[inline(always)]
            fn exp_m1(self) -> Self {
                $t::exp_m1(self)
            }
            #[inline(always)]
            fn ln(self) -> Self {
                $t::ln(self)
            }
            #[inline(always)]
            fn powf(self, y: Self) -> Self {
                $t::powf(self, y)
            }
            #[inline(always)]
            fn mul_add(self, a: Self, b: Self) -> Self {
                $t::mul_add(self, a, b)
            }
            #[inline(always)]
            fn is_finite(self) -> bool {
                $t::is_finite(self)
            }
            #[inline(always)]
            fn add_eight(a: [Self; 8], b: [Self; 8]) -> [Self; 8] {
                ($eight::from(a) + $eight::from(b)).to_array()
            }
            #[inline(always)]
            fn sub_eight(a: [Self; 8], b: [Self; 8]) -> [Self; 8] {
                ($eight::from(a) - $eight::from(b)).to_array()
            }
            #[inline(always)]
            fn mul_eight(a: [Self; 8], b: [Self; 8]) -> [Self; 8] {
                ($eight::from(a) * $eight::from(b)).to_array()
            }
            #[inline(always)]
            fn div_eight(a: [Self; 8], b: [Self; 8]) -> [Self; 8] {
                ($eight::from(a) / $eight::from(b)).to_array()
            }
            #[inline(always)]
            fn mul_add_eight(a: [Self; 8], b: [Self; 8], c: [Self; 8]) -> [Self; 8] {
                // Without the machine's fused product the vectors round twice and the scalars, by a
                // library call, once.
                if cfg!(target_feature = "fma") {
                    $eight::from(a).mul_add($eight::from(b), $eight::from(c)).to_array()
                } else {
                    std::array::from_fn(|q| $t::mul_add(a[q], b[q], c[q]))
                }
            }
            #[inline(always)]
            fn mul_add_four(a: [Self; 4], b: [Self; 4], c: [Self; 4]) -> [Self; 4] {
                if cfg!(target_feature = "fma") {
                    $four::from(a).mul_add($four::from(b), $four::from(c)).to_array()
                } else {
                    std::array::from_fn(|i| $t::mul_add(a[i], b[i], c[i]))
                }
            }
            #[inline(always)]
            fn sqrt_eight(a: [Self; 8]) -> [Self; 8] {
                $eight::from(a).sqrt().to_array()
            }
        }
    };
}

real!(f32, f32x4, f32x8);
real!(f64, f64x4, f64x8);
