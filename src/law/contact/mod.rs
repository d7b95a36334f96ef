//! The law as an incremental update of one contact, the form in which a discrete-element code calls it.
mod material;
mod update;
mod virgin;

pub use update::{ContactResponse, ContactState};
pub use virgin::{Axial, COLUMNS, ContactError, ContactParameters, KNOTS, SLIDERS};

#[cfg(test)]
mod tests;
