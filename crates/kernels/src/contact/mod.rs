//! Contact of the sphere's surface points with the rigid plane z = 0.
//!
//! `plane` says how far a point is from the plane and how far it has slid; `coulomb` turns that and the internal force on the point into
//! the residual and the linearised rows of the contact conditions.

pub mod coulomb;
pub mod mortar;
pub mod pair;
pub mod plane;

#[cfg(test)]
mod tests;
