//! One case of a batch: what it is made of, its committed state, and what that state shows.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::contact::coulomb::Friction;
use crate::contact::pair::Image;
use crate::contact::rigid::Rigid;
use crate::material::multistep::Flow;
use crate::material::{Material, PointState};
use crate::mesh::Mesh;

/// One case of a batch, scaled: lengths by R, stresses by E.
#[derive(Clone, Debug)]
pub struct CaseModel {
    /// The mesh; all cases of a batch share its connectivity, not its node positions.
    pub mesh: Arc<Mesh>,
    /// Elasticity and hardening.
    pub material: Material<f64>,
    /// Friction between sphere and opponent.
    pub friction: Friction<f64>,
    /// Elasticity and hardening of the opponent, if the mesh is of two bodies.
    pub opponent: Option<Material<f64>>,
    /// Where the other of two equal bodies is; none where the opponent is another one.
    pub image: Option<Image>,
    /// Surface of an opponent that does not deform: the plane by default.
    pub surface: Rigid,
}

impl CaseModel {
    /// Index of the first element of the opponent: the number of elements if there is none.
    pub fn opponent_from(&self) -> usize {
        self.mesh.own_elements()
    }

    /// Whether the two have one mesh connectivity and linear systems of one kind: they may be in
    /// one batch.
    pub fn is_alike(&self, other: &Self) -> bool {
        let (is_equal, own, other) = (self.image == other.image, &self.mesh, &other.mesh);
        is_equal && own.elements == other.elements && own.hanging == other.hanging && own.contact_nodes == other.contact_nodes
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
