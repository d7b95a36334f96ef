//! `contact/step_0020.csv`: the contact surface of one step, a row a node, in the user's units.

use super::history::row_problem;
use super::{OutputError, write_atomically};
use crate::bounded;
use serde::{Deserialize, Serialize};
use std::io;
use std::path::Path;

/// What a point of the surface does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ContactStatus {
    /// Not in contact.
    Open,
    /// In contact, not moving along the plane.
    Stick,
    /// In contact, sliding along the plane.
    Slip,
}

/// One node of the surface that can touch the plane.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ContactPoint {
    /// Number of the mesh node.
    pub point: usize,
    /// Reference position X, along the shear.
    #[serde(rename = "X")]
    pub reference_x: f64,
    /// Reference position Y, across it; the symmetry plane is Y = 0.
    #[serde(rename = "Y")]
    pub reference_y: f64,
    /// Current position x.
    #[serde(rename = "x")]
    pub current_x: f64,
    /// Current position y.
    #[serde(rename = "y")]
    pub current_y: f64,
    /// Distance from the plane.
    pub gap: f64,
    /// Contact pressure, force over `area`, compression positive.
    pub pressure: f64,
    /// Shear traction on the sphere along x.
    pub traction_x: f64,
    /// Shear traction on the sphere along y.
    pub traction_y: f64,
    /// Area that the node stands for, on the meshed half.
    pub area: f64,
    /// What it does.
    pub status: ContactStatus,
}

/// Writes the table; header only if there are no points.
pub fn write_contact(path: &Path, points: &[ContactPoint]) -> Result<(), OutputError> {
    write_atomically(path, |out| {
        let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(out);
        let header = ["point", "X", "Y", "x", "y", "gap", "pressure", "traction_x", "traction_y", "area", "status"];
        writer.write_record(header).map_err(io::Error::other)?;
        for point in points {
            writer.serialize(point).map_err(io::Error::other)?;
        }
        writer.flush()
    })
}

/// Reads the table back; errors name the line and the column.
pub fn read_contact(path: &Path) -> Result<Vec<ContactPoint>, OutputError> {
    let text = bounded::read_to_string(path, bounded::RESULT).map_err(OutputError::reading(path))?;
    let malformed = |(line, problem): (u64, String)| OutputError::Malformed { path: path.to_path_buf(), line, problem };
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let columns = reader.headers().map_err(|error| malformed((1, error.to_string())))?.clone();
    reader.deserialize().map(|row| row.map_err(|error| malformed(row_problem(&error, &columns)))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn point(point: usize, status: ContactStatus) -> ContactPoint {
        ContactPoint {
            point,
            reference_x: 0.1,
            reference_y: 1.0 / 3.0,
            current_x: 0.11,
            current_y: 0.33,
            gap: 1e-17,
            pressure: 1087.25,
            traction_x: -300.0,
            traction_y: 2.5,
            area: 1.25e-4,
            status,
        }
    }

    #[test]
    fn round_trip_to_the_bit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("contact/step_0003.csv");
        let points = vec![point(7, ContactStatus::Open), point(8, ContactStatus::Stick), point(12, ContactStatus::Slip)];
        write_contact(&path, &points).unwrap();
        assert_eq!(read_contact(&path).unwrap(), points);
        let text = fs::read_to_string(&path).unwrap();
        assert!(text.starts_with("point,X,Y,x,y,gap,pressure,traction_x,traction_y,area,status\n7,0.1,"), "{text}");
        assert!(text.contains(",stick\n") && text.trim_end().ends_with(",slip"));
        write_contact(&path, &[]).unwrap();
        assert!(read_contact(&path).unwrap().is_empty());
    }

    #[test]
    fn an_unknown_status_is_named_with_its_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("step.csv");
        write_contact(&path, &[point(1, ContactStatus::Stick)]).unwrap();
        let text = fs::read_to_string(&path).unwrap().replace("stick", "glue");
        fs::write(&path, text).unwrap();
        let error = read_contact(&path).unwrap_err().to_string();
        assert!(error.contains("line 2") && error.contains("glue"), "{error}");
    }
}
