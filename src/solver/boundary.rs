//! Which displacements are prescribed: by the plate, by the symmetry plane.

use super::pose::{CENTRE, Pose};
use crate::compute::iterate::{missing_weight, prescribed};
use crate::contact::coulomb::Friction;
use crate::mesh::Mesh;

/// Which displacements are prescribed, whatever the contact does.
#[derive(Debug)]
pub struct Boundary {
    /// Nodes of the rigid plate that moves; that of another body stands still.
    pub plate: Vec<u32>,
    /// How far from the sphere's centre they lie in the undeformed body.
    pub from_centre: Vec<[f64; 3]>,
    /// Per unknown: prescribed by the plate or by symmetry.
    pub prescribed: Vec<bool>,
    /// Per contact point: slides without friction in the present step, whatever the case says. For
    /// points that come into contact within a step under full stick: where they touch down, and so
    /// what they stick to, is not known before its end.
    pub frictionless: Vec<bool>,
    /// Every point that touches sticks, but for those that slide without friction.
    pub stuck: bool,
    /// Per unknown: a typical stiffness by which a missing prescribed displacement enters the
    /// merit.
    pub weight: f64,
    /// Nodes of the sphere; those of another body follow them.
    pub own_nodes: usize,
    /// Its contact nodes, alike.
    pub own_contacts: usize,
}

impl Boundary {
    /// Plate and symmetry plane of a mesh.
    pub fn new(mesh: &Mesh) -> Self {
        let frictionless = vec![false; mesh.contact_nodes.len()];
        let own_nodes = mesh.own_nodes();
        let plate: Vec<u32> = mesh.plate_nodes.iter().copied().filter(|&n| (n as usize) < own_nodes).collect();
        let from_centre = |&n: &u32| std::array::from_fn(|k| mesh.nodes[n as usize][k] - CENTRE[k]);
        Self {
            from_centre: plate.iter().map(from_centre).collect(),
            plate,
            prescribed: prescribed(mesh),
            frictionless,
            stuck: false,
            weight: missing_weight(mesh),
            own_nodes,
            own_contacts: mesh.own_contacts(),
        }
    }

    /// The friction of a contact point, of a case with this one.
    pub fn friction_at(&self, contact: usize, friction: Friction<f64>) -> Friction<f64> {
        match (self.frictionless[contact], self.stuck) {
            (true, _) => Friction::Coulomb(0.0),
            (false, true) => Friction::Stick,
            (false, false) => friction,
        }
    }

    /// Writes the plate's position into a displacement.
    pub fn place_plate(&self, u: &mut [f64], h: f64, pose: &Pose) {
        for (&n, from_centre) in self.plate.iter().zip(&self.from_centre) {
            u[3 * n as usize..3 * n as usize + 3].copy_from_slice(&pose.displacement(h, from_centre));
        }
    }
}
