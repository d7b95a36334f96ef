//! Killed at every system call that changes a file, a run goes on to the bits of one that was left
//! in peace.

use std::collections::BTreeMap;
use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Command, Output};
use std::time::Instant;

use asperity::output::read_history;

use super::common::{Scratch, difference, files, program, stderr};
use super::program::{scratch, skipped, whole};

/// Those that change a file, or hold on to one; the question mark lets one be unknown to the
/// system.
const CALLS: &str = "?open,openat,write,?pwrite64,?rename,?renameat,renameat2,?unlink,unlinkat,?link,linkat,?mkdir,mkdirat,?rmdir,fsync,fdatasync,ftruncate,flock";

fn strace(scratch: &Scratch, out: &Path, options: &[&str], tracing: &[&str]) -> Output {
    let mut command = Command::new("strace");
    command.args(["-f", "-qq", "-y"]).args(tracing).arg(program().get_program()).args(scratch.args(out, options));
    command.output().expect("strace runs")
}

fn can_trace() -> bool {
    Command::new("strace").args(["-f", "-qq", "-e", "trace=none", "true"]).output().is_ok_and(|output| output.status.success())
}

/// The calls of the run's thread that touch the directory: the name, and the how many-eth of that
/// name it is, counting all.
fn calls(log: &str, out: &Path) -> Vec<(String, usize)> {
    let out = out.display().to_string();
    let thread = |line: &str| line.split_whitespace().next().expect("a traced call").to_owned();
    let mut writes: BTreeMap<String, usize> = BTreeMap::new();
    log.lines().filter(|line| line.contains(&out)).for_each(|line| *writes.entry(thread(line)).or_default() += 1);
    // The thread in which the run is.
    let (writer, _) = writes.into_iter().max_by_key(|(_, writes)| *writes).expect("a thread that writes");
    let (mut counts, mut others, mut found) = (BTreeMap::new(), BTreeMap::new(), Vec::new());
    for line in log.lines() {
        let of = thread(line);
        let Some((name, _)) = line[of.len()..].trim_start().split_once('(') else { continue };
        if of != writer {
            *others.entry((of, name.to_owned())).or_insert(0) += 1;
            continue;
        }
        let count: &mut usize = counts.entry(name.to_owned()).or_default();
        *count += 1;
        let reads = name.starts_with("open") && !line.contains("O_WRONLY") && !line.contains("O_RDWR");
        if line.contains(&out) && !reads {
            found.push((name.to_owned(), *count));
        }
    }
    // Calls are counted in each thread by itself: where another has as many, it is killed there.
    found.retain(|(name, count)| !others.iter().any(|((_, other), most)| other == name && most >= count));
    found
}

