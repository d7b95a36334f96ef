//! Elastic shear at constant normal force: Cattaneo (1938), Mindlin (1949); reversal after Mindlin
//! & Deresiewicz (1953).
//!
//! Exact for a Hertz contact without normal-tangential coupling (Dundurs' beta = 0, against a rigid
//! plane only nu = 0.5) and with slip taken along the shear direction only. Displacements are those
//! of the contact region relative to distant points; a displacement prescribed at the equator
//! includes the body's own compliance, of relative size a/R.

use super::{ElasticSphere, hertz};

/// A Hertz contact under a constant normal force, ready to be sheared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CattaneoMindlin {
    sphere: ElasticSphere,
    /// Contact radius a.
    pub contact_radius: f64,
    /// Normal force F_N.
    pub normal_force: f64,
    /// Coulomb's coefficient mu.
    pub friction: f64,
}

impl CattaneoMindlin {
    /// The contact pressed to the indentation `h0`.
    pub fn at_indentation(sphere: ElasticSphere, friction: f64, h0: f64) -> Self {
        Self { sphere, contact_radius: hertz::contact_radius(&sphere, h0), normal_force: hertz::force(&sphere, h0), friction }
    }

    /// Initial tangential stiffness k_T0 = 8 G a / (2 - nu) (Mindlin 1949).
    pub fn initial_stiffness(&self) -> f64 {
        initial_stiffness(&self.sphere, self.contact_radius)
    }

    /// Displacement at which everything slips, d_s = 3 mu F_N (2 - nu) / (16 G a).
    pub fn slip_displacement(&self) -> f64 {
        1.5 * self.friction * self.normal_force / self.initial_stiffness()
    }

    /// First loading, F_T = mu F_N [1 - (1 - d/d_s)^1.5], and mu F_N from d_s on; odd in
    /// `displacement`.
    pub fn force(&self, displacement: f64) -> f64 {
        let limit = self.friction * self.normal_force;
        let d = displacement.abs();
        let slip = self.slip_displacement();
        let size = if d >= slip { limit } else { limit * (1.0 - (1.0 - d / slip).powf(1.5)) };
        size.copysign(displacement)
    }

    /// The displacement at which [`force`](Self::force) has come to a share of mu F_N on first
    /// loading, d_s [1 - (1 - share)^(2/3)]; 0 to 1.
    pub fn displacement(&self, share: f64) -> f64 {
        self.slip_displacement() * (1.0 - (1.0 - share.clamp(0.0, 1.0)).powf(2.0 / 3.0))
    }

    /// Shear forward to `turning` > 0 and then back: F = F_1 - 2 mu F_N {1 - [1 - (d_1 - d)/(2
    /// d_s)]^1.5} until -d_1, where first loading in the other direction goes on (Mindlin &
    /// Deresiewicz 1953). A turning point beyond d_s counts as d_s from the point of return.
    pub fn reversed_force(&self, turning: f64, displacement: f64) -> f64 {
        let limit = self.friction * self.normal_force;
        let slip = self.slip_displacement();
        let fall = turning - displacement;
        if fall <= 0.0 {
            return self.force(displacement);
        }
        // Past d_s the whole contact has slid along: the elastic branch starts from the turning
        // point all the same.
        if fall >= 2.0 * turning.min(slip) {
            return self.force(displacement - (turning - turning.min(slip)));
        }
        self.force(turning) - 2.0 * limit * (1.0 - (1.0 - fall / (2.0 * slip)).powf(1.5))
    }

    /// Radius of the stick zone, c = a (1 - F_T/(mu F_N))^(1/3), on first loading; zero once
    /// everything slips.
    pub fn stick_radius(&self, tangential_force: f64) -> f64 {
        let share = 1.0 - tangential_force.abs() / (self.friction * self.normal_force);
        self.contact_radius * share.max(0.0).cbrt()
    }

