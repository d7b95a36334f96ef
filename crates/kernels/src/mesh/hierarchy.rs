//! Logical blocks of cells and the multigrid hierarchy on them.
//!
//! A mesh is made of blocks, each a box of cells in three logical indices. Every index belongs to a
//! class (x, y, r, d), shared by the blocks that touch, so that coarsening class by class ("every
//! second index and the last") keeps the blocks conforming. Levels need no exact nesting:
//! interpolation is trilinear in index space and injects at the coarse nodes.

/// No level is made below this number of nodes: the smoother alone solves it. Half and twice of it:
/// `benches/constants`.
pub const COARSEST_NODES: usize = 300;

/// Sparse interpolation from a coarse level's nodes to a fine level's nodes, in rows of (coarse
/// node, weight); the weights of a row sum to 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Prolongation {
    /// Number of coarse nodes (columns).
    pub coarse_nodes: usize,
    /// Row starts, one more than there are fine nodes.
    pub row_start: Vec<u32>,
    /// Coarse node of each entry, increasing within a row.
    pub column: Vec<u32>,
    /// Weight of each entry.
    pub weight: Vec<f64>,
}

/// A node by its block and its logical indices; nodes on a block's boundary have a name in each
/// block that shares them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Site {
    /// Number of the block.
    pub block: usize,
    /// Logical indices in the block.
    pub at: [usize; 3],
}

/// An index of a fine level in terms of the coarse one: it lies between `low` and `high`, at the
/// share `toward_high` of the way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Between {
    /// Coarse index at or below.
    pub low: usize,
    /// Coarse index at or above; equal to `low` where the fine index is kept.
    pub high: usize,
    /// Weight of `high`, 0 to 1.
    pub toward_high: f64,
}

/// Coarsening of one index class: the interpolation of each of its fine indices.
pub type ClassMap = Vec<Between>;

/// Blocks of cells over shared index classes.
pub trait Blocks: Sized {
    /// Cells along each index class.
    fn cells(&self) -> Vec<usize>;
    /// The same blocks with other numbers of cells.
    fn with_cells(&self, cells: &[usize]) -> Self;
    /// One site per node, in the order of the node numbers.
    fn sites(&self) -> Vec<Site>;
    /// Number of nodes.
    fn node_count(&self) -> usize;
    /// Node number of a site (of any of its names).
    fn number(&self, site: Site) -> u32;
    /// Where index `axis` of a site lies between indices of the `coarse` blocks, given the
    /// coarsening of each class.
    fn between(&self, coarse: &Self, site: Site, axis: usize, maps: &[ClassMap]) -> Between;
}

/// Cells left of `cells` when every second index and the last are kept.
pub fn coarse_cells(cells: usize) -> usize {
    cells.div_ceil(2)
}

/// Interpolation of the indices 0..=`cells` from every second of them and the last.
pub fn class_map(cells: usize) -> ClassMap {
    let kept: Vec<usize> = (0..=coarse_cells(cells)).map(|i| (2 * i).min(cells)).collect();
    (0..=cells)
        .map(|i| {
            let low = (i / 2).min(kept.len() - 1);
            if kept[low] == i {
                return Between { low, high: low, toward_high: 0.0 };
            }
            if kept.get(low + 1) == Some(&i) {
                return Between { low: low + 1, high: low + 1, toward_high: 0.0 };
            }
            let toward_high = (i - kept[low]) as f64 / (kept[low + 1] - kept[low]) as f64;
            Between { low, high: low + 1, toward_high }
        })
        .collect()
}

/// All interpolations of `blocks`, finest first, down to about [`COARSEST_NODES`] nodes or until
/// nothing coarsens any more.
pub fn hierarchy<B: Blocks>(blocks: B) -> Vec<Prolongation> {
    let mut levels = Vec::new();
    let mut fine = blocks;
    while fine.node_count() > COARSEST_NODES {
        let cells = fine.cells();
        let coarse = fine.with_cells(&cells.iter().map(|&n| coarse_cells(n)).collect::<Vec<_>>());
        if coarse.cells() == cells {
            break;
        }
        levels.push(prolongation(&fine, &coarse));
        fine = coarse;
    }
    levels
}

/// Trilinear interpolation in index space from the `coarse` blocks to the `fine` ones.
fn prolongation<B: Blocks>(fine: &B, coarse: &B) -> Prolongation {
    let maps: Vec<ClassMap> = fine.cells().iter().map(|&n| class_map(n)).collect();
    let mut p = Prolongation { coarse_nodes: coarse.node_count(), row_start: vec![0], column: Vec::new(), weight: Vec::new() };
    for site in fine.sites() {
        let along = [0, 1, 2].map(|axis| fine.between(coarse, site, axis, &maps));
        let mut row: Vec<(u32, f64)> = Vec::with_capacity(8);
        for corner in 0..8 {
            let mut weight = 1.0;
            let mut at = [0; 3];
            for axis in 0..3 {
                let high = corner >> axis & 1 == 1;
                at[axis] = if high { along[axis].high } else { along[axis].low };
                weight *= if high { along[axis].toward_high } else { 1.0 - along[axis].toward_high };
            }
            if weight > 0.0 {
                row.push((coarse.number(Site { block: site.block, at }), weight));
            }
        }
        row.sort_by_key(|&(column, _)| column);
        p.column.extend(row.iter().map(|&(column, _)| column));
        p.weight.extend(row.iter().map(|&(_, weight)| weight));
        p.row_start.push(p.column.len() as u32);
    }
    p
}
