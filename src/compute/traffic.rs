//! What passes between the host and a device: the account from which it is seen whether a run waits
//! for the device or for the way there.

use std::ops::{Add, AddAssign, Sub};

use serde::{Deserialize, Serialize};

/// Counts of what was asked of a device and of the bytes that went there and back.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Traffic {
    /// Kernels that were started, each for all cases that it served.
    pub dispatches: u64,
    /// Command lists that were handed to the queue.
    pub submissions: u64,
    /// Times the host waited for the device.
    pub waits: u64,
    /// Bytes from the host to the device.
    pub bytes_up: u64,
    /// Bytes from the device to the host.
    pub bytes_down: u64,
}

impl Traffic {
    fn with(self, other: Self, f: impl Fn(u64, u64) -> u64) -> Self {
        Self {
            dispatches: f(self.dispatches, other.dispatches),
            submissions: f(self.submissions, other.submissions),
            waits: f(self.waits, other.waits),
            bytes_up: f(self.bytes_up, other.bytes_up),
            bytes_down: f(self.bytes_down, other.bytes_down),
        }
    }
}

impl Add for Traffic {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        self.with(other, u64::saturating_add)
    }
}

impl AddAssign for Traffic {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

/// What came since an earlier reading; nothing where a new device counts from the beginning.
impl Sub for Traffic {
    type Output = Self;

    fn sub(self, earlier: Self) -> Self {
        self.with(earlier, u64::saturating_sub)
    }
}

/// The account of a run, as `summary.json` has it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct DeviceTraffic {
    /// Since the case was given the device, what was needed to begin, to write fields and to keep a
    /// copy of the state included. Where cases share a backend, of all of them.
    #[serde(flatten)]
    pub total: Traffic,
    /// Of the accepted steps, with the attempts that led to them.
    pub steps: Traffic,
}

/// Adds the account of a run up, step by step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Account {
    total: Traffic,
    steps: Traffic,
    /// The last reading of the device's counters.
    last: Traffic,
    on_device: bool,
}

impl Account {
    /// Takes what a step was, and the device's counters after it.
    pub fn step(&mut self, step: Traffic, now: Option<Traffic>) {
        self.steps += step;
        self.read(now);
    }

    /// Takes the device's counters.
    pub fn read(&mut self, now: Option<Traffic>) {
        let Some(now) = now else { return };
        self.total += now - self.last;
        (self.last, self.on_device) = (now, true);
    }

    /// Another device counts from zero.
    pub fn reopened(&mut self) {
        self.last = Traffic::default();
    }

    /// The same for a run that starts over: its steps are no more.
    pub fn starts_over(&mut self) {
        self.reopened();
        self.steps = Traffic::default();
    }

    /// The account; `None` if there was no device.
    pub fn sum(&self) -> Option<DeviceTraffic> {
        self.on_device.then_some(DeviceTraffic { total: self.total, steps: self.steps })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_account_goes_on_with_another_device() {
        let reading = |n: u64| Traffic { dispatches: 7 * n, submissions: n, waits: n, bytes_up: 100 * n, bytes_down: 10 * n };
        let mut account = Account::default();
        account.read(None);
        assert_eq!(account.sum(), None);
        account.step(reading(2), Some(reading(5)));
        account.step(reading(1), Some(reading(7)));
        assert_eq!(account.sum(), Some(DeviceTraffic { total: reading(7), steps: reading(3) }));
        account.reopened();
        account.step(reading(1), Some(reading(2)));
        assert_eq!(account.sum(), Some(DeviceTraffic { total: reading(9), steps: reading(4) }));
        account.starts_over();
        account.read(Some(reading(1)));
        let sum = account.sum().unwrap();
        assert_eq!(sum, DeviceTraffic { total: reading(10), steps: Traffic::default() });
        let json = serde_json::to_value(sum).unwrap();
        assert_eq!((&json["submissions"], &json["steps"]["waits"]), (&10.into(), &0.into()));
    }
}
