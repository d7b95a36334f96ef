//! Times and bytes of each kernel of a whole job, beside what a copy on the device makes.
//!
//! Times are of timestamps around every dispatch ([`crate::compute::gpu::profile`]), bytes what it
//! moves at the least ([`crate::compute::gpu::moves`]).

use std::fmt::Write;

use serde::Serialize;

use super::table::{align, number};
use crate::compute::gpu::KernelTimes;

/// A kernel in a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BenchKernel {
    /// Its name.
    pub kernel: &'static str,
    /// f64 or f32.
    pub precision: String,
    /// How often it was dispatched.
    pub dispatches: u64,
    /// Seconds on the device; none where it has no timestamps.
    pub seconds: Option<f64>,
    /// Share of the seconds of all kernels.
    pub share: Option<f64>,
    /// Bytes that it moved at the least; none where that is not known.
    pub bytes: Option<u64>,
    /// Bytes a second.
    pub bytes_per_s: Option<f64>,
    /// That over the rate of a copy on the device.
    pub share_of_copy: Option<f64>,
}

/// The kernels of a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct KernelShares {
    /// Cases at a time.
    pub batch: usize,
    /// The device.
    pub device: String,
    /// Seconds on the wall for the run, setting up included, with timestamps.
    pub wall_s: f64,
    /// Seconds from the first kernel to the last.
    pub span_s: f64,
    /// Seconds of all kernels; none where the device has no timestamps.
    pub kernels_s: Option<f64>,
    /// Why seconds are missing, or not all of them are there, for people; empty if all are.
    pub missing: Vec<String>,
    /// Bytes a second of a copy on the device, read and written together.
    pub copy_bytes_per_s: f64,
    /// The kernels, those that took longest first.
    pub kernels: Vec<BenchKernel>,
}

impl KernelShares {
    /// What the kernels of a run of `batch` cases on `device` came to, which took `wall_s` seconds,
    /// where a copy moves `copy` bytes a second.
    pub fn new((batch, device): (usize, String), wall_s: f64, copy: f64, times: &KernelTimes) -> Self {
        let mut missing = Vec::new();
        if !times.timed {
            missing.push(format!("NO TIMES BY KERNEL: {device} has no timestamps (TIMESTAMP_QUERY)"));
        }
        for (count, why) in [
            (times.unusable, "have timestamps that are zero or go backwards"),
            (times.unread, "have timestamps that were not read"),
        ] {
            if count > 0 {
                missing.push(format!("{count} dispatches {why}: their seconds are missing"));
            }
        }
        let all: f64 = times.kernels.iter().map(|kernel| kernel.seconds).sum();
        let mut kernels: Vec<BenchKernel> = times
            .kernels
            .iter()
            .map(|of| {
                let seconds = times.timed.then_some(of.seconds);
                let per_s = seconds.zip(of.bytes).filter(|(seconds, _)| *seconds > 0.0).map(|(s, bytes)| bytes as f64 / s);
                BenchKernel {
                    kernel: of.kernel,
                    precision: of.precision.to_string(),
                    dispatches: of.dispatches,
                    seconds,
                    share: seconds.filter(|_| all > 0.0).map(|seconds| seconds / all),
                    bytes: of.bytes,
                    bytes_per_s: per_s,
                    share_of_copy: per_s.map(|rate| rate / copy),
                }
            })
            .collect();
        let rank = |kernel: &BenchKernel| (kernel.seconds.unwrap_or(0.0), kernel.dispatches as f64);
        kernels.sort_by(|a, b| rank(b).0.total_cmp(&rank(a).0).then(rank(b).1.total_cmp(&rank(a).1)));
        let (span_s, kernels_s) = (times.span, times.timed.then_some(all));
        Self { batch, device, wall_s, span_s, kernels_s, missing, copy_bytes_per_s: copy, kernels }
    }
}

