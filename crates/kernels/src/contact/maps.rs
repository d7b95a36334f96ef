//! The maps of an equal pair's interface as rows of 3x3 blocks, one a contact node: for a device,
//! which multiplies by them as they are.

use std::collections::BTreeMap;

/// A block, row by row.
pub(super) type Block = [f64; 9];

/// A map of vectors: the numbers of a contact node become the sum of a row of blocks times those of
/// others. At all other nodes they stay as they are.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NodeMap {
    /// Starts of the rows in the lists, one more than there are contact nodes.
    pub start: Vec<u32>,
    /// The node of each block.
    pub column: Vec<u32>,
    /// The blocks.
    pub block: Vec<Block>,
}

/// Blocks of a row by contact node.
pub(super) type Row = BTreeMap<usize, Block>;

impl NodeMap {
    /// Of rows by contact node; `nodes` are these.
    pub(super) fn new(rows: &[Row], nodes: &[usize]) -> Self {
        let mut out = Self { start: vec![0], ..Self::default() };
        for row in rows {
            let blocks = row.iter().filter(|(_, block)| **block != [0.0; 9]);
            for (&column, &block) in blocks {
                out.column.push(nodes[column] as u32);
                out.block.push(block);
            }
            out.start.push(out.column.len() as u32);
        }
        out
    }

    /// The map of forces that goes with this map of displacements: its transpose.
    pub(super) fn transposed(rows: &[Row]) -> Vec<Row> {
        let mut out = vec![Row::new(); rows.len()];
        for (i, row) in rows.iter().enumerate() {
            for (&j, block) in row {
                out[j].insert(i, std::array::from_fn(|m| block[3 * (m % 3) + m / 3]));
            }
        }
        out
    }

    /// What it makes of a vector (three numbers a node); `nodes` are the contact nodes.
    pub fn times(&self, nodes: &[u32], x: &[f64]) -> Vec<f64> {
        let mut out = x.to_vec();
        for (i, &node) in nodes.iter().enumerate() {
            let mut sum = [0.0; 3];
            for at in self.start[i] as usize..self.start[i + 1] as usize {
                let x = &x[3 * self.column[at] as usize..][..3];
                (0..9).for_each(|m| sum[m / 3] += self.block[at][m] * x[m % 3]);
            }
            out[3 * node as usize..][..3].copy_from_slice(&sum);
        }
        out
    }
}

/// The maps of an interface.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PairMaps {
    /// Of the forces of y: at a slave what it takes of its masters' loads where its own unknowns
    /// are fixed (see [`super::pair::PairInterface::loads`]).
    pub halves: NodeMap,
    /// From the interface's forces at slaves and the loads elsewhere to those of all nodes.
    pub nodal: NodeMap,
    /// From displacements u to the unknowns y.
    pub contract: NodeMap,
    /// u = T y.
    pub expand: NodeMap,
    /// T^T f.
    pub reduce: NodeMap,
}

impl PairMaps {
    /// All of them, in the order in which a device has them.
    pub fn all(&self) -> [&NodeMap; 5] {
        [&self.halves, &self.nodal, &self.contract, &self.expand, &self.reduce]
    }
}
