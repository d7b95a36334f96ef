//! `asperity study`: a grid of cases, from its file to a row each.

use std::io::Write;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::Ordering;

use clap::{Args, ValueEnum};

use super::backend::{device_choice, precision_choice};
use super::input::InputFile;
use super::options::{DeviceArgs, PrecisionOption, Verbosity, out_or_name};
use super::signals::stop_flag;
use super::{CliError, Exit, cluster};
use crate::compute::ComputeError;
use crate::study::{self, Options, Report, Shard, Study, StudyError, StudyProgress};

/// Simulate every combination of a grid of cases.
///
/// Each case has a directory and a row in study.csv. A case that fails does not stop the others;
/// its row says why. An interrupted study continues with --resume.
#[derive(Clone, Debug, Args)]
pub struct StudyArgs {
    /// The study file: a case under `base`, and values of its keys under `grid`, `zip` or `list`.
    #[arg(value_name = "STUDY.toml", required_unless_present = "merge", conflicts_with = "merge")]
    pub study: Option<PathBuf>,
    /// Directory for the results: new or empty, or with an earlier study if --resume, --shard or
    /// --force is given. By default it has the name of the study file, without its extension.
    #[arg(long, value_name = "DIR", required_if_eq("study", "-"), required_unless_present = "study")]
    pub out: Option<PathBuf>,
    /// Compute only the I-th of N shares of about equal size. Several machines may work in one
    /// directory, one share each; `--resume` without a share then collects all rows.
    #[arg(long, value_name = "I/N")]
    pub shard: Option<Shard>,
    /// Continue a study in DIR. Finished cases are kept; interrupted ones continue from their
    /// checkpoints, or start again if there are none. The grid may have grown; cases that no longer
    /// belong to it are listed and kept.
    #[arg(long)]
    pub resume: bool,
    /// Replace an earlier study in DIR, even another one.
    #[arg(long, conflicts_with = "resume")]
    pub force: bool,
    /// With --resume: also repeat cases that did not converge or whose contact outgrew the mesh.
    #[arg(long, requires = "resume")]
    pub retry: bool,
    /// Compute nothing; write scripts for Slurm to DIR/slurm: a job array of shares, then a job
    /// that makes the table. Keys: tasks=N, the number of shares (4); at-once=N, how many run at a
    /// time; warning=SECONDS, how long before the time limit a task is told to stop (60). Other
    /// keys are options of sbatch, as in time=02:00:00 partition=long mem=4G cpus-per-task=2.
    #[arg(long, value_name = "KEY=VALUE", num_args = 0.., conflicts_with_all = ["shard", "force", "merge"])]
    pub slurm: Option<Vec<String>>,
    /// With --slurm: submit the scripts.
    #[arg(long, requires = "slurm")]
    pub submit: bool,
    /// Compute nothing; join these directories, each with shares of one study, in the directory of
    /// --out, which may be one of them.
    #[arg(long, value_name = "DIR", num_args = 1.., conflicts_with_all = ["shard", "force", "resume"])]
    pub merge: Option<Vec<PathBuf>>,
    /// Device, precision, threads.
    #[command(flatten)]
    pub device: DeviceArgs,
    /// How much to say.
    #[command(flatten)]
    pub verbosity: Verbosity,
}

/// Reads and checks the study, computes what there is to compute, and reports.
pub fn study(args: &StudyArgs) -> Result<Exit, CliError> {
    args.verbosity.start_log();
    // Clap lets no study pass without its file, and nothing be merged without --out.
    let file = args.study.as_deref().unwrap_or(Path::new(""));
    let out = out_or_name(args.out.as_ref(), file, "");
    if let Some(sources) = &args.merge {
        return cluster::merge(sources, &out, args.verbosity.quiet);
    }
    args.device.start_threads()?;
    let study = InputFile::read(file)?.study()?;
    if let Some(arguments) = &args.slurm {
        return cluster::slurm(&study, arguments, &out, &options_of_tasks(args), args.submit);
    }
    let options =
        Options { shard: args.shard, resume: args.resume, retry: args.retry, force: args.force, ..options(&args.device) };
    let (report, interrupted) = compute(&study, &out, &options, args.verbosity.quiet)?;
    conclude(&report, interrupted, &out, args.verbosity.quiet)
}

/// The options of this command that the tasks are to have too.
fn options_of_tasks(args: &StudyArgs) -> Vec<String> {
    let mut options = Vec::new();
    if let Some(device) = args.device.device {
        options.extend(device.to_possible_value().map(|value| format!("--device={}", value.get_name())));
    }
    if args.device.precision != PrecisionOption::default() {
        options.extend(args.device.precision.to_possible_value().map(|value| format!("--precision={}", value.get_name())));
    }
    if args.retry {
        options.push("--retry".to_owned());
    }
    options
}

/// A whole study, begun anew, on the device and the threads that the arguments name.
pub(super) fn options(device: &DeviceArgs) -> Options {
    let all_cores = || std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN);
    Options {
        device: device_choice(device),
        precision: precision_choice(device),
        threads: device.threads.unwrap_or_else(all_cores).get(),
        shard: None,
        resume: false,
        retry: false,
        force: false,
    }
}

/// Computes what there is to compute of a study until that is done or a signal stops it; returns
/// whether one did.
pub(super) fn compute(study: &Study, out: &Path, options: &Options, quiet: bool) -> Result<(Report, bool), CliError> {
    let stop = stop_flag()?;
    let report =
        study::run(study, out, options, Arc::new(StudyProgress::new(quiet)), stop.clone()).map_err(|error| match error {
            StudyError::Compute(ComputeError::Device(what)) => CliError::Device { what },
            error => error.into(),
        })?;
    Ok((report, stop.load(Ordering::Relaxed)))
}

/// Says how it went and gives the exit code.
fn conclude(report: &Report, interrupted: bool, out: &Path, quiet: bool) -> Result<Exit, CliError> {
    let (dir, Report { done, failed, pending, .. }) = (out.display(), report);
    if !quiet {
        let elsewhere = match report.pending_elsewhere {
            0 => String::new(),
            count => format!(", {count} of other shares pending"),
        };
        super::print(&format!("{done} done, {failed} failed, {pending} pending{elsewhere}; a row each in {dir}/study.csv\n"))?;
    }
    // A closed stderr does not change how the study went.
    if *pending > 0 {
        let busy = report.pending_reason.as_ref().filter(|_| !interrupted);
        let why = busy.map_or("interrupted by a signal".to_owned(), |reason| format!("ended ({reason})"));
        let _ = writeln!(
            std::io::stderr(),
            "error: {why} with {pending} cases to go. What was computed is kept in {dir}; to go on, run the same command with --resume"
        );
        return Ok(Exit::Interrupted);
    }
    if let Some((id, reason)) = &report.first_failure {
        let _ = writeln!(
            std::io::stderr(),
            "error: {failed} of {} cases failed, the first in {dir}/cases/{id}: {reason}. all rows are kept in {dir}/study.csv",
            done + failed
        );
        return Ok(Exit::CasesFailed);
    }
    Ok(Exit::Done)
}
