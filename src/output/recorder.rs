//! Keeps the rows of a run in memory and writes nothing.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::{ContactPoint, StepRecord, Units};
use crate::case::Case;
use crate::simulation::drive::{Observer, StepView};
use crate::simulation::error::ObserverError;
use crate::simulation::problem::Problem;

/// The history of a run, in the case's units, the undeformed state first, and the contact at its
/// end.
pub struct Recorder {
    units: Units,
    stop: Option<Arc<AtomicBool>>,
    /// Size of the elements in the contact, over R, once the run has started over on another mesh.
    pub spacing: Option<f64>,
    /// The rows.
    pub rows: Vec<StepRecord>,
    /// The whole contact at the end of the last segment.
    pub contact: Vec<ContactPoint>,
}

impl Recorder {
    /// For a run of `case`, which ends early when `stop` is set.
    pub fn new(case: &Case, stop: Option<Arc<AtomicBool>>) -> Self {
        Self { units: Units::of(case), stop, spacing: None, rows: Vec::new(), contact: Vec::new() }
    }
}

impl Observer for Recorder {
    fn step(&mut self, view: &mut StepView<'_>) -> Result<(), ObserverError> {
        self.rows.push(view.record.in_units(&self.units));
        Ok(())
    }

    fn segment_end(&mut self, view: &mut StepView<'_>) -> Result<(), ObserverError> {
        self.contact = ContactPoint::whole_of(view.points, &self.units);
        Ok(())
    }

    fn starts_over(&mut self, problem: &Problem, _: usize) -> Result<(), ObserverError> {
        self.spacing = Some(problem.spacing);
        self.rows.clear();
        Ok(())
    }

    fn note(&mut self, text: &str) {
        log::info!("{text}");
    }

    fn stop_requested(&self) -> bool {
        self.stop.as_ref().is_some_and(|stop| stop.load(Ordering::Relaxed))
    }
}
