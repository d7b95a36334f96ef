//! Times of kernels: a pair of timestamps around every dispatch, summed by kernel.
//!
//! Off unless a device is made one `with_profile`, and then nothing is submitted, waited for or
//! moved that would not be otherwise. When it is on, every list of kernels ends with its
//! timestamps, which are read after the list has been waited for anyway; the account of the traffic
//! leaves them out.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use super::arguments::Array;
use super::compiled::Pipeline;
use super::moves::bytes;
use super::source::Precision;

/// Dispatches whose timestamps a set holds.
pub(super) const DISPATCHES: usize = wgpu::QUERY_SET_MAX_QUERIES as usize / 2;
/// Bytes of a timestamp.
pub(super) const STAMP: u64 = size_of::<u64>() as u64;

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
pub(super) struct Sum {
    dispatches: u64,
    seconds: f64,
    pub bytes: Option<u64>,
}

#[derive(Debug, Default)]
pub(super) struct Sums {
    pub kernels: BTreeMap<(&'static str, Precision), Sum>,
    unusable: u64,
    stamped: u64,
    read: u64,
    pub first: Option<Instant>,
    last: Option<Instant>,
}

/// The sums of a device and all its parts.
#[derive(Debug, Default)]
pub(super) struct Profile {
    pub timed: bool,
    /// Seconds of a tick.
    pub period: f64,
    pub sums: Mutex<Sums>,
    pub free: Mutex<Vec<Queries>>,
}

/// What a part of a device has of a profile.
#[derive(Debug, Default)]
pub(super) struct Profiling {
    pub profile: Arc<Profile>,
    /// Lists that were sent and not waited for yet.
    pub pending: Mutex<Vec<Stamps>>,
}

/// Queries, and the way of their answers to the host.
#[derive(Debug)]
pub(super) struct Queries {
    pub queries: wgpu::QuerySet,
    pub resolved: wgpu::Buffer,
    pub mapped: wgpu::Buffer,
}

/// A bound kernel as a profile knows it.
#[derive(Debug)]
pub(super) struct Moved {
    pub pipeline: Arc<Pipeline>,
    pub arrays: Vec<Array>,
}

impl Moved {
    /// Its name and precision.
    pub fn kernel(&self) -> (&'static str, Precision) {
        (self.pipeline.kernel.name, self.pipeline.precision)
    }

    /// Bytes of a dispatch, where they are known.
    pub fn bytes(&self, slots: usize, vectors: usize) -> Option<u64> {
        bytes(self.pipeline.kernel, &self.arrays, slots, vectors)
    }
}

/// The timestamps of a list of kernels that is being made, or was sent.
#[derive(Debug, Default)]
pub(super) struct Stamps {
    pub sets: Vec<Queries>,
    pub dispatches: Vec<((&'static str, Precision), Option<u64>)>,
}

pub(super) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Profile {
    /// Adds what a list dispatched, when it is sent.
    pub fn sent(&self, stamps: &Stamps) {
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
    pub fn add(&self, stamps: &Stamps, ticks: &[u64]) {
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

    /// The sums up to now.
    pub fn times(&self) -> KernelTimes {
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

/// Adds bytes where they are known.
pub(super) fn add(sum: &mut Option<u64>, bytes: Option<u64>) {
    if let Some(bytes) = bytes {
        *sum.get_or_insert_default() += bytes;
    }
}

/// Seconds between two timestamps; `None` where a driver has left one out or they go backwards.
fn seconds([begin, end]: [u64; 2], period: f64) -> Option<f64> {
    (begin != 0 && end >= begin).then(|| (end - begin) as f64 * period)
}

impl Stamps {
    /// Bytes of the timestamps in each set.
    pub fn bytes_by_set(&self) -> impl Iterator<Item = u64> {
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
