//! `asperity run --resume`: a run that was interrupted or killed goes on to the results of one that
//! never stopped, bit for bit.
#![cfg(unix)]

mod common;
mod device;

use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::Arc;
use std::sync::OnceLock;
use std::time::{Duration, Instant};

use asperity::case::Case;
use asperity::internals::compute::Compute;
use asperity::internals::compute::cpu::Cpu;
use asperity::internals::compute::gpu::Precision;
use asperity::internals::simulation::drive::{Drive, Ending};
use asperity::internals::simulation::problem::Problem;
use asperity::internals::simulation::scout::scout;
use asperity::output::{Clock, OutputDirectory, Position, Progress, ResultWriter, Setting, Summary, read_history};
use common::{Scratch, difference, files, interruption, program, stderr};
use rustix::process::{Pid, Signal, kill_process};

/// Pressed, sheared to full slip and released, with fields of every step.
const CASE: &str = r#"
[sphere]
radius = 1.0
[material]
youngs_modulus = 200e3
poissons_ratio = 0.3
[material.hardening]
law = "ideal"
yield_stress = 400.0
[contact]
friction = 0.3
[mesh]
elements_per_contact_radius = 5
[output]
fields = "all"
[[path]]
indentation = 0.02
[[path]]
shear = "full-slip"
[[path]]
release = true
"#;
const UNLIKE: &str = r#"[opponent]
radius = 2.0
[opponent.material]
youngs_modulus = 600e3
poissons_ratio = 0.3
[opponent.material.hardening]
law = "ideal"
yield_stress = 500.0
"#;
/// A program that has not come so far after this time hangs.
const PATIENCE: Duration = Duration::from_secs(300);

fn scratch() -> Scratch {
    Scratch::new(CASE, &["--device", "cpu"])
}

/// Goes on to the end.
fn resumed(scratch: &Scratch, name: &str, options: &[&str]) -> String {
    let output = scratch.run(name, &[&["--resume"], options].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    stderr(&output)
}

/// Begins or goes on, and sends a signal once the history has `rows` rows.
fn stopped(scratch: &Scratch, name: &str, signal: Signal, rows: usize, options: &[&str]) -> Output {
    let child = piped(program().args(scratch.args(name, options)));
    stop(child, signal, &scratch.path(name), rows)
}

/// A run that was interrupted after some steps.
fn interrupted(scratch: &Scratch, name: &str) {
    let output = stopped(scratch, name, Signal::TERM, 3, &[]);
    assert_eq!(output.status.code(), Some(75), "{}", stderr(&output));
    assert!(scratch.path(name).join("checkpoint.bin").exists());
}

fn piped(command: &mut Command) -> Child {
    command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program runs")
}

fn stop(child: Child, signal: Signal, dir: &Path, rows: usize) -> Output {
    let begun = Instant::now();
    while steps(dir) < rows {
        assert!(begun.elapsed() < PATIENCE, "{rows} steps take for ever");
        std::thread::sleep(Duration::from_millis(2));
    }
    kill_process(Pid::from_child(&child), signal).expect("a signal is sent");
    child.wait_with_output().expect("it ends")
}

/// Steps of the history, 0 if it cannot be read.
fn steps(dir: &Path) -> usize {
    read_history(&dir.join("history.csv")).map_or(0, |rows| rows.len())
}

/// Both hold the same files with the same bytes; the summaries but for times and the number of
/// threads.
fn assert_same(found: &Path, expected: &Path) {
    assert_eq!(difference(found, expected), None);
}

/// The run that nothing stopped, computed once.
fn whole() -> &'static Path {
    static WHOLE: OnceLock<PathBuf> = OnceLock::new();
    WHOLE.get_or_init(|| {
        let scratch = scratch();
        let dir = Path::new(env!("CARGO_TARGET_TMPDIR")).join("resume-whole");
        let output = program()
            .args(["run", &scratch.path("case.toml").display().to_string(), "--device", "cpu", "--force", "--out"])
            .arg(&dir)
            .output()
            .expect("the program runs");
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        dir
    })
}

