//! The inner loops of Asperity: what a run spends its time in, and what that stands on.
//!
//! A crate of its own so that the release profile can leave integer overflow checks on everywhere
//! else: a crate has them or has them not, and here they cost a seventh of a run. Nothing here
//! reads a file or takes a number from a user: indices come from meshes that were made here and
//! counts that `case` has bounded, and tests and development builds check them.
//!
//! `asperity` re-exports these rooms under its own name. From the bottom up: `real` and `lanes`
//! (numbers), `mesh`, `material`, `element`, `contact`, `linalg`.

pub mod contact;
pub mod element;
pub mod lanes;
pub mod linalg;
pub mod material;
pub mod mesh;
pub mod real;
