//! Criterion's clock: processor time of the whole process, whatever else the machine does (time on
//! the wall where the system does not tell).

use asperity::output::Clock;
use criterion::measurement::{Measurement, ValueFormatter, WallTime};

/// Processor time in nanoseconds.
pub struct Processor;

impl Measurement for Processor {
    type Intermediate = Clock;
    type Value = f64;

    fn start(&self) -> Clock {
        Clock::start()
    }

    fn end(&self, clock: Clock) -> f64 {
        1e9 * clock.cpu_seconds().unwrap_or_else(|| clock.wall_seconds())
    }

    fn add(&self, a: &f64, b: &f64) -> f64 {
        a + b
    }

    fn zero(&self) -> f64 {
        0.0
    }

    fn to_f64(&self, value: &f64) -> f64 {
        *value
    }

    fn formatter(&self) -> &dyn ValueFormatter {
        // Criterion's own counts nanoseconds too.
        WallTime.formatter()
    }
}
