//! Repeated calls on a clock.

use std::time::Instant;

/// How often a call is repeated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patience {
    /// At least so often, unless `enough` is over.
    pub least: usize,
    /// At most so often.
    pub most: usize,
    /// Beyond the least only until so many seconds have gone.
    pub seconds: f64,
    /// After so many seconds a single repetition is enough.
    pub enough: f64,
}

/// Milliseconds on the wall of a first call and of those after it.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Timing {
    /// The first call, which may compile and touch fresh memory; not among the others.
    pub first_ms: f64,
    /// Median of the others.
    pub median_ms: f64,
    /// The fastest.
    pub min_ms: f64,
    /// The slowest.
    pub max_ms: f64,
    /// How many others.
    pub repetitions: usize,
}

/// Calls `f` once and then as often as `patience` says; `f` is told the number of the call.
///
/// # Errors
/// The first error of `f`.
pub fn measure<E>(patience: Patience, mut f: impl FnMut(usize) -> Result<(), E>) -> Result<Timing, E> {
    gather(patience, |i| {
        let start = Instant::now();
        f(i)?;
        Ok(1e3 * start.elapsed().as_secs_f64())
    })
}

/// As [`measure`], of calls that return the milliseconds they took, without what they prepare.
///
/// # Errors
/// The first error of `call`.
pub fn gather<E>(patience: Patience, mut call: impl FnMut(usize) -> Result<f64, E>) -> Result<Timing, E> {
    let first_ms = call(0)?;
    let begun = Instant::now();
    let mut times = vec![call(1)?];
    while times.len() < patience.most {
        let gone = begun.elapsed().as_secs_f64();
        if gone > patience.enough || (gone > patience.seconds && times.len() >= patience.least) {
            break;
        }
        times.push(call(times.len() + 1)?);
    }
    times.sort_by(f64::total_cmp);
    let (min_ms, max_ms) = (times.first().copied().unwrap_or(first_ms), times.last().copied().unwrap_or(first_ms));
    Ok(Timing { first_ms, median_ms: median(&times).unwrap_or(first_ms), min_ms, max_ms, repetitions: times.len() })
}

/// Milliseconds that kernels take one after the other without the way to the device and back: the
/// median of three lists of as many as fill about 20 ms, or a single run of slow ones. `run` runs
/// so many and waits.
///
/// # Errors
/// The first error of `run`.
pub fn of_kernels<E>(mut run: impl FnMut(usize) -> Result<(), E>) -> Result<f64, E> {
    let mut list = |times: usize| {
        let start = Instant::now();
        run(times)?;
        Ok(1e3 * start.elapsed().as_secs_f64() / times as f64)
    };
    let once = list(1)?;
    if once > 200.0 {
        return Ok(once);
    }
    let times = (20.0 / once).ceil().clamp(1.0, 50.0) as usize;
    let mut lists = (0..3).map(|_| list(times)).collect::<Result<Vec<_>, E>>()?;
    lists.sort_by(f64::total_cmp);
    Ok(median(&lists).unwrap_or(once))
}

/// The middle of sorted numbers, or the mean of the two in the middle.
fn median(sorted: &[f64]) -> Option<f64> {
    let (low, high) = (sorted.get((sorted.len().max(1) - 1) / 2)?, sorted.get(sorted.len() / 2)?);
    Some(0.5 * (low + high))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_is_in_the_middle() {
        assert_eq!((median(&[]), median(&[3.0]), median(&[1.0, 2.0, 9.0])), (None, Some(3.0), Some(2.0)));
        assert_eq!(median(&[1.0, 2.0, 4.0, 9.0]), Some(3.0));
    }

    #[test]
    fn calls_are_counted_and_the_first_is_apart() {
        let mut calls = Vec::new();
        let slow_start = |i: usize| {
            calls.push(i);
            std::thread::sleep(std::time::Duration::from_millis(if i == 0 { 30 } else { 1 }));
            Ok::<(), ()>(())
        };
        let timing = measure(Patience { least: 3, most: 3, seconds: 0.0, enough: 9.0 }, slow_start).unwrap();
        assert_eq!((calls, timing.repetitions), (vec![0, 1, 2, 3], 3));
        assert!(timing.first_ms >= 30.0 && timing.min_ms >= 1.0 && timing.min_ms <= timing.median_ms);
        assert!(timing.median_ms <= timing.max_ms);
        let long = Patience { least: 1, most: 9, seconds: 9.0, enough: 9.0 };
        assert_eq!(measure(long, |i| if i < 2 { Ok(()) } else { Err(i) }), Err(2));
        assert_eq!(measure(long, |_| Ok::<(), ()>(())).unwrap().repetitions, 9);
        let impatient = Patience { least: 5, seconds: 0.0, enough: 0.0, ..long };
        assert_eq!(measure(impatient, |_| Ok::<(), ()>(())).unwrap().repetitions, 1);
    }

    #[test]
    fn lists_are_divided_by_their_length() {
        let per_kernel = of_kernels(|times| {
            std::thread::sleep(std::time::Duration::from_millis(times as u64));
            Ok::<(), ()>(())
        });
        assert!((1.0..4.0).contains(&per_kernel.unwrap()));
    }
}
