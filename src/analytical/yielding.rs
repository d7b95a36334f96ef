//! First yield under a Hertz pressure, by Mises' criterion on the axis, and the quantities derived
//! from it.
//!
//! The stresses on the axis are exact (Huber 1904; Johnson 1985, eq. 3.45). The axis decides for nu
//! in \[0, 0.5\]: at the edge of the contact Mises' stress is p_0 (1 - 2 nu)/sqrt(3), at most 0.58
//! p_0 against 0.77 p_0 on the axis, both at nu = 0.

use super::ElasticSphere;
use std::f64::consts::{FRAC_PI_2, PI};

/// Where and when a Hertz contact yields first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstYield {
    /// Greatest pressure over yield stress, p_0 / sigma_Y.
    pub pressure_ratio: f64,
    /// Depth of the yielding point over the contact radius, z / a.
    pub depth: f64,
}

impl FirstYield {
    /// Johnson's parameter at first yield, Lambda_Y = (pi/2) p_0/sigma_Y; 2.533 at nu = 0.3.
    pub fn lambda(&self) -> f64 {
        FRAC_PI_2 * self.pressure_ratio
    }
}

/// Mises stress on the axis over p_0, at the depth `zeta` = z/a: |sigma_z - sigma_r| with
/// sigma_z = -1/(1 + zeta^2) and sigma_r = -(1 + nu)(1 - zeta atan(1/zeta)) + 1/(2 (1 + zeta^2))
/// (Johnson 1985, eqs 3.45a, b).
pub fn axial_mises(nu: f64, zeta: f64) -> f64 {
    let fall = 1.0 / (1.0 + zeta * zeta);
    let angle = if zeta > 0.0 { (1.0 / zeta).atan() } else { FRAC_PI_2 };
    (1.5 * fall - (1.0 + nu) * (1.0 - zeta * angle)).abs()
}

/// First yield at Poisson's ratio `nu` in \[0, 0.5\], by maximising [`axial_mises`]: p_0/sigma_Y =
/// 1.3945 (nu = 0.1), 1.5543 (0.25), 1.6128 (0.3), 1.7385 (0.4), 1.8772 (0.5).
pub fn first_yield(nu: f64) -> FirstYield {
    // d/dzeta of the stress difference falls through zero once in (0.2, 1).
    let falling_slope = |zeta: f64| {
        let fall = 1.0 / (1.0 + zeta * zeta);
        -3.0 * zeta * fall * fall + (1.0 + nu) * ((1.0 / zeta).atan() - zeta * fall)
    };
    let depth = super::bisect(0.2, 1.0, |zeta| -falling_slope(zeta));
    FirstYield { pressure_ratio: 1.0 / axial_mises(nu, depth), depth }
}

/// Jackson & Green's (2005, eq. 8) fit to p_0/sigma_Y, C = 1.295 exp(0.736 nu); within 0.35 % of
/// [`first_yield`] for nu in \[0.1, 0.5\].
pub fn jackson_green_constant(nu: f64) -> f64 {
    1.295 * (0.736 * nu).exp()
}

/// Critical indentation h_c = (pi C sigma_Y / (2 E*))^2 R, where `c` is p_0/sigma_Y at first yield,
/// exact or fitted (Jackson & Green 2005).
pub fn critical_indentation(sphere: &ElasticSphere, yield_stress: f64, c: f64) -> f64 {
    (PI * c * yield_stress / (2.0 * sphere.effective_modulus())).powi(2) * sphere.radius
}

/// Critical force F_c = (4/3) (R/E*)^2 (pi C sigma_Y / 2)^3, the Hertz force at h_c (Jackson &
/// Green 2005).
pub fn critical_force(sphere: &ElasticSphere, yield_stress: f64, c: f64) -> f64 {
    4.0 / 3.0 * (sphere.radius / sphere.effective_modulus()).powi(2) * (FRAC_PI_2 * c * yield_stress).powi(3)
}

/// Critical contact area A_c = pi R h_c (Jackson & Green 2005).
pub fn critical_area(sphere: &ElasticSphere, yield_stress: f64, c: f64) -> f64 {
    PI * sphere.radius * critical_indentation(sphere, yield_stress, c)
}

#[cfg(test)]
mod tests {
    use super::super::hertz;
    use super::*;

    #[test]
    fn known_pressure_ratios_and_depth() {
        for (nu, ratio) in [(0.1, 1.3945), (0.25, 1.5543), (0.3, 1.6128), (0.4, 1.7385), (0.5, 1.8772)] {
            let yielding = first_yield(nu);
            assert!((yielding.pressure_ratio - ratio).abs() < 5e-5, "nu = {nu}: {}", yielding.pressure_ratio);
        }
        let yielding = first_yield(0.3);
        assert!((yielding.depth - 0.481).abs() < 5e-4);
        assert!((yielding.lambda() - 2.533).abs() < 5e-4);
    }

    #[test]
    fn the_maximum_is_one() {
        for nu in [0.0, 0.1, 0.3, 0.5] {
            let yielding = first_yield(nu);
            let greatest = (1..4000).map(|i| axial_mises(nu, i as f64 * 1e-3)).fold(0.0, f64::max);
            assert!((greatest * yielding.pressure_ratio - 1.0).abs() < 1e-6);
            assert!((1.0 - 2.0 * nu) / 3f64.sqrt() < greatest, "the edge would yield first at nu = {nu}");
        }
    }

    #[test]
    fn the_fit_is_as_good_as_it_says() {
        for i in 10..=50 {
            let nu = i as f64 * 0.01;
            assert!((jackson_green_constant(nu) / first_yield(nu).pressure_ratio - 1.0).abs() < 3.5e-3, "nu = {nu}");
        }
    }

    #[test]
    fn critical_values_are_hertz_at_first_yield() {
        let sphere = ElasticSphere { radius: 3.0, youngs_modulus: 200e3, poissons_ratio: 0.3 };
        let c = first_yield(0.3).pressure_ratio;
        let h_c = critical_indentation(&sphere, 400.0, c);
        let a_c = hertz::contact_radius(&sphere, h_c);
        assert!((hertz::maximum_pressure(&sphere, a_c) / (c * 400.0) - 1.0).abs() < 1e-13);
        assert!((hertz::force(&sphere, h_c) / critical_force(&sphere, 400.0, c) - 1.0).abs() < 1e-13);
        assert!((PI * a_c * a_c / critical_area(&sphere, 400.0, c) - 1.0).abs() < 1e-13);
    }
}
