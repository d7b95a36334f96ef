//! One writer a directory: a locked file in it, for as long as a run writes there.
//!
//! It is the lock on the open file that counts, which the system gives back however the process
//! ends. One that is there without a lock was left by a process that was killed. Some network file
//! systems keep locks to one host, or grant every lock: so the file tells process and host, is made
//! with that text in it, and is touched as long as the process lives. A lock whose file says that
//! another process is there, and that was touched lately, is not taken over.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::hash::{BuildHasher, Hasher, RandomState};
use std::io::{self, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError, Weak};
use std::time::{Duration, SystemTime};

use super::OutputError;

/// Name of the file, in the directory that is written to. It is there only while somebody writes.
pub const LOCK_NAME: &str = ".asperity.lock";
/// Name of the file that those have in common who compute one study in a directory.
pub const STUDY_LOCK_NAME: &str = ".asperity.study";

/// Time between two touches of a lock's file.
const BEAT: Duration = Duration::from_secs(10);
/// A lock's file that was not touched for so long was left by a killed process.
const GONE: Duration = Duration::from_secs(60);

/// The right to write to a directory, given back when dropped.
#[derive(Debug)]
pub struct DirectoryLock {
    path: PathBuf,
    /// Locked for as long as it is open.
    file: Arc<File>,
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
        let no_locks = |error| format!("{} cannot be locked ({error}): see that no other run writes there", dir.display());
        loop {
            let now = match make(&path).map_err(OutputError::writing(&path))? {
                Made::Ours(file, failed) => return Ok(Self::held(path, file, failed.map(no_locks))),
                Made::There(now) => now,
            };
            let mut file = match open(&path, false) {
                Err(error) if error.kind() == ErrorKind::NotFound => continue,
                opened => opened.map_err(OutputError::writing(&path))?,
            };
            let failed = match file.try_lock() {
                Ok(()) => None,
                Err(TryLockError::WouldBlock) => {
                    return Err(OutputError::Locked { dir: dir.to_path_buf(), holder: holder(&mut file), wait: None });
                }
                Err(TryLockError::Error(error)) => Some(error),
            };
            // Whoever had it before may have removed the file since it was opened: then what is
            // locked is a file without a name.
            if !same_file(&file, &path) {
                continue;
            }
            let left = holder(&mut file);
            if let Some(wait) = left.as_deref().and_then(|who| still_there(who, &file, now)) {
                return Err(OutputError::Locked { dir: dir.to_path_buf(), holder: left, wait: Some(wait) });
            }
            let note = left.map(|who| format!("{}: taken over from {who}, which was killed", dir.display()));
            write_text(&mut file, &myself()).map_err(OutputError::writing(&path))?;
            return Ok(Self::held(path, file, failed.map(no_locks).or(note)));
        }
    }

    fn held(path: PathBuf, file: File, note: Option<String>) -> Self {
        Self { path, file: keep_touched(file), note }
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
        if same_file(&self.file, &self.path) {
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// The right of several processes to work on one task in a directory, each a part of it, and of
/// nobody to work on another there. Given back when dropped.
#[derive(Debug)]
pub struct TaskLock {
    path: PathBuf,
    /// Locked with the others' for as long as it is open.
    file: Arc<File>,
}

impl TaskLock {
    /// Joins those who work on `task`, or is the first; with `alone` there must be no others. To be
    /// called by whoever has the [`DirectoryLock`], so that one comes after the other. The holder
    /// in the error is in words, with `this` or `another` of `names`, as the task is.
    ///
    /// # Errors
    /// [`OutputError::Locked`] with the last who came; [`OutputError::Write`].
    pub fn join(dir: &Path, task: &str, alone: bool, [this, another]: [&str; 2]) -> Result<Self, OutputError> {
        let path = dir.join(STUDY_LOCK_NAME);
        loop {
            let mut file = open(&path, true).map_err(OutputError::writing(&path))?;
            let locked = file.try_lock();
            if !same_file(&file, &path) {
                continue;
            }
            let told = holder(&mut file).unwrap_or_default();
            let (who, theirs) = told.split_once('\n').unwrap_or((&told, ""));
            let wait = match locked {
                Err(TryLockError::WouldBlock) => Some(None),
                _ => still_there(who, &file, SystemTime::now()).map(Some),
            };
            if let Some(wait) = wait
                && (alone || theirs != task)
            {
                let who = if who.is_empty() { "another process" } else { who };
                let holder = Some(format!("{who}, which computes {}", if theirs == task { this } else { another }));
                return Err(OutputError::Locked { dir: dir.to_path_buf(), holder, wait });
            }
            write_text(&mut file, &format!("{}{task}\n", myself())).map_err(OutputError::writing(&path))?;
            // Without locks the file's text and age are what there is.
            let _ = file.unlock().and_then(|()| file.lock_shared());
            if same_file(&file, &path) {
                return Ok(Self { path, file: keep_touched(file) });
            }
        }
    }

    /// Whether the directory still is where it was.
    ///
    /// # Errors
    /// [`OutputError::Gone`].
    pub fn check_there(&self) -> Result<(), OutputError> {
        let dir = self.path.parent().unwrap_or(&self.path);
        if same_file(&self.file, &self.path) { Ok(()) } else { Err(OutputError::Gone { path: dir.to_owned() }) }
    }
}

impl Drop for TaskLock {
    fn drop(&mut self) {
        // The last who goes removes the file.
        if self.file.unlock().is_ok() && self.file.try_lock().is_ok() && same_file(&self.file, &self.path) {
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// What became of making a lock's file.
enum Made {
    /// It has the name, and our text; with the error of a file system that has no locks.
    Ours(File, Option<io::Error>),
    /// There was one, at this time of the file system's clock.
    There(SystemTime),
}

/// Makes the file, with its text in it and locked before it has its name, if there is none.
fn make(path: &Path) -> io::Result<Made> {
    let number = RandomState::new().build_hasher().finish();
    let draft = path.with_file_name(format!(".{LOCK_NAME}.{number}.tmp"));
    let made = (|| {
        let mut file = OpenOptions::new().read(true).write(true).create_new(true).open(&draft)?;
        write_text(&mut file, &myself())?;
        let now = file.metadata().and_then(|found| found.modified()).unwrap_or_else(|_| SystemTime::now());
        let failed = match file.try_lock() {
            Err(TryLockError::Error(error)) => Some(error),
            _ => None,
        };
        match fs::hard_link(&draft, path) {
            Ok(()) => Ok(Made::Ours(file, failed)),
            // Somebody who clears the directory may have removed the draft.
            Err(error) if matches!(error.kind(), ErrorKind::AlreadyExists | ErrorKind::NotFound) => Ok(Made::There(now)),
            // No links on this file system.
            Err(_) => match OpenOptions::new().read(true).write(true).create_new(true).open(path) {
                Err(error) if error.kind() == ErrorKind::AlreadyExists => Ok(Made::There(now)),
                opened => {
                    let mut file = opened?;
                    let failed = match file.try_lock() {
                        Ok(()) => None,
                        Err(TryLockError::WouldBlock) => return Ok(Made::There(now)),
                        Err(TryLockError::Error(error)) => Some(error),
                    };
                    write_text(&mut file, &myself()).map(|()| Made::Ours(file, failed))
                }
            },
        }
    })();
    let _ = fs::remove_file(&draft);
    made
}

/// Opens the file, or makes it, but never follows a link to somebody else's.
fn open(path: &Path, create: bool) -> io::Result<File> {
    let mut options = OpenOptions::new();
    options.read(true).write(true).create(create).truncate(false);
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

fn write_text(file: &mut File, text: &str) -> io::Result<()> {
    file.set_len(0)?;
    file.seek(SeekFrom::Start(0))?;
    file.write_all(text.as_bytes())
}

/// How long a file that `who` left, and whose lock was granted, still counts as held; `None` if its
/// holder is gone. On this host the process must be there; a process elsewhere cannot be looked
/// for.
fn still_there(who: &str, file: &File, now: SystemTime) -> Option<Duration> {
    let (process, on) = who.strip_prefix("process ")?.split_once(" on ")?;
    if on == host() && !is_running(process.parse().ok()?, file) {
        return None;
    }
    let touched = file.metadata().and_then(|found| found.modified()).ok()?;
    let age = now.duration_since(touched).or_else(|_| touched.duration_since(now)).ok()?;
    GONE.checked_sub(age).filter(|left| !left.is_zero())
}

fn is_running(process: u32, file: &File) -> bool {
    if process == std::process::id() {
        // A number that was given out again, unless it is among our own locks.
        return touched().iter().any(|ours| is_one(ours, file));
    }
    let all = Path::new("/proc");
    !all.join("self").exists() || all.join(process.to_string()).exists()
}

#[cfg(unix)]
fn is_one(one: &File, other: &File) -> bool {
    use std::os::unix::fs::MetadataExt;
    let identity = |file: &File| file.metadata().map(|found| (found.dev(), found.ino())).ok();
    identity(one).is_some() && identity(one) == identity(other)
}

#[cfg(not(unix))]
fn is_one(_: &File, _: &File) -> bool {
    true
}

/// The files of all locks of this process.
static LOCKS: Mutex<Vec<Weak<File>>> = Mutex::new(Vec::new());

fn touched() -> Vec<Arc<File>> {
    LOCKS.lock().unwrap_or_else(PoisonError::into_inner).iter().filter_map(Weak::upgrade).collect()
}

/// Has a file touched as long as it is open.
fn keep_touched(file: File) -> Arc<File> {
    let file = Arc::new(file);
    let mut locks = LOCKS.lock().unwrap_or_else(PoisonError::into_inner);
    if locks.is_empty() {
        // Without this thread the lock still holds wherever locks do.
        let _ = std::thread::Builder::new().name("locks".to_owned()).spawn(touch_all);
    }
    locks.push(Arc::downgrade(&file));
    file
}

/// Touches the files of all locks every so often, until there are none.
fn touch_all() {
    loop {
        std::thread::sleep(BEAT);
        {
            let mut locks = LOCKS.lock().unwrap_or_else(PoisonError::into_inner);
            locks.retain(|file| file.strong_count() > 0);
            if locks.is_empty() {
                return;
            }
        }
        touched().iter().for_each(|file| touch(file));
    }
}

/// Sets a file's time by the clock of its file system.
#[cfg(unix)]
fn touch(file: &File) {
    use rustix::fs::{Timespec, Timestamps, UTIME_NOW, UTIME_OMIT, futimens};
    let time = |tv_nsec| Timespec { tv_sec: 0, tv_nsec };
    let _ = futimens(file, &Timestamps { last_access: time(UTIME_OMIT), last_modification: time(UTIME_NOW) });
}

#[cfg(not(unix))]
fn touch(file: &File) {
    let _ = file.set_modified(SystemTime::now());
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
        left(dir.path(), "process 4711 on node7\n", 3600);
        let lock = DirectoryLock::take(dir.path()).unwrap();
        assert!(lock.note().unwrap().contains("taken over from process 4711 on node7"), "{:?}", lock.note());
        assert!(fs::read_to_string(dir.path().join(LOCK_NAME)).unwrap().contains(&std::process::id().to_string()));
    }

    /// A lock's file that nobody holds, last touched so many seconds ago.
    fn left(dir: &Path, text: &str, seconds: u64) {
        fs::write(dir.join(LOCK_NAME), text).unwrap();
        let file = OpenOptions::new().write(true).open(dir.join(LOCK_NAME)).unwrap();
        file.set_modified(SystemTime::now() - Duration::from_secs(seconds)).unwrap();
    }

    #[test]
    fn a_lock_of_another_host_that_was_touched_lately_is_refused_with_how_to_go_on() {
        let dir = tempfile::tempdir().unwrap();
        left(dir.path(), "process 4711 on node7\n", 20);
        let message = DirectoryLock::take(dir.path()).unwrap_err().to_string();
        for part in [
            "process 4711 on node7",
            "If it was killed, start again in ",
            " s: its lock is then taken over",
            "nothing was changed",
        ] {
            assert!(message.contains(part), "{message}");
        }
        assert_eq!(fs::read_to_string(dir.path().join(LOCK_NAME)).unwrap(), "process 4711 on node7\n");
        assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 1);
        left(dir.path(), "process 4711 on node7\n", 61);
        assert!(DirectoryLock::take(dir.path()).unwrap().note().is_some());
    }

    #[test]
    fn on_this_host_a_lock_is_taken_over_at_once_from_a_process_that_is_gone() {
        let dir = tempfile::tempdir().unwrap();
        // The greatest number that Linux gives out is 4194304; our own was given out again.
        for process in [4_194_305, std::process::id()] {
            left(dir.path(), &format!("process {process} on {}\n", host()), 0);
            assert!(DirectoryLock::take(dir.path()).unwrap().note().unwrap().contains(&format!("process {process} on")));
        }
    }

    #[test]
    fn a_held_lock_is_touched() {
        let dir = tempfile::tempdir().unwrap();
        let lock = DirectoryLock::take(dir.path()).unwrap();
        let long_ago = SystemTime::now() - Duration::from_secs(3600);
        lock.file.set_modified(long_ago).unwrap();
        assert!(touched().iter().any(|file| is_one(file, &lock.file)));
        touch(&lock.file);
        assert!(lock.file.metadata().unwrap().modified().unwrap() > long_ago + Duration::from_secs(3500));
    }

    #[test]
    fn one_task_is_worked_on_by_many_and_another_by_nobody() {
        let dir = tempfile::tempdir().unwrap();
        let join = |task, alone| TaskLock::join(dir.path(), task, alone, ["this study", "another study"]);
        let first = join("one", true).unwrap();
        let second = join("one", false).unwrap();
        for (task, alone, what) in [("two", false, "another study"), ("two", true, "another study"), ("one", true, "this study")]
        {
            let message = join(task, alone).unwrap_err().to_string();
            assert!(
                message.contains(&format!("process {} on {}, which computes {what}", std::process::id(), host())),
                "{message}"
            );
        }
        drop(first);
        assert!(join("two", true).is_err() && second.check_there().is_ok());
        drop(second);
        assert!(!dir.path().join(STUDY_LOCK_NAME).exists());
        let third = join("two", true).unwrap();
        fs::remove_file(dir.path().join(STUDY_LOCK_NAME)).unwrap();
        assert!(matches!(third.check_there(), Err(OutputError::Gone { .. })));
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
