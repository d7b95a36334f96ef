//! The right of many processes to work on one thing in a directory.

use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::{self, ErrorKind};
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, SystemTime};

use super::beat::{self, Own};
use super::draft::{Draft, is_left, random};
use super::file::{open, same_file};
use super::holder::{Holder, age};
use super::{LockState, state};
use crate::output::{OutputError, draft_of};

/// How the names of the files begin of those who compute a study in a directory.
const STUDY_LOCK: &str = ".asperity.study.";
/// So many files of those who work on the same are looked at for who was killed. All of them would
/// take a thousand tasks that start together too long.
const LOOKED_AT: usize = 16;
/// A file of one who works on the same, and of whose process nothing is known, is removed after so
/// long. Before, it may have been suspended.
const LITTER: Duration = Duration::from_secs(86_400);

/// Whether a name is that of a file of one who computes a study in the directory.
pub fn is_study_lock(name: &str) -> bool {
    let parts = name.strip_prefix(STUDY_LOCK).and_then(|rest| rest.split_once('.'));
    let all = |text: &str, of: fn(&u8) -> bool| !text.is_empty() && text.as_bytes().iter().all(of);
    parts.is_some_and(|(task, number)| all(task, u8::is_ascii_hexdigit) && all(number, u8::is_ascii_digit))
}

/// The right of several processes to work on one task in a directory, each a part of it, and of
/// nobody to work on another there. Given back when dropped.
///
/// Each has a file of its own in the directory, which nobody else removes as long as it is touched:
/// so it does not matter whether locks hold from host to host, or at all.
#[derive(Debug)]
pub struct TaskLock {
    own: Arc<Own>,
}

impl TaskLock {
    /// Joins those who work on `task`, or is the first; with `alone` there must be no others. To be
    /// called by whoever has the [`DirectoryLock`](super::DirectoryLock), so that one comes after
    /// the other. The holder in the error is in words, with `this` or `another` of `names`, as the
    /// task is.
    ///
    /// # Errors
    /// [`OutputError::Locked`] with one who is there; [`OutputError::Write`],
    /// [`OutputError::Read`].
    pub fn join(dir: &Path, task: &str, alone: bool, [this, another]: [&str; 2]) -> Result<Self, OutputError> {
        let same = format!("{STUDY_LOCK}{:016x}.", hash(task));
        // Where two come at once all the same, each sees the other.
        let (joined, now) = Self::make(&dir.join(format!("{same}{}", random())), task)?;
        let mut there: Option<(Holder, Option<Duration>)> = None;
        let mut looked_at = 0;
        for name in names(dir)? {
            let path = dir.join(&name);
            if draft_of(&name).is_some_and(is_study_lock) && is_left(&path) {
                let _ = fs::remove_file(&path);
            }
            let ours = name.starts_with(&same);
            looked_at += usize::from(ours);
            if !is_study_lock(&name) || path == joined.own.path() || ours && !alone && looked_at > LOOKED_AT {
                continue;
            }
            let file = match open(&path) {
                Err(error) if error.kind() == ErrorKind::NotFound => continue,
                opened => opened.map_err(OutputError::writing(&path))?,
            };
            let holder = Holder::read(&file);
            let hinders = alone || holder.task != task;
            let left = match state(&file, &holder, now) {
                LockState::Held(wait) => {
                    // The one who will be there longest.
                    if hinders
                        && there.as_ref().is_none_or(|(_, longest)| longest.is_some() && (wait.is_none() || wait > *longest))
                    {
                        there = Some((holder, wait));
                    }
                    false
                }
                LockState::Old => hinders || age(&file, now).is_some_and(|age| age > LITTER),
                LockState::Gone => true,
            };
            if left && same_file(&file, &path) {
                let _ = fs::remove_file(&path);
            }
        }
        let Some((holder, wait)) = there else { return Ok(joined) };
        let who = if holder.name.is_empty() { "another process" } else { &holder.name };
        let what = if holder.task == task { this } else { another };
        Err(OutputError::Locked { dir: dir.to_path_buf(), holder: Some(format!("{who}, which computes {what}")), wait })
    }

    /// Makes the file, and tells when, by the clock of the file system.
    fn make(path: &Path, task: &str) -> Result<(Self, SystemTime), OutputError> {
        loop {
            let draft = Draft::make(path, &Holder::myself(task)).map_err(OutputError::writing(path))?;
            let now = draft.made;
            if let Some((file, _)) = draft.replace(path).map_err(OutputError::writing(path))? {
                return Ok((Self { own: Own::keep(path.to_owned(), file) }, now));
            }
        }
    }