#[test]
fn a_run_killed_at_any_call_that_changes_a_file_goes_on_to_the_same_bits() {
    if !can_trace() {
        return skipped("kills", "strace is not there, or may not trace");
    }
    let scratch = scratch();
    let traced = scratch.path("traced");
    let log = scratch.path("log").display().to_string();
    let output = strace(&scratch, &traced, &["-q"], &["-e", &format!("trace={CALLS}"), "-o", &log]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(difference(&traced, whole()), None);
    let calls = calls(&fs::read_to_string(&log).expect("a log"), &traced);
    let kinds: std::collections::BTreeSet<&str> = calls.iter().map(|(name, _)| name.as_str()).collect();
    assert!(calls.len() > 100 && kinds.len() >= 6, "{} calls: {kinds:?}", calls.len());

    // All, or the first and the last ones and some between.
    let share = if super::all() { 1 } else { calls.len() / 16 };
    let chosen: Vec<_> =
        calls.iter().enumerate().filter(|(i, _)| i % share == 0 || *i + 4 >= calls.len()).map(|(_, call)| call).collect();
    let mut killed = 0;
    for (name, count) in &chosen {
        let out = scratch.path("out");
        let inject = format!("inject={name}:signal=KILL:when={count}");
        let output = strace(&scratch, &out, &["-q"], &["-e", &format!("trace={name}"), "-e", &inject, "-o", "/dev/null"]);
        killed += usize::from(output.status.signal() == Some(9) || output.status.code() == Some(137));
        let output = scratch.run(&out, &["-q", "--resume"]);
        assert_eq!(output.status.code(), Some(0), "killed at {name} {count}: {}", stderr(&output));
        assert_eq!(difference(&out, whole()), None, "killed at {name} {count}");
        fs::remove_dir_all(&out).expect("removed");
    }
    println!("{killed} kills at {} calls of {}, of {kinds:?}; all went on to the same bits", chosen.len(), calls.len());
    // A checkpoint after every step: the same calls in every run, however fast the machine is.
    assert_eq!(killed, chosen.len(), "a call did not come");
}

/// The longer path of the extension.
const LONGER: [&str; 3] = ["-q", "--set", "path=[{indentation=0.01},{shear=0.002},{shear=0.0005}]"];

#[test]
fn an_extension_killed_at_any_call_that_changes_a_file_loses_nothing() {
    if !can_trace() {
        return skipped("kills of extensions", "strace is not there, or may not trace");
    }
    let scratch = scratch();
    let expected = scratch.path("expected");
    assert_eq!(scratch.run(&expected, &LONGER).status.code(), Some(0));
    let begun = |out: &Path| {
        for (name, bytes) in files(whole()) {
            let path = out.join(name);
            fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
            fs::write(path, bytes).expect("a copy");
        }
    };
    let extending = [&LONGER[..], &["--extend"]].concat();
    let (traced, log) = (scratch.path("traced"), scratch.path("log").display().to_string());
    begun(&traced);
    let output = strace(&scratch, &traced, &extending, &["-e", &format!("trace={CALLS}"), "-o", &log]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(difference(&traced, &expected), None);
    let calls = calls(&fs::read_to_string(&log).expect("a log"), &traced);
    // The first ones are those that could lose the run that is done.
    let share = if super::all() { 1 } else { calls.len() / 8 };
    let chosen: Vec<_> = calls
        .iter()
        .enumerate()
        .filter(|(i, _)| *i < 20 || i % share == 0 || *i + 4 >= calls.len())
        .map(|(_, call)| call)
        .collect();
    let (mut killed, mut kept) = (0, 0);
    for (name, count) in &chosen {
        let out = scratch.path("out");
        begun(&out);
        let inject = format!("inject={name}:signal=KILL:when={count}");
        let output = strace(&scratch, &out, &extending, &["-e", &format!("trace={name}"), "-e", &inject, "-o", "/dev/null"]);
        killed += usize::from(output.status.signal() == Some(9) || output.status.code() == Some(137));
        // The run that is done is still that, or the extension goes on.
        let output = scratch.run(&out, &["-q", "--resume"]);
        if output.status.code() == Some(0) {
            assert!(
                read_history(&out.join("history.csv")).expect("a history")
                    == read_history(&whole().join("history.csv")).expect("one")
            );
            kept += 1;
            let output = scratch.run(&out, &extending);
            assert_eq!(output.status.code(), Some(0), "killed at {name} {count}: {}", stderr(&output));
        } else {
            let output = scratch.run(&out, &[&LONGER[..], &["--resume"]].concat());
            assert_eq!(output.status.code(), Some(0), "killed at {name} {count}: {}", stderr(&output));
        }
        assert_eq!(difference(&out, &expected), None, "killed at {name} {count}");
        fs::remove_dir_all(&out).expect("removed");
    }
    println!("{killed} kills at {} calls of {}; {kept} left the run as it was", chosen.len(), calls.len());
    assert!(killed == chosen.len() && kept > 0 && kept < killed, "{killed} kills, {kept} kept");
}

/// Many kills of one and the same run, wherever it stands; what comes to its end in between is
/// compared, removed, and begun anew.
#[test]
fn a_run_that_is_killed_again_and_again_comes_to_its_end() {
    let scratch = scratch();
    let out = scratch.path("out");
    let many = if super::all() { 200 } else { 12 };
    let ends_alike = |kills: usize| {
        let output = scratch.run(&out, &["-q", "--resume"]);
        assert_eq!(output.status.code(), Some(0), "after {kills} kills: {}", stderr(&output));
        assert_eq!(difference(&out, whole()), None, "after {kills} kills");
    };
    // Over the whole of a run, early and late, however fast this machine is just now.
    let begun = Instant::now();
    assert_eq!(scratch.run(scratch.path("alone"), &["-q"]).status.code(), Some(0));
    let moment = begun.elapsed() / 16;
    let (mut kills, mut starts, mut ends) = (0, 0, 0);
    while kills < many {
        let mut child = program().args(scratch.args(&out, &["-q", "--resume"])).spawn().expect("the program runs");
        std::thread::sleep(moment * (starts % 17) as u32);
        kills += usize::from(child.try_wait().expect("its state").is_none());
        starts += 1;
        let _ = child.kill();
        child.wait().expect("it ends");
        if out.join("summary.json").exists() {
            ends_alike(kills);
            ends += 1;
            fs::remove_dir_all(&out).expect("removed");
        }
        assert!(starts < 20 * many, "{kills} kills of {starts} starts");
    }
    ends_alike(kills);
    println!("{kills} kills of {starts} starts; {} runs came to their end, all with the same bits", ends + 1);
}
