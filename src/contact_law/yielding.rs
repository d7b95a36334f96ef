//! Where a contact yields: the virgin curve in F_N, the yield curve of a press under F_T, and the
//! elastic approach below them.

use super::shapes::{normal_shape, normal_shape_inverse, tangential_shape_inverse};
use super::update::ContactState;
use super::virgin::{BY_NUMBERS, ContactParameters, Virgin, VirginPoint};

/// Share of an indentation that unloading recovers at which c is the same for all ratios F_T/F_N:
/// it rises with them where more is elastic, and falls where less is. Of simulated oblique presses
/// at 15, 45 and 75 degrees.
const NO_CHANGE: f64 = 0.15;

/// Share of F_N0 from which a force counts as F_N0, so that rounding is not taken for unloading.
pub(super) const AT_CAP: f64 = 1.0 - 1e-9;

/// Share of F_N that is compared with F_N_slip, so that rounding does not decide whether a contact
/// slips as a whole.
pub(super) const AT_SLIP: f64 = 1.0 - 1e-13;

/// Greatest share of F_N_slip that is lost besides when the slip reverses, in one reversal or in
/// several.
const REVERSED: f64 = 0.05;
/// The least such share, of a contact that loses nothing to slip.
const LEAST_REVERSED: f64 = 1e-6;

/// x after all of that loss.
pub(super) const MOST: f64 = 2.0;

/// A contact that is pressed while F_T acts yields where F_N (1 + s c r^2) = F_N0, r = F_T/F_N, and
/// flows as if s were 1: simulated steady oblique presses have d(delta_T)/dh = 2 c r/(1 - c r^2)
/// for the plastic parts of both. s is this share, less what of it the contact recovers on
/// unloading. Of simulated oblique presses.
const PRESSED: f64 = 0.9;

/// F_N_slip/F_N0 from which a contact counts as elastic.
const ELASTIC: f64 = 1.0 - 1e-6;

/// F_N on the virgin curve at `x`.
pub(super) fn normal_cap(p: &ContactParameters, virgin: &Virgin, x: f64) -> f64 {
    virgin.point.f_n0 - (virgin.point.f_n0 - virgin.point.f_n_slip) * normal_shape(p, virgin, x)[0]
}

/// Whether shear costs no normal force: the sliders alone then are Cattaneo and Mindlin's contact.
pub(super) fn is_elastic(point: &VirginPoint) -> bool {
    point.f_n_slip >= ELASTIC * point.f_n0
}

/// c of F_N0/F_N = 1 + b r + c r^2, r = F_T/F_N, which the virgin curve follows; by its points at
/// 40 % and all of the slip force. The linear part belongs to a sudden shear alone. Not less than
/// half of what it is without that part.
pub(super) fn virgin_yield_coefficient(p: &ContactParameters, virgin: &Virgin) -> f64 {
    if !(p.friction > 0.0) {
        return 0.0;
    }
    let loss = virgin.point.f_n0 - virgin.point.f_n_slip;
    let at_slip = loss / (virgin.point.f_n_slip * p.friction);
    let (x, _) = tangential_shape_inverse(p, virgin, 0.4);
    let lost = loss * normal_shape(p, virgin, x)[0];
    let f_n = virgin.point.f_n0 - lost;
    let r = 0.4 * p.friction * virgin.point.f_n_slip / f_n;
    let before = lost / (f_n * r);
    let (c, least) = ((at_slip - before) / (p.friction - r), 0.5 * at_slip / p.friction);
    if c > least { c } else { least }
}

/// c of the yield curve: a table's own, or that of the virgin curve.
pub(super) fn yield_coefficient(p: &ContactParameters, virgin: &Virgin) -> f64 {
    if p.form == BY_NUMBERS { virgin.point.n } else { virgin_yield_coefficient(p, virgin) }
}

/// Share of an indentation that unloading recovers.
fn recovered(virgin: &Virgin) -> f64 {
    virgin.slope * virgin.depth / (virgin.gamma * virgin.point.f_n0)
}

/// s c of the yield curve F_N (1 + s c r^2) = F_N0.
pub(super) fn yield_share(virgin: &Virgin, c: f64) -> f64 {
    PRESSED * (1.0 - recovered(virgin)) * c
}

/// delta_T over h of the oblique press by which c is measured: at c = 2 its F_T comes to half of mu
/// F_N.
pub fn measured_slope(mu: f64) -> f64 {
    2.0 * mu / (1.0 + 0.5 * mu * mu)
}

/// c of the flow at the ratio `r` of F_T to F_N, from the `c` that was measured.
pub(super) fn flow_coefficient(p: &ContactParameters, virgin: &Virgin, c: f64, r: f64) -> f64 {
    let slope = measured_slope(p.friction);
    let measured = ((1.0 + slope * slope / c).sqrt() - 1.0) / slope;
    let share = if r < 2.0 * measured { r / measured } else { 2.0 };
    c * (1.0 + (recovered(virgin) - NO_CHANGE) * (share - 1.0))
}

