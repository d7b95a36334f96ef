//! The finite element: an eight-node hexahedron with mean dilatation (Q1P0).
//!
//! `hex8` holds the kernels, written in the eight-wide arithmetic of [`lanes`].

pub mod hex8;

pub use crate::lanes;

#[cfg(test)]
mod tests;
