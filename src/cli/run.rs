//! `asperity run`: one case, from its file to its results.

use std::io::Write;
use std::path::PathBuf;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use clap::Args;

use super::backend::choose_backend;
use super::force::{Earlier, claim, tidy};
use super::options::{DeviceArgs, Verbosity};
use super::resume::{Standing, refused, standing};
use super::signals::stop_flag;
use super::{CliError, Outcome, out};
use crate::case::Case;
use crate::compute::ComputeError;
use crate::output::companion;
use crate::output::{Checkpoint, Clock, OutputDirectory, ResultWriter, Setting, Status, Summary, progress};
use crate::simulation::SimulationError;
use crate::simulation::drive::{Drive, Ending, Observer};
use crate::simulation::problem::Problem;

/// Simulate one case.
#[derive(Clone, Debug, Args)]
pub struct RunArgs {
    /// The case file.
    #[arg(value_name = "CASE.toml")]
    pub case: PathBuf,
    /// Directory for the results: a new one, an empty one, or with --resume or --force one that holds an earlier result.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Replace a value of the case, as in contact.friction=0.1 or path.0.indentation=0.01; may be repeated.
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Go on with an unfinished run of the same case in DIR, from its last checkpoint and to the same results as if it had never stopped. Without one
    /// the run starts from its beginning; one that is done stays as it is. So batch scripts may always give it.
    #[arg(long)]
    pub resume: bool,
    /// Replace an earlier result in DIR, whatever it is of and however far it is.
    #[arg(long, conflicts_with = "resume")]
    pub force: bool,
    /// Seconds between checkpoints, for tests.
    #[arg(long, value_name = "SECONDS", hide = true, value_parser = clap::value_parser!(u16))]
    pub checkpoint_every: Option<u16>,
    /// Device, precision, threads.
    #[command(flatten)]
    pub device: DeviceArgs,
    /// How much to say.
    #[command(flatten)]
    pub verbosity: Verbosity,
}

/// Loads and checks the case, prepares the directory or goes on with what is in it, simulates, and reports.
pub fn run(args: &RunArgs) -> Result<Outcome, CliError> {
    let clock = Clock::start();
    args.verbosity.start_log();
    args.device.start_threads()?;
    let case = Case::load(&args.case, &args.set)?;
    let earlier = match (args.force, args.resume) {
        (true, _) => Earlier::Replace,
        (_, true) => Earlier::Resume,
        _ => Earlier::Keep,
    };
    // Kept until the end: nobody else writes there.
    let _lock = claim(&args.out, &case, earlier, args.verbosity.quiet)?;
    let checkpoint = match args.resume.then(|| standing(&args.out, &case)).transpose()? {
        Some(Standing::Ended(summary)) => return ended(&summary, args),
        Some(Standing::Unfinished(checkpoint)) => Some(*checkpoint),
        Some(Standing::NotBegun) | None => None,
    };
    let bad_case = |source: SimulationError| CliError::Problem { file: args.case.clone(), source };
    let problem = Problem::new(&case).map_err(bad_case)?;
    let selected = choose_backend(&args.device, vec![problem.model.clone()]).map_err(|error| match error {
        ComputeError::Device(what) => CliError::Device { what },
        error => bad_case(error.into()),
    })?;
    let mut backend = selected.backend;
    let newton = problem.newton().map_err(bad_case)?;
    let stop = stop_flag()?;
    let setting = Setting {
        computed_on: backend.description(),
        elements: problem.model.mesh.elements.len(),
        unknowns: newton.free_unknowns(),
    };
    let mut drive = Drive::new(&problem, backend.as_mut(), 0, newton);
    match &checkpoint {
        Some(checkpoint) => {
            checkpoint.check_precision(&OutputDirectory::existing(&args.out).checkpoint(), setting.computed_on.precision)?;
            drive.resume(checkpoint.snapshot()).map_err(|error| refused(&args.out, &error.to_string()))?;
        }
        None => out::prepare(&args.out, &case)?,
    }
    let progress = progress(args.verbosity.quiet);
    let mut results = ResultWriter::create(&case, &args.out, setting, clock, progress, stop.clone(), checkpoint.as_ref())?;
    if let Some(seconds) = args.checkpoint_every {
        results = results.with_checkpoints_every(Duration::from_secs(seconds.into()));
    }
    match &checkpoint {
        Some(checkpoint) => results.tell(&resumed(checkpoint, args)),
        None if args.resume => results.tell(&format!("nothing to resume in {}: from the beginning", args.out.display())),
        None => {}
    }
    // A resumed run has noted them before.
    selected.notes.iter().filter(|_| checkpoint.is_none()).for_each(|note| results.note(note));
    let mut followed = drive.run(&mut results);
    let estimates = matches!(followed, Ok(Ending::Done)) && case.solver.error_estimate;
    if estimates {
        // Whatever becomes of the companion, the path has not to be followed again.
        drive.checkpoint(true, &mut results);
    }
    // Not where it began, if the device failed on the way.
    results.computed_on(backend.description());
    drop(backend);
    if estimates {
        let begun = Instant::now();
        let companion = companion::companion(&case);
        let elements = [&case, &companion].map(|c| c.mesh.elements_per_contact_radius);
        log::info!("error estimate: the same path on {} elements per contact radius", elements[1]);
        match companion::follow(&companion, stop.clone()) {
            Ok(rows) => results.compare(elements[0], &rows, elements[1]),
            Err(_) if stop.load(Ordering::Relaxed) => followed = Ok(Ending::Interrupted),
            Err(reason) => results.note(&format!("no error estimate, the run on {} elements ended: {reason}", elements[1])),
        }
        results.estimate_took(begun.elapsed().as_secs_f64());
    }
    conclude(followed, results, args)
}

