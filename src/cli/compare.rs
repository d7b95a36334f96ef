//! `asperity compare`: several runs side by side, as a table and in one picture.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use clap::Args;
use serde_json::{Map, Value, json};

use super::{CliError, Exit, print, print_json};
use crate::case::{Case, PictureFormat, PictureWidth};
use crate::output::plots::axes::{Axes, AxisUnits};
use crate::output::plots::{OverlaidRun, Sheet, View, plot_overlay};
use crate::output::{OutputDirectory, RunStatus, StepRecord, Summary, read_history};

/// Compare runs, in a table and a picture.
///
/// Differences are in per cent of the first run. Runs of different radius or Young's modulus are
/// compared without units: forces over E R^2, lengths over R, stiffnesses over E R.
#[derive(Clone, Debug, Args)]
pub struct CompareArgs {
    /// Directories of runs; the others are compared with the first.
    #[arg(value_name = "DIR", required = true, num_args = 2..)]
    pub dirs: Vec<PathBuf>,
    /// File for the picture of the curves, .svg, .pdf or .png; an existing file is replaced.
    #[arg(long, value_name = "FILE", default_value = "compare.svg", value_parser = picture_file)]
    pub out: PathBuf,
    /// Width of the picture, as in 85mm, 3.3in or 640px.
    #[arg(long, value_name = "WIDTH", value_parser = PictureWidth::from_str)]
    pub width: Option<PictureWidth>,
    /// Leave out the title.
    #[arg(long)]
    pub no_title: bool,
    /// Print the table as JSON.
    #[arg(long)]
    pub json: bool,
}

/// A run as it stands in its directory.
struct ComparedRun {
    name: String,
    case: Case,
    summary: Summary,
    history: Vec<StepRecord>,
}

impl ComparedRun {
    fn read(dir: &Path) -> Result<Self, CliError> {
        let out = OutputDirectory::existing(dir);
        let lacking = |what: &str| CliError::NothingToCompare { dir: dir.to_owned(), what: what.to_owned() };
        if !out.holds_result() {
            return Err(lacking("is not a run: there is no case.toml that a run wrote"));
        }
        if !out.summary().exists() {
            return Err(lacking("has no summary.json yet: its run goes on, or was killed"));
        }
        Ok(Self {
            name: dir.display().to_string(),
            case: out.load_case()?,
            summary: Summary::read(&out.summary())?,
            history: read_history(&out.history())?,
        })
    }

    /// Units of length and force that make its numbers comparable with those of any other.
    fn scales(&self) -> [f64; 2] {
        let (radius, modulus) = (self.case.sphere.radius, self.case.material.youngs_modulus);
        [radius, modulus * radius * radius]
    }
}

