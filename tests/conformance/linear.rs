//! Linear systems solved on a device: bits, guesses, memory, and what cannot be solved.

use crate::device::device;
use asperity::internals::compute::gpu::{Gpu, GpuContext, Precision};
use asperity::internals::compute::linear::{self, Ended, Side, SideReport, Solved};
use asperity::internals::compute::{CaseModel, Compute};
use asperity::internals::conformance::batch;
use asperity::internals::conformance::kernels::every_level_has_the_cpus_matrix_and_its_v_cycle;
use asperity::internals::conformance::linear::{
    CASES, TestSystem, asked, meets_tolerances_as_the_cpu_does, meets_tolerances_down_to_one_element,
    meets_tolerances_on_two_levels, mesh, models, solve, solved, system,
};
use asperity::material::Elasticity;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::sync::Arc;

/// Those with which a device in f32 has always met its tolerances (see the comparison).
fn numbers(seed: u64) -> Box<dyn FnMut(f64, f64) -> f64> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    Box::new(move |low, high| rng.random_range(low..high))
}

/// The same of one case, from a guess.
fn solve_from(
    backend: &mut dyn Compute,
    (case, system): (usize, &TestSystem),
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

#[test]
fn a_device_in_f64_meets_tolerances_as_the_cpu_does() {
    let Some(context) = context("a_device_in_f64_meets_tolerances_as_the_cpu_does", Precision::F64) else { return };
    meets_tolerances_as_the_cpu_does::<f64>(&context, numbers);
    meets_tolerances_on_two_levels::<f64>(&context, numbers);
}

#[test]
fn a_device_in_f32_meets_tolerances_as_the_cpu_does() {
    let Some(context) = context("a_device_in_f32_meets_tolerances_as_the_cpu_does", Precision::F32) else { return };
    meets_tolerances_as_the_cpu_does::<f32>(&context, numbers);
    meets_tolerances_on_two_levels::<f32>(&context, numbers);
}

#[test]
fn a_device_meets_tolerances_down_to_one_element() {
    let Some(context) = context("a_device_meets_tolerances_down_to_one_element", Precision::F64) else { return };
    meets_tolerances_down_to_one_element(&context);
}

/// Of kernels too: matrices, inverses and what a V-cycle takes and leaves on every level.
#[test]
fn kernels_leave_the_cpus_matrix_and_its_v_cycle_on_every_level() {
    let name = "kernels_leave_the_cpus_matrix_and_its_v_cycle_on_every_level";
    let Some(context) = context(name, Precision::F64) else { return };
    every_level_has_the_cpus_matrix_and_its_v_cycle(&context, numbers, |seed| {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        Box::new(move || rng.random_range(-1.0..1.0))
    });
}

/// A system alone, among others, in another slot, beside one that is done at once, and once more.
#[test]
fn a_solution_has_the_same_bits_whatever_is_solved_beside_it() {
    let name = "a_solution_has_the_same_bits_whatever_is_solved_beside_it";
    let Some(context) = context(name, Precision::F32) else { return };
    let mesh = mesh();
    let models = models(&mesh);
    let mut systems: Vec<TestSystem> = (0..CASES).map(|case| system(numbers, case, &models, false)).collect();
    let mut gpu = Gpu::<f32>::new(context, models.clone()).unwrap();
    let all: Vec<(usize, &TestSystem)> = systems.iter().enumerate().collect();
    let together = bits(&solve(&mut gpu, &all, 1e-3));
    assert!(bits(&solve(&mut gpu, &all, 1e-3)) == together, "again");
    for case in 0..CASES {
        assert!(bits(&solve(&mut gpu, &[(case, &systems[case])], 1e-3))[0] == together[case], "case {case} alone");
    }
    let turned = bits(&solve(&mut gpu, &[(2, &systems[2]), (0, &systems[0])], 1e-3));
    assert!(turned[0] == together[2] && turned[1] == together[0]);
    systems[0].rhs.fill(0.0);
    let all: Vec<(usize, &TestSystem)> = systems.iter().enumerate().collect();
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
    let systems: Vec<TestSystem> = (0..CASES).map(|case| system(numbers, case, &models, false)).collect();
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
    let system = system(numbers, 0, models, false);
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
    let mut hard = system(numbers, 2, &models, false);
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
    let flat: Vec<CaseModel> = batch::models([2, 2, 2]);
    let mut gpu = Gpu::<f32>::new(context, flat.clone()).unwrap();
    let n = 3 * flat[0].mesh.nodes.len();
    let (zeros, fixed) = (vec![0.0; n], vec![false; n]);
    let side = Side { rhs: zeros.clone(), tolerance: 0.1, relative_to_guess: false, expected: 1, guess: zeros.clone() };
    let system = linear::SolveRequest {
        displacement: zeros.into(),
        rows: Vec::new(),
        frames: Vec::new(),
        fixed,
        tie: None,
        sides: vec![side],
    };
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
    let systems: Vec<TestSystem> = (0..2).map(|case| system(numbers, case, &models, true)).collect();
    let mut gpu = Gpu::<f32>::new(context, models).unwrap();
    let alone = bits(&solve(&mut gpu, &[(0, &systems[0])], 2e-3));
    let both = solve(&mut gpu, &[(0, &systems[0]), (1, &systems[1])], 2e-3);
    eprintln!("{} and {} iterations", both[0].1.iterations, both[1].1.iterations);
    assert!(both.iter().all(|(_, report)| report.ended == Ended::Converged));
    assert!(both[0].1.iterations < 30 && both[1].1.iterations > 30);
    assert!(systems[1].residual(&both[1].0) <= 2.05e-3);
    assert!(bits(&both)[0] == alone[0]);
}
