//! Why a bench ends early.

use crate::compute::ComputeError;
use crate::compute::gpu::GpuError;
use crate::material::MaterialError;
use crate::mesh::MeshError;

/// Why a bench ends early. A row that does not fit is no error.
#[derive(Debug, thiserror::Error)]
pub enum BenchError {
    /// A device was asked for and cannot be used.
    #[error("{0}")]
    Device(#[from] GpuError),
    /// The CPU backend refused the batch.
    #[error("the bench's own cases cannot be evaluated: {0}")]
    Compute(#[from] ComputeError),
    /// The bench's mesh.
    #[error("--elements: {0}")]
    Mesh(#[from] MeshError),
    /// The bench's materials.
    #[error("the bench's own materials cannot be built: {0}")]
    Material(#[from] MaterialError),
    /// A study of whole jobs.
    #[error("{0}")]
    Study(#[from] crate::study::StudyError),
    /// A whole job did not end well.
    #[error("the bench's own case {case} failed: {why}")]
    Case {
        /// Its number.
        case: String,
        /// Why.
        why: String,
    },
    /// A pool of threads.
    #[error("--threads {threads}: cannot start that many threads: {what}. Give fewer")]
    Threads {
        /// The number asked for.
        threads: usize,
        /// What the pool says.
        what: String,
    },
}
