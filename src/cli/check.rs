//! `asperity check`: the case as it would be run.

use std::path::PathBuf;

use clap::Args;

use super::{CliError, Outcome};
use crate::case::Case;

/// Check a case and print it with every default, without running it.
#[derive(Clone, Debug, Args)]
pub struct CheckArgs {
    /// The case file.
    #[arg(value_name = "CASE.toml")]
    pub case: PathBuf,
    /// Replace a value of the case, as in contact.friction=0.1 or path.0.indentation=0.01; may be repeated.
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
}

/// Loads and checks the case and prints it as TOML.
pub fn check(args: &CheckArgs) -> Result<Outcome, CliError> {
    let case = Case::load(&args.case, &args.set)?;
    super::print(&case.to_toml())?;
    Ok(Outcome::Done)
}
