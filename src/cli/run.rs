//! `asperity run`: one case, from its file to its results.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::Args;

use super::backend::{device_choice, precision_choice};
use super::input::InputFile;
use super::options::{DeviceArgs, Verbosity, out_or_name};
use super::signals::stop_flag;
use super::{CliError, Exit, called};
use crate::output::{LoggedProgress, OutputDirectory, RESULT_MARKER, RunStatus, progress, refuse_input};
use crate::quoting;
use crate::session::{Canceller, Earlier, Options, SessionError, Simulation};

/// Simulate one case.
#[derive(Clone, Debug, Args)]
pub struct RunArgs {
    /// The case file; `-` for standard input.
    #[arg(value_name = "CASE.toml")]
    pub case: PathBuf,
    /// Directory for the results: new or empty, or with earlier results if --resume, --extend or
    /// --force is given. By default it has the name of the case file, without its extension.
    #[arg(long, value_name = "DIR", required_if_eq("case", "-"))]
    pub out: Option<PathBuf>,
    /// Replace a value of the case, as in contact.friction=0.1 or path.0.indentation=0.01. May be
    /// repeated.
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Continue an unfinished run of the same case in DIR from its last checkpoint, with the same
    /// results as if it had never stopped. Without a checkpoint the run starts from the beginning,
    /// and a finished run is left as it is; a batch script can therefore always give this option.
    #[arg(long)]
    pub resume: bool,
    /// Continue the finished run in DIR along a longer path: its case with segments added after the
    /// last one. The results are those of the longer path from the beginning; if that path needs
    /// another mesh, the extension is refused.
    #[arg(long, conflicts_with = "resume")]
    pub extend: bool,
    /// Replace earlier results in DIR, even those of another case.
    #[arg(long, conflicts_with_all = ["resume", "extend"])]
    pub force: bool,
    /// Seconds between checkpoints, for tests; 0 is after every step.
    #[arg(long, value_name = "SECONDS", hide = true, value_parser = clap::value_parser!(u16))]
    pub checkpoint_every: Option<u16>,
    /// Device, precision, threads.
    #[command(flatten)]
    pub device: DeviceArgs,
    /// How much to say.
    #[command(flatten)]
    pub verbosity: Verbosity,
}

/// Loads and checks the case, prepares the directory or goes on with what is in it, simulates, and
/// reports.
pub fn run(args: &RunArgs) -> Result<Exit, CliError> {
    args.verbosity.start_log();
    args.device.start_threads()?;
    let input = InputFile::read(&args.case)?;
    let case = input.case(&args.set)?;
    let out = out_or_name(args.out.as_ref(), &args.case, "");
    let written = OutputDirectory::existing(&out).case();
    if input.text != format!("{RESULT_MARKER}\n{}", case.to_toml()) {
        refuse_input(&written, &[&args.case])?;
    }
    let options = Options {
        device: device_choice(&args.device),
        precision: precision_choice(&args.device),
        // The pool of the whole program has their number.
        threads: None,
        out: Some(out.clone()),
        earlier: match (args.force, args.resume, args.extend) {
            (true, _, _) => Earlier::Replace,
            (_, true, _) => Earlier::Resume,
            (_, _, true) => Earlier::Extend,
            _ => Earlier::Keep,
        },
        checkpoint_every: args.checkpoint_every.map(|seconds| Duration::from_secs(seconds.into())),
        canceller: Canceller::on_signal(stop_flag()?),
    };
    let in_case = |error: SessionError| match error {
        // The same with its line.
        SessionError::Case(error) => input.check_room(&case, &args.set).err().unwrap_or_else(|| error.into()),
        SessionError::Device { what } => CliError::Device { what },
        SessionError::Simulation(source) => CliError::Problem { file: input.name.clone().into(), source },
        error => error.into(),
    };
    let mut simulation = Simulation::with(&case, options).map_err(in_case)?;
    if !args.verbosity.quiet {
        // A closed stderr does not change how the run goes.
        simulation.notes().iter().for_each(|note| drop(writeln!(std::io::stderr(), "{note}")));
    }
    if simulation.outcome().is_none() {
        let head = format!("asperity {}: {}", env!("CARGO_PKG_VERSION"), command_line());
        let log = LoggedProgress::new(progress(args.verbosity.quiet), &OutputDirectory::existing(&out), &head);
        simulation = simulation.watched_by(Box::new(log));
    }
    let outcome = simulation.run().map_err(in_case)?;
    report(&outcome, simulation.history().len(), &out, &args.verbosity)
}

/// The arguments of the program, as they would be typed.
fn command_line() -> String {
    called::arguments().into_iter().skip(1).map(quoting::word).collect::<Vec<_>>().join(" ")
}

/// Says how it went, and gives the exit code.
fn report(outcome: &crate::session::Outcome, steps: usize, out: &Path, verbosity: &Verbosity) -> Result<Exit, CliError> {
    let (summary, dir, quiet) = (&outcome.summary, out.display(), verbosity.quiet);
    let code = match outcome.status {
        RunStatus::Done => Exit::Done,
        RunStatus::Interrupted => Exit::Interrupted,
        RunStatus::NotConverged | RunStatus::ContactOutgrewMesh | RunStatus::Failed => Exit::NotConverged,
    };
    let error = if outcome.ended_before {
        if outcome.is_done() && !quiet {
            super::print(&format!("already done: {} steps on {}; results in {dir}\n", summary.steps, summary.device))?;
        }
        let reason = outcome.message.clone().unwrap_or_else(|| summary.status.to_string());
        format!(
            "ended before: {reason}. What was computed is kept in {dir} ({} steps); to compute it again, run with --force and without --resume",
            summary.steps
        )
    } else {
        if !quiet {
            let text = if verbosity.verbose > 0 { summary.report() } else { summary.brief() };
            super::print(&format!("{text}results in {dir}\n"))?;
        }
        let message = outcome.message.clone().unwrap_or_default();
        format!("{message}. What was computed is kept in {dir} ({steps} steps)")
    };
    if !outcome.is_done() {
        // A closed stderr does not change how the run went.
        let _ = writeln!(std::io::stderr(), "error: {error}");
    }
    Ok(code)
}
