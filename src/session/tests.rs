use std::sync::Mutex;

use super::*;
use crate::case::{Case, Friction};
use crate::compute::select::DeviceChoice;
use crate::output::{Checkpoint, OutputDirectory, StepRecord, read_contact, read_history};

/// Pressed, sheared at constant force and back: steps of every kind, on a coarse mesh.
fn case() -> Case {
    let text = include_str!("../../fixtures/cases/ideal.toml");
    let settings = [
        "mesh.elements_per_contact_radius=4",
        "solver.error_estimate=false",
        "solver.press_steps=5",
        "solver.shear_steps=5",
        "path=[{ indentation = 0.005 }, { shear = 4e-4, hold = \"normal-force\" }, { release = true }]",
    ];
    Case::parse(text, "ideal.toml", &settings.map(str::to_owned)).expect("the fixture is a case")
}

fn on_cpu() -> Options {
    Options { device: DeviceChoice::Cpu, threads: NonZeroUsize::new(1), ..Options::default() }
}

fn whole(case: &Case) -> Vec<StepRecord> {
    let mut simulation = Simulation::with(case, on_cpu()).expect("a simulation");
    assert!(simulation.run().expect("a run").is_done());
    simulation.history().to_vec()
}

#[test]
fn one_step_at_a_time_is_the_same_run() {
    let case = case();
    let expected = whole(&case);
    let mut simulation = Simulation::with(&case, on_cpu()).expect("a simulation");
    let mut seen = Vec::new();
    while let Some(row) = simulation.step().expect("a step") {
        seen.push(row);
        // What is looked at in between changes nothing.
        let force: f64 = simulation.contact().iter().map(|point| point.pressure * point.area).sum();
        assert!((force - row.f_n).abs() <= 1e-9 * row.f_n.abs().max(1e-9), "{force} and {}", row.f_n);
        let fields = simulation.fields().expect("fields").expect("of a step");
        assert_eq!((fields.mises.len(), fields.displacement.len()), (fields.elements.len(), fields.nodes.len()));
    }
    assert_eq!((&seen, simulation.history()), (&expected, expected.as_slice()));
    assert!(simulation.outcome().expect("an end").is_done() && simulation.step().expect("no step").is_none());
    // An iterator that is let go of leaves the simulation where it is.
    let mut simulation = Simulation::with(&case, on_cpu()).expect("a simulation");
    assert_eq!(simulation.steps().take(3).filter_map(Result::ok).count(), 3);
    assert!(simulation.outcome().is_none());
    simulation.run().expect("the rest");
    assert_eq!(simulation.history(), expected);
}

#[test]
fn files_do_not_show_that_it_was_stepped_or_dropped_on_the_way() {
    let scratch = tempfile::tempdir().expect("a scratch directory");
    let [at_once, stepped, dropped] = ["at-once", "stepped", "dropped"].map(|name| scratch.path().join(name));
    let case = case();
    let into = |out: &std::path::Path, earlier| {
        Simulation::with(&case, Options { out: Some(out.to_owned()), earlier, ..on_cpu() }).expect("a simulation")
    };
    assert!(into(&at_once, Earlier::Keep).run().expect("a run").is_done());
    assert_eq!(into(&stepped, Earlier::Keep).steps().filter_map(Result::ok).count(), whole(&case).len());
    assert_eq!(into(&dropped, Earlier::Keep).steps().take(4).filter_map(Result::ok).count(), 4);
    let left = OutputDirectory::existing(&dropped);
    assert_eq!(Summary::read(&left.summary()).expect("a summary").status, RunStatus::Interrupted);
    assert!(left.checkpoint().exists());
    let mut resumed = into(&dropped, Earlier::Resume);
    assert_eq!(resumed.steps().count(), whole(&case).len() - 4);
    drop(resumed);
    let names = |dir: &std::path::Path| {
        let folders = ["", "fields", "contact", "plots"];
        let mut names: Vec<_> = folders[..if cfg!(feature = "plots") { 4 } else { 3 }]
            .iter()
            .flat_map(|folder| std::fs::read_dir(dir.join(folder)).expect("a folder"))
            .map(|entry| entry.expect("an entry").path())
            .filter(|path| path.is_file())
            .map(|path| path.strip_prefix(dir).expect("within").to_owned())
            .collect();
        names.sort();
        names
    };
    for other in [&stepped, &dropped] {
        assert_eq!(names(other), names(&at_once));
        for name in names(&at_once).iter().filter(|name| !["summary.json", "checkpoint.bin"].contains(&&*name.to_string_lossy()))
        {
            let read = |dir: &std::path::Path| std::fs::read(dir.join(name)).expect("a file");
            assert!(read(other) == read(&at_once), "{} differs in {}", name.display(), other.display());
        }
    }
    // Checkpoints have times; their states are the same.
    let state =
        |dir: &std::path::Path| Checkpoint::read(&dir.join("checkpoint.bin")).expect("it reads").expect("it stays").snapshot();
    assert!([&stepped, &dropped].into_iter().all(|other| state(other) == state(&at_once)));
    // One that is done is read, not computed.
    let mut again = into(&at_once, Earlier::Resume);
    assert!(again.outcome().expect("an end").ended_before && again.step().expect("no step").is_none());
    assert_eq!(again.history(), read_history(&OutputDirectory::existing(&at_once).history()).expect("a history"));
    assert_eq!(again.run().expect("nothing to do").status, RunStatus::Done);
}

