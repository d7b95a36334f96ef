//! Transfers between the levels of a hierarchy, and the coarse matrices P^T A P formed through a plan made once.

use rayon::prelude::*;

use super::bsr::{BlockMatrix, Pattern, for_rows};
use crate::mesh::Prolongation;

/// Block rows a task of a parallel update works on.
const ROWS_PER_TASK: usize = 256;

/// A scalar sparse matrix by rows, acting on each of the three components alike.
#[derive(Clone, Debug)]
pub(super) struct Weights {
    pub start: Vec<u32>,
    pub column: Vec<u32>,
    pub weight: Vec<f32>,
}

impl Weights {
    #[inline(always)]
    pub fn row(&self, i: usize) -> impl Iterator<Item = (usize, f32)> {
        let range = self.start[i] as usize..self.start[i + 1] as usize;
        self.column[range.clone()].iter().map(|&j| j as usize).zip(self.weight[range].iter().copied())
    }

    pub fn rows(&self) -> usize {
        self.start.len() - 1
    }

    #[inline(always)]
    fn row_times(&self, i: usize, x: &[[f32; 3]]) -> [f32; 3] {
        let mut sum = [0.0; 3];
        for (j, w) in self.row(i) {
            for c in 0..3 {
                sum[c] += w * x[j][c];
            }
        }
        sum
    }

    fn transposed(&self, columns: usize) -> Self {
        let mut start = vec![0u32; columns + 1];
        for &j in &self.column {
            start[j as usize + 1] += 1;
        }
        for j in 0..columns {
            start[j + 1] += start[j];
        }
        let mut next = start.clone();
        let (mut column, mut weight) = (vec![0; self.column.len()], vec![0.0; self.column.len()]);
        for i in 0..self.rows() {
            for (j, w) in self.row(i) {
                let at = next[j] as usize;
                (column[at], weight[at]) = (i as u32, w);
                next[j] += 1;
            }
        }
        Self { start, column, weight }
    }
}

/// Prolongation P, restriction P^T and the plan for P^T A P between a fine and a coarse level.
#[derive(Clone, Debug)]
pub(super) struct Transfer {
    prolongation: Weights,
    restriction: Weights,
    /// Row starts of A P.
    product_start: Vec<u32>,
    /// The rows of A P, computed before P^T (A P).
    product: Vec<[f32; 9]>,
    /// For each row of A where its places in `fine_place` begin.
    fine_start: Vec<u32>,
    /// For each entry of A, for each coarse node of its column: the place in A P's row.
    fine_place: Vec<u16>,
    /// For each row of P^T A P where its places in `coarse_place` begin.
    coarse_start: Vec<u32>,
    /// For each fine node of a coarse row, for each entry of A P's row: the place in the coarse row.
    coarse_place: Vec<u16>,
}

/// The sorted distinct columns that `collect` pushes for each of `rows` rows.
fn distinct(rows: usize, collect: impl Fn(usize, &mut Vec<u32>)) -> Vec<Vec<u32>> {
    let mut all = Vec::new();
    (0..rows)
        .map(|i| {
            all.clear();
            collect(i, &mut all);
            all.sort_unstable();
            all.dedup();
            all.clone()
        })
        .collect()
}

impl Transfer {
    /// `fine` is the fine level's pattern and `fine_order` the node behind each of its rows. Returns the transfer, the coarse pattern
    /// and the coarse order, chosen by `order` from the coarse pattern in the mesh's numbering.
    pub fn new(
        fine: &Pattern,
        fine_order: &[u32],
        prolongation: &Prolongation,
        order: impl Fn(&Pattern) -> Vec<u32>,
    ) -> (Self, Pattern, Vec<u32>) {
        let (fine_rows, coarse_rows) = (fine.rows(), prolongation.coarse_nodes);
        let mut p = Weights { start: vec![0], column: Vec::new(), weight: Vec::new() };
        for &node in fine_order {
            let range = prolongation.row_start[node as usize] as usize..prolongation.row_start[node as usize + 1] as usize;
            p.column.extend_from_slice(&prolongation.column[range.clone()]);
            p.weight.extend(prolongation.weight[range].iter().map(|&w| w as f32));
            p.start.push(p.column.len() as u32);
        }
        let product_rows = |p: &Weights| {
            distinct(fine_rows, |i, all| {
                for at in fine.row(i) {
                    all.extend(p.row(fine.column[at] as usize).map(|(j, _)| j as u32));
                }
            })
        };
        let coarse_rows_of = |r: &Weights, product: &[Vec<u32>]| {
            distinct(coarse_rows, |i, all| r.row(i).for_each(|(k, _)| all.extend_from_slice(&product[k])))
        };
        let natural = Pattern::from_rows(coarse_rows_of(&p.transposed(coarse_rows), &product_rows(&p)).into_iter());
        let coarse_order = order(&natural);
        let mut rank = vec![0u32; coarse_rows];
        for (i, &node) in coarse_order.iter().enumerate() {
            rank[node as usize] = i as u32;
        }
        for j in &mut p.column {
            *j = rank[*j as usize];
        }
        let r = p.transposed(coarse_rows);
        let product_columns = product_rows(&p);
        let coarse = Pattern::from_rows(coarse_rows_of(&r, &product_columns).into_iter());

        let place = |row: &[u32], j: usize| row.binary_search(&(j as u32)).unwrap_or(0) as u16;
        let (mut fine_start, mut fine_place, mut product_start) = (vec![0u32], Vec::new(), vec![0u32]);
        for (i, row) in product_columns.iter().enumerate() {
            for at in fine.row(i) {
                fine_place.extend(p.row(fine.column[at] as usize).map(|(j, _)| place(row, j)));
            }
            fine_start.push(fine_place.len() as u32);
            product_start.push(product_start[i] + row.len() as u32);
        }
        let (mut coarse_start, mut coarse_place) = (vec![0u32], Vec::new());
        for i in 0..coarse_rows {
            let row = &coarse.column[coarse.row(i)];
            for (k, _) in r.row(i) {
                coarse_place.extend(product_columns[k].iter().map(|&j| place(row, j as usize)));
            }
            coarse_start.push(coarse_place.len() as u32);
        }
        let product = vec![[0.0; 9]; product_start[fine_rows] as usize];
        let transfer =
            Self { prolongation: p, restriction: r, product_start, product, fine_start, fine_place, coarse_start, coarse_place };
        (transfer, coarse, coarse_order)
    }

