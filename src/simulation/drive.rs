//! Takes the steps of a path: predicts, solves, bisects what fails, measures and records what is
//! accepted.

mod paused;
mod segments;

use std::ops::Range;
use std::sync::Arc;

use super::SimulationError;
use super::checkpoint::{Committed, Place, Snapshot};
pub use super::ending::{Ending, Outgrowth};
use super::footprint::{bulge, footprint};
pub use super::observer::{Observer, StepView};
use super::path::{Resolution, Start, Target, indentation_targets, oblique_targets};
use super::problem::Problem;
use super::record::{ContactPoint, StepRecord};
use crate::case::{Scaled, Segment, ShearTarget};
use crate::compute::handle::{CaseHandle, Evaluate};
use crate::compute::traffic::Traffic;
use crate::compute::{Compute, ComputeError, Outcome};
use crate::contact::coulomb::{Friction, Status};
use crate::contact::frame::to_frame;
use crate::contact::plane::gap;
use crate::material::multistep;
use crate::mesh::Mesh;
use crate::solver::encounter::Encounter;
use crate::solver::newton::Newton;
use crate::solver::phases::{Lap, Phase};
use crate::solver::rigid::position;
use crate::solver::system::Meeting;
use crate::solver::{Control, StepOutcome, StepReport};
pub use paused::Paused;

/// Follows a path.
pub struct Drive<'a> {
    problem: &'a Problem,
    mesh: Arc<Mesh>,
    backend: &'a mut dyn Compute,
    case: usize,
    newton: Newton,
    state: Committed,
    place: Place,
    /// Normal force that the present segment holds, of the meshed half.
    held_force: Option<f64>,
    /// How Newton went in the last accepted step.
    last_report: StepReport,
    /// The device's account before the first attempt at the next step.
    traffic_before: Option<Traffic>,
}

/// Share of the last step by which a press step is extrapolated. Measured: 0.45 to 0.75 need the
/// same iterations, a third fewer than none.
const PRESS_EXTRAPOLATION: f64 = 0.6;
/// See [`Drive::attempt_stuck`]; all but the first only after a step was bisected so often.
const SLIDING_RATIOS: [f64; 3] = [3.0, 1.0, 0.3];
const SHALLOW: usize = 3;
/// After a step that failed the targets are taken in half as long parts, until a step takes no more
/// iterations than this.
const EASY: usize = 6;
/// The same after a step under full stick that took more iterations than this: points come off and
/// land in it one by one.
const SLOW: usize = 12;
/// Targets are taken in 2^2 parts at most.
const FINEST: u32 = 2;

impl<'a> Drive<'a> {
    /// Prepares to follow the problem's path on a backend whose case `case` is the problem's model
    /// in its virgin state.
    pub fn new(problem: &'a Problem, backend: &'a mut dyn Compute, case: usize, newton: Newton) -> Self {
        let mesh = problem.model.mesh.clone();
        let state = Committed::virgin(&mesh, problem.rigid);
        Self {
            problem,
            mesh,
            backend,
            case,
            newton,
            state,
            place: Place::default(),
            held_force: None,
            last_report: StepReport::default(),
            traffic_before: None,
        }
    }

    /// Number of contact nodes of the sphere: they come first.
    fn own_contacts(&self) -> usize {
        self.mesh.couple.as_ref().map_or(self.mesh.contact_nodes.len(), |couple| couple.contact)
    }

    /// The contact nodes at which the contact is known: of two bodies the slave's.
    fn slave_contacts(&self) -> Range<usize> {
        let (own, all) = (self.own_contacts(), self.mesh.contact_nodes.len());
        match self.problem.couple {
            Some((1, _)) => own..all,
            _ => 0..own,
        }
    }

    /// Puts the run back to where a snapshot of it was taken; [`Drive::run`] then goes on from
    /// there.
    ///
    /// # Errors
    /// [`SimulationError::Snapshot`] if it is one of another mesh, [`SimulationError::Compute`].
    pub fn resume(&mut self, snapshot: Snapshot) -> Result<(), SimulationError> {
        snapshot.check(&self.mesh)?;
        self.backend.restore(self.case, &snapshot.case)?;
        self.newton.set_force_scales(snapshot.force_scales);
        (self.state, self.place) = (snapshot.state, snapshot.place);
        self.state.place_points(&self.mesh);
        Ok(())
    }

