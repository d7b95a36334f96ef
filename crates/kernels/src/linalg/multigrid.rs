//! The geometric multigrid hierarchy: Galerkin coarse matrices on prolongations that stay fixed for
//! a whole run, a V-cycle in f32.

use std::sync::atomic::{AtomicUsize, Ordering};

use super::bsr::{BlockMatrix, Pattern};
use super::chebyshev::{LOW, Smoother};
use super::fixed::Fixed;
use super::galerkin::{Transfer, mask};
use super::kernel::{Node, row_times};
use super::outcome::{LinalgError, size};
use super::parallel::{each, each_row};
use super::ties::Ties;
use crate::lanes::array;
use crate::mesh::Prolongation;
use crate::real::Real;

/// Degree of the smoothing polynomial on either side of the coarse correction. Half and twice of
/// this and of the numbers below: `benches/constants`.
pub(super) const DEGREE: usize = 3;
/// The coarsest level is solved by a polynomial that damps its whole spectrum: on the sphere's
/// coarsest levels (80 to 300 nodes) iteration counts are those of an exact solution (2.27 to 2.26
/// at 4 elements per contact radius, 2.80 to 2.80 at 8, 3.21 to 3.22 at 16). A dense LU would cost
/// a third of the update at 4 elements, and its pivoting does not fit a device.
pub(super) const COARSEST_DEGREE: usize = 24;
pub(super) const COARSEST_LOW: f32 = 0.03;

#[derive(Clone, Debug)]
struct GridLevel {
    smoother: Smoother,
    /// To the next coarser level; none on the coarsest.
    transfer: Option<Transfer>,
    /// Rows of the matrix that the last update changed.
    changed: Vec<bool>,
    b: Vec<Node>,
    x: Vec<Node>,
    r: Vec<Node>,
}

/// What a level holds. Vectors have three components a node and a fourth number that is 0.
#[derive(Clone, Copy, Debug)]
pub struct LevelView<'a> {
    /// Its matrix; on the finest level with the rows and columns of fixed unknowns replaced by
    /// those of the identity.
    pub matrix: &'a BlockMatrix<f32>,
    /// Inverses of its diagonal blocks, by columns.
    pub inverse: &'a [[[f32; 4]; 3]],
    /// Right-hand side of the last V-cycle.
    pub b: &'a [[f32; 4]],
    /// What it left.
    pub x: &'a [[f32; 4]],
}

/// A multigrid preconditioner for one sparsity pattern and one chain of prolongations.
#[derive(Clone, Debug)]
pub struct Hierarchy {
    levels: Vec<GridLevel>,
    fixed: Fixed,
    /// The mask of the update before.
    fixed_before: Fixed,
    /// Whether all levels are those of the last matrix, so that rows that are as they were need no
    /// work.
    complete: bool,
}

impl Hierarchy {
    /// Plans a hierarchy: coarse patterns and gather plans. `prolongations` is finest first and
    /// fits the pattern and itself.
    ///
    /// # Errors
    /// [`LinalgError::Hierarchy`] if it does not fit.
    pub fn new(pattern: &Pattern, prolongations: &[Prolongation]) -> Result<Self, LinalgError> {
        check(pattern.rows(), prolongations)?;
        let mut levels = Vec::with_capacity(prolongations.len() + 1);
        let mut fine = pattern.clone();
        for prolongation in prolongations {
            let (transfer, coarse) = Transfer::new(&fine, prolongation);
            let smoother = Smoother::new(std::mem::replace(&mut fine, coarse), DEGREE, LOW);
            levels.push(GridLevel::new(smoother, Some(transfer)));
        }
        levels.push(GridLevel::new(Smoother::new(fine, COARSEST_DEGREE, COARSEST_LOW), None));
        Ok(Self { levels, fixed: Fixed::default(), fixed_before: Fixed::default(), complete: false })
    }

