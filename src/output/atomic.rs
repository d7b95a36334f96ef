//! Whole files or none.

use super::OutputError;
use std::fs::{self, File, OpenOptions};
use std::hash::{BuildHasher, Hasher, RandomState};
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// Writes `path` through `fill`: into a hidden file beside it, which takes the name only when it is
/// complete and on the disk; then the folder is brought to the disk too, so that a power cut does
/// not take the name back. Folders above it are made. On an error the hidden file is removed and
/// what stood under the name before stays; so does a device, a pipe or a socket.
pub fn write_atomically(path: &Path, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), OutputError> {
    let folder = folder_of(path);
    make_folder(folder).map_err(OutputError::writing(folder))?;
    replace_atomically(path, fill)
}

/// The same in a folder that is there: none is made, so that one which was removed while a run goes
/// on does not come back.
pub fn replace_atomically(path: &Path, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), OutputError> {
    let name = path.file_name().ok_or_else(|| OutputError::Write {
        path: path.to_path_buf(),
        source: io::Error::new(io::ErrorKind::InvalidInput, "not the name of a file"),
    })?;
    if fs::symlink_metadata(path).is_ok_and(|there| !(there.is_file() || there.is_symlink() || there.is_dir())) {
        let source = io::Error::new(io::ErrorKind::InvalidInput, "it is a device, a pipe or a socket, which no file replaces");
        return Err(OutputError::Write { path: path.to_path_buf(), source });
    }
    let folder = folder_of(path);
    // A name that nobody can have laid a link under, and a file that was not there.
    let number = RandomState::new().build_hasher().finish();
    let draft = folder.join(format!(".{}.{number}.tmp", name.to_string_lossy()));
    let written = (|| {
        let mut file = BufWriter::with_capacity(1 << 16, OpenOptions::new().write(true).create_new(true).open(&draft)?);
        fill(&mut file)?;
        file.into_inner().map_err(io::IntoInnerError::into_error)?.sync_data()?;
        fs::rename(&draft, path)
    })();
    written.map_err(|source| {
        // The first error is the one to report; a draft that cannot be removed either is hidden and
        // harmless.
        let _ = fs::remove_file(&draft);
        OutputError::Write { path: path.to_path_buf(), source }
    })?;
    sync_folder(folder);
    Ok(())
}

/// The name of the file for which a name is that of a draft; `None` if it is not one.
pub fn draft_of(name: &str) -> Option<&str> {
    let (name, number) = name.strip_prefix('.')?.strip_suffix(".tmp")?.rsplit_once('.')?;
    number.bytes().all(|byte| byte.is_ascii_digit()).then_some(name)
}

/// Removes a file; that somebody else has removed it, or takes his draft away again, is no fault.
///
/// # Errors
/// Those of the system.
pub fn remove_if_there(path: &Path) -> io::Result<()> {
    match fs::remove_file(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
        removed => removed,
    }
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Makes a folder and those above it, and brings their names to the disk.
fn make_folder(folder: &Path) -> io::Result<()> {
    if folder.is_dir() {
        return Ok(());
    }
    fs::create_dir_all(folder)?;
    if let Some(above) = folder.parent() {
        sync_folder(if above.as_os_str().is_empty() { Path::new(".") } else { above });
    }
    Ok(())
}

/// Brings the names in a folder to the disk. Not every system and file system can, and then there
/// is nothing to be done about it.
fn sync_folder(folder: &Path) {
    if cfg!(unix) {
        let _ = File::open(folder).and_then(|folder| folder.sync_all());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> =
            fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    #[test]
    fn a_folder_that_is_gone_does_not_come_back() {
        let folder = tempfile::tempdir().unwrap();
        let gone = folder.path().join("gone");
        assert!(replace_atomically(&gone.join("file.txt"), |out| out.write_all(b"x")).is_err());
        assert!(!gone.exists());
    }

    #[test]
    fn makes_folders_and_replaces() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a/b/file.txt");
        write_atomically(&path, |out| out.write_all(b"first")).unwrap();
        write_atomically(&path, |out| out.write_all(b"second")).unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "second");
        assert_eq!(names(path.parent().unwrap()), ["file.txt"]);
    }

    #[test]
    fn an_error_half_way_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file.txt");
        write_atomically(&path, |out| out.write_all(b"old")).unwrap();
        let error = write_atomically(&path, |out| {
            out.write_all(&[b'x'; 200_000])?;
            Err(io::Error::from(io::ErrorKind::StorageFull))
        })
        .unwrap_err();
        assert!(error.to_string().contains("free space"), "{error}");
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        assert_eq!(names(folder.path()), ["file.txt"]);
    }

    #[cfg(unix)]
    #[test]
    fn a_draft_has_a_name_that_nobody_knows_and_a_link_under_the_name_itself_is_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let (mine, path) = (folder.path().join("mine.txt"), folder.path().join("out/file.txt"));
        fs::write(&mine, "mine").unwrap();
        fs::create_dir(folder.path().join("out")).unwrap();
        std::os::unix::fs::symlink(&mine, &path).unwrap();
        let mut drafts = Vec::new();
        for _ in 0..2 {
            write_atomically(&path, |_| {
                drafts.extend(names(path.parent().unwrap()).into_iter().filter(|name| draft_of(name) == Some("file.txt")));
                Ok(())
            })
            .unwrap();
        }
        assert!(
            drafts.len() == 2 && drafts[0] != drafts[1] && !drafts[0].contains(&std::process::id().to_string()),
            "{drafts:?}"
        );
        assert_eq!(fs::read_to_string(&mine).unwrap(), "mine");
        assert!(!path.is_symlink());
    }

    #[cfg(unix)]
    #[test]
    fn what_is_no_file_stays() {
        use std::os::unix::fs::FileTypeExt;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("socket");
        let _open = std::os::unix::net::UnixListener::bind(&path).unwrap();
        let error = write_atomically(&path, |out| out.write_all(b"x")).unwrap_err().to_string();
        assert!(error.contains("socket: it is a device, a pipe or a socket"), "{error}");
        assert!(fs::symlink_metadata(&path).unwrap().file_type().is_socket());
        assert_eq!(names(folder.path()), ["socket"]);
    }

    #[test]
    fn a_file_in_the_way_of_a_folder_is_an_error_with_a_remedy() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("fields"), "").unwrap();
        let error = write_atomically(&folder.path().join("fields/step_0001.vtu"), |_| Ok(())).unwrap_err();
        assert!(error.to_string().contains("a file stands where a folder is needed"), "{error}");
        assert!(write_atomically(Path::new("/"), |_| Ok(())).is_err());
    }
}
