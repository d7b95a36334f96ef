//! The one error of this room: what, where, what to do.

use std::io;
use std::path::PathBuf;

use crate::case::CaseError;
use crate::material::HardeningError;
use crate::output::OutputError;
use crate::simulation::SimulationError;

/// A law could not be fitted, read or used.
#[derive(Debug, thiserror::Error)]
pub enum LawError {
    /// There is no study where one was named.
    #[error("{}: is not a study: {source}. give the directory of `asperity study --out`, with its study.csv", .path.display())]
    NoStudy {
        /// The file that should be there.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// The table of a study is not one.
    #[error("{}, line {line}: {problem}. restore the file, or run the study again with --resume", .path.display())]
    Table {
        /// The table.
        path: PathBuf,
        /// Line, counted from 1.
        line: u64,
        /// What is wrong there.
        problem: String,
    },
    /// Too little to fit a law to.
    #[error(
        "{}: {cases} usable cases of {materials} materials, and a law needs {needed_cases} of {needed_materials}. {skipped}add values to the study's [grid], or let it \
         finish with --resume", .path.display()
    )]
    TooFewCases {
        /// The study.
        path: PathBuf,
        /// Usable cases.
        cases: usize,
        /// Different materials among them.
        materials: usize,
        /// Least number of cases.
        needed_cases: usize,
        /// Least number of materials.
        needed_materials: usize,
        /// Why others are not usable, as a sentence; or nothing.
        skipped: String,
    },
    /// A fit that ends nowhere.
    #[error("{what} could not be fitted: {problem}. look at the study's curves for cases that went wrong")]
    Fit {
        /// Which correlation.
        what: &'static str,
        /// What the least squares say.
        problem: String,
    },
    /// A law file that is none.
    #[error("{}: {problem}. give a law.json that `asperity law fit` of this version wrote", .path.display())]
    BadLaw {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        problem: String,
    },
    /// A case that the law says nothing about.
    #[error("{problem}. {remedy}")]
    NotCovered {
        /// What the case asks for.
        problem: &'static str,
        /// What to do.
        remedy: &'static str,
    },
    /// The hardening law of a case.
    #[error(transparent)]
    Hardening(#[from] HardeningError),
    /// A case file of the study.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// Results of the study that cannot be read, or a law that cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The press that gives the normal data.
    #[error("the press segment could not be computed: {0}")]
    Simulation(#[from] SimulationError),
    /// The press ended before its end.
    #[error("the press segment did not reach its indentation: {0}")]
    Press(String),
}
