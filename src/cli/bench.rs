//! `asperity bench`: rates of the kernels on a device and on the CPU.

use std::io::Write;
use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::Args;

use super::backend::device_or_variable;
use super::options::{Device, Verbosity};
use super::{CliError, Exit};
use crate::bench::whole_job::{self, WholeJobs};
use crate::bench::{self, BenchError, Options, table};
use crate::compute::select::{self, DeviceChoice};
use crate::output::write_own;

/// Measure the kernels on a GPU and on the CPU.
///
/// These are return mapping, internal force, tangent, contact and commit; on a GPU also parts of
/// the linear solver. Takes some minutes.
#[derive(Clone, Debug, Args)]
pub struct BenchArgs {
    /// What to measure beside the CPU. The default is ASPERITY_DEVICE if it is set, else auto.
    #[arg(long, value_enum, value_name = "DEVICE")]
    pub device: Option<Device>,
    /// Small meshes, small batches, few repetitions: a minute.
    #[arg(long)]
    pub quick: bool,
    /// Run whole simulations (press and shear of an ideally plastic sphere) instead: on one core,
    /// on all cores, and on the device in batches of 1 to 256 (with --quick, 1 and 2). The smallest
    /// and the largest batch are then repeated to measure the time and bytes of each kernel.
    #[arg(long)]
    pub whole_job: bool,
    /// Elements along the contact radius of the mesh, 2 to 32; by default 8, with --quick 4.
    #[arg(long, value_name = "N")]
    pub elements: Option<usize>,
    /// Write the results to this file, as JSON.
    #[arg(long, alias = "export", value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Print that JSON instead of the table.
    #[arg(long)]
    pub json: bool,
    /// Number of threads; by default all of the machine's.
    #[arg(long, value_name = "N")]
    pub threads: Option<NonZeroUsize>,
    /// How much to say.
    #[command(flatten)]
    pub verbosity: Verbosity,
}

/// Measures, prints the table and writes the numbers.
pub fn bench(args: &BenchArgs) -> Result<Exit, CliError> {
    args.verbosity.start_log();
    let device = match device_or_variable(args.device) {
        DeviceChoice::Auto => bench::BenchDevice::Auto,
        DeviceChoice::Cpu => bench::BenchDevice::Cpu,
        DeviceChoice::Gpu => bench::BenchDevice::Gpu,
    };
    let threads = args.threads.or_else(|| std::thread::available_parallelism().ok()).map_or(1, NonZeroUsize::get);
    let mut options = if args.quick { Options::quick(device, threads) } else { Options::full(device, threads) };
    options.elements = args.elements.unwrap_or(options.elements);
    if let Some(path) = args.out.as_ref().filter(|path| !path.exists()) {
        // Minutes of measuring are not lost to a file that cannot be written.
        write_own(path, |_| Ok(()))?;
    }
    let quiet = args.verbosity.quiet;
    let mut say = |text: &str| {
        if !quiet {
            // A closed stderr is no reason to stop measuring.
            let _ = writeln!(std::io::stderr(), "{text}");
        }
    };
    if args.whole_job {
        return whole_job(args, &options, &mut say);
    }
    let report = bench::run(&options, &mut say).map_err(|error| match error {
        BenchError::Device(error) => CliError::Device { what: error.to_string() },
        error => CliError::Bench(error),
    })?;
    super::print(&if args.json { report.to_json() } else { table::table(&report) })?;
    if let Some(path) = &args.out {
        write_own(path, |file| file.write_all(report.to_json().as_bytes()))?;
    }
    Ok(Exit::Done)
}

/// Runs whole jobs, prints their table and writes the numbers.
fn whole_job(args: &BenchArgs, options: &Options, say: &mut dyn FnMut(&str)) -> Result<Exit, CliError> {
    let device = match device_or_variable(args.device) {
        // Without a device worth using there are the CPU's rows alone.
        DeviceChoice::Auto if !select::is_there(DeviceChoice::Auto).unwrap_or(false) => DeviceChoice::Cpu,
        choice => choice,
    };
    let batches = if args.quick { vec![1, 2] } else { vec![1, 4, 16, 64, 256] };
    let jobs = WholeJobs { device, threads: options.threads, batches, elements: options.elements, copied: options.copied };
    let report = whole_job::run(&jobs, say).map_err(|error| match error {
        BenchError::Study(error) => CliError::from(error),
        error => CliError::Bench(error),
    })?;
    let json = || serde_json::to_string_pretty(&report).unwrap_or_default() + "\n";
    super::print(&if args.json { json() } else { whole_job::tables(&report) })?;
    if let Some(path) = &args.out {
        write_own(path, |file| file.write_all(json().as_bytes()))?;
    }
    Ok(Exit::Done)
}
