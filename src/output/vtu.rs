//! `fields/*.vtu` for ParaView, pyvista and meshio: VTK XML unstructured grids of hexahedra, and
//! the `.pvd` that lists them over time.
//!
//! Written here rather than by a crate: vtkio, the only candidate, has stood at a release candidate
//! since 2024 whose repository builds on a fork of quick-xml. The format is small: inline base64,
//! uncompressed, little-endian, 64-bit lengths.

use super::{OutputError, write_atomically};
use base64::Engine;
use base64::engine::general_purpose::STANDARD as BASE64;
use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesEnd, BytesStart, BytesText, Event};
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// VTK's number for a hexahedron.
const VTK_HEXAHEDRON: u8 = 12;

/// Points and hexahedra.
#[derive(Clone, Copy, Debug)]
pub struct Grid<'a> {
    /// Positions, in the user's units; the reference ones if a displacement goes with them.
    pub points: &'a [[f64; 3]],
    /// Eight points each, in VTK_HEXAHEDRON order.
    pub cells: &'a [[u32; 8]],
    /// The y at which the rest of the body is this part's mirror image, where it is only half of
    /// one: the file says so in a comment and in its field data.
    pub symmetry_plane: Option<f64>,
}

/// The numbers of a field.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Real numbers, kept to the bit.
    Real(Vec<f64>),
    /// Whole numbers, such as a status or a flag.
    Integer(Vec<i32>),
}

/// A named field on points or cells.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Name shown in ParaView.
    pub name: String,
    /// Numbers a point or cell: 1, 3 for a vector, 6 for a symmetric tensor in VTK's order xx, yy,
    /// zz, xy, yz, xz, 9 for a full one by rows.
    pub components: usize,
    /// `components` numbers for each point or cell in turn.
    pub values: Values,
}

impl Field {
    /// One real number each.
    pub fn scalar(name: &str, values: Vec<f64>) -> Self {
        Self { name: name.into(), components: 1, values: Values::Real(values) }
    }

    /// One whole number each.
    pub fn integer(name: &str, values: Vec<i32>) -> Self {
        Self { name: name.into(), components: 1, values: Values::Integer(values) }
    }

    /// A vector each.
    pub fn vector(name: &str, values: &[[f64; 3]]) -> Self {
        Self { name: name.into(), components: 3, values: Values::Real(values.as_flattened().to_vec()) }
    }

    /// A symmetric tensor each, xx, yy, zz, xy, yz, xz.
    pub fn symmetric_tensor(name: &str, values: &[[f64; 6]]) -> Self {
        Self { name: name.into(), components: 6, values: Values::Real(values.as_flattened().to_vec()) }
    }

    fn len(&self) -> usize {
        match &self.values {
            Values::Real(values) => values.len(),
            Values::Integer(values) => values.len(),
        }
    }
}

/// Writes a grid with its fields, whole or not at all. Fields whose length is not `components`
/// times the number of points or cells, and cells that name no point, are refused.
pub fn write_vtu(path: &Path, grid: &Grid, point_fields: &[Field], cell_fields: &[Field]) -> Result<(), OutputError> {
    check(grid, point_fields, cell_fields).map_err(|problem| OutputError::Inconsistent { path: path.to_path_buf(), problem })?;
    write_atomically(path, |out| {
        let mut xml = Xml::start(out, "UnstructuredGrid")?;
        xml.open("UnstructuredGrid", &[])?;
        if let Some(y) = grid.symmetry_plane {
            xml.comment(&format!(
                " Half of the body: the other half is its mirror image at y = {y}. Forces of this half are half of the whole. "
            ))?;
            xml.open("FieldData", &[])?;
            let attributes = [("NumberOfTuples", "1")];
            xml.array_with("Float64", "half_model_mirrored_at_y", 1, y.to_le_bytes(), &attributes)?;
            xml.close("FieldData")?;
        }
        let (points, cells) = (grid.points.len().to_string(), grid.cells.len().to_string());
        xml.open("Piece", &[("NumberOfPoints", &points), ("NumberOfCells", &cells)])?;
        xml.fields("PointData", point_fields)?;
        xml.fields("CellData", cell_fields)?;
        xml.open("Points", &[])?;
        xml.array("Float64", "Points", 3, grid.points.as_flattened().iter().flat_map(|x| x.to_le_bytes()))?;
        xml.close("Points")?;
        xml.open("Cells", &[])?;
        let connectivity = grid.cells.as_flattened().iter().flat_map(|&node| i64::from(node).to_le_bytes());
        xml.array("Int64", "connectivity", 1, connectivity)?;
        xml.array("Int64", "offsets", 1, (1..=grid.cells.len() as i64).flat_map(|cell| (8 * cell).to_le_bytes()))?;
        xml.array("UInt8", "types", 1, std::iter::repeat_n(VTK_HEXAHEDRON, grid.cells.len()))?;
        xml.close("Cells")?;
        xml.close("Piece")?;
        xml.close("UnstructuredGrid")?;
        xml.finish()
    })
}

