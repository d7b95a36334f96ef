//! From simulations to a contact law that needs axisymmetric data only.
//!
//! `variables` are the normalised quantities in which contacts of different materials fall
//! together; `data` reads a study back; `forms` and `normal` are the correlations; `prior` is what a
//! small study may take from a bigger one; `fit` determines their constants and makes of them a
//! [`Law`] (`model`, `law.json`), whose errors are cross-validated;
//! `predict` applies it to a case; `contact_parameters` makes of it what the update of
//! [`contact_law`](crate::contact_law) needs, and `export` writes both for other programs.
//! `least_squares` and `report` serve them.
//!
//! `tabulated` is the law of one material and one friction as curves in h, `interpolated` makes
//! such a table for any material between those of a study; `file` takes any kind; `check` holds the
//! update against simulated paths.

pub mod check;
pub mod data;
pub mod elastic;
pub mod export;
pub mod file;
pub mod fit;
pub mod forms;
pub mod interpolated;
pub mod model;
pub mod normal;
#[cfg(feature = "plots")]
pub mod plots;
pub mod predict;
pub mod prior;
pub mod report;
pub mod table;
pub mod tabulated;
pub mod variables;

mod baseline;
mod bounds;
mod contact_parameters;
mod error;
mod family;
mod folds;
mod formulas;
mod json;
mod least_squares;
mod own_fit;

#[cfg(test)]
mod tests;

pub use error::LawError;
pub use file::LawFile;
pub use model::{Axisymmetric, Law, Parameters};
