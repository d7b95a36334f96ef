//! `asperity check`: the case, or the first of a study's, as it would be run.

use std::path::PathBuf;

use clap::Args;

use super::{CliError, Outcome};
use crate::bounded;
use crate::case::{Case, Document};
use crate::study::Study;

/// Check a case and print it with every default, without running it; of a study, check every combination and print how many there are, and the first.
#[derive(Clone, Debug, Args)]
pub struct CheckArgs {
    /// The case file, or a study file.
    #[arg(value_name = "CASE.toml")]
    pub case: PathBuf,
    /// Replace a value of the case, as in contact.friction=0.1 or path.0.indentation=0.01; may be repeated.
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
}

/// Loads and checks the case and prints it as TOML; so the first case of a study, after a line on the size of its grid.
pub fn check(args: &CheckArgs) -> Result<Outcome, CliError> {
    if let Some(study) = study(args)? {
        let first = study
            .cases
            .first()
            .map_or(String::new(), |case| format!("# case {}: {}\n{}", case.id, study.combination(case), case.case.to_toml()));
        super::print(&format!("# {}\n{first}", study.size()))?;
        return Ok(Outcome::Done);
    }
    let case = Case::load(&args.case, &args.set)?;
    super::print(&case.to_toml())?;
    Ok(Outcome::Done)
}

/// The study, if the file is one. What cannot be read as TOML is left to the case's own check.
fn study(args: &CheckArgs) -> Result<Option<Study>, CliError> {
    let name = args.case.display().to_string();
    let text = bounded::read_to_string(&args.case, bounded::CASE).unwrap_or_default();
    if !Document::parse(&text, &name).is_ok_and(|document| Study::is_study(&document)) {
        return Ok(None);
    }
    match args.set.first() {
        Some(argument) => Err(CliError::SetInStudy { argument: argument.clone(), file: args.case.clone() }),
        None => Ok(Some(Study::parse(&text, &name)?)),
    }
}