    /// coarse = P^T fine P. `diagonal_of` may replace a row's diagonal block (to leave out the identity of fixed unknowns).
    pub fn update(
        &mut self,
        fine: &BlockMatrix<f32>,
        diagonal_of: impl Fn(usize) -> Option<[f32; 9]> + Sync,
        coarse: &mut BlockMatrix<f32>,
    ) {
        let (p, r) = (&self.prolongation, &self.restriction);
        for_row_blocks(&mut self.product, &self.product_start, |i, sum| {
            let mut places = self.fine_place[self.fine_start[i] as usize..].iter();
            let replaced = diagonal_of(i);
            for at in fine.pattern.row(i) {
                let j = fine.pattern.column[at] as usize;
                let a = match &replaced {
                    Some(diagonal) if i == j => diagonal,
                    _ => &fine.blocks[at],
                };
                for ((_, w), &place) in p.row(j).zip(&mut places) {
                    add_scaled(&mut sum[place as usize], w, a);
                }
            }
        });
        let (product, product_start) = (&self.product, &self.product_start);
        for_row_blocks(&mut coarse.blocks, &coarse.pattern.row_start, |i, sum| {
            let mut places = self.coarse_place[self.coarse_start[i] as usize..].iter();
            for (k, w) in r.row(i) {
                for (a, &place) in product[product_start[k] as usize..product_start[k + 1] as usize].iter().zip(&mut places) {
                    add_scaled(&mut sum[place as usize], w, a);
                }
            }
        });
    }

    /// coarse = P^T fine.
    pub fn restrict(&self, fine: &[[f32; 3]], coarse: &mut [[f32; 3]]) {
        for_rows(coarse, |i, y| *y = self.restriction.row_times(i, fine));
    }

    /// fine += P coarse.
    pub fn prolong_add(&self, coarse: &[[f32; 3]], fine: &mut [[f32; 3]]) {
        for_rows(fine, |i, y| {
            let sum = self.prolongation.row_times(i, coarse);
            for c in 0..3 {
                y[c] += sum[c];
            }
        });
    }
}

#[inline(always)]
fn add_scaled(sum: &mut [f32; 9], w: f32, a: &[f32; 9]) {
    for m in 0..9 {
        sum[m] += w * a[m];
    }
}

/// Zeroes the blocks of every row and hands them to `row(i, blocks)`, in parallel where it pays.
pub(super) fn for_row_blocks(blocks: &mut [[f32; 9]], start: &[u32], row: impl Fn(usize, &mut [[f32; 9]]) + Sync) {
    let rows = start.len() - 1;
    let run = |range: std::ops::Range<usize>, blocks: &mut [[f32; 9]]| {
        blocks.as_flattened_mut().fill(0.0);
        let base = start[range.start];
        for i in range {
            row(i, &mut blocks[(start[i] - base) as usize..(start[i + 1] - base) as usize]);
        }
    };
    if rows <= 2 * ROWS_PER_TASK || rayon::current_num_threads() == 1 {
        return run(0..rows, blocks);
    }
    let mut rest = blocks;
    let mut tasks = Vec::with_capacity(rows / ROWS_PER_TASK + 1);
    for first in (0..rows).step_by(ROWS_PER_TASK) {
        let last = rows.min(first + ROWS_PER_TASK);
        let (mine, others) = rest.split_at_mut((start[last] - start[first]) as usize);
        tasks.push((first..last, mine));
        rest = others;
    }
    tasks.into_par_iter().for_each(|(range, blocks)| run(range, blocks));
}
