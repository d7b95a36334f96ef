//! Is the device still the one that computed these numbers?

use super::error::GpuError;
use std::sync::{Mutex, PoisonError};

/// The first fault of a device, kept for good: a device that failed once is not used again.
///
/// wgpu reports a lost device to a callback only; submissions to it are silently dropped, and
/// mapped buffers show what they held before. Every download asks here after its wait and before
/// its numbers are handed on.
#[derive(Debug, Default)]
pub struct DeviceHealth {
    fault: Mutex<Option<GpuError>>,
}

impl DeviceHealth {
    /// Records a fault; the first one stays.
    pub fn fail(&self, fault: GpuError) {
        let mut slot = self.fault.lock().unwrap_or_else(PoisonError::into_inner);
        if slot.is_none() {
            log::debug!("{fault}");
            *slot = Some(fault);
        }
    }

    /// The fault, if there was one.
    ///
    /// # Errors
    /// The first fault recorded, at every call from then on.
    pub fn check(&self) -> Result<(), GpuError> {
        match &*self.fault.lock().unwrap_or_else(PoisonError::into_inner) {
            None => Ok(()),
            Some(fault) => Err(fault.clone()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_fault_stays() {
        let health = DeviceHealth::default();
        assert_eq!(health.check(), Ok(()));
        health.fail(GpuError::Lost { reason: "first".into() });
        health.fail(GpuError::Stale { what: "second".into() });
        assert_eq!(health.check(), Err(GpuError::Lost { reason: "first".into() }));
        assert_eq!(health.check(), Err(GpuError::Lost { reason: "first".into() }));
    }
}
