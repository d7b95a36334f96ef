//! The solvers against each other, their iteration counts, and what they do with odd input.

use super::problem::{Brick, Patch, Problem};
use super::*;
use crate::linalg::SolveReport;
use crate::mesh::sphere::{SphereSpec, sphere_mesh};

fn solver(problem: &Problem, kind: SolverKind) -> LinearSolver {
    let mut solver = LinearSolver::new(kind, &problem.matrix.pattern, &problem.prolongations).unwrap();
    solver.update(&problem.matrix, &problem.fixed).unwrap();
    solver
}

fn solve(problem: &Problem, kind: SolverKind, tolerance: f64) -> (Vec<f64>, SolveReport) {
    let mut x = vec![0.0; problem.rhs.len()];
    let report = solver(problem, kind).solve(&problem.rhs, tolerance, &mut x).unwrap();
    (x, report)
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    let size = a.iter().fold(0.0_f64, |s, x| s.max(x.abs()));
    a.iter().zip(b).fold(0.0_f64, |s, (a, b)| s.max((a - b).abs())) / size
}

fn iterations(problem: &Problem, tolerance: f64) -> usize {
    let (_, report) = solve(problem, SolverKind::Multigrid, tolerance);
    assert!(report.converged && !report.stagnated && !report.fallback && report.residual <= tolerance, "{report:?}");
    report.iterations
}

/// The dense matrix with fixed unknowns' rows those of the identity, solved by faer.
fn dense_solution(problem: &Problem) -> Vec<f64> {
    use faer::linalg::solvers::Solve;
    let n = problem.rhs.len();
    let mut a = faer::Mat::<f64>::zeros(n, n);
    for i in 0..problem.matrix.rows() {
        for at in problem.matrix.pattern.row(i) {
            let j = problem.matrix.pattern.column[at] as usize;
            for m in 0..9 {
                a[(3 * i + m / 3, 3 * j + m % 3)] = problem.matrix.blocks[at][m];
            }
        }
    }
    let b = faer::Mat::from_fn(n, 1, |i, _| problem.rhs[i]);
    let x = a.partial_piv_lu().solve(&b);
    (0..n).map(|i| x[(i, 0)]).collect()
}

