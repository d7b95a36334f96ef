//! Whole simulations: one on all cores, then batches of them on a device, as a study computes them;
//! and, after these, the same on the device with timestamps around every kernel.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use serde::Serialize;

use super::kernels::{self, KernelShares};
use super::{BenchError, copy};
use crate::compute::gpu::{DeviceRequest, GpuContext};
use crate::compute::select::{DeviceChoice, Devices, PrecisionChoice, SharedCalls};
use crate::compute::traffic::Traffic;
use crate::output::Summary;
use crate::study::{Options, Study, StudyDirectory, StudyError, StudyProgress, backends, run_on};

/// The main job: ideal plasticity, pressed and sheared to full slip; friction coefficients a
/// thousandth apart, so that a batch has as many cases.
fn study(cases: usize, elements: usize) -> Result<Study, StudyError> {
    let friction: Vec<String> = (0..cases).map(|i| format!("{:.3}", 0.3 + 0.001 * i as f64)).collect();
    let text = format!(
        r#"
[base.sphere]
radius = 1.0
[base.material]
youngs_modulus = 200e3
poissons_ratio = 0.3
[base.material.hardening]
law = "ideal"
yield_stress = 400.0
[base.mesh]
elements_per_contact_radius = {elements}
fine_zone = 1.6
[base.solver]
error_estimate = false
[base.output]
fields = "none"
plots = false
[[base.path]]
indentation = 0.02
[[base.path]]
shear = "full-slip"
[grid]
"contact.friction" = [{}]
"#,
        friction.join(", ")
    );
    Study::parse(&text, "the whole job")
}

/// Whole jobs at one batch size.
#[derive(Clone, Debug, Serialize)]
pub struct WholeJob {
    /// Where: "CPU (2 threads)", an adapter's name.
    pub device: String,
    /// Precision of the residual.
    pub precision: String,
    /// Cases at a time.
    pub batch: usize,
    /// Unknowns of a case.
    pub unknowns: usize,
    /// Newton iterations of all cases.
    pub newton_iterations: usize,
    /// Krylov iterations of all cases.
    pub krylov_iterations: usize,
    /// Seconds on the wall for all of them, setting up included.
    pub wall_s: f64,
    /// What passed to the device and back in the steps; none on the CPU. Of a batch it is what its
    /// backend counted while the case with the most of it ran, times the number of backends: about
    /// what all of them moved.
    pub traffic: Option<Traffic>,
    /// Cases that a call of iterates served in the mean, of so many as share a backend; none on the
    /// CPU.
    pub cases_a_call: Option<[f64; 2]>,
}

/// What is run.
#[derive(Clone, Debug)]
pub struct WholeJobs {
    /// The device beside the CPU; none if that is [`DeviceChoice::Cpu`].
    pub device: DeviceChoice,
    /// Threads of the CPU's rows.
    pub threads: usize,
    /// Cases at a time on the device; on the CPU as many as there are threads.
    pub batches: Vec<usize>,
    /// Elements along the contact radius.
    pub elements: usize,
    /// Length of the arrays of a copy on the device, bytes.
    pub copied: usize,
}

/// What the jobs came to.
#[derive(Clone, Debug, Serialize)]
pub struct WholeReport {
    /// The jobs.
    pub jobs: Vec<WholeJob>,
    /// Their kernels on the device, of the smallest and the largest batch.
    pub kernels: Vec<KernelShares>,
}

/// Runs the jobs; `say` is told which.
///
/// # Errors
/// [`BenchError::Study`] if a study cannot be computed or a case fails.
pub fn run(options: &WholeJobs, say: &mut dyn FnMut(&str)) -> Result<WholeReport, BenchError> {
    let mut jobs = Vec::new();
    let cpu = if options.threads > 1 { vec![1, options.threads] } else { vec![1] };
    for batch in cpu {
        say(&format!("{batch} whole jobs on the CPU, a thread each"));
        jobs.push(one(options, DeviceChoice::Cpu, batch)?);
    }
    let mut kernels = Vec::new();
    if options.device != DeviceChoice::Cpu {
        for &batch in &options.batches {
            say(&format!("{batch} whole jobs on the device"));
            jobs.push(one(options, options.device, batch)?);
        }
        say("copies on the device");
        let copied = copy_rate(options)?;
        let mut batches = vec![options.batches.iter().min(), options.batches.iter().max()];
        batches.dedup();
        for &batch in batches.into_iter().flatten() {
            say(&format!("{batch} whole jobs on the device, with timestamps"));
            kernels.extend(profiled(options, batch, copied)?);
        }
    }
    Ok(WholeReport { jobs, kernels })
}

fn one(options: &WholeJobs, device: DeviceChoice, batch: usize) -> Result<WholeJob, BenchError> {
    let begun = Instant::now();
    let devices = Devices::open(device).map_err(StudyError::from)?;
    on(options, (device, &devices), batch, begun)
}

/// Bytes a second of a copy on the device.
fn copy_rate(options: &WholeJobs) -> Result<f64, BenchError> {
    let request = if options.device == DeviceChoice::Gpu { DeviceRequest::Gpu } else { DeviceRequest::Auto };
    Ok(match GpuContext::open(request)? {
        Some(context) => copy::on_device(&context, options.copied)?,
        None => f64::NAN,
    })
}

