//! Linear systems solved on a device against the CPU's multigrid: what each leaves of the residual
//! in f64, and how many iterations it takes for that.

use crate::batch::{random, tangents};
use crate::device::device;
use asperity::internals::compute::cpu::Cpu;
use asperity::internals::compute::gpu::{DeviceReal, Gpu, GpuContext, Precision};
use asperity::internals::compute::linear::{self, Ended, Side, SideReport, Solved};
use asperity::internals::compute::{Answer, Call, CaseModel, Compute, Outcome};
use asperity::internals::contact::coulomb::{CONTACT_WEIGHT, Friction, Point, Rows, Status, contact_rows};
use asperity::internals::linalg::{BlockMatrix, LinearSolver, Pattern, SolverKind};
use asperity::internals::mesh::{Mesh, SphereSpec, sphere_mesh};
use asperity::internals::solver::system::{Boundary, apply_contact, fixed_unknowns, plate_functional};
use asperity::material::{Elasticity, Hardening, Material};
use rand::RngExt;
use std::sync::Arc;

const CASES: usize = 3;

pub fn mesh() -> Arc<Mesh> {
    let [mesh, ..] = meshes();
    mesh
}

/// A sphere of even elements, and with elements at the surface that are halved once and twice
/// again.
pub fn meshes() -> [Arc<Mesh>; 3] {
    [0, 1, 2].map(|skin_levels| {
        let spec = SphereSpec { contact_radius: 0.2, elements_per_contact_radius: 4, fine_zone: 1.3, skin_levels };
        Arc::new(sphere_mesh(&spec).unwrap())
    })
}

/// Three spheres: elastic, plastic, nearly incompressible.
pub fn models(mesh: &Arc<Mesh>) -> Vec<CaseModel> {
    let cases = [(Hardening::Elastic, 0.3), (Hardening::ideal(2e-3).unwrap(), 0.3), (Hardening::Elastic, 0.49)];
    let model = |(hardening, nu): (Hardening<f64>, f64)| CaseModel {
        mesh: mesh.clone(),
        material: Material { elasticity: Elasticity::new(1.0, nu), hardening },
        friction: Friction::Coulomb(0.3),
        opponent: None,
    };
    cases.map(model).to_vec()
}

/// One system, and what is asked of it.
pub struct System {
    displacement: Vec<f64>,
    rows: Vec<Rows<f64>>,
    pub fixed: Vec<bool>,
    pub rhs: Vec<f64>,
    pub matrix: BlockMatrix<f64>,
    functional: Vec<f64>,
}

/// Points that stick, slide and are open by chance; every other free unknown has a random force,
/// every fixed one a random displacement.
pub fn system(case: usize, models: &[CaseModel], masked: bool) -> System {
    let mesh = &models[case].mesh;
    let mut rng = random(40 + case as u64);
    let n = 3 * mesh.nodes.len();
    let displacement: Vec<f64> = mesh
        .nodes
        .iter()
        .flat_map(|x| [0.02 * x[0] * x[2], 0.0, -0.004 * x[2] * x[2]])
        .map(|u| u + rng.random_range(-1e-6..1e-6))
        .collect();
    let blocks = tangents(&mut Cpu::<f64>::new(models.to_vec()).unwrap(), &[(case, displacement.clone())]).remove(0).1;
    let rows: Vec<Rows<f64>> = (0..mesh.contact_nodes.len())
        .map(|i| {
            let point = Point {
                force: [rng.random_range(-1e-5..1e-5), 0.0, rng.random_range(-1e-5..3e-5)],
                gap: rng.random_range(-1e-5..1e-5),
                slip: [rng.random_range(-1e-4..1e-4), 0.0],
                weight: CONTACT_WEIGHT * mesh.contact_size[i],
                on_symmetry_plane: mesh.symmetry_nodes.contains(&mesh.contact_nodes[i]),
            };
            contact_rows(Friction::Coulomb(0.3), &point)
        })
        .collect();
    let boundary = Boundary::new(mesh);
    let mut fixed = vec![false; n];
    fixed_unknowns(mesh, &boundary, &rows, &mut fixed);
    if masked {
        fixed.iter_mut().for_each(|fixed| *fixed |= rng.random_bool(0.2));
    }
    let size = |fixed: bool| if fixed { 1e-4 } else { 1e-6 };
    let rhs = fixed.iter().map(|&fixed| size(fixed) * rng.random_range(-1.0..1.0)).collect();
    let mut matrix = BlockMatrix::zeros(Pattern::from_elements(mesh.nodes.len(), &mesh.elements));
    matrix.blocks.copy_from_slice(&blocks);
    let mut functional = vec![0.0; n];
    plate_functional(&matrix, &boundary.plate, &mut functional);
    apply_contact(&mut matrix, mesh, &rows);
    assert!([Status::Open, Status::Stick, Status::Slip].iter().all(|status| rows.iter().any(|row| row.status == *status)));
    System { displacement, rows, fixed, rhs, matrix, functional }
}

