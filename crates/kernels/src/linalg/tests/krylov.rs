//! FGMRES by itself, and in two precisions.

use super::problem::Brick;
use super::*;
use crate::linalg::fgmres::{Fgmres, System};
use crate::linalg::fixed::Fixed;
use crate::linalg::vector::norm;

/// A small dense matrix without a preconditioner.
struct Dense {
    n: usize,
    a: Vec<f64>,
}

impl System<f64> for Dense {
    fn step(&mut self, v: &[f64], z: &mut [f32], w: &mut [f64]) {
        z.iter_mut().zip(v).for_each(|(z, v)| *z = *v as f32);
        for (w, row) in w.iter_mut().zip(self.a.chunks(self.n)) {
            *w = row.iter().zip(&*z).map(|(a, z)| a * f64::from(*z)).sum();
        }
    }

    fn residual(&self, b: &[f64], x: &[f64], r: &mut [f64]) {
        for ((r, b), row) in r.iter_mut().zip(b).zip(self.a.chunks(self.n)) {
            *r = b - row.iter().zip(x).map(|(a, x)| a * x).sum::<f64>();
        }
    }
}

/// Not symmetric, with eigenvalues about 1 and above.
fn dense(n: usize) -> Dense {
    let entry = |i: usize, j: usize| if i == j { 2.0 + i as f64 } else { 0.5 * ((i * 7 + j * 3) as f64).sin() };
    Dense { n, a: (0..n * n).map(|k| entry(k / n, k % n)).collect() }
}

#[test]
fn ends_within_as_many_iterations_as_unknowns() {
    let n = 12;
    let b: Vec<f64> = (0..n).map(|i| 1.0 + i as f64).collect();
    let mut x = vec![0.0; n];
    let report = Fgmres::new(n, 50).solve(&mut dense(n), &b, &mut x, 1e-6, 100);
    assert!(report.converged && report.iterations <= n, "{report:?}");
    let mut r = vec![0.0; n];
    dense(n).residual(&b, &x, &mut r);
    assert!((norm(&r) / norm(&b) - report.residual).abs() < 1e-15 && report.residual <= 1e-6);
}

#[test]
fn restarts_and_the_limit_are_kept() {
    let n = 12;
    let b = vec![1.0; n];
    let mut x = vec![0.0; n];
    let report = Fgmres::new(n, 4).solve(&mut dense(n), &b, &mut x, 1e-9, 200);
    assert!(report.converged && report.iterations > n, "{report:?}");
    let report = Fgmres::new(n, 4).solve(&mut dense(n), &b, &mut vec![0.0; n], 1e-9, 6);
    assert!(!report.converged && !report.stagnated && report.iterations == 6, "{report:?}");
}

#[test]
fn gives_up_on_what_is_singular_or_not_a_number() {
    // A rotation by a quarter turn stalls GMRES(1) for good.
    let mut turn = Dense { n: 2, a: vec![0.0, 1.0, -1.0, 0.0] };
    let report = Fgmres::new(2, 1).solve(&mut turn, &[1.0, 0.0], &mut [0.0; 2], 1e-6, 100);
    assert!(report.stagnated && report.iterations < 5, "{report:?}");
    let mut nothing = Dense { n: 2, a: vec![0.0; 4] };
    let report = Fgmres::new(2, 5).solve(&mut nothing, &[1.0, 0.0], &mut [0.0; 2], 1e-6, 100);
    assert!(report.stagnated && report.iterations < 5, "{report:?}");
    let mut nan = Dense { n: 2, a: vec![f64::NAN; 4] };
    let report = Fgmres::new(2, 5).solve(&mut nan, &[1.0, 0.0], &mut [0.0; 2], 1e-6, 100);
    assert!(report.stagnated && report.iterations < 5, "{report:?}");
}

/// As the solver's own system, its basis in f64.
struct Wide<'a> {
    matrix: &'a BlockMatrix<f64>,
    fixed: &'a Fixed,
    hierarchy: Hierarchy,
}

impl System<f64> for Wide<'_> {
    fn step(&mut self, v: &[f64], z: &mut [f32], w: &mut [f64]) {
        self.hierarchy.v_cycle(v, z);
        self.matrix.multiply(z, w);
        self.fixed.clear(w);
    }

    fn residual(&self, b: &[f64], x: &[f64], r: &mut [f64]) {
        self.matrix.residual(x, b, r);
        self.fixed.clear(r);
    }
}

#[test]
fn a_basis_in_f32_costs_no_iterations() {
    for brick in [Brick::plastic(10), Brick { bulk: 1000.0, ..Brick::elastic(10) }] {
        let problem = brick.problem();
        let n = problem.rhs.len();
        let mut fixed = Fixed::default();
        fixed.set(&problem.fixed);
        let mut b = problem.rhs.clone();
        fixed.clear(&mut b);
        let mut hierarchy = Hierarchy::new(&problem.matrix.pattern, &problem.prolongations).unwrap();
        hierarchy.update(&problem.matrix, &problem.fixed).unwrap();
        let mut wide = Wide { matrix: &problem.matrix, fixed: &fixed, hierarchy };
        let mut solver = LinearSolver::new(SolverKind::Multigrid, &problem.matrix.pattern, &problem.prolongations).unwrap();
        solver.update(&problem.matrix, &problem.fixed).unwrap();
        // Measured to 1e-8: 42 against 40 (plastic); to 1e-5: 58 against 52 (nearly
        // incompressible).
        for tolerance in [1e-3, 1e-5] {
            let in_f64 = Fgmres::<f64>::new(n, 60).solve(&mut wide, &b, &mut vec![0.0; n], tolerance, 200).iterations;
            let in_f32 = solver.solve(&b, tolerance, &mut vec![0.0; n]).unwrap().iterations;
            assert!(in_f32 <= in_f64 + 1 + in_f64 / 5, "{in_f32} against {in_f64} to {tolerance:e}");
        }
    }
}
