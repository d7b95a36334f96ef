//! A small press and shear, step by step, on every backend: its history against the CPU's in f64,
//! within gaps that were measured and written down in fixtures/precision.json.

use crate::recorder::Recorder;
use asperity::case::Case;
use asperity::internals::compute::cpu::Cpu;
use asperity::internals::compute::fallback::Fallback;
use asperity::internals::compute::gpu::{Gpu, GpuContext, Mixed, Precision};
use asperity::internals::compute::{CaseModel, Compute};
use asperity::internals::simulation::drive::{Drive, Ending};
use asperity::internals::simulation::problem::Problem;
use asperity::internals::simulation::record::StepRecord;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

type Gaps = BTreeMap<String, f64>;

/// What is held to a gap, and how far the CPU in f64 itself may be from one machine to the next.
const COLUMNS: [&str; 13] = [
    "h",
    "delta_T",
    "F_N",
    "F_T",
    "a",
    "stick_radius",
    "a_gap",
    "work_external",
    "energy_elastic",
    "work_plastic",
    "work_friction",
    "max_alpha",
    "newton_iterations",
];

fn columns(r: &StepRecord) -> [f64; COLUMNS.len()] {
    [
        r.h,
        r.delta_t,
        r.f_n,
        r.f_t,
        r.a,
        r.stick_radius,
        r.a_gap,
        r.work_external,
        r.energy_elastic,
        r.work_plastic,
        r.work_friction,
        r.max_alpha,
        r.newton_iterations as f64,
    ]
}

/// A power law, four elements a contact radius, five steps of pressing and six of shearing, the
/// last of them back.
fn problem() -> Problem {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/cases/power.toml");
    let set = ["mesh.elements_per_contact_radius=4", "solver.press_steps=5", "solver.shear_steps=4", "path.1.shear=0.002"]
        .map(String::from);
    let mut case = Case::load(&file, &set).unwrap();
    let back = Case::load(&file, &["path.1.shear=0.001".to_owned()]).unwrap().path[1];
    case.path.push(back);
    Problem::new(&case).unwrap()
}

fn history(problem: &Problem, backend: &mut dyn Compute, destroy: Option<(usize, &GpuContext)>) -> Vec<StepRecord> {
    let mut recorder = Recorder { destroy, ..Recorder::default() };
    let ending = Drive::new(problem, backend, 0, problem.newton().unwrap()).run(&mut recorder).unwrap();
    assert_eq!(ending, Ending::Done);
    // told once, at the step that the CPU had to make
    let told = |n: &String| n.contains("after 6 accepted steps") && n.contains("no accepted step was lost");
    assert!(recorder.notes.iter().all(told) && recorder.notes.len() == usize::from(destroy.is_some()), "{:?}", recorder.notes);
    recorder.steps.into_iter().map(|(record, _)| record).collect()
}

fn reference(problem: &Problem) -> Vec<StepRecord> {
    history(problem, &mut Cpu::<f64>::new(vec![problem.model.clone()]).unwrap(), None)
}

/// The largest difference in each column by the largest number in it.
fn gaps(ours: &[StepRecord], reference: &[StepRecord]) -> Gaps {
    assert_eq!(ours.len(), reference.len(), "another number of steps");
    let gap = |c: usize| {
        let scale = reference.iter().fold(f64::MIN_POSITIVE, |m, r| m.max(columns(r)[c].abs()));
        ours.iter().zip(reference).fold(0.0f64, |m, (a, b)| m.max((columns(a)[c] - columns(b)[c]).abs())) / scale
    };
    COLUMNS.iter().enumerate().map(|(c, name)| ((*name).to_owned(), gap(c))).collect()
}

/// How far beyond a measured gap another driver may be: it rounds otherwise, by as much. Better
/// than a tenth of what is promised is asked of nobody.
const SLACK: f64 = 3.0;

