//! Joins the directories in which shares of a study were computed, on machines that share no disk,
//! say: the best of what there is of each case, and its row.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::StudyError;
use super::directory::{EarlierStudy, StudyDirectory};
use super::file::Study;
use super::place::place;
use super::row::{Row, RowStatus, write_table};
use super::run::{PreparedStudy, Report, begin, read_rows};
use crate::output::{DirectoryLock, OutputDirectory, write_atomically};

/// What was joined.
#[derive(Clone, Debug, PartialEq)]
pub struct Merged {
    /// How the cases stand now.
    pub report: Report,
    /// Cases whose results were copied.
    pub copied: usize,
    /// Cases that are not done, each with the name of its directory and its values.
    pub missing: Vec<String>,
    /// Cases that could not be copied as somebody computes them.
    pub busy: Vec<String>,
}

/// Joins the studies in `sources` in `out`, which may be one of them, a new directory, an empty
/// one, or one of the same study. Nothing is removed from the sources; of a case that is there
/// already, what is further is kept.
///
/// # Errors
/// [`StudyError::Merge`] for a source that is no study, or another one than the first; those of
/// preparing `out`; [`StudyError::Output`].
pub fn merge(sources: &[PathBuf], out: &Path) -> Result<Merged, StudyError> {
    let refused = |dir: &Path, what: String| StudyError::Merge { dir: dir.to_owned(), what };
    let mut studies: Vec<(StudyDirectory, Study)> = Vec::new();
    for dir in sources {
        let directory = StudyDirectory::new(dir);
        if !directory.holds_study() {
            return Err(refused(dir, "is not a study. Give directories of `asperity study --out`".to_owned()));
        }
        let study = Study::load(&directory.study()).map_err(|error| refused(dir, error.to_string()))?;
        if let Some((first, other)) = studies.first()
            && !other.cases_are(&study)
        {
            let what = format!("holds another study ({}) than {} ({})", study.size(), first.root().display(), other.size());
            return Err(refused(dir, format!("{what}. Merge directories of one study")));
        }
        let placed = place(&directory, &study)?.study;
        studies.push((directory, placed));
    }
    let Some((_, first)) = studies.first() else {
        return Err(refused(out, "there is nothing to merge. Give directories of `asperity study --out`".to_owned()));
    };
    let target = StudyDirectory::new(out);
    let PreparedStudy { study, mut rows, lock: _lock } = begin(&target, first, EarlierStudy::Keep, |_, _| Ok(()))?;
    let mut merged = Merged { report: Report::default(), copied: 0, missing: Vec::new(), busy: Vec::new() };
    for (directory, source) in studies.iter().filter(|(directory, _)| !is_same(directory.root(), out)) {
        for (number, (case, there)) in study.cases.iter().zip(&source.cases).enumerate() {
            let (from, to) = (directory.case(&there.id), target.case(&case.id));
            let found = Row::read(&case.case, &from);
            let begun = |out: &OutputDirectory, row: &Row| rank(row, out.holds_result() && out.checkpoint().exists());
            if begun(&from, &found) <= begun(&to, &rows[number]) {
                continue;
            }
            if copy(&from, &to, &case.case.to_toml())? {
                rows[number] = Row::read(&case.case, &to);
                merged.copied += 1;
            } else {
                merged.busy.push(case.id.clone());
            }
        }
    }
    let rows = read_rows(&study, &target);
    write_table(&target.table(), &study, &rows)?;
    let all: Vec<usize> = (0..rows.len()).collect();
    merged.report = Report::of(&study, &rows, &all);
    let open = study.cases.iter().zip(&rows).filter(|(_, row)| row.status == RowStatus::Pending);
    merged.missing = open.map(|(case, _)| format!("{} ({})", case.id, study.combination(case))).collect();
    Ok(merged)
}

/// How far a case is.
fn rank(row: &Row, checkpoint: bool) -> usize {
    match row.status {
        RowStatus::Done => 4,
        RowStatus::NotConverged | RowStatus::Outgrown => 3,
        RowStatus::Failed | RowStatus::Pending if checkpoint => 2,
        RowStatus::Failed => 1,
        RowStatus::Pending => 0,
    }
}

fn is_same(one: &Path, other: &Path) -> bool {
    matches!((fs::canonicalize(one), fs::canonicalize(other)), (Ok(one), Ok(other)) if one == other)
}

/// Copies a run's results, each file whole or not at all and the summary last, so that a copy that
/// is cut short is a case that has to be computed. False if somebody writes in one of the two
/// places.
fn copy(from: &OutputDirectory, to: &OutputDirectory, case: &str) -> Result<bool, StudyError> {
    OutputDirectory::create(to.root())?;
    // A source that cannot be written to, and so not be locked, is nobody's who writes there.
    let (Ok(_target), source) = (DirectoryLock::take(to.root()), DirectoryLock::take(from.root())) else { return Ok(false) };
    if matches!(source, Err(crate::output::OutputError::Locked { .. })) {
        return Ok(false);
    }
    to.clear()?;
    to.write_case(case)?;
    let mut files = vec![from.history(), from.parquet(), from.checkpoint()];
    from.refuse_links()?;
    files.extend(from.in_folders()?);
    files.push(from.summary());
    for file in files.iter().filter(|file| file.is_file()) {
        let relative = file.strip_prefix(from.root()).unwrap_or(file);
        let mut source = fs::File::open(file).map_err(reading(file))?;
        write_atomically(&to.root().join(relative), |out| io::copy(&mut source, out).map(drop))?;
    }
    Ok(true)
}

fn reading(path: &Path) -> impl FnOnce(io::Error) -> StudyError + '_ {
    move |source| crate::output::OutputError::Read { path: path.to_path_buf(), source }.into()
}
