//! The kernels of a batch: uploads, dispatches and downloads, in one precision.
//!
//! One dispatch serves all cases of a call that share a group of [`Resident`] arrays; each has a
//! slot of the scratch arrays. What a slot gets does not depend on the others. Where scratch memory
//! is short, a call takes several dispatches.

use std::sync::{Arc, Mutex, PoisonError};

use super::block_plan::BlockPlan;
use super::buffers::{DeviceReal, StorageBuffer};
use super::context::GpuContext;
use super::dispatch::{Dispatch, Evaluation, outcomes};
use super::error::GpuError;
use super::iterate::arrays::Kept;
use super::iterate::kernels::Iterates;
use super::layout::{HISTORY, NEXT_HISTORY, ROWS, STATE};
use super::linear::plan::Plan;
use super::linear::solver::{Right, SideSolutions, SlotSolver};
use super::linear::tied::Ties;
use super::pipelines::KernelList;
use super::resident::{BatchSizes, Connectivity, Resident};
use super::room::DeviceRoom;
use super::scratch::{Dimensions, EvaluationKernels, Scratch};
use super::source::Precision;
use super::tangents::Tangents;
use crate::compute::gather::GatherPlan;
use crate::compute::{CaseModel, ComputeError, Evaluated};
use crate::contact::pair::Image;

/// The arrays and kernels of a batch.
#[derive(Debug)]
pub struct Batch<R> {
    pub(super) context: Arc<GpuContext>,
    connectivity: Connectivity,
    /// Where each block of the pattern comes from.
    pub(super) plan: BlockPlan,
    pub(super) groups: Vec<(Resident<R>, EvaluationKernels)>,
    pub(super) scratch: Scratch<R>,
    slots: usize,
    /// The increments that the slots have.
    pub(super) increments: Mutex<Vec<R>>,
    /// Tangents.
    pub(super) tangents: Tangents<R>,
    /// How linear systems are solved, if the mesh has a hierarchy.
    pub(super) linear: Option<SlotSolver>,
    /// Newton's iterates, where they are asked for and linear systems are solved.
    pub(super) iterates: Option<Iterates<R>>,
    /// What the user should know of it.
    pub(super) notes: Vec<String>,
}

/// What a batch has besides its residuals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Parts {
    /// Tangents in single precision, whatever the residual's.
    pub tangents_in_single: bool,
    /// Newton's iterates, where linear systems are solved.
    pub iterates: bool,
}

/// What came of the linear systems of a dispatch.
#[derive(Debug)]
pub struct LinearAnswers {
    /// How each slot's tangent ended.
    pub outcomes: Vec<Evaluated>,
    /// By side, of all slots.
    pub sides: Vec<SideSolutions>,
    /// By slot, whether these are solutions: of a pair whose maps have no room here they are not.
    pub solved: Vec<bool>,
}

/// Upper blocks of tangents, in the precision in which they are computed.
#[derive(Clone, Debug)]
pub enum UpperBlocks<R> {
    /// In the residual's.
    Same(Vec<R>),
    /// In single precision.
    Single(Vec<f32>),
}

impl<R: DeviceReal> UpperBlocks<R> {
    /// The number at a place.
    pub fn at(&self, place: usize) -> f64 {
        match self {
            Self::Same(blocks) => blocks[place].to_f64(),
            Self::Single(blocks) => blocks[place].into(),
        }
    }
}

