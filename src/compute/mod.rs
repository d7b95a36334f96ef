//! Evaluation of a batch of cases: internal forces, tangents, contact, commit. One trait, a CPU and
//! a GPU behind it.
//!
//! The batch is the leading dimension everywhere: a call carries one request for each case that
//! still iterates, and one dispatch serves them all. A single case is a batch of one. What a case
//! gets never depends on the other cases of the batch.
//!
//! A backend holds the committed state of every case (elastic strains, hardening variables,
//! displacement); trial states are never stored: each evaluation is a pure function of the
//! committed state and the trial displacement.

pub mod call;
pub mod cpu;
mod error;
mod evaluated;
pub mod fallback;
pub mod gather;
#[cfg(feature = "gpu")]
pub mod gpu;
pub mod handle;
pub mod iterate;
pub mod linear;
#[cfg(feature = "gpu")]
pub mod lost;
mod model;
pub mod select;
mod sweep;
pub mod traffic;
pub mod wrong;

#[cfg(test)]
mod tests;

pub use call::{Answer, Call, TangentBlocks};
pub use error::ComputeError;
pub use evaluated::{Evaluated, Fault};
use iterate::Keeps;
pub use model::{CaseFields, CaseModel, CaseState, Energies};
use traffic::Traffic;

/// Where and in which precision a backend computes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Description {
    /// For people: "CPU (2 threads)", an adapter's name.
    pub device: String,
    /// Precision of the residual: "f64" or "f32".
    pub precision: &'static str,
}

/// What a backend says of itself.
#[derive(Clone, Debug, PartialEq)]
pub struct About {
    /// Where this is computed.
    pub description: Description,
    /// It solves linear systems: [`Call::Solve`].
    pub solves: bool,
    /// Which of Newton's iterates stay where they are computed: [`Call::Iterate`] asks for those,
    /// and nothing else is asked for up to the step's end.
    pub keeps: Keeps,
    /// Another backend would stand in if this one failed: then copies of states are worth taking
    /// from time to time.
    pub has_stand_in: bool,
    /// What has passed between the host and the device so far; `None` without a device.
    pub traffic: Option<Traffic>,
}

impl About {
    /// Of a backend that evaluates, and does nothing else.
    pub fn plain(description: Description) -> Self {
        Self { description, solves: false, keeps: Keeps::Nothing, has_stand_in: false, traffic: None }
    }
}

/// A batch of cases on some device.
pub trait Compute: Send {
    /// The cases of the batch.
    fn models(&self) -> &[CaseModel];
    /// What it is, and what may be asked of it at present.
    fn about(&self) -> About;
    /// Answers calls, each of the case of this index, in their order. All go with the first
    /// ([`Call::goes_with`]).
    ///
    /// # Errors
    /// What no smaller step cures. What was to be evaluated can be asked for again; of anything
    /// else some may be done.
    fn call(&mut self, calls: Vec<(usize, Call)>) -> Result<Vec<Answer>, ComputeError>;
    /// What the user should know and has not been told yet, in whole sentences: a device that
    /// failed, say.
    fn take_notes(&mut self) -> Vec<String> {
        Vec::new()
    }
}
