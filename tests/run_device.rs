//! `asperity run` with and without a device: what it names, what it says, and how it ends.

mod device;

use asperity::internals::compute::gpu::Precision;
use asperity::internals::compute::lost::LOSE_VARIABLE;
use asperity::output::DeviceTraffic;
use asperity::output::{OutputDirectory, RunStatus, StepRecord, Summary, read_history};
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

const CASE: &str = r#"
[sphere]
radius = 1.0
[material]
youngs_modulus = 200e3
poissons_ratio = 0.3
[material.hardening]
law = "power"
yield_stress = 400.0
coefficient = 600.0
exponent = 0.4
[contact]
friction = 0.3
[mesh]
elements_per_contact_radius = 4
[solver]
press_steps = 5
[output]
fields = "none"
plots = false
[[path]]
indentation = 0.01
"#;

fn run(dir: &Path, options: &[&str], environment: &[(&str, &str)]) -> Output {
    run_case(dir, CASE, options, environment)
}

fn run_case(dir: &Path, case: &str, options: &[&str], environment: &[(&str, &str)]) -> Output {
    fs::write(dir.join("case.toml"), case).unwrap();
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("asperity"));
    command.arg("run").arg(dir.join("case.toml")).arg("--out").arg(dir.join("out")).arg("--force").args(options);
    command
        .env_remove("ASPERITY_ADAPTER")
        .env_remove("ASPERITY_DEVICE")
        .env_remove("ASPERITY_GPU_MEMORY")
        .env_remove(LOSE_VARIABLE)
        .envs(environment.iter().copied());
    command.output().unwrap()
}

fn done(dir: &Path, options: &[&str], environment: &[(&str, &str)]) -> (Summary, String) {
    let output = run(dir, options, environment);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{options:?}: {said}");
    let summary = Summary::read(&OutputDirectory::existing(dir.join("out")).summary()).unwrap();
    assert_eq!(summary.status, RunStatus::Done);
    (summary, said)
}

#[test]
fn a_device_is_named_with_its_precision_and_gives_the_same_force() {
    let Some(context) = device::device("run_device", Precision::F64) else { return };
    let dir = tempfile::tempdir().unwrap();
    let (cpu, _) = done(dir.path(), &["--device", "cpu"], &[]);
    assert!(cpu.device.starts_with("CPU") && cpu.precision == "f64" && cpu.device_traffic.is_none());
    // Solved tightly it is the same force; at the default tolerance Newton may end at another
    // iterate.
    let tight = |device: &str| done(dir.path(), &["--device", device, "--set", "solver.tolerance=1e-8"], &[]).0.f_n0.unwrap();
    let ratio = tight("gpu") / tight("cpu");
    assert!((ratio - 1.0).abs() < 1e-7, "{ratio}");
    for precision in ["f64", "mixed", "f32"] {
        let options = ["--device", "gpu", "--precision", precision, "--set", "output.fields=segments"];
        let (gpu, _) = done(dir.path(), &options, &[]);
        assert!(gpu.device.contains(&context.adapter().name) && gpu.precision == "f64", "{gpu:?}");
        assert_eq!(gpu.confirming_iterations.is_some(), precision != "f64");
        // Nothing is said but that f32 means mixed.
        assert!(gpu.messages.iter().all(|message| message.contains("f32 means mixed")), "{:?}", gpu.messages);
        assert_eq!(gpu.messages.len(), usize::from(precision == "f32"));
        let ratio = gpu.f_n0.unwrap() / cpu.f_n0.unwrap();
        assert!((ratio - 1.0).abs() < 1e-5, "{precision}: {ratio}");
        // A row for each point of the whole contact, of which a half is meshed.
        let table = std::fs::read_dir(dir.path().join("out/contact")).unwrap().next().unwrap().unwrap().path();
        let points = std::fs::read_to_string(table).unwrap().lines().count() as u64;
        match precision {
            "f64" => check_traffic(&gpu, points),
            _ => check_traffic_of_steps(&gpu),
        }
    }
}

