//! `asperity plot`: the pictures of a run, or of a study with its report.

use std::fs;
use std::io::Write as _;
use std::path::PathBuf;
use std::str::FromStr;

use clap::Args;

use super::options::{Format, UnitsOption};
use super::{CliError, Exit, print};
use crate::case::{PictureFormat, PictureWidth};
use crate::law::plots::beside_run;
use crate::law::{LawError, LawFile};
use crate::output::plots::axes::Axes;
use crate::output::plots::{Sheet, View, replot};
use crate::output::{OutputDirectory, read_history, refuse_foreign};
use crate::study::{StudyDirectory, report};

/// Draw the results in a directory.
///
/// Writes DIR/plots, and DIR/report.html for a study. A run may be unfinished; of a study, the
/// finished cases are drawn.
#[derive(Clone, Debug, Args)]
pub struct PlotArgs {
    /// The directory of a run or of a study.
    #[arg(value_name = "DIR")]
    pub dir: PathBuf,
    /// A law to draw beside the simulations. For a study, DIR/law.json is used if it exists.
    #[arg(long, value_name = "LAW.json")]
    pub law: Option<PathBuf>,
    /// Format of the pictures; by default that of the case, SVG for a study. The report of a study
    /// always has SVG.
    #[arg(long, value_enum, value_name = "FORMAT")]
    pub format: Option<Format>,
    /// Width of each picture, as in 85mm, 8.5cm, 3.3in, 240pt or 640px. The picture is laid out for
    /// this width. By default that of the case, or each picture's own.
    #[arg(long, value_name = "WIDTH", value_parser = PictureWidth::from_str)]
    pub width: Option<PictureWidth>,
    /// Leave out the titles, for pictures with a caption.
    #[arg(long)]
    pub no_title: bool,
    /// Units on the axes of a run's pictures.
    #[arg(long, value_enum, default_value_t, value_name = "UNITS")]
    pub units: UnitsOption,
}

/// Finds out what the directory is and draws it.
pub fn plot(args: &PlotArgs) -> Result<Exit, CliError> {
    let dir = args.dir.as_path();
    let nothing = |what: String| CliError::NothingToPlot { dir: dir.to_owned(), what };
    match fs::metadata(dir) {
        Err(error) => return Err(nothing(format!("cannot be read: {error}"))),
        Ok(found) if !found.is_dir() => return Err(nothing("is not a directory".to_owned())),
        Ok(_) => {}
    }
    let study = StudyDirectory::new(dir);
    if study.holds_study() {
        return plot_study(&study, args);
    }
    let run = OutputDirectory::existing(dir);
    if run.holds_result() {
        return plot_run(&run, args);
    }
    let missing = |path: PathBuf, otherwise: &str| {
        let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        if path.exists() { format!("its {name} is {otherwise}") } else { format!("there is no {name}") }
    };
    Err(nothing(format!(
        "is neither a run nor a study: {}, and {}",
        missing(run.case(), "not one that a run wrote"),
        missing(study.table(), "not the table of a study")
    )))
}

fn plot_study(study: &StudyDirectory, args: &PlotArgs) -> Result<Exit, CliError> {
    let own = study.root().join("law.json");
    let path = args.law.clone().or_else(|| own.exists().then_some(own));
    let law = path.as_deref().map(LawFile::read).transpose()?;
    let formulas = match &law {
        Some(LawFile::Formulas(law)) => Some(law.as_ref()),
        // The table's own picture is drawn where the table is made; its study is drawn without
        // formulas.
        Some(LawFile::Table(_) | LawFile::Interpolated(_)) | None => None,
    };
    let format = args.format.map_or(PictureFormat::Svg, PictureFormat::from);
    let written = report::write_report(study, formulas, Sheet { width: args.width, untitled: args.no_title }, format)?;
    tell(&written)
}

fn plot_run(run: &OutputDirectory, args: &PlotArgs) -> Result<Exit, CliError> {
    run.refuse_links()?;
    let case = run.load_case()?;
    let law = args.law.as_deref().map(LawFile::read_or_built_in).transpose()?;
    let history = read_history(&run.history())?;
    let width = args.width.or(case.output.plot_width);
    let view = View { axes: Axes::of(&case, args.units.into()), sheet: Sheet { width, untitled: args.no_title } };
    let mut pictures = replot(run, &case, &history, &view)?;
    if let Some(law) = &law {
        let in_case = |source: LawError| CliError::LawCase { file: run.case(), source: Box::new(source) };
        let (picture, out_of_range) = beside_run(law, &case, &history, &view).map_err(in_case)?;
        super::print::warn_out_of_range(&run.case(), &out_of_range);
        pictures.push(picture);
    }
    if pictures.is_empty() {
        // A closed stderr does not change what was drawn.
        let _ = writeln!(std::io::stderr(), "warning: {} has no steps yet: there is nothing to draw", run.history().display());
    }
    let format = args.format.map_or(case.output.plot_format, PictureFormat::from);
    pictures.iter().try_for_each(|picture| refuse_foreign(&run.plot(picture.name, format)))?;
    let mut written = Vec::new();
    for picture in &pictures {
        let path = run.plot(picture.name, format);
        picture.write(&path, format)?;
        written.push(path);
    }
    tell(&written)
}

/// Prints the paths, a line each.
fn tell(written: &[PathBuf]) -> Result<Exit, CliError> {
    let lines: Vec<String> = written.iter().map(|path| format!("{}\n", path.display())).collect();
    print(&lines.concat())?;
    Ok(Exit::Done)
}
