//! The directory of a run: one writer, nothing foreign touched, nothing missed that is gone.

use std::fs;
use std::path::Path;
use std::process::{Child, Stdio};
use std::sync::Arc;
use std::time::{Duration, Instant};

use asperity::case::{Case, Segment};
use asperity::internals::compute::Compute;
use asperity::internals::compute::cpu::Cpu;
use asperity::internals::simulation::drive::Drive;
use asperity::internals::simulation::problem::Problem;
use asperity::output::{Clock, OutputDirectory, ResultWriter, RunStatus, Setting, SilentProgress, read_history};
use rustix::process::{Pid, Signal, kill_process};

use super::common::{Scratch, difference, files, program, stderr};
use super::program::{CASE, scratch, whole};

/// Takes some seconds.
const SLOW: [&str; 4] = ["--set", "mesh.elements_per_contact_radius=8", "--set", "solver.press_steps=60"];

/// Starts a run and waits until it has some steps.
fn started(scratch: &Scratch, out: &Path, options: &[&str]) -> Child {
    let mut command = program();
    command.args(scratch.args(out, options)).stdout(Stdio::piped()).stderr(Stdio::piped());
    let child = command.spawn().expect("the program runs");
    let begun = Instant::now();
    while read_history(&out.join("history.csv")).map_or(0, |rows| rows.len()) < 3 {
        assert!(begun.elapsed() < Duration::from_secs(120), "no steps");
        std::thread::sleep(Duration::from_millis(2));
    }
    child
}

/// A run that was interrupted after some steps, with fields of every step.
fn interrupted(scratch: &Scratch, out: &Path) {
    let child = started(scratch, out, &["-q", "--set", "output.fields=\"all\"", "--set", "solver.press_steps=30"]);
    kill_process(Pid::from_child(&child), Signal::TERM).expect("a signal is sent");
    let output = child.wait_with_output().expect("it ends");
    assert_eq!(output.status.code(), Some(75), "{}", stderr(&output));
}

#[test]
fn a_second_run_is_refused_with_the_first_ones_process_and_the_first_is_not_disturbed() {
    let scratch = scratch();
    let (out, alone) = (scratch.path("out"), scratch.path("alone"));
    let child = started(&scratch, &out, &[&["-q"][..], &SLOW].concat());
    let process = child.id();
    for options in [&["-q"][..], &["-q", "--force"], &["-q", "--resume"]] {
        let output = scratch.run(&out, options);
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{message}");
        let parts = [format!("is being written by process {process} on "), "nothing was changed".to_owned()];
        assert!(parts.iter().all(|part| message.contains(part)) && message.lines().count() == 1, "{message}");
    }
    let output = child.wait_with_output().expect("it ends");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(scratch.run(&alone, &[&["-q"][..], &SLOW].concat()).status.code(), Some(0));
    assert_eq!(difference(&out, &alone), None);
}

#[test]
fn the_lock_of_a_killed_run_is_taken_over_and_said() {
    let scratch = scratch();
    let out = scratch.path("out");
    let mut child = started(&scratch, &out, &[&["-q"][..], &SLOW].concat());
    let process = child.id();
    child.kill().expect("killed");
    child.wait().expect("it ends");
    let output = scratch.run(&out, &[&["--resume"][..], &SLOW].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let said = stderr(&output);
    assert!(said.contains(&format!("taken over from process {process} on ")), "{said}");
    assert!(!files(&out).keys().any(|name| name.contains("lock")), "{:?}", files(&out).keys());
}

#[test]
fn a_directory_that_is_removed_in_the_middle_ends_the_run_with_3_and_stays_removed() {
    let scratch = scratch();
    let out = scratch.path("out");
    let child = started(&scratch, &out, &[&["-q"][..], &SLOW].concat());
    // At once: the run writes into it all the time, so that it is not to be emptied file by file.
    fs::rename(&out, scratch.path("away")).expect("moved");
    fs::remove_dir_all(scratch.path("away")).expect("removed");
    let output = child.wait_with_output().expect("it ends");
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(3), "{message}");
    assert!(message.contains("history.csv: was removed or replaced while the run went on"), "{message}");
    assert!(message.contains("nothing of it is left in ") && message.lines().count() == 1, "{message}");
    assert!(!out.exists());
}

#[test]
fn a_folder_of_results_that_is_a_link_is_refused() {
    let scratch = scratch();
    let (out, foreign) = (scratch.path("out"), scratch.path("foreign"));
    assert_eq!(scratch.run(&out, &["-q"]).status.code(), Some(0));
    fs::create_dir(&foreign).expect("a directory");
    fs::write(foreign.join("step_0001.vtu"), "mine").expect("a file");
    fs::remove_dir_all(out.join("fields")).expect("removed");
    std::os::unix::fs::symlink(&foreign, out.join("fields")).expect("a link");
    let output = scratch.run(&out, &["-q", "--force"]);
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("out/fields: is a link") && message.lines().count() == 1, "{message}");
    assert_eq!(files(&foreign).len(), 1);
    assert!(out.join("history.csv").exists());
}

