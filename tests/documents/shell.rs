//! Runs the blocks of a page that are marked `sh`, in their order, in a directory of the page's
//! own.

use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::Command;

use super::page::Page;

/// What the commands of a page find in their directory, of the repository.
const SHARED: [&str; 4] = ["fixtures", "examples", "docs", "benches"];

pub fn run(page: &Page) {
    let scratch = tempfile::tempdir().expect("a scratch directory");
    let root = std::env::current_dir().expect("the repository");
    for name in SHARED {
        symlink(root.join(name), scratch.path().join(name)).expect("a link");
    }
    let mut printed = String::new();
    for block in &page.blocks {
        let place = format!("{}:{}", page.path.display(), block.line);
        let remark = block.remark.as_deref().unwrap_or_default();
        let (what, detail) = remark.split_once(": ").unwrap_or((remark, ""));
        match (what, block.language.as_str()) {
            ("file", _) => fs::write(scratch.path().join(detail), &block.text).expect("a file of the page"),
            ("output", _) => compare(&place, &block.text, &printed),
            ("not run", "sh") => {
                eprintln!("NOT RUN {place}: {detail}");
                for line in block.text.lines() {
                    names_a_target(&place, line);
                }
            }
            ("", "sh") => printed = shell(&place, &block.text, "", scratch.path()),
            ("run with", "sh") => printed = shell(&place, &block.text, detail, scratch.path()),
            (_, "sh") => panic!("{place}: what is `{remark}`?"),
            _ => {}
        }
    }
}

/// Runs the lines one by one; what they print. Options are added to each `asperity` command.
fn shell(place: &str, text: &str, options: &str, directory: &Path) -> String {
    let mut printed = String::new();
    for line in text.lines() {
        if names_a_target(place, line) {
            continue;
        }
        let line = line.replace("cargo run --release -- ", "asperity ");
        let (command, comment) = line.split_once("  #").unwrap_or((&line, ""));
        let script = if command.starts_with("asperity") { format!("{command} {options}") } else { command.to_owned() };
        let output = Command::new("bash")
            .args(["-euo", "pipefail", "-c", &script])
            .current_dir(directory)
            .env("PATH", path())
            .output()
            .expect("bash runs");
        let said = [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).concat();
        assert!(output.status.success(), "{place}: {script} ({comment}): {}\n{said}", output.status);
        printed += &said;
    }
    printed
}

/// Whether a line is one that builds or tests the repository, which runs this test, not the other
/// way round. What it names has to be there.
fn names_a_target(place: &str, line: &str) -> bool {
    let words: Vec<&str> = line.split_whitespace().collect();
    for pair in words.windows(2) {
        let found = |files: &[String]| files.iter().any(|file| Path::new(file).exists());
        let file = match pair[0] {
            "--bench" => vec![format!("benches/{}.rs", pair[1])],
            "--test" => vec![format!("tests/{}.rs", pair[1])],
            "--example" => vec![format!("examples/{}.rs", pair[1]), format!("examples/{}/main.rs", pair[1])],
            "bash" if pair[1].ends_with(".sh") && !pair[1].starts_with("DIR") => vec![pair[1].to_owned()],
            _ => continue,
        };
        assert!(found(&file), "{place}: {line}: no {file:?}");
    }
    let builds = ["build", "test", "bench", "install"].iter().any(|verb| words.starts_with(&["cargo", verb]));
    builds || line.contains(" cargo ") || line.contains("tests/run.sh") || line.contains(" --example ")
}

/// The search path with the program in front.
fn path() -> std::ffi::OsString {
    let program = assert_cmd::cargo::cargo_bin!("asperity");
    let mut folders = vec![program.parent().expect("its folder").to_owned()];
    folders.extend(std::env::split_paths(&std::env::var_os("PATH").unwrap_or_default()));
    std::env::join_paths(folders).expect("a search path")
}

/// Every line that the page shows was printed, in this order, digits and spaces apart.
fn compare(place: &str, shown: &str, printed: &str) {
    let mut lines = printed.lines().map(without_digits);
    for line in shown.lines() {
        let wanted = without_digits(line);
        assert!(lines.any(|found| found == wanted), "{place}: `{line}` is not what is printed:\n{printed}");
    }
}

fn without_digits(line: &str) -> String {
    let number = |word: &str| word.trim_matches(|c| "(),%".contains(c)).parse::<f64>().is_ok();
    line.split_whitespace().map(|word| if number(word) { "#" } else { word }).collect::<Vec<_>>().join(" ")
}
