//! `asperity devices`: what there is to compute on, and what would be chosen.

use clap::Args;

use super::{CliError, Outcome};
use crate::compute::gpu::{adapters, report::report};

/// List the GPU adapters, what they can do, and which would be chosen and why.
#[derive(Clone, Debug, Args)]
pub struct DevicesArgs {}

/// Prints the adapters and the choices; a machine without any is no error.
pub fn devices(_: &DevicesArgs) -> Result<Outcome, CliError> {
    super::print(&report(&adapters::adapters(), adapters::wanted_name().as_deref()))?;
    Ok(Outcome::Done)
}
