//! One case from its first touch to the end of its path.
//!
//! `problem` turns a case file into a scaled model, `path` cuts segments into steps, `drive` takes
//! the steps (bisecting those that fail), `observer` watches, `follow` starts a run over on a
//! larger `zone` of fine mesh when the contact leaves it, `scout` finds before how far it will
//! reach, on a coarse mesh, `footprint` measures the contact, `record` holds what is remembered of
//! each step, `checkpoint` what the next one depends on, `body_share` how much
//! of h and delta_T the bodies give way outside their contact, `equator` how far
//! a plate widens that is free to.

mod body_share;
pub mod checkpoint;
pub mod drive;
mod ending;
mod equator;
pub mod error;
pub mod follow;
pub mod footprint;
pub mod observer;
pub mod path;
pub mod problem;
pub mod record;
pub mod scout;
pub mod zone;

pub use error::SimulationError;

#[cfg(test)]
mod tests;
