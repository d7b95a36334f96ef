//! One writer a directory: a locked file in it, for as long as a run writes there.
//!
//! It is the lock on the open file that counts, which the system gives back however the process
//! ends. One that is there without a lock was left by a process that was killed. Some network file
//! systems keep locks to one host, or grant every lock: so the file tells process and host
//! (`holder`), is made with that text in it (`draft`), and is touched as long as the process lives
//! (`beat`). A lock whose file says that another process is there, and that was touched lately, is
//! not taken over. Those who compute one study have a file each (`task`).

mod beat;
mod draft;
mod file;
mod holder;
mod task;

use std::fs::{File, TryLockError};
use std::io::ErrorKind;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, SystemTime};

use super::OutputError;
use beat::Own;
use draft::{Draft, NamedFile};
use file::open;
use holder::{Holder, left};

pub(crate) use draft::is_left;
pub(super) use file::same_file;
pub use task::{TaskLock, is_study_lock};

/// Name of the file, in the directory that is written to. It is there only while somebody writes.
pub const LOCK_NAME: &str = ".asperity.lock";

/// How long one who took a lock over waits for another who does so at the same moment.
const MOMENT: Duration = Duration::from_millis(50);

/// The right to write to a directory, given back when dropped.
#[derive(Debug)]
pub struct DirectoryLock {
    own: Arc<Own>,
    /// What should be told about how it was taken.
    note: Option<String>,
}

impl DirectoryLock {
    /// Takes the lock of a directory that is there.
    ///
    /// # Errors
    /// [`OutputError::Locked`] with who has it; [`OutputError::Write`].
    pub fn take(dir: &Path) -> Result<Self, OutputError> {
        let path = dir.join(LOCK_NAME);
        let failed = |error| OutputError::writing(&path)(error);
        let draft = || Draft::make(&path, &Holder::myself(""));
        loop {
            let file = match open(&path) {
                Err(error) if error.kind() == ErrorKind::NotFound => {
                    match draft().and_then(|draft| draft.link(&path)).map_err(failed)? {
                        Some(named) => return Ok(Self::held(dir, &path, named, None)),
                        None => continue,
                    }
                }
                opened => opened.map_err(failed)?,
            };
            let locked = |holder: Holder, wait| {
                let holder = Some(holder.name).filter(|name| !name.is_empty());
                Err(OutputError::Locked { dir: dir.to_path_buf(), holder, wait })
            };
            if matches!(file.try_lock(), Err(TryLockError::WouldBlock)) {
                return locked(Holder::read(&file), None);
            }
            // Whoever had it before may have removed the file since it was opened: then what is
            // locked is a file without a name.
            if !same_file(&file, &path) {
                continue;
            }
            let holder = Holder::read(&file);
            let gone = holder.is_gone(&file);
            let draft = draft().map_err(failed)?;
            if let Some(wait) = left(&file, draft.made).filter(|_| !gone) {
                return locked(holder, Some(wait));
            }
            // Our own file takes the place of the other, in one go: the process that left it may
            // only have been suspended, and then finds that its file is gone. Where locks hold, the
            // one on the old file keeps others out until then; elsewhere the last who comes has it.
            if !same_file(&file, &path) {
                continue;
            }
            let Some(named) = draft.replace(&path).map_err(failed)? else { continue };
            std::thread::sleep(MOMENT);
            if same_file(&named.0, &path) {
                return Ok(Self::held(dir, &path, named, Some(&holder)));
            }
        }
    }

    fn held(dir: &Path, path: &Path, (file, no_locks): NamedFile, before: Option<&Holder>) -> Self {
        let note = match (no_locks, before) {
            (Some(error), _) => Some(format!("{} cannot be locked ({error}): see that no other run writes there", dir.display())),
            (None, Some(before)) if !before.name.is_empty() => {
                Some(format!("{}: taken over from {}, which was killed", dir.display(), before.name))
            }
            _ => None,
        };
        Self { own: Own::keep(path.to_owned(), file), note }
    }

