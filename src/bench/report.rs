//! What was measured, as it goes into a file.

use std::time::{SystemTime, UNIX_EPOCH};

use serde::Serialize;

use super::Options;
use super::copy::CopyRates;
use super::timing::Timing;
use crate::compute::gpu::GpuContext;

/// Where and how it was measured.
#[derive(Clone, Debug, Serialize)]
pub struct Header {
    /// Version of the program.
    pub version: &'static str,
    /// Day in UTC, year-month-day.
    pub date: String,
    /// The processor, as the system names it.
    pub processor: String,
    /// Threads of the rows on all cores.
    pub threads: usize,
    /// The device; none where there is only the CPU.
    pub adapter: Option<BenchedDevice>,
    /// Why there is no device though one was not ruled out, for people.
    pub no_device: Option<String>,
    /// Elements along the contact radius of the bench's mesh.
    pub elements_per_contact_radius: usize,
    /// Material points a case of the return mapping.
    pub points_per_case: usize,
    /// How operations and bytes were counted, for people.
    pub counted: &'static str,
    /// What memory can do.
    pub copy: CopyRates,
}

/// A device.
#[derive(Clone, Debug, Serialize)]
pub struct BenchedDevice {
    /// Its name.
    pub name: String,
    /// What sort of machine.
    pub kind: String,
    /// Whether it computes on the CPU: no measure of any GPU.
    pub software: bool,
    /// Driver interface.
    pub backend: String,
    /// Driver and version.
    pub driver: String,
    /// Features and limits that matter here.
    pub features: Vec<String>,
    /// Memory that may be used, MiB.
    pub memory_budget_mib: f64,
}

/// Counting in a paragraph.
const COUNTED: &str = "bytes: every array that the kernels of an evaluation read or write counts once a kernel, as stored on that side; operations: \
                       of the CPU's kernels, run on numbers that count (+ - * / sqrt exp ln pow one each, a fused multiply-add two), on both sides; \
                       copies: bytes read and written; rates of a device: of its kernels, without transfers";

impl Header {
    /// Of this machine, with the copies still to be measured; `missing` says why there is no device
    /// though one was not ruled out.
    pub fn new(options: &Options, context: Option<&GpuContext>, missing: Option<String>) -> Self {
        let adapter = context.map(|context| {
            let a = context.adapter();
            let yes = |what: &str, there: bool| there.then(|| what.to_owned());
            let features = [yes("f64", a.double_precision), yes("timestamps", a.timestamps)];
            let limits = [
                format!("arrays up to {} MiB in a kernel", a.max_binding >> 20),
                format!("{} arrays a kernel", a.limits.storage_buffers),
                format!("workgroups of {}", a.limits.threads),
            ];
            BenchedDevice {
                name: a.name.clone(),
                kind: a.kind.to_string(),
                software: !a.kind.is_real(),
                backend: a.backend.clone(),
                driver: a.driver.clone(),
                features: features.into_iter().flatten().chain(limits).collect(),
                memory_budget_mib: context.budget().limit() as f64 / f64::from(1 << 20),
            }
        });
        let no_device = missing
            .map(|why| format!("NO GPU WAS MEASURED: {why} (`asperity devices` lists what is there). All rows are the CPU's"));
        Self {
            version: env!("CARGO_PKG_VERSION"),
            date: date(),
            processor: processor(),
            threads: options.threads,
            adapter,
            no_device,
            elements_per_contact_radius: options.elements,
            points_per_case: options.points,
            counted: COUNTED,
            copy: CopyRates::default(),
        }
    }

    /// The device in a line; a loud one where there is none.
    pub fn device_line(&self) -> String {
        match (&self.adapter, &self.no_device) {
            (Some(a), _) => {
                let software = if a.software { "; A SOFTWARE DRIVER: NO MEASURE OF ANY GPU" } else { "" };
                format!("device: {} ({}), {}, {}{software}", a.name, a.kind, a.backend, a.driver)
            }
            (None, Some(why)) => why.clone(),
            (None, None) => "device: none asked for, all rows are the CPU's".to_owned(),
        }
    }
}

/// Where a row was computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum On {
    /// The device.
    Device,
    /// One thread.
    OneCore,
    /// All threads.
    AllCores,
}

/// What memory or the device made of a row.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Measurement {
    /// Measured.
    Measured(MeasuredRates),
    /// Not measured, for this reason: it does not fit, or the device cannot.
    Skipped(String),
}

/// The numbers of a row.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MeasuredRates {
    /// The call as the program makes it, with transfers.
    #[serde(flatten)]
    pub call: Timing,
    /// The kernels alone, on a device, milliseconds.
    pub kernels_ms: Option<f64>,
    /// Items a second, by the call.
    pub items_per_s: f64,
    /// Bytes a second: by the kernels on a device, by the call on the CPU.
    pub bytes_per_s: f64,
    /// Floating-point operations a second, likewise.
    pub operations_per_s: f64,
    /// `bytes_per_s` over the rate of a copy there.
    pub share_of_copy: f64,
}