    /// Offers the observer a checkpoint of the last accepted step.
    pub fn checkpoint(&mut self, last: bool, observer: &mut dyn Observer) {
        observer.checkpoint(last, &mut || {
            Ok(Snapshot {
                state: self.state.clone(),
                place: self.place.clone(),
                force_scales: self.newton.force_scales(),
                case: self.backend.state(self.case)?,
            })
        });
    }

    /// Follows the whole path, or what is left of it.
    pub fn run(&mut self, observer: &mut dyn Observer) -> Result<Ending, SimulationError> {
        if !self.place.begun {
            observer.step(&mut self.view()).map_err(SimulationError::Observer)?;
            self.place.begun = true;
        }
        let path = &self.problem.case.0.path;
        while let Some(segment) = path.get(self.place.segment) {
            let start = match self.place.start {
                Some(start) => start,
                None => self.begin_segment(segment),
            };
            let ending = match segment {
                Segment::Indentation { indentation } => {
                    self.reach(&indentation_targets(&start, *indentation, &self.resolution()), observer)?
                }
                Segment::Oblique { indentation, shear } => {
                    self.reach(&oblique_targets(&start, *indentation, *shear, &self.resolution()), observer)?
                }
                Segment::Release { share } if *share > 0.0 => self.release_to(&start, *share, observer)?,
                Segment::Release { .. } => self.release(&start, observer)?,
                Segment::Shear { shear, hold } => self.shear(&start, *shear, *hold, observer)?,
            };
            observer.segment_end(&mut self.view()).map_err(SimulationError::Observer)?;
            if ending != Ending::Done {
                return Ok(ending);
            }
            self.place = self.place.next_segment();
        }
        Ok(Ending::Done)
    }

    /// Sets out for the present segment from the committed state.
    fn begin_segment(&mut self, segment: &Segment) -> Start {
        self.state.record.segment = self.place.segment;
        self.state.last_increment = None;
        let mut start = self.start();
        let target = match segment {
            Segment::Shear { shear, .. } => Some(*shear),
            Segment::Oblique { shear, .. } => Some(ShearTarget::Displacement(*shear)),
            _ => None,
        };
        if let Some(shear) = target {
            let direction = match shear {
                ShearTarget::Displacement(d) => (d - start.delta_t).signum(),
                // Full slip goes on in the direction of the last shear, forward if there was none.
                ShearTarget::FullSlip if self.state.direction != 0.0 => self.state.direction,
                ShearTarget::FullSlip => 1.0,
            };
            start.reversed = self.state.direction * direction < 0.0;
            self.state.direction = direction;
        }
        self.place.start = Some(start);
        start
    }

    fn start(&self) -> Start {
        let r = &self.state.record;
        Start {
            h: r.h,
            h_max: self.state.h_max,
            delta_t: r.delta_t,
            f_n: r.f_n,
            a: r.a,
            friction: match self.problem.model.friction {
                Friction::Coulomb(mu) => mu,
                Friction::Stick => f64::INFINITY,
            },
            nu: self.problem.case.0.material.poissons_ratio,
            compliance: self.problem.case.0.compliance(),
            reversed: false,
        }
    }

    fn resolution(&self) -> Resolution {
        self.problem.resolution
    }

