//! The program's pictures.

use std::path::PathBuf;
use std::str::FromStr;

use asperity::case::{Case, PictureFormat, PictureWidth};
use asperity::contact_law::path::PathPoint;
use asperity::law::plots::as_step;
use asperity::output::StepRecord;
use asperity::output::plots::{Picture, PlotInputs, Sheet, View, plot_forces, plot_indentation, plot_ratio};
use pyo3::prelude::*;

use crate::errors::{failed, refused};

/// A picture as an SVG, with what it shows.
#[pyclass(name = "NativePicture", frozen)]
pub struct NativePicture {
    picture: Picture,
}

#[pymethods]
impl NativePicture {
    fn name(&self) -> &'static str {
        self.picture.name
    }

    fn caption(&self) -> &str {
        &self.picture.caption
    }

    fn svg(&self) -> &str {
        &self.picture.svg
    }

    /// Writes a file of the format that its name ends with.
    fn save(&self, file: PathBuf) -> PyResult<()> {
        let wrong = || refused(format!("file: is {:?}. Allowed: a name that ends with .svg, .pdf or .png", file.display()));
        let format = PictureFormat::of_file(&file).ok_or_else(wrong)?;
        self.picture.write(&file, format).map_err(failed)
    }
}

/// How a case is drawn.
pub fn view(case: &Case, width: Option<&str>, title: bool) -> PyResult<View> {
    let width = match width {
        None => case.output.plot_width,
        Some(text) => {
            let of = |what| refused(format!("width: is {text:?}, {what}. Allowed: as 85mm, 3.3in or 640px"));
            Some(PictureWidth::from_str(text).map_err(of)?)
        }
    };
    Ok(View { sheet: Sheet { width, untitled: !title }, ..View::of(case) })
}

/// The one of this name; without one the first that there is of `FIRST`.
pub fn chosen(mut pictures: Vec<Picture>, name: Option<&str>) -> PyResult<NativePicture> {
    const FIRST: [&str; 5] = ["law", "forces", "plane", "moments", "indentation"];
    let at = |name: &str| pictures.iter().position(|picture| picture.name == name);
    let index = match name {
        Some(name) => at(name).ok_or_else(|| {
            let names: Vec<String> = pictures.iter().map(|picture| format!("{:?}", picture.name)).collect();
            refused(format!("name: is {name:?}. Allowed: {}", names.join(", ")))
        })?,
        None => FIRST.into_iter().find_map(at).ok_or_else(|| failed("there is nothing to draw yet"))?,
    };
    Ok(NativePicture { picture: pictures.swap_remove(index) })
}

/// A picture of what a law predicts along the path of a case.
pub fn law_picture(
    points: &[PathPoint],
    case: &Case,
    name: Option<&str>,
    width: Option<&str>,
    title: bool,
) -> PyResult<NativePicture> {
    let view = view(case, width, title)?;
    let history: Vec<StepRecord> = points.iter().map(as_step).collect();
    let inputs = PlotInputs::of(case);
    let mut pictures = vec![plot_indentation(&history, &inputs, &view).map_err(failed)?];
    if history.iter().any(|record| record.delta_t != 0.0) {
        pictures.push(plot_forces(&history, &view).map_err(failed)?);
        pictures.push(plot_ratio(&history, inputs.friction, &view).map_err(failed)?);
    }
    chosen(pictures, name)
}

/// The program `asperity`, called with these arguments, the file of the script first; its exit
/// code.
#[pyfunction]
pub fn program(arguments: Vec<std::ffi::OsString>) -> u8 {
    asperity::internals::cli::main_within(arguments)
}
