//! Loops over nodes, in parallel where the vectors are long enough to pay for it. Nodes are
//! independent of each other in each of them, so how they are shared out does not change a bit.

use rayon::prelude::*;

/// Nodes a task works on.
const TASK: usize = 1024;

/// Whether a loop over this many nodes is worth sharing out.
pub(super) fn worth(nodes: usize) -> bool {
    nodes > 2 * TASK && rayon::current_num_threads() > 1
}

/// Calls `body(i, &mut y[i])` for every i.
#[inline(always)]
pub(super) fn each<Y: Send>(y: &mut [Y], body: impl Fn(usize, &mut Y) + Sync) {
    let run = |first: usize, y: &mut [Y]| y.iter_mut().enumerate().for_each(|(k, y)| body(first + k, y));
    if worth(y.len()) {
        y.par_chunks_mut(TASK).enumerate().for_each(|(task, y)| run(task * TASK, y));
    } else {
        run(0, y);
    }
}

/// Calls `body(i, &mut y[i], &mut z[i])` for every i.
#[inline(always)]
pub(super) fn each_of_two<Y: Send, Z: Send>(y: &mut [Y], z: &mut [Z], body: impl Fn(usize, &mut Y, &mut Z) + Sync) {
    let run =
        |first: usize, y: &mut [Y], z: &mut [Z]| y.iter_mut().zip(z).enumerate().for_each(|(k, (y, z))| body(first + k, y, z));
    if worth(y.len()) {
        y.par_chunks_mut(TASK).zip(z.par_chunks_mut(TASK)).enumerate().for_each(|(task, (y, z))| run(task * TASK, y, z));
    } else {
        run(0, y, z);
    }
}

/// Hands the entries of every row to `body(i, entries)`; row i has `entries[start[i]..start[i +
/// 1]]`.
#[inline(always)]
pub(super) fn each_row<B: Send>(entries: &mut [B], start: &[u32], body: impl Fn(usize, &mut [B]) + Sync) {
    let rows = start.len() - 1;
    let run = |range: std::ops::Range<usize>, entries: &mut [B]| {
        let base = start[range.start];
        for i in range {
            body(i, &mut entries[(start[i] - base) as usize..(start[i + 1] - base) as usize]);
        }
    };
    if !worth(rows) {
        return run(0..rows, entries);
    }
    let mut rest = entries;
    let mut tasks = Vec::with_capacity(rows / TASK + 1);
    for first in (0..rows).step_by(TASK) {
        let last = rows.min(first + TASK);
        let (mine, others) = rest.split_at_mut((start[last] - start[first]) as usize);
        tasks.push((first..last, mine));
        rest = others;
    }
    tasks.into_par_iter().for_each(|(range, entries)| run(range, entries));
}
