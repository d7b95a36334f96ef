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

/// Hands the entries of every row, and what else there is of it, to `body(i, entries, &mut
/// other[i])`; row i has `entries[start[i]..start[i + 1]]`.
#[inline(always)]
pub(super) fn each_row<B: Send, O: Send>(
    entries: &mut [B],
    start: &[u32],
    other: &mut [O],
    body: impl Fn(usize, &mut [B], &mut O) + Sync,
) {
    let rows = start.len() - 1;
    let run = |first: usize, entries: &mut [B], other: &mut [O]| {
        let base = start[first];
        for (k, other) in other.iter_mut().enumerate() {
            let i = first + k;
            body(i, &mut entries[(start[i] - base) as usize..(start[i + 1] - base) as usize], other);
        }
    };
    if !worth(rows) {
        return run(0, entries, &mut other[..rows]);
    }
    let mut rest = entries;
    let mut tasks = Vec::with_capacity(rows / TASK + 1);
    for (task, other) in other[..rows].chunks_mut(TASK).enumerate() {
        let first = task * TASK;
        let (mine, others) = rest.split_at_mut((start[first + other.len()] - start[first]) as usize);
        tasks.push((first, mine, other));
        rest = others;
    }
    tasks.into_par_iter().for_each(|(first, entries, other)| run(first, entries, other));
}
