//! What passes between the host of a shared backend and its guests.

use std::sync::mpsc::Sender;
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::compute::{About, Answer, Call, ComputeError};

/// What the backend says of itself, for all guests.
pub struct HostReport {
    /// What it is.
    pub about: About,
    /// What it wants the user to know, so far.
    pub notes: Vec<String>,
}

/// What becomes of a call.
pub type Answered = Result<Answer, ComputeError>;

/// What a case asks, and the way back to it.
pub struct QueuedCall {
    /// Which case of the backend.
    pub case: usize,
    /// What it asks.
    pub call: Call,
    /// Where the answer goes.
    pub reply: Sender<Answered>,
}

/// The report, whatever became of those who had it before.
pub fn lock(told: &Mutex<HostReport>) -> MutexGuard<'_, HostReport> {
    told.lock().unwrap_or_else(PoisonError::into_inner)
}