    /// Whether the directory still is where it was.
    ///
    /// # Errors
    /// [`OutputError::Gone`].
    pub fn check_there(&self) -> Result<(), OutputError> {
        beat::go_on();
        let dir = self.own.path().parent().unwrap_or(self.own.path());
        if self.own.is_there() { Ok(()) } else { Err(OutputError::Gone { path: dir.to_owned() }) }
    }
}

impl Drop for TaskLock {
    fn drop(&mut self) {
        self.own.remove();
    }
}

fn hash(task: &str) -> u64 {
    let mut hasher = DefaultHasher::new();
    task.hash(&mut hasher);
    hasher.finish()
}

fn names(dir: &Path) -> Result<Vec<String>, OutputError> {
    let names = || -> io::Result<Vec<String>> {
        fs::read_dir(dir)?.map(|entry| Ok(entry?.file_name().to_string_lossy().into_owned())).collect()
    };
    names().map_err(OutputError::reading(dir))
}

#[cfg(test)]
mod tests {
    use super::super::tests::age;
    use super::*;
    use std::path::PathBuf;

    const WORDS: [&str; 2] = ["this study", "another study"];

    fn files(dir: &Path) -> Vec<String> {
        names(dir).unwrap()
    }

    /// The file of one on another host, last touched so many seconds ago.
    fn lay(dir: &Path, task: &str, number: usize, seconds: u64) -> PathBuf {
        let path = dir.join(format!("{STUDY_LOCK}{:016x}.{number}", hash(task)));
        fs::write(&path, format!("process {number} on node7\n{task}\n")).unwrap();
        age(&path, seconds);
        path
    }

    #[test]
    fn one_task_is_worked_on_by_many_and_another_by_nobody() {
        let dir = tempfile::tempdir().unwrap();
        let join = |task, alone| TaskLock::join(dir.path(), task, alone, WORDS);
        let first = join("one", true).unwrap();
        let second = join("one", false).unwrap();
        for (task, alone, what) in [("two", false, "another study"), ("two", true, "another study"), ("one", true, "this study")]
        {
            let message = join(task, alone).unwrap_err().to_string();
            assert!(message.contains(&format!("{}, which computes {what}", Holder::myself("").name)), "{message}");
        }
        assert_eq!(files(dir.path()).len(), 2);
        assert!(files(dir.path()).iter().all(|name| is_study_lock(name)), "{:?}", files(dir.path()));
        drop(first);
        assert!(join("two", true).is_err() && second.check_there().is_ok());
        drop(second);
        assert!(files(dir.path()).is_empty());
        let third = join("two", true).unwrap();
        fs::remove_file(third.own.path()).unwrap();
        assert!(matches!(third.check_there(), Err(OutputError::Gone { .. })));
    }

    #[test]
    fn each_who_was_there_lately_counts_and_not_only_the_last() {
        let dir = tempfile::tempdir().unwrap();
        let join = |task, alone| TaskLock::join(dir.path(), task, alone, WORDS);
        let there = lay(dir.path(), "one", 4711, 20);
        let old = lay(dir.path(), "one", 4712, 61);
        // One who came later, and has ended.
        drop(join("one", false).unwrap());
        let message = join("two", false).unwrap_err().to_string();
        for part in ["process 4711 on node7, which computes another study", "start again in 4", "nothing was changed"] {
            assert!(message.contains(part), "{message}");
        }
        assert!(there.exists() && !old.exists());
        assert!(join("one", true).unwrap_err().to_string().contains("process 4711 on node7, which computes this study"));
        // One of the same may have been suspended; it is in the way of another only.
        age(&there, 61);
        drop(join("one", false).unwrap());
        assert!(there.exists());
        let lock = join("two", false).unwrap();
        assert!(!there.exists() && lock.check_there().is_ok());
        drop(lock);
        lay(dir.path(), "one", 4713, 86_500);
        drop(join("one", false).unwrap());
        assert!(files(dir.path()).is_empty());
    }

    #[test]
    fn what_killed_ones_left_is_no_hindrance_and_does_not_stay() {
        let dir = tempfile::tempdir().unwrap();
        let text = Holder::myself("one").text().replace(&format!("process {} ", std::process::id()), "process 4194305 ");
        let left = [format!("{STUDY_LOCK}{:016x}.1", hash("one")), format!(".{STUDY_LOCK}ab.1.4194305{:020}.tmp", 1)];
        for alone in [false, true] {
            left.iter().for_each(|name| fs::write(dir.path().join(name), &text).unwrap());
            drop(TaskLock::join(dir.path(), "one", alone, WORDS).unwrap());
            assert!(files(dir.path()).is_empty(), "{:?}", files(dir.path()));
        }
        for name in
            [".asperity.study", ".asperity.study.1", ".asperity.study.x.1", ".asperity.study.ab.1x", "asperity.study.ab.1"]
        {
            assert!(!is_study_lock(name), "{name}");
        }
    }
}
