//! The solver of a step's linear systems, whatever the opponent.

pub mod couple;
mod half;
pub mod pair;
pub mod tied;

use std::sync::Arc;

use super::outcome::{Halt, StepFailure};
use crate::linalg::{BlockMatrix, DEFAULT_FALLBACK_LIMIT, LinalgError, LinearSolver, Pattern, SolveReport, SolverKind};
use crate::mesh::Mesh;
use couple::CoupleSolver;
use pair::PairSolver;
use tied::Tied;

/// A plan of one body's systems. The solver is made when it is first asked for: where a device
/// makes whole steps in f64 it never is, and its matrices take no memory.
#[derive(Debug)]
pub struct OneBody {
    kind: SolverKind,
    mesh: Arc<Mesh>,
}

impl OneBody {
    /// Systems of that kind.
    pub fn new(mesh: &Arc<Mesh>, kind: SolverKind) -> Self {
        Self { kind, mesh: mesh.clone() }
    }

    fn make(&self) -> Result<Systems, LinalgError> {
        let pattern = Pattern::from_elements(self.mesh.nodes.len(), &self.mesh.elements);
        Ok(match self.kind {
            SolverKind::Multigrid => LinearSolver::<f32>::new(self.kind, &pattern, &self.mesh.hierarchy)?.into(),
            SolverKind::Direct => LinearSolver::<f64>::new(self.kind, &pattern, &self.mesh.hierarchy)?.into(),
        })
    }
}

/// The solver of one body's systems, of an equal pair's, or of two bodies'.
#[derive(Debug)]
pub enum Systems {
    /// One body's, not made yet.
    Planned(OneBody),
    /// One body's, by multigrid.
    Multigrid(Box<LinearSolver<f32>>),
    /// One body's, by elimination: the reference, in f64 throughout.
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

impl From<LinearSolver<f32>> for Systems {
    fn from(solver: LinearSolver<f32>) -> Self {
        Self::Multigrid(Box::new(solver))
    }
}

impl From<LinearSolver<f64>> for Systems {
    fn from(solver: LinearSolver<f64>) -> Self {
        Self::Direct(Box::new(solver))
    }
}

impl Systems {
    /// Makes the solver if it is not.
    ///
    /// # Errors
    /// As [`LinearSolver::new`].
    pub fn make(&mut self) -> Result<(), LinalgError> {
        if let Self::Planned(plan) = self {
            *self = plan.make()?;
        }
        Ok(())
    }

    /// How systems are solved.
    pub fn kind(&self) -> SolverKind {
        match self {
            Self::Planned(plan) => plan.kind,
            Self::Multigrid(solver) => solver.kind(),
            Self::Direct(solver) => solver.kind(),
            Self::Pair(_) | Self::Couple(_) => SolverKind::Multigrid,
        }
    }

    /// The tangent, to be written in place; `None` of a solver that is not made.
    pub fn matrix_mut(&mut self) -> Option<Matrix<'_>> {
        Some(match self {
            Self::Planned(_) => return None,
            Self::Direct(solver) => Matrix::Double(solver.matrix_mut()),
            Self::Multigrid(solver) => Matrix::Single(solver.matrix_mut()),
            Self::Pair(solver) => Matrix::Single(&mut solver.tie_mut().matrix),
            Self::Couple(solver) => Matrix::Single(&mut solver.tie_mut().matrix),
        })
    }

    /// Makes one body's systems ready to be solved, now that the tangent is in them and it is known
    /// which unknowns are `fixed`.
    ///
    /// # Errors
    /// As [`LinearSolver::refresh`]; systems of two bodies, whose opponent does this.
    pub(super) fn refresh(&mut self, fixed: &[bool]) -> Result<(), Halt> {
        match self {
            Self::Multigrid(solver) => Ok(solver.refresh(fixed)?),
            Self::Direct(solver) => Ok(solver.refresh(fixed)?),
            Self::Planned(_) => Err(LinalgError::NotUpdated.into()),
            Self::Pair(_) | Self::Couple(_) => Err(of_another_opponent()),
        }
    }

    /// Solves for the correction of the unknowns; without `fallback` never by the direct solver.
    ///
    /// # Errors
    /// As [`LinearSolver::solve`].
    pub fn solve(&mut self, rhs: &[f64], tolerance: f64, x: &mut [f64], fallback: bool) -> Result<SolveReport, LinalgError> {
        match self {
            Self::Planned(_) => Err(LinalgError::NotUpdated),
            Self::Multigrid(solver) => {
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
            Self::Planned(_) => Err(LinalgError::NotUpdated),
            Self::Multigrid(solver) => solver.residual_norm(rhs, x),
            Self::Direct(solver) => solver.residual_norm(rhs, x),
            Self::Pair(solver) => Ok(solver.residual_norm(rhs, x)),
            Self::Couple(solver) => Ok(solver.residual_norm(rhs, x)),
        }
    }
}

/// Why systems cannot be solved that another opponent has planned.
pub(super) fn of_another_opponent() -> Halt {
    StepFailure::Linear("the solver is made for another opponent".into()).into()
}
