//! The one error of this room: what, where, what to do.

use std::io;
use std::path::PathBuf;

use crate::case::CaseError;
use crate::contact_law::ContactError;
use crate::law::table::Against;
use crate::material::MaterialError;
use crate::output::OutputError;
use crate::simulation::SimulationError;

/// A law could not be fitted, read or used.
#[derive(Debug, thiserror::Error)]
pub enum LawError {
    /// There is no study where one was named.
    #[error("{}: is not a study: {source}. Give the directory of `asperity study --out`, with its study.csv", .path.display())]
    NoStudy {
        /// The file that should be there.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// The table of a study is not one.
    #[error("{}, line {line}: {problem}. Restore the file, or run the study again with --resume", .path.display())]
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
    #[error("{what} could not be fitted: {problem}. Look at the study's curves for cases that went wrong")]
    Fit {
        /// Which correlation.
        what: &'static str,
        /// What the least squares say.
        problem: String,
    },
    /// A law file that is none.
    #[error(
        "{}: {problem}. Restore the file, or make it anew with `asperity law fit`, `law tabulate` or `law compose` of this version",
        .path.display()
    )]
    BadLaw {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        problem: String,
    },
    /// The name of no file that resembles a word.
    #[error("{}: there is no such file, did you mean `{meant}`? Else give the path of a law.json", .path.display())]
    Misspelt {
        /// The name.
        path: PathBuf,
        /// The word.
        meant: String,
    },
    /// A case that the law says nothing about.
    #[error("{problem}. {remedy}")]
    NotCovered {
        /// What the case asks for.
        problem: &'static str,
        /// What to do.
        remedy: &'static str,
    },
    /// A case of which a table says nothing.
    #[error(
        "the table is of another material: {what}. Tabulate this one with `asperity law tabulate`, or take the built-in law, \
         whose name is `built-in`"
    )]
    OtherMaterial {
        /// What differs.
        what: String,
    },
    /// A case against something that a law by interpolation is not of.
    #[error(
        "the contact is one with {case}, and the law's study is of spheres on {law}. Take a law that was fitted to a study with \
         this opponent, or tabulate the case with `asperity law tabulate`"
    )]
    OtherOpponent {
        /// That of the case.
        case: Against,
        /// That of the law.
        law: Against,
    },
    /// Another kind of law for what takes formulas.
    #[error("{}: is a law without formulas, and {what} takes them. Give a law.json that `asperity law fit` wrote", .path.display())]
    NoFormulas {
        /// The file.
        path: PathBuf,
        /// What.
        what: &'static str,
    },
    /// Too few depths for a table.
    #[error("{}: {done} of {of} depths were computed to their end, too few for a table{reason}. Run it again with --resume", .path.display())]
    TooFewDepths {
        /// The study.
        path: PathBuf,
        /// Depths that are there.
        done: usize,
        /// Depths that were wanted.
        of: usize,
        /// Why another is missing, after a semicolon; or nothing.
        reason: String,
    },
    /// A table of a body that ends before the pair that it is to make.
    #[error(
        "the table of the {body} ends at h/R = {has:.3e}, and in this pair that body is pressed to {needs:.3e}. \
         Tabulate it deeper, or the pair less deep"
    )]
    Shallow {
        /// Which.
        body: &'static str,
        /// h/R at its end.
        has: f64,
        /// h/R that the pair needs, of the table's contact.
        needs: f64,
    },
    /// A law that has no sound numbers for a contact which is far from all that it was made from.
    #[error(
        "there is no sound table for this case: {problem}. Check its material, friction and indentation against the range of the \
         law, or the results that the table is made from"
    )]
    NoTable {
        /// The key and the number of the table that it would be.
        problem: String,
    },
    /// The contact update has no numbers for a material.
    #[error(transparent)]
    Contact(#[from] ContactError),
    /// The hardening law of a case.
    #[error(transparent)]
    Hardening(#[from] MaterialError),
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