impl System {
    /// |b - A x| over the free unknowns over the same at x = 0, in f64; fixed unknowns have to be
    /// right.
    fn residual(&self, x: &[f64]) -> f64 {
        let left = |x: &[f64]| {
            let mut r = vec![0.0; x.len()];
            self.matrix.residual(x, &self.rhs, &mut r);
            r.iter().zip(&self.fixed).filter(|(_, fixed)| !**fixed).map(|(r, _)| r * r).sum::<f64>().sqrt()
        };
        let values = |x: f64, b: f64, fixed: bool| if fixed { b } else { x };
        let zero: Vec<f64> = self.rhs.iter().zip(&self.fixed).map(|(b, fixed)| values(0.0, *b, *fixed)).collect();
        for ((x, b), _) in x.iter().zip(&self.rhs).zip(&self.fixed).filter(|(_, fixed)| **fixed) {
            assert!(x == b || b.is_nan());
        }
        left(x) / left(&zero)
    }
}

/// What is asked of a system: a side of this tolerance from each guess.
fn asked(system: &System, sides: &[(f64, Vec<f64>)], expected: usize, relative_to_guess: bool) -> linear::System {
    let side = |(tolerance, guess): &(f64, Vec<f64>)| Side {
        rhs: system.rhs.clone(),
        tolerance: *tolerance,
        relative_to_guess,
        expected,
        guess: guess.clone(),
    };
    let System { displacement, rows, fixed, .. } = system;
    let (rows, fixed) = (rows.clone(), fixed.clone());
    linear::System { displacement: displacement.as_slice().into(), rows, fixed, sides: sides.iter().map(side).collect() }
}

fn solved(backend: &mut dyn Compute, systems: Vec<(usize, linear::System)>) -> Vec<Solved> {
    let answers = backend.call(systems.into_iter().map(|(case, system)| (case, Call::Solve(system.into()))).collect()).unwrap();
    answers.into_iter().map(|answer| if let Answer::Solved(solved) = answer { solved } else { panic!("{answer:?}") }).collect()
}

pub fn solve(backend: &mut dyn Compute, systems: &[(usize, &System)], tolerance: f64) -> Vec<(Vec<f64>, SideReport)> {
    let zeros = |system: &System| vec![0.0; system.rhs.len()];
    let one = |&(case, system): &(usize, &System)| (case, asked(system, &[(tolerance, zeros(system))], 2, false));
    let answers = solved(backend, systems.iter().map(one).collect());
    let solution = |mut solved: Solved| {
        assert_eq!((solved.outcome, solved.solutions.len()), (Outcome::Valid, 1));
        let solution = solved.solutions.remove(0);
        (solution.x, solution.report)
    };
    answers.into_iter().map(solution).collect()
}

