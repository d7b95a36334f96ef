//! What there is of memory: refused beforehand where that is known, and told where it is not, by
//! the real program under a limit of its address space.
#![cfg(target_os = "linux")]

mod common;

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use common::{files, stderr};

/// Runs the program with so many KiB of address space.
fn within(kibibytes: usize, arguments: &[&str]) -> Output {
    let program = assert_cmd::cargo::cargo_bin!("asperity");
    let script = format!("ulimit -v {kibibytes}; exec \"$0\" \"$@\"");
    Command::new("sh").arg("-c").arg(script).arg(program).args(arguments).output().expect("sh runs the program")
}

/// For a program of 0.3 GiB at the least, far too little for 32 elements.
const LITTLE: usize = 700_000;
const FINE: &str = "mesh.elements_per_contact_radius=32";
const FINE_ZONE: &str = "mesh.fine_zone=3";

fn text(path: &Path) -> &str {
    path.to_str().expect("a path in UTF-8")
}

#[test]
fn an_allocation_that_fails_is_told_with_what_to_do() {
    let scratch = tempfile::tempdir().expect("a scratch directory");
    let out = scratch.path().join("out");
    // The user says that there is enough.
    let settings =
        ["--set", FINE, "--set", FINE_ZONE, "--set", "solver.max_memory_gib=64", "--set", "solver.error_estimate=false"];
    let run = ["run", "fixtures/cases/ideal.toml", "--out", text(&out), "--device", "cpu", "--threads", "1", "-q"];
    let output = within(LITTLE, &[&run[..], &settings].concat());
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(3), "{:?}: {message}", output.status);
    assert!(message.contains("error: out of memory: ") && message.contains(" MiB more were asked for"), "{message}");
    assert!(message.contains("A mesh of ") && message.contains(" elements is too large"), "{message}");
    for remedy in ["fewer elements", "mesh.elements_per_contact_radius", "allow more memory", "ulimit -v", "--resume"] {
        assert!(message.contains(remedy), "{remedy:?} in {message}");
    }
    assert!(!message.contains("memory allocation of") && !message.contains("panicked"), "{message}");
}

#[test]
fn a_case_that_does_not_fit_is_refused_beforehand_with_what_says_so() {
    let scratch = tempfile::tempdir().expect("a scratch directory");
    let out = scratch.path().join("out");
    let mut file = fs::read_to_string("fixtures/cases/ideal.toml").expect("the fixture");
    file += "[mesh]\nelements_per_contact_radius = 32\nfine_zone = 3.0\n";
    let line = file.lines().position(|line| line.starts_with("elements_per")).expect("the line") + 1;
    let case = scratch.path().join("fine.toml");
    fs::write(&case, file).expect("the case");
    for arguments in [vec!["check", text(&case)], vec!["run", text(&case), "--out", text(&out), "--device", "cpu"]] {
        let output = within(LITTLE, &arguments);
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{message}");
        let place = format!("error: {}:{line}: mesh.elements_per_contact_radius: a mesh of about ", case.display());
        assert!(message.starts_with(&place), "{message}");
        assert!(message.contains(" GiB that there are for this process"), "{message}");
        assert!(
            message.contains("the limit of its address space, ulimit -v") && message.contains("Allowed: fewer mesh."),
            "{message}"
        );
    }
    assert!(!out.exists());
    // With enough, and with a limit of the user's own, it is a case.
    assert_eq!(within(8_000_000, &["check", text(&case)]).status.code(), Some(0));
    assert_eq!(within(LITTLE, &["check", text(&case), "--set", "solver.max_memory_gib=5"]).status.code(), Some(0));
}

/// A run of a second, as it stands in its directory.
const CASE: &str = r#"
[sphere]
radius = 1.0
[material]
youngs_modulus = 200e3
poissons_ratio = 0.3
[material.hardening]
law = "ideal"
yield_stress = 400.0
[contact]
friction = 0.3
[mesh]
elements_per_contact_radius = 4
[solver]
press_steps = 3
error_estimate = false
[output]
plots = false
[[path]]
indentation = 0.01
"#;

#[test]
fn how_much_there_is_makes_no_other_case() {
    let scratch = tempfile::tempdir().expect("a scratch directory");
    let (case, out) = (scratch.path().join("case.toml"), scratch.path().join("out"));
    fs::write(&case, CASE).expect("the case");
    let run = ["run", text(&case), "--out", text(&out), "--device", "cpu", "--threads", "1"];
    let output = within(4_000_000, &run);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let written = out.join("case.toml");
    let resolved = fs::read_to_string(&written).expect("case.toml");
    assert!(!resolved.contains("max_memory_gib"), "{resolved}");
    let before = files(&out);
    // Less memory than it would need: there is nothing to compute. And the same case of a version
    // that wrote 8 down.
    for kept in [resolved.clone(), resolved.replace("[solver]\n", "[solver]\nmax_memory_gib = 8.0\n")] {
        fs::write(&written, &kept).expect("case.toml");
        let output = within(150_000, &[&run[..], &["--resume"]].concat());
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        assert!(String::from_utf8_lossy(&output.stdout).starts_with("already done"), "{output:?}");
    }
    fs::write(&written, &resolved).expect("case.toml");
    assert!(files(&out) == before);
    let output = within(150_000, &[&run[..], &["--force", "--set", FINE]].concat());
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
}

#[test]
fn cases_of_a_study_share_what_there_is() {
    let scratch = tempfile::tempdir().expect("a scratch directory");
    let base = CASE.replace("[[path]]", "[[base.path]]").replace("\n[", "\n[base.").replace("[base.[base.", "[[base.");
    let study = scratch.path().join("study.toml");
    let write = |grid: &str| fs::write(&study, format!("{base}[grid]\n{grid}\n")).expect("the study");
    write("contact.friction = [0.1, 0.2, 0.3, 0.4]");
    let run = |kibibytes: usize, name: &str| {
        let out = scratch.path().join(name);
        within(kibibytes, &["study", text(&study), "--out", text(&out), "--device", "cpu", "--threads", "4"])
    };
    // An address space takes what the allocator sets aside for each thread, beside the meshes.
    let output = run(800_000, "little");
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(0), "{message}");
    assert!(
        message.contains(" at a time, not 4: there is memory for no more, of ") && message.contains("ulimit -v"),
        "{message}"
    );
    let output = run(4_000_000, "much");
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(0), "{message}");
    assert!(message.contains("4 to compute, 4 at a time") && !message.contains("there is memory"), "{message}");
    let numbers = |name: &str| {
        let table = fs::read_to_string(scratch.path().join(name).join("study.csv")).expect("study.csv");
        // All but the time that they took.
        table.lines().map(|line| line.rsplit_once(',').expect("columns").0.to_owned()).collect::<Vec<_>>()
    };
    assert_eq!(numbers("little"), numbers("much"));

    write("mesh.elements_per_contact_radius = [4, 32]\nmesh.fine_zone = [3.0]");
    let output = run(LITTLE, "large");
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("a mesh of about ") && message.contains("1 of 2 combinations are refused"), "{message}");
    assert!(!scratch.path().join("large").exists());
}
