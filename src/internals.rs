//! The rooms behind those of the front page, for this project's own program, tests, benches and
//! tools: no part of what a version promises.

#[cfg(feature = "cli")]
pub mod bench {
    pub use crate::bench::*;
}
pub mod bounded {
    pub use crate::bounded::*;
}
#[cfg(feature = "cli")]
pub mod cli {
    pub use crate::cli::*;
}
pub mod compute {
    pub use crate::compute::*;
}
#[cfg(feature = "cli")]
pub mod conformance {
    pub use crate::conformance::*;
}
#[cfg(feature = "explore")]
pub mod explore {
    pub use crate::explore::*;
}
pub mod memory {
    pub use crate::memory::*;
}
pub mod processor {
    pub use crate::processor::*;
}
#[cfg(feature = "cli")]
pub mod prove {
    pub use crate::prove::*;
}
pub mod quoting {
    pub use crate::quoting::*;
}
pub mod simulation {
    pub use crate::simulation::*;
}
pub mod solver {
    pub use crate::solver::*;
}
#[cfg(feature = "cli")]
pub mod verify {
    pub use crate::verify::*;
}

pub use asperity_kernels::{contact, element, lanes, linalg, mesh, real};
