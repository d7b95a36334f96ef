//! Where a batch is computed: the one place that turns a choice of device and precision into a
//! backend.

use super::cpu::Cpu;
use super::{CaseModel, Compute, ComputeError, wrong};

#[cfg(feature = "gpu")]
pub use device::Devices;
#[cfg(feature = "gpu")]
pub use device::{measured, select_on};
#[cfg(feature = "gpu")]
use device::{on_device, opens};

/// The environment variable that says which device is used where nothing else does.
pub const DEVICE_VARIABLE: &str = "ASPERITY_DEVICE";

/// The device wished for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DeviceChoice {
    /// A GPU that a short measurement finds faster than the CPU, else the CPU; never a software
    /// adapter. Whatever fails there, the CPU takes over.
    #[default]
    Auto,
    /// The CPU.
    Cpu,
    /// A GPU, a software adapter if there is nothing else; what fails there is an error.
    Gpu,
}

impl DeviceChoice {
    /// By its word; none for another.
    pub fn of(word: &str) -> Option<Self> {
        match word {
            "auto" => Some(Self::Auto),
            "cpu" => Some(Self::Cpu),
            "gpu" => Some(Self::Gpu),
            _ => None,
        }
    }

    /// What [`DEVICE_VARIABLE`] says; `Auto` where it is not set.
    ///
    /// # Errors
    /// Its value, if that is none of the words.
    pub fn of_environment() -> Result<Self, String> {
        match std::env::var_os(DEVICE_VARIABLE) {
            None => Ok(Self::Auto),
            Some(value) => value.to_str().and_then(Self::of).ok_or_else(|| value.to_string_lossy().into_owned()),
        }
    }
}

/// The precision wished for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PrecisionChoice {
    /// f64 for the residual, f32 for the linear systems. On a device without f64 as `Mixed`.
    #[default]
    Auto,
    /// As `Mixed`, with a note: f32 for everything was a precision once.
    F32,
    /// f64, as `Auto`.
    F64,
    /// The device makes steps in f32, and the CPU holds each to the residual in f64. On the CPU as
    /// `F64`.
    Mixed,
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
/// [`ComputeError::InvertedMesh`] and [`ComputeError::Connectivity`] from any device;
/// [`ComputeError::Device`] if a GPU was asked for and there is none, or the batch does not fit.
pub fn select(device: DeviceChoice, precision: PrecisionChoice, models: Vec<CaseModel>) -> Result<Selected, ComputeError> {
    match device {
        DeviceChoice::Cpu => Ok(Selected { backend: cpu(models)?, notes: notes_of(precision) }),
        choice => on_device(choice, precision, models),
    }
}

/// Whether a device is to be used: asked for or found, and able to be opened.
///
/// # Errors
/// [`ComputeError::Device`] if a GPU was asked for and cannot be had.
pub fn is_there(device: DeviceChoice) -> Result<bool, ComputeError> {
    match device {
        DeviceChoice::Cpu => Ok(false),
        choice => opens(choice),
    }
}

/// Calls of iterates that cases of a batch have shared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SharedCalls {
    /// How many.
    pub calls: u64,
    /// Cases that they served, summed.
    pub cases: u64,
}

impl std::ops::AddAssign for SharedCalls {
    fn add_assign(&mut self, other: Self) {
        self.calls += other.calls;
        self.cases += other.cases;
    }
}

fn cpu(models: Vec<CaseModel>) -> Result<Box<dyn Compute>, ComputeError> {
    Ok(wrong::hooked(Cpu::<f64, f32>::with_tangents(models)?))
}

/// What the user should know of the precision, wherever it is computed in.
fn notes_of(precision: PrecisionChoice) -> Vec<String> {
    match precision {
        PrecisionChoice::F32 => {
            vec!["precision f32 means mixed: a device makes the steps in f32, and each is held to the residual in f64".to_owned()]
        }
        PrecisionChoice::Auto | PrecisionChoice::F64 | PrecisionChoice::Mixed => Vec::new(),
    }
}

