//! A lock's file before it has its name: nobody ever sees one without its text.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::hash::{BuildHasher, Hasher, RandomState};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use super::file::same_file;
use super::holder::{GONE, Holder, is_running};

/// A new file with its text in it, and locked.
pub struct Draft {
    name: Name,
    file: File,
    /// When it was made, by the clock of its file system.
    pub made: SystemTime,
    no_locks: Option<io::Error>,
    text: String,
}

/// A lock's file that has its name, with the error of a file system that has no locks.
pub type NamedFile = (File, Option<io::Error>);

impl Draft {
    /// Makes the draft of a lock's file.
    pub fn make(path: &Path, holder: &Holder) -> io::Result<Self> {
        let lock = path.file_name().unwrap_or_default().to_string_lossy();
        // The number of the process, and one that nobody can guess.
        let name = Name(path.with_file_name(format!(".{lock}.{}{:020}.tmp", std::process::id(), random())));
        let mut file = OpenOptions::new().read(true).write(true).create_new(true).open(&name.0)?;
        let text = holder.text();
        file.write_all(text.as_bytes())?;
        let made = file.metadata().and_then(|found| found.modified()).unwrap_or_else(|_| SystemTime::now());
        let no_locks = match file.try_lock() {
            Err(TryLockError::Error(error)) => Some(error),
            _ => None,
        };
        Ok(Self { name, file, made, no_locks, text })
    }

    /// Gives it the name, if nothing has that.
    pub fn link(self, path: &Path) -> io::Result<Option<NamedFile>> {
        match fs::hard_link(&self.name.0, path) {
            Ok(()) => Ok(Some((self.file, self.no_locks))),
            // A network may lose the answer that all went well.
            Err(error) if error.kind() == ErrorKind::AlreadyExists && cfg!(unix) && same_file(&self.file, path) => {
                Ok(Some((self.file, self.no_locks)))
            }
            // Somebody who clears the directory may have removed the draft.
            Err(error) if matches!(error.kind(), ErrorKind::AlreadyExists | ErrorKind::NotFound) => Ok(None),
            // No links on this file system.
            Err(_) => match OpenOptions::new().read(true).write(true).create_new(true).open(path) {
                Err(error) if error.kind() == ErrorKind::AlreadyExists => Ok(None),
                opened => {
                    let mut file = opened?;
                    let no_locks = match file.try_lock() {
                        Ok(()) => None,
                        Err(TryLockError::WouldBlock) => return Ok(None),
                        Err(TryLockError::Error(error)) => Some(error),
                    };
                    file.write_all(self.text.as_bytes())?;
                    Ok(Some((file, no_locks)))
                }
            },
        }
    }

    /// Gives it the name, whatever has it; `None` if somebody removed the draft.
    pub fn replace(self, path: &Path) -> io::Result<Option<NamedFile>> {
        match fs::rename(&self.name.0, path) {
            Ok(()) => Ok(Some((self.file, self.no_locks))),
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
            Err(error) => Err(error),
        }
    }
}

/// The draft's name, which goes with it.
struct Name(PathBuf);

impl Drop for Name {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.0);
    }
}

/// A number that nobody can guess.
pub fn random() -> u64 {
    RandomState::new().build_hasher().finish()
}

/// Whether the draft of a lock's file was left by a process that was killed: there is none of its
/// number here, or it is a minute old. Whoever loses one that he still wanted makes another.
pub fn is_left(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let number = name.strip_suffix(".tmp").and_then(|name| name.rsplit_once('.')).map_or("", |(_, number)| number);
    let process = number.len().checked_sub(20).and_then(|end| number.get(..end)?.parse().ok());
    let old = || {
        let age = |made: SystemTime| made.elapsed().unwrap_or_else(|early| early.duration());
        fs::metadata(path).and_then(|found| found.modified()).is_ok_and(|made| age(made) >= GONE)
    };
    process.is_some_and(|process| !is_running(process)) || old()
}
