//! Watches a run beside whoever writes its results: keeps the rows, and stops it after a step where
//! one at a time is wanted.

use std::cell::Cell;

use crate::compute::ComputeError;
use crate::output::{StepRecord, Units};
use crate::simulation::checkpoint::Snapshot;
use crate::simulation::drive::{Observer, StepView};
use crate::simulation::error::ObserverError;
use crate::simulation::problem::Problem;

/// How far a run is to go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pace {
    /// To the end of the path.
    Whole,
    /// One accepted step.
    Step,
    /// No further: it ends here, as if it were cancelled.
    Halt,
}

/// Hands everything on to `inner`, but for the end of a segment and the checkpoint that go with a
/// stop of its own: for `inner` there was none.
pub struct Pacer<'a> {
    inner: &'a mut dyn Observer,
    units: Units,
    rows: &'a mut Vec<StepRecord>,
    pace: Pace,
    /// Steps accepted on the present mesh.
    accepted: usize,
    paused: Cell<bool>,
}

impl<'a> Pacer<'a> {
    /// Keeps `rows` in the user's units.
    pub fn new(inner: &'a mut dyn Observer, units: Units, rows: &'a mut Vec<StepRecord>, pace: Pace) -> Self {
        Self { inner, units, rows, pace, accepted: 0, paused: Cell::new(false) }
    }

    /// Whether the run has stopped only because one step was wanted.
    pub fn has_paused(&self) -> bool {
        self.paused.get()
    }

    /// Whether a step was accepted.
    pub fn has_accepted(&self) -> bool {
        self.accepted > 0
    }
}

impl Observer for Pacer<'_> {
    fn step(&mut self, view: &mut StepView<'_>) -> Result<(), ObserverError> {
        self.inner.step(view)?;
        if view.record.0.step > 0 {
            self.rows.push(view.record.in_units(&self.units));
            self.accepted += 1;
        }
        Ok(())
    }

    fn segment_end(&mut self, view: &mut StepView<'_>) -> Result<(), ObserverError> {
        if self.paused.get() { Ok(()) } else { self.inner.segment_end(view) }
    }

    fn note(&mut self, text: &str) {
        self.inner.note(text);
    }

    fn starts_over(&mut self, problem: &Problem, unknowns: usize) -> Result<(), ObserverError> {
        self.rows.clear();
        self.accepted = 0;
        self.inner.starts_over(problem, unknowns)
    }

    fn stop_requested(&self) -> bool {
        if self.pace == Pace::Halt || self.inner.stop_requested() {
            return true;
        }
        self.paused.set(self.pace == Pace::Step && self.accepted > 0);
        self.paused.get()
    }

    fn keeps_end(&self) -> bool {
        self.inner.keeps_end()
    }

    fn checkpoint(&mut self, last: bool, take: &mut dyn FnMut() -> Result<Snapshot, ComputeError>) {
        if !self.paused.get() {
            self.inner.checkpoint(last, take);
        }
    }
}
