//! Why a family of checks has no result.

use crate::compute::ComputeError;
use crate::simulation::SimulationError;

/// Why a family of checks has no result.
#[derive(Debug, thiserror::Error)]
pub enum VerifyError {
    /// A case could not be set up, or the device failed.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// The device failed.
    #[error(transparent)]
    Compute(#[from] ComputeError),
    /// A path could not be followed to its end.
    #[error("{0}")]
    Stopped(String),
}
