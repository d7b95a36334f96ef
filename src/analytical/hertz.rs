//! Elastic normal contact: Hertz (1882), as in Johnson, *Contact Mechanics* (1985), section 4.2.
//!
//! Exact as a/R -> 0 for a frictionless (or nu = 0.5) contact; expect departures of order (a/R)^2,
//! about 1 % in the force at a/R = 0.1.

use super::ElasticSphere;
use std::f64::consts::PI;

/// Normal force F = (4/3) E* sqrt(R) h^1.5 at the indentation `h`; zero for h <= 0.
pub fn force(sphere: &ElasticSphere, h: f64) -> f64 {
    4.0 / 3.0 * sphere.effective_modulus() * sphere.radius.sqrt() * h.max(0.0).powf(1.5)
}

/// Contact radius a = sqrt(R h); zero for h <= 0.
pub fn contact_radius(sphere: &ElasticSphere, h: f64) -> f64 {
    (sphere.radius * h.max(0.0)).sqrt()
}

/// Normal force F = 4 E* a^3 / (3 R) at the contact radius `a`.
pub fn force_from_radius(sphere: &ElasticSphere, a: f64) -> f64 {
    4.0 * sphere.effective_modulus() * a.powi(3) / (3.0 * sphere.radius)
}

/// Greatest pressure, at the centre: p_0 = 2 E* a / (pi R).
pub fn maximum_pressure(sphere: &ElasticSphere, a: f64) -> f64 {
    2.0 * sphere.effective_modulus() * a / (PI * sphere.radius)
}

/// Pressure p(r) = p_0 sqrt(1 - r^2/a^2); zero outside.
pub fn pressure(sphere: &ElasticSphere, a: f64, r: f64) -> f64 {
    if r.abs() < a { maximum_pressure(sphere, a) * (1.0 - (r / a).powi(2)).sqrt() } else { 0.0 }
}

/// Normal stiffness dF/dh = 2 E* a. It holds for any axisymmetric elastic contact, so also where
/// unloading of a plastic one starts (Johnson 1985, section 5.4 with Sneddon 1965; Oliver & Pharr
/// 1992).
pub fn stiffness(sphere: &ElasticSphere, a: f64) -> f64 {
    2.0 * sphere.effective_modulus() * a
}

/// The inverse of [`force`]: h = (3 F / (4 E* sqrt(R)))^(2/3); zero for F <= 0.
pub fn indentation(sphere: &ElasticSphere, force: f64) -> f64 {
    (3.0 * force.max(0.0) / (4.0 * sphere.effective_modulus() * sphere.radius.sqrt())).powf(2.0 / 3.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEEL: ElasticSphere = ElasticSphere { radius: 2.5, youngs_modulus: 200e3, poissons_ratio: 0.3 };

    #[test]
    fn force_of_h_and_of_a_agree_and_invert() {
        for h in [1e-6, 1e-4, 1e-2] {
            let f = force(&STEEL, h);
            assert!((f / force_from_radius(&STEEL, contact_radius(&STEEL, h)) - 1.0).abs() < 1e-14);
            assert!((indentation(&STEEL, f) / h - 1.0).abs() < 1e-14);
        }
        assert_eq!(force(&STEEL, -1.0), 0.0);
        assert_eq!(indentation(&STEEL, -1.0), 0.0);
    }

    #[test]
    fn stiffness_is_the_derivative_of_the_force() {
        let (h, d) = (0.01, 1e-6);
        let slope = (force(&STEEL, h + d) - force(&STEEL, h - d)) / (2.0 * d);
        assert!((slope / stiffness(&STEEL, contact_radius(&STEEL, h)) - 1.0).abs() < 1e-8);
    }

    #[test]
    fn pressure_integrates_to_the_force() {
        let a = 0.1;
        let n = 200_000;
        let dr = a / n as f64;
        let total: f64 = (0..n)
            .map(|i| {
                let r = (i as f64 + 0.5) * dr;
                2.0 * PI * r * dr * pressure(&STEEL, a, r)
            })
            .sum();
        assert!((total / force_from_radius(&STEEL, a) - 1.0).abs() < 1e-6);
        assert_eq!(pressure(&STEEL, a, 1.01 * a), 0.0);
    }
}
