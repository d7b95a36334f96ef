//! What a run costs: time on the wall and of the processor.

use std::time::Instant;

/// Runs since it was started.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    wall: Instant,
    cpu: Option<f64>,
}

impl Clock {
    /// Starts it.
    pub fn start() -> Self {
        Self { wall: Instant::now(), cpu: process_seconds() }
    }

    /// Seconds on the wall since the start.
    pub fn wall_seconds(&self) -> f64 {
        self.wall.elapsed().as_secs_f64()
    }

    /// Processor seconds of the whole process since the start, all threads; `None` where the system does not tell.
    pub fn cpu_seconds(&self) -> Option<f64> {
        Some(process_seconds()? - self.cpu?)
    }
}

#[cfg(unix)]
fn process_seconds() -> Option<f64> {
    use rustix::time::{ClockId, clock_gettime};
    let time = clock_gettime(ClockId::ProcessCPUTime);
    Some(time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64)
}

#[cfg(not(unix))]
fn process_seconds() -> Option<f64> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_takes_time() {
        let clock = Clock::start();
        let sum: f64 = std::hint::black_box((0..3_000_000).map(|i| f64::from(i).sqrt()).sum());
        assert!(sum > 0.0 && clock.wall_seconds() > 0.0);
        // Other tests run in the same process: the processor's time is at least this one's.
        #[cfg(unix)]
        assert!(clock.cpu_seconds().is_some_and(|seconds| seconds > 0.0));
    }
}