    /// Reaches `target` from the committed state in one step, or in as many as bisection needs; a
    /// target that was set out for before, in what is left of it.
    fn advance(&mut self, target: &Target, observer: &mut dyn Observer) -> Result<Ending, SimulationError> {
        if !self.place.under_way {
            self.place.under_way = true;
            self.set_out(target);
            self.place.force_before = self.state.record.f_t;
        }
        loop {
            if let Some(reason) = self.outgrown() {
                return Ok(Ending::Outgrown(reason));
            }
            let Some(next) = self.place.waiting.last().copied() else { break };
            if observer.stop_requested() {
                self.checkpoint(true, observer);
                return Ok(Ending::Interrupted);
            }
            let attempted = match self.problem.model.friction {
                Friction::Stick => self.attempt_stuck(&next)?,
                Friction::Coulomb(_) => self.attempt(&next)?,
            };
            match attempted {
                StepOutcome::Converged(report) => {
                    self.place.waiting.pop();
                    self.place.depth = self.place.depth.saturating_sub(1);
                    self.pace(report.iterations.len());
                    self.accept(&next, report, observer)?;
                    self.checkpoint(false, observer);
                }
                StepOutcome::Failed(failure) => {
                    let r = &self.state.record;
                    log::info!("step to h = {:.5}, delta_T = {:.5} failed, bisecting: {failure}", next.h, next.delta_t);
                    self.place.cutbacks += 1;
                    self.place.wasted += failure.iterations();
                    self.place.pace = (self.place.pace + 1).min(FINEST);
                    self.place.depth += 1;
                    if self.place.depth > self.problem.max_cutbacks {
                        return Ok(Ending::NotConverged(format!(
                            "step {} of segment {} (from h = {:.6} R, delta_T = {:.6} R to h = {:.6} R, delta_T = {:.6} R): {failure}; \
                             the step was bisected {} times. A finer mesh ([mesh] elements_per_contact_radius) or more steps ([solver] press_steps, \
                             shear_steps) may help",
                            r.step + 1,
                            r.segment,
                            self.problem.bodies * r.h,
                            self.problem.bodies * r.delta_t,
                            self.problem.bodies * next.h,
                            self.problem.bodies * next.delta_t,
                            self.problem.max_cutbacks,
                        )));
                    }
                    self.place.waiting.push(Target {
                        h: 0.5 * (r.h + next.h),
                        delta_t: 0.5 * (r.delta_t + next.delta_t),
                        ..next
                    });
                }
            }
        }
        self.place.under_way = false;
        self.place.reached += 1;
        Ok(Ending::Done)
    }

    /// Adapts the length of the next steps to the iterations of the last one.
    fn pace(&mut self, iterations: usize) {
        let pace = &mut self.place.pace;
        if iterations <= EASY {
            *pace = pace.saturating_sub(1);
        } else if iterations > SLOW && self.problem.model.friction == Friction::Stick {
            *pace = (*pace + 1).min(FINEST);
        }
    }

    /// Makes `target` the next one, in as many equal parts as hard steps before it ask for.
    fn set_out(&mut self, target: &Target) {
        let StepRecord { h, delta_t, .. } = self.state.record;
        let parts = 1usize << self.place.pace;
        self.place.waiting.push(*target);
        self.place.waiting.extend((1..parts).rev().map(|i| {
            let share = i as f64 / parts as f64;
            Target { h: h + share * (target.h - h), delta_t: delta_t + share * (target.delta_t - delta_t), ..*target }
        }));
    }

    /// One Newton solve under full stick. A point that comes down within the step has no place to
    /// stick to before its end, and carries no tangential force in it. If the step fails so, those
    /// slide too that hold a large tangential force under little normal one: they are about to come
    /// off, and there may be no equilibrium with them nor without.
    fn attempt_stuck(&mut self, target: &Target) -> Result<StepOutcome, SimulationError> {
        let mut attempted = self.slide_beyond(f64::INFINITY, target)?;
        let ratios = if self.place.depth < SHALLOW { &SLIDING_RATIOS[..1] } else { &SLIDING_RATIOS[..] };
        for &ratio in ratios {
            let StepOutcome::Failed(failure) = &attempted else { break };
            log::info!(
                "points sheared beyond {ratio} of their normal force slide in the step to delta_T = {:.5}: {failure}",
                target.delta_t
            );
            self.place.wasted += failure.iterations();
            attempted = self.slide_beyond(ratio, target)?;
            if let StepOutcome::Converged(report) = &mut attempted {
                report.relaxed = true;
            }
        }
        self.newton.set_sliding(&[]);
        Ok(attempted)
    }

