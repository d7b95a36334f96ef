//! In which directory the results of each case lie. A study that is begun numbers its cases in grid
//! order; one whose grid has grown finds its cases where they are and gives the new ones numbers
//! that are free.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::time::{Duration, Instant};

use super::StudyError;
use super::directory::{EarlierStudy, StudyDirectory};
use super::file::Study;
use super::id::{case_id, directory_of, is_case_id};
use super::row::cell;
use crate::law::study_table::StudyTable;
use crate::output::{DirectoryLock, OutputDirectory, OutputError, RunStatus, Summary, TaskLock, read_history};

/// A study and the directories of its cases.
#[derive(Debug)]
pub struct Placed {
    /// The study, its cases with the names of their directories.
    pub study: Study,
    /// Directories with results of cases that the study does not have.
    pub strangers: Vec<String>,
    /// How many of its cases have a directory.
    pub begun: usize,
}

impl StudyDirectory {
    /// Prepares the folder, and says where the results of the study's cases are. One that does not
    /// exist is made, an empty one is used. In one that holds a study, results stay that are of
    /// this study if it is to be kept, which takes that there are some, or none at all; if they are
    /// to be replaced, what studies wrote is removed and everything else stays. Anything else is
    /// refused, untouched.
    ///
    /// # Errors
    /// [`StudyError::NotADirectory`], [`StudyError::NotAStudy`], [`StudyError::OtherStudy`],
    /// [`StudyError::Earlier`], [`StudyError::Directory`], [`StudyError::Output`] where somebody
    /// else computes one of the cases that are to be replaced.
    pub fn prepare(&self, study: &Study, earlier: EarlierStudy) -> Result<Placed, StudyError> {
        self.recognise()?;
        match earlier {
            EarlierStudy::Keep => {}
            EarlierStudy::Replace => self.clear()?,
            EarlierStudy::Refuse => {
                let ids = numbered(self)?;
                let computed: Vec<Computed> = ids.iter().filter_map(|id| computed(&self.case(id))).collect();
                if !computed.is_empty() {
                    return Err(earlier_results(self, &computed));
                }
                self.clear()?;
            }
        }
        place(self, study)
    }
}

/// Finds the directories of the study's cases in its folder, as it is.
///
/// # Errors
/// [`StudyError::OtherStudy`] if there are results, and none of them is of this study;
/// [`StudyError::Directory`].
pub fn place(directory: &StudyDirectory, study: &Study) -> Result<Placed, StudyError> {
    let there = numbered(directory)?;
    let before = directory.study().exists().then(|| Study::load(&directory.study()));
    let same = before.as_ref().is_none_or(|before| before.as_ref().is_ok_and(|before| before.cases_are(study)));
    let told = if same { told(directory, study) } else { None };
    let ids = match told {
        Some(ids) => ids,
        None => {
            let ids = found(directory, study, &there);
            if ids.iter().all(Option::is_none) && !there.is_empty() {
                return Err(other_study(directory, study, before));
            }
            with_free_numbers(study, ids, &there)
        }
    };
    let mut placed = study.clone();
    placed.cases.iter_mut().zip(ids).for_each(|(case, id)| case.id = id);
    let ours: BTreeSet<&str> = placed.cases.iter().map(|case| case.id.as_str()).collect();
    let strangers = there.iter().filter(|id| !ours.contains(id.as_str())).cloned().collect();
    let begun = there.iter().filter(|id| ours.contains(id.as_str())).count();
    Ok(Placed { study: placed, strangers, begun })
}

/// The names of the directories in `cases/` that hold a result, or what is left of one whose
/// `case.toml` is gone.
fn numbered(directory: &StudyDirectory) -> Result<Vec<String>, StudyError> {
    let mut names = directory.numbered()?;
    names.retain(|id| directory.case(id).holds_result() || computed(&directory.case(id)).is_some());
    Ok(names)
}

/// How far a case is of which there is something to lose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Computed {
    /// To the end of its path.
    Done,
    /// It ended, but not well.
    Ended,
    /// It is unfinished.
    Begun,
}

/// What is computed of the case in a directory; `None` if it is nothing.
pub(super) fn computed(out: &OutputDirectory) -> Option<Computed> {
    match Summary::read(&out.summary()).map(|summary| summary.status) {
        Ok(RunStatus::Done) => Some(Computed::Done),
        Ok(RunStatus::NotConverged | RunStatus::ContactOutgrewMesh | RunStatus::Failed) => Some(Computed::Ended),
        Ok(RunStatus::Interrupted) => Some(Computed::Begun),
        Err(_) => {
            let steps = || read_history(&out.history()).map_or(0, |rows| rows.len());
            (out.checkpoint().exists() || steps() > 0).then_some(Computed::Begun)
        }
    }
}

/// Refuses to begin where cases have been computed.
pub(super) fn earlier_results(directory: &StudyDirectory, computed: &[Computed]) -> StudyError {
    let count = |wanted| computed.iter().filter(|one| **one == wanted).count();
    let rest = [(count(Computed::Ended), "failed or did not converge"), (count(Computed::Begun), "unfinished")];
    let words = rest.into_iter().filter(|(number, _)| *number > 0).map(|(number, what)| format!(", {number} {what}"));
    let what = format!("{} cases are done{}", count(Computed::Done), words.collect::<String>());
    StudyError::Earlier { dir: directory.root().to_owned(), what }
}

