//! A copy of the state of a run whose device may fail, and the steps after it, which are made again
//! then.

use std::time::{Duration, Instant};

use crate::compute::ComputeError;
use crate::simulation::checkpoint::Snapshot;
use crate::simulation::drive::{Observer, StepView};
use crate::simulation::error::ObserverError;
use crate::simulation::problem::Problem;

/// Time between copies: one takes as long as some steps do.
const INTERVAL: Duration = Duration::from_secs(5);

/// The last copy of a run's state, and how far the run was when it last had to go back to one.
pub struct Safe {
    snapshot: Option<Box<Snapshot>>,
    taken: Instant,
    lost: Option<Lost>,
}

/// How far a run was when its device failed.
#[derive(Clone, Copy, Debug)]
pub struct Lost {
    step: usize,
    segment: usize,
}

impl Default for Safe {
    fn default() -> Self {
        Self { snapshot: None, taken: Instant::now(), lost: None }
    }
}

impl Safe {
    /// Keeps a copy.
    pub fn keep(&mut self, snapshot: Snapshot) {
        (self.snapshot, self.taken) = (Some(Box::new(snapshot)), Instant::now());
    }

    /// The last copy is old.
    pub fn is_due(&self) -> bool {
        self.taken.elapsed() >= INTERVAL
    }

    /// The run has lost its state after so many steps, in this segment; gives the last copy.
    pub fn lose(&mut self, step: usize, segment: usize) -> Option<Box<Snapshot>> {
        let before = self.lost.unwrap_or(Lost { step: 0, segment: 0 });
        self.lost = Some(Lost { step: step.max(before.step), segment: segment.max(before.segment) });
        self.snapshot.take()
    }

    /// How far the run was when it last lost its state.
    pub fn lost(&self) -> Option<Lost> {
        self.lost
    }
}

/// An observer that has seen a part of the run before, and is not shown it again.
pub struct Muted<'a> {
    observer: &'a mut dyn Observer,
    lost: Option<Lost>,
    is_repeating: bool,
}

impl<'a> Muted<'a> {
    /// Of a run that is at `step`.
    pub fn new(observer: &'a mut dyn Observer, lost: Option<Lost>, step: usize) -> Self {
        Self { observer, lost, is_repeating: lost.is_some_and(|lost| step < lost.step) }
    }
}

impl Observer for Muted<'_> {
    fn step(&mut self, view: &mut StepView<'_>) -> Result<(), ObserverError> {
        let step = view.record.0.step;
        self.is_repeating = self.lost.is_some_and(|lost| step < lost.step);
        if self.lost.is_some_and(|lost| step <= lost.step) { Ok(()) } else { self.observer.step(view) }
    }

    fn segment_end(&mut self, view: &mut StepView<'_>) -> Result<(), ObserverError> {
        let was_shown = self.lost.is_some_and(|lost| view.record.0.segment < lost.segment);
        if was_shown { Ok(()) } else { self.observer.segment_end(view) }
    }

    fn note(&mut self, text: &str) {
        if !self.is_repeating {
            self.observer.note(text);
        }
    }

    fn starts_over(&mut self, problem: &Problem, unknowns: usize) -> Result<(), ObserverError> {
        self.observer.starts_over(problem, unknowns)
    }

    fn stop_requested(&self) -> bool {
        self.observer.stop_requested()
    }

    fn keeps_end(&self) -> bool {
        self.observer.keeps_end()
    }

    /// What has been shown is further on than what could be kept.
    fn checkpoint(&mut self, last: bool, take: &mut dyn FnMut() -> Result<Snapshot, ComputeError>) {
        if !self.is_repeating {
            self.observer.checkpoint(last, take);
        }
    }
}