/// The same of one case, from a guess.
fn solve_from(
    backend: &mut dyn Compute,
    (case, system): (usize, &System),
    tolerance: f64,
    relative_to_guess: bool,
    guess: Vec<f64>,
) -> (Vec<f64>, SideReport) {
    let solution =
        solved(backend, vec![(case, asked(system, &[(tolerance, guess)], 2, relative_to_guess))]).remove(0).solutions.remove(0);
    (solution.x, solution.report)
}

fn bits(answers: &[(Vec<f64>, SideReport)]) -> Vec<Vec<u64>> {
    answers.iter().map(|(x, report)| x.iter().chain([&report.along]).map(|x| x.to_bits()).collect()).collect()
}

fn context(name: &str, precision: Precision) -> Option<Arc<GpuContext>> {
    device(name, precision).map(Arc::new)
}

fn meets_tolerances_as_the_cpu_does<R: DeviceReal>(name: &str) {
    for mesh in meshes() {
        let Some(context) = context(name, R::PRECISION) else { return };
        meets_tolerances_on::<R>(name, context, &mesh);
    }
}

fn meets_tolerances_on<R: DeviceReal>(name: &str, context: Arc<GpuContext>, mesh: &Arc<Mesh>) {
    let models = models(mesh);
    let mut gpu = Gpu::<R>::new(context, models.clone()).unwrap();
    for masked in [false, true] {
        let systems: Vec<System> = (0..CASES).map(|case| system(case, &models, masked)).collect();
        let all: Vec<(usize, &System)> = systems.iter().enumerate().collect();
        for tolerance in [0.1, 1e-2, 1e-3, 1e-5] {
            for (system, (x, report)) in systems.iter().zip(solve(&mut gpu, &all, tolerance)) {
                let mut host = LinearSolver::new(SolverKind::Multigrid, &system.matrix.pattern, &mesh.hierarchy).unwrap();
                host.update(&system.matrix, &system.fixed).unwrap();
                let mut reference = vec![0.0; x.len()];
                let on_host = host.solve(&system.rhs, tolerance, &mut reference).unwrap();
                let left = system.residual(&x);
                eprintln!("{name} {tolerance}: {left:.3e}, {} iterations, host {}", report.iterations, on_host.iterations);
                assert_eq!(report.ended, Ended::Converged);
                // f32 resolves 1.2e-5 of the first residual.
                assert!(left <= 1.02 * tolerance.max(1.3e-5), "{left} of {tolerance}");
                assert!(report.iterations.abs_diff(on_host.iterations) <= 1, "{} and {}", report.iterations, on_host.iterations);
                let along: f64 = system.functional.iter().zip(&x).map(|(w, x)| w * x).sum();
                let size: f64 = system.functional.iter().zip(&x).map(|(w, x)| (w * x).abs()).sum();
                assert!((report.along - along).abs() <= 1e-5 * size, "{} and {along} of {size}", report.along);
            }
        }
    }
}

#[test]
fn a_device_in_f64_meets_tolerances_as_the_cpu_does() {
    meets_tolerances_as_the_cpu_does::<f64>("a_device_in_f64_meets_tolerances_as_the_cpu_does");
}

#[test]
fn a_device_in_f32_meets_tolerances_as_the_cpu_does() {
    meets_tolerances_as_the_cpu_does::<f32>("a_device_in_f32_meets_tolerances_as_the_cpu_does");
}

