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
            ("output", _) => compare(&place, &block.text, &printed, true),
            ("output, numbers apart", _) => {
                assert!(!detail.is_empty(), "{place}: why are its numbers not compared?");
                eprintln!("NUMBERS NOT COMPARED {place}: {detail}");
                compare(&place, &block.text, &printed, false);
            }
            (_, "text") if what.starts_with("output") => panic!("{place}: what is `{remark}`?"),
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

/// Every line that the page shows was printed, in this order: the same words, and numbers within
/// 0.5 % or half a unit of the last digit shown; percentages within 0.05 as well. Without `numbers`
/// any number stands for any other.
fn compare(place: &str, shown: &str, printed: &str, numbers: bool) {
    let mut lines = printed.lines();
    for line in shown.lines() {
        let mut rest = lines.clone();
        if lines.any(|found| alike(line, found, numbers)) {
            continue;
        }
        match rest.find(|found| alike(line, found, false)) {
            Some(found) => panic!("{place}: the page says\n{line}\nand the program\n{found}\nAll that it printed:\n{printed}"),
            None => panic!("{place}: `{line}` is not what is printed:\n{printed}"),
        }
    }
}

fn alike(shown: &str, printed: &str, numbers: bool) -> bool {
    let words = |line: &str| line.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
    let (shown, printed) = (words(shown), words(printed));
    let percent = |index: usize| shown[index].contains('%') || shown.get(index + 1).is_some_and(|next| next.starts_with('%'));
    shown.len() == printed.len()
        && (0..shown.len()).all(|index| match (number(&shown[index]), number(&printed[index])) {
            (Some((wanted, digit)), Some((found, _))) => {
                let bound = (0.005 * wanted.abs()).max(0.5 * digit).max(if percent(index) { 0.05 } else { 0.0 });
                // What is decimal on the page is not quite that as a double.
                !numbers || (wanted - found).abs() <= bound * (1.0 + 1e-9)
            }
            _ => shown[index] == printed[index],
        })
}

/// A word as a number, brackets and the like apart, and what a unit of its last digit is worth.
fn number(word: &str) -> Option<(f64, f64)> {
    let word = word.trim_matches(|c| "(),;:%".contains(c));
    let value = word.parse().ok().filter(|value: &f64| value.is_finite())?;
    let (mantissa, exponent) = word.split_once(['e', 'E']).unwrap_or((word, "0"));
    let decimals = mantissa.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    Some((value, 10f64.powi(exponent.parse::<i32>().ok()? - i32::try_from(decimals).ok()?)))
}

#[test]
fn numbers_are_held_to_half_a_per_cent() {
    let near = |shown: &str, printed: &str| alike(shown, printed, true);
    assert!(near("F_N0   148.293  before (+- 4.6 %)", "F_N0 148.9 before (+- 4.6 %)"));
    assert!(!near("F_N0 148.293", "F_N0 149.1"), "0.54 % off");
    assert!(!near("k_T0 44771 45918 +4.48 %", "k_T0 44771 45918 -4.12 %"), "another sign");
    assert!(near("k_T0 +2.56 %", "k_T0 +2.60 %") && !near("k_T0 +2.56 %", "k_T0 +2.66 %"));
    assert!(!near("3e-05 unaccounted for", "4e-05 unaccounted for"));
    assert!(!near("deepest h/R 0.0165", "deepest h 0.0165"), "another word");
    assert!(alike("took 1.2 s", "took 9.7 s", false) && !near("took 1.2 s", "took 9.7 s"));
}
