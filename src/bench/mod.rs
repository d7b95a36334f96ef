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
mod error;
pub mod input;
pub mod kernels;
pub mod linear;
pub mod material;
mod options;
pub mod report;
pub mod table;
pub mod timing;
pub mod traffic;
pub mod whole_job;

#[cfg(test)]
mod tests;

use std::sync::Arc;

use crate::compute::gpu::{DeviceRequest, GpuContext, GpuError};
use copy::CopyRates;
use report::{Header, RatesReport};

pub use error::BenchError;
pub use options::{BenchDevice, Options, ThreadPools};

/// Measures everything; `say` is told what is being measured.
///
/// # Errors
/// [`BenchError`]; what does not fit in memory is a row that says so.
pub fn run(options: &Options, say: &mut dyn FnMut(&str)) -> Result<RatesReport, BenchError> {
    let opened = match options.device {
        BenchDevice::Cpu => Ok(None),
        BenchDevice::Auto => GpuContext::open(DeviceRequest::Auto),
        BenchDevice::Gpu => GpuContext::open(DeviceRequest::Gpu),
    };
    let (context, missing) = match (options.device, opened) {
        (BenchDevice::Cpu, _) => (None, None),
        // Kernels as a release build has them, from any build.
        (_, Ok(Some(context))) => (Some(Arc::new(context.with_checks(false))), None),
        (BenchDevice::Auto, Ok(None)) => {
            (None, Some("there is none, or only a software adapter, which --device gpu takes too".to_owned()))
        }
        (BenchDevice::Auto, Err(error)) => (None, Some(error.to_string())),
        (BenchDevice::Gpu, Ok(None)) => return Err(GpuError::NoAdapter.into()),
        (BenchDevice::Gpu, Err(error)) => return Err(error.into()),
    };
    let pools = ThreadPools::new(options.threads)?;
    let mut header = Header::new(options, context.as_deref(), missing);
    say(&header.device_line());
    say("copies");
    header.copy = CopyRates::measure(options, context.as_deref(), &pools)?;
    let mut report = RatesReport { header, setups: Vec::new(), rows: Vec::new() };
    material::measure::<f64>(options, context.as_deref(), &pools, &mut report, say)?;
    material::measure::<f32>(options, context.as_deref(), &pools, &mut report, say)?;
    element::measure::<f64>(options, context.as_ref(), &pools, &mut report, say)?;
    element::measure::<f32>(options, context.as_ref(), &pools, &mut report, say)?;
    linear::measure(options, context.as_ref(), &mut report, say)?;
    Ok(report)
}
