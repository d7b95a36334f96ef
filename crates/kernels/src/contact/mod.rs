//! Contact of the body's surface points with the rigid plane z = 0, with a rigid sphere, with the
//! body's own image, or with another body that deforms.
//!
//! `plane` says how far a point is from the plane and how far it has slid, `rigid` the same of a
//! sphere, and `pair` and `couple` of the image and of another body, each with its mortar (over
//! `polygon`s) and what `interface` has for both; `coulomb` turns that and the internal force on
//! the point into the residual and the linearised rows of the contact conditions.

pub mod coulomb;
pub mod couple;
pub mod frame;
pub mod interface;
pub mod inversion;
pub mod mortar;
pub mod pair;
pub mod plane;
mod polygon;
pub mod rigid;

#[cfg(test)]
mod tests;
