//! Where the results of a study lie: `study.toml`, `study.csv` and `cases/0001/`, each an ordinary run's directory; `plots/*.svg` and `report.html` of
//! `asperity plot`.

use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use super::StudyError;
use super::file::Study;
use super::row::FIRST_COLUMNS;
use crate::law::plots::STUDY_PICTURES;
use crate::output::{OutputDirectory, write_atomically};

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

    /// `plots/NAME.svg`.
    pub fn plot(&self, name: &str) -> PathBuf {
        self.root.join(format!("plots/{name}.svg"))
    }

    /// `report.html`.
    pub fn report(&self) -> PathBuf {
        self.root.join("report.html")
    }

    /// The directory of a case from the study's, as `study.csv` names it.
    pub fn relative(id: &str) -> String {
        format!("cases/{id}")
    }

    /// The directory of a case.
    pub fn case(&self, id: &str) -> OutputDirectory {
        OutputDirectory::existing(self.root.join("cases").join(id))
    }

    /// Whether there is a study: by the header of `study.csv`, and only by it, a directory is recognised as one that may be replaced.
    pub fn holds_study(&self) -> bool {
        let table = fs::read_to_string(self.table());
        table.is_ok_and(|text| text.starts_with(&format!("{},", FIRST_COLUMNS.join(","))))
    }

    /// Prepares the folder. One that does not exist is made, an empty one is used. In one that holds a study, `keep` tells whether its results
    /// stay, which takes that it is this very study (comments and spaces apart); if they do not, what studies wrote is removed and everything else
    /// stays. Anything else is refused, untouched.
    ///
    /// # Errors
    /// [`StudyError::NotADirectory`], [`StudyError::NotAStudy`], [`StudyError::OtherStudy`], [`StudyError::Directory`].
    pub fn prepare(&self, study: &Study, keep: bool) -> Result<(), StudyError> {
        let dir = &self.root;
        let failed = |what: &'static str| move |source: io::Error| StudyError::Directory { dir: dir.clone(), what, source };
        match fs::metadata(dir) {
            Ok(found) if !found.is_dir() => return Err(StudyError::NotADirectory { dir: dir.clone() }),
            Ok(_) => {}
            Err(error) if error.kind() == ErrorKind::NotFound => fs::create_dir_all(dir).map_err(failed("be created"))?,
            Err(error) => return Err(failed("be read")(error)),
        }
        let names = names(dir).map_err(failed("be read"))?;
        if !self.holds_study() {
            return match names.into_iter().min() {
                Some(found) => Err(StudyError::NotAStudy { dir: dir.clone(), found }),
                None => Ok(()),
            };
        }
        if keep { self.same_study(study) } else { self.clear() }
    }

    /// Refuses a folder that was begun with another study.
    fn same_study(&self, study: &Study) -> Result<(), StudyError> {
        let other = |what: String| StudyError::OtherStudy { dir: self.root.clone(), what };
        if !self.study().exists() {
            // Killed before anything was computed.
            return Ok(());
        }
        let found = Study::load(&self.study()).map_err(|error| other(error.to_string()))?;
        if found.keys != study.keys {
            return Err(other(format!("its grid is {}, not {}", found.size(), study.size())));
        }
        if found.cases.len() != study.cases.len() {
            return Err(other(format!("it has {}, not {}", found.size(), study.size())));
        }
        match found.cases.iter().zip(&study.cases).find(|(there, here)| there.case != here.case) {
            Some((there, here)) if there.values != here.values => {
                let (there, here) = (found.combination(there), study.combination(here));
                Err(other(format!("a case of it is {there}, where this one has {here}")))
            }
            Some((there, _)) => Err(other(format!("its base gives another case {} than this one's", there.id))),
            None => Ok(()),
        }
    }

    /// Removes what earlier studies wrote.
    fn clear(&self) -> Result<(), StudyError> {
        let cases = self.root.join("cases");
        let failed = |source| StudyError::Directory { dir: self.root.clone(), what: "be cleared", source };
        if cases.is_dir() {
            for name in names(&cases).map_err(failed)? {
                let out = OutputDirectory::existing(cases.join(&name));
                if name.bytes().all(|byte| byte.is_ascii_digit()) && out.holds_result() {
                    out.clear()?;
                    fs::remove_file(out.case()).map_err(failed)?;
                    for folder in ["fields", "contact", "plots", ""] {
                        remove_if_empty(&out.root().join(folder)).map_err(failed)?;
                    }
                }
            }
            remove_if_empty(&cases).map_err(failed)?;
        }
        let pictures = STUDY_PICTURES.into_iter().map(|name| self.plot(name));
        for file in pictures.chain([self.report(), self.study(), self.table()]) {
            if file.is_file() {
                fs::remove_file(&file).map_err(failed)?;
            }
        }
        remove_if_empty(&self.root.join("plots")).map_err(failed)?;
        Ok(())
    }

    /// Writes `study.toml`.
    ///
    /// # Errors
    /// [`StudyError::Output`].
    pub fn write_study(&self, study: &Study) -> Result<(), StudyError> {
        Ok(write_atomically(&self.study(), |out| out.write_all(study.text.as_bytes()))?)
    }
}

fn names(dir: &Path) -> io::Result<Vec<String>> {
    fs::read_dir(dir)?.map(|entry| Ok(entry?.file_name().to_string_lossy().into_owned())).collect()
}

/// A folder in which the user keeps something of his own stays.
fn remove_if_empty(dir: &Path) -> io::Result<()> {
    if dir.is_dir() && fs::read_dir(dir)?.next().is_none() {
        fs::remove_dir(dir)?;
    }
    Ok(())
}
