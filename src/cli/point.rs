//! `asperity point`: one material point along a path of deformation, as CSV.

use std::fmt::Display;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use super::{CliError, Exit};
use crate::bounded;
use crate::case::{self, short};
use crate::material::MaterialError;
use crate::material::point::{PointRecord, along, simple_shear, uniaxial};
use crate::output::decimal;

/// Strain that is reached unless `--strain` says otherwise.
const STRAIN: f64 = 0.1;
/// Steps unless `--steps` says otherwise.
const STEPS: u32 = 100;

/// The columns that [`point`] prints. Stresses and energies per reference volume are in the unit of
/// Young's modulus.
pub const COLUMNS: &str = "step,F11,F12,F13,F21,F22,F23,F31,F32,F33,sigma_xx,sigma_yy,sigma_zz,sigma_xy,sigma_yz,sigma_zx,\
                           von_mises,alpha,plastic_work,elastic_energy";

/// How the point is deformed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Mode {
    /// Uniaxial stress along x with free sides; the strain is logarithmic, negative in compression.
    Uniaxial,
    /// Simple shear, F = I + strain e_x e_y.
    Shear,
    /// The deformation gradients of `--path`.
    Path,
}

/// Drive one material point; stress, strain and energies as CSV.
#[derive(Clone, Debug, Args)]
pub struct PointArgs {
    /// A TOML file with a `[material]` table: a case file, or a material alone.
    #[arg(value_name = "MATERIAL.toml")]
    pub material: PathBuf,
    /// How the point is deformed [default: uniaxial, or path with --path].
    #[arg(long, value_enum, value_name = "MODE")]
    pub mode: Option<Mode>,
    /// Strain to reach [default: 0.1].
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    pub strain: Option<f64>,
    /// Number of equal steps [default: 100].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=10_000_000))]
    pub steps: Option<u32>,
    /// CSV file of deformation gradients relative to the undeformed point, one row a step:
    /// F11,F12,F13,F21,F22,F23,F31,F32,F33, or in the order that a first row of these names gives.
    /// Lines that start with # are comments.
    #[arg(long, value_name = "FILE.csv", conflicts_with_all = ["strain", "steps"], required_if_eq("mode", "path"))]
    pub path: Option<PathBuf>,
    /// Replace a value of the file, as in material.hardening.yield_stress=300. May be repeated.
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
}

/// Reads the material, drives the point, and prints a row a step, the undeformed point first. A
/// step without an answer ends it with [`Exit::NotConverged`], after the rows before it.
pub fn point(args: &PointArgs) -> Result<Exit, CliError> {
    let constants = case::Material::load(&args.material, &args.set)?;
    let material = constants.constants::<f64>().map_err(|source| CliError::Hardening { file: args.material.clone(), source })?;
    let (strain, steps) = (args.strain.unwrap_or(STRAIN), args.steps.unwrap_or(STEPS) as usize);
    if !strain.is_finite() {
        return Err(CliError::Deformation { what: format!("--strain {strain}: is not finite. Give a number, such as 0.1") });
    }
    let unit = constants.youngs_modulus;
    match (args.mode, &args.path) {
        (None | Some(Mode::Path), Some(file)) => print(along(&material, read_path(file)?), unit),
        (Some(mode), Some(_)) => {
            let what = format!("--path: cannot go with --mode {}. Leave one of them out", format!("{mode:?}").to_lowercase());
            Err(CliError::Deformation { what })
        }
        (Some(Mode::Path), None) => {
            Err(CliError::Deformation { what: "--mode path: needs --path. Give --path FILE.csv".to_owned() })
        }
        (None | Some(Mode::Uniaxial), None) => print(uniaxial(&material, strain, steps), unit),
        (Some(Mode::Shear), None) => print(simple_shear(&material, strain, steps), unit),
    }
}

/// The names of the components of a deformation gradient, row by row.
const COMPONENTS: [&str; 9] = ["F11", "F12", "F13", "F21", "F22", "F23", "F31", "F32", "F33"];