/// Says that a run that was to go on has ended before: as it did then.
fn ended(summary: &Summary, args: &RunArgs) -> Result<Outcome, CliError> {
    let (steps, dir) = (summary.steps, args.out.display());
    tidy(&args.out);
    if summary.status == Status::Done {
        if !args.verbosity.quiet {
            super::print(&format!("already done: {steps} steps on {}; results in {dir}\n", summary.device))?;
        }
        return Ok(Outcome::Done);
    }
    let reason = summary.messages.last().map_or_else(|| summary.status.to_string(), Clone::clone);
    // A closed stderr does not change how the run went.
    let _ = writeln!(
        std::io::stderr(),
        "error: ended before: {reason}. what was computed is kept in {dir} ({steps} steps); to compute it again, run with --force and without --resume"
    );
    Ok(Outcome::NotConverged)
}

fn resumed(checkpoint: &Checkpoint, args: &RunArgs) -> String {
    format!("resumed after step {} of the run in {}", checkpoint.step(), args.out.display())
}

/// Writes the end of the results, says how it went, and gives the exit code.
fn conclude(followed: Result<Ending, SimulationError>, results: ResultWriter, args: &RunArgs) -> Result<Outcome, CliError> {
    let (steps, dir) = (results.steps(), args.out.display());
    let broke_off = |what: String| CliError::BrokeOff { steps, what, dir: args.out.clone() };
    let kept = format!("what was computed is kept in {dir} ({steps} steps)");
    let (status, outcome, message) = match followed {
        Ok(Ending::Done) => (Status::Done, Outcome::Done, None),
        Ok(Ending::NotConverged(reason)) => {
            (Status::NotConverged, Outcome::NotConverged, Some(format!("no convergence: {reason}")))
        }
        Ok(Ending::Outgrown(reason)) => (Status::ContactOutgrewMesh, Outcome::NotConverged, Some(reason)),
        Ok(Ending::Interrupted) => {
            let reason = format!("interrupted by a signal after step {steps}; to go on, run the same command with --resume");
            (Status::Interrupted, Outcome::Interrupted, Some(reason))
        }
        Err(error) => {
            let what = error.to_string();
            // The disk may be full: what can still be written is written, and the first error is the one to tell.
            let _ = results.finish(Status::Interrupted, Some(&what));
            return Err(broke_off(what));
        }
    };
    let summary = results.finish(status, message.as_deref()).map_err(|error| broke_off(error.to_string()))?;
    if !args.verbosity.quiet {
        super::print(&format!("{}results in {dir}\n", summary.report()))?;
    }
    if let Some(message) = message {
        // A closed stderr does not change how the run went.
        let _ = writeln!(std::io::stderr(), "error: {message}. {kept}");
    }
    Ok(outcome)
}