    /// The same where nodes of the finest level are tied to each other, as their interpolations
    /// from tied nodes of the next level are. `prolongations` are those it was made of.
    pub fn with_ties(mut self, ties: Ties, prolongations: &[Prolongation]) -> Self {
        let all = std::iter::successors(Some((ties, prolongations)), |(ties, rest)| {
            let (first, rest) = rest.split_first()?;
            Some((ties.coarser(first), rest))
        });
        self.levels.iter_mut().zip(all).for_each(|(level, (ties, _))| level.smoother.ties = ties);
        self
    }

    /// The same with smoothers that round their blocks to bf16, as those of a device do, which
    /// reads them in half the time. On the CPU that saves nothing: it is for comparisons.
    pub fn with_rounded_smoothers(mut self) -> Self {
        self.levels.iter_mut().for_each(|level| level.smoother.round());
        self
    }

    /// Takes over a new matrix (on the pattern given to [`Hierarchy::new`]) in which `fixed`
    /// unknowns (one flag an unknown) are eliminated: their rows and columns count as those of the
    /// identity, and contribute nothing to coarser levels.
    ///
    /// # Errors
    /// [`LinalgError::Size`]; [`LinalgError::NotFinite`] names the first node in whose row there is
    /// a number that is not finite in f32.
    pub fn update<T: Real>(&mut self, matrix: &BlockMatrix<T>, fixed: &[bool]) -> Result<(), LinalgError> {
        let finest = &self.levels[0].smoother.matrix;
        size("the matrix", matrix.blocks.len(), finest.blocks.len())?;
        size("the mask of fixed unknowns", fixed.len(), finest.unknowns())?;
        std::mem::swap(&mut self.fixed, &mut self.fixed_before);
        self.fixed.set(fixed);
        let as_it_was = std::mem::replace(&mut self.complete, false);
        self.take(matrix, as_it_was)?;
        for l in 0..self.levels.len() {
            let (fine, coarse) = self.levels.split_at_mut(l + 1);
            let level = &mut fine[l];
            if let (Some(transfer), Some(coarse)) = (&mut level.transfer, coarse.first_mut()) {
                let identity = |i: usize| if l == 0 { self.fixed.node(i) } else { 0 };
                let coarse = (&mut coarse.smoother.matrix, coarse.changed.as_mut_slice());
                transfer.update((&level.smoother.matrix, &level.changed), identity, coarse);
            }
            level.smoother.update(&level.changed);
        }
        self.complete = true;
        Ok(())
    }

    /// Copies the matrix to the finest level, rows and columns of fixed unknowns replaced, and
    /// notes the rows that are not `as_it_was`.
    fn take<T: Real>(&mut self, matrix: &BlockMatrix<T>, as_it_was: bool) -> Result<(), LinalgError> {
        let (fixed, before) = (&self.fixed, &self.fixed_before);
        let GridLevel { smoother, changed, .. } = &mut self.levels[0];
        let BlockMatrix { pattern, blocks } = &mut smoother.matrix;
        let not_finite = AtomicUsize::new(usize::MAX);
        each_row(blocks, &pattern.row_start, changed, |i, row, changed| {
            let range = pattern.row(i);
            let rows = fixed.node(i);
            let columns = &pattern.column[range.clone()];
            // A finite number times 0 is 0, all others give NaN.
            let mut check = [0.0; 9];
            *changed = !as_it_was || before.node(i) != rows;
            for ((block, a), &j) in row.iter_mut().zip(&matrix.blocks[range.clone()]).zip(columns) {
                let mut new: [f32; 9] = array(0.0, |m| a[m].to_f64() as f32);
                if rows != 0 {
                    mask(&mut new, rows, 0);
                }
                for m in 0..9 {
                    check[m] += new[m] * 0.0;
                }
                let columns = fixed.node(j as usize);
                if columns != 0 {
                    mask(&mut new, 0, columns);
                }
                if rows != 0 && i == j as usize {
                    (0..3).filter(|c| rows >> c & 1 != 0).for_each(|c| new[4 * c] = 1.0);
                }
                *changed |= !(0..9).fold(true, |same, m| same & (block[m].to_bits() == new[m].to_bits()));
                *block = new;
            }
            if check.iter().any(|x| x.is_nan()) {
                not_finite.fetch_min(i, Ordering::Relaxed);
            }
        });
        match not_finite.into_inner() {
            usize::MAX => Ok(()),
            node => Err(LinalgError::NotFinite { place: "the matrix", node }),
        }
    }

