//! Opening a device, and watching over it.

use super::adapters::{self, Adapter, AdapterKind, Choice, DeviceRequest};
use super::compiled::PipelineCache;
use super::drivers::Drivers;
use super::error::GpuError;
use super::health::DeviceHealth;
use super::memory::{MemoryBudget, Staging};
use super::meter::Meter;
use super::needs;
use super::pace::ListPace;
use super::profile::Profiling;
use super::source::Precision;
use crate::compute::traffic::Traffic;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// Longest time that one submission may take before the device is given up. Software adapters
/// compile for a quarter of a minute at a kernel's first dispatch.
pub(super) const PATIENCE: Duration = Duration::from_secs(300);

/// The environment variable by which tests make a kernel faulty, which only builds with debug
/// assertions look at: the kernel of this name computes nothing.
pub const FAULT_VARIABLE: &str = "ASPERITY_TEST_FAULTY_KERNEL";

/// The words of wgpu and of drivers, which come in indented lines, as a part of one message.
fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// An open device with its queue, its compiled kernels and its memory budget.
///
/// May be shared between threads; what is read back goes through one staging buffer, so that one
/// thread at a time waits. Results are identical bits for identical input: kernels gather in fixed
/// order and use atomics for the lowest number alone, which has no order (`atomicMin`).
pub struct GpuContext {
    pub(super) device: wgpu::Device,
    pub(super) queue: wgpu::Queue,
    pub(super) health: Arc<DeviceHealth>,
    pub(super) budget: Arc<MemoryBudget>,
    pub(super) pipelines: Arc<PipelineCache>,
    pub(super) staging: Mutex<Option<Staging>>,
    pub(super) meter: Meter,
    pub(super) pace: ListPace,
    /// A kernel that is left out.
    fault: Option<String>,
    pub(super) profiling: Option<Profiling>,
    pub(super) checked: bool,
    adapter: Adapter,
    named: bool,
    _closing: Arc<Closing>,
}

/// Closes the device with the last part of its context.
struct Closing(wgpu::Device);

impl Drop for Closing {
    fn drop(&mut self) {
        // Closing a device is not a loss: keep the callback from reporting one.
        self.0.set_device_lost_callback(|_, _| ());
    }
}

impl GpuContext {
    /// Opens the device that `request` and the environment (`ASPERITY_ADAPTER`) ask for; none
    /// means: use the CPU.
    ///
    /// # Errors
    /// As [`adapters::choose`]; [`GpuError::NoDevice`] if the driver opens none.
    pub fn open(request: DeviceRequest) -> Result<Option<Self>, GpuError> {
        Self::open_named(request, adapters::wanted_name().as_deref())
    }

    /// Opens the device that `request` and `wanted`, a part of an adapter's name, ask for; none
    /// means: use the CPU.
    ///
    /// # Errors
    /// As [`GpuContext::open`].
    pub fn open_named(request: DeviceRequest, wanted: Option<&str>) -> Result<Option<Self>, GpuError> {
        let found = adapters::enumerate(&adapters::instance());
        let described: Vec<Adapter> = found.iter().map(Adapter::of).collect();
        let choice = adapters::choose(&described, request, wanted).map_err(|error| match error {
            GpuError::NoAdapter => Drivers::found().nothing_found(),
            error => error,
        })?;
        let Choice { adapter, named, reason } = choice;
        let Some(chosen) = adapter else {
            let hint = Drivers::found().hint(&described).map_or_else(String::new, |hint| format!(". {hint}"));
            log::info!("device: the CPU ({reason}{hint})");
            return Ok(None);
        };
        let description = described[chosen].clone();
        let notice = format!("device: {} ({}), {reason}", description.name, description.kind);
        // Once is enough for a program that opens it again and again.
        static WARNED: AtomicBool = AtomicBool::new(false);
        if description.kind == AdapterKind::Software && !WARNED.swap(true, Ordering::Relaxed) {
            log::warn!("{notice}")
        } else {
            log::info!("{notice}")
        }
        Self::open_adapter(&found[chosen], description, named).map(Some)
    }

