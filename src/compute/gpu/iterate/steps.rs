//! Lists of kernels that go from iterates to their trials.

use std::sync::PoisonError;

use super::super::batch::Batch;
use super::super::buffers::{DeviceReal, ReadBack};
use super::super::dispatch::{Dispatch, Evaluation, outcomes};
use super::super::error::GpuError;
use super::super::layout::AT_POINT;
use super::super::linear::records::Solves;
use super::super::linear::solver::SlotSolver;
use super::super::pipelines::KernelList;
use super::arrays::{Kept, READINGS, SLIDES};
use super::kernels::Iterates;
use super::marks::{Brought, CommitReport, Corrections, Readout, SlotMark, flags};
use crate::compute::{Energies, Evaluated};

/// Krylov iterations by which a correction's list is longer the second time.
const MORE_AGAIN: usize = 6;

/// What is read back of a list.
struct Back<R> {
    first: Vec<u32>,
    of_tangent: Vec<u32>,
    readings: Vec<R>,
    counts: Vec<[u32; 4]>,
}

impl<R: DeviceReal> Back<R> {
    fn new(slots: usize) -> Self {
        let status = || vec![0; slots];
        Self { first: status(), of_tangent: status(), readings: vec![R::ZERO; slots * READINGS], counts: vec![[0; 4]; slots] }
    }

    fn readouts(&self) -> Vec<Readout> {
        let readout = |(slot, outcome): (usize, Evaluated)| {
            let numbers: [f64; READINGS] = std::array::from_fn(|i| self.readings[READINGS * slot + i].to_f64());
            Readout { outcome, numbers, counts: self.counts[slot] }
        };
        outcomes(&self.first).into_iter().enumerate().map(readout).collect()
    }
}

impl<R: DeviceReal> Batch<R> {
    /// Whether iterates are kept here.
    pub fn keeps_iterates(&self) -> bool {
        self.iterates.is_some()
    }

    fn iterates(&self) -> Result<(&Iterates<R>, &SlotSolver), GpuError> {
        let nothing = || GpuError::Length { what: "the iterates of the batch".into(), expected: 1, given: 0 };
        self.iterates.as_ref().zip(self.linear.as_ref()).ok_or_else(nothing)
    }

    /// Tells the slots of a dispatch what is to be done.
    fn tell(&self, dispatch: &Dispatch, marks: &[SlotMark]) -> Result<(), GpuError> {
        self.begin(dispatch)?;
        // The element's increments are formed on the device.
        self.increments.lock().unwrap_or_else(PoisonError::into_inner).clear();
        let told = &self.iterates()?.0.told;
        let words: Vec<[u32; 4]> = marks.iter().map(|m| [m.current, m.trial, m.flags, m.source]).collect();
        let numbers: Vec<R> = marks.iter().flat_map(|m| m.numbers.map(R::of)).collect();
        self.context.upload_at(&told.marks, 0, &words)?;
        self.context.upload_at(&told.numbers, 0, &numbers)
    }

    /// Appends a copy that lets the next evaluation begin as a valid one.
    fn append_valid(&self, list: &mut KernelList<'_>, slots: usize) -> Result<(), GpuError> {
        list.copy(&self.iterates()?.0.told.all_valid, 0, &self.scratch.first_invalid, 0, slots)
    }

    /// Appends what makes and measures the trials that the marks ask for.
    fn append_trial(&self, dispatch: &Dispatch, list: &mut KernelList<'_>) -> Result<(), GpuError> {
        let (nodes, slots) = (self.sizes().nodes, dispatch.cases.len());
        let kernels = &self.iterates()?.0.groups[dispatch.group].1;
        list.dispatch(&kernels.place, nodes, slots)?;
        self.append_valid(list, slots)?;
        self.append(dispatch, Evaluation::InternalForce, list)?;
        list.dispatch(&kernels.save, nodes, slots)?;
        self.append_assessment(dispatch, list)
    }

    /// Appends what contact makes of the trials, whose forces are there, and their measures.
    fn append_assessment(&self, dispatch: &Dispatch, list: &mut KernelList<'_>) -> Result<(), GpuError> {
        let (sizes, slots) = (self.sizes(), dispatch.cases.len());
        let kernels = &self.iterates()?.0.groups[dispatch.group].1;
        list.dispatch(&kernels.contact, sizes.contact_points, slots)?;
        list.dispatch(&kernels.measure, sizes.nodes, slots)?;
        list.dispatch(&kernels.read, 1, slots)
    }