/// Where steps are made in f32, vectors come down and states go up once a step: displacement, force
/// and a mark a node; states committed and started from a point, and two displacements a node.
fn check_traffic_of_steps(summary: &Summary) {
    let DeviceTraffic { steps, .. } = summary.device_traffic.expect("the device's account");
    let (iterations, accepted) = (summary.newton_iterations as u64, summary.steps as u64);
    assert!(steps.waits <= 2 * iterations + 4 * accepted, "{steps:?}");
    let (nodes, points) = (summary.unknowns as u64 / 2, 8 * summary.elements as u64);
    assert!(steps.bytes_down <= 512 * steps.waits + 4 * 7 * nodes * accepted, "{steps:?}");
    assert!(steps.bytes_up <= 512 * steps.submissions + 4 * (22 * points + 10 * nodes) * accepted, "{steps:?}");
}

/// In double precision Newton's iterates stay on the device: an iteration is a submission and a
/// wait, one more for every step length that does not do, and so are a step's beginning and its
/// end. `points` is how many contact points there are.
fn check_traffic(summary: &Summary, points: u64) {
    let DeviceTraffic { total, steps } = summary.device_traffic.expect("the device's account");
    let (iterations, accepted) = (summary.newton_iterations as u64, summary.steps as u64);
    assert!(steps.dispatches >= 7 * iterations && steps.submissions >= steps.waits, "{steps:?}");
    assert!(steps.waits <= 2 * iterations + 3 * accepted && steps.submissions <= steps.waits + 3 * accepted, "{steps:?}");
    assert!(steps.bytes_up <= 512 * steps.submissions, "{steps:?}");
    assert!(steps.bytes_down <= 256 * steps.waits + (64 * points + 1024) * accepted, "{steps:?}");
    // The geometry goes up once.
    let beside = total - steps;
    assert!(beside.bytes_up >= 24 * 8 * 8 * summary.elements as u64 && beside.waits < steps.waits, "{total:?}");
}

#[test]
fn a_device_that_is_too_small_is_told_of_and_replaced() {
    let Some(context) = device::device("run_device", Precision::F64) else { return };
    let dir = tempfile::tempdir().unwrap();
    let small = [("ASPERITY_ADAPTER", context.adapter().name.as_str()), ("ASPERITY_GPU_MEMORY", "1")];
    let (summary, said) = done(dir.path(), &[], &small);
    assert!(summary.device.starts_with("CPU"), "{}", summary.device);
    assert_eq!(summary.messages.len(), 1, "{:?}", summary.messages);
    for text in [&summary.messages[0], &said] {
        assert!(text.contains("the GPU could not be used") && text.contains("the CPU was taken instead"), "{text}");
    }
    let output = run(dir.path(), &["--device", "gpu"], &small);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("error: --device gpu: ") && said.contains("ASPERITY_GPU_MEMORY"), "{said}");
}

#[test]
#[cfg(target_os = "linux")]
fn without_a_driver_auto_is_the_cpu_and_gpu_ends_with_2() {
    let nothing = [("VK_DRIVER_FILES", "/dev/null"), ("VK_ICD_FILENAMES", "/dev/null")];
    let dir = tempfile::tempdir().unwrap();
    let (summary, _) = done(dir.path(), &[], &nothing);
    assert!(summary.device.starts_with("CPU") && summary.messages.is_empty(), "{summary:?}");
    let dir = tempfile::tempdir().unwrap();
    let output = run(dir.path(), &["--device", "gpu"], &nothing);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.starts_with("error: --device gpu: no GPU found") && said.lines().count() == 1, "{said}");
    assert!(!dir.path().join("out").exists());
}

