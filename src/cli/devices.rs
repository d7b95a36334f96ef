//! `asperity devices`: what there is to compute on, and what would be chosen.

use clap::Args;

use super::{CliError, Outcome};
use crate::compute::gpu::{
    adapters,
    report::{report, report_json},
};

/// List GPU adapters, what they can do, and which would be chosen and why.
#[derive(Clone, Debug, Args)]
pub struct DevicesArgs {
    /// Print JSON.
    #[arg(long)]
    pub json: bool,
}

/// Prints the adapters and the choices; a machine without any is no error.
pub fn devices(args: &DevicesArgs) -> Result<Outcome, CliError> {
    let (adapters, wanted) = (adapters::adapters(), adapters::wanted_name());
    if args.json {
        super::print_json(&report_json(&adapters, wanted.as_deref()))?;
    } else {
        super::print(&report(&adapters, wanted.as_deref()))?;
    }
    Ok(Outcome::Done)
}
