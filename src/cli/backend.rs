//! Where a case is computed: the one place that turns `--device` and `--precision` into a backend.

use super::CliError;
use super::options::{Device, DeviceArgs, Precision};
use crate::compute::cpu::Cpu;
use crate::compute::{CaseModel, Compute, ComputeError};

/// The backend for a batch of cases in their virgin state.
///
/// `auto` is the CPU, and `auto` there is f64, the reference. Errors: a device that this build does not have, a mesh that the backend refuses.
pub fn choose_backend(args: &DeviceArgs, models: Vec<CaseModel>) -> Result<Result<Box<dyn Compute>, ComputeError>, CliError> {
    match args.device {
        Device::Gpu => Err(CliError::NoGpu),
        Device::Auto | Device::Cpu => Ok(match args.precision {
            Precision::Auto | Precision::F64 => Cpu::<f64>::new(models).map(boxed),
            Precision::F32 => Cpu::<f32>::new(models).map(boxed),
        }),
    }
}

fn boxed(backend: impl Compute + 'static) -> Box<dyn Compute> {
    Box::new(backend)
}
