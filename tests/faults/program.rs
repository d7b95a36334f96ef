//! The program, a small case, and what a run of it that nothing disturbs leaves.

use std::collections::BTreeMap;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

use asperity::output::{Summary, TimeByPhase};
use tempfile::TempDir;

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

/// A directory with the case.
pub struct Scratch {
    pub dir: TempDir,
}

impl Scratch {
    pub fn new() -> Self {
        let dir = tempfile::tempdir().expect("a scratch directory");
        fs::write(dir.path().join("case.toml"), CASE).expect("the case");
        Self { dir }
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.dir.path().join(name)
    }

    pub fn args(&self, out: &Path, options: &[&str]) -> Vec<String> {
        let mut args =
            vec!["run".to_owned(), self.path("case.toml").display().to_string(), "--out".to_owned(), out.display().to_string()];
        args.extend(
            ["--device", "cpu", "--threads", "1", "--checkpoint-every", "0"].iter().chain(options).map(|o| (*o).to_owned()),
        );
        args
    }

    pub fn run(&self, out: &Path, options: &[&str]) -> Output {
        Command::new(program()).args(self.args(out, options)).output().expect("the program runs")
    }
}

pub fn program() -> &'static str {
    env!("CARGO_BIN_EXE_asperity")
}

pub fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).expect("messages are UTF-8")
}

/// Says that a test could not be made; the print macros are captured for passing tests, the handle is not.
#[allow(clippy::explicit_write)]
pub fn skipped(test: &str, why: &str) {
    writeln!(std::io::stderr(), "SKIPPED {test}: {why}").expect("stderr");
}

/// Every file below a directory.
pub fn files(dir: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut files = BTreeMap::new();
    for entry in fs::read_dir(dir).unwrap_or_else(|error| panic!("{}: {error}", dir.display())) {
        let path = entry.expect("an entry").path();
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        if path.is_dir() {
            files.extend(self::files(&path).into_iter().map(|(below, bytes)| (format!("{name}/{below}"), bytes)));
        } else {
            files.insert(name, fs::read(&path).expect("a file"));
        }
    }
    files
}

/// In what two directories differ, times apart; `None` if they hold the same files with the same bits.
pub fn difference(found: &Path, expected: &Path) -> Option<String> {
    let summary = |dir: &Path| {
        let summary = Summary::read(&dir.join("summary.json")).expect("a summary");
        Summary { wall_s: 0.0, cpu_s: None, time_by_phase: TimeByPhase::default(), ..summary }
    };
    let (ours, theirs) = (files(found), files(expected));
    let names = |files: &BTreeMap<String, Vec<u8>>| files.keys().cloned().collect::<Vec<_>>();
    if names(&ours) != names(&theirs) {
        return Some(format!("{:?}, not {:?}", names(&ours), names(&theirs)));
    }
    let differs = |name: &&String| *name != "summary.json" && ours[*name] != theirs[*name];
    let name = theirs.keys().find(differs).map(|name| format!("{name} differs"));
    name.or_else(|| (summary(found) != summary(expected)).then(|| "summary.json differs".to_owned()))
}

/// The run that nothing disturbs, computed once.
pub fn whole() -> &'static Path {
    static WHOLE: OnceLock<PathBuf> = OnceLock::new();
    WHOLE.get_or_init(|| {
        let scratch = Scratch::new();
        let dir = Path::new(env!("CARGO_TARGET_TMPDIR")).join("faults-whole");
        let output = scratch.run(&dir, &["-q", "--force"]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        dir
    })
}
