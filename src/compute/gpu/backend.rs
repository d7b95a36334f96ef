//! A batch of cases on a device: forces, tangents, contact and states in one precision, linear
//! systems in f32.

use std::sync::Arc;

use rayon::prelude::*;

use super::batch::{Batch, Dispatch, Evaluation, Parts};
use super::buffers::DeviceReal;
use super::context::GpuContext;
use super::error::GpuError;
use super::linear::Linear;
use super::linear::pack::Packed;
use super::linear::parts::Part;
use super::scratch::{CONTACT_ANSWER, CONTACT_TRIAL};
use super::shader_sources::Precision;
use crate::compute::cpu::Cpu;
use crate::compute::iterate::{IterateRequest, Keeps};
use crate::compute::linear::LinearRequest;
use crate::compute::traffic::Traffic;
use crate::compute::{
    Blocks, CaseFields, CaseModel, CaseState, CommitRequest, Compute, ComputeError, ContactRequest, Description, Energies,
    ForceRequest, Outcome, TangentRequest,
};
use crate::contact::coulomb::{CONTACT_WEIGHT, Rows, Status};
use crate::contact::plane::slip;
use crate::element::hex8::QUADRATURE_POINTS;
use crate::material::PointState;
use crate::material::multistep::Flow;
use crate::mesh::Mesh;
use crate::real::Real;

/// Evaluates a batch on a device in precision `R`: residuals, tangents, contact and state; and
/// solves linear systems with the tangents, in f32 (see [`super::linear`]).
///
/// Committed states live on the device. Trial displacements go there as increments from the
/// committed displacement, formed in f64 and rounded once, so that f32 loses no digits of a small
/// step.
pub struct Gpu<R> {
    pub(super) models: Vec<CaseModel>,
    /// Committed displacements, in f64.
    pub(super) committed: Vec<Vec<f64>>,
    /// By case: `committed` is what the device has.
    pub(super) fresh: Vec<bool>,
    /// By case: which of the two iterates on the device is the current one.
    pub(super) current: Vec<u32>,
    /// By case and iterate: the largest number of its right-hand side.
    pub(super) largest: Vec<[f64; 2]>,
    pub(super) batch: Option<Batch<R>>,
    name: String,
}

impl<R: DeviceReal> Gpu<R> {
    /// Takes a batch of cases in their undeformed, virgin state to a device.
    ///
    /// # Errors
    /// [`ComputeError::Connectivity`], [`ComputeError::InvertedMesh`], [`ComputeError::Device`]:
    /// memory, limits, no double precision, or the device's fault.
    pub fn new(context: Arc<GpuContext>, models: Vec<CaseModel>) -> Result<Self, ComputeError> {
        let iterates = R::PRECISION == Precision::F64;
        Self::of(context, models, Parts { tangents_in_single: false, iterates })
    }

    /// The same with Newton's iterates also in single precision.
    ///
    /// # Errors
    /// As [`Gpu::new`].
    pub fn with_iterates(context: Arc<GpuContext>, models: Vec<CaseModel>) -> Result<Self, ComputeError> {
        Self::of(context, models, Parts { tangents_in_single: false, iterates: true })
    }

    /// The same with tangents in single precision, whatever the residual's: they decide how fast an
    /// answer is found, not what it is, and cost a half to a sixty-fourth of those in double.
    ///
    /// # Errors
    /// As [`Gpu::new`].
    pub fn with_tangents_in_single(context: Arc<GpuContext>, models: Vec<CaseModel>) -> Result<Self, ComputeError> {
        Self::of(context, models, Parts { tangents_in_single: true, iterates: true })
    }

    fn of(context: Arc<GpuContext>, models: Vec<CaseModel>, parts: Parts) -> Result<Self, ComputeError> {
        let name = format!("{} ({})", context.adapter().name, context.adapter().kind);
        let Some(first) = models.first() else {
            let (committed, fresh, current, largest) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
            return Ok(Self { models, committed, fresh, current, largest, batch: None, name });
        };
        for (case, model) in models.iter().enumerate() {
            if !model.is_alike(first) {
                return Err(ComputeError::Connectivity { case });
            }
        }
        context.supports(R::PRECISION)?;
        let batch = Batch::new(context, &models, parts)?;
        let committed = models.iter().map(|m| vec![0.0; 3 * m.mesh.nodes.len()]).collect();
        let (fresh, current, largest) = (vec![true; models.len()], vec![0; models.len()], vec![[0.0; 2]; models.len()]);
        Ok(Self { models, committed, fresh, current, largest, batch: Some(batch), name })
    }

