//! `asperity law`: fits a contact law to a study, and applies it to a case.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};

use serde_json::{Value, json};

use super::contact::ContactArgs;
use super::input::InputFile;
use super::law_check::{LawCheckArgs, check_law};
use super::law_compose::{ComposeArgs, compose_tables};
use super::law_export::{ExportArgs, export_law};
use super::law_tabulate::{TabulateArgs, tabulate};
use super::print::warn_out_of_range;
use super::{CliError, Exit, print, print_json};
use crate::case::{Case, Segment};
use crate::contact_law::path::PathPoint;
use crate::law::data::raw_sentence;
use crate::law::file::BUILT_IN;
use crate::law::formulas::fit::fit;
use crate::law::formulas::predict::{NormalSource, predict};
use crate::law::formulas::prior::Prior;
use crate::law::interpolated::{self, Interpolated};
use crate::law::range::OutOfRange;
use crate::law::report::RegionError;
use crate::law::{Law, LawError, LawFile, report};
use crate::output::{decimal, refuse_foreign, refuse_input};

/// Make a contact law and use it.
#[derive(Clone, Debug, Args)]
pub struct LawArgs {
    /// What to do.
    #[command(subcommand)]
    pub command: LawCommand,
}

/// The subcommands of `asperity law`.
#[derive(Clone, Debug, Subcommand)]
pub enum LawCommand {
    /// Fit a law to a study: writes DIR/law.json, and prints the formulas and the errors of the
    /// law.
    Fit(FitArgs),
    /// Make a table of one contact: simulates it at several depths up to that of the case, writes
    /// DIR/law.json, and prints the errors between the depths.
    Tabulate(TabulateArgs),
    /// Make a table of one contact without simulating it: from one table of each material, or from
    /// an interpolated law.
    Compose(ComposeArgs),
    /// Predict F_N and F_T along the path of a case without simulating it; prints CSV.
    Predict(PredictArgs),
    /// Simulate a set of test paths and print the errors of the law along each.
    Check(LawCheckArgs),
    /// Export a law for a DEM code: all files that an engine needs, or the update of one contact as
    /// C headers or as a Python module.
    Export(ExportArgs),
}

/// The arguments of `law fit`.
#[derive(Clone, Debug, Args)]
pub struct FitArgs {
    /// The directory of a study.
    #[arg(value_name = "DIR")]
    pub dir: PathBuf,
    /// Constants to start from, weighted by cross-validation: wear-2014 (those of 240 cases, used
    /// if the study has less than a quarter as many), none, or another law.json.
    #[arg(long, value_name = "PRIOR", default_value = "wear-2014")]
    pub prior: String,
    /// Interpolate between the cases instead of fitting formulas: for a large study of many
    /// materials, on a plane or of equal spheres.
    #[arg(long, conflicts_with = "prior")]
    pub interpolate: bool,
    /// With --interpolate: if the cases have no reversal or release, take the stiffnesses of both
    /// from this interpolated law. `built-in` is the built-in law of a plane.
    #[arg(long, value_name = "LAW.json", requires = "interpolate")]
    pub reversal: Option<PathBuf>,
    /// With --interpolate: DIR is a study of oblique presses. What they tell of how a contact
    /// yields under F_T is added to this interpolated law.
    #[arg(long, value_name = "LAW.json", requires = "interpolate", conflicts_with = "reversal")]
    pub add_to: Option<PathBuf>,
    /// Print the law as JSON, as in DIR/law.json, instead of the tables.
    #[arg(long)]
    pub json: bool,
    /// Also print the errors of the formulas that were tried and not chosen, and those of each
    /// region of materials and friction.
    #[arg(short, long, conflicts_with = "json")]
    pub verbose: bool,
}

/// The arguments of `law predict`.
#[derive(Clone, Debug, Args)]
pub struct PredictArgs {
    /// A law file that `law fit`, `law tabulate` or `law compose` wrote; or `built-in`.
    #[arg(value_name = "LAW.json")]
    pub law: PathBuf,
    /// The case, with any path; `-` for standard input. Instead of a case, --E, --nu, --yield, --mu
    /// and --h describe a contact.
    #[arg(value_name = "CASE.toml", required_unless_present = "youngs_modulus")]
    pub case: Option<PathBuf>,
    /// A contact without a case file.
    #[command(flatten)]
    pub contact: ContactArgs,
    /// Take F_N0 and a0 from a simulation of the press, not from the formulas of the law; for a
    /// case with one press and one shear at constant indentation.
    #[arg(long)]
    pub press: bool,
    /// Replace a value of the case, as in contact.friction=0.1 or path.0.indentation=0.01. May be
    /// repeated.
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Print JSON instead of CSV: the curve, and what lies outside the range of the law.
    #[arg(long)]
    pub json: bool,
}

