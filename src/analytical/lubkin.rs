//! Torsion of two elastic spheres pressed together, with slip in a ring: Lubkin, J. Appl. Mech. 18
//! (1951) 183; without slip Reissner & Sagoci, J. Appl. Phys. 15 (1944) 652.
//!
//! Twisting turns the surface without a component along the normal, so Hertz's pressure stays as it
//! is at any Poisson's ratio. The traction is put together from those of rigid discs of radius s
//! that turn by dg(s) (Jäger, J. Tribol. 117 (1995) 651): 4 G r dg / (pi sqrt(s^2 - r^2)) within s,
//! with the moment 16/3 G s^3 dg. That they come to mu p in the ring c < r < a is an equation of
//! Abel's for g there; what sticks within c turns by all of them. With k^2 = 1 - (c/a)^2 and the
//! complete elliptic integrals K and E
//!
//!   phi = 3 mu F_N / (4 pi G a^2) (K - E),   M = 4 mu F_N / (pi a^2) (c^3 (K - E)(c) + 3 int_c^a s^2 (K - E)(s) ds).

use std::f64::consts::PI;

/// An elastic contact of Hertz's that is twisted, of a sphere on what is rigid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Torsion {
    /// Contact radius a, a length.
    pub contact_radius: f64,
    /// Shear modulus G, a stress; of two bodies that both turn, G_1 G_2/(G_1 + G_2).
    pub shear_modulus: f64,
    /// Coulomb's coefficient.
    pub friction: f64,
    /// Normal force F_N.
    pub normal_force: f64,
}

/// Panels of the integral over the ring.
const PANELS: usize = 64;
/// Halvings of the bracket of the stick radius.
const HALVINGS: usize = 60;

impl Torsion {
    /// Moment over angle without slip, 16/3 G a^3, in force times length.
    pub fn initial_stiffness(&self) -> f64 {
        16.0 / 3.0 * self.shear_modulus * self.contact_radius.powi(3)
    }

    /// Moment at which all slips, 3 pi mu F_N a/16.
    pub fn slip_moment(&self) -> f64 {
        3.0 * PI / 16.0 * self.friction * self.normal_force * self.contact_radius
    }

    /// Angle, in rad, and moment at which what sticks has the radius `stick` times a, 0 < `stick`
    /// <= 1.
    pub fn at_stick_radius(&self, stick: f64) -> [f64; 2] {
        let Self { contact_radius: a, shear_modulus: g, friction, normal_force } = *self;
        let traction = friction * normal_force / PI;
        let angle = 0.75 * traction / (g * a * a) * difference(stick);
        // With s = 1 - (1 - c) t^2: the integrand is smooth in t at s = a.
        let inside = |t: f64| {
            let s = 1.0 - (1.0 - stick) * t * t;
            3.0 * s * s * difference(s) * 2.0 * (1.0 - stick) * t
        };
        let moment = 4.0 * traction * a * (stick.powi(3) * difference(stick) + simpson(inside));
        [angle, moment]
    }

    /// The moment at an angle, in rad, of a first twist.
    pub fn moment(&self, angle: f64) -> f64 {
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if self.at_stick_radius(middle)[0] < angle.abs() { high = middle } else { low = middle }
        }
        self.at_stick_radius(high.max(f64::MIN_POSITIVE))[1].copysign(angle)
    }
}

/// Simpson's rule from 0 to 1.
fn simpson(f: impl Fn(f64) -> f64) -> f64 {
    let h = 1.0 / PANELS as f64;
    let panel = |i: usize| {
        let x = i as f64 * h;
        f(x) + 4.0 * f(x + 0.5 * h) + f(x + h)
    };
    (0..PANELS).map(panel).sum::<f64>() * h / 6.0
}

/// K(k) - E(k) at k^2 = 1 - c^2, by the arithmetic-geometric mean (Abramowitz & Stegun 17.6).
fn difference(c: f64) -> f64 {
    let (mut a, mut b, mut power, mut sum) = (1.0, c, 0.5, 0.5 * (1.0 - c * c));
    // Quadratic: eight suffice for any c that is a number.
    for _ in 0..40 {
        let half = 0.5 * (a - b);
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
        power *= 2.0;
        sum += power * half * half;
        if half <= 1e-17 * a {
            break;
        }
    }
    0.5 * PI / a * sum
}

#[cfg(test)]
mod tests {
    use super::*;

    const CONTACT: Torsion = Torsion { contact_radius: 0.1, shear_modulus: 80e3, friction: 0.3, normal_force: 5.0 };

    #[test]
    fn the_elliptic_integrals_are_those_of_the_tables() {
        // Abramowitz & Stegun, table 17.1: m = 0.5 and 0.9.
        assert!((difference(0.5f64.sqrt()) - (1.854_074_677_3 - 1.350_643_881_0)).abs() < 1e-9);
        assert!((difference(0.1f64.sqrt()) - (2.578_092_113_3 - 1.104_774_732_7)).abs() < 1e-9);
    }

    #[test]
    fn a_small_twist_is_without_slip_and_a_large_one_all_slip() {
        let stiffness = CONTACT.initial_stiffness();
        let small = 1e-4 * CONTACT.slip_moment() / stiffness;
        assert!((CONTACT.moment(small) / (stiffness * small) - 1.0).abs() < 1e-3);
        assert!((CONTACT.at_stick_radius(1e-9)[1] / CONTACT.slip_moment() - 1.0).abs() < 1e-5);
        assert!(CONTACT.moment(-small) < 0.0);
    }

    #[test]
    fn moment_and_angle_fit_each_other() {
        for stick in [0.2, 0.5, 0.9] {
            let [angle, moment] = CONTACT.at_stick_radius(stick);
            assert!((CONTACT.moment(angle) / moment - 1.0).abs() < 1e-9);
            // dM/dphi is what the sticking disc does.
            let [less, more] = [stick - 1e-5, stick + 1e-5].map(|stick| CONTACT.at_stick_radius(stick));
            let slope = (more[1] - less[1]) / (more[0] - less[0]);
            assert!((slope / (CONTACT.initial_stiffness() * stick.powi(3)) - 1.0).abs() < 1e-5, "{stick}");
        }
    }
}
