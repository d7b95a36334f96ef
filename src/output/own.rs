//! Which files are the program's own, by what is in them: only those are replaced and removed. A
//! name alone tells nothing, as a user may have a `run.log` or `plots/forces.svg` too.

use super::{OutputError, write_atomically};
use std::fs::{self, File};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::Path;

/// First line of a result's `case.toml`: by it, and only by it, a directory is recognised as a
/// result that may be replaced.
pub const RESULT_MARKER: &str = "# The resolved case of an asperity run. Running into this directory again replaces its results.";

/// Bytes of a file that are looked at, at its beginning and at its end.
const LOOK: u64 = 65_536;

/// Whether a file that is there is one that this program wrote. An empty one counts as such: there
/// is nothing in it to lose. Read from the contents of its beginning, so that files of earlier
/// versions are recognised too; PDF and PNG by their format alone, as they carry no mark.
///
/// # Errors
/// Those of the system.
pub fn is_own(path: &Path) -> io::Result<bool> {
    let mut file = File::open(path)?;
    let mut head = Vec::new();
    Read::take(&mut file, LOOK).read_to_end(&mut head)?;
    if head.is_empty() {
        return Ok(true);
    }
    let text = String::from_utf8_lossy(&head);
    let first = text.lines().next().unwrap_or_default().trim_end();
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let ending = Path::new(&name).extension().map(|ending| ending.to_string_lossy().into_owned()).unwrap_or_default();
    Ok(match (name.as_str(), ending.as_str()) {
        ("case.toml", _) => first == RESULT_MARKER,
        ("run.log", _) => first.trim_start().split_once(" s  ").is_some_and(|(seconds, _)| seconds.parse::<f64>().is_ok()),
        ("checkpoint.bin" | "checkpoint-end.bin", _) => head.starts_with(b"asperity checkpoint"),
        (_, "parquet") => head.starts_with(b"PAR1") && end(&mut file)?.contains("newton_iterations"),
        (_, "csv") => {
            let heads =
                ["step,segment,h,delta_T,F_N,F_T,a,", "point,X,Y,x,y,gap,pressure,", "segment,h,delta_T,F_N,F_T,law_F_N,law_F_T"];
            heads.iter().any(|head| first.starts_with(head))
                || name == "asperity_law_vectors.csv" && first.starts_with("path,E,nu,")
        }
        (_, "json") => [
            "\"format\": \"asperity-",
            "\"format\":\"asperity-",
            // A summary, a verification, a bench.
            "\"F_N0\"",
            "\"checks\"",
            "\"setups\"",
            "\"jobs\"",
        ]
        .iter()
        .any(|mark| text.contains(mark)),
        (_, "svg") => text.starts_with("<svg width=\"") && text.contains("fill=\"#FFFFFF\" stroke=\"none\"/>\n<desc>"),
        (_, "pdf") => head.starts_with(b"%PDF-"),
        (_, "png") => head.starts_with(b"\x89PNG"),
        (_, "vtu") => text.contains("<VTKFile type=\"UnstructuredGrid\"") && text.contains("<Piece NumberOfPoints="),
        (_, "pvd") => {
            let ours = text.lines().filter(|line| line.contains("<DataSet")).all(|line| line.contains(" file=\"step_"));
            text.contains("<VTKFile type=\"Collection\"") && ours
        }
        // Exports, pages of the manual, the report of a study, scripts for Slurm.
        _ => text.to_lowercase().contains("asperity") || first.starts_with("#!/bin/bash") && text.contains("# Submits the study"),
    })
}

/// The last bytes of a file.
fn end(file: &mut File) -> io::Result<String> {
    let length = file.metadata()?.len();
    file.seek(SeekFrom::Start(length.saturating_sub(LOOK)))?;
    let mut bytes = Vec::new();
    Read::take(file, LOOK).read_to_end(&mut bytes)?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// Refuses to replace or remove a file that somebody else wrote.
///
/// # Errors
/// [`OutputError::Foreign`], [`OutputError::Read`].
pub fn refuse_foreign(path: &Path) -> Result<(), OutputError> {
    // A link is replaced itself, and never what it leads to.
    if path.is_symlink() || !path.is_file() || is_own(path).map_err(OutputError::reading(path))? {
        return Ok(());
    }
    Err(OutputError::Foreign { path: path.to_path_buf() })
}

/// As [`write_atomically`], but a file of somebody else's that has the name stays.
///
/// # Errors
/// [`OutputError::Foreign`], [`OutputError::Write`].
pub fn write_own(path: &Path, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), OutputError> {
    refuse_foreign(path)?;
    write_atomically(path, fill)
}

/// Refuses to write a file from which something was read: what is written would take its place.
///
/// # Errors
/// [`OutputError::Input`].
pub fn refuse_input(written: &Path, inputs: &[&Path]) -> Result<(), OutputError> {
    let Ok(written) = fs::canonicalize(written) else { return Ok(()) };
    let same = |input: &&&Path| fs::canonicalize(input).is_ok_and(|input| input == written);
    inputs.iter().find(same).map_or(Ok(()), |input| Err(OutputError::Input { path: input.to_path_buf() }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_alone_is_no_proof_and_an_empty_file_no_loss() {
        let folder = tempfile::tempdir().unwrap();
        for name in [
            "case.toml",
            "run.log",
            "checkpoint.bin",
            "history.csv",
            "history.parquet",
            "summary.json",
            "law.json",
            "step_0001.csv",
            "step_0001.vtu",
            "case.pvd",
            "forces.svg",
            "forces.pdf",
            "forces.png",
            "report.html",
            "asperity_law.h",
            "law.asperity",
            "asperity.1",
            "asperity_law_vectors.csv",
        ] {
            let path = folder.path().join(name);
            assert!(write_own(&path, |_| Ok(())).is_ok() && write_own(&path, |out| out.write_all(b"my own\n")).is_ok(), "{name}");
            let message = write_own(&path, |out| out.write_all(b"another")).unwrap_err().to_string();
            assert!(message.contains(name) && message.contains("was not written by asperity"), "{message}");
            assert_eq!(fs::read_to_string(&path).unwrap(), "my own\n");
        }
    }

    #[test]
    fn what_was_read_is_not_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("law.json");
        refuse_input(&path, &[&path]).unwrap();
        fs::write(&path, "{}").unwrap();
        let other = folder.path().join(".").join("law.json");
        let message = refuse_input(&path, &[Path::new("none"), &other]).unwrap_err().to_string();
        assert!(message.contains("law.json: is an input"), "{message}");
    }
}
