//! Paths that a shell, Slurm and the program's own scripts could take for something else: commands
//! that are printed can be typed, and scripts do what they say.
#![cfg(target_os = "linux")]

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use super::common::{program, stderr, stdout};
use super::study::BASE;
use tempfile::TempDir;

const NASTY: &str = "it's a $HOME `x` @PROGRAM@ @DIR@ @ALL@ #1 & (2); ~*?{a,b}";
const GRID: &str = "[grid]\n\"contact.friction\" = [0.1, 0.2]\n";

/// Tells what it would hand over, and runs it at once, task by task.
const SBATCH: &str = r#"#!/bin/bash
[ "$1" = --parsable ] && shift
case "$1" in --dependency=*) shift ;; esac
bash -n "$1" || exit 1
tasks=$(sed -n 's/^#SBATCH --array=1-\([0-9]*\).*/\1/p' "$1")
log=$(sed -n 's/^#SBATCH --output="\(.*\)"$/\1/p' "$1")
for task in $(seq "${tasks:-1}"); do
    SLURM_ARRAY_TASK_ID=$task SLURM_ARRAY_JOB_ID=7 bash "$1" >> "${log//\%a/$task}" 2>&1
done
echo 7
"#;

/// A folder of such a name, and in it a study, this program, and a scheduler.
struct Scratch {
    _dir: TempDir,
    root: PathBuf,
}

impl Scratch {
    fn new() -> Self {
        // Beside the program, of which there is to be a second name.
        let dir = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("a scratch directory");
        let root = dir.path().canonicalize().expect("a path").join(NASTY);
        fs::create_dir(&root).expect("a directory");
        let mine = program();
        let named = root.join("asperity");
        if fs::hard_link(mine.get_program(), &named).is_err() {
            fs::copy(mine.get_program(), &named).expect("a copy");
        }
        fs::write(root.join("study.toml"), format!("{BASE}{GRID}")).expect("the study");
        fs::write(root.join("sbatch"), SBATCH).expect("a scheduler");
        fs::set_permissions(root.join("sbatch"), fs::Permissions::from_mode(0o755)).expect("it may run");
        Self { _dir: dir, root }
    }

    fn in_folder(&self, command: &mut Command) -> Output {
        let path = format!("{}:{}", self.root.display(), std::env::var("PATH").expect("a path"));
        command.current_dir(&self.root).env("PATH", path).output().expect("it runs")
    }

    /// Runs this program by its name here.
    fn asperity(&self, arguments: &[&str]) -> Output {
        self.in_folder(Command::new(self.root.join("asperity")).args(arguments))
    }

    /// What somebody types who copies a command.
    fn typed(&self, command: &str) -> Output {
        self.in_folder(Command::new("bash").args(["-c", command]))
    }
}

/// The words of a command as a shell reads them.
fn words(command: &str) -> Vec<String> {
    let script = format!("told() {{ printf '%s\\0' \"$@\"; }}; told {command}");
    let output = Command::new("bash").args(["-c", &script]).output().expect("bash runs");
    assert!(output.status.success(), "{command}: {}", stderr(&output));
    stdout(&output).split_terminator('\0').map(str::to_owned).collect()
}

/// What stands between two parts of a text.
fn between<'t>(text: &'t str, before: &str, after: &str) -> &'t str {
    let start = text.find(before).unwrap_or_else(|| panic!("{before} is not in {text}")) + before.len();
    let end = text[start..].find(after).unwrap_or_else(|| panic!("{after} is not in {text}"));
    &text[start..start + end]
}

fn done(table: &Path) -> usize {
    fs::read_to_string(table).expect("a table").matches(",done,").count()
}

