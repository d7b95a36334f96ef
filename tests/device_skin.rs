//! Meshes whose elements at the surface are halved again, with corners that hang: a study on a
//! device has the CPU's histories, step by step, and the same bits again alone.

mod device;
#[path = "common/histories.rs"]
mod histories;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use asperity::internals::compute::gpu::Precision;
use asperity::output::{OutputDirectory, RunStatus, Summary};
use histories::{difference, history};

/// The reference case, tightly solved, so that what is left is not which iterate was the first to
/// be good enough.
const STUDY: &str = r#"
[base.sphere]
radius = 1.0
[base.material]
youngs_modulus = 200e3
poissons_ratio = 0.3
[base.material.hardening]
law = "ideal"
yield_stress = 400.0
[base.mesh]
elements_per_contact_radius = 4
contact_radius = 0.2
[base.solver]
tolerance = 1e-8
press_steps = 3
shear_steps = 2
error_estimate = false
[base.output]
fields = "none"
plots = false
"#;

fn program(verb: &str, file: &Path, out: &Path, (device, precision): (&str, &str)) {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("asperity"));
    command.arg(verb).arg(file).arg("--out").arg(out).args(["--device", device, "--precision", precision, "--quiet"]);
    let output = command.output().expect("the program runs");
    assert_eq!(output.status.code(), Some(0), "{verb}: {}", String::from_utf8_lossy(&output.stderr));
}

/// Studies of so many cases on the CPU, and on the device in f64 and in f32 held to f64: the bounds
/// are those of meshes without a skin.
fn check(name: &str, dir: &Path, path_and_grid: &str, cases: usize) {
    let Some(context) = device::device(name, Precision::F64) else { return };
    let file = dir.join("study.toml");
    fs::write(&file, format!("{STUDY}{path_and_grid}")).expect("the study");
    program("study", &file, &dir.join("cpu"), ("cpu", "auto"));
    for (out, precision, most) in [("f64", "auto", 3e-7), ("mixed", "mixed", 1e-7)] {
        program("study", &file, &dir.join(out), ("gpu", precision));
        for number in 1..=cases {
            let [theirs, ours] = ["cpu", out].map(|out| case(dir, out, number));
            let summary = Summary::read(&OutputDirectory::existing(&ours).summary()).expect("a summary");
            assert!(summary.device.contains(&context.adapter().name), "{}", summary.device);
            assert_eq!((summary.status, summary.linear_fallbacks), (RunStatus::Done, 0));
            assert!(summary.messages.is_empty() && summary.device_traffic.is_some(), "{:?}", summary.messages);
            let [theirs, ours] = [theirs, ours].map(|dir| history(&dir));
            assert!(ours.iter().any(|row| row.slipping_points > 0 && row.f_t > 0.0), "nothing slips");
            let difference = difference(&ours, &theirs);
            eprintln!("{out}, case {number}, {} elements: {difference:.1e}", summary.elements);
            assert!(difference <= most, "{out}, case {number}: {difference}");
        }
    }
}

fn case(dir: &Path, out: &str, number: usize) -> PathBuf {
    dir.join(out).join(format!("cases/c{number:04}"))
}

/// Two frictions share a mesh and are one batch; the first mesh has no skin.
#[test]
fn a_skin_has_the_cpus_histories_and_the_bits_of_its_case_alone() {
    let dir = tempfile::tempdir().expect("a scratch directory");
    let grid = "[[base.path]]\nindentation = 0.02\n[[base.path]]\nshear = 0.003\n\
        [grid]\n\"contact.friction\" = [0.1, 0.3]\n\"mesh.surface_elements_per_contact_radius\" = [4, 8]\n";
    check("a_skin_has_the_cpus_histories_and_the_bits_of_its_case_alone", dir.path(), grid, 4);
    let of_study = case(dir.path(), "f64", 4);
    if of_study.exists() {
        let alone = dir.path().join("alone");
        program("run", &OutputDirectory::existing(&of_study).case(), &alone, ("gpu", "auto"));
        assert!(history(&alone) == history(&of_study), "other bits than in the study");
    }
}

#[test]
fn a_skin_of_two_levels_has_the_cpus_histories() {
    let dir = tempfile::tempdir().expect("a scratch directory");
    // In steps that are not bisected.
    let grid = "[[base.path]]\nindentation = 0.008\n[[base.path]]\nshear = 0.0008\n\
        [grid]\n\"contact.friction\" = [0.3]\n\"mesh.surface_elements_per_contact_radius\" = [16]\n";
    check("a_skin_of_two_levels_has_the_cpus_histories", dir.path(), grid, 1);
}
