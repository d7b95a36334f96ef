//! Asperity: force-displacement laws for elastic-plastic spheres, computed instead of guessed.
//!
//! One sphere is pressed onto a rigid plane and sheared along it, with finite-strain J2 plasticity
//! and exact Coulomb friction, by implicit finite elements. The plane stands for a second, equal
//! sphere only without friction. A [`Case`] says what is simulated, a [`Simulation`] does it:
//!
//! ```
//! use asperity::{Case, Simulation};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let case = Case::parse(
//!     r#"
//!     sphere = { radius = 1.0 }
//!     material = { youngs_modulus = 200e3, poissons_ratio = 0.3, hardening = { law = "ideal", yield_stress = 400.0 } }
//!     contact = { friction = 0.3 }
//!     mesh = { elements_per_contact_radius = 4 }
//!     path = [{ indentation = 0.005 }, { shear = "full-slip" }]
//!     "#, "my case", &[])?;
//! let outcome = Simulation::new(&case)?.run()?;
//! println!("F_N = {:?}, largest F_T = {:?}", outcome.summary.f_n0, outcome.summary.f_t_max);
//! # assert!(outcome.is_done());
//! # assert!(outcome.summary.f_n0.is_some_and(|f_n| (29.0..40.0).contains(&f_n)));
//! # Ok(()) }
//! ```
//!
//! Lengths and stresses are in any one consistent system of units; forces are of the whole sphere,
//! F_N positive in compression. With [`Options::out`] a simulation leaves the files of `asperity
//! run`; [`Simulation::steps`] takes one step at a time, [`Simulation::canceller`] ends it from
//! another thread. A case that a program has put together is held to the rules of a case file by
//! [`Case::validate`].
//!
//! # Where to look
//!
//! | for | there is |
//! |---|---|
//! | one run | [`Simulation`], [`Options`], [`Outcome`]; `examples/run.rs`, `examples/fields.rs` |
//! | many runs | [`study`]; `examples/parallel_study.rs` |
//! | a contact law in a discrete-element code | [`law::LawFile::built_in`], [`contact_law`]; `examples/law_in_time_loop.rs` |
//! | closed forms | [`analytical`] |
//! | one material point | [`material::point`] |
//!
//! # Features
//!
//! All are on by default, because cargo has no defaults of a program alone. A library writes
//! `default-features = false`, which leaves a run on the CPU with its files, and names what it
//! needs beside that:
//!
//! | feature | adds |
//! |---|---|
//! | `law` | [`study`], [`law`] and [`contact_law`]: grids of cases, fits, tables, exports, the update of a contact |
//! | `plots` | pictures of runs, with `law` those of studies and laws, and their report |
//! | `gpu` | Vulkan, Metal and DX12; the largest part of the time to compile |
//! | `cli` | the program, with all of the above |
//! | `explore` | `asperity explore`, the page in the browser |
//!
//! # Units and signs
//!
//! Lengths and stresses are in any one consistent system of units, forces in stress times length
//! squared; mm and MPa give N. h is positive when the sphere is pressed, F_N in compression; F_T is
//! the force that has to be applied along delta_T to move the sphere, so that their signs agree as
//! long as it is sheared one way. All forces, energies and contact tables are of the whole sphere,
//! although half of it is meshed. Of two equal spheres h and delta_T are the relative displacements
//! of their equators.
//!
//! # What is not here
//!
//! Mesh, elements, contact rows, linear algebra, backends, Newton's method and the path's steps lie
//! behind a hidden module and may change with any version. ARCHITECTURE.md follows one case through
//! them.

pub mod analytical;
#[cfg(feature = "cli")]
mod bench;
mod bounded;
pub mod case;
#[cfg(feature = "cli")]
mod cli;
#[doc(hidden)]
mod compute;
#[cfg(feature = "cli")]
mod conformance;
#[cfg(feature = "law")]
pub mod contact_law;
#[cfg(feature = "explore")]
mod explore;
#[cfg(feature = "law")]
pub mod law;
mod memory;
pub mod output;
mod processor;
#[cfg(feature = "cli")]
mod prove;
mod quoting;
#[cfg(feature = "law")]
mod random;
pub mod session;
mod simulation;
mod solver;
#[cfg(feature = "law")]
pub mod study;
#[cfg(feature = "cli")]
mod verify;

#[doc(hidden)]
pub mod internals;

#[doc(inline)]
pub use asperity_kernels::material;
pub use case::Case;
pub use session::{Canceller, Earlier, Options, Outcome, SessionError, Simulation};

use asperity_kernels::{contact, element, lanes, linalg, mesh, real};

/// The Rust of the documents, which runs.
#[cfg(doctest)]
#[doc = include_str!("../docs/rust.md")]
pub mod documents {}
