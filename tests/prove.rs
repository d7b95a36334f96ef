//! `asperity prove`: complete and in agreement on a sound device, exit code 3 where a kernel is
//! faulty, 2 without a device.

mod device;

use asperity::internals::compute::gpu::Precision;
use asperity::internals::compute::gpu::context::FAULT_VARIABLE;
use asperity::internals::compute::gpu::kernels::KERNELS;
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

fn prove(dir: &Path, options: &[&str], environment: &[(&str, &str)]) -> Output {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("asperity"));
    command.args(["prove", "--quick", "--out"]).arg(dir.join("report.json")).args(options);
    command.env_remove("ASPERITY_ADAPTER").env_remove("ASPERITY_GPU_MEMORY").env_remove(FAULT_VARIABLE);
    command.envs(environment.iter().copied()).output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn report(dir: &Path) -> (Value, String) {
    let read = |name: &str| std::fs::read_to_string(dir.join(name)).unwrap();
    (serde_json::from_str(&read("report.json")).unwrap(), read("report.md"))
}

#[test]
fn a_sound_device_is_proved_in_two_files() {
    let Some(context) = device::device("a_sound_device_is_proved_in_two_files", Precision::F64) else { return };
    let dir = tempfile::tempdir().unwrap();
    let output = prove(dir.path(), &[], &[]);
    let (report, page) = report(dir.path());
    assert_eq!(output.status.code(), Some(0), "{}{page}", said(&output));
    assert_eq!(report["disagreements"], serde_json::json!([]));
    assert_eq!(report["adapter"]["name"], Value::from(context.adapter().name.clone()));
    assert!(report["adapter"]["unmet"].is_null() && report["needs"].as_array().unwrap().len() == 5);
    // Each kernel in each precision in which it is dispatched; one that is left out would disagree.
    let kernels = report["kernels"]["kernels"].as_array().unwrap();
    assert!(kernels.iter().all(|of| of["dispatches"].as_u64() > Some(0) && of["disagree"] == 0), "{kernels:?}");
    for precision in ["f64", "f32"] {
        assert!(kernels.iter().filter(|of| of["precision"] == precision).count() > 10, "{precision}");
    }
    let row = &report["parity"]["rows"][0];
    let cases = row["cases"].as_array().unwrap();
    assert_eq!(cases.len(), 9);
    assert!(cases.iter().all(|of| of["difference"].as_f64() < Some(5e-4) && of["repeated"] == true), "{cases:?}");
    assert_eq!(cases.iter().filter(|of| of["alone"] == true).count(), 1);
    let latency = &report["latency"];
    assert!(latency["dispatch_us"].as_f64() > Some(0.0) && latency["submission_us"].as_f64() > Some(0.0), "{latency}");
    assert!(report["copies"]["device"].as_f64() > Some(0.0));
    let jobs = &report["jobs"][0];
    let on_device = jobs["jobs"].as_array().unwrap().iter().filter(|job| job["device"] != "CPU (1 thread)").count();
    assert!(on_device >= 1 && !jobs["kernels"].as_array().unwrap().is_empty(), "{jobs}");
    // What the quick run leaves out is said, in both files.
    let left_out: Vec<&str> = report["left_out"].as_array().unwrap().iter().filter_map(Value::as_str).collect();
    assert!(left_out.len() == 5 && left_out.iter().all(|line| page.contains(line)), "{left_out:?}");
    for part in ["Everything that was compared agrees", "## Limits", "## Nine whole cases", "## Whole jobs at 4 elements"] {
        assert!(page.contains(part), "{part}: {page}");
    }
    // It is passed on: nothing in it says where it was made.
    let host = std::fs::read_to_string("/etc/hostname").unwrap_or_default();
    let secret = [host.trim().to_owned(), dir.path().display().to_string(), env!("CARGO_MANIFEST_DIR").to_owned()];
    for word in secret.iter().filter(|word| word.len() > 3) {
        assert!(!page.contains(word.as_str()) && !report.to_string().contains(word.as_str()), "{word}");
    }
    // The files are its own, and are replaced.
    assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 2);
}

/// One kernel of the element, one of the linear solver and one of Newton's iterates; with
/// `ASPERITY_FAULTS=all` or `ASPERITY_LONG=1` each in turn, and where the comparisons of kernels
/// have not got it, in whole cases.
#[test]
#[cfg_attr(not(debug_assertions), ignore = "only builds with debug assertions make kernels faulty on demand")]
fn a_faulty_kernel_ends_with_3() {
    let Some(_) = device::device("a_faulty_kernel_ends_with_3", Precision::F64) else { return };
    let is_set = |(name, wanted): (&str, &str)| std::env::var_os(name).is_some_and(|value| value == *wanted);
    let all = [("ASPERITY_FAULTS", "all"), ("ASPERITY_LONG", "1")].into_iter().any(is_set);
    let some = ["gather_node_force", "smooth_step", "iterate_measure"];
    for name in KERNELS.iter().map(|kernel| kernel.name).filter(|name| all || some.contains(name)) {
        let dir = tempfile::tempdir().unwrap();
        let faulty = |part: &str| prove(dir.path(), &["-q", "--only", part], &[(FAULT_VARIABLE, name)]);
        let output = faulty("kernels");
        let (report, page) = report(dir.path());
        if report["kernels"]["not_compared"].as_array().unwrap().contains(&Value::from(name)) {
            assert_eq!(faulty("cases").status.code(), Some(3), "{name}");
            continue;
        }
        assert_eq!(output.status.code(), Some(3), "{name}: {}", said(&output));
        assert!(!report["disagreements"].as_array().unwrap().is_empty() && page.contains("disagrees with the CPU"), "{name}");
        let of = report["kernels"]["kernels"].as_array().unwrap().iter().find(|of| of["kernel"] == name).cloned();
        assert!(of.is_some_and(|of| of["disagree"].as_u64() > Some(0)), "{name}: {page}");
    }
}

#[test]
#[cfg(target_os = "linux")]
fn without_a_device_it_ends_with_2_and_leaves_nothing() {
    let dir = tempfile::tempdir().unwrap();
    let nothing = [("VK_DRIVER_FILES", "/dev/null"), ("VK_ICD_FILENAMES", "/dev/null")];
    for (device, why) in [("gpu", "no GPU found"), ("auto", "auto finds no GPU")] {
        let output = prove(dir.path(), &["--device", device], &nothing);
        let said = said(&output);
        assert_eq!(output.status.code(), Some(2), "{said}");
        let expected = format!("error: there is nothing to prove: {why}");
        assert!(said.starts_with(&expected) && said.lines().count() == 1, "{said}");
    }
    assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 0);
}
