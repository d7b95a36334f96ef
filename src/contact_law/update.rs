//! One increment of one contact. The C and the Python twin have the same functions in the same
//! order and do the same operations.

use super::shapes::{normal_shape, normal_shape_inverse, tangential_shape, tangential_shape_back, tangential_shape_inverse};
use super::virgin::{BY_NUMBERS, ContactParameters, SLIDERS, Virgin, VirginPoint};

/// The memory of one contact; all zero before first contact. Plain data: copy it, write it to a
/// file as it is.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct ContactState {
    /// Indentation h, length; negative is a gap.
    pub h: f64,
    /// Greatest h so far, length.
    pub h_max: f64,
    /// Elastic approach, length: what is recovered until contact is lost; negative is the gap over
    /// the residual dent.
    pub approach: f64,
    /// x = delta_T/delta_T_slip on the virgin curves at which the contact stands: the measure of
    /// its loss of F_N to shear. Beyond 1, up to 2, of what reversed slip costs besides.
    pub x: f64,
    /// x of the virgin curves up to which the contact has hardened in shear: 0 after a press
    /// without F_T, 1 after full slip. Below it F_T/F_N rises without yielding to shear; the edge
    /// of a contact that was not sheared slips sooner.
    pub sheared: f64,
    /// Tangential deflections of the sliders, length, innermost (last to slip) first.
    pub deflection: [[f64; 2]; SLIDERS],
}

/// The answer of an increment.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct ContactResponse {
    /// Normal force, compression positive.
    pub f_n: f64,
    /// Tangential force along the displacement: what drives the sphere; the plane gives the sphere
    /// the opposite.
    pub f_t: [f64; 2],
    /// d f_t\[i\]/d delta_T\[j\].
    pub df_t_ddelta: [[f64; 2]; 2],
    /// d f_n/dh at constant delta_T, for the direction in which h last moved.
    pub df_n_dh: f64,
    /// d f_n/d delta_T at constant h, for the direction in which delta_T last moved.
    pub df_n_ddelta: [f64; 2],
    /// Radius of the contact, length.
    pub a: f64,
}

/// Share of F_N0 from which a force counts as F_N0, so that rounding is not taken for unloading.
const AT_CAP: f64 = 1.0 - 1e-9;

/// Share of F_N that is compared with F_N_slip, so that rounding does not decide whether a contact
/// slips as a whole.
const AT_SLIP: f64 = 1.0 - 1e-13;

/// Share of a bound up to which a force counts as within it, so that a contact at rest answers with
/// its elastic stiffness.
const AT_BOUND: f64 = 1.0 + 1e-10;

/// A contact that is pressed while F_T acts yields where F_N (1 + s c r^2) = F_N0, r = F_T/F_N, and
/// flows as if s were 1: simulated steady oblique presses have d(delta_T)/dh = 2 c r/(1 - c r^2)
/// for the plastic parts of both. s is this share, less what of it the contact recovers on
/// unloading. Of simulated oblique presses.
const PRESSED: f64 = 0.9;

/// Least 1 - c r^2: beyond it F_N falls along the yield curve however it is pressed.
const LEAST_NORMAL: f64 = 0.25;

/// Greatest share of a displacement that hardens nothing while the contact is pressed too. Of
/// simulated contacts that were pressed first and obliquely then.
const SUDDEN: f64 = 0.2;

/// How many times faster than F_T the hardening in shear is forgotten where a press takes F_T.
const FORGETS: f64 = 4.0;

/// Share of the slip force below which the rest of an F_T that a press takes is gone.
const GONE: f64 = 1e-5;

/// x over which a sudden shear takes F_N from the yield curve of a press down to the virgin one.
const RELAXATION: f64 = 0.1;

/// Share of what F_T would rise by at k_T that it counts as risen at the least, when it is asked
/// what part of a step is beyond the virgin curve. Where everything slides it rises by nothing but
/// rounding; there the displacement tells what is beyond. At a tenth a contact that is pressed as
/// it slides swings from step to step in an engine, and last bits grow by half in each.
const LEAST_TRAVEL: f64 = 0.4;