#[test]
fn an_interrupted_run_goes_on_to_the_same_bits() {
    let scratch = scratch();
    let out = scratch.path("out");
    // Without anything to go on with it begins, and says so.
    let output = stopped(&scratch, "out", Signal::TERM, 3, &["--resume", "--threads", "1"]);
    assert_eq!(output.status.code(), Some(75), "{}", stderr(&output));
    let message = stderr(&output);
    assert!(message.contains("nothing to resume in ") && message.contains(": from the beginning"), "{message}");
    assert!(message.contains("error: interrupted by a signal after step ") && message.contains("with --resume"), "{message}");
    let first = steps(&out);
    assert!(out.join("checkpoint.bin").exists() && out.join("summary.json").exists());
    // Again, elsewhere on the path, on another number of threads.
    let output = stopped(&scratch, "out", interruption(), first + 8, &["--resume", "--threads", "2"]);
    assert_eq!(output.status.code(), Some(75), "{}", stderr(&output));
    assert!(stderr(&output).contains(&format!("resumed after step {first} ")), "{}", stderr(&output));
    let second = steps(&out);
    let message = resumed(&scratch, "out", &[]);
    assert!(message.contains(&format!("resumed after step {second} ")), "{message}");
    assert_same(&out, whole());
    // The parts' times add up.
    let times = |dir: &Path| Summary::read(&dir.join("summary.json")).expect("a summary");
    let phases = times(&out).time_by_phase;
    let sum: f64 = phases.rows().iter().map(|(_, time)| time.seconds).sum();
    assert!((sum / times(&out).wall_s - 1.0).abs() < 1e-9, "{phases:?}");
}

#[test]
fn a_killed_run_goes_on_from_its_last_checkpoint() {
    let scratch = scratch();
    let out = scratch.path("out");
    interrupted(&scratch, "out");
    let begun = steps(&out);
    let output = stopped(&scratch, "out", Signal::KILL, begun + 3, &["--resume", "-q"]);
    assert_eq!(output.status.code(), None, "{}", stderr(&output));
    let left = steps(&out);
    // A row cut short, and the draft of a checkpoint.
    let torn = fs::read_to_string(out.join("history.csv")).expect("a history") + "99,1,0.02,0.0";
    fs::write(out.join("history.csv"), torn).expect("a history");
    fs::write(out.join(".checkpoint.bin.4711.tmp"), "draft").expect("a draft");
    let message = resumed(&scratch, "out", &[]);
    let step: usize =
        message.split("resumed after step ").nth(1).expect("told").split(' ').next().unwrap().parse().expect("a step");
    assert!((begun..=left).contains(&step), "{step}: {message}");
    assert_same(&out, whole());
}

/// Copies the directory as it is after some steps: what a run that was killed then leaves.
struct Copies {
    from: PathBuf,
    to: PathBuf,
    after: Vec<usize>,
}

impl Progress for Copies {
    fn step(&mut self, position: &Position) {
        if self.after.contains(&position.step) {
            for (name, bytes) in files(&self.from) {
                let path = self.to.join(position.step.to_string()).join(name);
                fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
                fs::write(path, bytes).expect("a copy");
            }
        }
    }
    fn message(&mut self, _: &str) {}
    fn finish(&mut self, _: &str) {}
}

