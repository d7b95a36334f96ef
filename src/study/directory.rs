//! Where the results of a study lie: `study.toml`, `study.csv` and `cases/c0001/`, each an ordinary
//! run's directory; `plots/*.svg` and `report.html` of `asperity plot`.

use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use super::StudyError;
use super::file::Study;
use super::id::is_case_id;
use super::row::FIRST_COLUMNS;
use crate::bounded;
use crate::case::PictureFormat;
use crate::output::{
    DirectoryLock, LOCK_NAME, OutputDirectory, OutputError, draft_of, is_left, is_study_lock, refuse_foreign, remove_if_there,
    write_atomically,
};

/// Names of all pictures of a study, by which an earlier study's are removed.
const STUDY_PICTURES: [&str; 8] =
    ["johnson", "area", "fall", "parameters", "collapse-tangential", "collapse-normal", "cases", "errors"];

/// The folder of one study.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StudyDirectory {
    root: PathBuf,
}

impl StudyDirectory {
    /// A folder that may or may not be there.
    pub fn new(root: impl Into<PathBuf>) -> Self {
        Self { root: root.into() }
    }

    /// The folder itself.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// `study.toml`, a copy of the study file.
    pub fn study(&self) -> PathBuf {
        self.root.join("study.toml")
    }

    /// `study.csv`, a row a case.
    pub fn table(&self) -> PathBuf {
        self.root.join("study.csv")
    }

    /// `plots/NAME.svg`, or with the ending of another format.
    pub fn plot(&self, name: &str, format: PictureFormat) -> PathBuf {
        self.root.join(format!("plots/{name}.{}", format.ending()))
    }

    /// `report.html`.
    pub fn report(&self) -> PathBuf {
        self.root.join("report.html")
    }

    /// The directory of a case.
    pub fn case(&self, id: &str) -> OutputDirectory {
        OutputDirectory::existing(self.root.join("cases").join(id))
    }

    /// Whether there is a study: by the header of `study.csv`, and only by it, a directory is
    /// recognised as one that may be replaced.
    pub fn holds_study(&self) -> bool {
        let expected = format!("{},", FIRST_COLUMNS.join(","));
        bounded::beginning(&self.table(), expected.len() as u64).is_ok_and(|head| head == expected.as_bytes())
    }

    /// Refuses a folder that is neither absent nor empty nor a study's.
    ///
    /// # Errors
    /// [`StudyError::NotADirectory`], [`StudyError::NotAStudy`], [`StudyError::Directory`],
    /// [`StudyError::Output`] for a folder that is a link.
    pub fn recognise(&self) -> Result<(), StudyError> {
        let dir = &self.root;
        let failed = |source: io::Error| StudyError::Directory { dir: dir.clone(), what: "be read", source };
        match fs::metadata(dir) {
            Ok(found) if !found.is_dir() => return Err(StudyError::NotADirectory { dir: dir.clone() }),
            Ok(_) => {}
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(()),
            Err(error) => return Err(failed(error)),
        }
        if self.holds_study() {
            return self.refuse_links();
        }
        // What a study leaves that was killed before its first file had its name is no hindrance.
        let own = |name: &String| name == LOCK_NAME || is_study_lock(name) || own_draft(name);
        let foreign = names(dir).map_err(failed)?.into_iter().filter(|name| !own(name)).min();
        foreign.map_or(Ok(()), |found| Err(StudyError::NotAStudy { dir: dir.clone(), found }))
    }

    /// Refuses a study in which a folder, of a case too, is a link: what it leads to is not ours to
    /// write to or to clear.
    ///
    /// # Errors
    /// [`StudyError::Output`], [`StudyError::Directory`].
    pub fn refuse_links(&self) -> Result<(), StudyError> {
        let refuse = |path: PathBuf| if path.is_symlink() { Err(OutputError::Link { path }) } else { Ok(()) };
        ["cases", "plots", "slurm"].into_iter().try_for_each(|folder| refuse(self.root.join(folder)))?;
        for id in self.numbered()? {
            let out = self.case(&id);
            refuse(out.root().to_owned())?;
            out.refuse_links()?;
        }
        Ok(())
    }

    /// The names in `cases/` that are those of directories of cases, in their order.
    pub(super) fn numbered(&self) -> Result<Vec<String>, StudyError> {
        let cases = self.root.join("cases");
        if !cases.is_dir() {
            return Ok(Vec::new());
        }
        let failed = |source| StudyError::Directory { dir: self.root.clone(), what: "be read", source };
        let mut found = names(&cases).map_err(failed)?;
        found.retain(|name| is_case_id(name));
        found.sort();
        Ok(found)
    }

