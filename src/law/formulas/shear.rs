//! The formulas of a shear: smooth correlations with few constants, every one with its elastic
//! limit built in.
//!
//! With Lambda_Y at first yield, g = 1 - (Lambda_Y/Lambda)^2 and c^2 = a^2/(2 R h), z says how much
//! larger the contact is than an elastic one, and w how fast it has grown since first yield (fast
//! without hardening, slowly with it):
//! ```text
//! z             = g (2 c^2 - 1), w = z/ln(Lambda/Lambda_Y)
//! F_N_slip/F_N0 = 1 - tanh(A mu) tanh[B mu^p z^q exp(r mu w - d a/R)]  fall of the normal force
//! n             = 3/2 + N tanh[C mu^p z^(q exp(-s mu)) exp(r mu w - d a/R) / N], N = 8.5  exponent of f_T
//! delta_T_end   = 3 mu F_N0 (2 - nu)/(16 G a) f,                       where the curves end, x = 1:
//!             f = (2 n/3) (F_N_slip/F_N0) (1 + b a/R + S z^q)          through the initial stiffness
//! f_T           = 1 - (1 - x)^n
//! f_N           = 1 - (1 - x^M)^N                                      N = 1 + s + t (n - 3/2) steep, M = 1 + u mu^v gentle
//! ```
//! All constants are positive. Below first yield z = w = 0, so that n = 3/2, F_N_slip = F_N0 and
//! f = 1 + b a/R: Cattaneo and Mindlin's law for a half-space (a/R = 0), and for a sphere the
//! compliance b of the body between the contact and the equator, where delta_T is prescribed.

use serde::{Deserialize, Serialize};

/// Greatest n - 3/2. Beyond n = 10, f_T is an exponential for all that can be seen, and
/// delta_T_end would no longer be the displacement at which sliding starts.
pub const EXPONENT_SPAN: f64 = 8.5;

/// f_T(x) = 1 - (1 - x)^n, x clamped to \[0, 1\].
pub fn f_t(x: f64, n: f64) -> f64 {
    1.0 - (1.0 - x.clamp(0.0, 1.0)).powf(n)
}

/// f_N(x) = 1 - (1 - x^M)^N, x clamped to \[0, 1\].
pub fn f_n(x: f64, m_exponent: f64, n_exponent: f64) -> f64 {
    1.0 - (1.0 - x.clamp(0.0, 1.0).powf(m_exponent)).powf(n_exponent)
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
    /// w >= 0, the growth of the contact since first yield, zero up to it.
    pub growth: f64,
}

impl Plasticity {
    /// From the normalised variables of a contact, `lambda_yield` being Lambda at first yield.
    pub fn new(friction: f64, relative_radius: f64, lambda: f64, lambda_yield: f64, c_squared: f64) -> Self {
        let elastic = Self { friction, relative_radius, z: 0.0, growth: 0.0 };
        // Written so that a NaN is elastic.
        if !(lambda > lambda_yield) {
            return elastic;
        }
        let ratio = lambda / lambda_yield;
        let ramp = 1.0 - 1.0 / (ratio * ratio);
        let z = ramp * (2.0 * c_squared - 1.0);
        let positive = |x: f64| if x > 0.0 && x.is_finite() { x } else { 0.0 };
        Self { z: positive(z), growth: positive(z / ratio.ln()), ..elastic }
    }

    /// mu^p z^q.
    fn product(&self, p: f64, q: f64) -> f64 {
        if self.z <= 0.0 { 0.0 } else { self.friction.powf(p) * self.z.powf(q) }
    }
}

/// The constants of a law; the letters are those of the module's formulas.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ShearConstants {
    /// F_N_slip/F_N0: A, B, p, q, r, d.
    pub fall: [f64; 6],
    /// n: C, p, q, d, s, r.
    pub exponent: [f64; 6],
    /// f: b, S, one that no formula has, q.
    pub slip: [f64; 4],
    /// The exponents of f_N: s, t, u, v.
    pub curve: [f64; 4],
}

impl ShearConstants {
    /// Every constant of order one, from which the fits start and to which what the data leave open
    /// is drawn.
    pub const START: Self = Self {
        fall: [1.0, 1.0, 0.5, 1.0, 1.0, 0.5],
        exponent: [10.0, 1.0, 2.0, 1.0, 1.0, 1.0],
        slip: [1.0, 0.3, 1.0, 1.0],
        curve: [0.5, 0.5, 0.5, 1.0],
    };
    /// How many there are in the formulas.
    pub const COUNT: usize = 19;
}

/// 1 - F_N_slip/F_N0, in \[0, 1).
pub fn fall(constants: &[f64; 6], state: &Plasticity) -> f64 {
    let [a, b, p, q, r, d] = *constants;
    let size = (r * state.friction * state.growth - d * state.relative_radius).exp();
    (a * state.friction).tanh() * (b * state.product(p, q) * size).tanh()
}

/// n of f_T.
pub fn exponent(constants: &[f64; 6], state: &Plasticity) -> f64 {
    let [c, p, q, d, s, r] = *constants;
    // The less friction, the later after first yield n begins to grow.
    let power = q * (-s * state.friction).exp();
    let size = (r * state.friction * state.growth - d * state.relative_radius).exp();
    1.5 + EXPONENT_SPAN * (c * state.product(p, power) * size / EXPONENT_SPAN).tanh()
}

/// f = delta_T_end over its elastic value, given n and F_N_slip/F_N0.
pub fn slip_factor(constants: &[f64; 4], state: &Plasticity, n: f64, slip_share: f64) -> f64 {
    let [body, rate, _, q] = *constants;
    n / 1.5 * slip_share * (1.0 + body * state.relative_radius + rate * state.z.powf(q))
}

/// (M, N) of f_N, both at least 1, so that F_N leaves its start smoothly.
pub fn curve_exponents(constants: &[f64; 4], friction: f64, n: f64) -> (f64, f64) {
    let [s, t, u, v] = *constants;
    (1.0 + u * friction.powf(v), 1.0 + s + t * (n - 1.5))
}
