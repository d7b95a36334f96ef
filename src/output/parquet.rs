//! `history.parquet`: the rows of `history.csv` for programs that read columns. Counts are 64-bit
//! integers, everything else is double.

use std::path::Path;

use super::{OutputError, StepRecord};

/// Writes the rows, whole or not at all.
///
/// # Errors
/// [`OutputError::Write`]; [`OutputError::Format`] in a program without the feature `parquet`.
pub fn write_parquet(path: &Path, rows: &[StepRecord]) -> Result<(), OutputError> {
    let bytes = encode(rows).map_err(|problem| OutputError::Format { path: path.to_owned(), problem })?;
    super::write_atomically(path, |out| out.write_all(&bytes))
}

#[cfg(not(feature = "parquet"))]
fn encode(_rows: &[StepRecord]) -> Result<Vec<u8>, String> {
    Err("this program was built without the feature \"parquet\"; leave out output.parquet".to_owned())
}

#[cfg(feature = "parquet")]
fn encode(rows: &[StepRecord]) -> Result<Vec<u8>, String> {
    use std::sync::Arc;

    use parquet::data_type::{DoubleType, Int64Type};
    use parquet::file::properties::WriterProperties;
    use parquet::file::writer::SerializedFileWriter;
    use parquet::schema::parser::parse_message_type;
    let values = |row: &StepRecord| serde_json::to_value(row).map_err(|error| error.to_string());
    let kinds = values(&StepRecord::default())?;
    let table = rows.iter().map(values).collect::<Result<Vec<_>, _>>()?;
    // The columns of the CSV, by the names that the record itself has.
    let columns: Vec<(String, bool)> = super::history_columns()
        .into_iter()
        .map(|name| {
            let whole = kinds[&name].is_u64();
            (name, whole)
        })
        .collect();
    let fields: Vec<String> =
        columns.iter().map(|(name, whole)| format!("required {} {name};", if *whole { "int64" } else { "double" })).collect();
    let written = || -> parquet::errors::Result<Vec<u8>> {
        let schema = Arc::new(parse_message_type(&format!("message history {{ {} }}", fields.join(" ")))?);
        let mut writer = SerializedFileWriter::new(Vec::new(), schema, Arc::new(WriterProperties::default()))?;
        let mut group = writer.next_row_group()?;
        for (name, whole) in &columns {
            let Some(mut column) = group.next_column()? else { break };
            if *whole {
                let values: Vec<i64> = table.iter().map(|row| row[name].as_i64().unwrap_or_default()).collect();
                column.typed::<Int64Type>().write_batch(&values, None, None)?;
            } else {
                let values: Vec<f64> = table.iter().map(|row| row[name].as_f64().unwrap_or(f64::NAN)).collect();
                column.typed::<DoubleType>().write_batch(&values, None, None)?;
            }
            column.close()?;
        }
        group.close()?;
        writer.into_inner()
    };
    written().map_err(|error| error.to_string())
}

#[cfg(all(test, feature = "parquet"))]
mod tests {
    use super::*;

    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::Field;

    #[test]
    fn every_column_comes_back_to_the_bit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("history.parquet");
        let rows: Vec<StepRecord> = (1..=5)
            .map(|step| StepRecord {
                step,
                f_n: 0.1 * step as f64,
                f_t: -f64::MIN_POSITIVE,
                h: 1.0 / 3.0,
                ..StepRecord::default()
            })
            .collect();
        write_parquet(&path, &rows).unwrap();
        let reader = SerializedFileReader::new(std::fs::File::open(&path).unwrap()).unwrap();
        let read: Vec<_> = reader.get_row_iter(None).unwrap().map(Result::unwrap).collect();
        assert_eq!(read.len(), 5);
        let names: Vec<String> = read[0].get_column_iter().map(|(name, _)| name.clone()).collect();
        assert_eq!(names, super::super::history_columns());
        for (row, step) in read.iter().zip(&rows) {
            let of = |name: &str| row.get_column_iter().find(|(column, _)| *column == name).unwrap().1.clone();
            assert_eq!(of("step"), Field::Long(step.step as i64));
            for (name, value) in [("F_N", step.f_n), ("F_T", step.f_t), ("h", step.h)] {
                assert_eq!(of(name), Field::Double(value));
            }
        }
        // A run that ended before its first step.
        write_parquet(&path, &[]).unwrap();
        let empty = SerializedFileReader::new(std::fs::File::open(&path).unwrap()).unwrap();
        assert_eq!(empty.metadata().file_metadata().num_rows(), 0);
    }
}