impl<R: DeviceReal> Batch<R> {
    /// Sends a batch of cases of one connectivity (there is at least one) and compiles its kernels.
    ///
    /// # Errors
    /// [`ComputeError::InvertedMesh`]; what the device says, above all [`GpuError::OutOfBudget`]
    /// and [`GpuError::TooLarge`].
    pub fn new(context: Arc<GpuContext>, models: &[CaseModel], parts: Parts) -> Result<Self, ComputeError> {
        let in_single = parts.tangents_in_single && R::PRECISION != Precision::F32;
        let mesh = models[0].mesh.clone();
        let gather = GatherPlan::new(&mesh);
        let plan = BlockPlan::new(&mesh, &gather);
        let is_paired = models[0].image == Some(Image::HalfTurn);
        let linear_plan = Plan::new(&mesh, &gather.pattern, (&plan.source, plan.blocks()), is_paired);
        let connectivity = Connectivity::new(&context, &mesh, &plan)?;
        let sizes = connectivity.sizes;
        let chunks = context.chunks_of_bindings("the states of a case", models.len(), sizes.resident_bytes::<R>().0)?;
        let of = |first: usize, count: usize| &models[first..first + count];
        let residents = chunks
            .iter()
            .map(|c| Resident::new(&context, sizes, c.first, of(c.first, c.count)))
            .collect::<Result<Vec<_>, _>>()?;
        let mut room = DeviceRoom::new::<R>(&context, sizes, models.len(), in_single);
        room.place_linear(linear_plan)?;
        room.place_iterates(parts.iterates)?;
        let kept = residents
            .iter()
            .filter(|_| room.keeps)
            .map(|r| Kept::new(&context, sizes, r, of(r.first, r.count)))
            .collect::<Result<Vec<_>, _>>()?;
        let slots = room.slots(chunks.iter().map(|c| c.count).max().unwrap_or(1))?;
        let scratch = Scratch::new(&context, sizes, (slots, room.pools()))?;
        let tangents = Tangents::new(&context, &connectivity, &scratch, &residents, models, (slots, in_single))?;
        let DeviceRoom { linear, notes, .. } = room;
        let linear = linear
            .map(|plan| match &tangents {
                Tangents::Same(set) => SlotSolver::new(&context, &plan, (slots, &scratch.pools), set.blocks()),
                Tangents::Single(single) => SlotSolver::new(&context, &plan, (slots, &scratch.pools), single.set().blocks()),
            })
            .transpose()?;
        linear.iter().try_for_each(|linear| linear.face(&context, models))?;
        let groups: Vec<(Resident<R>, EvaluationKernels)> = residents
            .into_iter()
            .map(|r| EvaluationKernels::new(&context, &connectivity, &r, &scratch).map(|k| (r, k)))
            .collect::<Result<_, GpuError>>()?;
        let iterates = match &linear {
            Some(linear) if !kept.is_empty() => {
                let residents = groups.iter().map(|(resident, _)| resident);
                Some(Iterates::new(&context, &connectivity, &scratch, linear, (slots, kept), residents)?)
            }
            _ => None,
        };
        let increments = Mutex::default();
        Ok(Self { context, connectivity, plan, groups, scratch, slots, increments, tangents, linear, iterates, notes })
    }

    /// The device.
    pub fn context(&self) -> &Arc<GpuContext> {
        &self.context
    }

    /// Sizes of a case.
    pub fn sizes(&self) -> BatchSizes {
        self.connectivity.sizes
    }

    /// Splits a call's requests, given their cases, into dispatches.
    pub fn schedule(&self, cases: &[usize]) -> Vec<Dispatch> {
        let mut out = Vec::new();
        for (group, (resident, _)) in self.groups.iter().enumerate() {
            let range = resident.first..resident.first + resident.count;
            let mut requests: Vec<usize> = (0..cases.len()).filter(|&i| range.contains(&cases[i])).collect();
            // A case keeps its slot while the same ones ask, whoever asks first: what is there of
            // it is not sent again.
            requests.sort_by_key(|&i| cases[i]);
            out.extend(requests.chunks(self.slots).map(|requests| Dispatch {
                group,
                requests: requests.to_vec(),
                cases: requests.iter().map(|&i| cases[i] - range.start).collect(),
            }));
        }
        out
    }

    pub(super) fn begin(&self, dispatch: &Dispatch) -> Result<(), GpuError> {
        let (context, scratch, sizes) = (&self.context, &self.scratch, self.sizes());
        let resident = &self.groups[dispatch.group].0;
        let slots: Vec<[u32; 4]> = dispatch.cases.iter().map(|&c| [c as u32, resident.geometry_of[c], 0, 0]).collect();
        let dimensions = Dimensions {
            cases: resident.count as u32,
            in_dispatch: slots.len() as u32,
            nodes: sizes.nodes as u32,
            elements: sizes.elements as u32,
            contact_points: sizes.contact_points as u32,
            blocks: sizes.blocks as u32,
            own_elements: sizes.own_elements as u32,
            materials: (sizes.bodies() * resident.count) as u32,
            start_numbers: sizes.start_numbers() as u32,
            trial_numbers: sizes.trial_numbers() as u32,
            reserved: [0; 2],
        };
        context.upload(&scratch.dimensions, &[dimensions])?;
        context.upload_at(&scratch.active, 0, &slots)
    }

