//! Elastic shear after any axisymmetric, also plastic, preload: Jaeger (1998), Ciavarella (1998).
//!
//! With F_u(h) the elastic *unloading* curve from h0, F_T = mu [F_u(h0) - F_u(h0 - d/(mu kappa))],
//! kappa = (2 - nu)/(2 (1 - nu)). Exact for Dundurs' beta = 0 and an elastic response to the shear.
//! It needs axisymmetric data only: the natural baseline that a plastic law is compared with.

use super::ElasticSphere;
use std::f64::consts::PI;

/// Tangential force at the displacement `d` after pressing to `h0`, from the elastic unloading
/// curve `unloading`: h -> F_u(h), which must be non-decreasing and zero where the contact is lost.
/// Odd in `d`.
pub fn force(sphere: &ElasticSphere, friction: f64, h0: f64, unloading: impl Fn(f64) -> f64, d: f64) -> f64 {
    if friction <= 0.0 {
        return 0.0;
    }
    let back = d.abs() / (friction * sphere.stiffness_ratio());
    (friction * (unloading(h0) - unloading(h0 - back))).copysign(d)
}

/// Displacement at full slip, d = mu kappa (h0 - h_lost), where `lost` is the indentation at which
/// the unloading curve reaches zero.
pub fn slip_displacement(sphere: &ElasticSphere, friction: f64, h0: f64, lost: f64) -> f64 {
    friction * sphere.stiffness_ratio() * (h0 - lost)
}

/// f_T = F_T/(mu F_N) under a uniform pressure, the fully plastic limit: (2/pi) [asin x + x
/// sqrt(1 - x^2)] with x = d/d_slip; 1 from x = 1 on; odd. The best single exponent n in 1 - (1 -
/// x)^n is 1.36.
pub fn uniform_pressure_ratio(x: f64) -> f64 {
    let x = x.clamp(-1.0, 1.0);
    2.0 / PI * (x.asin() + x * (1.0 - x * x).sqrt())
}

/// Displacement at full slip under a uniform pressure, d_slip = mu F_N (2 - nu) / (2 pi G a).
pub fn uniform_pressure_slip_displacement(sphere: &ElasticSphere, friction: f64, normal_force: f64, a: f64) -> f64 {
    friction * normal_force * (2.0 - sphere.poissons_ratio) / (2.0 * PI * sphere.shear_modulus() * a)
}

#[cfg(test)]
mod tests {
    use super::super::cattaneo_mindlin::{self, CattaneoMindlin};
    use super::super::mesarovic_johnson::Unloading;
    use super::super::{bisect, hertz};
    use super::*;

    const SPHERE: ElasticSphere = ElasticSphere { radius: 1.0, youngs_modulus: 200e3, poissons_ratio: 0.3 };

    #[test]
    fn hertz_gives_cattaneo_mindlin_back() {
        let (h0, mu) = (2e-3, 0.3);
        let exact = CattaneoMindlin::at_indentation(SPHERE, mu, h0);
        let slip = slip_displacement(&SPHERE, mu, h0, 0.0);
        assert!((slip / exact.slip_displacement() - 1.0).abs() < 1e-13);
        for x in [0.01, 0.2, 0.5, 0.9, 1.0, 1.5, -0.5] {
            let ours = force(&SPHERE, mu, h0, |h| hertz::force(&SPHERE, h), x * slip);
            assert!((ours / exact.force(x * slip) - 1.0).abs() < 1e-9, "x = {x}");
        }
        assert_eq!(force(&SPHERE, 0.0, h0, |h| hertz::force(&SPHERE, h), 1.0), 0.0);
    }

    #[test]
    fn a_flat_pressure_gives_the_uniform_form() {
        let (h0, a, p, mu) = (0.02, 0.2, 1090.0, 0.25);
        let unloading = Unloading { sphere: SPHERE, indentation: h0, contact_radius: a, force: p * PI * a * a };
        let slip = uniform_pressure_slip_displacement(&SPHERE, mu, unloading.force, a);
        assert!((slip / slip_displacement(&SPHERE, mu, h0, unloading.lost()) - 1.0).abs() < 1e-12);
        for x in [0.05, 0.3, 0.7, 0.95] {
            let ours = force(&SPHERE, mu, h0, |h| unloading.force_at(h), x * slip);
            assert!((ours / (mu * unloading.force * uniform_pressure_ratio(x)) - 1.0).abs() < 1e-9, "x = {x}");
        }
        // Both start with Mindlin's stiffness.
        let d = 1e-6 * slip;
        let slope = force(&SPHERE, mu, h0, |h| unloading.force_at(h), d) / d;
        assert!((slope / cattaneo_mindlin::initial_stiffness(&SPHERE, a) - 1.0).abs() < 1e-4);
    }

    #[test]
    fn best_single_exponent() {
        let misfit = |n: f64| {
            (0..=1000)
                .map(|i| i as f64 * 1e-3)
                .map(|x| (1.0 - (1.0 - x).powf(n) - uniform_pressure_ratio(x)).powi(2))
                .sum::<f64>()
        };
        let slope = |n: f64| misfit(n + 1e-5) - misfit(n - 1e-5);
        assert!((bisect(1.1, 1.9, slope) - 1.36).abs() < 0.01, "{}", bisect(1.1, 1.9, slope));
    }
}
