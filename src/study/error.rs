//! What can go wrong with a study as a whole; what goes wrong with one of its cases is a row of
//! `study.csv`.

use std::io;
use std::path::PathBuf;

use crate::case::CaseError;
use crate::compute::ComputeError;
use crate::law::LawError;
use crate::material::MaterialError;
use crate::output::OutputError;
use crate::simulation::SimulationError;

/// A study that cannot be run, or that broke off.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// The study file, or all of its combinations for the same reason.
    #[error(transparent)]
    File(#[from] CaseError),
    /// Some of the combinations are no cases.
    #[error(
        "{source} (in the combination {combination}; {failing} of {}{count} combinations are refused)",
        if *more { "the first " } else { "" }
    )]
    Combination {
        /// What is wrong with the first of them.
        source: Box<CaseError>,
        /// Its grid values, `key = value, ...`.
        combination: String,
        /// How many are refused.
        failing: usize,
        /// Of how many.
        count: usize,
        /// Whether there are more, which were not looked at.
        more: bool,
    },
    /// The hardening law of a combination.
    #[error("{file}: {source} (in the combination {combination})")]
    Hardening {
        /// The study file.
        file: String,
        /// What the material says.
        source: MaterialError,
        /// The combination's grid values.
        combination: String,
    },
    /// The directory holds something else.
    #[error("--out {}: holds {found:?}, and is not an Asperity study. Give a new or an empty directory (nothing was changed)", .dir.display())]
    NotAStudy {
        /// The directory.
        dir: PathBuf,
        /// A file found in it.
        found: String,
    },
    /// The directory is something else.
    #[error("--out {}: is not a directory. Give a new or an empty directory (nothing was changed)", .dir.display())]
    NotADirectory {
        /// The path.
        dir: PathBuf,
    },
    /// The directory holds another study, to which results cannot be added.
    #[error(
        "--out {}: holds another study: {what}. Go on with the study.toml in there, or give a new directory (nothing was changed)",
        .dir.display()
    )]
    OtherStudy {
        /// The directory.
        dir: PathBuf,
        /// In what it differs.
        what: String,
    },
    /// The directory holds results, and it was not said what is to become of them.
    #[error(
        "--out {}: holds a study of which {what}. --resume goes on with it, --force replaces it; or give another directory (nothing was changed)",
        .dir.display()
    )]
    Earlier {
        /// The directory.
        dir: PathBuf,
        /// How far its cases are.
        what: String,
    },
    /// What cannot be merged.
    #[error("--merge {}: {what} (nothing was changed)", .dir.display())]
    Merge {
        /// The directory.
        dir: PathBuf,
        /// What is wrong, and what to do.
        what: String,
    },
    /// What cannot be handed to Slurm.
    #[error("--slurm {argument}: {what}")]
    Slurm {
        /// The argument.
        argument: String,
        /// What is wrong, and what to do.
        what: String,
    },
    /// The directory cannot be made or read.
    #[error("--out {}: cannot {what}: {source}. Give a directory that you may write to", .dir.display())]
    Directory {
        /// The directory.
        dir: PathBuf,
        /// What was tried.
        what: &'static str,
        /// What the system says.
        source: io::Error,
    },
    /// Results cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The results of a study cannot be read back, or a picture of them fails.
    #[error(transparent)]
    Law(#[from] LawError),
    /// One case could not be simulated; it becomes the reason in its row.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// There is no such device, or it failed.
    #[error(transparent)]
    Compute(#[from] ComputeError),
    /// The threads cannot be started.
    #[error("cannot start {threads} threads: {what}. Give fewer with --threads")]
    Threads {
        /// How many were asked for.
        threads: usize,
        /// What the system says.
        what: String,
    },
    /// The study broke off while cases were computed.
    #[error("the study broke off: {source}. The cases that are done are kept in {}; --resume goes on from there", .dir.display())]
    BrokeOff {
        /// What went wrong and what to do.
        source: Box<StudyError>,
        /// The directory of `--out`.
        dir: PathBuf,
    },
}
