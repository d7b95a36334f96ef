//! The one error of this room: which file, what went wrong, what to do.

use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// A result file could not be written or read.
#[derive(Debug, thiserror::Error)]
pub enum OutputError {
    /// A file or folder could not be created, written or renamed.
    #[error("cannot write {}: {source}; {}", path.display(), writing_remedy(source))]
    Write {
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A file could not be opened or read.
    #[error("cannot read {}: {source}; {}", path.display(), reading_remedy(source))]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A file is not what its name promises.
    #[error("{}, line {line}: {problem}. Restore the file or run the case again into an empty folder", path.display())]
    Malformed {
        /// The file.
        path: PathBuf,
        /// Line, counted from 1.
        line: u64,
        /// What is wrong there.
        problem: String,
    },
    /// A run cannot go on from its checkpoint.
    #[error("{}: a run cannot go on from here: {problem}", path.display())]
    Checkpoint {
        /// The checkpoint.
        path: PathBuf,
        /// Why, and what to do.
        problem: String,
    },
    /// Somebody else writes there.
    #[error(
        "--out {}: is being written by {}. Wait for it to end, or give another directory{} (nothing was changed)",
        dir.display(),
        holder.as_deref().unwrap_or("another process"),
        wait.map_or(String::new(), |wait| format!(
            ". If it was killed, start again in {} s: its lock is then taken over",
            wait.as_secs() + 1
        ))
    )]
    Locked {
        /// The directory.
        dir: PathBuf,
        /// Process and host, if they are known.
        holder: Option<String>,
        /// Where it may have been killed: how long it still counts as being there.
        wait: Option<Duration>,
    },
    /// A folder of results is a link to somewhere else.
    #[error("{}: is a link, and results are only written to folders of their own; remove it, or choose another --out", path.display())]
    Link {
        /// The link.
        path: PathBuf,
    },
    /// A file that somebody else wrote has the name of one of ours.
    #[error("{}: was not written by asperity, and is not replaced or removed. Move it away, or choose another place (nothing was changed)", path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
    },
    /// What was read would be replaced.
    #[error("{}: is an input, and results would take its place. Copy it elsewhere, or choose another --out (nothing was changed)", path.display())]
    Input {
        /// The file.
        path: PathBuf,
    },
    /// What is being written was removed or replaced.
    #[error("{}: was removed or replaced while the run went on; leave the directory alone until the run has ended, and run again", path.display())]
    Gone {
        /// The file that is not there any more.
        path: PathBuf,
    },
    /// What is being written was cut or written to by somebody else.
    #[error(
        "{}: was changed while the run went on ({length} bytes are there, {written} were written); leave the directory alone until the run has ended, and \
         go on with --resume",
        path.display()
    )]
    Changed {
        /// The file.
        path: PathBuf,
        /// Its length now.
        length: u64,
        /// What it should be.
        written: u64,
    },
    /// A result that is no number.
    #[error(
        "step {step}: {column} is {value}; the numbers of the case are too large or too small, or this is a fault of the program: choose other units, or \
         report it"
    )]
    NotFinite {
        /// The file that it would have been written to.
        path: PathBuf,
        /// The step.
        step: usize,
        /// What is not finite.
        column: String,
        /// Infinite, or not a number.
        value: f64,
    },
    /// A file cannot be made in its format.
    #[error("cannot write {}: {problem}", path.display())]
    Format {
        /// The file that was to be written.
        path: PathBuf,
        /// Why not, and what to do.
        problem: String,
    },
    /// Data handed to a writer do not fit each other.
    #[error("cannot write {}: {problem}; this is a fault of the program, please report it", path.display())]
    Inconsistent {
        /// The file that was to be written.
        path: PathBuf,
        /// What does not fit.
        problem: String,
    },
}

impl OutputError {
    /// For `map_err` where `path` is being written.
    pub(super) fn writing(path: &Path) -> impl FnOnce(io::Error) -> Self + '_ {
        move |source| Self::Write { path: path.to_path_buf(), source }
    }

    /// For `map_err` where `path` is being read.
    pub(super) fn reading(path: &Path) -> impl FnOnce(io::Error) -> Self + '_ {
        move |source| Self::Read { path: path.to_path_buf(), source }
    }

    /// The file concerned.
    pub fn path(&self) -> &Path {
        match self {
            Self::Write { path, .. }
            | Self::Read { path, .. }
            | Self::Malformed { path, .. }
            | Self::Checkpoint { path, .. }
            | Self::Link { path }
            | Self::Foreign { path }
            | Self::Input { path }
            | Self::Gone { path }
            | Self::Changed { path, .. }
            | Self::NotFinite { path, .. }
            | Self::Format { path, .. }
            | Self::Inconsistent { path, .. } => path,
            Self::Locked { dir, .. } => dir,
        }
    }
}

fn writing_remedy(error: &io::Error) -> &'static str {
    use io::ErrorKind as Kind;
    match error.kind() {
        Kind::StorageFull | Kind::QuotaExceeded => "free space there or choose another place with --out, and run again",
        Kind::FileTooLarge => {
            "it would be larger than files may be here: raise that limit (`ulimit -f`) or choose another place with --out, and run again"
        }
        Kind::PermissionDenied | Kind::ReadOnlyFilesystem => "choose a folder that you may write to with --out",
        Kind::AlreadyExists | Kind::NotADirectory | Kind::IsADirectory => {
            "a file stands where a folder is needed, or the reverse: move it away or choose another --out"
        }
        _ => "check that the place exists and can be written, or choose another with --out",
    }
}

fn reading_remedy(error: &io::Error) -> &'static str {
    match error.kind() {
        io::ErrorKind::NotFound => "check the path: it should be in the folder that was given to --out",
        io::ErrorKind::PermissionDenied => "ask for the right to read it",
        _ => "check the file",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_name_the_file_and_the_remedy() {
        let full = OutputError::writing(Path::new("out/history.csv"))(io::Error::from(io::ErrorKind::StorageFull));
        let text = full.to_string();
        assert!(text.contains("out/history.csv") && text.contains("free space"), "{text}");
        let limited = OutputError::writing(Path::new("out/history.csv"))(io::Error::from(io::ErrorKind::FileTooLarge));
        assert!(limited.to_string().contains("out/history.csv") && limited.to_string().contains("`ulimit -f`"), "{limited}");
        let denied = OutputError::writing(Path::new("/summary.json"))(io::Error::from(io::ErrorKind::PermissionDenied));
        assert!(denied.to_string().contains("--out"));
        let missing = OutputError::reading(Path::new("x/history.csv"))(io::Error::from(io::ErrorKind::NotFound));
        assert!(missing.to_string().contains("x/history.csv") && missing.to_string().contains("check the path"));
        assert_eq!(missing.path(), Path::new("x/history.csv"));
    }
}
