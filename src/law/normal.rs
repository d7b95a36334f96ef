//! F_N0 and a0 from the indentation: closed forms with a fitted correction. All but `composed` are
//! exactly Hertz below first yield and know nothing of friction.
//!
//! With g = 1 - Lambda_Y/Lambda, u = ln(Lambda/Lambda_Y), e = d ln sigma/d ln eps_p at the
//! representative strain, a_H = sqrt(R h), F_H Hertz's force and X = Lambda/Lambda_Y - 1, the
//! candidates are
//! ```text
//! published   a, F_N of Olsson & Larsson (2016)
//! corrected   a = a_OL exp(g (c1 + c2 u)),            F_N = F_OL exp(g (d1 + d2 a/R + d3 e + d4 u))
//! smooth      a^2 = 2 R h {1/2 + (1.43 exp(-b1 e) - 1/2) [1 - exp(-(b2 u)^b3)]} exp(b4 g a_H/R)
//!             F_N = F_H [1 + (k1 X^k2)^k3]^(-1/k3) exp(g [(k4 - k5 u) a_H/R - k6 e])
//! composed    a of `smooth`,
//!             F_N = F_H [1 + (k1 (Lambda - Lambda_Y)^k2)^k3]^(-1/k3)
//!                   exp{(1 - g) ln(F_el/F_H) + g [(k6 - k4 u) a_H/R - k5 e]}
//! ```
//! In `composed` the force of a fully plastic contact follows from Lambda and not from its ratio to
//! first yield, so that it hardly depends on nu. F_el is that of the elastic sphere, with what a
//! finite a/R and friction add ([`super::elastic`]): below first yield F_N = F_el.
//!
//! Lambda, e are taken at the contact radius (published, corrected) or at Hertz's radius a_H
//! (smooth, composed: explicit in h).

use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

use super::elastic::stiffening;
use super::least_squares::Sign;
use super::variables::{Body, yield_lambda};
use crate::analytical::olsson_larsson::{c_squared, large_deformation_factor, limited_hardness, plastic_c_squared};
use crate::analytical::{bisect, hertz, johnson};

/// Which candidate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum NormalForm {
    /// Olsson & Larsson (2016) as published.
    Published,
    /// The same times fitted factors.
    Corrected,
    /// Curves of our own.
    Smooth,
    /// The same radius; the force between the limits of an elastic sphere at a finite a/R, with
    /// friction, and of full plasticity.
    Composed,
}

impl NormalForm {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Published, Self::Corrected, Self::Smooth, Self::Composed];

    /// How a table calls it.
    pub fn label(self) -> &'static str {
        match self {
            Self::Published => "Olsson & Larsson",
            Self::Corrected => "Olsson & Larsson, corrected",
            Self::Smooth => "smooth curves",
            Self::Composed => "composed of limits",
        }
    }

    /// Constants of the radius from which a fit starts, in the order of the module's formulas.
    pub fn radius_start(self) -> Vec<f64> {
        match self {
            Self::Published => Vec::new(),
            Self::Corrected => vec![0.0; 2],
            Self::Smooth | Self::Composed => vec![1.0, 0.3, 1.0, 0.1],
        }
    }

    /// Constants of the force from which a fit starts.
    pub fn force_start(self) -> Vec<f64> {
        match self {
            Self::Published => Vec::new(),
            Self::Corrected => vec![0.0; 4],
            Self::Smooth => vec![0.3, 1.0, 1.0, 0.5, 0.1, 0.5],
            Self::Composed => vec![0.12, 1.0, 1.0, 0.5, 0.5, 0.8],
        }
    }

    /// What the constants may be.
    pub(super) fn sign(self) -> Sign {
        match self {
            Self::Smooth | Self::Composed => Sign::Positive,
            Self::Published | Self::Corrected => Sign::Any,
        }
    }
}

/// The normal problem of a law: F_N0 and a0 as functions of h and, in the composed form, mu.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NormalModel {
    /// Which candidate.
    pub form: NormalForm,
    /// Constants of the contact radius.
    pub radius: Vec<f64>,
    /// Constants of the force.
    pub force: Vec<f64>,
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
struct Level {
    ramp: f64,
    ratio: f64,
    hardening: f64,
}

impl Level {
    fn at(body: &Body, a: f64) -> Self {
        let ratio = (body.lambda(a) / yield_lambda(body.sphere.poissons_ratio)).max(1.0);
        Self { ramp: 1.0 - 1.0 / ratio, ratio, hardening: body.hardening_exponent(a) }
    }
}

impl NormalModel {
    /// The closed forms without any correction.
    pub fn published() -> Self {
        Self { form: NormalForm::Published, radius: Vec::new(), force: Vec::new() }
    }

    /// a0 and F_N0 at the indentation `h`, pressed with Coulomb's coefficient `friction`; zero for
    /// h <= 0. Hertz below first yield, but for F_N0 of the composed form.
    pub fn state(&self, body: &Body, friction: f64, h: f64) -> NormalState {
        if !(h > 0.0) {
            return NormalState { a: 0.0, f_n: 0.0 };
        }
        let a = contact_radius(self.form, &self.radius, body, h);
        NormalState { a, f_n: normal_force(self.form, &self.force, body, friction, h, a) }
    }
}

