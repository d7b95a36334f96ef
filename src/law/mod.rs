//! From simulations to a contact law that needs axisymmetric data only.
//!
//! A law is of one of three kinds, a room each: `formulas` with constants that are fitted to a
//! study, a `table` of one contact as curves in h, and what is `interpolated` between the contacts
//! of a large study, which makes such a table for any material. [`LawFile`] is any of them. Each
//! ends in the parameters of the update of [`contact_law`](crate::contact_law): `export` writes
//! them for other programs, `check` holds the update against simulated paths, `plots` draws.
//!
//! What the rooms share: `variables` are the normalised quantities in which contacts of different
//! materials fall together; `study_table` and `data` read a study back, `folds` are those of a
//! cross-validation, `report` is what a fit says of itself; `range` is where a law holds; `json`
//! and `bounds` are how a law is kept in a file and checked.

pub mod check;
pub mod data;
pub mod export;
pub mod file;
pub mod formulas;
pub mod interpolated;
#[cfg(feature = "plots")]
pub mod plots;
pub mod range;
pub mod report;
pub mod study_table;
pub mod table;
pub mod variables;

mod bounds;
mod error;
mod folds;
mod json;

pub use error::LawError;
pub use file::LawFile;
pub use formulas::model::{Axisymmetric, Law, Parameters};
