//! What can go wrong with one run.

use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use crate::case::CaseError;
use crate::output::OutputError;
use crate::simulation::SimulationError;

/// A run that could not begin, or broke off. A step that does not converge is not an error: see
/// [`super::Outcome`].
#[derive(Debug, thiserror::Error)]
pub enum SessionError {
    /// The case.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// The directory of results holds something else.
    #[error("--out {}: holds {found:?}, and is not an Asperity result. Give a new or an empty directory (nothing was changed)", .dir.display())]
    NotAResult {
        /// The directory.
        dir: PathBuf,
        /// A file found in it.
        found: String,
    },
    /// The directory of results is something else.
    #[error("--out {}: is not a directory. Give a new or an empty directory (nothing was changed)", .dir.display())]
    NotADirectory {
        /// The path.
        dir: PathBuf,
    },
    /// The directory of results cannot be made, read or written.
    #[error("--out {}: cannot {what}: {source}. Give a directory that you may write to", .dir.display())]
    Out {
        /// The directory.
        dir: PathBuf,
        /// What was tried.
        what: &'static str,
        /// What the system says.
        source: io::Error,
    },
    /// The directory of results holds an earlier one, and it was not said what is to become of it.
    #[error(
        "--out {}: holds {found}. --resume goes on with it (if it is done, it stays), --force replaces it; or give another directory (nothing was changed)",
        .dir.display()
    )]
    Earlier {
        /// The directory.
        dir: PathBuf,
        /// What is there.
        found: String,
    },
    /// To be resumed where another case has been computed.
    #[error(
        "--out {}: holds the results of another case: {difference}. restore the case file or --set, give another directory, or run with --force and without \
         --resume to replace them",
        .dir.display()
    )]
    OtherRun {
        /// The directory.
        dir: PathBuf,
        /// A key in which they differ.
        difference: String,
    },
    /// To be extended, and it cannot be.
    #[error("--out {}: cannot be extended: {why} (nothing was changed)", .dir.display())]
    NotExtended {
        /// The directory.
        dir: PathBuf,
        /// Why not, and what to do.
        why: String,
    },
    /// The pool of threads.
    #[error("--threads {threads}: cannot start that many threads: {what}. Give fewer")]
    Threads {
        /// The number asked for.
        threads: usize,
        /// What the pool says.
        what: String,
    },
    /// A GPU was asked for and cannot be used.
    #[error("--device gpu: {what}")]
    Device {
        /// What is wrong and what to do.
        what: String,
    },
    /// The case cannot be made into a simulation.
    #[error(transparent)]
    Simulation(SimulationError),
    /// Results cannot be begun, or an unfinished run cannot go on.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The run broke off: results cannot be written, or the device failed.
    #[error("the run broke off after {steps} steps: {what}{}", .dir.as_deref().map_or_else(String::new, kept))]
    BrokeOff {
        /// Steps that are kept.
        steps: usize,
        /// What went wrong and what to do.
        what: String,
        /// The directory of results, if there is one.
        dir: Option<PathBuf>,
    },
    /// A simulation that broke off was asked to go on.
    #[error(
        "the run has broken off before: there is no state to go on from. Make a new simulation; with results in a directory it may resume them"
    )]
    Over,
}

/// What became of the results of a run that broke off, and what to do.
fn kept(dir: &Path) -> String {
    let dir_name = dir.display();
    if is_absent(&dir.join("case.toml")) {
        return format!(". nothing of it is left in {dir_name}; run it again from the beginning");
    }
    format!(". What was computed until then is kept in {dir_name}; to go on, run the same command with --resume")
}

/// Whether nothing is there.
pub fn is_absent(path: &Path) -> bool {
    matches!(fs::metadata(path), Err(error) if error.kind() == ErrorKind::NotFound)
}
