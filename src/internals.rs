//! The rooms behind those of the front page, for this project's own program, tests, benches and
//! tools: no part of what a version promises.

#[cfg(feature = "cli")]
#[path = "bench/mod.rs"]
pub mod bench;
#[path = "bounded.rs"]
pub mod bounded;
#[cfg(feature = "cli")]
#[path = "cli/mod.rs"]
pub mod cli;
#[path = "compute/mod.rs"]
pub mod compute;
#[cfg(feature = "cli")]
#[path = "conformance/mod.rs"]
pub mod conformance;
#[cfg(feature = "explore")]
#[path = "explore/mod.rs"]
pub mod explore;
#[path = "memory.rs"]
pub mod memory;
#[path = "processor.rs"]
pub mod processor;
#[cfg(feature = "cli")]
#[path = "prove/mod.rs"]
pub mod prove;
#[path = "quoting.rs"]
pub mod quoting;
#[path = "simulation/mod.rs"]
pub mod simulation;
#[path = "solver/mod.rs"]
pub mod solver;
#[cfg(feature = "cli")]
#[path = "verify/mod.rs"]
pub mod verify;

pub use asperity_kernels::{contact, element, lanes, linalg, mesh, real};