/// Runs a subcommand of `asperity law`.
pub fn law(args: &LawArgs) -> Result<Exit, CliError> {
    match &args.command {
        LawCommand::Fit(args) => fit_law(args),
        LawCommand::Tabulate(args) => tabulate(args),
        LawCommand::Compose(args) => compose_tables(args),
        LawCommand::Predict(args) => predict_case(args),
        LawCommand::Check(args) => check_law(args),
        LawCommand::Export(args) => export_law(args),
    }
}

fn fit_law(args: &FitArgs) -> Result<Exit, CliError> {
    let path = args.dir.join("law.json");
    let reversal_file = args.reversal.as_deref().unwrap_or(Path::new(BUILT_IN));
    let other = args.add_to.as_deref().unwrap_or(reversal_file);
    refuse_input(&path, &[Path::new(&args.prior), other])?;
    refuse_foreign(&path)?;
    if args.interpolate {
        let reversal = match &args.reversal {
            Some(path) if path == Path::new(BUILT_IN) => Some(Interpolated::built_in()?),
            Some(path) => Some(Interpolated::read(path)?),
            None => None,
        };
        let law = match &args.add_to {
            Some(path) => interpolated::with_yielding(Interpolated::read(path)?, &args.dir)?,
            None => interpolated::fit(&args.dir, reversal.as_ref())?,
        };
        law.write(&path)?;
        if args.json {
            print_json(&law)?;
        } else {
            print(&format!("{}\nlaw in {}\n", summary_of_interpolation(&law), path.display()))?;
        }
        return Ok(Exit::Done);
    }
    let law = fit(&args.dir, &Prior::from_option(&args.prior)?)?;
    law.write(&path)?;
    if args.json {
        print_json(&law)?;
    } else {
        print(&format!("{}\nlaw in {}\n", summary(&law, args.verbose), path.display()))?;
    }
    Ok(Exit::Done)
}

/// What `law fit --interpolate` prints.
fn summary_of_interpolation(law: &Interpolated) -> String {
    let source = &law.source;
    let [f, f_max, a, a_max] =
        [law.normal_errors.f_n0[0], law.normal_errors.f_n0[1], law.normal_errors.a0[0], law.normal_errors.a0[1]]
            .map(|x| 100.0 * x);
    let mut text = format!(
        "{} cases of {} materials on {}, {} elements per contact radius, {} left out\n{}\n\
         Errors from h alone, each material from the others, in per cent\n\
         F_N0 rms     max   a0 rms     max\n{f:>8.2} {f_max:>7.2} {a:>8.2} {a_max:>7.2}\n\n",
        source.cases,
        source.materials,
        law.body,
        source.elements_per_contact_radius,
        source.left_out.len(),
        raw_sentence(source.raw)
    );
    text.push_str(&report::region_table("F_T of its peak, F_N of F_N0", &law.errors));
    if let Some(yielding) = &law.yielding {
        let [rms, most] = yielding.errors.map(|error| 100.0 * error);
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "\nc of {} oblique presses of {} materials, {} left out: ln c {rms:.1} % rms, at most {most:.0}, \
             each material from the others",
            yielding.cases,
            yielding.materials,
            yielding.left_out.len()
        );
    }
    text
}

/// What `law fit` prints.
fn summary(law: &Law, verbose: bool) -> String {
    let p = &law.provenance;
    let (coarsest, finest) = p.elements_per_contact_radius;
    let mut text = format!(
        "{} cases of {} materials, {coarsest} to {finest} elements per contact radius, {} left out; {} folds, whole \
         materials left out (seed {})\n{}\n",
        p.cases,
        p.materials,
        p.left_out.len(),
        p.folds,
        p.seed,
        raw_sentence(p.raw)
    );
    if let Some(prior) = &p.prior {
        let weight = |weight: Option<f64>| weight.map_or_else(|| "none".to_owned(), |weight| weight.to_string());
        let _ = writeln!(
            text,
            "Prior: the law of {}; weight for the shear {}, for a0 {}, for F_N0 {}\n",
            prior.study,
            weight(prior.shear),
            weight(prior.normal.map(|weights| weights[0])),
            weight(prior.normal.map(|weights| weights[1]))
        );
    }
    if !verbose {
        for (what, regions) in [("known", &law.errors), ("predicted from h", &law.errors_predicted)] {
            // The last region is all of them.
            if let Some(RegionError { errors, .. }) = regions.last() {
                let [f_t, most, f_n, normal_most] =
                    [errors.f_t_rms, errors.f_t_max, errors.f_n_rms, errors.f_n_max].map(|error| 100.0 * error);
                let _ = writeln!(
                    text,
                    "F_N0 and a0 {what}: F_T {f_t:.2} % rms ({most:.1} at worst), F_N {f_n:.2} ({normal_most:.1}), \
                     cross-validated"
                );
            }
        }
        text.push('\n');
        text.push_str(&law.formulas());
        return text;
    }
    let predicted = "Errors with F_N0 and a0 predicted from h, cross-validated, in per cent";
    let known = "Errors of the kept fit (*) with F_N0 and a0 known, cross-validated, in per cent";
    for table in [
        report::candidate_table(&law.candidates),
        report::normal_table(&law.normal_candidates),
        report::region_table(known, &law.errors),
        report::region_table(predicted, &law.errors_predicted),
    ] {
        let _ = writeln!(text, "{table}");
    }
    text.push_str(&law.formulas());
    text
}

