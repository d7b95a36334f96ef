//! Why a run ends without a result.

use crate::compute::ComputeError;
use crate::mesh::MeshError;
use crate::solver::SolverError;

/// What an observer could not do, a file that cannot be written for instance: the run ends with it.
pub type ObserverError = Box<dyn std::error::Error + Send + Sync>;

/// A failure that ends a run without a result, as opposed to a step that did not converge (see
/// [`Ending`](super::drive::Ending)).
#[derive(Debug, thiserror::Error)]
pub enum SimulationError {
    /// The mesh cannot be made.
    #[error("the mesh cannot be made: {0}")]
    Mesh(#[from] MeshError),
    /// The hardening law's numbers make no law.
    #[error("the material is not usable: {0}")]
    Hardening(#[from] crate::material::MaterialError),
    /// The solver or the device.
    #[error(transparent)]
    Solver(#[from] SolverError),
    /// The device.
    #[error(transparent)]
    Compute(#[from] ComputeError),
    /// The mesh has nodes without one opposite: an equal pair cannot be simulated on it.
    #[error("the mesh is not its own mirror image, which an equal pair needs")]
    NotMirrored,
    /// The forces that a free equator makes as it widens are none to go by.
    #[error("the stiffness of the free equator could not be found; sphere.equator = \"clamped\" does without")]
    Widening,
    /// A path that a program has put together meshes both bodies, of which one has a free equator.
    #[error("sphere.equator is \"free\" on a path for which both spheres are meshed")]
    TwoPlates,
    /// An accepted step has a result that is no number: nothing can go on from it.
    #[error("{what} of step {step} is {value}, which no result may be; --device cpu tells whether the device computes wrongly")]
    NotFinite {
        /// Number of the step.
        step: usize,
        /// Column of the history.
        what: &'static str,
        /// The value.
        value: f64,
    },
    /// A snapshot is of a body with another mesh.
    #[error("the state to go on from has {found} {what} where the mesh has {expected}")]
    Snapshot {
        /// What there is another number of.
        what: &'static str,
        /// Its number in the snapshot.
        found: usize,
        /// Its number in the mesh.
        expected: usize,
    },
    /// Whoever watches the run could not go on: results cannot be written, say.
    #[error("{0}")]
    Observer(ObserverError),
}

impl SimulationError {
    /// The device that had the committed state has failed, and its stand-in waits for an earlier
    /// one.
    pub(crate) fn is_gone(&self) -> bool {
        match self {
            Self::Compute(error) | Self::Solver(SolverError::Compute(error)) => {
                matches!(error, ComputeError::Gone | ComputeError::Moved)
            }
            // Who watches the run had asked for fields.
            Self::Observer(error) => matches!(error.downcast_ref(), Some(ComputeError::Gone | ComputeError::Moved)),
            _ => false,
        }
    }
}
