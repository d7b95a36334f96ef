//! Contact parameters from a fitted law and a material.

use super::virgin::{Axial, ContactError, ContactParameters};
use crate::analytical::cattaneo_mindlin;
use crate::law::model::{Axisymmetric, Law};
use crate::law::variables::{Body, yield_lambda};

/// Greatest tabulated indentation over R.
pub const LAST: f64 = 0.15;
/// First tabulated indentation over R of a sphere that yields later or never. Below it the powers
/// of h of a half-space hold, as a/R is 0.001.
pub const ELASTIC_FIRST: f64 = 1e-6;

/// First tabulated indentation: below first yield, where the contact goes with Hertz's powers of
/// h.
fn first_indentation(body: &Body) -> f64 {
    let radius = body.sphere.radius;
    if body.is_elastic() {
        return ELASTIC_FIRST * radius;
    }
    let a = yield_lambda(body.sphere.poissons_ratio) * body.hardening.flow_stress(0.0) * radius / body.sphere.effective_modulus();
    let h = 0.98 * a * a / radius;
    if h < ELASTIC_FIRST * radius { h } else { ELASTIC_FIRST * radius }
}

impl ContactParameters {
    /// The parameters of a sphere on a rigid plane with Coulomb friction `friction` >= 0: F_N0 and
    /// a from the law's normal model.
    ///
    /// The stiffness of a reversal is Mindlin's (1949), 8 G a/(2 - nu), in series with the
    /// compliance b a/R of the body up to its equator, where delta_T is measured; b is the law's
    /// constant for it.
    ///
    /// # Errors
    /// [`ContactError`]: `friction` is negative or not finite, or the law gives no positive numbers
    /// for this material.
    pub fn new(law: &Law, body: &Body, friction: f64) -> Result<Self, ContactError> {
        if !(friction >= 0.0 && friction.is_finite()) {
            return Err(ContactError::Friction { value: friction });
        }
        let sphere = body.sphere;
        let contact = |h: f64| {
            let state = law.normal.state(body, friction, h);
            let inputs = Axisymmetric {
                youngs_modulus: sphere.youngs_modulus,
                poissons_ratio: sphere.poissons_ratio,
                radius: sphere.radius,
                // Without friction there is no displacement at full slip, and none is asked for.
                friction: if friction > 0.0 { friction } else { 1e-6 },
                sigma_rep: body.representative_stress(state.a),
                h,
                a: state.a,
                f_n: state.f_n,
            };
            let compliance = 1.0 + law.constants.slip[0] * (state.a / sphere.radius);
            let k_t = cattaneo_mindlin::initial_stiffness(&sphere, state.a) / compliance;
            Axial { a: state.a, k_t, law: law.contact(&inputs) }
        };
        let range = [first_indentation(body), LAST * sphere.radius];
        Self::tabulate(sphere.radius, sphere.effective_modulus(), friction, Some(law.forms.normal_curve), range, contact)
    }
}
