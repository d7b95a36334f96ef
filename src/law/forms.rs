//! The candidate forms of the law: smooth correlations with few constants, every one with its
//! elastic limit built in.
//!
//! With z the plasticity of the contact in one of the [`Variable`]s, zero at first yield, and g =
//! 1 - (Lambda_Y/Lambda)^2,
//! ```text
//! F_N_slip/F_N0 = 1 - tanh(A mu) tanh[B mu^p z^q exp(r mu w - d a/R)]  fall of the normal force
//! n             = 3/2 + N tanh[C mu^p z^(q exp(-s mu)) exp(r mu w - d a/R) / N], N = 8.5  exponent of f_T
//! delta_T_slip  = 3 mu F_N0 (2 - nu)/(16 G a) f(y),                  displacement at full slip:
//!             f = 1 + b a/R + S mu^p z^q                               directly, or
//!             f = (2 n/3) (F_N_slip/F_N0) (1 + b a/R + S z^q)          through the initial stiffness
//! f_N           = [1 - (1 - x)^M]^N or 1 - (1 - x^M)^N               one steep exponent 1 + s + t (n - 3/2), one gentle one 1 + u mu^v
//! ```
//! w = g (2 c^2 - 1)/ln(Lambda/Lambda_Y), c^2 = a^2/(2 R h), is how fast the contact has grown
//! since first yield: fast without hardening, slowly with it. All constants are positive. Below
//! first yield z = w = 0, so that n = 3/2, F_N_slip = F_N0 and f = 1 + b a/R: Cattaneo and
//! Mindlin's law for a half-space (a/R = 0), and for a sphere the compliance b of the body between
//! the contact and the equator, where delta_T is prescribed.

use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

pub use crate::contact_law::NormalCurve;

/// Greatest n - 3/2. Beyond n = 10, f_T is an exponential for all that can be seen, and
/// delta_T_slip would no longer be the displacement at which sliding starts.
pub const EXPONENT_SPAN: f64 = 8.5;

/// In what the plasticity z of a contact is measured. The first three are the candidates of Olsson
/// & Larsson's (2014) y.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Variable {
    /// z = ln(Lambda/Lambda_Y).
    Lambda,
    /// z = ln(1 + mu (Lambda - Lambda_Y)); mu enters in no other way (p = 0).
    FrictionLambda,
    /// z = g ln(y/y_Hertz), y = k_T0 a0/F_N0 with Mindlin's k_T0, y_Hertz its value for an elastic
    /// contact of the same radius: the ratio is that of Hertz's force to the actual one, 4
    /// Lambda/(3 pi Hbar).
    Stiffness,
    /// z = g (2 c^2 - 1), c^2 = a^2/(2 R h): what the contact is larger than an elastic one.
    Area,
}

impl Variable {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Lambda, Self::FrictionLambda, Self::Stiffness, Self::Area];

    /// How a table calls it.
    pub fn label(self) -> &'static str {
        match self {
            Self::Lambda => "Lambda",
            Self::FrictionLambda => "mu Lambda",
            Self::Stiffness => "k_T0 a0/F_N0",
            Self::Area => "c^2",
        }
    }
}

/// How delta_T_slip is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SlipForm {
    /// f = 1 + b a/R + S mu^p z^q.
    Direct,
    /// f from n and a correction of Mindlin's initial stiffness.
    ThroughStiffness,
}

impl SlipForm {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Direct, Self::ThroughStiffness];

    /// How a table calls it.
    pub fn label(self) -> &'static str {
        match self {
            Self::Direct => "direct",
            Self::ThroughStiffness => "stiffness",
        }
    }
}

/// f_T(x) = 1 - (1 - x)^n, x clamped to \[0, 1\].
pub fn f_t(x: f64, n: f64) -> f64 {
    1.0 - (1.0 - x.clamp(0.0, 1.0)).powf(n)
}

/// Which of the forms.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Forms {
    /// The measure of plasticity.
    pub variable: Variable,
    /// delta_T_slip.
    pub slip_displacement: SlipForm,
    /// f_N.
    pub normal_curve: NormalCurve,
}

impl Forms {
    /// Number of fitted constants.
    pub fn constants(&self) -> usize {
        // With mu Lambda, mu^p is in the variable; through the stiffness, S z^q has none.
        let powers = if self.variable == Variable::FrictionLambda { 0 } else { 1 };
        let slip = match self.slip_displacement {
            SlipForm::Direct => 3 + powers,
            SlipForm::ThroughStiffness => 3,
        };
        (5 + powers) + (5 + powers) + slip + 4
    }
}

/// What the correlations see of a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plasticity {
    /// mu.
    pub friction: f64,
    /// a/R.
    pub relative_radius: f64,
    /// z >= 0: zero up to first yield.
    pub z: f64,
    /// w >= 0, the growth of the contact since first yield: g (2 c^2 - 1)/ln(Lambda/Lambda_Y), zero
    /// up to it.
    pub growth: f64,
}

