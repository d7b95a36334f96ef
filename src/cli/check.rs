//! `asperity check`: the case, or the first of a study's, as it would be run.

use std::path::PathBuf;

use clap::Args;
use serde_json::{Value, json};

use super::input::InputFile;
use super::{CliError, Exit, print, print_json};
use crate::case::{Case, estimated_elements, estimated_memory};
use crate::simulation::problem::{press_steps, shear_steps};
use crate::study::{Study, StudyCase, estimated_seconds};

/// Check a case or a study without running it.
///
/// Prints a case with every default, and the size of the problem. Of a study, checks all
/// combinations and prints their number and the first of them.
#[derive(Clone, Debug, Args)]
pub struct CheckArgs {
    /// A case or study file; `-` for standard input.
    #[arg(value_name = "CASE.toml")]
    pub case: PathBuf,
    /// Replace a value of the case, as in contact.friction=0.1 or path.0.indentation=0.01. May be
    /// repeated.
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Print JSON instead of TOML.
    #[arg(long)]
    pub json: bool,
}

/// Loads and checks the case and prints it as TOML under its size; so the first case of a study,
/// after a line on the size of its grid.
pub fn check(args: &CheckArgs) -> Result<Exit, CliError> {
    let input = InputFile::read(&args.case)?;
    if input.is_study() {
        if let Some(argument) = args.set.first() {
            return Err(CliError::SetInStudy { argument: argument.clone(), file: args.case.clone() });
        }
        let study = input.study()?;
        study.check_room(|_| true)?;
        if args.json {
            print_json(&study_json(&study))?
        } else {
            print(&study_text(&study))?
        }
        return Ok(Exit::Done);
    }
    let case = input.case(&args.set)?;
    input.check_room(&case, &args.set)?;
    if args.json {
        print_json(&case_json(&case))?
    } else {
        print(&case_text(&case))?
    }
    Ok(Exit::Done)
}

fn study_text(study: &Study) -> String {
    let first = |case: &StudyCase| format!("# case {}: {}\n{}", case.id, study.combination(case), resolved(&case.case));
    let seconds = duration(study.cases.iter().map(|case| estimated_seconds(&case.case)).sum());
    let first = study.cases.first().map_or(String::new(), first);
    let notes: String = study.doubts().iter().map(|(id, doubt)| format!("# note: case {id}: {doubt}\n")).collect();
    format!("# {}\n# about {seconds} of processor time in all, to a factor of three\n{notes}{first}", study.size())
}

fn study_json(study: &Study) -> Value {
    let seconds: f64 = study.cases.iter().map(|case| estimated_seconds(&case.case)).sum();
    let keys: Vec<Value> = study.axes.iter().map(|(key, values)| json!({ "key": key, "values": values })).collect();
    let first = study.cases.first().map(|case| case_json(&case.case));
    let notes: Vec<String> = study.doubts().iter().map(|(id, doubt)| format!("case {id}: {doubt}")).collect();
    json!({
        "kind": "study", "cases": study.cases.len(), "grid": keys, "estimated_seconds": seconds, "notes": notes, "first": first
    })
}

/// The case under comments with what is odd about it, its size, and what the mesh decides where no
/// key does.
fn case_text(case: &Case) -> String {
    let notes: String = case.doubts().iter().map(|doubt| format!("# note: {doubt}\n")).collect();
    format!("{notes}{}", resolved(case))
}

fn resolved(case: &Case) -> String {
    format!(
        "# about {} elements, {:.2} GiB and {} of processor time (to a factor of three)\n\
         # press_steps = {} and shear_steps = {}\n{}",
        estimated_elements(case),
        estimated_memory(case),
        duration(estimated_seconds(case)),
        press_steps(case),
        shear_steps(case),
        case.to_toml()
    )
}

fn case_json(case: &Case) -> Value {
    json!({
        "kind": "case",
        "case": case,
        "press_steps": press_steps(case),
        "shear_steps": shear_steps(case),
        "estimated_elements": estimated_elements(case),
        "estimated_memory_gib": estimated_memory(case),
        "estimated_seconds": estimated_seconds(case),
        "notes": case.doubts().iter().map(ToString::to_string).collect::<Vec<_>>(),
    })
}

/// A time in the unit that suits it.
fn duration(seconds: f64) -> String {
    match seconds {
        ..10.0 => format!("{seconds:.1} s"),
        10.0..120.0 => format!("{seconds:.0} s"),
        120.0..7200.0 => format!("{:.0} min", seconds / 60.0),
        _ => format!("{:.1} h", seconds / 3600.0),
    }
}