    /// One Newton solve in which open points and those slide whose tangential force exceeds `ratio`
    /// times their normal one.
    fn slide_beyond(&mut self, ratio: f64, target: &Target) -> Result<StepOutcome, SimulationError> {
        let beyond = |p: &ContactPoint| p.status == Status::Open || p.force[0].hypot(p.force[1]) > ratio * p.force[2];
        let sliding: Vec<bool> = self.state.points.iter().map(beyond).collect();
        self.newton.set_sliding(&sliding);
        self.attempt(target)
    }

    /// One Newton solve towards a target; commits nothing.
    fn attempt(&mut self, target: &Target) -> Result<StepOutcome, SimulationError> {
        self.traffic_before = self.traffic_before.or_else(|| self.backend.traffic());
        let mut guess = self.guess(target);
        let h = match (target.hold_force, self.state.last_increment) {
            // Where the force is held the indentation is an unknown, and goes on as the
            // displacements do.
            (true, Some([last_h, last_delta_t])) if guess.is_some() && last_delta_t != 0.0 => {
                let r = &self.state.record;
                r.h + last_h * (target.delta_t - r.delta_t) / last_delta_t
            }
            _ => target.h,
        };
        let control =
            Control { h, delta_t: target.delta_t, normal_force: if target.hold_force { self.held_force } else { None } };
        let weight = match self.state.last_increment {
            Some(_) => multistep::weight(self.state.length_to(target.h, target.delta_t) / self.state.last_length),
            None => 0.0,
        };
        if self.problem.equal_pair {
            let expected = guess.as_deref().unwrap_or(&self.state.u);
            // Up to the first shear all is even in x.
            let meeting = Meeting::new(&self.mesh, &self.state.u, expected, self.state.direction == 0.0);
            if let Some(guess) = &mut guess {
                meeting.separate(&self.mesh, guess);
            }
            self.newton.meet(meeting);
            if let Some(guess) = &mut guess {
                self.newton.symmetrise(guess);
            }
        }
        if let Some(couple) = self.problem.couple {
            let expected = guess.as_deref().unwrap_or(&self.state.u);
            let encounter = Encounter::new(&self.mesh, couple, &self.state.u, expected, self.state.direction == 0.0);
            if let Some(guess) = &mut guess {
                encounter.separate(&self.mesh, guess);
            }
            self.newton.encounter(encounter);
            if let Some(guess) = &mut guess {
                self.newton.symmetrise(guess);
            }
        }
        let mut lap = Lap::start();
        self.backend.begin_step(self.case, weight)?;
        lap.end(&mut self.newton.times, Phase::Commit);
        let mut handle = CaseHandle { backend: &mut *self.backend, case: self.case };
        Ok(self.newton.solve(&mut handle, &self.state.u, self.state.record.h, guess.as_deref(), &control)?)
    }

    /// Extrapolates the last step of the segment: under shear, pressed at the same time or not, all
    /// of it; under pressing alone a part, so that points that are about to touch come down but are
    /// not pushed through the plane.
    ///
    /// What matters is less the guess's accuracy than that points that flow are found flowing: the
    /// first tangent is then a plastic one. A fully plastic contact is extrapolated in full, and
    /// points that come out below the plane are left there: lifted one by one they would strain the
    /// elements under them backwards. Without friction, at E/sigma_Y = 15,000 and h = 0.085 R, a
    /// press took 2,200 iterations and 37 cuts, and takes 150 and one; an oblique press at
    /// E/sigma_Y = 9000, mu = 0.5, took 19,800 and 472, and takes 300 and none.
    fn guess(&self, target: &Target) -> Option<Vec<f64>> {
        let [last_h, last_delta_t] = self.state.last_increment.filter(|_| target.extrapolate)?;
        let r = &self.state.record;
        let ratio = if last_delta_t != 0.0 {
            (target.delta_t - r.delta_t) / last_delta_t
        } else if last_h != 0.0 {
            let share = if self.problem.fully_plastic { 1.0 } else { PRESS_EXTRAPOLATION };
            share * (target.h - r.h) / last_h
        } else {
            return None;
        };
        let mut guess: Vec<f64> = self.state.u.iter().zip(&self.state.u_before).map(|(u, b)| u + ratio * (u - b)).collect();
        if self.problem.equal_pair || self.problem.couple.is_some() || self.problem.fully_plastic {
            return Some(guess);
        }
        if let Some(rigid) = self.problem.rigid {
            for &node in &self.mesh.contact_nodes {
                let x = rigid.push_out(&position(&self.mesh, &guess, node));
                let reference = self.mesh.nodes[node as usize];
                (0..3).for_each(|c| guess[3 * node as usize + c] = x[c] - reference[c]);
            }
            return Some(guess);
        }
        for &node in &self.mesh.contact_nodes {
            let z = 3 * node as usize + 2;
            guess[z] -= gap(self.mesh.nodes[node as usize][2], guess[z]).min(0.0);
        }
        Some(guess)
    }

