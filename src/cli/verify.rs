//! `asperity verify`: closed-form checks as a table.

use std::io::Write;
use std::path::PathBuf;

use clap::Args;
use clap::builder::PossibleValuesParser;

use super::backend::choose_backend;
use super::options::{DeviceArgs, Verbosity};
use super::{CliError, Exit};
use crate::compute::ComputeError;
use crate::output::write_own;
use crate::verify::{Check, FAMILIES, Fineness, Runner, Verdict, VerificationReport, VerifyError, names, table};

/// Compare this build with closed-form solutions.
///
/// Prints result, reference, error, tolerance and verdict of each check; exit code 3 means that one
/// failed. The reason of each tolerance is printed by -v and written by --out.
#[derive(Clone, Debug, Args)]
pub struct VerifyArgs {
    /// Use 16 elements along the contact radius in all checks; by default some use fewer, to finish
    /// in a minute or two.
    #[arg(long)]
    pub fine: bool,
    /// Run only this family of checks, or this check of the table. May be repeated.
    #[arg(long, value_name = "NAME", value_parser = PossibleValuesParser::new(names()))]
    pub only: Vec<String>,
    /// Write the checks with the reasons of their tolerances to this file, as JSON.
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Print that JSON instead of the table.
    #[arg(long)]
    pub json: bool,
    /// Device, precision, threads.
    #[command(flatten)]
    pub device: DeviceArgs,
    /// How much to say.
    #[command(flatten)]
    pub verbosity: Verbosity,
}

/// Runs the checks, a family at a time, and prints the table.
pub fn verify(args: &VerifyArgs) -> Result<Exit, CliError> {
    args.verbosity.start_log();
    args.device.start_threads()?;
    let all = args.only.is_empty();
    let quiet = args.verbosity.quiet;
    let mut told: Vec<String> = Vec::new();
    let mut make = |models| {
        let selected = choose_backend(&args.device, models)?;
        for note in selected.notes.into_iter().filter(|_| !quiet) {
            if !told.contains(&note) {
                say(&note);
                told.push(note);
            }
        }
        Ok(selected.backend)
    };
    let mut runner = Runner::new(&mut make, if args.fine { Fineness::Fine } else { Fineness::Quick });
    let mut report = VerificationReport::default();
    for family in FAMILIES.iter().filter(|family| all || args.only.iter().any(|only| family.has(only))) {
        let mut rows = family.run(&mut runner).map_err(|error| match error {
            VerifyError::Compute(ComputeError::Device(what)) if report.checks.is_empty() => CliError::Device { what },
            source => CliError::Verify { family: family.name, source },
        })?;
        // A path that could not be followed is a row that has no number, and fails whatever was
        // asked for.
        let stopped = |check: &Check| check.ours.is_nan();
        rows.checks.retain(|check| all || stopped(check) || args.only.iter().any(|only| family.names(only, check)));
        if !quiet {
            let failed = rows.checks.iter().filter(|check| check.verdict() == Verdict::Fail).count();
            let (rows, seconds) = (rows.checks.len(), rows.took.as_secs_f64());
            say(&format!("{}: {rows} rows, {failed} failed, {seconds:.1} s", family.name));
        }
        report.add(rows);
    }
    report.computed_on(&runner);
    if args.json {
        super::print(&report.to_json())?;
    } else {
        super::print(&table::table(&report.checks))?;
        if args.verbosity.verbose > 0 {
            super::print(&format!("\n{}", table::reasons(&report.checks)))?;
        }
        super::print(&format!("\n{}\n", table::summary(&report)))?;
    }
    if let Some(path) = &args.out {
        write_own(path, |file| file.write_all(report.to_json().as_bytes()))?;
    }
    Ok(if report.passed() { Exit::Done } else { Exit::ChecksFailed })
}

/// A line on stderr; a closed one is no reason to stop computing.
fn say(text: &str) {
    let _ = writeln!(std::io::stderr(), "{text}");
}
