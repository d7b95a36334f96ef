//! `asperity study`: a directory and a row a case, whatever becomes of the others; shares;
//! interruption; bad files.

mod common;
mod device;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::{Duration, Instant};

use asperity::case::Case;
use asperity::internals::compute::gpu::Precision;
use asperity::output::{OutputDirectory, RunStatus, Summary, read_contact, read_history};
use common::{stderr, stdout};
use tempfile::TempDir;

/// Less than a second a case.
const BASE: &str = r#"
[base.sphere]
radius = 1.0
[base.material]
youngs_modulus = 200e3
poissons_ratio = 0.3
[base.material.hardening]
law = "ideal"
yield_stress = 400.0
[base.contact]
friction = 0.3
[base.mesh]
elements_per_contact_radius = 4
contact_radius = 0.16
[base.solver]
press_steps = 4
shear_steps = 4
[[base.path]]
indentation = 0.01
[[base.path]]
shear = 0.002
"#;

const GRID: &str = r#"
[grid]
"material.hardening.yield_stress" = [400.0, 1600.0]
"contact.friction" = [0.1, "stick"]
"#;

/// The second mesh is made for a smaller contact, the second solver gives up after one iteration.
const FAILING: &str = r#"
[grid]
"solver.max_iterations" = [25, 1]
"mesh.contact_radius" = [0.16, 0.05]
"solver.max_cutbacks" = [0]
"#;

struct Scratch {
    dir: TempDir,
}

impl Scratch {
    fn new(grid: &str) -> Self {
        let dir = tempfile::tempdir().expect("a scratch directory");
        fs::write(dir.path().join("study.toml"), format!("{BASE}{grid}")).expect("the study");
        Self { dir }
    }

    fn out(&self, name: &str) -> PathBuf {
        self.dir.path().join(name)
    }

    /// On the CPU, whatever devices the machine has, unless `options` say otherwise.
    fn command(&self, name: &str, options: &[&str]) -> Command {
        let mut command = Command::new(assert_cmd::cargo::cargo_bin!("asperity"));
        command.arg("study").arg(self.dir.path().join("study.toml")).arg("--out").arg(self.out(name)).args(options);
        if !options.contains(&"--device") {
            command.args(["--device", "cpu"]);
        }
        command
    }

    fn run(&self, name: &str, options: &[&str]) -> Output {
        self.command(name, options).output().expect("the program runs")
    }

    /// Runs and expects an exit code.
    fn ends_with(&self, code: i32, name: &str, options: &[&str]) -> Output {
        let output = self.run(name, options);
        assert_eq!(output.status.code(), Some(code), "{options:?}: {}", stderr(&output));
        output
    }

    fn case(&self, name: &str, id: &str) -> OutputDirectory {
        OutputDirectory::existing(self.out(name).join("cases").join(id))
    }
}

type Row = BTreeMap<String, String>;

fn rows(dir: &Path) -> Vec<Row> {
    let mut reader = csv::Reader::from_path(dir.join("study.csv")).expect("a table");
    let header = reader.headers().expect("a header").clone();
    let row = |record: Result<csv::StringRecord, csv::Error>| {
        header.iter().map(str::to_owned).zip(record.expect("a row").iter().map(str::to_owned)).collect()
    };
    reader.records().map(row).collect()
}

/// The rows without what may differ between two runs of one case.
fn timeless(mut rows: Vec<Row>) -> Vec<Row> {
    rows.iter_mut().for_each(|row| drop(row.remove("cpu_s")));
    rows
}

fn statuses(dir: &Path) -> Vec<String> {
    rows(dir).into_iter().map(|row| row["status"].clone()).collect()
}

fn history(out: &OutputDirectory) -> String {
    fs::read_to_string(out.history()).expect("a history")
}

