//! What a run costs: time on the wall and of the processor.

use std::time::Instant;

/// Runs since it was started.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    wall: Instant,
    whose: Whose,
    cpu: Option<f64>,
}

/// Whose processor time it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Whose {
    Process,
    Thread,
}

impl Clock {
    /// Starts it.
    pub fn start() -> Self {
        Self::of(Whose::Process)
    }

    /// Starts one for the work of this thread alone, for runs side by side in one process; it must
    /// be read in the thread that started it.
    pub fn start_for_thread() -> Self {
        Self::of(Whose::Thread)
    }

    fn of(whose: Whose) -> Self {
        Self { wall: Instant::now(), whose, cpu: cpu_seconds(whose) }
    }

    /// Seconds on the wall since the start.
    pub fn wall_seconds(&self) -> f64 {
        self.wall.elapsed().as_secs_f64()
    }

    /// Processor seconds since the start, of the whole process or of the thread; `None` where the
    /// system does not tell.
    pub fn cpu_seconds(&self) -> Option<f64> {
        Some(cpu_seconds(self.whose)? - self.cpu?)
    }
}

#[cfg(unix)]
fn cpu_seconds(whose: Whose) -> Option<f64> {
    use rustix::time::{ClockId, clock_gettime};
    let time = clock_gettime(match whose {
        Whose::Process => ClockId::ProcessCPUTime,
        Whose::Thread => ClockId::ThreadCPUTime,
    });
    Some(time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64)
}

#[cfg(not(unix))]
fn cpu_seconds(_: Whose) -> Option<f64> {
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

    #[cfg(unix)]
    #[test]
    fn a_threads_clock_does_not_count_the_others_work() {
        let clock = Clock::start_for_thread();
        let work = || std::hint::black_box((0..20_000_000).map(|i| f64::from(i).sqrt()).sum::<f64>());
        let theirs = std::thread::spawn(move || {
            let clock = Clock::start_for_thread();
            work();
            clock.cpu_seconds()
        });
        let theirs = theirs.join().expect("the thread ends").expect("this system tells");
        let ours = clock.cpu_seconds().expect("this system tells");
        assert!(theirs > 0.0 && ours < 0.5 * theirs, "{ours} and {theirs}");
    }
}
