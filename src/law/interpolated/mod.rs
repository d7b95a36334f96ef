//! The law by interpolation between simulated contacts of many materials: for any material, any mu
//! and any h between them, a table as of its own simulations.
//!
//! A contact is eight dimensionless numbers (`inputs`). What is wanted of it (`outputs`) are six
//! numbers and two curves, the curves as five `components` each; every one of these is a Gaussian
//! `process` over the eight. How a contact yields under F_T (`yielding`) comes from a study of
//! oblique `presses`. `fit` makes the others from a study, and `model` is the law that they are.
//! [`Interpolated::table`] asks for the depths that `law tabulate` would simulate; what comes out
//! is a [`super::table::Tabulated`], which update and exports take like one of simulations.

mod checked;
mod components;
mod fit;
pub mod inputs;
mod model;
mod outputs;
mod presses;
mod process;
mod yielding;

pub use fit::fit;
pub use model::{FORMAT, Input, Interpolated, NormalErrors, Source, VERSION};
pub use presses::with_yielding;
pub use yielding::Yielding;
