//! Internal force, tangent, contact and commit of a batch of cases, as the Newton iteration asks
//! for them.

use std::sync::Arc;
use std::time::Instant;

use super::count::{Counted, operations};
use super::input::{mesh, models, squeezed};
use super::report::{Measurement, On, RateRow, RatesReport, Setup};
use super::timing::{Timing, gather, measure as repeat, of_kernels};
use super::traffic::Sizes;
use super::{BenchError, Options, ThreadPools};
use crate::compute::cpu::Cpu;
use crate::compute::gpu::{DeviceReal, Evaluation, Gpu, GpuContext};
use crate::compute::handle::at_contact;
use crate::compute::{Answer, Call, CaseModel, Compute, ComputeError, Evaluated, TangentBlocks};
use crate::memory;
use crate::mesh::Mesh;

/// The evaluations in the order in which they are made, with the names of their rows and what they
/// are counted in.
pub const EVALUATIONS: [(Evaluation, &str, &str); 4] = [
    (Evaluation::InternalForce, "internal force", "element"),
    (Evaluation::Tangent, "tangent", "element"),
    (Evaluation::Contact, "contact", "contact point"),
    (Evaluation::Update, "commit", "element"),
];
/// Strain of the trial displacements, and what is added to it at each commit so that plastic flow
/// goes on.
const SQUEEZE: [f64; 2] = [0.02, 1e-4];

/// What calls of a batch are about, by case.
struct Calls {
    displacement: Vec<Arc<[f64]>>,
    /// What the last calls left: internal forces at the contact nodes, and memory for tangents.
    force: Vec<Vec<f64>>,
    blocks: Vec<TangentBlocks>,
}

impl Calls {
    fn new(models: &[CaseModel], sizes: &Sizes) -> Self {
        Self {
            displacement: models.iter().map(|m| squeezed(&m.mesh, SQUEEZE[0]).into()).collect(),
            force: vec![vec![0.0; 3 * sizes.contact_points]; models.len()],
            blocks: vec![TangentBlocks::Double(vec![[0.0; 9]; sizes.blocks]); models.len()],
        }
    }

    /// Squeezes on.
    fn advance(&mut self, models: &[CaseModel], step: usize) {
        for (u, model) in self.displacement.iter_mut().zip(models) {
            *u = squeezed(&model.mesh, SQUEEZE[0] + SQUEEZE[1] * step as f64).into();
        }
    }

    /// One call for all cases.
    fn make(&mut self, backend: &mut dyn Compute, evaluation: Evaluation) -> Result<(), ComputeError> {
        let call = |(case, u): (usize, &Arc<[f64]>)| {
            let displacement = u.clone();
            let call = match evaluation {
                Evaluation::InternalForce => Call::Force { displacement },
                Evaluation::Tangent => {
                    let none = self.blocks[case].none();
                    Call::Tangent { displacement, blocks: std::mem::replace(&mut self.blocks[case], none) }
                }
                Evaluation::Contact => {
                    let displacement = at_contact(&backend.models()[case].mesh, u);
                    Call::Contact { displacement, force: self.force[case].clone() }
                }
                Evaluation::Update => Call::Commit { displacement },
            };
            (case, call)
        };
        let calls = self.displacement.iter().enumerate().map(call).collect();
        for (case, answer) in backend.call(calls)?.into_iter().enumerate() {
            match answer {
                Answer::Force { force, outcome } => {
                    self.force[case] = at_contact(&backend.models()[case].mesh, &force);
                    valid(outcome)?;
                }
                Answer::Tangent { blocks, outcome } => {
                    self.blocks[case] = blocks;
                    valid(outcome)?;
                }
                Answer::Commit { outcome, .. } => valid(outcome)?,
                _ => {}
            }
        }
        Ok(())
    }
}

fn valid(outcome: Evaluated) -> Result<(), ComputeError> {
    match outcome {
        Evaluated::Valid => Ok(()),
        outcome => Err(ComputeError::Device(format!("the bench's displacement was refused: {outcome:?}"))),
    }
}

/// Operations of one case: of each evaluation.
fn operations_of_a_case(models: &[CaseModel], sizes: &Sizes, pools: &ThreadPools) -> Result<[u64; 4], BenchError> {
    let model = &models[..1];
    pools.one.install(|| {
        let mut cpu = Cpu::<Counted>::new(model.to_vec())?;
        let mut calls = Calls::new(model, sizes);
        let mut counts = [0; 4];
        for (count, (evaluation, _, _)) in counts.iter_mut().zip(EVALUATIONS) {
            let (operations, made) = operations(|| calls.make(&mut cpu, evaluation));
            made?;
            *count = operations;
        }
        Ok(counts)
    })
}

