//! Linear systems that are solved where the tangents are: what is asked, and how it went.

use std::sync::Arc;

use super::Evaluated;
use crate::contact::coulomb::Rows;
use crate::contact::frame::ContactFrame;
use crate::contact::maps::PairMaps;

/// Asks to form the tangent of one case and to solve linear systems with it, without bringing it to
/// the host. Over a rigid body, with the unknowns of contact nodes in their frames; and of an equal
/// pair that is turned half round y, with the unknowns of its interface.
#[derive(Clone, Debug)]
pub struct SolveRequest {
    /// Trial displacement, three a node.
    pub displacement: Arc<[f64]>,
    /// Contact conditions; those of points that slide replace the rows of their nodes, and those of
    /// a pair's slaves that touch stand in the place of their forces.
    pub rows: Vec<Rows<f64>>,
    /// Frames of contact nodes; none where all are the axes.
    pub frames: Vec<ContactFrame>,
    /// Per unknown: its row is one of the identity, whatever the tangent holds.
    pub fixed: Vec<bool>,
    /// What ties the bodies of an equal pair.
    pub tie: Option<PairTie>,
    /// The systems.
    pub sides: Vec<Side>,
}

/// What ties two equal bodies in a linear system.
#[derive(Clone, Debug)]
pub struct PairTie {
    /// The maps between displacements and the unknowns of the interface: the same for all systems
    /// of an attempt.
    pub maps: Arc<PairMaps>,
    /// Which unknowns of half of the body are fixed in what preconditions, of fields that are even
    /// in x and of odd ones.
    pub halves: [Vec<bool>; 2],
}

/// One right-hand side.
#[derive(Clone, Debug)]
pub struct Side {
    /// Right-hand side, three a node; at fixed unknowns their values.
    pub rhs: Vec<f64>,
    /// Relative residual to be reached over the free unknowns, the fixed ones' part taken over to
    /// the right-hand side. A device in single precision stops at 1.2e-5 of the residual that its
    /// last cycle of vectors began with, whatever is asked.
    pub tolerance: f64,
    /// The tolerance is of the residual at the guess, not of the right-hand side.
    pub relative_to_guess: bool,
    /// Krylov iterations that it will probably take: so many are sent off at once. A wrong number
    /// costs time, and nothing else.
    pub expected: usize,
    /// The guess; zeros are one.
    pub guess: Vec<f64>,
}

/// How linear systems went.
#[derive(Clone, Debug)]
pub struct Solved {
    /// How the tangent went.
    pub outcome: Evaluated,
    /// By side; none where nobody tried, because the backend solves no systems.
    pub solutions: Vec<Solution>,
}

impl Solved {
    /// Of a backend that solves none.
    pub fn not_tried() -> Self {
        Self { outcome: Evaluated::Valid, solutions: Vec::new() }
    }
}

/// The last iterate of a solution.
#[derive(Clone, Debug)]
pub struct Solution {
    /// The iterate, whatever the report says of it.
    pub x: Vec<f64>,
    /// How it went.
    pub report: SideReport,
}

/// How a solution ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Ended {
    /// The tolerance is met, by the recurrence of the residual, or what can be reached of it.
    Converged,
    /// It is not, and will not be.
    #[default]
    Stalled,
    /// A number of the system is not finite.
    NotFinite,
}

/// What is known of a solution.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SideReport {
    /// How it ended.
    pub ended: Ended,
    /// Krylov iterations.
    pub iterations: usize,
    /// Norm of the right-hand side over the free unknowns, the fixed ones' part taken over.
    pub rhs_norm: f64,
    /// Norm of the residual at the guess.
    pub start_norm: f64,
    /// Norm of the residual reached, by the recurrence.
    pub residual: f64,
    /// What the plate's summed f_z changes by along the solution.
    pub along: f64,
}
