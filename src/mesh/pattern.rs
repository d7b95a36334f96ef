//! Which pairs of nodes share an element: the sparsity pattern of every block matrix on the mesh.

use std::sync::Arc;

/// Block rows in compressed form: for each node the nodes it shares an element with (itself included), increasing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BlockPattern {
    /// Row starts, one more than there are nodes.
    pub row_start: Arc<[u32]>,
    /// Column (node) of each block.
    pub column: Arc<[u32]>,
    /// Position of each row's diagonal block.
    pub diagonal: Arc<[u32]>,
}

impl BlockPattern {
    /// The pattern of a mesh of `node_count` nodes.
    pub fn from_elements(node_count: usize, elements: &[[u32; 8]]) -> Self {
        let mut neighbours = vec![Vec::new(); node_count];
        for element in elements {
            for &a in element {
                neighbours[a as usize].extend_from_slice(element);
            }
        }
        let (mut row_start, mut column, mut diagonal) = (vec![0], Vec::new(), Vec::with_capacity(node_count));
        for (node, row) in neighbours.iter_mut().enumerate() {
            row.push(node as u32);
            row.sort_unstable();
            row.dedup();
            let own = row.iter().position(|&c| c as usize == node).unwrap_or(0);
            diagonal.push((column.len() + own) as u32);
            column.extend_from_slice(row);
            row_start.push(column.len() as u32);
        }
        Self { row_start: row_start.into(), column: column.into(), diagonal: diagonal.into() }
    }

    /// Number of block rows.
    pub fn rows(&self) -> usize {
        self.row_start.len() - 1
    }

    /// Number of blocks.
    pub fn blocks(&self) -> usize {
        self.column.len()
    }

    /// Positions of the blocks of a row.
    pub fn row(&self, node: usize) -> std::ops::Range<usize> {
        self.row_start[node] as usize..self.row_start[node + 1] as usize
    }
}