fn kinds(n: usize) -> [(&'static str, Brick); 6] {
    [
        ("elastic", Brick::elastic(n)),
        ("plastic", Brick::plastic(n)),
        ("slipping", Brick::slipping(n)),
        ("all slipping", Brick { patch: Patch::Slip, ..Brick::elastic(n) }),
        ("standard hex8", Brick { mean_dilatation: false, ..Brick::elastic(n) }),
        ("nearly incompressible", Brick { bulk: 50.0, ..Brick::elastic(n) }),
    ]
}

#[test]
fn direct_matches_a_dense_solution() {
    for (name, brick) in kinds(6) {
        let problem = brick.problem();
        let (x, report) = solve(&problem, SolverKind::Direct, 1e-10);
        assert!(report.converged && report.residual < 1e-12, "{name}: {report:?}");
        let error = largest_difference(&dense_solution(&problem), &x);
        assert!(error < 1e-9, "{name}: {error:e}");
    }
}

#[test]
fn multigrid_matches_direct() {
    for (name, brick) in kinds(10) {
        let problem = brick.problem();
        let (direct, _) = solve(&problem, SolverKind::Direct, 1e-10);
        let (multigrid, report) = solve(&problem, SolverKind::Multigrid, 1e-9);
        assert!(report.converged && !report.fallback && report.residual <= 1e-9, "{name}: {report:?}");
        let error = largest_difference(&direct, &multigrid);
        assert!(error < 1e-6, "{name}: {error:e}");
    }
}

#[test]
fn fixed_unknowns_hold_exactly() {
    let problem = Brick::slipping(8).problem();
    for kind in [SolverKind::Multigrid, SolverKind::Direct] {
        let (x, _) = solve(&problem, kind, 1e-2);
        for (k, _) in problem.fixed.iter().enumerate().filter(|(_, fixed)| **fixed) {
            assert_eq!(x[k].to_bits(), problem.rhs[k].to_bits(), "{kind:?} {k}");
        }
    }
}

#[test]
fn iterations_hardly_grow_with_the_mesh() {
    // Graded 1:10 in every direction; 648 to 46,875 unknowns. Measured 6/7/7, 7/9/12, 7/9/12 (to
    // 1e-3): by 5 where the unknowns are 70 times as many.
    for (name, make, bound) in
        [("elastic", Brick::elastic as fn(usize) -> Brick, 9), ("plastic", Brick::plastic, 14), ("slipping", Brick::slipping, 14)]
    {
        let counts = [6, 12, 24].map(|n| iterations(&make(n).problem(), 1e-3));
        println!("{name}: {counts:?}");
        assert!(counts.iter().all(|&count| count <= bound), "{name}: {counts:?}");
        assert!(counts[2] <= counts[1] + 4, "{name}: {counts:?}");
    }
}

#[test]
fn iterations_on_the_sphere() {
    let spec = |per_radius| SphereSpec {
        contact_radius: 0.2,
        elements_per_contact_radius: per_radius,
        fine_zone: 1.5,
        skin_levels: 0,
        first_layer: 1.0,
    };
    // To 1e-2 and to 1e-3, at 51,417 unknowns. Measured 3/5, 7/15, 7/15, 2/6.
    let mesh = sphere_mesh(&spec(16)).unwrap();
    for (name, brick, bounds) in [
        ("elastic", Brick::elastic(1), [5, 7]),
        ("plastic", Brick::plastic(1), [10, 19]),
        ("slipping", Brick::slipping(1), [10, 19]),
        ("nearly incompressible", Brick { bulk: 1000.0, ..Brick::elastic(1) }, [4, 9]),
    ] {
        let problem = brick.on(&mesh);
        let counts = [1e-2, 1e-3].map(|tolerance| iterations(&problem, tolerance));
        println!("{name}: {counts:?}");
        assert!(counts[0] <= bounds[0] && counts[1] <= bounds[1], "{name}: {counts:?}, at most {bounds:?}");
    }
}

#[test]
fn same_bits_at_any_thread_count() {
    // Large enough that every kind of loop is shared out on the finest level.
    let problem = Brick::slipping(16).problem();
    let solutions = [1, 2, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| [SolverKind::Multigrid, SolverKind::Direct].map(|kind| solve(&problem, kind, 1e-8)))
    });
    for other in &solutions[1..] {
        for (a, b) in solutions[0].iter().zip(other) {
            assert_eq!(a.1, b.1);
            assert!(a.0.iter().zip(&b.0).all(|(a, b)| a.to_bits() == b.to_bits()));
        }
    }
}

#[test]
fn an_update_does_not_depend_on_earlier_ones() {
    let (first, second) = (Brick::elastic(8).problem(), Brick::slipping(8).problem());
    let mut solver = solver(&first, SolverKind::Multigrid);
    solver.solve(&first.rhs, 1e-6, &mut vec![0.0; first.rhs.len()]).unwrap();
    solver.update(&second.matrix, &second.fixed).unwrap();
    let mut x = vec![0.0; second.rhs.len()];
    solver.solve(&second.rhs, 1e-6, &mut x).unwrap();
    assert_eq!(x, solve(&second, SolverKind::Multigrid, 1e-6).0);
}

