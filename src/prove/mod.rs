//! A device against the CPU, whole: what `asperity prove` finds on a machine, for people who have
//! the card at hand and for those who have not.
//!
//! [`kernels`] runs each kernel's comparisons, [`parity`] nine whole cases; [`latency`] and
//! [`crate::bench`] measure. [`page`] writes what was found as Markdown. A report has no name of a
//! host, of a user or of a folder.

pub mod kernels;
pub mod latency;
mod options;
pub mod page;
pub mod parity;
pub mod progress;

use std::collections::BTreeSet;
use std::sync::Arc;

use serde::Serialize;
use serde_json::Value;

use crate::bench::copy::CopyRates;
use crate::bench::whole_job::{self, WholeJobs, WholeReport};
use crate::bench::{self, BenchError, ThreadPools};
use crate::compute::gpu::adapters::AdapterKind;
use crate::compute::gpu::report::{adapter_json, needs_json};
use crate::compute::gpu::{DeviceRequest, GpuContext, GpuError, Precision};
use crate::compute::select::DeviceChoice;
use crate::conformance::comparisons;
use kernels::KernelReport;
use latency::Latency;
use parity::DeviceParity;
use progress::ProveProgress;

pub use options::{Options, ProofPart};

/// The first key of a report: what it is and its layout.
pub const FORMAT: &str = "asperity-prove/1";

/// Whole jobs on one mesh.
#[derive(Clone, Debug, Serialize)]
pub struct Jobs {
    /// Elements along the contact radius.
    pub elements: usize,
    /// Jobs on one core, on all cores and on the device in batches, and the kernels of some.
    #[serde(flatten)]
    pub report: WholeReport,
    /// Batches that were left out because the device has no memory for them.
    pub too_large: Vec<usize>,
    /// The smallest batch at which a job on the device takes less time than on all cores; none
    /// where no batch does.
    pub breaks_even_at: Option<usize>,
    /// Why there are none, if they could not be computed.
    pub failed: Option<String>,
}

/// Everything that was found.
#[derive(Clone, Debug, Serialize)]
pub struct ProofReport {
    /// [`FORMAT`].
    pub format: &'static str,
    /// Version of the program.
    pub version: &'static str,
    /// Operating system and kind of processor.
    pub system: String,
    /// The processor, as the system names it.
    pub processor: String,
    /// Threads of what was computed on the CPU.
    pub threads: usize,
    /// Whether it was the quick run.
    pub quick: bool,
    /// Whole sentences on what that leaves out.
    pub left_out: Vec<String>,
    /// Whether the device computes on the CPU: no measure of any GPU.
    pub software: bool,
    /// The adapter with its limits, as `asperity devices --json` has it.
    pub adapter: Value,
    /// What the kernels need of it.
    pub needs: Value,
    /// Each kernel against the CPU.
    pub kernels: KernelReport,
    /// Whole cases against the CPU.
    pub parity: DeviceParity,
    /// What a dispatch costs; none where that was not measured.
    pub latency: Option<Latency>,
    /// What memory can do, bytes a second; none where that was not measured.
    pub copies: Option<CopyRates>,
    /// Whole jobs.
    pub jobs: Vec<Jobs>,
    /// Whole sentences on what disagrees or failed; empty where nothing did.
    pub disagreements: Vec<String>,
}

impl ProofReport {
    /// Whether everything that was compared agrees.
    pub fn agrees(&self) -> bool {
        self.disagreements.is_empty()
    }

    /// Indented JSON.
    pub fn to_json(&self) -> String {
        // Plain numbers, words and lists: nothing that could fail.
        serde_json::to_string_pretty(self).unwrap_or_default() + "\n"
    }
}

/// Opens the device that is to be proved; none where only a software adapter is there and a real
/// one was asked for.
///
/// # Errors
/// As [`GpuContext::open`].
pub fn open(request: DeviceRequest) -> Result<Option<GpuContext>, GpuError> {
    GpuContext::open(request)
}

fn opened(request: DeviceRequest) -> Result<GpuContext, GpuError> {
    open(request)?.ok_or(GpuError::NoAdapter)
}

/// Work of the parts, in the units of [`ProveProgress::begins`].
pub fn work(options: &Options) -> f64 {
    let of = |part: ProofPart, work: f64| if options.has(part) { work } else { 0.0 };
    let jobs: f64 = plans(options).iter().map(|&(elements, batches)| weight(elements, batches)).sum();
    let kernels = kernels::comparisons_of(true, options.quick).len() as f64;
    of(ProofPart::Kernels, kernels)
        + of(ProofPart::Cases, if options.quick { 15.0 } else { 70.0 })
        + of(ProofPart::Times, 1.0 + jobs)
}

