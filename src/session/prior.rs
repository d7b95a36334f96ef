//! `--resume` and `--extend`: what a directory holds of a run, and whether there is something to go
//! on with.

use std::path::Path;

use super::SessionError;
use crate::case::Case;
use crate::output::{Checkpoint, OutputDirectory, OutputError, RunStatus, Summary, case_difference};

/// What `--resume` finds of an earlier run.
#[derive(Debug)]
pub enum PriorRun {
    /// There is nothing to go on with: no directory, an empty one, or a run that was killed before
    /// its first checkpoint.
    NotBegun,
    /// It is under way.
    Unfinished(Box<Checkpoint>),
    /// It is done, its path is the beginning of this one, so many segments, and this is its end.
    Extendable(Box<Checkpoint>, usize),
    /// It has ended for good: computed again it would be the same.
    Ended(Box<Summary>),
}

/// Looks into `dir`, and leaves it as it is. `extends` says whether a run of a path that this one
/// begins with is to be gone on with.
///
/// # Errors
/// [`SessionError::OtherRun`] for the results of another case; [`SessionError::NotExtended`];
/// [`SessionError::Output`] for a checkpoint that is damaged, of another version or another case.
pub fn prior_run(dir: &Path, case: &Case, extends: bool) -> Result<PriorRun, SessionError> {
    let out = OutputDirectory::existing(dir);
    let not_extended = |why: String| SessionError::NotExtended { dir: dir.to_owned(), why };
    let nothing = || match extends {
        true => Err(not_extended("it holds no run that is done; leave out --extend to begin one".to_owned())),
        false => Ok(PriorRun::NotBegun),
    };
    // Anything that is not a result is left to those who prepare the directory.
    let Some(found) = out.read_case() else { return nothing() };
    let ended = |summary: &Summary| match summary.status {
        RunStatus::Done | RunStatus::NotConverged | RunStatus::ContactOutgrewMesh => true,
        RunStatus::Interrupted | RunStatus::Failed => false,
    };
    let path = out.checkpoint();
    // A summary that cannot be read counts as missing.
    if let Some(summary) = Summary::read(&out.summary()).ok().filter(ended) {
        let Some(difference) = case_difference(&found, &case.to_toml()) else {
            return Ok(PriorRun::Ended(Box::new(summary)));
        };
        // Killed where an extension had begun with its checkpoint and with nothing else.
        if let Ok(Some(checkpoint)) = Checkpoint::read(&path)
            && checkpoint.is_of(case)
        {
            checkpoint.check_files(&out, case)?;
            return Ok(PriorRun::Unfinished(Box::new(checkpoint)));
        }
        return match extends {
            true => extendable(&out, case, &summary).map_err(|problem| match problem {
                NotExtendable::Why(why) => not_extended(why),
                NotExtendable::Output(error) => error.into(),
            }),
            false => Err(SessionError::OtherRun { dir: dir.to_owned(), difference }),
        };
    }
    let Some(checkpoint) = Checkpoint::read(&path)? else { return nothing() };
    if extends && !checkpoint.is_of(case) {
        return Err(not_extended("its run is unfinished; go on with that one first, with its own case and --resume".to_owned()));
    }
    checkpoint.check_case(&path, case)?;
    checkpoint.check_files(&out, case)?;
    Ok(PriorRun::Unfinished(Box::new(checkpoint)))
}

/// Why a run that has ended cannot be extended.
enum NotExtendable {
    Why(String),
    Output(OutputError),
}

impl From<OutputError> for NotExtendable {
    fn from(error: OutputError) -> Self {
        Self::Output(error)
    }
}

/// The end of a run with another case: where `case` goes on from it.
fn extendable(out: &OutputDirectory, case: &Case, summary: &Summary) -> Result<PriorRun, NotExtendable> {
    let is_done = summary.status == RunStatus::Done;
    // An extension that did not converge leaves the end of the path before it.
    let path = if is_done { out.checkpoint() } else { out.end_checkpoint() };
    let Some(checkpoint) = Checkpoint::read(&path)? else {
        if !is_done {
            let ended = summary.status.to_string();
            return Err(NotExtendable::Why(format!("its run ended as {ended:?}, not at the end of its path")));
        }
        let why = "the last checkpoint of its run was not kept (output.keep_checkpoint); compute the longer path from the beginning, in another directory or with --force";
        return Err(NotExtendable::Why(why.to_owned()));
    };
    let longer = "the case has to be the same, with segments after the last one of its path";
    let segments = checkpoint.extended_by(case).map_err(|why| NotExtendable::Why(format!("{why}; {longer}")))?;
    checkpoint.check_files(out, case)?;
    let mut shorter = case.clone();
    shorter.path.truncate(segments);
    let meshed = |case: &Case| (case.is_even(), case.image(), case.orientation(), case.moves_along_x());
    if meshed(&shorter) != meshed(case) {
        let why = "the longer path leaves the x axis, turns the sphere or has another first direction, and from the beginning it \
                   would be simulated otherwise, mostly on the whole sphere. Compute it in another directory, or with --force";
        return Err(NotExtendable::Why(why.to_owned()));
    }
    Ok(PriorRun::Extendable(Box::new(checkpoint), segments))
}

/// An error of the checkpoint in `dir` that only the simulation can see.
pub fn refused(dir: &Path, problem: &str) -> SessionError {
    OutputError::Checkpoint {
        path: OutputDirectory::existing(dir).checkpoint(),
        problem: format!("{problem}; run with --force and without --resume to begin anew"),
    }
    .into()
}
