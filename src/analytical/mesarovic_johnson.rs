//! Elastic unloading of a fully plastic contact: Mesarovic & Johnson (2000), a uniform pressure
//! taken off as by rigid punches.
//!
//! Starts, as unloading from any state does, with dF/dh = 2 E* a. Holds without adhesion as long as
//! unloading stays elastic.

use super::{ElasticSphere, bisect};
use std::f64::consts::PI;

/// The state from which a fully plastic contact is unloaded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unloading {
    /// The sphere.
    pub sphere: ElasticSphere,
    /// Greatest indentation h_m.
    pub indentation: f64,
    /// Contact radius a_m there.
    pub contact_radius: f64,
    /// Normal force F_m there.
    pub force: f64,
}

impl Unloading {
    /// Mean pressure p_0 = F_m / (pi a_m^2).
    pub fn mean_pressure(&self) -> f64 {
        self.force / (PI * self.contact_radius * self.contact_radius)
    }

    /// Indentation recovered from the full load to none, 2 p_0 a_m / E*.
    pub fn recovery(&self) -> f64 {
        2.0 * self.mean_pressure() * self.contact_radius / self.sphere.effective_modulus()
    }

    /// Indentation at which contact is lost, h_m - 2 p_0 a_m / E*.
    pub fn lost(&self) -> f64 {
        self.indentation - self.recovery()
    }

    /// Contact radius over a_m at the indentation `h`: h_m - h = (2 p_0 a_m/E*) sqrt(1 - s^2); 1 at
    /// and beyond h_m, 0 once lost.
    pub fn radius_ratio(&self, h: f64) -> f64 {
        let x = ((self.indentation - h) / self.recovery()).clamp(0.0, 1.0);
        (1.0 - x * x).sqrt()
    }

    /// Force at the indentation `h` <= h_m: F/F_m = (2/pi) [asin s - s sqrt(1 - s^2)], s = a/a_m;
    /// zero once lost.
    pub fn force_at(&self, h: f64) -> f64 {
        // In x = sqrt(1 - s^2) the same is 1 - (2/pi)[asin x + x sqrt(1 - x^2)], which keeps its
        // digits near s = 1.
        let x = ((self.indentation - h) / self.recovery()).clamp(0.0, 1.0);
        self.force * (1.0 - 2.0 / PI * (x.asin() + x * (1.0 - x * x).sqrt()))
    }

    /// The inverse of [`Self::force_at`], for a force between zero and F_m.
    pub fn indentation_at(&self, force: f64) -> f64 {
        bisect(self.lost(), self.indentation, |h| self.force_at(h) - force)
    }
}

#[cfg(test)]
mod tests {
    use super::super::hertz;
    use super::*;

    #[test]
    fn unloading_curve() {
        let sphere = ElasticSphere { radius: 1.0, youngs_modulus: 200e3, poissons_ratio: 0.3 };
        let unloading = Unloading { sphere, indentation: 0.02, contact_radius: 0.2087, force: 148.8 };
        let d = 1e-9;
        let slope = (unloading.force_at(0.02) - unloading.force_at(0.02 - d)) / d;
        assert!((slope / hertz::stiffness(&sphere, 0.2087) - 1.0).abs() < 1e-4);
        assert_eq!(unloading.force_at(unloading.lost() - 1e-4), 0.0);
        for share in [0.1, 0.5, 0.9] {
            let h = unloading.indentation_at(share * 148.8);
            assert!((unloading.force_at(h) / (share * 148.8) - 1.0).abs() < 1e-9);
            let s = unloading.radius_ratio(h);
            assert!((2.0 / PI * (s.asin() - s * (1.0 - s * s).sqrt()) - share).abs() < 1e-9);
        }
    }
}
