//! A batch on a device, in f64 or held to it, against the CPU: nine cases of every hardening law,
//! friction and path have the same history, step by step.

mod device;
#[path = "common/histories.rs"]
mod histories;

use std::path::Path;
use std::process::Command;

use asperity::internals::compute::gpu::Precision;
use asperity::output::{OutputDirectory, RunStatus, StepRecord, Summary, read_history};
use histories::difference;

const STUDY: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/studies/parity.toml");

/// Devices with their precision.
const CPU: (&str, &str) = ("cpu", "auto");
const GPU: (&str, &str) = ("gpu", "auto");
const MIXED: (&str, &str) = ("gpu", "mixed");

/// The case whose vectors stay on the host, by its number from 0, and what is told of it.
const TURNED: usize = 8;
const STAYS: &str = "note: the sphere leaves the x axis or turns, so the vectors of Newton's method stay on the host";

/// What is told of a case is what is expected, and it has a device's account.
fn assert_told(number: usize, summary: &Summary) {
    let told: &[&str] = if number == TURNED { &[STAYS] } else { &[] };
    assert!(summary.messages == told && summary.device_traffic.is_some(), "{:?}", summary.messages);
}

/// The histories and summaries of the study's cases.
fn cases(dir: &Path, tolerance: f64, device: (&str, &str)) -> Vec<(Vec<StepRecord>, Summary)> {
    cases_of(dir, &std::fs::read_to_string(STUDY).unwrap(), tolerance, device)
}

fn cases_of(dir: &Path, text: &str, tolerance: f64, (device, precision): (&str, &str)) -> Vec<(Vec<StepRecord>, Summary)> {
    let with_tolerance = text.replace("[base.solver]", &format!("[base.solver]\ntolerance = {tolerance}"));
    assert!(with_tolerance != text);
    let (file, out) = (dir.join("study.toml"), dir.join(format!("{device}-{precision}-{tolerance}")));
    std::fs::write(&file, with_tolerance).unwrap();
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("asperity"));
    command.arg("study").arg(&file).arg("--out").arg(&out);
    let output = command.args(["--device", device, "--precision", precision, "-q"]).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let mut directories: Vec<_> = std::fs::read_dir(out.join("cases")).unwrap().map(|entry| entry.unwrap().path()).collect();
    directories.sort();
    assert_eq!(directories.len(), 9);
    let read = |path: &std::path::PathBuf| {
        let case = OutputDirectory::existing(path.clone());
        (read_history(&path.join("history.csv")).unwrap(), Summary::read(&case.summary()).unwrap())
    };
    directories.iter().map(read).collect()
}

/// Solved tightly, what is left is not which iterate was the first to be good enough.
#[test]
fn a_batch_has_the_cpus_histories() {
    let Some(_) = device::device("a_batch_has_the_cpus_histories", Precision::F64) else { return };
    let dir = tempfile::tempdir().unwrap();
    let (cpu, gpu) = (cases(dir.path(), 1e-8, CPU), cases(dir.path(), 1e-8, GPU));
    for (number, ((theirs, _), (ours, summary))) in cpu.iter().zip(&gpu).enumerate() {
        let difference = difference(ours, theirs);
        eprintln!("case {}: {difference:.1e}", number + 1);
        assert_eq!((summary.status, summary.linear_fallbacks), (RunStatus::Done, 0));
        assert_told(number, summary);
        assert!(difference <= 3e-7, "case {}: {difference}", number + 1);
    }
    assert!(gpu.iter().any(|(_, summary)| summary.cutbacks > 0), "no step was bisected");
}

/// At the default tolerance the device needs as many iterations.
#[test]
fn a_batch_takes_the_cpus_iterations() {
    let Some(_) = device::device("a_batch_takes_the_cpus_iterations", Precision::F64) else { return };
    let dir = tempfile::tempdir().unwrap();
    let [cpu, gpu] = [CPU, GPU].map(|device| {
        let cases = cases(dir.path(), 1e-3, device);
        cases.iter().map(|(_, summary)| summary.newton_iterations).sum::<usize>() as f64
    });
    eprintln!("{gpu} iterations, {cpu} on the CPU");
    assert!((gpu / cpu - 1.0).abs() <= 0.05, "{gpu} and {cpu}");
}