#[test]
fn a_directory_and_a_row_for_every_case_and_shares_give_the_same() {
    let scratch = Scratch::new(GRID);
    let output = scratch.ends_with(0, "whole", &["--threads", "2"]);
    let said = stderr(&output);
    assert!(
        said.starts_with("4 cases: material.hardening.yield_stress (2) x contact.friction (2); 4 to compute, 2 at a time\n"),
        "{said}"
    );
    assert!(
        said.lines().last().is_some_and(|line| line.starts_with("4/4  c000") && line.ends_with("(4 done, 0 running, 0 failed)")),
        "{said}"
    );
    assert!(stdout(&output).starts_with("4 done, 0 failed, 0 pending; a row each in "), "{}", stdout(&output));

    let whole = rows(&scratch.out("whole"));
    let text = fs::read_to_string(scratch.out("whole").join("study.csv")).expect("a table");
    assert!(text.starts_with("case,directory,status,reason,material.hardening.yield_stress,contact.friction,E,nu,"), "{text}");
    assert_eq!(
        fs::read(scratch.out("whole").join("study.toml")).expect("a copy"),
        fs::read(scratch.out("study.toml")).expect("the study")
    );
    for (row, [id, stress, friction]) in whole.iter().zip([
        ["c0001", "400.0", "0.1"],
        ["c0002", "400.0", "stick"],
        ["c0003", "1600.0", "0.1"],
        ["c0004", "1600.0", "stick"],
    ]) {
        assert_eq!([&row["case"], &row["material.hardening.yield_stress"], &row["contact.friction"]], [id, stress, friction]);
        assert_eq!((row["status"].as_str(), row["reason"].as_str()), ("done", ""));
        // An ordinary run's directory, without fields and plots, but by default with the contact at
        // the ends of the two segments.
        let out = scratch.case("whole", id);
        let case = Case::load(&out.case(), &[]).expect("a case");
        assert_eq!(case.material.hardening.yield_stress(200e3), stress.parse().ok());
        let summary = Summary::read(&out.summary()).expect("a summary");
        let records = read_history(&out.history()).expect("a history");
        assert_eq!((summary.status, summary.steps), (RunStatus::Done, records.len()));
        let steps = out.contact_steps().expect("contact tables");
        assert_eq!((steps.len(), steps.last()), (2, Some(&records.len())));
        assert!(!read_contact(&out.contact(steps[0])).expect("a contact").is_empty());
        assert!(!out.root().join("fields").exists() && !out.root().join("plots").exists());
        assert!(summary.device.starts_with("CPU (1 thread)") && summary.cpu_s.is_some_and(|seconds| seconds > 0.0));
        let number = |name: &str| row[name].parse::<f64>().expect("a number");
        assert_eq!((Some(number("F_N0")), Some(number("a0"))), (summary.f_n0, summary.a0));
        let lambda = 200e3 / 0.91 * number("a0") / number("sigma_rep");
        assert!((number("Lambda") / lambda - 1.0).abs() < 1e-12 && number("sigma_rep") >= number("sigma_Y"));
        assert_eq!(row["mu"].is_empty(), friction == "stick");
    }

    // One share after the other into one directory, one core each; then all rows are gathered and
    // nothing is left to do.
    scratch.ends_with(0, "shares", &["--threads", "1", "--shard", "1/2", "-q"]);
    let first = statuses(&scratch.out("shares"));
    assert_eq!(first.iter().filter(|status| *status == "done").count(), 2, "{first:?}");
    assert_eq!(first.iter().filter(|status| *status == "pending").count(), 2, "{first:?}");
    let output = scratch.ends_with(0, "shares", &["--threads", "1", "--shard", "2/2"]);
    assert!(stderr(&output).contains("; share 2/2; 2 to compute, 1 at a time\n"), "{}", stderr(&output));
    assert_eq!(timeless(rows(&scratch.out("shares"))), timeless(whole));
    let table = fs::read(scratch.out("shares").join("study.csv")).expect("a table");
    let output = scratch.ends_with(0, "shares", &["--resume"]);
    assert!(stderr(&output).contains("; 4 done and 0 failed before; 0 to compute"), "{}", stderr(&output));
    assert_eq!(fs::read(scratch.out("shares").join("study.csv")).expect("a table"), table);
    for id in ["c0001", "c0002", "c0003", "c0004"] {
        assert_eq!(history(&scratch.case("shares", id)), history(&scratch.case("whole", id)), "{id}");
    }
}

