//! Newton's iterates on a device against those of the CPU: what is read of the same trial, what a
//! correction leaves of its linear system, and what passes on the way.

use super::batch::{random, tangents};
use super::linear::{mesh, whole_mesh};
use crate::compute::cpu::Cpu;
use crate::compute::gpu::{Gpu, GpuContext};
use crate::compute::handle::CaseHandle;
use crate::compute::iterate::{Ask, Begin, Correct, Corrected, From, Keeps, Plate, Reading, Reply, Request};
use crate::compute::linear::Ended;
use crate::compute::{Answer, Call, CaseModel, Compute, Evaluated, Fault};
use crate::contact::coulomb::{Friction, Status};
use crate::contact::rigid::Rigid;
use crate::linalg::{BlockMatrix, LinearSolver, Pattern, SolverKind};
use crate::material::{Elasticity, FlowStress, Material};
use crate::mesh::Mesh;
use crate::solver::boundary::Boundary;
use crate::solver::contact_rows::{apply_contact, turn};
use crate::solver::iterate::SetOut;
use crate::solver::newton::Newton;
use crate::solver::opponent::Opponent;
use crate::solver::opponent::rigid::RigidBody;
use crate::solver::phases::PhaseTimes;
use crate::solver::pose::Pose;
use crate::solver::system::{fixed_unknowns, plate_functional, right_hand_side};
use crate::solver::trial::Trial;
use crate::solver::{Control, Settings, StepOutcome};
use std::sync::Arc;

/// Depth to which the cases are pressed.
pub const DEPTH: f64 = 0.004;

/// Spheres on a plane that are elastic and slide a little, plastic under full stick, and plastic
/// without friction; and plastic ones on spheres, with friction and without.
fn models(mesh: &Arc<Mesh>) -> Vec<CaseModel> {
    let cases = [
        (FlowStress::Elastic, Friction::Coulomb(0.3), 0.0),
        (FlowStress::ideal(2e-3).unwrap(), Friction::Stick, 0.0),
        (FlowStress::ideal(4e-3).unwrap(), Friction::Coulomb(0.0), 0.0),
        (FlowStress::ideal(2e-3).unwrap(), Friction::Coulomb(0.3), 1.25),
        (FlowStress::ideal(4e-3).unwrap(), Friction::Coulomb(0.0), 0.5),
    ];
    let model = |(hardening, friction, curvature)| CaseModel {
        mesh: mesh.clone(),
        material: Material { elasticity: Elasticity::new(1.0, 0.3), hardening },
        friction,
        opponent: None,
        image: None,
        surface: Rigid { curvature },
    };
    cases.map(model).to_vec()
}

/// A batch on a device, each case pressed to [`DEPTH`] in a step, and the same on the CPU.
pub struct Pressed {
    /// The device.
    pub gpu: Gpu<f64>,
    cpu: Cpu<f64>,
    /// The cases.
    pub models: Vec<CaseModel>,
    displacement: Vec<Vec<f64>>,
}

/// Presses the cases on a device.
pub fn pressed(context: &Arc<GpuContext>) -> Pressed {
    pressed_on(context, &mesh())
}

/// The same on a mesh.
fn pressed_on(context: &Arc<GpuContext>, mesh: &Arc<Mesh>) -> Pressed {
    let models = models(mesh);
    let mut gpu = Gpu::<f64>::new(context.clone(), models.clone()).unwrap();
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
        let mut newton = Newton::new(mesh, linear, settings).against(Box::new(opponent(model)));
        let zero = vec![0.0; 3 * mesh.nodes.len()];
        let start =
            SetOut { displacement: &zero, h: 0.0, pose: Pose::default(), guess: None, extrapolation: None, came_off: &[] };
        let mut handle = CaseHandle { backend: &mut gpu, case };
        assert_eq!(newton.keeps_on(&handle, false), Keeps::Steps);
        let outcome = newton.solve(&mut handle, &start, &control).unwrap();
        assert!(matches!(outcome, StepOutcome::Converged(_)), "{outcome:?}");
        let settled = newton.settle(&mut handle).unwrap().unwrap();
        assert!(settled.points.iter().any(|point| point.status != Status::Open) && settled.energies.elastic > 0.0);
        let state = handle.state().unwrap();
        displacement.push(state.displacement.clone());
        CaseHandle { backend: &mut cpu, case }.restore(state).unwrap();
    }
    Pressed { gpu, cpu, models, displacement }
}