/// The names that `study.csv` tells, if it is the table of this very study.
fn told(directory: &StudyDirectory, study: &Study) -> Option<Vec<String>> {
    let table = StudyTable::read(&directory.table()).ok().filter(|table| table.rows.len() == study.cases.len())?;
    let mut names = BTreeSet::new();
    for (row, case) in table.rows.iter().zip(&study.cases) {
        let same = study.keys.iter().zip(&case.values).all(|(key, value)| same_cell(table.cell(row, key), &cell(key, value)));
        let number = is_case_id(&row.id) && row.directory == directory_of(&row.id);
        if !(same && number && names.insert(row.id.clone())) {
            return None;
        }
    }
    Some(table.rows.into_iter().map(|row| row.id).collect())
}

/// Whether two cells say the same: an earlier version wrote whole numbers without a point.
fn same_cell(one: &str, other: &str) -> bool {
    let number = |text: &str| text.parse::<f64>().ok();
    one == other || number(one).is_some_and(|one| number(other) == Some(one))
}

/// For each case the directory that holds it, if there is one: that of its own number rather than
/// another.
fn found(directory: &StudyDirectory, study: &Study, there: &[String]) -> Vec<Option<String>> {
    let holds = |id: &str| directory.case(id).load_case().ok().map(|case| case.identity());
    let held: Vec<(&String, String)> = there.iter().filter_map(|id| Some((id, holds(id)?))).collect();
    let mut by_case: BTreeMap<&str, Vec<&String>> = BTreeMap::new();
    held.iter().for_each(|(id, case)| by_case.entry(case).or_default().push(id));
    let one_of = |case: &super::StudyCase| {
        let ids = by_case.get(case.case.identity().as_str())?;
        ids.iter().find(|id| ***id == case.id).or(ids.first()).map(|id| (*id).clone())
    };
    study.cases.iter().map(one_of).collect()
}

/// Names for the cases that have none: their own numbers where those are free, else the first free
/// ones after the last.
fn with_free_numbers(study: &Study, ids: Vec<Option<String>>, there: &[String]) -> Vec<String> {
    let mut taken: BTreeSet<String> = there.iter().cloned().collect();
    // Whoever comes later and finds some of them begun comes to the same names.
    let mut next = study.cases.len();
    let mut number = |own: &str, taken: &mut BTreeSet<String>| {
        let mut id = own.to_owned();
        while !taken.insert(id.clone()) {
            next += 1;
            id = case_id(next, own.len() - 1);
        }
        id
    };
    let pairs = study.cases.iter().zip(ids);
    pairs.map(|(case, id)| id.unwrap_or_else(|| number(&case.id, &mut taken))).collect()
}

/// In what the study differs from the one whose results are there.
fn other_study(directory: &StudyDirectory, study: &Study, before: Option<Result<Study, StudyError>>) -> StudyError {
    let what = match before {
        None => "none of the results is of a case of this one".to_owned(),
        Some(Err(error)) => error.to_string(),
        Some(Ok(found)) if found.keys != study.keys => format!("its grid is {}, not {}", found.size(), study.size()),
        Some(Ok(found)) => match found.cases.iter().zip(&study.cases).find(|(there, here)| there.case != here.case) {
            Some((there, here)) if there.values != here.values => {
                let (there, here) = (found.combination(there), study.combination(here));
                format!("a case of it is {there}, where this one has {here}")
            }
            _ => "its base gives other cases than this one's".to_owned(),
        },
    };
    StudyError::OtherStudy {
        dir: directory.root().to_owned(),
        what: format!("{what}, and none of its results is of a case of this one"),
    }
}

/// The right to prepare a study's folder, which several processes may do at once: waits for it.
///
/// # Errors
/// [`StudyError::Output`].
pub fn alone(directory: &StudyDirectory) -> Result<DirectoryLock, StudyError> {
    const PATIENCE: Duration = Duration::from_secs(120);
    const LONGEST_PAUSE: Duration = Duration::from_millis(250);
    let (begun, mut pause) = (Instant::now(), Duration::from_millis(20));
    loop {
        match DirectoryLock::take(directory.root()) {
            Err(OutputError::Locked { .. }) if begun.elapsed() < PATIENCE => std::thread::sleep(pause),
            taken => return Ok(taken?),
        }
        pause = (2 * pause).min(LONGEST_PAUSE);
    }
}

/// The right to compute the study in its folder, with others who compute shares of it or, with
/// `alone`, by oneself; nobody computes another study there as long as it is kept. To be taken by
/// whoever is [`alone`] in the folder.
///
/// # Errors
/// [`StudyError::Output`] with who is there.
pub fn join(directory: &StudyDirectory, study: &Study, alone: bool) -> Result<TaskLock, StudyError> {
    Ok(TaskLock::join(directory.root(), &study.fingerprint(), alone, ["this study", "another study"])?)
}

/// The right to work on with the results of a study in its folder: nobody begins another there as
/// long as it is kept.
///
/// # Errors
/// [`StudyError::Output`] with who computes another study there.
pub fn hold(dir: &Path, study: &Study) -> Result<TaskLock, StudyError> {
    let directory = StudyDirectory::new(dir);
    let _alone = alone(&directory)?;
    join(&directory, study, false)
}
