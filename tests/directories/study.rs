//! The directory of a study.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant, SystemTime};

use asperity::output::OutputDirectory;
use asperity::study::{EarlierStudy, Study, StudyDirectory};

use super::common::{files, program, stderr, stdout};
use tempfile::TempDir;

/// A fraction of a second a case.
pub const BASE: &str = r#"
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
const ONE: &str = "[grid]\n\"contact.friction\" = [0.1, 0.2, 0.4]\n";
const ANOTHER: &str = "[grid]\n\"contact.friction\" = [0.15, 0.25, 0.45]\n";
/// Cases of some seconds.
const SLOW: &str = "[grid]\n\"contact.friction\" = [0.1, 0.2, 0.4]\n\"solver.press_steps\" = [400]\n";
/// Does not converge.
const FAILING: &str = "[grid]\n\"solver.max_iterations\" = [1]\n\"solver.max_cutbacks\" = [0]\n";

pub struct Scratch(TempDir);

impl Scratch {
    pub fn new() -> Self {
        Self(tempfile::tempdir().expect("a scratch directory"))
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn command(&self, grid: &str, out: &str, options: &[&str]) -> Command {
        let file = self.path("study.toml");
        fs::write(&file, format!("{BASE}{grid}")).expect("the study");
        let mut command = program();
        command.arg("study").arg(file).arg("--out").arg(self.path(out)).args(["--device", "cpu"]).args(options);
        command
    }

    pub fn ends_with(&self, code: i32, grid: &str, out: &str, options: &[&str]) -> Output {
        let output = self.command(grid, out, options).output().expect("the program runs");
        assert_eq!(output.status.code(), Some(code), "{options:?}: {}{}", stdout(&output), stderr(&output));
        output
    }

    /// Starts a slow study, and waits until it computes.
    pub fn started(&self, grid: &str, out: &str, options: &[&str], environment: &[(&str, &Path)]) -> Child {
        let mut command = self.command(grid, out, &[&["-q", "--threads", "1"], options].concat());
        command.envs(environment.iter().copied());
        let child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("the program runs");
        let (begun, cases) = (Instant::now(), self.path(out).join("cases"));
        let rows =
            |case: fs::DirEntry| fs::read_to_string(case.path().join("history.csv")).map_or(0, |text| text.lines().count());
        while !fs::read_dir(&cases).is_ok_and(|cases| cases.flatten().any(|case| rows(case) > 3)) {
            assert!(begun.elapsed() < Duration::from_secs(120), "no steps");
            std::thread::sleep(Duration::from_millis(2));
        }
        child
    }
}

pub fn statuses(dir: &Path) -> Vec<String> {
    let mut table = csv::Reader::from_path(dir.join("study.csv")).expect("a table");
    table.records().map(|row| row.expect("a row")[2].to_owned()).collect()
}

fn kill(mut child: Child) {
    child.kill().expect("killed");
    child.wait().expect("it ends");
}

#[cfg(unix)]
#[test]
fn a_folder_of_a_study_that_is_a_link_is_refused_and_what_it_leads_to_stays() {
    let scratch = Scratch::new();
    scratch.ends_with(0, ONE, "mine", &["-q"]);
    let mine = files(&scratch.path("mine"));
    let links = [("cases", "mine/cases"), ("plots", "mine"), ("slurm", "mine"), ("cases/c0003", "mine/cases/c0003")];
    for (link, leads_to) in links.into_iter().chain([("cases/c0002/contact", "mine/cases/c0001/contact")]) {
        scratch.ends_with(0, ONE, "out", &["-q", "--force"]);
        let path = scratch.path("out").join(link);
        if path.exists() {
            fs::remove_dir_all(&path).expect("removed");
        }
        std::os::unix::fs::symlink(scratch.path(leads_to), &path).expect("a link");
        let before = files(&scratch.path("out"));
        for (grid, options) in [
            (ANOTHER, &["--force"][..]),
            (ONE, &["--force"]),
            (ONE, &["--resume"]),
            (ONE, &["--shard", "1/2"]),
            (ONE, &["--slurm"]),
        ] {
            let message = stderr(&scratch.ends_with(2, grid, "out", options));
            assert!(message.contains(&format!("out/{link}: is a link")) && message.lines().count() == 1, "{message}");
            assert!(files(&scratch.path("out")) == before && files(&scratch.path("mine")) == mine, "{link} {options:?}");
        }
        fs::remove_file(&path).expect("removed");
    }
}

#[test]
fn results_that_are_not_done_are_discarded_by_force_alone() {
    let scratch = Scratch::new();
    scratch.ends_with(3, FAILING, "failed", &["-q"]);
    kill(scratch.started(SLOW, "killed", &[], &[]));
    for (out, what, shard) in [
        ("failed", "0 cases are done, 1 failed or did not converge", FAILING),
        ("killed", "0 cases are done, 1 unfinished", SLOW),
    ] {
        // Of the lock that was left, nothing is changed either.
        let before = files(&scratch.path(out));
        for (grid, options) in [(ANOTHER, &[][..]), (shard, &[]), (shard, &["--shard", "1/1"])] {
            let message = stderr(&scratch.ends_with(2, grid, out, options));
            let parts = [format!("holds a study of which {what}."), "--force replaces it".to_owned()];
            assert!(parts.iter().all(|part| message.contains(part)), "{message}");
            let mut after = files(&scratch.path(out));
            after.extend(
                before.iter().filter(|(name, _)| name.contains(".asperity.")).map(|(name, text)| (name.clone(), text.clone())),
            );
            assert!(after == before, "{out} {options:?}");
        }
        scratch.ends_with(0, ANOTHER, out, &["-q", "--force"]);
    }
}

#[test]
fn of_two_studies_in_one_directory_one_is_refused() {
    let scratch = Scratch::new();
    let child = scratch.started(SLOW, "out", &[], &[]);
    let process = child.id();
    for (grid, options, what) in [
        (ANOTHER, &[][..], "another study"),
        (ANOTHER, &["--force"], "another study"),
        (ANOTHER, &["--resume"], "another study"),
        (ANOTHER, &["--shard", "1/2"], "another study"),
        (ANOTHER, &["--slurm"], "another study"),
        (SLOW, &[], "this study"),
        (SLOW, &["--force"], "this study"),
    ] {
        let message = stderr(&scratch.ends_with(2, grid, "out", options));
        assert!(message.contains(&format!("is being written by process {process} on ")), "{message}");
        assert!(message.contains(&format!(", which computes {what}. Wait")) && message.lines().count() == 1, "{message}");
    }
    let text = fs::read_to_string(scratch.path("out/study.toml")).expect("a study");
    assert_eq!(text, format!("{BASE}{SLOW}"));
    kill(child);
    // What a killed one leaves is no hindrance.
    scratch.ends_with(0, ANOTHER, "out", &["-q", "--force"]);
    assert_eq!(statuses(&scratch.path("out")), ["done"; 3]);
    assert!(!files(&scratch.path("out")).keys().any(|name| name.contains(".asperity.")));
}

#[test]
fn two_studies_that_start_together_are_never_mixed() {
    let scratch = Scratch::new();
    // Long enough that neither ends before the other comes.
    let grids = [ONE, ANOTHER].map(|grid| format!("{grid}\"solver.press_steps\" = [60]\n"));
    for _ in 0..4 {
        let starts = [0, 1].map(|number| {
            let grid = &grids[number];
            // Each of its own file: the second start must not change the first one's.
            let file = scratch.path(["one.toml", "another.toml"][number]);
            fs::write(&file, format!("{BASE}{grid}")).expect("the study");
            let mut command = program();
            command.arg("study").arg(file).arg("--out").arg(scratch.path("out")).args([
                "--device",
                "cpu",
                "-q",
                "--threads",
                "1",
            ]);
            command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("the program runs")
        });
        let processes = [0, 1].map(|number: usize| starts[number].id());
        let ended = starts.map(|child| child.wait_with_output().expect("it ends"));
        let codes: Vec<_> = ended.iter().map(|output| output.status.code()).collect();
        let winner = codes.iter().position(|code| *code == Some(0)).unwrap_or_else(|| panic!("{codes:?}"));
        let message = stderr(&ended[1 - winner]);
        assert_eq!(codes[1 - winner], Some(2), "{message}");
        let holder = format!("is being written by process {} on ", processes[winner]);
        let parts = [&holder, ", which computes another study. Wait", "(nothing was changed)"];
        assert!(parts.iter().all(|part| message.contains(part)) && message.lines().count() == 1, "{message}");
        let expected = format!("{BASE}{}", grids[winner]);
        assert_eq!(fs::read_to_string(scratch.path("out/study.toml")).expect("a study"), expected);
        assert_eq!(statuses(&scratch.path("out")), ["done"; 3]);
        fs::remove_dir_all(scratch.path("out")).expect("removed");
    }
}

#[test]
fn shares_of_one_study_are_computed_side_by_side() {
    let scratch = Scratch::new();
    // The file is written before any of them reads it.
    let commands = ["1/3", "2/3", "3/3"].map(|number| scratch.command(ONE, "out", &["-q", "--threads", "1", "--shard", number]));
    let share = |mut command: Command| command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("the program runs");
    let shares = commands.map(share);
    for child in shares {
        let output = child.wait_with_output().expect("it ends");
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    }
    let output = program().args(["study", "--merge"]).arg(scratch.path("out")).arg("--out").arg(scratch.path("out")).output();
    assert_eq!(output.expect("the program runs").status.code(), Some(0));
    assert_eq!(statuses(&scratch.path("out")), ["done"; 3]);
    assert!(!files(&scratch.path("out")).keys().any(|name| name.contains(".asperity.")));

    // While a study goes on, the same may be joined.
    let child = scratch.started(SLOW, "slow", &["--shard", "1/3"], &[]);
    let merged = program().args(["study", "--merge"]).arg(scratch.path("slow")).arg("--out").arg(scratch.path("slow")).output();
    assert_eq!(merged.expect("the program runs").status.code(), Some(75));
    kill(child);
}

#[test]
fn a_case_whose_history_is_missing_or_cut_is_computed_again() {
    let scratch = Scratch::new();
    scratch.ends_with(0, ONE, "out", &["-q"]);
    let whole = fs::read_to_string(scratch.path("out/cases/c0002/history.csv")).expect("a history");
    let history = scratch.path("out/cases/c0002/history.csv");
    let rows: Vec<&str> = whole.split_inclusive('\n').collect();
    let damages = [None, Some(String::new()), Some(rows[0].to_owned()), Some(rows[..4].concat())];
    for text in damages.into_iter().chain([Some(whole[..whole.len() - 9].to_owned())]) {
        match &text {
            None => fs::remove_file(&history).expect("removed"),
            Some(text) => fs::write(&history, text).expect("written"),
        }
        let output = scratch.ends_with(0, ONE, "out", &["--resume"]);
        assert!(stderr(&output).contains("; 2 done and 0 failed before; 1 to compute"), "{text:?}: {}", stderr(&output));
        assert_eq!(fs::read_to_string(&history).expect("a history"), whole);
    }
}

#[test]
fn a_study_whose_directory_is_moved_away_ends_and_does_not_make_it_again() {
    let scratch = Scratch::new();
    let child = scratch.started(SLOW, "out", &[], &[]);
    fs::rename(scratch.path("out"), scratch.path("away")).expect("moved");
    let output = child.wait_with_output().expect("it ends");
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(3), "{message}");
    assert!(message.contains("out: was removed or replaced while the run went on"), "{message}");
    assert!(!scratch.path("out").exists());
    // Where it was moved to it goes on.
    scratch.ends_with(0, SLOW, "away", &["-q", "--resume"]);
    assert_eq!(statuses(&scratch.path("away")), ["done"; 3]);
}