/// `ASPERITY_DEVICE` stands for an option that is not given.
#[test]
#[cfg(target_os = "linux")]
fn the_variable_names_the_device_where_no_option_does() {
    let gpu = [("VK_DRIVER_FILES", "/dev/null"), ("VK_ICD_FILENAMES", "/dev/null"), ("ASPERITY_DEVICE", "gpu")];
    let dir = tempfile::tempdir().unwrap();
    let output = run(dir.path(), &[], &gpu);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.starts_with("error: ASPERITY_DEVICE=gpu: no GPU found") && said.lines().count() == 1, "{said}");
    for device in ["cpu", "auto"] {
        let (summary, _) = done(dir.path(), &["--device", device], &gpu);
        assert!(summary.device.starts_with("CPU") && summary.messages.is_empty(), "{device}: {summary:?}");
    }
    for wrong in ["", "GPU", "cuda"] {
        let output = run(dir.path(), &["--device", "cpu"], &[("ASPERITY_DEVICE", wrong)]);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{said}");
        let expected = format!("error: ASPERITY_DEVICE={wrong}: is no device. Allowed: auto, cpu, gpu");
        assert!(said.starts_with(&expected) && said.lines().count() == 1, "{said}");
    }
}

#[test]
fn the_variable_takes_a_device_and_the_cpu() {
    let Some(context) = device::device("the_variable_takes_a_device_and_the_cpu", Precision::F64) else { return };
    let dir = tempfile::tempdir().unwrap();
    let (gpu, _) = done(dir.path(), &[], &[("ASPERITY_DEVICE", "gpu")]);
    assert!(gpu.device.contains(&context.adapter().name), "{}", gpu.device);
    let named = [("ASPERITY_DEVICE", "cpu"), ("ASPERITY_ADAPTER", context.adapter().name.as_str())];
    let (cpu, _) = done(dir.path(), &[], &named);
    assert!(cpu.device.starts_with("CPU"), "{}", cpu.device);
}

/// A driver whose library is not there is another thing than none.
#[test]
#[cfg(target_os = "linux")]
fn a_broken_driver_is_told_of_as_such() {
    let dir = tempfile::tempdir().unwrap();
    let manifest = dir.path().join("broken_icd.json");
    let text = r#"{"file_format_version": "1.0.0", "ICD": {"library_path": "/nowhere/libbroken.so", "api_version": "1.3.0"}}"#;
    fs::write(&manifest, text).unwrap();
    let manifest = manifest.to_str().unwrap();
    let broken = [("VK_DRIVER_FILES", manifest), ("VK_ICD_FILENAMES", manifest)];
    let output = run(dir.path(), &["--device", "gpu"], &broken);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{said}");
    let expected = "error: --device gpu: no GPU can be used: Vulkan's drivers are installed (broken_icd.json) and none of them";
    assert!(said.contains(expected), "{said}");
    let (summary, _) = done(dir.path(), &[], &broken);
    assert!(summary.device.starts_with("CPU"), "{}", summary.device);
    let devices = Command::new(assert_cmd::cargo::cargo_bin!("asperity")).arg("devices").envs(broken).output().unwrap();
    let text = String::from_utf8_lossy(&devices.stdout).into_owned();
    assert!(text.contains("a Vulkan driver is installed (broken_icd.json), and it opens no device"), "{text}");
}

/// Press and shear on a device that is lost after the sixth step; `ASPERITY_TEST_LOSE_DEVICE_AFTER`
/// is the hook for it.
const LOST_AFTER: usize = 6;
const SHEAR: [&str; 4] = ["--set", "solver.shear_steps=4", "--set", "solver.error_estimate=false"];

fn with_shear(dir: &Path, options: &[&str], environment: &[(&str, &str)]) -> (Output, Vec<StepRecord>, Summary) {
    let output = run_case(dir, &format!("{CASE}[[path]]\nshear = 0.002\n"), &[options, &SHEAR].concat(), environment);
    let said = String::from_utf8_lossy(&output.stderr);
    let out = OutputDirectory::existing(dir.join("out"));
    let history = read_history(&out.history()).unwrap_or_else(|error| panic!("{error}: {said}"));
    (output, history, Summary::read(&out.summary()).unwrap())
}

