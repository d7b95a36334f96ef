//! The flow coefficient c of plastic displacements from that of the oblique press, which is of all
//! of the displacement.

use super::super::table::{FIRST_N, LN_FORCE, LN_STIFFNESS, RADIAL_SLIP, RECOVERED, ROWS, Table, UNSHEARED_N, exponent};
use super::super::virgin::{FirstLoading, measured_slope};
use super::drive::{Driven, Slides};
use super::losses::steady_loss;

/// Greatest r of an oblique press over mu.
const MOST: f64 = 0.97;
/// Rows on either side over which the flow is a mean.
const BESIDE: usize = 4;

/// c of each row, and the ratio at which it was measured.
pub(super) struct Coefficients {
    c: [f64; ROWS],
    measured: [f64; ROWS],
}

impl Coefficients {
    /// d(delta_T)/dh of the oblique press is `measured_slope`, and its ratio r is written as slope
    /// = 2 c r/(1 - c r^2) of total displacements. Here it is of plastic ones: flow = 2 c r/(1 -
    /// A).
    pub(super) fn new(first: &FirstLoading, table: &Table) -> Self {
        let (constants, mu) = (&table.constants, table.friction);
        let slope = measured_slope(mu);
        let [shallow, deepest] = first.range();
        let (mut slipped, mut before, mut before_dent) = (0.0, 0.0, 0.0);
        let mut dents = [0.0; ROWS];
        let (mut flowed, mut given, mut measured) = ([0.0; ROWS], [1.0; ROWS], [0.0; ROWS]);
        let mut driven = Driven::default();
        for i in 0..ROWS {
            let row = &table.rows[i];
            let whole = table.first * (i as f64 / table.per_step).exp();
            let (mut h, mut r, mut loss) = (whole, 0.0, 0.0);
            let approach = row[RECOVERED] * whole;
            let dent = whole - approach;
            for _ in 0..6 {
                given[i] = first.virgin(h.clamp(shallow, deepest)).point.c;
                r = (((1.0 + slope * slope / given[i]).sqrt() - 1.0) / slope).min(MOST * mu);
                loss = steady_loss(constants, given[i], r);
                h = dent + approach / (1.0 + loss);
            }
            let force = row[LN_FORCE].exp() / (1.0 + loss);
            let plastic = dent - before_dent;
            before_dent = dent;
            dents[i] = dent;
            let slides = Slides {
                stiff: row[LN_STIFFNESS].exp(),
                most: mu * force,
                exponent: exponent(row[FIRST_N], row[UNSHEARED_N], table.later, r / mu),
                radial_most: constants.radial_most,
            };
            slipped += driven.drive_to(&slides, row[RADIAL_SLIP] * plastic, r * force, slope * (h - before));
            before = h;
            measured[i] = r;
            flowed[i] = slope * h - slipped;
        }
        let whole = ((deepest / table.first).ln() * table.per_step) as usize - 2;
        let c = std::array::from_fn(|i| {
            let to = (i + BESIDE).min(whole);
            let from = i.saturating_sub(BESIDE).min(to.saturating_sub(2 * BESIDE));
            let r = measured[i.min(to)];
            let flow = (flowed[to] - flowed[from]) / (dents[to] - dents[from]);
            let one = flow / (2.0 * r + flow * steady_loss(constants, 1.0, r));
            // `max` and `min` give a bound for what is no number.
            one.max(0.3 * given[i]).min(3.0 * given[i])
        });
        let measured = std::array::from_fn(|i| measured[i.min((i + BESIDE).min(whole))]);
        Self { c, measured }
    }

    /// c at a place between the rows, and the ratio of the row before it.
    pub(super) fn at(&self, position: f64) -> [f64; 2] {
        let k = (position as usize).min(ROWS - 2);
        [self.c[k] + (position - k as f64) * (self.c[k + 1] - self.c[k]), self.measured[k]]
    }
}
