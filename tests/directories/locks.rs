//! Where the file system grants every lock, the file that tells who has it counts.
#![cfg(target_os = "linux")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant, SystemTime};

use super::common::{Scratch, files, program, stderr};
use super::study;

#[path = "../common/programs.rs"]
mod programs;

const CASE: &str = include_str!("case.toml");
const SLOW: [&str; 6] = ["-q", "--device", "cpu", "--set", "solver.press_steps=400", "--threads=1"];

/// Every lock is granted.
const GRANTED: &str = "int flock(int file, int operation) { (void)file; (void)operation; return 0; }\n";
/// The clock of this host is two hours fast; that of the file system is not.
const FAST: &str = r"
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>
int clock_gettime(clockid_t clock, struct timespec *time) {
    long failed = syscall(SYS_clock_gettime, clock, time);
    if (clock == CLOCK_REALTIME) time->tv_sec += 7200;
    return (int)failed;
}
";
/// Whoever makes a file empty takes his time.
const SLOWLY: &str = r"
#include <sys/syscall.h>
#include <unistd.h>
int ftruncate64(int file, long length) {
    usleep(300000);
    return (int)syscall(SYS_ftruncate, file, length);
}
";

/// A library that takes the place of functions of the system; `None` without a compiler.
fn library(dir: &Path, source: &str) -> Option<PathBuf> {
    if !programs::has("gcc", "locks") {
        return None;
    }
    let (file, library) = (dir.join("stub.c"), dir.join("stub.so"));
    fs::write(&file, source).expect("a source");
    let built = Command::new("gcc").args(["-shared", "-fPIC", "-o"]).args([&library, &file]).status().expect("gcc runs");
    assert!(built.success());
    Some(library)
}

#[test]
fn a_live_run_is_not_taken_over_where_every_lock_is_granted() {
    let scratch = Scratch::new(CASE, &[]);
    let Some(library) = library(scratch.dir.path(), GRANTED) else { return };
    let run = |options: &[&str]| {
        let mut command = program();
        command.args(scratch.args("out", &[&SLOW[..], options].concat())).env("LD_PRELOAD", &library);
        command
    };
    let mut child = run(&[]).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("the program runs");
    let (begun, lock) = (Instant::now(), scratch.path("out/.asperity.lock"));
    let steps = || fs::read_to_string(scratch.path("out/history.csv")).map_or(0, |text| text.lines().count());
    while steps() < 4 {
        assert!(begun.elapsed() < Duration::from_secs(120), "no steps");
        std::thread::sleep(Duration::from_millis(2));
    }
    let refused = |holder: &str| {
        for options in [&[][..], &["--force"], &["--resume"]] {
            let output = run(options).output().expect("the program runs");
            let message = stderr(&output);
            assert_eq!(output.status.code(), Some(2), "{message}");
            assert!(message.contains(&format!("is being written by process {holder}")), "{message}");
            assert!(message.contains("If it was killed, start again in ") && message.lines().count() == 1, "{message}");
        }
    };
    refused(&format!("{} on ", child.id()));
    // As if it were on another host, where its process cannot be looked for.
    fs::write(&lock, "process 4711 on node7\n").expect("the lock");
    refused("4711 on node7");
    assert!(child.try_wait().expect("its state").is_none(), "it goes on");
    child.kill().expect("killed");
    child.wait().expect("it ends");
    // Just killed, for all that is known; a minute later it is gone.
    refused("4711 on node7");
    age(&lock);
    let output = run(&["--resume"]).output().expect("the program runs");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(!files(&scratch.path("out")).keys().any(|name| name.contains(".asperity.")));
}

