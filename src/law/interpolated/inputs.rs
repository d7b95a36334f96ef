//! What a contact is before it is sheared, in eight dimensionless numbers: all that the
//! interpolation knows of it.
//!
//! Hertz's a = (R h)^(1/2) stands for the contact radius, which is not known yet. How far a
//! material has yielded, and how it hardens, is seen in its flow stress at five strains around
//! Tabor's representative one, 0.2 a/R: an elastic contact and one before first yield have zero in
//! all five, whatever the material.

use crate::analytical::ElasticSphere;
use crate::analytical::olsson_larsson::plastic_share;
use crate::law::variables::{Body, yield_lambda};

/// Number of inputs.
pub const INPUTS: usize = 8;

/// Their names in files.
pub const NAMES: [&str; INPUTS] =
    ["ln Lambda", "hardening to 0", "hardening to 0.02", "hardening to 0.07", "hardening to 0.6", "ln mu", "nu", "a/R"];

/// Place of ln Lambda, mu, nu and a/R among them.
pub const LAMBDA: usize = 0;
/// ln mu.
pub const FRICTION: usize = 5;
/// nu.
pub const POISSON: usize = 6;
/// a/R by Hertz.
pub const SIZE: usize = 7;

/// Total strains over a/R at which the flow stress is compared with that at [`TABOR`].
const STRAINS: [f64; 4] = [0.0, 0.02, 0.07, 0.6];
/// Tabor's representative strain over a/R.
const TABOR: f64 = 0.2;
/// Least mu: the numbers of the shear are over mu, and go on as they are below.
const LEAST_FRICTION: f64 = 1e-3;

/// The inputs of a contact of `body` at the indentation `h`; `sphere` is the one that makes the
/// same elastic contact on a rigid plane. Any one system of units.
pub fn inputs(body: &Body, sphere: &ElasticSphere, friction: f64, h: f64) -> [f64; INPUTS] {
    let a = (sphere.radius * h).sqrt();
    let size = a / body.sphere.radius;
    let [rep, others @ ..] = yielded(body, size, [TABOR, STRAINS[0], STRAINS[1], STRAINS[2], STRAINS[3]]);
    let [s0, s1, s2, s3] = others.map(|other| other - rep);
    [rep, s0, s1, s2, s3, friction.max(LEAST_FRICTION).ln(), body.sphere.poissons_ratio, size]
}

/// ln(Lambda/Lambda_Y), not below 0, with the flow stress at each of the total strains over `size`,
/// a/R.
fn yielded<const N: usize>(body: &Body, size: f64, strains: [f64; N]) -> [f64; N] {
    if body.is_elastic() {
        return [0.0; N];
    }
    let flow = |plastic: f64| body.hardening.flow_stress(plastic);
    let first = yield_lambda(body.sphere.poissons_ratio);
    strains.map(|strain| {
        let stress = flow(plastic_share(body.sphere.youngs_modulus, strain * size, flow));
        (body.sphere.effective_modulus() * size / (stress * first)).ln().max(0.0)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::{Hardening, Material};

    fn body(hardening: Hardening) -> Body {
        Body::new(2.0, &Material { youngs_modulus: 200e3, poissons_ratio: 0.3, hardening }).unwrap()
    }

    #[test]
    fn a_contact_before_first_yield_is_an_elastic_one() {
        let (elastic, strong) = (body(Hardening::Elastic), body(Hardening::Ideal { yield_stress: 5000.0 }));
        let of = |body: &Body, h: f64| inputs(body, &body.sphere, 0.3, h);
        assert_eq!(of(&elastic, 1e-4), of(&strong, 1e-4));
        assert_ne!(of(&elastic, 0.1), of(&strong, 0.1));
        // Without hardening the stress is the same at all strains.
        assert_eq!(of(&strong, 0.1)[1..5], [0.0; 4]);
    }

    #[test]
    fn they_have_no_units() {
        let hardening = |unit: f64| Hardening::Voce { yield_stress: 200.0 * unit, saturation_stress: 500.0 * unit, rate: 20.0 };
        let of = |unit: f64, radius: f64| {
            let material = Material { youngs_modulus: 200e3 * unit, poissons_ratio: 0.2, hardening: hardening(unit) };
            let body = Body::new(radius, &material).unwrap();
            inputs(&body, &body.sphere, 0.1, 0.02 * radius)
        };
        for (a, b) in of(1.0, 1.0).iter().zip(of(1e6, 3.0)) {
            assert!((a - b).abs() < 1e-12, "{a} and {b}");
        }
        let [lambda, to_yield, .., strong, mu, nu, size] = of(1.0, 1.0);
        assert!(
            lambda > 0.0
                && to_yield > 0.0
                && strong < 0.0
                && mu == 0.1f64.ln()
                && nu == 0.2
                && (size - 0.02f64.sqrt()).abs() < 1e-15
        );
    }
}
