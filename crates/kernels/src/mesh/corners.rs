//! Points and cells of a mesh for what draws them, corners that hang among them.

use std::collections::BTreeMap;

use super::{Hanging, Mesh};

/// Points and cells of a mesh as others draw them: corners that hang are points too, after the
/// nodes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Corners {
    /// Points of each element's corners.
    pub elements: Vec<[u32; 8]>,
    /// For each point after the nodes, the nodes whose mean it is.
    pub means: Vec<Vec<u32>>,
}

impl Corners {
    /// Those of a mesh.
    pub fn of(mesh: &Mesh) -> Self {
        let (mut means, mut known) = (Vec::new(), BTreeMap::new());
        let mut point = |nodes: &[u32; 8], hanging: Hanging, corner: usize| {
            if !hanging.hangs(corner) {
                return nodes[corner];
            }
            let mut from: Vec<u32> = hanging.members(corner).map(|c| nodes[c]).collect();
            from.sort_unstable();
            *known.entry(from.clone()).or_insert_with(|| {
                means.push(from);
                (mesh.nodes.len() + means.len() - 1) as u32
            })
        };
        let elements = mesh
            .elements
            .iter()
            .zip(&mesh.hanging)
            .map(|(nodes, &hanging)| std::array::from_fn(|a| point(nodes, hanging, a)))
            .collect();
        Self { elements, means }
    }

    /// Vectors at the points, from those at the nodes.
    pub fn extended(&self, at_nodes: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let mean =
            |from: &Vec<u32>| [0, 1, 2].map(|k| from.iter().map(|&n| at_nodes[n as usize][k]).sum::<f64>() / from.len() as f64);
        at_nodes.iter().copied().chain(self.means.iter().map(mean)).collect()
    }
}
