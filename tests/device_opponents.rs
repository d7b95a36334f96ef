//! An equal pair, a rigid sphere and an unlike sphere that deforms, on a device: the CPU's history
//! step by step, and the same bits again, alone or in a study.

mod device;
#[path = "common/histories.rs"]
mod histories;

use std::fs;
use std::path::Path;
use std::process::Command;

use asperity::internals::compute::gpu::Precision;
use asperity::output::{OutputDirectory, Status, Summary, read_history};
use histories::{difference, history};

/// Two cases of one mesh, the first with friction that slips, tightly solved.
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
contact_radius = 0.16
[base.solver]
tolerance = 1e-8
press_steps = 4
shear_steps = 4
[base.output]
plots = false
[grid]
"contact.friction" = [0.1, 0.3]
"#;

const EQUAL: &str = "[base.opponent]\nequal = true\n[[base.path]]\nindentation = 0.02\n[[base.path]]\nshear = 0.004\n";
const RIGID: &str =
    "[base.opponent]\nrigid = true\nradius = 0.8\n[[base.path]]\nindentation = 0.01\n[[base.path]]\nshear = 0.002\n";
/// Over the plane, but not along x: all of the sphere is meshed, and Newton's vectors stay on the
/// host.
const TURNED: &str =
    "[[base.path]]\nindentation = 0.01\n[[base.path]]\nshear = [0.001, 0.0015]\ntwist = 0.01\nroll = [0.0, 0.002]\n";
const UNLIKE: &str = r#"
[base.opponent]
radius = 2.0
[base.opponent.material]
youngs_modulus = 600e3
poissons_ratio = 0.25
[base.opponent.material.hardening]
law = "voce"
yield_stress = 500.0
saturation_stress = 900.0
rate = 30.0
[[base.path]]
indentation = 0.02
[[base.path]]
shear = 0.004
"#;

/// What is told of such a path on a device, and on no CPU.
const STAYS: &str = "note: the sphere leaves the x axis or turns, so the vectors of Newton's method stay on the host";

fn program(verb: &str, file: &Path, out: &Path, device: &str) {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("asperity"));
    command.arg(verb).arg(file).arg("--out").arg(out).args(["--device", device, "--quiet"]);
    let output = command.output().expect("the program runs");
    assert_eq!(output.status.code(), Some(0), "{verb}: {}", String::from_utf8_lossy(&output.stderr));
}

fn check(test: &str, opponent: &str) {
    let Some(context) = device::device(test, Precision::F64) else { return };
    let dir = tempfile::tempdir().expect("a scratch directory");
    let at = |name: &str| dir.path().join(name);
    fs::write(at("study.toml"), format!("{STUDY}{opponent}")).expect("the study");
    for device in ["cpu", "gpu"] {
        program("study", &at("study.toml"), &at(device), device);
    }
    for case in ["c0001", "c0002"] {
        let [theirs, ours] = ["cpu", "gpu"].map(|device| at(device).join("cases").join(case));
        let out = OutputDirectory::existing(&ours);
        let summary = Summary::read(&out.summary()).expect("a summary");
        assert!(summary.device.contains(&context.adapter().name), "{}", summary.device);
        assert_eq!((summary.status, summary.linear_fallbacks), (Status::Done, 0));
        let told: &[&str] = if opponent == TURNED { &[STAYS] } else { &[] };
        assert!(summary.messages == told && summary.device_traffic.is_some(), "{:?}", summary.messages);
        let rows = [&ours, &theirs].map(|dir| read_history(&OutputDirectory::existing(dir).history()).expect("a history"));
        assert!(rows[0].iter().any(|row| row.slipping_points > 0 && row.f_t > 0.0), "nothing slips");
        let difference = difference(&rows[0], &rows[1]);
        eprintln!("{test}, case {case}: {difference:.1e}");
        assert!(difference <= 3e-7, "case {case}: {difference}");
        // The second case alone, twice.
        for again in ["alone", "again"].iter().filter(|_| case == "c0002") {
            program("run", &out.case(), &at(again), "gpu");
            assert!(history(&at(again)) == history(&ours), "{again}: other bits than in the study");
        }
    }
}

#[test]
fn an_equal_pair_has_the_cpus_history() {
    check("an_equal_pair_has_the_cpus_history", EQUAL);
}

#[test]
fn a_rigid_sphere_has_the_cpus_history() {
    check("a_rigid_sphere_has_the_cpus_history", RIGID);
}

#[test]
fn a_plate_that_turns_has_the_cpus_history() {
    check("a_plate_that_turns_has_the_cpus_history", TURNED);
}

#[test]
fn an_unlike_pair_has_the_cpus_history() {
    check("an_unlike_pair_has_the_cpus_history", UNLIKE);
}