    /// Keeps the right without an open file, for who has to have many at a time.
    #[cfg(any(feature = "law", test))]
    pub(crate) fn close(&mut self) {
        if cfg!(unix) {
            self.own = self.own.closed();
        }
    }

    /// What the user should know about how it was taken: from whom, if somebody had it who was
    /// killed.
    pub fn note(&self) -> Option<&str> {
        self.note.as_deref()
    }
}

impl Drop for DirectoryLock {
    fn drop(&mut self) {
        // While it is still locked: the next one makes a file of its own.
        self.own.remove();
    }
}

/// How the file of somebody's lock stands.
enum LockState {
    /// Somebody is there; where he may have been killed, for how long he still counts as that.
    Held(Option<Duration>),
    /// It was not touched for a while, and nothing is known of its process.
    Old,
    /// Its process has ended.
    Gone,
}

/// How a file stands, at the time `now` of its file system's clock.
fn state(file: &File, holder: &Holder, now: SystemTime) -> LockState {
    if matches!(file.try_lock(), Err(TryLockError::WouldBlock)) {
        LockState::Held(None)
    } else if holder.is_gone(file) {
        LockState::Gone
    } else {
        left(file, now).map_or(LockState::Old, |left| LockState::Held(Some(left)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs::{self, OpenOptions};
    use std::sync::Mutex;

    #[test]
    fn a_second_writer_is_refused_with_the_first_ones_process_and_host() {
        let dir = tempfile::tempdir().unwrap();
        let mut first = DirectoryLock::take(dir.path()).unwrap();
        assert_eq!(first.note(), None);
        for _ in 0..2 {
            let message = DirectoryLock::take(dir.path()).unwrap_err().to_string();
            assert!(message.contains(&Holder::myself("").name), "{message}");
            // Nor without an open file.
            first.close();
        }
        drop(first);
        assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 0);
        assert_eq!(DirectoryLock::take(dir.path()).unwrap().note(), None);
    }

    #[test]
    fn what_a_killed_process_left_is_taken_over_and_said() {
        let dir = tempfile::tempdir().unwrap();
        lay(dir.path(), "process 4711 on node7\n", 3600);
        let lock = DirectoryLock::take(dir.path()).unwrap();
        assert!(lock.note().unwrap().contains("taken over from process 4711 on node7"), "{:?}", lock.note());
        assert!(fs::read_to_string(dir.path().join(LOCK_NAME)).unwrap().contains(&std::process::id().to_string()));
    }

    /// A lock's file that nobody holds, last touched so many seconds ago.
    fn lay(dir: &Path, text: &str, seconds: u64) {
        fs::write(dir.join(LOCK_NAME), text).unwrap();
        age(&dir.join(LOCK_NAME), seconds);
    }

    pub(super) fn age(path: &Path, seconds: u64) {
        let file = OpenOptions::new().write(true).open(path).unwrap();
        file.set_modified(SystemTime::now() - Duration::from_secs(seconds)).unwrap();
    }

    #[test]
    fn a_lock_that_was_touched_lately_is_refused_with_how_to_go_on() {
        let dir = tempfile::tempdir().unwrap();
        // Of another host; of one with the name of ours, as containers may have it; of nobody
        // knows.
        let here = format!("process 4194305 on {}\n", Holder::myself("").name.rsplit_once(' ').unwrap().1);
        for (text, who) in [("process 4711 on node7\n", "process 4711 on node7"), (&here, here.trim()), ("", "another process")] {
            lay(dir.path(), text, 20);
            let message = DirectoryLock::take(dir.path()).unwrap_err().to_string();
            let parts = ["If it was killed, start again in ", " s: its lock is then taken over", "nothing was changed"];
            assert!(parts.iter().chain([&who]).all(|part| message.contains(part)), "{message}");
            assert_eq!(fs::read_to_string(dir.path().join(LOCK_NAME)).unwrap(), text);
            assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 1);
            lay(dir.path(), text, 61);
            assert_eq!(DirectoryLock::take(dir.path()).unwrap().note().is_some(), !text.is_empty());
        }
    }

    #[test]
    fn on_this_host_a_lock_is_taken_over_at_once_from_a_process_that_is_gone() {
        let dir = tempfile::tempdir().unwrap();
        let own = format!("process {} ", std::process::id());
        // The greatest number that Linux gives out is 4194304; our own was given out again.
        for process in ["process 4194305 ", &own] {
            lay(dir.path(), &Holder::myself("").text().replace(&own, process), 0);
            assert!(DirectoryLock::take(dir.path()).unwrap().note().unwrap().contains(&format!("from {process}on")));
        }
    }

    #[test]
    fn one_who_was_suspended_leaves_the_lock_of_the_one_who_took_it_over() {
        let dir = tempfile::tempdir().unwrap();
        let first = DirectoryLock::take(dir.path()).unwrap();
        // As of a host from where the lock is not seen.
        open(first.own.path()).unwrap().set_len(0).unwrap();
        first.own.unlock();
        lay(dir.path(), "process 4711 on node7\n", 61);
        let second = DirectoryLock::take(dir.path()).unwrap();
        assert!(second.note().unwrap().contains("process 4711 on node7"));
        drop(first);
        assert!(second.own.is_there() && DirectoryLock::take(dir.path()).is_err());
        drop(second);
        assert!(!dir.path().join(LOCK_NAME).exists());
    }

    #[cfg(unix)]
    #[test]
    fn a_link_is_not_followed() {
        let dir = tempfile::tempdir().unwrap();
        let mine = dir.path().join("mine.txt");
        fs::write(&mine, "mine").unwrap();
        std::os::unix::fs::symlink(&mine, dir.path().join(LOCK_NAME)).unwrap();
        assert!(DirectoryLock::take(dir.path()).is_err());
        assert_eq!(fs::read_to_string(&mine).unwrap(), "mine");
    }

    #[test]
    fn of_many_that_come_at_once_one_is_let_in_at_a_time() {
        let dir = tempfile::tempdir().unwrap();
        let (inside, left) = (std::sync::atomic::AtomicUsize::new(0), Mutex::new(0));
        std::thread::scope(|scope| {
            for _ in 0..8 {
                scope.spawn(|| {
                    for _ in 0..200 {
                        if let Ok(lock) = DirectoryLock::take(dir.path()) {
                            assert_eq!(inside.fetch_add(1, std::sync::atomic::Ordering::SeqCst), 0);
                            std::thread::yield_now();
                            inside.fetch_sub(1, std::sync::atomic::Ordering::SeqCst);
                            // What a killed one leaves, now and then.
                            let mut left = left.lock().unwrap();
                            drop(lock);
                            *left += 1;
                            if *left % 20 == 0 && !dir.path().join(LOCK_NAME).exists() {
                                let draft = dir.path().join("draft");
                                fs::write(&draft, "process 4711 on node7\n").unwrap();
                                age(&draft, 61);
                                let _ = fs::hard_link(&draft, dir.path().join(LOCK_NAME));
                                fs::remove_file(&draft).unwrap();
                            }
                        }
                    }
                });
            }
        });
    }

    #[cfg(unix)]
    #[test]
    fn one_who_waits_makes_no_file() {
        let dir = tempfile::tempdir().unwrap();
        let _lock = DirectoryLock::take(dir.path()).unwrap();
        let written = || fs::metadata(dir.path()).unwrap().modified().unwrap();
        let long_ago = SystemTime::now() - Duration::from_secs(3600);
        File::open(dir.path()).unwrap().set_modified(long_ago).unwrap();
        let before = written();
        assert!(DirectoryLock::take(dir.path()).is_err());
        assert_eq!(written(), before);
    }

    #[test]
    fn drafts_are_left_to_those_who_still_want_them() {
        let dir = tempfile::tempdir().unwrap();
        let name = |process: &str| dir.path().join(format!(".{LOCK_NAME}.{process}{:020}.tmp", 1));
        let own = name(&std::process::id().to_string());
        for path in [&own, &name("4194305"), &name("")] {
            fs::write(path, "").unwrap();
        }
        assert!(!is_left(&own) && is_left(&name("4194305")) && !is_left(&name("")) && !is_left(&name("1")));
        age(&own, 61);
        assert!(is_left(&own));
    }
}