#[test]
fn a_study_is_replaced_as_a_whole_or_not_at_all() {
    let scratch = Scratch::new();
    scratch.ends_with(0, ONE, "out", &["-q"]);
    let lock = scratch.path("out/cases/c0003/.asperity.lock");
    fs::write(&lock, "process 4711 on node7\n").expect("a lock");
    let before = files(&scratch.path("out"));
    let message = stderr(&scratch.ends_with(2, ANOTHER, "out", &["--force"]));
    for part in ["out/cases/c0003: is being written by process 4711 on node7", "(nothing was changed)"] {
        assert!(message.contains(part), "{message}");
    }
    assert!(files(&scratch.path("out")) == before, "{:?}", files(&scratch.path("out")).keys());
    fs::remove_file(&lock).expect("removed");
    if !cfg!(unix) {
        return;
    }
    // More cases than files that may be open.
    let case = fs::read(scratch.path("out/cases/c0001/case.toml")).expect("a case");
    for number in 4..120 {
        let dir = scratch.path(&format!("out/cases/c{number:04}"));
        fs::create_dir(&dir).expect("a directory");
        fs::write(dir.join("case.toml"), &case).expect("a case");
    }
    let study = scratch.command(ANOTHER, "out", &["-q", "--force"]);
    let mut limited = Command::new("sh");
    limited.args(["-c", "ulimit -n 64; exec \"$0\" \"$@\""]).arg(study.get_program()).args(study.get_args());
    let output = limited.output().expect("the program runs");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(fs::read_dir(scratch.path("out/cases")).expect("cases").count(), 3);
    assert!(!files(&scratch.path("out")).keys().any(|name| name.contains(".asperity.")));
}

