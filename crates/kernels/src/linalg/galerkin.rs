//! Transfers between the levels of a hierarchy, and the coarse matrices P^T A P formed through a
//! plan made once.

use wide::f32x4;

use super::bsr::{BlockMatrix, Pattern};
use super::kernel::Node;
use super::parallel::{each, each_row};
use crate::mesh::Prolongation;

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
    fn row_times(&self, i: usize, x: &[Node]) -> f32x4 {
        self.row(i).fold(f32x4::ZERO, |sum, (j, w)| f32x4::splat(w).mul_add(f32x4::new(x[j]), sum))
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
    pub prolongation: Weights,
    pub restriction: Weights,
    /// Row starts of A P.
    pub product_start: Vec<u32>,
    /// The rows of A P, computed before P^T (A P).
    product: Vec<[f32; 9]>,
    /// For each row of A where its places in `fine_place` begin.
    pub fine_start: Vec<u32>,
    /// For each entry of A, for each coarse node of its column: the place in A P's row.
    pub fine_place: Vec<u16>,
    /// For each row of P^T A P where its places in `coarse_place` begin.
    pub coarse_start: Vec<u32>,
    /// For each fine node of a coarse row, for each entry of A P's row: the place in the coarse
    /// row.
    pub coarse_place: Vec<u16>,
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
    /// Plans the transfer from a level with the pattern `fine`, which the prolongation fits;
    /// returns the coarse pattern as well.
    pub fn new(fine: &Pattern, prolongation: &Prolongation) -> (Self, Pattern) {
        let (fine_rows, coarse_rows) = (fine.rows(), prolongation.coarse_nodes);
        let p = Weights {
            start: prolongation.row_start.clone(),
            column: prolongation.column.clone(),
            weight: prolongation.weight.iter().map(|&w| w as f32).collect(),
        };
        let r = p.transposed(coarse_rows);
        let product_columns = distinct(fine_rows, |i, all| {
            for at in fine.row(i) {
                all.extend(p.row(fine.column[at] as usize).map(|(j, _)| j as u32));
            }
        });
        let coarse = distinct(coarse_rows, |i, all| r.row(i).for_each(|(k, _)| all.extend_from_slice(&product_columns[k])));
        let coarse = Pattern::from_rows(coarse.into_iter());

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
        (transfer, coarse)
    }

    /// coarse = P^T fine P, leaving out the identity rows of fixed unknowns: those whose bits
    /// `identity` sets for a node. What does not depend on the rows of `fine` that have changed is
    /// left as it is; `coarse_changed` says which rows of `coarse` were formed anew.
    pub fn update(
        &mut self,
        (fine, changed): (&BlockMatrix<f32>, &[bool]),
        identity: impl Fn(usize) -> u8 + Sync,
        (coarse, coarse_changed): (&mut BlockMatrix<f32>, &mut [bool]),
    ) {
        let (p, r) = (&self.prolongation, &self.restriction);
        let mut nothing = vec![(); fine.rows()];
        each_row(&mut self.product, &self.product_start, &mut nothing, |i, sum, ()| {
            if !changed[i] {
                return;
            }
            sum.as_flattened_mut().fill(0.0);
            let mut places = self.fine_place[self.fine_start[i] as usize..].iter();
            let bits = identity(i);
            let mut diagonal = fine.blocks[fine.pattern.diagonal[i] as usize];
            mask(&mut diagonal, bits, bits);
            for at in fine.pattern.row(i) {
                let j = fine.pattern.column[at] as usize;
                let a = if i == j { &diagonal } else { &fine.blocks[at] };
                for ((_, w), &place) in p.row(j).zip(&mut places) {
                    add_scaled(&mut sum[place as usize], w, a);
                }
            }
        });
        let (product, product_start) = (&self.product, &self.product_start);
        each_row(&mut coarse.blocks, &coarse.pattern.row_start, coarse_changed, |i, sum, anew| {
            *anew = r.row(i).any(|(k, _)| changed[k]);
            if !*anew {
                return;
            }
            sum.as_flattened_mut().fill(0.0);
            let mut places = self.coarse_place[self.coarse_start[i] as usize..].iter();
            for (k, w) in r.row(i) {
                for (a, &place) in product[product_start[k] as usize..product_start[k + 1] as usize].iter().zip(&mut places) {
                    add_scaled(&mut sum[place as usize], w, a);
                }
            }
        });
    }

    /// coarse = P^T fine.
    pub fn restrict(&self, fine: &[Node], coarse: &mut [Node]) {
        each(coarse, |i, y| *y = self.restriction.row_times(i, fine).to_array());
    }

    /// fine += P coarse.
    pub fn prolong_add(&self, coarse: &[Node], fine: &mut [Node]) {
        each(fine, |i, y| *y = (f32x4::new(*y) + self.prolongation.row_times(i, coarse)).to_array());
    }
}

#[inline(always)]
fn add_scaled(sum: &mut [f32; 9], w: f32, a: &[f32; 9]) {
    for m in 0..9 {
        sum[m] += w * a[m];
    }
}

/// Zeroes the rows and columns whose bits are set.
pub(super) fn mask(block: &mut [f32; 9], rows: u8, columns: u8) {
    for (m, a) in block.iter_mut().enumerate() {
        if (rows >> (m / 3) | columns >> (m % 3)) & 1 != 0 {
            *a = 0.0;
        }
    }
}
