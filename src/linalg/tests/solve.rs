use super::problem::{Brick, Patch, Problem};
use super::*;

fn solve(problem: &Problem, kind: SolverKind, smoother: Smoother, tolerance: f64) -> (Vec<f64>, super::super::SolveReport) {
    let mut solver = LinearSolver::with_smoother(kind, &problem.matrix.pattern, &problem.prolongations, smoother).unwrap();
    solver.update(&problem.matrix, &problem.fixed).unwrap();
    let mut x = vec![0.0; problem.rhs.len()];
    let report = solver.solve(&problem.rhs, tolerance, &mut x).unwrap();
    (x, report)
}

#[test]
#[ignore]
fn survey() {
    let variants = [
        ("GS1", Smoother::GaussSeidel { sweeps: 1 }),
        ("GS2", Smoother::GaussSeidel { sweeps: 2 }),
        ("C3", Smoother::Chebyshev { degree: 3 }),
        ("C2", Smoother::Chebyshev { degree: 2 }),
    ];
    for n in [12, 24] {
        for (name, brick) in [
            ("elastic", Brick::elastic(n)),
            ("ungraded", Brick { grading: 1.0, ..Brick::elastic(n) }),
            ("plastic", Brick::plastic(n)),
            ("slipping", Brick::slipping(n)),
            ("incompressible", Brick { bulk: 1000.0, ..Brick::elastic(n) }),
            ("open", Brick { patch: Patch::Open, ..Brick::elastic(n) }),
        ] {
            let problem = brick.problem();
            for (label, smoother) in variants {
                let mut solver =
                    LinearSolver::with_smoother(SolverKind::Multigrid, &problem.matrix.pattern, &problem.prolongations, smoother)
                        .unwrap();
                solver.update(&problem.matrix, &problem.fixed).unwrap();
                let start = std::time::Instant::now();
                solver.update(&problem.matrix, &problem.fixed).unwrap();
                let update = start.elapsed().as_secs_f64();
                let mut line = format!("{n} {name:14} {label} update {update:.4}");
                for tolerance in [1e-2, 1e-3, 1e-8] {
                    let mut x = vec![0.0; problem.rhs.len()];
                    let start = std::time::Instant::now();
                    let report = solver.solve(&problem.rhs, tolerance, &mut x);
                    let t = start.elapsed().as_secs_f64();
                    line += &match report {
                        Ok(r) => format!(
                            "  {tolerance:.0e}: {:3} {:.3} s{}",
                            r.iterations,
                            t,
                            if r.converged && !r.fallback { "" } else { "!" }
                        ),
                        Err(e) => format!("  {e}"),
                    };
                }
                println!("{line}");
            }
        }
    }
}

#[test]
fn multigrid_matches_direct() {
    for brick in [Brick::elastic(8), Brick::plastic(8), Brick::slipping(8)] {
        let problem = brick.problem();
        let (direct, report) = solve(&problem, SolverKind::Direct, Smoother::default(), 1e-10);
        assert!(report.converged && report.residual < 1e-10, "{report:?}");
        let (multigrid, report) = solve(&problem, SolverKind::Multigrid, Smoother::default(), 1e-10);
        assert!(report.converged && !report.fallback, "{report:?}");
        let size = direct.iter().fold(0.0_f64, |s, x| s.max(x.abs()));
        let error = direct.iter().zip(&multigrid).fold(0.0_f64, |s, (a, b)| s.max((a - b).abs()));
        assert!(error < 1e-7 * size, "{error} of {size}");
    }
}