/// How it went, for people: a line for each disagreement, or one.
pub fn verdict(report: &ProofReport) -> String {
    if report.agrees() {
        let (comparisons, cases) = (report.kernels.comparisons.len(), report.parity.rows.iter().map(|row| row.cases.len()));
        return format!("all agree: {comparisons} comparisons of kernels, {} whole cases\n", cases.sum::<usize>());
    }
    report.disagreements.iter().fold(String::new(), |text, line| text + "disagrees: " + line + "\n")
}

/// The whole report.
///
/// # Errors
/// What keeps it from being made at all: no device, no threads. What disagrees is in the report.
pub fn run(options: &Options, progress: &mut ProveProgress) -> Result<ProofReport, BenchError> {
    let context = opened(options.request)?;
    let adapter = context.adapter().clone();
    let has_double = context.supports(Precision::F64).is_ok();
    let has = |part: ProofPart| options.has(part);
    let kernels =
        if has(ProofPart::Kernels) { kernels::compare(context, options.quick, progress) } else { KernelReport::default() };
    // The others open the device for themselves: one that was lost harms none of them.
    let parity = if has(ProofPart::Cases) { parity::compare(options, has_double, progress) } else { DeviceParity::default() };
    let mut disagreements = kernels.disagreements();
    disagreements.extend(parity.disagreements());
    if has(ProofPart::Kernels) && has(ProofPart::Cases) {
        let nowhere = kernels.not_compared.iter().filter(|kernel| !parity.kernels.contains(kernel));
        disagreements.extend(nowhere.map(|kernel| format!("{kernel}: it took part in nothing that was compared")));
    }
    let (mut latency, mut copies, mut jobs) = (None, None, Vec::new());
    if has(ProofPart::Times) {
        progress.begins("latency and copies", 1.0);
        let mut failed = |what: &str, why: String| disagreements.push(format!("{what}: {why}"));
        latency = measured(options, latency::measure).map_err(|why| failed("latency", why)).ok();
        copies = measured(options, |context| copy_rates(options, &context)).map_err(|why| failed("copies", why)).ok();
        jobs = all_jobs(options, progress);
        disagreements.extend(jobs.iter().filter_map(|jobs| jobs.failed.as_ref().map(|why| format!("whole jobs: {why}"))));
    }
    Ok(ProofReport {
        format: FORMAT,
        version: env!("CARGO_PKG_VERSION"),
        system: format!("{} on {}", std::env::consts::OS, std::env::consts::ARCH),
        processor: bench::report::processor(),
        threads: options.threads,
        quick: options.quick,
        left_out: left_out(options, has_double),
        software: adapter.kind == AdapterKind::Software,
        adapter: adapter_json(&adapter),
        needs: needs_json(),
        kernels,
        parity,
        latency,
        copies,
        jobs,
        disagreements,
    })
}

/// What the quick run leaves out of its parts, in whole sentences.
fn left_out(options: &Options, has_double: bool) -> Vec<String> {
    if !options.quick {
        return Vec::new();
    }
    let mut said = Vec::new();
    if options.has(ProofPart::Kernels) {
        let long: Vec<&str> = comparisons(has_double).iter().filter(|of| of.is_long()).map(|of| of.name).collect();
        let long: BTreeSet<&str> = long.into_iter().collect();
        said.push(format!("Kernels are not compared on: {}.", long.into_iter().collect::<Vec<_>>().join("; ")));
    }
    if options.has(ProofPart::Cases) {
        said.extend(parity::left_out(has_double));
    }
    if options.has(ProofPart::Times) {
        let jobs = "Whole jobs are those at 4 elements, two at a time: larger meshes and other batches are not run, and the \
                    smallest batch that pays is not found.";
        said.push(jobs.to_owned());
    }
    said
}

/// A measurement on a device that is opened for it.
fn measured<T>(options: &Options, measure: impl FnOnce(Arc<GpuContext>) -> Result<T, BenchError>) -> Result<T, String> {
    let context = opened(options.request).map_err(|error| error.to_string())?;
    measure(Arc::new(context)).map_err(|error| error.to_string())
}

