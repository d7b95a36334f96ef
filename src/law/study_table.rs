//! `study.csv` as it stands: a header and cells, by name.

use std::path::Path;

use super::LawError;
use crate::bounded;

/// The table of a study.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StudyTable {
    /// Names of the columns.
    pub header: Vec<String>,
    /// The rows, in the table's order.
    pub rows: Vec<StudyRow>,
}

/// One case of a [`StudyTable`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StudyRow {
    /// The case's number, as its directory is called; in the table `c` stands before it.
    pub id: String,
    /// Its directory, from the study's.
    pub directory: String,
    /// How it stands: `done`, or why it is not.
    pub status: String,
    cells: Vec<String>,
}

impl StudyTable {
    /// Reads it.
    ///
    /// # Errors
    /// [`LawError::NoStudy`] if it is not there, [`LawError::Table`] if it is no table or lacks
    /// `case`, `directory` or `status`.
    pub fn read(path: &Path) -> Result<Self, LawError> {
        let text = bounded::result_to_string(path, bounded::RESULT)
            .map_err(|source| LawError::NoStudy { path: path.to_owned(), source })?;
        let malformed = |line: u64, problem: String| LawError::Table { path: path.to_owned(), line, problem };
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let header = reader.headers().map_err(|error| malformed(1, error.to_string()))?.clone();
        let column = |name: &str| {
            header.iter().position(|column| column == name).ok_or_else(|| malformed(1, format!("there is no column {name}")))
        };
        let (id, directory, status) = (column("case")?, column("directory")?, column("status")?);
        let mut rows = Vec::new();
        for record in reader.records() {
            let record = record.map_err(|error| malformed(error.position().map_or(0, csv::Position::line), error.to_string()))?;
            let cell = |index: usize| record.get(index).unwrap_or_default().to_owned();
            let cells = record.iter().map(str::to_owned).collect();
            rows.push(StudyRow { id: cell(id), directory: cell(directory), status: cell(status), cells });
        }
        Ok(Self { header: header.iter().map(str::to_owned).collect(), rows })
    }

    /// A cell by the name of its column; empty if there is no such column.
    pub fn cell<'a>(&self, row: &'a StudyRow, column: &str) -> &'a str {
        let index = self.header.iter().position(|name| name == column);
        index.and_then(|index| row.cells.get(index)).map_or("", String::as_str)
    }

    /// A cell as a number, if it is one.
    pub fn number(&self, row: &StudyRow, column: &str) -> Option<f64> {
        self.cell(row, column).parse().ok().filter(|number: &f64| number.is_finite())
    }
}

impl StudyRow {
    /// Whether the case was computed to its end.
    pub fn is_done(&self) -> bool {
        self.status == "done"
    }
}