#[test]
fn a_run_killed_at_any_step_goes_on() {
    let scratch = scratch();
    let case = Case::load(&scratch.path("case.toml"), &[]).expect("the case");
    let history = read_history(&whole().join("history.csv")).expect("a history");
    let last_of = |segment| history.iter().filter(|row| row.segment == segment).map(|row| row.step).max().expect("steps");
    // In the press, at its end, just after it, in the shear, just after it, and at the very end.
    let after = vec![4, last_of(0), last_of(0) + 1, last_of(0) + 7, last_of(1) + 1, last_of(2)];

    let dir = scratch.path("run");
    OutputDirectory::create(&dir).and_then(|out| out.write_case(&case.to_toml())).expect("a directory");
    let problem = Problem::new(&case).expect("a problem");
    let mut backend = Cpu::<f64, f32>::with_tangents(vec![problem.model.clone()]).expect("a backend");
    let newton = problem.newton().expect("a solver");
    let (elements, unknowns) = (problem.model.mesh.elements.len(), newton.free_unknowns());
    let setting = Setting { computed_on: backend.about().description, elements, unknowns };
    let copies = Copies { from: dir.clone(), to: scratch.path("killed"), after: after.clone() };
    let mut results = ResultWriter::create(&case, &dir, setting, Clock::start(), Box::new(copies), Arc::default(), None)
        .expect("results")
        .with_checkpoints_every(Duration::ZERO);
    results.meshed(&problem);
    results.scouted(scout(&case, &Arc::default()).expect("a scout").expect("to its end"), 0.0);
    // What is told of a step comes before its checkpoint: that of each copy is one step old, or
    // older if writing it took long.
    assert_eq!(Drive::new(&problem, &mut backend, 0, newton).run(&mut results).expect("a run"), Ending::Done);
    drop(results);

    for step in after {
        let name = format!("killed/{step}");
        assert_eq!(steps(&scratch.path(&name)), step);
        let message = resumed(&scratch, &name, &[]);
        assert!(
            !message.contains(&format!("resumed after step {step} ")) && message.contains("resumed after step "),
            "{message}"
        );
        assert_same(&scratch.path(&name), whole());
    }
}

#[test]
fn an_interruption_of_the_coarse_run_is_a_run_that_has_not_begun() {
    let scratch = scratch();
    let out = scratch.path("out");
    // The machine may be so slow that the coarse run is over before the signal.
    for _ in 0..5 {
        let mut child = piped(program().args(scratch.args("out", &["-v", "--force"])));
        let mut told = BufReader::new(child.stderr.take().expect("stderr"));
        let mut line = String::new();
        while !line.contains("coarse run") {
            line.clear();
            assert!(told.read_line(&mut line).expect("stderr is UTF-8") > 0, "no coarse run");
        }
        kill_process(Pid::from_child(&child), Signal::TERM).expect("a signal is sent");
        told.read_to_string(&mut line).expect("stderr is UTF-8");
        let code = child.wait().expect("it ends").code();
        if code == Some(75) && steps(&out) == 0 {
            assert!(!out.join("checkpoint.bin").exists());
            let message = resumed(&scratch, "out", &["-v"]);
            assert!(message.contains("from the beginning"), "{message}");
            assert_same(&out, whole());
            return;
        }
    }
    panic!("no interruption came in time");
}

