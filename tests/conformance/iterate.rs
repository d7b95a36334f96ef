//! Newton's iterates on a device against those of the CPU: what is read of the same trial, what a
//! correction leaves of its linear system, and what passes on the way.

use crate::batch::{random, tangents};
use crate::device::device;
use crate::linear::mesh;
use asperity::internals::compute::cpu::Cpu;
use asperity::internals::compute::gpu::{Gpu, Precision};
use asperity::internals::compute::handle::CaseHandle;
use asperity::internals::compute::iterate::{Ask, Begin, Correct, Corrected, From, Keeps, Plate, Reading, Reply, Request};
use asperity::internals::compute::linear::Ended;
use asperity::internals::compute::traffic::Traffic;
use asperity::internals::compute::{Answer, Call, CaseModel, Compute, Fault, Outcome};
use asperity::internals::contact::coulomb::{Friction, Status};
use asperity::internals::linalg::{BlockMatrix, LinearSolver, Pattern, SolverKind};
use asperity::internals::solver::iterate::SetOut;
use asperity::internals::solver::newton::Newton;
use asperity::internals::solver::phases::PhaseTimes;
use asperity::internals::solver::pose::Pose;
use asperity::internals::solver::system::{Boundary, Trial, apply_contact, fixed_unknowns, plate_functional, right_hand_side};
use asperity::internals::solver::{Control, Settings, StepOutcome};
use asperity::material::{Elasticity, Hardening, Material};
use rand::RngExt;
use std::sync::Arc;

const DEPTH: f64 = 0.004;

/// Spheres that are elastic and slide a little, plastic under full stick, and plastic without
/// friction.
fn models() -> Vec<CaseModel> {
    let mesh = mesh();
    let cases = [
        (Hardening::Elastic, Friction::Coulomb(0.3)),
        (Hardening::ideal(2e-3).unwrap(), Friction::Stick),
        (Hardening::ideal(4e-3).unwrap(), Friction::Coulomb(0.0)),
    ];
    let model = |(hardening, friction)| CaseModel {
        mesh: mesh.clone(),
        material: Material { elasticity: Elasticity::new(1.0, 0.3), hardening },
        friction,
        opponent: None,
    };
    cases.map(model).to_vec()
}

/// A batch on a device, each case pressed to [`DEPTH`] in a step, and the same on the CPU.
struct Pressed {
    gpu: Gpu<f64>,
    cpu: Cpu<f64>,
    models: Vec<CaseModel>,
    displacement: Vec<Vec<f64>>,
}

fn pressed(name: &str) -> Option<Pressed> {
    let context = Arc::new(device(name, Precision::F64)?);
    let models = models();
    let mut gpu = Gpu::<f64>::new(context, models.clone()).unwrap();
    let mut cpu = Cpu::<f64>::new(models.clone()).unwrap();
    let settings = Settings {
        tolerance: 1e-4,
        max_iterations: 60,
        loosest_linear: 0.1,
        held_linear: 0.01,
        first_linear: f64::INFINITY,
        monotone_from: 2,
    };
    let control = Control { h: DEPTH, pose: Pose::along_x(0.0), normal_force: None };
    let mut displacement = Vec::new();
    for (case, model) in models.iter().enumerate() {
        let mesh = &model.mesh;
        let pattern = Pattern::from_elements(mesh.nodes.len(), &mesh.elements);
        let linear = LinearSolver::<f32>::new(SolverKind::Multigrid, &pattern, &mesh.hierarchy).unwrap();
        let mut newton = Newton::new(mesh, linear, settings);
        let zero = vec![0.0; 3 * mesh.nodes.len()];
        let start =
            SetOut { displacement: &zero, h: 0.0, pose: Pose::default(), guess: None, extrapolation: None, came_off: &[] };
        let mut handle = CaseHandle { backend: &mut gpu, case };
        assert_eq!(newton.keeps_on(&handle), Keeps::Steps);
        let outcome = newton.solve(&mut handle, &start, &control).unwrap();
        assert!(matches!(outcome, StepOutcome::Converged(_)), "{outcome:?}");
        let settled = newton.settle(&mut handle).unwrap().unwrap();
        assert!(settled.points.iter().any(|point| point.status != Status::Open) && settled.energies.elastic > 0.0);
        let state = handle.state().unwrap();
        displacement.push(state.displacement.clone());
        CaseHandle { backend: &mut cpu, case }.restore(state).unwrap();
    }
    Some(Pressed { gpu, cpu, models, displacement })
}