/// Greatest F_N of a contact that is pressed with the tangential force `f_t`, on the yield curve of
/// this s c, and q, the square of its root; at its apex F_N0/2.
pub(super) fn pressed_cap(virgin: &Virgin, share: f64, f_t: f64) -> [f64; 2] {
    let f_n0 = virgin.point.f_n0;
    let force = f_t / f_n0;
    let q = 1.0 - 4.0 * share * (force * force);
    if q > 0.0 { [0.5 * f_n0 * (1.0 + q.sqrt()), q] } else { [0.5 * f_n0, 0.0] }
}

/// F_N on that curve at a ratio F_T/F_N.
pub(super) fn yielding_at(virgin: &Virgin, share: f64, ratio: f64) -> f64 {
    virgin.point.f_n0 / (1.0 + share * (ratio * ratio))
}

/// Share of F_N_slip that reversals cost: no more than what the slip itself has cost.
pub(super) fn reversed_share(virgin: &Virgin) -> f64 {
    let lost = virgin.point.f_n0 / virgin.point.f_n_slip - 1.0;
    let share = if lost < REVERSED { lost } else { REVERSED };
    if share > LEAST_REVERSED { share } else { LEAST_REVERSED }
}

/// The x of the virgin curve that has the normal force `f_n`.
pub(super) fn mobilisation(p: &ContactParameters, virgin: &Virgin, f_n: f64) -> f64 {
    if f_n >= AT_CAP * virgin.point.f_n0 {
        return 0.0;
    }
    if AT_SLIP * f_n <= virgin.point.f_n_slip {
        let lost = 1.0 - f_n / virgin.point.f_n_slip;
        let x = if lost > 0.0 { 1.0 + lost / reversed_share(virgin) } else { 1.0 };
        return if x < MOST { x } else { MOST };
    }
    normal_shape_inverse(p, virgin, (virgin.point.f_n0 - f_n) / (virgin.point.f_n0 - virgin.point.f_n_slip))
}

/// F_N at `x`, with what a reversed slip costs.
pub(super) fn reversed_cap(p: &ContactParameters, virgin: &Virgin, x: f64) -> f64 {
    if x < 1.0 { normal_cap(p, virgin, x) } else { virgin.point.f_n_slip * (1.0 - reversed_share(virgin) * (x - 1.0)) }
}

/// F_N over the reach of a contact: 2 E* a/gamma.
fn per_reach(virgin: &Virgin) -> f64 {
    virgin.point.f_n0 / virgin.depth
}

/// Elastic unloading: F_N at the approach `e` of a contact with this reach. It starts with 2 E* a
/// from any F_N: what shear takes of F_N leaves the contact as wide as it was.
pub(super) fn force_at(virgin: &Virgin, reach: f64, e: f64) -> f64 {
    if e <= 0.0 { 0.0 } else { per_reach(virgin) * reach * (e / reach).powf(virgin.gamma) }
}

/// The elastic response at an approach.
pub(super) struct Elastic {
    pub(super) f_n: f64,
    /// dF_N/dh.
    pub(super) stiffness: f64,
    /// The same of an unloading.
    pub(super) unloading: f64,
    pub(super) approach: f64,
    pub(super) reach: f64,
}

/// The elastic response at the approach `e` of a contact with this reach. `virgin` is first loading
/// at the greatest h so far and `old` the same before the step; they differ if the contact has
/// `grown`.
///
/// Beyond its reach the contact stores the work of the step, with the mean of the forces before and
/// after; the energy is F_N^2/(k (gamma + 1)), k = F_N/reach. Where shear has made the reach
/// smaller than D, it stores sqrt(reach/D) of the work only. Of simulated contacts that were
/// sheared first and pressed on then.
pub(super) fn elastic_at(old: &Virgin, virgin: &Virgin, grown: bool, reach: f64, e: f64) -> Elastic {
    if e <= reach && !grown {
        let f_n = force_at(virgin, reach, e);
        let stiffness = if e > 0.0 { virgin.gamma * f_n / e } else { 0.0 };
        return Elastic { f_n, stiffness, unloading: stiffness, approach: e, reach };
    }
    let began = per_reach(old) * reach;
    let half = if e > reach { 0.5 * (e - reach) } else { 0.0 };
    let softness = 1.0 / (per_reach(virgin) * (virgin.gamma + 1.0));
    let kept = half * (reach / old.depth).sqrt();
    let stored = began * reach / (old.gamma + 1.0) + began * kept;
    let f_n = (kept + (kept * kept + 4.0 * softness * stored).sqrt()) / (2.0 * softness);
    let unloading = old.gamma * per_reach(old);
    let stiffness = if half > 0.0 { 0.5 * (f_n - began) / half } else { unloading };
    let reach = f_n / per_reach(virgin);
    Elastic { f_n, stiffness, unloading, approach: reach, reach }
}

/// F_N falls to a share of what it was, without an unloading.
pub(super) fn lower(state: &mut ContactState, share: f64) {
    state.approach *= share;
    state.reach *= share;
}
