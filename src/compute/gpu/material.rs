//! Material points on the device: the parameters of many materials, and the return mapping at every
//! point of every case.

use super::arguments::args;
use super::buffers::{DeviceReal, StorageBuffer};
use super::context::GpuContext;
use super::error::GpuError;
use super::layout::{ANSWER, PARAMETERS, RELATIVE, STATE, TANGENT};
use super::pipelines::Bound;
use super::shader_sources::RETURN_MAPPING;
use crate::material::{FlowStress as Hardening, Material};
use crate::real::Real;

/// What became of a point; the numbers are those of `shaders/material/material.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PointStatus {
    /// Elastic.
    Elastic,
    /// Plastic strain grew.
    Yielding,
    /// det f is not above 0: no answer.
    Inverted,
    /// A NaN, or an overflow: no answer.
    NotFinite,
}

impl PointStatus {
    /// From the device's number. A number that the kernel does not write (a point that it never
    /// reached) is no answer either.
    pub fn of(number: u32) -> Self {
        match number {
            0 => Self::Elastic,
            1 => Self::Yielding,
            2 => Self::Inverted,
            _ => Self::NotFinite,
        }
    }
}

/// Materials as kernels read them: parameter p of material m at `p * materials + m`, and after them
/// alpha, sigma, plastic work of the points of all tables.
pub fn flatten<R: Real>(materials: &[Material<R>]) -> Vec<R> {
    let cases = materials.len();
    let mut numbers = vec![R::ZERO; PARAMETERS * cases];
    for (case, material) in materials.iter().enumerate() {
        let zero = R::ZERO;
        let mut points = 0;
        let first = numbers.len();
        let (yield_stress, coefficient, exponent, youngs_modulus) = match &material.hardening {
            Hardening::Elastic => (zero, zero, zero, zero),
            Hardening::Ideal { yield_stress } => (*yield_stress, zero, zero, zero),
            Hardening::Linear { yield_stress, modulus } => (*yield_stress, *modulus, zero, zero),
            Hardening::Power { yield_stress, coefficient, exponent } => (*yield_stress, *coefficient, *exponent, zero),
            Hardening::Hollomon { coefficient, exponent, youngs_modulus, yield_stress } => {
                (*yield_stress, *coefficient, *exponent, *youngs_modulus)
            }
            Hardening::Voce { yield_stress, saturation_stress, rate } => (*yield_stress, *saturation_stress, *rate, zero),
            Hardening::Table { points: rows } => {
                points = rows.len();
                numbers.extend(rows.iter().flatten());
                (rows.first().map_or(zero, |row| row[1]), zero, zero, zero)
            }
        };
        let whole = |n: usize| R::of(n as f64);
        let elasticity = &material.elasticity;
        let row: [R; PARAMETERS] = [
            elasticity.bulk,
            elasticity.shear,
            whole(material.hardening.law().code().into()),
            yield_stress,
            coefficient,
            exponent,
            youngs_modulus,
            whole(first),
            whole(points),
        ];
        for (p, value) in row.into_iter().enumerate() {
            numbers[p * cases + case] = value;
        }
    }
    numbers
}

/// The block that `return_mapping.wgsl` calls PointDimensions.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(super) struct PointDimensions {
    pub cases: u32,
    pub in_dispatch: u32,
    pub points: u32,
    pub reserved: u32,
}

/// The answers of all points, arrays `[case][component][point]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Answers<R> {
    /// [`ANSWER`] components; meaningless where the status is no answer.
    pub answer: Vec<R>,
    /// [`TANGENT`] components; likewise.
    pub tangent: Vec<R>,
    /// `[case][point]`.
    pub status: Vec<PointStatus>,
}

/// The return mapping for a batch of materials with the same number of points each, its arrays
/// resident on the device.
#[derive(Debug)]
pub struct ReturnMapping<R> {
    cases: usize,
    points: usize,
    relative: StorageBuffer<R>,
    committed: StorageBuffer<R>,
    answer: StorageBuffer<R>,
    tangent: StorageBuffer<R>,
    status: StorageBuffer<u32>,
    active: StorageBuffer<u32>,
    dimensions: StorageBuffer<PointDimensions>,
    bound: Bound,
}

impl<R: DeviceReal> ReturnMapping<R> {
    /// Compiles the kernel and reserves the arrays for `materials.len()` cases of `points` points.
    ///
    /// # Errors
    /// [`GpuError::NoDoublePrecision`], [`GpuError::TooLarge`], [`GpuError::OutOfBudget`], or the
    /// device's fault.
    pub fn new(context: &GpuContext, materials: &[Material<R>], points: usize) -> Result<Self, GpuError> {
        let cases = materials.len();
        let materials = context.array("materials", &flatten(materials))?;
        let of_cases =
            |what: &str, components: usize| Ok::<_, GpuError>(context.zeros(what, cases * components * points)?.each(cases));
        let relative = of_cases("relative displacement gradient", RELATIVE)?;
        let committed = of_cases("committed state", STATE)?;
        let answer = of_cases("material answers", ANSWER)?;
        let tangent = of_cases("material tangents", TANGENT)?;
        let status = context.zeros("point status", cases * points)?.each(cases);
        let active = context.zeros("active cases", cases)?;
        let dimensions = context.block("dimensions")?;
        let arguments = args! {
            dimensions,
            active_cases: active,
            relative_gradient: relative,
            committed,
            answer,
            tangent,
            point_status: status,
            materials,
        };
        let bound = context.bind(&RETURN_MAPPING, R::PRECISION, &arguments)?;
        Ok(Self { cases, points, relative, committed, answer, tangent, status, active, dimensions, bound })
    }

