//! The device layer: from "is there a GPU" to "run this kernel on these arrays", with every failure
//! an error.
//!
//! [`adapters`] chooses one whose limits meet the [`needs`] of the kernels, [`trial`] measures
//! whether it is worth it, and [`drivers`] looks for the reason where there is none. [`context`]
//! opens a device, [`buffers`] holds typed arrays on it within a memory budget, [`shader_sources`]
//! lists the WGSL of the [`kernels`], [`reflect`] reads there which arguments each takes,
//! [`pipelines`] compiles it, binds [`arguments`] by name and dispatches it,
//! [`validate`](mod@validate) says where a source does not compile, [`profile`] sums the times of
//! dispatches and [`moves`] their bytes, where that is asked for.
//!
//! On top of it, [`batch`] runs the kernels of a batch of cases over what [`resident`] keeps on the
//! device and arrays in memory that they have in turn, [`linear`] solves their linear systems,
//! [`iterate`] makes Newton iterations of both; [`backend`] is the [`Compute`](super::Compute) of
//! it in one precision, [`mixed`] that of a device without double precision.
//!
//! A device fails quietly: a lost one ignores what is submitted and leaves old numbers in its
//! buffers. [`health::DeviceHealth`] and the tickets of [`buffers`] turn that into an error;
//! nothing is read back without both having been asked.

pub mod adapters;
#[cfg(test)]
mod agreement;
pub mod arguments;
pub mod backend;
pub mod batch;
pub mod block_plan;
pub mod buffers;
mod compiled;
pub mod context;
pub mod dispatch;
pub mod drivers;
pub mod error;
pub mod health;
pub mod iterate;
pub mod kernel;
pub mod kernels;
pub mod layout;
pub mod linear;
pub mod material;
pub mod memory;
mod meter;
pub mod mixed;
pub mod moves;
pub mod needs;
mod pace;
pub mod pipelines;
mod pools;
pub mod profile;
pub mod reflect;
mod replace;
pub mod report;
pub mod resident;
mod room;
pub mod scratch;
pub mod shader_sources;
pub mod source;
pub mod tangents;
mod timing;
pub mod trial;
pub mod validate;

pub use adapters::{Adapter, AdapterKind, Choice, DeviceRequest};
pub use backend::Gpu;
pub use buffers::{Chunk, DeviceReal, StorageBuffer};
pub use context::GpuContext;
pub use dispatch::Evaluation;
pub use error::GpuError;
pub use kernel::Kernel;
pub use mixed::Mixed;
pub use profile::{KernelTime, KernelTimes};
pub use source::Precision;
