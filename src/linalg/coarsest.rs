//! The coarsest level, solved exactly by a dense LU factorisation.

use faer::linalg::solvers::{PartialPivLu, SolveCore};
use faer::{Conj, Mat, MatMut};

use super::bsr::BlockMatrix;
use super::kernel::Node;

/// Dense LU in f64 of a small block matrix; unknowns without any stiffness are held at 0.
#[derive(Clone, Debug, Default)]
pub(super) struct Dense {
    factors: Option<PartialPivLu<f64>>,
    work: Vec<f64>,
}

impl Dense {
    pub fn update(&mut self, matrix: &BlockMatrix<f32>) {
        let n = matrix.unknowns();
        let mut dense = Mat::<f64>::zeros(n, n);
        for i in 0..matrix.rows() {
            for at in matrix.pattern.row(i) {
                let j = matrix.pattern.column[at] as usize;
                for (m, &a) in matrix.blocks[at].iter().enumerate() {
                    dense[(3 * i + m / 3, 3 * j + m % 3)] = f64::from(a);
                }
            }
        }
        let scale = (0..n).fold(0.0_f64, |s, i| s.max(dense[(i, i)].abs()));
        for i in 0..n {
            if dense[(i, i)].abs() <= 1e-9 * scale {
                dense[(i, i)] = if scale > 0.0 { scale } else { 1.0 };
            }
        }
        self.factors = Some(dense.partial_piv_lu());
        self.work.resize(n, 0.0);
    }

    pub fn solve(&mut self, b: &[Node], x: &mut [Node]) {
        let Some(lu) = &self.factors else { return };
        for (w, b) in self.work.as_chunks_mut::<3>().0.iter_mut().zip(b) {
            *w = [b[0], b[1], b[2]].map(f64::from);
        }
        let n = self.work.len();
        lu.solve_in_place_with_conj(Conj::No, MatMut::from_column_major_slice_mut(&mut self.work, n, 1));
        for (x, w) in x.iter_mut().zip(self.work.as_chunks::<3>().0) {
            *x = [w[0] as f32, w[1] as f32, w[2] as f32, 0.0];
        }
    }
}
