//! In which directory the results of each case lie. A study that is begun numbers its cases in grid
//! order; one whose grid has grown finds its cases where they are and gives the new ones numbers
//! that are free.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::time::{Duration, Instant};

use super::StudyError;
use super::directory::{Earlier, StudyDirectory};
use super::file::Study;
use super::id::{case_id, directory_of, is_case_id};
use crate::case::Case;
use crate::law::table::StudyTable;
use crate::output::{DirectoryLock, OutputDirectory, OutputError};

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
    pub fn prepare(&self, study: &Study, earlier: Earlier) -> Result<Placed, StudyError> {
        self.recognise()?;
        match earlier {
            Earlier::Keep => {}
            Earlier::Replace => self.clear()?,
            Earlier::Refuse => {
                let done =
                    StudyTable::read(&self.table()).map_or(0, |table| table.rows.iter().filter(|row| row.is_done()).count());
                if done > 0 {
                    return Err(StudyError::Earlier { dir: self.root().to_owned(), done });
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
    let failed = |source| StudyError::Directory { dir: directory.root().to_owned(), what: "be read", source };
    let there = numbered(directory).map_err(failed)?;
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

/// The names of the directories in `cases/` that hold a result.
fn numbered(directory: &StudyDirectory) -> std::io::Result<Vec<String>> {
    let cases = directory.root().join("cases");
    if !cases.is_dir() {
        return Ok(Vec::new());
    }
    let mut names = Vec::new();
    for entry in fs::read_dir(&cases)? {
        let name = entry?.file_name().to_string_lossy().into_owned();
        if is_case_id(&name) && OutputDirectory::existing(cases.join(&name)).holds_result() {
            names.push(name);
        }
    }
    names.sort();
    Ok(names)
}

/// The names that `study.csv` tells, if it is the table of this very study.
fn told(directory: &StudyDirectory, study: &Study) -> Option<Vec<String>> {
    let table = StudyTable::read(&directory.table()).ok().filter(|table| table.rows.len() == study.cases.len())?;
    let mut names = BTreeSet::new();
    for (row, case) in table.rows.iter().zip(&study.cases) {
        let same = study.keys.iter().zip(&case.values).all(|(key, value)| table.cell(row, key) == value);
        let number = is_case_id(&row.id) && row.directory == directory_of(&row.id);
        if !(same && number && names.insert(row.id.clone())) {
            return None;
        }
    }
    Some(table.rows.into_iter().map(|row| row.id).collect())
}

/// For each case the directory that holds it, if there is one: that of its own number rather than
/// another.
fn found(directory: &StudyDirectory, study: &Study, there: &[String]) -> Vec<Option<String>> {
    let holds = |id: &str| Case::load(&directory.case(id).case(), &[]).ok().map(|case| case.identity());
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
    let begun = Instant::now();
    loop {
        match DirectoryLock::take(directory.root()) {
            Err(OutputError::Locked { .. }) if begun.elapsed() < PATIENCE => std::thread::sleep(Duration::from_millis(20)),
            taken => return Ok(taken?),
        }
    }
}