    fn append_landing(&self, dispatch: &Dispatch, marks: &[SlotMark], list: &mut KernelList<'_>) -> Result<(), GpuError> {
        if marks.iter().all(|mark| mark.flags & flags::LANDS == 0) {
            return Ok(());
        }
        let land = &self.iterates()?.0.groups[dispatch.group].1.land;
        list.dispatch(land, self.sizes().contact_points, dispatch.cases.len())
    }

    /// Sends a list off and reads what its trials came to.
    fn read_trials(&self, list: KernelList<'_>, solves: Option<&mut Solves>, back: &mut Back<R>) -> Result<(), GpuError> {
        self.read_trials_and(list, solves, back, None)
    }

    /// The same, and something else.
    fn read_trials_and(
        &self,
        list: KernelList<'_>,
        mut solves: Option<&mut Solves>,
        back: &mut Back<R>,
        and: Option<ReadBack<'_>>,
    ) -> Result<(), GpuError> {
        let (iterates, linear) = self.iterates()?;
        let told = &iterates.told;
        let mut reads = vec![
            self.scratch.first_invalid.read(0, &mut back.first)?,
            told.readings.read(0, &mut back.readings)?,
            told.counts.read(0, &mut back.counts)?,
        ];
        if let Some(solves) = &mut solves {
            reads.push(linear.read(solves)?);
            reads.push(told.of_tangent.read(0, &mut back.of_tangent)?);
        }
        reads.extend(and);
        list.submit_and_read(&mut reads)?;
        if let Some(solves) = solves {
            linear.count(&self.context, solves);
        }
        Ok(())
    }

    /// Evaluates trials.
    ///
    /// # Errors
    /// The device's fault.
    pub fn try_iterates(&self, dispatch: &Dispatch, marks: &[SlotMark]) -> Result<Vec<Readout>, GpuError> {
        self.tell(dispatch, marks)?;
        let mut list = self.context.record();
        self.append_landing(dispatch, marks, &mut list)?;
        self.append_trial(dispatch, &mut list)?;
        let mut back = Back::new(marks.len());
        self.read_trials(list, None, &mut back)?;
        Ok(back.readouts())
    }

    /// Assesses iterates anew whose forces stay as they are: the trial of each mark is itself the
    /// current one. `moves` has them placed first.
    ///
    /// # Errors
    /// The device's fault.
    pub fn assess_iterates(&self, dispatch: &Dispatch, marks: &[SlotMark], moves: bool) -> Result<Vec<Readout>, GpuError> {
        self.tell(dispatch, marks)?;
        let mut list = self.context.record();
        self.append_landing(dispatch, marks, &mut list)?;
        if moves {
            list.dispatch(&self.iterates()?.0.groups[dispatch.group].1.place, self.sizes().nodes, marks.len())?;
        }
        self.append_valid(&mut list, marks.len())?;
        self.append_assessment(dispatch, &mut list)?;
        let mut back = Back::new(marks.len());
        self.read_trials(list, None, &mut back)?;
        Ok(back.readouts())
    }

