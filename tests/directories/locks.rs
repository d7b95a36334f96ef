//! Where the file system grants every lock, the file that tells who has it counts.
#![cfg(target_os = "linux")]

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant, SystemTime};

use super::common::{Scratch, files, program, stderr};

#[path = "../common/programs.rs"]
mod programs;

const CASE: &str = include_str!("case.toml");
const SLOW: [&str; 6] = ["-q", "--device", "cpu", "--set", "solver.press_steps=400", "--threads=1"];

#[test]
fn a_live_run_is_not_taken_over_where_every_lock_is_granted() {
    if !programs::has("gcc", "locks") {
        return;
    }
    let scratch = Scratch::new(CASE, &[]);
    let (source, library) = (scratch.path("flock.c"), scratch.path("flock.so"));
    fs::write(&source, "int flock(int file, int operation) { (void)file; (void)operation; return 0; }\n").expect("a source");
    let built = Command::new("gcc").args(["-shared", "-fPIC", "-o"]).args([&library, &source]).status().expect("gcc runs");
    assert!(built.success());
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

fn age(lock: &Path) {
    let file = fs::File::options().write(true).open(lock).expect("the lock");
    file.set_modified(SystemTime::now() - Duration::from_secs(61)).expect("a time");
}
