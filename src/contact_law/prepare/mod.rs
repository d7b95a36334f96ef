//! The update's [`Table`] from first loading, the shear at constant h and the oblique press.
//!
//! Columns come from first loading as they are. Shapes are made so that the update follows the
//! shear at constant h: along it r, F_N and so the hardening are known, the sliders are driven to
//! F_T, and what is left of delta_T has flowed. The steady flow comes from the oblique press in the
//! same way.

mod coefficients;
mod drive;
mod losses;
mod shapes;

use self::coefficients::Coefficients;
use self::losses::{costs, power};
use super::constants::Constants;
use super::state::ContactState;
use super::table::{
    COLUMNS, FIRST_N, GAMMA, LEVELS, LN_FORCE, LN_RADIUS, LN_STIFFNESS, PLACES, RADIAL_SLIP, RECOVERED, ROWS, SHAPES, SOFTENING,
    SUDDEN, Table, UNSHEARED_N,
};
use super::update::moved;
use super::virgin::{FirstLoading, Virgin};

/// How far beyond its last knot the columns go on.
const BEYOND: f64 = 1.5;
/// The depth of the first row over that of the last knot, at the most: an elastic contact has its
/// k_T from there on.
const SHALLOW: f64 = 1e-5;
/// Least friction coefficient, so that F_T/F_N over mu is a number.
const LEAST_FRICTION: f64 = 1e-9;
/// Share of F_N0 left at full slip below which the exponent's excess over 1 of a reversal is less,
/// in proportion: a table that is fitted to simulations lessens it, the first reversal takes that
/// back.
pub const KEPT: f64 = 0.6;
/// n - 1 of a reversal, at the least.
const LEAST_N: f64 = 0.02;
/// mu in whose neighbourhood a release takes less of the yield force.
const SMOOTH: f64 = 0.01;
/// Steps of the press from one level to the next.
const PRESS: i32 = 8;

/// The table of a contact.
pub(super) fn prepare(first: &FirstLoading, constants: &Constants) -> Table {
    let [shallow, end] = first.range();
    let start = shallow.min(SHALLOW * end);
    let friction = first.friction.max(LEAST_FRICTION);
    let mut table = Table {
        constants: *constants,
        friction,
        later: 1.0 + constants.later * (friction / 0.3).powf(constants.later_mu),
        first: start,
        per_step: (ROWS as f64 - 1.0) / (BEYOND * end / start).ln(),
        level_start: (shallow / start).ln(),
        per_level: (LEVELS as f64 - 1.0) / (end / shallow).ln(),
        rows: [[0.0; COLUMNS]; ROWS],
        shapes: [[[0.0; PLACES + 1]; SHAPES]; LEVELS],
        reach: [friction; LEVELS],
        beyond: [0.0; LEVELS],
    };
    fill_rows(first, &mut table);
    let coefficients = Coefficients::new(first, &table);
    let (mut pressed, mut before) = (ContactState::default(), 0.0);
    for level in 0..LEVELS {
        let end = shallow * (level as f64 / table.per_level).exp();
        for k in 1..=PRESS {
            let share = f64::from(k) / f64::from(PRESS);
            let h = if level > 0 { before * (end / before).powf(share) } else { end * share };
            pressed = moved(&table, &pressed, h, [0.0; 2]).0;
        }
        before = end;
        let flow = coefficients.at((end / start).ln() * table.per_step);
        shapes::fill(&first.virgin(end), &mut table, level, flow, &pressed);
    }
    table
}

fn fill_rows(first: &FirstLoading, table: &mut Table) {
    let constants = table.constants;
    let mut last = 1.0;
    for i in 0..ROWS {
        let h = table.first * (i as f64 / table.per_step).exp();
        let virgin = first.virgin(h);
        let point = &virgin.point;
        // The curves are of a contact that slid to the end: before that it was narrower, the more
        // the further it slid for its radius.
        let wider = 1.0 + costs(&virgin) * constants.widens * point.delta_t_end / point.a;
        // All of the first row is recovered, and never a greater share of h as that grows: so a
        // dent never shrinks.
        let recovered = if i == 0 { 1.0 } else { (virgin.depth * wider / h).min(last) };
        last = recovered;
        let plastic = 1.0 - recovered;
        let first_n = first_exponent(&virgin, &constants);
        let row = &mut table.rows[i];
        row[LN_FORCE] = point.f_n0.ln();
        row[LN_STIFFNESS] = point.k_t.ln() - constants.stiffens * wider.ln();
        row[RECOVERED] = recovered;
        row[GAMMA] = virgin.gamma;
        row[FIRST_N] = first_n;
        row[UNSHEARED_N] = plastic * (constants.unsheared - first_n).max(0.0);
        row[RADIAL_SLIP] = constants.radial * power(plastic, constants.radial_fades);
        row[SUDDEN] = constants.vertex_flow * (-constants.vertex_fades * (1.0 - plastic) * (1.0 - plastic)).exp();
        let fourth = plastic * plastic * plastic * plastic;
        row[SOFTENING] = constants.released * fourth * first.friction / (first.friction + SMOOTH);
        row[LN_RADIUS] = point.a.ln();
    }
}

/// n of a first reversal, from that of the curves, which is between it and those after; where much
/// is lost to shear it is nearer to those. Held below a limit. That of an elastic contact is its
/// own.
fn first_exponent(virgin: &Virgin, constants: &Constants) -> f64 {
    let (own, kept) = (virgin.backbone - 1.0, virgin.point.f_n_slip / virgin.point.f_n0);
    let x = constants.first * own / (kept / KEPT).min(1.0);
    let x = x / (1.0 + (x / constants.first_most).powi(8)).powf(0.125);
    1.0 + (own + costs(virgin) * (x - own)).max(LEAST_N)
}
