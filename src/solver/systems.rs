//! The solver of a step's linear systems, whatever the opponent.

use super::couple::CoupleSolver;
use super::pair::PairSolver;
use super::tied::Tied;
use crate::linalg::{BlockMatrix, DEFAULT_FALLBACK_LIMIT, LinalgError, LinearSolver, SolveReport};

/// The solver of one body's systems, of an equal pair's, or of two bodies'.
#[derive(Debug)]
pub enum Systems {
    /// Over a plane.
    Plane(Box<LinearSolver>),
    /// Against its own image.
    Pair(Box<PairSolver>),
    /// Against another body.
    Couple(Box<CoupleSolver>),
}

impl From<CoupleSolver> for Systems {
    fn from(solver: CoupleSolver) -> Self {
        Self::Couple(Box::new(solver))
    }
}

impl From<LinearSolver> for Systems {
    fn from(solver: LinearSolver) -> Self {
        Self::Plane(Box::new(solver))
    }
}

impl From<PairSolver> for Systems {
    fn from(solver: PairSolver) -> Self {
        Self::Pair(Box::new(solver))
    }
}

impl Systems {
    /// The tangent, to be written in place.
    pub fn matrix_mut(&mut self) -> &mut BlockMatrix<f64> {
        match self {
            Self::Plane(solver) => solver.matrix_mut(),
            Self::Pair(solver) => solver.matrix_mut(),
            Self::Couple(solver) => solver.matrix_mut(),
        }
    }

    /// Solves for the correction of the unknowns; without `fallback` never by the direct solver.
    ///
    /// # Errors
    /// As [`LinearSolver::solve`].
    pub fn solve(&mut self, rhs: &[f64], tolerance: f64, x: &mut [f64], fallback: bool) -> Result<SolveReport, LinalgError> {
        match self {
            Self::Plane(solver) => {
                solver.set_fallback_limit(if fallback { DEFAULT_FALLBACK_LIMIT } else { 0 });
                solver.solve(rhs, tolerance, x)
            }
            Self::Pair(solver) => solver.solve(rhs, tolerance, x),
            Self::Couple(solver) => solver.solve(rhs, tolerance, x),
        }
    }

    /// The norm of what is left of the free unknowns' equations.
    ///
    /// # Errors
    /// As [`LinearSolver::residual_norm`].
    pub fn residual_norm(&mut self, rhs: &[f64], x: &[f64]) -> Result<f64, LinalgError> {
        match self {
            Self::Plane(solver) => solver.residual_norm(rhs, x),
            Self::Pair(solver) => Ok(solver.residual_norm(rhs, x)),
            Self::Couple(solver) => Ok(solver.residual_norm(rhs, x)),
        }
    }
}
