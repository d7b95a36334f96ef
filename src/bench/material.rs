//! The return mapping with its consistent tangent at points that all yield, under every law.

use std::convert::Infallible;
use std::hint::black_box;

use rayon::prelude::*;

use super::count::{Counted, operations};
use super::input::{BenchPoint, EightPoints, laws, material_points, side_by_side};
use super::report::{Measurement, On, RateRow, RatesReport, Setup};
use super::timing::{Timing, measure as repeat, of_kernels};
use super::traffic::{point_on_cpu, point_on_device};
use super::{BenchError, Options, ThreadPools};
use crate::compute::gpu::layout::{RELATIVE, STATE};
use crate::compute::gpu::material::ReturnMapping;
use crate::compute::gpu::{DeviceReal, GpuContext, GpuError};
use crate::lanes::Lanes;
use crate::material::{Material, PointState, deviatoric_tangent, return_mapping_of_eight};
use crate::real::Real;

/// The name of the rows.
pub const NAME: &str = "return mapping";
/// Groups of eight points handed to a thread at a time.
const GROUPS: usize = 64;

/// What eight points answer.
#[derive(Clone, Copy, Debug)]
pub struct EightAnswers<R> {
    /// Deviatoric Kirchhoff stress.
    pub stress: [Lanes<R>; 6],
    /// State after the step.
    pub state: PointState<Lanes<R>>,
    /// Consistent tangent.
    pub tangent: [[Lanes<R>; 6]; 6],
}

impl<R: Real> Default for EightAnswers<R> {
    fn default() -> Self {
        let zero = Lanes::ZERO;
        Self { stress: [zero; 6], state: PointState { be: [zero; 6], alpha: zero }, tangent: [[zero; 6]; 6] }
    }
}

/// Stress, state and tangent of every point, eight side by side. A point that is refused leaves its
/// group as it was.
#[inline]
pub fn map<R: Real>(material: &Material<R>, points: &[EightPoints<R>], answers: &mut [EightAnswers<R>]) {
    for (point, answer) in points.iter().zip(answers) {
        if let Ok(response) = return_mapping_of_eight(material, &point.relative, &point.state) {
            *answer = EightAnswers { stress: response.stress, state: response.state, tangent: deviatoric_tangent(&response) };
        }
    }
}

/// Operations of one point, the mean over `points`.
fn operations_of_a_point(law: usize, points: usize) -> Result<f64, BenchError> {
    let material = laws::<Counted>()?.swap_remove(law).1;
    let groups = side_by_side(&material_points(&material, points));
    let mut answers = vec![EightAnswers::default(); groups.len()];
    let (operations, ()) = operations(|| map(&material, &groups, &mut answers));
    Ok(operations as f64 / (8 * groups.len()) as f64)
}

/// Measures every law at every batch size in precision `R`.
///
/// # Errors
/// [`BenchError`].
pub fn measure<R: DeviceReal>(
    options: &Options,
    context: Option<&GpuContext>,
    pools: &ThreadPools,
    report: &mut RatesReport,
    say: &mut dyn FnMut(&str),
) -> Result<(), BenchError> {
    let mut compiled = false;
    for (law, (name, material)) in laws::<R>()?.into_iter().enumerate() {
        say(&format!("{NAME}, {name}, {}", R::NAME));
        let points = material_points(&material, options.points);
        let of_a_point = operations_of_a_point(law, options.points.min(512))?;
        for &batch in &options.batches {
            let items = batch * options.points;
            let row = |on, word_bytes: fn(usize) -> usize| RateRow {
                evaluation: NAME,
                law: name,
                precision: R::NAME,
                batch,
                on,
                item: "point",
                items,
                bytes: items * word_bytes(size_of::<R>()),
                operations: (of_a_point * items as f64) as u64,
                outcome: Measurement::Skipped(String::new()),
            };
            let copy = report.header.copy;
            if let Some(context) = context {
                let times = on_device(options, context, &material, &points, batch);
                if let (Ok((setup, _, _)), false) = (&times, compiled) {
                    report.setups.push(Setup { evaluation: NAME, precision: R::NAME, batch, ms: *setup });
                    compiled = true;
                }
                let times = times.map(|(_, call, kernels)| (call, Some(kernels))).map_err(|error| error.to_string());
                report.rows.push(row(On::Device, point_on_device).with(times, copy.device));
            }
            let groups = side_by_side(&points);
            let groups: Vec<_> = groups.iter().copied().cycle().take(batch * groups.len()).collect();
            let mut answers = vec![EightAnswers::default(); groups.len()];
            for (on, pool, rate) in [(On::OneCore, &pools.one, copy.one_core), (On::AllCores, &pools.all, copy.all_cores)] {
                let timing = pool.install(|| {
                    repeat(options.patience, |_| {
                        let parts = answers.par_chunks_mut(GROUPS).zip(groups.par_chunks(GROUPS));
                        parts.for_each(|(answers, groups)| map(&material, groups, answers));
                        black_box(&mut answers);
                        Ok::<(), Infallible>(())
                    })
                });
                let Ok(timing) = timing;
                report.rows.push(row(on, point_on_cpu).with(Ok((timing, None)), Some(rate)));
            }
        }
    }
    Ok(())
}

/// Milliseconds of the set-up, of the calls, and of the kernel alone.
fn on_device<R: DeviceReal>(
    options: &Options,
    context: &GpuContext,
    material: &Material<R>,
    points: &[BenchPoint<R>],
    batch: usize,
) -> Result<(f64, Timing, f64), GpuError> {
    let start = std::time::Instant::now();
    let kernel = ReturnMapping::new(context, &vec![material.clone(); batch], points.len())?;
    let setup = 1e3 * start.elapsed().as_secs_f64();
    let mut relative = Vec::with_capacity(RELATIVE * points.len());
    let mut committed = Vec::with_capacity(STATE * points.len());
    for c in 0..RELATIVE {
        relative.extend(points.iter().map(|p| p.relative[c / 3][c % 3]));
    }
    for c in 0..STATE {
        committed.extend(points.iter().map(|p| if c < 6 { p.state.be[c] } else { p.state.alpha }));
    }
    let (relative, committed) = (relative.repeat(batch), committed.repeat(batch));
    let active: Vec<u32> = (0..batch as u32).collect();
    let call = repeat(options.patience, |_| {
        kernel.run(context, &active, &relative, &committed).map(|answers| drop(black_box(answers)))
    })?;
    let kernels = of_kernels(|times| {
        kernel.repeat(context, batch, times)?;
        kernel.wait(context)
    })?;
    Ok((setup, call, kernels))
}
