//! Contact with a rigid sphere: the rows of a plane, each contact node's in the frame of the
//! sphere's surface where it is (see [`crate::contact::rigid`]).
//!
//! Residual, corrections and tangent are in these frames at contact nodes and along the axes
//! elsewhere. The tangent is turned block by block, so that whatever solves its systems finds what
//! it finds over a plane.

use super::couple::turn_node;
use crate::contact::frame::Frame;
use crate::contact::rigid::Rigid;
use crate::linalg::bsr::BlockMatrix;
use crate::mesh::Mesh;
use crate::real::Real;

/// A rigid sphere that the body is pressed against, and where the step started.
#[derive(Clone, Debug)]
pub struct Against {
    /// The sphere.
    pub rigid: Rigid,
    /// Positions of the contact nodes when the step began.
    pub start: Vec<[f64; 3]>,
}

/// Position of a node.
pub fn position(mesh: &Mesh, u: &[f64], node: u32) -> [f64; 3] {
    let n = node as usize;
    std::array::from_fn(|i| mesh.nodes[n][i] + u[3 * n + i])
}

impl Against {
    /// The sphere, before any step.
    pub fn new(rigid: Rigid) -> Self {
        Self { rigid, start: Vec::new() }
    }

    /// Sets out from displacement `u`.
    pub fn set_out(&mut self, mesh: &Mesh, u: &[f64]) {
        self.start = mesh.contact_nodes.iter().map(|&node| position(mesh, u, node)).collect();
    }
}

/// Turns the rows and columns of contact nodes into their frames.
pub(super) fn turn<T: Real>(matrix: &mut BlockMatrix<T>, mesh: &Mesh, frames: &[Frame]) {
    for (q, &node) in frames.iter().zip(&mesh.contact_nodes) {
        turn_node(matrix, node as usize, q);
    }
}
