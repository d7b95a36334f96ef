//! An open file, and what stands under its name.

use std::fs::{self, File, OpenOptions};
use std::io;
use std::path::Path;

/// Opens the file, but never follows a link to somebody else's.
pub fn open(path: &Path) -> io::Result<File> {
    let mut options = OpenOptions::new();
    options.read(true).write(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::custom_flags(&mut options, rustix::fs::OFlags::NOFOLLOW.bits() as i32);
    options.open(path)
}

/// Whether an open file still is what stands under the name.
#[cfg(unix)]
pub fn same_file(file: &File, path: &Path) -> bool {
    let ours = identity(file.metadata());
    ours.is_some() && ours == identity(fs::metadata(path))
}

/// Whether something stands under the name: an open file cannot be removed here.
#[cfg(not(unix))]
pub fn same_file(_: &File, path: &Path) -> bool {
    path.exists()
}

/// Device and number of a file.
#[cfg(unix)]
pub fn identity(found: io::Result<fs::Metadata>) -> Option<(u64, u64)> {
    use std::os::unix::fs::MetadataExt;
    found.map(|found| (found.dev(), found.ino())).ok()
}

/// Whether there is one.
#[cfg(not(unix))]
pub fn identity(found: io::Result<fs::Metadata>) -> Option<(u64, u64)> {
    found.ok().map(|_| (0, 0))
}
