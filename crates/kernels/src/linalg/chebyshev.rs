//! The smoother: a Chebyshev polynomial of block Jacobi.

use wide::f32x4;

use super::bsr::BlockMatrix;
use super::kernel::{Inverse, Node, inverse_times, invert, row_times};
use super::parallel::{each, each_of_two};
use super::ties::Ties;
use crate::mesh::pattern::Pattern;

/// The polynomial damps the eigenvalues of D^-1 A from a lower end to this.
///
/// 8 is a bound that needs no estimate: for the sum of positive semidefinite matrices of elements
/// with 8 nodes, D the block diagonal, x^T A x <= 8 x^T D x by Cauchy and Schwarz in each element
/// (Fried, J. Sound Vib. 20, 1972; Wathen, IMA J. Numer. Anal. 7, 1987). Measured on the sphere:
/// 5.4 elastic, 7.8 with a plastic core, 7.9 nearly incompressible; on coarse levels 4 to 5.6. An
/// estimate from below does harm: with 0.95 of the largest eigenvalue iterations double.
pub(super) const HIGH: f32 = 8.0;
/// The lower end on all levels but the coarsest. Iteration counts do not change by more than one
/// from 0.12 to 0.5.
pub(super) const LOW: f32 = 0.25;

/// A level's matrix, smoothed by Chebyshev acceleration of block Jacobi (Adams, Brezina, Hu and
/// Tuminaro, J. Comput. Phys. 188, 2003): an error is multiplied by a polynomial of D^-1 A that is
/// small on the upper part of its spectrum.
#[derive(Clone, Debug)]
pub(super) struct Smoother {
    pub matrix: BlockMatrix<f32>,
    degree: usize,
    /// Lower end of the eigenvalues that are damped.
    low: f32,
    /// The matrix that it smooths with where that is rounded.
    rounded: Option<BlockMatrix<f32>>,
    /// Nodes that are tied to each other.
    pub ties: Ties,
    /// Inverses of the diagonal blocks.
    inverse: Vec<Inverse>,
    /// Last step of the recurrence, and the next iterate.
    step: Vec<Node>,
    next: Vec<Node>,
}

impl Smoother {
    pub fn new(pattern: Pattern, degree: usize, low: f32) -> Self {
        let rows = pattern.rows();
        Self {
            matrix: BlockMatrix::zeros(pattern),
            degree: degree.max(1),
            low,
            rounded: None,
            ties: Ties::default(),
            inverse: vec![[[0.0; 4]; 3]; rows],
            step: vec![[0.0; 4]; rows],
            next: vec![[0.0; 4]; rows],
        }
    }

    /// Inverses of the diagonal blocks, by columns.
    pub fn inverse(&self) -> &[Inverse] {
        &self.inverse
    }

    /// Smooths with the rounded matrix from now on: see [`rounded`].
    pub fn round(&mut self) {
        self.rounded = Some(self.matrix.clone());
    }

    /// After rows of the matrix changed.
    pub fn update(&mut self, changed: &[bool]) {
        if let Some(to) = &mut self.rounded {
            round_rows(&self.matrix, to);
        }
        let (blocks, diagonal) = (&self.matrix.blocks, &self.matrix.pattern.diagonal);
        each(&mut self.inverse, |i, inverse| {
            if changed[i] {
                *inverse = invert(&blocks[diagonal[i] as usize]);
            }
        });
        self.ties.invert(&self.matrix, changed, &mut self.inverse);
    }

    /// x = the polynomial applied to b from x = 0.
    pub fn smooth_from_zero(&mut self, b: &[Node], x: &mut Vec<Node>) {
        self.smooth_with(b, x, true);
    }

    /// Smooths x towards A x = b.
    pub fn smooth(&mut self, b: &[Node], x: &mut Vec<Node>) {
        self.smooth_with(b, x, false);
    }

    /// r = b - A x.
    pub fn residual(&self, b: &[Node], x: &[Node], r: &mut [Node]) {
        let matrix = self.rounded.as_ref().unwrap_or(&self.matrix);
        each(r, |i, r| *r = (f32x4::new(b[i]) - row_times(matrix, i, x)).to_array());
    }

    /// The recurrence of Saad, Iterative Methods for Sparse Linear Systems, 2nd ed. (2003),
    /// Algorithm 12.1, for D^-1 A x = D^-1 b.
    fn smooth_with(&mut self, b: &[Node], x: &mut Vec<Node>, from_zero: bool) {
        let (matrix, inverse) = (self.rounded.as_ref().unwrap_or(&self.matrix), &self.inverse);
        let ties = &self.ties;
        for (k, [keep, add]) in shares(HIGH, self.low).take(self.degree).enumerate() {
            let (keep4, add4) = (f32x4::splat(keep), f32x4::splat(add));
            if k > 0 || !from_zero {
                let now: &[Node] = x;
                each_of_two(&mut self.step, &mut self.next, |i, d, next| {
                    let r = f32x4::new(b[i]) - row_times(matrix, i, now);
                    if ties.is_tied(i) {
                        *next = r.to_array();
                        return;
                    }
                    let mut step = add4 * inverse_times(&inverse[i], r);
                    if k > 0 {
                        step += keep4 * f32x4::new(*d);
                    }
                    *d = step.to_array();
                    *next = (f32x4::new(now[i]) + step).to_array();
                });
                let keep = if k > 0 { keep } else { 0.0 };
                ties.smooth(inverse, Some(now), [keep, add], (&mut self.step, &mut self.next));
                std::mem::swap(x, &mut self.next);
            } else {
                each_of_two(&mut self.step, x, |i, d, x| {
                    if ties.is_tied(i) {
                        *x = b[i];
                        return;
                    }
                    *d = (add4 * inverse_times(&inverse[i], f32x4::new(b[i]))).to_array();
                    *x = *d;
                });
                ties.smooth(inverse, None, [0.0, add], (&mut self.step, x));
            }
        }
    }
}

/// A number rounded to the upper half of its bits (bf16: 8 digits of the mantissa), away from 0 in
/// the middle.
fn rounded(x: f32) -> f32 {
    f32::from_bits(x.to_bits().wrapping_add(0x8000) & 0xffff_0000)
}

/// Rounds the blocks of a matrix, and adds what that takes from a row to its diagonal block: a
/// constant vector has the same product, and a smooth one nearly. Where material hardly changes its
/// volume, half as many Krylov iterations again were needed without.
fn round_rows(matrix: &BlockMatrix<f32>, to: &mut BlockMatrix<f32>) {
    for i in 0..matrix.rows() {
        let mut lost = [0.0; 9];
        for k in matrix.pattern.row(i) {
            let (whole, short) = (&matrix.blocks[k], &mut to.blocks[k]);
            *short = whole.map(rounded);
            for m in 0..9 {
                lost[m] += whole[m] - short[m];
            }
        }
        let diagonal = &mut to.blocks[matrix.pattern.diagonal[i] as usize];
        diagonal.iter_mut().zip(lost).for_each(|(a, lost)| *a += lost);
    }
}

/// Shares of the step before and of D^-1 r in each step of the polynomial that damps eigenvalues
/// from `low` to `high`.
pub(super) fn shares(high: f32, low: f32) -> impl Iterator<Item = [f32; 2]> {
    let (center, half) = ((high + low) / 2.0, (high - low) / 2.0);
    let first = (half / center, [0.0, 1.0 / center]);
    std::iter::successors(Some(first), move |(rho, _)| {
        let next = 1.0 / (2.0 * center / half - rho);
        Some((next, [next * rho, 2.0 * next / half]))
    })
    .map(|(_, shares)| shares)
}