#[test]
fn contact_and_summary_are_those_of_the_files() {
    let scratch = tempfile::tempdir().expect("a scratch directory");
    let mut case = case();
    case.path.truncate(1);
    case.solver.error_estimate = true;
    let mut kept = Simulation::with(&case, on_cpu()).expect("a simulation");
    let mut written =
        Simulation::with(&case, Options { out: Some(scratch.path().to_owned()), ..on_cpu() }).expect("a simulation");
    let [ours, theirs] = [&mut kept, &mut written].map(|simulation| simulation.run().expect("a run").summary);
    let steps = kept.history().len();
    let table = read_contact(&OutputDirectory::existing(scratch.path()).contact(steps)).expect("a table");
    assert_eq!((kept.contact(), written.contact()), (table.clone(), table));
    let timeless = |summary: Summary| Summary {
        wall_s: 0.0,
        cpu_s: None,
        time_by_phase: Default::default(),
        messages: Vec::new(),
        ..summary
    };
    assert!(ours.f_n0_error.is_some());
    assert_eq!(timeless(ours), timeless(theirs));
    assert_eq!(kept.history(), written.history());
    assert!(kept.history().iter().all(|row| row.f_n_limit.is_some()));
}

#[test]
fn a_run_is_cancelled_from_another_thread() {
    /// Says after which step it is.
    struct Tell(Mutex<std::sync::mpsc::Sender<usize>>);
    impl crate::output::Progress for Tell {
        fn step(&mut self, position: &crate::output::Position) {
            self.0.lock().expect("one thread").send(position.step).expect("somebody listens");
        }
        fn message(&mut self, _: &str) {}
        fn finish(&mut self, _: &str) {}
    }
    let (sender, steps) = std::sync::mpsc::channel();
    let simulation = Simulation::with(&case(), on_cpu()).expect("a simulation");
    let canceller = simulation.canceller();
    let mut simulation = simulation.watched_by(Box::new(Tell(Mutex::new(sender))));
    let run = std::thread::spawn(move || (simulation.run(), simulation));
    assert_eq!(steps.recv(), Ok(1));
    canceller.cancel();
    let (outcome, simulation) = run.join().expect("no panic");
    let outcome = outcome.expect("an end");
    assert_eq!(outcome.status, RunStatus::Interrupted);
    assert!(outcome.message.is_some_and(|message| message.starts_with("interrupted after step ")));
    assert!(simulation.history().len() < whole(&case()).len());
}

#[test]
fn a_case_that_is_none_and_a_directory_of_the_users_are_refused() {
    let mut wrong = case();
    wrong.contact.friction = Friction::Coefficient(f64::NAN);
    let error = Simulation::new(&wrong).err().expect("no case").to_string();
    assert_eq!(error, "case: contact.friction: is NaN. Allowed: a number >= 0, or \"stick\"");
    wrong = case();
    wrong.path.clear();
    let error = Simulation::new(&wrong).err().expect("no case").to_string();
    assert!(error.starts_with("case: path: is empty. Allowed: at least one [[path]] segment"), "{error}");
    let scratch = tempfile::tempdir().expect("a scratch directory");
    std::fs::write(scratch.path().join("thesis.tex"), "mine").expect("a file");
    let refused = Simulation::with(&case(), Options { out: Some(scratch.path().to_owned()), ..on_cpu() }).err().expect("refused");
    assert!(matches!(refused, SessionError::NotAResult { .. }), "{refused}");
}

#[test]
fn a_step_that_does_not_converge_is_an_outcome() {
    let mut case = case();
    (case.solver.max_iterations, case.solver.max_cutbacks) = (1, 0);
    let mut simulation = Simulation::with(&case, on_cpu()).expect("a simulation");
    let outcome = simulation.run().expect("an end");
    assert_eq!((outcome.status, simulation.history().len()), (RunStatus::NotConverged, 0));
    assert!(outcome.message.is_some_and(|message| message.starts_with("no convergence: step 1 of segment 0")));
}

/// Pictures are drawn, or it is said that they are not; never neither.
#[test]
fn a_program_without_pictures_says_so_to_who_asks_for_them() {
    for plots in [true, false] {
        let scratch = tempfile::tempdir().expect("a scratch directory");
        let mut case = case();
        case.path.truncate(1);
        case.output.plots = plots;
        let options = Options { out: Some(scratch.path().to_owned()), ..on_cpu() };
        let summary = Simulation::with(&case, options).expect("a simulation").run().expect("a run").summary;
        let said = summary.messages.iter().any(|text| text.contains("no pictures are drawn") && text.contains("\"plots\""));
        let drawn = std::fs::read_dir(scratch.path().join("plots")).is_ok_and(|mut files| files.next().is_some());
        assert_eq!(
            (said, drawn),
            (plots && cfg!(not(feature = "plots")), plots && cfg!(feature = "plots")),
            "{:?}",
            summary.messages
        );
        // What they are drawn from is there all the same.
        let read = Summary::read(&OutputDirectory::existing(scratch.path()).summary()).expect("a summary");
        assert_eq!(read.messages, summary.messages);
    }
}
