//! What is proved, and how long it may take.

use crate::compute::gpu::DeviceRequest;

/// A part of what is proved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProofPart {
    /// Each kernel against the CPU.
    Kernels,
    /// Nine whole cases against the CPU.
    Cases,
    /// Latency, copies, whole jobs.
    Times,
}

/// What is proved, and how long it may take.
#[derive(Clone, Debug)]
pub struct Options {
    /// The parts; all if there are none.
    pub only: Vec<ProofPart>,
    /// Which device: a real one, or any.
    pub request: DeviceRequest,
    /// Threads of what is computed on the CPU.
    pub threads: usize,
    /// Two minutes on a software driver, in place of all there is.
    pub quick: bool,
}

impl Options {
    pub(super) fn has(&self, part: ProofPart) -> bool {
        self.only.is_empty() || self.only.contains(&part)
    }
}
