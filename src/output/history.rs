//! `history.csv`: one row for every accepted step, in the user's units, appended as the run goes.

use super::finite::{check_row, none_in_row};
use super::lock::same_file;
use super::{OutputError, write_atomically};
use crate::bounded;
use crate::simulation::record::StepRecord;
use serde::de::DeserializeOwned;
use std::fs::{File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// The columns that every history has, in this order; more may follow.
const FIXED_COLUMNS: [&str; 10] =
    ["step", "segment", "h", "delta_T", "F_N", "F_T", "a", "stick_radius", "newton_iterations", "cutbacks"];

/// Appends rows to a `history.csv`; each is one write to the file, so that a killed job keeps whole
/// rows.
#[derive(Debug)]
pub struct HistoryWriter {
    path: PathBuf,
    file: File,
    /// Bytes written to it: as many as there have to be.
    length: u64,
}

impl HistoryWriter {
    /// A new history with its header; one that stands there is replaced.
    pub fn create(path: &Path) -> Result<Self, OutputError> {
        Self::resume(path, &[])
    }

    /// Goes on after `rows`, those of the checkpoint: what stands there is replaced by them, so
    /// that later rows, and a row cut short, are gone; they will be computed again.
    pub fn resume(path: &Path, rows: &[StepRecord]) -> Result<Self, OutputError> {
        write_atomically(path, |out| {
            out.write_all(header()?.as_bytes())?;
            rows.iter().try_for_each(|row| out.write_all(&encode(row)?))
        })?;
        let file = OpenOptions::new().append(true).open(path).map_err(OutputError::writing(path))?;
        let length = file.metadata().map_err(OutputError::writing(path))?.len();
        Ok(Self { path: path.to_path_buf(), file, length })
    }

    /// Appends a row and hands it to the system.
    /// A value that is not a number is refused, and so is a file that has gone or was changed.
    pub fn append(&mut self, record: &StepRecord) -> Result<(), OutputError> {
        check_row(&self.path, record)?;
        self.check_there()?;
        let row = encode(record).map_err(OutputError::writing(&self.path))?;
        self.file.write_all(&row).and_then(|()| self.file.flush()).map_err(OutputError::writing(&self.path))?;
        self.length += row.len() as u64;
        Ok(())
    }

    /// Whether the file still stands where it was made, as long as it was written: somebody may
    /// have removed the directory, moved it, or cut the file.
    ///
    /// # Errors
    /// [`OutputError::Gone`], [`OutputError::Changed`].
    pub fn check_there(&self) -> Result<(), OutputError> {
        if !same_file(&self.file, &self.path) {
            return Err(OutputError::Gone { path: self.path.clone() });
        }
        let found = self.file.metadata().map_err(OutputError::writing(&self.path))?;
        if found.is_file() && found.len() != self.length {
            return Err(OutputError::Changed { path: self.path.clone(), length: found.len(), written: self.length });
        }
        Ok(())
    }
}

/// One line with its end; the shortest digits that give the same number back.
fn encode(row: &StepRecord) -> io::Result<Vec<u8>> {
    let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(Vec::new());
    writer.serialize(row).map_err(io::Error::other)?;
    writer.into_inner().map_err(|error| io::Error::other(error.to_string()))
}

/// The line of column names, taken from the record itself.
fn header() -> io::Result<String> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.serialize(StepRecord::default()).map_err(io::Error::other)?;
    let text = writer.into_inner().map_err(|error| io::Error::other(error.to_string()))?;
    let end = text.iter().position(|&byte| byte == b'\n').map_or(text.len(), |end| end + 1);
    String::from_utf8(text[..end].to_vec()).map_err(io::Error::other)
}

/// The columns of a `history.csv`, in their order.
pub fn history_columns() -> Vec<String> {
    // The record's own field names: there is nothing in them that could not be written.
    header().unwrap_or_default().trim_end().split(',').map(str::to_owned).collect()
}

