//! Where a case is computed: turns `--device` and `--precision` into a backend.

use super::options::{Device, DeviceArgs, Precision};
use crate::compute::select::{DeviceWish, PrecisionWish, Selected, select};
use crate::compute::{CaseModel, ComputeError};

/// The backend for a batch of cases in their virgin state, with what the user should know of how it was chosen.
///
/// # Errors
/// As [`select`].
pub fn choose_backend(args: &DeviceArgs, models: Vec<CaseModel>) -> Result<Selected, ComputeError> {
    let device = match args.device {
        Device::Auto => DeviceWish::Auto,
        Device::Cpu => DeviceWish::Cpu,
        Device::Gpu => DeviceWish::Gpu,
    };
    let precision = match args.precision {
        Precision::Auto => PrecisionWish::Auto,
        Precision::F32 => PrecisionWish::F32,
        Precision::F64 => PrecisionWish::F64,
    };
    select(device, precision, models)
}