    fn begin_element(&self, dispatch: &Dispatch, increments: &[R]) -> Result<(), GpuError> {
        self.begin(dispatch)?;
        // An iterate is evaluated as a trial first, and then its tangent is asked for.
        let mut known = self.increments.lock().unwrap_or_else(PoisonError::into_inner);
        if !same_bits(&known, increments) {
            known.clear();
            for (slot, increment) in increments.chunks(3 * self.sizes().nodes).enumerate() {
                self.context.upload_at(&self.scratch.trial, slot * self.sizes().trial_numbers(), increment)?;
            }
            known.extend_from_slice(increments);
        }
        drop(known);
        self.context.upload_at(&self.scratch.first_invalid, 0, &vec![u32::MAX; dispatch.cases.len()])
    }

    /// Runs the kernels of an evaluation and reads what they leave in `buffer`, and how each slot
    /// went.
    fn evaluate<T: DeviceReal>(
        &self,
        dispatch: &Dispatch,
        evaluation: Evaluation,
        buffer: &StorageBuffer<T>,
        out: &mut [T],
    ) -> Result<Vec<Evaluated>, GpuError> {
        let mut list = self.context.record();
        self.append(dispatch, evaluation, &mut list)?;
        let mut first = vec![0u32; dispatch.cases.len()];
        list.submit_and_read(&mut [buffer.read(0, out)?, self.scratch.first_invalid.read(0, &mut first)?])?;
        Ok(outcomes(&first))
    }

    /// Appends the kernels of an evaluation.
    pub(super) fn append(&self, dispatch: &Dispatch, evaluation: Evaluation, list: &mut KernelList<'_>) -> Result<(), GpuError> {
        let (kernels, sizes, slots) = (&self.groups[dispatch.group].1, self.sizes(), dispatch.cases.len());
        if evaluation == Evaluation::Contact {
            return list.dispatch(&kernels.contact, sizes.contact_points, slots);
        }
        if evaluation == Evaluation::Tangent {
            return self.tangents.append(dispatch, sizes, list);
        }
        list.dispatch(&kernels.jacobian, sizes.points(), slots)?;
        let (at_points, gathered, items) = match evaluation {
            Evaluation::InternalForce => (&kernels.internal_force, &kernels.node_force, sizes.nodes),
            Evaluation::Contact | Evaluation::Tangent | Evaluation::Update => {
                (&kernels.update, &kernels.energies, sizes.elements)
            }
        };
        list.dispatch(at_points, sizes.points(), slots)?;
        list.dispatch(gathered, items, slots)
    }

    /// Runs the kernels of an evaluation `times` times over the numbers that its last call left on
    /// the device, and waits for them: what they take without transfers.
    ///
    /// # Errors
    /// The device's fault.
    pub fn repeat(&self, dispatch: &Dispatch, evaluation: Evaluation, times: usize) -> Result<(), GpuError> {
        self.begin(dispatch)?;
        let mut list = self.context.record();
        for _ in 0..times {
            self.append(dispatch, evaluation, &mut list)?;
        }
        list.submit_and_read(&mut [self.scratch.first_invalid.read(0, &mut [0])?])
    }

    /// Internal forces `[slot][3 node + i]` at increments `[slot][3 node + i]`.
    ///
    /// # Errors
    /// The device's fault.
    pub fn internal_force(&self, dispatch: &Dispatch, increments: &[R]) -> Result<(Vec<Evaluated>, Vec<R>), GpuError> {
        self.begin_element(dispatch, increments)?;
        let (sizes, slots) = (self.sizes(), dispatch.cases.len());
        let mut force = vec![R::ZERO; slots * 3 * sizes.nodes];
        Ok((self.evaluate(dispatch, Evaluation::InternalForce, &self.scratch.force, &mut force)?, force))
    }

    /// Upper blocks of the tangents, `[slot][3 i + j][block]`.
    ///
    /// # Errors
    /// The device's fault.
    pub fn tangent(&self, dispatch: &Dispatch, increments: &[R]) -> Result<(Vec<Evaluated>, UpperBlocks<R>), GpuError> {
        self.begin_element(dispatch, increments)?;
        Ok(match &self.tangents {
            Tangents::Same(set) => {
                let (outcomes, blocks) = self.bring_tangents(dispatch, set.blocks())?;
                (outcomes, UpperBlocks::Same(blocks))
            }
            Tangents::Single(single) => {
                let (outcomes, blocks) = self.bring_tangents(dispatch, single.set().blocks())?;
                (outcomes, UpperBlocks::Single(blocks))
            }
        })
    }

