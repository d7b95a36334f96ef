//! A batch of cases on a device: forces, tangents, contact and states in one precision, linear
//! systems in f32.

use std::sync::Arc;

use rayon::prelude::*;

use super::batch::{Batch, LinearAnswers, Parts};
use super::buffers::DeviceReal;
use super::context::GpuContext;
use super::dispatch::{Dispatch, Evaluation, status_of};
use super::error::GpuError;
use super::layout::{HISTORY, ROWS, STATE, TRIAL};
use super::linear::pack::Packed;
use super::linear::parts::SolvePart;
use super::linear::solver::SlotSolver;
use super::source::Precision;
use crate::compute::call::not_asked;
use crate::compute::cpu::Cpu;
use crate::compute::handle::{at, at_contact};
use crate::compute::iterate::Keeps;
use crate::compute::linear::{PairTie, SolveRequest, Solved};
use crate::compute::{
    About, Answer, Call, CaseFields, CaseModel, CaseState, Compute, ComputeError, Description, Energies, Evaluated, TangentBlocks,
};
use crate::contact::coulomb::{CONTACT_WEIGHT, Rows};
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

/// Answers the calls of a dispatch, in the order of its slots.
type OfDispatch<R> = fn(&mut Gpu<R>, &Dispatch, &mut [(usize, Call)]) -> Result<Vec<Answer>, ComputeError>;

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
    pub fn repeat_part(&self, part: SolvePart, cases: &[usize], times: usize) -> Result<(), ComputeError> {
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
    pub fn solver(&self) -> Option<&SlotSolver> {
        self.batch.as_ref().and_then(|batch| batch.linear.as_ref())
    }

    /// The dispatches for requests of these cases; none for no requests.
    pub(super) fn schedule(&self, cases: impl Iterator<Item = usize>) -> Vec<Dispatch> {
        self.batch.as_ref().map_or_else(Vec::new, |b| b.schedule(&cases.collect::<Vec<_>>()))
    }

    /// Increments of a dispatch, `[slot][3 node + i]`: formed in f64, rounded once.
    fn increments(&mut self, dispatch: &Dispatch, calls: &[(usize, Call)]) -> Result<Vec<R>, ComputeError> {
        let mut out = Vec::new();
        for &i in &dispatch.requests {
            let (case, call) = &calls[i];
            self.refresh(*case)?;
            out.extend(call.displacement().iter().zip(&self.committed[*case]).map(|(u, c)| R::of(u - c)));
        }
        Ok(out)
    }

    /// Answers calls dispatch by dispatch: `answer` has those of one, in the order of its slots.
    fn by_dispatch(&mut self, mut calls: Vec<(usize, Call)>, answer: OfDispatch<R>) -> Result<Vec<Answer>, ComputeError> {
        let mut answers: Vec<Answer> = calls.iter().map(|_| Answer::Done).collect();
        for dispatch in self.schedule(calls.iter().map(|(case, _)| *case)) {
            let of_slots = answer(self, &dispatch, &mut calls)?;
            dispatch.requests.iter().zip(of_slots).for_each(|(&i, answer)| answers[i] = answer);
        }
        Ok(answers)
    }

    fn internal_force(&mut self, dispatch: &Dispatch, calls: &mut [(usize, Call)]) -> Result<Vec<Answer>, ComputeError> {
        let increments = self.increments(dispatch, calls)?;
        let (outcomes, force) = self.batch()?.internal_force(dispatch, &increments)?;
        let of_slots = force.chunks_exact(3 * self.batch()?.sizes().nodes).zip(outcomes);
        Ok(of_slots
            .map(|(force, outcome)| Answer::Force { force: force.iter().map(|f| f.to_f64()).collect(), outcome })
            .collect())
    }

    fn tangent(&mut self, dispatch: &Dispatch, calls: &mut [(usize, Call)]) -> Result<Vec<Answer>, ComputeError> {
        let increments = self.increments(dispatch, calls)?;
        let batch = self.batch()?;
        let (outcomes, upper) = batch.tangent(dispatch, &increments)?;
        let count = batch.sizes().blocks;
        let mut answers = Vec::with_capacity(outcomes.len());
        for (slot, (&i, outcome)) in dispatch.requests.iter().zip(outcomes).enumerate() {
            let Call::Tangent { blocks, .. } = &mut calls[i].1 else { return Err(not_asked()) };
            let empty = blocks.none();
            let mut blocks = std::mem::replace(blocks, empty).resized(batch.plan.source.len());
            if outcome == Evaluated::Valid {
                let upper = |component, block| upper.at((slot * 9 + component) * count + block);
                match &mut blocks {
                    TangentBlocks::Double(blocks) => mirror(&batch.plan.source, upper, blocks),
                    TangentBlocks::Single(blocks) => mirror(&batch.plan.source, upper, blocks),
                }
            }
            answers.push(Answer::Tangent { blocks, outcome });
        }
        Ok(answers)
    }

    fn contact(&mut self, dispatch: &Dispatch, calls: &mut [(usize, Call)]) -> Result<Vec<Answer>, ComputeError> {
        let points = self.batch()?.sizes().contact_points;
        let mut trial = vec![R::ZERO; dispatch.requests.len() * TRIAL * points];
        for (trial, &i) in trial.chunks_exact_mut(TRIAL * points).zip(&dispatch.requests) {
            let (case, Call::Contact { displacement, force }) = &calls[i] else { return Err(not_asked()) };
            self.refresh(*case)?;
            let start = at_contact(&self.models[*case].mesh, &self.committed[*case]);
            let of_points = displacement.as_chunks::<3>().0.iter().zip(start.as_chunks::<3>().0).zip(force.as_chunks::<3>().0);
            for (k, ((u, start), force)) in of_points.enumerate() {
                let [x, y, z] = std::array::from_fn(|i| u[i] - start[i]);
                let numbers = [force[0], force[1], force[2], x, y, z];
                numbers.into_iter().enumerate().for_each(|(c, value)| trial[c * points + k] = R::of(value));
            }
        }
        let (answer, status) = self.batch()?.contact(dispatch, &trial)?;
        let of_slot =
            |(slot, &i): (usize, &usize)| Answer::Contact(read_rows(slot, &answer, &status, &self.models[calls[i].0].mesh));
        Ok(dispatch.requests.iter().enumerate().map(of_slot).collect())
    }

    fn solve(&mut self, dispatch: &Dispatch, calls: &mut [(usize, Call)]) -> Result<Vec<Answer>, ComputeError> {
        let increments = self.increments(dispatch, calls)?;
        let system = |&i: &usize| if let (_, Call::Solve(system)) = &calls[i] { Some(&**system) } else { None };
        let systems: Vec<&SolveRequest> = dispatch.requests.iter().filter_map(system).collect();
        let packed = Packed::new(&systems);
        let ties: Vec<&PairTie> = systems.iter().filter_map(|system| system.tie.as_ref()).collect();
        let of_rows = (&packed.rows[..], &packed.fixed[..]);
        let LinearAnswers { outcomes, sides, solved } =
            self.batch()?.linear(dispatch, &increments, of_rows, &ties, &packed.sides)?;
        let of_slot = |(slot, (system, outcome)): (usize, (&&SolveRequest, Evaluated))| {
            let solutions = if solved[slot] { packed.unpack(slot, &sides, system) } else { Vec::new() };
            Answer::Solved(Solved { outcome, solutions })
        };
        Ok(systems.iter().zip(outcomes).enumerate().map(of_slot).collect())
    }

    fn commit(&mut self, dispatch: &Dispatch, calls: &mut [(usize, Call)]) -> Result<Vec<Answer>, ComputeError> {
        let increments = self.increments(dispatch, calls)?;
        let (outcomes, energies) = self.batch()?.update(dispatch, &increments)?;
        let mut answers = Vec::with_capacity(outcomes.len());
        for (slot, (&i, outcome)) in dispatch.requests.iter().zip(outcomes).enumerate() {
            let mut of_state = Energies::default();
            if outcome == Evaluated::Valid {
                let (case, displacement) = (calls[i].0, calls[i].1.displacement());
                let batch = self.batch()?;
                batch.keep(dispatch, slot, &self.models[case], displacement)?;
                let (elements, own) = (batch.sizes().elements, batch.sizes().own_elements);
                let component = |c: usize| energies[(3 * slot + c) * elements..][..elements].iter().map(|e| e.to_f64());
                of_state = Energies {
                    elastic: component(0).sum(),
                    plastic: component(1).sum(),
                    max_alpha: component(2).fold(0.0, f64::max),
                    opponent_plastic: component(1).skip(own).sum(),
                };
                self.committed[case].copy_from_slice(displacement);
            }
            answers.push(Answer::Commit { energies: of_state, outcome });
        }
        Ok(answers)
    }

    /// What is done case by case.
    fn answer(&mut self, case: usize, call: Call) -> Result<Answer, ComputeError> {
        Ok(match call {
            Call::BeginStep(weight) => {
                self.batch()?.begin_step(case, weight)?;
                Answer::Done
            }
            Call::Fields => Answer::Fields(self.fields(case)?),
            Call::State => Answer::State(self.state(case)?),
            Call::Restore(state) => {
                self.restore(case, &state)?;
                Answer::Done
            }
            Call::Replace(model) => Answer::Replaced(self.take_in(case, *model)?),
            _ => return Err(not_asked()),
        })
    }

    /// Computed on the CPU, in the same precision, from the state on the device: it is output, and
    /// wanted once a step at most.
    fn fields(&mut self, case: usize) -> Result<CaseFields, ComputeError> {
        let state = self.state(case)?;
        let mut twin = Cpu::<R>::new(vec![self.models[case].clone()])?;
        at(&mut twin, 0).restore(state)?;
        at(&mut twin, 0).fields()
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
            let component = |c: usize| state[(STATE + c) * count + p].to_f64();
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

    fn restore(&mut self, case: usize, state: &CaseState) -> Result<(), ComputeError> {
        let batch = self.batch()?;
        let count = batch.sizes().points();
        let mut rows = vec![R::ZERO; HISTORY * count];
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

impl<R: DeviceReal> Compute for Gpu<R> {
    fn models(&self) -> &[CaseModel] {
        &self.models
    }

    fn about(&self) -> About {
        let keeps = self.batch.as_ref().is_some_and(Batch::keeps_iterates);
        About {
            description: Description { device: self.name.clone(), precision: R::NAME },
            solves: self.batch.as_ref().is_some_and(Batch::solves),
            keeps: if keeps { Keeps::Steps } else { Keeps::Nothing },
            has_stand_in: false,
            traffic: self.context().map(|context| context.traffic()),
        }
    }

    fn call(&mut self, calls: Vec<(usize, Call)>) -> Result<Vec<Answer>, ComputeError> {
        match calls.first() {
            Some((_, Call::Force { .. })) => self.by_dispatch(calls, Self::internal_force),
            Some((_, Call::Tangent { .. })) => self.by_dispatch(calls, Self::tangent),
            Some((_, Call::Contact { .. })) => self.by_dispatch(calls, Self::contact),
            Some((_, Call::Solve(_))) if !self.about().solves => Ok(vec![Answer::Solved(Solved::not_tried()); calls.len()]),
            Some((_, Call::Solve(_))) => self.by_dispatch(calls, Self::solve),
            Some((_, Call::Commit { .. })) => self.by_dispatch(calls, Self::commit),
            Some((_, Call::Iterate(_))) => self.iterate(calls),
            _ => calls.into_iter().map(|(case, call)| self.answer(case, call)).collect(),
        }
    }
}

/// The contact rows of a slot, from components `[slot][component][point]` and codes
/// `[slot][point]`.
fn read_rows<R: DeviceReal>(slot: usize, answer: &[R], status: &[u32], mesh: &Mesh) -> Vec<Rows<f64>> {
    let points = mesh.contact_nodes.len();
    let component = |c: usize, k: usize| answer[(slot * ROWS + c) * points + k].to_f64();
    let of_point = |k: usize| {
        let code = status[slot * points + k];
        let row = |first: usize| std::array::from_fn(|j| component(first + j, k));
        Rows {
            status: status_of(code % 4),
            residual: row(0),
            force_rows: [row(3), row(6), row(9)],
            displacement_rows: [row(12), row(15), row(18)],
            fixed: [code & 4 != 0, code & 8 != 0, code & 16 != 0],
            weight: R::of(CONTACT_WEIGHT * mesh.contact_size[k]).to_f64(),
        }
    };
    (0..points).map(of_point).collect()
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
