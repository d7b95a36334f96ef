//! `asperity run`: one case, from its file to its results.

use std::io::Write;
use std::path::PathBuf;
use std::time::Instant;

use clap::Args;

use super::backend::choose_backend;
use super::options::{DeviceArgs, Verbosity};
use super::signals::stop_flag;
use super::{CliError, Outcome, companion, out};
use crate::case::Case;
use crate::compute::ComputeError;
use crate::output::{Clock, ResultWriter, Setting, Status, progress};
use crate::simulation::SimulationError;
use crate::simulation::drive::{Drive, Ending, Observer};
use crate::simulation::problem::Problem;

/// Simulate one case.
#[derive(Clone, Debug, Args)]
pub struct RunArgs {
    /// The case file.
    #[arg(value_name = "CASE.toml")]
    pub case: PathBuf,
    /// Directory for the results: a new one, an empty one, or one that holds an earlier result, which is replaced.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Replace a value of the case, as in contact.friction=0.1 or path.0.indentation=0.01; may be repeated.
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Device, precision, threads.
    #[command(flatten)]
    pub device: DeviceArgs,
    /// How much to say.
    #[command(flatten)]
    pub verbosity: Verbosity,
}

/// Loads and checks the case, prepares the directory, simulates, and reports.
pub fn run(args: &RunArgs) -> Result<Outcome, CliError> {
    let clock = Clock::start();
    args.verbosity.start_log();
    args.device.start_threads()?;
    let case = Case::load(&args.case, &args.set)?;
    let bad_case = |source: SimulationError| CliError::Problem { file: args.case.clone(), source };
    let problem = Problem::new(&case).map_err(bad_case)?;
    let selected = choose_backend(&args.device, vec![problem.model.clone()]).map_err(|error| match error {
        ComputeError::Device(what) => CliError::Device { what },
        error => bad_case(error.into()),
    })?;
    let mut backend = selected.backend;
    let newton = problem.newton().map_err(bad_case)?;
    let stop = stop_flag()?;
    out::prepare(&args.out, &case)?;

    let setting = Setting {
        computed_on: backend.description(),
        elements: problem.model.mesh.elements.len(),
        unknowns: newton.free_unknowns(),
    };
    let mut results = ResultWriter::create(&case, &args.out, setting, clock, progress(args.verbosity.quiet), stop.clone())?;
    selected.notes.iter().for_each(|note| results.note(note));
    let followed = Drive::new(&problem, backend.as_mut(), 0, newton).run(&mut results);
    // Not where it began, if the device failed on the way.
    results.computed_on(backend.description());
    drop(backend);
    if matches!(followed, Ok(Ending::Done)) && case.solver.error_estimate {
        let begun = Instant::now();
        let companion = companion::companion(&case);
        let elements = [&case, &companion].map(|c| c.mesh.elements_per_contact_radius);
        log::info!("error estimate: the same path on {} elements per contact radius", elements[1]);
        match companion::follow(&companion, stop) {
            Ok(rows) => results.compare(elements[0], &rows, elements[1]),
            Err(reason) => results.note(&format!("no error estimate, the run on {} elements ended: {reason}", elements[1])),
        }
        results.estimate_took(begun.elapsed().as_secs_f64());
    }
    conclude(followed, results, args)
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
            let reason =
                format!("interrupted by a signal after step {steps}; to compute the whole path, run the same command again");
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
