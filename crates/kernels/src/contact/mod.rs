//! Contact of the body's surface points with a rigid plane or sphere, with the body's own image, or
//! with another body that deforms.
//!
//! `rigid` says how far a point is from a rigid surface, and in which frame it slides along it;
//! `pair` and `couple` the same of the image and of another body, each with its mortar (over
//! `polygon`s) and what `interface` has for both; `coulomb` turns that and the internal force on
//! the point into the residual and the linearised rows of the contact conditions.

pub mod coulomb;
pub mod couple;
pub mod frame;
pub mod interface;
pub mod inversion;
pub mod maps;
pub mod mortar;
pub mod pair;
mod pair_maps;
mod polygon;
pub mod rigid;

#[cfg(test)]
mod tests;
