//! Linear systems on the device: the tangent as a matrix of the multigrid hierarchy, and FGMRES
//! preconditioned by its V-cycle, for every slot of a dispatch at once.
//!
//! All of it is in single precision, as the preconditioner is on the CPU ([`crate::linalg`], whose
//! algorithm this is but for three things: a cycle has up to 30 vectors, two passes of classical
//! Gram-Schmidt stand for the modified one, and that the tolerance is met is taken from the
//! recurrence). Newton's residual decides what is a solution, the linear system only how fast it is
//! found. The list of a solve has as many Krylov iterations as whoever asks expects it to take, and
//! one more. After each of them the device lists the slots that go on, and writes for how many the
//! next kernels are dispatched; where some have not finished at the end of the list, more is sent.
//!
//! `tied` has the same for equal pairs, whose systems are applied and never formed.

mod arrays;
mod calls;
pub mod inspect;
mod kernels;
mod levels;
pub mod pack;
pub mod parts;
pub mod plan;
pub mod records;
pub mod sizes;
pub mod solver;
pub mod sources;
pub mod tied;
pub mod tied_plan;
