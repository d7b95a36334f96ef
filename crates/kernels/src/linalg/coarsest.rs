//! The coarsest level, solved exactly by a dense LU factorisation.

use faer::linalg::triangular_solve::{solve_unit_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::{Mat, Par};

use super::bsr::BlockMatrix;
use super::direct::{column, factorise_dense};
use super::kernel::Node;

/// Dense LU in f64 of a small block matrix; unknowns without any stiffness are held at 0.
#[derive(Clone, Debug)]
pub(super) struct Dense {
    lu: Mat<f64>,
    /// Row taken as each pivot; none if the matrix was singular, which leaves this level without a
    /// correction.
    pivots: Option<Vec<usize>>,
    work: [Vec<f64>; 2],
}

impl Default for Dense {
    fn default() -> Self {
        Self { lu: Mat::new(), pivots: None, work: [Vec::new(), Vec::new()] }
    }
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
        self.pivots = factorise_dense(dense.as_mut());
        self.lu = dense;
        self.work.iter_mut().for_each(|work| work.resize(n, 0.0));
    }

    pub fn solve(&mut self, b: &[Node], x: &mut [Node]) {
        let Some(pivots) = &self.pivots else {
            x.fill([0.0; 4]);
            return;
        };
        let [right, work] = &mut self.work;
        for (w, b) in right.as_chunks_mut::<3>().0.iter_mut().zip(b) {
            *w = [b[0], b[1], b[2]].map(f64::from);
        }
        for (w, &p) in work.iter_mut().zip(pivots) {
            *w = right[p];
        }
        solve_unit_lower_triangular_in_place(self.lu.as_ref(), column(work), Par::Seq);
        solve_upper_triangular_in_place(self.lu.as_ref(), column(work), Par::Seq);
        for (x, w) in x.iter_mut().zip(work.as_chunks::<3>().0) {
            *x = [w[0] as f32, w[1] as f32, w[2] as f32, 0.0];
        }
    }
}
