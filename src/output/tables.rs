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
            let ratio = (record.f_n > 0.0).then(|| record.f_t / record.f_n);
            self.shear.push(SlipPanel { delta_t: record.delta_t, ratio, points });
        } else if self.pressed.as_ref().is_none_or(|(deepest, _)| record.h >= deepest.h) {
            self.pressed = Some((record, points));
        }
    }
}

/// The contact surface at one step of a shear: a panel of `slip.svg`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SlipPanel {
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