/// A system alone, among others, in another slot, beside one that is done at once, and once more.
#[test]
fn a_solution_has_the_same_bits_whatever_is_solved_beside_it() {
    let name = "a_solution_has_the_same_bits_whatever_is_solved_beside_it";
    let Some(context) = context(name, Precision::F32) else { return };
    let mesh = mesh();
    let models = models(&mesh);
    let mut systems: Vec<System> = (0..CASES).map(|case| system(case, &models, false)).collect();
    let mut gpu = Gpu::<f32>::new(context, models.clone()).unwrap();
    let all: Vec<(usize, &System)> = systems.iter().enumerate().collect();
    let together = bits(&solve(&mut gpu, &all, 1e-3));
    assert!(bits(&solve(&mut gpu, &all, 1e-3)) == together, "again");
    for case in 0..CASES {
        assert!(bits(&solve(&mut gpu, &[(case, &systems[case])], 1e-3))[0] == together[case], "case {case} alone");
    }
    let turned = bits(&solve(&mut gpu, &[(2, &systems[2]), (0, &systems[0])], 1e-3));
    assert!(turned[0] == together[2] && turned[1] == together[0]);
    systems[0].rhs.fill(0.0);
    let all: Vec<(usize, &System)> = systems.iter().enumerate().collect();
    let beside = solve(&mut gpu, &all, 1e-3);
    assert!(beside[0].0.iter().all(|x| *x == 0.0) && beside[0].1.iterations == 0);
    assert!(bits(&beside)[1..] == together[1..]);
}

/// One case asks for two sides, the others for one; some have guesses, some begin at zero.
#[test]
fn a_dispatch_takes_different_numbers_of_sides_and_guesses() {
    let name = "a_dispatch_takes_different_numbers_of_sides_and_guesses";
    let Some(context) = context(name, Precision::F32) else { return };
    let mesh = mesh();
    let models = models(&mesh);
    let systems: Vec<System> = (0..CASES).map(|case| system(case, &models, false)).collect();
    let mut gpu = Gpu::<f32>::new(context, models).unwrap();
    // By case: the sides' guesses, in 1e-6 everywhere; 0 is no guess.
    let guesses: [&[f64]; CASES] = [&[0.0, 1.0], &[0.0], &[-1.0]];
    let mut answers = |cases: &[usize]| -> Vec<Vec<Vec<u64>>> {
        let n = systems[0].rhs.len();
        let call = |&case: &usize| {
            let guesses = guesses[case].iter().map(|guess| vec![1e-6 * guess; n]);
            let sides: Vec<(f64, Vec<f64>)> = [1e-2, 1e-3].into_iter().zip(guesses).collect();
            (case, asked(&systems[case], &sides, 1, false))
        };
        let answers = solved(&mut gpu, cases.iter().map(call).collect());
        for (&case, solved) in cases.iter().zip(&answers) {
            assert_eq!(solved.solutions.len(), guesses[case].len());
            for (solution, tolerance) in solved.solutions.iter().zip([1e-2, 1e-3]) {
                assert!(solution.report.ended == Ended::Converged && solution.report.iterations > 0);
                assert!(systems[case].residual(&solution.x) <= 1.02 * tolerance);
            }
        }
        let bits = |solved: &Solved| solved.solutions.iter().map(|s| s.x.iter().map(|x| x.to_bits()).collect()).collect();
        answers.iter().map(bits).collect()
    };
    let together = answers(&[0, 1, 2]);
    for case in 0..CASES {
        assert!(answers(&[case])[0] == together[case], "case {case} alone");
    }
}

/// Where the solver's arrays do not fit, nobody tries; where they do, all of them are in the
/// account.
#[test]
fn too_little_memory_leaves_the_systems_to_the_host() {
    let name = "too_little_memory_leaves_the_systems_to_the_host";
    let Some(context) = context(name, Precision::F32) else { return };
    let mesh = mesh();
    let models = &models(&mesh)[..1];
    let system = system(0, models, false);
    let gpu = Gpu::<f32>::new(context.clone(), models.to_vec()).unwrap();
    let used = context.budget().used();
    drop((gpu, context));
    let nodes = mesh.nodes.len() as u64;
    // Krylov and preconditioned vectors alone.
    assert!(used > 4 * 61 * 3 * nodes, "{used} bytes for {nodes} nodes");
    let context = device(name, Precision::F32).unwrap().with_budget(used - (1 << 20));
    let mut gpu = Gpu::<f32>::new(Arc::new(context), models.to_vec()).unwrap();
    assert!(gpu.notes().len() == 1 && gpu.notes()[0].contains("solved on the CPU"), "{:?}", gpu.notes());
    assert!(!gpu.about().solves);
    let system = asked(&system, &[(0.1, vec![0.0; system.rhs.len()])], 2, false);
    assert!(solved(&mut gpu, vec![(0, system)])[0].solutions.is_empty());
}

