//! `--resume`: what a directory holds of a run, and whether there is something to go on with.

use std::path::Path;

use super::SessionError;
use crate::case::Case;
use crate::output::{Checkpoint, OutputDirectory, OutputError, Status, Summary, case_difference};

/// What `--resume` finds of an earlier run.
#[derive(Debug)]
pub enum PriorRun {
    /// There is nothing to go on with: no directory, an empty one, or a run that was killed before
    /// its first checkpoint.
    NotBegun,
    /// It is under way.
    Unfinished(Box<Checkpoint>),
    /// It has ended for good: computed again it would be the same.
    Ended(Box<Summary>),
}

/// Looks into `dir`, and leaves it as it is.
///
/// # Errors
/// [`SessionError::OtherRun`] for the results of another case; [`SessionError::Output`] for a
/// checkpoint that is damaged, of another version or another case.
pub fn prior_run(dir: &Path, case: &Case) -> Result<PriorRun, SessionError> {
    let out = OutputDirectory::existing(dir);
    // Anything that is not a result is left to those who prepare the directory.
    let Some(found) = out.read_case() else { return Ok(PriorRun::NotBegun) };
    let ended = |summary: &Summary| match summary.status {
        Status::Done | Status::NotConverged | Status::ContactOutgrewMesh => true,
        Status::Interrupted | Status::Failed => false,
    };
    // A summary that cannot be read counts as missing.
    if let Some(summary) = Summary::read(&out.summary()).ok().filter(ended) {
        return match case_difference(&found, &case.to_toml()) {
            None => Ok(PriorRun::Ended(Box::new(summary))),
            Some(difference) => Err(SessionError::OtherRun { dir: dir.to_owned(), difference }),
        };
    }
    let path = out.checkpoint();
    let Some(checkpoint) = Checkpoint::read(&path)? else { return Ok(PriorRun::NotBegun) };
    checkpoint.check_case(&path, case)?;
    checkpoint.check_files(&out, case)?;
    Ok(PriorRun::Unfinished(Box::new(checkpoint)))
}

/// An error of the checkpoint in `dir` that only the simulation can see.
pub fn refused(dir: &Path, problem: &str) -> SessionError {
    OutputError::Checkpoint {
        path: OutputDirectory::existing(dir).checkpoint(),
        problem: format!("{problem}; run with --force and without --resume to begin anew"),
    }
    .into()
}