    /// What the user should know: what the device leaves to the host.
    pub fn notes(&self) -> Vec<String> {
        self.batch.as_ref().map_or_else(Vec::new, |batch| batch.notes.clone())
    }

    /// The device; none for an empty batch.
    pub fn context(&self) -> Option<&Arc<GpuContext>> {
        self.batch.as_ref().map(Batch::context)
    }

    /// Runs the kernels of an evaluation of these cases `times` times over what its last call left
    /// on the device, and waits for them: for timing them without transfers. Nothing is committed.
    ///
    /// # Errors
    /// [`ComputeError::Device`].
    pub fn repeat(&self, evaluation: Evaluation, cases: &[usize], times: usize) -> Result<(), ComputeError> {
        for dispatch in self.schedule(cases.iter().copied()) {
            self.batch()?.repeat(&dispatch, evaluation, times)?;
        }
        Ok(())
    }

    /// The same of a part of the linear solver.
    ///
    /// # Errors
    /// [`ComputeError::Device`], also where linear systems are not solved on the device.
    pub fn repeat_part(&self, part: Part, cases: &[usize], times: usize) -> Result<(), ComputeError> {
        let missing = || ComputeError::Device("the linear systems are not solved on the device".to_owned());
        let solver = self.solver().ok_or_else(missing)?;
        for dispatch in self.schedule(cases.iter().copied()) {
            solver.repeat(self.batch()?.context(), part, dispatch.requests.len(), times)?;
        }
        Ok(())
    }

    pub(super) fn batch(&self) -> Result<&Batch<R>, GpuError> {
        let empty = || GpuError::Length { what: "the cases of the batch".into(), expected: 0, given: 1 };
        self.batch.as_ref().ok_or_else(empty)
    }

    /// What solves linear systems on the device, if anything does.
    pub fn solver(&self) -> Option<&Linear> {
        self.batch.as_ref().and_then(|batch| batch.linear.as_ref())
    }

    /// The dispatches for requests of these cases; none for no requests.
    pub(super) fn schedule(&self, cases: impl Iterator<Item = usize>) -> Vec<Dispatch> {
        self.batch.as_ref().map_or_else(Vec::new, |b| b.schedule(&cases.collect::<Vec<_>>()))
    }

    /// Increments of a dispatch, `[slot][3 node + i]`: formed in f64, rounded once.
    fn increments<'a>(
        &mut self,
        dispatch: &Dispatch,
        request: impl Fn(usize) -> (usize, &'a [f64]),
    ) -> Result<Vec<R>, ComputeError> {
        let mut out = Vec::new();
        for &i in &dispatch.requests {
            let (case, displacement) = request(i);
            self.refresh(case)?;
            out.extend(displacement.iter().zip(&self.committed[case]).map(|(u, c)| R::of(u - c)));
        }
        Ok(out)
    }
}

impl<R: DeviceReal> Compute for Gpu<R> {
    fn description(&self) -> Description {
        Description { device: self.name.clone(), precision: R::NAME }
    }

    fn models(&self) -> &[CaseModel] {
        &self.models
    }

    fn traffic(&self) -> Option<Traffic> {
        self.context().map(|context| context.traffic())
    }

    fn begin_step(&mut self, case: usize, weight: f64) -> Result<(), ComputeError> {
        Ok(self.batch()?.begin_step(case, weight)?)
    }