    /// Maps every point of the `active` cases; the answers of the others are those of the last run.
    ///
    /// # Errors
    /// [`GpuError::Length`], or the device's fault.
    pub fn run(&self, context: &GpuContext, active: &[u32], relative: &[R], committed: &[R]) -> Result<Answers<R>, GpuError> {
        if active.len() > self.cases || active.iter().any(|&case| case as usize >= self.cases) {
            let what = "the list of active cases".to_owned();
            return Err(GpuError::Length { what, expected: self.cases, given: active.len() });
        }
        let [cases, in_dispatch, points] = [self.cases, active.len(), self.points].map(|n| n as u32);
        context.upload(&self.dimensions, &[PointDimensions { cases, in_dispatch, points, reserved: 0 }])?;
        context.upload_at(&self.active, 0, active)?;
        context.upload(&self.relative, relative)?;
        context.upload(&self.committed, committed)?;
        self.repeat(context, active.len(), 1)?;
        let status = context.download(&self.status)?.into_iter().map(PointStatus::of).collect();
        Ok(Answers { answer: context.download(&self.answer)?, tangent: context.download(&self.tangent)?, status })
    }

    /// Maps the first `active` cases of the last run `times` times more; [`ReturnMapping::wait`]
    /// waits for it.
    ///
    /// # Errors
    /// The device's fault.
    pub fn repeat(&self, context: &GpuContext, active: usize, times: usize) -> Result<(), GpuError> {
        let mut list = context.record();
        for _ in 0..times {
            list.dispatch(&self.bound, self.points, active)?;
        }
        list.submit()
    }

    /// Waits for what was submitted.
    ///
    /// # Errors
    /// The device's fault.
    pub fn wait(&self, context: &GpuContext) -> Result<(), GpuError> {
        context.download_at(&self.status, 0, &mut [0u32]).map(drop)
    }
}

/// [`ReturnMapping`] for any number of cases, in as many chunks as the device's limits and memory
/// ask for.
///
/// `relative` and `committed` are `[case][component][point]`.
///
/// # Errors
/// As [`ReturnMapping::new`] and [`ReturnMapping::run`].
pub fn return_mapping<R: DeviceReal>(
    context: &GpuContext,
    materials: &[Material<R>],
    points: usize,
    relative: &[R],
    committed: &[R],
) -> Result<Answers<R>, GpuError> {
    let bytes = |components: usize| (components * points * size_of::<R>()) as u64;
    // twice the tangents: what is read back goes through a staging buffer of the same size
    let total = bytes(RELATIVE + STATE + ANSWER + 2 * TANGENT + PARAMETERS) + 4 * points as u64;
    let mut all = Answers { answer: Vec::new(), tangent: Vec::new(), status: Vec::new() };
    for chunk in context.chunks("material points", materials.len(), bytes(TANGENT), total)? {
        let cases = chunk.first..chunk.first + chunk.count;
        let part = |data: &[R], components: usize| -> Result<Vec<R>, GpuError> {
            let range = cases.start * components * points..cases.end * components * points;
            let given = data.len();
            let expected = materials.len() * components * points;
            data.get(range).map(<[R]>::to_vec).ok_or_else(|| GpuError::Length {
                what: "material points".to_owned(),
                expected,
                given,
            })
        };
        let kernel = ReturnMapping::new(context, &materials[cases.clone()], points)?;
        let active: Vec<u32> = (0..chunk.count as u32).collect();
        let answers = kernel.run(context, &active, &part(relative, RELATIVE)?, &part(committed, STATE)?)?;
        all.answer.extend(answers.answer);
        all.tangent.extend(answers.tangent);
        all.status.extend(answers.status);
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::Elasticity;

    #[test]
    fn parameters_are_laid_out_by_parameter_and_tables_follow_each_other() {
        let elasticity = Elasticity { bulk: 5.0, shear: 7.0 };
        let table = |points: &[[f64; 2]]| Hardening::<f64>::table(points).unwrap();
        let laws = [table(&[[0.0, 1.0], [1.0, 3.0]]), Hardening::voce(2.0, 4.0, 6.0).unwrap(), table(&[[0.0, 8.0]])];
        let materials = laws.map(|hardening| Material { elasticity, hardening });
        let numbers = flatten(&materials);
        let column = |case: usize| (0..PARAMETERS).map(|p| numbers[p * 3 + case]).collect::<Vec<_>>();
        assert_eq!(column(0), [5.0, 7.0, 6.0, 1.0, 0.0, 0.0, 0.0, 27.0, 2.0]);
        assert_eq!(column(1), [5.0, 7.0, 5.0, 2.0, 4.0, 6.0, 0.0, 33.0, 0.0]);
        assert_eq!(column(2), [5.0, 7.0, 6.0, 8.0, 0.0, 0.0, 0.0, 33.0, 1.0]);
        assert_eq!(numbers[3 * PARAMETERS..], [0.0, 1.0, 0.0, 1.0, 3.0, 2.0, 0.0, 8.0, 0.0]);
    }
}
