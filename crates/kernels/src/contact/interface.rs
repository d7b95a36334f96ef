//! What the interfaces of two bodies that deform have in common, whichever mortar ties them: an
//! equal pair's ([`super::pair`]) and that of two bodies ([`super::couple`]).
//!
//! The unknowns y of a step are relative displacements w at slave nodes, in frames of their own,
//! and displacements elsewhere: u = T y. The forces that belong to y are T^T f.

use std::collections::HashMap;
use std::fmt::Debug;

use super::frame::{Frame, to_frame, unit};
use crate::mesh::Mesh;

/// The interface of one step: fixed while it is solved, made anew for the next.
pub trait Interface: Debug + Default + Send + Sync {
    /// Slave nodes, by their index among the contact nodes.
    fn slaves(&self) -> &[usize];

    /// Per contact node: the slave that it is, or of a master the one that it has most to do with.
    fn facing(&self) -> &[Option<usize>];

    /// Per slave: frame [t_1, t_2, n].
    fn frames(&self) -> &[Frame];

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

/// The node opposite in x of each node of a mesh that is its own mirror image; `None` if it is not.
pub fn mirror_nodes(mesh: &Mesh) -> Option<Vec<u32>> {
    // + 0: no -0 among the keys.
    let key = |n: usize, sign: f64| {
        let x = mesh.nodes[n];
        (mesh.couple.as_ref().map_or(0, |couple| couple.body_of(n)), [sign * x[0] + 0.0, x[1], x[2]].map(f64::to_bits))
    };
    let all = 0..mesh.nodes.len();
    let nodes: HashMap<(usize, [u64; 3]), u32> = all.clone().zip(0..).map(|(n, i)| (key(n, 1.0), i)).collect();
    all.map(|n| nodes.get(&key(n, -1.0)).copied()).collect()
}

/// Leaves the part of a vector (three a node) that is even in x; `mirror` is the node opposite in x
/// of each node.
pub fn leave_even(mirror: &[u32], v: &mut [f64]) {
    for (n, &opposite) in mirror.iter().enumerate().filter(|(n, opposite)| *n <= **opposite as usize) {
        for c in 0..3 {
            let sign = if c == 0 { -1.0 } else { 1.0 };
            let (i, j) = (3 * n + c, 3 * opposite as usize + c);
            let even = 0.5 * (v[i] + sign * v[j]);
            (v[i], v[j]) = (even, sign * even);
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
