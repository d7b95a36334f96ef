//! One writer a directory: a locked file in it, for as long as a run writes there.
//!
//! It is the lock on the open file that counts, which the system gives back however the process
//! ends; the file itself only tells whose it is. One that is there without a lock was left by a
//! process that was killed.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use super::OutputError;

/// Name of the file, in the directory that is written to. It is there only while somebody writes.
pub const LOCK_NAME: &str = ".asperity.lock";

/// The right to write to a directory, given back when dropped.
#[derive(Debug)]
pub struct DirectoryLock {
    path: PathBuf,
    /// Locked for as long as it is open.
    _file: File,
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
        loop {
            let mut file = open(&path).map_err(OutputError::writing(&path))?;
            match file.try_lock() {
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => {
                    return Err(OutputError::Locked { dir: dir.to_path_buf(), holder: holder(&mut file) });
                }
                Err(TryLockError::Error(error)) => {
                    // No locks on this file system: nothing is lost that was there before.
                    let note = format!("{} cannot be locked ({error}): see that no other run writes there", dir.display());
                    return Ok(Self { path, _file: file, note: Some(note) });
                }
            }
            // Whoever had it before may have removed the file since it was opened: then what is
            // locked is a file without a name.
            if !same_file(&file, &path) {
                continue;
            }
            let left = holder(&mut file);
            let note = left.map(|who| format!("{}: taken over from {who}, which was killed", dir.display()));
            let told =
                file.set_len(0).and_then(|()| file.seek(SeekFrom::Start(0))).and_then(|_| file.write_all(myself().as_bytes()));
            told.map_err(OutputError::writing(&path))?;
            return Ok(Self { path, _file: file, note });
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
        // While it is still locked: the next one makes a file of its own. One that cannot be
        // removed is taken for what a killed run left.
        if same_file(&self._file, &self.path) {
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// Opens or makes the file, but never follows a link to somebody else's.
fn open(path: &Path) -> std::io::Result<File> {
    let mut options = OpenOptions::new();
    options.read(true).write(true).create(true).truncate(false);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::custom_flags(&mut options, rustix::fs::OFlags::NOFOLLOW.bits() as i32);
    options.open(path)
}

/// Whether an open file still is what stands under the name.
#[cfg(unix)]
pub(super) fn same_file(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let identity = |found: fs::Metadata| (found.dev(), found.ino());
    matches!((file.metadata().map(identity), fs::metadata(path).map(identity)), (Ok(ours), Ok(there)) if ours == there)
}

/// Whether something stands under the name: an open file cannot be removed here.
#[cfg(not(unix))]
pub(super) fn same_file(_: &File, path: &Path) -> bool {
    path.exists()
}

/// The holder's own words, if there are any yet.
fn holder(file: &mut File) -> Option<String> {
    let mut text = String::new();
    file.seek(SeekFrom::Start(0)).ok()?;
    Read::take(file, 1000).read_to_string(&mut text).ok()?;
    Some(text.trim().to_owned()).filter(|text| !text.is_empty())
}

fn myself() -> String {
    format!("process {} on {}\n", std::process::id(), host())
}

#[cfg(unix)]
fn host() -> String {
    rustix::system::uname().nodename().to_string_lossy().into_owned()
}

#[cfg(not(unix))]
fn host() -> String {
    std::env::var("COMPUTERNAME").unwrap_or_else(|_| "this host".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_second_writer_is_refused_with_the_first_ones_process_and_host() {
        let dir = tempfile::tempdir().unwrap();
        let first = DirectoryLock::take(dir.path()).unwrap();
        assert_eq!(first.note(), None);
        let message = DirectoryLock::take(dir.path()).unwrap_err().to_string();
        assert!(message.contains(&format!("process {} on {}", std::process::id(), host())), "{message}");
        drop(first);
        assert!(!dir.path().join(LOCK_NAME).exists());
        assert_eq!(DirectoryLock::take(dir.path()).unwrap().note(), None);
    }

    #[test]
    fn what_a_killed_process_left_is_taken_over_and_said() {
        let dir = tempfile::tempdir().unwrap();
        fs::write(dir.path().join(LOCK_NAME), "process 4711 on node7\n").unwrap();
        let lock = DirectoryLock::take(dir.path()).unwrap();
        assert!(lock.note().unwrap().contains("taken over from process 4711 on node7"), "{:?}", lock.note());
        assert!(fs::read_to_string(dir.path().join(LOCK_NAME)).unwrap().contains(&std::process::id().to_string()));
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
        let inside = std::sync::atomic::AtomicUsize::new(0);
        std::thread::scope(|scope| {
            for _ in 0..8 {
                scope.spawn(|| {
                    for _ in 0..200 {
                        if let Ok(_lock) = DirectoryLock::take(dir.path()) {
                            assert_eq!(inside.fetch_add(1, std::sync::atomic::Ordering::SeqCst), 0);
                            std::thread::yield_now();
                            inside.fetch_sub(1, std::sync::atomic::Ordering::SeqCst);
                        }
                    }
                });
            }
        });
    }
}
