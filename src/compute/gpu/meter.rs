//! Counts what passes between the host and a device.

use std::sync::atomic::{AtomicU64, Ordering};

use crate::compute::traffic::Traffic;

/// The counters of a device, which threads may share.
#[derive(Debug, Default)]
pub(super) struct Meter {
    dispatches: AtomicU64,
    submissions: AtomicU64,
    waits: AtomicU64,
    bytes_up: AtomicU64,
    bytes_down: AtomicU64,
}

impl Meter {
    /// A command list with so many kernels was submitted.
    pub fn submitted(&self, dispatches: u64) {
        self.submissions.fetch_add(1, Ordering::Relaxed);
        self.dispatches.fetch_add(dispatches, Ordering::Relaxed);
    }

    /// The host is about to wait.
    pub fn waited(&self) {
        self.waits.fetch_add(1, Ordering::Relaxed);
    }

    /// Bytes were handed over.
    pub fn went_up(&self, bytes: u64) {
        self.bytes_up.fetch_add(bytes, Ordering::Relaxed);
    }

    /// Bytes were read back.
    pub fn came_down(&self, bytes: u64) {
        self.bytes_down.fetch_add(bytes, Ordering::Relaxed);
    }

    /// The counts so far.
    pub fn read(&self) -> Traffic {
        let of = |counter: &AtomicU64| counter.load(Ordering::Relaxed);
        Traffic {
            dispatches: of(&self.dispatches),
            submissions: of(&self.submissions),
            waits: of(&self.waits),
            bytes_up: of(&self.bytes_up),
            bytes_down: of(&self.bytes_down),
        }
    }
}