/// A choice of device, opened once for all the backends that are made on it.
#[cfg(not(feature = "gpu"))]
pub struct Devices(DeviceChoice);

#[cfg(not(feature = "gpu"))]
impl Devices {
    /// Opens the device of a choice.
    ///
    /// # Errors
    /// [`ComputeError::Device`] if a GPU was asked for and cannot be had.
    pub fn open(choice: DeviceChoice) -> Result<Self, ComputeError> {
        opens(choice).map(|_| Self(choice))
    }

    /// There is nothing to share.
    pub fn served(&self, _: SharedCalls) {}

    /// Nothing is to be said of a choice of one.
    pub fn notes(&self) -> &[String] {
        &[]
    }

    /// Whether there is a device to be used.
    pub fn is_there(&self) -> bool {
        false
    }

    /// As [`select`].
    ///
    /// # Errors
    /// As [`select`].
    pub fn select(&self, precision: PrecisionChoice, models: Vec<CaseModel>) -> Result<Selected, ComputeError> {
        select(self.0, precision, models)
    }

    /// As [`select`].
    ///
    /// # Errors
    /// As [`select`].
    pub fn batch(&self, _: u64, precision: PrecisionChoice, models: Vec<CaseModel>) -> Result<Selected, ComputeError> {
        select(self.0, precision, models)
    }
}

#[cfg(not(feature = "gpu"))]
fn on_device(device: DeviceChoice, precision: PrecisionChoice, models: Vec<CaseModel>) -> Result<Selected, ComputeError> {
    opens(device)?;
    Ok(Selected { backend: cpu(models)?, notes: notes_of(precision) })
}

#[cfg(not(feature = "gpu"))]
fn opens(device: DeviceChoice) -> Result<bool, ComputeError> {
    match device {
        DeviceChoice::Gpu => Err(ComputeError::Device(
            "this build computes on the CPU only. Build it with the feature gpu, or ask for the CPU".to_owned(),
        )),
        DeviceChoice::Auto | DeviceChoice::Cpu => Ok(false),
    }
}

/// What there is only with a GPU in the build.
#[cfg(feature = "gpu")]
mod device {
    use std::sync::{Arc, Mutex, PoisonError};

    use super::{DeviceChoice, PrecisionChoice, Selected, SharedCalls, cpu, notes_of};
    use crate::compute::fallback::Fallback;
    use crate::compute::gpu::trial::TrialRun;
    use crate::compute::gpu::{DeviceRequest, Gpu, GpuContext, GpuError, KernelTimes, Mixed, Precision};
    use crate::compute::lost::hooked;
    use crate::compute::{CaseModel, Compute, ComputeError};

    /// A device, or none, and what the user should know of how that was decided.
    struct OpenedDevice {
        context: Option<GpuContext>,
        notes: Vec<String>,
    }

    fn open(device: DeviceChoice) -> Result<OpenedDevice, GpuError> {
        let request = match device {
            DeviceChoice::Cpu => return Ok(OpenedDevice { context: None, notes: Vec::new() }),
            DeviceChoice::Gpu => DeviceRequest::Gpu,
            DeviceChoice::Auto => DeviceRequest::Auto,
        };
        match GpuContext::open(request)? {
            Some(context) if device == DeviceChoice::Auto && !context.is_named() => {
                let trial = TrialRun::of(&context);
                Ok(judged(context, trial))
            }
            context => Ok(OpenedDevice { context, notes: Vec::new() }),
        }
    }

    /// A device that `auto` found, if the measurement is in favour of it.
    fn judged(context: GpuContext, trial: Result<TrialRun, ComputeError>) -> OpenedDevice {
        let name = context.adapter().name.clone();
        let (takes, note) = match trial {
            Ok(trial) if trial.takes_device() => (true, format!("{name} was chosen: {trial}")),
            Ok(trial) => (false, format!("the CPU was chosen, not {name}: {trial}")),
            Err(error) => (false, format!("the GPU could not be used ({error}); the CPU was taken instead")),
        };
        log::info!("device: {note}");
        OpenedDevice { context: takes.then_some(context), notes: vec![note] }
    }