/// With a tolerance at which it does not matter which iterate was the first to be good enough: the
/// CPU's tangents are rounded otherwise than a device's.
fn tightly<'a>(options: &[&'a str]) -> Vec<&'a str> {
    options.iter().copied().chain(["--set", "solver.tolerance=1e-8"]).collect()
}

fn columns(r: &StepRecord) -> [f64; 11] {
    let energies = [r.work_external, r.energy_elastic, r.work_plastic, r.work_friction];
    let [external, elastic, plastic, friction] = energies;
    [r.h, r.delta_t, r.f_n, r.f_t, r.a, r.stick_radius, r.a_gap, external, elastic, plastic, friction]
}

/// The largest difference of any column over the largest number in it.
fn gap(ours: &[StepRecord], reference: &[StepRecord]) -> f64 {
    assert_eq!(ours.len(), reference.len(), "another number of steps");
    let of_column = |c: usize| {
        let scale = reference.iter().fold(f64::MIN_POSITIVE, |m, r| m.max(columns(r)[c].abs()));
        ours.iter().zip(reference).fold(0.0f64, |m, (a, b)| m.max((columns(a)[c] - columns(b)[c]).abs())) / scale
    };
    (0..11).map(of_column).fold(0.0, f64::max)
}

#[test]
#[cfg_attr(not(debug_assertions), ignore = "only builds with debug assertions lose a device on demand")]
fn a_device_lost_on_the_way_costs_no_step() {
    let Some(context) = device::device("a_device_lost_on_the_way_costs_no_step", Precision::F64) else { return };
    let adapter = context.adapter().name.as_str();
    let dir = tempfile::tempdir().unwrap();
    let (output, reference, _) = with_shear(dir.path(), &tightly(&["--device", "cpu"]), &[]);
    assert_eq!(output.status.code(), Some(0));
    assert!(reference.len() > LOST_AFTER + 2, "{} steps: the device should be lost in the middle", reference.len());

    for precision in ["auto", "mixed"] {
        loses_its_device(adapter, precision, &reference);
    }
}

fn loses_its_device(adapter: &str, precision: &str, reference: &[StepRecord]) {
    let after = LOST_AFTER.to_string();
    let dir = tempfile::tempdir().unwrap();
    let environment = [("ASPERITY_ADAPTER", adapter), (LOSE_VARIABLE, &after)];
    let options = ["--device", "auto", "--precision", precision];
    let (output, history, summary) = with_shear(dir.path(), &tightly(&options), &environment);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{said}");
    assert_eq!(summary.status, RunStatus::Done);
    assert!(history.iter().enumerate().all(|(i, row)| row.step == i + 1), "a step is missing");
    assert!(gap(&history, reference) < 1e-7, "{precision}: {:e}", gap(&history, reference));
    // told once, on stderr and in the summary
    let told = format!("{adapter} (");
    let [message] = &summary.messages[..] else { panic!("{:?}", summary.messages) };
    for text in [message, &said] {
        let expected = format!("failed after {LOST_AFTER} accepted steps");
        assert!(text.contains(&expected) && text.contains("no accepted step was lost") && text.contains(&told), "{text}");
    }
    assert_eq!(said.matches("no accepted step was lost").count(), 1, "{said}");
    assert!(summary.device.starts_with("CPU") && summary.device.contains("failed"), "{}", summary.device);
    assert_eq!(summary.precision, "f64");
}

