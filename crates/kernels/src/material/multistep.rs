//! Plastic flow integrated to second order in the step: the two-step backward difference (BDF2), as
//! a backward Euler step from a state that anticipates a part of the flow.
//!
//! With steps of length `dt` and `omega dt` the two-step backward difference of `y' = g(y)` (Gear
//! 1971; for plasticity Papadopoulos & Taylor, Int. J. Numer. Methods Eng. 37, 1994) is
//! ```text
//! y_new = y + w (y - y_before) + (1 - w) omega dt g(y_new),    w = omega^2/(1 + 2 omega)
//! ```
//! Plastic flow has no time of its own: `(1 - w) omega dt` times its rate is the unknown multiplier
//! of the return mapping. So the formula is the ordinary return mapping from the state `y + w (y -
//! y_before)`, in which the flow of the last step has gone on for a while: nothing in an iteration
//! changes. A point that turns out not to flow any more has anticipated what did not happen; it is
//! updated from its committed state.
//!
//! A backward Euler step balances, at its end, stresses that belong to the mean flow of the step:
//! where a contact spreads the error of its radius and force is of the first order in the step,
//! however exactly a straight strain path is integrated within a step.

use serde::{Deserialize, Serialize};

use super::j2::{
    Response, determinant, determinant_minus_one, deviator, isochoric_factor_minus_one, isochoric_mean, norm_squared,
    return_mapping,
};
use super::{Material, PointError, PointState};
use crate::real::Real;

/// Longest step over its predecessor for which the formula is used as it is: it is stable up to 1 +
/// sqrt 2.
const LARGEST_RATIO: f64 = 2.0;

/// What flowed at a point in its last step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Flow<R> {
    /// What the elastic strain dev b_e_bar lost to the flow, in the configuration at the end of the
    /// step, [xx, yy, zz, xy, yz, zx].
    pub strain: [R; 6],
    /// Increment of the equivalent plastic strain, >= 0.
    pub alpha: R,
}

/// The share w of the last step's flow that a step anticipates, from its length over the last one's
/// (both > 0, in any measure of time).
pub fn weight(ratio: f64) -> f64 {
    let omega = ratio.clamp(0.0, LARGEST_RATIO);
    omega * omega / (1.0 + 2.0 * omega)
}

/// The state from which a step starts: `weight` times the last flow is anticipated. Without flow it
/// is the committed state.
#[inline]
pub fn anticipate<R: Real>(committed: &PointState<R>, flow: &Flow<R>, weight: R) -> PointState<R> {
    if !(weight * flow.alpha > R::ZERO) {
        return *committed;
    }
    let (deviator, mean) = deviator(&committed.be);
    let start: [R; 6] = std::array::from_fn(|c| deviator[c] - weight * flow.strain[c]);
    let mean = isochoric_mean(&start, mean);
    let [xx, yy, zz, xy, yz, zx] = start;
    PointState { be: [xx + mean, yy + mean, zz + mean, xy, yz, zx], alpha: committed.alpha + weight * flow.alpha }
}

/// The response to commit and what flowed, after a step by `relative` = f - I whose `response` was
/// found from `start`, the committed state or what [`anticipate`] made of it.
///
/// # Errors
/// As [`super::j2::return_mapping`], where a point that does not flow is updated from its committed
/// state.
#[inline]
pub fn complete<R: Real>(
    material: &Material<R>,
    relative: &[[R; 3]; 3],
    committed: &PointState<R>,
    start: &PointState<R>,
    response: Response<R>,
) -> Result<(Response<R>, Flow<R>), PointError> {
    let anticipated = start.alpha > committed.alpha;
    let mut response = response;
    let kept = anticipated && response.yielding;
    if anticipated && !kept {
        response = return_mapping(material, relative, committed)?;
    }
    let length = response.beta_1 * response.norm / material.elasticity.shear;
    let mut flow = Flow { strain: response.normal.map(|n| length * n), alpha: response.state.alpha - committed.alpha };
    if kept {
        let pushed = push_forward(relative, &std::array::from_fn(|c| committed.be[c] - start.be[c]));
        flow.strain = std::array::from_fn(|c| flow.strain[c] + pushed[c]);
        // Equivalent strain of what flowed altogether, sqrt(2/3) |strain/2|: where the flow turns,
        // less than what was anticipated and what was added one by one.
        flow.alpha = flow.alpha.min(norm_squared(&flow.strain).sqrt() * R::of(1.0 / 6.0_f64.sqrt()));
        response.state.alpha = committed.alpha + flow.alpha;
        let hardening = &material.hardening;
        let work = |alpha: R| hardening.plastic_work(alpha, hardening.flow_stress(alpha));
        response.plastic_work = (work(response.state.alpha) - work(committed.alpha)).max(R::ZERO);
    }
    if response.yielding {
        response.plastic_work *= dissipated(&response.state.be);
    }
    Ok((response, flow))
}

/// What flow dissipates over the flow stress times the increment of alpha, by b_e_bar - I: 1 but
/// for a fraction of the order of the elastic strain. Dissipated is what the stored energy,
/// mu/2 (tr b_e_bar - 3), loses while the deviator of b_e_bar shrinks at a determinant of 1. With
/// s = |dev b_e_bar| and m = tr b_e_bar/3 that determinant is `m^3 - m s^2/2 + det dev b_e_bar`, so
/// that `dm/ds = (m s - 3 det/s)/(3 m^2 - s^2/2)`, and ds is -2 m times the plastic multiplier
/// (Simo & Hughes 1998, Box 9.1).
#[inline]
pub(crate) fn dissipated<R: Real>(be: &[R; 6]) -> R {
    let (strain, mean) = deviator(be);
    let square = norm_squared(&strain);
    if !(square > R::ZERO) {
        return R::ONE;
    }
    let m = R::ONE + mean;
    (m * m - R::of(3.0) * m * (determinant(&strain) / square)) / (m * m - square * R::of(1.0 / 6.0))
}

/// The deviator of J^(-2/3) f a f^T with f = I + d.
#[inline(always)]
fn push_forward<R: Real>(d: &[[R; 3]; 3], a: &[R; 6]) -> [R; 6] {
    let [xx, yy, zz, xy, yz, zx] = *a;
    let a = [[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]];
    let fa: [[R; 3]; 3] =
        std::array::from_fn(|i| std::array::from_fn(|k| a[i][k] + d[i][0] * a[0][k] + d[i][1] * a[1][k] + d[i][2] * a[2][k]));
    let scale = R::ONE + isochoric_factor_minus_one(determinant_minus_one(d));
    let m = |i: usize, k: usize| scale * (fa[i][k] + fa[i][0] * d[k][0] + fa[i][1] * d[k][1] + fa[i][2] * d[k][2]);
    deviator(&[m(0, 0), m(1, 1), m(2, 2), m(0, 1), m(1, 2), m(2, 0)]).0
}