#[test]
fn a_case_that_fails_stops_no_other_and_its_row_says_why() {
    let scratch = Scratch::new(FAILING);
    let output = scratch.ends_with(3, "out", &["--threads", "2"]);
    let table = rows(&scratch.out("out"));
    let found: Vec<&str> = table.iter().map(|row| row["status"].as_str()).collect();
    // The second one's contact leaves its fine mesh, and is computed on a larger one.
    assert_eq!(found, ["done", "done", "not-converged", "not-converged"], "{}", stderr(&output));
    assert!(stderr(&output).contains("c0002: note: the contact reaches "), "{}", stderr(&output));
    assert!(table[2]["reason"].starts_with("no convergence: step 1 of segment 0"), "{table:?}");
    let message = stderr(&output);
    let last = message.lines().last().unwrap_or_default();
    assert!(
        last.starts_with("error: 2 of 4 cases failed, the first in ") && last.contains("cases/c0003: no convergence"),
        "{message}"
    );
    assert!(last.ends_with("study.csv"), "{message}");
    // What was computed is kept, and has its row.
    assert!(!read_history(&scratch.case("out", "c0002").history()).expect("a history").is_empty());
    assert!(table[1]["F_N0"].parse::<f64>().is_ok_and(|force| force > 0.0));

    // The same program would do the same: they are not computed again, unless that is asked for.
    let output = scratch.ends_with(3, "out", &["--resume"]);
    assert!(stderr(&output).contains("; 2 done and 2 failed before; 0 to compute"), "{}", stderr(&output));
    let output = scratch.ends_with(3, "out", &["--resume", "--retry"]);
    assert!(stderr(&output).contains("; 2 done and 0 failed before; 2 to compute"), "{}", stderr(&output));
    assert_eq!(timeless(rows(&scratch.out("out"))), timeless(table));
}

#[cfg(unix)]
#[test]
fn an_interrupted_study_goes_on_where_it_was() {
    use rustix::process::{Pid, Signal, kill_process};

    let scratch = Scratch::new(GRID);
    scratch.ends_with(0, "whole", &["-q"]);
    for (name, signal, code) in [
        ("terminated", Signal::TERM, Some(75)),
        ("warned", Signal::USR2, Some(75)),
        ("out-of-time", Signal::XCPU, Some(75)),
        ("killed", Signal::KILL, None),
    ] {
        let mut command = scratch.command(name, &["--threads", "1", "-q"]);
        let child = command.stderr(std::process::Stdio::piped()).stdout(std::process::Stdio::null()).spawn().expect("it runs");
        let table = scratch.out(name).join("study.csv");
        let begun = Instant::now();
        while !fs::read_to_string(&table).is_ok_and(|text| text.contains(",done,")) {
            assert!(begun.elapsed() < Duration::from_secs(120), "{name}: no case was done");
            std::thread::sleep(Duration::from_millis(2));
        }
        kill_process(Pid::from_child(&child), signal).expect("a signal is sent");
        let output = child.wait_with_output().expect("it ends");
        assert_eq!(output.status.code(), code, "{name}: {}", stderr(&output));
        let before = statuses(&scratch.out(name));
        let done = before.iter().filter(|status| *status == "done").count();
        assert!(before.iter().all(|status| status == "done" || status == "pending"), "{name}: {before:?}");
        assert!((1..4).contains(&done), "{name}: {before:?}");
        if code.is_some() {
            let message = stderr(&output);
            assert!(
                message.contains(&format!("with {} cases to go", 4 - done)) && message.contains("with --resume"),
                "{message}"
            );
        }
        let (ended, id) =
            before.iter().zip(["c0001", "c0002", "c0003", "c0004"]).find(|(status, _)| *status == "done").expect("one");
        let summary = scratch.case(name, id).summary();
        let written = fs::metadata(&summary).and_then(|file| file.modified()).expect("a summary");

        // A killed program may have finished a case that the table does not know of yet.
        let unfinished =
            ["c0001", "c0002", "c0003", "c0004"].into_iter().filter(|id| scratch.case(name, id).checkpoint().exists()).count();
        let output = scratch.ends_with(0, name, &["--threads", "2", "--resume", "-v"]);
        assert!(stderr(&output).contains(" done and 0 failed before; "), "{}", stderr(&output));
        // An interrupted case goes on from where it was.
        assert_eq!(stderr(&output).matches(": resumed after step ").count(), unfinished, "{name}: {}", stderr(&output));
        assert_eq!(timeless(rows(&scratch.out(name))), timeless(rows(&scratch.out("whole"))), "{name}, {ended}");
        assert_eq!(fs::metadata(&summary).and_then(|file| file.modified()).expect("a summary"), written, "{name}");
        for id in ["c0001", "c0002", "c0003", "c0004"] {
            assert_eq!(history(&scratch.case(name, id)), history(&scratch.case("whole", id)), "{name}, {id}");
            assert!(!scratch.case(name, id).checkpoint().exists());
        }
    }
}

