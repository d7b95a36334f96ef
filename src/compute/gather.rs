//! Plans by which element contributions are gathered into nodes and blocks: every sum has one
//! writer and a fixed order.

use crate::mesh::Mesh;
use crate::mesh::pattern::Pattern;

/// Where the blocks of every element around a node go in that node's block row.
#[derive(Clone, Debug)]
pub struct GatherPlan {
    /// The pattern of the matrices.
    pub pattern: Pattern,
    /// For each entry of the mesh's node-to-element lists, the offset within the row of the column
    /// of each local node.
    pub offset: Vec<[u16; 8]>,
}

impl GatherPlan {
    /// The plan of a mesh.
    pub fn new(mesh: &Mesh) -> Self {
        let pattern = Pattern::from_elements(mesh.nodes.len(), &mesh.elements);
        let mut offset = Vec::with_capacity(mesh.node_elements.entry.len());
        for node in 0..mesh.nodes.len() {
            let row = &pattern.column[pattern.row(node)];
            for &entry in &mesh.node_elements.entry[mesh.node_elements.list(node)] {
                let element = &mesh.elements[entry as usize / 8];
                // The pattern was made from these very elements: every column is there.
                offset.push(element.map(|b| row.partition_point(|&c| c < b) as u16));
            }
        }
        Self { pattern, offset }
    }
}
