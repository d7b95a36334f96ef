//! Parts of the linear solver on a device: what bounds them is memory, and how near they come to
//! that is their share of a copy.

use std::sync::Arc;

use super::input::{mesh, models};
use super::report::{Measurement, On, RateRow, RatesReport};
use super::timing::{Timing, measure as repeat, of_kernels};
use super::{BenchError, Options};
use crate::compute::gpu::linear::parts::SolvePart;
use crate::compute::gpu::linear::sizes::Cost;
use crate::compute::gpu::{DeviceReal, Evaluation, Gpu, GpuContext};
use crate::compute::{CaseModel, ComputeError};

/// What is known of each part: its account, calls and kernels in milliseconds.
type PartTimes = Vec<(Cost, Timing, f64)>;

/// Measures every part at every batch size: in single precision, as all of the solver is.
///
/// # Errors
/// [`BenchError`].
pub fn measure(
    options: &Options,
    context: Option<&Arc<GpuContext>>,
    report: &mut RatesReport,
    say: &mut dyn FnMut(&str),
) -> Result<(), BenchError> {
    let Some(context) = context else { return Ok(()) };
    let mesh = mesh(options.elements)?;
    for &batch in &options.batches {
        say(&format!("linear solver, batch of {batch}"));
        let models = models(&mesh, batch)?;
        // As runs have it: tangents in single precision, whatever the residuals.
        let found = if context.adapter().double_precision {
            Gpu::<f64>::with_tangents_in_single(context.clone(), models.clone()).and_then(|gpu| parts(options, &gpu, &models))
        } else {
            Gpu::<f32>::new(context.clone(), models.clone()).and_then(|gpu| parts(options, &gpu, &models))
        };
        let reason = found.as_ref().err().map(ToString::to_string).unwrap_or_default();
        for (i, (_, name)) in SolvePart::ALL.into_iter().enumerate() {
            // Of a solver that does not fit, bytes and operations are not known.
            let known = found.as_ref().ok().map(|found| found[i]);
            let account = known.map_or(Cost::default(), |(account, _, _)| account);
            let row = RateRow {
                evaluation: name,
                law: "power",
                precision: "f32",
                batch,
                on: On::Device,
                item: "node",
                items: batch * mesh.nodes.len(),
                bytes: size_of::<f32>() * (batch * account.numbers + account.shared),
                operations: (batch * account.operations) as u64,
                outcome: Measurement::Skipped(String::new()),
            };
            let times = known.map(|(_, call, kernels)| (call, Some(kernels))).ok_or_else(|| reason.clone());
            report.rows.push(row.with(times, report.header.copy.device));
        }
    }
    Ok(())
}

fn parts<R: DeviceReal>(options: &Options, gpu: &Gpu<R>, models: &[CaseModel]) -> Result<PartTimes, ComputeError> {
    // Where it does not fit, a note says what it needs.
    let why = || gpu.notes().first().cloned().unwrap_or_else(|| "the device solves no linear systems".to_owned());
    let missing = || ComputeError::Device(why());
    let solver = gpu.solver().ok_or_else(missing)?;
    let cases: Vec<usize> = (0..models.len()).collect();
    // The matrices are those of undeformed bodies.
    gpu.repeat(Evaluation::Tangent, &cases, 1)?;
    let of_part = |(part, _): (SolvePart, &str)| {
        let call = repeat(options.patience, |_| gpu.repeat_part(part, &cases, 1))?;
        Ok((solver.account(part), call, of_kernels(|times| gpu.repeat_part(part, &cases, times))?))
    };
    SolvePart::ALL.into_iter().map(of_part).collect()
}