    /// What an update and a V-cycle left on a level, the finest being 0: for comparisons with a
    /// device. None beyond the coarsest.
    pub fn on_level(&self, l: usize) -> Option<LevelView<'_>> {
        let level = self.levels.get(l)?;
        let (matrix, inverse) = (&level.smoother.matrix, level.smoother.inverse());
        Some(LevelView { matrix, inverse, b: &level.b, x: &level.x })
    }

    /// Gives a level's matrix other numbers after an update; its smoother follows, coarser levels
    /// do not. For comparisons with a device whose sums round otherwise.
    pub fn alter_level(&mut self, l: usize, alter: impl FnOnce(&mut BlockMatrix<f32>)) {
        let level = &mut self.levels[l];
        alter(&mut level.smoother.matrix);
        level.smoother.update(&vec![true; level.changed.len()]);
    }

    /// z = one V-cycle's approximation of A^-1 v from zero. `v` must be zero at fixed unknowns; so
    /// is `z`.
    pub fn v_cycle<T: Real>(&mut self, v: &[T], z: &mut [f32]) {
        let v = v.as_chunks::<3>().0;
        each(&mut self.levels[0].b, |i, b| *b = [v[i][0].to_f64() as f32, v[i][1].to_f64() as f32, v[i][2].to_f64() as f32, 0.0]);
        self.cycle();
        let x = &self.levels[0].x;
        each(z.as_chunks_mut::<3>().0, |i, z| *z = [x[i][0], x[i][1], x[i][2]]);
    }

    /// As [`Hierarchy::v_cycle`], and w = A z in f32.
    pub(super) fn v_cycle_and_product(&mut self, v: &[f32], z: &mut [f32], w: &mut [f32]) {
        self.v_cycle(v, z);
        let (matrix, x) = (&self.levels[0].smoother.matrix, &self.levels[0].x);
        each(w.as_chunks_mut::<3>().0, |i, w| {
            let y = row_times(matrix, i, x).to_array();
            *w = [y[0], y[1], y[2]];
        });
    }

    /// One V-cycle on the finest level's b; leaves its solution in x.
    fn cycle(&mut self) {
        let last = self.levels.len() - 1;
        for l in 0..last {
            let (fine, coarse) = self.levels.split_at_mut(l + 1);
            let level = &mut fine[l];
            level.smoother.smooth_from_zero(&level.b, &mut level.x);
            level.smoother.residual(&level.b, &level.x, &mut level.r);
            if let Some(transfer) = &level.transfer {
                transfer.restrict(&level.r, &mut coarse[0].b);
            }
        }
        let coarsest = &mut self.levels[last];
        coarsest.smoother.smooth_from_zero(&coarsest.b, &mut coarsest.x);
        for l in (0..last).rev() {
            let (fine, coarse) = self.levels.split_at_mut(l + 1);
            let level = &mut fine[l];
            if let Some(transfer) = &level.transfer {
                transfer.prolong_add(&coarse[0].x, &mut level.x);
            }
            if l == 0 {
                self.fixed.clear_nodes(&mut level.x);
            }
            level.smoother.smooth(&level.b, &mut level.x);
        }
    }
}

impl GridLevel {
    fn new(smoother: Smoother, transfer: Option<Transfer>) -> Self {
        let zero = vec![[0.0; 4]; smoother.matrix.rows()];
        let changed = vec![true; zero.len()];
        Self { smoother, transfer, changed, b: zero.clone(), x: zero.clone(), r: zero }
    }
}

pub(super) fn check(mut rows: usize, prolongations: &[Prolongation]) -> Result<(), LinalgError> {
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
