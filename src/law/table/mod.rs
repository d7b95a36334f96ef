//! The law of one material and one friction as curves in h, from simulations at some depths: exact
//! where formulas for all materials are not. It is of one pair of bodies, and says which: a sphere
//! on a rigid plane, two equal spheres, or any two that a case can describe.
//!
//! `series` makes the table of two unlike bodies from one `body` each. Tables of two spheres are in
//! the [frame of their centres](crate::contact_law::Centres), which engines have.
//!
//! Lengths are over R and forces over E R^2, so that one table serves every radius.
//! [`Tabulated::contact_parameters`] hands the curves to the contact update, and everything that
//! uses a table goes through it: what is checked is what is exported.

mod against;
mod body;
mod build;
mod cases;
mod checked;
mod level;
mod measure;
mod series;
pub mod spline;
mod tabulated;

pub use against::{Against, equivalent, indentation_at_first_yield, is_on_a_flat};
pub use build::{Built, build, depths, study_text};
pub(super) use build::{backbone_of, reversal};
pub use cases::case_of;
pub(super) use checked::check_levels;
pub use level::Level;
pub(super) use level::{Curves, cleaned};
pub use measure::Missing;
pub(super) use measure::{Measured, slides_to_its_end, unloading_radius, yielding};
pub(super) use series::bodies_alone;
pub use series::{compose, compose_from};
pub use tabulated::{DepthErrors, FORMAT, Tabulated, VERSION};
pub(super) use tabulated::{frame_of_the_centres, straight};

#[cfg(test)]
mod tests;