/// More iterations than one list has, and more than one cycle of vectors; a guess; numbers that are
/// not finite; a mesh without a hierarchy, where nobody tries.
#[test]
fn a_hard_system_a_guess_and_what_cannot_be_solved() {
    let name = "a_hard_system_a_guess_and_what_cannot_be_solved";
    let Some(context) = context(name, Precision::F32) else { return };
    let mesh = mesh();
    let models = models(&mesh);
    let mut gpu = Gpu::<f32>::new(context.clone(), models.clone()).unwrap();
    let mut hard = system(2, &models, false);
    let x = solve(&mut gpu, &[(2, &hard)], 1e-5).remove(0).0;
    // Its own solution as the guess, asked for by the residual at the guess.
    let (mut again, report) = solve_from(&mut gpu, (2, &hard), 1e-3, false, x);
    assert!(
        (report.ended, report.iterations) == (Ended::Converged, 0) && report.start_norm < 2e-5 * report.rhs_norm,
        "{report:?}"
    );
    again.iter_mut().for_each(|x| *x *= 0.5);
    let (again, report) = solve_from(&mut gpu, (2, &hard), 0.1, true, again);
    assert!(
        report.ended == Ended::Converged && report.iterations > 0 && report.residual <= 0.1 * report.start_norm,
        "{report:?}"
    );
    assert!(hard.residual(&again) <= 0.101 * report.start_norm / report.rhs_norm);

    hard.rhs[0] = f64::NAN;
    assert_eq!(solve(&mut gpu, &[(2, &hard)], 1e-2)[0].1.ended, Ended::NotFinite);
    let flat: Vec<CaseModel> = crate::batch::models([2, 2, 2]);
    let mut gpu = Gpu::<f32>::new(context, flat.clone()).unwrap();
    let n = 3 * flat[0].mesh.nodes.len();
    let (zeros, fixed) = (vec![0.0; n], vec![false; n]);
    let side = Side { rhs: zeros.clone(), tolerance: 0.1, relative_to_guess: false, expected: 1, guess: zeros.clone() };
    let system = linear::System { displacement: zeros.into(), rows: Vec::new(), fixed, sides: vec![side] };
    assert!(!gpu.about().solves && solved(&mut gpu, vec![(0, system)])[0].solutions.is_empty());
}

/// More iterations than a cycle has vectors: the next begins at the answer of the last. The other
/// system of the list has long been done then, and keeps its bits.
#[test]
fn a_cycle_that_is_full_begins_anew() {
    let name = "a_cycle_that_is_full_begins_anew";
    let Some(context) = context(name, Precision::F32) else { return };
    let mesh = mesh();
    let mut models = models(&mesh);
    models[1].material.elasticity = Elasticity::new(1.0, 0.497);
    let systems: Vec<System> = (0..2).map(|case| system(case, &models, true)).collect();
    let mut gpu = Gpu::<f32>::new(context, models).unwrap();
    let alone = bits(&solve(&mut gpu, &[(0, &systems[0])], 2e-3));
    let both = solve(&mut gpu, &[(0, &systems[0]), (1, &systems[1])], 2e-3);
    eprintln!("{} and {} iterations", both[0].1.iterations, both[1].1.iterations);
    assert!(both.iter().all(|(_, report)| report.ended == Ended::Converged));
    assert!(both[0].1.iterations < 30 && both[1].1.iterations > 30);
    assert!(systems[1].residual(&both[1].0) <= 2.05e-3);
    assert!(bits(&both)[0] == alone[0]);
}