fn copy_rates(options: &Options, context: &GpuContext) -> Result<CopyRates, BenchError> {
    let of_bench = bench::Options::quick(bench::BenchDevice::Gpu, options.threads);
    let copied = if options.quick { of_bench.copied / 4 } else { 256 << 20 };
    CopyRates::measure(&bench::Options { copied, ..of_bench }, Some(context), &ThreadPools::new(options.threads)?)
}

/// Bytes of a case on a device for each unknown: 89 MB for 45,810 (docs/performance.md).
const BYTES_AN_UNKNOWN: f64 = 1_943.0;

/// Meshes, and the batches on each.
fn plans(options: &Options) -> &'static [(usize, &'static [usize])] {
    if options.quick { &[(4, &[2])] } else { &[(6, &[1, 8, 64, 256]), (16, &[1, 8, 64, 256])] }
}

/// Work of the jobs on a mesh, beside that of a comparison.
fn weight(elements: usize, batches: &[usize]) -> f64 {
    (elements as f64 / 4.0).powf(2.5) * (4 + 2 * batches.iter().sum::<usize>()) as f64
}

fn all_jobs(options: &Options, progress: &mut ProveProgress) -> Vec<Jobs> {
    let memory = opened(options.request).map_or(0, |context| context.budget().limit());
    plans(options).iter().map(|&(elements, batches)| whole_jobs(options, elements, batches, memory, progress)).collect()
}

fn whole_jobs(options: &Options, elements: usize, batches: &[usize], memory: u64, progress: &mut ProveProgress) -> Jobs {
    // Unknowns grow as the power 2.25 of the elements: 2,020 at 4 and 45,810 at 16.
    let unknowns = 45_810.0 * (elements as f64 / 16.0).powf(2.25);
    let fits = |batch: &usize| *batch as f64 * unknowns * BYTES_AN_UNKNOWN <= memory as f64 || *batch == 1;
    let (batches, too_large): (Vec<usize>, Vec<usize>) = batches.iter().copied().partition(fits);
    let (weight, steps) = (weight(elements, &batches), 5.0 + batches.len() as f64);
    let copied = if options.quick { 16 << 20 } else { 256 << 20 };
    let of_bench = WholeJobs { device: DeviceChoice::Gpu, threads: options.threads, batches, elements, copied };
    let mut say = |text: &str| progress.begins(&format!("{elements} elements: {text}"), weight / steps);
    match whole_job::run(&of_bench, &mut say) {
        Ok(report) => {
            let breaks_even_at = breaks_even_at(&report, options.threads);
            Jobs { elements, report, too_large, breaks_even_at, failed: None }
        }
        Err(error) => {
            let report = WholeReport { jobs: Vec::new(), kernels: Vec::new() };
            Jobs { elements, report, too_large, breaks_even_at: None, failed: Some(error.to_string()) }
        }
    }
}

/// The smallest batch whose jobs take less time each than those on all cores.
fn breaks_even_at(report: &WholeReport, threads: usize) -> Option<usize> {
    let each = |job: &whole_job::WholeJob| job.wall_s / job.batch as f64;
    let (on_cpu, on_device): (Vec<_>, Vec<_>) = report.jobs.iter().partition(|job| job.device.starts_with("CPU"));
    let all_cores = each(on_cpu.iter().find(|job| job.batch == threads)?);
    on_device.iter().filter(|job| each(job) < all_cores).map(|job| job.batch).min()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::whole_job::WholeJob;

    #[test]
    fn the_device_breaks_even_where_a_job_takes_less_than_on_all_cores() {
        let job = |device: &str, batch: usize, wall_s: f64| WholeJob {
            device: device.to_owned(),
            precision: "f64".to_owned(),
            batch,
            unknowns: 1,
            newton_iterations: 1,
            krylov_iterations: 1,
            wall_s,
            traffic: None,
            cases_a_call: None,
        };
        let with = |eight: f64| WholeReport {
            jobs: vec![
                job("CPU (1 thread)", 1, 4.0),
                job("CPU (2 threads)", 2, 5.0),
                job("a card", 1, 6.0),
                job("a card", 8, eight),
                job("a card", 64, 64.0),
            ],
            kernels: Vec::new(),
        };
        assert_eq!(breaks_even_at(&with(19.0), 2), Some(8));
        assert_eq!(breaks_even_at(&with(21.0), 2), Some(64));
        assert_eq!(breaks_even_at(&with(19.0), 3), None);
    }
}
