//! `contact/step_0020.csv`: the contact surface of one step, in the user's units.
//!
//! The table holds the whole contact: a node on the symmetry plane once, with the area that it has
//! on both halves, every other node twice, as it was computed and, after all of those, mirrored.
//! Where all of the sphere is meshed, every node stands there once.
//! Sums over all rows are therefore of the whole sphere: F_N of pressure times area, -F_T of
//! traction_x times area.

use super::contact_point::ContactPoint;
use super::finite::none_in_point;
use super::history::read_rows;
use super::{OutputError, write_atomically};
use crate::bounded;
use std::io;
use std::path::Path;

/// The columns, in this order.
const COLUMNS: [&str; 12] =
    ["point", "X", "Y", "x", "y", "gap", "pressure", "traction_x", "traction_y", "area", "status", "half"];

/// Writes the table; header only if there are no points.
pub fn write_contact(path: &Path, points: &[ContactPoint]) -> Result<(), OutputError> {
    write_atomically(path, |out| {
        let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(out);
        writer.write_record(COLUMNS).map_err(io::Error::other)?;
        for point in points {
            writer.serialize(point).map_err(io::Error::other)?;
        }
        writer.flush()
    })
}

/// Reads the table back; errors name the line and the column. Columns that are not its own are left
/// out.
pub fn read_contact(path: &Path) -> Result<Vec<ContactPoint>, OutputError> {
    let text = bounded::result_to_string(path, bounded::RESULT).map_err(OutputError::reading(path))?;
    let malformed = |(line, problem): (u64, String)| OutputError::Malformed { path: path.to_path_buf(), line, problem };
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let columns = reader.headers().map_err(|error| malformed((1, error.to_string())))?.clone();
    if let Some(missing) = COLUMNS.iter().find(|&&name| !columns.iter().any(|column| column == name)) {
        // Without `half` it is a table of the meshed half alone, whose sums are half of the forces.
        return Err(malformed((1, format!("no column {missing}: a table of another version; run the case again"))));
    }
    read_rows(&mut reader, &columns, none_in_point).map_err(malformed)
}

#[cfg(test)]
mod tests {
    use super::super::contact_point::{ContactStatus, Half};
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
            half: Half::Meshed,
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
        assert!(text.starts_with("point,X,Y,x,y,gap,pressure,traction_x,traction_y,area,status,half\n7,0.1,"), "{text}");
        assert!(text.contains(",stick,meshed\n") && text.trim_end().ends_with(",slip,meshed"));
        write_contact(&path, &[]).unwrap();
        assert!(read_contact(&path).unwrap().is_empty());
    }

    #[test]
    fn the_whole_has_an_image_of_every_point_beside_the_symmetry_plane() {
        let beside = ContactPoint { traction_y: 0.0, ..point(7, ContactStatus::Slip) };
        let on = ContactPoint { reference_y: 0.0, current_y: 0.0, half: Half::Both, ..point(8, ContactStatus::Stick) };
        let whole = ContactPoint::whole(vec![beside.clone(), on.clone(), point(9, ContactStatus::Open)]);
        let rows: Vec<(usize, Half)> = whole.iter().map(|p| (p.point, p.half)).collect();
        let (meshed, mirrored) = (Half::Meshed, Half::Mirrored);
        assert_eq!(rows, [(7, meshed), (8, Half::Both), (9, meshed), (7, mirrored), (9, mirrored)]);
        assert_eq!(whole[..2], [beside.clone(), on]);
        let image = ContactPoint { reference_y: -1.0 / 3.0, current_y: -0.33, half: mirrored, ..beside };
        assert_eq!(whole[3], image);
        assert!(whole[3].traction_y.is_sign_positive());
        assert_eq!((whole[4].traction_y, whole[4].traction_x), (-2.5, -300.0));
    }

    #[test]
    fn a_table_of_half_a_contact_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("step.csv");
        fs::write(&path, "point,X,Y,x,y,gap,pressure,traction_x,traction_y,area,status\n").unwrap();
        let error = read_contact(&path).unwrap_err().to_string();
        assert!(error.contains("line 1") && error.contains("no column half") && error.contains("run the case again"), "{error}");
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
