//! How the CPU forms and sums element tangents: wave after wave of elements, each row as soon as
//! its last element is done, so that what it is the sum of is still in the cache. The numbers of
//! the sphere's elements sweep over the mesh (`mesh::connectivity::sweep_order`), so that the front
//! is short.

use std::ops::Range;

use crate::mesh::Mesh;

/// Elements of a wave: enough to share out between threads, few enough to stay in the cache with
/// the waves before it.
const WAVE: usize = 512;

/// Which contributions a sweep leaves behind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Keep {
    /// Those of all elements.
    All,
    /// Those of the last waves.
    Front,
}

/// Waves of successive elements; after each, the rows that are complete.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct WaveSweep {
    elements: usize,
    /// Nodes whose last element is in each wave.
    rows: Vec<Vec<u32>>,
    slots: usize,
}

impl WaveSweep {
    /// Plans the sweep of a mesh; the contributions of all elements are kept, or of those alone
    /// whose rows are not complete.
    pub fn new(mesh: &Mesh, keep: Keep) -> Self {
        let elements = mesh.elements.len();
        let lists = &mesh.node_elements;
        let mut rows = vec![Vec::new(); elements.div_ceil(WAVE)];
        let mut depth = 1;
        for node in 0..mesh.nodes.len() {
            let around = &lists.entry[lists.list(node)];
            // The lists are in increasing order. The row of a node without elements is empty and so
            // complete at once.
            let [first, last] = [around.first(), around.last()].map(|entry| entry.map_or(0, |entry| *entry as usize / 8 / WAVE));
            if let Some(rows) = rows.get_mut(last) {
                rows.push(node as u32);
            }
            depth = depth.max(last - first + 1);
        }
        let slots = match keep {
            Keep::All => elements,
            Keep::Front => elements.min(depth * WAVE),
        };
        Self { elements, rows, slots }
    }

    /// Contributions that are kept at a time.
    pub fn slots(&self) -> usize {
        self.slots
    }

    /// The place of an element's contribution.
    #[inline(always)]
    pub fn slot(&self, element: usize) -> usize {
        element % self.slots
    }

    /// For each wave its elements, which have successive places, and the nodes that have all of
    /// their elements after it.
    pub fn waves(&self) -> impl Iterator<Item = (Range<usize>, &[u32])> {
        self.rows.iter().enumerate().map(|(wave, rows)| (wave * WAVE..self.elements.min((wave + 1) * WAVE), rows.as_slice()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{SphereSpec, brick, sphere_mesh};

    #[test]
    fn every_row_finds_the_contributions_of_its_elements() {
        let sphere = sphere_mesh(&SphereSpec {
            contact_radius: 0.2,
            elements_per_contact_radius: 8,
            fine_zone: 1.3,
            skin_levels: 0,
            first_layer: 1.0,
        })
        .unwrap();
        for mesh in [brick(4, 3, 5, [1.0; 3]).unwrap(), brick(40, 3, 30, [1.0; 3]).unwrap(), sphere] {
            let sweep = WaveSweep::new(&mesh, Keep::Front);
            assert_eq!(WaveSweep::new(&mesh, Keep::All).slots(), mesh.elements.len());
            let mut kept = vec![usize::MAX; sweep.slots()];
            let mut summed = vec![0; mesh.nodes.len()];
            for (elements, rows) in sweep.waves() {
                let first = sweep.slot(elements.start);
                for (i, element) in elements.enumerate() {
                    assert_eq!(sweep.slot(element), first + i);
                    kept[first + i] = element;
                }
                for &row in rows {
                    summed[row as usize] += 1;
                    let lists = &mesh.node_elements;
                    let around = &lists.entry[lists.list(row as usize)];
                    assert!(around.iter().map(|entry| *entry as usize / 8).all(|element| kept[sweep.slot(element)] == element));
                }
            }
            assert!(summed.iter().all(|&times| times == 1));
        }
    }

    #[test]
    fn the_front_is_short() {
        let mesh = sphere_mesh(&SphereSpec {
            contact_radius: 0.2,
            elements_per_contact_radius: 16,
            fine_zone: 1.3,
            skin_levels: 0,
            first_layer: 1.0,
        })
        .unwrap();
        let sweep = WaveSweep::new(&mesh, Keep::Front);
        assert!(4 * sweep.slots() < mesh.elements.len(), "{} of {}", sweep.slots(), mesh.elements.len());
    }
}
