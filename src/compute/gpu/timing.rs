//! Timestamps around dispatches, where a profile asks for them.

use std::sync::Arc;
use std::time::Instant;

use super::arguments::Array;
use super::compiled::Pipeline;
use super::context::{GpuContext, PATIENCE};
use super::error::GpuError;
use super::profile::{DISPATCHES, KernelTimes, Moved, Profile, Profiling, Queries, STAMP, Stamps, add, lock};

impl GpuContext {
    /// The same with a sum of the times and bytes of every kernel that it or its parts run from now
    /// on; before any kernel is bound. Without timestamps (TIMESTAMP_QUERY) dispatches and bytes
    /// are summed alone.
    pub fn with_profile(mut self) -> Self {
        let timed = self.adapter().timestamps;
        let period = 1e-9 * f64::from(self.queue.get_timestamp_period());
        let profile = Arc::new(Profile { timed, period, ..Profile::default() });
        self.profiling = Some(Profiling { profile, ..Profiling::default() });
        self
    }

    /// The sums up to now; `None` unless [`GpuContext::with_profile`] asked for them.
    pub fn kernel_times(&self) -> Option<KernelTimes> {
        self.profiling.as_ref().map(|profiling| profiling.profile.times())
    }

    /// Whether there is a profile.
    pub(super) fn is_profiled(&self) -> bool {
        self.profiling.is_some()
    }

    /// The profile of a part of this device: the same sums.
    pub(super) fn profile_of_part(&self) -> Option<Profiling> {
        let profiling = self.profiling.as_ref()?;
        Some(Profiling { profile: Arc::clone(&profiling.profile), ..Profiling::default() })
    }

    /// What is to be known of a kernel that is bound to `arrays`; nothing without a profile.
    pub(super) fn moved(&self, pipeline: &Arc<Pipeline>, arrays: Vec<Array>) -> Option<Moved> {
        self.is_profiled().then(|| Moved { pipeline: Arc::clone(pipeline), arrays })
    }

    /// Adds the bytes that a kernel has moved for `slots` whose Krylov bases have so many vectors,
    /// where that is known only now.
    pub(super) fn credit(&self, moved: Option<&Moved>, slots: usize, vectors: usize) {
        if let (Some(profiling), Some(moved)) = (&self.profiling, moved) {
            let mut sums = lock(&profiling.profile.sums);
            add(&mut sums.kernels.entry(moved.kernel()).or_default().bytes, moved.bytes(slots, vectors));
        }
    }

    /// The timestamps of a list that begins.
    pub(super) fn stamps(&self) -> Option<Stamps> {
        let profiling = self.profiling.as_ref()?;
        lock(&profiling.profile.sums).first.get_or_insert_with(Instant::now);
        Some(Stamps::default())
    }

    /// Takes a dispatch for so many slots in, and says where its timestamps go.
    ///
    /// # Errors
    /// [`GpuError::Rejected`], or the device's fault.
    pub(super) fn stamp<'a>(
        &self,
        stamps: &'a mut Stamps,
        moved: &Moved,
        slots: usize,
    ) -> Result<Option<wgpu::ComputePassTimestampWrites<'a>>, GpuError> {
        let Some(Profiling { profile, .. }) = &self.profiling else { return Ok(None) };
        let at = stamps.dispatches.len();
        if profile.timed && at == DISPATCHES * stamps.sets.len() {
            let free = lock(&profile.free).pop();
            stamps.sets.push(match free {
                Some(set) => set,
                None => self.set_of_queries()?,
            });
        }
        stamps.dispatches.push((moved.kernel(), moved.bytes(slots, 0)));
        let first = 2 * (at % DISPATCHES) as u32;
        Ok(stamps.sets.last().map(|set| wgpu::ComputePassTimestampWrites {
            query_set: &set.queries,
            beginning_of_pass_write_index: Some(first),
            end_of_pass_write_index: Some(first + 1),
        }))
    }

    fn set_of_queries(&self) -> Result<Queries, GpuError> {
        let label = Some("timestamps");
        let count = 2 * DISPATCHES as u32;
        self.scoped("timestamps", || {
            let buffer = |usage| {
                let size = STAMP * u64::from(count);
                self.device.create_buffer(&wgpu::BufferDescriptor { label, size, usage, mapped_at_creation: false })
            };
            Queries {
                queries: self.device.create_query_set(&wgpu::QuerySetDescriptor { label, ty: wgpu::QueryType::Timestamp, count }),
                resolved: buffer(wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC),
                mapped: buffer(wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST),
            }
        })
    }

    /// Takes in that a list was sent and not waited for.
    pub(super) fn sent(&self, stamps: Option<Stamps>) {
        if let (Some(profiling), Some(stamps)) = (&self.profiling, stamps) {
            profiling.profile.sent(&stamps);
            lock(&profiling.pending).push(stamps);
        }
    }

    /// Reads the timestamps of a list that was waited for, and of those that were sent before it.
    /// Those that cannot be read are counted so.
    pub(super) fn waited_for(&self, stamps: Option<Stamps>, submission: &wgpu::SubmissionIndex) {
        let (Some(profiling), Some(stamps)) = (&self.profiling, stamps) else { return };
        self.sent(Some(stamps));
        for stamps in std::mem::take(&mut *lock(&profiling.pending)) {
            if let Some(ticks) = self.ticks(&stamps, submission) {
                profiling.profile.add(&stamps, &ticks);
                lock(&profiling.profile.free).extend(stamps.sets);
            }
        }
    }

    fn ticks(&self, stamps: &Stamps, submission: &wgpu::SubmissionIndex) -> Option<Vec<u64>> {
        let mut ticks = Vec::with_capacity(2 * stamps.dispatches.len());
        for (set, bytes) in stamps.sets.iter().zip(stamps.bytes_by_set()) {
            let (report, outcome) = std::sync::mpsc::channel();
            set.mapped.slice(..bytes).map_async(wgpu::MapMode::Read, move |result| {
                // Whoever has given up does not listen any more.
                let _ = report.send(result.is_ok());
            });
            let poll = wgpu::PollType::Wait { submission_index: Some(submission.clone()), timeout: Some(PATIENCE) };
            // Another thread that waits for the device may be the one that is told.
            if self.device.poll(poll).is_err() || outcome.recv_timeout(PATIENCE) != Ok(true) {
                return None;
            }
            let view = set.mapped.slice(..bytes).get_mapped_range().ok()?;
            ticks.extend(view.as_chunks::<{ STAMP as usize }>().0.iter().map(|&word| u64::from_le_bytes(word)));
            drop(view);
            set.mapped.unmap();
        }
        Some(ticks)
    }
}
