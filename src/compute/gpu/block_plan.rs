//! Which element blocks make up each block of the tangent: the list along which the device gathers.

use crate::compute::gather::GatherPlan;
use crate::mesh::Mesh;

/// The upper block triangle of a tangent, block by block in the order of the pattern, with the
/// element blocks of each.
///
/// The element tangent is symmetric: the lower triangle is the upper one transposed, and is neither
/// computed nor sent.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BlockPlan {
    /// Starts of the blocks' lists in `entry`, one more than there are upper blocks.
    pub start: Vec<u32>,
    /// `64 element + 8 a + b`: the block (a, b) of the element tangent; elements increase along a
    /// list.
    pub entry: Vec<u32>,
    /// For each block of the pattern, `2 * upper block`, plus 1 if it is that block transposed.
    pub source: Vec<u32>,
}

impl BlockPlan {
    /// The plan of a mesh, from the plan by which block rows are gathered.
    pub fn new(mesh: &Mesh, plan: &GatherPlan) -> Self {
        let (pattern, lists) = (&plan.pattern, &mesh.node_elements);
        let mut out = Self { start: vec![0], entry: Vec::new(), source: vec![0; pattern.entries()] };
        let mut row: Vec<Vec<u32>> = Vec::new();
        for node in 0..pattern.rows() {
            let positions = pattern.row(node);
            row.iter_mut().for_each(Vec::clear);
            row.resize(row.len().max(positions.len()), Vec::new());
            for at in lists.list(node) {
                for (b, &offset) in (0..).zip(&plan.offset[at]) {
                    row[offset as usize].push(8 * lists.entry[at] + b);
                }
            }
            for (k, blocks) in positions.zip(&row) {
                let column = pattern.column[k] as usize;
                if column < node {
                    continue;
                }
                // The pattern is symmetric: it says which nodes share an element.
                let transpose = pattern.position(column, node).unwrap_or(k);
                let block = out.start.len() as u32 - 1;
                out.source[transpose] = 2 * block + 1;
                out.source[k] = 2 * block;
                out.entry.extend(blocks);
                out.start.push(out.entry.len() as u32);
            }
        }
        out
    }

    /// Number of upper blocks.
    pub fn blocks(&self) -> usize {
        self.start.len() - 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::brick::brick;

    #[test]
    fn every_element_block_of_the_upper_triangle_is_listed_once() {
        let mesh = brick(2, 3, 2, [1.0; 3]).unwrap();
        let plan = GatherPlan::new(&mesh);
        let blocks = BlockPlan::new(&mesh, &plan);
        let pattern = &plan.pattern;
        assert_eq!(2 * blocks.blocks(), pattern.entries() + pattern.rows());
        let mut seen = vec![0; 64 * mesh.elements.len()];
        for row in 0..pattern.rows() {
            for k in pattern.row(row) {
                let column = pattern.column[k] as usize;
                let (block, transposed) = (blocks.source[k] as usize / 2, blocks.source[k] % 2 == 1);
                assert_eq!(transposed, column < row);
                for &entry in &blocks.entry[blocks.start[block] as usize..blocks.start[block + 1] as usize] {
                    let element = &mesh.elements[entry as usize / 64];
                    let ends = [element[entry as usize / 8 % 8] as usize, element[entry as usize % 8] as usize];
                    assert_eq!(ends, if transposed { [column, row] } else { [row, column] });
                    seen[entry as usize] += usize::from(!transposed);
                }
            }
        }
        for (e, element) in mesh.elements.iter().enumerate() {
            for a in 0..8 {
                for b in 0..8 {
                    assert_eq!(seen[64 * e + 8 * a + b], usize::from(element[a] <= element[b]));
                }
            }
        }
    }
}
