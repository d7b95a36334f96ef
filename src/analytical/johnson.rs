//! Johnson's normalised variables, as Olsson & Larsson (2014) define them in eqs 1 and 2.

use super::ElasticSphere;
use std::f64::consts::PI;

/// Tabor's representative strain eps_rep = 0.2 a/R (Tabor 1951).
pub fn representative_strain(sphere: &ElasticSphere, a: f64) -> f64 {
    0.2 * a / sphere.radius
}

/// Johnson's parameter Lambda = E a / ((1 - nu^2) sigma_rep R) (Olsson & Larsson 2014, eq. 2).
/// Below about 2.5 the contact is elastic (level I), above about 160 fully plastic (level III).
pub fn lambda(sphere: &ElasticSphere, representative_stress: f64, a: f64) -> f64 {
    sphere.effective_modulus() * a / (representative_stress * sphere.radius)
}

/// Normalised hardness Hbar = F / (pi a^2 sigma_rep) (Olsson & Larsson 2014, eq. 1).
pub fn normalized_hardness(force: f64, representative_stress: f64, a: f64) -> f64 {
    force / (PI * a * a * representative_stress)
}

/// Hertz in these variables: Hbar = 4 Lambda / (3 pi), exact in level I.
pub fn elastic_hardness(lambda: f64) -> f64 {
    4.0 * lambda / (3.0 * PI)
}

#[cfg(test)]
mod tests {
    use super::super::hertz;
    use super::*;

    #[test]
    fn hertz_in_normalised_variables() {
        let sphere = ElasticSphere { radius: 2.0, youngs_modulus: 70e3, poissons_ratio: 0.33 };
        let (a, stress) = (0.01, 250.0);
        let hardness = normalized_hardness(hertz::force_from_radius(&sphere, a), stress, a);
        assert!((hardness / elastic_hardness(lambda(&sphere, stress, a)) - 1.0).abs() < 1e-14);
        assert!((representative_strain(&sphere, a) - 0.001).abs() < 1e-18);
    }
}
