//! Tests of the room: the solvers against each other on elasticity problems.

mod problem;
mod solve;

pub(super) use super::{BlockMatrix, LinalgError, LinearSolver, Pattern, Smoother, SolverKind};
pub(super) use crate::mesh::Prolongation;
