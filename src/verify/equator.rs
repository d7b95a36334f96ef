//! What the body between the contact and the equator adds to the displacements.
//!
//! Hertz's h and Mindlin's delta are those of points far away in a half-space; the plate holds the
//! equator of a sphere, a distance R away. To first order in a/R the difference is linear in the
//! force, whatever the contact is like:
//!
//!   h = h_contact - c_N F_N/(E R),   delta_T = delta_contact + c_T F_T/(E R).
//!
//! c_N is what a half-space would still yield beyond the equator, less what the sphere lacks in
//! breadth; c_T is ten times as large, for the tangential force bends the body as well. No closed
//! form is known for either. They are measured by two elastic contacts without slip, of which one
//! has four times the a/R of the other: what grows with a/R is the body's, what does not is the
//! contact's and the mesh's.

use super::sphere::{History, RADIUS, YOUNGS_MODULUS, press, shear, sphere};
use super::{Check, VerifyError};
use crate::analytical::cattaneo_mindlin::initial_stiffness;
use crate::analytical::{ElasticSphere, hertz};
use crate::case::{Case, Friction, Hardening, Hold};
use crate::simulation::record::StepRecord;

/// The two compliances of the body, over 1/(E R).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compliances {
    /// Normal: the body is stiffer than the rest of a half-space.
    pub normal: f64,
    /// Tangential: it is softer.
    pub tangential: f64,
}

/// Contact radii of the two contacts.
const RADII: [f64; 2] = [0.01 * RADIUS, 0.04 * RADIUS];
/// Shear over a, small enough that no point comes off or touches.
const SHEAR: f64 = 1e-5;

impl Compliances {
    /// Measures both for one Poisson's ratio, with so many elements along the contact radius and
    /// what `follow` makes of a case.
    ///
    /// # Errors
    /// Those of `follow`.
    pub fn measure(
        nu: f64,
        elements: usize,
        mut follow: impl FnMut(&Case) -> Result<History, VerifyError>,
    ) -> Result<Self, VerifyError> {
        let small = follow(&case(nu, elements, RADII[0]))?;
        let large = follow(&case(nu, elements, RADII[1]))?;
        Ok(Self::between(&ball(nu), [&small, &large].map(ends)))
    }

    /// From the pressed and the sheared state of two contacts.
    fn between(sphere: &ElasticSphere, contacts: [(StepRecord, StepRecord); 2]) -> Self {
        // F/F_Hertz(h) = (1 + mesh) (1 + (3/2) c_N F/(E R h)), and a/k_T = (1 + mesh) (2 - nu)/(8
        // G) + c_T a/(E R).
        let [(x0, y0), (x1, y1)] =
            contacts.map(|(pressed, _)| (1.5 * pressed.f_n / pressed.h, pressed.f_n / hertz::force(sphere, pressed.h)));
        let [(a0, s0), (a1, s1)] = contacts.map(|(_, sheared)| {
            let a = hertz::contact_radius(sphere, sheared.h);
            (a, a * sheared.delta_t / sheared.f_t)
        });
        let unit = sphere.youngs_modulus * sphere.radius;
        Self { normal: unit * (y1 - y0) / (x1 - x0), tangential: unit * (s1 - s0) / (a1 - a0) }
    }

    /// The contact's own indentation.
    pub fn contact_indentation(&self, h: f64, f_n: f64) -> f64 {
        h + self.normal * f_n / (YOUNGS_MODULUS * RADIUS)
    }

    /// The contact's own tangential displacement.
    pub fn contact_shear(&self, delta_t: f64, f_t: f64) -> f64 {
        delta_t - self.tangential * f_t / (YOUNGS_MODULUS * RADIUS)
    }

    /// The compliances and what they mean for the stiffnesses of a contact of a/R = 0.01, for the
    /// table.
    pub fn rows(&self, nu: f64) -> [Check; 2] {
        let a = RADII[0];
        let (normal, tangential) = (hertz::stiffness(&ball(nu), a), initial_stiffness(&ball(nu), a));
        let share = |stiffness: f64, compliance: f64| stiffness * compliance / (YOUNGS_MODULUS * RADIUS);
        let row = |what: &str, ours: f64, because| Check::information("equator", format!("{what}, nu = {nu}"), ours, because);
        [
            row(
                "body's share of dF_N/dh at a/R = 0.01",
                share(normal, self.normal),
                "taken off wherever a closed form of the half-space is compared; proportional to a/R",
            ),
            row(
                "body's share of k_T0 at a/R = 0.01",
                -share(tangential, self.tangential),
                "taken off wherever a closed form of the half-space is compared; proportional to a/R",
            ),
        ]
    }
}

fn ball(nu: f64) -> ElasticSphere {
    ElasticSphere { radius: RADIUS, youngs_modulus: YOUNGS_MODULUS, poissons_ratio: nu }
}

fn case(nu: f64, elements: usize, a: f64) -> Case {
    let mut case =
        sphere(nu, Hardening::Elastic, 0.0, elements, vec![press(a * a / RADIUS), shear(SHEAR * a, Hold::Indentation)]);
    case.contact.friction = Friction::Stick;
    case.mesh.contact_radius = Some(a);
    case.solver.press_steps = Some(3);
    case.solver.shear_steps = Some(1);
    // F_T is a thousandth of F_N.
    case.solver.tolerance = 1e-7;
    case
}

fn ends(history: &History) -> (StepRecord, StepRecord) {
    (history.end(0), history.end(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_the_compliances_that_were_put_in() {
        let (sphere, body) = (ball(0.3), Compliances { normal: 0.2, tangential: 1.5 });
        let unit = YOUNGS_MODULUS * RADIUS;
        let contact = |a: f64| {
            let h = a * a / RADIUS;
            // To first order in c_N, with a mesh error of 1 % in both.
            let hertz = hertz::force(&sphere, h);
            let f_n = 1.01 * hertz;
            let f_n = f_n * (1.0 + 1.5 * body.normal * f_n / (unit * h));
            let delta_t = SHEAR * a;
            let f_t = delta_t / (1.01 / initial_stiffness(&sphere, a) + body.tangential / unit);
            let pressed = StepRecord { h, f_n, a, ..StepRecord::default() };
            (pressed, StepRecord { delta_t, f_t, ..pressed })
        };
        let found = Compliances::between(&sphere, RADII.map(contact));
        assert!((found.tangential / body.tangential - 1.0).abs() < 1e-9, "{found:?}");
        assert!((found.normal / body.normal - 1.0).abs() < 0.05, "{found:?}");
        assert!((found.contact_indentation(1e-4, 0.0), found.contact_shear(1e-6, 0.0)) == (1e-4, 1e-6));
        assert!(found.contact_indentation(1e-4, 0.3) > 1e-4 && found.contact_shear(1e-6, 0.3) < 1e-6);
    }
}
