//! Where a case is computed: turns `--device` and `--precision` into a backend.

use super::options::{Device, DeviceArgs, Precision};
use crate::compute::select::{DeviceWish, PrecisionWish, Selected, select};
use crate::compute::{CaseModel, ComputeError};

/// `--device` as `compute` has it.
pub fn device_wish(args: &DeviceArgs) -> DeviceWish {
    match args.device {
        Device::Auto => DeviceWish::Auto,
        Device::Cpu => DeviceWish::Cpu,
        Device::Gpu => DeviceWish::Gpu,
    }
}

/// `--precision` as `compute` has it.
pub fn precision_wish(args: &DeviceArgs) -> PrecisionWish {
    match args.precision {
        Precision::Auto => PrecisionWish::Auto,
        Precision::F32 => PrecisionWish::F32,
        Precision::F64 => PrecisionWish::F64,
    }
}

/// The backend for a batch of cases in their virgin state, with what the user should know of how it was chosen.
///
/// # Errors
/// As [`select`].
pub fn choose_backend(args: &DeviceArgs, models: Vec<CaseModel>) -> Result<Selected, ComputeError> {
    select(device_wish(args), precision_wish(args), models)
}