/// The kernels of a run as a table, and what they are together beside its time on the wall.
pub fn table(of: &KernelShares) -> String {
    let mut text = String::new();
    let jobs = if of.batch == 1 { "job" } else { "jobs" };
    let _ = writeln!(text, "kernels of {} {jobs} on {}, in another run, with timestamps", of.batch, of.device);
    for why in &of.missing {
        let _ = writeln!(text, "{why}");
    }
    let head = ["kernel", "precision", "dispatches", "s", "share", "GB", "GB/s", "copy"];
    let mut lines = vec![head.map(str::to_owned).to_vec()];
    let show = |x: Option<f64>| x.map_or(String::new(), number);
    let percent = |x: Option<f64>| x.map_or(String::new(), |x| format!("{:.1} %", 100.0 * x));
    for kernel in &of.kernels {
        lines.push(vec![
            kernel.kernel.to_owned(),
            kernel.precision.clone(),
            kernel.dispatches.to_string(),
            show(kernel.seconds),
            percent(kernel.share),
            show(kernel.bytes.map(|bytes| 1e-9 * bytes as f64)),
            show(kernel.bytes_per_s.map(|rate| 1e-9 * rate)),
            percent(kernel.share_of_copy),
        ]);
    }
    align(&mut text, &lines, 2);
    let dispatches: u64 = of.kernels.iter().map(|kernel| kernel.dispatches).sum();
    let _ = match of.kernels_s {
        Some(all) => writeln!(
            text,
            "kernels together: {dispatches} dispatches, {} s: {:.0} % of the {} s in which they were sent and {:.0} % of the \
             {} s on the wall, set-up included; in the rest the device copied or waited for the host",
            number(all),
            100.0 * all / of.span_s,
            number(of.span_s),
            100.0 * all / of.wall_s,
            number(of.wall_s)
        ),
        None => writeln!(text, "kernels together: {dispatches} dispatches in {} s on the wall", number(of.wall_s)),
    };
    let _ = writeln!(
        text,
        "bytes are the least that a kernel must move: each array once for reading and once for writing, empty where that is not \
         known; copy is the share of the {} GB/s of a copy there (beyond 100 %: from caches)",
        number(1e-9 * of.copy_bytes_per_s)
    );
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compute::gpu::{KernelTime, Precision};

    fn times(timed: bool, unusable: u64) -> KernelTimes {
        let of = |kernel, precision, dispatches, seconds, bytes| KernelTime { kernel, precision, dispatches, seconds, bytes };
        let kernels = vec![
            of("short", Precision::F64, 10, if timed { 0.5 } else { 0.0 }, None),
            of("long", Precision::F32, 4, if timed { 1.5 } else { 0.0 }, Some(3_000_000_000)),
        ];
        KernelTimes { kernels, timed, unusable, unread: 0, span: 4.0 }
    }

    #[test]
    fn the_longest_comes_first_with_its_share_of_a_copy() {
        let of = KernelShares::new((2, "a card".to_owned()), 5.0, 8e9, &times(true, 3));
        let first = &of.kernels[0];
        assert_eq!(
            (first.kernel, first.share, first.bytes_per_s, first.share_of_copy),
            ("long", Some(0.75), Some(2e9), Some(0.25))
        );
        assert_eq!((of.kernels[1].bytes, of.kernels[1].bytes_per_s, of.kernels_s), (None, None, Some(2.0)));
        let text = table(&of);
        assert!(text.contains("| long   | f32       |          4 |  1.50 | 75.0 % | 3.00 | 2.00 | 25.0 % |"), "{text}");
        assert!(text.contains("| short  | f64       |         10 | 0.500 | 25.0 % |      |      |        |"), "{text}");
        assert!(text.contains("14 dispatches, 2.00 s: 50 % of the 4.00 s") && text.contains("40 % of the 5.00 s"), "{text}");
        assert!(text.contains("3 dispatches have timestamps that are zero or go backwards"), "{text}");
    }

    #[test]
    fn without_timestamps_that_is_said() {
        let of = KernelShares::new((1, "a card".to_owned()), 5.0, 8e9, &times(false, 0));
        assert!(of.kernels_s.is_none() && of.kernels.iter().all(|kernel| kernel.seconds.is_none() && kernel.share.is_none()));
        let text = table(&of);
        assert!(text.contains("NO TIMES BY KERNEL: a card has no timestamps"), "{text}");
        assert!(text.contains("14 dispatches in 5.00 s on the wall") && !text.contains("NaN"), "{text}");
    }
}
