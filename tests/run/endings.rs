//! How a run ends that does not come to its end, and what it keeps.

use std::fs;
use std::path::Path;
use std::process::Command;

use asperity::internals::compute::wrong::WRONG_VARIABLE;
use asperity::output::{RunStatus, read_history};

use super::common::{program, stderr, stdout};
use super::{CPU, SHEAR, done, names, results, scratch, timeless};

#[test]
fn a_step_that_does_not_converge_ends_with_3_and_keeps_what_there_is() {
    let scratch = scratch(SHEAR);
    let output = scratch.run("out", &["--set", "solver.max_iterations=4", "--set", "solver.max_cutbacks=0", "-q"]);
    assert_eq!(output.status.code(), Some(3), "{}", stderr(&output));
    let message = stderr(&output);
    let (history, summary) = results(&scratch.path("out"));
    // The step that failed is the one after the last row, and both are counted alike.
    let failed = format!("error: no convergence: step {} of segment 0 (", history.last().map_or(1, |row| row.step + 1));
    for word in [&failed, "merit ", "node ", "[solver] press_steps", "is kept in "] {
        assert!(message.contains(word), "{word}: {message}");
    }
    assert_eq!(message.lines().count(), 1, "{message}");
    assert_eq!((summary.status, summary.steps), (RunStatus::NotConverged, history.len()));
    assert!(summary.messages.last().is_some_and(|last| last.contains("no convergence: step ")), "{:?}", summary.messages);
    // Not one step: still a history with its columns, and a summary whose numbers do not exist.
    let output = scratch.run("none", &["--set", "solver.max_iterations=1", "--set", "solver.max_cutbacks=0"]);
    assert_eq!(output.status.code(), Some(3), "{}", stderr(&output));
    let (history, summary) = results(&scratch.path("none"));
    assert!(history.is_empty() && summary.f_n0.is_none() && summary.steps == 0);
    // The time of attempts that led to no step is told all the same.
    assert!(summary.time_by_phase.tangent.seconds > 0.0 && summary.time_by_phase.linear_solve.seconds > 0.0, "{summary:?}");
    assert!(stdout(&output).contains("not converged in ") && stdout(&output).contains(" s, 0 steps; "), "{}", stdout(&output));
}

#[cfg(unix)]
#[test]
fn an_interrupted_run_ends_with_75_and_keeps_what_there_is() {
    use asperity::internals::cli::signals::is_ignored;
    use rustix::process::{Pid, Signal, kill_process};
    use std::time::{Duration, Instant};

    let scratch = scratch("[[path]]\nshear = 0.01\n");
    for (name, signal) in [
        ("terminated", Signal::TERM),
        ("interrupted", Signal::INT),
        ("warned", Signal::USR1),
        ("warned-too", Signal::USR2),
        ("out-of-time", Signal::XCPU),
        ("hung-up", Signal::HUP),
    ] {
        let mut command = program();
        // Far more steps than it makes before the signal comes, however busy the machine.
        let long = ["solver.press_steps=400", "mesh.contact_radius=0.22", "solver.error_estimate=false"];
        command.args(scratch.args(name, &long.map(|set| ["--set", set]).concat()));
        let child = command.stdout(std::process::Stdio::piped()).stderr(std::process::Stdio::piped()).spawn().expect("a run");
        let history = scratch.path(name).join("history.csv");
        let started = Instant::now();
        while read_history(&history).map_or(0, |rows| rows.len()) < 2 {
            assert!(started.elapsed() < Duration::from_secs(60), "no step in a minute");
            std::thread::sleep(Duration::from_millis(5));
        }
        kill_process(Pid::from_child(&child), signal).expect("a signal is sent");
        let output = child.wait_with_output().expect("it ends");
        let message = stderr(&output);
        if is_ignored(signal.as_raw()) {
            // These tests were started by `nohup` or in the background, and so was the run: it goes
            // on.
            assert_eq!(output.status.code(), Some(0), "{message}");
            continue;
        }
        assert_eq!(output.status.code(), Some(75), "{message}");
        assert!(
            message.contains("error: interrupted by a signal after step ")
                && message.contains("run the same command with --resume"),
            "{message}"
        );
        let (history, summary) = results(&scratch.path(name));
        assert!(history.len() >= 2);
        assert_eq!((summary.status, summary.steps), (RunStatus::Interrupted, history.len()));
        assert_eq!(names(&scratch.path(name).join("fields")), ["case.pvd".to_owned(), format!("step_{:04}.vtu", history.len())]);
    }
}

