//! F_N0 and a0 from the indentation: between an elastic and a fully plastic contact.
//!
//! With g = 1 - Lambda_Y/Lambda, u = ln(Lambda/Lambda_Y), e = d ln sigma/d ln eps_p at the
//! representative strain, a_H = sqrt(R h) and F_H Hertz's radius and force,
//! ```text
//! a^2 = 2 R h {1/2 + (1.43 exp(-b1 e) - 1/2) [1 - exp(-(b2 u)^b3)]} exp(b4 g a_H/R)
//! F_N = F_H [1 + (k1 (Lambda - Lambda_Y)^k2)^k3]^(-1/k3)
//!           exp{(1 - g) ln(F_el/F_H) + g [(k6 - k4 u) a_H/R - k5 e]}
//! ```
//! The force of a fully plastic contact follows from Lambda and not from its ratio to first yield,
//! so that it hardly depends on nu. F_el is that of the elastic sphere, with what a finite a/R and
//! friction add ([`super::elastic`]): below first yield F_N = F_el and a = a_H. Lambda and e are
//! taken at Hertz's radius, so that all is explicit in h.

use serde::{Deserialize, Serialize};

use super::elastic::stiffening;
use crate::analytical::hertz;
use crate::analytical::olsson_larsson::plastic_c_squared;
use crate::law::variables::{Body, yield_lambda};

/// The normal problem of a law: F_N0 and a0 as functions of h and mu.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NormalModel {
    /// Constants of the contact radius, b1 to b4.
    pub radius: [f64; 4],
    /// Constants of the force, k1 to k6.
    pub force: [f64; 6],
}

/// The normal state at one indentation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalState {
    /// a0, length.
    pub a: f64,
    /// F_N0, force.
    pub f_n: f64,
}

/// What the corrections depend on.
struct CorrectionInputs {
    ramp: f64,
    ratio: f64,
    hardening: f64,
}

impl CorrectionInputs {
    fn at(body: &Body, a: f64) -> Self {
        let ratio = (body.lambda(a) / yield_lambda(body.sphere.poissons_ratio)).max(1.0);
        Self { ramp: 1.0 - 1.0 / ratio, ratio, hardening: body.hardening_exponent(a) }
    }
}

impl NormalModel {
    /// From which a fit starts.
    pub const START: Self = Self::new([1.0, 0.3, 1.0, 0.1], [0.12, 1.0, 1.0, 0.5, 0.5, 0.8]);

    /// With the constants of the radius and of the force.
    pub const fn new(radius: [f64; 4], force: [f64; 6]) -> Self {
        Self { radius, force }
    }

    /// a0 and F_N0 at the indentation `h`, pressed with Coulomb's coefficient `friction`; zero for
    /// h <= 0.
    pub fn state(&self, body: &Body, friction: f64, h: f64) -> NormalState {
        if !(h > 0.0) {
            return NormalState { a: 0.0, f_n: 0.0 };
        }
        NormalState { a: contact_radius(&self.radius, body, h), f_n: normal_force(&self.force, body, friction, h) }
    }
}

/// a at the indentation `h` > 0.
pub(super) fn contact_radius(constants: &[f64; 4], body: &Body, h: f64) -> f64 {
    let sphere = &body.sphere;
    let hertz = hertz::contact_radius(sphere, h);
    if body.lambda(hertz) <= yield_lambda(sphere.poissons_ratio) {
        return hertz;
    }
    let [b1, b2, b3, b4] = *constants;
    let CorrectionInputs { ramp, ratio, hardening } = CorrectionInputs::at(body, hertz);
    let growth = plastic_c_squared(0.0) * (-b1 * hardening).exp() - 0.5;
    let c_squared = 0.5 + growth * (1.0 - (-(b2 * ratio.ln()).powf(b3)).exp());
    hertz * (2.0 * c_squared * (b4 * ramp * hertz / sphere.radius).exp()).sqrt()
}

/// F_N at the indentation `h` > 0.
pub(super) fn normal_force(constants: &[f64; 6], body: &Body, friction: f64, h: f64) -> f64 {
    let sphere = &body.sphere;
    let (hertz_radius, hertz_force) = (hertz::contact_radius(sphere, h), hertz::force(sphere, h));
    let size = hertz_radius / sphere.radius;
    let elastic = stiffening(sphere, friction, size);
    let excess = body.lambda(hertz_radius) - yield_lambda(sphere.poissons_ratio);
    // Written so that a NaN goes on.
    if excess <= 0.0 {
        return hertz_force * elastic.exp();
    }
    let [k1, k2, k3, k4, k5, k6] = *constants;
    let CorrectionInputs { ramp, ratio, hardening } = CorrectionInputs::at(body, hertz_radius);
    let plastic = (k1 * excess.powf(k2)).powf(k3);
    let rest = (1.0 - ramp) * elastic + ramp * ((k6 - k4 * ratio.ln()) * size - k5 * hardening);
    hertz_force * (1.0 + plastic).powf(-1.0 / k3) * rest.exp()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analytical::ElasticSphere;
    use crate::case::{Hardening, Material};

    #[test]
    fn the_composed_force_is_continuous_at_first_yield() {
        let force = |friction: f64, h: f64| {
            let hardening = Hardening::Ideal { yield_stress: 2000.0 };
            let body = Body::new(2.0, &Material { youngs_modulus: 200e3, poissons_ratio: 0.2, hardening }).unwrap();
            normal_force(&[0.11, 0.85, 1.4, 0.6, 0.3, 0.8], &body, friction, 2.0 * h) / hertz::force(&body.sphere, 2.0 * h)
        };
        let sphere = ElasticSphere { radius: 1.0, youngs_modulus: 200e3, poissons_ratio: 0.2 };
        let a = yield_lambda(0.2) * 2000.0 / sphere.effective_modulus();
        let at = |factor: f64| force(0.3, factor * a * a);
        assert!((at(1.0 - 1e-9).ln() - stiffening(&sphere, 0.3, a)).abs() < 1e-6);
        assert!((at(1.0 + 1e-9) / at(1.0 - 1e-9) - 1.0).abs() < 1e-6);
        assert!(at(2.0) < at(1.0));
        assert!(force(f64::NAN, 0.01).is_nan());
    }
}
