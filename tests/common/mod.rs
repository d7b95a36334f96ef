//! What tests of the program share: a case in a scratch directory, what a run printed, and what two
//! runs left.
// Every test target compiles this file and uses a part of it.
#![allow(dead_code)]

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use asperity::output::{Checkpoint, Summary, TimeByPhase};
use asperity::output::{DeviceTraffic, Traffic};
use tempfile::TempDir;

/// SIGINT, unless these tests were started in the background, where runs are to ignore it.
pub fn interruption() -> rustix::process::Signal {
    let ignored = asperity::internals::cli::signals::is_ignored(rustix::process::Signal::INT.as_raw());
    if ignored { rustix::process::Signal::TERM } else { rustix::process::Signal::INT }
}

/// The program.
pub fn program() -> Command {
    Command::new(assert_cmd::cargo::cargo_bin!("asperity"))
}

/// Runs the program with these arguments.
pub fn asperity(arguments: &[&str]) -> Output {
    program().args(arguments).output().expect("the program runs")
}

/// What it wrote to stderr.
pub fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).expect("messages are UTF-8")
}

/// What it wrote to stdout.
pub fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).expect("text is UTF-8")
}

/// A directory that holds `case.toml`, with options that every run of it gets.
pub struct Scratch {
    pub dir: TempDir,
    options: &'static [&'static str],
}

impl Scratch {
    pub fn new(case: &str, options: &'static [&'static str]) -> Self {
        let dir = tempfile::tempdir().expect("a scratch directory");
        fs::write(dir.path().join("case.toml"), case).expect("the case");
        Self { dir, options }
    }

    pub fn path(&self, name: impl AsRef<Path>) -> PathBuf {
        self.dir.path().join(name)
    }

    /// The arguments that run the case into `out`, a name in the directory or a path elsewhere.
    pub fn args(&self, out: impl AsRef<Path>, options: &[&str]) -> Vec<OsString> {
        let mut args = vec!["run".into(), self.path("case.toml").into(), "--out".into(), self.path(out).into()];
        args.extend(self.options.iter().chain(options).map(OsString::from));
        args
    }

    pub fn run(&self, out: impl AsRef<Path>, options: &[&str]) -> Output {
        program().args(self.args(out, options)).output().expect("the program runs")
    }
}

/// Every file below a directory.
pub fn files(dir: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut files = BTreeMap::new();
    for entry in fs::read_dir(dir).unwrap_or_else(|error| panic!("{}: {error}", dir.display())) {
        let path = entry.expect("an entry").path();
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        if path.is_dir() {
            files.extend(self::files(&path).into_iter().map(|(below, bytes)| (format!("{name}/{below}"), bytes)));
        } else {
            files.insert(name, fs::read(&path).expect("a file"));
        }
    }
    files
}

/// The summary of a run without what may differ between two runs of one case: times, the number of
/// threads, and what a run that goes on has to send to a device once more.
pub fn timeless(dir: &Path) -> Summary {
    let summary = Summary::read(&dir.join("summary.json")).expect("a summary");
    let device = summary.device.split(" (").next().unwrap_or_default().to_owned();
    let device_traffic = summary.device_traffic.map(|traffic| DeviceTraffic { total: Traffic::default(), ..traffic });
    Summary { wall_s: 0.0, cpu_s: None, time_by_phase: TimeByPhase::default(), device, device_traffic, ..summary }
}

/// In what two results differ, see [`timeless`]; `None` if they hold the same files with the same
/// bits. The log has times, and tells of resuming; of checkpoints, which have times too, the states
/// are compared.
pub fn difference(found: &Path, expected: &Path) -> Option<String> {
    let [ours, theirs] = [found, expected].map(|dir| {
        let mut files = files(dir);
        assert!(files.remove("run.log").is_some(), "{}: no log", dir.display());
        files
    });
    let names = |files: &BTreeMap<String, Vec<u8>>| files.keys().cloned().collect::<Vec<_>>();
    if names(&ours) != names(&theirs) {
        return Some(format!("{:?}, not {:?}", names(&ours), names(&theirs)));
    }
    let state = |dir: &Path| {
        let read = Checkpoint::read(&dir.join("checkpoint.bin")).unwrap_or_else(|error| panic!("{error}"));
        read.map(|checkpoint| checkpoint.snapshot())
    };
    if state(found) != state(expected) {
        return Some("the states of the checkpoints differ".to_owned());
    }
    let differs = |name: &&String| !["summary.json", "checkpoint.bin"].contains(&name.as_str()) && ours[*name] != theirs[*name];
    if let Some(name) = theirs.keys().find(differs) {
        return Some(format!("{name} differs"));
    }
    let (ours, theirs) = (timeless(found), timeless(expected));
    (ours != theirs).then(|| format!("the summaries differ: {ours:?}, not {theirs:?}"))
}
