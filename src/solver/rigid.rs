//! Contact with a rigid sphere: the rows of a plane, each contact node's in the frame of the
//! sphere's surface where it is (see [`crate::contact::rigid`]).
//!
//! Residual, corrections and tangent are in these frames at contact nodes and along the axes
//! elsewhere. The tangent is turned block by block, so that whatever solves its systems finds what
//! it finds over a plane.

use super::couple::turn_node;
use super::system::{Boundary, Trial};
use crate::compute::CaseModel;
use crate::contact::coulomb::{CONTACT_WEIGHT, Friction, Point, Status, contact_rows};
use crate::contact::frame::{Frame, from_frame, to_frame};
use crate::contact::rigid::Rigid;
use crate::linalg::bsr::BlockMatrix;
use crate::mesh::Mesh;

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

impl Trial {
    /// Contact rows of a rigid sphere, and the residual with them in it.
    pub(super) fn meet_rigid(&mut self, model: &CaseModel, boundary: &Boundary, against: &Against) {
        let mesh = &model.mesh;
        self.residual.copy_from_slice(&self.force);
        self.frames.clear();
        self.force_scale = 0.0;
        for (i, &node) in mesh.contact_nodes.iter().enumerate() {
            let base = 3 * node as usize;
            let x = position(mesh, &self.u, node);
            let frame = against.rigid.frame(&x);
            let force = to_frame(&frame, &[self.force[base], self.force[base + 1], self.force[base + 2]]);
            let moved = to_frame(&frame, &std::array::from_fn(|c| x[c] - against.start[i][c]));
            let slides = boundary.frictionless[i];
            let point = Point {
                force,
                gap: against.rigid.gap(&x),
                slip: if slides { [0.0; 2] } else { [moved[0], moved[1]] },
                weight: CONTACT_WEIGHT * mesh.contact_size[i],
                on_symmetry_plane: boundary.prescribed[base + 1],
            };
            let rows = contact_rows(if slides { Friction::Coulomb(0.0) } else { model.friction }, &point);
            if rows.status != Status::Open {
                self.force_scale += force[2].abs();
            }
            self.residual[base..base + 3].copy_from_slice(&rows.residual);
            self.rows[i] = rows;
            self.frames.push(frame);
        }
    }

    /// Turns contact nodes' components of a vector (three a node) from their frames to the axes.
    pub(super) fn to_axes(&self, mesh: &Mesh, x: &mut [f64]) {
        for (frame, &node) in self.frames.iter().zip(&mesh.contact_nodes) {
            let v = &mut x[3 * node as usize..][..3];
            v.copy_from_slice(&from_frame(frame, &[v[0], v[1], v[2]]));
        }
    }

    /// Turns contact nodes' components of a vector (three a node) from the axes to their frames.
    pub(super) fn to_frames(&self, mesh: &Mesh, x: &mut [f64]) {
        for (frame, &node) in self.frames.iter().zip(&mesh.contact_nodes) {
            let v = &mut x[3 * node as usize..][..3];
            v.copy_from_slice(&to_frame(frame, &[v[0], v[1], v[2]]));
        }
    }

    /// Force of a rigid sphere on a contact point along the axes, as [`Trial::point_force`] has
    /// that of a plane.
    pub(super) fn rigid_point_force(&self, mesh: &Mesh, point: usize) -> [f64; 3] {
        let (rows, node) = (&self.rows[point], mesh.contact_nodes[point] as usize);
        if rows.status == Status::Open {
            return [0.0; 3];
        }
        let frame = &self.frames[point];
        let [t1, t2, n] = to_frame(frame, &[self.force[3 * node], self.force[3 * node + 1], self.force[3 * node + 2]]);
        let across = if mesh.nodes[node][1] == 0.0 { 0.0 } else { t2 - rows.residual[1] };
        from_frame(frame, &[t1 - rows.residual[0], across, n.max(0.0)])
    }
}

/// Turns the rows and columns of contact nodes into their frames.
pub(super) fn turn(matrix: &mut BlockMatrix<f64>, mesh: &Mesh, frames: &[Frame]) {
    for (q, &node) in frames.iter().zip(&mesh.contact_nodes) {
        turn_node(matrix, node as usize, q);
    }
}