/// The kernels of a batch, which is computed for them alone: timestamps cost time.
fn profiled(options: &WholeJobs, batch: usize, copied: f64) -> Result<Option<KernelShares>, BenchError> {
    let begun = Instant::now();
    let devices = Devices::profiled(options.device).map_err(StudyError::from)?;
    let job = on(options, (options.device, &devices), batch, begun)?;
    Ok(devices.kernel_times().map(|times| KernelShares::new((batch, job.device), job.wall_s, copied, &times)))
}

/// Whole jobs on a device that was opened at `begun`, or on the CPU.
fn on(
    options: &WholeJobs,
    (device, devices): (DeviceChoice, &Devices),
    batch: usize,
    begun: Instant,
) -> Result<WholeJob, BenchError> {
    let study = study(batch, options.elements)?;
    let dir = ScratchFolder::new(&format!("whole-job-{batch}"));
    let how = Options {
        device,
        precision: PrecisionChoice::Auto,
        threads: options.threads.min(batch),
        shard: None,
        resume: false,
        retry: false,
        force: false,
    };
    let watched = (Arc::new(StudyProgress::new(true)), Arc::new(AtomicBool::new(false)));
    let report = run_on(devices, &study, &dir.0, &how, watched)?;
    let wall_s = begun.elapsed().as_secs_f64();
    if let Some((case, why)) = report.first_failure {
        return Err(BenchError::Case { case, why });
    }
    let mut out: Option<WholeJob> = None;
    for case in &study.cases {
        let directory = StudyDirectory::new(&dir.0).case(&case.id);
        let summary = Summary::read(&directory.summary()).map_err(StudyError::from)?;
        let row = out.get_or_insert_with(|| WholeJob {
            device: summary.device.clone(),
            precision: summary.precision.clone(),
            batch,
            unknowns: summary.unknowns,
            newton_iterations: 0,
            krylov_iterations: 0,
            wall_s,
            traffic: None,
            cases_a_call: None,
        });
        row.newton_iterations += summary.newton_iterations;
        row.krylov_iterations += summary.krylov_iterations;
        if let Some(traffic) = summary.device_traffic {
            // Each case has its own steps' account, in which those of the others are while they
            // share the device: the largest comes nearest to the batch's.
            let most = row.traffic.get_or_insert_default();
            if traffic.steps.bytes_up > most.bytes_up {
                *most = traffic.steps;
            }
        }
    }
    if backends(batch) == 2
        && let Some(WholeJob { traffic: Some(traffic), .. }) = &mut out
    {
        *traffic += *traffic;
    }
    if let (Some(row), SharedCalls { calls: calls @ 1.., cases }) = (&mut out, devices.shared_calls()) {
        row.cases_a_call = Some([cases as f64 / calls as f64, (batch / backends(batch)) as f64]);
    }
    out.ok_or(BenchError::Case { case: "1".to_owned(), why: "there is no case".to_owned() })
}

/// A folder for results that nobody will look at, removed at the end.
pub(crate) struct ScratchFolder(PathBuf);

impl ScratchFolder {
    /// Of this process, with a name among its own.
    pub fn new(name: &str) -> Self {
        Self(std::env::temp_dir().join(format!("asperity-{name}-{}", std::process::id())))
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        &self.0
    }
}

impl Drop for ScratchFolder {
    fn drop(&mut self) {
        // What cannot be removed is left to whoever tidies the temporary files.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// The jobs as a table, and their kernels as others.
pub fn tables(report: &WholeReport) -> String {
    let mut text = table(&report.jobs);
    for of in &report.kernels {
        text.push('\n');
        text.push_str(&kernels::table(of));
    }
    text
}

/// The rows as a table: seconds of a job, iterations a second, and what passes to the device a
/// Newton iteration of a case.
pub fn table(rows: &[WholeJob]) -> String {
    let head =
        ["where", "precision", "jobs", "unknowns", "Newton", "Krylov", "s, all", "s a job", "Newton/s", "kB up", "kB down"];
    let mut lines = vec![head.map(str::to_owned).to_vec()];
    for row in rows {
        let a_newton = |bytes: u64| bytes as f64 / row.newton_iterations.max(1) as f64 / 1e3;
        let traffic = |of: fn(&Traffic) -> u64| row.traffic.map_or(String::new(), |t| format!("{:.0}", a_newton(of(&t))));
        lines.push(vec![
            row.device.clone(),
            row.precision.clone(),
            row.batch.to_string(),
            row.unknowns.to_string(),
            row.newton_iterations.to_string(),
            row.krylov_iterations.to_string(),
            format!("{:.2}", row.wall_s),
            format!("{:.3}", row.wall_s / row.batch as f64),
            format!("{:.1}", row.newton_iterations as f64 / row.wall_s),
            traffic(|t| t.bytes_up),
            traffic(|t| t.bytes_down),
        ]);
    }
    let mut text = String::new();
    super::table::align(&mut text, &lines, 2);
    text
}