/// The rows of a CSV file of deformation gradients. A row of names says which column is which.
pub fn read_path(file: &Path) -> Result<Vec<[[f64; 3]; 3]>, CliError> {
    let refuse =
        |place: String, what: String| CliError::Deformation { what: format!("--path {}{place}: {what}", file.display()) };
    let unreadable = |error: &dyn Display| refuse(String::new(), format!("cannot be read: {error}. Give a CSV file"));
    let text = bounded::read_to_string(file, bounded::RESULT).map_err(|error| unreadable(&error))?;
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .trim(csv::Trim::All)
        .comment(Some(b'#'))
        .from_reader(text.as_bytes());
    let mut gradients = Vec::new();
    let mut places: [usize; 9] = std::array::from_fn(|i| i);
    for (index, row) in reader.records().enumerate() {
        let row = row.map_err(|error| unreadable(&error))?;
        let at_line = format!(", line {}", row.position().map_or(0, csv::Position::line));
        let columns = "Give 9 numbers, F11,F12,F13,F21,F22,F23,F31,F32,F33";
        if row.len() != 9 {
            return Err(refuse(at_line, format!("has {} columns. {columns}", row.len())));
        }
        // A first row without a single number is a row of names.
        if index == 0 && row.iter().all(|cell| cell.parse::<f64>().is_err()) {
            places = named(&row).map_err(|what| refuse(at_line, what))?;
            continue;
        }
        let mut gradient = [[0.0; 3]; 3];
        for (i, (cell, place)) in row.iter().zip(places).enumerate() {
            gradient[place / 3][place % 3] = cell
                .parse()
                .ok()
                .filter(|x: &f64| x.is_finite())
                .ok_or_else(|| refuse(at_line.clone(), format!("column {} is {:?}. {columns}", i + 1, short(cell))))?;
        }
        gradients.push(gradient);
    }
    if gradients.is_empty() {
        return Err(refuse(String::new(), "has no rows. Give one deformation gradient a row".to_owned()));
    }
    Ok(gradients)
}

/// Which component each column is, by a row of names; the error is what is wrong with it.
fn named(row: &csv::StringRecord) -> Result<[usize; 9], String> {
    let mut places = [0; 9];
    for (i, name) in row.iter().enumerate() {
        let remedy = format!("Name each of {} once, in any order, or leave the row of names out", COMPONENTS.join(", "));
        let Some(place) = COMPONENTS.iter().position(|known| *known == name) else {
            return Err(format!("column {} is called {:?}. {remedy}", i + 1, short(name)));
        };
        if places[..i].contains(&place) {
            return Err(format!("two columns are called {name}. {remedy}"));
        }
        places[i] = place;
    }
    Ok(places)
}

/// Prints the records, stresses and energies times `unit`.
fn print(records: impl Iterator<Item = Result<PointRecord, MaterialError>>, unit: f64) -> Result<Exit, CliError> {
    let mut out = BufWriter::new(io::stdout().lock());
    match write(&mut out, records, unit) {
        Ok(None) => Ok(Exit::Done),
        Ok(Some(error)) => {
            let _ = writeln!(io::stderr(), "error: {error}");
            Ok(Exit::NotConverged)
        }
        // The reader has seen enough.
        Err(source) if source.kind() == io::ErrorKind::BrokenPipe => Ok(Exit::Done),
        Err(source) => Err(CliError::Stdout { source }),
    }
}

/// Writes the header and a row for each record; returns the error that ended the path, if any.
fn write(
    out: &mut impl Write,
    records: impl Iterator<Item = Result<PointRecord, MaterialError>>,
    unit: f64,
) -> io::Result<Option<MaterialError>> {
    writeln!(out, "{COLUMNS}")?;
    for record in records {
        let record = match record {
            Ok(record) => record,
            Err(error) => {
                out.flush()?;
                return Ok(Some(error));
            }
        };
        write!(out, "{}", record.step)?;
        for x in record.deformation_gradient.iter().flatten() {
            write!(out, ",{}", decimal(*x))?;
        }
        for x in record.cauchy.into_iter().chain([record.von_mises]) {
            write!(out, ",{}", decimal(x * unit))?;
        }
        let numbers = [record.alpha, record.plastic_work * unit, record.elastic_energy * unit].map(decimal);
        writeln!(out, ",{}", numbers.join(","))?;
    }
    out.flush()?;
    Ok(None)
}
