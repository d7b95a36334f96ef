//! Who has a lock: what its file tells, and whether that process still is there.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::time::{Duration, SystemTime};

use super::beat::is_locked_here;

/// A lock's file that was not touched for so long counts no more: its process was killed.
pub const GONE: Duration = Duration::from_secs(60);

/// What a lock's file tells of its holder.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Holder {
    /// `process NUMBER on HOST`; empty if the file does not tell.
    pub name: String,
    /// Within what the number of the process means something, see [`system`].
    system: String,
    /// What it works on; empty for a lock of one writer.
    pub task: String,
}

impl Holder {
    /// This process.
    pub fn myself(task: &str) -> Self {
        let name = format!("process {} on {}", std::process::id(), host());
        Self { name, system: system().unwrap_or_default(), task: task.to_owned() }
    }

    /// What stands in the lock's file.
    pub fn text(&self) -> String {
        let lines = [&self.name, &format!("system {}", self.system), &self.task];
        lines.into_iter().filter(|line| !line.is_empty()).map(|line| format!("{line}\n")).collect()
    }

    /// What a lock's file tells; nothing, if it cannot be read.
    pub fn read(mut file: &File) -> Self {
        let mut text = String::new();
        let read = file.seek(SeekFrom::Start(0)).and_then(|_| Read::take(file, 1000).read_to_string(&mut text));
        let mut holder = Self::default();
        for line in text.lines().map(str::trim).filter(|line| read.is_ok() && !line.is_empty()) {
            match (line.strip_prefix("system "), holder.name.is_empty()) {
                (Some(system), _) => system.clone_into(&mut holder.system),
                (None, true) => line.clone_into(&mut holder.name),
                (None, false) => line.clone_into(&mut holder.task),
            }
        }
        holder
    }

    /// Whether its process is known to have ended. Nothing is known of one on another host, nor
    /// where numbers of processes mean something else: after a start of the system, or in another
    /// container.
    pub fn is_gone(&self, file: &File) -> bool {
        let told = self.name.strip_prefix("process ").and_then(|rest| rest.split_once(" on "));
        let Some((process, on)) = told.and_then(|(process, on)| Some((process.parse().ok()?, on))) else { return false };
        if on != host() || system().is_none_or(|ours| ours != self.system) {
            return false;
        }
        // Our own number may have been given out again.
        if process == std::process::id() { !is_locked_here(file) } else { !is_running(process) }
    }
}

/// How long a file still counts as held that was touched lately, at the time `now` of its file
/// system's clock; `None` if that is over.
pub fn left(file: &File, now: SystemTime) -> Option<Duration> {
    GONE.checked_sub(age(file, now)?).filter(|left| !left.is_zero())
}

/// How long ago a file was touched, at the time `now` of its file system's clock.
pub fn age(file: &File, now: SystemTime) -> Option<Duration> {
    let touched = file.metadata().and_then(|found| found.modified()).ok()?;
    now.duration_since(touched).or_else(|_| touched.duration_since(now)).ok()
}

/// Whether there is a process of this number.
#[cfg(unix)]
pub fn is_running(process: u32) -> bool {
    use rustix::process::{Pid, test_kill_process};
    let pid = i32::try_from(process).ok().and_then(Pid::from_raw);
    // One that may not be sent signals to is there.
    pid.is_some_and(|pid| test_kill_process(pid) != Err(rustix::io::Errno::SRCH))
}

#[cfg(not(unix))]
pub fn is_running(_: u32) -> bool {
    true
}

/// The start of the system and the name space in which processes have their numbers; `None` where
/// that is not known.
#[cfg(target_os = "linux")]
fn system() -> Option<String> {
    let boot = std::fs::read_to_string("/proc/sys/kernel/random/boot_id").ok()?;
    let namespace = std::fs::read_link("/proc/self/ns/pid").ok()?;
    Some(format!("{} {}", boot.trim(), namespace.display()))
}

/// Elsewhere the name of the host is enough: there are no name spaces, and a number that was given
/// out again after a start of the system is that of a process which is there.
#[cfg(not(target_os = "linux"))]
fn system() -> Option<String> {
    Some(std::env::consts::OS.to_owned())
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
    use std::fs;

    /// A file with this text.
    fn file(text: &str) -> File {
        let dir = tempfile::tempdir().unwrap();
        fs::write(dir.path().join("lock"), text).unwrap();
        File::open(dir.path().join("lock")).unwrap()
    }

    #[test]
    fn what_a_file_tells_is_what_was_written() {
        for task in ["", "study 0123456789abcdef"] {
            let holder = Holder::myself(task);
            assert_eq!(Holder::read(&file(&holder.text())), holder);
        }
        let other = Holder::read(&file("process 4711 on node7\nstudy 01\n"));
        assert_eq!((other.name.as_str(), other.task.as_str(), other.system.as_str()), ("process 4711 on node7", "study 01", ""));
        assert_eq!(Holder::read(&file("")), Holder::default());
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_number_of_a_process_is_trusted_only_where_it_means_something() {
        let told = |process: u32, host: &str, system: Option<&str>| {
            let system = system.map_or(String::new(), |system| format!("system {system}\n"));
            let file = file(&format!("process {process} on {host}\n{system}"));
            Holder::read(&file).is_gone(&file)
        };
        let (ours, system) = (host(), system().unwrap());
        let (boot, namespace) = system.split_once(' ').unwrap();
        assert!(boot.len() == 36 && namespace.starts_with("pid:["), "{system}");
        // The greatest number that Linux gives out is 4194304; our own was given out again.
        for process in [4_194_305, std::process::id()] {
            assert!(told(process, &ours, Some(&system)));
            assert!(!told(process, "node7", Some(&system)));
            // Of another container with this host's name, of the time before a start, of a system
            // that does not tell.
            assert!(!told(process, &ours, Some(&format!("{boot} pid:[1]"))));
            assert!(!told(process, &ours, Some(&format!("918eda78-0000-0000-0000-000000000000 {namespace}"))));
            assert!(!told(process, &ours, None));
        }
        // There, though it is another user's.
        assert!(!told(1, &ours, Some(&system)) && is_running(1) && !is_running(0) && !is_running(u32::MAX));
        let text = file("nobody knows");
        assert!(!Holder::read(&text).is_gone(&text));
    }
}
