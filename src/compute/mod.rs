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

use crate::contact::coulomb::{Friction, Rows};
use crate::element::hex8::Invalid;
use crate::material::multistep::Flow;
use crate::material::{Material, PointState, Refusal};
use crate::mesh::Mesh;
use iterate::{IterateRequest, Keeps};
use linear::LinearRequest;
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
        self.mesh.elements == other.mesh.elements && self.mesh.contact_nodes == other.mesh.contact_nodes
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

/// Asks for the internal nodal forces of one case.
#[derive(Debug)]
pub struct ForceRequest<'a> {
    /// Case index in the batch.
    pub case: usize,
    /// Trial displacement, three a node.
    pub displacement: &'a [f64],
    /// Receives dW/du, three a node.
    pub force: &'a mut [f64],
    /// Receives how it went.
    pub outcome: Outcome,
}

/// Where the blocks of a tangent go: in f32 for multigrid, which holds its matrices so; in f64 for
/// the direct solver, and for comparisons.
#[derive(Debug)]
pub enum Blocks<'a> {
    /// In f64.
    Double(&'a mut [[f64; 9]]),
    /// In f32.
    Single(&'a mut [[f32; 9]]),
}

impl<'a> From<&'a mut Vec<[f64; 9]>> for Blocks<'a> {
    fn from(blocks: &'a mut Vec<[f64; 9]>) -> Self {
        Self::Double(blocks)
    }
}

impl<'a> From<&'a mut Vec<[f32; 9]>> for Blocks<'a> {
    fn from(blocks: &'a mut Vec<[f32; 9]>) -> Self {
        Self::Single(blocks)
    }
}

/// Asks for the tangent of one case: blocks d f_i / d u_j in the order of
/// [`crate::mesh::pattern::Pattern`].
#[derive(Debug)]
pub struct TangentRequest<'a> {
    /// Case index in the batch.
    pub case: usize,
    /// Trial displacement, three a node.
    pub displacement: &'a [f64],
    /// Receives the blocks, row-major; they mean nothing if the outcome is not [`Outcome::Valid`].
    pub blocks: Blocks<'a>,
    /// Receives how it went.
    pub outcome: Outcome,
}

/// Asks for the contact conditions of one case.
#[derive(Debug)]
pub struct ContactRequest<'a> {
    /// Case index in the batch.
    pub case: usize,
    /// Trial displacement, three a node.
    pub displacement: &'a [f64],
    /// Internal forces there, three a node.
    pub force: &'a [f64],
    /// Receives the rows of each of the mesh's contact nodes.
    pub rows: &'a mut [Rows<f64>],
}

/// Asks to make a trial displacement the committed state of one case.
#[derive(Debug)]
pub struct CommitRequest<'a> {
    /// Case index in the batch.
    pub case: usize,
    /// Converged displacement, three a node.
    pub displacement: &'a [f64],
    /// Receives the energies of the new committed state.
    pub energies: Energies,
    /// Receives how it went; an invalid state is not committed.
    pub outcome: Outcome,
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
    /// given a state to go on from ([`Compute::restore`]).
    #[error("the device that had the state of the case failed, and nobody has given its stand-in an earlier one")]
    Gone,
    /// The device that had Newton's iterates failed; its stand-in has the committed state.
    #[error("the device that had the iterates of the step failed, and the step was not begun anew")]
    Moved,
}

/// A batch of cases on some device.
pub trait Compute: Send {
    /// Where this is computed.
    fn description(&self) -> Description;
    /// The cases of the batch.
    fn models(&self) -> &[CaseModel];
    /// Starts a step of one case: what is asked of it up to its next commit starts from its
    /// committed state with `weight` times the flow of its last step anticipated (see
    /// [`crate::material::multistep`]). A step that is not started so, as any after a commit,
    /// anticipates nothing.
    fn begin_step(&mut self, case: usize, weight: f64) -> Result<(), ComputeError>;
    /// Internal forces.
    fn internal_force(&mut self, requests: &mut [ForceRequest<'_>]) -> Result<(), ComputeError>;
    /// Tangents. In f32 beside residuals in f64 they may be, element by element, those of an
    /// earlier request of the step that are as good.
    fn tangent(&mut self, requests: &mut [TangentRequest<'_>]) -> Result<(), ComputeError>;
    /// Contact conditions.
    fn contact(&mut self, requests: &mut [ContactRequest<'_>]) -> Result<(), ComputeError>;
    /// Tangents, and the solutions of linear systems with them, both staying where they are
    /// computed. A backend that solves none leaves the requests as [`linear::Ended::NotTried`].
    fn linear(&mut self, requests: &mut [LinearRequest<'_>]) -> Result<(), ComputeError> {
        let _ = requests;
        Ok(())
    }
    /// Which of Newton's iterates stay where they are computed: [`Compute::iterate`] is asked for
    /// those, and nothing else up to the step's end.
    fn keeps(&self) -> Keeps {
        Keeps::Nothing
    }
    /// Newton's iterates, where they stay. All requests ask for the same.
    fn iterate(&mut self, requests: &mut [IterateRequest]) -> Result<(), ComputeError> {
        let _ = requests;
        Err(ComputeError::Device("this backend keeps no iterates".to_owned()))
    }
    /// Commits converged displacements.
    fn commit(&mut self, requests: &mut [CommitRequest<'_>]) -> Result<(), ComputeError>;
    /// Stresses and strains of a committed state.
    fn fields(&mut self, case: usize) -> Result<CaseFields, ComputeError>;
    /// A copy of a committed state.
    fn state(&mut self, case: usize) -> Result<CaseState, ComputeError>;
    /// Replaces a committed state.
    fn restore(&mut self, case: usize, state: &CaseState) -> Result<(), ComputeError>;
    /// Puts another case of the batch's connectivity, in its virgin state, in the place of one that
    /// has ended; `false` where the backend has no place for it, and leaves things as they were.
    /// The new case gets the bits that it would get in a batch that had it from the beginning.
    fn replace(&mut self, case: usize, model: CaseModel) -> Result<bool, ComputeError> {
        let _ = (case, model);
        Ok(false)
    }
    /// Whether another backend would stand in if this one failed: then copies of states are worth
    /// taking from time to time.
    fn has_stand_in(&self) -> bool {
        false
    }
    /// What the user should know and has not been told yet, in whole sentences: a device that
    /// failed, say.
    fn take_notes(&mut self) -> Vec<String> {
        Vec::new()
    }
    /// What has passed between the host and the device so far; `None` without a device.
    fn traffic(&self) -> Option<Traffic> {
        None
    }
}