fn check(grid: &Grid, point_fields: &[Field], cell_fields: &[Field]) -> Result<(), String> {
    if let Some(node) = grid.cells.as_flattened().iter().find(|&&node| node as usize >= grid.points.len()) {
        return Err(format!("a cell names point {node}, but there are {}", grid.points.len()));
    }
    let sized = point_fields.iter().map(|field| (field, grid.points.len(), "points"));
    for (field, count, what) in sized.chain(cell_fields.iter().map(|field| (field, grid.cells.len(), "cells"))) {
        if field.components == 0 || field.len() != field.components * count {
            let (name, components, len) = (&field.name, field.components, field.len());
            return Err(format!("field {name} has {len} numbers, not {components} for each of {count} {what}"));
        }
    }
    Ok(())
}

/// The XML writer with VTK's habits.
struct Xml<W: Write>(Writer<W>);

impl<W: Write> Xml<W> {
    fn start(out: W, kind: &str) -> io::Result<Self> {
        let mut xml = Self(Writer::new_with_indent(out, b' ', 1));
        xml.0.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
        let attributes = [("type", kind), ("version", "1.0"), ("byte_order", "LittleEndian"), ("header_type", "UInt64")];
        xml.open("VTKFile", &attributes)?;
        Ok(xml)
    }

    fn finish(mut self) -> io::Result<()> {
        self.close("VTKFile")?;
        self.0.get_mut().write_all(b"\n")
    }

    fn open(&mut self, tag: &str, attributes: &[(&str, &str)]) -> io::Result<()> {
        self.0.write_event(Event::Start(BytesStart::new(tag).with_attributes(attributes.iter().copied())))
    }

    fn empty(&mut self, tag: &str, attributes: &[(&str, &str)]) -> io::Result<()> {
        self.0.write_event(Event::Empty(BytesStart::new(tag).with_attributes(attributes.iter().copied())))
    }

    fn comment(&mut self, text: &str) -> io::Result<()> {
        self.0.write_event(Event::Comment(BytesText::from_escaped(text)))
    }

    fn close(&mut self, tag: &str) -> io::Result<()> {
        self.0.write_event(Event::End(BytesEnd::new(tag)))
    }

    fn fields(&mut self, tag: &str, fields: &[Field]) -> io::Result<()> {
        self.open(tag, &[])?;
        for field in fields {
            match &field.values {
                Values::Real(values) => {
                    self.array("Float64", &field.name, field.components, values.iter().flat_map(|x| x.to_le_bytes()))?;
                }
                Values::Integer(values) => {
                    self.array("Int32", &field.name, field.components, values.iter().flat_map(|x| x.to_le_bytes()))?;
                }
            }
        }
        self.close(tag)
    }

    /// One inline array: the number of bytes and the bytes, as one base64 block.
    fn array(&mut self, kind: &str, name: &str, components: usize, bytes: impl IntoIterator<Item = u8>) -> io::Result<()> {
        self.array_with(kind, name, components, bytes, &[])
    }

    /// The same with more attributes.
    fn array_with(
        &mut self,
        kind: &str,
        name: &str,
        components: usize,
        bytes: impl IntoIterator<Item = u8>,
        more: &[(&str, &str)],
    ) -> io::Result<()> {
        let mut block = vec![0; 8];
        block.extend(bytes);
        let length = (block.len() - 8) as u64;
        block[..8].copy_from_slice(&length.to_le_bytes());
        let components = components.to_string();
        let attributes = [("type", kind), ("Name", name), ("NumberOfComponents", &components), ("format", "binary")];
        self.open("DataArray", &[&attributes, more].concat())?;
        self.0.write_event(Event::Text(BytesText::from_escaped(BASE64.encode(&block))))?;
        self.close("DataArray")
    }
}

/// A `.pvd`: files over a pseudo-time, which is what the writer says: the length of the path
/// behind. Rewritten whole with every file, so that it can be opened while the run goes on.
#[derive(Clone, Debug, PartialEq)]
pub struct Collection {
    path: PathBuf,
    entries: Vec<(f64, String)>,
}

impl Collection {
    /// An empty collection; nothing is written before the first file.
    pub fn new(path: &Path) -> Self {
        Self { path: path.to_path_buf(), entries: Vec::new() }
    }

    /// The collection of the files that a run had written when it was interrupted: whatever stands
    /// there is replaced by it.
    pub fn resume(path: &Path, files: impl Iterator<Item = (f64, PathBuf)>) -> Result<Self, OutputError> {
        let mut collection = Self::new(path);
        collection.entries.extend(files.map(|(time, file)| (time, file_name(&file))));
        match (collection.entries.is_empty(), fs::remove_file(path)) {
            (false, _) => collection.write()?,
            (true, Err(error)) if error.kind() != io::ErrorKind::NotFound => return Err(OutputError::writing(path)(error)),
            (true, _) => {}
        }
        Ok(collection)
    }

    /// Adds a file and writes the collection; the file has to lie in the collection's folder.
    pub fn push(&mut self, time: f64, file: &Path) -> Result<(), OutputError> {
        self.entries.push((time, file_name(file)));
        self.write()
    }