fn plate(control: &Control) -> Plate {
    Plate { h: control.h, delta_t: control.pose.shift[0], held: control.normal_force }
}

fn ask(gpu: &mut Gpu<f64>, asks: &[(usize, bool, Plate, Ask)]) -> Vec<Reply> {
    let request = |(case, kept, plate, ask): &(usize, bool, Plate, Ask)| {
        (*case, Call::Iterate(Request { kept: *kept, plate: *plate, ask: ask.clone() }))
    };
    let answers = gpu.call(asks.iter().map(request).collect()).unwrap();
    answers.into_iter().map(|answer| if let Answer::Iterate(reply) = answer { reply } else { panic!("{answer:?}") }).collect()
}

fn reading(answer: &Reply) -> Reading {
    let Reply::Reading(reading) = answer else { panic!("{answer:?}") };
    *reading
}

fn begin() -> Ask {
    Ask::Begin(Begin { from: From::Start, sliding: None })
}

/// What the host makes of a trial at a displacement.
fn on_host(pressed: &mut Pressed, case: usize, u: &[f64], h: f64, control: &Control) -> (Trial, Boundary) {
    let mesh = pressed.models[case].mesh.clone();
    let boundary = Boundary::new(&mesh);
    let mut trial = Trial::new(&mesh);
    trial.u.copy_from_slice(u);
    trial.h = h;
    let mut handle = CaseHandle { backend: &mut pressed.cpu, case };
    let outcome = trial.evaluate(&mut handle, &boundary, control, &mut PhaseTimes::default()).unwrap();
    assert_eq!(outcome, Outcome::Valid);
    (trial, boundary)
}

fn near(what: &str, ours: f64, theirs: f64, scale: f64) {
    assert!((ours - theirs).abs() <= 1e-9 * scale, "{what}: {ours:e}, not {theirs:e}");
}

/// The same trials on both: every number by which the iteration goes on.
#[test]
fn a_trial_reads_as_on_the_cpu() {
    let Some(mut pressed) = pressed("a_trial_reads_as_on_the_cpu") else { return };
    for case in 0..pressed.models.len() {
        for held in [None, Some(1e-4)] {
            let mesh = pressed.models[case].mesh.clone();
            let control = Control { h: DEPTH + 1e-4, pose: Pose::along_x(2e-4), normal_force: held };
            let start = pressed.displacement[case].clone();
            let at_start = reading(&ask(&mut pressed.gpu, &[(case, false, plate(&control), begin())])[0]);
            let (current, boundary) = on_host(&mut pressed, case, &start, control.h, &control);
            near("merit", at_start.merit, current.merit, current.merit);
            near("plate force", at_start.plate_force, current.plate_force, current.plate_force);
            let mut fixed = vec![false; start.len()];
            fixed_unknowns(&mesh, &boundary, &current.rows, &mut fixed);
            let mut rng = random(70 + case as u64);
            let correction: Vec<f64> = start.iter().map(|_| rng.random_range(-2e-5..2e-5)).collect();
            ask(&mut pressed.gpu, &[(case, false, plate(&control), Ask::Give(correction.clone()))]);
            for (length, delta_h) in [(1.0, 3e-5), (0.3, 3e-5)] {
                let tried = reading(&ask(&mut pressed.gpu, &[(case, false, plate(&control), Ask::Try(length, delta_h))])[0]);
                let h = control.h + length * delta_h;
                let mut u: Vec<f64> = start.iter().zip(&correction).map(|(u, d)| u + length * d).collect();
                if length == 1.0 {
                    boundary.place_plate(&mut u, h, &control.pose);
                }
                let (trial, _) = on_host(&mut pressed, case, &u, h, &control);
                near("merit", tried.merit, trial.merit, trial.merit);
                near("force scale", tried.force_scale, trial.force_scale, trial.force_scale);
                near("plate force", tried.plate_force, trial.plate_force, trial.force_scale);
                near("tangential", tried.tangential, trial.tangential_residual(), trial.merit);
                near("normal force", tried.normal_force, trial.contact_force(&mesh, &boundary)[2], trial.force_scale);
                let free = || trial.residual.iter().zip(&correction).zip(&fixed).filter(|(_, fixed)| !**fixed);
                let (slope, size) = free().fold((0.0, 0.0), |(s, t), ((r, d), _)| (s + r * d, t + (r * d).abs()));
                near("slope", tried.slope, slope, size);
                let changed = trial.rows.iter().zip(&current.rows).filter(|(a, b)| a.status != b.status).count();
                let released: f64 = (trial.rows.iter().zip(&current.rows))
                    .filter(|(after, before)| before.status == Status::Stick && after.status == Status::Open)
                    .map(|(after, _)| after.residual[0].powi(2) + if after.fixed[1] { 0.0 } else { after.residual[1].powi(2) })
                    .sum();
                assert_eq!(tried.changed, changed);
                near("released", tried.released, released, trial.merit * trial.merit);
            }
            // A deformation that no element has.
            let far: Vec<f64> = (0..start.len()).map(|i| if i % 7 == 0 { 5.0 } else { 0.0 }).collect();
            ask(&mut pressed.gpu, &[(case, false, plate(&control), Ask::Give(far))]);
            let tried = reading(&ask(&mut pressed.gpu, &[(case, false, plate(&control), Ask::Try(1.0, 0.0))])[0]);
            assert!(
                matches!(tried.outcome, Outcome::Invalid(Fault::Inverted { .. })) && tried.merit == f64::INFINITY,
                "{tried:?}"
            );
        }
    }
}

