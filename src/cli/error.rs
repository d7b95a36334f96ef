//! What can go wrong in front of the simulation.

use std::io;
use std::path::PathBuf;

use super::called::gpu_asked_by;
use super::snippet;
use crate::bench::BenchError;
use crate::case::CaseError;
use crate::law::LawError;
use crate::material::MaterialError;
use crate::output::OutputError;
use crate::processor::TooOld;
use crate::quoting;
use crate::session::SessionError;
use crate::simulation::SimulationError;
use crate::study::StudyError;
use crate::verify::VerifyError;

/// Bad input or usage: nothing was computed.
pub const BAD_INPUT: u8 = 2;
/// What was computed is kept, but it is not all.
pub const NOT_CONVERGED: u8 = 3;

/// An error that ends the program, with [`BAD_INPUT`] unless a run had begun.
#[derive(Debug, thiserror::Error)]
pub enum CliError {
    /// The case file.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// What is wrong with a case or study file, with the text of the file.
    #[error("{}", snippet::plain(.errors, .text))]
    Mistakes {
        /// The mistakes, at least one, in the order of the file.
        errors: Vec<CaseError>,
        /// The text in which their places are.
        text: String,
    },
    /// The directory of `--out` cannot be made, read or written.
    #[error("--out {}: cannot {what}: {source}. Give a directory that you may write to", .dir.display())]
    Out {
        /// The directory.
        dir: PathBuf,
        /// What was tried.
        what: &'static str,
        /// What the system says.
        source: io::Error,
    },
    /// Scripts that cannot be submitted.
    #[error("--submit: {what}. The scripts are written; submit them with `bash {}` where sbatch is", quoting::path(.script))]
    Submit {
        /// The script that submits.
        script: PathBuf,
        /// What went wrong.
        what: String,
    },
    /// An environment variable.
    #[error("{name}={value}: {what}. Unset it, or correct it")]
    Variable {
        /// Its name.
        name: &'static str,
        /// Its value.
        value: String,
        /// What is wrong.
        what: &'static str,
    },
    /// The hardening law of a case.
    #[error("{}: {source}", .file.display())]
    Hardening {
        /// The case file.
        file: PathBuf,
        /// What the material says.
        source: MaterialError,
    },
    /// The deformation of `asperity point`.
    #[error("{what}")]
    Deformation {
        /// What is wrong, where, and what to do.
        what: String,
    },
    /// The pool of threads.
    #[error("--threads {threads}: cannot start that many threads: {what}. Give fewer")]
    Threads {
        /// The number asked for.
        threads: usize,
        /// What the pool says.
        what: String,
    },
    /// Standard output cannot be written.
    #[error("stdout: cannot be written: {source}. Redirect it to a place with room")]
    Stdout {
        /// What the system says.
        source: io::Error,
    },
    /// The program was compiled for a newer processor.
    #[error(transparent)]
    Processor(#[from] TooOld),
    /// A GPU was asked for and cannot be used.
    #[error("{}: {what}", gpu_asked_by())]
    Device {
        /// What is wrong and what to do.
        what: String,
    },
    /// There is no device that `prove` could compare.
    #[error("there is nothing to prove: {what}")]
    Prove {
        /// What is wrong and what to do.
        what: String,
    },
    /// The kernels cannot be measured.
    #[error("bench: {0}")]
    Bench(#[from] BenchError),
    /// The page of `explore` cannot be served.
    #[cfg(feature = "explore")]
    #[error("--port {port}: the page cannot be served: {source}. Give another port, or 0 for any that is free")]
    Serve {
        /// The port.
        port: u16,
        /// What the system says.
        source: io::Error,
    },
    /// The signals cannot be caught.
    #[error("cannot listen for signals: {source}. This system allows no signal handlers, which a run needs")]
    Signals {
        /// What the system says.
        source: io::Error,
    },
    /// The case cannot be made into a simulation.
    #[error("{}: {source}", .file.display())]
    Problem {
        /// The case file.
        file: PathBuf,
        /// What the simulation says.
        source: SimulationError,
    },
    /// A law cannot be fitted or read.
    #[error(transparent)]
    Law(#[from] LawError),
    /// A law does not apply to a case.
    #[error("{}: {source}", .file.display())]
    LawCase {
        /// The case file.
        file: PathBuf,
        /// What the law says.
        source: Box<LawError>,
    },
    /// What is wrong with options that stand for a case.
    #[error("{}", .what.join("\n"))]
    Options {
        /// A line each.
        what: Vec<String>,
    },
    /// The directory of `plot` holds nothing that can be drawn.
    #[error("{}: {what}. Give the directory that was given to `asperity run --out` or `asperity study --out`", .dir.display())]
    NothingToPlot {
        /// The directory.
        dir: PathBuf,
        /// What is wrong with it.
        what: String,
    },
    /// A run.
    #[error(transparent)]
    Session(#[from] SessionError),
    /// A file cannot be written or read.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A study.
    #[error(transparent)]
    Study(#[from] StudyError),
    /// A study where a case is wanted.
    #[error(
        "{file}: is a study, a grid of cases. `asperity study {} --out DIR` computes it, `asperity check {}` shows its first case",
        quoting::input(.file),
        quoting::input(.file)
    )]
    StudyGiven {
        /// The file.
        file: String,
    },
    /// A case where a study is wanted.
    #[error(
        "{file}: is a case, not a study (there is no [base] and no [grid]). `asperity run {} --out DIR` computes it",
        quoting::input(.file)
    )]
    CaseGiven {
        /// The file.
        file: String,
    },
    /// A key that `explain` does not know.
    #[error("{key}: no key of case or study files{} `asperity explain` lists them", nearest.as_ref().map_or(".".to_owned(), |key| format!(", did you mean `{key}`?")))]
    UnknownKey {
        /// What was asked for.
        key: String,
        /// The key that it resembles.
        nearest: Option<String>,
    },
    /// A file that `init` or `law compose` would replace.
    #[error("{}: is there already. Give another name, or --force to replace it (nothing was changed)", .file.display())]
    FileThere {
        /// The file.
        file: PathBuf,
    },
    /// Results that cannot be compared.
    #[error("{}: {what}. Give directories that `asperity run` wrote", .dir.display())]
    NothingToCompare {
        /// The directory.
        dir: PathBuf,
        /// What is wrong with it.
        what: String,
    },
    /// A study where `--set` was given.
    #[error("--set {argument}: {} is a study, whose values are those of its file. Edit the file, or give a case", .file.display())]
    SetInStudy {
        /// The argument.
        argument: String,
        /// The study file.
        file: PathBuf,
    },
    /// The checks of a verification could not be run.
    #[error("verify, {family}: {source}. `asperity devices` lists what there is to compute on; --device cpu needs nothing")]
    Verify {
        /// The family of checks.
        family: &'static str,
        /// What went wrong.
        source: VerifyError,
    },
}

impl CliError {
    /// The exit code of the program.
    pub fn exit_code(&self) -> u8 {
        match self {
            CliError::Session(SessionError::BrokeOff { .. })
            | CliError::Verify { .. }
            | CliError::Study(StudyError::BrokeOff { .. }) => NOT_CONVERGED,
            CliError::LawCase { source, .. } if matches!(**source, LawError::Press(_)) => NOT_CONVERGED,
            _ => BAD_INPUT,
        }
    }
}
