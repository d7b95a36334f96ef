//! Where each result of a run lies in its folder.

use super::{OutputError, write_atomically};
use std::fs;
use std::path::{Path, PathBuf};

/// The folder of one run: the names in it, in one place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OutputDirectory {
    root: PathBuf,
}

impl OutputDirectory {
    /// Makes the folder if it is not there.
    pub fn create(root: impl Into<PathBuf>) -> Result<Self, OutputError> {
        let root = root.into();
        fs::create_dir_all(&root).map_err(OutputError::writing(&root))?;
        Ok(Self { root })
    }

    /// A folder that is there already, to be read; nothing is checked.
    pub fn existing(root: impl Into<PathBuf>) -> Self {
        Self { root: root.into() }
    }

    /// The folder itself.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// `case.toml`, the resolved case.
    pub fn case(&self) -> PathBuf {
        self.root.join("case.toml")
    }

    /// `history.csv`, a row a step.
    pub fn history(&self) -> PathBuf {
        self.root.join("history.csv")
    }

    /// `summary.json`.
    pub fn summary(&self) -> PathBuf {
        self.root.join("summary.json")
    }

    /// The checkpoint, there while the run is unfinished.
    pub fn checkpoint(&self) -> PathBuf {
        self.root.join("checkpoint")
    }

    /// `fields/step_0020.vtu`.
    pub fn fields(&self, step: usize) -> PathBuf {
        self.root.join(format!("fields/step_{step:04}.vtu"))
    }

    /// `fields/case.pvd`, the list of the above.
    pub fn collection(&self) -> PathBuf {
        self.root.join("fields/case.pvd")
    }

    /// `contact/step_0020.csv`.
    pub fn contact(&self, step: usize) -> PathBuf {
        self.root.join(format!("contact/step_{step:04}.csv"))
    }

    /// `plots/NAME.svg`.
    pub fn plot(&self, name: &str) -> PathBuf {
        self.root.join(format!("plots/{name}.svg"))
    }

    /// Step numbers for which there is a contact file, increasing; none if there is no such folder.
    pub fn contact_steps(&self) -> Result<Vec<usize>, OutputError> {
        let folder = self.root.join("contact");
        if !folder.is_dir() {
            return Ok(Vec::new());
        }
        let mut steps = Vec::new();
        for entry in fs::read_dir(&folder).map_err(OutputError::reading(&folder))? {
            let name = entry.map_err(OutputError::reading(&folder))?.file_name();
            let step: Option<usize> =
                name.to_str().and_then(|name| name.strip_prefix("step_")?.strip_suffix(".csv")?.parse().ok());
            steps.extend(step);
        }
        steps.sort_unstable();
        Ok(steps)
    }

    /// Writes `case.toml`.
    pub fn write_case(&self, toml: &str) -> Result<(), OutputError> {
        write_atomically(&self.case(), |out| out.write_all(toml.as_bytes()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_listing() {
        let folder = tempfile::tempdir().unwrap();
        let out = OutputDirectory::create(folder.path().join("new/run")).unwrap();
        assert!(out.fields(20).ends_with("fields/step_0020.vtu"));
        assert!(out.contact(12345).ends_with("contact/step_12345.csv"));
        assert!(out.contact_steps().unwrap().is_empty());
        for step in [20, 3] {
            write_atomically(&out.contact(step), |_| Ok(())).unwrap();
        }
        write_atomically(&out.root().join("contact/notes.txt"), |_| Ok(())).unwrap();
        assert_eq!(out.contact_steps().unwrap(), [3, 20]);
        out.write_case("[sphere]\nradius = 1.0\n").unwrap();
        assert_eq!(fs::read_to_string(out.case()).unwrap(), "[sphere]\nradius = 1.0\n");
    }
}
