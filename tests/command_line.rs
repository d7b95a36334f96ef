//! Usage, exit codes and the directory of results.

mod common;

use std::fs;

use asperity::case::Case;
use common::{asperity, stderr};

#[test]
fn check_prints_every_good_fixture_resolved() {
    let mut tried = 0;
    for entry in fs::read_dir("fixtures/cases").expect("the fixtures") {
        let path = entry.expect("an entry").path();
        if path.extension().is_none_or(|extension| extension != "toml") {
            continue;
        }
        tried += 1;
        let file = path.to_string_lossy();
        let output = asperity(&["check", &file]);
        assert_eq!(output.status.code(), Some(0), "{file}: {}", stderr(&output));
        let printed = String::from_utf8(output.stdout).expect("TOML is UTF-8");
        let resolved = Case::parse(&printed, "printed", &[]).expect("what was printed is a case");
        assert_eq!(resolved, Case::load(&path, &[]).expect("the fixture is a case"), "{file}");
        assert!(
            printed.contains("elements_per_contact_radius = 10\nsurface_elements_per_contact_radius = 20"),
            "{file}: defaults are written out"
        );
    }
    assert!(tried >= 10, "only {tried} cases");
}

#[test]
fn usage_errors_end_with_2_and_help_with_0() {
    for arguments in [
        &["check"][..],
        &["check", "--no-such-flag", "case.toml"],
        &["run"],
        &["run", "fixtures/cases/ideal.toml", "--out", "x", "--device", "tpu"],
        &["run", "fixtures/cases/ideal.toml", "--out", "x", "--precision", "f16"],
        &["run", "fixtures/cases/ideal.toml", "--out", "x", "--threads", "0"],
        &["run", "fixtures/cases/ideal.toml", "--out", "x", "-q", "-v"],
        &["no-such-subcommand"],
        &[],
    ] {
        let output = asperity(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {}", stderr(&output));
        assert!(!output.stderr.is_empty(), "{arguments:?}");
    }
    for arguments in [&["--help"][..], &["--version"], &["run", "--help"], &["check", "--help"], &["verify", "--help"]] {
        assert_eq!(asperity(arguments).status.code(), Some(0), "{arguments:?}");
    }
}

#[test]
fn run_never_touches_a_directory_of_the_users() {
    let scratch = tempfile::tempdir().expect("a scratch directory");
    let notes = scratch.path().join("notes.txt");
    fs::write(&notes, "mine").expect("a file");
    for out in [scratch.path(), notes.as_path()] {
        let output = asperity(&["run", "fixtures/cases/ideal.toml", "--out", &out.to_string_lossy()]);
        assert_eq!(output.status.code(), Some(2));
        let message = stderr(&output);
        assert!(message.starts_with(&format!("error: --out {}: ", out.display())), "{message}");
        assert!(message.contains("Give a new or an empty directory"), "{message}");
    }
    assert_eq!(fs::read_to_string(&notes).expect("still there"), "mine");
    assert_eq!(fs::read_dir(scratch.path()).expect("still there").count(), 1);
}
