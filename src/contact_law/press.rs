//! The normal part of an increment: h moves, delta_T is held.

use super::shapes::{normal_shape, tangential_shape, tangential_shape_back, tangential_shape_inverse};
use super::sliders::{extent, length, slide, slider_force, slider_limits};
use super::update::ContactState;
use super::virgin::{ContactParameters, SLIDERS, Virgin};
use super::yielding::{
    AT_CAP, Elastic, elastic_at, flow_coefficient, is_elastic, lower, mobilisation, normal_cap, pressed_cap, yield_coefficient,
    yield_share,
};

/// Least 1 - c r^2: beyond it F_N falls along the yield curve however it is pressed.
const LEAST_NORMAL: f64 = 0.25;

/// Share of what a press takes of F_T by the flow of a steady press that it does take. Of simulated
/// contacts that were sheared first and pressed on then.
const TAKEN_BACK: f64 = 0.9;

/// Greatest share of a displacement that hardens nothing while the contact is pressed too. Of
/// simulated contacts that were pressed first and obliquely then.
const SUDDEN: f64 = 0.2;

/// How many times faster than F_T the hardening in shear is forgotten where a press takes F_T.
const FORGETS: f64 = 4.0;

/// Share of the slip force below which the rest of an F_T that a press takes is gone.
const GONE: f64 = 1e-5;

/// Normal part of an increment.
pub(super) struct Pressed {
    pub(super) f_n: f64,
    pub(super) x: f64,
    pub(super) df_n_dh: f64,
    /// By how many e-folds F_T has flowed.
    pub(super) flow: f64,
    /// Displacement that hardens nothing.
    pub(super) sudden: f64,
}

/// Share of a displacement that the sliders take where their force meanwhile flows by `flow`
/// e-folds: (1 - e^-flow)/flow. Without it a press under shear would keep more of F_T the longer
/// its steps are.
pub(super) fn taken(flow: f64) -> f64 {
    if flow < 0.05 {
        1.0 - flow * (0.5 - flow * (1.0 / 6.0 - flow * (1.0 / 24.0 - flow / 120.0)))
    } else {
        (1.0 - (-flow).exp()) / flow
    }
}

/// Moves h with delta_T held. The elastic force follows the unloading curve; first loading caps it;
/// a sheared contact that is pressed against its yield curve loses tangential force to plastic flow
/// as it gains normal force, while `increment` brings some of it back.
pub(super) fn press(p: &ContactParameters, state: &mut ContactState, virgin: &Virgin, h: f64, increment: [f64; 2]) -> Pressed {
    let dh = h - state.h;
    let grown = h > state.h_max;
    let first = grown && (state.x == 0.0 || !(state.h_max > 0.0));
    let f_n0 = virgin.point.f_n0;
    let (reach, e) = (state.reach, state.approach + dh);
    let mut answer = Elastic {
        f_n: f_n0,
        stiffness: virgin.slope,
        unloading: virgin.gamma * f_n0 / virgin.depth,
        approach: virgin.depth,
        reach: virgin.depth,
    };
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
            answer = elastic_at(&old, virgin, true, reach, e);
        }
    } else if !grown {
        answer = elastic_at(virgin, virgin, false, reach, e);
    }
    let Elastic { f_n: trial, mut stiffness, unloading: elastic_stiffness, .. } = answer;
    let f_n = if trial < f_n0 { trial } else { f_n0 };
    if dh != 0.0 {
        let stands = trial < f_n0;
        state.approach = if stands { answer.approach } else { virgin.depth };
        state.reach = if stands { answer.reach } else { virgin.depth };
    }
    let eta = extent(virgin, state);
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
    slide(&mut state.deflection, &slider_limits(p, virgin, f_n, eta), [0.0, 0.0]);
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
    let c = flow_coefficient(p, virgin, c, r);
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
    let mut steady = part * (tangential / normal) * plastic;
    if grown && softer > 0.0 {
        // In a steady press the sliders' force grows too, and c is of all of delta_T over all of h.
        let all = plastic / softer;
        let grows = r * virgin.slope * (f_n / f_n0) / virgin.point.k_t;
        let flows = part * ((tangential / normal - grows) * all);
        let flows = if flows < forward { flows } else { forward };
        steady = if flows > steady { flows } else { steady };
    }
    let (mut flows, mut taken_back) = (steady, 0.0);
    if forward < steady {
        let (stiff, soft) = (normal * across * elastic_stiffness, tangential * along * virgin.point.k_t);
        flows = forward + TAKEN_BACK * (steady - forward) * (stiff / (stiff + soft));
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
    if raised < f_n {
        lower(state, raised / f_n);
    }
    let f_n = if raised < f_n { raised } else { f_n };
    let back = (1.0 - keep) / virgin.point.k_t;
    slide(&mut state.deflection, &slider_limits(p, virgin, f_n, eta), [-back * force[0], -back * force[1]]);
    if taken_back > 0.0 && left < GONE {
        state.deflection = [[0.0; 2]; SLIDERS];
    }
    let x = if x < state.x { x } else { state.x };
    // It forgets with the growth of the contact, and as F_T is taken back.
    let kept = (-plastic / h - FORGETS * (taken_back * taken_back) * flow).exp();
    state.sheared = if state.sheared > x { x + (state.sheared - x) * kept } else { x };
    state.reversed *= kept;
    Pressed { f_n, x, df_n_dh: slope, flow, sudden }
}