#[test]
fn going_on_computes_what_is_not_the_very_case_or_has_no_summary() {
    let scratch = Scratch::new(GRID);
    scratch.ends_with(0, "out", &["-q"]);
    let whole = timeless(rows(&scratch.out("out")));
    fs::remove_file(scratch.case("out", "c0002").summary()).expect("a summary");
    let case = scratch.case("out", "c0003").case();
    let text = fs::read_to_string(&case).expect("a case");
    fs::write(&case, text.replace("friction = 0.1", "friction = 0.2")).expect("a case");
    let output = scratch.ends_with(0, "out", &["--resume", "--threads", "2"]);
    assert!(stderr(&output).contains("; 2 done and 0 failed before; 2 to compute"), "{}", stderr(&output));
    assert_eq!(timeless(rows(&scratch.out("out"))), whole);
    assert_eq!(fs::read_to_string(&case).expect("a case"), text);

    // Another study has no business there, and only by force it takes the place.
    let changed = format!("{}{GRID}", BASE.replace("poissons_ratio = 0.3", "poissons_ratio = 0.29"));
    fs::write(scratch.out("study.toml"), changed).expect("the study");
    for options in [&["--resume"][..], &["--shard", "1/2"]] {
        let output = scratch.ends_with(2, "out", options);
        let message = stderr(&output);
        assert!(
            message.contains("holds another study") && message.contains("none of its results is of a case of this one"),
            "{message}"
        );
    }
    let output = scratch.ends_with(2, "out", &[]);
    let message = stderr(&output);
    assert!(message.contains("holds a study of which 4 cases are done") && message.contains("--force replaces it"), "{message}");
    assert_eq!(timeless(rows(&scratch.out("out"))), whole);
    scratch.ends_with(0, "out", &["-q", "--force"]);
    assert_eq!(rows(&scratch.out("out"))[0]["nu"], "0.29");
}

#[test]
fn a_grid_that_has_grown_keeps_what_it_has() {
    let scratch = Scratch::new(GRID);
    scratch.ends_with(0, "out", &["-q"]);
    let before = rows(&scratch.out("out"));
    let written = |id: &str| fs::metadata(scratch.case("out", id).summary()).and_then(|file| file.modified()).expect("a summary");
    let times: Vec<_> = ["c0001", "c0002", "c0003", "c0004"].map(written).into();
    // Two values more: the numbers of the grid are others now.
    let grown = GRID.replace("[0.1, \"stick\"]", "[0.05, 0.1, \"stick\"]").replace("[400.0, 1600.0]", "[400.0, 800.0, 1600.0]");
    fs::write(scratch.out("study.toml"), format!("{BASE}{grown}")).expect("the study");
    let output = scratch.ends_with(0, "out", &["--resume"]);
    assert!(stderr(&output).contains("; 4 done and 0 failed before; 5 to compute"), "{}", stderr(&output));
    assert!(!stderr(&output).contains("do not belong"), "{}", stderr(&output));
    let after = rows(&scratch.out("out"));
    assert_eq!(after.len(), 9);
    for row in &after {
        let (stress, friction) = (&row["material.hardening.yield_stress"], &row["contact.friction"]);
        let old =
            before.iter().find(|old| (&old["material.hardening.yield_stress"], &old["contact.friction"]) == (stress, friction));
        // The very row, times and all.
        assert!(old.is_none_or(|old| old == row), "{old:?} {row:?}");
        let case = Case::load(&scratch.out("out").join(&row["directory"]).join("case.toml"), &[]).expect("a case");
        assert_eq!(case.material.hardening.yield_stress(200e3), stress.parse().ok());
        assert_eq!((row["status"].as_str(), row["case"].len()), ("done", 5));
    }
    assert_eq!(["c0001", "c0002", "c0003", "c0004"].map(written).to_vec(), times);
    let output = scratch.ends_with(0, "out", &["--resume"]);
    assert!(stderr(&output).contains("; 9 done and 0 failed before; 0 to compute"), "{}", stderr(&output));
    assert_eq!(rows(&scratch.out("out")), after);

    // A value less: what belongs to the study no more is named and stays.
    fs::write(scratch.out("study.toml"), format!("{BASE}{}", grown.replace("0.05, ", "").replace("1600.0", "3200.0")))
        .expect("the study");
    let kept = after.iter().filter(|row| row["contact.friction"] == "0.05" || row["material.hardening.yield_stress"] == "1600.0");
    let kept: Vec<PathBuf> = kept.map(|row| scratch.out("out").join(&row["directory"]).join("history.csv")).collect();
    assert_eq!(kept.len(), 5);
    let output = scratch.ends_with(0, "out", &["--resume"]);
    let message = stderr(&output);
    assert!(message.contains("; 4 done and 0 failed before; 2 to compute"), "{message}");
    assert!(message.contains("5 of the cases in ") && message.contains("are left as they are: cases/c000"), "{message}");
    assert!(kept.iter().all(|path| path.exists()) && rows(&scratch.out("out")).len() == 6);
}

