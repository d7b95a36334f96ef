//! Sums over long vectors in a fixed order, so that they have the same bits at any thread count.

use rayon::prelude::*;

use crate::real::Real;

/// Entries summed on their own before the partial sums are added up in order.
pub(super) const CHUNK: usize = 3 * 1024;

/// sum_i x_i y_i of one chunk, in eight lanes.
#[inline(always)]
pub(super) fn chunk_dot<X: Real, Y: Real>(x: &[X], y: &[Y]) -> f64 {
    let (x8, x_rest) = x.as_chunks::<8>();
    let (y8, y_rest) = y.as_chunks::<8>();
    let mut lanes = [0.0; 8];
    for (x, y) in x8.iter().zip(y8) {
        for l in 0..8 {
            lanes[l] += x[l].to_f64() * y[l].to_f64();
        }
    }
    let mut sum = ((lanes[0] + lanes[4]) + (lanes[2] + lanes[6])) + ((lanes[1] + lanes[5]) + (lanes[3] + lanes[7]));
    for (x, y) in x_rest.iter().zip(y_rest) {
        sum += x.to_f64() * y.to_f64();
    }
    sum
}

/// sum_i x_i y_i.
pub(super) fn dot<X: Real, Y: Real>(x: &[X], y: &[Y]) -> f64 {
    if x.len() <= 4 * CHUNK || rayon::current_num_threads() == 1 {
        x.chunks(CHUNK).zip(y.chunks(CHUNK)).map(|(x, y)| chunk_dot(x, y)).sum()
    } else {
        let partial: Vec<f64> = x.par_chunks(CHUNK).zip(y.par_chunks(CHUNK)).map(|(x, y)| chunk_dot(x, y)).collect();
        partial.iter().sum()
    }
}

/// The Euclidean norm.
pub(super) fn norm<X: Real>(x: &[X]) -> f64 {
    dot(x, x).sqrt()
}
