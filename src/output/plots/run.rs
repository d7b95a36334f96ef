//! The pictures of a run.

use super::contact_map::{plot_contact, plot_slip};
use super::curves::{plot_forces, plot_indentation, plot_ratio, plot_stick};
use super::inputs::PlotInputs;
use super::pressure::plot_pressure;
use super::style::Picture;
use super::turning::{is_needed, plot_moments, plot_plane};
use super::view::View;
use crate::case::PictureFormat;
use crate::output::tables::{Tables, split};
use crate::output::{OutputDirectory, OutputError, StepRecord};
use std::path::PathBuf;

/// Most panels of the stick/slip picture.
pub(super) const PANELS: usize = 6;

/// Up to `count` items, evenly over their numbers, the first and the last among them.
pub(super) fn spread<T: Clone>(items: &[T], count: usize) -> Vec<T> {
    if items.len() <= count {
        return items.to_vec();
    }
    (0..count).map(|i| items[i * (items.len() - 1) / (count - 1)].clone()).collect()
}

/// Every picture for which there is something to show: `indentation` and `pressure` of the press,
/// `forces`, `ratio`, `stick` and `slip` of the shear along x, `plane` of one across it, `moments`
/// of what turns, `contact` of the last step in contact.
///
/// # Errors
/// A drawing fails.
pub fn run_pictures(
    history: &[StepRecord],
    tables: &Tables,
    inputs: &PlotInputs,
    view: &View,
) -> Result<Vec<Picture>, OutputError> {
    let mut pictures = Vec::new();
    let (pressing, shear) = split(history);
    if !pressing.is_empty() {
        pictures.push(plot_indentation(history, inputs, view)?);
    }
    if let Some((record, points)) = &tables.pressed {
        pictures.push(plot_pressure(points, record, inputs, view)?);
    }
    if shear.len() > 1 {
        let friction = inputs.friction;
        pictures.extend([
            plot_forces(history, view)?,
            plot_ratio(history, friction, view)?,
            plot_stick(history, friction, view)?,
        ]);
    }
    let [across, turns] = is_needed(history);
    if across {
        pictures.push(plot_plane(history, inputs.friction, view)?);
    }
    if turns {
        pictures.push(plot_moments(history, view)?);
    }
    if !tables.shear.is_empty() {
        pictures.push(plot_slip(&spread(&tables.shear, PANELS), view)?);
    }
    if !tables.last.is_empty() {
        pictures.push(plot_contact(&tables.last, view)?);
    }
    Ok(pictures)
}

/// Draws and writes [`run_pictures`] and returns their paths.
///
/// # Errors
/// A drawing fails, or the place cannot be written.
pub fn write_plots(
    out: &OutputDirectory,
    history: &[StepRecord],
    tables: &Tables,
    inputs: &PlotInputs,
    view: &View,
    format: PictureFormat,
) -> Result<Vec<PathBuf>, OutputError> {
    let pictures = run_pictures(history, tables, inputs, view)?;
    pictures
        .iter()
        .map(|picture| {
            let path = out.plot(picture.name, format);
            picture.write(&path, format)?;
            Ok(path)
        })
        .collect()
}
