//! The files of the locks that this process has, which are touched every so often: whoever finds
//! one that is not, knows that its process was killed.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::time::Duration;

use super::file::{identity, open};

/// Time between two touches.
const BEAT: Duration = Duration::from_secs(10);

/// The file of a lock that this process has.
#[derive(Debug)]
pub struct Own {
    path: PathBuf,
    identity: (u64, u64),
    /// Locked for as long as it is open.
    file: Option<File>,
    /// That which took it: one that `fork` makes of it has it not.
    process: u32,
}

impl Own {
    /// Has a file touched for as long as this is kept.
    pub fn keep(path: PathBuf, file: File) -> Arc<Self> {
        let identity = identity(file.metadata()).unwrap_or_default();
        Self { path, identity, file: Some(file), process: std::process::id() }.kept()
    }

    fn kept(self) -> Arc<Self> {
        let own = Arc::new(self);
        let mut beat = beat();
        beat.own(own.process).push(Arc::downgrade(&own));
        beat.start(own.process, start);
        own
    }

    /// The same without an open file, of which a process cannot have many. Its text and time count
    /// from now on.
    #[cfg(any(feature = "law", test))]
    pub fn closed(&self) -> Arc<Self> {
        Self { path: self.path.clone(), identity: self.identity, file: None, process: self.process }.kept()
    }

    /// As where locks do not hold.
    #[cfg(test)]
    pub fn unlock(&self) {
        self.file.iter().for_each(|file| file.unlock().unwrap());
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether it still stands under its name.
    pub fn is_there(&self) -> bool {
        if cfg!(unix) { identity(fs::metadata(&self.path)) == Some(self.identity) } else { self.path.exists() }
    }

    /// Removes it, unless another has its name.
    pub fn remove(&self) {
        if self.process == std::process::id() && self.is_there() {
            // One that cannot be removed is taken for what a killed run left.
            let _ = fs::remove_file(&self.path);
        }
    }

    fn touch(&self) {
        match &self.file {
            Some(file) => touch(file),
            None if self.is_there() => open(&self.path).iter().for_each(touch),
            None => {}
        }
    }
}

/// Whether an open file is that of one of this process's locks.
pub fn is_locked_here(file: &File) -> bool {
    let file = identity(file.metadata());
    let own: Vec<_> = beat().own(std::process::id()).iter().filter_map(Weak::upgrade).collect();
    own.iter().any(|own| !cfg!(unix) || Some(own.identity) == file)
}

/// Starts the thread that touches the files, if there are some and it could not be started before.
pub fn go_on() {
    beat().start(std::process::id(), start);
}

/// The files that one thread touches, and the process whose thread it is.
struct Beat {
    process: u32,
    own: Vec<Weak<Own>>,
    runs: bool,
}

static BEATS: Mutex<Beat> = Mutex::new(Beat { process: 0, own: Vec::new(), runs: false });

fn beat() -> MutexGuard<'static, Beat> {
    BEATS.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Beat {
    /// The files of a process. One that `fork` has made has the list of its parent, but not its
    /// thread: it begins with none.
    fn own(&mut self, process: u32) -> &mut Vec<Weak<Own>> {
        if self.process != process {
            *self = Self { process, own: Vec::new(), runs: false };
        }
        &mut self.own
    }

    /// Has the thread started, if it is needed and does not run. Without it a lock still holds
    /// wherever locks do, and the next one tries again.
    fn start(&mut self, process: u32, start: impl FnOnce() -> bool) {
        if !self.own(process).is_empty() && !self.runs {
            self.runs = start();
        }
    }
}

fn start() -> bool {
    std::thread::Builder::new().name("locks".to_owned()).spawn(touch_all).is_ok()
}

/// Touches the files of all locks every so often, until there are none.
fn touch_all() {
    loop {
        std::thread::sleep(BEAT);
        let own: Vec<_> = {
            let mut beat = beat();
            beat.own.retain(|own| own.strong_count() > 0);
            if beat.own.is_empty() {
                beat.runs = false;
                return;
            }
            beat.own.iter().filter_map(Weak::upgrade).collect()
        };
        own.iter().for_each(|own| own.touch());
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
    let _ = file.set_modified(std::time::SystemTime::now());
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::SystemTime;

    #[test]
    fn a_held_lock_is_touched_with_and_without_an_open_file() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("lock");
        let file = File::create(&path).unwrap();
        let long_ago = SystemTime::now() - Duration::from_secs(3600);
        let open = Own::keep(path.clone(), file);
        let closed = open.closed();
        for own in [open, closed] {
            File::options().write(true).open(&path).unwrap().set_modified(long_ago).unwrap();
            assert!(is_locked_here(&File::open(&path).unwrap()));
            own.touch();
            assert!(fs::metadata(&path).unwrap().modified().unwrap() > long_ago + Duration::from_secs(3500));
        }
        // By no lock that is kept.
        assert!(!is_locked_here(&File::open(&path).unwrap()));
    }

    #[test]
    fn a_process_made_by_fork_begins_anew_and_a_failed_start_is_tried_again() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("lock");
        let file = File::create(&path).unwrap();
        let own = Arc::new(Own { path, identity: identity(file.metadata()).unwrap(), file: Some(file), process: 1 });
        let mut beat = Beat { process: 0, own: Vec::new(), runs: false };
        let never = || -> bool { panic!("it runs already, or there is nothing to touch") };
        beat.start(1, never);
        beat.own(1).push(Arc::downgrade(&own));
        beat.start(1, || false);
        beat.start(1, || true);
        beat.start(1, never);
        assert_eq!(beat.own(1).len(), 1);
        // The child.
        beat.start(2, never);
        assert!(beat.own(2).is_empty() && !beat.runs);
        beat.own(2).push(Arc::downgrade(&own));
        beat.start(2, || true);
        assert!(beat.runs);
        // Another process's file is not ours to remove.
        own.remove();
        assert!(own.is_there());
    }
}
