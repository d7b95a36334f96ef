//! `plots/*.svg`: what a run looks like, on a white card with dark text and colours that hold in print and for colour-blind readers.

mod contact_map;
mod curves;
mod style;

pub use contact_map::plot_contact;
pub use curves::{plot_forces, plot_indentation, plot_ratio};

use super::{ContactPoint, OutputDirectory, OutputError, StepRecord};
use crate::analytical::ElasticSphere;
use crate::analytical::olsson_larsson::Hardening;
use std::path::PathBuf;

/// What the plots show beside the computed curves, in the user's units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlotInputs {
    /// The sphere, for Hertz's curve.
    pub sphere: ElasticSphere,
    /// The law for Olsson & Larsson's curve; `None` where theirs has no counterpart.
    pub hardening: Option<Hardening>,
    /// Coulomb's coefficient for the line that F_T/F_N runs up to; `None` for full stick.
    pub friction: Option<f64>,
}

/// Writes every plot for which there is something to show and returns their paths: `indentation` from the pressing, `forces` and `ratio` from
/// the shear, `contact` from the points of one step.
pub fn write_plots(
    out: &OutputDirectory,
    history: &[StepRecord],
    contact: Option<&[ContactPoint]>,
    inputs: &PlotInputs,
) -> Result<Vec<PathBuf>, OutputError> {
    let mut written = Vec::new();
    let (pressing, shear) = curves::split(history);
    if !pressing.is_empty() {
        plot_indentation(&out.plot("indentation"), history, inputs)?;
        written.push(out.plot("indentation"));
    }
    if shear.len() > 1 {
        plot_forces(&out.plot("forces"), history)?;
        plot_ratio(&out.plot("ratio"), history, inputs.friction)?;
        written.extend([out.plot("forces"), out.plot("ratio")]);
    }
    if let Some(points) = contact.filter(|points| !points.is_empty()) {
        plot_contact(&out.plot("contact"), points)?;
        written.push(out.plot("contact"));
    }
    Ok(written)
}

#[cfg(test)]
mod tests;
