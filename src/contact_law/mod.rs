//! The law as an incremental, vectorial update of one contact, the form in which a discrete-element
//! code calls it: a macro-element of plasticity, F_N and F_T by one implicit step.
//!
//! [`ContactParameters`] belong to a pair of materials, [`ContactState`] to a contact;
//! [`ContactParameters::update`] takes the new indentation h and the tangential increment in two
//! directions, and answers with the forces and their tangents.
//!
//! Over the hardening depth h_m a [`FirstLoading`] gives the yield force P = F_N0, the share D/h_m
//! that is recovered, k_T and gamma of an unloading; h_p = h_m - D is the dent, r = F_T/F_N.
//!
//! - *Elastic in h*: F_N = P g^(gamma - 1) (e/D)^gamma, e = h - h_p. g follows the yield factor G
//!   as the contact hardens: shear takes F_N and leaves the contact as wide as it was.
//! - *Sliders*: [`SLIDERS`] annuli in parallel (Iwan 1967) hold forces along the plane and, since a
//!   press slips outwards, in the radial direction, each up to its share of mu F_N, and are lost
//!   one by one as the contact is released (Jaeger 1998): Cattaneo and Mindlin's slip, Masing's
//!   rule, nested loops. Their backbone turns the more sharply the further the contact was sheared
//!   and its slip reversed.
//! - *Yield*: F_N G = rho P with G = 1 + A(r) + B(|r - alpha|). A is what a steady oblique press
//!   loses, and what sliding after one keeps; B what the shear at constant h loses besides. The
//!   vertex alpha follows r as the contact is pressed. rho is what a release takes of the yield
//!   force, and flow gives back.
//! - *Flow*: d(delta_p) = dh_p (F(r) r/|r| + v f) + D S(r) dG v, v along r - alpha: a steady part,
//!   and a sudden one under new shear, such that the shear at constant h comes out nearly as it was
//!   given.
//!
//! [`ContactParameters::update_turning`] twists and rolls the contact besides; what that adds is in
//! `turning`. [`ContactParameters::cohere`] adds the attraction of the surfaces: `cohesion`.
//!
//! A step solves F_N G = rho P and F_T = r F_N for the hardening and r by Newton's method with
//! exact slopes; where that does not find the root the hardening is bracketed, and a step for which
//! that finds none either is taken in parts, up to 256.
//! `benches/law/element.md` has all equations, what fails, and by which term.

pub mod export;
pub mod path;

mod centres;
mod cohesion;
mod constants;
mod hint;
mod parameters;
mod prepare;
mod sectors;
mod sliders;
mod state;
mod step;
mod table;
mod turning;
mod turning_constants;
mod update;
mod virgin;

pub use centres::{Centres, Frame};
pub use cohesion::{Attraction, Cohesion, CohesionState};
pub use constants::Constants;
pub use parameters::ContactParameters;
pub(crate) use prepare::KEPT;
pub use sectors::SECTORS;
pub use state::{ContactResponse, ContactState};
pub use table::SLIDERS;
pub use turning::{Moments, Turn, TurningState};
pub use turning_constants::TurningConstants;
pub use virgin::{ContactError, FirstLoading, Given, POINTS, Shapes, Virgin, VirginPoint, measured_slope, unloading_exponent};

#[cfg(test)]
mod cohesion_tests;
#[cfg(test)]
mod tests;