fn correct(tolerance: f64, plate_force: f64) -> Ask {
    Ask::Correct(Correct { tolerance, expected: 12, unit_tolerance: 1e-4, unit_expected: 12, first: true, plate_force })
}

fn corrected(answer: &Reply) -> Corrected {
    let Reply::Corrected(corrected) = answer else { panic!("{answer:?}") };
    *corrected
}

/// A correction solves the system that the host states in f64, to the tolerance that was asked; one
/// under a held force brings the plate's to it.
#[test]
fn a_correction_solves_the_hosts_system() {
    let Some(mut pressed) = pressed("a_correction_solves_the_hosts_system") else { return };
    for case in 0..pressed.models.len() {
        let mesh = pressed.models[case].mesh.clone();
        let start = pressed.displacement[case].clone();
        for held in [false, true] {
            let mut control = Control { h: DEPTH, pose: Pose::along_x(1e-4), normal_force: None };
            let (current, boundary) = on_host(&mut pressed, case, &start, control.h, &control);
            let target = 1.1 * current.plate_force;
            control.normal_force = held.then_some(target);
            let begun = reading(&ask(&mut pressed.gpu, &[(case, false, plate(&control), begin())])[0]);
            let asked = correct(1e-4, begun.plate_force);
            let found = corrected(&ask(&mut pressed.gpu, &[(case, false, plate(&control), asked)])[0]);
            assert_eq!((found.tangent, found.report.ended), (Outcome::Valid, Ended::Converged));
            // The whole correction becomes the iterate, so that it can be read.
            let brought = ask(&mut pressed.gpu, &[(case, true, plate(&control), Ask::Bring)]).remove(0);
            let Reply::Vectors(vectors) = brought else { panic!("{brought:?}") };
            let x: Vec<f64> = vectors.displacement.iter().zip(&start).map(|(a, b)| a - b).collect();

            let blocks = tangents(&mut pressed.cpu, &[(case, start.clone())]).remove(0).1;
            let mut matrix = BlockMatrix::zeros(Pattern::from_elements(mesh.nodes.len(), &mesh.elements));
            matrix.blocks.copy_from_slice(&blocks);
            let mut functional = vec![0.0; x.len()];
            plate_functional(&matrix, &boundary.plate, &mut functional);
            apply_contact(&mut matrix, &mesh, &current.rows);
            let (mut fixed, mut rhs) = (vec![false; x.len()], vec![0.0; x.len()]);
            fixed_unknowns(&mesh, &boundary, &current.rows, &mut fixed);
            right_hand_side(&current, &mesh, &boundary, &mut rhs);
            let left = |x: &[f64]| {
                let mut r = vec![0.0; x.len()];
                matrix.residual(x, &rhs, &mut r);
                r.iter().zip(&fixed).filter(|(_, fixed)| !**fixed).map(|(r, _)| r * r).sum::<f64>().sqrt()
            };
            let nothing: Vec<f64> = rhs.iter().zip(&fixed).map(|(b, fixed)| if *fixed { *b } else { 0.0 }).collect();
            if held {
                let along: f64 = functional.iter().zip(&x).map(|(w, x)| w * x).sum();
                let missing = target - (current.plate_force - along);
                assert!(found.unit.is_some() && missing.abs() <= 1e-3 * target, "{missing} of {target}");
                assert!(found.delta_h > 0.0);
            } else {
                assert!(found.unit.is_none() && left(&x) <= 1.02e-4 * left(&nothing), "{} of {}", left(&x), left(&nothing));
            }
            let (then, _) = on_host(&mut pressed, case, &vectors.displacement, control.h + found.delta_h, &control);
            near("merit", found.trial.merit, then.merit, then.merit);
        }
    }
}