/// Steps that the device makes in f32 are found good by the residual in f64 at the default
/// tolerance, all but a few; a tolerance that f32 cannot reach is reached in f64.
#[test]
fn a_batch_in_f32_is_held_to_f64() {
    let Some(_) = device::device("a_batch_in_f32_is_held_to_f64", Precision::F64) else { return };
    let dir = tempfile::tempdir().unwrap();
    // Iterations in f32 and those that confirm them count apart: where few are allowed, other steps
    // are bisected.
    let text = std::fs::read_to_string(STUDY).unwrap();
    let study = text.replace("\"solver.max_iterations\" = 6\n", "");
    assert!(study != text);
    // At 1e-3 a linear solve that takes one Krylov iteration more or less ends Newton elsewhere:
    // the CPU's own two linear solvers, multigrid and direct, are up to 4.2e-4 apart here.
    for (tolerance, most) in [(1e-3, 5e-4), (1e-8, 1e-7)] {
        let [cpu, gpu] = [CPU, MIXED].map(|device| cases_of(dir.path(), &study, tolerance, device));
        for (number, ((theirs, _), (ours, summary))) in cpu.iter().zip(&gpu).enumerate() {
            let difference = difference(ours, theirs);
            eprintln!("case {}: {difference:.1e}", number + 1);
            assert_eq!((summary.status, summary.precision.as_str()), (RunStatus::Done, "f64"));
            assert_told(number, summary);
            // Of the other cases the device makes steps in f32.
            assert_eq!(summary.confirming_iterations.is_none(), number == TURNED);
            assert!(difference <= most, "case {} at {tolerance}: {difference}", number + 1);
        }
        let sum = |of: fn(&Summary) -> usize, cases: &[(_, Summary)]| {
            cases[..TURNED].iter().map(|(_, summary)| of(summary)).sum::<usize>()
        };
        let of_all = |summary: &Summary| summary.newton_iterations;
        let confirming = sum(|summary| summary.confirming_iterations.unwrap(), &gpu);
        let (theirs, ours) = (sum(of_all, &cpu) as f64, sum(of_all, &gpu) as f64);
        eprintln!("at {tolerance}: {ours} iterations, {confirming} of them in f64; {theirs} on the CPU");
        if tolerance == 1e-3 {
            assert!((ours / theirs - 1.0).abs() <= 0.05 && confirming as f64 <= 0.05 * ours);
        } else {
            assert!((0.1..0.6).contains(&(confirming as f64 / ours)) && ours <= 1.3 * theirs);
        }
    }
}

/// Five cases of other yield stresses, meshes and tables, for a device that has room for some at a
/// time.
const FIVE: &str = r#"
[base.sphere]
radius = 2.0
[base.material]
youngs_modulus = 200e3
poissons_ratio = 0.3
[base.contact]
friction = 0.3
[base.mesh]
elements_per_contact_radius = 4
fine_zone = 1.6
[base.solver]
press_steps = 2
shear_steps = 1
error_estimate = false
[base.output]
fields = "none"
plots = false
[[base.path]]
indentation = 0.004
[[base.path]]
shear = 0.0002
[grid]
"material.hardening" = [
    { law = "ideal", yield_stress = 400.0 },
    { law = "table", points = [[0.0, 400.0], [0.01, 500.0], [0.1, 600.0]] },
    { law = "elastic" },
    { law = "voce", yield_stress = 400.0, saturation_stress = 800.0, rate = 10.0 },
    { law = "table", points = [[0.0, 800.0], [0.1, 900.0]] },
]
"#;

/// Where a case ends the next one takes its place, and has the bits that it has with all in one
/// batch.
#[test]
fn a_case_in_the_place_of_another_has_the_same_bits() {
    let Some(_) = device::device("a_case_in_the_place_of_another_has_the_same_bits", Precision::F64) else { return };
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("study.toml");
    std::fs::write(&file, FIVE).unwrap();
    for precision in ["auto", "mixed"] {
        let histories = |memory: &str| {
            let out = dir.path().join(format!("{precision}-{memory}"));
            let mut command = Command::new(assert_cmd::cargo::cargo_bin!("asperity"));
            command.arg("study").arg(&file).arg("--out").arg(&out).env("ASPERITY_GPU_MEMORY", memory);
            let output = command.args(["--device", "gpu", "--precision", precision, "-v"]).output().unwrap();
            let text = String::from_utf8_lossy(&output.stderr).into_owned();
            assert_eq!(output.status.code(), Some(0), "{text}");
            let history = |case: usize| {
                let path = out.join(format!("cases/c{case:04}"));
                let summary = Summary::read(&OutputDirectory::existing(path.clone()).summary()).unwrap();
                assert!(summary.messages.is_empty() && summary.device_traffic.is_some(), "{:?}", summary.messages);
                std::fs::read(path.join("history.csv")).unwrap()
            };
            let histories: Vec<Vec<u8>> = (1..=5).map(history).collect();
            (histories, text.matches("at a time are too many").count())
        };
        let (all, never) = histories("1000");
        let (some, once) = histories(if precision == "auto" { "10" } else { "8" });
        assert!(all == some, "{precision}");
        assert!(never == 0 && once >= 1, "{precision}: {never}, {once}");
    }
}
