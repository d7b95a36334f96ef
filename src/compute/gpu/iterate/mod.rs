//! Newton's iterates on the device: what [`crate::compute::Call::Iterate`] asks for, of all cases
//! the same.
//!
//! A list of kernels goes from the linear system at the current iterates to the merit of the trials
//! at the ends of their corrections, and is one submission; what comes back is some thirty numbers
//! a case.

pub mod arrays;
pub mod kernels;
pub mod marks;
mod requests;
pub mod sources;
mod steps;
