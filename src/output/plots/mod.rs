//! `plots/*`: what a run looks like, on a white card with dark text and colours that hold in print
//! and for colour-blind readers.
//!
//! `canvas` writes SVG, `text` and `field` help it; `style` is the card, the colours and the
//! writing of numbers; `sheet` is the size on paper, `axes` the units; `chart` draws any diagram;
//! the others are the pictures of a run. A picture is drawn into a [`Picture`] first and then
//! written, by `print` also as PDF or PNG.

pub mod axes;
pub mod canvas;
pub mod chart;
pub mod sheet;
pub mod style;

mod contact_map;
mod curves;
mod field;
mod inputs;
mod overlay;
mod pressure;
mod print;
mod replot;
mod segments;
mod text;
mod turning;

pub use super::tables::{SlipPanel, Tables};
pub use contact_map::{plot_contact, plot_slip, plot_slip_frame};
pub use curves::{from_zero, greatest, plot_forces, plot_indentation, plot_law, plot_ratio, plot_stick};
pub use overlay::{OverlaidRun, plot_overlay};
pub use pressure::plot_pressure;
pub use replot::replot;
pub use sheet::Sheet;
pub use style::Picture;
pub use turning::{plot_moments, plot_plane};

use self::axes::{Axes, AxisUnits};
use super::{OutputDirectory, OutputError, StepRecord};
use crate::analytical::ElasticSphere;
use crate::analytical::olsson_larsson::OlssonLarssonHardening;
use crate::case::{Case, PictureFormat};
use std::path::PathBuf;

/// What the plots show beside the computed curves, in the user's units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlotInputs {
    /// The sphere, for Hertz's curve; against a rigid sphere that of radius R*.
    pub sphere: ElasticSphere,
    /// The law for Olsson & Larsson's curve; `None` where theirs has no counterpart.
    pub hardening: Option<OlssonLarssonHardening>,
    /// Coulomb's coefficient for the line that F_T/F_N runs up to; `None` for full stick.
    pub friction: Option<f64>,
    /// Bodies that deform (see [`crate::case::Case::bodies`]): closed forms are of one of them,
    /// over a plane.
    pub bodies: f64,
}

/// How pictures are made, whatever they show.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// The units of axes.
    pub axes: Axes,
    /// The width.
    pub sheet: Sheet,
}

impl View {
    /// As the case has it.
    pub fn of(case: &Case) -> Self {
        Self { axes: Axes::of(case, AxisUnits::Auto), sheet: Sheet { width: case.output.plot_width, untitled: false } }
    }
}

/// Most panels of the stick/slip picture.
const PANELS: usize = 6;

/// Up to `count` items, evenly over their numbers, the first and the last among them.
fn spread<T: Clone>(items: &[T], count: usize) -> Vec<T> {
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
    let (pressing, shear) = super::tables::split(history);
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
    let [across, turns] = turning::is_needed(history);
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

#[cfg(test)]
mod tests;