    /// Shear traction on first loading, q = mu p_0 sqrt(1 - r^2/a^2), less mu p_0 (c/a) sqrt(1 -
    /// r^2/c^2) inside the stick radius c.
    pub fn traction(&self, tangential_force: f64, r: f64) -> f64 {
        let a = self.contact_radius;
        let c = self.stick_radius(tangential_force);
        let peak = self.friction * hertz::maximum_pressure(&self.sphere, a);
        let ellipse = |radius: f64| if r.abs() < radius { (1.0 - (r / radius).powi(2)).sqrt() } else { 0.0 };
        (peak * (ellipse(a) - c / a * ellipse(c))).copysign(tangential_force)
    }
}

/// Initial tangential stiffness of any circular contact without slip, k_T0 = 8 G a / (2 - nu)
/// (Mindlin 1949); an upper bound where shear starts from a plastic contact at its greatest load.
pub fn initial_stiffness(sphere: &ElasticSphere, a: f64) -> f64 {
    8.0 * sphere.shear_modulus() * a / (2.0 - sphere.poissons_ratio)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn displacement_is_the_inverse_of_force() {
        let contact = contact();
        for share in [0.0, 0.3, 0.99, 1.0] {
            let force = contact.force(contact.displacement(share));
            assert!((force - share * contact.friction * contact.normal_force).abs() < 1e-12 * contact.normal_force);
        }
    }

    fn contact() -> CattaneoMindlin {
        let sphere = ElasticSphere { radius: 1.0, youngs_modulus: 200e3, poissons_ratio: 0.3 };
        CattaneoMindlin::at_indentation(sphere, 0.3, 1e-4)
    }

    #[test]
    fn stiffness_slip_and_oddness() {
        let contact = contact();
        let slip = contact.slip_displacement();
        let g = contact.sphere.shear_modulus();
        let expected = 3.0 * 0.3 * contact.normal_force * 1.7 / (16.0 * g * contact.contact_radius);
        assert!((slip / expected - 1.0).abs() < 1e-14);
        let d = 1e-7 * slip;
        assert!((contact.force(d) / (d * contact.initial_stiffness()) - 1.0).abs() < 1e-6);
        assert_eq!(contact.force(slip), 0.3 * contact.normal_force);
        assert_eq!(contact.force(-0.4 * slip), -contact.force(0.4 * slip));
        assert_eq!(contact.stick_radius(contact.force(2.0 * slip)), 0.0);
        assert_eq!(contact.stick_radius(0.0), contact.contact_radius);
    }

    #[test]
    fn traction_integrates_to_the_force() {
        let contact = contact();
        let f_t = contact.force(0.5 * contact.slip_displacement());
        let n = 200_000;
        let dr = contact.contact_radius / n as f64;
        let total: f64 = (0..n)
            .map(|i| {
                let r = (i as f64 + 0.5) * dr;
                2.0 * PI * r * dr * contact.traction(f_t, r)
            })
            .sum();
        assert!((total / f_t - 1.0).abs() < 1e-5);
        assert_eq!(contact.traction(-f_t, 0.0), -contact.traction(f_t, 0.0));
    }

    #[test]
    fn reversal_closes_the_loop() {
        let contact = contact();
        let slip = contact.slip_displacement();
        for turning in [0.3 * slip, 0.9 * slip] {
            assert!((contact.reversed_force(turning, turning) - contact.force(turning)).abs() < 1e-12);
            // Antisymmetric at the other end of the loop, and continuous there.
            let end = contact.reversed_force(turning, -turning * (1.0 - 1e-12));
            assert!((end / contact.force(-turning) - 1.0).abs() < 1e-9);
            // Starts back with the initial stiffness.
            let d = 1e-7 * slip;
            let slope = (contact.force(turning) - contact.reversed_force(turning, turning - d)) / d;
            assert!((slope / contact.initial_stiffness() - 1.0).abs() < 1e-5);
        }
        // After gross sliding the loop spans 2 d_s from the turning point.
        let turning = 3.0 * slip;
        assert!((contact.reversed_force(turning, turning - 2.0 * slip) + 0.3 * contact.normal_force).abs() < 1e-12);
        assert!((contact.reversed_force(turning, turning - 1.999_999 * slip) + 0.3 * contact.normal_force).abs() < 1e-6);
    }
}