    fn open_adapter(adapter: &wgpu::Adapter, description: Adapter, named: bool) -> Result<Self, GpuError> {
        let wanted = wgpu::Features::SHADER_F64 | wgpu::Features::TIMESTAMP_QUERY;
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("asperity"),
            required_features: adapter.features() & wanted,
            required_limits: needs::asked_for(&adapter.limits()),
            ..Default::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))
            .map_err(|e| GpuError::NoDevice { adapter: description.name.clone(), reason: e.to_string() })?;
        let health = Arc::new(DeviceHealth::default());
        let on_error = Arc::clone(&health);
        device.on_uncaptured_error(Arc::new(move |e: wgpu::Error| {
            on_error.fail(GpuError::Lost { reason: one_line(&e.to_string()) })
        }));
        let on_loss = Arc::clone(&health);
        device.set_device_lost_callback(move |reason, message| {
            on_loss.fail(GpuError::Lost { reason: one_line(&format!("it was lost ({reason:?}) {message}")) });
        });
        let budget = Arc::new(MemoryBudget::for_adapter(description.kind, adapters::own_memory(adapter)));
        Ok(Self {
            health,
            budget,
            pipelines: Arc::default(),
            staging: Mutex::new(None),
            meter: Meter::default(),
            pace: ListPace::default(),
            fault: std::env::var(FAULT_VARIABLE).ok().filter(|_| cfg!(debug_assertions)),
            profiling: None,
            checked: cfg!(debug_assertions),
            adapter: description,
            named,
            _closing: Arc::new(Closing(device.clone())),
            device,
            queue,
        })
    }

    /// The same device and its compiled kernels for another user, with a memory budget of `bytes`,
    /// a staging buffer and counters of its own: two of these do not wait for each other. A profile
    /// has the sums of all parts.
    pub fn part(&self, bytes: u64) -> Self {
        Self {
            device: self.device.clone(),
            queue: self.queue.clone(),
            health: Arc::clone(&self.health),
            budget: Arc::new(MemoryBudget::new(bytes)),
            pipelines: Arc::clone(&self.pipelines),
            staging: Mutex::new(None),
            meter: Meter::default(),
            pace: self.pace.of_part(),
            fault: self.fault.clone(),
            profiling: self.profile_of_part(),
            checked: self.checked,
            adapter: self.adapter.clone(),
            named: self.named,
            _closing: Arc::clone(&self._closing),
        }
    }

    /// The same with kernels compiled with or without bounds checks; the default is with in debug
    /// builds, without in release builds, where they cost a factor of 3.5 to 5 in kernels with
    /// private arrays.
    pub fn with_checks(mut self, checked: bool) -> Self {
        self.checked = checked;
        self.pipelines = Arc::default();
        self
    }

    /// The same with a memory budget of `bytes` instead of that of the environment; before any
    /// array is made.
    pub fn with_budget(mut self, bytes: u64) -> Self {
        self.budget = Arc::new(MemoryBudget::new(bytes));
        self
    }

    /// The same without double precision, as most interfaces but Vulkan are. For tests of what is
    /// done then.
    pub fn without_double_precision(mut self) -> Self {
        self.adapter.double_precision = false;
        self
    }

    /// The same without timestamps, as some drivers are. For tests of what is said then.
    pub fn without_timestamps(mut self) -> Self {
        self.adapter.timestamps = false;
        self
    }

    /// The same with kernels that see no more than so many bytes of an array, as on some adapters.
    /// For tests of batches that are cut up by it.
    pub fn with_longest_array(mut self, bytes: u64) -> Self {
        self.adapter.max_binding = bytes;
        self
    }

    /// The same with lists of kernels sent in pieces where the last one took longer than this,
    /// instead of half a second. For tests of that.
    pub fn with_longest_submission(mut self, longest: Duration) -> Self {
        self.pace = ListPace::with(longest);
        self
    }

    /// Pieces of lists that were sent ahead of the last one, which the account of the traffic does
    /// not count: there a list is one submission.
    pub fn pieces_sent_ahead(&self) -> u64 {
        self.pace.ahead()
    }

    /// Whether a test wants this kernel to compute nothing.
    pub(super) fn leaves_out(&self, kernel: &str) -> bool {
        self.fault.as_deref() == Some(kernel)
    }

    /// The adapter behind this device.
    pub fn adapter(&self) -> &Adapter {
        &self.adapter
    }

    /// Whether the environment names this adapter (`ASPERITY_ADAPTER`), so that it is taken without
    /// having been measured.
    pub fn is_named(&self) -> bool {
        self.named
    }

    /// The memory budget: what is taken of how much.
    pub fn budget(&self) -> &MemoryBudget {
        &self.budget
    }

    /// What has passed between the host and this device, or this part of it, since it was opened.
    pub fn traffic(&self) -> Traffic {
        self.meter.read()
    }

    /// The device's state of health.
    ///
    /// # Errors
    /// The first fault since it was opened.
    pub fn check(&self) -> Result<(), GpuError> {
        self.health.check()
    }

    /// As [`GpuContext::check`], after having heard what the driver has to say.
    ///
    /// # Errors
    /// The first fault since it was opened.
    pub fn ask(&self) -> Result<(), GpuError> {
        let _ = self.device.poll(wgpu::PollType::Poll);
        self.check()
    }

    /// Whether kernels in `precision` run here.
    ///
    /// # Errors
    /// [`GpuError::NoDoublePrecision`].
    pub fn supports(&self, precision: Precision) -> Result<(), GpuError> {
        if precision == Precision::F64 && !self.adapter.double_precision {
            return Err(GpuError::NoDoublePrecision { adapter: self.adapter.name.clone() });
        }
        Ok(())
    }

    /// Gives the device up, as a driver reset would: everything after it must fail. For tests of
    /// the error paths.
    pub fn destroy(&self) {
        self.device.destroy();
    }

    /// Runs `make`, which creates `what`, and turns every error that wgpu raises meanwhile on this
    /// thread into a result.
    pub(super) fn scoped<R>(&self, what: &str, make: impl FnOnce() -> R) -> Result<R, GpuError> {
        self.check()?;
        let internal = self.device.push_error_scope(wgpu::ErrorFilter::Internal);
        let memory = self.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let validation = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let made = make();
        // Every scope has to be popped, innermost first, whichever one holds the error.
        let errors = [pollster::block_on(validation.pop()), pollster::block_on(memory.pop()), pollster::block_on(internal.pop())];
        match errors.into_iter().flatten().next() {
            None => Ok(made),
            Some(e) => {
                // A lost device refuses everything; it says that it is lost when it is polled.
                let _ = self.device.poll(wgpu::PollType::Poll);
                self.check()?;
                Err(GpuError::Rejected { what: what.to_owned(), message: one_line(&e.to_string()) })
            }
        }
    }

    /// Waits for a submission and checks that the device survived it.
    pub(super) fn wait(&self, what: &str, submission: wgpu::SubmissionIndex) -> Result<(), GpuError> {
        let poll = wgpu::PollType::Wait { submission_index: Some(submission), timeout: Some(PATIENCE) };
        self.meter.waited();
        let waited = self.device.poll(poll);
        self.check()?;
        match waited {
            Ok(_) => Ok(()),
            Err(wgpu::PollError::Timeout) => {
                Err(self.fault(GpuError::Timeout { what: what.to_owned(), seconds: PATIENCE.as_secs() }))
            }
            // To a lost device nothing is submitted any more, without a word.
            Err(wgpu::PollError::WrongSubmissionIndex(..)) => {
                Err(self
                    .fault(GpuError::Lost { reason: "it was lost, and took nothing that was submitted to it since".to_owned() }))
            }
        }
    }

    /// Gives the device up for `fault`, and returns it.
    pub(super) fn fault(&self, fault: GpuError) -> GpuError {
        self.health.fail(fault.clone());
        fault
    }

    pub(super) fn staging(&self) -> std::sync::MutexGuard<'_, Option<Staging>> {
        self.staging.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl std::fmt::Debug for GpuContext {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("GpuContext").field("adapter", &self.adapter).finish_non_exhaustive()
    }
}