    /// Commits the accepted trial and records it.
    fn accept(&mut self, target: &Target, mut report: StepReport, observer: &mut dyn Observer) -> Result<(), SimulationError> {
        let before = self.state.record;
        let (wasted, cutbacks) = (std::mem::take(&mut self.place.wasted), std::mem::take(&mut self.place.cutbacks));
        let accepted = self.newton.accepted();
        let mut lap = Lap::start();
        let (energies, outcome) = CaseHandle { backend: &mut *self.backend, case: self.case }.commit(&accepted.u)?;
        lap.end(&mut report.times, Phase::Commit);
        if let (Some(before), Some(after)) = (self.traffic_before.take(), self.backend.traffic()) {
            report.traffic = after - before;
        }
        if let Outcome::Inverted { element, point } = outcome {
            return Err(ComputeError::Device(format!("a converged state is invalid at element {element}, point {point}")).into());
        }
        let (forces, statuses, gaps) = self.newton.contact_state(&self.mesh);
        let force: [f64; 3] = std::array::from_fn(|c| forces[..self.own_contacts()].iter().map(|f| f[c]).sum());
        let slaves = self.slave_contacts();
        let count = |s: Status| statuses[slaves.clone()].iter().filter(|status| **status == s).count();
        let (h, contact_points, slipping_points) = (accepted.h, count(Status::Stick) + count(Status::Slip), count(Status::Slip));
        let length = self.state.length_to(target.h, target.delta_t);
        let friction_work = match self.newton.interface_friction_work(&self.state.force) {
            Some(work) => work,
            None => self.friction_work(&accepted.u, &forces),
        };
        self.state.u_before.copy_from_slice(&self.state.u);
        self.state.u.copy_from_slice(&accepted.u);
        self.state.force.copy_from_slice(&accepted.force);
        for (force, &node) in forces.iter().zip(&self.mesh.contact_nodes) {
            self.state.force[3 * node as usize..][..3].copy_from_slice(force);
        }
        (self.state.statuses, self.state.gaps) = (statuses, gaps);
        self.newton.committed();
        self.state.last_increment = Some([h - before.h, target.delta_t - before.delta_t]);
        self.state.last_length = length;
        self.state.h_max = self.state.h_max.max(h);
        self.state.place_points(&self.mesh);
        let size = footprint(&self.state.points[slaves.clone()], self.problem.spacing);
        // A slave that is the opponent lies the other way round.
        let side = if slaves.start == 0 { 1.0 } else { -1.0 };
        let shape = self.problem.couple.and_then(|_| bulge(&self.state.points[slaves]));
        let [depth, curvature] = shape.map_or([0.0; 2], |[height, curvature]| [0.0 - side * height, side * curvature]);
        // 0 - x, not -x: no force is 0, not -0.
        let (f_n, f_t) = (2.0 * force[2], 0.0 - 2.0 * force[0]);
        self.state.record = StepRecord {
            step: before.step + 1,
            segment: before.segment,
            h,
            delta_t: target.delta_t,
            f_n,
            f_t,
            a: size.radius,
            stick_radius: size.stick_radius,
            newton_iterations: report.iterations.len() + wasted,
            cutbacks,
            a_gap: size.radius_gap,
            krylov_iterations: report.krylov(),
            merit: report.merit,
            work_external: before.work_external
                + 0.5 * (before.f_n + f_n) * (h - before.h)
                + 0.5 * (before.f_t + f_t) * (target.delta_t - before.delta_t),
            energy_elastic: 2.0 * energies.elastic,
            work_plastic: 2.0 * energies.plastic,
            work_friction: before.work_friction + 2.0 * friction_work,
            contact_points,
            slipping_points,
            max_alpha: energies.max_alpha,
            reach: self.state.reach(),
            relaxed: usize::from(report.relaxed),
            landed_again: report.landed_again,
            h_opponent: depth,
            work_plastic_opponent: 2.0 * energies.opponent_plastic,
            curvature,
        };
        log::info!(
            "step {}: h = {h:.5}, delta_T = {:.5}, {} iterations, {} Krylov, {} cut-backs, merit {:.1e}, {:.2} s (tangent {:.2}, force {:.2}, \
             contact {:.2}, linear update {:.2}, linear solve {:.2}, commit {:.2})",
            self.state.record.step,
            target.delta_t,
            self.state.record.newton_iterations,
            report.krylov(),
            cutbacks,
            report.merit,
            report.times.total(),
            report.times.seconds(Phase::Tangent),
            report.times.seconds(Phase::Force),
            report.times.seconds(Phase::Contact),
            report.times.seconds(Phase::LinearUpdate),
            report.times.seconds(Phase::LinearSolve),
            report.times.seconds(Phase::Commit),
        );
        if report.relaxed && !self.place.relaxed_told {
            self.place.relaxed_told = true;
            let r = &self.state.record;
            observer.note(&format!(
                "step {} of segment {} was accepted with relaxed conditions; column relaxed of the history tells of it and of any other in this segment",
                r.step, r.segment
            ));
        }
        self.last_report = report;
        self.backend.take_notes().iter().for_each(|note| observer.note(note));
        observer.step(&mut self.view()).map_err(SimulationError::Observer)
    }