    fn opened(device: DeviceChoice, profiled: bool) -> Result<OpenedDevice, GpuError> {
        let OpenedDevice { context, notes } = open(device)?;
        Ok(OpenedDevice { context: if profiled { context.map(GpuContext::with_profile) } else { context }, notes })
    }

    /// The same with notes before its own.
    fn noted(notes: &[String], selected: Selected) -> Selected {
        Selected { notes: [notes, &selected.notes].concat(), ..selected }
    }

    /// Whether `auto` takes a GPU that is there and real, and why; none where there is none, or one
    /// is named.
    pub fn measured() -> Option<(bool, String)> {
        let OpenedDevice { context, notes } = open(DeviceChoice::Auto).ok()?;
        Some((context.is_some(), notes.into_iter().next()?))
    }

    pub(super) fn on_device(
        device: DeviceChoice,
        precision: PrecisionChoice,
        models: Vec<CaseModel>,
    ) -> Result<Selected, ComputeError> {
        let (opened, notes) = match open(device) {
            Ok(OpenedDevice { context, notes }) => (Ok(context), notes),
            Err(error) => (Err(error), Vec::new()),
        };
        select_on(opened, device, precision, models).map(|selected| noted(&notes, selected))
    }

    pub(super) fn opens(device: DeviceChoice) -> Result<bool, ComputeError> {
        Devices::open(device).map(|devices| devices.is_there())
    }

    /// A choice of device, opened once for all the backends that are made on it: they share its
    /// compiled kernels.
    pub struct Devices {
        choice: DeviceChoice,
        profiled: bool,
        context: Mutex<Option<Arc<GpuContext>>>,
        /// What the user should know of how the device was chosen.
        notes: Vec<String>,
        shared: Mutex<SharedCalls>,
    }

    impl Devices {
        /// Opens the device of a choice.
        ///
        /// # Errors
        /// [`ComputeError::Device`] if a GPU was asked for and cannot be had.
        pub fn open(choice: DeviceChoice) -> Result<Self, ComputeError> {
            Self::new(choice, false)
        }

        /// The same with sums of the times and bytes of its kernels: [`Devices::kernel_times`].
        ///
        /// # Errors
        /// As [`Devices::open`].
        pub fn profiled(choice: DeviceChoice) -> Result<Self, ComputeError> {
            Self::new(choice, true)
        }

        fn new(choice: DeviceChoice, profiled: bool) -> Result<Self, ComputeError> {
            let OpenedDevice { context, notes } = match opened(choice, profiled) {
                Ok(OpenedDevice { context: None, .. }) if choice == DeviceChoice::Gpu => return Err(GpuError::NoAdapter.into()),
                Err(error) if choice == DeviceChoice::Gpu => return Err(error.into()),
                Ok(opened) => opened,
                Err(error) => {
                    log::info!("the GPU could not be used ({error}); the CPU was taken instead");
                    OpenedDevice { context: None, notes: Vec::new() }
                }
            };
            Ok(Self { choice, profiled, context: Mutex::new(context.map(Arc::new)), notes, shared: Mutex::default() })
        }

        /// What the kernels came to since the device was opened, or opened anew after a loss;
        /// `None` without a device or a profile.
        pub fn kernel_times(&self) -> Option<KernelTimes> {
            self.context.lock().unwrap_or_else(PoisonError::into_inner).as_ref()?.kernel_times()
        }

        /// Takes in what a batch has shared.
        pub fn served(&self, calls: SharedCalls) {
            *self.shared.lock().unwrap_or_else(PoisonError::into_inner) += calls;
        }

        /// What batches have shared since the device was opened.
        pub fn shared_calls(&self) -> SharedCalls {
            *self.shared.lock().unwrap_or_else(PoisonError::into_inner)
        }

        /// Whole sentences on how the device was chosen; none where the choice was the user's.
        pub fn notes(&self) -> &[String] {
            &self.notes
        }

        /// Whether there is a device to be used.
        pub fn is_there(&self) -> bool {
            self.context.lock().unwrap_or_else(PoisonError::into_inner).is_some()
        }

