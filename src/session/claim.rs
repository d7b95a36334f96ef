//! The right to write to the directory of `--out`: nobody else writes there, and what stands there
//! is not replaced without a word.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use super::error::is_absent;
use super::{Earlier, SessionError, prepare};
use crate::case::Case;
use crate::output::{DirectoryLock, OutputDirectory, RunStatus, Summary, case_difference, read_history};

/// A directory that is taken. Given up, folders that were made for it and in which nothing was
/// written go too.
#[derive(Debug)]
pub struct Claim {
    lock: Option<DirectoryLock>,
    /// Innermost first.
    made: Vec<PathBuf>,
}

impl Claim {
    /// What the user should know of a lock that a killed run left.
    pub fn note(&self) -> Option<&str> {
        self.lock.as_ref()?.note()
    }
}

impl Drop for Claim {
    fn drop(&mut self) {
        drop(self.lock.take());
        // A folder in which there is something is not removed.
        let _ = self.made.iter().try_for_each(fs::remove_dir);
    }
}

/// Takes the directory for a run of `case`: makes it if it is not there, and locks it for as long
/// as the lock is kept. A directory of the user's own, one that another process writes to, and an
/// earlier result that is neither to be resumed nor replaced are refused, and stay as they are.
///
/// # Errors
/// [`SessionError::NotAResult`], [`SessionError::NotADirectory`], [`SessionError::Out`],
/// [`SessionError::Earlier`], [`SessionError::Output`].
pub fn claim(dir: &Path, case: &Case, earlier: Earlier) -> Result<Claim, SessionError> {
    prepare::recognise(dir)?;
    prepare::refuse_case_alone(dir, case)?;
    let made = dir.ancestors().take_while(|folder| !folder.as_os_str().is_empty() && is_absent(folder));
    let made = made.map(Path::to_path_buf).collect();
    let mut claim = Claim { lock: None, made };
    fs::create_dir_all(dir).map_err(|source| SessionError::Out { dir: dir.to_owned(), what: "be created", source })?;
    claim.lock = Some(DirectoryLock::take(dir)?);
    // Once more, as now nobody else changes it.
    prepare::recognise(dir)?;
    if earlier == Earlier::Keep
        && let Some(found) = found(dir, case)
    {
        return Err(SessionError::Earlier { dir: dir.to_owned(), found });
    }
    Ok(claim)
}

/// An earlier result in words: whose, how far and how old; `None` if there is none, or nothing of
/// it was computed.
fn found(dir: &Path, case: &Case) -> Option<String> {
    let out = OutputDirectory::existing(dir);
    let there = out.read_case()?;
    let summary = Summary::read(&out.summary()).ok();
    let steps = read_history(&out.history()).map_or(0, |rows| rows.len());
    if summary.is_none() && steps == 0 && !out.checkpoint().exists() {
        return None;
    }
    let how = match summary.map_or(RunStatus::Interrupted, |summary| summary.status) {
        RunStatus::Done => "a run that is done".to_owned(),
        RunStatus::Interrupted => "an unfinished run".to_owned(),
        status => format!("a run that ended as {:?}", status.to_string()),
    };
    let whose = match case_difference(&there, &case.to_toml()) {
        None => "of this very case".to_owned(),
        Some(difference) => format!("of another case ({difference})"),
    };
    let written = [out.summary(), out.history(), out.checkpoint()].iter().filter_map(|path| modified(path)).max();
    let age = written.map_or(String::new(), |time| format!(", written {}", ago(time)));
    Some(format!("{how}, {whose}, {steps} steps{age}"))
}

fn modified(path: &Path) -> Option<SystemTime> {
    fs::metadata(path).and_then(|found| found.modified()).ok()
}

fn ago(time: SystemTime) -> String {
    let seconds = SystemTime::now().duration_since(time).unwrap_or(Duration::ZERO).as_secs();
    match seconds {
        0..120 => format!("{seconds} s ago"),
        120..7200 => format!("{} min ago", seconds / 60),
        7200..172_800 => format!("{} h ago", seconds / 3600),
        _ => format!("{} days ago", seconds / 86_400),
    }
}

/// Removes from a run that has ended what is left there when it was killed just before its last
/// file was removed.
pub fn tidy(dir: &Path, keeps_checkpoint: bool, keeps_end: bool) {
    // What cannot be removed does no harm.
    let _ = OutputDirectory::existing(dir).tidy(keeps_checkpoint, keeps_end);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ages_are_told_in_words() {
        let before = |seconds| ago(SystemTime::now() - Duration::from_secs(seconds));
        let told = [5, 600, 3600 * 30, 86_400 * 9].map(before);
        assert_eq!(told, ["5 s ago", "10 min ago", "30 h ago", "9 days ago"]);
    }
}
