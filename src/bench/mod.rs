//! Rates of the kernels: return mapping, internal force, tangent, contact and commit, on a device
//! and beside it on the CPU; and parts of the linear solver, on a device alone.
//!
//! What is measured is one call as the program makes it: on a device with its transfers, and the
//! kernels alone beside that. A row is one evaluation in one precision at one batch size; its input
//! is seeded and the same everywhere. [`element`], [`linear`] and [`material`] measure, [`traffic`]
//! counts bytes, [`count`] operations, [`copy`] measures what memory could do, [`report`] holds the
//! numbers and [`table`] shows them. [`whole_job`] runs whole simulations instead, with the
//! times of their kernels in [`kernels`].

pub mod copy;
pub mod count;
pub mod element;
pub mod input;
pub mod kernels;
pub mod linear;
pub mod material;
pub mod report;
pub mod table;
pub mod timing;
pub mod traffic;
pub mod whole_job;

#[cfg(test)]
mod tests;

use std::sync::Arc;

use crate::compute::ComputeError;
use crate::compute::gpu::{DeviceRequest, GpuContext, GpuError};
use crate::material::MaterialError;
use crate::mesh::MeshError;
use copy::CopyRates;
use report::{Header, Report};
use timing::Patience;

/// Why a bench ends early. A row that does not fit is no error.
#[derive(Debug, thiserror::Error)]
pub enum BenchError {
    /// A device was asked for and cannot be used.
    #[error("{0}")]
    Device(#[from] GpuError),
    /// The CPU backend refused the batch.
    #[error("the bench's own cases cannot be evaluated: {0}")]
    Compute(#[from] ComputeError),
    /// The bench's mesh.
    #[error("--elements: {0}")]
    Mesh(#[from] MeshError),
    /// The bench's materials.
    #[error("the bench's own materials cannot be built: {0}")]
    Material(#[from] MaterialError),
    /// A study of whole jobs.
    #[error("{0}")]
    Study(#[from] crate::study::StudyError),
    /// A whole job did not end well.
    #[error("the bench's own case {case} failed: {why}")]
    Case {
        /// Its number.
        case: String,
        /// Why.
        why: String,
    },
    /// A pool of threads.
    #[error("--threads {threads}: cannot start that many threads: {what}. Give fewer")]
    Threads {
        /// The number asked for.
        threads: usize,
        /// What the pool says.
        what: String,
    },
}

/// The device that is benched beside the CPU.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Device {
    /// A GPU where there is one; a software adapter is not taken.
    Auto,
    /// None.
    Cpu,
    /// A GPU, a software adapter if there is nothing else, and an error without any.
    Gpu,
}

/// What is measured, and how large.
#[derive(Clone, Debug)]
pub struct Options {
    /// The device beside the CPU.
    pub device: Device,
    /// Threads of the rows on all cores.
    pub threads: usize,
    /// Cases a call.
    pub batches: Vec<usize>,
    /// Elements along the contact radius.
    pub elements: usize,
    /// Material points a case of the return mapping, a multiple of eight.
    pub points: usize,
    /// Length of the arrays that are copied, bytes.
    pub copied: usize,
    /// How often and how long each evaluation is repeated.
    pub patience: Patience,
}

impl Options {
    /// The whole table: minutes on a machine with a GPU.
    pub fn full(device: Device, threads: usize) -> Self {
        let patience = Patience { least: 3, most: 15, seconds: 1.0, enough: 4.0 };
        let batches = vec![1, 4, 16, 64, 256];
        Self { device, threads, batches, elements: 8, points: 4096, copied: 256 << 20, patience }
    }

    /// A look at it in a minute, for machines without a GPU and for tests: small meshes, small
    /// batches, few repetitions.
    pub fn quick(device: Device, threads: usize) -> Self {
        let patience = Patience { least: 3, most: 5, seconds: 0.05, enough: 1.0 };
        Self { device, threads, batches: vec![1, 4, 8], elements: 4, points: 512, copied: 64 << 20, patience }
    }
}

/// The pools of one thread and of all.
pub struct Pools {
    /// One thread.
    pub one: rayon::ThreadPool,
    /// As many as asked for.
    pub all: rayon::ThreadPool,
    /// How many that is.
    pub threads: usize,
}

impl Pools {
    /// Starts the threads.
    ///
    /// # Errors
    /// [`BenchError::Threads`].
    pub fn new(threads: usize) -> Result<Self, BenchError> {
        let pool = |threads: usize| {
            let built = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            built.map_err(|error| BenchError::Threads { threads, what: error.to_string() })
        };
        Ok(Self { one: pool(1)?, all: pool(threads)?, threads })
    }
}

/// Measures everything; `say` is told what is being measured.
///
/// # Errors
/// [`BenchError`]; what does not fit in memory is a row that says so.
pub fn run(options: &Options, say: &mut dyn FnMut(&str)) -> Result<Report, BenchError> {
    let opened = match options.device {
        Device::Cpu => Ok(None),
        Device::Auto => GpuContext::open(DeviceRequest::Auto),
        Device::Gpu => GpuContext::open(DeviceRequest::Gpu),
    };
    let (context, missing) = match (options.device, opened) {
        (Device::Cpu, _) => (None, None),
        // Kernels as a release build has them, from any build.
        (_, Ok(Some(context))) => (Some(Arc::new(context.with_checks(false))), None),
        (Device::Auto, Ok(None)) => {
            (None, Some("there is none, or only a software adapter, which --device gpu takes too".to_owned()))
        }
        (Device::Auto, Err(error)) => (None, Some(error.to_string())),
        (Device::Gpu, Ok(None)) => return Err(GpuError::NoAdapter.into()),
        (Device::Gpu, Err(error)) => return Err(error.into()),
    };
    let pools = Pools::new(options.threads)?;
    let mut header = Header::new(options, context.as_deref(), missing);
    say(&header.device_line());
    say("copies");
    header.copy = CopyRates::measure(options, context.as_deref(), &pools)?;
    let mut report = Report { header, setups: Vec::new(), rows: Vec::new() };
    material::measure::<f64>(options, context.as_deref(), &pools, &mut report, say)?;
    material::measure::<f32>(options, context.as_deref(), &pools, &mut report, say)?;
    element::measure::<f64>(options, context.as_ref(), &pools, &mut report, say)?;
    element::measure::<f32>(options, context.as_ref(), &pools, &mut report, say)?;
    linear::measure(options, context.as_ref(), &mut report, say)?;
    Ok(report)
}
