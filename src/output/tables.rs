//! What is kept of a run for its pictures, whether this build can draw them or not: a checkpoint
//! and a directory mean the same to both.

use serde::{Deserialize, Serialize};

use super::{ContactPoint, ContactStatus, StepRecord};

/// Names of all pictures of a run, by which an earlier run's are removed.
pub const RUN_PICTURES: [&str; 8] = ["indentation", "pressure", "forces", "ratio", "stick", "slip", "contact", "law"];

/// The contact tables of a run that are shown.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Tables {
    /// At the end of the press, with the row of the history.
    pub pressed: Option<(StepRecord, Vec<ContactPoint>)>,
    /// Some of the shear.
    pub shear: Vec<SlipPanel>,
    /// The last one in contact.
    pub last: Vec<ContactPoint>,
}

impl Tables {
    /// Takes the table of the last step of a history, where it is one that is shown.
    pub fn add(&mut self, history: &[StepRecord], points: Vec<ContactPoint>) {
        let Some(record) = history.last().copied() else { return };
        if points.iter().any(|point| point.status != ContactStatus::Open) {
            self.last.clone_from(&points);
        }
        if !split(history).1.is_empty() {
            // What is pressed or unloaded after a shear is no step of one.
            if !shears(history) {
                return;
            }
            // The same step may be the end of a segment as well.
            if self.shear.last().is_some_and(|panel| panel.step == record.step) {
                return;
            }
            let ratio = (record.f_n > 0.0).then(|| record.f_t / record.f_n);
            self.shear.push(SlipPanel { step: record.step, delta_t: record.delta_t, ratio, points });
        } else if self.pressed.as_ref().is_none_or(|(deepest, _)| record.h >= deepest.h) {
            self.pressed = Some((record, points));
        }
    }
}

/// The contact surface at one step of a shear: a panel of `slip.svg`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SlipPanel {
    /// Number of the step.
    pub step: usize,
    /// delta_T.
    pub delta_t: f64,
    /// F_T over F_N; `None` without a normal force.
    pub ratio: Option<f64>,
    /// The surface then.
    pub points: Vec<ContactPoint>,
}

/// The records up to the start of the first shear, and those from there on with the starting one
/// first; the latter are empty without a shear.
pub(super) fn split(history: &[StepRecord]) -> (&[StepRecord], &[StepRecord]) {
    match history.windows(2).position(|pair| pair[1].delta_t != pair[0].delta_t) {
        // Pressed and sheared at once from the start: all that presses is both.
        Some(0) => {
            let pressing = history.windows(2).take_while(|pair| pair[1].h > pair[0].h).count();
            (&history[..=pressing], history)
        }
        Some(begin) => (&history[..=begin], &history[begin..]),
        None => (history, &[]),
    }
}

/// Whether the last step of a history moved the sphere tangentially.
pub(super) fn shears(history: &[StepRecord]) -> bool {
    let before = history.len().checked_sub(2).map_or(0.0, |before| history[before].delta_t);
    history.last().is_some_and(|step| step.delta_t != before)
}

/// Shares of mu that F_T/F_N reaches for the first time where the stick/slip picture has a panel.
const PANEL_SHARES: [f64; 4] = [0.3, 0.6, 0.8, 0.95];

/// Whether the last step of a history is one that the stick/slip picture shows, beside the ends of
/// segments: a step in which the first shear comes to use the next share of the friction
/// coefficient.
pub fn is_panel(history: &[StepRecord], friction: Option<f64>) -> bool {
    let (Some(mu), (_, shear)) = (friction.filter(|&mu| mu > 0.0), split(history)) else { return false };
    let Some((last, before)) = shear.split_last().filter(|(_, before)| !before.is_empty()) else { return false };
    // The first shear: what follows shows itself at the ends of its segments.
    if shear.get(1).is_none_or(|first| first.segment != last.segment) {
        return false;
    }
    let reached = |steps: &[StepRecord]| {
        let most = steps.iter().filter(|step| step.f_n > 0.0).map(|step| (step.f_t / (mu * step.f_n)).abs()).fold(0.0, f64::max);
        PANEL_SHARES.into_iter().filter(|&share| most >= share).count()
    };
    reached(shear) > reached(before)
}
