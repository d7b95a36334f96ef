//! The program, a small case, and what a run of it that nothing disturbs leaves.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use super::common::{Scratch, stderr};

/// Less than half a second: every kind of file is written.
pub const CASE: &str = r#"
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
contact_radius = 0.16
[solver]
press_steps = 4
shear_steps = 3
error_estimate = false
[[path]]
indentation = 0.01
[[path]]
shear = 0.002
"#;

/// On one thread, with a checkpoint after every step.
const OPTIONS: [&str; 6] = ["--device", "cpu", "--threads", "1", "--checkpoint-every", "0"];

/// A directory with the case.
pub fn scratch() -> Scratch {
    Scratch::new(CASE, &OPTIONS)
}

/// Says that a test could not be made; the print macros are captured for passing tests, the handle
/// is not.
#[allow(clippy::explicit_write)]
pub fn skipped(test: &str, why: &str) {
    writeln!(std::io::stderr(), "SKIPPED {test}: {why}").expect("stderr");
}

/// The run that nothing disturbs, computed once.
pub fn whole() -> &'static Path {
    static WHOLE: OnceLock<PathBuf> = OnceLock::new();
    WHOLE.get_or_init(|| {
        let scratch = scratch();
        // The two profiles have one such folder, and may be tested at once.
        let name = if cfg!(debug_assertions) { "faults-whole" } else { "faults-whole-release" };
        let dir = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
        let output = scratch.run(&dir, &["-q", "--force"]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        dir
    })
}
