//! What an elastic body gives way between its contact and the plate that holds it, beyond what a
//! half-space does.
//!
//! A sphere that is held at its equator, or a flat that is held at its dome, is no half-space:
//! under the same forces its plate comes closer than the far field of a half-space would by
//!
//! ```text
//! c_N F_N/(E R)     along the normal
//! c_T F_T/(G R)     along the surface,  c_T = c_0 + c_1 ln(a/R)
//! ```
//!
//! The logarithm is that of a curved surface. At a below 0.04 R `asperity verify` finds 0.55 a/R
//! more F_N at a given h, c_N = -0.25: here the next power of a/R is in it. The constants are
//! fits to elastic simulations with a from 0.05 to 0.2 R and nu from 0 to 0.45, which
//! `benches/turning/body.py` makes; of spheres they meet 1/k_T0 to 2 % and h to 0.9 %. R is the
//! sphere's radius; a flat is half a ball of 2 R.

/// How a body is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Held {
    /// A sphere at its equator, which is rigid.
    Clamped,
    /// A sphere at its equator, which is free to widen.
    Free,
    /// A flat at its dome.
    Dome,
}

impl Held {
    /// Coefficients of 1, nu and nu^2 of c_N, and of 1 and ln(a/R) of c_T.
    const fn constants(self) -> ([f64; 3], [f64; 2]) {
        match self {
            Self::Clamped => ([-0.142, -0.882, 1.239], [0.204, -0.126]),
            Self::Free => ([-0.119, -0.776, 1.475], [0.192, -0.132]),
            Self::Dome => ([-0.390, 0.385, -0.441], [-0.122, 0.0]),
        }
    }

    /// c_N of a body with this Poisson's ratio.
    pub fn normal(self, poissons_ratio: f64) -> f64 {
        let ([c, by_nu, by_square], _) = self.constants();
        c + poissons_ratio * (by_nu + poissons_ratio * by_square)
    }

    /// c_T at a contact radius over R; 0 without contact.
    pub fn tangential(self, contact_radius: f64) -> f64 {
        let (_, [c, by_logarithm]) = self.constants();
        if contact_radius > 0.0 { c + by_logarithm * contact_radius.ln() } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sphere_is_softer_than_a_half_space_along_its_surface_and_stiffer_along_the_normal() {
        // The fraction 0.55 a/R of F_N at a given h: h is smaller by two thirds of that.
        let expected = -0.55 * 2.0 / 3.0 * 0.75 * (1.0 - 0.09);
        assert!((Held::Clamped.normal(0.3) - expected).abs() < 0.06, "{}", Held::Clamped.normal(0.3));
        assert!((Held::Clamped.tangential(0.1) - 0.49).abs() < 0.02);
        assert!(Held::Free.normal(0.3) > Held::Clamped.normal(0.3));
        assert!(Held::Dome.tangential(0.1) < 0.0 && Held::Dome.normal(0.3) < 0.0);
        assert_eq!(Held::Clamped.tangential(0.0), 0.0);
    }
}
