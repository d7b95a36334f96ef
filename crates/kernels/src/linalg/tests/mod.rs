//! Tests of the room: the solvers against each other on elasticity problems.

mod krylov;
mod problem;
mod products;
mod solve;
mod turn;

pub(super) use super::{BlockMatrix, Hierarchy, LinalgError, LinearSolver, Pattern, SolverKind};
pub(super) use crate::mesh::quality::CORNERS;
pub(super) use crate::mesh::{Mesh, Prolongation};