    /// Makes the tangents and reads them: all at once where the host always solves, slot by slot
    /// where it seldom does, and there is memory for no more.
    fn bring_tangents<T: DeviceReal>(
        &self,
        dispatch: &Dispatch,
        buffer: &StorageBuffer<T>,
    ) -> Result<(Vec<Evaluated>, Vec<T>), GpuError> {
        let (slots, of_slot) = (dispatch.cases.len(), 9 * self.sizes().blocks);
        let mut blocks = vec![T::ZERO; slots * of_slot];
        let at_a_time = if self.solves() { 1 } else { slots };
        let (first, rest) = blocks.split_at_mut(at_a_time * of_slot);
        let outcomes = self.evaluate(dispatch, Evaluation::Tangent, buffer, first)?;
        for (i, piece) in rest.chunks_mut(of_slot).enumerate() {
            self.context.download_at(buffer, (at_a_time + i) * of_slot, piece)?;
        }
        Ok((outcomes, blocks))
    }

    /// Whether linear systems are solved here: the mesh has a hierarchy.
    pub fn solves(&self) -> bool {
        self.linear.is_some()
    }

    /// The tangents at increments, and the solutions of the systems of each side with them (see
    /// [`SlotSolver::update`] and [`SlotSolver::solve`]), in one submission a side. What ties pairs
    /// is in `ties`: none of one body.
    ///
    /// # Errors
    /// The device's fault.
    pub fn linear(
        &self,
        dispatch: &Dispatch,
        increments: &[R],
        (rows, fixed): (&[f32], &[u32]),
        ties: &Ties<'_>,
        sides: &[Right],
    ) -> Result<LinearAnswers, GpuError> {
        let (context, slots) = (&self.context, dispatch.cases.len());
        let nothing = || GpuError::Length { what: "the levels of the mesh's hierarchy".into(), expected: 1, given: 0 };
        let linear = self.linear.as_ref().ok_or_else(nothing)?;
        self.begin_element(dispatch, increments)?;
        let mut list = context.record();
        self.append(dispatch, Evaluation::Tangent, &mut list)?;
        let mut first = vec![u32::MAX; slots];
        let mut solved = vec![true; slots];
        if ties.is_empty() {
            linear.update(context, &mut list, rows, fixed, slots)?;
        } else {
            solved = linear.update_tied(context, &mut list, (rows, fixed), ties)?;
        }
        if !solved.contains(&true) {
            return Ok(LinearAnswers { outcomes: outcomes(&first), sides: Vec::new(), solved });
        }
        let mut answers = Vec::with_capacity(sides.len());
        for right in sides {
            let list = std::mem::replace(&mut list, context.record());
            answers.push(linear.solve(context, list, right, !ties.is_empty(), (&self.scratch.first_invalid, &mut first))?);
        }
        Ok(LinearAnswers { outcomes: outcomes(&first), sides: answers, solved })
    }

    /// Contact rows `[slot][component][point]` and their status, from forces and increments
    /// `[slot][component][point]`.
    ///
    /// # Errors
    /// The device's fault.
    pub fn contact(&self, dispatch: &Dispatch, trial: &[R]) -> Result<(Vec<R>, Vec<u32>), GpuError> {
        self.begin(dispatch)?;
        self.context.upload_at(&self.scratch.contact_trial, 0, trial)?;
        let (points, slots) = (self.sizes().contact_points, dispatch.cases.len());
        let mut list = self.context.record();
        self.append(dispatch, Evaluation::Contact, &mut list)?;
        let mut answer = vec![R::ZERO; slots * ROWS * points];
        let mut status = vec![0; slots * points];
        let scratch = &self.scratch;
        list.submit_and_read(&mut [scratch.contact_rows.read(0, &mut answer)?, scratch.contact_codes.read(0, &mut status)?])?;
        Ok((answer, status))
    }

    /// The states at increments, kept in scratch until [`Batch::keep`], and their energies
    /// `[slot][elastic, plastic, alpha][element]`.
    ///
    /// # Errors
    /// The device's fault.
    pub fn update(&self, dispatch: &Dispatch, increments: &[R]) -> Result<(Vec<Evaluated>, Vec<R>), GpuError> {
        self.begin_element(dispatch, increments)?;
        let (sizes, slots) = (self.sizes(), dispatch.cases.len());
        let mut energies = vec![R::ZERO; slots * 3 * sizes.elements];
        Ok((self.evaluate(dispatch, Evaluation::Update, &self.scratch.energies, &mut energies)?, energies))
    }

