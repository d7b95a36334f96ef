use super::problem::{Brick, Patch, Problem};
use super::timing::cpu_seconds;
use super::*;
use crate::mesh::sphere::{SphereSpec, sphere_mesh};

fn solve(problem: &Problem, kind: SolverKind, tolerance: f64) -> (Vec<f64>, super::super::SolveReport) {
    let mut solver = LinearSolver::new(kind, &problem.matrix.pattern, &problem.prolongations).unwrap();
    solver.update(&problem.matrix, &problem.fixed).unwrap();
    let mut x = vec![0.0; problem.rhs.len()];
    let report = solver.solve(&problem.rhs, tolerance, &mut x).unwrap();
    (x, report)
}

#[test]
#[ignore = "prints iterations and times"]
fn survey() {
    for per_radius in [8, 16] {
        let spec = SphereSpec { contact_radius: 0.2, elements_per_contact_radius: per_radius, fine_zone: 1.5 };
        let mesh = sphere_mesh(&spec).unwrap();
        for (name, brick) in [
            ("elastic", Brick::elastic(1)),
            ("plastic", Brick::plastic(1)),
            ("slipping", Brick::slipping(1)),
            ("incompressible", Brick { bulk: 1000.0, ..Brick::elastic(1) }),
        ] {
            let problem = brick.on(&mesh);
            let n = problem.rhs.len();
            {
                let (pattern, chain) = (&problem.matrix.pattern, &problem.prolongations);
                let mut solver = LinearSolver::new(SolverKind::Multigrid, pattern, chain).unwrap();
                solver.update(&problem.matrix, &problem.fixed).unwrap();
                let start = cpu_seconds();
                solver.update(&problem.matrix, &problem.fixed).unwrap();
                let mut line = format!("{n} {name:14} update {:.4}", cpu_seconds() - start);
                for tolerance in [1e-2, 1e-3, 1e-5] {
                    let mut x = vec![0.0; n];
                    let start = cpu_seconds();
                    let report = solver.solve(&problem.rhs, tolerance, &mut x);
                    let t = cpu_seconds() - start;
                    line += &match report {
                        Ok(r) => format!("  {tolerance:.0e}: {:3} {t:.3} s{}", r.iterations, if r.fallback { "!" } else { "" }),
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
        let (direct, report) = solve(&problem, SolverKind::Direct, 1e-10);
        assert!(report.converged && report.residual < 1e-10, "{report:?}");
        let (multigrid, report) = solve(&problem, SolverKind::Multigrid, 1e-10);
        assert!(report.converged && !report.fallback, "{report:?}");
        let size = direct.iter().fold(0.0_f64, |s, x| s.max(x.abs()));
        let error = direct.iter().zip(&multigrid).fold(0.0_f64, |s, (a, b)| s.max((a - b).abs()));
        assert!(error < 1e-7 * size, "{error} of {size}");
    }
}
