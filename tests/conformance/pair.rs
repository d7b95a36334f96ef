//! The press of an equal pair on a device, whose iterates stay there as over the plane in which it
//! meets: point by point against the CPU, which has the mortar; and what a device leaves that is
//! lost on the way.

use crate::recorder::Recorder;
use asperity::case::Case;
use asperity::internals::compute::Compute;
use asperity::internals::compute::cpu::Cpu;
use asperity::internals::compute::fallback::Fallback;
use asperity::internals::compute::gpu::{Gpu, GpuContext, Precision};
use asperity::internals::contact::coulomb::Status;
use asperity::internals::simulation::drive::{Drive, Ending};
use asperity::internals::simulation::problem::Problem;
use asperity::internals::simulation::record::{RecordedPoint, StepRecord};
use std::path::Path;
use std::sync::Arc;

/// Press steps.
const PRESSED: usize = 4;

/// A power law, four elements a contact radius, four steps of pressing and three of shearing.
fn problem(friction: &str) -> Problem {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/cases/power.toml");
    let set = [
        "opponent={equal=true}",
        "mesh.elements_per_contact_radius=4",
        "solver.press_steps=4",
        "solver.shear_steps=3",
        "solver.tolerance=1e-9",
        "path.1.shear=0.002",
        friction,
    ];
    Problem::new(&Case::load(&file, &set.map(String::from)).unwrap()).unwrap()
}

fn followed<'a>(problem: &Problem, backend: &mut dyn Compute, destroy: Option<(usize, &'a GpuContext)>) -> Recorder<'a> {
    let mut recorder = Recorder { destroy, ..Recorder::default() };
    let ending = Drive::new(problem, backend, 0, problem.newton().unwrap()).run(&mut recorder).unwrap();
    assert_eq!(ending, Ending::Done);
    recorder
}

fn on_cpu(problem: &Problem) -> Recorder<'static> {
    followed(problem, &mut Cpu::<f64>::new(vec![problem.model.clone()]).unwrap(), None)
}

/// The largest difference of F_N and F_T in steps, over the largest F_N.
fn difference(ours: &[(StepRecord, Vec<RecordedPoint>)], theirs: &[(StepRecord, Vec<RecordedPoint>)]) -> f64 {
    assert_eq!(ours.len(), theirs.len(), "another number of steps");
    let scale = theirs.iter().fold(0.0_f64, |m, (row, _)| m.max(row.f_n));
    let of = |((a, _), (b, _)): (&(StepRecord, _), &(StepRecord, _))| (a.f_n - b.f_n).abs().max((a.f_t - b.f_t).abs());
    ours.iter().zip(theirs).map(of).fold(0.0, f64::max) / scale
}

/// Position, force, gap and status of each contact node, slaves and masters alike.
fn hold_points(what: &str, ours: &[RecordedPoint], theirs: &[RecordedPoint]) {
    let scale = |of: fn(&RecordedPoint) -> f64| theirs.iter().map(of).fold(0.0, f64::max);
    let (force, radius) = (scale(|point| point.force[2]), scale(|point| point.position[0].abs()));
    for (k, (a, b)) in ours.iter().zip(theirs).enumerate() {
        assert_eq!(a.status, b.status, "{what}, point {k}");
        let apart = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let found = [apart(&a.force, &b.force) / force, apart(&a.position, &b.position) / radius, (a.gap - b.gap).abs() / radius];
        assert!(found.iter().all(|x| *x < 1e-7), "{what}, point {k}: {found:?}");
    }
}

/// With friction, without any, and under full stick: nothing slips, and no point carries a
/// tangential force.
#[test]
fn a_press_has_the_mortars_points() {
    let Some(context) = crate::device::device("a_press_has_the_mortars_points", Precision::F64) else { return };
    let context = Arc::new(context);
    for friction in ["contact.friction=0.3", "contact.friction=0.0", "contact.friction=stick"] {
        let problem = problem(friction);
        let mut gpu = Gpu::<f64>::new(context.clone(), vec![problem.model.clone()]).unwrap();
        let (ours, theirs) = (followed(&problem, &mut gpu, None), on_cpu(&problem));
        for step in 1..=PRESSED {
            let ([ours, theirs], what) = ([&ours.steps[step].1, &theirs.steps[step].1], format!("{friction}, step {step}"));
            hold_points(&what, ours, theirs);
            assert!(ours.iter().any(|point| point.status != Status::Open), "{what}: nothing touches");
            assert!(ours.iter().all(|point| point.force[..2] == [0.0; 2]), "{what}");
        }
        let found = difference(&ours.steps[..=PRESSED], &theirs.steps[..=PRESSED]);
        let all = difference(&ours.steps, &theirs.steps);
        println!("{friction}: {found:.1e} in the press, {all:.1e} in all");
        assert!(found < 1e-8 && all < 1e-7, "{friction}: {found:e}, {all:e}");
        let friction_work = ours.steps[PRESSED].0.work_friction;
        assert!(friction_work == 0.0, "{friction_work}");
    }
}

/// In the press the states are on the device alone, and the run goes back; in the shear there are
/// copies of them, and it goes on.
#[test]
fn a_device_lost_in_the_press_or_in_the_shear_costs_no_step() {
    let test = "a_device_lost_in_the_press_or_in_the_shear_costs_no_step";
    let problem = problem("contact.friction=0.3");
    let theirs = on_cpu(&problem);
    for lost_after in [2, PRESSED + 2] {
        let Some(context) = crate::device::device(test, Precision::F64) else { return };
        let context = Arc::new(context);
        let gpu = Gpu::<f64>::new(context.clone(), vec![problem.model.clone()]).unwrap();
        let ours = followed(&problem, &mut Fallback::new(Box::new(gpu)), Some((lost_after, &context)));
        let expected = format!("after {lost_after} accepted steps");
        let [note] = &ours.notes[..] else { panic!("{:?}", ours.notes) };
        assert!(note.contains(&expected) && note.contains("no accepted step was lost"), "{note}");
        let found = difference(&ours.steps, &theirs.steps);
        assert!(found < 1e-7, "lost after {lost_after}: {found:e}");
    }
}
