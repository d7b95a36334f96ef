//! Files read whole, but never more of one than it may have: what is given may be a device or a
//! file of another kind that has no end.

use std::fs::File;
use std::io::{self, ErrorKind, Read};
use std::path::Path;

const MIB: u64 = 1 << 20;
/// Most bytes of a case or study file.
pub const CASE: u64 = 16 * MIB;
/// Most bytes of a law, and of what a run or a study wrote as text.
pub const RESULT: u64 = 256 * MIB;
/// Most bytes of a checkpoint: several times that of the finest mesh.
pub const CHECKPOINT: u64 = 4096 * MIB;

/// The bytes of a file that has `most` at most.
///
/// # Errors
/// Those of the system; [`ErrorKind::FileTooLarge`] for a file that has more, of which no more than
/// `most` is read.
pub fn read(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let file = File::open(path)?;
    let told = file.metadata()?.len();
    if told > most {
        return Err(too_large(most));
    }
    up_to(file, most, usize::try_from(told).unwrap_or(0))
}

/// What a device or a pipe has is not told beforehand.
fn up_to(source: impl Read, most: u64, expected: usize) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::with_capacity(expected);
    source.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most { Err(too_large(most)) } else { Ok(bytes) }
}

/// [`read`] for a file that a run or a study wrote. A device or a pipe under its name is none of
/// theirs, and is not waited for.
///
/// # Errors
/// As [`read`]; [`ErrorKind::InvalidInput`] for what is no ordinary file.
pub fn read_result(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let found = std::fs::metadata(path)?.file_type();
    if found.is_file() || found.is_dir() {
        return read(path, most);
    }
    Err(io::Error::new(ErrorKind::InvalidInput, "it is no ordinary file but a device or a pipe"))
}

/// [`read_result`] for text.
///
/// # Errors
/// As [`read_result`]; [`ErrorKind::InvalidData`] for what is not UTF-8.
pub fn result_to_string(path: &Path, most: u64) -> io::Result<String> {
    text(read_result(path, most)?)
}

/// The first bytes of a file that a run or a study wrote, `most` at most.
///
/// # Errors
/// As [`read_result`].
pub fn beginning(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    if !std::fs::metadata(path)?.is_file() {
        return Err(ErrorKind::InvalidInput.into());
    }
    let mut bytes = Vec::new();
    File::open(path)?.take(most).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// [`read`] for text.
///
/// # Errors
/// As [`read`]; [`ErrorKind::InvalidData`] for what is not UTF-8.
pub fn read_to_string(path: &Path, most: u64) -> io::Result<String> {
    text(read(path, most)?)
}

/// [`read_to_string`] for what is open already, such as standard input.
///
/// # Errors
/// As [`read_to_string`].
pub fn to_string(source: impl Read, most: u64) -> io::Result<String> {
    text(up_to(source, most, 0)?)
}

fn text(bytes: Vec<u8>) -> io::Result<String> {
    String::from_utf8(bytes).map_err(|_| io::Error::new(ErrorKind::InvalidData, "it is not text in UTF-8"))
}

fn too_large(most: u64) -> io::Error {
    io::Error::new(ErrorKind::FileTooLarge, format!("it has more than {} MiB, the most that such a file may have", most / MIB))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn as_much_as_allowed_and_no_more() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        std::fs::write(&path, "12345678").unwrap();
        assert_eq!(read_to_string(&path, 8).unwrap(), "12345678");
        assert_eq!(read(&path, 7).unwrap_err().kind(), ErrorKind::FileTooLarge);
        assert_eq!(to_string(&b"12345678"[..], 8).unwrap(), "12345678");
        assert_eq!(to_string(&b"12345678"[..], 7).unwrap_err().kind(), ErrorKind::FileTooLarge);
        std::fs::write(&path, b"\xff\xfe").unwrap();
        assert!(read_to_string(&path, 8).unwrap_err().to_string().contains("UTF-8"));
        assert_eq!(read(&folder.path().join("none"), 8).unwrap_err().kind(), ErrorKind::NotFound);
    }

    /// Nobody writes to the pipe: to open it would take for ever.
    #[cfg(unix)]
    #[test]
    fn a_pipe_among_results_is_not_waited_for() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("history.csv");
        rustix::fs::mknodat(rustix::fs::CWD, &path, rustix::fs::FileType::Fifo, 0o600.into(), 0).unwrap();
        let error = result_to_string(&path, 8).unwrap_err();
        assert!(error.kind() == ErrorKind::InvalidInput && error.to_string().contains("a pipe"), "{error}");
        assert!(beginning(&path, 8).is_err());
        let path = folder.path().join("summary.json");
        std::fs::write(&path, "12345678").unwrap();
        assert_eq!(result_to_string(&path, 8).unwrap(), "12345678");
        assert_eq!(beginning(&path, 3).unwrap(), b"123");
        assert_eq!(read_result(&path, 7).unwrap_err().kind(), ErrorKind::FileTooLarge);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_device_without_an_end_is_refused() {
        let error = read(Path::new("/dev/zero"), MIB).unwrap_err();
        assert!(error.to_string().contains("more than 1 MiB"), "{error}");
    }
}
