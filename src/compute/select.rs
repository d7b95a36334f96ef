//! Where a batch is computed: the one place that turns a wish for a device and a precision into a backend.

use std::sync::Arc;

use super::cpu::Cpu;
use super::fallback::Fallback;
use super::gpu::{DeviceRequest, Gpu, GpuContext, GpuError, Mixed, Precision};
use super::lost::hooked;
use super::{CaseModel, Compute, ComputeError};

/// The device wished for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DeviceWish {
    /// A GPU worth it, else the CPU; never a software adapter. Whatever fails there, the CPU takes over.
    #[default]
    Auto,
    /// The CPU.
    Cpu,
    /// A GPU, a software adapter if there is nothing else; what fails there is an error.
    Gpu,
}

/// The precision wished for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PrecisionWish {
    /// f64, at the least for the residual: a device without f64 computes tangents only.
    #[default]
    Auto,
    /// f32 for everything.
    F32,
    /// f64, as `Auto`.
    F64,
}

/// A backend, with what the user should know of how it was chosen.
pub struct Selected {
    /// The backend with the batch in its virgin state.
    pub backend: Box<dyn Compute>,
    /// Whole sentences for the log and the summary; empty if all is as wished for.
    pub notes: Vec<String>,
}

/// The backend for a batch of cases in their virgin state.
///
/// # Errors
/// [`ComputeError::InvertedMesh`] and [`ComputeError::Connectivity`] from any device; [`ComputeError::Device`] if a GPU was asked for
/// and there is none, or the batch does not fit.
pub fn select(device: DeviceWish, precision: PrecisionWish, models: Vec<CaseModel>) -> Result<Selected, ComputeError> {
    let context = match device {
        DeviceWish::Cpu => Ok(None),
        DeviceWish::Gpu => GpuContext::open(DeviceRequest::Gpu),
        DeviceWish::Auto => GpuContext::open(DeviceRequest::Auto),
    };
    select_on(context, device, precision, models)
}

/// As [`select`], on a device that was opened (or not) by the caller.
///
/// # Errors
/// As [`select`].
pub fn select_on(
    context: Result<Option<GpuContext>, GpuError>,
    device: DeviceWish,
    precision: PrecisionWish,
    models: Vec<CaseModel>,
) -> Result<Selected, ComputeError> {
    let reason = match context {
        Ok(None) if device == DeviceWish::Gpu => ComputeError::from(GpuError::NoAdapter),
        Ok(None) => return Ok(Selected { backend: cpu(precision, models)?, notes: Vec::new() }),
        Err(error) => error.into(),
        Ok(Some(context)) => match gpu(Arc::new(context), precision, models.clone()) {
            Ok((backend, notes)) if device == DeviceWish::Gpu => return Ok(Selected { backend, notes }),
            Ok((backend, notes)) => return Ok(Selected { backend: Box::new(Fallback::new(backend)), notes }),
            Err(error) => error,
        },
    };
    match reason {
        ComputeError::Device(reason) if device != DeviceWish::Gpu => {
            let note = format!("the GPU could not be used ({reason}); the CPU was taken instead");
            log::info!("{note}");
            Ok(Selected { backend: cpu(precision, models)?, notes: vec![note] })
        }
        error => Err(error),
    }
}

fn cpu(precision: PrecisionWish, models: Vec<CaseModel>) -> Result<Box<dyn Compute>, ComputeError> {
    Ok(match precision {
        PrecisionWish::F32 => Box::new(Cpu::<f32>::new(models)?),
        PrecisionWish::Auto | PrecisionWish::F64 => Box::new(Cpu::<f64>::new(models)?),
    })
}

fn gpu(
    context: Arc<GpuContext>,
    precision: PrecisionWish,
    models: Vec<CaseModel>,
) -> Result<(Box<dyn Compute>, Vec<String>), ComputeError> {
    if precision == PrecisionWish::F32 {
        return Ok((hooked(Box::new(Gpu::<f32>::new(context.clone(), models)?), context), Vec::new()));
    }
    if context.supports(Precision::F64).is_ok() {
        return Ok((hooked(Box::new(Gpu::<f64>::new(context.clone(), models)?), context), Vec::new()));
    }
    let note = format!(
        "{} has no double precision in shaders: it computes the tangents in f32, the CPU the residuals in f64",
        context.adapter().name
    );
    log::info!("{note}");
    Ok((hooked(Box::new(Mixed::new(context.clone(), models)?), context), vec![note]))
}
