//! What can go wrong with a backend.

/// An evaluation that failed for a reason that no smaller step cures.
#[derive(Clone, Debug, thiserror::Error)]
pub enum ComputeError {
    /// An element of the undeformed mesh is inverted.
    #[error(
        "element {element} of the mesh is inverted at quadrature point {point}; choose another [mesh] elements_per_contact_radius"
    )]
    InvertedMesh {
        /// Element index.
        element: usize,
        /// Quadrature point.
        point: usize,
    },
    /// The cases of a batch do not share one connectivity.
    #[error("case {case} of the batch has another mesh connectivity than the first; run it in a batch of its own")]
    Connectivity {
        /// Case index.
        case: usize,
    },
    /// The device failed.
    #[error("the compute device failed: {0}")]
    Device(String),
    /// The device that had the case's committed state failed. Another stands in for it, once it is
    /// given a state to go on from ([`super::Call::Restore`]).
    #[error("the device that had the state of the case failed, and nobody has given its stand-in an earlier one")]
    Gone,
    /// The device that had Newton's iterates failed; its stand-in has the committed state.
    #[error("the device that had the iterates of the step failed, and the step was not begun anew")]
    Moved,
}