/// a at the indentation `h` > 0.
pub(super) fn contact_radius(form: NormalForm, constants: &[f64], body: &Body, h: f64) -> f64 {
    let sphere = &body.sphere;
    let hertz = hertz::contact_radius(sphere, h);
    if body.lambda(hertz) <= yield_lambda(sphere.poissons_ratio) {
        return hertz;
    }
    match (form, constants) {
        (NormalForm::Smooth | NormalForm::Composed, &[b1, b2, b3, b4]) => {
            let Level { ramp, ratio, hardening } = Level::at(body, hertz);
            let growth = plastic_c_squared(0.0) * (-b1 * hardening).exp() - 0.5;
            let c_squared = 0.5 + growth * (1.0 - (-(b2 * ratio.ln()).powf(b3)).exp());
            hertz * (2.0 * c_squared * (b4 * ramp * hertz / sphere.radius).exp()).sqrt()
        }
        (NormalForm::Corrected, &[c1, c2]) => {
            let a = published_radius(body, h);
            let level = Level::at(body, a);
            a * (level.ramp * (c1 + c2 * level.ratio.ln())).exp()
        }
        _ => published_radius(body, h),
    }
}

/// F_N at the indentation `h` > 0, at which the contact radius is `a`.
pub(super) fn normal_force(form: NormalForm, constants: &[f64], body: &Body, friction: f64, h: f64, a: f64) -> f64 {
    let sphere = &body.sphere;
    let (hertz_radius, hertz_force) = (hertz::contact_radius(sphere, h), hertz::force(sphere, h));
    if let (NormalForm::Composed, &[k1, k2, k3, k4, k5, k6]) = (form, constants) {
        let size = hertz_radius / sphere.radius;
        let elastic = stiffening(sphere, friction, size);
        let excess = body.lambda(hertz_radius) - yield_lambda(sphere.poissons_ratio);
        // Written so that a NaN goes on.
        if excess <= 0.0 {
            return hertz_force * elastic.exp();
        }
        let Level { ramp, ratio, hardening } = Level::at(body, hertz_radius);
        let plastic = (k1 * excess.powf(k2)).powf(k3);
        let rest = (1.0 - ramp) * elastic + ramp * ((k6 - k4 * ratio.ln()) * size - k5 * hardening);
        return hertz_force * (1.0 + plastic).powf(-1.0 / k3) * rest.exp();
    }
    if body.lambda(hertz_radius) <= yield_lambda(sphere.poissons_ratio) {
        return hertz_force;
    }
    match (form, constants) {
        (NormalForm::Smooth, &[k1, k2, k3, k4, k5, k6]) => {
            let Level { ramp, ratio, hardening } = Level::at(body, hertz_radius);
            let plastic = (k1 * (ratio - 1.0).powf(k2)).powf(k3);
            let size = (k4 - k5 * ratio.ln()) * hertz_radius / sphere.radius;
            hertz_force * (1.0 + plastic).powf(-1.0 / k3) * (ramp * (size - k6 * hardening)).exp()
        }
        (NormalForm::Corrected, &[d1, d2, d3, d4]) => {
            let radius = published_radius(body, h);
            let level = Level::at(body, radius);
            let correction = d1 + d2 * a / sphere.radius + d3 * level.hardening + d4 * level.ratio.ln();
            published_force(body, radius) * (level.ramp * correction).exp()
        }
        _ => published_force(body, published_radius(body, h)),
    }
}

/// Olsson & Larsson's contact radius for any hardening law, the 1/m of the closed form being the
/// local hardening exponent.
fn published_radius(body: &Body, h: f64) -> f64 {
    let reach = 2.0 * body.sphere.radius * h;
    let c_squared_at = |a: f64| c_squared(body.lambda(a), plastic_c_squared(body.hardening_exponent(a)));
    bisect((0.5 * reach).sqrt(), (plastic_c_squared(0.0) * reach).sqrt(), |a| a * a - c_squared_at(a) * reach)
}

/// Olsson & Larsson's force at the contact radius `a` for any hardening law.
fn published_force(body: &Body, a: f64) -> f64 {
    let stress = body.representative_stress(a);
    // H_max = 2.8 for a two-parameter law with m < 5.
    let maximum = if body.hardening_exponent(a) > 0.2 { 2.8 } else { 3.0 };
    let factor = large_deformation_factor(a / body.sphere.radius);
    limited_hardness(johnson::lambda(&body.sphere, stress, a), maximum, factor) * PI * a * a * stress
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
            normal_force(NormalForm::Composed, &[0.11, 0.85, 1.4, 0.6, 0.3, 0.8], &body, friction, 2.0 * h, 0.0)
                / hertz::force(&body.sphere, 2.0 * h)
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