/// Reads a `history.csv`. A last row without its line end, left by a killed job, is not counted;
/// columns after the first ten may be missing or unknown. Errors name the line and the column.
pub fn read_history(path: &Path) -> Result<Vec<StepRecord>, OutputError> {
    let mut text = bounded::result_to_string(path, bounded::RESULT).map_err(OutputError::reading(path))?;
    text.truncate(text.rfind('\n').map_or(0, |end| end + 1));
    let malformed = |line: u64, problem: String| OutputError::Malformed { path: path.to_path_buf(), line, problem };
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let columns = reader.headers().map_err(|error| malformed(1, error.to_string()))?.clone();
    if columns.iter().take(FIXED_COLUMNS.len()).ne(FIXED_COLUMNS) {
        return Err(malformed(1, format!("the columns should start with {}", FIXED_COLUMNS.join(","))));
    }
    read_rows(&mut reader, &columns, none_in_row).map_err(|(line, problem)| malformed(line, problem))
}

/// All rows of a table; what is wrong with one is told with its line. `flaw` says what is wrong
/// with the values of a row.
pub(super) fn read_rows<T: DeserializeOwned>(
    reader: &mut csv::Reader<&[u8]>,
    columns: &csv::StringRecord,
    flaw: impl Fn(&T) -> Option<String>,
) -> Result<Vec<T>, (u64, String)> {
    let mut rows = Vec::new();
    let mut record = csv::StringRecord::new();
    while reader.read_record(&mut record).map_err(|error| row_problem(&error, columns))? {
        let row: T = record.deserialize(Some(columns)).map_err(|error| row_problem(&error, columns))?;
        if let Some(problem) = flaw(&row) {
            return Err((record.position().map_or(0, csv::Position::line), problem));
        }
        rows.push(row);
    }
    Ok(rows)
}

