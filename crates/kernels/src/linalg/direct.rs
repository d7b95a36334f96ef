//! Multifrontal sparse LU (Duff and Reid, ACM Trans. Math. Softw. 9, 1983) on a nested dissection,
//! dense kernels by faer: the reference that the multigrid solver is tested against, and its
//! fallback.
//!
//! Pivots are sought within a front's own unknowns, so the order and the memory are known before;
//! what that costs in accuracy is made good by iterative refinement.

use std::sync::Arc;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::factor::{lu_in_place, lu_in_place_scratch};
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{
    solve_lower_triangular_in_place, solve_unit_lower_triangular_in_place, solve_upper_triangular_in_place,
};
use faer::{Accum, Mat, MatMut, Par};

use super::bsr::{BlockMatrix, Pattern, Widen};
use super::dissection::{Dissection, Separator};
use super::fixed::Fixed;
use super::outcome::{LinalgError, SolveReport};
use super::vector::norm;
use crate::real::Real;

/// Memory the factors may take by default, in bytes.
pub const DEFAULT_MEMORY_LIMIT: usize = 8 << 30;

/// Refinement stops below the first relative residual, and a solution with less than the second
/// counts as one.
const ROUNDING: f64 = 1e-14;
const ACCEPTED: f64 = 1e-8;
const MAX_REFINEMENTS: usize = 5;

/// Parts whose fronts are at least this large are worth factorising beside each other.
const PARALLEL_FRONT: usize = 200;

/// A sparse LU factorisation in f64. The order is made once for a pattern, at the first use; the
/// factors are the same bits at any thread count.
#[derive(Debug)]
pub struct DirectSolver {
    /// Memory in bytes that a factorisation may take before an update refuses.
    pub memory_limit: usize,
    pattern: Pattern,
    dissection: Option<Arc<Dissection>>,
    fronts: Vec<Front>,
}

/// The factors of one part: its own unknowns' LU, the rows of U beside it and the columns of L
/// below it.
#[derive(Clone, Debug)]
struct Front {
    lu: Mat<f64>,
    /// Row of the part taken as each pivot.
    pivots: Vec<usize>,
    upper: Mat<f64>,
    lower: Mat<f64>,
}

impl Front {
    fn empty() -> Self {
        Self { lu: Mat::new(), pivots: Vec::new(), upper: Mat::new(), lower: Mat::new() }
    }
}

impl DirectSolver {
    /// A solver for matrices on `pattern`. Nothing expensive happens before the first use.
    pub fn new(pattern: &Pattern) -> Self {
        Self { memory_limit: DEFAULT_MEMORY_LIMIT, pattern: pattern.clone(), dissection: None, fronts: Vec::new() }
    }

    fn dissection(&mut self) -> Arc<Dissection> {
        self.dissection.get_or_insert_with(|| Arc::new(Dissection::new(&self.pattern))).clone()
    }

    /// Memory that a factorisation takes at its peak, bytes: the factors and the largest stack of
    /// fronts waiting for their parents (of a factorisation on one thread).
    pub fn memory(&mut self) -> usize {
        let dissection = self.dissection();
        let (mut factors, mut waiting, mut peak) = (0, 0, 0);
        for part in &dissection.parts {
            let (own, boundary) = (3 * part.own.len(), 3 * part.boundary.len());
            // The front itself is there together with its children's.
            peak = peak.max(factors + waiting + (own + boundary) * (own + boundary));
            factors += own * (own + 2 * boundary);
            let children: usize = part.children.iter().map(|&c| (3 * dissection.parts[c].boundary.len()).pow(2)).sum();
            waiting = waiting + boundary * boundary - children;
        }
        8 * peak.max(factors)
    }

    /// Factorises the matrix with its fixed unknowns eliminated.
    pub(super) fn update<T: Real>(&mut self, matrix: &BlockMatrix<T>, fixed: &Fixed) -> Result<(), LinalgError> {
        self.fronts.clear();
        let need = self.memory();
        if need > self.memory_limit {
            return Err(LinalgError::TooLarge { unknowns: matrix.unknowns(), need, limit: self.memory_limit });
        }
        for i in (0..matrix.rows()).filter(|&i| fixed.node(i) != 7) {
            if matrix.blocks[matrix.pattern.row(i)].as_flattened().iter().any(|a| !a.to_f64().is_finite()) {
                return Err(LinalgError::NotFinite { place: "the matrix", node: i });
            }
        }
        let dissection = self.dissection();
        let mut fronts = vec![Front::empty(); dissection.parts.len()];
        if let Some(root) = dissection.parts.len().checked_sub(1) {
            Job { dissection: &dissection, matrix, fixed }.factorise(root, &mut fronts)?;
        }
        self.fronts = fronts;
        Ok(())
    }