fn predict_case(args: &PredictArgs) -> Result<Exit, CliError> {
    let (case, name) = match args.contact.case(&args.set)? {
        Some(case) => (case, "the contact".to_owned()),
        None => {
            // Clap lets nothing pass without options or a file.
            let input = InputFile::read(args.case.as_deref().unwrap_or(Path::new("")))?;
            (input.case(&args.set)?, input.name)
        }
    };
    let law = LawFile::read_or_built_in(&args.law)?;
    let in_case = |source: LawError| CliError::LawCase { file: name.clone().into(), source: Box::new(source) };
    let (points, out_of_range) = if args.press { pressed(&law, &case, &args.law) } else { law.follow(&case) }.map_err(in_case)?;
    warn_out_of_range(Path::new(&name), &out_of_range);
    let leaves_x = case.path.iter().any(Segment::leaves_x);
    if args.json {
        print_json(&as_json(&points, [leaves_x, case.turns()], &out_of_range))?;
        return Ok(Exit::Done);
    }
    let mut text = String::from("segment,h,delta_T,F_N,F_T");
    text.push_str(if leaves_x { ",delta_T_y,F_T_y" } else { "" });
    text.push_str(if case.turns() { ",twist,roll_x,roll_y,M_twist,M_roll_x,M_roll_y\n" } else { "\n" });
    for point in &points {
        let mut told = vec![point.h, point.delta_t, point.f_n, point.f_t];
        if leaves_x {
            told.extend([point.delta_t_y, point.f_t_y]);
        }
        if case.turns() {
            told.extend([point.turned, point.moments].concat());
        }
        let told: Vec<String> = told.into_iter().map(decimal).collect();
        let _ = writeln!(text, "{},{}", point.segment, told.join(","));
    }
    print(&text)?;
    Ok(Exit::Done)
}

fn as_json(points: &[PathPoint], [leaves_x, turns]: [bool; 2], out_of_range: &[OutOfRange]) -> Value {
    let column = |of: fn(&PathPoint) -> f64| points.iter().map(of).collect::<Vec<f64>>();
    let outside = out_of_range.iter().map(
        |OutOfRange { quantity, value, range }| json!({ "quantity": quantity, "value": value, "from": range.from, "to": range.to }),
    );
    let mut curve = json!({
        "segment": points.iter().map(|p| p.segment).collect::<Vec<_>>(),
        "h": column(|p| p.h),
        "delta_T": column(|p| p.delta_t),
        "F_N": column(|p| p.f_n),
        "F_T": column(|p| p.f_t)
    });
    if leaves_x {
        curve["delta_T_y"] = json!(column(|p| p.delta_t_y));
        curve["F_T_y"] = json!(column(|p| p.f_t_y));
    }
    if turns {
        for (k, about) in ["twist", "roll_x", "roll_y"].into_iter().enumerate() {
            curve[about] = json!(points.iter().map(|p| p.turned[k]).collect::<Vec<_>>());
            curve[format!("M_{about}")] = json!(points.iter().map(|p| p.moments[k]).collect::<Vec<_>>());
        }
    }
    json!({ "curve": curve, "out_of_range": outside.collect::<Vec<_>>() })
}

/// One shear from a simulated press.
fn pressed(law: &LawFile, case: &Case, path: &Path) -> Result<(Vec<PathPoint>, Vec<OutOfRange>), LawError> {
    let LawFile::Formulas(law) = law else {
        return Err(LawError::NoFormulas { path: path.to_owned(), what: "--press" });
    };
    let prediction = predict(law, case, NormalSource::Press)?;
    Ok((prediction.points(), prediction.out_of_range))
}