/// Line and plain words for what the CSV reader says of a row.
fn row_problem(error: &csv::Error, columns: &csv::StringRecord) -> (u64, String) {
    let line = error.position().map_or(0, csv::Position::line);
    let problem = match error.kind() {
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            format!("{len} values where there are {expected_len} columns")
        }
        csv::ErrorKind::Deserialize { err, .. } => {
            let column = err.field().and_then(|index| columns.get(index as usize)).unwrap_or("row");
            format!("column {column}: {}", err.kind())
        }
        _ => error.to_string(),
    };
    (line, problem)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn record(step: usize) -> StepRecord {
        StepRecord {
            step,
            segment: usize::from(step > 2),
            h: 0.02 * step as f64 / 3.0,
            delta_t: -1e-17 * step as f64,
            f_n: 148.812_345_678_901_2,
            f_t: -std::f64::consts::PI,
            a: 0.2087,
            newton_iterations: 7,
            max_alpha: 0.31,
            merit: f64::MIN_POSITIVE,
            // One that has something to compare with, and one that has not.
            f_t_limit: step.is_multiple_of(2).then_some(-3.25),
            f_n_error: step.is_multiple_of(2).then_some(1.0),
            delta_t_y: -0.1 / step as f64,
            m_roll_y: 0.7 / step as f64,
            ..StepRecord::default()
        }
    }

    #[test]
    fn first_columns_are_the_fixed_ones() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("history.csv");
        HistoryWriter::create(&path).unwrap();
        let text = fs::read_to_string(&path).unwrap();
        assert!(text.starts_with("step,segment,h,delta_T,F_N,F_T,a,stick_radius,newton_iterations,cutbacks,a_gap,"), "{text}");
        let last = "h_opponent,work_plastic_opponent,curvature,k_T,F_T_limit,F_N_limit,F_T_error,F_N_error,\
                    delta_T_y,F_T_y,twist,roll_x,roll_y,M_twist,M_roll_x,M_roll_y,h_contact,delta_T_contact,delta_T_y_contact\n";
        assert!(text.ends_with(&format!(",{last}")), "{text}");
        assert!(read_history(&path).unwrap().is_empty());
    }

    #[test]
    fn every_appended_row_is_on_the_disk_and_comes_back_to_the_bit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("history.csv");
        let mut writer = HistoryWriter::create(&path).unwrap();
        for step in 1..=4 {
            writer.append(&record(step)).unwrap();
            // The writer is still open: what a killed job leaves.
            let rows = read_history(&path).unwrap();
            assert_eq!(rows.len(), step);
            assert_eq!(rows[step - 1], record(step));
        }
    }

    #[test]
    fn resume_drops_later_and_torn_rows() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("history.csv");
        let mut writer = HistoryWriter::create(&path).unwrap();
        (1..=4).for_each(|step| writer.append(&record(step)).unwrap());
        drop(writer);
        OpenOptions::new().append(true).open(&path).unwrap().write_all(b"5,1,0.02,0.0").unwrap();
        assert_eq!(read_history(&path).unwrap().len(), 4);
        let mut writer = HistoryWriter::resume(&path, &[1, 2, 3].map(record)).unwrap();
        assert_eq!(read_history(&path).unwrap(), [1, 2, 3].map(record));
        writer.append(&record(4)).unwrap();
        assert_eq!(read_history(&path).unwrap(), (1..=4).map(record).collect::<Vec<_>>());
    }

    #[test]
    fn the_ten_columns_suffice() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("history.csv");
        fs::write(&path, format!("{},note\n1,0,0.01,0,70,0,0.14,0.14,5,0,hand-made\n", FIXED_COLUMNS.join(","))).unwrap();
        assert_eq!(read_history(&path).unwrap()[0].f_n, 70.0);
    }

    #[test]
    fn errors_name_line_and_column() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("history.csv");
        let mut writer = HistoryWriter::create(&path).unwrap();
        writer.append(&record(1)).unwrap();
        writer.append(&record(2)).unwrap();
        let good = fs::read_to_string(&path).unwrap();
        let fails = |text: String| {
            fs::write(&path, text).unwrap();
            read_history(&path).unwrap_err().to_string()
        };
        let error = fails(good.replace("148.8123456789012", "many"));
        assert!(error.contains("line 2") && error.contains("column F_N"), "{error}");
        let error = fails(good.clone() + "3,0,0.01\n");
        assert!(error.contains("line 4") && error.contains("3 values where there are 42"), "{error}");
        let error = fails(good.replace("delta_T", "shear"));
        assert!(error.contains("line 1") && error.contains("delta_T"), "{error}");
        let error = fails(String::new());
        assert!(error.contains("line 1"), "{error}");
        let error = read_history(&folder.path().join("none.csv")).unwrap_err().to_string();
        assert!(error.contains("none.csv") && error.contains("check the path"), "{error}");
    }

    #[cfg(unix)]
    #[test]
    fn a_history_that_was_removed_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("history.csv");
        let mut writer = HistoryWriter::create(&path).unwrap();
        writer.append(&record(1)).unwrap();
        fs::remove_file(&path).unwrap();
        assert!(matches!(writer.append(&record(2)), Err(OutputError::Gone { .. })));
        fs::write(&path, "another").unwrap();
        assert!(matches!(writer.check_there(), Err(OutputError::Gone { .. })));
    }

    #[test]
    fn a_history_that_was_cut_or_written_to_is_an_error_before_another_row_follows() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("history.csv");
        for text in ["", "another,header\n"] {
            let mut writer = HistoryWriter::resume(&path, &[record(1)]).unwrap();
            writer.append(&record(2)).unwrap();
            writer.check_there().unwrap();
            // The same file, as an editor or a full disk leaves it.
            OpenOptions::new().write(true).truncate(true).open(&path).unwrap().write_all(text.as_bytes()).unwrap();
            let message = writer.append(&record(3)).unwrap_err().to_string();
            assert!(message.contains("history.csv: was changed") && message.contains("--resume"), "{message}");
            assert_eq!(fs::read_to_string(&path).unwrap(), text);
        }
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_disk_is_an_error_with_a_remedy() {
        let file = OpenOptions::new().append(true).open("/dev/full").unwrap();
        let error =
            HistoryWriter { path: PathBuf::from("/dev/full"), file, length: 0 }.append(&record(1)).unwrap_err().to_string();
        assert!(error.contains("/dev/full") && error.contains("free space"), "{error}");
    }
}