#[test]
fn bad_places_and_devices_end_with_2_and_touch_nothing() {
    let scratch = scratch(SHEAR);
    let mine = scratch.path("mine");
    fs::create_dir(&mine).expect("a directory");
    fs::write(mine.join("notes.txt"), "mine").expect("a file");
    for (out, options, expected) in [
        ("mine", &[][..], "is not an Asperity result"),
        ("mine/notes.txt", &[], "is not a directory"),
        ("mine/notes.txt/below", &[], "cannot be"),
        ("new", &["--set", "contact.friction=-1"], "contact.friction"),
    ] {
        let output = scratch.run(out, options);
        assert_eq!(output.status.code(), Some(2), "{out} {options:?}: {}", stderr(&output));
        assert!(stderr(&output).starts_with("error: ") && stderr(&output).contains(expected), "{}", stderr(&output));
        assert!(output.stdout.is_empty());
    }
    assert_eq!(names(&mine), ["notes.txt"]);
    assert_eq!(fs::read_to_string(mine.join("notes.txt")).expect("still there"), "mine");
    assert!(!scratch.path("new").exists());
}

/// A limit on the size of a file stands for a full disk: the system refuses the first write beyond
/// it.
#[cfg(target_os = "linux")]
#[test]
fn a_disk_that_fills_ends_with_3_and_leaves_nothing_half_written() {
    let scratch = scratch(SHEAR);
    let output = Command::new("bash")
        .args(["-c", "ulimit -f 60; exec \"$@\"", "bash"])
        .arg(assert_cmd::cargo::cargo_bin!("asperity"))
        .arg("run")
        .args([&scratch.path("case.toml"), Path::new("--out"), &scratch.path("out")])
        .args(CPU)
        .output()
        .expect("bash runs");
    assert_eq!(output.status.code(), Some(3), "{}", stderr(&output));
    let message = stderr(&output);
    assert!(
        message.contains("error: the run broke off after 5 steps: cannot write ") && message.contains("step_0005.vtu"),
        "{message}"
    );
    assert_eq!(message.lines().filter(|line| line.starts_with("error")).count(), 1, "{message}");
    let (history, summary) = results(&scratch.path("out"));
    assert_eq!((history.len(), summary.status), (5, RunStatus::Interrupted));
    assert!(summary.messages[0].contains("step_0005.vtu"), "{:?}", summary.messages);
    assert!(names(&scratch.path("out").join("fields")).is_empty());
}

/// From some step on the backend computes wrongly: the step is cut, the run ends, and says why.
#[test]
fn a_number_that_is_none_and_a_material_that_refuses_are_told_as_what_they_are() {
    let scratch = scratch(SHEAR);
    let options = ["-q", "--set", "solver.error_estimate=false", "--set", "solver.max_cutbacks=2"];
    for (wrong, what) in [
        ("contact:0", "step 1 of segment 0 "),
        ("force:2", "the residual is not finite at node "),
        ("tangential-force:3", "the residual is not finite at node "),
        ("tangent:2", "a number that is not finite in the row of node "),
        ("material:2", "the material refuses the deformation of element 7 at quadrature point 3: its stress or plastic strain"),
        ("commit:2", "where the step is committed"),
    ] {
        let name = wrong.replace(':', "-after-");
        let output = program().args(scratch.args(&name, &options)).env(WRONG_VARIABLE, wrong).output().expect("it runs");
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(3), "{wrong}: {message}");
        assert!(message.starts_with("error: no convergence: step ") && message.contains(what), "{wrong}: {message}");
        assert!(message.contains("the step was bisected 2 times") && !message.contains("inverts"), "{wrong}: {message}");
        let (history, summary) = results(&scratch.path(&name));
        assert_eq!(summary.status, RunStatus::NotConverged, "{wrong}");
        assert_eq!(history.len().to_string(), wrong.rsplit(':').next().expect("a number"), "{wrong}");
    }
}

/// What is no number is not written, and the state before it is kept: another device may go on.
#[test]
fn a_result_that_is_no_number_ends_the_run_and_not_what_was_computed_before() {
    let scratch = scratch(SHEAR);
    let options = ["-q", "--set", "solver.error_estimate=false", "--checkpoint-every", "0"];
    done(&scratch, "whole", &options);
    let output = program().args(scratch.args("out", &options)).env(WRONG_VARIABLE, "energy:4").output().expect("it runs");
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(3), "{message}");
    assert!(message.contains("--resume"), "{message}");
    let (history, summary) = results(&scratch.path("out"));
    assert_eq!(summary.status, RunStatus::Failed);
    assert!(!history.is_empty() && history.iter().all(|row| row.energy_elastic.is_finite()), "{history:?}");
    let output = scratch.run("out", &[&options[..], &["--resume"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let [whole, resumed] = ["whole", "out"].map(|name| results(&scratch.path(name)));
    assert!(resumed.0 == whole.0 && timeless(&resumed.1) == timeless(&whole.1), "{:?} {:?}", resumed.1, whole.1);
}
