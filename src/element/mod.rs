//! The finite element: an eight-node hexahedron with mean dilatation (Q1P0).
//!
//! `hex8` holds the kernels, `lanes` the eight-wide arithmetic they are written in.

pub mod hex8;
pub mod lanes;

#[cfg(test)]
mod tests;
