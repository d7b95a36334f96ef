//! The hierarchy as a device stores it: block rows of one width, one after the other across nodes,
//! and for each block of a product the list of what it sums.

use super::LinalgError;
use super::bsr::Pattern;
use super::chebyshev::{HIGH, LOW, shares};
use super::galerkin::{Transfer, Weights};
use super::multigrid::{COARSEST_DEGREE, COARSEST_LOW, DEGREE, check};
use crate::mesh::Prolongation;

/// Stands for no block, or no column.
pub const NOWHERE: u32 = u32::MAX;

/// Lists of weighted blocks, one a block of a product.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Lists {
    /// Starts of the lists, one more than there are blocks.
    pub start: Vec<u32>,
    /// Index of a block of the factor.
    pub entry: Vec<u32>,
    /// Its weight.
    pub weight: Vec<f32>,
}

/// A scalar sparse matrix by rows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SparseRows {
    /// Starts of the rows.
    pub start: Vec<u32>,
    /// Columns.
    pub column: Vec<u32>,
    /// Weights.
    pub weight: Vec<f32>,
}

/// A level's matrix: block k of the row of a node is at `k nodes + node`.
#[derive(Clone, Debug, PartialEq)]
pub struct LevelLayout {
    /// Nodes.
    pub nodes: usize,
    /// Room for blocks in a row, an even number: two share a word. Rows with fewer end in zeros.
    pub width: usize,
    /// Column node of each block; where there is none, the row's own if its pair has one, and else
    /// [`NOWHERE`], which ends the row.
    pub column: Vec<u32>,
    /// Index in the pattern of each block, or [`NOWHERE`].
    pub source: Vec<u32>,
    /// k of each node's diagonal block.
    pub diagonal: Vec<u32>,
    /// To the next level.
    pub transfer: Option<TransferLayout>,
}

/// What leads from a level to the next.
#[derive(Clone, Debug, PartialEq)]
pub struct TransferLayout {
    /// Blocks of A P: which blocks of A they sum.
    pub product: Lists,
    /// Blocks of the next level's matrix: which blocks of A P they sum.
    pub coarse: Lists,
    /// P, by fine nodes.
    pub prolongation: SparseRows,
    /// P^T, by coarse nodes.
    pub restriction: SparseRows,
}

/// The layout of a whole hierarchy, finest first.
#[derive(Clone, Debug, PartialEq)]
pub struct HierarchyLayout {
    /// The levels.
    pub levels: Vec<LevelLayout>,
    /// Shares of the last step and of D^-1 r in each step of the smoother.
    pub smoother: Vec<[f32; 2]>,
    /// The same of the coarsest level's polynomial.
    pub coarsest: Vec<[f32; 2]>,
}

impl HierarchyLayout {
    /// The layout of the hierarchy that [`super::Hierarchy::new`] makes of the same arguments.
    ///
    /// # Errors
    /// [`LinalgError::Hierarchy`] if the prolongations do not fit the pattern and each other.
    pub fn new(pattern: &Pattern, prolongations: &[Prolongation]) -> Result<Self, LinalgError> {
        check(pattern.rows(), prolongations)?;
        let mut levels: Vec<LevelLayout> = Vec::with_capacity(prolongations.len() + 1);
        let mut fine = pattern.clone();
        for prolongation in prolongations {
            let (transfer, coarse) = Transfer::new(&fine, prolongation);
            let mut level = LevelLayout::new(&fine);
            level.transfer = Some(TransferLayout::new(&transfer, &fine, &coarse));
            levels.push(level);
            fine = coarse;
        }
        levels.push(LevelLayout::new(&fine));
        let all = |degree, low| shares(HIGH, low).take(degree).collect();
        Ok(Self { levels, smoother: all(DEGREE, LOW), coarsest: all(COARSEST_DEGREE, COARSEST_LOW) })
    }
}

impl LevelLayout {
    fn new(pattern: &Pattern) -> Self {
        let nodes = pattern.rows();
        let width = width(pattern);
        let mut column = vec![NOWHERE; width * nodes];
        let mut source = vec![NOWHERE; width * nodes];
        for i in 0..nodes {
            for (k, at) in pattern.row(i).enumerate() {
                column[k * nodes + i] = pattern.column[at];
                source[k * nodes + i] = at as u32;
            }
            let blocks = pattern.row(i).len();
            if blocks % 2 == 1 {
                column[blocks * nodes + i] = i as u32;
            }
        }
        let diagonal = (0..nodes).map(|i| pattern.diagonal[i] - pattern.row_start[i]).collect();
        Self { nodes, width, column, source, diagonal, transfer: None }
    }

    /// Blocks of the level, those that are missing included.
    pub fn blocks(&self) -> usize {
        self.width * self.nodes
    }
}

impl TransferLayout {
    fn new(transfer: &Transfer, fine: &Pattern, coarse: &Pattern) -> Self {
        let (nodes, coarse_nodes) = (fine.rows(), coarse.rows());
        let (p, r) = (&transfer.prolongation, &transfer.restriction);
        let start = &transfer.product_start;
        let mut product: Vec<Vec<(u32, f32)>> = vec![Vec::new(); start[nodes] as usize];
        for i in 0..nodes {
            let mut places = transfer.fine_place[transfer.fine_start[i] as usize..].iter();
            for (k, at) in fine.row(i).enumerate() {
                for ((_, w), &place) in p.row(fine.column[at] as usize).zip(&mut places) {
                    product[start[i] as usize + place as usize].push(((k * nodes + i) as u32, w));
                }
            }
        }
        let mut blocks: Vec<Vec<(u32, f32)>> = vec![Vec::new(); width(coarse) * coarse_nodes];
        for i in 0..coarse_nodes {
            let mut places = transfer.coarse_place[transfer.coarse_start[i] as usize..].iter();
            for (k, w) in r.row(i) {
                for (entry, &place) in (start[k]..start[k + 1]).zip(&mut places) {
                    blocks[place as usize * coarse_nodes + i].push((entry, w));
                }
            }
        }
        Self { product: Lists::new(&product), coarse: Lists::new(&blocks), prolongation: rows(p), restriction: rows(r) }
    }
}

impl Lists {
    fn new(lists: &[Vec<(u32, f32)>]) -> Self {
        let mut out = Self { start: vec![0], entry: Vec::new(), weight: Vec::new() };
        for list in lists {
            out.entry.extend(list.iter().map(|(entry, _)| *entry));
            out.weight.extend(list.iter().map(|(_, weight)| *weight));
            out.start.push(out.entry.len() as u32);
        }
        out
    }
}

/// Blocks of the longest row, or one more.
fn width(pattern: &Pattern) -> usize {
    (0..pattern.rows()).map(|i| pattern.row(i).len()).max().unwrap_or(0).next_multiple_of(2)
}

fn rows(weights: &Weights) -> SparseRows {
    SparseRows { start: weights.start.clone(), column: weights.column.clone(), weight: weights.weight.clone() }
}
