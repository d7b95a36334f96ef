//! The law as formulas for all materials: those of the paper's study, with constants that are
//! fitted to a study.
//!
//! `shear` has the correlations of a shear, `normal` those of F_N0 and a0, with the elastic
//! sphere's own force in `elastic`; `fit` determines their constants by `least_squares` and makes
//! of them a [`Law`](model::Law) (`law.json`; `family` knows the words of earlier versions), beside
//! what `baseline` and each case's `own_fit` have; `prior` is what a small study may take from a
//! bigger one. `predict` applies a law to a case, `contact_parameters` makes of it what the update
//! needs, and `text` writes it out.

pub mod elastic;
pub mod fit;
pub mod model;
pub mod normal;
pub mod predict;
pub mod prior;
pub mod shear;

mod baseline;
pub(super) mod contact_parameters;
mod family;
mod least_squares;
pub(super) mod own_fit;
mod text;

#[cfg(test)]
pub(super) mod tests;
