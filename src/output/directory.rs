//! Where each result of a run lies in its folder.

use super::OutputError;
use super::atomic::{draft_of, remove_if_there};
use super::lock::{LOCK_NAME, is_left};
use super::own::{RESULT_MARKER, refuse_foreign, write_own};
use super::tables::RUN_PICTURES;
use crate::bounded;
use crate::case::{Case, CaseError, PictureFormat};
use std::fs;
use std::path::{Path, PathBuf};

/// Names of the checkpoints: of where a run goes on, and of the end before an extension.
const CHECKPOINTS: [&str; 2] = ["checkpoint.bin", "checkpoint-end.bin"];

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

    /// `history.parquet`, the same rows.
    pub fn parquet(&self) -> PathBuf {
        self.root.join("history.parquet")
    }

    /// `summary.json`.
    pub fn summary(&self) -> PathBuf {
        self.root.join("summary.json")
    }

    /// `checkpoint.bin`, there while the run is unfinished, and afterwards for a longer path.
    pub fn checkpoint(&self) -> PathBuf {
        self.root.join("checkpoint.bin")
    }

    /// `checkpoint-end.bin`, the end of the shorter path while an extension of it is not done.
    pub fn end_checkpoint(&self) -> PathBuf {
        self.root.join("checkpoint-end.bin")
    }

    /// `run.log`, what the run said and when.
    pub fn log(&self) -> PathBuf {
        self.root.join("run.log")
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

    /// `plots/NAME.svg`, or with the ending of another format.
    pub fn plot(&self, name: &str, format: PictureFormat) -> PathBuf {
        self.root.join(format!("plots/{name}.{}", format.ending()))
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

    /// Removes what an earlier run left here, so that nothing of it is taken for the next one's:
    /// files by the names in this page, and drafts of killed runs. Everything else, `case.toml`
    /// among it, stays.
    pub fn clear(&self) -> Result<(), OutputError> {
        self.clear_but(|_, _| false)
    }

    /// Removes what an interrupted run left here beyond its checkpoint, in which the fields and
    /// contact tables of the steps `saved` and the tables of `panels` are: later ones, summary and
    /// pictures, and drafts. History and collection, which have entries of several steps, stay and
    /// have to be cut back.
    pub fn cut_back(&self, saved: &[usize], panels: &[usize]) -> Result<(), OutputError> {
        let saved = saved.iter().flat_map(|&step| [self.fields(step), self.contact(step)]);
        let files: Vec<String> =
            saved.chain(panels.iter().map(|&step| self.contact(step))).map(|path| file_name(&path)).collect();
        self.clear_but(|folder, name| match folder {
            "" => matches!(name, "history.csv" | "run.log") || CHECKPOINTS.contains(&name),
            "plots" => false,
            _ => name == "case.pvd" || files.iter().any(|file| file == name),
        })
    }

    /// Refuses a directory in which a folder of results is a link: what it leads to is not ours to
    /// write to or to clear.
    ///
    /// # Errors
    /// [`OutputError::Link`].
    pub fn refuse_links(&self) -> Result<(), OutputError> {
        let links =
            ["fields", "contact", "plots"].map(|folder| self.root.join(folder)).into_iter().find(|path| path.is_symlink());
        links.map_or(Ok(()), |path| Err(OutputError::Link { path }))
    }

    /// A file that there should be, as a checkpoint tells, and that is gone or empty: fields (where
    /// the case has them written) and contact tables of the steps `saved`, tables alone of the
    /// steps `panels`.
    pub fn missing(&self, saved: &[usize], panels: &[usize], fields: bool) -> Option<PathBuf> {
        let files = saved.iter().flat_map(|&step| [Some(self.contact(step)), fields.then(|| self.fields(step))]).flatten();
        files
            .chain(panels.iter().map(|&step| self.contact(step)))
            .find(|path| !fs::metadata(path).is_ok_and(|found| found.is_file() && found.len() > 0))
    }

    /// Names in the folder that are no run's drafts nor its lock, the least first: what one has to
    /// look at who wants to know whose it is.
    ///
    /// # Errors
    /// Those of the system.
    pub fn names(&self) -> std::io::Result<Vec<String>> {
        let mut names = Vec::new();
        for entry in fs::read_dir(&self.root)? {
            names.push(entry?.file_name().to_string_lossy().into_owned());
        }
        names.retain(|name| name != LOCK_NAME && !(draft_of(name).is_some() && ours("", name)));
        names.sort();
        Ok(names)
    }

    /// Removes what a run leaves that was killed between its last files: drafts, and the checkpoint
    /// of a run that has ended and that of the end before it, unless they are to be kept.
    pub fn tidy(&self, keeps_checkpoint: bool, keeps_end: bool) -> Result<(), OutputError> {
        self.clear_but(|_, name| match name {
            "checkpoint.bin" => keeps_checkpoint,
            "checkpoint-end.bin" => keeps_end,
            _ => draft_of(name).is_none(),
        })
    }

    /// Makes a result one of another case that goes on from its checkpoint. The summary goes first:
    /// whatever kills the program in between, nothing says that the other case is done.
    ///
    /// # Errors
    /// [`OutputError::Write`].
    pub fn go_over_to(&self, toml: &str) -> Result<(), OutputError> {
        remove_if_there(&self.summary()).map_err(OutputError::writing(&self.summary()))?;
        self.write_case(toml)
    }

    /// Refuses a directory in which a file has the name of one of a run's and is not one.
    ///
    /// # Errors
    /// [`OutputError::Foreign`] for the first, [`OutputError::Read`].
    pub fn refuse_foreign(&self) -> Result<(), OutputError> {
        self.refuse_foreign_of(|_, _| true)
    }

    /// The same of the files that `wanted` names by folder and name, and of `case.toml`.
    fn refuse_foreign_of(&self, wanted: impl Fn(&str, &str) -> bool) -> Result<(), OutputError> {
        let own = self.own_files()?;
        // A damaged checkpoint is known by what lies beside it.
        let begun = own.iter().any(|(_, name, _)| matches!(name.as_str(), "history.csv" | "summary.json"));
        let drafted = |name: &str| draft_of(name).is_some();
        let unknowable = |name: &str| drafted(name) || begun && CHECKPOINTS.contains(&name);
        let looked_at = own.iter().filter(|(folder, name, _)| wanted(folder, name) && !unknowable(name));
        looked_at.map(|(_, _, path)| path).chain([&self.case()]).try_for_each(|path| refuse_foreign(path))
    }

    /// The files in `fields`, `contact` and `plots` with the names of a run's.
    ///
    /// # Errors
    /// [`OutputError::Read`].
    pub fn in_folders(&self) -> Result<Vec<PathBuf>, OutputError> {
        let own = self.own_files()?.into_iter();
        Ok(own.filter(|(folder, name, _)| !folder.is_empty() && draft_of(name).is_none()).map(|(_, _, path)| path).collect())
    }

    /// The files with the names of a run's but `case.toml`, each with its folder and its name.
    fn own_files(&self) -> Result<Vec<(&'static str, String, PathBuf)>, OutputError> {
        let mut files = Vec::new();
        for folder in ["", "fields", "contact", "plots"] {
            let path = if folder.is_empty() { self.root.clone() } else { self.root.join(folder) };
            if !path.is_dir() {
                continue;
            }
            for entry in fs::read_dir(&path).map_err(OutputError::reading(&path))? {
                let name = entry.map_err(OutputError::reading(&path))?.file_name();
                let file = path.join(&name);
                if let Some(name) = name.to_str().filter(|name| ours(folder, name))
                    && file.is_file()
                {
                    files.push((folder, name.to_owned(), file));
                }
            }
        }
        Ok(files)
    }

    fn clear_but(&self, keep: impl Fn(&str, &str) -> bool) -> Result<(), OutputError> {
        self.refuse_links()?;
        self.refuse_foreign_of(|folder, name| !keep(folder, name))?;
        for (folder, name, file) in self.own_files()? {
            // One who waits for the directory makes drafts of a lock, and removes them.
            if !keep(folder, &name) && (draft_of(&name) != Some(LOCK_NAME) || is_left(&file)) {
                remove_if_there(&file).map_err(OutputError::writing(&file))?;
            }
        }
        Ok(())
    }

    /// Writes `case.toml`, its first line the [`RESULT_MARKER`], unless it stands there already.
    pub fn write_case(&self, toml: &str) -> Result<(), OutputError> {
        let text = format!("{RESULT_MARKER}\n{toml}");
        // It may be the case that was read.
        match bounded::result_to_string(&self.case(), bounded::CASE) {
            Ok(found) if found == text => Ok(()),
            _ => write_own(&self.case(), |out| out.write_all(text.as_bytes())),
        }
    }

    /// The text of `case.toml` without the [`RESULT_MARKER`]; `None` if the folder holds no result.
    pub fn read_case(&self) -> Option<String> {
        let text = bounded::result_to_string(&self.case(), bounded::CASE).ok()?;
        let (first, toml) = text.split_once('\n')?;
        (first.trim_end() == RESULT_MARKER).then(|| toml.to_owned())
    }

    /// The case of `case.toml`.
    ///
    /// # Errors
    /// Those of a case file.
    pub fn load_case(&self) -> Result<Case, CaseError> {
        let file = self.case().display().to_string();
        let text = bounded::result_to_string(&self.case(), bounded::CASE);
        let text = text.map_err(|source| CaseError::Unreadable { file: file.clone(), source })?;
        Case::parse(&text, &file, &[])
    }

    /// Whether the folder holds a result: its `case.toml` begins with [`RESULT_MARKER`].
    pub fn holds_result(&self) -> bool {
        let first = bounded::beginning(&self.case(), RESULT_MARKER.len() as u64 + 2).unwrap_or_default();
        first.split(|byte| *byte == b'\n').next().is_some_and(|line| line.trim_ascii_end() == RESULT_MARKER.as_bytes())
    }
}

fn file_name(path: &Path) -> String {
    path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}

/// Whether a run gives this name to a file in this folder.
fn ours(folder: &str, name: &str) -> bool {
    let step = |suffix: &str| {
        let number = name.strip_prefix("step_").and_then(|name| name.strip_suffix(suffix));
        number.is_some_and(|number| number.len() >= 4 && number.bytes().all(|byte| byte.is_ascii_digit()))
    };
    let draft = || draft_of(name).is_some_and(|name| name == "case.toml" || name == LOCK_NAME || ours(folder, name));
    let named = match folder {
        "" => matches!(name, "history.csv" | "history.parquet" | "summary.json" | "run.log") || CHECKPOINTS.contains(&name),
        "fields" => name == "case.pvd" || step(".vtu"),
        "contact" => step(".csv"),
        "plots" => name.rsplit_once('.').is_some_and(|(name, ending)| {
            RUN_PICTURES.contains(&name) && PictureFormat::ALL.iter().any(|format| format.ending() == ending)
        }),
        _ => false,
    };
    named || draft()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::write_atomically;

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
        assert_eq!(fs::read_to_string(out.case()).unwrap(), format!("{RESULT_MARKER}\n[sphere]\nradius = 1.0\n"));
        assert!(out.holds_result() && !OutputDirectory::existing(folder.path()).holds_result());
    }

    #[test]
    fn clearing_removes_by_name_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let out = OutputDirectory::create(folder.path()).unwrap();
        let gone = [
            "history.csv",
            "summary.json",
            "checkpoint.bin",
            "run.log",
            ".checkpoint.bin.417.tmp",
            ".summary.json.417.tmp",
            ".case.toml.417.tmp",
            "fields/step_0020.vtu",
            "fields/case.pvd",
            "fields/.step_0021.vtu.417.tmp",
            "contact/step_12345.csv",
            "plots/forces.svg",
        ];
        let kept = [
            "case.toml",
            "notes.txt",
            ".hidden.tmp",
            "fields/view.pvsm",
            "fields/step_x.vtu",
            "contact/step_1.csv",
            "plots/mine.svg",
        ];
        for name in gone.iter().chain(&kept) {
            write_atomically(&folder.path().join(name), |_| Ok(())).unwrap();
        }
        out.clear().unwrap();
        assert!(gone.iter().all(|name| !folder.path().join(name).exists()));
        assert!(kept.iter().all(|name| folder.path().join(name).exists()));
    }

    #[cfg(unix)]
    #[test]
    fn a_folder_that_is_a_link_is_refused_and_what_it_leads_to_stays() {
        let folder = tempfile::tempdir().unwrap();
        let out = OutputDirectory::create(folder.path().join("out")).unwrap();
        let foreign = folder.path().join("foreign");
        fs::create_dir(&foreign).unwrap();
        fs::write(foreign.join("step_0001.vtu"), "mine").unwrap();
        std::os::unix::fs::symlink(&foreign, out.root().join("fields")).unwrap();
        for refused in [out.clear(), out.cut_back(&[], &[]), out.tidy(false, false)] {
            let message = refused.unwrap_err().to_string();
            assert!(message.contains("out/fields") && message.contains("is a link"), "{message}");
        }
        assert_eq!(fs::read_to_string(foreign.join("step_0001.vtu")).unwrap(), "mine");
    }

    #[test]
    fn what_a_checkpoint_tells_of_is_looked_for() {
        let folder = tempfile::tempdir().unwrap();
        let out = OutputDirectory::create(folder.path()).unwrap();
        for path in [out.contact(3), out.fields(3), out.contact(4)] {
            write_atomically(&path, |out| out.write_all(b"x")).unwrap();
        }
        assert_eq!((out.missing(&[3], &[], true), out.missing(&[3, 4], &[], false)), (None, None));
        assert_eq!(out.missing(&[3, 4], &[], true), Some(out.fields(4)));
        fs::write(out.contact(3), "").unwrap();
        assert_eq!(out.missing(&[3, 4], &[], true), Some(out.contact(3)));
    }

    #[test]
    fn cutting_back_leaves_what_the_checkpoint_has() {
        let folder = tempfile::tempdir().unwrap();
        let out = OutputDirectory::create(folder.path()).unwrap();
        let gone =
            ["summary.json", ".checkpoint.bin.417.tmp", "fields/step_0021.vtu", "contact/step_0021.csv", "plots/forces.svg"];
        let kept = [
            "case.toml",
            "history.csv",
            "checkpoint.bin",
            "run.log",
            "fields/step_0020.vtu",
            "contact/step_0020.csv",
            "notes.txt",
        ];
        for name in gone.iter().chain(&kept).chain(&["fields/case.pvd"]) {
            write_atomically(&folder.path().join(name), |_| Ok(())).unwrap();
        }
        out.cut_back(&[7, 20], &[]).unwrap();
        assert!(gone.iter().all(|name| !folder.path().join(name).exists()));
        assert!(kept.iter().all(|name| folder.path().join(name).exists()) && out.collection().exists());
    }
}