#[test]
fn scripts_for_slurm_do_what_they_say_wherever_they_lie() {
    let scratch = Scratch::new();
    let options = ["study", "study.toml", "--out", NASTY, "--device", "cpu", "--slurm", "tasks=2"];
    let output = scratch.asperity(&options);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let out = scratch.root.join(NASTY);
    assert_eq!(done(&out.join("study.csv")), 0);
    let printed = stdout(&output);
    let output = scratch.typed(between(&printed, "to submit them: ", "\n"));
    assert_eq!(stdout(&output), "submitted: tasks 7, table 7\n", "{}", stderr(&output));
    let log = |name: &str| fs::read_to_string(out.join("slurm").join(name)).expect("a log");
    assert_eq!(done(&out.join("study.csv")), 2, "{}{}", log("task-1.log"), log("table.log"));
    for task in ["1", "2"] {
        assert!(log(&format!("task-{task}.log")).contains(&format!("share {task}/2 ended with 0")), "{}", log("task-1.log"));
    }
    // By the program itself; there is nothing left to do.
    let output = scratch.asperity(&[&options[..], &["--submit"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(stdout(&output).contains("submitted: tasks 7, table 7"), "{}", stdout(&output));
    // And where it fails, what to type instead.
    fs::write(scratch.root.join("sbatch"), "#!/bin/sh\necho no >&2; exit 1\n").expect("a scheduler");
    let output = scratch.asperity(&[&options[..], &["--submit"]].concat());
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    let script = PathBuf::from(NASTY).join("slurm/submit.sh").display().to_string();
    let printed = stderr(&output);
    assert_eq!(words(between(&printed, "submit them with `", "` where sbatch is")), ["bash".to_owned(), script]);
}

#[test]
fn a_path_that_slurm_cannot_take_is_refused_before_anything_is_written() {
    let scratch = Scratch::new();
    fs::create_dir(scratch.root.join("100%")).expect("a directory");
    for out in ["100%", "50%/new", "a\"b", "a\\b"] {
        let output = scratch.asperity(&["study", "study.toml", "--out", out, "--slurm"]);
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{out}: {message}");
        assert!(message.starts_with("error: --slurm ") && message.contains("nothing was written"), "{message}");
    }
    let mut left: Vec<String> = fs::read_dir(&scratch.root)
        .expect("a directory")
        .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
        .collect();
    left.sort();
    assert_eq!(left, ["100%", "asperity", "sbatch", "study.toml"]);
    assert_eq!(fs::read_dir(scratch.root.join("100%")).expect("a directory").count(), 0);
}

#[test]
fn commands_that_are_printed_can_be_typed() {
    let scratch = Scratch::new();
    // A case to begin with.
    let name = format!("{NASTY}.toml");
    let output = scratch.asperity(&["init", &name]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let printed = stdout(&output);
    assert_eq!(words(between(&printed, "written; `", "` runs it")), ["asperity", "run", &name]);
    let text = fs::read_to_string(scratch.root.join(&name)).expect("a case");
    let output = scratch.typed(between(&text, "#     ", "              the case"));
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    // A case where a study is wanted, and the reverse; from standard input too.
    let study = format!("-{NASTY}");
    fs::copy(scratch.root.join("study.toml"), scratch.root.join(&study)).expect("a copy");
    let output = scratch.asperity(&["study", &name, "--out", "out"]);
    let message = stderr(&output);
    assert_eq!(words(between(&message, "[grid]). `", "` computes it")), ["asperity", "run", &name, "--out", "DIR"]);
    let output = scratch.asperity(&["run", "--out", "out", "--", &study]);
    let message = stderr(&output);
    let file = format!("./{study}");
    assert_eq!(words(between(&message, "a grid of cases. `", "` computes it")), ["asperity", "study", &file, "--out", "DIR"]);
    let check = between(&message, "computes it, `", "` shows its first case");
    assert_eq!(words(check), ["asperity", "check", &file]);
    assert_eq!(scratch.typed(check).status.code(), Some(0));
    let output = scratch.typed("asperity run - --out out < study.toml");
    assert!(stderr(&output).contains("`asperity study - --out DIR`"), "{}", stderr(&output));
    // A share that is missing: the command computes it.
    let output = scratch.asperity(&["study", "study.toml", "--out", NASTY, "--shard", "1/2", "--device", "cpu", "-q"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let output = scratch.asperity(&["study", "--merge", NASTY, "--out", NASTY]);
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(75), "{message}");
    let (_, command) = between(&message, "are missing: ", "` computes them").split_once(". `").expect("a command");
    let output = scratch.typed(command);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(done(&scratch.root.join(NASTY).join("study.csv")), 2);
    // What a run was started with, in its log.
    fs::write(scratch.root.join("case.toml"), BASE.replace("base.", "")).expect("a case");
    let arguments = ["run", "case.toml", "--out", "a\nb", "--device", "cpu", "-q", "--set", "solver.press_steps = 3"];
    let output = scratch.asperity(&arguments);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let log = fs::read_to_string(scratch.root.join("a\nb/run.log")).expect("a log");
    let head = log.lines().next().expect("a line");
    assert_eq!(words(head.split_once(": ").expect("a command").1), arguments);
}
