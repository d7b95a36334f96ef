//! The similarity limit of fully plastic contact with power-law hardening: Biwa & Storåkers (1995),
//! Storåkers, Biwa & Larsson (1997).
//!
//! For sigma = sigma_0 eps^(1/m) without elasticity, at small a/R: F = 3 pi a^2 sigma_0 (a/(6
//! R))^(1/m) and a^2 = 2 c^2 R h. The constants are second-hand; c^2 is 1.43 (m = inf), 1.0 (m = 3)
//! and 0.5 (m = 1) there, here the fit 1.43 exp(-0.97/m) of Olsson & Larsson (2016), which is
//! within 9 % of all three.

use super::olsson_larsson::plastic_c_squared;
use std::f64::consts::PI;

/// Normal force at the contact radius `a` of a sphere of radius `radius`; `exponent` = m,
/// `f64::INFINITY` for no hardening.
pub fn force_from_radius(radius: f64, coefficient: f64, exponent: f64, a: f64) -> f64 {
    3.0 * PI * a * a * coefficient * (a / (6.0 * radius)).powf(1.0 / exponent)
}

/// c^2 = a^2/(2 R h), constant along the path.
pub fn c_squared(exponent: f64) -> f64 {
    plastic_c_squared(1.0 / exponent)
}

/// Contact radius at the indentation `h`.
pub fn contact_radius(radius: f64, exponent: f64, h: f64) -> f64 {
    (2.0 * c_squared(exponent) * radius * h.max(0.0)).sqrt()
}

/// Normal force at the indentation `h`, proportional to h^(1 + 1/(2m)).
pub fn force(radius: f64, coefficient: f64, exponent: f64, h: f64) -> f64 {
    force_from_radius(radius, coefficient, exponent, contact_radius(radius, exponent, h))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits() {
        for (exponent, digest) in [(f64::INFINITY, 1.43), (3.0, 1.0), (1.0, 0.5)] {
            assert!((c_squared(exponent) / digest - 1.0).abs() < 0.09, "m = {exponent}: {}", c_squared(exponent));
        }
        // No hardening: three times the yield stress on the area.
        assert!((force_from_radius(2.0, 400.0, f64::INFINITY, 0.1) / (3.0 * PI * 0.01 * 400.0) - 1.0).abs() < 1e-14);
        // The power of h.
        let slope = (force(1.0, 500.0, 4.0, 0.02) / force(1.0, 500.0, 4.0, 0.01)).log2();
        assert!((slope - 1.125).abs() < 1e-12);
        // m = 1 is incompressible elasticity, Hertz with E* = 4/3 sigma_0: 12 % off, as similarity
        // says little about it.
        let hertz = 16.0 / 9.0 * 0.05f64.powi(3);
        assert!((force_from_radius(1.0, 1.0, 1.0, 0.05) / hertz - 0.8836).abs() < 1e-3);
    }
}