    /// Solves the linear systems at the current iterates and evaluates the trials at the ends of
    /// their corrections, in one submission where so many Krylov iterations are enough. Where
    /// `marks` hold forces (all or none), the responses to a unit indentation are solved in it too.
    ///
    /// # Errors
    /// The device's fault.
    pub fn correct_iterates(
        &self,
        dispatch: &Dispatch,
        marks: &[SlotMark],
        systems: [&Solves; 2],
    ) -> Result<Corrections, GpuError> {
        let (iterates, linear) = self.iterates()?;
        let (sizes, slots) = (self.sizes(), marks.len());
        let kernels = &iterates.groups[dispatch.group].1;
        let held = marks.iter().any(|mark| mark.flags & flags::HOLDS_FORCE != 0);
        self.tell(dispatch, marks)?;
        let mut list = self.context.record();
        self.append_landing(dispatch, marks, &mut list)?;
        list.dispatch(&kernels.current, sizes.nodes, slots)?;
        self.append_valid(&mut list, slots)?;
        self.append(dispatch, Evaluation::Tangent, &mut list)?;
        list.copy(&self.scratch.first_invalid, 0, &iterates.told.of_tangent, 0, slots)?;
        list.dispatch(&kernels.system, sizes.nodes, slots)?;
        linear.append_update(&mut list, slots)?;
        let mut solves = systems[0].clone();
        let mut back = Back::new(slots);
        linear.set_out(&self.context, &mut list, &solves, false)?;
        linear.iterate(&mut list, solves.first_list(), slots)?;
        let units = if held {
            self.hold_forces(dispatch, list, (&mut solves, systems[1]), &mut back)?.reports()
        } else {
            let tail = |list: &mut KernelList<'_>| {
                list.dispatch(&kernels.expand, sizes.nodes, slots)?;
                self.append_trial(dispatch, list)
            };
            tail(&mut list)?;
            self.read_trials(list, Some(&mut solves), &mut back)?;
            self.finish(linear, &mut solves, &mut back, tail)?;
            Vec::new()
        };
        let (tangents, reports) = (outcomes(&back.of_tangent), solves.reports());
        Ok(Corrections { tangents, reports, units, readouts: back.readouts() })
    }

    /// Goes on with `list`, in which corrections at constant h are being solved, to the trials at
    /// the ends of those that hold a force: the responses to a unit indentation, with the same
    /// matrix, and how far the plate moves.
    fn hold_forces(
        &self,
        dispatch: &Dispatch,
        mut list: KernelList<'_>,
        (solves, units): (&mut Solves, &Solves),
        back: &mut Back<R>,
    ) -> Result<Solves, GpuError> {
        let (iterates, linear) = self.iterates()?;
        let (told, kernels) = (&iterates.told, &iterates.groups[dispatch.group].1);
        let (nodes, slots) = (self.sizes().nodes, solves.slots());
        let begun = solves.clone();
        let mut units = units.clone();
        let of_correction = |list: &mut KernelList<'_>| {
            linear.append_keep(list, &told.corrections, slots)?;
            list.dispatch(&kernels.expand, nodes, slots)
        };
        let trial = |list: &mut KernelList<'_>| {
            list.dispatch(&kernels.depth, 1, slots)?;
            list.dispatch(&kernels.press, nodes, slots)?;
            self.append_trial(dispatch, list)
        };
        let of_response = |list: &mut KernelList<'_>| {
            linear.append_keep(list, &told.units, slots)?;
            list.dispatch(&kernels.respond, nodes, slots)?;
            trial(list)
        };
        units.send(&self.context, &told.units)?;
        of_correction(&mut list)?;
        list.dispatch(&kernels.unit, nodes, slots)?;
        linear.set_out_after(&mut list, &told.units, slots, true)?;
        linear.iterate(&mut list, units.first_list(), slots)?;
        of_response(&mut list)?;
        self.read_trials_and(list, Some(&mut units), back, Some(solves.read_kept(&told.corrections)?))?;
        linear.count(&self.context, solves);
        self.finish(linear, &mut units, back, of_response)?;
        if solves.go_on() {
            // The responses have taken the place of vectors that were to be gone on with: the
            // corrections are solved anew, and the responses are kept.
            *solves = begun.with_more(MORE_AGAIN);
            let mut list = self.context.record();
            list.dispatch(&kernels.system, nodes, slots)?;
            linear.set_out(&self.context, &mut list, solves, false)?;
            linear.iterate(&mut list, solves.first_list(), slots)?;
            let tail = |list: &mut KernelList<'_>| {
                of_correction(list)?;
                trial(list)
            };
            tail(&mut list)?;
            self.read_trials(list, Some(solves), back)?;
            self.finish(linear, solves, back, tail)?;
        }
        Ok(units)
    }

    /// Goes on with solutions that have not finished, and with what `tail` appends after them.
    fn finish(
        &self,
        linear: &SlotSolver,
        solves: &mut Solves,
        back: &mut Back<R>,
        tail: impl Fn(&mut KernelList<'_>) -> Result<(), GpuError>,
    ) -> Result<(), GpuError> {
        while solves.go_on() {
            let mut list = self.context.record();
            linear.take_up(&self.context, &mut list, solves)?;
            tail(&mut list)?;
            self.read_trials(list, Some(solves), back)?;
        }
        Ok(())
    }

    /// Makes the current iterates the committed states, and reads what is recorded of them.
    ///
    /// # Errors
    /// The device's fault.
    pub fn commit_iterates(&self, dispatch: &Dispatch, marks: &[SlotMark]) -> Result<Vec<CommitReport>, GpuError> {
        self.tell(dispatch, marks)?;
        let (sizes, slots, points) = (self.sizes(), marks.len(), self.sizes().contact_points);
        let iterates = self.iterates()?.0;
        let (kernels, told, scratch) = (&iterates.groups[dispatch.group].1, &iterates.told, &self.scratch);
        let resident = &self.groups[dispatch.group].0;
        let mut list = self.context.record();
        list.dispatch(&kernels.current, sizes.nodes, slots)?;
        self.append_valid(&mut list, slots)?;
        self.append(dispatch, Evaluation::Update, &mut list)?;
        list.dispatch(&kernels.energies, 1, slots)?;
        list.dispatch(&kernels.commit, sizes.nodes, slots)?;
        for (slot, &case) in dispatch.cases.iter().enumerate() {
            self.append_keep(&mut list, resident, slot, case)?;
        }
        let mut first = vec![0; slots];
        let mut energies = vec![R::ZERO; 3 * slots];
        let mut at_points = vec![R::ZERO; AT_POINT * points * slots];
        let mut status = vec![0; points * slots];
        list.submit_and_read(&mut [
            scratch.first_invalid.read(0, &mut first)?,
            told.energies.read(0, &mut energies)?,
            told.at_points.read(0, &mut at_points)?,
            told.status.read(0, &mut status)?,
        ])?;
        let committed = |(slot, outcome): (usize, Evaluated)| {
            let [elastic, plastic, max_alpha] = std::array::from_fn(|i| energies[3 * slot + i].to_f64());
            CommitReport {
                outcome,
                energies: Energies { elastic, plastic, max_alpha, opponent_plastic: 0.0 },
                at_points: at_points[AT_POINT * points * slot..][..AT_POINT * points].iter().map(|x| x.to_f64()).collect(),
                status: status[points * slot..][..points].to_vec(),
            }
        };
        Ok(outcomes(&first).into_iter().enumerate().map(committed).collect())
    }

    /// Says which contact points of a case slide in its step; none has come off yet.
    ///
    /// # Errors
    /// The device's fault.
    pub fn set_sliding(&self, case: usize, sliding: &[bool]) -> Result<(), GpuError> {
        let (kept, index) = self.kept(case)?;
        let points = self.sizes().contact_points;
        let words: Vec<u32> = sliding.iter().map(|&slides| if slides { SLIDES } else { 0 }).collect();
        self.context.upload_at(&kept.let_go, index * points, &words)
    }

    /// Increments and internal forces of an iterate of a case, and which points slide.
    ///
    /// # Errors
    /// The device's fault.
    pub fn bring_iterate(&self, case: usize, iterate: u32) -> Result<Brought<R>, GpuError> {
        let (kept, index) = self.kept(case)?;
        let (n, points) = (3 * self.sizes().nodes, self.sizes().contact_points);
        let (mut increments, mut forces) = (vec![R::ZERO; n], vec![R::ZERO; n]);
        let mut let_go = vec![0; points];
        let first = 2 * (2 * index + iterate as usize) * n;
        self.context.record().submit_and_read(&mut [
            kept.iterates.read(first, &mut increments)?,
            kept.iterates.read(first + n, &mut forces)?,
            kept.let_go.read(index * points, &mut let_go)?,
        ])?;
        Ok(Brought { increments, forces, let_go })
    }

    /// Sets the correction of a case.
    ///
    /// # Errors
    /// The device's fault.
    pub fn give_correction(&self, case: usize, correction: &[f64]) -> Result<(), GpuError> {
        let (kept, index) = self.kept(case)?;
        let numbers: Vec<R> = correction.iter().map(|&x| R::of(x)).collect();
        self.context.upload_at(&kept.correction, index * numbers.len(), &numbers)
    }

    /// Displacement of a case one step before the committed one.
    ///
    /// # Errors
    /// The device's fault.
    pub fn earlier(&self, case: usize) -> Result<Vec<R>, GpuError> {
        let (kept, index) = self.kept(case)?;
        let mut out = vec![R::ZERO; 3 * self.sizes().nodes];
        self.context.download_at(&kept.before, index * out.len(), &mut out)?;
        Ok(out)
    }

    /// Sets it.
    ///
    /// # Errors
    /// The device's fault.
    pub fn set_earlier(&self, case: usize, displacement: &[f64]) -> Result<(), GpuError> {
        let (kept, index) = self.kept(case)?;
        let numbers: Vec<R> = displacement.iter().map(|&u| R::of(u)).collect();
        self.context.upload_at(&kept.before, index * numbers.len(), &numbers)
    }

    /// Committed displacement of a case.
    ///
    /// # Errors
    /// The device's fault.
    pub fn displacement(&self, case: usize) -> Result<Vec<R>, GpuError> {
        let (resident, index) = self.resident(case)?;
        let mut out = vec![R::ZERO; 3 * self.sizes().nodes];
        self.context.download_at(&resident.start, index * self.sizes().start_numbers(), &mut out)?;
        Ok(out)
    }

    fn kept(&self, case: usize) -> Result<(&Kept<R>, usize), GpuError> {
        let (_, index) = self.resident(case)?;
        let group = self.groups.iter().position(|(r, _)| (r.first..r.first + r.count).contains(&case)).unwrap_or(0);
        Ok((&self.iterates()?.0.groups[group].0, index))
    }
}
