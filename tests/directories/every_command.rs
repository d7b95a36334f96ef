//! Every command of the program, from its own definition of the command line, against the rules of
//! what it writes: a command without an entry here fails.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::Output;

use super::common::{program, stderr, stdout};

/// What a command leaves behind.
enum Writes {
    /// It prints, and has no option that names a file or a directory to be written.
    Nothing,
    /// It is run with these arguments in a folder with the fixtures of [`folder`]. Each of the
    /// files is one that it would write; where it holds something of the user's, the command must
    /// end with 2 and leave it.
    Files { arguments: &'static [&'static str], files: &'static [&'static str] },
}
use Writes::{Files, Nothing};

const RUN: &[&str] = &["run", "case.toml", "--out", "run", "--force", "--device", "cpu", "-q"];
const STUDY: &[&str] = &["study", "study.toml", "--out", "study", "--force", "--device", "cpu", "-q"];
const TABULATE: &[&str] = &["law", "tabulate", "case.toml", "--out", "study", "--force", "--elements", "4", "--device", "cpu"];

/// The commands, as they are typed.
const COMMANDS: &[(&str, Writes)] = &[
    // The user names the very file, and --force says that it is to be replaced: without it nothing
    // is.
    ("init", Files { arguments: &["init", "mine"], files: &["mine.toml"] }),
    ("explain", Nothing),
    ("check", Nothing),
    (
        "run",
        Files {
            arguments: RUN,
            files: &[
                "run/run.log",
                "run/history.csv",
                "run/summary.json",
                "run/plots/forces.svg",
                "run/fields/step_0001.vtu",
                "run/contact/step_0001.csv",
                "run/case.toml",
            ],
        },
    ),
    (
        "study",
        Files {
            arguments: STUDY,
            files: &["study/plots/cases.svg", "study/report.html", "study/cases/c0001/history.csv", "study/cases/c0001/run.log"],
        },
    ),
    ("plot", Files { arguments: &["plot", "run"], files: &["run/plots/forces.svg"] }),
    ("compare", Files { arguments: &["compare", "run", "study/cases/c0001", "--out", "both.svg"], files: &["both.svg"] }),
    ("law fit", Files { arguments: &["law", "fit", "study"], files: &["study/law.json"] }),
    ("law tabulate", Files { arguments: TABULATE, files: &["study/law.json", "study/tabulated.svg"] }),
    (
        "law compose",
        Files { arguments: &["law", "compose", "case.toml", "built-in", "--out", "made", "--force"], files: &["made/law.json"] },
    ),
    ("law predict", Nothing),
    (
        "law check",
        Files {
            arguments: &["law", "check", "law.json", "case.toml", "--out", "curves", "--elements", "4"],
            files: &["curves/the-case-coefficient-0.3-shear.csv"],
        },
    ),
    (
        "law export",
        Files {
            arguments: &["law", "export", "built-in", "case.toml", "--format", "c", "--out", "export"],
            files: &["export/asperity_law.h", "export/law.asperity", "export/asperity_law_vectors.csv"],
        },
    ),
    ("explore", Nothing),
    ("verify", Files { arguments: &["verify", "--only", "hertz", "--out", "verify.json"], files: &["verify.json"] }),
    ("devices", Nothing),
    ("bench", Files { arguments: &["bench", "--quick", "--device", "cpu", "--out", "bench.json"], files: &["bench.json"] }),
    ("prove", Files { arguments: &["prove", "--quick", "--out", "prove.json"], files: &["prove.json", "prove.md"] }),
    ("point", Nothing),
    ("schema", Nothing),
    ("completions", Nothing),
    ("man", Files { arguments: &["man", "pages"], files: &["pages/asperity-run.1"] }),
];

/// Those whose refusal comes after minutes of work are looked at by their source alone: they write
/// through the same function.
const LONG: [&str; 3] = ["law check", "verify", "bench"];

/// The names of all commands, and of the options of each that name something to be written.
fn defined(command: &clap::Command, above: &str) -> Vec<(String, bool)> {
    let mut found = Vec::new();
    for command in command.get_subcommands().filter(|command| command.get_name() != "help") {
        let name = format!("{above}{}", command.get_name());
        if command.has_subcommands() {
            found.extend(defined(command, &format!("{name} ")));
        } else {
            let writes = command.get_arguments().any(|argument| matches!(argument.get_id().as_str(), "out" | "force"));
            found.push((name, writes));
        }
    }
    found
}

#[test]
fn every_command_has_an_entry_and_none_writes_unnoticed() {
    let defined = defined(&asperity::internals::cli::command(), "");
    let listed: BTreeSet<&str> = COMMANDS.iter().map(|(name, _)| *name).collect();
    let there: BTreeSet<&str> = defined.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(listed, there, "a command without an entry, or an entry without a command");
    for (name, writes) in &defined {
        let entry = COMMANDS.iter().find(|(listed, _)| listed == name).map(|(_, writes)| writes);
        assert!(!writes || matches!(entry, Some(Files { .. })), "{name} has --out or --force, and no files in its entry");
    }
}

const CASE: &str = include_str!("case.toml");
const GRID: &str = "[grid]\n\"contact.friction\" = [0.1, 0.3]\n";

fn asperity(dir: &Path, arguments: &[&str]) -> Output {
    program().args(arguments).current_dir(dir).output().expect("the program runs")
}

