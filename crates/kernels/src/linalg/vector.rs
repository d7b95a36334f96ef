//! Sums over long vectors in a fixed order, so that they have the same bits at any thread count.

use rayon::prelude::*;

use crate::real::Real;

/// Entries summed on their own, in their own precision, before the partial sums are added up in
/// order and in f64.
pub(super) const CHUNK: usize = 3 * 1024;

/// Whether a vector of this length is worth sharing out among threads.
pub(super) fn parallel(n: usize) -> bool {
    n > 4 * CHUNK && rayon::current_num_threads() > 1
}

/// sum_i x_i y_i of one chunk, in sixteen lanes.
#[inline(always)]
pub(super) fn chunk_dot<T: Real>(x: &[T], y: &[T]) -> f64 {
    let (x16, x_rest) = x.as_chunks::<16>();
    let (y16, y_rest) = y.as_chunks::<16>();
    let mut lanes = [T::ZERO; 16];
    for (x, y) in x16.iter().zip(y16) {
        for l in 0..16 {
            lanes[l] += x[l] * y[l];
        }
    }
    let sum: f64 = lanes.iter().map(|l| l.to_f64()).sum();
    x_rest.iter().zip(y_rest).fold(sum, |sum, (x, y)| sum + x.to_f64() * y.to_f64())
}

/// The Euclidean norm.
pub(super) fn norm<T: Real>(x: &[T]) -> f64 {
    let square = if parallel(x.len()) {
        let partial: Vec<f64> = x.par_chunks(CHUNK).map(|x| chunk_dot(x, x)).collect();
        partial.iter().sum::<f64>()
    } else {
        x.chunks(CHUNK).map(|x| chunk_dot(x, x)).sum()
    };
    square.sqrt()
}
