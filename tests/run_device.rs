//! `asperity run` with and without a device: what it names, what it says, and how it ends.

mod device;

use asperity::compute::gpu::Precision;
use asperity::output::{OutputDirectory, Status, Summary};
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
    fs::write(dir.join("case.toml"), CASE).unwrap();
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("asperity"));
    command.arg("run").arg(dir.join("case.toml")).arg("--out").arg(dir.join("out")).args(options);
    command.env_remove("ASPERITY_ADAPTER").env_remove("ASPERITY_GPU_MEMORY").envs(environment.iter().copied());
    command.output().unwrap()
}

fn done(dir: &Path, options: &[&str], environment: &[(&str, &str)]) -> (Summary, String) {
    let output = run(dir, options, environment);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{options:?}: {said}");
    let summary = Summary::read(&OutputDirectory::existing(dir.join("out")).summary()).unwrap();
    assert_eq!(summary.status, Status::Done);
    (summary, said)
}

#[test]
fn a_device_is_named_with_its_precision_and_gives_the_same_force() {
    let Some(context) = device::device("run_device", Precision::F64) else { return };
    let dir = tempfile::tempdir().unwrap();
    let (cpu, _) = done(dir.path(), &["--device", "cpu"], &[]);
    assert!(cpu.device.starts_with("CPU") && cpu.precision == "f64");
    for (precision, most) in [("f64", 1e-7), ("f32", 5e-4)] {
        let (gpu, _) = done(dir.path(), &["--device", "gpu", "--precision", precision], &[]);
        assert!(gpu.device.contains(&context.adapter().name) && gpu.precision == precision, "{gpu:?}");
        assert!(gpu.messages.is_empty(), "{:?}", gpu.messages);
        let ratio = gpu.f_n0.unwrap() / cpu.f_n0.unwrap();
        assert!((ratio - 1.0).abs() < most, "{precision}: {ratio}");
    }
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
