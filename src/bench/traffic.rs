//! Bytes that an evaluation moves at the least: every array that a kernel reads or writes counts
//! once for that kernel, whatever caches make of repeated reads. Parameters of materials and the
//! like are left out.

use crate::compute::gpu::Evaluation;
use crate::compute::gpu::layout::{ANSWER, COORDINATES, ELEMENT_BLOCKS, HISTORY, RELATIVE, ROWS, STATE, TANGENT, TRIAL};
use crate::contact::coulomb::Rows;
use crate::element::hex8::{ElementGeometry, ElementState, NODES, Nodal, Points, Tangent};
use crate::mesh::Mesh;
use crate::mesh::pattern::Pattern;

/// Sizes of a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sizes {
    /// Nodes.
    pub nodes: usize,
    /// Elements.
    pub elements: usize,
    /// Points that can touch.
    pub contact_points: usize,
    /// Blocks of the whole tangent.
    pub blocks: usize,
}

/// Indices in the lists and numbers of status.
const INDEX: usize = 4;
/// Pairs of nodes of an element with a <= b.
const PAIRS: usize = crate::element::hex8::PAIRS;

impl Sizes {
    /// Of a mesh.
    pub fn of(mesh: &Mesh) -> Self {
        Self {
            nodes: mesh.nodes.len(),
            elements: mesh.elements.len(),
            contact_points: mesh.contact_nodes.len(),
            blocks: Pattern::from_elements(mesh.nodes.len(), &mesh.elements).entries(),
        }
    }

    /// Bytes that the device's kernels move for an evaluation of one case in numbers of `word`
    /// bytes.
    pub fn on_device(&self, evaluation: Evaluation, word: usize) -> usize {
        let points = NODES * self.elements;
        // what every kernel at the points reads of the element, and the Jacobians that the first
        // kernel writes
        let element = INDEX * NODES * self.elements + word * (COORDINATES * self.elements + 6 * self.nodes);
        let jacobian = element + word * points;
        let at_points = element + word * (2 + STATE) * points;
        let upper = (self.blocks + self.nodes) / 2;
        match evaluation {
            Evaluation::InternalForce => {
                let gather = INDEX * (self.nodes + NODES * self.elements) + word * (9 * points + 3 * self.nodes);
                jacobian + at_points + word * 9 * points + gather
            }
            Evaluation::Tangent => {
                let elements = word * ELEMENT_BLOCKS * self.elements;
                let gather = INDEX * (upper + PAIRS * self.elements) + elements + word * 9 * upper;
                jacobian + at_points + elements + gather
            }
            Evaluation::Contact => self.contact_points * (word * (3 + TRIAL + ROWS) + 2 * INDEX),
            Evaluation::Update => {
                let energies = word * (5 * points + 4 * self.elements);
                // the committed state is read, and the new one written with its flow
                jacobian + at_points + word * (STATE + HISTORY + 2) * points + energies
            }
        }
    }

    /// Bytes that the CPU moves for an evaluation of one case in numbers `R`.
    pub fn on_cpu<R>(&self, evaluation: Evaluation) -> usize {
        let double = size_of::<f64>();
        let of_elements = |bytes: usize| bytes * self.elements;
        // committed and trial displacements, geometry, states
        let element =
            of_elements(INDEX * NODES + size_of::<ElementGeometry<R>>() + size_of::<Points<R>>()) + 2 * 3 * double * self.nodes;
        match evaluation {
            Evaluation::InternalForce => {
                let gather = INDEX * (self.nodes + NODES * self.elements) + 3 * double * self.nodes;
                element + 2 * of_elements(size_of::<Nodal<R>>()) + gather
            }
            Evaluation::Tangent => {
                let gather = INDEX * NODES * self.elements + 9 * double * self.blocks;
                element + 2 * of_elements(size_of::<Tangent<R>>()) + gather
            }
            Evaluation::Contact => self.contact_points * (size_of::<Rows<f64>>() + INDEX + 10 * double + size_of::<R>()),
            Evaluation::Update => {
                // the state is read, made anew, read again and kept with its start
                element + of_elements(4 * size_of::<ElementState<R>>() + size_of::<Points<R>>()) + 2 * 3 * double * self.nodes
            }
        }
    }
}

/// Bytes that the device moves for the return mapping of a point.
pub fn point_on_device(word: usize) -> usize {
    word * (RELATIVE + STATE + ANSWER + TANGENT) + INDEX
}

/// Bytes that the CPU moves for the return mapping of a point: step and state, then stress, state
/// and tangent.
pub fn point_on_cpu(word: usize) -> usize {
    word * (RELATIVE + STATE + 6 + STATE + TANGENT)
}