#[test]
fn an_update_of_some_rows_leaves_the_bits_of_an_update_of_all() {
    let problem = Brick::slipping(8).problem();
    let (mut matrix, mut fixed) = (problem.matrix, problem.fixed);
    let new = || Hierarchy::new(&matrix.pattern, &problem.prolongations).unwrap();
    let mut hierarchy = new();
    let check = |hierarchy: &Hierarchy, matrix: &BlockMatrix<f64>, fixed: &[bool], what: &str| {
        let mut fresh = new();
        fresh.update(matrix, fixed).unwrap();
        let mut level = 0;
        while let Some(expected) = fresh.on_level(level) {
            let got = hierarchy.on_level(level).unwrap();
            assert!(got.matrix == expected.matrix, "{what}: the matrix of level {level}");
            assert!(got.inverse == expected.inverse, "{what}: the inverses of level {level}");
            level += 1;
        }
        assert!(level > 1);
    };
    hierarchy.update(&matrix, &fixed).unwrap();
    check(&hierarchy, &matrix, &fixed, "the first");
    hierarchy.update(&matrix, &fixed).unwrap();
    check(&hierarchy, &matrix, &fixed, "nothing new");
    // Numbers of some rows.
    for node in [3, 200, matrix.rows() - 1] {
        let row = matrix.pattern.row(node);
        matrix.blocks[row].iter_mut().for_each(|block| block[4] *= 1.01);
    }
    hierarchy.update(&matrix, &fixed).unwrap();
    check(&hierarchy, &matrix, &fixed, "three rows");
    // The mask: one that is let go, one that is held.
    let held = fixed.iter().position(|fixed| *fixed).unwrap();
    let free = fixed.iter().rposition(|fixed| !fixed).unwrap();
    (fixed[held], fixed[free]) = (false, true);
    hierarchy.update(&matrix, &fixed).unwrap();
    check(&hierarchy, &matrix, &fixed, "the mask");
    // An error in between, whatever it has left.
    let good = matrix.blocks[500];
    matrix.blocks[500][2] = f64::NAN;
    matrix.blocks[900][0] *= 2.0;
    assert!(hierarchy.update(&matrix, &fixed).is_err());
    matrix.blocks[500] = good;
    hierarchy.update(&matrix, &fixed).unwrap();
    check(&hierarchy, &matrix, &fixed, "after an error");
}

#[test]
fn several_right_hand_sides_and_a_guess() {
    let problem = Brick::elastic(8).problem();
    let mut solver = solver(&problem, SolverKind::Multigrid);
    let n = problem.rhs.len();
    let other: Vec<f64> = (0..n).map(|i| (i as f64).cos() * 1e-4).collect();
    let mut solutions = Vec::new();
    for rhs in [&problem.rhs, &other] {
        let mut x = vec![0.0; n];
        solver.solve(rhs, 1e-12, &mut x).unwrap();
        solutions.push(x);
    }
    let sum: Vec<f64> = problem.rhs.iter().zip(&other).map(|(a, b)| a + b).collect();
    let mut x: Vec<f64> = solutions[0].iter().zip(&solutions[1]).map(|(a, b)| a + b).collect();
    // The sum of the solutions is the solution of the sum: as a guess it leaves nothing to do.
    let report = solver.solve(&sum, 1e-9, &mut x).unwrap();
    assert!(report.converged && report.iterations == 0, "{report:?}");
    // A rough guess helps.
    let rough: Vec<f64> = x.iter().map(|x| x * 1.001).collect();
    let (mut from_rough, mut from_zero) = (rough, vec![0.0; n]);
    let [near, far] = [&mut from_rough, &mut from_zero].map(|x| solver.solve(&sum, 1e-6, x).unwrap().iterations);
    assert!(near < far, "{near} {far}");
}

#[test]
fn zero_right_hand_side_gives_zero() {
    let problem = Brick::slipping(6).problem();
    for kind in [SolverKind::Multigrid, SolverKind::Direct] {
        let mut x = vec![0.3; problem.rhs.len()];
        let report = solver(&problem, kind).solve(&vec![0.0; x.len()], 1e-8, &mut x).unwrap();
        assert!(report.converged && x.iter().all(|x| *x == 0.0), "{kind:?} {report:?}");
    }
}

