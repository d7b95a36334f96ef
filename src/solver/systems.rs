//! The solver of a step's linear systems, whatever the opponent.

use super::couple::CoupleSolver;
use super::pair::PairSolver;
use super::tied::Tied;
use crate::linalg::{BlockMatrix, DEFAULT_FALLBACK_LIMIT, LinalgError, LinearSolver, SolveReport, SolverKind};

/// The solver of one body's systems over a plane, made when it is first asked for: where a device
/// makes whole steps in f64 it never is, and its matrices take no memory.
pub struct Unmade {
    kind: SolverKind,
    make: Box<dyn Fn() -> Result<Systems, LinalgError> + Send>,
}

impl Unmade {
    /// Systems of that kind, which `make` makes.
    pub fn new(kind: SolverKind, make: impl Fn() -> Result<Systems, LinalgError> + Send + 'static) -> Self {
        Self { kind, make: Box::new(make) }
    }
}

impl std::fmt::Debug for Unmade {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Unmade({:?})", self.kind)
    }
}

/// The solver of one body's systems, of an equal pair's, or of two bodies'.
#[derive(Debug)]
pub enum Systems {
    /// Over a plane, not made yet.
    Unmade(Unmade),
    /// Over a plane, by multigrid.
    Plane(Box<LinearSolver<f32>>),
    /// Over a plane, by elimination: the reference, in f64 throughout.
    Direct(Box<LinearSolver<f64>>),
    /// Against its own image.
    Pair(Box<PairSolver>),
    /// Against another body.
    Couple(Box<CoupleSolver>),
}

/// The tangent of a system, in the precision in which it is solved.
#[derive(Debug)]
pub enum Matrix<'a> {
    /// In f64.
    Double(&'a mut BlockMatrix<f64>),
    /// In f32.
    Single(&'a mut BlockMatrix<f32>),
}

impl From<CoupleSolver> for Systems {
    fn from(solver: CoupleSolver) -> Self {
        Self::Couple(Box::new(solver))
    }
}

impl From<Unmade> for Systems {
    fn from(unmade: Unmade) -> Self {
        Self::Unmade(unmade)
    }
}

impl From<LinearSolver<f32>> for Systems {
    fn from(solver: LinearSolver<f32>) -> Self {
        Self::Plane(Box::new(solver))
    }
}

impl From<LinearSolver<f64>> for Systems {
    fn from(solver: LinearSolver<f64>) -> Self {
        Self::Direct(Box::new(solver))
    }
}

impl From<PairSolver> for Systems {
    fn from(solver: PairSolver) -> Self {
        Self::Pair(Box::new(solver))
    }
}

impl Systems {
    /// Makes the solver if it is not.
    ///
    /// # Errors
    /// As [`LinearSolver::new`].
    pub fn make(&mut self) -> Result<(), LinalgError> {
        if let Self::Unmade(unmade) = self {
            *self = (unmade.make)()?;
        }
        Ok(())
    }

    /// How systems are solved.
    pub fn kind(&self) -> SolverKind {
        match self {
            Self::Unmade(unmade) => unmade.kind,
            Self::Plane(solver) => solver.kind(),
            Self::Direct(solver) => solver.kind(),
            Self::Pair(_) | Self::Couple(_) => SolverKind::Multigrid,
        }
    }

    /// The tangent, to be written in place; `None` of a solver that is not made.
    pub fn matrix_mut(&mut self) -> Option<Matrix<'_>> {
        Some(match self {
            Self::Unmade(_) => return None,
            Self::Direct(solver) => Matrix::Double(solver.matrix_mut()),
            Self::Plane(solver) => Matrix::Single(solver.matrix_mut()),
            Self::Pair(solver) => Matrix::Single(solver.matrix_mut()),
            Self::Couple(solver) => Matrix::Single(solver.matrix_mut()),
        })
    }

    /// Solves for the correction of the unknowns; without `fallback` never by the direct solver.
    ///
    /// # Errors
    /// As [`LinearSolver::solve`].
    pub fn solve(&mut self, rhs: &[f64], tolerance: f64, x: &mut [f64], fallback: bool) -> Result<SolveReport, LinalgError> {
        match self {
            Self::Unmade(_) => Err(LinalgError::NotUpdated),
            Self::Plane(solver) => {
                solver.set_fallback_limit(if fallback { DEFAULT_FALLBACK_LIMIT } else { 0 });
                solver.solve(rhs, tolerance, x)
            }
            Self::Direct(solver) => solver.solve(rhs, tolerance, x),
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
            Self::Unmade(_) => Err(LinalgError::NotUpdated),
            Self::Plane(solver) => solver.residual_norm(rhs, x),
            Self::Direct(solver) => solver.residual_norm(rhs, x),
            Self::Pair(solver) => Ok(solver.residual_norm(rhs, x)),
            Self::Couple(solver) => Ok(solver.residual_norm(rhs, x)),
        }
    }
}
