//! Linear systems with 3x3 blocks: geometric multigrid preconditioned FGMRES, and sparse LU as its
//! fallback and reference.
//!
//! A system A x = b comes with a mask of fixed unknowns, whose rows are rows of the identity and
//! whose values are those of b. They are eliminated first, so that they hold exactly; the rest is
//! solved for what they leave over. Everything sums in a fixed order: the same input gives the same
//! bits at any thread count.

pub mod bsr;
mod chebyshev;
pub mod direct;
mod dissection;
pub mod fgmres;
mod fixed;
pub mod fold;
mod galerkin;
mod kernel;
pub mod layout;
pub mod multigrid;
mod outcome;
mod parallel;
mod solver;
#[cfg(test)]
mod tests;
pub mod ties;
pub mod turn;
mod vector;

pub use bsr::{BlockMatrix, Pattern};
pub use direct::DirectSolver;
pub use multigrid::Hierarchy;
pub use outcome::{LinalgError, SolveReport};
pub use solver::{DEFAULT_FALLBACK_LIMIT, LinearSolver, SolverKind};
