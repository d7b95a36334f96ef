//! Where a case is computed: turns `--device` and `--precision` into a backend.

use super::options::{Device, DeviceArgs, PrecisionOption};
use crate::compute::select::{DeviceChoice, PrecisionChoice, Selected, select};
use crate::compute::{CaseModel, ComputeError};

/// `--device` as `compute` has it.
pub fn device_choice(args: &DeviceArgs) -> DeviceChoice {
    device_or_variable(args.device)
}

/// What `--device` says, or else `ASPERITY_DEVICE`, which [`super::environment::check`] has looked
/// at.
pub fn device_or_variable(device: Option<Device>) -> DeviceChoice {
    match device {
        Some(Device::Auto) => DeviceChoice::Auto,
        Some(Device::Cpu) => DeviceChoice::Cpu,
        Some(Device::Gpu) => DeviceChoice::Gpu,
        None => DeviceChoice::of_environment().unwrap_or_default(),
    }
}

/// `--precision` as `compute` has it.
pub fn precision_choice(args: &DeviceArgs) -> PrecisionChoice {
    match args.precision {
        PrecisionOption::Auto => PrecisionChoice::Auto,
        PrecisionOption::F32 => PrecisionChoice::F32,
        PrecisionOption::F64 => PrecisionChoice::F64,
        PrecisionOption::Mixed => PrecisionChoice::Mixed,
    }
}

/// The backend for a batch of cases in their virgin state, with what the user should know of how it
/// was chosen.
///
/// # Errors
/// As [`select`].
pub fn choose_backend(args: &DeviceArgs, models: Vec<CaseModel>) -> Result<Selected, ComputeError> {
    select(device_choice(args), precision_choice(args), models)
}