    /// Makes the state in `slot` of the last [`Batch::update`] the committed one of its case, at
    /// `displacement`.
    ///
    /// # Errors
    /// The device's fault.
    pub fn keep(&self, dispatch: &Dispatch, slot: usize, model: &CaseModel, displacement: &[f64]) -> Result<(), GpuError> {
        let (resident, case) = (&self.groups[dispatch.group].0, dispatch.cases[slot]);
        let mut list = self.context.record();
        self.append_keep(&mut list, resident, slot, case)?;
        list.submit()?;
        resident.set_displacement(&self.context, self.sizes(), case, model, displacement)
    }

    /// Appends the copies that make the states in `slot` those of a case of the group.
    pub(super) fn append_keep(
        &self,
        list: &mut KernelList<'_>,
        resident: &Resident<R>,
        slot: usize,
        case: usize,
    ) -> Result<(), GpuError> {
        let (scratch, sizes) = (&self.scratch, self.sizes());
        let (history, state, elements) = (HISTORY * sizes.points(), STATE * sizes.points(), sizes.elements);
        let (from, start) = (slot * NEXT_HISTORY * sizes.points(), case * sizes.start_numbers() + 3 * sizes.nodes);
        list.copy(&scratch.next_history, from, &resident.history, case * history, history)?;
        list.copy(&scratch.next_history, from, &resident.start, start, state)?;
        list.copy(&scratch.energies, (3 * slot + 1) * elements, &resident.plastic_work, case * elements, elements)
    }

    /// Forms the states from which the next step of a case starts, with `weight` times the last
    /// flow anticipated.
    ///
    /// # Errors
    /// The device's fault.
    pub fn begin_step(&self, case: usize, weight: f64) -> Result<(), GpuError> {
        for dispatch in self.schedule(&[case]) {
            self.begin(&dispatch)?;
            let (resident, kernels) = &self.groups[dispatch.group];
            self.context.upload_at(&resident.anticipated, dispatch.cases[0], &[R::of(weight)])?;
            let mut list = self.context.record();
            list.dispatch(&kernels.begin_step, self.sizes().points(), 1)?;
            list.submit()?;
        }
        Ok(())
    }

    /// Committed state and last flow `[component][point]` and plastic work `[element]` of a case.
    ///
    /// # Errors
    /// The device's fault.
    pub fn state(&self, case: usize) -> Result<(Vec<R>, Vec<R>), GpuError> {
        let (resident, index) = self.resident(case)?;
        let mut state = vec![R::ZERO; HISTORY * self.sizes().points()];
        let mut work = vec![R::ZERO; self.sizes().elements];
        let (first, first_work) = (index * state.len(), index * work.len());
        let mut reads = [resident.history.read(first, &mut state)?, resident.plastic_work.read(first_work, &mut work)?];
        self.context.record().submit_and_read(&mut reads)?;
        Ok((state, work))
    }

    /// Replaces the committed state of a case.
    ///
    /// # Errors
    /// The device's fault.
    pub fn restore(&self, case: usize, model: &CaseModel, displacement: &[f64], state: &[R], work: &[R]) -> Result<(), GpuError> {
        let (resident, index) = self.resident(case)?;
        let (points, start) = (self.sizes().points(), index * self.sizes().start_numbers() + 3 * self.sizes().nodes);
        self.context.upload_at(&resident.history, index * HISTORY * points, state)?;
        self.context.upload_at(&resident.start, start, &state[..STATE * points])?;
        self.context.upload_at(&resident.plastic_work, index * self.sizes().elements, work)?;
        resident.set_displacement(&self.context, self.sizes(), index, model, displacement)
    }

    pub(super) fn resident(&self, case: usize) -> Result<(&Resident<R>, usize), GpuError> {
        let holds = |r: &Resident<R>| (r.first..r.first + r.count).contains(&case);
        let found = self.groups.iter().map(|(r, _)| r).find(|r| holds(r));
        let expected = self.groups.iter().map(|(r, _)| r.count).sum();
        let missing = || GpuError::Length { what: "the cases of the batch".into(), expected, given: case + 1 };
        found.map(|r| (r, case - r.first)).ok_or_else(missing)
    }
}

/// Whether these begin with those.
fn same_bits<R: DeviceReal>(known: &[R], increments: &[R]) -> bool {
    known
        .get(..increments.len())
        .is_some_and(|known| bytemuck::cast_slice::<R, u8>(known) == bytemuck::cast_slice::<R, u8>(increments))
}
