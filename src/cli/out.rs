//! The directory of `--out`: made, or recognised as an earlier result, and never anything of the user's.

use std::fs;
use std::io::{self, ErrorKind};
use std::path::Path;

use super::CliError;
use crate::case::Case;
use crate::output::OutputDirectory;

/// Prepares `dir` for the results of `case` and writes the resolved case to `case.toml` there.
///
/// A directory that does not exist is made, an empty one is used. In one that holds an earlier result, what that
/// run wrote is removed and everything else stays. Anything else is refused, untouched.
pub fn prepare(dir: &Path, case: &Case) -> Result<(), CliError> {
    let failed = |what: &'static str| move |source: io::Error| CliError::Out { dir: dir.to_owned(), what, source };
    match fs::metadata(dir) {
        Ok(found) if !found.is_dir() => return Err(CliError::NotADirectory { dir: dir.to_owned() }),
        Ok(_) => {}
        Err(error) if error.kind() == ErrorKind::NotFound => fs::create_dir_all(dir).map_err(failed("be created"))?,
        Err(error) => return Err(failed("be read")(error)),
    }
    let mut names = Vec::new();
    for entry in fs::read_dir(dir).map_err(failed("be read"))? {
        names.push(entry.map_err(failed("be read"))?.file_name().to_string_lossy().into_owned());
    }
    let out = OutputDirectory::existing(dir);
    if let Some(found) = names.iter().min().filter(|_| !out.holds_result()) {
        return Err(CliError::NotAResult { dir: dir.to_owned(), found: found.clone() });
    }
    out.clear()?;
    Ok(out.write_case(&case.to_toml())?)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn case() -> Case {
        let text = include_str!("../../fixtures/cases/ideal.toml");
        Case::parse(text, "ideal.toml", &[]).expect("the fixture is a case")
    }

    #[test]
    fn makes_nested_directories_and_writes_the_resolved_case() {
        let scratch = tempfile::tempdir().expect("a scratch directory");
        let dir = scratch.path().join("a/b");
        prepare(&dir, &case()).expect("a new directory");
        assert!(OutputDirectory::existing(&dir).holds_result());
        assert_eq!(Case::load(&dir.join("case.toml"), &[]).expect("it reads back"), case());
    }

    #[test]
    fn replaces_an_earlier_result_and_keeps_what_is_not_its_own() {
        let scratch = tempfile::tempdir().expect("a scratch directory");
        prepare(scratch.path(), &case()).expect("an empty directory");
        for name in ["history.csv", "summary.json", "notes.txt"] {
            fs::write(scratch.path().join(name), "earlier").expect("a file");
        }
        prepare(scratch.path(), &case()).expect("an earlier result");
        assert!(!scratch.path().join("history.csv").exists());
        assert!(!scratch.path().join("summary.json").exists());
        assert_eq!(fs::read_to_string(scratch.path().join("notes.txt")).expect("the user's file"), "earlier");
    }

    #[test]
    fn refuses_a_directory_of_the_users_untouched() {
        let scratch = tempfile::tempdir().expect("a scratch directory");
        // A case of the user's own, even one that has the name that a result would have.
        fs::write(scratch.path().join("case.toml"), "[sphere]\n").expect("a file");
        let refused = prepare(scratch.path(), &case()).expect_err("not a result");
        assert!(matches!(refused, CliError::NotAResult { .. }), "{refused}");
        assert_eq!(fs::read_to_string(scratch.path().join("case.toml")).expect("the user's file"), "[sphere]\n");
    }

    #[test]
    fn refuses_a_file_and_a_path_below_a_file() {
        let scratch = tempfile::tempdir().expect("a scratch directory");
        let file = scratch.path().join("file");
        fs::write(&file, "mine").expect("a file");
        assert!(matches!(prepare(&file, &case()), Err(CliError::NotADirectory { .. })));
        assert!(matches!(prepare(&file.join("below"), &case()), Err(CliError::Out { .. })));
        assert_eq!(fs::read_to_string(&file).expect("the user's file"), "mine");
    }
}