#[test]
fn everything_fixed() {
    let mut problem = Brick::elastic(6).problem();
    problem.fixed.fill(true);
    for kind in [SolverKind::Multigrid, SolverKind::Direct] {
        let (x, report) = solve(&problem, kind, 1e-8);
        assert!(report.converged && report.residual == 0.0, "{kind:?} {report:?}");
        assert_eq!(x, problem.rhs);
    }
}

#[test]
fn whole_coarse_nodes_fixed() {
    // The lower third is held as well: coarse nodes without any stiffness.
    let mut problem = Brick::elastic(9).problem();
    let third = problem.fixed.len() / 3;
    for k in 0..third {
        problem.fixed[k] = true;
        problem.rhs[k] = 0.0;
        problem.matrix.set_identity_row(k / 3, k % 3);
    }
    assert!(iterations(&problem, 1e-6) < 20);
}

#[test]
fn one_node_and_none() {
    let pattern = Pattern::from_elements(1, &[]);
    let mut matrix = BlockMatrix::zeros(pattern.clone());
    matrix.blocks[0] = [2.0, 0.0, 1.0, 0.0, 4.0, 0.0, -1.0, 0.0, 8.0];
    let mut solver = LinearSolver::new(SolverKind::Multigrid, &pattern, &[]).unwrap();
    assert_eq!(solver.kind(), SolverKind::Direct);
    solver.update(&matrix, &[false, false, true]).unwrap();
    let mut x = [0.0; 3];
    solver.solve(&[5.0, 2.0, 3.0], 1e-8, &mut x).unwrap();
    assert_eq!(x, [1.0, 0.5, 3.0]);

    let pattern = Pattern::from_elements(0, &[]);
    let mut solver = LinearSolver::<f64>::new(SolverKind::Direct, &pattern, &[]).unwrap();
    solver.update(&BlockMatrix::zeros(pattern), &[]).unwrap();
    assert!(solver.solve(&[], 1e-8, &mut []).unwrap().converged);
}

#[test]
fn a_mesh_in_pieces() {
    // Three separate elements and two loose nodes with springs to the ground.
    let elements: Vec<[u32; 8]> = (0..3).map(|e| std::array::from_fn(|a| (8 * e + a) as u32)).collect();
    let pattern = Pattern::from_elements(26, &elements);
    let mut matrix = BlockMatrix::zeros(pattern.clone());
    for i in 0..26 {
        for at in pattern.row(i) {
            let spread = |m: usize| ((at * 9 + m) as f64 * 0.618_033_988_749_894_9).fract() - 0.5;
            matrix.blocks[at] =
                std::array::from_fn(|m| if pattern.column[at] as usize == i && m % 4 == 0 { 20.0 } else { spread(m) });
        }
    }
    let rhs: Vec<f64> = (0..78).map(f64::from).collect();
    let problem = Problem { matrix, fixed: vec![false; 78], rhs, prolongations: vec![] };
    let (x, report) = solve(&problem, SolverKind::Direct, 1e-10);
    assert!(report.converged);
    assert!(largest_difference(&dense_solution(&problem), &x) < 1e-12);
}

#[test]
fn not_a_number_is_an_error() {
    let good = Brick::elastic(6).problem();
    for kind in [SolverKind::Multigrid, SolverKind::Direct] {
        for bad in [f64::NAN, f64::INFINITY] {
            let mut problem = Brick::elastic(6).problem();
            let node = 60;
            let at = problem.matrix.pattern.diagonal[node] as usize;
            problem.matrix.blocks[at][1] = bad;
            let mut solver = solver(&good, kind);
            let error = solver.update(&problem.matrix, &problem.fixed).unwrap_err();
            assert_eq!(error, LinalgError::NotFinite { place: "the matrix", node }, "{kind:?}");
            let mut x = vec![0.0; good.rhs.len()];
            assert_eq!(solver.solve(&good.rhs, 1e-2, &mut x).unwrap_err(), LinalgError::NotUpdated);
            // In a row that is not looked at it does no harm.
            problem.fixed[3 * node..3 * node + 3].fill(true);
            solver.update(&problem.matrix, &problem.fixed).unwrap();
            let mut rhs = good.rhs.clone();
            assert!(solver.solve(&rhs, 1e-2, &mut x).unwrap().converged);
            assert!(x.iter().all(|x| x.is_finite()));
            rhs[5] = bad;
            assert!(matches!(solver.solve(&rhs, 1e-2, &mut x), Err(LinalgError::NotFinite { node: 1, .. })));
        }
    }
}

