//! Signals and limits of the system: what was ignored stays ignored, warnings end a run as SIGTERM
//! does, and a limit on the size of files is told like a full disk.

use std::fs;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use asperity::output::{RunStatus, Summary, read_history};
use rustix::process::{Pid, Signal, kill_process};

use super::common::{Scratch, difference, files, program, stderr};
use super::program::{scratch, whole};

/// The program, started by a shell after these commands of it.
fn after(commands: &str, scratch: &Scratch, out: &Path, options: &[&str]) -> Command {
    let mut command = Command::new("bash");
    command.args(["-c", &format!("{commands}; exec \"$@\""), "bash"]).arg(program().get_program());
    command.args(scratch.args(out, options));
    command
}

/// Steps of the history, 0 if it cannot be read.
fn steps(out: &Path) -> usize {
    read_history(&out.join("history.csv")).map_or(0, |rows| rows.len())
}

/// Starts a run and waits until it has some steps.
fn started(command: &mut Command, out: &Path) -> Child {
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it runs");
    let begun = Instant::now();
    while steps(out) < 2 {
        assert!(begun.elapsed() < Duration::from_secs(120), "no steps");
        std::thread::sleep(Duration::from_millis(2));
    }
    child
}

fn send(child: &Child, signal: Signal) {
    kill_process(Pid::from_child(child), signal).expect("a signal is sent");
}

#[test]
fn a_signal_that_is_ignored_at_the_start_stays_ignored() {
    let scratch = scratch();
    let out = scratch.path("out");
    let long = ["-q", "--set", "solver.press_steps=60"];
    let mut child = started(&mut after("trap '' INT HUP TERM USR1 USR2 XCPU", &scratch, &out, &long), &out);
    for signal in [Signal::INT, Signal::HUP, Signal::TERM, Signal::USR1, Signal::USR2, Signal::XCPU] {
        assert!(child.try_wait().expect("its state").is_none(), "it was over before {signal:?}");
        send(&child, signal);
    }
    let output = child.wait_with_output().expect("it ends");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    // In the background of a script, which is where SIGINT is ignored; SIGTERM still is not.
    let out = scratch.path("background");
    let mut command = Command::new("sh");
    command.args(["-c", "\"$@\" & echo $! > \"$0\"; wait $!"]).arg(scratch.path("process")).arg(program().get_program());
    let child = started(command.args(scratch.args(&out, &long)), &out);
    let process: i32 = fs::read_to_string(scratch.path("process")).expect("a number").trim().parse().expect("a number");
    let process = Pid::from_raw(process).expect("a process");
    kill_process(process, Signal::INT).expect("a signal is sent");
    let before = steps(&out);
    while steps(&out) < before + 3 {
        assert!(!out.join("summary.json").exists(), "SIGINT ended it");
        std::thread::sleep(Duration::from_millis(2));
    }
    kill_process(process, Signal::TERM).expect("a signal is sent");
    let output = child.wait_with_output().expect("it ends");
    assert_eq!(output.status.code(), Some(75), "{}", stderr(&output));
}

#[test]
fn a_warning_that_comes_again_lets_the_run_write_its_checkpoint() {
    let scratch = scratch();
    // Steps that are longer than what lies between the warnings.
    let slow = ["-q", "--set", "mesh.elements_per_contact_radius=20", "--set", "solver.press_steps=60"];
    for (name, signals) in [("lsf", [Signal::XCPU, Signal::XCPU]), ("sge", [Signal::USR1, Signal::USR2])] {
        let out = scratch.path(name);
        let mut child = started(program().args(scratch.args(&out, &slow)), &out);
        for signal in signals {
            if child.try_wait().expect("its state").is_none() {
                send(&child, signal);
                std::thread::sleep(Duration::from_millis(300));
            }
        }
        let output = child.wait_with_output().expect("it ends");
        assert_eq!(output.status.code(), Some(75), "{name}: {}", stderr(&output));
        assert!(out.join("checkpoint.bin").exists(), "{name}");
    }
}

/// The run that is limited to files of so many KiB.
fn limited(scratch: &Scratch, out: &Path, kib: usize) -> Output {
    after(&format!("ulimit -f {kib}"), scratch, out, &["-q"]).output().expect("bash runs")
}

#[test]
fn a_limit_on_the_size_of_files_is_told_like_a_full_disk_and_nothing_is_lost() {
    let scratch = scratch();
    let largest = files(whole()).values().map(|bytes| bytes.len().div_ceil(1024)).max().expect("files");
    let (mut told, mut without_checkpoint) = (0, 0);
    for kib in [0, 1, 2, 4, 8, 16, 32, 64, largest / 2, largest - 1, largest + 1] {
        let out = scratch.path(format!("out{kib}"));
        let output = limited(&scratch, &out, kib);
        let (code, message) = (output.status.code(), stderr(&output));
        assert!(matches!(code, Some(0 | 2 | 3)), "{kib} KiB: {:?} {message}", output.status);
        let errors = message.lines().filter(|line| line.starts_with("error: ")).count();
        assert_eq!(errors, usize::from(code != Some(0)), "{kib} KiB: {message}");
        if code == Some(0) {
            without_checkpoint += usize::from(!out.join("checkpoint.bin").exists());
        } else {
            told += 1;
            assert!(message.contains(&out.display().to_string()) && message.contains("`ulimit -f`"), "{kib} KiB: {message}");
            let summary = Summary::read(&out.join("summary.json")).ok();
            assert!(summary.is_none_or(|summary| summary.status != RunStatus::Done), "{kib} KiB: done, but {message}");
            let output = scratch.run(&out, &["-q", "--resume"]);
            assert_eq!(output.status.code(), Some(0), "{kib} KiB: {}", stderr(&output));
            assert_eq!(difference(&out, whole()), None, "{kib} KiB, after {message}");
        }
    }
    println!("{told} limits were met, {without_checkpoint} of them by the checkpoint alone");
    assert!(told > 4, "{told}");
    // What is printed too.
    let printed = scratch.path("printed");
    let script = "ulimit -f 0; exec \"$@\" > \"$0\"";
    let output = Command::new("bash")
        .args(["-c", script])
        .arg(&printed)
        .arg(program().get_program())
        .arg("check")
        .arg(scratch.path("case.toml"))
        .output()
        .expect("bash runs");
    assert_eq!(output.status.code(), Some(2), "{:?} {}", output.status, stderr(&output));
    assert!(stderr(&output).starts_with("error: stdout: cannot be written: "), "{}", stderr(&output));
}
