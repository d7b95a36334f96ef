//! `asperity prove`: a device against the CPU, in one file to pass on.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::options::Verbosity;
use super::{CliError, Exit};
use crate::bench::BenchError;
use crate::compute::gpu::{DeviceRequest, GpuError};
use crate::output::{refuse_foreign, write_own};
use crate::prove::progress::ProveProgress;
use crate::prove::{self, Options, ProofPart, page};

/// Which device is proved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Proved {
    /// The GPU that a run would take, and an error without a real one.
    Auto,
    /// A GPU; a software adapter if there is nothing else.
    #[default]
    Gpu,
}

/// A part of what is proved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ProvedPart {
    /// Each kernel against the CPU.
    Kernels,
    /// Nine whole cases against the CPU.
    Cases,
    /// Latency, copies and whole jobs.
    Times,
}

impl From<ProvedPart> for ProofPart {
    fn from(part: ProvedPart) -> Self {
        match part {
            ProvedPart::Kernels => Self::Kernels,
            ProvedPart::Cases => Self::Cases,
            ProvedPart::Times => Self::Times,
        }
    }
}

/// Compare a GPU with the CPU, in results and in speed.
///
/// Compares the limits of the GPU with what the kernels need, and each kernel and the cases of
/// fixtures/studies/parity.toml with the CPU. Measures latency, copies, and whole jobs in batches.
/// Writes a report as JSON and as Markdown, without the names of host and user. Exit code 3 means
/// that results disagree, 2 that there is no GPU.
#[derive(Clone, Debug, Args)]
pub struct ProveArgs {
    /// The file for the report, as JSON; the page beside it ends in .md.
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
    /// Fewer comparisons, and only small jobs: two minutes on a software driver with two cores.
    #[arg(long)]
    pub quick: bool,
    /// Only this part. May be repeated.
    #[arg(long, value_enum, value_name = "PART")]
    pub only: Vec<ProvedPart>,
    /// Which device.
    #[arg(long, value_enum, default_value_t, value_name = "DEVICE")]
    pub device: Proved,
    /// Number of threads; by default all of the machine's.
    #[arg(long, value_name = "N")]
    pub threads: Option<NonZeroUsize>,
    /// How much to say.
    #[command(flatten)]
    pub verbosity: Verbosity,
}

/// Compares, measures, writes both files and says how it went.
pub fn prove(args: &ProveArgs) -> Result<Exit, CliError> {
    args.verbosity.start_log();
    let request = match args.device {
        Proved::Auto => DeviceRequest::Auto,
        Proved::Gpu => DeviceRequest::Gpu,
    };
    let threads = args.threads.or_else(|| std::thread::available_parallelism().ok()).map_or(1, NonZeroUsize::get);
    let only = args.only.iter().copied().map(ProofPart::from).collect();
    let options = Options { only, request, threads, quick: args.quick };
    // Minutes of measuring are not lost to a file that cannot be written.
    let markdown = args.out.with_extension("md");
    for path in [&args.out, &markdown] {
        refuse_foreign(path)?;
    }
    // Asked for before anything is written.
    let refused = |error: GpuError| CliError::Prove { what: error.to_string() };
    if prove::open(request).map_err(refused)?.is_none() {
        let what = "auto finds no GPU that it may take. --device gpu takes a software adapter too; `asperity devices` says what is \
                    there";
        return Err(CliError::Prove { what: what.to_owned() });
    }
    for path in [&args.out, &markdown].into_iter().filter(|path| !path.exists()) {
        write_own(path, |_| Ok(()))?;
    }
    let mut progress = ProveProgress::new(args.verbosity.quiet, prove::work(&options));
    let report = prove::run(&options, &mut progress).map_err(|error| match error {
        BenchError::Device(error) => refused(error),
        error => CliError::Bench(error),
    })?;
    progress.ends();
    write_own(&args.out, |file| file.write_all(report.to_json().as_bytes()))?;
    write_own(&markdown, |file| file.write_all(page::page(&report).as_bytes()))?;
    if !args.verbosity.quiet {
        super::print(&format!("{}report in {} and {}\n", prove::verdict(&report), args.out.display(), markdown.display()))?;
    }
    Ok(if report.agrees() { Exit::Done } else { Exit::ChecksFailed })
}
