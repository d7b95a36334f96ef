//! Which pairs of nodes share an element: the sparsity pattern of every block matrix on the mesh.

use std::ops::Range;
use std::sync::Arc;

/// The sparsity pattern of a block matrix. Cloning shares it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pattern {
    /// Row starts in `column`, one more than there are block rows.
    pub row_start: Arc<[u32]>,
    /// Block column of each entry, increasing within a row.
    pub column: Arc<[u32]>,
    /// Position in `column` of each row's diagonal block.
    pub diagonal: Arc<[u32]>,
}

impl Pattern {
    /// The pattern of a mesh of hex8 elements on `node_count` nodes: nodes are coupled if they
    /// share an element; every node is coupled with itself. `elements` name nodes below
    /// `node_count`; others are left out.
    pub fn from_elements(node_count: usize, elements: &[[u32; 8]]) -> Self {
        let known = |node: &u32| (*node as usize) < node_count;
        let mut start = vec![0u32; node_count + 1];
        for &node in elements.iter().flatten().filter(|node| known(node)) {
            start[node as usize + 1] += 1;
        }
        for i in 0..node_count {
            start[i + 1] += start[i];
        }
        let mut next = start.clone();
        let mut around = vec![0u32; start[node_count] as usize];
        for (e, element) in elements.iter().enumerate() {
            for &node in element.iter().filter(|node| known(node)) {
                around[next[node as usize] as usize] = e as u32;
                next[node as usize] += 1;
            }
        }
        let mut row = Vec::with_capacity(256);
        let rows = (0..node_count).map(|i| {
            row.clear();
            row.push(i as u32);
            for &e in &around[start[i] as usize..start[i + 1] as usize] {
                row.extend(elements[e as usize].iter().copied().filter(|node| known(node)));
            }
            row.sort_unstable();
            row.dedup();
            row.clone()
        });
        Self::from_rows(rows)
    }

    /// A pattern from the columns of each row. They must be increasing, and the diagonal is added
    /// where it is missing.
    pub fn from_rows(rows: impl Iterator<Item = Vec<u32>>) -> Self {
        let (mut row_start, mut column, mut diagonal) = (vec![0u32], Vec::new(), Vec::new());
        for (i, mut row) in rows.enumerate() {
            let at = row.binary_search(&(i as u32)).unwrap_or_else(|at| {
                row.insert(at, i as u32);
                at
            });
            diagonal.push((column.len() + at) as u32);
            column.append(&mut row);
            row_start.push(column.len() as u32);
        }
        Self { row_start: row_start.into(), column: column.into(), diagonal: diagonal.into() }
    }

    /// Number of block rows (nodes).
    pub fn rows(&self) -> usize {
        self.diagonal.len()
    }

    /// Number of blocks.
    pub fn entries(&self) -> usize {
        self.column.len()
    }

    /// Positions of row `i`'s entries.
    #[inline(always)]
    pub fn row(&self, i: usize) -> Range<usize> {
        self.row_start[i] as usize..self.row_start[i + 1] as usize
    }

    /// Position of the entry (`row`, `column`), if there is one.
    pub fn position(&self, row: usize, column: usize) -> Option<usize> {
        let range = self.row(row);
        self.column[range.clone()].binary_search(&(column as u32)).ok().map(|at| range.start + at)
    }
}
