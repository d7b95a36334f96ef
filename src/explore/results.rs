//! Results that are there already: the cases of a study, and one run, to be laid over the law.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::simulate::{SimulatedRun, Stage};
use crate::case::Case;
use crate::law::LawError;
use crate::law::study_table::StudyTable;
use crate::output::plots::SlipPanel;
use crate::output::{OutputDirectory, StepRecord, Summary, read_contact, read_history};

/// Most cases of a study that are read.
const MOST: usize = 5000;
/// Relative difference up to which two depths are the same one: a run's is where its press ended.
const SAME: f64 = 1e-6;
/// Most contact tables that are read of a run.
const MOST_FRAMES: usize = 80;

/// A case of a study.
#[derive(Clone, Debug)]
pub struct ShownCase {
    /// Its name in the study.
    pub id: String,
    /// The case.
    pub case: Case,
    /// Its results in some numbers.
    pub summary: Summary,
    directory: PathBuf,
}

impl ShownCase {
    /// Its rows; none where they cannot be read any more.
    pub fn history(&self) -> Vec<StepRecord> {
        read_history(&OutputDirectory::existing(&self.directory).history()).unwrap_or_default()
    }
}

/// The finished cases of a study.
#[derive(Clone, Debug, Default)]
pub struct StudyCases {
    /// The cases.
    pub cases: Vec<ShownCase>,
}

impl StudyCases {
    /// Reads those that are done.
    ///
    /// # Errors
    /// No study there, or one with a case that cannot be read.
    pub fn read(dir: &Path) -> Result<Self, LawError> {
        let table = StudyTable::read(&dir.join("study.csv"))?;
        let mut cases = Vec::new();
        for row in table.rows.iter().filter(|row| row.is_done()).take(MOST) {
            let directory = dir.join(&row.directory);
            let out = OutputDirectory::existing(&directory);
            let (case, summary) = (out.load_case()?, Summary::read(&out.summary())?);
            cases.push(ShownCase { id: row.id.clone(), case, summary, directory });
        }
        Ok(Self { cases })
    }

    /// The cases of the contact of `case`: whatever their depths and paths.
    pub fn of_contact(&self, case: &Case) -> Vec<&ShownCase> {
        self.cases.iter().filter(|one| same_contact(&one.case, case)).collect()
    }

    /// That of its depth too.
    pub fn of_depth(&self, case: &Case) -> Option<&ShownCase> {
        let (h, close) = (case.greatest_indentation(), |a: f64, b: f64| (a / b - 1.0).abs() < SAME);
        self.of_contact(case).into_iter().find(|one| one.summary.h0.is_some_and(|h0| close(h0, h)))
    }
}

/// Whether two cases are of one contact. A field shows all digits of a number, so that a case whose
/// values were put on the page is the same one.
pub fn same_contact(one: &Case, other: &Case) -> bool {
    one.sphere == other.sphere && one.material == other.material && one.contact == other.contact && one.opponent == other.opponent
}

/// Reads the results of a run as if the page had just made them.
///
/// # Errors
/// No case there, or results that cannot be read.
pub fn read_run(dir: &Path) -> Result<SimulatedRun, LawError> {
    let out = OutputDirectory::existing(dir);
    let case = out.load_case()?;
    let history = read_history(&out.history())?;
    let mut frames = Vec::new();
    for step in out.contact_steps()?.into_iter().take(MOST_FRAMES) {
        let Some(record) = history.iter().find(|record| record.step == step) else { continue };
        if record.delta_t != 0.0 {
            let ratio = (record.f_n > 0.0).then(|| record.f_t / record.f_n);
            let points = read_contact(&out.contact(step))?;
            frames.push(SlipPanel { step, delta_t: record.delta_t, ratio, points });
        }
    }
    let summary = Summary::read(&out.summary()).ok();
    Ok(SimulatedRun {
        query: String::new(),
        stage: Stage::Done,
        fraction: 1.0,
        message: format!("read from {}", dir.display()),
        seconds: summary.as_ref().map_or(0.0, |summary| summary.wall_s),
        case,
        history,
        frames: Arc::new(frames),
        summary,
    })
}
