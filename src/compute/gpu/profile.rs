//! Times of kernels: a pair of timestamps around every dispatch, summed by kernel.
//!
//! Off unless [`GpuContext::with_profile`] asks for it, and then nothing is submitted, waited for
//! or moved that would not be otherwise. When it is on, every list of kernels ends with its
//! timestamps, which are read after the list has been waited for anyway; the account of the traffic
//! leaves them out.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use super::arguments::Array;
use super::compiled::Pipeline;
use super::context::{GpuContext, PATIENCE};
use super::error::GpuError;
use super::moves::bytes;
use super::source::Precision;

/// Dispatches whose timestamps a set holds.
const DISPATCHES: usize = wgpu::QUERY_SET_MAX_QUERIES as usize / 2;
/// Bytes of a timestamp.
const STAMP: u64 = size_of::<u64>() as u64;

/// What a kernel came to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KernelTime {
    /// Its name.
    pub kernel: &'static str,
    /// The precision that it was compiled in.
    pub precision: Precision,
    /// How often it was dispatched.
    pub dispatches: u64,
    /// Seconds of those dispatches whose timestamps are of use.
    pub seconds: f64,
    /// Bytes that they moved at the least, as [`super::moves`] counts them; none where that is not
    /// known.
    pub bytes: Option<u64>,
}

/// What all kernels came to.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct KernelTimes {
    /// By name and precision.
    pub kernels: Vec<KernelTime>,
    /// The device has timestamps; without, all seconds are 0.
    pub timed: bool,
    /// Dispatches whose timestamps are zero, or go backwards: they have no seconds.
    pub unusable: u64,
    /// Dispatches whose timestamps were not read, because nothing was waited for after them or the
    /// device was lost: they have no seconds either.
    pub unread: u64,
    /// Seconds on the wall from when the first list of kernels was begun to when the last
    /// timestamps were read.
    pub span: f64,
}

#[derive(Debug, Default)]
struct Sum {
    dispatches: u64,
    seconds: f64,
    bytes: Option<u64>,
}

#[derive(Debug, Default)]
struct Sums {
    kernels: BTreeMap<(&'static str, Precision), Sum>,
    unusable: u64,
    stamped: u64,
    read: u64,
    first: Option<Instant>,
    last: Option<Instant>,
}

/// The sums of a device and all its parts.
#[derive(Debug, Default)]
pub(super) struct Profile {
    timed: bool,
    /// Seconds of a tick.
    period: f64,
    sums: Mutex<Sums>,
    free: Mutex<Vec<Set>>,
}

/// What a part of a device has of a profile.
#[derive(Debug, Default)]
pub(super) struct Profiling {
    pub profile: Arc<Profile>,
    /// Lists that were sent and not waited for yet.
    pending: Mutex<Vec<Stamps>>,
}

/// Queries, and the way of their answers to the host.
#[derive(Debug)]
struct Set {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    mapped: wgpu::Buffer,
}

/// A bound kernel as a profile knows it.
#[derive(Debug)]
pub(super) struct Moved {
    pipeline: Arc<Pipeline>,
    arrays: Vec<Array>,
}

impl Moved {
    fn kernel(&self) -> (&'static str, Precision) {
        (self.pipeline.kernel.name, self.pipeline.precision)
    }

