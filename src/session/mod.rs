//! One run from its case to its results: what `asperity run` does, as a value that a program of its
//! own may step, watch and cancel.
//!
//! `claim` takes the directory of results, `prepare` recognises and clears it, `prior` finds
//! whether there is a run in it to go on with, `pacer` watches the steps, `sink` is where results
//! go: into the directory, or into `memory` where there is none. [`Simulation`] puts them together.

mod claim;
mod error;
mod memory;
mod pacer;
mod plan;
mod prepare;
mod prior;
mod simulation;
mod sink;

#[cfg(test)]
mod tests;

use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

pub use error::SessionError;
pub use simulation::{Simulation, StepFields, Steps};

pub use crate::compute::select::{DeviceChoice, PrecisionChoice};
use crate::output::{RunStatus, Summary};

/// What to do with an earlier result in the directory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Earlier {
    /// Refuse it.
    #[default]
    Keep,
    /// Go on with it if it is unfinished, leave it if it is done, begin where there is none.
    Resume,
    /// Go on with one that is done along a longer path, which begins with its own; go on with that
    /// if it is unfinished, and leave it if it is done.
    Extend,
    /// Replace it.
    Replace,
}

/// How and where a case is simulated; by default as `asperity run` does, but without a directory.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Where the kernels run.
    pub device: DeviceChoice,
    /// Their precision.
    pub precision: PrecisionChoice,
    /// Threads of a pool of its own; without a number the simulation computes in the pool from
    /// which it is called. Results do not depend on it.
    pub threads: Option<NonZeroUsize>,
    /// Directory for the results, with all the files of `asperity run`; without one nothing is
    /// written.
    pub out: Option<PathBuf>,
    /// What to do with an earlier result there.
    pub earlier: Earlier,
    /// Time between checkpoints instead of five seconds; zero is after every step. Results do not
    /// depend on it.
    pub checkpoint_every: Option<Duration>,
    /// Ends the run from elsewhere.
    pub canceller: Canceller,
}

/// Ends a run after its present step, from any thread: what was computed is kept, and a checkpoint
/// is written where there is a directory.
#[derive(Clone, Debug, Default)]
pub struct Canceller {
    flag: Arc<AtomicBool>,
    by: &'static str,
}

impl Canceller {
    /// Asks the run to end. It does not go on afterwards.
    pub fn cancel(&self) {
        self.flag.store(true, Ordering::Relaxed);
    }

    /// Whether that was asked.
    pub fn is_cancelled(&self) -> bool {
        self.flag.load(Ordering::Relaxed)
    }

    /// Of a flag that a signal sets.
    pub fn on_signal(flag: Arc<AtomicBool>) -> Self {
        Self { flag, by: " by a signal" }
    }
}

/// How a run ended.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// To the end of the path, or why not.
    pub status: RunStatus,
    /// The reason, if it did not get to the end of the path.
    pub message: Option<String>,
    /// The run in some numbers, in the user's units.
    pub summary: Summary,
    /// It had ended before, and was only read.
    pub ended_before: bool,
}

impl Outcome {
    /// Whether the whole path was followed.
    pub fn is_done(&self) -> bool {
        self.status == RunStatus::Done
    }
}