    /// Makes the directory of a case, but not that of the study: one that was removed or moved
    /// while the study goes on does not come back.
    pub(super) fn make_case(&self, id: &str) -> Result<OutputDirectory, OutputError> {
        let out = self.case(id);
        for dir in [&self.root.join("cases"), out.root()] {
            match fs::create_dir(dir) {
                Err(source) if source.kind() != ErrorKind::AlreadyExists => {
                    return Err(OutputError::Write { path: dir.to_owned(), source });
                }
                _ => {}
            }
        }
        Ok(out)
    }

    /// Removes what earlier studies wrote, or refuses that and changes nothing.
    pub(super) fn clear(&self) -> Result<(), StudyError> {
        self.refuse_links()?;
        let drawn = || STUDY_PICTURES.into_iter().flat_map(|name| PictureFormat::ALL.map(|format| self.plot(name, format)));
        drawn().chain([self.report()]).try_for_each(|path| refuse_foreign(&path))?;
        let failed = |source| StudyError::Directory { dir: self.root.clone(), what: "be cleared", source };
        // Before any of them is removed nobody computes any of them.
        for (out, lock) in self.lock_cases()? {
            out.clear()?;
            remove_if_there(&out.case()).map_err(failed)?;
            for folder in ["fields", "contact", "plots"] {
                remove_if_empty(&out.root().join(folder)).map_err(failed)?;
            }
            drop(lock);
            remove_if_empty(out.root()).map_err(failed)?;
        }
        remove_if_empty(&self.root.join("cases")).map_err(failed)?;
        for name in names(&self.root).map_err(failed)?.iter().filter(|name| own_draft(name)) {
            let path = self.root.join(name);
            let of_lock = draft_of(name).is_some_and(|name| name == LOCK_NAME || is_study_lock(name));
            if !of_lock || is_left(&path) {
                remove_if_there(&path).map_err(failed)?;
            }
        }
        for file in drawn().chain([self.report(), self.study(), self.table()]) {
            if file.is_file() {
                remove_if_there(&file).map_err(failed)?;
            }
        }
        remove_if_empty(&self.root.join("plots")).map_err(failed)?;
        Ok(())
    }

    /// Takes the locks of all directories in which there is a result of a case.
    fn lock_cases(&self) -> Result<Vec<(OutputDirectory, DirectoryLock)>, StudyError> {
        let mut cases: Vec<_> = self.numbered()?.iter().map(|id| self.case(id)).collect();
        cases.iter().try_for_each(OutputDirectory::refuse_foreign)?;
        cases.retain(OutputDirectory::holds_result);
        let mut locked = Vec::with_capacity(cases.len());
        for out in cases {
            let mut lock = DirectoryLock::take(out.root())?;
            // There may be more cases than files that may be open.
            lock.close();
            locked.push((out, lock));
        }
        Ok(locked)
    }

    /// Writes `study.toml`.
    ///
    /// # Errors
    /// [`StudyError::Output`].
    pub fn write_study(&self, study: &Study) -> Result<(), StudyError> {
        // It may be the file that was read.
        match bounded::result_to_string(&self.study(), bounded::CASE) {
            Ok(found) if found == study.text => Ok(()),
            _ => Ok(write_atomically(&self.study(), |out| out.write_all(study.text.as_bytes()))?),
        }
    }
}

/// What is to become of an earlier study in the folder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EarlierStudy {
    /// It is gone on with.
    Keep,
    /// It is replaced.
    Replace,
    /// It is replaced only if none of it is done.
    Refuse,
}

/// Whether a name is that of a draft of the study's own files.
fn own_draft(name: &str) -> bool {
    let ours = |name| matches!(name, "study.csv" | "study.toml" | "report.html" | LOCK_NAME) || is_study_lock(name);
    draft_of(name).is_some_and(ours)
}

fn names(dir: &Path) -> io::Result<Vec<String>> {
    fs::read_dir(dir)?.map(|entry| Ok(entry?.file_name().to_string_lossy().into_owned())).collect()
}

/// A folder in which the user keeps something of his own stays.
fn remove_if_empty(dir: &Path) -> io::Result<()> {
    let removed = || if dir.is_dir() && fs::read_dir(dir)?.next().is_none() { fs::remove_dir(dir) } else { Ok(()) };
    match removed() {
        // Somebody was faster, or makes a lock's draft in it.
        Err(error) if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::DirectoryNotEmpty) => Ok(()),
        done => done,
    }
}