#[test]
fn what_a_study_leaves_that_was_killed_at_its_first_file_is_no_hindrance() {
    let scratch = Scratch::new(GRID);
    fs::create_dir(scratch.out("out")).expect("a directory");
    fs::write(scratch.out("out").join(".study.csv.4711.tmp"), "").expect("a draft");
    let lock = scratch.out("out").join(".asperity.lock");
    fs::write(&lock, "process 4711 on node7\n").expect("a lock");
    let hour_ago = std::time::SystemTime::now() - Duration::from_secs(3600);
    fs::File::options().write(true).open(&lock).and_then(|file| file.set_modified(hour_ago)).expect("a time");
    scratch.ends_with(0, "out", &["-q", "--resume"]);
    assert_eq!(statuses(&scratch.out("out")), ["done"; 4]);
}

#[test]
fn directories_of_shares_are_merged_and_what_is_missing_is_said() {
    let scratch = Scratch::new(GRID);
    scratch.ends_with(0, "whole", &["-q"]);
    scratch.ends_with(0, "a", &["-q", "--shard", "1/3"]);
    scratch.ends_with(0, "b", &["-q", "--shard", "2/3"]);
    let merge = |sources: &[&str], out: &str| {
        let mut command = Command::new(assert_cmd::cargo::cargo_bin!("asperity"));
        command.arg("study").arg("--merge").args(sources.iter().map(|name| scratch.out(name))).arg("--out").arg(scratch.out(out));
        command.output().expect("the program runs")
    };
    let output = merge(&["a", "b"], "all");
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(75), "{message}");
    let missing: Vec<String> =
        rows(&scratch.out("all")).iter().filter(|row| row["status"] == "pending").map(|row| row["case"].clone()).collect();
    assert!(!missing.is_empty() && missing.len() < 4);
    assert!(message.contains(&format!("error: {} of 4 cases are missing: {} (material", missing.len(), missing[0])), "{message}");
    scratch.ends_with(0, "c", &["-q", "--shard", "3/3"]);
    let output = merge(&["all", "c"], "all");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(
        stdout(&output).starts_with(&format!("4 done, 0 failed, 0 missing; {} cases copied", missing.len())),
        "{}",
        stdout(&output)
    );
    assert_eq!(timeless(rows(&scratch.out("all"))), timeless(rows(&scratch.out("whole"))));
    for id in ["c0001", "c0002", "c0003", "c0004"] {
        assert_eq!(history(&scratch.case("all", id)), history(&scratch.case("whole", id)), "{id}");
        assert_eq!(scratch.case("all", id).contact_steps().expect("tables").len(), 2);
    }
    // Another study, and what is none.
    fs::write(scratch.out("study.toml"), format!("{BASE}{}", GRID.replace("0.1", "0.2"))).expect("the study");
    scratch.ends_with(0, "other", &["-q"]);
    fs::create_dir(scratch.out("none")).expect("a directory");
    for (wrong, part) in [("other", "Merge directories of one study"), ("none", "is not a study")] {
        let output = merge(&["a", wrong], "new");
        assert_eq!(output.status.code(), Some(2));
        assert!(stderr(&output).contains(part) && !scratch.out("new").exists(), "{}", stderr(&output));
    }
}

