//! `asperity plot`: the pictures of a run, or of a study with its report.

use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use clap::Args;

use super::{CliError, Outcome, print};
use crate::case::Case;
use crate::law::plots::{law_beside_run, table_beside_run};
use crate::law::{LawError, LawFile};
use crate::output::plots::replot;
use crate::output::{OutputDirectory, read_history};
use crate::study::{StudyDirectory, report};

/// Draw the results in a directory: DIR/plots, and DIR/report.html for a study.
///
/// A run may be unfinished; of a study, the finished cases are drawn.
#[derive(Clone, Debug, Args)]
pub struct PlotArgs {
    /// The directory of a run or of a study.
    #[arg(value_name = "DIR")]
    pub dir: PathBuf,
    /// A law to draw beside the simulations. For a study, DIR/law.json is used if it exists.
    #[arg(long, value_name = "LAW.json")]
    pub law: Option<PathBuf>,
}

/// Finds out what the directory is and draws it.
pub fn plot(args: &PlotArgs) -> Result<Outcome, CliError> {
    let dir = args.dir.as_path();
    let nothing = |what: String| CliError::NothingToPlot { dir: dir.to_owned(), what };
    match fs::metadata(dir) {
        Err(error) => return Err(nothing(format!("cannot be read: {error}"))),
        Ok(found) if !found.is_dir() => return Err(nothing("is not a directory".to_owned())),
        Ok(_) => {}
    }
    let study = StudyDirectory::new(dir);
    if study.holds_study() {
        return plot_study(&study, args.law.as_deref());
    }
    let run = OutputDirectory::existing(dir);
    if run.holds_result() {
        return plot_run(&run, args.law.as_deref());
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

fn plot_study(study: &StudyDirectory, law: Option<&Path>) -> Result<Outcome, CliError> {
    let own = study.root().join("law.json");
    let path = law.map(Path::to_owned).or_else(|| own.exists().then_some(own));
    let law = path.as_deref().map(LawFile::read).transpose()?;
    let formulas = match &law {
        Some(LawFile::Formulas(law)) => Some(law.as_ref()),
        // The table's own picture is drawn where the table is made; its study is drawn without
        // formulas.
        Some(LawFile::Table(_)) | None => None,
    };
    let written = report::write_report(study, formulas)?;
    tell(&written)
}

fn plot_run(run: &OutputDirectory, law: Option<&Path>) -> Result<Outcome, CliError> {
    let law = law.map(LawFile::read).transpose()?;
    let case = Case::load(&run.case(), &[])?;
    let history = read_history(&run.history())?;
    let mut pictures = replot(run, &case, &history)?;
    if let Some(law) = &law {
        let in_case = |source: LawError| CliError::LawCase { file: run.case(), source: Box::new(source) };
        let (picture, out_of_range) = match law {
            LawFile::Formulas(law) => {
                law_beside_run(law, &case, &history).map(|(picture, prediction)| (picture, prediction.out_of_range))
            }
            LawFile::Table(_) => table_beside_run(law, &case, &history),
        }
        .map_err(in_case)?;
        super::law::warn_out_of_range(&run.case(), &out_of_range);
        pictures.push(picture);
    }
    if pictures.is_empty() {
        // A closed stderr does not change what was drawn.
        let _ = writeln!(std::io::stderr(), "warning: {} has no steps yet: there is nothing to draw", run.history().display());
    }
    let mut written = Vec::new();
    for picture in &pictures {
        let path = run.plot(picture.name);
        picture.write(&path)?;
        written.push(path);
    }
    tell(&written)
}

/// Prints the paths, a line each.
fn tell(written: &[PathBuf]) -> Result<Outcome, CliError> {
    let lines: Vec<String> = written.iter().map(|path| format!("{}\n", path.display())).collect();
    print(&lines.concat())?;
    Ok(Outcome::Done)
}