/// What a case is pressed against.
fn opponent(model: &CaseModel) -> RigidBody {
    RigidBody { surface: model.surface }
}

/// What a control says of the plate.
pub fn plate(control: &Control) -> Plate {
    Plate { h: control.h, delta_t: control.pose.shift[0], held: control.normal_force }
}

/// The replies to what is asked of cases.
pub fn ask(gpu: &mut Gpu<f64>, asks: &[(usize, bool, Plate, Ask)]) -> Vec<Reply> {
    let request = |(case, kept, plate, ask): &(usize, bool, Plate, Ask)| {
        (*case, Call::Iterate(Request { kept: *kept, plate: *plate, ask: ask.clone() }))
    };
    let answers = gpu.call(asks.iter().map(request).collect()).unwrap();
    answers.into_iter().map(|answer| if let Answer::Iterate(reply) = answer { reply } else { panic!("{answer:?}") }).collect()
}

/// A reply that is a reading.
pub fn reading(answer: &Reply) -> Reading {
    let Reply::Reading(reading) = answer else { panic!("{answer:?}") };
    *reading
}

/// An iterate at the start of a step in which no contact point of a mesh slides under full stick,
/// whatever slid in the step before.
pub fn begin(mesh: &Mesh) -> Ask {
    Ask::Begin(Begin { from: From::Start, sliding: Some(vec![false; mesh.contact_nodes.len()]) })
}

/// What the host makes of a trial at a displacement.
fn on_host(pressed: &mut Pressed, case: usize, u: &[f64], h: f64, control: &Control) -> (Trial, Boundary) {
    let mesh = pressed.models[case].mesh.clone();
    let boundary = Boundary::new(&mesh);
    let mut trial = Trial::new(&mesh);
    trial.u.copy_from_slice(u);
    trial.h = h;
    let mut handle = CaseHandle { backend: &mut pressed.cpu, case };
    let opponent = opponent(&pressed.models[case]);
    let outcome = trial.evaluate(&mut handle, &boundary, &opponent, control, &mut PhaseTimes::default()).unwrap();
    assert_eq!(outcome, Evaluated::Valid);
    (trial, boundary)
}

fn near(what: &str, ours: f64, theirs: f64, scale: f64) {
    assert!((ours - theirs).abs() <= 1e-9 * scale, "{what}: {ours:e}, not {theirs:e}");
}

/// Trials and corrections after one press, on half a sphere and on all of it, whose plate moves
/// along x alone here: a device knows no other.
pub fn trials_and_corrections_are_the_cpus(context: &Arc<GpuContext>) {
    for mesh in [mesh(), whole_mesh()] {
        let mut pressed = pressed_on(context, &mesh);
        a_trial_reads_as_on_the_cpu(&mut pressed);
        a_correction_solves_the_hosts_system(&mut pressed);
    }
}