/// Share of F_N_slip that is lost besides when the slip reverses, in one reversal or in several.
const REVERSED: f64 = 0.05;

/// The measure of that loss: x gathers this many times the share of the sliders that slip, times
/// that of those that stick, over the displacement that mu F_N_slip takes at k_T.
const GATHERED: f64 = 0.7;

/// Share of mu F_N from which a contact slides on as it did: nothing is lost then.
const SLIDING: f64 = 0.98;

/// x after all of that loss.
const MOST: f64 = 2.0;

/// F_N_slip/F_N0 from which a contact counts as elastic.
const ELASTIC: f64 = 1.0 - 1e-6;

/// F_N on the virgin curve at `x`.
fn normal_cap(p: &ContactParameters, virgin: &Virgin, x: f64) -> f64 {
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
fn yield_coefficient(p: &ContactParameters, virgin: &Virgin) -> f64 {
    if p.form == BY_NUMBERS { virgin.point.n } else { virgin_yield_coefficient(p, virgin) }
}

/// s c of the yield curve F_N (1 + s c r^2) = F_N0.
fn yield_share(virgin: &Virgin, c: f64) -> f64 {
    PRESSED * (1.0 - virgin.slope * virgin.depth / (virgin.gamma * virgin.point.f_n0)) * c
}

/// Greatest F_N of a contact that is pressed with the tangential force `f_t`, on the yield curve of
/// this s c, and q, the square of its root; at its apex F_N0/2.
fn pressed_cap(virgin: &Virgin, share: f64, f_t: f64) -> [f64; 2] {
    let f_n0 = virgin.point.f_n0;
    let force = f_t / f_n0;
    let q = 1.0 - 4.0 * share * (force * force);
    if q > 0.0 { [0.5 * f_n0 * (1.0 + q.sqrt()), q] } else { [0.5 * f_n0, 0.0] }
}

/// F_N on that curve at a ratio F_T/F_N.
fn yielding_at(virgin: &Virgin, share: f64, ratio: f64) -> f64 {
    virgin.point.f_n0 / (1.0 + share * (ratio * ratio))
}

/// The x of the virgin curve that has the normal force `f_n`.
fn mobilisation(p: &ContactParameters, virgin: &Virgin, f_n: f64) -> f64 {
    if f_n >= AT_CAP * virgin.point.f_n0 {
        return 0.0;
    }
    if AT_SLIP * f_n <= virgin.point.f_n_slip {
        let lost = 1.0 - f_n / virgin.point.f_n_slip;
        let x = if lost > 0.0 { 1.0 + lost / REVERSED } else { 1.0 };
        return if x < MOST { x } else { MOST };
    }
    normal_shape_inverse(p, virgin, (virgin.point.f_n0 - f_n) / (virgin.point.f_n0 - virgin.point.f_n_slip))
}

/// Elastic unloading: F_N at the approach `e`.
fn force_at(virgin: &Virgin, e: f64) -> f64 {
    if e <= 0.0 { 0.0 } else { virgin.point.f_n0 * (e / virgin.depth).powf(virgin.gamma) }
}

/// Inverse of [`force_at`].
fn approach_at(virgin: &Virgin, f_n: f64) -> f64 {
    if f_n >= virgin.point.f_n0 { virgin.depth } else { virgin.depth * (f_n / virgin.point.f_n0).powf(1.0 / virgin.gamma) }
}

/// Greatest deflection of each slider under the normal force `f_n`: their forces then add up to mu
/// F_N.
fn slider_limits(p: &ContactParameters, virgin: &Virgin, f_n: f64) -> [f64; SLIDERS] {
    let mut limit = [0.0; SLIDERS];
    if f_n <= 0.0 {
        return limit;
    }
    let eta = (f_n / virgin.point.f_n0).powf(1.0 / virgin.backbone);
    let mut sum = 0.0;
    for i in 0..SLIDERS {
        limit[i] = if eta > virgin.lost[i] { eta - virgin.lost[i] } else { 0.0 };
        if i == 0 && limit[i] < 0.1 * eta {
            limit[i] = 0.1 * eta; // the innermost carries what little force there is
        }
        sum += virgin.weight[i] * limit[i];
    }
    let scale = p.friction * f_n / (virgin.point.k_t * sum);
    for i in 0..SLIDERS {
        limit[i] *= scale;
    }
    limit
}

/// An increment in the same direction, of at most 1e150: far beyond full slip, and its square is
/// still finite.
fn bounded(increment: [f64; 2]) -> [f64; 2] {
    let size = if increment[0].abs() > increment[1].abs() { increment[0].abs() } else { increment[1].abs() };
    if size > 1e150 { [increment[0] / size * 1e150, increment[1] / size * 1e150] } else { increment }
}

/// Moves the sliders by `increment` and holds each to its limit.
fn slide(deflection: &mut [[f64; 2]; SLIDERS], limit: &[f64; SLIDERS], increment: [f64; 2]) {
    for i in 0..SLIDERS {
        let q = [deflection[i][0] + increment[0], deflection[i][1] + increment[1]];
        let size = (q[0] * q[0] + q[1] * q[1]).sqrt();
        let keep = if size > limit[i] { limit[i] / size } else { 1.0 };
        deflection[i] = [keep * q[0], keep * q[1]];
    }
}

/// Tangential force of the sliders.
fn slider_force(virgin: &Virgin, deflection: &[[f64; 2]; SLIDERS]) -> [f64; 2] {
    let mut sum = [0.0, 0.0];
    for i in 0..SLIDERS {
        sum[0] += virgin.weight[i] * deflection[i][0];
        sum[1] += virgin.weight[i] * deflection[i][1];
    }
    [virgin.point.k_t * sum[0], virgin.point.k_t * sum[1]]
}

/// Stiffness of the sliders after [`slide`]: a slider at its limit only turns.
fn slider_stiffness(virgin: &Virgin, before: &[[f64; 2]; SLIDERS], limit: &[f64; SLIDERS], increment: [f64; 2]) -> [[f64; 2]; 2] {
    let mut sum = [0.0, 0.0, 0.0];
    for i in 0..SLIDERS {
        let q = [before[i][0] + increment[0], before[i][1] + increment[1]];
        let size = (q[0] * q[0] + q[1] * q[1]).sqrt();
        let k = virgin.point.k_t * virgin.weight[i];
        if size > AT_BOUND * limit[i] {
            let k = k * limit[i] / size;
            let m = [q[0] / size, q[1] / size];
            sum[0] += k * m[1] * m[1];
            sum[1] -= k * m[0] * m[1];
            sum[2] += k * m[0] * m[0];
        } else {
            sum[0] += k;
            sum[2] += k;
        }
    }
    [[sum[0], sum[1]], [sum[1], sum[2]]]
}

/// Length of a vector.
fn length(v: [f64; 2]) -> f64 {
    (v[0] * v[0] + v[1] * v[1]).sqrt()
}

/// Normal part of an increment.
struct Pressed {
    f_n: f64,
    x: f64,
    df_n_dh: f64,
    /// By how many e-folds F_T has flowed.
    flow: f64,
    /// Displacement that hardens nothing.
    sudden: f64,
}

/// Share of a displacement that the sliders take where their force meanwhile flows by `flow`
/// e-folds: (1 - e^-flow)/flow. Without it a press under shear would keep more of F_T the longer
/// its steps are.
fn taken(flow: f64) -> f64 {
    if flow < 0.05 {
        1.0 - flow * (0.5 - flow * (1.0 / 6.0 - flow * (1.0 / 24.0 - flow / 120.0)))
    } else {
        (1.0 - (-flow).exp()) / flow
    }
}

/// Moves h with delta_T held. The elastic force follows the unloading curve; first loading caps it;
/// a sheared contact that is pressed against its yield curve loses tangential force to plastic flow
/// as it gains normal force, while `increment` brings some of it back.
fn press(p: &ContactParameters, state: &mut ContactState, virgin: &Virgin, h: f64, increment: [f64; 2]) -> Pressed {
    let dh = h - state.h;
    let grown = h > state.h_max;
    let first = grown && (state.x == 0.0 || !(state.h_max > 0.0));
    let f_n0 = virgin.point.f_n0;
    let (mut trial, mut stiffness) = (f_n0, virgin.slope);
    let mut elastic_stiffness = virgin.gamma * f_n0 / virgin.depth;
    let e = state.approach + dh;
    if grown && state.h_max > 0.0 {
        let old = p.virgin(state.h_max);
        // The sliders keep their forces as the contact grows (Mindlin & Deresiewicz 1953), and
        // never gain energy by it.
        let keep = old.point.k_t / virgin.point.k_t;
        if keep < 1.0 {
            for q in &mut state.deflection {
                *q = [keep * q[0], keep * q[1]];
            }
        }
        if !first {
            trial = force_at(&old, e);
            stiffness = if e > 0.0 { old.gamma * trial / e } else { 0.0 };
            elastic_stiffness = stiffness;
        }
    } else if !grown {
        trial = force_at(virgin, e);
        stiffness = if e > 0.0 { virgin.gamma * trial / e } else { 0.0 };
        elastic_stiffness = stiffness;
    }
    let f_n = if trial < f_n0 { trial } else { f_n0 };
    if dh == 0.0 {
        // At rest on the virgin curve the next press is first loading.
        let slope = if state.x == 0.0 && state.h == state.h_max { virgin.slope } else { stiffness };
        return Pressed { f_n, x: state.x, df_n_dh: slope, flow: 0.0, sudden: 0.0 };
    }
    let elastic = mobilisation(p, virgin, f_n);
    if dh < 0.0 {
        let x = if elastic > state.x { elastic } else { state.x };
        return Pressed { f_n, x, df_n_dh: stiffness, flow: 0.0, sudden: 0.0 };
    }
    if trial >= f_n0 && grown {
        stiffness = virgin.slope;
    }
    slide(&mut state.deflection, &slider_limits(p, virgin, f_n), [0.0, 0.0]);
    let force = slider_force(virgin, &state.deflection);
    let f_t = length(force);
    if is_elastic(&virgin.point) {
        return Pressed { f_n, x: elastic, df_n_dh: stiffness, flow: 0.0, sudden: 0.0 }; // pressing leaves F_T as it is
    }
    let slip_force = p.friction * virgin.point.f_n_slip;
    let (place, before) = tangential_shape_inverse(p, virgin, f_t / slip_force);
    let cap = normal_cap(p, virgin, place);
    if trial <= cap || f_t == 0.0 {
        if f_n >= AT_CAP * f_n0 {
            state.sheared = 0.0;
        }
        return Pressed { f_n, x: elastic, df_n_dh: stiffness, flow: 0.0, sudden: 0.0 };
    }
    let c = yield_coefficient(p, virgin);
    let share = yield_share(virgin, c);
    let [highest, _] = pressed_cap(virgin, share, f_t);
    // The direction of the flow, and the yield curve's normal.
    let r = f_t / f_n;
    let bounded = |normal: f64| if normal > LEAST_NORMAL { normal } else { LEAST_NORMAL };
    let (normal, tangential) = (bounded(1.0 - c * (r * r)), 2.0 * c * r);
    let (across, along) = (bounded(1.0 - share * (r * r)), 2.0 * share * r);
    // Between the virgin curve and the yield curve the contact yields in part.
    let part = if highest > cap { (trial - cap) / (highest - cap) } else { 1.0 };
    let part = if part < 1.0 { part } else { 1.0 };
    let softer = if grown { 1.0 - virgin.slope * f_n / (f_n0 * elastic_stiffness) } else { 1.0 };
    let plastic = if softer > 0.0 { softer * dh } else { 0.0 };
    let most = (trial - cap) / elastic_stiffness;
    let plastic = if plastic < most { plastic } else { most };
    let forward = (force[0] * increment[0] + force[1] * increment[1]) / f_t;
    let forward = if forward > 0.0 { forward } else { 0.0 };
    // What of delta_T flows. Where the contact does not move as far, F_T falls, and F_N rises along
    // the yield curve: that takes some of the press.
    let steady = part * (tangential / normal) * plastic;
    let (mut flows, mut taken_back) = (steady, 0.0);
    if forward < steady {
        let (stiff, soft) = (normal * across * elastic_stiffness, tangential * along * virgin.point.k_t);
        flows = forward + (steady - forward) * (stiff / (stiff + soft));
        taken_back = 1.0 - forward / steady;
    }
    let flow = virgin.point.k_t * flows / f_t;
    // The linear part of the virgin curve flows too, and what it takes of delta_T does not harden.
    let linear = (f_n0 / virgin.point.f_n_slip - 1.0) / p.friction - c * p.friction;
    let sudden = if linear > 0.0 { linear / normal * plastic } else { 0.0 };
    let sudden = if sudden < SUDDEN * forward { sudden } else { SUDDEN * forward };
    let keep = (-flow).exp();
    // A force beyond the peak of the virgin curve stays at its place.
    let left = keep * f_t / slip_force;
    let x = if left < tangential_shape(p, virgin, place)[0] { tangential_shape_back(p, virgin, left, before) } else { place };
    let [pressed, q] = pressed_cap(virgin, share, keep * f_t);
    let on_curve = normal_cap(p, virgin, x);
    let raised = if pressed > on_curve { pressed } else { on_curve };
    let rate = flow / dh;
    let along = if pressed > on_curve {
        let root = q.sqrt();
        // At the apex F_N grows with the contact alone.
        let turns = if root > 0.0 { 0.5 * (1.0 - q) / root } else { 0.0 };
        virgin.slope * (0.5 * (1.0 + root) + turns) + f_n0 * turns * rate
    } else {
        let rises = slip_force * tangential_shape(p, virgin, x)[1];
        let falls = (f_n0 - virgin.point.f_n_slip) * normal_shape(p, virgin, x)[1];
        // What F_N gains for a share of F_T lost, over F_N0; the curve itself grows with h.
        let gain = if rises > 0.0 { falls * keep * f_t / (f_n0 * rises) } else { 0.0 };
        virgin.slope * (raised / f_n0 + gain) + f_n0 * gain * rate
    };
    let slope = if raised < f_n && along < stiffness { along } else { stiffness };
    // Where F_N is below the curve, it is F_N that tells the place.
    let x = if f_n < on_curve { elastic } else { x };
    let f_n = if raised < f_n { raised } else { f_n };
    let back = (1.0 - keep) / virgin.point.k_t;
    slide(&mut state.deflection, &slider_limits(p, virgin, f_n), [-back * force[0], -back * force[1]]);
    if taken_back > 0.0 && left < GONE {
        state.deflection = [[0.0; 2]; SLIDERS];
    }
    let x = if x < state.x { x } else { state.x };
    // It forgets with the growth of the contact, and as F_T is taken back.
    let kept = (-plastic / h - FORGETS * (taken_back * taken_back) * flow).exp();
    state.sheared = if state.sheared > x { x + (state.sheared - x) * kept } else { x };
    Pressed { f_n, x, df_n_dh: slope, flow, sudden }
}

impl ContactState {
    /// Turns the memory into axes that are turned by the angle whose cosine and sine are given: the
    /// new components of a vector v are (c v0 + s v1, -s v0 + c v1). Call it when the tangent frame
    /// follows the contact's normal.
    pub fn rotate(&mut self, cosine: f64, sine: f64) {
        for q in &mut self.deflection {
            *q = [cosine * q[0] + sine * q[1], -sine * q[0] + cosine * q[1]];
        }
    }
}

impl ContactParameters {
    /// Moves a contact to the indentation `h` and along the plane by `increment` (two components in
    /// the tangent frame), the press first. A pure function of the state before. Where `h` or the
    /// increment is not finite, nothing in the answer is a number and the state stays as it was.
    pub fn update(&self, state: &ContactState, h: f64, increment: [f64; 2]) -> (ContactState, ContactResponse) {
        let mut next = *state;
        let mut out = ContactResponse::default();
        if !(h.is_finite() && increment[0].is_finite() && increment[1].is_finite()) {
            let nan = f64::NAN;
            out = ContactResponse {
                f_n: nan,
                f_t: [nan; 2],
                df_t_ddelta: [[nan; 2]; 2],
                df_n_dh: nan,
                df_n_ddelta: [nan; 2],
                a: nan,
            };
            return (next, out);
        }
        let increment = bounded(increment);
        let greatest = if h > state.h_max { h } else { state.h_max };
        if !(greatest > 0.0) {
            next.h = h;
            return (next, out);
        }
        let virgin = self.virgin_sheared(greatest, state.sheared);
        let pressed = press(self, &mut next, &virgin, h, increment);
        if h != state.h {
            next.approach = if pressed.f_n > 0.0 { approach_at(&virgin, pressed.f_n) } else { state.approach + (h - state.h) };
        }
        next.h = h;
        next.h_max = greatest;
        next.x = pressed.x;
        if !(pressed.f_n > 0.0) {
            next.deflection = [[0.0; 2]; SLIDERS];
            return (next, out);
        }
        out.df_n_dh = pressed.df_n_dh;
        let share = taken(pressed.flow);
        shear(self, &mut next, &mut out, &virgin, &pressed, [share * increment[0], share * increment[1]]);
        for i in 0..2 {
            out.df_t_ddelta[i] = [share * out.df_t_ddelta[i][0], share * out.df_t_ddelta[i][1]];
            out.df_n_ddelta[i] *= share;
        }
        out.a = virgin.point.a * (next.approach / virgin.depth).powf(virgin.gamma - 1.0);
        (next, out)
    }

    /// Elastic energy that the contact stores, force times length: no path gives back more than it.
    pub fn stored_energy(&self, state: &ContactState) -> f64 {
        if !(state.h_max > 0.0) || state.approach <= 0.0 {
            return 0.0;
        }
        let virgin = self.virgin(state.h_max);
        let mut sum = 0.0;
        for i in 0..SLIDERS {
            let q = state.deflection[i];
            sum += virgin.weight[i] * (q[0] * q[0] + q[1] * q[1]);
        }
        force_at(&virgin, state.approach) * state.approach / (virgin.gamma + 1.0) + 0.5 * virgin.point.k_t * sum
    }
}

/// The sliders slip and stick while F_N is at that of full slip, or the contact was released: it
/// loses what a reversal of the slip costs besides.
fn reverse(
    p: &ContactParameters,
    next: &mut ContactState,
    out: &mut ContactResponse,
    virgin: &Virgin,
    before: &[[f64; 2]; SLIDERS],
    force_before: [f64; 2],
    increment: [f64; 2],
) {
    let size = length(increment);
    if next.x >= MOST || !(size > 0.0) || length(force_before) > SLIDING * (p.friction * out.f_n) {
        return;
    }
    let k_t = virgin.point.k_t;
    let rise = [out.f_t[0] - force_before[0], out.f_t[1] - force_before[1]];
    let risen = length(rise);
    let stick = risen / (k_t * size);
    if !(stick > 0.0 && stick < 1.0) {
        return;
    }
    // What F_N is above that of its x stays above it.
    let above = out.f_n - virgin.point.f_n_slip * (1.0 - REVERSED * (next.x - 1.0));
    let above = if above > 0.0 { above } else { 0.0 };
    let rate = 4.0 * GATHERED * (MOST - next.x) * (k_t / (p.friction * virgin.point.f_n_slip));
    let x = next.x + rate * (stick * (1.0 - stick)) * size;
    next.x = if x < MOST { x } else { MOST };
    let cap = virgin.point.f_n_slip * (1.0 - REVERSED * (next.x - 1.0)) + above;
    if !(cap < out.f_n) {
        return;
    }
    out.f_n = cap;
    next.approach = approach_at(virgin, cap);
    let limit = slider_limits(p, virgin, cap);
    next.deflection = *before;
    slide(&mut next.deflection, &limit, increment);
    out.f_t = slider_force(virgin, &next.deflection);
    let loss = if next.x < MOST { REVERSED * virgin.point.f_n_slip * rate } else { 0.0 };
    for j in 0..2 {
        let stiffer = (rise[0] * out.df_t_ddelta[0][j] + rise[1] * out.df_t_ddelta[1][j]) / (risen * k_t);
        out.df_n_ddelta[j] = -loss * ((1.0 - 2.0 * stick) * stiffer + stick * stick * increment[j] / size);
    }
    out.df_t_ddelta = slider_stiffness(virgin, before, &limit, increment);
    for j in 0..2 {
        // The limits of what slips fall with F_N.
        let falls = (1.0 - stick) * out.df_n_ddelta[j] / cap;
        for i in 0..2 {
            out.df_t_ddelta[i][j] += falls * out.f_t[i];
        }
    }
}

/// Moves delta_T with h held. Inside the virgin curve the sliders answer; on it F_T and F_N follow
/// the law in x.
fn shear(
    p: &ContactParameters,
    next: &mut ContactState,
    out: &mut ContactResponse,
    virgin: &Virgin,
    pressed: &Pressed,
    increment: [f64; 2],
) {
    let f_n = pressed.f_n;
    let before = next.deflection;
    let force_before = slider_force(virgin, &before);
    let limit = slider_limits(p, virgin, f_n);
    slide(&mut next.deflection, &limit, increment);
    out.f_n = f_n;
    out.f_t = slider_force(virgin, &next.deflection);
    out.df_t_ddelta = slider_stiffness(virgin, &before, &limit, increment);
    if is_elastic(&virgin.point) {
        return;
    }
    if next.x >= 1.0 && !(AT_CAP * f_n > virgin.point.f_n_slip) {
        reverse(p, next, out, virgin, &before, force_before, increment);
        return;
    }
    let slip_force = p.friction * virgin.point.f_n_slip;
    let at = if next.x > next.sheared { next.x } else { next.sheared };
    let at = if at < 1.0 { at } else { 1.0 };
    let before_cap = normal_cap(p, virgin, at);
    // After a press F_N may be above the virgin curve, but not above the yield curve; F_T/F_N is
    // that of the virgin curve there too.
    let raised = AT_CAP * f_n > before_cap;
    let share = if raised { yield_share(virgin, yield_coefficient(p, virgin)) } else { 0.0 };
    let mut bound = slip_force * tangential_shape(p, virgin, at)[0];
    let bounded = |ratio: f64| if ratio < p.friction { ratio } else { p.friction };
    if raised {
        let ratio = bound / before_cap;
        let top = yielding_at(virgin, share, ratio);
        let top = if top < f_n { top } else { f_n };
        let top = if top > before_cap { top } else { before_cap };
        bound = bounded(ratio) * top;
    }
    let trial = length(out.f_t);
    let forward = if trial > 0.0 { (out.f_t[0] * increment[0] + out.f_t[1] * increment[1]) / trial } else { 0.0 };
    let forward = if forward > 0.0 { forward } else { 0.0 };
    let along = if trial > 0.0 { (out.f_t[0] * force_before[0] + out.f_t[1] * force_before[1]) / trial } else { 0.0 };
    let travel = trial - along;
    let ahead = LEAST_TRAVEL * (virgin.point.k_t * forward) - travel;
    let ahead = if ahead > 0.0 { ahead } else { 0.0 };
    if trial + ahead <= AT_BOUND * bound {
        let [highest, q] = pressed_cap(virgin, share, trial);
        if raised && AT_CAP * highest < f_n {
            let cap = if highest > before_cap { highest } else { before_cap };
            let falls = if highest > before_cap && q > 0.0 { 2.0 * share * trial / (virgin.point.f_n0 * q.sqrt()) } else { 0.0 };
            for j in 0..2 {
                let rises = out.f_t[0] * out.df_t_ddelta[0][j] + out.f_t[1] * out.df_t_ddelta[1][j];
                out.df_n_ddelta[j] = if trial > 0.0 { -falls * rises / trial } else { 0.0 };
            }
            let cap = if cap < f_n { cap } else { f_n };
            out.f_n = cap;
            next.approach = approach_at(virgin, cap);
            let limit = slider_limits(p, virgin, cap);
            next.deflection = before;
            slide(&mut next.deflection, &limit, increment);
            out.f_t = slider_force(virgin, &next.deflection);
            out.df_t_ddelta = slider_stiffness(virgin, &before, &limit, increment);
        } else if next.x >= 1.0 {
            reverse(p, next, out, virgin, &before, force_before, increment);
        }
        return;
    }
    let direction = [out.f_t[0] / trial, out.f_t[1] / trial];
    // Share of the increment that is beyond the curve: all of it when the contact stood on it.
    let (excess, travel) = (trial - bound + ahead, travel + ahead);
    let excess = if excess > 0.0 { excess } else { 0.0 };
    let beyond = if excess < travel { excess / travel } else { 1.0 };
    // In a long step, half of it at the least.
    let way = beyond * forward;
    let hardens = if pressed.sudden < 0.5 * way { way - pressed.sudden } else { 0.5 * way };
    let dx = hardens / virgin.point.delta_t_slip;
    let x = if at + dx < 1.0 { at + dx } else { 1.0 };
    let cap = normal_cap(p, virgin, x);
    let [shape, shape_slope] = tangential_shape(p, virgin, x);
    let falls = (virgin.point.f_n0 - virgin.point.f_n_slip) * normal_shape(p, virgin, x)[1];
    let ratio = slip_force * shape / cap;
    let steeper = (slip_force * shape_slope + ratio * falls) / cap;
    let above = if raised { (f_n - before_cap) * (-dx / RELAXATION).exp() } else { 0.0 };
    let (mut relaxed, mut loss) = (cap + above, falls + above / RELAXATION);
    if raised {
        let highest = yielding_at(virgin, share, ratio);
        if highest < relaxed && highest > cap {
            relaxed = highest;
            loss = 2.0 * share * ratio * steeper * highest * (highest / virgin.point.f_n0);
        } else if highest < relaxed {
            (relaxed, loss) = (cap, falls);
        }
    }
    out.f_n = if relaxed < f_n { relaxed } else { f_n };
    next.x = if AT_SLIP * out.f_n <= virgin.point.f_n_slip { 1.0 } else { x };
    next.sheared = x;
    next.approach = approach_at(virgin, out.f_n);
    let limit = slider_limits(p, virgin, out.f_n);
    next.deflection = before;
    slide(&mut next.deflection, &limit, increment);
    let held = slider_force(virgin, &next.deflection);
    let stiffness = slider_stiffness(virgin, &before, &limit, increment);
    let bound = bounded(ratio) * out.f_n;
    let per_x = if hardens > 0.0 { beyond / virgin.point.delta_t_slip } else { 0.0 };
    let rate = (steeper * out.f_n - ratio * loss) * per_x;
    let size = length(held);
    out.f_t = held;
    out.df_t_ddelta = stiffness;
    out.df_n_ddelta = [-loss * per_x * direction[0], -loss * per_x * direction[1]];
    // At full slip the two are the same but for rounding.
    if AT_BOUND * size <= bound {
        return;
    }
    let keep = if size > bound { bound / size } else { 1.0 };
    for q in &mut next.deflection {
        *q = [keep * q[0], keep * q[1]];
    }
    let m = [held[0] / size, held[1] / size];
    out.f_t = [keep * held[0], keep * held[1]];
    for j in 0..2 {
        let radial = m[0] * stiffness[0][j] + m[1] * stiffness[1][j];
        for i in 0..2 {
            out.df_t_ddelta[i][j] = rate * m[i] * direction[j] + keep * (stiffness[i][j] - m[i] * radial);
        }
    }
}
