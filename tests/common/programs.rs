//! Programs that a test needs and a machine may lack.

use std::io::Write as _;
use std::process::Command;

/// Whether a program is there. Where it is not the test is skipped, aloud; with
/// `ASPERITY_REQUIRE_COMPILERS=1` that is a failure.
pub fn has(program: &str, test: &str) -> bool {
    let found = Command::new(program).arg("--version").output().is_ok_and(|output| output.status.success());
    if !found {
        let required = std::env::var_os("ASPERITY_REQUIRE_COMPILERS").is_some_and(|value| value == "1");
        assert!(!required, "{test}: no {program}, and ASPERITY_REQUIRE_COMPILERS=1");
        // The print macros are captured for passing tests; the handle is not.
        #[allow(clippy::explicit_write)]
        writeln!(std::io::stderr(), "SKIPPED {test}: no {program}").expect("stderr");
    }
    found
}