#[test]
fn a_file_that_a_checkpoint_tells_of_and_that_is_gone_is_missed() {
    let scratch = scratch();
    let out = scratch.path("out");
    interrupted(&scratch, &out);
    let options = ["-q", "--resume", "--set", "output.fields=\"all\"", "--set", "solver.press_steps=30"];
    let gone = out.join("fields/step_0002.vtu");
    let kept = fs::read(&gone).expect("a file");
    fs::remove_file(&gone).expect("removed");
    let before = files(&out);
    let output = scratch.run(&out, &options);
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("fields/step_0002.vtu was written before it and is gone or empty"), "{message}");
    assert!(files(&out) == before);
    fs::write(&gone, kept).expect("restored");
    let output = scratch.run(&out, &options);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
}

#[test]
fn a_history_that_is_cut_while_the_run_goes_on_ends_it_and_it_goes_on_from_the_checkpoint() {
    let scratch = scratch();
    let (out, alone) = (scratch.path("out"), scratch.path("alone"));
    let child = started(&scratch, &out, &[&["-q"][..], &SLOW].concat());
    fs::File::options().write(true).truncate(true).open(out.join("history.csv")).expect("cut");
    let output = child.wait_with_output().expect("it ends");
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(3), "{message}");
    assert!(message.contains("history.csv: was changed while the run went on (0 bytes are there"), "{message}");
    assert_eq!(scratch.run(&out, &[&["-q", "--resume"][..], &SLOW].concat()).status.code(), Some(0));
    assert_eq!(scratch.run(&alone, &[&["-q"][..], &SLOW].concat()).status.code(), Some(0));
    assert_eq!(difference(&out, &alone), None);
}

#[test]
fn what_was_left_by_a_kill_at_the_very_end_is_tidied_up() {
    let scratch = scratch();
    let out = scratch.path("out");
    assert_eq!(scratch.run(&out, &["-q"]).status.code(), Some(0));
    let left = [".checkpoint.bin.4711.tmp", ".summary.json.4711.tmp", "plots/.forces.svg.4711.tmp"];
    for name in left {
        fs::write(out.join(name), "left").expect("a file");
    }
    let output = scratch.run(&out, &["--resume"]);
    assert_eq!((output.status.code(), stderr(&output).as_str()), (Some(0), ""));
    assert_eq!(difference(&out, whole()), None);
    // A checkpoint that is not to be kept goes too.
    fs::write(out.join(left[0]), "left").expect("a file");
    let output = scratch.run(&out, &["--resume", "--set", "output.keep_checkpoint=false"]);
    assert_eq!((output.status.code(), stderr(&output).as_str()), (Some(0), ""));
    assert!(!out.join("checkpoint.bin").exists() && !out.join(left[0]).exists());
}

/// In units so great that forces overflow; a case file with such is refused, so this one is made by
/// hand.
#[test]
fn a_result_that_is_no_number_is_a_failure_with_its_step_and_never_done() {
    let scratch = scratch();
    let mut case = Case::parse(CASE, "case.toml", &[]).expect("the case");
    case.sphere.radius = 1e200;
    case.mesh.contact_radius = Some(0.16e200);
    case.path = vec![Segment::Indentation { indentation: 0.01e200 }];
    let problem = Problem::new(&case).expect("a problem");
    let mut backend = Cpu::<f64>::new(vec![problem.model.clone()]).expect("a backend");
    let newton = problem.newton().expect("a solver");
    let setting = Setting { computed_on: backend.about().description, elements: 1, unknowns: 1 };
    let out = OutputDirectory::create(scratch.path("out")).expect("a directory");
    let progress = Box::new(SilentProgress);
    let mut results =
        ResultWriter::create(&case, out.root(), setting, Clock::start(), progress, Arc::default(), None).expect("results");
    let error = Drive::new(&problem, &mut backend, 0, newton).run(&mut results).expect_err("no number").to_string();
    assert!(error.contains("step 1: F_N is inf"), "{error}");
    // Whatever the caller makes of it.
    let summary = results.finish(RunStatus::Done, Some(&error)).expect("a summary");
    assert_eq!((summary.status, summary.steps), (RunStatus::Failed, 0));
    assert!(fs::read_to_string(out.summary()).expect("a summary").contains("\"status\": \"failed\""));
}

#[test]
fn several_starts_at_once_are_one_run() {
    let scratch = scratch();
    for _ in 0..3 {
        let out = scratch.path("out");
        let mut starts: Vec<Child> = (0..6)
            .map(|_| {
                program().args(scratch.args(&out, &["-q"])).stderr(Stdio::piped()).stdout(Stdio::null()).spawn().expect("it runs")
            })
            .collect();
        let ended: Vec<_> = starts.drain(..).map(|child| child.wait_with_output().expect("it ends")).collect();
        let done = ended.iter().filter(|output| output.status.code() == Some(0)).count();
        assert_eq!(done, 1, "{:?}", ended.iter().map(stderr).collect::<Vec<_>>());
        for output in ended.iter().filter(|output| output.status.code() != Some(0)) {
            let message = stderr(output);
            assert_eq!(output.status.code(), Some(2), "{message}");
            assert!(message.contains("is being written by") || message.contains("holds a run that is done"), "{message}");
        }
        assert_eq!(difference(&out, whole()), None);
        fs::remove_dir_all(&out).expect("removed");
    }
}