/// An evaluation at a batch size in a place.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RateRow {
    /// What is evaluated.
    pub evaluation: &'static str,
    /// Hardening law.
    pub law: &'static str,
    /// f64 or f32.
    pub precision: &'static str,
    /// Cases a call.
    pub batch: usize,
    /// Where.
    pub on: On,
    /// What is counted: points, elements, contact points.
    pub item: &'static str,
    /// How many of them a call evaluates.
    pub items: usize,
    /// Bytes a call moves at the least.
    pub bytes: usize,
    /// Floating-point operations of a call.
    pub operations: u64,
    /// The numbers.
    pub outcome: Measurement,
}

impl RateRow {
    /// The numbers, if there are any.
    pub fn measured(&self) -> Option<&MeasuredRates> {
        match &self.outcome {
            Measurement::Measured(measured) => Some(measured),
            Measurement::Skipped(_) => None,
        }
    }

    /// The row with its times (or why there are none), where a copy moves `copy` bytes a second.
    pub fn with(mut self, times: Result<(Timing, Option<f64>), String>, copy: Option<f64>) -> Self {
        self.outcome = match times {
            Err(reason) => Measurement::Skipped(reason),
            Ok((call, kernels_ms)) => {
                let seconds = 1e-3 * kernels_ms.unwrap_or(call.median_ms);
                let bytes_per_s = self.bytes as f64 / seconds;
                Measurement::Measured(MeasuredRates {
                    call,
                    kernels_ms,
                    items_per_s: self.items as f64 / (1e-3 * call.median_ms),
                    bytes_per_s,
                    operations_per_s: self.operations as f64 / seconds,
                    share_of_copy: copy.map_or(f64::NAN, |copy| bytes_per_s / copy),
                })
            }
        };
        self
    }
}

/// The time before the first evaluation: compiling kernels and sending a batch.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Setup {
    /// Whose kernels.
    pub evaluation: &'static str,
    /// f64 or f32.
    pub precision: &'static str,
    /// Cases.
    pub batch: usize,
    /// Milliseconds; at the first batch size with compiling, unless the driver has a cache of its
    /// own.
    pub ms: f64,
}

/// Everything that was measured.
#[derive(Clone, Debug, Serialize)]
pub struct RatesReport {
    /// Where and how.
    #[serde(flatten)]
    pub header: Header,
    /// Set-up times of the device.
    pub setups: Vec<Setup>,
    /// The rows: every evaluation, precision and batch size on the device, one core and all cores.
    pub rows: Vec<RateRow>,
}

impl RatesReport {
    /// Indented JSON with an end of line; what is not a number is null.
    pub fn to_json(&self) -> String {
        // Plain numbers, words and lists: nothing that could fail.
        serde_json::to_string_pretty(self).unwrap_or_default() + "\n"
    }
}

/// Today in UTC.
fn date() -> String {
    let seconds = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
    day(seconds / 86_400)
}

/// The civil day after so many days from 1970-01-01 (Hinnant, "chrono-compatible low-level date
/// algorithms", days_from_civil inverted).
fn day(since_1970: u64) -> String {
    let z = since_1970 + 719_468;
    let (era, of_era) = (z / 146_097, z % 146_097);
    let year_of_era = (of_era - of_era / 1460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let from_march = (5 * of_year + 2) / 153;
    let (day, month) = (of_year - (153 * from_march + 2) / 5 + 1, if from_march < 10 { from_march + 3 } else { from_march - 9 });
    let year = era * 400 + year_of_era + u64::from(month <= 2);
    format!("{year:04}-{month:02}-{day:02}")
}

/// The processor's name where the system tells it, else its architecture.
pub(crate) fn processor() -> String {
    let told = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name =
        told.lines().find_map(|line| line.strip_prefix("model name")?.split_once(':').map(|(_, name)| name.trim().to_owned()));
    name.unwrap_or_else(|| std::env::consts::ARCH.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_are_civil() {
        for (days, text) in
            [(0, "1970-01-01"), (59, "1970-03-01"), (11_016, "2000-02-29"), (11_017, "2000-03-01"), (20_778, "2026-11-21")]
        {
            assert_eq!(day(days), text);
        }
    }

    #[test]
    fn rates_follow_from_the_times() {
        let row = RateRow {
            evaluation: "tangent",
            law: "power",
            precision: "f64",
            batch: 2,
            on: On::Device,
            item: "element",
            items: 100,
            bytes: 4000,
            operations: 8000,
            outcome: Measurement::Skipped(String::new()),
        };
        let call = Timing { first_ms: 9.0, median_ms: 4.0, min_ms: 3.0, max_ms: 5.0, repetitions: 3 };
        let on_device = row.clone().with(Ok((call, Some(2.0))), Some(4e6));
        let m = on_device.measured().unwrap();
        assert_eq!((m.items_per_s, m.bytes_per_s, m.operations_per_s, m.share_of_copy), (25e3, 2e6, 4e6, 0.5));
        let on_cpu = row.clone().with(Ok((call, None)), Some(4e6));
        assert_eq!(on_cpu.measured().unwrap().bytes_per_s, 1e6);
        assert_eq!(row.with(Err("too large".into()), None).outcome, Measurement::Skipped("too large".into()));
    }
}
