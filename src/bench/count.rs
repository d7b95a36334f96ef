//! Floating-point operations, counted by running the CPU's kernels on numbers that count.
//!
//! Every addition, subtraction, multiplication, division and square root is one operation, a fused
//! multiply-add two, a power, exponential or logarithm one; comparisons, signs and conversions are
//! none. What lanes that are already done compute along with the others counts: it is computed. A
//! device arranges some sums in another way (its tangent computes more and stores less); its rates
//! are told in the CPU's operations, so that they compare.

use std::cell::Cell;
use std::fmt;
use std::iter::Sum;
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

use crate::real::Real;

thread_local! {
    static OPERATIONS: Cell<u64> = const { Cell::new(0) };
}

/// The operations that `f` makes on [`Counted`] numbers in this thread, and its result.
pub fn operations<T>(f: impl FnOnce() -> T) -> (u64, T) {
    let before = OPERATIONS.get();
    let result = f();
    (OPERATIONS.get() - before, result)
}

fn tick(operations: u64) {
    OPERATIONS.set(OPERATIONS.get() + operations);
}

/// An `f64` that counts what is done with it.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct Counted(f64);

impl fmt::Display for Counted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

macro_rules! counted {
    ($($trait:ident $name:ident $assign:ident $assign_name:ident $op:tt),+) => {
        $(impl $trait for Counted {
            type Output = Self;
            fn $name(self, other: Self) -> Self {
                tick(1);
                Self(self.0 $op other.0)
            }
        }
        impl $assign for Counted {
            fn $assign_name(&mut self, other: Self) {
                *self = *self $op other;
            }
        })+
    };
}

counted!(Add add AddAssign add_assign +, Sub sub SubAssign sub_assign -, Mul mul MulAssign mul_assign *, Div div DivAssign div_assign /);

impl Neg for Counted {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Sum for Counted {
    fn sum<I: Iterator<Item = Self>>(numbers: I) -> Self {
        numbers.fold(Self(0.0), |sum, x| sum + x)
    }
}

impl Real for Counted {
    const ZERO: Self = Self(0.0);
    const ONE: Self = Self(1.0);
    const EPSILON: Self = Self(f64::EPSILON);
    const MIN_POSITIVE: Self = Self(f64::MIN_POSITIVE);
    const NAME: &'static str = "counted f64";

    fn of(x: f64) -> Self {
        Self(x)
    }
    fn to_f64(self) -> f64 {
        self.0
    }
    fn sqrt(self) -> Self {
        tick(1);
        Self(self.0.sqrt())
    }
    fn abs(self) -> Self {
        Self(self.0.abs())
    }
    fn max(self, other: Self) -> Self {
        Self(self.0.max(other.0))
    }
    fn min(self, other: Self) -> Self {
        Self(self.0.min(other.0))
    }
    fn exp_m1(self) -> Self {
        tick(1);
        Self(self.0.exp_m1())
    }
    fn ln(self) -> Self {
        tick(1);
        Self(self.0.ln())
    }
    fn powf(self, y: Self) -> Self {
        tick(1);
        Self(self.0.powf(y.0))
    }
    fn mul_add(self, a: Self, b: Self) -> Self {
        tick(2);
        Self(self.0.mul_add(a.0, b.0))
    }
    fn is_finite(self) -> bool {
        self.0.is_finite()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::Lanes;
    use crate::material::j2::{deviator, norm_squared};

    #[test]
    fn operations_are_those_of_the_formula() {
        let a: [Counted; 6] = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0].map(Counted);
        // three squares and two sums of the shear; three squares and four sums of the rest
        let (n, norm) = operations(|| norm_squared(&a));
        assert_eq!((n, norm), (12, Counted(168.0)));
        // two sums and a product for the mean, three differences
        assert_eq!(operations(|| deviator(&a)).0, 6);
        // eight side by side are eight times as many
        assert_eq!(operations(|| norm_squared(&a.map(Lanes::splat))).0, 8 * 12);
        assert_eq!(operations(|| Counted(4.0).sqrt().mul_add(Counted(1.0), -Counted(2.0)).abs()).0, 3);
    }
}
