//! The tangential part of an increment: delta_T moves, h is held.

use super::press::Pressed;
use super::shapes::{normal_shape, tangential_shape};
use super::sliders::{AT_BOUND, extent, length, slide, slider_force, slider_limits, slider_stiffness};
use super::update::{ContactResponse, ContactState};
use super::virgin::{ContactParameters, SLIDERS, Virgin};
use super::yielding::{
    AT_CAP, AT_SLIP, MOST, is_elastic, lower, normal_cap, pressed_cap, reversed_cap, reversed_share, yield_coefficient,
    yield_share, yielding_at,
};

/// x over which a sudden shear takes F_N from the yield curve of a press down to the virgin one.
const RELAXATION: f64 = 0.1;

/// Share of what F_T would rise by at k_T that it counts as risen at the least, when it is asked
/// what part of a step is beyond the virgin curve. Where everything slides it rises by nothing but
/// rounding; there the displacement tells what is beyond. At a tenth a contact that is pressed as
/// it slides swings from step to step in an engine, and last bits grow by half in each.
const LEAST_TRAVEL: f64 = 0.4;

/// The measure of that loss: x gathers this many times the share of the sliders that slip, times
/// that of those that stick, over the displacement that mu F_N_slip takes at k_T.
const GATHERED: f64 = 0.7;

/// Share of mu F_N from which a contact slides on as it did: nothing is lost then.
const SLIDING: f64 = 0.98;

/// The sliders slip and stick while F_N is at that of full slip or next to it, or the contact was
/// released: it loses what a reversal of the slip costs besides.
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
    let stands = reversed_cap(p, virgin, next.x);
    let above = if out.f_n > stands { out.f_n - stands } else { 0.0 };
    let mut rate = 4.0 * GATHERED * (k_t / (p.friction * virgin.point.f_n_slip));
    let mut falling = reversed_share(virgin) * virgin.point.f_n_slip;
    if next.x < 1.0 {
        // Next to full slip alone: F_T/F_N over mu to the power 24.
        let near = tangential_shape(p, virgin, next.x)[0] * virgin.point.f_n_slip / stands;
        let near = near * near * near;
        let near = near * near;
        let near = near * near;
        rate *= near * near;
        falling = (virgin.point.f_n0 - virgin.point.f_n_slip) * normal_shape(p, virgin, next.x)[1];
    }
    let gain = rate * (stick * (1.0 - stick)) * size;
    let rate = rate * (MOST - next.x);
    let x = next.x + (MOST - next.x) * gain;
    next.x = if x < MOST { x } else { MOST };
    let reversed = next.reversed + (1.0 - next.reversed) * gain;
    next.reversed = if reversed < 1.0 { reversed } else { 1.0 };
    // The sliders of a contact at rest are those that it came to rest with.
    let mut sharper = *virgin;
    sharper.sharpen(next.sheared, next.reversed);
    let virgin = &sharper;
    let eta = extent(virgin, next);
    let cap = reversed_cap(p, virgin, next.x) + above;
    let lowers = cap < out.f_n;
    if lowers {
        lower(next, cap / out.f_n);
        out.f_n = cap;
    }
    let limit = slider_limits(p, virgin, out.f_n, eta);
    next.deflection = *before;
    slide(&mut next.deflection, &limit, increment);
    out.f_t = slider_force(virgin, &next.deflection);
    let loss = if lowers && next.x < MOST { falling * rate } else { 0.0 };
    for j in 0..2 {
        let stiffer = (rise[0] * out.df_t_ddelta[0][j] + rise[1] * out.df_t_ddelta[1][j]) / (risen * k_t);
        out.df_n_ddelta[j] = -loss * ((1.0 - 2.0 * stick) * stiffer + stick * stick * increment[j] / size);
    }
    out.df_t_ddelta = slider_stiffness(virgin, before, &limit, increment);
    for j in 0..2 {
        // The limits of what slips fall with F_N.
        let falls = (1.0 - stick) * out.df_n_ddelta[j] / out.f_n;
        for i in 0..2 {
            out.df_t_ddelta[i][j] += falls * out.f_t[i];
        }
    }
}

/// Moves delta_T with h held. Inside the virgin curve the sliders answer; on it F_T and F_N follow
/// the law in x.
pub(super) fn shear(
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
    let eta = extent(virgin, next);
    let limit = slider_limits(p, virgin, f_n, eta);
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
            lower(next, cap / f_n);
            out.f_n = cap;
            let limit = slider_limits(p, virgin, cap, eta);
            next.deflection = before;
            slide(&mut next.deflection, &limit, increment);
            out.f_t = slider_force(virgin, &next.deflection);
            out.df_t_ddelta = slider_stiffness(virgin, &before, &limit, increment);
        } else if next.x >= 1.0 || (next.x > 0.0 && !raised) {
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
    lower(next, out.f_n / f_n);
    let limit = slider_limits(p, virgin, out.f_n, eta);
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
