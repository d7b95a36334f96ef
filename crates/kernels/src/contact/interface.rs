//! What the interfaces of two bodies that deform have in common, whichever mortar ties them: an
//! equal pair's ([`super::pair`]) and that of two bodies ([`super::couple`]).
//!
//! The unknowns y of a step are relative displacements w at slave nodes, in frames of their own,
//! and displacements elsewhere: u = T y. The forces that belong to y are T^T f.

use std::collections::HashMap;
use std::fmt::Debug;

use super::frame::{ContactFrame, to_frame, unit};
use crate::mesh::Mesh;

/// The interface of one step: fixed while it is solved, made anew for the next.
pub trait Interface: Debug + Default + Send + Sync {
    /// Slave nodes, by their index among the contact nodes.
    fn slaves(&self) -> &[usize];

    /// Per contact node: the slave that it is, or of a master the one that it has most to do with.
    fn facing(&self) -> &[Option<usize>];

    /// Per slave: frame [t_1, t_2, n].
    fn frames(&self) -> &[ContactFrame];

    /// The unknown of component 0 of a slave.
    fn base(&self, k: usize) -> usize;

    /// Whether a slave's slip along y is no condition: something else than contact sees to it.
    fn is_free_along_y(&self, k: usize) -> bool;

    /// Relative position or displacement of a slave along the axes, from those of all nodes (three
    /// a node).
    fn relative_along_axes(&self, k: usize, x: &[f64]) -> [f64; 3];

    /// u = T y, in place.
    fn expand(&self, y: &mut [f64]);

    /// T^T f, in place: slave entries become the forces of the interface in their frames, master
    /// entries what is not balanced there.
    fn reduce(&self, f: &mut [f64]);

    /// What the interface's forces (per slave, in its frame) exert on the contact nodes, in their
    /// order.
    fn nodal(&self, forces: &[[f64; 3]]) -> Vec<[f64; 3]>;

    /// Relative positions or displacements of the slaves in their frames, from those of all nodes
    /// (three a node).
    fn relative(&self, x: &[f64]) -> Vec<[f64; 3]> {
        self.frames().iter().enumerate().map(|(k, frame)| to_frame(frame, &self.relative_along_axes(k, x))).collect()
    }

    /// y of displacements u, in place: slave entries become relative ones in their frames.
    fn contract(&self, u: &mut [f64]) {
        for (k, w) in self.relative(u).into_iter().enumerate() {
            u[self.base(k)..][..3].copy_from_slice(&w);
        }
    }
}

/// What takes a body to itself: the node opposite to each node, and the sign that each component of
/// a vector has there.
#[derive(Clone, Debug, Default)]
pub struct Symmetry {
    /// Per node, the one opposite to it; none if the mesh is not itself seen so.
    pub nodes: Vec<u32>,
    /// Signs by component.
    pub signs: [f64; 3],
}

impl Symmetry {
    /// The mirror in x.
    pub fn mirror(mesh: &Mesh) -> Self {
        Self::of(mesh, [-1.0, 1.0, 1.0])
    }

    /// The half turn round z.
    pub fn turn(mesh: &Mesh) -> Self {
        Self::of(mesh, [-1.0, -1.0, 1.0])
    }

    fn of(mesh: &Mesh, signs: [f64; 3]) -> Self {
        // + 0: no -0 among the keys.
        let key = |n: usize, signs: [f64; 3]| {
            let x = mesh.nodes[n];
            let at: [u64; 3] = std::array::from_fn(|c| (signs[c] * x[c] + 0.0).to_bits());
            (mesh.couple.as_ref().map_or(0, |couple| couple.body_of(n)), at)
        };
        let all = 0..mesh.nodes.len();
        let nodes: HashMap<(usize, [u64; 3]), u32> = all.clone().zip(0..).map(|(n, i)| (key(n, [1.0; 3]), i)).collect();
        let opposite: Option<Vec<u32>> = all.map(|n| nodes.get(&key(n, signs)).copied()).collect();
        Self { nodes: opposite.unwrap_or_default(), signs }
    }

    /// Leaves the part of a vector (three a node) that is the same seen so.
    pub fn leave_even(&self, v: &mut [f64]) {
        for (n, &opposite) in self.nodes.iter().enumerate().filter(|(n, opposite)| *n <= **opposite as usize) {
            for (c, sign) in self.signs.into_iter().enumerate() {
                let (i, j) = (3 * n + c, 3 * opposite as usize + c);
                let even = 0.5 * (v[i] + sign * v[j]);
                (v[i], v[j]) = (even, sign * even);
            }
        }
    }
}

/// Unit normals into the body at the surface's nodes, means of those of the faces around them
/// weighted by area. The body's surface looks down.
pub(super) fn inward_normals(positions: &[[f64; 3]], faces: &[[usize; 4]]) -> Vec<[f64; 3]> {
    let mut normals = vec![[0.0; 3]; positions.len()];
    for face in faces {
        let [a, b, c, d] = face.map(|n| positions[n]);
        let (p, q): ([f64; 3], [f64; 3]) = (std::array::from_fn(|i| c[i] - a[i]), std::array::from_fn(|i| d[i] - b[i]));
        let cross = [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];
        let sign = if cross[2] < 0.0 { -1.0 } else { 1.0 };
        for &n in face {
            (0..3).for_each(|i| normals[n][i] += sign * cross[i]);
        }
    }
    normals.iter_mut().for_each(|n| *n = unit(*n));
    normals
}