        /// The device; opened anew where it was lost.
        fn context(&self) -> Result<Option<Arc<GpuContext>>, GpuError> {
            let mut context = self.context.lock().unwrap_or_else(PoisonError::into_inner);
            if context.as_ref().is_some_and(|context| context.ask().is_err()) {
                *context = opened(self.choice, self.profiled)?.context.map(Arc::new);
            }
            Ok(context.clone())
        }

        /// As [`super::select`], with a memory budget for itself.
        ///
        /// # Errors
        /// As [`super::select`].
        pub fn select(&self, precision: PrecisionChoice, models: Vec<CaseModel>) -> Result<Selected, ComputeError> {
            let part = |context: Arc<GpuContext>| context.part(context.budget().limit());
            let selected = select_on(self.context().map(|context| context.map(part)), self.choice, precision, models)?;
            Ok(noted(&self.notes, selected))
        }

        /// A batch on the device, for which there is one of `parts` parts of its memory.
        ///
        /// # Errors
        /// [`ComputeError::Device`] where it does not fit, or there is no device any more.
        pub fn batch(&self, parts: u64, precision: PrecisionChoice, models: Vec<CaseModel>) -> Result<Selected, ComputeError> {
            let context = self.context()?.ok_or(GpuError::NoAdapter)?;
            let part = context.part(context.budget().limit() / parts.max(1));
            let (backend, notes) = gpu(Arc::new(part), precision, models)?;
            let watched = self.choice != DeviceChoice::Gpu;
            let backend = if watched { Box::new(Fallback::new(backend)) } else { backend };
            Ok(noted(&self.notes, Selected { backend, notes }))
        }
    }

    /// As [`super::select`], on a device that was opened (or not) by the caller.
    ///
    /// # Errors
    /// As [`super::select`].
    pub fn select_on(
        context: Result<Option<GpuContext>, GpuError>,
        device: DeviceChoice,
        precision: PrecisionChoice,
        models: Vec<CaseModel>,
    ) -> Result<Selected, ComputeError> {
        let reason = match context {
            Ok(None) if device == DeviceChoice::Gpu => ComputeError::from(GpuError::NoAdapter),
            Ok(None) => return Ok(Selected { backend: cpu(models)?, notes: notes_of(precision) }),
            Err(error) => error.into(),
            Ok(Some(context)) => match gpu(Arc::new(context), precision, models.clone()) {
                Ok((backend, notes)) if device == DeviceChoice::Gpu => return Ok(Selected { backend, notes }),
                Ok((backend, notes)) => return Ok(Selected { backend: Box::new(Fallback::new(backend)), notes }),
                Err(error) => error,
            },
        };
        match reason {
            ComputeError::Device(reason) if device != DeviceChoice::Gpu => {
                let note = format!("the GPU could not be used ({reason}); the CPU was taken instead");
                log::info!("{note}");
                let notes = [notes_of(precision), vec![note]].concat();
                Ok(Selected { backend: cpu(models)?, notes })
            }
            error => Err(error),
        }
    }

    fn gpu(
        context: Arc<GpuContext>,
        precision: PrecisionChoice,
        models: Vec<CaseModel>,
    ) -> Result<(Box<dyn Compute>, Vec<String>), ComputeError> {
        let has_double = context.supports(Precision::F64).is_ok();
        if has_double && matches!(precision, PrecisionChoice::Auto | PrecisionChoice::F64) {
            let gpu = Gpu::<f64>::with_tangents_in_single(context.clone(), models)?;
            let notes = gpu.notes();
            return Ok((hooked(Box::new(gpu), context), notes));
        }
        let mixed = Mixed::new(context.clone(), models)?;
        let mut notes = mixed.notes();
        if !has_double {
            let name = &context.adapter().name;
            let note = format!("{name} has no double precision in shaders: it computes in f32, and the CPU the residuals in f64");
            log::info!("{note}");
            notes.insert(0, note);
        }
        notes.extend(notes_of(precision));
        Ok((hooked(Box::new(mixed), context), notes))
    }
}
