//! The material: isochoric-volumetric hyperelasticity with multiplicative J2 plasticity at one
//! point.
//!
//! Strain energy per reference volume, Simo & Hughes, *Computational Inelasticity* (1998), eq.
//! 9.2.6:
//! ```text
//! U(J) + W(b_e_bar) = kappa/2 [ (J^2 - 1)/2 - ln J ] + mu/2 [ tr b_e_bar - 3 ],     b_e_bar = J^(-2/3) b_e,
//! ```
//! so that the Kirchhoff stress is `tau = J U'(J) 1 + mu dev b_e_bar`. The point yields when the
//! von Mises stress of `tau` reaches the flow stress `sigma(alpha)`, `|dev tau| = sqrt(2/3)
//! sigma(alpha)`; `alpha` is the equivalent plastic strain.
//!
//! [`j2`] holds the deviatoric half (the return mapping and its tangent), [`hardening`] the laws
//! `sigma(alpha)`, and this file the volumetric half, which the element evaluates once for its mean
//! dilatation. Kernels are generic over [`Real`], allocate nothing and report a bad deformation as
//! a [`PointError`].
//!
//! Symmetric tensors are `[xx, yy, zz, xy, yz, zx]`, tensor components everywhere: no engineering
//! factors. Stresses are in the unit of the moduli given (inside the program: scaled by E).

mod error;
pub mod hardening;
pub mod j2;
mod laws;
pub mod multistep;
pub mod point;

pub use error::{MaterialError, PointError, Refusal};
pub use hardening::FlowStress;
pub use j2::{Response, deviatoric_tangent, elastic_energy_deviatoric, return_mapping, return_mapping_of_eight};
pub use laws::{HardeningLaw, HardeningParameter, hollomon_yield_stress};

use serde::{Deserialize, Serialize};

use crate::lanes::{Lanes, array};
use crate::real::Real;

/// The two elastic constants of an isotropic solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Elasticity<R> {
    /// kappa = E / (3 (1 - 2 nu)), stress.
    pub bulk: R,
    /// mu = E / (2 (1 + nu)), stress.
    pub shear: R,
}

impl<R: Real> Elasticity<R> {
    /// From Young's modulus (stress, > 0) and Poisson's ratio (-1 < nu < 1/2), formed in f64 and
    /// rounded once.
    pub fn new(youngs_modulus: f64, poissons_ratio: f64) -> Self {
        Self {
            bulk: R::of(youngs_modulus / (3.0 * (1.0 - 2.0 * poissons_ratio))),
            shear: R::of(youngs_modulus / (2.0 * (1.0 + poissons_ratio))),
        }
    }
}

/// What a point remembers between accepted steps. [`Default`] is the virgin state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PointState<R> {
    /// b_e_bar - I: the isochoric elastic left Cauchy-Green tensor less the identity, whose digits
    /// at small strains it keeps.
    pub be: [R; 6],
    /// Equivalent plastic strain, >= 0.
    pub alpha: R,
}

impl<R: Real> PointState<Lanes<R>> {
    /// Eight states side by side.
    #[inline(always)]
    pub fn of_eight(points: &[PointState<R>; 8]) -> Self {
        let be = array(Lanes::ZERO, |c| Lanes::from_fn(|q| points[q].be[c]));
        Self { be, alpha: Lanes::from_fn(|q| points[q].alpha) }
    }
}

/// The constants of one material.
#[derive(Clone, Debug, PartialEq)]
pub struct Material<R> {
    /// Elastic constants.
    pub elasticity: Elasticity<R>,
    /// The flow stress against the equivalent plastic strain, in the same unit of stress.
    pub hardening: FlowStress<R>,
}

impl Material<f64> {
    /// The same material in another precision, each number rounded once.
    pub fn cast<R: Real>(&self) -> Material<R> {
        Material {
            elasticity: Elasticity { bulk: R::of(self.elasticity.bulk), shear: R::of(self.elasticity.shear) },
            hardening: self.hardening.cast(),
        }
    }
}

/// U'(J) and U''(J) from J - 1: the pressure-like stress (positive in tension) and its derivative,
/// both in units of stress.
///
/// `U' = kappa/2 (J - 1/J)`, written as `kappa/2 j (2 + j)/(1 + j)` with `j = J - 1` so that small
/// volume changes keep their digits (Simo & Hughes 1998, eq. 9.2.6). The Kirchhoff stress of the
/// volumetric part is `J U'(J) 1`. J has to be positive: the caller checks.
#[inline]
pub fn pressure<R: Real>(elasticity: &Elasticity<R>, j_minus_1: R) -> (R, R) {
    let half = R::of(0.5) * elasticity.bulk;
    let inverse = R::ONE / (R::ONE + j_minus_1);
    (half * j_minus_1 * (R::ONE + R::ONE + j_minus_1) * inverse, half * (R::ONE + inverse * inverse))
}

/// U(J) from J - 1, energy per reference volume, >= 0 (Simo & Hughes 1998, eq. 9.2.6).
///
/// `j + j^2/2 - ln(1 + j)` is of the order j^2. Below |j| = 0.2 the logarithm is summed as `2
/// artanh z`, `z = j/(2 + j)`, whose leading term cancels `j` exactly: `U = kappa/2 [ j^2/2 + j z -
/// 2 (z^3/3 + z^5/5 + ...) ]`.
#[inline]
pub fn elastic_energy_volumetric<R: Real>(elasticity: &Elasticity<R>, j_minus_1: R) -> R {
    let j = j_minus_1;
    let half = R::of(0.5);
    let bracket = if j.abs() < R::of(0.2) {
        let z = j / (R::of(2.0) + j);
        let z2 = z * z;
        // z^2 < 0.0124: the ninth term is below 2e-17 of the first.
        let mut sum = R::ZERO;
        for k in (1..=9).rev() {
            sum = z2 * (sum + R::ONE / R::of(f64::from(2 * k + 1)));
        }
        half * j * j + z * (j - R::of(2.0) * sum)
    } else {
        j + half * j * j - (R::ONE + j).ln()
    };
    half * elasticity.bulk * bracket
}

#[cfg(test)]
mod tests;