#[test]
fn of_two_who_take_over_one_lock_where_every_lock_is_granted_one_has_it() {
    let scratch = Scratch::new(CASE, &[]);
    let Some(library) = library(scratch.dir.path(), &format!("{SLOWLY}{GRANTED}")) else { return };
    for _ in 0..3 {
        fs::create_dir(scratch.path("out")).expect("a directory");
        let lock = scratch.path("out/.asperity.lock");
        fs::write(&lock, "process 4711 on node7\n").expect("the lock");
        age(&lock);
        let start = || {
            let mut command = program();
            command.args(scratch.args("out", &SLOW)).env("LD_PRELOAD", &library);
            command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("the program runs")
        };
        let mut runs = [start(), start()];
        let mut ended = || runs.iter_mut().position(|run| run.try_wait().expect("its state").is_some());
        let loser = loop {
            match ended() {
                Some(loser) => break loser,
                None => std::thread::sleep(Duration::from_millis(2)),
            }
        };
        let [first, second] = runs;
        let (loser, mut winner) = if loser == 0 { (first, second) } else { (second, first) };
        let output = loser.wait_with_output().expect("it ends");
        assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
        let holder = format!("is being written by process {} on ", winner.id());
        assert!(stderr(&output).contains(&holder), "{}", stderr(&output));
        assert!(winner.try_wait().expect("its state").is_none(), "it goes on");
        winner.kill().expect("killed");
        winner.wait().expect("it ends");
        fs::remove_dir_all(scratch.path("out")).expect("removed");
    }
}

#[test]
fn shares_of_different_length_end_well_where_every_lock_is_granted() {
    /// The first share has the case that takes some seconds.
    const UNEQUAL: &str = "[grid]\n\"solver.press_steps\" = [4, 400]\n";
    let scratch = study::Scratch::new();
    let Some(library) = library(&scratch.path(""), GRANTED) else { return };
    let preload = ("LD_PRELOAD", library.as_path());
    let mut long = scratch.started(UNEQUAL, "out", &["--shard", "1/2"], &[preload]);
    let run = |grid: &str, options: &[&str]| {
        let mut command = scratch.command(grid, "out", options);
        command.env(preload.0, preload.1).output().expect("the program runs")
    };
    let short = run(UNEQUAL, &["-q", "--shard", "2/2"]);
    assert_eq!(short.status.code(), Some(0), "{}", stderr(&short));
    let out = scratch.path("out");
    let merged = program().args(["study", "--merge"]).arg(&out).arg("--out").arg(&out).env(preload.0, preload.1).output();
    assert_eq!(merged.expect("the program runs").status.code(), Some(75));
    let refused = run("[grid]\n\"contact.friction\" = [0.15, 0.25]\n", &["-q", "--force"]);
    let message = stderr(&refused);
    assert_eq!(refused.status.code(), Some(2), "{message}");
    assert!(message.contains(&format!("is being written by process {} on ", long.id())), "{message}");
    assert!(message.contains(", which computes another study. Wait") && message.contains("nothing was changed"), "{message}");
    assert!(long.try_wait().expect("its state").is_none(), "it goes on");
    let long = long.wait_with_output().expect("it ends");
    assert_eq!(long.status.code(), Some(0), "{}", stderr(&long));
    assert_eq!(study::statuses(&out), ["done"; 2]);
    assert!(!files(&out).keys().any(|name| name.contains(".asperity.")));
}

#[test]
fn how_old_a_lock_is_is_told_by_the_clock_of_its_file_system() {
    const GRID: &str = "[grid]\n\"contact.friction\" = [0.1]\n";
    let scratch = study::Scratch::new();
    let Some(library) = library(&scratch.path(""), &format!("{FAST}{GRANTED}")) else { return };
    for name in [".asperity.study.0123456789abcdef.4711", "cases/c0001/.asperity.lock"] {
        scratch.ends_with(0, GRID, "out", &["-q", "--force"]);
        let lock = scratch.path("out").join(name);
        fs::write(&lock, "process 4711 on node7\nstudy 0123456789abcdef\n").expect("a lock");
        let run = || {
            let mut command = scratch.command(GRID, "out", &["-q", "--force"]);
            command.env("LD_PRELOAD", &library).output().expect("the program runs")
        };
        let message = stderr(&run());
        assert!(message.contains("process 4711 on node7") && message.contains("start again in "), "{name}: {message}");
        age(&lock);
        let output = run();
        assert_eq!(output.status.code(), Some(0), "{name}: {}", stderr(&output));
    }
}

fn age(lock: &Path) {
    let file = fs::File::options().write(true).open(lock).expect("the lock");
    file.set_modified(SystemTime::now() - Duration::from_secs(61)).expect("a time");
}