#[test]
fn drafts_that_come_and_go_while_a_directory_is_cleared_are_no_fault() {
    let scratch = Scratch::new();
    let study = Study::parse(&format!("{BASE}{ONE}"), "study.toml").expect("a study");
    let (root, run) = (scratch.path("out"), scratch.path("run"));
    let (directory, out) = (StudyDirectory::new(&root), OutputDirectory::create(&run).expect("a directory"));
    fs::create_dir(&root).expect("a directory");
    // One who waits has it just now.
    let young = [root.join("..asperity.lock.4711.tmp"), run.join("..asperity.lock.4711.tmp")];
    young.iter().for_each(|path| fs::write(path, "process 4711 on node7\n").expect("a draft"));
    let cleared = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            let drafts = [root.join(".study.csv.1.tmp"), root.join("..asperity.lock.1.tmp"), run.join(".summary.json.1.tmp")];
            while !cleared.load(Ordering::Relaxed) {
                for path in &drafts {
                    fs::write(path, "").expect("a draft");
                    let _ = fs::remove_file(path);
                }
            }
        });
        let clear = || {
            for _ in 0..1000 {
                directory.prepare(&study, EarlierStudy::Replace).map_err(|error| error.to_string())?;
                out.clear().map_err(|error| error.to_string())?;
            }
            Ok::<(), String>(())
        };
        let done = clear();
        cleared.store(true, Ordering::Relaxed);
        done.expect("cleared");
    });
    assert!(young.iter().all(|path| path.exists()));
    let hour_ago = SystemTime::now() - Duration::from_secs(3600);
    for path in &young {
        fs::File::options().write(true).open(path).and_then(|file| file.set_modified(hour_ago)).expect("a time");
    }
    directory.prepare(&study, EarlierStudy::Replace).expect("cleared");
    out.clear().expect("cleared");
    assert!(!young.iter().any(|path| path.exists()));
}
