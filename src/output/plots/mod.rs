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
mod run;
mod segments;
mod text;
mod turning;
mod view;

pub use super::tables::{SlipPanel, Tables};
pub use contact_map::{plot_contact, plot_slip, plot_slip_frame};
pub use curves::{from_zero, greatest, plot_forces, plot_indentation, plot_law, plot_ratio, plot_stick};
pub use inputs::PlotInputs;
pub use overlay::{OverlaidRun, plot_overlay};
pub use pressure::plot_pressure;
pub use replot::replot;
pub use run::{run_pictures, write_plots};
pub use sheet::Sheet;
pub use style::Picture;
pub use turning::{plot_moments, plot_plane};
pub use view::View;

#[cfg(test)]
mod tests;
