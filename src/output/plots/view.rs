//! Units and size of pictures.

use super::axes::{Axes, AxisUnits};
use super::sheet::Sheet;
use crate::case::Case;

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
