//! The account of device memory.

use super::adapters::AdapterKind;
use super::error::GpuError;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// The environment variable for the device memory budget, MiB.
pub const MEMORY_VARIABLE: &str = "ASPERITY_GPU_MEMORY";
const MIB: u64 = 1 << 20;

/// Our own account of device memory. Drivers overcommit: a device may accept twice what it has and
/// fail long after.
#[derive(Debug)]
pub struct MemoryBudget {
    limit: u64,
    used: AtomicU64,
}

impl MemoryBudget {
    /// A budget of `limit` bytes.
    pub fn new(limit: u64) -> Self {
        Self { limit, used: AtomicU64::new(0) }
    }

    /// The budget from `ASPERITY_GPU_MEMORY` (MiB). Else, of a GPU with its own memory, four fifths
    /// of that, or 4 GiB where the driver does not tell `own`; and 2 GiB where memory is shared
    /// with the CPU.
    pub fn for_adapter(kind: AdapterKind, own: Option<u64>) -> Self {
        let default = usual_mib(kind, own);
        let mib: u64 = match std::env::var(MEMORY_VARIABLE) {
            Err(_) => default,
            Ok(text) => text.trim().parse().unwrap_or_else(|_| {
                log::warn!("{MEMORY_VARIABLE}={text} is not a whole number of MiB; {default} is used");
                default
            }),
        };
        Self::new(mib.saturating_mul(MIB))
    }

    /// The budget, bytes.
    pub fn limit(&self) -> u64 {
        self.limit
    }

    /// What is taken, bytes.
    pub fn used(&self) -> u64 {
        self.used.load(Ordering::Relaxed)
    }

    /// Takes `bytes` for `what` until the reservation is dropped.
    ///
    /// # Errors
    /// [`GpuError::OutOfBudget`].
    pub fn reserve(self: &Arc<Self>, what: &str, bytes: u64) -> Result<Reservation, GpuError> {
        let fits = |used: u64| used.checked_add(bytes).filter(|&sum| sum <= self.limit);
        match self.used.fetch_update(Ordering::Relaxed, Ordering::Relaxed, fits) {
            Ok(_) => Ok(Reservation { budget: Arc::clone(self), bytes }),
            Err(used) => Err(GpuError::OutOfBudget {
                what: what.to_owned(),
                needed_mib: bytes as f64 / MIB as f64,
                used_mib: used as f64 / MIB as f64,
                budget_mib: self.limit as f64 / MIB as f64,
            }),
        }
    }
}

/// A share of a [`MemoryBudget`], given back when dropped.
#[derive(Debug)]
pub struct Reservation {
    budget: Arc<MemoryBudget>,
    bytes: u64,
}

/// The budget without `ASPERITY_GPU_MEMORY`, MiB.
fn usual_mib(kind: AdapterKind, own: Option<u64>) -> u64 {
    match (kind, own) {
        (AdapterKind::Discrete | AdapterKind::Virtual, Some(own)) => own / MIB * 4 / 5,
        (AdapterKind::Discrete | AdapterKind::Virtual, None) => 4096,
        _ => 2048,
    }
}

impl Drop for Reservation {
    fn drop(&mut self) {
        self.budget.used.fetch_sub(self.bytes, Ordering::Relaxed);
    }
}

/// The buffer that downloads are mapped from, with the running number of the last ticket.
pub(super) struct Staging {
    pub mapped: wgpu::Buffer,
    pub ticket: wgpu::Buffer,
    pub number: u64,
    #[expect(dead_code, reason = "given back when dropped")]
    pub reservation: Reservation,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_device_with_memory_of_its_own_is_used_nearly_whole() {
        assert_eq!(usual_mib(AdapterKind::Discrete, Some(80 << 30)), 64 << 10);
        assert_eq!(usual_mib(AdapterKind::Virtual, None), 4 << 10);
        assert_eq!(usual_mib(AdapterKind::Integrated, Some(80 << 30)), 2 << 10);
        assert_eq!(usual_mib(AdapterKind::Software, Some(80 << 30)), 2 << 10);
    }

    #[test]
    fn a_reservation_is_given_back() {
        let budget = Arc::new(MemoryBudget::new(10 * MIB));
        let first = budget.reserve("a", 6 * MIB).unwrap();
        let error = budget.reserve("tangents", 5 * MIB).unwrap_err();
        let expected = GpuError::OutOfBudget { what: "tangents".into(), needed_mib: 5.0, used_mib: 6.0, budget_mib: 10.0 };
        assert_eq!(error, expected);
        assert!(error.to_string().contains("tangents needs 5 MiB of device memory, 6 of 10 MiB are taken"), "{error}");
        drop(first);
        let _second = budget.reserve("b", 10 * MIB).unwrap();
        assert_eq!(budget.used(), 10 * MIB);
        assert!(budget.reserve("c", u64::MAX).is_err());
    }
}