/// Measures every evaluation at every batch size in precision `R`.
///
/// # Errors
/// [`BenchError`].
pub fn measure<R: DeviceReal>(
    options: &Options,
    context: Option<&Arc<GpuContext>>,
    pools: &ThreadPools,
    report: &mut RatesReport,
    say: &mut dyn FnMut(&str),
) -> Result<(), BenchError> {
    let mesh = mesh(options.elements)?;
    let sizes = Sizes::of(&mesh);
    let operations = operations_of_a_case(&models(&mesh, 1)?, &sizes, pools)?;
    for &batch in &options.batches {
        say(&format!("force, tangent, contact, commit, {}, batch of {batch}", R::NAME));
        let copy = report.header.copy;
        let row = |kind: usize, on| {
            let (evaluation, name, item) = EVALUATIONS[kind];
            let items = batch * if evaluation == Evaluation::Contact { sizes.contact_points } else { sizes.elements };
            let bytes = match on {
                On::Device => sizes.on_device(evaluation, size_of::<R>()),
                On::OneCore | On::AllCores => sizes.on_cpu::<R>(evaluation),
            };
            RateRow {
                evaluation: name,
                law: "power",
                precision: R::NAME,
                batch,
                on,
                item,
                items,
                bytes: batch * bytes,
                operations: batch as u64 * operations[kind],
                outcome: Measurement::Skipped(String::new()),
            }
        };
        let room = memory_for(&mesh, &sizes, batch, size_of::<R>());
        let skip = |report: &mut RatesReport, reason: &str| {
            let places = [On::Device, On::OneCore, On::AllCores];
            for on in places.into_iter().filter(|&on| on != On::Device || context.is_some()) {
                report.rows.extend((0..4).map(|kind| row(kind, on).with(Err(reason.to_owned()), None)));
            }
        };
        if let Err(reason) = room {
            skip(report, &reason);
            continue;
        }
        let models = models(&mesh, batch)?;
        if let Some(context) = context {
            let start = Instant::now();
            let made = Gpu::<R>::new(context.clone(), models.clone());
            let ms = 1e3 * start.elapsed().as_secs_f64();
            let times = made.and_then(|mut gpu| {
                report.setups.push(Setup { evaluation: "all of an element", precision: R::NAME, batch, ms });
                on_device(options, &mut gpu, &models, &sizes)
            });
            let reason = times.as_ref().err().map(ToString::to_string).unwrap_or_default();
            for kind in 0..4 {
                let times = times.as_ref().map(|t| (t[kind].0, Some(t[kind].1))).map_err(|_| reason.clone());
                report.rows.push(row(kind, On::Device).with(times, copy.device));
            }
        }
        let mut cpu = Cpu::<R>::new(models.clone())?;
        for (on, pool, rate) in [(On::OneCore, &pools.one, copy.one_core), (On::AllCores, &pools.all, copy.all_cores)] {
            let times = pool.install(|| on_cpu(options, &mut cpu, &models, &sizes))?;
            report.rows.extend((0..4).map(|kind| row(kind, on).with(Ok((times[kind], None)), Some(rate))));
            cpu = Cpu::<R>::new(models.clone())?;
        }
    }
    Ok(())
}

/// Calls and kernels of each evaluation, milliseconds.
fn on_device<R: DeviceReal>(
    options: &Options,
    gpu: &mut Gpu<R>,
    models: &[CaseModel],
    sizes: &Sizes,
) -> Result<Vec<(Timing, f64)>, ComputeError> {
    let mut calls = Calls::new(models, sizes);
    let cases: Vec<usize> = (0..models.len()).collect();
    let mut times = Vec::with_capacity(4);
    for (evaluation, _, _) in EVALUATIONS {
        let call = timed(options, &mut calls, gpu, models, evaluation)?;
        times.push((call, of_kernels(|n| gpu.repeat(evaluation, &cases, n))?));
    }
    Ok(times)
}

/// Calls of each evaluation.
fn on_cpu(options: &Options, cpu: &mut dyn Compute, models: &[CaseModel], sizes: &Sizes) -> Result<Vec<Timing>, ComputeError> {
    let mut calls = Calls::new(models, sizes);
    EVALUATIONS.iter().map(|&(evaluation, _, _)| timed(options, &mut calls, cpu, models, evaluation)).collect()
}

/// Repeats one call; commits go on squeezing, so that every one of them flows.
fn timed(
    options: &Options,
    calls: &mut Calls,
    backend: &mut dyn Compute,
    models: &[CaseModel],
    evaluation: Evaluation,
) -> Result<Timing, ComputeError> {
    if evaluation != Evaluation::Update {
        return repeat(options.patience, |_| calls.make(backend, evaluation));
    }
    // Making the displacement is not the commit.
    gather(options.patience, |i| {
        calls.advance(models, i);
        let start = Instant::now();
        calls.make(backend, evaluation)?;
        Ok(1e3 * start.elapsed().as_secs_f64())
    })
}

/// Whether the machine has the memory for a batch on the CPU side: the cases, a backend, and what
/// the calls fill.
fn memory_for(mesh: &Mesh, sizes: &Sizes, batch: usize, word: usize) -> Result<(), String> {
    let of_mesh = 24 * mesh.nodes.len() + 100 * mesh.elements.len();
    let of_case = sizes.elements * (25 * 8 + 3 * 14 * 8) * word + sizes.nodes * 3 * 8 * 4;
    // What a device sends back is there once more.
    let of_calls = sizes.blocks * 9 * (8 + word) + sizes.nodes * 3 * 8 * 2;
    let needed = batch * (of_mesh + of_case + of_calls);
    match memory::left() {
        Some(available) if needed as u64 > available / 10 * 7 => {
            let [needed, available] = [needed as u64, available].map(|bytes| bytes >> 20);
            Err(format!("does not fit: {needed} MiB of this machine's memory, of which {available} are free"))
        }
        _ => Ok(()),
    }
}