    /// x = A^-1 b for the reduced system, refined until the residual is at rounding or no longer
    /// halves.
    pub(super) fn solve<T: Real + Widen<f64>>(
        &self,
        matrix: &BlockMatrix<T>,
        fixed: &Fixed,
        b: &[f64],
        x: &mut [f64],
    ) -> Result<SolveReport, LinalgError> {
        let scale = norm(b);
        let mut report = SolveReport { converged: true, ..SolveReport::default() };
        x.fill(0.0);
        if scale == 0.0 {
            return Ok(report);
        }
        let (mut r, mut best) = (b.to_vec(), x.to_vec());
        report.residual = 1.0;
        for _ in 0..MAX_REFINEMENTS {
            self.solve_in_place(&mut r)?;
            best.iter_mut().zip(&r).for_each(|(x, d)| *x += d);
            matrix.residual(&best, b, &mut r);
            fixed.clear(&mut r);
            let residual = norm(&r) / scale;
            if residual >= report.residual || residual.is_nan() {
                break;
            }
            x.copy_from_slice(&best);
            let enough = residual < ROUNDING || residual > 0.5 * report.residual;
            report.residual = residual;
            if enough {
                break;
            }
        }
        report.converged = report.residual < ACCEPTED;
        Ok(report)
    }

    /// x = A^-1 x for the reduced system, without refinement.
    pub(super) fn solve_in_place(&self, x: &mut [f64]) -> Result<(), LinalgError> {
        let Some(dissection) = self.dissection.as_ref().filter(|d| d.parts.len() == self.fronts.len()) else {
            return Err(LinalgError::NotUpdated);
        };
        let mut y: Vec<[f64; 3]> = dissection.order.iter().map(|&node| x.as_chunks::<3>().0[node as usize]).collect();
        let (mut own, mut beside) = (Vec::new(), Vec::new());
        let mut fronts = dissection.parts.iter().zip(&self.fronts).filter(|(part, _)| !part.own.is_empty());
        for (part, front) in fronts.clone() {
            let flat = y[part.own.clone()].as_flattened();
            own.clear();
            own.extend(front.pivots.iter().map(|&p| flat[p]));
            solve_unit_lower_triangular_in_place(front.lu.as_ref(), column(&mut own), Par::Seq);
            y[part.own.clone()].as_flattened_mut().copy_from_slice(&own);
            beside.clear();
            beside.resize(3 * part.boundary.len(), 0.0);
            matmul(column(&mut beside), Accum::Replace, front.lower.as_ref(), column(&mut own).as_ref(), 1.0, Par::Seq);
            for (&j, below) in part.boundary.iter().zip(beside.as_chunks::<3>().0) {
                (0..3).for_each(|c| y[j as usize][c] -= below[c]);
            }
        }
        while let Some((part, front)) = fronts.next_back() {
            beside.clear();
            beside.extend(part.boundary.iter().flat_map(|&j| y[j as usize]));
            let own = y[part.own.clone()].as_flattened_mut();
            matmul(column(own), Accum::Add, front.upper.as_ref(), column(&mut beside).as_ref(), -1.0, Par::Seq);
            solve_upper_triangular_in_place(front.lu.as_ref(), column(own), Par::Seq);
        }
        for (&node, y) in dissection.order.iter().zip(&y) {
            x.as_chunks_mut::<3>().0[node as usize] = *y;
        }
        match x.iter().position(|x| !x.is_finite()) {
            Some(at) => Err(LinalgError::Singular { node: at / 3 }),
            None => Ok(()),
        }
    }
}

pub(super) fn column(x: &mut [f64]) -> MatMut<'_, f64> {
    let n = x.len();
    MatMut::from_column_major_slice_mut(x, n, 1)
}

/// A factorisation under way.
struct Job<'a, T> {
    dissection: &'a Dissection,
    matrix: &'a BlockMatrix<T>,
    fixed: &'a Fixed,
}

