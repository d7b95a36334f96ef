//! Files without an end, and pipes to which nobody writes, in the place of each file that the
//! program reads.
#![cfg(target_os = "linux")]

mod common;

use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use std::time::{Duration, Instant};

use rustix::fs::{CWD, FileType, mknodat};

fn text(path: &Path) -> &str {
    path.to_str().expect("a path in UTF-8")
}

/// Runs the program; one that does not end within five minutes is a failure.
fn ended(arguments: &[&str]) -> Output {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("asperity"));
    let piped = std::process::Stdio::piped;
    let mut child = command.args(arguments).stdout(piped()).stderr(piped()).spawn().expect("the program runs");
    let begun = Instant::now();
    while child.try_wait().expect("a child").is_none() {
        if begun.elapsed() > Duration::from_secs(300) {
            child.kill().expect("it is ours");
            panic!("{arguments:?} does not end");
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    child.wait_with_output().expect("what it said")
}

fn refused(arguments: &[&str], part: &str) {
    let output = ended(arguments);
    let message = common::stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
    assert!(message.contains(part), "{arguments:?}: {part:?} in {message}");
}

#[test]
fn a_device_without_an_end_is_refused_by_every_command() {
    let scratch = tempfile::tempdir().expect("a scratch directory");
    let out = scratch.path().join("out");
    let (zero, case, out) = ("/dev/zero", "fixtures/cases/ideal.toml", text(&out));
    for arguments in [
        vec!["check", zero],
        vec!["run", zero, "--out", out],
        vec!["study", zero, "--out", out],
        vec!["point", zero],
        vec!["law", "predict", "built-in", zero],
        vec!["law", "tabulate", zero, "--out", out],
        vec!["law", "compose", zero, "built-in", "built-in", "--out", out],
        vec!["law", "check", "built-in", zero],
        vec!["law", "export", "built-in", zero, "--format", "c"],
    ] {
        refused(&arguments, "it has more than 16 MiB, the most that such a file may have");
    }
    for arguments in [
        vec!["point", case, "--path", zero],
        vec!["law", "predict", zero, case],
        vec!["law", "export", zero, case, "--format", "c"],
        vec!["law", "check", zero, case],
    ] {
        refused(&arguments, "it has more than 256 MiB, the most that such a file may have");
    }
    assert!(!Path::new(out).exists());
}

/// A run of a second, as a study of one case.
const STUDY: &str = r#"
[base.sphere]
radius = 1.0
[base.material]
youngs_modulus = 200e3
poissons_ratio = 0.3
[base.material.hardening]
law = "ideal"
yield_stress = 400.0
[base.contact]
friction = 0.3
[base.mesh]
elements_per_contact_radius = 4
[base.solver]
press_steps = 2
error_estimate = false
[[base.path]]
indentation = 0.005
[grid]
"contact.friction" = [0.3]
"#;

/// In the place of each file of a run and of a study a pipe, and then a device without an end.
#[test]
fn a_pipe_among_results_is_not_waited_for() {
    let scratch = tempfile::tempdir().expect("a scratch directory");
    let (file, study) = (scratch.path().join("study.toml"), scratch.path().join("study"));
    fs::write(&file, STUDY).expect("the study");
    let output = ended(&["study", text(&file), "--out", text(&study), "--device", "cpu", "-q"]);
    assert_eq!(output.status.code(), Some(0), "{}", common::stderr(&output));
    let (run, picture) = (study.join("cases/c0001"), scratch.path().join("compare.svg"));
    let names = ["study.csv", "study.toml", "case.toml", "history.csv", "summary.json"];
    for name in names {
        let path = [study.join(name), run.join(name)].into_iter().find(|path| path.exists()).expect(name);
        let aside = scratch.path().join("aside");
        fs::rename(&path, &aside).expect("a file");
        for endless in [false, true] {
            match endless {
                true => std::os::unix::fs::symlink("/dev/zero", &path).expect("a link"),
                false => mknodat(CWD, &path, FileType::Fifo, 0o600.into(), 0).expect("a pipe"),
            }
            for arguments in [
                vec!["plot", text(&study)],
                vec!["plot", text(&run)],
                vec!["law", "fit", text(&study)],
                vec!["law", "fit", text(&study), "--interpolate"],
                vec!["compare", text(&run), text(&run), "--out", text(&picture)],
                vec!["study", text(&file), "--out", text(&study), "--device", "cpu", "-q"],
            ] {
                // Some of them need others of the files: they end well, or say what they lack.
                let output = ended(&arguments);
                let message = common::stderr(&output);
                assert!(matches!(output.status.code(), Some(0 | 2 | 3)), "{name} {arguments:?}: {:?} {message}", output.status);
                assert!(!message.contains("out of memory"), "{name} {arguments:?}: {message}");
            }
            assert!(path.symlink_metadata().is_ok_and(|found| !found.is_file()), "{name} was replaced");
            fs::remove_file(&path).expect("a pipe or a link");
        }
        fs::rename(&aside, &path).expect("a file");
    }
    let output = ended(&["compare", text(&run), text(&run), "--out", text(&picture)]);
    assert_eq!(output.status.code(), Some(0), "{}", common::stderr(&output));
}
