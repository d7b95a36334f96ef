//! How a linear solve ends: with a report, or with an error.

/// What went wrong in a linear solve.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LinalgError {
    /// A number in the input is infinite or NaN (or, in the matrix, beyond the range of f32).
    #[error(
        "{place} has a number that is not finite in the row of node {node}; the state it was formed from has diverged, take a smaller step"
    )]
    NotFinite {
        /// Where the number is.
        place: &'static str,
        /// The node in whose row it is.
        node: usize,
    },
    /// A vector, a mask or a matrix is of the wrong size.
    #[error("{what} has {got} entries where the linear solver was made for {expected}; make a solver for this mesh")]
    Size {
        /// What is of the wrong size.
        what: &'static str,
        /// Its size.
        got: usize,
        /// The size it should have.
        expected: usize,
    },
    /// The prolongations do not fit the mesh or each other.
    #[error("the prolongation to coarse level {} does not fit the {rows} nodes of the level below; rebuild the mesh hierarchy", level + 1)]
    Hierarchy {
        /// Index of the prolongation, 0 the finest.
        level: usize,
        /// Number of nodes of the level it should interpolate to.
        rows: usize,
    },
    /// The matrix is singular.
    #[error("the matrix is singular (found at node {node}); check that every body is held and every contact row is set")]
    Singular {
        /// A node whose row took part.
        node: usize,
    },
    /// The direct solver would need too much memory.
    #[error(
        "a direct solution of {unknowns} unknowns needs about {} MB, more than the {} MB allowed; use the multigrid solver or a coarser mesh",
        need >> 20, limit >> 20
    )]
    TooLarge {
        /// Number of unknowns.
        unknowns: usize,
        /// Estimated memory, bytes.
        need: usize,
        /// Allowed memory, bytes.
        limit: usize,
    },
    /// A solution was asked for before a successful update.
    #[error("the linear solver has no matrix; call update before solve")]
    NotUpdated,
    /// FGMRES stalled and the direct fallback is not possible.
    #[error(
        "the linear solve stalled at a relative residual of {residual:.1e} after {iterations} iterations; take a smaller step"
    )]
    Stalled {
        /// Iterations spent.
        iterations: usize,
        /// Relative residual reached.
        residual: f64,
    },
}

/// How a solution was obtained.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SolveReport {
    /// FGMRES iterations; 0 for a direct solution.
    pub iterations: usize,
    /// |b - A x| / |b| over the free unknowns, where b has the fixed unknowns' part taken over; 0
    /// where b is.
    pub residual: f64,
    /// The tolerance was met.
    pub converged: bool,
    /// FGMRES did not meet the tolerance.
    pub stagnated: bool,
    /// The solution comes from the direct solver because FGMRES did not meet the tolerance.
    pub fallback: bool,
}

pub(super) fn size(what: &'static str, got: usize, expected: usize) -> Result<(), LinalgError> {
    if got == expected { Ok(()) } else { Err(LinalgError::Size { what, got, expected }) }
}