#[test]
fn a_stall_falls_back_to_the_direct_solver_where_that_is_allowed() {
    // Indefinite far beyond what the smoother bears: springs of the wrong sign as strong as the
    // body.
    let mut problem = Brick::elastic(6).problem();
    for i in 0..problem.matrix.rows() {
        let at = problem.matrix.pattern.diagonal[i] as usize;
        for c in (0..3).filter(|c| !problem.fixed[3 * i + c]) {
            problem.matrix.blocks[at][4 * c] *= if (i * 7 + c) % 3 == 0 { -3.0 } else { 0.2 };
        }
    }
    let mut solver = solver(&problem, SolverKind::Multigrid);
    let mut x = vec![0.0; problem.rhs.len()];
    let report = solver.solve(&problem.rhs, 1e-8, &mut x).unwrap();
    assert!(report.fallback && report.stagnated && report.converged && report.residual < 1e-8, "{report:?}");
    assert!(largest_difference(&dense_solution(&problem), &x) < 1e-6);
    solver.set_fallback_limit(0);
    solver.update(&problem.matrix, &problem.fixed).unwrap();
    let error = solver.solve(&problem.rhs, 1e-8, &mut vec![0.0; x.len()]).unwrap_err();
    assert!(matches!(error, LinalgError::Stalled { .. }), "{error}");
}

#[test]
fn a_singular_matrix_is_an_error() {
    let mut problem = Brick::elastic(6).problem();
    let node = 100;
    for at in problem.matrix.pattern.row(node) {
        problem.matrix.blocks[at] = [0.0; 9];
    }
    let mut solver = LinearSolver::new(SolverKind::Direct, &problem.matrix.pattern, &[]).unwrap();
    let update = solver.update(&problem.matrix, &problem.fixed);
    assert!(matches!(update, Err(LinalgError::Singular { .. })), "{update:?}");
}

#[test]
fn sizes_and_chains_that_do_not_fit_are_errors() {
    let (small, large) = (Brick::elastic(6).problem(), Brick::elastic(8).problem());
    let wrong = LinearSolver::<f64>::new(SolverKind::Multigrid, &small.matrix.pattern, &large.prolongations);
    assert!(matches!(wrong, Err(LinalgError::Hierarchy { level: 0, .. })));
    let mut solver = solver(&small, SolverKind::Multigrid);
    assert!(matches!(solver.update(&large.matrix, &large.fixed), Err(LinalgError::Size { .. })));
    assert!(matches!(solver.update(&small.matrix, &large.fixed), Err(LinalgError::Size { .. })));
    solver.update(&small.matrix, &small.fixed).unwrap();
    assert!(matches!(solver.solve(&large.rhs, 1e-2, &mut []), Err(LinalgError::Size { .. })));
}

#[test]
fn the_direct_solver_keeps_to_its_memory() {
    let problem = Brick::elastic(6).problem();
    let mut solver = crate::linalg::DirectSolver::new(&problem.matrix.pattern);
    let need = solver.memory();
    // More than the matrix itself, less than a dense one.
    assert!(need > problem.matrix.blocks.len() * 72 && need < 8 * problem.rhs.len().pow(2), "{need}");
    solver.memory_limit = need - 1;
    let error = solver.update(&problem.matrix, &Default::default()).unwrap_err();
    assert!(matches!(error, LinalgError::TooLarge { .. }));
    assert!(error.to_string().contains("multigrid"));
}