/// A quantity of the table: its name and its value, with and without units.
type Quantity = (&'static str, fn(&Summary) -> Option<f64>, fn(&Summary) -> Option<f64>);

const QUANTITIES: [Quantity; 11] = [
    ("F_N0", |s| s.f_n0, |s| s.normalized.f_n0),
    ("a0", |s| s.a0, |s| s.normalized.a0),
    ("h0", |s| s.h0, |s| s.normalized.h0),
    ("F_N_slip", |s| s.f_n_slip, |s| s.normalized.f_n_slip),
    ("F_T_max", |s| s.f_t_max, |s| s.normalized.f_t_max),
    ("delta_T_90", |s| s.delta_t_90, |s| s.normalized.delta_t_90),
    ("delta_T_95", |s| s.delta_t_95, |s| s.normalized.delta_t_95),
    ("delta_T_slip", |s| s.delta_t_slip, |s| s.normalized.delta_t_slip),
    ("k_T0", |s| s.k_t0, |s| s.normalized.k_t0),
    ("mu_at_slip", |s| s.mu_at_slip, |s| s.mu_at_slip),
    ("max_alpha", |s| s.max_alpha, |s| s.max_alpha),
];

/// A part of what a run cost, which has no difference.
type Cost = (&'static str, fn(&Summary) -> f64);

const COSTS: [Cost; 4] = [
    ("elements", |s| s.elements as f64),
    ("steps", |s| s.steps as f64),
    ("newton_iterations", |s| s.newton_iterations as f64),
    ("wall_s", |s| s.wall_s),
];

/// Prints the table and draws the picture.
pub fn compare(args: &CompareArgs) -> Result<Exit, CliError> {
    let runs = args.dirs.iter().map(|dir| ComparedRun::read(dir)).collect::<Result<Vec<_>, _>>()?;
    let unlike = runs.iter().any(|run| run.scales() != runs[0].scales());
    let overlaid: Vec<OverlaidRun<'_>> = runs
        .iter()
        .map(|run| {
            let [length, force] = if unlike { run.scales() } else { [1.0, 1.0] };
            OverlaidRun { name: &run.name, history: &run.history, length, force }
        })
        .collect();
    let first = &runs[0].case;
    // What is divided already has no unit any more.
    let axes = if unlike { Axes::normalised(1.0, 1.0) } else { Axes::of(first, AxisUnits::Auto) };
    let picture = plot_overlay(&overlaid, &View { axes, sheet: Sheet { width: args.width, untitled: args.no_title } })?;
    picture.write(&args.out, PictureFormat::of_file(&args.out).unwrap_or_default())?;
    if args.json {
        print_json(&as_json(&runs, unlike))?;
    } else {
        print(&table(&runs, unlike))?;
        print(&format!("\n{}\n", args.out.display()))?;
    }
    for run in runs.iter().filter(|run| run.summary.status != RunStatus::Done) {
        // A closed stderr does not change the comparison.
        let _ = writeln!(std::io::stderr(), "warning: {}: {}", run.name, run.summary.status);
    }
    Ok(Exit::Done)
}

fn picture_file(text: &str) -> Result<PathBuf, String> {
    let file = PathBuf::from(text);
    let refused = || "the name of a picture ends in .svg, .pdf or .png".to_owned();
    PictureFormat::of_file(&file).map(|_| file).ok_or_else(refused)
}

/// The values of a quantity, and how far each is from the first, as a share.
fn values(runs: &[ComparedRun], (_, plain, normalized): &Quantity, unlike: bool) -> Vec<(Option<f64>, Option<f64>)> {
    let of = |run: &ComparedRun| if unlike { normalized(&run.summary) } else { plain(&run.summary) };
    let first = of(&runs[0]).filter(|first| *first != 0.0);
    runs.iter().map(|run| (of(run), of(run).zip(first).map(|(value, first)| value / first - 1.0))).collect()
}

fn as_json(runs: &[ComparedRun], unlike: bool) -> Value {
    let mut quantities = Map::new();
    for quantity in &QUANTITIES {
        let values = values(runs, quantity, unlike);
        let [value, difference]: [Vec<Option<f64>>; 2] =
            [values.iter().map(|v| v.0).collect(), values.iter().map(|v| v.1).collect()];
        quantities.insert(quantity.0.to_owned(), json!({ "value": value, "relative_difference": difference }));
    }
    for (name, of) in COSTS {
        quantities.insert(name.to_owned(), json!({ "value": runs.iter().map(|run| of(&run.summary)).collect::<Vec<_>>() }));
    }
    let names: Vec<&str> = runs.iter().map(|run| run.name.as_str()).collect();
    let status: Vec<String> = runs.iter().map(|run| run.summary.status.to_string()).collect();
    json!({ "runs": names, "status": status, "normalized": unlike, "quantities": quantities })
}

/// A column for each run, with a column of differences beside every one but the first.
fn table(runs: &[ComparedRun], unlike: bool) -> String {
    let mut rows: Vec<Vec<String>> = Vec::new();
    let mut head = vec![if unlike { "without units" } else { "" }.to_owned()];
    for (i, run) in runs.iter().enumerate() {
        head.push(run.name.clone());
        head.extend((i > 0).then(|| "difference".to_owned()));
    }
    rows.push(head);
    for quantity in &QUANTITIES {
        let mut row = vec![quantity.0.to_owned()];
        for (i, (value, difference)) in values(runs, quantity, unlike).into_iter().enumerate() {
            row.push(value.map_or_else(|| "-".to_owned(), number));
            row.extend((i > 0).then(|| difference.map_or_else(|| "-".to_owned(), |share| format!("{:+.2} %", 100.0 * share))));
        }
        rows.push(row);
    }
    for (name, of) in COSTS {
        let mut row = vec![name.to_owned()];
        for (i, run) in runs.iter().enumerate() {
            row.push(number(of(&run.summary)));
            row.extend((i > 0).then(String::new));
        }
        rows.push(row);
    }
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let line = |row: &Vec<String>| {
        let cells: Vec<String> = row
            .iter()
            .zip(&widths)
            .enumerate()
            .map(|(column, (cell, &width))| if column == 0 { format!("{cell:<width$}") } else { format!("{cell:>width$}") })
            .collect();
        format!("{}\n", cells.join("  ").trim_end())
    };
    rows.iter().map(line).collect()
}

/// Five digits, without those that say nothing.
fn number(value: f64) -> String {
    if value != 0.0 && !(1e-4..1e7).contains(&value.abs()) {
        return format!("{value:.4e}");
    }
    let decimals = if value == 0.0 { 0 } else { (4 - value.abs().log10().floor() as i32).clamp(0, 9) as usize };
    let text = format!("{value:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}