    fn bytes(&self, slots: usize, vectors: usize) -> Option<u64> {
        bytes(self.pipeline.kernel, &self.arrays, slots, vectors)
    }
}

/// The timestamps of a list of kernels that is being made, or was sent.
#[derive(Debug, Default)]
pub(super) struct Stamps {
    sets: Vec<Set>,
    dispatches: Vec<((&'static str, Precision), Option<u64>)>,
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Profile {
    /// Adds what a list dispatched, when it is sent.
    fn sent(&self, stamps: &Stamps) {
        let mut sums = lock(&self.sums);
        for &(kernel, bytes) in &stamps.dispatches {
            let sum = sums.kernels.entry(kernel).or_default();
            sum.dispatches += 1;
            add(&mut sum.bytes, bytes);
        }
        if self.timed {
            sums.stamped += stamps.dispatches.len() as u64;
        }
    }

    /// Adds the timestamps of a list, two for each dispatch.
    fn add(&self, stamps: &Stamps, ticks: &[u64]) {
        let mut sums = lock(&self.sums);
        sums.last = Some(Instant::now());
        for ((kernel, _), pair) in stamps.dispatches.iter().zip(ticks.as_chunks::<2>().0) {
            sums.read += 1;
            match seconds(*pair, self.period) {
                Some(seconds) => sums.kernels.entry(*kernel).or_default().seconds += seconds,
                None => sums.unusable += 1,
            }
        }
    }

    fn times(&self) -> KernelTimes {
        let sums = lock(&self.sums);
        let time = |(&(kernel, precision), sum): (&(&'static str, Precision), &Sum)| KernelTime {
            kernel,
            precision,
            dispatches: sum.dispatches,
            seconds: sum.seconds,
            bytes: sum.bytes,
        };
        KernelTimes {
            kernels: sums.kernels.iter().map(time).collect(),
            timed: self.timed,
            unusable: sums.unusable,
            unread: sums.stamped - sums.read,
            span: sums.first.zip(sums.last).map_or(0.0, |(first, last)| last.duration_since(first).as_secs_f64()),
        }
    }
}

fn add(sum: &mut Option<u64>, bytes: Option<u64>) {
    if let Some(bytes) = bytes {
        *sum.get_or_insert_default() += bytes;
    }
}

/// Seconds between two timestamps; `None` where a driver has left one out or they go backwards.
fn seconds([begin, end]: [u64; 2], period: f64) -> Option<f64> {
    (begin != 0 && end >= begin).then(|| (end - begin) as f64 * period)
}

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

    fn set_of_queries(&self) -> Result<Set, GpuError> {
        let label = Some("timestamps");
        let count = 2 * DISPATCHES as u32;
        self.scoped("timestamps", || {
            let buffer = |usage| {
                let size = STAMP * u64::from(count);
                self.device.create_buffer(&wgpu::BufferDescriptor { label, size, usage, mapped_at_creation: false })
            };
            Set {
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

impl Stamps {
    /// Bytes of the timestamps in each set.
    fn bytes_by_set(&self) -> impl Iterator<Item = u64> {
        let all = self.dispatches.len();
        (0..self.sets.len()).map(move |i| 2 * STAMP * (all - DISPATCHES * i).min(DISPATCHES) as u64)
    }

    /// Appends that they are brought to where the host reads them.
    pub fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        for (set, bytes) in self.sets.iter().zip(self.bytes_by_set()) {
            encoder.resolve_query_set(&set.queries, 0..(bytes / STAMP) as u32, &set.resolved, 0);
            encoder.copy_buffer_to_buffer(&set.resolved, 0, &set.mapped, 0, bytes);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn timestamps_of_no_use_are_counted_and_not_summed() {
        assert_eq!(seconds([10, 30], 0.5), Some(10.0));
        assert_eq!(seconds([10, 10], 1.0), Some(0.0));
        assert_eq!((seconds([30, 10], 1.0), seconds([0, 10], 1.0), seconds([0, 0], 1.0)), (None, None, None));

        let profile = Profile { timed: true, period: 1.0, ..Profile::default() };
        let (a, b) = (("a", Precision::F32), ("b", Precision::F64));
        let stamps = Stamps { sets: Vec::new(), dispatches: vec![(a, Some(8)), (b, None), (a, Some(3)), (a, Some(0))] };
        profile.sent(&stamps);
        assert_eq!((profile.times().unread, profile.times().unusable), (4, 0));
        profile.add(&stamps, &[1, 3, 5, 4, 6, 7, 0, 0]);
        let times = profile.times();
        assert_eq!((times.unread, times.unusable, times.timed), (0, 2, true));
        let of = |kernel, precision, dispatches, seconds, bytes| KernelTime { kernel, precision, dispatches, seconds, bytes };
        let expected = [of("a", Precision::F32, 3, 3.0, Some(11)), of("b", Precision::F64, 1, 0.0, None)];
        assert_eq!(times.kernels, expected);
    }
}