    /// The last accepted step.
    fn view(&mut self) -> StepView<'_> {
        let (points, opponent_points) = self.state.points.split_at(self.own_contacts());
        StepView {
            record: Scaled(self.state.record),
            report: &self.last_report,
            unfinished: std::mem::take(&mut self.newton.times),
            mesh: &self.mesh,
            displacement: &self.state.u,
            points,
            opponent_points,
            backend: &mut *self.backend,
            case: self.case,
        }
    }

    /// Dissipation by friction in a step: minus the mean traction force times the slip, summed over
    /// the points of the meshed half.
    fn friction_work(&self, u: &[f64], forces: &[[f64; 3]]) -> f64 {
        let mut work = 0.0;
        for ((point, force), &node) in self.state.points.iter().zip(forces).zip(&self.mesh.contact_nodes) {
            let base = 3 * node as usize;
            let Some(rigid) = self.problem.rigid else {
                for i in 0..2 {
                    work -= 0.5 * (point.force[i] + force[i]) * (u[base + i] - self.state.u[base + i]);
                }
                continue;
            };
            // Along the surface half-way: across it points come down, and nothing is dissipated.
            let [before, after] = [&self.state.u, u].map(|u| position(&self.mesh, u, node));
            let frame = rigid.frame(&std::array::from_fn(|i| 0.5 * (before[i] + after[i])));
            let slip = to_frame(&frame, &std::array::from_fn(|i| after[i] - before[i]));
            let traction = to_frame(&frame, &std::array::from_fn(|i| 0.5 * (point.force[i] + force[i])));
            work -= traction[0] * slip[0] + traction[1] * slip[1];
        }
        work
    }

    /// The contact has come within half an element of the edge of the fine zone.
    fn outgrown(&self) -> Option<Outgrowth> {
        let limit = self.mesh.fine_radius - 0.5 * self.problem.spacing;
        let StepRecord { h, delta_t, reach, a: contact_radius, .. } = self.state.record;
        let (h, delta_t) = (self.problem.bodies * h, self.problem.bodies * delta_t);
        (reach > limit).then_some(Outgrowth { reach, contact_radius, fine_radius: self.mesh.fine_radius, h, delta_t })
    }
}
