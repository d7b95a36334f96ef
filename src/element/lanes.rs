//! Eight numbers side by side, one a quadrature point: the form in which the element does its arithmetic, so that the compiler
//! turns each operation into vector instructions.

use std::ops::{Add, AddAssign, Mul, Neg, Sub};

use crate::real::Real;

/// One number for each of an element's eight quadrature points.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub struct Lanes<R>(pub [R; 8]);

impl<R: Real> Lanes<R> {
    /// Eight zeros.
    pub const ZERO: Self = Self([R::ZERO; 8]);

    /// The same number in every lane.
    #[inline(always)]
    pub fn splat(x: R) -> Self {
        Self([x; 8])
    }

    /// The number that `f` gives for each lane.
    #[inline(always)]
    pub fn from_fn(f: impl FnMut(usize) -> R) -> Self {
        Self(std::array::from_fn(f))
    }

    /// `self + a * b`, fused where the machine can.
    #[inline(always)]
    pub fn plus(self, a: Self, b: Self) -> Self {
        let mut out = self;
        for q in 0..8 {
            out.0[q] = a.0[q].mul_add(b.0[q], out.0[q]);
        }
        out
    }

    /// `self + s * b` with one number for all lanes.
    #[inline(always)]
    pub fn plus_scaled(self, s: R, b: Self) -> Self {
        let mut out = self;
        for q in 0..8 {
            out.0[q] = s.mul_add(b.0[q], out.0[q]);
        }
        out
    }

    /// 1 / self.
    #[inline(always)]
    pub fn reciprocal(self) -> Self {
        Self(self.0.map(|x| R::ONE / x))
    }

    /// The sum of the lanes, always in the same order.
    #[inline(always)]
    pub fn sum(self) -> R {
        let x = self.0;
        ((x[0] + x[4]) + (x[2] + x[6])) + ((x[1] + x[5]) + (x[3] + x[7]))
    }
}

macro_rules! lanewise {
    ($trait:ident, $name:ident, $op:tt) => {
        impl<R: Real> $trait for Lanes<R> {
            type Output = Self;
            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                let mut out = self;
                for q in 0..8 {
                    out.0[q] = self.0[q] $op other.0[q];
                }
                out
            }
        }
    };
}

lanewise!(Add, add, +);
lanewise!(Sub, sub, -);
lanewise!(Mul, mul, *);

impl<R: Real> AddAssign for Lanes<R> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<R: Real> Neg for Lanes<R> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(self.0.map(|x| -x))
    }
}
