//! `asperity verify`: closed-form checks as a table.

use clap::Args;

use super::options::{DeviceArgs, Verbosity};
use super::{CliError, Outcome};

/// Compare this build with closed-form solutions: ours, reference, error, verdict.
#[derive(Clone, Debug, Args)]
pub struct VerifyArgs {
    /// Device, precision, threads.
    #[command(flatten)]
    pub device: DeviceArgs,
    /// How much to say.
    #[command(flatten)]
    pub verbosity: Verbosity,
}

/// Runs the checks.
pub fn verify(args: &VerifyArgs) -> Result<Outcome, CliError> {
    args.verbosity.start_log();
    args.device.start_threads()?;
    Err(CliError::NoSimulation)
}