/// A case, a study, and a result of each.
fn folder() -> tempfile::TempDir {
    let dir = tempfile::tempdir().expect("a scratch directory");
    fs::write(dir.path().join("case.toml"), CASE).expect("the case");
    let base: String = CASE.lines().map(|line| format!("{}\n", line.replacen("[[", "[[base.", 1))).collect();
    let base: String = base
        .lines()
        .map(|line| if line.starts_with('[') && !line.starts_with("[[") { line.replacen('[', "[base.", 1) } else { line.to_owned() } + "\n")
        .collect();
    fs::write(dir.path().join("study.toml"), base + GRID).expect("the study");
    for arguments in [RUN, STUDY] {
        let output = asperity(dir.path(), arguments);
        assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}{}", stdout(&output), stderr(&output));
    }
    dir
}

#[test]
fn a_file_of_the_users_is_never_replaced() {
    let dir = folder();
    for (name, writes) in COMMANDS.iter().filter(|(name, _)| !LONG.contains(name)) {
        let Files { arguments, files } = writes else { continue };
        for file in *files {
            let path = dir.path().join(file);
            fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
            let before = fs::read(&path).ok();
            fs::write(&path, "my own\n").expect("a file");
            let output = asperity(dir.path(), arguments);
            assert_eq!(output.status.code(), Some(2), "{name}, {file}: {}{}", stdout(&output), stderr(&output));
            assert_eq!(fs::read_to_string(&path).expect("a file"), "my own\n", "{name}, {file}");
            assert_eq!(stderr(&output).lines().count(), 1, "{name}, {file}: {}", stderr(&output));
            match before {
                Some(text) => fs::write(&path, text).expect("restored"),
                None => fs::remove_file(&path).expect("removed"),
            }
        }
    }
}

#[test]
fn the_case_that_is_read_is_never_replaced() {
    let dir = folder();
    let resolved = fs::read_to_string(dir.path().join("run/case.toml")).expect("a case");
    // A resolved case that was copied and changed, beside files of the user's.
    fs::create_dir_all(dir.path().join("work/plots")).expect("a folder");
    let mine = resolved.replacen("friction = 0.3", "friction = 0.2 # mine", 1);
    assert_ne!(mine, resolved);
    for (name, text) in [("case.toml", mine.as_str()), ("run.log", "mine"), ("plots/forces.svg", "mine")] {
        fs::write(dir.path().join("work").join(name), text).expect("a file");
    }
    for options in [&[][..], &["--force"], &["--resume"]] {
        for case in ["case.toml", "../case.toml"] {
            let arguments = [&["run", case, "--out", ".", "--device", "cpu", "-q"], options].concat();
            let output = asperity(&dir.path().join("work"), &arguments);
            assert_eq!(output.status.code(), Some(2), "{arguments:?}: {}", stderr(&output));
        }
    }
    fs::remove_file(dir.path().join("work/run.log")).expect("removed");
    fs::remove_dir_all(dir.path().join("work/plots")).expect("removed");
    for case in ["case.toml", "../case.toml"] {
        let output = asperity(&dir.path().join("work"), &["run", case, "--out", ".", "--force", "--device", "cpu", "-q"]);
        assert_eq!(output.status.code(), Some(2), "{case}: {}", stderr(&output));
    }
    assert_eq!(fs::read_to_string(dir.path().join("work/case.toml")).expect("a case"), mine);
    // The resolved case of a result may be run again in its place.
    let output = asperity(dir.path(), &["run", "run/case.toml", "--out", "run", "--force", "--device", "cpu", "-q"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(fs::read_to_string(dir.path().join("run/case.toml")).expect("a case"), resolved);
    // A law that a fit or a table is made from.
    fs::write(dir.path().join("study/law.json"), "{\"format\": \"asperity-law\"}").expect("a law");
    for arguments in [
        &["law", "fit", "study", "--prior", "study/law.json"][..],
        &["law", "compose", "case.toml", "built-in", "study/law.json", "--out", "study", "--force"],
    ] {
        let output = asperity(dir.path(), arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {}", stderr(&output));
    }
    assert_eq!(fs::read_to_string(dir.path().join("study/law.json")).expect("a law"), "{\"format\": \"asperity-law\"}");
}

#[cfg(unix)]
#[test]
fn folders_that_are_links_are_refused_and_directories_are_locked() {
    let dir = folder();
    let path = |name: &str| dir.path().join(name);
    fs::create_dir(path("foreign")).expect("a directory");
    for (link, commands) in [
        ("run/plots", &[RUN, &["plot", "run"]][..]),
        ("study/plots", &[STUDY, TABULATE, &["plot", "study"], &["study", "--merge", "study", "--out", "study"]]),
    ] {
        let _ = fs::remove_dir_all(path(link));
        std::os::unix::fs::symlink(path("foreign"), path(link)).expect("a link");
        for arguments in commands {
            let output = asperity(dir.path(), arguments);
            assert_eq!(output.status.code(), Some(2), "{arguments:?}: {}", stderr(&output));
            assert!(stderr(&output).contains("is a link"), "{arguments:?}: {}", stderr(&output));
            assert_eq!(fs::read_dir(path("foreign")).expect("a directory").count(), 0, "{arguments:?}");
        }
        fs::remove_file(path(link)).expect("removed");
    }
    // As another host holds it.
    fs::write(path("run/.asperity.lock"), "process 4711 on node7\n").expect("a lock");
    fs::write(path("study/.asperity.study.0123456789abcdef.4711"), "process 4711 on node7\nstudy 0123456789abcdef\n")
        .expect("a lock");
    for (arguments, code) in [(RUN, 2), (STUDY, 2), (TABULATE, 2)] {
        let output = asperity(dir.path(), arguments);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {}", stderr(&output));
        let message = stderr(&output);
        assert!(message.contains("process 4711 on node7") && message.contains("start again in"), "{message}");
    }
}
