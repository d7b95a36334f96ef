//! The parts of a mesh: its half at x >= 0, and where the second of two bodies begins.

use super::hierarchy::Prolongation;

/// The half at x >= 0 of a mesh that is its own mirror image in x: all of a body that moves evenly,
/// or oddly, in x.
#[derive(Clone, Debug, PartialEq)]
pub struct MirrorHalf {
    /// Node of the whole mesh, for each node of the half.
    pub node: Vec<u32>,
    /// Interpolations of the half, finest first. Nodes at x = 0 take from nodes at x = 0 alone.
    pub hierarchy: Vec<Prolongation>,
}

/// Where the opponent begins in the lists of a mesh of two bodies, and the interpolations of each.
#[derive(Clone, Debug, PartialEq)]
pub struct Couple {
    /// Its first node.
    pub node: usize,
    /// Its first element.
    pub element: usize,
    /// Its first contact node, as an index among the contact nodes.
    pub contact: usize,
    /// Its first contact face.
    pub contact_face: usize,
    /// Interpolations of the sphere and of the opponent, finest first.
    pub hierarchies: [Vec<Prolongation>; 2],
    /// The half of each at x >= 0, in numbers of its own nodes.
    pub halves: [Option<MirrorHalf>; 2],
}

impl Couple {
    /// Body of a node: 0 the sphere, 1 the opponent.
    pub fn body_of(&self, node: usize) -> usize {
        usize::from(node >= self.node)
    }
}
