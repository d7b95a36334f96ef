//! Whether a device is worth it: a short measurement of it beside the CPU, kept for the next time.
//!
//! What is estimated is a Newton iteration of one case over a plane with 46,000 unknowns, of which
//! forces at points and the latency of dispatches are the two parts that differ most from machine
//! to machine. A batch gains more from a device than one case does.

use super::backend::Gpu;
use super::buffers::DeviceReal;
use super::context::GpuContext;
use super::dispatch::Evaluation;
use super::source::Precision;
use crate::bounded;
use crate::compute::cpu::Cpu;
use crate::compute::{Call, CaseModel, Compute, ComputeError};
use crate::contact::coulomb::Friction;
use crate::contact::rigid::Rigid;
use crate::material::{Elasticity, FlowStress as Hardening, Material};
use crate::mesh::brick::brick;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Elements along an edge of the box that is measured.
const CELLS: usize = 16;
/// Elements of such a mesh: the main job's at 16 elements along the contact radius.
const ELEMENTS: f64 = 14_720.0;
/// Time of an iteration over that of a force on the same mesh: 161 ms and 35 ms on one core.
const FORCES: f64 = 4.6;
/// Dispatches of an iteration, 38 and 30 for each of 4.2 Krylov iterations.
const DISPATCHES: f64 = 164.0;
/// How long each of the two is measured.
const PATIENCE: Duration = Duration::from_millis(25);
/// Longest file that is read.
const MOST_BYTES: u64 = 64 << 10;

/// What a measurement is of.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Of {
    version: String,
    adapter: String,
    driver: String,
    threads: usize,
}

/// What was measured, and what an iteration is estimated at from that.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TrialRun {
    of: Of,
    /// Milliseconds of an iteration on the device.
    pub device_ms: f64,
    /// The same on the CPU with all threads.
    pub cpu_ms: f64,
}

impl TrialRun {
    /// Whether the device is the faster one.
    pub fn takes_device(&self) -> bool {
        self.device_ms < self.cpu_ms
    }

    /// Of a device and the threads of this process: from memory, from the user's cache, or measured
    /// now. A cache that cannot be read or written is none.
    ///
    /// # Errors
    /// What the device says.
    pub fn of(context: &GpuContext) -> Result<Self, ComputeError> {
        static KNOWN: Mutex<Option<TrialRun>> = Mutex::new(None);
        Self::through(context, &mut KNOWN.lock().unwrap_or_else(PoisonError::into_inner), cache().as_deref())
    }

    fn through(context: &GpuContext, known: &mut Option<Self>, cache: Option<&Path>) -> Result<Self, ComputeError> {
        let adapter = context.adapter();
        let of = Of {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            adapter: adapter.name.clone(),
            driver: adapter.driver.clone(),
            threads: rayon::current_num_threads(),
        };
        if let Some(trial) = known.as_ref().filter(|trial| trial.of == of) {
            return Ok(trial.clone());
        }
        if let Some(trial) = cache.and_then(|path| Self::read(path, &of)) {
            return Ok(known.insert(trial).clone());
        }
        let has_double = context.supports(Precision::F64).is_ok();
        let (force, dispatch) = if has_double { on_device::<f64>(context)? } else { on_device::<f32>(context)? };
        let larger = FORCES * ELEMENTS / (CELLS * CELLS * CELLS) as f64;
        let (device_ms, cpu_ms) = (1e3 * (larger * force + DISPATCHES * dispatch), 1e3 * larger * on_cpu()?);
        let trial = Self { of, device_ms, cpu_ms };
        if let Some(path) = cache {
            trial.write(path);
        }
        Ok(known.insert(trial).clone())
    }

    /// The measurement that a file has, if it is of this device and these threads.
    fn read(path: &Path, of: &Of) -> Option<Self> {
        let text = bounded::result_to_string(path, MOST_BYTES).ok()?;
        let trial: Self = serde_json::from_str(&text).ok()?;
        let sound = [trial.device_ms, trial.cpu_ms].iter().all(|ms| ms.is_finite() && *ms > 0.0);
        (sound && trial.of == *of).then_some(trial)
    }

    /// Keeps it for the next time, where that can be done.
    fn write(&self, path: &Path) {
        let write = || {
            path.parent().map_or(Ok(()), std::fs::create_dir_all)?;
            let draft = path.with_extension(format!("{}", std::process::id()));
            std::fs::write(&draft, serde_json::to_string_pretty(self).unwrap_or_default())?;
            std::fs::rename(&draft, path).inspect_err(|_| drop(std::fs::remove_file(&draft)))
        };
        if let Err(error) = write() {
            log::debug!("{}: the measurement of the device is not kept: {error}", path.display());
        }
    }
}

impl fmt::Display for TrialRun {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { of, device_ms, cpu_ms } = self;
        let threads = if of.threads == 1 { "1 thread" } else { &format!("{} threads", of.threads) };
        write!(
            f,
            "by a short measurement an iteration with 46,000 unknowns takes about {device_ms:.1} ms there and {cpu_ms:.1} ms on \
             the CPU with {threads}"
        )
    }
}

/// The file of the measurement in the user's cache folder; none where that is not known.
fn cache() -> Option<PathBuf> {
    let folder = |variable: &str| std::env::var_os(variable).map(PathBuf::from).filter(|path| path.is_absolute());
    let home = || folder("HOME");
    let caches = if cfg!(target_os = "windows") {
        folder("LOCALAPPDATA")
    } else if cfg!(target_os = "macos") {
        home().map(|home| home.join("Library/Caches"))
    } else {
        folder("XDG_CACHE_HOME").or_else(|| home().map(|home| home.join(".cache")))
    };
    Some(caches?.join("asperity").join("device.json"))
}

