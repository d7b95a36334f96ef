//! The directory of `--out`: made, or recognised as an earlier result, and never anything of the
//! user's.

use std::fs;
use std::io::{self, ErrorKind};
use std::path::Path;

use super::SessionError;
use crate::case::Case;
use crate::output::{LOCK_NAME, OutputDirectory, case_difference};

/// Refuses a directory that is neither absent nor empty nor a result. Drafts and the lock of runs
/// do not count: a run that was killed before its first file had its name leaves those alone.
///
/// # Errors
/// [`SessionError::NotAResult`], [`SessionError::NotADirectory`], [`SessionError::Out`],
/// [`SessionError::Output`] for a folder of results that is a link.
pub fn recognise(dir: &Path) -> Result<(), SessionError> {
    let failed = |what: &'static str| move |source: io::Error| SessionError::Out { dir: dir.to_owned(), what, source };
    match fs::metadata(dir) {
        Ok(found) if !found.is_dir() => return Err(SessionError::NotADirectory { dir: dir.to_owned() }),
        Ok(_) => {}
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(()),
        Err(error) => return Err(failed("be read")(error)),
    }
    let out = OutputDirectory::existing(dir);
    let found = out.names().map_err(failed("be read"))?.into_iter().next();
    match found.filter(|_| !out.holds_result()) {
        Some(found) => Err(SessionError::NotAResult { dir: dir.to_owned(), found }),
        None => {
            out.refuse_links()?;
            Ok(out.refuse_foreign()?)
        }
    }
}

/// Refuses a directory in which a `case.toml` of a run is all that is left of one, and another than
/// this: it may have been copied there to be changed. To be asked before the directory is locked,
/// as the lock of a killed run shows whose it is.
///
/// # Errors
/// [`SessionError::NotAResult`].
pub fn refuse_case_alone(dir: &Path, case: &Case) -> Result<(), SessionError> {
    let out = OutputDirectory::existing(dir);
    let Some(found) = out.read_case().filter(|found| *found != case.to_toml()) else { return Ok(()) };
    let beside = [out.history(), out.summary(), out.checkpoint(), out.log(), dir.join(LOCK_NAME)];
    if beside.iter().any(|path| path.exists()) || case_difference(&found, &case.to_toml()).is_none() {
        return Ok(());
    }
    Err(SessionError::NotAResult { dir: dir.to_owned(), found: "case.toml".to_owned() })
}

/// Prepares `dir` for the results of `case` and writes the resolved case to `case.toml` there.
///
/// A directory that does not exist is made, an empty one is used. In one that holds an earlier
/// result, what that run wrote is removed and everything else stays. Anything else is refused,
/// untouched.
pub fn prepare(dir: &Path, case: &Case) -> Result<(), SessionError> {
    recognise(dir)?;
    fs::create_dir_all(dir).map_err(|source| SessionError::Out { dir: dir.to_owned(), what: "be created", source })?;
    let out = OutputDirectory::existing(dir);
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
        for (name, text) in [
            ("history.csv", "step,segment,h,delta_T,F_N,F_T,a,stick_radius,newton_iterations,cutbacks\n"),
            ("summary.json", "{\n  \"F_N0\": 148.8\n}\n"),
            ("notes.txt", "earlier"),
        ] {
            fs::write(scratch.path().join(name), text).expect("a file");
        }
        prepare(scratch.path(), &case()).expect("an earlier result");
        assert!(!scratch.path().join("history.csv").exists());
        assert!(!scratch.path().join("summary.json").exists());
        assert_eq!(fs::read_to_string(scratch.path().join("notes.txt")).expect("the user's file"), "earlier");
    }

    #[test]
    fn what_a_run_leaves_that_was_killed_at_its_first_file_is_no_hindrance() {
        let scratch = tempfile::tempdir().expect("a scratch directory");
        for name in [".case.toml.4711.tmp", ".asperity.lock"] {
            fs::write(scratch.path().join(name), "").expect("a file");
        }
        prepare(scratch.path(), &case()).expect("as good as empty");
        assert!(!scratch.path().join(".case.toml.4711.tmp").exists());
        // A draft of something else is the user's.
        let mine = tempfile::tempdir().expect("a scratch directory");
        fs::write(mine.path().join(".thesis.tex.4711.tmp"), "mine").expect("a file");
        assert!(matches!(prepare(mine.path(), &case()), Err(SessionError::NotAResult { .. })));
    }

    #[test]
    fn refuses_a_directory_of_the_users_untouched() {
        let scratch = tempfile::tempdir().expect("a scratch directory");
        // A case of the user's own, even one that has the name that a result would have.
        fs::write(scratch.path().join("case.toml"), "[sphere]\n").expect("a file");
        let refused = prepare(scratch.path(), &case()).expect_err("not a result");
        assert!(matches!(refused, SessionError::NotAResult { .. }), "{refused}");
        assert_eq!(fs::read_to_string(scratch.path().join("case.toml")).expect("the user's file"), "[sphere]\n");
    }

    #[test]
    fn refuses_a_result_with_a_file_of_the_users_under_a_name_of_ours() {
        for name in
            ["run.log", "history.csv", "summary.json", "plots/forces.svg", "fields/step_0001.vtu", "contact/step_0001.csv"]
        {
            let scratch = tempfile::tempdir().expect("a scratch directory");
            prepare(scratch.path(), &case()).expect("an empty directory");
            let file = scratch.path().join(name);
            fs::create_dir_all(file.parent().expect("a folder")).expect("a folder");
            fs::write(&file, "mine").expect("a file");
            let message = prepare(scratch.path(), &case()).expect_err("refused").to_string();
            assert!(message.contains(name) && message.contains("was not written by asperity"), "{message}");
            assert_eq!(fs::read_to_string(&file).expect("the user's file"), "mine");
        }
    }

    #[test]
    fn refuses_another_case_that_lies_there_alone() {
        let scratch = tempfile::tempdir().expect("a scratch directory");
        prepare(scratch.path(), &case()).expect("an empty directory");
        refuse_case_alone(scratch.path(), &case()).expect("this very case");
        let mut other = case();
        other.sphere.radius = 2.0;
        assert!(matches!(refuse_case_alone(scratch.path(), &other), Err(SessionError::NotAResult { .. })));
        fs::write(scratch.path().join("run.log"), "").expect("a file");
        refuse_case_alone(scratch.path(), &other).expect("a run was there");
    }

    #[test]
    fn refuses_a_file_and_a_path_below_a_file() {
        let scratch = tempfile::tempdir().expect("a scratch directory");
        let file = scratch.path().join("file");
        fs::write(&file, "mine").expect("a file");
        assert!(matches!(prepare(&file, &case()), Err(SessionError::NotADirectory { .. })));
        assert!(matches!(prepare(&file.join("below"), &case()), Err(SessionError::Out { .. })));
        assert_eq!(fs::read_to_string(&file).expect("the user's file"), "mine");
    }
}