    fn internal_force(&mut self, requests: &mut [ForceRequest<'_>]) -> Result<(), ComputeError> {
        for dispatch in self.schedule(requests.iter().map(|r| r.case)) {
            let increments = self.increments(&dispatch, |i| (requests[i].case, requests[i].displacement))?;
            let (outcomes, force) = self.batch()?.internal_force(&dispatch, &increments)?;
            for (slot, &i) in dispatch.requests.iter().enumerate() {
                let request = &mut requests[i];
                request.outcome = outcomes[slot];
                let n = request.force.len();
                request.force.iter_mut().zip(&force[slot * n..]).for_each(|(out, f)| *out = f.to_f64());
            }
        }
        Ok(())
    }

    fn tangent(&mut self, requests: &mut [TangentRequest<'_>]) -> Result<(), ComputeError> {
        for dispatch in self.schedule(requests.iter().map(|r| r.case)) {
            let increments = self.increments(&dispatch, |i| (requests[i].case, requests[i].displacement))?;
            let batch = self.batch()?;
            let (outcomes, upper) = batch.tangent(&dispatch, &increments)?;
            let count = batch.sizes().blocks;
            for (slot, &i) in dispatch.requests.iter().enumerate() {
                let request = &mut requests[i];
                request.outcome = outcomes[slot];
                if request.outcome != Outcome::Valid {
                    continue;
                }
                let upper = |component, block| upper.at((slot * 9 + component) * count + block);
                match &mut request.blocks {
                    Blocks::Double(blocks) => mirror(&batch.plan.source, upper, blocks),
                    Blocks::Single(blocks) => mirror(&batch.plan.source, upper, blocks),
                }
            }
        }
        Ok(())
    }

    fn linear(&mut self, requests: &mut [LinearRequest<'_>]) -> Result<(), ComputeError> {
        if !self.batch.as_ref().is_some_and(Batch::solves) {
            return Ok(());
        }
        for dispatch in self.schedule(requests.iter().map(|r| r.case)) {
            let increments = self.increments(&dispatch, |i| (requests[i].case, requests[i].displacement))?;
            let packed = Packed::new(dispatch.requests.iter().map(|&i| &requests[i]));
            let (outcomes, answers) = self.batch()?.linear(&dispatch, &increments, &packed.rows, &packed.fixed, &packed.sides)?;
            for (slot, &i) in dispatch.requests.iter().enumerate() {
                requests[i].outcome = outcomes[slot];
                packed.unpack(slot, &answers, &mut requests[i]);
            }
        }
        Ok(())
    }

    fn contact(&mut self, requests: &mut [ContactRequest<'_>]) -> Result<(), ComputeError> {
        requests.iter().try_for_each(|request| self.refresh(request.case))?;
        for dispatch in self.schedule(requests.iter().map(|r| r.case)) {
            let batch = self.batch()?;
            let points = batch.sizes().contact_points;
            let mut trial = vec![R::ZERO; dispatch.requests.len() * CONTACT_TRIAL * points];
            for (trial, &i) in trial.chunks_exact_mut(CONTACT_TRIAL * points).zip(&dispatch.requests) {
                let ContactRequest { case, displacement, force, .. } = &requests[i];
                for (k, &node) in self.models[*case].mesh.contact_nodes.iter().enumerate() {
                    let base = 3 * node as usize;
                    let (u, start) = (&displacement[base..base + 3], &self.committed[*case][base..base + 3]);
                    let [x, y] = slip([u[0], u[1]], [start[0], start[1]]);
                    let numbers = [force[base], force[base + 1], force[base + 2], x, y, u[2] - start[2]];
                    numbers.into_iter().enumerate().for_each(|(c, value)| trial[c * points + k] = R::of(value));
                }
            }
            let (answer, status) = batch.contact(&dispatch, &trial)?;
            for (slot, &i) in dispatch.requests.iter().enumerate() {
                let request = &mut requests[i];
                read_rows(slot, &answer, &status, &self.models[request.case].mesh, request.rows);
            }
        }
        Ok(())
    }

    fn keeps(&self) -> Keeps {
        if self.batch.as_ref().is_some_and(Batch::keeps_iterates) { Keeps::Steps } else { Keeps::Nothing }
    }

    fn iterate(&mut self, requests: &mut [IterateRequest]) -> Result<(), ComputeError> {
        self.answer(requests)
    }

    fn commit(&mut self, requests: &mut [CommitRequest<'_>]) -> Result<(), ComputeError> {
        for dispatch in self.schedule(requests.iter().map(|r| r.case)) {
            let increments = self.increments(&dispatch, |i| (requests[i].case, requests[i].displacement))?;
            let (outcomes, energies) = self.batch()?.update(&dispatch, &increments)?;
            for (slot, &i) in dispatch.requests.iter().enumerate() {
                let request = &mut requests[i];
                request.outcome = outcomes[slot];
                if request.outcome != Outcome::Valid {
                    continue;
                }
                let batch = self.batch()?;
                batch.keep(&dispatch, slot, &self.models[request.case], request.displacement)?;
                let elements = batch.sizes().elements;
                let component = |c: usize| energies[(3 * slot + c) * elements..][..elements].iter().map(|e| e.to_f64());
                let own = batch.sizes().own_elements;
                request.energies = Energies {
                    elastic: component(0).sum(),
                    plastic: component(1).sum(),
                    max_alpha: component(2).fold(0.0, f64::max),
                    opponent_plastic: component(1).skip(own).sum(),
                };
                self.committed[request.case].copy_from_slice(request.displacement);
            }
        }
        Ok(())
    }

    /// Computed on the CPU, in the same precision, from the state on the device: it is output, and
    /// wanted once a step at most.
    fn fields(&mut self, case: usize) -> Result<CaseFields, ComputeError> {
        let state = self.state(case)?;
        let mut twin = Cpu::<R>::new(vec![self.models[case].clone()])?;
        twin.restore(0, &state)?;
        twin.fields(0)
    }

    fn state(&mut self, case: usize) -> Result<CaseState, ComputeError> {
        self.refresh(case)?;
        let batch = self.batch()?;
        let (state, work) = batch.state(case)?;
        let count = batch.sizes().points();
        let point = |p: usize| {
            let component = |c: usize| state[c * count + p].to_f64();
            PointState { be: std::array::from_fn(component), alpha: component(6) }
        };
        let flow = |p: usize| {
            let component = |c: usize| state[(super::resident::STATE + c) * count + p].to_f64();
            Flow { strain: std::array::from_fn(component), alpha: component(6) }
        };
        let elements = batch.sizes().elements;
        Ok(CaseState {
            displacement: self.committed[case].clone(),
            points: (0..elements).map(|e| std::array::from_fn(|q| point(QUADRATURE_POINTS * e + q))).collect(),
            flow: (0..elements).map(|e| std::array::from_fn(|q| flow(QUADRATURE_POINTS * e + q))).collect(),
            plastic_work: work.iter().map(|w| w.to_f64()).collect(),
        })
    }

    fn replace(&mut self, case: usize, model: CaseModel) -> Result<bool, ComputeError> {
        self.take_in(case, model)
    }

    fn restore(&mut self, case: usize, state: &CaseState) -> Result<(), ComputeError> {
        let batch = self.batch()?;
        let count = batch.sizes().points();
        let mut rows = vec![R::ZERO; super::resident::HISTORY * count];
        for (p, (point, flow)) in state.points.iter().flatten().zip(state.flow.iter().flatten()).enumerate() {
            let numbers = point.be.iter().chain([&point.alpha]).chain(&flow.strain).chain([&flow.alpha]);
            for (c, &value) in numbers.enumerate() {
                rows[c * count + p] = R::of(value);
            }
        }
        let work: Vec<R> = state.plastic_work.iter().map(|&w| R::of(w)).collect();
        batch.restore(case, &self.models[case], &state.displacement, &rows, &work)?;
        self.committed[case].clone_from(&state.displacement);
        self.fresh[case] = true;
        Ok(())
    }
}

/// The contact rows of a slot, from components `[slot][component][point]` and codes
/// `[slot][point]`.
fn read_rows<R: DeviceReal>(slot: usize, answer: &[R], status: &[u32], mesh: &Mesh, rows: &mut [Rows<f64>]) {
    let points = rows.len();
    let component = |c: usize, k: usize| answer[(slot * CONTACT_ANSWER + c) * points + k].to_f64();
    for (k, rows) in rows.iter_mut().enumerate() {
        let code = status[slot * points + k];
        let row = |first: usize| std::array::from_fn(|j| component(first + j, k));
        *rows = Rows {
            status: match code % 4 {
                0 => Status::Open,
                1 => Status::Stick,
                _ => Status::Slip,
            },
            residual: row(0),
            force_rows: [row(3), row(6), row(9)],
            displacement_rows: [row(12), row(15), row(18)],
            fixed: [code & 4 != 0, code & 8 != 0, code & 16 != 0],
            weight: R::of(CONTACT_WEIGHT * mesh.contact_size[k]).to_f64(),
        };
    }
}

/// All blocks of a tangent from `upper(component, block)`, its upper ones: `source` says of each
/// which it is, twice its index, and one more if it is transposed.
fn mirror<B: Real>(source: &[u32], upper: impl Fn(usize, usize) -> f64 + Sync, blocks: &mut [[B; 9]]) {
    blocks.par_iter_mut().zip(source).with_min_len(4096).for_each(|(out, &source)| {
        let (block, transposed) = (source as usize / 2, source % 2 == 1);
        for i in 0..3 {
            for j in 0..3 {
                let component = if transposed { 3 * j + i } else { 3 * i + j };
                out[3 * i + j] = B::of(upper(component, block));
            }
        }
    });
}
