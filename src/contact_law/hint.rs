//! Where Newton's method begins, given how the last plastic step went. With a hint and without one
//! the equations are met to the same tolerance.

use super::step::Step;

/// Greatest way to the trial's ratio over mu of a step that begins by its hint
/// (`benches/law/fit_hint.py`).
const HINT_SHORT: f64 = 0.06;

/// Where Newton's method begins in a short step of a contact that has yielded before, and what the
/// hint that the step leaves is measured by.
pub(super) struct Way {
    /// Direction of the ratio of the start, and the way to the trial's, along it and across.
    axis: [f64; 2],
    toward: [f64; 2],
    /// Hardening that the trial would bring.
    trial: f64,
    /// Hardening and ratio to begin with, if there is a hint.
    pub(super) begin: Option<(f64, [f64; 2])>,
}

impl Way {
    /// The hint that a step leaves in which the contact yielded, from the ratio at its `start`.
    /// Where the way in one direction is too short to tell, that of before stays.
    pub(super) fn left(&self, before: [f64; 3], y: f64, r: [f64; 2], start: [f64; 2]) -> [f64; 3] {
        let ([x, z], [u, v], [along, across]) = ([r[0] - start[0], r[1] - start[1]], self.axis, self.toward);
        let least = 0.01 * (along * along + across * across);
        [
            if along * along > least { within((x * u + z * v) / along, -2.0, 2.0) } else { before[0] },
            if across * across > least { within((z * u - x * v) / across, -2.0, 2.0) } else { before[1] },
            within(y / self.trial, 0.01, 10.0),
        ]
    }
}

/// A number within bounds, and the lower one where it is none.
fn within(x: f64, least: f64, most: f64) -> f64 {
    if x > least { x.min(most) } else { least }
}

impl Step<'_> {
    /// Where Newton's method begins in a short step of a contact that has yielded before: as far on
    /// the way to the trial's ratio as in its last step that yielded, along the ratio of the start
    /// and across it, and with as much of the hardening that the trial would bring; `load` is the
    /// trial's F_N G over the yield force.
    pub(super) fn hinted(&self, trial: [f64; 2], r: [f64; 2], load: f64) -> Way {
        let (hint, short) = (self.state.hint, HINT_SHORT * self.table.friction);
        let per = 1.0 / (r[0] * r[0] + r[1] * r[1] + 1e-200).sqrt();
        let ([u, v], [x, z]) = ([r[0] * per, r[1] * per], [trial[0] - r[0], trial[1] - r[1]]);
        let toward = [x * u + z * v, z * u - x * v];
        let trial = self.first_guess(load);
        let hinted = hint[2].abs() > 0.0 && self.state.approach > 0.0 && x * x + z * z < short * short;
        let [along, across] = [hint[0] * toward[0], hint[1] * toward[1]];
        let to = [r[0] + (along * u - across * v), r[1] + (along * v + across * u)];
        Way { axis: [u, v], toward, trial, begin: hinted.then_some((hint[2].abs() * trial, to)) }
    }
}
