//! A Python for tests that hand our files to other programs: `ASPERITY_PYTHON`, else
//! `target/python/bin/python`, else `python3`.
//!
//! To make one: `python3 -m venv target/python && target/python/bin/pip install meshio numpy pandas
//! pyarrow pyvista`. Without one such a test is skipped, aloud; with `ASPERITY_REQUIRE_PYTHON=1`
//! that is a failure.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A Python that can import these modules, or none after a line on stderr that no test runner
/// swallows.
pub fn python(test: &str, modules: &[&str]) -> Option<PathBuf> {
    let modules = modules.join(", ");
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut candidates: Vec<PathBuf> = std::env::var_os("ASPERITY_PYTHON").map(PathBuf::from).into_iter().collect();
    candidates.extend([root.join("target/python/bin/python"), PathBuf::from("python3")]);
    let works = |python: &PathBuf| {
        Command::new(python).args(["-c", &format!("import {modules}")]).output().is_ok_and(|output| output.status.success())
    };
    let found = candidates.into_iter().find(works);
    if found.is_none() {
        let install = modules.replace(',', "");
        let reason =
            format!("no Python with {modules}: python3 -m venv target/python && target/python/bin/pip install {install}");
        assert!(std::env::var_os("ASPERITY_REQUIRE_PYTHON").is_none_or(|value| value != "1"), "{test}: {reason}");
        // The print macros are captured for passing tests; the handle is not.
        #[allow(clippy::explicit_write)]
        writeln!(std::io::stderr(), "SKIPPED {test}: {reason}").expect("stderr");
    }
    found
}
