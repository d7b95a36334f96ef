//! Contact parameters from a fitted law and a material.

use super::model::{Axisymmetric, Law, Parameters};
use super::shear::{f_n, f_t};
use crate::analytical::cattaneo_mindlin;
use crate::contact_law::{ContactError, ContactParameters, FirstLoading, Given, POINTS, VirginPoint, unloading_exponent};
use crate::law::variables::{Body, yield_lambda};

/// Greatest tabulated indentation over R.
pub const LAST: f64 = 0.15;
/// First tabulated indentation over R of a sphere that yields later or never. Below it the powers
/// of h of a half-space hold, as a/R is 0.001.
const ELASTIC_FIRST: f64 = 1e-6;

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

impl Law {
    /// What the contact update needs of a sphere on a rigid plane with Coulomb friction `friction`
    /// >= 0: F_N0 and a from the law's normal model.
    ///
    /// The stiffness of a reversal is Mindlin's (1949), 8 G a/(2 - nu), in series with the
    /// compliance b a/R of the body up to its equator, where delta_T is measured; b is the law's
    /// constant for it.
    ///
    /// # Errors
    /// [`ContactError`]: `friction` is negative or not finite, or the law gives no positive numbers
    /// for this material.
    pub fn contact_parameters(&self, body: &Body, friction: f64) -> Result<ContactParameters, ContactError> {
        if !(friction >= 0.0 && friction.is_finite()) {
            return Err(ContactError::Friction { value: friction });
        }
        let sphere = body.sphere;
        let (radius, modulus) = (sphere.radius, sphere.effective_modulus());
        let contact = |h: f64| {
            let state = self.normal.state(body, friction, h);
            // Without friction there is no displacement at full slip, and none is asked for.
            let inputs = Axisymmetric::of(body, if friction > 0.0 { friction } else { 1e-6 }, h, state);
            let compliance = 1.0 + self.constants.slip[0] * (state.a / radius);
            let k_t = cattaneo_mindlin::initial_stiffness(&sphere, state.a) / compliance;
            let Parameters { f_n0, f_n_slip, delta_t_end, n, m_exponent, n_exponent, .. } = self.contact(&inputs);
            // The sliders must be able to follow the curve of the shear at its start.
            let k_t = k_t.max(n * friction * f_n_slip / delta_t_end);
            let x = |j: usize| ((j + 1) as f64 / POINTS as f64).powi(2);
            let tangential = std::array::from_fn(|j| f_t(x(j), n));
            let normal = std::array::from_fn(|j| f_n(x(j), m_exponent, n_exponent));
            Given {
                point: VirginPoint { a: state.a, f_n0, f_n_slip, delta_t_end, k_t, c: 0.0 },
                unloading_radius: None,
                // The law has no curve of a reversal: that of an unloading, or of the shear.
                backbone: unloading_exponent(radius, modulus, state.a, f_n0).min(n),
                coefficient: None,
                shapes: [tangential, normal],
            }
        };
        let range = [first_indentation(body), LAST * radius];
        Ok(ContactParameters::new(FirstLoading::tabulate(radius, modulus, friction, range, contact)?))
    }
}
