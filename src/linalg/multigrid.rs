//! The geometric multigrid hierarchy: Galerkin coarse matrices on prolongations that stay fixed for a whole run, a V-cycle in f32.
//!
//! Rows are kept sorted by colour on every level (see [`Smoother::GaussSeidel`]); vectors that come and go are in the mesh's order.

use super::bsr::{BlockMatrix, Pattern, for_rows};
use super::coarsest::Dense;
use super::fixed::Fixed;
use super::galerkin::{Transfer, for_row_blocks};
use super::smoother::{Smoothed, Smoother, color_order};
use super::{LinalgError, size};
use crate::mesh::Prolongation;

/// Coarsest levels up to this many unknowns are solved by dense LU, larger ones by smoothing.
const DENSE_UNKNOWNS: usize = 1200;
/// Smoothing sweeps on a coarsest level too large for that.
const COARSEST_SWEEPS: usize = 10;

#[derive(Clone, Debug)]
struct Level {
    smoothed: Smoothed,
    /// To the next coarser level; none on the coarsest.
    transfer: Option<Transfer>,
    b: Vec<[f32; 3]>,
    x: Vec<[f32; 3]>,
    r: Vec<[f32; 3]>,
}

/// A multigrid preconditioner for one sparsity pattern and one chain of prolongations.
#[derive(Clone, Debug)]
pub struct Hierarchy {
    smoother: Smoother,
    levels: Vec<Level>,
    dense: Option<Dense>,
    /// Node of each row of the finest level.
    order: Vec<u32>,
    /// Block of the matrix given to [`Hierarchy::update`] behind each entry of the finest level.
    source: Vec<u32>,
    /// Fixed components of each row's node.
    fixed: Vec<u8>,
}

impl Hierarchy {
    /// Plans a hierarchy: coarse patterns, orders, gather plans. `prolongations` is finest first and fits the pattern and itself.
    ///
    /// # Errors
    /// [`LinalgError::Hierarchy`] if it does not fit.
    pub fn new(pattern: &Pattern, prolongations: &[Prolongation], smoother: Smoother) -> Result<Self, LinalgError> {
        check(pattern.rows(), prolongations)?;
        let order = color_order(pattern);
        let (mut fine, source) = permuted(pattern, &order);
        let mut levels = Vec::with_capacity(prolongations.len() + 1);
        let mut fine_order = order.clone();
        for prolongation in prolongations {
            let (transfer, coarse, coarse_order) = Transfer::new(&fine, &fine_order, prolongation, color_order);
            levels.push(Level::new(std::mem::replace(&mut fine, coarse), Some(transfer)));
            fine_order = coarse_order;
        }
        let dense = (3 * fine.rows() <= DENSE_UNKNOWNS).then(Dense::default);
        levels.push(Level::new(fine, None));
        let fixed = vec![0; order.len()];
        Ok(Self { smoother, levels, dense, order, source, fixed })
    }

    /// Nodes and blocks of each level, finest first.
    pub fn sizes(&self) -> Vec<[usize; 2]> {
        self.levels.iter().map(|level| [level.b.len(), level.smoothed.matrix.blocks.len()]).collect()
    }

    /// Takes over a new matrix (on the pattern given to [`Hierarchy::new`]) in which `fixed` unknowns are eliminated: their rows and
    /// columns count as those of the identity, and contribute nothing to coarser levels.
    ///
    /// # Errors
    /// [`LinalgError::Size`]; [`LinalgError::NotFinite`] names a node in whose row there is a number that is not finite in f32.
    pub fn update(&mut self, matrix: &BlockMatrix<f64>, fixed: &[bool]) -> Result<(), LinalgError> {
        let unknowns = 3 * self.order.len();
        size("the matrix's blocks", matrix.blocks.len(), self.source.len())?;
        size("the mask of fixed unknowns", fixed.len(), unknowns)?;
        let mut mask = Fixed::default();
        mask.set(fixed);
        self.update_masked(matrix, &mask)
    }

    pub(super) fn update_masked(&mut self, matrix: &BlockMatrix<f64>, fixed: &Fixed) -> Result<(), LinalgError> {
        for (bits, &node) in self.fixed.iter_mut().zip(&self.order) {
            *bits = fixed.node(node as usize);
        }
        let (masks, source) = (&self.fixed, &self.source);
        let finest = &mut self.levels[0].smoothed.matrix;
        let pattern = &finest.pattern;
        for_row_blocks(&mut finest.blocks, &pattern.row_start, |i, row| {
            for (block, at) in row.iter_mut().zip(pattern.row(i)) {
                *block = matrix.blocks[source[at] as usize].map(|a| a as f32);
                let masks = (masks[i], masks[pattern.column[at] as usize]);
                if masks != (0, 0) {
                    mask_block(block, masks.0, masks.1);
                    if at == pattern.diagonal[i] as usize {
                        (0..3).filter(|c| masks.0 >> c & 1 != 0).for_each(|c| block[4 * c] = 1.0);
                    }
                }
            }
        });
        // A finite number times 0 is 0, all others give NaN.
        let bad = |row: &[[f32; 9]]| row.as_flattened().iter().map(|a| a * 0.0).sum::<f32>().is_nan();
        if let Some(i) = (0..finest.rows()).find(|&i| bad(&finest.blocks[finest.pattern.row(i)])) {
            return Err(LinalgError::NotFinite { place: "the matrix", node: self.order[i] as usize });
        }
        for l in 0..self.levels.len() {
            let (fine, coarse) = self.levels.split_at_mut(l + 1);
            let level = &mut fine[l];
            let last = level.transfer.is_none();
            if let (Some(transfer), Some(coarse)) = (&mut level.transfer, coarse.first_mut()) {
                let matrix = &level.smoothed.matrix;
                let diagonal = |i: usize| {
                    let mask = if l == 0 { masks[i] } else { 0 };
                    (mask != 0).then(|| {
                        let mut block = matrix.blocks[matrix.pattern.diagonal[i] as usize];
                        mask_block(&mut block, mask, mask);
                        block
                    })
                };
                transfer.update(matrix, diagonal, &mut coarse.smoothed.matrix);
            }
            match &mut self.dense {
                Some(dense) if last => dense.update(&level.smoothed.matrix),
                _ => level.smoothed.update(self.smoother),
            }
        }
        Ok(())
    }

