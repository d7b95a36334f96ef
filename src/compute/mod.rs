//! Evaluation of a batch of cases: internal forces, tangents, contact, commit. One trait, a CPU and
//! a GPU behind it.
//!
//! The batch is the leading dimension everywhere: a call carries one request for each case that
//! still iterates, and one dispatch serves them all. A single case is a batch of one. What a case
//! gets never depends on the other cases of the batch.
//!
//! A backend holds the committed state of every case (elastic strains, hardening variables,
//! displacement); trial states are never stored: each evaluation is a pure function of the
//! committed state and the trial displacement.

pub mod call;
pub mod cpu;
pub mod fallback;
pub mod gather;
#[cfg(feature = "gpu")]
pub mod gpu;
pub mod handle;
pub mod iterate;
pub mod linear;
#[cfg(feature = "gpu")]
pub mod lost;
pub mod select;
mod sweep;
pub mod traffic;
pub mod wrong;

#[cfg(test)]
mod tests;

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::contact::coulomb::Friction;
use crate::element::hex8::Invalid;
use crate::material::multistep::Flow;
use crate::material::{Material, PointState, Refusal};
use crate::mesh::Mesh;
pub use call::{Answer, Blocks, Call};
use iterate::Keeps;
use traffic::Traffic;

/// One case of a batch, scaled: lengths by R, stresses by E.
#[derive(Clone, Debug)]
pub struct CaseModel {
    /// The mesh; all cases of a batch share its connectivity, not its node positions.
    pub mesh: Arc<Mesh>,
    /// Elasticity and hardening.
    pub material: Material<f64>,
    /// Friction between sphere and plane.
    pub friction: Friction<f64>,
    /// Elasticity and hardening of the opponent, if the mesh is of two bodies.
    pub opponent: Option<Material<f64>>,
}

impl CaseModel {
    /// Index of the first element of the opponent: the number of elements if there is none.
    pub fn opponent_from(&self) -> usize {
        self.mesh.own_elements()
    }

    /// Whether the two have one mesh connectivity: they may be in one batch.
    pub fn is_alike(&self, other: &Self) -> bool {
        let (own, other) = (&self.mesh, &other.mesh);
        own.elements == other.elements && own.hanging == other.hanging && own.contact_nodes == other.contact_nodes
    }
}

/// How the evaluation of a trial displacement went.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Outcome {
    /// Evaluated.
    #[default]
    Valid,
    /// It could not be evaluated; the solver answers by backtracking.
    Invalid(Fault),
}

impl Outcome {
    /// Nothing if it is valid.
    ///
    /// # Errors
    /// The fault.
    pub fn check(self) -> Result<(), Fault> {
        match self {
            Self::Valid => Ok(()),
            Self::Invalid(fault) => Err(fault),
        }
    }
}

/// Why a trial displacement could not be evaluated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Fault {
    /// J <= 0 at a quadrature point.
    #[error("element {element} inverts at quadrature point {point}")]
    Inverted {
        /// Element index.
        element: usize,
        /// Quadrature point.
        point: usize,
    },
    /// J is infinite or NaN there.
    #[error("the deformation of element {element} is not finite at quadrature point {point}")]
    Deformation {
        /// Element index.
        element: usize,
        /// Quadrature point.
        point: usize,
    },
    /// The material has no answer there.
    #[error("the material refuses the deformation of element {element} at quadrature point {point}: {why}")]
    Refused {
        /// Element index.
        element: usize,
        /// Quadrature point.
        point: usize,
        /// The material's reason.
        why: Refusal,
    },
    /// The residual holds a number that is infinite or NaN, or its norm is one.
    #[error("the residual is not finite{}", .at.map_or_else(String::new, on_node))]
    Residual {
        /// The first node and direction with such a number, if it is known.
        at: Option<(usize, usize)>,
    },
}

fn on_node((node, direction): (usize, usize)) -> String {
    format!(" at node {node} in {}", ["x", "y", "z"].get(direction).copied().unwrap_or("?"))
}

impl Fault {
    /// Of an element.
    pub fn of(element: usize, invalid: Invalid) -> Self {
        match invalid {
            Invalid::Inverted(point) => Self::Inverted { element, point },
            Invalid::NotFinite(point) => Self::Deformation { element, point },
            Invalid::Material(point, why) => Self::Refused { element, point, why },
        }
    }

