//! Block-sparse matrices: 3x3 blocks, one block row a node (block compressed sparse rows, BSR).
//!
//! Vectors are flat, three components a node: `[x_0, y_0, z_0, x_1, ...]`.

use super::parallel::each;
use crate::real::Real;

pub use crate::mesh::pattern::Pattern;

/// A square block-sparse matrix.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockMatrix<T> {
    /// Where the blocks are.
    pub pattern: Pattern,
    /// The blocks, each row-major: entry (r, c) of a block is `block[3 * r + c]`.
    pub blocks: Vec<[T; 9]>,
}

impl<T: Real> BlockMatrix<T> {
    /// The zero matrix on a pattern.
    pub fn zeros(pattern: Pattern) -> Self {
        let blocks = vec![[T::ZERO; 9]; pattern.entries()];
        Self { pattern, blocks }
    }

    /// Number of block rows (nodes).
    pub fn rows(&self) -> usize {
        self.pattern.rows()
    }

    /// Number of unknowns, 3 a node.
    pub fn unknowns(&self) -> usize {
        3 * self.rows()
    }

    /// The block that couples row node `row` to column node `column`, if the pattern has it.
    #[cfg(test)]
    pub fn block(&self, row: usize, column: usize) -> Option<&[T; 9]> {
        self.pattern.position(row, column).map(|at| &self.blocks[at])
    }

    /// The block of a row and a column for writing; `None` where the pattern has none.
    pub fn block_mut(&mut self, row: usize, column: usize) -> Option<&mut [T; 9]> {
        self.pattern.position(row, column).map(|at| &mut self.blocks[at])
    }

    /// Makes row `3 * node + component` a row of the identity.
    pub fn set_identity_row(&mut self, node: usize, component: usize) {
        for at in self.pattern.row(node) {
            self.blocks[at][3 * component..3 * component + 3].fill(T::ZERO);
        }
        self.blocks[self.pattern.diagonal[node] as usize][4 * component] = T::ONE;
    }

    /// y = A x. Lengths are [`BlockMatrix::unknowns`].
    ///
    /// `y` may be wider than the matrix and `x` (f32 blocks or an f32 `x`, f64 sums): sums are
    /// taken in the precision of `y`.
    pub fn multiply<X: Widen<V> + Sync, V: Real>(&self, x: &[X], y: &mut [V])
    where
        T: Widen<V>,
    {
        let x = x.as_chunks::<3>().0;
        each(&mut y.as_chunks_mut::<3>().0[..self.rows()], |i, y| *y = self.row_times(i, x));
    }

    /// r = b - A x, as [`BlockMatrix::multiply`].
    pub fn residual<X: Widen<V> + Sync, V: Real>(&self, x: &[X], b: &[V], r: &mut [V])
    where
        T: Widen<V>,
    {
        let (x, b) = (x.as_chunks::<3>().0, b.as_chunks::<3>().0);
        each(&mut r.as_chunks_mut::<3>().0[..self.rows()], |i, r| {
            let y = self.row_times(i, x);
            *r = [b[i][0] - y[0], b[i][1] - y[1], b[i][2] - y[2]];
        });
    }

    /// r -= A x where few nodes of x are not 0: rows without such a node are left out. The pattern
    /// must be symmetric.
    pub fn subtract_product_of_few<V: Real + Widen<V>>(&self, x: &[V], r: &mut [V])
    where
        T: Widen<V>,
    {
        let x = x.as_chunks::<3>().0;
        let mut touched = vec![false; self.rows()];
        for j in (0..self.rows()).filter(|&j| x[j] != [V::ZERO; 3]) {
            self.pattern.column[self.pattern.row(j)].iter().for_each(|&i| touched[i as usize] = true);
        }
        let touched = touched.as_slice();
        each(&mut r.as_chunks_mut::<3>().0[..self.rows()], |i, r| {
            if touched[i] {
                let y = self.row_times(i, x);
                *r = [r[0] - y[0], r[1] - y[1], r[2] - y[2]];
            }
        });
    }

    /// Row `i` of A times x.
    #[inline(always)]
    pub(super) fn row_times<X: Widen<V>, V: Real>(&self, i: usize, x: &[[X; 3]]) -> [V; 3]
    where
        T: Widen<V>,
    {
        let range = self.pattern.row(i);
        // Nine lanes, one for each place of a block: they vectorise as the block lies in memory,
        // and are added up once a row.
        let mut lanes = [V::ZERO; 9];
        for (a, &j) in self.blocks[range.clone()].iter().zip(&self.pattern.column[range]) {
            let x = x[j as usize].map(Widen::widen);
            for m in 0..9 {
                lanes[m] += a[m].widen() * x[m % 3];
            }
        }
        [lanes[0] + lanes[1] + lanes[2], lanes[3] + lanes[4] + lanes[5], lanes[6] + lanes[7] + lanes[8]]
    }
}

/// Exact conversion of a matrix entry to the precision of the vectors.
pub trait Widen<V>: Copy {
    /// The same number.
    fn widen(self) -> V;
}
macro_rules! widen {
    ($from:ident, $to:ident) => {
        impl Widen<$to> for $from {
            #[inline(always)]
            fn widen(self) -> $to {
                $to::from(self)
            }
        }
    };
}
widen!(f32, f32);
widen!(f32, f64);
widen!(f64, f64);