impl<T: Real> Job<'_, T> {
    /// Factorises the subtree of a part, whose fronts (and no others) are `fronts`. Returns what it
    /// leaves over for the boundary.
    fn factorise(&self, part: usize, fronts: &mut [Front]) -> Result<Mat<f64>, LinalgError> {
        let parts = &self.dissection.parts;
        let this = &parts[part];
        let Some((front, below)) = fronts.split_last_mut() else { return Ok(Mat::new()) };
        let left_over: Vec<(usize, Mat<f64>)> = match this.children[..] {
            [a, b] => {
                let (fronts_a, fronts_b) = below.split_at_mut(parts[b].first - this.first);
                let large = |p: usize| parts[p].own.len() + parts[p].boundary.len() >= PARALLEL_FRONT;
                let (x, y) = if rayon::current_num_threads() > 1 && large(a) && large(b) {
                    rayon::join(|| self.factorise(a, fronts_a), || self.factorise(b, fronts_b))
                } else {
                    (self.factorise(a, fronts_a), self.factorise(b, fronts_b))
                };
                vec![(a, x?), (b, y?)]
            }
            _ => Vec::new(),
        };
        let (own, boundary) = (3 * this.own.len(), 3 * this.boundary.len());
        let mut f = Mat::<f64>::zeros(own + boundary, own + boundary);
        self.assemble(this, &mut f);
        for (child, rest) in left_over {
            extend_add(this, &parts[child].boundary, &rest, &mut f);
        }
        let node = self.dissection.order.get(this.own.start).map_or(0, |&node| node as usize);
        *front = eliminate(&mut f, own).ok_or(LinalgError::Singular { node })?;
        Ok(f.submatrix(own, own, boundary, boundary).to_owned())
    }

    /// Adds the matrix's entries in the rows and columns of a part's own nodes.
    fn assemble(&self, part: &Separator, f: &mut Mat<f64>) {
        let Dissection { order, rank, .. } = self.dissection;
        for (k, &node) in order[part.own.clone()].iter().enumerate() {
            let i = node as usize;
            for at in self.matrix.pattern.row(i) {
                let j = self.matrix.pattern.column[at] as usize;
                let Some(l) = local(part, rank[j]) else { continue };
                self.add(f, [k, l], [i, j], at);
                if l >= part.own.len()
                    && let Some(at) = self.matrix.pattern.position(j, i)
                {
                    self.add(f, [l, k], [j, i], at);
                }
            }
        }
    }

    fn add(&self, f: &mut Mat<f64>, [k, l]: [usize; 2], [i, j]: [usize; 2], at: usize) {
        let (rows, columns) = (self.fixed.node(i), self.fixed.node(j));
        for (m, &a) in self.matrix.blocks[at].iter().enumerate() {
            let (r, c) = (m / 3, m % 3);
            let held = (rows >> r | columns >> c) & 1 != 0;
            f[(3 * k + r, 3 * l + c)] += if held { f64::from(u8::from(i == j && r == c)) } else { a.to_f64() };
        }
    }
}

/// Place of a node in a part's front, by its elimination number.
fn local(part: &Separator, rank: u32) -> Option<usize> {
    if part.own.contains(&(rank as usize)) {
        Some(rank as usize - part.own.start)
    } else {
        part.boundary.binary_search(&rank).ok().map(|k| part.own.len() + k)
    }
}

/// Adds to a part's front what a child, whose boundary is `ranks`, left over.
fn extend_add(part: &Separator, ranks: &[u32], rest: &Mat<f64>, f: &mut Mat<f64>) {
    // Every place is found: a child's boundary lies in its parent's front.
    let places: Vec<usize> = ranks.iter().filter_map(|&rank| local(part, rank)).collect();
    for (l, &to_l) in places.iter().enumerate() {
        for c in 0..3 {
            let to = f.col_as_slice_mut(3 * to_l + c).as_chunks_mut::<3>().0;
            let from = rest.col_as_slice(3 * l + c).as_chunks::<3>().0;
            for (from, &to_k) in from.iter().zip(&places) {
                (0..3).for_each(|r| to[to_k][r] += from[r]);
            }
        }
    }
}

/// LU with row pivoting in place, on the calling thread; returns the row taken as each pivot. None
/// if a pivot vanishes.
pub(super) fn factorise_dense(a: MatMut<'_, f64>) -> Option<Vec<usize>> {
    let n = a.nrows();
    let mut a = a;
    let (mut pivots, mut inverse) = (vec![0usize; n], vec![0usize; n]);
    if n > 0 {
        let mut memory = MemBuffer::try_new(lu_in_place_scratch::<usize, f64>(n, n, Par::Seq, Default::default())).ok()?;
        lu_in_place(a.as_mut(), &mut pivots, &mut inverse, Par::Seq, MemStack::new(&mut memory), Default::default());
    }
    (0..n).all(|k| a[(k, k)] != 0.0 && a[(k, k)].is_finite()).then_some(pivots)
}

/// Eliminates the first `own` unknowns of a front; none if a pivot vanishes.
fn eliminate(f: &mut Mat<f64>, own: usize) -> Option<Front> {
    let boundary = f.nrows() - own;
    if own == 0 {
        return Some(Front { upper: Mat::zeros(0, boundary), lower: Mat::zeros(boundary, 0), ..Front::empty() });
    }
    let mut lu = f.submatrix(0, 0, own, own).to_owned();
    let pivots = factorise_dense(lu.as_mut())?;
    let mut upper = Mat::from_fn(own, boundary, |i, j| f[(pivots[i], own + j)]);
    solve_unit_lower_triangular_in_place(lu.as_ref(), upper.as_mut(), Par::Seq);
    let mut lower = f.submatrix(own, 0, boundary, own).to_owned();
    solve_lower_triangular_in_place(lu.as_ref().transpose(), lower.as_mut().transpose_mut(), Par::Seq);
    let rest = f.as_mut().submatrix_mut(own, own, boundary, boundary);
    matmul(rest, Accum::Add, lower.as_ref(), upper.as_ref(), -1.0, Par::Seq);
    Some(Front { lu, pivots, upper, lower })
}
