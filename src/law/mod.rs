//! From simulations to a contact law that needs axisymmetric data only.
//!
//! `variables` are the normalised quantities in which contacts of different materials fall together.

pub mod contact;
pub mod model;
pub mod variables;