    /// It comes from numbers that are not finite, which a deformation that is merely too large does
    /// not make.
    pub fn is_of_numbers(&self) -> bool {
        match self {
            Self::Inverted { .. } => false,
            Self::Refused { why, .. } => *why == Refusal::NotFinite,
            Self::Deformation { .. } | Self::Residual { .. } => true,
        }
    }
}

/// Energies of a committed state, of the meshed half.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energies {
    /// Stored elastic energy.
    pub elastic: f64,
    /// Plastic work done so far.
    pub plastic: f64,
    /// Largest equivalent plastic strain of any quadrature point, no energy but measured with them.
    pub max_alpha: f64,
    /// The opponent's share of the plastic work.
    pub opponent_plastic: f64,
}

/// The committed state of a case, for output and checkpoints.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CaseState {
    /// Displacement, three a node.
    pub displacement: Vec<f64>,
    /// State of each element's eight quadrature points.
    pub points: Vec<[PointState<f64>; 8]>,
    /// What flowed in the last step at each element's eight quadrature points.
    pub flow: Vec<[Flow<f64>; 8]>,
    /// Plastic work of each element.
    pub plastic_work: Vec<f64>,
}

impl CaseState {
    /// The undeformed state of a mesh.
    pub fn virgin(mesh: &Mesh) -> Self {
        let elements = mesh.elements.len();
        Self {
            displacement: vec![0.0; 3 * mesh.nodes.len()],
            points: vec![Default::default(); elements],
            flow: vec![Default::default(); elements],
            plastic_work: vec![0.0; elements],
        }
    }
}

/// What a committed state shows, for output.
#[derive(Clone, Debug, PartialEq)]
pub struct CaseFields {
    /// Cauchy stress [xx, yy, zz, xy, yz, zx] of each element (volume mean of its points), scaled
    /// by E.
    pub stress: Vec<[f64; 6]>,
    /// Equivalent plastic strain of each element: mean over its points.
    pub alpha: Vec<f64>,
    /// Largest equivalent plastic strain of any quadrature point.
    pub max_alpha: f64,
}

/// Where and in which precision a backend computes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Description {
    /// For people: "CPU (2 threads)", an adapter's name.
    pub device: String,
    /// Precision of the residual: "f64" or "f32".
    pub precision: &'static str,
}

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
    /// given a state to go on from ([`Call::Restore`]).
    #[error("the device that had the state of the case failed, and nobody has given its stand-in an earlier one")]
    Gone,
    /// The device that had Newton's iterates failed; its stand-in has the committed state.
    #[error("the device that had the iterates of the step failed, and the step was not begun anew")]
    Moved,
}

/// What a backend says of itself.
#[derive(Clone, Debug, PartialEq)]
pub struct About {
    /// Where this is computed.
    pub description: Description,
    /// It solves linear systems: [`Call::Solve`].
    pub solves: bool,
    /// Which of Newton's iterates stay where they are computed: [`Call::Iterate`] asks for those,
    /// and nothing else is asked for up to the step's end.
    pub keeps: Keeps,
    /// Another backend would stand in if this one failed: then copies of states are worth taking
    /// from time to time.
    pub has_stand_in: bool,
    /// What has passed between the host and the device so far; `None` without a device.
    pub traffic: Option<Traffic>,
}

impl About {
    /// Of a backend that evaluates, and does nothing else.
    pub fn plain(description: Description) -> Self {
        Self { description, solves: false, keeps: Keeps::Nothing, has_stand_in: false, traffic: None }
    }
}

/// A batch of cases on some device.
pub trait Compute: Send {
    /// The cases of the batch.
    fn models(&self) -> &[CaseModel];
    /// What it is, and what may be asked of it at present.
    fn about(&self) -> About;
    /// Answers calls, each of the case of this index, in their order. All go with the first
    /// ([`Call::goes_with`]).
    ///
    /// # Errors
    /// What no smaller step cures. What was to be evaluated can be asked for again; of anything
    /// else some may be done.
    fn call(&mut self, calls: Vec<(usize, Call)>) -> Result<Vec<Answer>, ComputeError>;
    /// What the user should know and has not been told yet, in whole sentences: a device that
    /// failed, say.
    fn take_notes(&mut self) -> Vec<String> {
        Vec::new()
    }
}
