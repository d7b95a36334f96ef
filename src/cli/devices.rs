//! `asperity devices`: what there is to compute on, and what would be chosen.

use clap::Args;

use super::{CliError, Exit};
use crate::compute::gpu::adapters;
use crate::compute::gpu::drivers::Drivers;
use crate::compute::gpu::report::{Surroundings, report, report_json};
use crate::compute::select::{DEVICE_VARIABLE, measured};

/// List GPUs, and say which would be chosen and why.
///
/// Shows what each can do and what the kernels need. A GPU that auto may choose is timed once on
/// each machine, in 0.05 s; the result is kept in the user's cache folder.
#[derive(Clone, Debug, Args)]
pub struct DevicesArgs {
    /// Print JSON.
    #[arg(long)]
    pub json: bool,
}

/// Prints the adapters and the choices; a machine without any is no error.
pub fn devices(args: &DevicesArgs) -> Result<Exit, CliError> {
    let adapters = adapters::adapters();
    let around = Surroundings {
        adapter: adapters::wanted_name(),
        device: std::env::var(DEVICE_VARIABLE).ok(),
        measured: measured(),
        drivers: Drivers::found(),
    };
    if args.json {
        super::print_json(&report_json(&adapters, &around))?;
    } else {
        super::print(&report(&adapters, &around))?;
    }
    Ok(Exit::Done)
}