#[test]
fn scripts_for_slurm_are_written_and_nothing_is_computed() {
    let scratch = Scratch::new(GRID);
    let output = scratch.ends_with(0, "out", &["--slurm", "tasks=2", "time=00:10:00"]);
    assert!(stdout(&output).contains("2 tasks; to submit them: bash "), "{}", stdout(&output));
    let tasks = fs::read_to_string(scratch.out("out/slurm/tasks.sh")).expect("a script");
    for part in ["#SBATCH --array=1-2\n", "#SBATCH --time=00:10:00\n", "--device=cpu", "--shard \"$share\" --resume"] {
        assert!(tasks.contains(part), "{part}: {tasks}");
    }
    assert_eq!(statuses(&scratch.out("out")), ["pending"; 4]);
    let output = scratch.ends_with(2, "out", &["--slurm", "array=1-2"]);
    assert!(stderr(&output).starts_with("error: --slurm array=1-2: is unknown"), "{}", stderr(&output));
    // A task as Slurm runs it, with a scheduler that has nothing to do.
    for task in ["1", "2"] {
        let output = Command::new("bash")
            .arg(scratch.out("out/slurm/tasks.sh"))
            .env("SLURM_ARRAY_TASK_ID", task)
            .output()
            .expect("bash runs");
        assert_eq!(output.status.code(), Some(0), "{}{}", stdout(&output), stderr(&output));
    }
    let output = Command::new("bash").arg(scratch.out("out/slurm/table.sh")).output().expect("bash runs");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(statuses(&scratch.out("out")), ["done"; 4]);
}

#[test]
fn a_directory_of_the_users_is_never_touched() {
    let scratch = Scratch::new(GRID);
    fs::create_dir(scratch.out("mine")).expect("a directory");
    fs::write(scratch.out("mine").join("notes.txt"), "mine").expect("a file");
    for options in [&[][..], &["--resume"], &["--shard", "1/2"]] {
        let output = scratch.ends_with(2, "mine", options);
        let message = stderr(&output);
        assert!(
            message.contains("holds \"notes.txt\", and is not an Asperity study") && message.lines().count() == 1,
            "{message}"
        );
    }
    assert_eq!(fs::read_dir(scratch.out("mine")).expect("a directory").count(), 1);
}

/// File in `fixtures/studies/bad`, line, key, what is wrong, what is allowed (a part of each).
#[rustfmt::skip]
const MISTAKES: &[(&str, usize, &str, &str, &str)] = &[
    ("base-mistake", 10, "contact.friction", "is -0.3", "a number >= 0, or \"stick\""),
    ("base-missing", 1, "base", "missing", "[base.sphere]"),
    ("case", 1, "sphere", "unknown key", "base, grid"),
    ("combination", 17, "path.1.shear", "never reaches", "(in the combination contact.friction = stick, path.1.shear = full-slip; 1 of 4 combinations are refused)"),
    ("grid-empty", 15, "grid", "is empty", "dotted keys of the case"),
    ("grid-empty-list", 16, "grid.contact.friction", "is an empty list", "a list of values"),
    ("grid-hardening", 18, "material.hardening.coefficient", "missing", "(in the combination material.hardening = { exponent = 4.0, law = \"hollomon\" }; 1 of 2"),
    ("grid-index", 16, "grid.path.7.indentation", "`path` has 2 items", "a dotted key of the case"),
    ("grid-key", 16, "contact.frictoin", "unknown key, did you mean `friction`?", "Allowed: friction"),
    ("grid-key-not-there", 16, "grid.contact.friction.static", "it has no key `static`", "a dotted key of the case"),
    ("grid-key-twice", 17, "grid.contact.friction", "is there twice", "each key once"),
    ("grid-missing", 1, "grid", "missing", "dotted keys of the case"),
    ("grid-no-list", 16, "grid.contact.friction", "is the number 0.1, which is the wrong type", "a list of values"),
    ("grid-range", 17, "contact.friction", "is -0.3", "path.0.indentation = 0.01, contact.friction = -0.3; 2 of 4"),
    ("grid-table", 16, "contacts", "unknown key, did you mean `contact`?", "sphere, material, contact"),
    ("grid-twice", 16, "grid.contact.friction", "has the value 0.1 twice", "each value once"),
    ("grid-type", 18, "contact.friction", "is the boolean true, which is the wrong type", "contact.friction = true; 1 of 2"),
    ("syntax", 16, "", "not valid TOML", ""),
    ("too-many", 16, "grid", "has more than 100000 combinations", "fewer values"),
];