impl Plasticity {
    /// From the normalised variables of a contact (`hardness` is Hbar), `lambda_yield` being Lambda
    /// at first yield.
    pub fn new(
        variable: Variable,
        friction: f64,
        relative_radius: f64,
        lambda: f64,
        lambda_yield: f64,
        hardness: f64,
        c_squared: f64,
    ) -> Self {
        let elastic = Self { friction, relative_radius, z: 0.0, growth: 0.0 };
        // Written so that a NaN is elastic.
        if !(lambda > lambda_yield) {
            return elastic;
        }
        let ratio = lambda / lambda_yield;
        let ramp = 1.0 - 1.0 / (ratio * ratio);
        let z = match variable {
            Variable::Lambda => ratio.ln(),
            Variable::FrictionLambda => (friction * (lambda - lambda_yield)).ln_1p(),
            Variable::Stiffness => ramp * (4.0 * lambda / (3.0 * PI * hardness)).ln(),
            Variable::Area => ramp * (2.0 * c_squared - 1.0),
        };
        let growth = ramp * (2.0 * c_squared - 1.0) / ratio.ln();
        let positive = |x: f64| if x > 0.0 && x.is_finite() { x } else { 0.0 };
        Self { z: positive(z), growth: positive(growth), ..elastic }
    }
}

/// The constants of a law; the letters are those of the module's formulas.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Constants {
    /// F_N_slip/F_N0: A, B, p, q, r, d.
    pub fall: [f64; 6],
    /// n: C, p, q, d, s, r.
    pub exponent: [f64; 6],
    /// f: b, S, p, q; through the stiffness there is no p.
    pub slip: [f64; 4],
    /// The exponents of f_N: s, t, u, v.
    pub curve: [f64; 4],
}

impl Constants {
    /// Every constant of order one, from which the fits start and to which what the data leave open
    /// is drawn.
    pub const START: Self = Self {
        fall: [1.0, 1.0, 0.5, 1.0, 1.0, 0.5],
        exponent: [10.0, 1.0, 2.0, 1.0, 1.0, 1.0],
        slip: [1.0, 0.3, 1.0, 1.0],
        curve: [0.5, 0.5, 0.5, 1.0],
    };

    /// All of them, in order.
    pub fn all(&self) -> impl Iterator<Item = f64> + '_ {
        self.fall.iter().chain(&self.exponent).chain(&self.slip).chain(&self.curve).copied()
    }
}

/// mu^p z^q; with y = mu Lambda friction is in z already.
fn product(variable: Variable, p: f64, q: f64, state: &Plasticity) -> f64 {
    if state.z <= 0.0 {
        return 0.0;
    }
    let friction = if variable == Variable::FrictionLambda { 1.0 } else { state.friction.powf(p) };
    friction * state.z.powf(q)
}

/// 1 - F_N_slip/F_N0, in \[0, 1).
pub fn fall(forms: &Forms, constants: &[f64; 6], state: &Plasticity) -> f64 {
    let [a, b, p, q, r, d] = *constants;
    let size = (r * state.friction * state.growth - d * state.relative_radius).exp();
    (a * state.friction).tanh() * (b * product(forms.variable, p, q, state) * size).tanh()
}

/// n of f_T.
pub fn exponent(forms: &Forms, constants: &[f64; 6], state: &Plasticity) -> f64 {
    let [c, p, q, d, s, r] = *constants;
    // The less friction, the later after first yield n begins to grow.
    let power = q * (-s * state.friction).exp();
    let size = (r * state.friction * state.growth - d * state.relative_radius).exp();
    1.5 + EXPONENT_SPAN * (c * product(forms.variable, p, power, state) * size / EXPONENT_SPAN).tanh()
}

/// f(y) = delta_T_slip over its elastic value, given n and F_N_slip/F_N0.
pub fn slip_factor(forms: &Forms, constants: &[f64; 4], state: &Plasticity, n: f64, slip_share: f64) -> f64 {
    let [body, rate, p, q] = *constants;
    let body = 1.0 + body * state.relative_radius;
    match forms.slip_displacement {
        SlipForm::Direct => body + rate * product(forms.variable, p, q, state),
        SlipForm::ThroughStiffness => n / 1.5 * slip_share * (body + rate * state.z.powf(q)),
    }
}

/// (steep, gentle) exponent of f_N, both at least 1, so that F_N leaves its start smoothly.
pub fn curve_exponents(constants: &[f64; 4], friction: f64, n: f64) -> (f64, f64) {
    let [s, t, u, v] = *constants;
    (1.0 + s + t * (n - 1.5), 1.0 + u * friction.powf(v))
}
