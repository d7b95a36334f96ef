//! `asperity verify`: closed-form checks as a table.

use std::path::PathBuf;

use clap::Args;

use super::backend::choose_backend;
use super::options::{DeviceArgs, Verbosity};
use super::{CliError, Outcome};
use crate::output::write_atomically;
use crate::verify::{Check, FAMILIES, Level, Runner, Verdict, table::table};

/// Compare this build with closed-form solutions: ours, reference, error, verdict. Exit code 3 when a check fails.
#[derive(Clone, Debug, Args)]
pub struct VerifyArgs {
    /// Use the meshes that a case has by default; takes some minutes instead of one.
    #[arg(long)]
    pub fine: bool,
    /// Only this family of checks; may be repeated.
    #[arg(long, value_name = "FAMILY", value_parser = FAMILIES.map(|family| family.name))]
    pub only: Vec<String>,
    /// Also write the rows as JSON.
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Device, precision, threads.
    #[command(flatten)]
    pub device: DeviceArgs,
    /// How much to say.
    #[command(flatten)]
    pub verbosity: Verbosity,
}

/// Runs the checks, family by family.
pub fn verify(args: &VerifyArgs) -> Result<Outcome, CliError> {
    args.verbosity.start_log();
    args.device.start_threads()?;
    let mut notes: Vec<String> = Vec::new();
    let mut backend = |models| {
        let selected = choose_backend(&args.device, models)?;
        for note in selected.notes {
            if !notes.contains(&note) {
                eprintln!("note: {note}");
                notes.push(note);
            }
        }
        Ok(selected.backend)
    };
    let mut runner = Runner::new(&mut backend, if args.fine { Level::Fine } else { Level::Quick });
    let mut checks: Vec<Check> = Vec::new();
    for family in FAMILIES.iter().filter(|family| args.only.is_empty() || args.only.iter().any(|name| name == family.name)) {
        let report = family.run(&mut runner).map_err(|source| CliError::Verify { source })?;
        if !args.verbosity.quiet {
            eprintln!("{}: {} checks, {:.1} s", report.name, report.checks.len(), report.took.as_secs_f64());
        }
        checks.extend(report.checks);
    }
    let count = |verdict| checks.iter().filter(|check| check.verdict() == verdict).count();
    let (passed, failed) = (count(Verdict::Pass), count(Verdict::Fail));
    super::print(&format!(
        "{}\n{passed} passed, {failed} failed, {} for information\n",
        table(&checks),
        count(Verdict::Information)
    ))?;
    if let Some(path) = &args.out {
        let rows = serde_json::to_string_pretty(&checks).map_err(|source| CliError::Rows { source })?;
        write_atomically(path, |file| std::io::Write::write_all(file, rows.as_bytes()))?;
    }
    Ok(if failed == 0 { Outcome::Done } else { Outcome::NotConverged })
}
