//! `asperity run`: one case, from its file to its results.

use std::io::Write;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::Args;

use super::backend::choose_backend;
use super::force::{Earlier, claim, tidy};
use super::input::Input;
use super::options::{DeviceArgs, Verbosity};
use super::resume::{Standing, refused, standing};
use super::signals::stop_flag;
use super::{CliError, Outcome, out};
use crate::case::BYTES_PER_ELEMENT;
use crate::compute::ComputeError;
use crate::compute::select::Selected;
use crate::output::{
    Checkpoint, Clock, LoggedProgress, OutputDirectory, Progress, ResultWriter, Setting, Status, Summary, progress,
};
use crate::simulation::SimulationError;
use crate::simulation::drive::{Ending, Observer};
use crate::simulation::follow::{follow, seats};
use crate::simulation::problem::Problem;
use crate::simulation::scout::{Scout, scout};

/// The cost of a Newton iteration grows with this power of the number of elements.
const COST_EXPONENT: f64 = 1.1;

/// Simulate one case.
#[derive(Clone, Debug, Args)]
pub struct RunArgs {
    /// The case file; `-` for standard input.
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
    let input = Input::read(&args.case)?;
    let case = input.case(&args.set)?;
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
    let bad_case = |source: SimulationError| CliError::Problem { file: input.name.clone().into(), source };
    let open = |problem: &Problem| choose_backend(&args.device, vec![problem.model.clone()]);
    let mut problem = Problem::on(&case, checkpoint.as_ref().and_then(Checkpoint::zone)).map_err(bad_case)?;
    let Selected { backend, notes } = open(&problem).map_err(|error| match error {
        ComputeError::Device(what) => CliError::Device { what },
        error => bad_case(error.into()),
    })?;
    let stop = stop_flag()?;
    let computed_on = backend.description();
    let mut seat = seats((backend, 0), problem.zone, open);
    match &checkpoint {
        Some(checkpoint) => {
            checkpoint.check_precision(&OutputDirectory::existing(&args.out).checkpoint(), computed_on.precision)?;
            checkpoint.snapshot().check(&problem.model.mesh).map_err(|error| refused(&args.out, &error.to_string()))?;
        }
        None => out::prepare(&args.out, &case)?,
    }
    let head = format!("asperity {}: {}", env!("CARGO_PKG_VERSION"), command_line());
    let log = LoggedProgress::new(progress(args.verbosity.quiet), &OutputDirectory::existing(&args.out), &head);
    let mut progress: Box<dyn Progress> = Box::new(log);
    let begun = Instant::now();
    let scouts = checkpoint.is_none() && case.solver.error_estimate;
    let scout = if scouts {
        log::info!("coarse run, for the reach of the contact and the error estimate:");
        scout(&case, &stop).map_err(bad_case)?
    } else {
        None
    };
    let stopped = scouts && scout.is_none();
    let scout_took = begun.elapsed().as_secs_f64();
    if let Some(scout) = &scout {
        let zone = scout.zone(problem.zone, problem.spacing);
        if zone != problem.zone {
            problem = Problem::on(&case, Some(zone)).map_err(bad_case)?;
        }
        progress.message(&forecast(scout, &problem, scout_took));
    }
    let setting = Setting { computed_on, elements: problem.model.mesh.elements.len(), unknowns: problem.free_unknowns() };
    let mut results = ResultWriter::create(&case, &args.out, setting, clock, progress, stop.clone(), checkpoint.as_ref())?;
    results.meshed(&problem);
    if let Some(seconds) = args.checkpoint_every {
        results = results.with_checkpoints_every(Duration::from_secs(seconds.into()));
    }
    match &checkpoint {
        Some(checkpoint) => results.tell(&resumed(checkpoint, args)),
        None if args.resume => results.tell(&format!("nothing to resume in {}: from the beginning", args.out.display())),
        None => {}
    }
    // A resumed run has noted them before.
    notes.iter().filter(|_| checkpoint.is_none()).for_each(|note| results.note(note));
    if let Some(scout) = scout {
        let asked = Problem::zone_of(&case).map_err(bad_case)?;
        if problem.zone != asked {
            results.note(&format!(
                "the contact leaves the zone of {:.4} R around the pole that would be meshed finely: meshed to {:.4} R, with elements of {:.5} R",
                asked.radius(),
                problem.zone.radius(),
                problem.spacing
            ));
        }
        results.scouted(scout, scout_took);
    }
    if stopped {
        // Without a checkpoint: the run will begin with its coarse run again.
        return conclude(Ok(Ending::Interrupted), results, args);
    }
    log::info!("the run:");
    let followed = follow(problem, checkpoint.as_ref().map(Checkpoint::snapshot), &mut seat, &mut results);
    let ending = followed.map(|followed| {
        // Not where it began, if the device failed on the way.
        results.computed_on(followed.computed_on);
        followed.ending
    });
    conclude(ending, results, args)
}

/// The arguments of the program, as they would be typed.
fn command_line() -> String {
    let quoted = |arg: String| if arg.contains([' ', '"', '[', '{']) { format!("'{arg}'") } else { arg };
    std::env::args_os().skip(1).map(|arg| quoted(arg.to_string_lossy().into_owned())).collect::<Vec<_>>().join(" ")
}

/// What the coarse run tells of the run: its size, and about how long it will take in the same place.
fn forecast(scout: &Scout, problem: &Problem, scout_seconds: f64) -> String {
    let elements = problem.model.mesh.elements.len();
    let refinement = scout.spacing / problem.spacing;
    let seconds = scout_seconds * refinement * (elements as f64 / scout.mesh_elements.max(1) as f64).powf(COST_EXPONENT);
    format!(
        "{elements} elements; about {:.1} GiB and, if the coarse run on {} elements is a measure, {seconds:.0} s",
        elements as f64 * BYTES_PER_ELEMENT / f64::from(1 << 30),
        scout.mesh_elements
    )
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
        Ok(Ending::Outgrown(outgrowth)) => {
            let reason = format!("{outgrowth}; there is no larger mesh");
            (Status::ContactOutgrewMesh, Outcome::NotConverged, Some(reason))
        }
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