/// A box that flows plastically.
fn model() -> Result<CaseModel, ComputeError> {
    let impossible = |what: String| ComputeError::Device(format!("what is measured cannot be made: {what}"));
    Ok(CaseModel {
        mesh: Arc::new(brick(CELLS, CELLS, CELLS, [1.0; 3]).map_err(|error| impossible(error.to_string()))?),
        material: Material {
            elasticity: Elasticity::new(1.0, 0.3),
            hardening: Hardening::ideal(2e-3).map_err(|error| impossible(error.to_string()))?,
        },
        friction: Friction::Coulomb(0.3),
        opponent: None,
        image: None,
        surface: Rigid::default(),
    })
}

/// A displacement that takes the box to twice its yield stress, and a call for the force there.
fn call(model: &CaseModel) -> (usize, Call) {
    let displacement: Vec<f64> = model.mesh.nodes.iter().flat_map(|x| [4e-3 * x[2], 0.0, -2e-3 * x[2]]).collect();
    (0, Call::Force { displacement: displacement.into() })
}

/// The shortest of calls repeated for [`PATIENCE`], seconds; at least three.
fn shortest(mut run: impl FnMut() -> Result<(), ComputeError>) -> Result<f64, ComputeError> {
    let (begun, mut best, mut count) = (Instant::now(), f64::INFINITY, 0);
    while count < 3 || begun.elapsed() < PATIENCE {
        let start = Instant::now();
        run()?;
        best = best.min(start.elapsed().as_secs_f64());
        count += 1;
    }
    Ok(best)
}

/// Seconds of a force and of a dispatch that has nearly nothing to do, in a list.
fn on_device<R: DeviceReal>(context: &GpuContext) -> Result<(f64, f64), ComputeError> {
    const SMALL: usize = 64;
    let model = model()?;
    let mut gpu = Gpu::<R>::new(Arc::new(context.part(context.budget().limit())), vec![model.clone()])?;
    // Sends what is needed, and compiles.
    gpu.call(vec![call(&model)])?;
    gpu.repeat(Evaluation::Contact, &[0], 1)?;
    let force = shortest(|| gpu.repeat(Evaluation::InternalForce, &[0], 1))?;
    let small = shortest(|| gpu.repeat(Evaluation::Contact, &[0], SMALL))?;
    Ok((force, small / SMALL as f64))
}

/// Seconds of a force with all threads.
fn on_cpu() -> Result<f64, ComputeError> {
    let model = model()?;
    let mut cpu = Cpu::<f64, f32>::with_tangents(vec![model.clone()])?;
    cpu.call(vec![call(&model)])?;
    shortest(|| cpu.call(vec![call(&model)]).map(drop))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compute::gpu::DeviceRequest;

    fn of(threads: usize) -> Of {
        Of { version: "1".into(), adapter: "a card".into(), driver: "its driver".into(), threads }
    }

    #[test]
    fn a_measurement_is_kept_and_no_file_is_trusted() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("new/folder/device.json");
        let trial = TrialRun { of: of(2), device_ms: 1.5, cpu_ms: 40.25 };
        assert_eq!(TrialRun::read(&path, &of(2)), None);
        trial.write(&path);
        assert_eq!(TrialRun::read(&path, &of(2)), Some(trial.clone()));
        assert_eq!(TrialRun::read(&path, &of(3)), None);
        assert_eq!(std::fs::read_dir(path.parent().unwrap()).unwrap().count(), 1);
        let text = std::fs::read_to_string(&path).unwrap();
        for (from, to) in [("1.5", "-1.5"), ("1.5", "null"), ("40.25", "1e999"), ("{", "["), ("a card", "another")] {
            std::fs::write(&path, text.replace(from, to)).unwrap();
            assert_eq!(TrialRun::read(&path, &of(2)), None, "{from} -> {to}");
        }
        // A folder in its place is no error.
        std::fs::remove_file(&path).unwrap();
        std::fs::create_dir(&path).unwrap();
        trial.write(&path);
        assert_eq!(TrialRun::read(&path, &of(2)), None);
        assert_eq!(std::fs::read_dir(path.parent().unwrap()).unwrap().count(), 1);
    }

    #[test]
    fn the_faster_one_is_taken_and_said() {
        let trial = |device_ms, cpu_ms| TrialRun { of: of(1), device_ms, cpu_ms };
        assert!(trial(1.0, 2.0).takes_device() && !trial(2.0, 1.0).takes_device());
        let said = trial(1.0, 2.0).to_string();
        assert!(said.contains("about 1.0 ms there and 2.0 ms on the CPU with 1 thread"), "{said}");
    }

    /// On any adapter, as a measurement of a real one goes.
    #[test]
    fn a_measurement_is_made_once() {
        let Ok(Some(context)) = GpuContext::open(DeviceRequest::Gpu) else {
            eprintln!("SKIPPED: no Vulkan adapter (a_measurement_is_made_once)");
            return;
        };
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("device.json");
        let made = TrialRun::through(&context, &mut None, Some(&path)).unwrap();
        assert!(made.device_ms > 0.0 && made.cpu_ms > 0.0 && made.of.adapter == context.adapter().name, "{made:?}");
        assert_eq!(TrialRun::through(&context, &mut None, Some(&path)).unwrap(), made);
        assert_eq!(TrialRun::through(&context, &mut Some(made.clone()), None).unwrap(), made);
        assert_eq!(context.budget().used(), 0);
        eprintln!("{made}");
    }
}