/// The cases of a study, each with its history and summary.
fn study_of_eight(dir: &Path, device: &str, environment: &[(&str, &str)]) -> Vec<(Vec<StepRecord>, Summary)> {
    let base = format!("{CASE}[[path]]\nshear = 0.002\n")
        .replace("[[", "[[base.")
        .replace("\n[", "\n[base.")
        .replace("[base.[base.", "[[base.");
    let solver = "[base.solver]\nshear_steps = 4\nerror_estimate = false\ntolerance = 1e-8\n";
    let text = format!(
        "{}\n[grid]\n\"contact.friction\" = [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7]\n",
        base.replace("[base.solver]\n", solver)
    );
    fs::write(dir.join("study.toml"), text).unwrap();
    let out = dir.join(device);
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("asperity"));
    command.arg("study").arg(dir.join("study.toml")).arg("--out").arg(&out).args(["--device", device]);
    command.env_remove("ASPERITY_ADAPTER").env_remove(LOSE_VARIABLE).envs(environment.iter().copied());
    let output = command.output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let mut directories: Vec<_> = fs::read_dir(out.join("cases")).unwrap().map(|entry| entry.unwrap().path()).collect();
    directories.sort();
    let read = |path: &std::path::PathBuf| {
        let case = OutputDirectory::existing(path.clone());
        (read_history(&case.history()).unwrap(), Summary::read(&case.summary()).unwrap())
    };
    directories.iter().map(read).collect()
}

/// Cases that share a device that is lost in the middle, in two halves, go on from their last
/// copies: rows that were written are not written again, and none is missing.
#[test]
#[cfg_attr(not(debug_assertions), ignore = "only builds with debug assertions lose a device on demand")]
fn a_batch_that_loses_its_device_has_every_row_once() {
    let Some(context) = device::device("a_batch_that_loses_its_device_has_every_row_once", Precision::F64) else { return };
    let dir = tempfile::tempdir().unwrap();
    let reference = study_of_eight(dir.path(), "cpu", &[]);
    let environment = [("ASPERITY_ADAPTER", context.adapter().name.as_str()), (LOSE_VARIABLE, "12")];
    let cases = study_of_eight(dir.path(), "auto", &environment);
    assert_eq!((cases.len(), reference.len()), (8, 8));
    let mut lost = 0;
    for ((history, summary), (theirs, _)) in cases.iter().zip(&reference) {
        assert_eq!(summary.status, RunStatus::Done);
        assert!(history.iter().enumerate().all(|(i, row)| row.step == i + 1), "a step is missing or doubled");
        assert!(gap(history, theirs) < 1e-7, "{:e}", gap(history, theirs));
        lost += summary.messages.iter().filter(|message| message.contains("no accepted step was lost")).count();
    }
    assert!(lost > 4, "only one half has lost the device: {lost}");
}

#[test]
#[cfg_attr(not(debug_assertions), ignore = "only builds with debug assertions lose a device on demand")]
fn a_device_asked_for_and_lost_ends_the_run_with_one_message() {
    let name = "a_device_asked_for_and_lost_ends_the_run_with_one_message";
    let Some(context) = device::device(name, Precision::F64) else { return };
    let after = LOST_AFTER.to_string();
    let environment = [("ASPERITY_ADAPTER", context.adapter().name.as_str()), (LOSE_VARIABLE, &after)];
    let dir = tempfile::tempdir().unwrap();
    let (output, history, summary) = with_shear(dir.path(), &tightly(&["--device", "gpu", "--quiet"]), &environment);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(3), "{said}");
    // the driver of the tests may speak as well
    let errors: Vec<&str> = said.lines().filter(|line| line.contains("error") || line.contains("device")).collect();
    let [error] = &errors[..] else { panic!("{said}") };
    for part in [
        &format!("broke off after {LOST_AFTER} steps"),
        "device failed: it was lost",
        "--device cpu",
        "What was computed until then is kept",
    ] {
        assert!(error.starts_with("error: ") && error.contains(part), "{part}: {error}");
    }
    assert_eq!(history.len(), LOST_AFTER);
    assert_eq!(summary.status, RunStatus::Interrupted);
    assert!(summary.messages.len() == 1 && summary.messages[0].contains("device failed"), "{:?}", summary.messages);

    let dir = tempfile::tempdir().unwrap();
    let (_, reference, _) = with_shear(dir.path(), &tightly(&["--device", "cpu"]), &[]);
    assert!(gap(&history, &reference[..LOST_AFTER]) < 1e-7);
}
