//! How large the contact will be: what the mesh is sized by before anything is computed.

use super::olsson_larsson::{c_squared, plastic_c_squared, plastic_share};
use super::{ElasticSphere, bisect, johnson};

/// Largest contact radius that is ever predicted: beyond it the hemisphere has no surface left to
/// touch with.
const LARGEST_RADIUS: f64 = 0.95;

/// Contact radius a/R expected at the indentation `h` (in sphere radii), an upper estimate, for any
/// isotropic hardening.
///
/// `flow_stress`(eps_p) is the flow stress at the equivalent plastic strain in the units of
/// `youngs_modulus`, at zero the initial yield stress; `f64::INFINITY` for an elastic sphere. The
/// greater of
/// - Hertz, a^2 = R h, and
/// - Olsson & Larsson (2016), a^2 = c^2(Lambda) (2 R h - h^2): their c^2 with sigma_rep at
///   eps_rep = 0.2 a/R, on the true section of a sphere cut at h instead of its parabola; the
///   hardening exponent that c^2 needs is the secant one, ln\[sigma(eps_p)/sigma(eps_p/4)\]/ln 4.
///
/// Continuous and increasing in `h` up to its bound, 0.95, from elastic to fully plastic. Ideal
/// plastic, h/R = 0.005 to 0.02: 3-7 % above axisymmetric computations (0.096, 0.141, 0.2087).
/// Meant for h/R from 1e-4 to 0.3.
pub fn predicted_contact_radius(youngs_modulus: f64, nu: f64, flow_stress: impl Fn(f64) -> f64, h: f64) -> f64 {
    let h = h.clamp(0.0, 1.0);
    let sphere = ElasticSphere { radius: 1.0, youngs_modulus, poissons_ratio: nu };
    let section = 2.0 * h - h * h;
    let c_squared_at = |a: f64| {
        let plastic_strain = plastic_share(youngs_modulus, johnson::representative_strain(&sphere, a), &flow_stress);
        let stress = flow_stress(plastic_strain);
        let secant = (stress / flow_stress(0.25 * plastic_strain)).ln() / 4f64.ln();
        // inf/inf of an elastic sphere, and softening, count as no hardening.
        let inverse_exponent = if secant > 0.0 { secant.min(1.0) } else { 0.0 };
        c_squared(johnson::lambda(&sphere, stress, a), plastic_c_squared(inverse_exponent))
    };
    let plastic =
        bisect((0.5 * section).sqrt(), (plastic_c_squared(0.0) * section).sqrt(), |a| a * a - c_squared_at(a) * section);
    plastic.max(h.sqrt()).min(LARGEST_RADIUS)
}

#[cfg(test)]
mod tests {
    use super::*;

    type Flow = Box<dyn Fn(f64) -> f64>;

    fn laws() -> Vec<(&'static str, Flow)> {
        vec![
            ("elastic", Box::new(|_| f64::INFINITY)),
            ("ideal 100", Box::new(|_| 100.0)),
            ("ideal 400", Box::new(|_| 400.0)),
            ("ideal 1600", Box::new(|_| 1600.0)),
            ("linear", Box::new(|p: f64| 300.0 + 5000.0 * p)),
            ("power", Box::new(|p: f64| 200.0 + 800.0 * p.powf(0.3))),
            ("voce", Box::new(|p: f64| 500.0 - 300.0 * (-20.0 * p).exp())),
            ("table", Box::new(|p: f64| 250.0 + 200.0 * (p / 0.02).min(1.0))),
            ("softening", Box::new(|p: f64| 400.0 - 100.0 * (p / 0.05).min(1.0))),
        ]
    }

    #[test]
    fn monotone_and_continuous_from_elastic_to_fully_plastic() {
        for (name, law) in laws() {
            let mut last = predicted_contact_radius(200e3, 0.3, &law, 1e-5);
            for i in 1..=2200 {
                let h = 1e-5 * (i as f64 * 0.005f64).exp();
                let a = predicted_contact_radius(200e3, 0.3, &law, h);
                // d ln a / d ln h is 1/2 for constant c^2 and well below 1.5 while c^2 grows.
                let growth = (a / last).ln() / 0.005;
                assert!((0.0..1.5).contains(&growth), "{name}: h = {h}, a = {a} after {last}");
                assert!(a >= h.min(0.9).sqrt(), "{name}");
                last = a;
            }
            assert!(last > 0.5 && last <= 0.95, "{name}: {last}");
        }
    }

    #[test]
    fn elastic_is_hertz_and_plastic_is_an_upper_estimate() {
        for h in [1e-4, 1e-2, 0.1] {
            assert!((predicted_contact_radius(200e3, 0.3, |_| f64::INFINITY, h) - f64::sqrt(h)).abs() < 1e-12);
        }
        for (h, radius) in [(0.02, 0.2087), (0.01, 0.141), (0.005, 0.096)] {
            let a = predicted_contact_radius(200e3, 0.3, |_| 400.0, h);
            println!("h = {h}: {a:.4} against {radius}: {:+.1} %", 100.0 * (a / radius - 1.0));
            assert!(a > radius && a < 1.08 * radius, "h = {h}: {a}");
        }
    }

    #[test]
    fn units_do_not_matter_and_bounds_hold() {
        let a = predicted_contact_radius(200e3, 0.3, |p: f64| 200.0 + 800.0 * p.sqrt(), 0.02);
        let b = predicted_contact_radius(1.0, 0.3, |p: f64| (200.0 + 800.0 * p.sqrt()) / 200e3, 0.02);
        assert!((a / b - 1.0).abs() < 1e-12);
        assert_eq!(predicted_contact_radius(200e3, 0.3, |_| 400.0, 0.0), 0.0);
        assert_eq!(predicted_contact_radius(200e3, 0.3, |_| 400.0, -1.0), 0.0);
        assert_eq!(predicted_contact_radius(200e3, 0.3, |_| 1.0, 5.0), 0.95);
    }
}
