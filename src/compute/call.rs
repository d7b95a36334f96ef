//! What is asked of a backend for one case, and what it answers. Both own what they are about: an
//! adapter passes a call on, makes it again elsewhere or sends it to another thread, and looks at
//! the answer, without a word for each kind.

use std::sync::Arc;

use super::linear::{SolveRequest, Solved};
use super::{CaseFields, CaseModel, CaseState, ComputeError, Energies, Evaluated, iterate};
use crate::contact::coulomb::Rows;
use crate::real::Real;

/// What is asked of one case. Displacements are three numbers a node.
#[derive(Clone, Debug)]
pub enum Call {
    /// A step begins: what is asked up to the next commit starts from the committed state with so
    /// many times the flow of the last step anticipated (see [`crate::material::multistep`]). A
    /// step that is not begun so, as any after a commit, anticipates nothing.
    BeginStep(f64),
    /// The internal forces at a trial displacement.
    Force {
        /// The trial.
        displacement: Arc<[f64]>,
    },
    /// The tangent there. In f32 beside residuals in f64 it may be, element by element, that of an
    /// earlier call of the step that is as good.
    Tangent {
        /// The trial.
        displacement: Arc<[f64]>,
        /// Memory for the answer, in the precision that is asked for; of any size.
        blocks: TangentBlocks,
    },
    /// The contact conditions there.
    Contact {
        /// The trial at the contact nodes alone.
        displacement: Vec<f64>,
        /// Internal forces at these nodes.
        force: Vec<f64>,
    },
    /// Linear systems with the tangent there, where the backend solves them: [`super::About`].
    Solve(Arc<SolveRequest>),
    /// Newton's iterates, where they stay. Only of backends that keep them: [`super::About`].
    Iterate(iterate::Request),
    /// A displacement is the committed one from now on.
    Commit {
        /// That of the converged step.
        displacement: Arc<[f64]>,
    },
    /// Stresses and strains of the committed state.
    Fields,
    /// A copy of the committed state.
    State,
    /// Replaces the committed state.
    Restore(Arc<CaseState>),
    /// Another case of the batch's connectivity, in its virgin state, takes the place of one that
    /// has ended. It gets the bits that it would get in a batch that had it from the beginning.
    Replace(Box<CaseModel>),
}

/// What comes back.
#[derive(Clone, Debug)]
pub enum Answer {
    /// Of [`Call::BeginStep`] and [`Call::Restore`].
    Done,
    /// Of [`Call::Force`].
    Force {
        /// dW/du, three a node.
        force: Vec<f64>,
        /// How it went.
        outcome: Evaluated,
    },
    /// Of [`Call::Tangent`].
    Tangent {
        /// Blocks d f_i / d u_j in the order of [`crate::mesh::pattern::Pattern`], row-major. They
        /// mean nothing if the outcome is not [`Evaluated::Valid`].
        blocks: TangentBlocks,
        /// How it went.
        outcome: Evaluated,
    },
    /// Of [`Call::Contact`]: the rows of each contact node.
    Contact(Vec<Rows<f64>>),
    /// Of [`Call::Solve`].
    Solved(Solved),
    /// Of [`Call::Iterate`].
    Iterate(iterate::Reply),
    /// Of [`Call::Commit`].
    Commit {
        /// Energies of the new committed state.
        energies: Energies,
        /// How it went; an invalid state is not committed.
        outcome: Evaluated,
    },
    /// Of [`Call::Fields`].
    Fields(CaseFields),
    /// Of [`Call::State`].
    State(CaseState),
    /// Of [`Call::Replace`]: whether the backend had a place for the case. It leaves things as they
    /// were where it had none.
    Replaced(bool),
}

impl Call {
    /// Whether the two may go into one call of a backend: many cases are evaluated at once, and
    /// everything else is done case by case.
    pub fn goes_with(&self, other: &Self) -> bool {
        use std::mem::discriminant;
        match (self, other) {
            (Self::Iterate(one), Self::Iterate(other)) => discriminant(&one.ask) == discriminant(&other.ask),
            (Self::Solve(one), Self::Solve(other)) => one.tie.is_some() == other.tie.is_some(),
            (Self::Force { .. } | Self::Tangent { .. } | Self::Contact { .. } | Self::Commit { .. }, _) => {
                discriminant(self) == discriminant(other)
            }
            _ => false,
        }
    }

    /// The same for another backend, if this one fails: without the memory that it brings.
    pub fn again(&self) -> Self {
        match self {
            Self::Tangent { displacement, blocks } => Self::Tangent { displacement: displacement.clone(), blocks: blocks.none() },
            call => call.clone(),
        }
    }

    /// The trial displacement of all nodes; nothing of calls that have none.
    pub fn displacement(&self) -> &[f64] {
        match self {
            Self::Force { displacement } | Self::Tangent { displacement, .. } | Self::Commit { displacement } => displacement,
            Self::Solve(system) => &system.displacement,
            _ => &[],
        }
    }

    /// Whether a state is committed by it.
    pub fn commits(&self) -> bool {
        match self {
            Self::Commit { .. } => true,
            Self::Iterate(request) => request.ask == iterate::Ask::Commit,
            _ => false,
        }
    }
}

/// The blocks of a tangent: in f32 for multigrid, which holds its matrices so; in f64 for the
/// direct solver, and for comparisons.
#[derive(Clone, Debug)]
pub enum TangentBlocks {
    /// In f64.
    Double(Vec<[f64; 9]>),
    /// In f32.
    Single(Vec<[f32; 9]>),
}

impl TangentBlocks {
    /// None, in the same precision.
    pub fn none(&self) -> Self {
        match self {
            Self::Double(_) => Self::Double(Vec::new()),
            Self::Single(_) => Self::Single(Vec::new()),
        }
    }

    /// So many; what they hold means nothing.
    pub fn resized(mut self, blocks: usize) -> Self {
        match &mut self {
            Self::Double(own) => own.resize(blocks, [0.0; 9]),
            Self::Single(own) => own.resize(blocks, [0.0; 9]),
        }
        self
    }
}

/// A precision that [`TangentBlocks`] have.
pub trait OfBlocks: Real {
    /// As blocks.
    fn wrap(blocks: Vec<[Self; 9]>) -> TangentBlocks;
    /// Out of blocks, if they are in this precision.
    fn unwrap(blocks: TangentBlocks) -> Option<Vec<[Self; 9]>>;
}

impl OfBlocks for f64 {
    fn wrap(blocks: Vec<[Self; 9]>) -> TangentBlocks {
        TangentBlocks::Double(blocks)
    }

    fn unwrap(blocks: TangentBlocks) -> Option<Vec<[Self; 9]>> {
        if let TangentBlocks::Double(blocks) = blocks { Some(blocks) } else { None }
    }
}

impl OfBlocks for f32 {
    fn wrap(blocks: Vec<[Self; 9]>) -> TangentBlocks {
        TangentBlocks::Single(blocks)
    }

    fn unwrap(blocks: TangentBlocks) -> Option<Vec<[Self; 9]>> {
        if let TangentBlocks::Single(blocks) = blocks { Some(blocks) } else { None }
    }
}

/// An answer to something else than was asked.
pub fn not_asked() -> ComputeError {
    ComputeError::Device("it answered something that was not asked".to_owned())
}
