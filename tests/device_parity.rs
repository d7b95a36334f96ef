//! A batch on a device in f64 against the CPU: eight cases of every hardening law, friction and
//! path have the same history, step by step.

mod device;

use std::path::Path;
use std::process::Command;

use asperity::internals::compute::gpu::Precision;
use asperity::output::{OutputDirectory, Status, StepRecord, Summary, read_history};

const STUDY: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/studies/parity.toml");

/// The histories and summaries of the study's cases.
fn cases(dir: &Path, tolerance: f64, device: &str) -> Vec<(Vec<StepRecord>, Summary)> {
    let text = std::fs::read_to_string(STUDY).unwrap();
    let with_tolerance = text.replace("[base.solver]", &format!("[base.solver]\ntolerance = {tolerance}"));
    assert!(with_tolerance != text);
    let (file, out) = (dir.join("study.toml"), dir.join(format!("{device}-{tolerance}")));
    std::fs::write(&file, with_tolerance).unwrap();
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("asperity"));
    let output = command.arg("study").arg(&file).arg("--out").arg(&out).args(["--device", device, "-q"]).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let mut directories: Vec<_> = std::fs::read_dir(out.join("cases")).unwrap().map(|entry| entry.unwrap().path()).collect();
    directories.sort();
    assert_eq!(directories.len(), 8);
    let read = |path: &std::path::PathBuf| {
        let case = OutputDirectory::existing(path.clone());
        (read_history(&path.join("history.csv")).unwrap(), Summary::read(&case.summary()).unwrap())
    };
    directories.iter().map(read).collect()
}

/// The largest difference of F_N, F_T and a over the steps of a case; forces by its largest F_N.
fn difference(ours: &[StepRecord], theirs: &[StepRecord]) -> f64 {
    assert_eq!(ours.len(), theirs.len(), "another number of steps");
    let largest = |of: fn(&StepRecord) -> f64| theirs.iter().fold(0.0_f64, |m, r| m.max(of(r).abs()));
    let columns: [Column; 3] = [(|r| r.f_n, largest(|r| r.f_n)), (|r| r.f_t, largest(|r| r.f_n)), (|r| r.a, largest(|r| r.a))];
    let gap = |(of, scale): Column| ours.iter().zip(theirs).fold(0.0_f64, |m, (a, b)| m.max((of(a) - of(b)).abs())) / scale;
    columns.into_iter().map(gap).fold(0.0, f64::max)
}

/// A column of the history, and what its differences are measured by.
type Column = (fn(&StepRecord) -> f64, f64);

/// Solved tightly, what is left is not which iterate was the first to be good enough.
#[test]
fn a_batch_has_the_cpus_histories() {
    let Some(_) = device::device("a_batch_has_the_cpus_histories", Precision::F64) else { return };
    let dir = tempfile::tempdir().unwrap();
    let (cpu, gpu) = (cases(dir.path(), 1e-8, "cpu"), cases(dir.path(), 1e-8, "gpu"));
    for (number, ((theirs, _), (ours, summary))) in cpu.iter().zip(&gpu).enumerate() {
        let difference = difference(ours, theirs);
        eprintln!("case {}: {difference:.1e}", number + 1);
        assert_eq!((summary.status, summary.linear_fallbacks), (Status::Done, 0));
        assert!(summary.messages.is_empty() && summary.device_traffic.is_some(), "{:?}", summary.messages);
        assert!(difference <= 3e-7, "case {}: {difference}", number + 1);
    }
    assert!(gpu.iter().any(|(_, summary)| summary.cutbacks > 0), "no step was bisected");
}

/// At the default tolerance the device needs as many iterations.
#[test]
fn a_batch_takes_the_cpus_iterations() {
    let Some(_) = device::device("a_batch_takes_the_cpus_iterations", Precision::F64) else { return };
    let dir = tempfile::tempdir().unwrap();
    let [cpu, gpu] = ["cpu", "gpu"].map(|device| {
        let cases = cases(dir.path(), 1e-3, device);
        cases.iter().map(|(_, summary)| summary.newton_iterations).sum::<usize>() as f64
    });
    assert!((gpu / cpu - 1.0).abs() <= 0.05, "{gpu} and {cpu}");
}