/// What is read of cases does not depend on who is beside them; and few bytes pass, whatever the
/// batch, in one submission and one wait, where a force is held too.
#[test]
fn a_batch_reads_as_its_cases_alone_and_little_passes() {
    let Some(mut pressed) = pressed("a_batch_reads_as_its_cases_alone_and_little_passes") else { return };
    let gpu = &mut pressed.gpu;
    for held in [None, Some(2e-4)] {
        let control = Control { h: DEPTH + 2e-4, pose: Pose::along_x(0.0), normal_force: held };
        let round = |gpu: &mut Gpu<f64>, cases: &[usize]| -> Vec<(Reading, Corrected)> {
            let (answers, passed) = correct_from_start(gpu, cases, &control, 0.1, [12, 12]);
            let count = cases.len() as u64;
            assert!(passed.bytes_up <= 512 * count && passed.bytes_down <= 256 * count, "{passed:?} for {count}");
            assert!(passed.submissions <= 2 && passed.waits == 1, "{passed:?}");
            // 13 Krylov iterations are sent off, for a system and for the response to the plate.
            let systems = 1 + u64::from(held.is_some());
            assert!(passed.dispatches <= 30 * 13 * systems + 40, "{passed:?}");
            answers
        };
        let together = round(gpu, &[0, 1, 2]);
        assert!(together.iter().all(|(_, found)| found.report.ended == Ended::Converged));
        assert!(together.iter().all(|(_, found)| found.unit.is_some() == held.is_some()));
        for case in 0..3 {
            assert_eq!(round(gpu, &[case])[0], together[case], "case {case} alone");
        }
        let turned = round(gpu, &[2, 0]);
        assert_eq!((turned[0], turned[1]), (together[2], together[0]));
    }
}

/// How many Krylov iterations are sent off at first changes no bit: neither where a correction
/// takes more, nor where the response to the plate does, nor where both do.
#[test]
fn a_list_that_is_too_short_changes_no_bit() {
    let Some(mut pressed) = pressed("a_list_that_is_too_short_changes_no_bit") else { return };
    let gpu = &mut pressed.gpu;
    for held in [None, Some(2e-4)] {
        let control = Control { h: DEPTH + 2e-4, pose: Pose::along_x(0.0), normal_force: held };
        let (expected, _) = correct_from_start(gpu, &[0, 1, 2], &control, 1e-3, [20, 20]);
        for lists in [[0, 20], [20, 0], [0, 0]] {
            let (found, passed) = correct_from_start(gpu, &[0, 1, 2], &control, 1e-3, lists);
            let short = lists[0] == 0 || held.is_some();
            assert!(!short || passed.waits > 1, "{lists:?}: {passed:?}");
            assert_eq!(found, expected, "{lists:?}");
        }
    }
}

/// Corrections from the start of the step, so many Krylov iterations expected for the correction
/// and the response to the plate, and what passed on the way.
fn correct_from_start(
    gpu: &mut Gpu<f64>,
    cases: &[usize],
    control: &Control,
    tolerance: f64,
    [expected, unit_expected]: [usize; 2],
) -> (Vec<(Reading, Corrected)>, Traffic) {
    let all = |ask: &dyn Fn(usize) -> Ask| -> Vec<(usize, bool, Plate, Ask)> {
        cases.iter().enumerate().map(|(i, &case)| (case, false, plate(control), ask(i))).collect()
    };
    let begun: Vec<Reading> = ask(gpu, &all(&|_| begin())).iter().map(reading).collect();
    let correct = |i: usize| {
        let plate_force = begun[i].plate_force;
        Ask::Correct(Correct { tolerance, expected, unit_tolerance: 0.1 * tolerance, unit_expected, first: true, plate_force })
    };
    let before = gpu.about().traffic.unwrap();
    let answers = ask(gpu, &all(&correct));
    let passed = gpu.about().traffic.unwrap() - before;
    (begun.into_iter().zip(answers.iter().map(corrected)).collect(), passed)
}