    /// z = one V-cycle's approximation of A^-1 v from zero, in the mesh's order. Zero at fixed unknowns if v is.
    pub fn v_cycle(&mut self, v: &[f64], z: &mut [f32]) {
        let v = v.as_chunks::<3>().0;
        let order = &self.order;
        for_rows(&mut self.levels[0].b, |i, b| *b = v[order[i] as usize].map(|v| v as f32));
        self.cycle();
        let z = z.as_chunks_mut::<3>().0;
        for (&node, x) in self.order.iter().zip(&self.levels[0].x) {
            z[node as usize] = *x;
        }
    }

    fn cycle(&mut self) {
        let last = self.levels.len() - 1;
        for l in 0..last {
            let (fine, coarse) = self.levels.split_at_mut(l + 1);
            let (level, coarse) = (&mut fine[l], &mut coarse[0]);
            level.smoothed.smooth_from_zero(self.smoother, &level.b, &mut level.x, &mut level.r);
            if let Some(transfer) = &level.transfer {
                transfer.restrict(&level.r, &mut coarse.b);
            }
        }
        let coarsest = &mut self.levels[last];
        match &mut self.dense {
            Some(dense) => dense.solve(&coarsest.b, &mut coarsest.x),
            None => {
                coarsest.smoothed.smooth_from_zero(self.smoother, &coarsest.b, &mut coarsest.x, &mut coarsest.r);
                (0..COARSEST_SWEEPS).for_each(|_| coarsest.smoothed.smooth(self.smoother, &coarsest.b, &mut coarsest.x));
            }
        }
        for l in (0..last).rev() {
            let (fine, coarse) = self.levels.split_at_mut(l + 1);
            let level = &mut fine[l];
            if let Some(transfer) = &level.transfer {
                transfer.prolong_add(&coarse[0].x, &mut level.x);
            }
            if l == 0 {
                for (x, &mask) in level.x.iter_mut().zip(&self.fixed).filter(|(_, mask)| **mask != 0) {
                    (0..3).filter(|c| mask >> c & 1 != 0).for_each(|c| x[c] = 0.0);
                }
            }
            level.smoothed.smooth(self.smoother, &level.b, &mut level.x);
        }
    }
}

impl Level {
    fn new(pattern: Pattern, transfer: Option<Transfer>) -> Self {
        let zero = vec![[0.0; 3]; pattern.rows()];
        Self { smoothed: Smoothed::new(pattern), transfer, b: zero.clone(), x: zero.clone(), r: zero }
    }
}

/// Zeroes the rows and columns whose bits are set.
fn mask_block(block: &mut [f32; 9], rows: u8, columns: u8) {
    for (m, a) in block.iter_mut().enumerate() {
        if (rows >> (m / 3) | columns >> (m % 3)) & 1 != 0 {
            *a = 0.0;
        }
    }
}

/// The pattern with rows and columns in another order, and the entry of the old one behind each of the new one.
fn permuted(pattern: &Pattern, order: &[u32]) -> (Pattern, Vec<u32>) {
    let mut rank = vec![0u32; order.len()];
    for (i, &node) in order.iter().enumerate() {
        rank[node as usize] = i as u32;
    }
    let mut source = Vec::with_capacity(pattern.entries());
    let rows = order.iter().map(|&node| {
        let mut row: Vec<(u32, u32)> =
            pattern.row(node as usize).map(|at| (rank[pattern.column[at] as usize], at as u32)).collect();
        row.sort_unstable();
        source.extend(row.iter().map(|&(_, at)| at));
        row.into_iter().map(|(j, _)| j).collect()
    });
    (Pattern::from_rows(rows), source)
}

fn check(mut rows: usize, prolongations: &[Prolongation]) -> Result<(), LinalgError> {
    for (level, p) in prolongations.iter().enumerate() {
        let fits = p.row_start.len() == rows + 1
            && p.row_start.first() == Some(&0)
            && p.row_start.is_sorted()
            && p.row_start.last().is_some_and(|&end| end as usize == p.column.len())
            && p.column.len() == p.weight.len()
            && p.column.iter().all(|&j| (j as usize) < p.coarse_nodes);
        if !fits {
            return Err(LinalgError::Hierarchy { level, rows });
        }
        rows = p.coarse_nodes;
    }
    Ok(())
}