    fn write(&self) -> Result<(), OutputError> {
        write_atomically(&self.path, |out| {
            let mut xml = Xml::start(out, "Collection")?;
            xml.open("Collection", &[])?;
            for (time, name) in &self.entries {
                xml.empty("DataSet", &[("timestep", &time.to_string()), ("part", "0"), ("file", name)])?;
            }
            xml.close("Collection")?;
            xml.finish()
        })
    }
}

fn file_name(file: &Path) -> String {
    file.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use quick_xml::{Reader, XmlVersion};

    const CUBE: [[f64; 3]; 8] = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [1.0, 0.0, 1.0],
        [1.0, 1.0, 1.0],
        [0.0, 1.0, 1.0],
    ];
    const CELLS: [[u32; 8]; 1] = [[0, 1, 2, 3, 4, 5, 6, 7]];

    #[test]
    fn arrays_decode_to_what_was_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("fields/step_0001.vtu");
        let pressure: Vec<f64> = (0..8).map(|i| 1.0 / (1.0 + i as f64)).collect();
        let grid = Grid { points: &CUBE, cells: &CELLS, symmetry_plane: Some(0.0) };
        write_vtu(&path, &grid, &[Field::scalar("p < q & \"r\"", pressure.clone())], &[Field::integer("plastic", vec![1])])
            .unwrap();
        let text = fs::read_to_string(&path).unwrap();
        let mut reader = Reader::from_str(&text);
        let (mut name, mut arrays) = (String::new(), Vec::new());
        loop {
            match reader.read_event().unwrap() {
                Event::Eof => break,
                Event::Start(tag) if tag.name().as_ref() == "DataArray" => {
                    name = tag
                        .try_get_attribute("Name")
                        .unwrap()
                        .unwrap()
                        .normalized_value(XmlVersion::Explicit1_0)
                        .unwrap()
                        .into_owned();
                }
                Event::Text(value) if !value.trim_ascii().is_empty() => {
                    arrays.push((name.clone(), BASE64.decode(value.trim_ascii()).unwrap()));
                }
                _ => {}
            }
        }
        let names: Vec<&str> = arrays.iter().map(|array| array.0.as_str()).collect();
        let field_data = "half_model_mirrored_at_y";
        assert_eq!(names, [field_data, "p < q & \"r\"", "plastic", "Points", "connectivity", "offsets", "types"]);
        assert!(text.contains("<!-- Half of the body: ") && text.contains("mirror image at y = 0."), "{text}");
        // A body that is whole says nothing of the kind.
        write_vtu(&path, &Grid { symmetry_plane: None, ..grid }, &[], &[]).unwrap();
        assert!(!fs::read_to_string(&path).unwrap().contains("alf"));
        for (_, block) in &arrays {
            assert_eq!(u64::from_le_bytes(block[..8].try_into().unwrap()) as usize, block.len() - 8);
        }
        let decoded: Vec<f64> = arrays[1].1[8..].chunks(8).map(|bytes| f64::from_le_bytes(bytes.try_into().unwrap())).collect();
        assert_eq!(decoded, pressure);
        assert_eq!(arrays[6].1[8..], [12]);
    }

    #[test]
    fn wrong_sizes_are_refused_and_leave_no_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("step.vtu");
        let grid = Grid { points: &CUBE, cells: &CELLS, symmetry_plane: None };
        let error = write_vtu(&path, &grid, &[Field::scalar("gap", vec![0.0; 7])], &[]).unwrap_err().to_string();
        assert!(error.contains("gap has 7 numbers, not 1 for each of 8 points"), "{error}");
        let error = write_vtu(&path, &grid, &[], &[Field::symmetric_tensor("stress", &[])]).unwrap_err().to_string();
        assert!(error.contains("1 cells"), "{error}");
        let wild = [[0, 1, 2, 3, 4, 5, 6, 8]];
        assert!(write_vtu(&path, &Grid { cells: &wild, ..grid }, &[], &[]).is_err());
        assert!(!path.exists());
    }

    #[test]
    fn a_collection_grows_and_resumes() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("fields/case.pvd");
        let mut collection = Collection::new(&path);
        for step in 1..=3 {
            collection.push(0.1 * step as f64, &folder.path().join(format!("fields/step_{step:04}.vtu"))).unwrap();
        }
        let whole = fs::read_to_string(&path).unwrap();
        let files = || (1..=3).map(|step| (0.1 * step as f64, folder.path().join(format!("fields/step_{step:04}.vtu"))));
        let mut resumed = Collection::resume(&path, files().take(2)).unwrap();
        assert_eq!(resumed.entries, [(0.1, "step_0001.vtu".to_owned()), (0.2, "step_0002.vtu".to_owned())]);
        assert_eq!(fs::read_to_string(&path).unwrap().matches("<DataSet ").count(), 2);
        let (time, file) = files().next_back().unwrap();
        resumed.push(time, &file).unwrap();
        assert_eq!((&resumed, fs::read_to_string(&path).unwrap()), (&collection, whole));
        // Nothing was written yet, whatever stands there.
        assert!(Collection::resume(&path, files().take(0)).unwrap().entries.is_empty());
        assert!(!path.exists());
        assert!(Collection::resume(&path, files().take(0)).is_ok());
    }
}
