//! `asperity law tabulate`: the law of one contact as curves in h, of one material on a plane or on
//! its equal, or of two bodies.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::PathBuf;

use clap::Args;

use super::options::{DeviceArgs, Verbosity, out_or_name};
use super::study::{compute, options};
use super::{CliError, Exit, print};
use crate::case::{Case, PictureFormat};
use crate::law::LawError;
use crate::law::plots::table_picture;
use crate::law::table::{Built, build, depths, study_text};
use crate::output::refuse_foreign;
use crate::study::{Options, Study, hold};

/// The arguments of `law tabulate`.
#[derive(Clone, Debug, Args)]
pub struct TabulateArgs {
    /// The case: its material, friction, opponent (a plane or any other body), and indentation,
    /// which is the greatest depth of the table. The rest of its path is not used.
    #[arg(value_name = "CASE.toml")]
    pub case: PathBuf,
    /// Directory for the study and its law.json: new or empty, or with an earlier table if --resume
    /// or --force is given. By default it has the name of the case file, with -table in place of
    /// its extension.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Elements along the contact radius, at every depth; twice as many at the surface. Oblique
    /// presses have 1.6 times as many.
    #[arg(long, default_value_t = 5, value_name = "N", value_parser = clap::value_parser!(u32).range(4..=16))]
    pub elements: u32,
    /// Replace a value of the case, as in contact.friction=0.1 or path.0.indentation=0.01. May be
    /// repeated.
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Continue a table in DIR; finished depths are kept.
    #[arg(long)]
    pub resume: bool,
    /// Replace an earlier study in DIR, even another one.
    #[arg(long, conflicts_with = "resume")]
    pub force: bool,
    /// Device, precision, threads.
    #[command(flatten)]
    pub device: DeviceArgs,
    /// How much to say.
    #[command(flatten)]
    pub verbosity: Verbosity,
}

/// Simulates the depths, makes the table of them, and says how good it is.
pub(super) fn tabulate(args: &TabulateArgs) -> Result<Exit, CliError> {
    args.verbosity.start_log();
    args.device.start_threads()?;
    let case = Case::load(&args.case, &args.set)?;
    let in_case = |source: LawError| CliError::LawCase { file: args.case.clone(), source: Box::new(source) };
    let elements = args.elements as usize;
    let out = out_or_name(args.out.as_ref(), &args.case, "-table");
    let depths = depths(&case).map_err(in_case)?;
    let study = Study::parse(&study_text(&case, elements, &depths), "tabulate")?;
    // Before hours of simulations.
    for name in ["law.json", "tabulated.svg"] {
        refuse_foreign(&out.join(name))?;
    }
    let options = Options { resume: args.resume, force: args.force, ..options(&args.device) };
    let (report, interrupted) = compute(&study, &out, &options, args.verbosity.quiet)?;
    if report.pending > 0 || interrupted {
        // A closed stderr does not change how it went.
        let _ = writeln!(
            std::io::stderr(),
            "error: interrupted with {} depths to go. What was computed is kept in {}; to go on, run the same command \
             with --resume",
            report.pending,
            out.display()
        );
        return Ok(Exit::Interrupted);
    }
    // Nobody begins another study there before its table is written.
    let _study = hold(&out, &study)?;
    let built = build(&out, &case, elements)?;
    let law = out.join("law.json");
    built.table.write(&law)?;
    let drawn = out.join("tabulated.svg");
    table_picture(&built)?.write(&drawn, PictureFormat::Svg)?;
    print(&format!("{}\nlaw in {}, picture in {}\n", summary(&built), law.display(), drawn.display()))?;
    Ok(if built.missing.is_empty() { Exit::Done } else { Exit::CasesFailed })
}

/// What the command prints.
fn summary(built: &Built) -> String {
    let table = &built.table;
    let mut text = format!(
        "{} levels from h/R = {:.2e} to {:.2e}, {} elements along the contact radius, against {}\n\n\
         Errors of a table of every other depth at the depths between, in per cent (F_T of its peak, F_N of F_N0)\n\n\
         {:>10} {:>7} {:>7} {:>8} {:>7} {:>8} {:>7}\n",
        table.levels.len(),
        table.range.from,
        table.range.to,
        table.elements_per_contact_radius,
        table.body,
        "h/R",
        "F_N0",
        "a0",
        "F_T rms",
        "max",
        "F_N rms",
        "max"
    );
    for e in &table.errors {
        let [f_n0, a0, t, t_max, n, n_max] = [e.f_n0, e.a0, e.f_t_rms, e.f_t_max, e.f_n_rms, e.f_n_max].map(|x| 100.0 * x);
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{:>10.3e} {f_n0:>+7.2} {a0:>+7.2} {t:>8.2} {t_max:>7.2} {n:>8.2} {n_max:>7.2}", e.h);
    }
    for missing in &built.missing {
        let _ = writeln!(text, "\nmissing: {} ended with: {}; the table does without", missing.id, missing.reason);
    }
    text
}