/// The same trials on both: every number by which the iteration goes on.
fn a_trial_reads_as_on_the_cpu(pressed: &mut Pressed) {
    for case in 0..pressed.models.len() {
        for held in [None, Some(1e-4)] {
            let (mesh, opponent) = (pressed.models[case].mesh.clone(), opponent(&pressed.models[case]));
            let control = Control { h: DEPTH + 1e-4, pose: Pose::along_x(2e-4), normal_force: held };
            let start = pressed.displacement[case].clone();
            let at_start = reading(&ask(&mut pressed.gpu, &[(case, false, plate(&control), begin(&mesh))])[0]);
            let (current, boundary) = on_host(pressed, case, &start, control.h, &control);
            near("merit", at_start.merit, current.merit, current.merit);
            near("plate force", at_start.plate_force, current.plate_force, current.plate_force);
            let mut fixed = vec![false; start.len()];
            fixed_unknowns(&mesh, &boundary, &current.rows, &mut fixed);
            let mut rng = random(70 + case as u64);
            let correction: Vec<f64> = start.iter().map(|_| rng.between(-2e-5, 2e-5)).collect();
            ask(&mut pressed.gpu, &[(case, false, plate(&control), Ask::Give(correction.clone()))]);
            let mut unknowns = correction.clone();
            opponent.contract(&current, &mesh, &mut unknowns);
            for (length, delta_h) in [(1.0, 3e-5), (0.3, 3e-5)] {
                let tried = reading(&ask(&mut pressed.gpu, &[(case, false, plate(&control), Ask::Try(length, delta_h))])[0]);
                let h = control.h + length * delta_h;
                let mut u: Vec<f64> = start.iter().zip(&correction).map(|(u, d)| u + length * d).collect();
                if length == 1.0 {
                    boundary.place_plate(&mut u, h, &control.pose);
                }
                let (trial, _) = on_host(pressed, case, &u, h, &control);
                near("merit", tried.merit, trial.merit, trial.merit);
                near("force scale", tried.force_scale, trial.force_scale, trial.force_scale);
                near("plate force", tried.plate_force, trial.plate_force, trial.force_scale);
                near("tangential", tried.tangential, trial.tangential_residual(), trial.merit);
                near("normal force", tried.normal_force, trial.contact_force(&mesh, &boundary, &opponent)[2], trial.force_scale);
                let free = || trial.residual.iter().zip(&unknowns).zip(&fixed).filter(|(_, fixed)| !**fixed);
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
                matches!(tried.outcome, Evaluated::Invalid(Fault::Inverted { .. })) && tried.merit == f64::INFINITY,
                "{tried:?}"
            );
        }
    }
}

fn correct(tolerance: f64, plate_force: f64) -> Ask {
    Ask::Correct(Correct { tolerance, expected: 12, unit_tolerance: 1e-4, unit_expected: 12, first: true, plate_force })
}

/// A reply that is of a correction.
pub fn corrected(answer: &Reply) -> Corrected {
    let Reply::Corrected(corrected) = answer else { panic!("{answer:?}") };
    *corrected
}

/// A correction solves the system that the host states in f64, to the tolerance that was asked; one
/// under a held force brings the plate's to it.
fn a_correction_solves_the_hosts_system(pressed: &mut Pressed) {
    for case in 0..pressed.models.len() {
        let mesh = pressed.models[case].mesh.clone();
        let start = pressed.displacement[case].clone();
        for held in [false, true] {
            let mut control = Control { h: DEPTH, pose: Pose::along_x(1e-4), normal_force: None };
            let (current, boundary) = on_host(pressed, case, &start, control.h, &control);
            let target = 1.1 * current.plate_force;
            control.normal_force = held.then_some(target);
            let begun = reading(&ask(&mut pressed.gpu, &[(case, false, plate(&control), begin(&mesh))])[0]);
            let asked = correct(1e-4, begun.plate_force);
            let found = corrected(&ask(&mut pressed.gpu, &[(case, false, plate(&control), asked)])[0]);
            assert_eq!((found.tangent, found.report.ended), (Evaluated::Valid, Ended::Converged));
            // The whole correction becomes the iterate, so that it can be read.
            let brought = ask(&mut pressed.gpu, &[(case, true, plate(&control), Ask::Bring)]).remove(0);
            let Reply::Vectors(vectors) = brought else { panic!("{brought:?}") };
            let x: Vec<f64> = vectors.displacement.iter().zip(&start).map(|(a, b)| a - b).collect();

            let blocks = tangents(&mut pressed.cpu, &[(case, start.clone())]).remove(0).1;
            let mut matrix = BlockMatrix::zeros(Pattern::from_elements(mesh.nodes.len(), &mesh.elements));
            matrix.blocks.copy_from_slice(&blocks);
            let mut functional = vec![0.0; x.len()];
            plate_functional(&matrix, &boundary.plate, &mut functional);
            turn(&mut matrix, &mesh, &current.frames);
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
                let mut y = x.clone();
                opponent(&pressed.models[case]).contract(&current, &mesh, &mut y);
                assert!(found.unit.is_none() && left(&y) <= 1.02e-4 * left(&nothing), "{} of {}", left(&y), left(&nothing));
            }
            let (then, _) = on_host(pressed, case, &vectors.displacement, control.h + found.delta_h, &control);
            near("merit", found.trial.merit, then.merit, then.merit);
        }
    }
}
