//! Elastic-plastic normal contact without hardening: Kogut & Etsion, *J. Appl. Mech.* 69 (2002)
//! 657-662.
//!
//! Power laws in omega* = h/h_c for 1 to 6 and 6 to 110, Hertz below 1; the last one is continued
//! beyond 110. The constants are second-hand (not read in the paper), and the pieces do not meet: F
//! jumps by 3 % at 1 and 1.7 % at 6, A by -7 % and 3 %. The paper's h_c comes from p_0 = (0.454 +
//! 0.41 nu) H with H = 2.8 sigma_Y, within 0.3 % of Mises' at nu = 0.3; here it is Mises'.

use super::{ElasticSphere, yielding};
use std::f64::consts::PI;

/// The model for one sphere and one yield stress.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KogutEtsion {
    /// The sphere.
    pub sphere: ElasticSphere,
    /// Yield stress sigma_Y.
    pub yield_stress: f64,
}

impl KogutEtsion {
    fn constant(&self) -> f64 {
        yielding::first_yield(self.sphere.poissons_ratio).pressure_ratio
    }

    /// omega* = h/h_c.
    pub fn interference(&self, h: f64) -> f64 {
        h / yielding::critical_indentation(&self.sphere, self.yield_stress, self.constant())
    }

    /// Normal force: F/F_c = omega*^1.5, then 1.03 omega*^1.425 from 1, then 1.40 omega*^1.263
    /// from 6.
    pub fn force(&self, h: f64) -> f64 {
        let omega = self.interference(h.max(0.0));
        let ratio = match omega {
            ..1.0 => omega.powf(1.5),
            1.0..6.0 => 1.03 * omega.powf(1.425),
            _ => 1.40 * omega.powf(1.263),
        };
        ratio * yielding::critical_force(&self.sphere, self.yield_stress, self.constant())
    }

    /// Contact area: A/A_c = omega*, then 0.93 omega*^1.136 from 1, then 0.94 omega*^1.146 from 6.
    pub fn area(&self, h: f64) -> f64 {
        let omega = self.interference(h.max(0.0));
        let ratio = match omega {
            ..1.0 => omega,
            1.0..6.0 => 0.93 * omega.powf(1.136),
            _ => 0.94 * omega.powf(1.146),
        };
        ratio * yielding::critical_area(&self.sphere, self.yield_stress, self.constant())
    }

    /// Contact radius sqrt(A/pi).
    pub fn contact_radius(&self, h: f64) -> f64 {
        (self.area(h) / PI).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_meet_as_well_as_documented() {
        let sphere = ElasticSphere { radius: 1.0, youngs_modulus: 200e3, poissons_ratio: 0.3 };
        let model = KogutEtsion { sphere, yield_stress: 400.0 };
        let h_c = 1.0 / model.interference(1.0);
        let jump = |omega: f64, f: &dyn Fn(f64) -> f64| f(omega * h_c * (1.0 + 1e-9)) / f(omega * h_c * (1.0 - 1e-9)) - 1.0;
        for (omega, force, area) in [(1.0, 0.03, -0.07), (6.0, 0.017, 0.029)] {
            assert!((jump(omega, &|h| model.force(h)) - force).abs() < 1e-3);
            assert!((jump(omega, &|h| model.area(h)) - area).abs() < 1e-3);
        }
        let paper = (0.454 + 0.41 * 0.3) * 2.8;
        assert!((paper / model.constant() - 1.0).abs() < 3e-3);
    }
}
