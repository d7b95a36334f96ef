//! Full stick: first yield and static friction of a sphere on a rigid plane, Brizmer, Kligerman &
//! Etsion, *Int. J. Solids Struct.* 43 (2006) 5736-5749 (the critical load) and *Tribol. Lett.* 25
//! (2007) 61-70 (static friction).
//!
//! No point slips from where it has touched. The sphere is pressed, then sheared at constant normal
//! force, and "sliding" is the point at which dF_T/d delta_T has fallen to a tenth of its first
//! value. Fits to finite elements with E_t = 0.02 E. The constants are second-hand (not read in the
//! papers). How they compare with this program, and why the tenth is no sharp point under
//! hardening: `benches/full_stick/README.md`.

use super::{ElasticSphere, yielding};

/// Share of the first stiffness at which the sphere is said to slide.
pub const SLIDING_STIFFNESS: f64 = 0.1;

/// First yield of a frictionless contact in their fit, p_0/sigma_Y = 1.234 + 1.256 nu; against
/// [`yielding::first_yield`] 0.9 % low at nu = 0.2, 0.4 % at 0.25, 0.1 % at 0.3 and 0.4, 0.8 % at
/// 0.5.
pub fn slip_constant(nu: f64) -> f64 {
    1.234 + 1.256 * nu
}

/// Normal force at first yield under full stick over the one without friction, 8.88 nu - 10.13
/// (nu^2 + 0.089), for nu from 0.2 to 0.5: 0.85 at 0.3.
pub fn critical_force_ratio(nu: f64) -> f64 {
    8.88 * nu - 10.13 * (nu * nu + 0.089)
}

/// Normal force L_c at first yield under full stick, by which they divide F_N.
pub fn critical_force(sphere: &ElasticSphere, yield_stress: f64) -> f64 {
    let nu = sphere.poissons_ratio;
    critical_force_ratio(nu) * yielding::critical_force(sphere, yield_stress, slip_constant(nu))
}

/// F_T/F_N at sliding, 0.27 coth(0.27 P*^0.35), with P* = F_N/L_c.
pub fn static_friction(load: f64) -> f64 {
    0.27 / (0.27 * load.powf(0.35)).tanh()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_constants_meet_what_is_known_otherwise() {
        // A fit, with its measured departures from Mises' criterion.
        for (nu, departure) in [(0.2, -0.0089), (0.25, -0.0041), (0.3, -0.0012), (0.4, -0.0012), (0.5, -0.0081)] {
            let exact = yielding::first_yield(nu).pressure_ratio;
            assert!((slip_constant(nu) / exact - 1.0 - departure).abs() < 2e-4, "nu = {nu}: {} and {exact}", slip_constant(nu));
        }
        // Incompressible material does not move along a rigid plane when it is pressed: stick
        // changes nothing.
        assert!((critical_force_ratio(0.5) - 1.0).abs() < 0.01);
        assert!((critical_force_ratio(0.3) - 0.851).abs() < 1e-3);
        let steel = ElasticSphere { radius: 1.0, youngs_modulus: 500.0, poissons_ratio: 0.3 };
        assert!((critical_force(&steel, 1.0) / 6.09e-5 - 1.0).abs() < 2e-3, "{}", critical_force(&steel, 1.0));
    }

    #[test]
    fn friction_falls_to_its_plateau() {
        assert!((static_friction(1.0) - 1.024).abs() < 1e-3);
        assert!((static_friction(42.0) - 0.355).abs() < 1e-3);
        assert!((static_friction(1e6) - 0.27).abs() < 1e-6);
    }
}