#[test]
fn a_run_that_has_ended_is_left_alone() {
    let scratch = scratch();
    let small =
        ["--set", "path.0.indentation=0.002", "--set", "mesh.elements_per_contact_radius=4", "--set", "output.fields=\"none\""];
    let with = |options: &[&'static str]| [&small[..], options].concat();
    let run = |name: &str, options: &[&'static str]| scratch.run(name, &with(options));
    let message = stderr(&run("out", &["--resume"]));
    assert!(message.contains("nothing to resume in "), "{message}");
    let before = files(&scratch.path("out"));
    let output = run("out", &["--resume"]);
    assert_eq!((output.status.code(), stderr(&output).as_str()), (Some(0), ""));
    let text = String::from_utf8(output.stdout).expect("text");
    assert!(text.starts_with("already done: ") && text.contains(" steps on CPU ("), "{text}");
    assert!(run("out", &["--resume", "-q"]).stdout.is_empty());
    // Another case has no business there.
    let output = run("out", &["--resume", "--set", "contact.friction=0.2"]);
    assert_eq!(output.status.code(), Some(2));
    let message = stderr(&output);
    assert!(message.contains("contact.friction is 0.3 there and 0.2 here") && message.contains("without --resume"), "{message}");
    assert!(files(&scratch.path("out")) == before);

    // What did not converge would not converge again.
    let fails = ["--set", "solver.max_iterations=1", "--set", "solver.max_cutbacks=0"];
    assert_eq!(run("fails", &fails).status.code(), Some(3));
    let before = files(&scratch.path("fails"));
    assert!(!before.contains_key("checkpoint.bin"));
    let output = run("fails", &[&fails[..], &["--resume"]].concat());
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(3), "{message}");
    assert!(message.starts_with("error: ended before: no convergence: ") && message.contains("without --resume"), "{message}");
    assert!(files(&scratch.path("fails")) == before);
}

#[test]
fn a_checkpoint_that_does_not_fit_is_refused_with_its_name_and_a_remedy() {
    let scratch = scratch();
    let out = scratch.path("out");
    let path = out.join("checkpoint.bin");
    interrupted(&scratch, "out");
    let good = fs::read(&path).expect("a checkpoint");
    let line = good.iter().position(|&byte| byte == b'\n').expect("a first line");
    let refused = |bytes: &[u8], options: &[&str], expected: &str| {
        fs::write(&path, bytes).expect("a checkpoint");
        let before = files(&out);
        let output = scratch.run("out", &[&["--resume"], options].concat());
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{expected}: {message}");
        for part in ["error: ", &path.display().to_string(), expected, "without --resume"] {
            assert!(message.contains(part), "{part}: {message}");
        }
        assert_eq!(message.lines().count(), 1, "{message}");
        assert!(files(&out) == before, "{expected}: something was changed");
    };
    refused(&good, &["--set", "contact.friction=0.2"], "contact.friction is 0.3 there and 0.2 here");
    refused(&good, &["--set", "mesh.elements_per_contact_radius=4"], "mesh.elements_per_contact_radius is 5 there and 4 here");
    for length in [0, 1, line, line + 1, line + 4, good.len() / 2, good.len() - 1] {
        refused(&good[..length], &[], "incomplete or damaged");
    }
    for place in [0, line, line + 1, good.len() / 2, good.len() - 1] {
        let mut flipped = good.clone();
        flipped[place] ^= 0x10;
        refused(&flipped, &[], "incomplete or damaged");
    }
    refused(&[&good[..], b"more"].concat(), &[], "incomplete or damaged");
    let other = [b"asperity checkpoint, format 1, version 0.0.1\n", &good[line + 1..]].concat();
    refused(&other, &[], "version 0.0.1");
    // The good one still does.
    fs::write(&path, &good).expect("a checkpoint");
    resumed(&scratch, "out", &["-q"]);
    assert_same(&out, whole());
}

#[test]
fn without_resume_a_run_begins_anew_only_by_force() {
    let scratch = scratch();
    interrupted(&scratch, "out");
    let before = files(&scratch.path("out"));
    // Only if it is said: what was computed would be lost.
    let output = scratch.run("out", &["-q"]);
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{message}");
    let parts = [
        "holds an unfinished run, of this very case, ",
        " s ago",
        "--resume goes on",
        "--force replaces it",
        "nothing was changed",
    ];
    assert!(parts.iter().all(|part| message.contains(part)) && message.lines().count() == 1, "{message}");
    assert!(files(&scratch.path("out")) == before);
    let output = scratch.run("out", &["-q", "--force"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_same(&scratch.path("out"), whole());
}

#[test]
fn a_run_on_a_device_goes_on_there_to_the_same_bits_and_elsewhere_with_a_note() {
    if device::device("resume", Precision::F64).is_none() {
        return;
    }
    let scratch = scratch();
    // The press alone, in few steps: software adapters are slow.
    let press: Vec<&str> = CASE.split("[[path]]").take(2).collect();
    let one_body = press.join("[[path]]");
    let two_bodies = press.join(&format!("{UNLIKE}[[path]]"));
    let small = ["mesh.elements_per_contact_radius=4", "solver.press_steps=5", "solver.error_estimate=false"];
    let sets: Vec<&str> = small.iter().flat_map(|set| ["--set", set]).collect();
    // Solved tightly, the device and the CPU come to the same force.
    let tight = "solver.tolerance=1e-8";
    let runs = [("plane", &one_body, "f64"), ("plane in f32 and f64", &one_body, "mixed"), ("pair", &two_bodies, "f64")];
    for (name, case, precision) in runs {
        fs::write(scratch.path("case.toml"), case).expect("the case");
        let run = |options: &[&str], device: &str| {
            let mut args = scratch.args(name, &[&sets[..], &["--set", tight, "--precision", precision], options].concat());
            args.iter_mut().filter(|arg| *arg == "cpu").for_each(|arg| *arg = device.into());
            args
        };
        let whole = scratch.path("whole");
        let args = run(&["--force"], "gpu")
            .into_iter()
            .map(|arg| if Path::new(&arg) == scratch.path(name) { whole.clone().into() } else { arg });
        assert_eq!(program().args(args).output().expect("it runs").status.code(), Some(0));
        let out = scratch.path(name);
        let output = stop(piped(program().args(run(&[], "gpu"))), Signal::TERM, &out, 2);
        assert_eq!(output.status.code(), Some(75), "{}", stderr(&output));
        let (left, at) = (files(&out), steps(&out));
        let output = program().args(run(&["--resume"], "gpu")).output().expect("it runs");
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        assert!(stderr(&output).contains(&format!("resumed after step {at} ")), "{}", stderr(&output));
        assert_same(&out, &whole);

        // The checkpoint again, now on the CPU in the same precision.
        fs::remove_file(out.join("summary.json")).expect("a summary");
        fs::write(out.join("checkpoint.bin"), &left["checkpoint.bin"]).expect("a checkpoint");
        let output = program().args(run(&["--resume"], "cpu")).output().expect("it runs");
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let read = |dir: &Path| Summary::read(&dir.join("summary.json")).expect("a summary");
        let (here, there) = (read(&out), read(&whole));
        let note = format!("note: computed up to step {at} on {}, from there on {}", there.device, here.device);
        // Before it stands what the device left to the host: nothing over a plane.
        assert_eq!(there.messages.len(), usize::from(name == "pair"), "{:?}", there.messages);
        assert_eq!(here.messages, [&there.messages[..], &[note]].concat());
        let ratio = here.f_n0.expect("a force") / there.f_n0.expect("a force");
        assert!((ratio - 1.0).abs() < 1e-7, "{name}: {ratio}");
    }
}

/// A limit on the size of a file stands for a full disk; nothing else that this run writes is as
/// large as its checkpoint.
#[cfg(target_os = "linux")]
#[test]
fn a_disk_that_fills_costs_the_checkpoint_and_not_the_run() {
    let scratch = scratch();
    let none = ["--set", "output.fields=\"none\""];
    let limited = |options: &[&str]| {
        let mut command = Command::new("bash");
        command.args(["-c", "ulimit -f 200; exec \"$@\"", "bash"]);
        command.arg(assert_cmd::cargo::cargo_bin!("asperity"));
        command.args(scratch.args("out", &[&none[..], options].concat()));
        command
    };
    let out = scratch.path("out");
    assert_eq!(stopped(&scratch, "out", Signal::TERM, 2, &none).status.code(), Some(75));
    let good = fs::read(out.join("checkpoint.bin")).expect("a checkpoint");
    assert!(good.len() > 200 << 10, "{} bytes", good.len());
    let output = stop(piped(&mut limited(&["--resume"])), Signal::TERM, &out, steps(&out) + 2);
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(75), "{message}");
    assert!(message.contains("warning: no checkpoint, the run goes on without: cannot write "), "{message}");
    assert!(fs::read(out.join("checkpoint.bin")).expect("a checkpoint") == good);
    // To the end without a single checkpoint.
    let output = limited(&["--resume"]).output().expect("bash runs");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(stderr(&output).matches("warning: no checkpoint").count(), 1, "{}", stderr(&output));
    for name in ["history.csv", "plots/forces.svg", "plots/contact.svg"] {
        assert!(fs::read(out.join(name)).expect("a file") == fs::read(whole().join(name)).expect("a file"), "{name} differs");
    }
    assert!(!out.join("checkpoint.bin").exists());
}
