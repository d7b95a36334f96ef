//! Eight numbers side by side, one a quadrature point: the form in which the element does its
//! arithmetic, in the machine's vector instructions.
//!
//! [`Number`] is what one number and eight have in common: a kernel written for it takes either,
//! and does the same to each of the eight as to one alone, bit for bit.

use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

use crate::real::Real;

/// An array of what `f` gives for each place; `any` only fills it before. Always compiled in line,
/// which [`std::array::from_fn`] and `map` are not: in the element's kernels they then hand each
/// number through memory.
#[inline(always)]
pub fn array<T: Copy, const N: usize>(any: T, mut f: impl FnMut(usize) -> T) -> [T; N] {
    let mut out = [any; N];
    for (i, out) in out.iter_mut().enumerate() {
        *out = f(i);
    }
    out
}

/// One number ([`Real`]) or eight side by side ([`Lanes`]).
pub trait Number:
    Copy
    + Debug
    + PartialEq
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
{
    /// The number itself, or one of the eight.
    type Scalar: Real;
    /// A yes or no for each.
    type Mask: Copy + Debug + PartialEq;
    /// How many there are.
    const COUNT: usize;

    /// The same number everywhere.
    fn splat(x: Self::Scalar) -> Self;
    /// What `f` gives for each.
    fn from_fn(f: impl FnMut(usize) -> Self::Scalar) -> Self;
    /// The `i`-th.
    fn lane(self, i: usize) -> Self::Scalar;
    /// Square root.
    fn sqrt(self) -> Self;
    /// Absolute value.
    fn abs(self) -> Self;
    /// The larger of two; a NaN argument is dropped.
    fn max(self, other: Self) -> Self;
    /// Where `self <= other`; nowhere for a NaN.
    fn at_most(self, other: Self) -> Self::Mask;
    /// Where `self > other`; nowhere for a NaN.
    fn above(self, other: Self) -> Self::Mask;
    /// Where it is neither infinite nor NaN.
    fn finite(self) -> Self::Mask;
    /// `yes` where the mask says so, else `no`.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// The opposite of a mask.
    fn not(mask: Self::Mask) -> Self::Mask;
    /// Where both say yes.
    fn and(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// Whether any says yes.
    fn any(mask: Self::Mask) -> bool;
    /// What the mask says of the `i`-th.
    fn is_set(mask: Self::Mask, i: usize) -> bool;

    /// The same number everywhere, rounded from `f64`.
    #[inline(always)]
    fn of(x: f64) -> Self {
        Self::splat(<Self::Scalar as Real>::of(x))
    }

    /// Whether all say yes.
    #[inline(always)]
    fn all(mask: Self::Mask) -> bool {
        !Self::any(Self::not(mask))
    }
}

impl<R: Real> Number for R {
    type Scalar = R;
    type Mask = bool;
    const COUNT: usize = 1;

    #[inline(always)]
    fn splat(x: R) -> R {
        x
    }
    #[inline(always)]
    fn from_fn(mut f: impl FnMut(usize) -> R) -> R {
        f(0)
    }
    #[inline(always)]
    fn lane(self, _: usize) -> R {
        self
    }
    #[inline(always)]
    fn sqrt(self) -> R {
        Real::sqrt(self)
    }
    #[inline(always)]
    fn abs(self) -> R {
        Real::abs(self)
    }
    #[inline(always)]
    fn max(self, other: R) -> R {
        Real::max(self, other)
    }
    #[inline(always)]
    fn at_most(self, other: R) -> bool {
        self <= other
    }
    #[inline(always)]
    fn above(self, other: R) -> bool {
        self > other
    }
    #[inline(always)]
    fn finite(self) -> bool {
        self.is_finite()
    }
    #[inline(always)]
    fn select(mask: bool, yes: R, no: R) -> R {
        if mask { yes } else { no }
    }
    #[inline(always)]
    fn not(mask: bool) -> bool {
        !mask
    }
    #[inline(always)]
    fn and(a: bool, b: bool) -> bool {
        a && b
    }
    #[inline(always)]
    fn any(mask: bool) -> bool {
        mask
    }
    #[inline(always)]
    fn is_set(mask: bool, _: usize) -> bool {
        mask
    }
}

/// One number for each of an element's eight quadrature points.
// Aligned to a vector register, and no wider than eight f32: padding would double what single
// precision moves.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(32))]
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
        Self(array(R::ZERO, f))
    }

    /// `self + a * b`, fused where the machine can.
    #[inline(always)]
    pub fn plus(self, a: Self, b: Self) -> Self {
        Self(R::mul_add_eight(a.0, b.0, self.0))
    }

    /// `self + s * b` with one number for all lanes.
    #[inline(always)]
    pub fn plus_scaled(self, s: R, b: Self) -> Self {
        Self(R::mul_add_eight([s; 8], b.0, self.0))
    }

    /// 1 / self.
    #[inline(always)]
    pub fn reciprocal(self) -> Self {
        Self(R::div_eight([R::ONE; 8], self.0))
    }

    /// The sum of the lanes, always in the same order.
    #[inline(always)]
    pub fn sum(self) -> R {
        let x = self.0;
        ((x[0] + x[4]) + (x[2] + x[6])) + ((x[1] + x[5]) + (x[3] + x[7]))
    }
}

macro_rules! lanewise {
    ($trait:ident, $name:ident, $eight:ident) => {
        impl<R: Real> $trait for Lanes<R> {
            type Output = Self;
            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                Self(R::$eight(self.0, other.0))
            }
        }
    };
}

lanewise!(Add, add, add_eight);
lanewise!(Sub, sub, sub_eight);
lanewise!(Mul, mul, mul_eight);
lanewise!(Div, div, div_eight);

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
        Self(array(R::ZERO, |q| -self.0[q]))
    }
}

impl<R: Real> Number for Lanes<R> {
    type Scalar = R;
    type Mask = [bool; 8];
    const COUNT: usize = 8;

    #[inline(always)]
    fn splat(x: R) -> Self {
        Self([x; 8])
    }
    #[inline(always)]
    fn from_fn(f: impl FnMut(usize) -> R) -> Self {
        Self(array(R::ZERO, f))
    }
    #[inline(always)]
    fn lane(self, i: usize) -> R {
        self.0[i]
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(R::sqrt_eight(self.0))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(array(R::ZERO, |q| self.0[q].abs()))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(array(R::ZERO, |q| self.0[q].max(other.0[q])))
    }
    #[inline(always)]
    fn at_most(self, other: Self) -> [bool; 8] {
        array(false, |q| self.0[q] <= other.0[q])
    }
    #[inline(always)]
    fn above(self, other: Self) -> [bool; 8] {
        array(false, |q| self.0[q] > other.0[q])
    }
    #[inline(always)]
    fn finite(self) -> [bool; 8] {
        array(false, |q| self.0[q].is_finite())
    }
    #[inline(always)]
    fn select(mask: [bool; 8], yes: Self, no: Self) -> Self {
        Self(array(R::ZERO, |q| if mask[q] { yes.0[q] } else { no.0[q] }))
    }
    #[inline(always)]
    fn not(mask: [bool; 8]) -> [bool; 8] {
        array(false, |q| !mask[q])
    }
    #[inline(always)]
    fn and(a: [bool; 8], b: [bool; 8]) -> [bool; 8] {
        array(false, |q| a[q] & b[q])
    }
    #[inline(always)]
    fn any(mask: [bool; 8]) -> bool {
        mask.iter().fold(false, |any, &x| any | x)
    }
    #[inline(always)]
    fn is_set(mask: [bool; 8], i: usize) -> bool {
        mask[i]
    }
}