/// Holds a backend's gaps to those in the fixture, and these to what they must not exceed; prints
/// what to write there.
fn hold(name: &str, ours: &[StepRecord], reference: &[StepRecord], most: f64) {
    let measured = gaps(ours, reference);
    println!("\"{name}\": {}", serde_json::to_string(&measured).unwrap());
    let text = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/precision.json")).unwrap();
    let fixture: BTreeMap<String, Gaps> = serde_json::from_str(&text).unwrap();
    for column in COLUMNS {
        let (ours, expected) = (measured[column], fixture[name][column]);
        // a count may differ by one: a merit next to the tolerance
        let most = if column == "newton_iterations" { 0.2 } else { most };
        assert!(ours <= (SLACK * expected).clamp(0.1 * most, most), "{name}, {column}: {ours:e}, and {expected:e} was measured");
    }
}

fn on_device<B: Compute + 'static>(
    test: &str,
    precision: Precision,
    start: impl Fn(Arc<GpuContext>, Vec<CaseModel>) -> B,
) -> Option<(Problem, B)> {
    let context = crate::device::device(test, precision)?;
    let problem = problem();
    let backend = start(context.into(), vec![problem.model.clone()]);
    Some((problem, backend))
}

#[test]
fn cpu_f32_stays_near_cpu_f64() {
    let problem = problem();
    let ours = history(&problem, &mut Cpu::<f32>::new(vec![problem.model.clone()]).unwrap(), None);
    hold("cpu_f32", &ours, &reference(&problem), 5e-4);
}

/// Steps in f32 on the device, held to residuals of the CPU: what a device without double
/// precision does. Solved tightly, so that what is left is no matter of which iterate was the first
/// to be good enough.
#[test]
fn steps_in_f32_do_not_change_the_answer() {
    let start = |context, models| Mixed::new(context, models).unwrap();
    let Some((mut problem, mut backend)) = on_device("steps_in_f32_do_not_change_the_answer", Precision::F32, start) else {
        return;
    };
    problem.settings.tolerance = 1e-7;
    hold("gpu_mixed", &history(&problem, &mut backend, None), &reference(&problem), 1e-5);
}

/// On a healthy device first, then on one that is destroyed in mid-run: the CPU goes on, and the
/// history is the same. Solved tightly: the device's smoother has other digits than the CPU's, so
/// that each goes from iterate to iterate in its own way.
#[test]
fn gpu_f64_has_the_cpus_history_even_if_it_is_lost_on_the_way() {
    let name = "gpu_f64_has_the_cpus_history_even_if_it_is_lost_on_the_way";
    let start = |context, models| Gpu::<f64>::new(context, models).unwrap();
    let Some((mut problem, mut backend)) = on_device(name, Precision::F64, start) else { return };
    problem.settings.tolerance = 1e-7;
    let reference = reference(&problem);
    hold("gpu_f64", &history(&problem, &mut backend, None), &reference, 1e-7);

    let context: Arc<GpuContext> = crate::device::device(name, Precision::F64).unwrap().into();
    let device = Gpu::<f64>::new(context.clone(), vec![problem.model.clone()]).unwrap();
    let mut backend = Fallback::new(Box::new(device));
    let lost = history(&problem, &mut backend, Some((6, &context)));
    hold("gpu_f64", &lost, &reference, 1e-7);
    assert!(backend.about().description.device.contains("CPU") && backend.about().description.device.contains("failed"));
    assert!(backend.take_notes().is_empty());
}

/// Without the watch over it, a lost device ends the run with one message.
#[test]
fn a_lost_device_is_one_clear_error() {
    let start = |context, models| Gpu::<f64>::new(context, models).unwrap();
    let Some((problem, mut backend)) = on_device("a_lost_device_is_one_clear_error", Precision::F64, start) else { return };
    let context = backend.context().unwrap().clone();
    let mut recorder = Recorder { destroy: Some((1, &context)), ..Recorder::default() };
    let newton = problem.newton().unwrap();
    let error = Drive::new(&problem, &mut backend, 0, newton).run(&mut recorder).unwrap_err().to_string();
    assert!(error.contains("device failed") && error.contains("--device cpu"), "{error}");
    assert_eq!(recorder.steps.len(), 2, "{error}");
}
