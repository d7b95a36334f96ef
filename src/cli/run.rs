//! `asperity run`: one case, from its file to its results.

use std::path::PathBuf;

use clap::Args;

use super::options::{DeviceArgs, Verbosity};
use super::{CliError, Outcome, out};
use crate::case::Case;

/// Simulate one case.
#[derive(Clone, Debug, Args)]
pub struct RunArgs {
    /// The case file.
    #[arg(value_name = "CASE.toml")]
    pub case: PathBuf,
    /// Directory for the results: a new one, an empty one, or one that holds an earlier result, which is replaced.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Replace a value of the case, as in contact.friction=0.1 or path.0.indentation=0.01; may be repeated.
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Device, precision, threads.
    #[command(flatten)]
    pub device: DeviceArgs,
    /// How much to say.
    #[command(flatten)]
    pub verbosity: Verbosity,
}

/// Loads and checks the case, prepares the directory and simulates.
pub fn run(args: &RunArgs) -> Result<Outcome, CliError> {
    args.verbosity.start_log();
    args.device.start_threads()?;
    let case = Case::load(&args.case, &args.set)?;
    out::prepare(&args.out, &case)?;
    Err(CliError::NoSimulation)
}