#[test]
fn every_mistake_in_a_study_file_ends_with_2_and_is_named() {
    let scratch = tempfile::tempdir().expect("a scratch directory");
    let out = scratch.path().join("out");
    for (name, line, key, what, allowed) in MISTAKES {
        let file = format!("fixtures/studies/bad/{name}.toml");
        let arguments: [&[&str]; 2] = [&["study", &file, "--out", &out.to_string_lossy()], &["check", &file]];
        for arguments in arguments {
            let output = Command::new(assert_cmd::cargo::cargo_bin!("asperity")).args(arguments).output().expect("it runs");
            let message = stderr(&output);
            assert_eq!(output.status.code(), Some(2), "{name}: {message}");
            let key = if key.is_empty() { String::new() } else { format!("{key}: ") };
            // Those that do not look like a study at all are told what a case lacks.
            if arguments[0] == "study" {
                assert!(message.starts_with(&format!("error: {file}:{line}: {key}")), "{name}: {message}");
                assert!(message.contains(what) && message.contains(allowed), "{name}: {message}");
            }
            assert_eq!(message.matches("error: ").count(), 1, "{name}: {message}");
        }
        assert!(!out.exists(), "{name}");
    }
    let files = fs::read_dir("fixtures/studies/bad").expect("the fixtures").count();
    assert_eq!(files, MISTAKES.len(), "each bad study is in the list");
}

#[test]
fn check_tells_how_many_cases_and_shows_the_first() {
    for (name, size) in [("small", "# 27 cases: "), ("wear-2014", "# 240 cases: material.hardening (15) x ")] {
        let file = format!("fixtures/studies/{name}.toml");
        let output = Command::new(assert_cmd::cargo::cargo_bin!("asperity")).args(["check", &file]).output().expect("it runs");
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let printed = stdout(&output);
        assert!(printed.starts_with(size), "{printed}");
        let first = Case::parse(&printed, "printed", &[]).expect("what was printed is a case");
        assert!(!first.output.plots);
        let set = ["check", file.as_str(), "--set", "contact.friction=0.1"];
        let output = Command::new(assert_cmd::cargo::cargo_bin!("asperity")).args(set).output().expect("it runs");
        assert_eq!(output.status.code(), Some(2));
        assert!(stderr(&output).contains("is a study"), "{}", stderr(&output));
    }
}

#[test]
fn cases_of_one_mesh_share_a_device_and_give_the_same_forces() {
    let Some(context) = device::device("study", Precision::F64) else { return };
    // Solved tightly: at the default tolerance Newton may end at another iterate.
    let grid = GRID.replace("[grid]", "[grid]\n\"path.1.shear\" = [0.0003]\n\"solver.tolerance\" = [1e-7]");
    let scratch = Scratch::new(&grid);
    scratch.ends_with(0, "cpu", &["-q"]);
    let output = scratch.ends_with(0, "gpu", &["--device", "gpu", "--precision", "f64", "--threads", "2"]);
    assert!(stderr(&output).contains("4 to compute, 4 at a time"), "{}", stderr(&output));
    for (ours, reference) in rows(&scratch.out("gpu")).iter().zip(rows(&scratch.out("cpu"))) {
        assert_eq!(ours["status"], "done");
        let out = scratch.case("gpu", &ours["case"]);
        assert!(Summary::read(&out.summary()).expect("a summary").device.contains(&context.adapter().name));
        for name in ["F_N0", "F_T_max", "a0"] {
            let number = |row: &Row| row[name].parse::<f64>().expect("a number");
            let ratio = number(ours) / number(&reference);
            assert!((ratio - 1.0).abs() < 1e-6, "{}: {name}: {ratio}", ours["case"]);
        }
    }
}

#[test]
#[cfg(target_os = "linux")]
fn a_device_that_is_not_there_ends_with_2_before_anything_is_written() {
    let scratch = Scratch::new(GRID);
    let nothing = [("VK_DRIVER_FILES", "/dev/null"), ("VK_ICD_FILENAMES", "/dev/null")];
    let output = scratch.command("out", &["--device", "gpu"]).envs(nothing).output().expect("it runs");
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).starts_with("error: --device gpu: no GPU found"), "{}", stderr(&output));
    assert!(!scratch.out("out").exists());
}
