//! Everything known at one trial displacement.

use super::Worst;
use super::boundary::Boundary;
use crate::contact::coulomb::{Friction, Point, Rows, Status, contact_rows};
use crate::contact::frame::ContactFrame;
use crate::mesh::Mesh;

/// Everything known at one trial displacement; the default is one of no mesh.
#[derive(Clone, Debug, Default)]
pub struct Trial {
    /// Displacement, three a node.
    pub u: Vec<f64>,
    /// Internal force, three a node.
    pub force: Vec<f64>,
    /// Contact conditions of each contact node.
    pub rows: Vec<Rows<f64>>,
    /// Residual: a force; for a prescribed unknown the displacement in excess.
    pub residual: Vec<f64>,
    /// Where there is an interface: the force that it carries at each slave node, in its frame.
    pub interface_force: Vec<[f64; 3]>,
    /// Against a rigid sphere: the frame of its surface at each contact node.
    pub frames: Vec<ContactFrame>,
    /// Indentation (an unknown when the normal force is held).
    pub h: f64,
    /// Normal force by which merits are scaled: the sum of f_z over the closed points.
    pub force_scale: f64,
    /// Norm of the residual (free forces, contact residuals, missing normal force), a force.
    pub merit: f64,
    /// Normal force that the plate feels, minus its f_z.
    pub plate_force: f64,
}

impl Trial {
    /// An empty trial for a mesh.
    pub fn new(mesh: &Mesh) -> Self {
        let n = 3 * mesh.nodes.len();
        Self {
            u: vec![0.0; n],
            force: vec![0.0; n],
            rows: vec![open(); mesh.contact_nodes.len()],
            residual: vec![0.0; n],
            interface_force: Vec::new(),
            frames: Vec::new(),
            h: 0.0,
            force_scale: 0.0,
            merit: f64::INFINITY,
            plate_force: 0.0,
        }
    }

    /// Internal force at a node.
    pub(super) fn force_at(&self, node: u32) -> [f64; 3] {
        let base = 3 * node as usize;
        [self.force[base], self.force[base + 1], self.force[base + 2]]
    }

    /// Before the slaves of an interface are gone through: no point is in contact.
    pub(super) fn open_all(&mut self) {
        self.rows.fill(open());
        self.force_scale = 0.0;
        self.interface_force.clear();
    }

    /// Norm of the tangential residuals of the points in contact.
    pub fn tangential_residual(&self) -> f64 {
        let closed = self.rows.iter().filter(|rows| rows.status != Status::Open);
        closed.map(|rows| rows.residual[0].powi(2) + rows.residual[1].powi(2)).sum::<f64>().sqrt()
    }

    /// The unknown with the largest residual, over the force `scale`.
    pub fn worst(&self, mesh: &Mesh, boundary: &Boundary, scale: f64) -> Worst {
        let mut worst = Worst::default();
        for (i, &r) in self.residual.iter().enumerate() {
            let r = if boundary.prescribed[i] { r * boundary.weight } else { r } / scale.max(f64::MIN_POSITIVE);
            if r.abs() > worst.residual.abs() || r.is_nan() {
                worst = Worst { node: i / 3, direction: i % 3, position: mesh.nodes[i / 3], residual: r };
            }
            if r.is_nan() {
                break;
            }
        }
        worst
    }
}

/// The rows of a point that is not in contact.
fn open() -> Rows<f64> {
    let apart = Point { force: [0.0; 3], gap: 1.0, slip: [0.0; 2], weight: 1.0, on_symmetry_plane: false };
    contact_rows(Friction::Coulomb(0.0), &apart)
}
