//! Takes the steps of a path: predicts, solves, bisects what fails, measures and records what is
//! accepted.

mod accept;
mod motion;
mod paused;
mod safe;
mod segments;
mod widening;

use std::sync::Arc;

use super::SimulationError;
use super::checkpoint::{Committed, FINEST, PathPosition, Snapshot};
pub use super::ending::{Ending, Outgrowth};
use super::equator;
use super::observer::Displacement;
pub use super::observer::{Observer, StepView};
use super::path::{Resolution, SegmentStart, Target, indentation_targets, straight_targets};
use super::problem::Problem;
use super::record::{RecordedPoint, StepRecord};
use crate::case::{Hold, Scaled, Segment, ShearTarget, unit};
use crate::compute::handle::CaseHandle;
use crate::compute::iterate::{Ask, Keeps, Plate, Settled};
use crate::compute::traffic::Traffic;
use crate::compute::{CaseState, Compute, ComputeError};
use crate::contact::coulomb::{Friction, Status};
use crate::material::multistep;
use crate::mesh::Mesh;
use crate::solver::iterate::{Extrapolation, SetOut};
use crate::solver::newton::Newton;
use crate::solver::phases::{Lap, Phase};
use crate::solver::{Control, StepFailure, StepOutcome, StepReport};
pub use paused::Paused;
use safe::{Muted, Safe};

/// Follows a path.
pub struct Drive<'a> {
    problem: &'a Problem,
    mesh: Arc<Mesh>,
    backend: &'a mut dyn Compute,
    case: usize,
    newton: Newton,
    state: Committed,
    /// The displacements of `state` are on the device; here they are known at contact nodes alone.
    is_away: bool,
    /// Where a run stood whose states are on a device that may fail: what it goes back to then.
    safe: Safe,
    /// What a step left whose iterates are on the device, until it is recorded.
    settled: Option<Settled>,
    place: PathPosition,
    /// Normal force that the present segment holds, of the meshed half.
    held_force: Option<f64>,
    /// How Newton went in the last accepted step.
    last_report: StepReport,
    /// The device's account before the first attempt at the next step.
    traffic_before: Option<Traffic>,
}

/// Share of the last step by which a press step is extrapolated. Measured: 0.45 to 0.75 need the
/// same iterations, a third fewer than none. Half and twice of it: `benches/constants`.
const PRESS_EXTRAPOLATION: f64 = 0.6;
/// See [`Drive::attempt_stuck`]; all but the first only after a step was bisected so often. Half
/// and twice of that: `benches/constants`.
const SLIDING_RATIOS: [f64; 3] = [3.0, 1.0, 0.3];
const SHALLOW: usize = 3;
/// After a step that failed the targets are taken in half as long parts, until a step takes no more
/// iterations than this. Half and twice of it: `benches/constants`.
const EASY: usize = 6;
/// The same after a step under full stick that took more iterations than this: points come off and
/// land in it one by one. Half and twice of it: `benches/constants`.
const SLOW: usize = 12;

impl<'a> Drive<'a> {
    /// Prepares to follow the problem's path on a backend whose case `case` is the problem's model
    /// in its virgin state.
    pub fn new(problem: &'a Problem, backend: &'a mut dyn Compute, case: usize, newton: Newton) -> Self {
        let mesh = problem.model.mesh.clone();
        let state = Committed::virgin(&mesh, newton.opponent());
        Self {
            problem,
            mesh,
            backend,
            case,
            newton,
            state,
            is_away: false,
            safe: Safe::default(),
            settled: None,
            place: PathPosition::default(),
            held_force: None,
            last_report: StepReport::default(),
            traffic_before: None,
        }
    }

    /// Puts the run back to where a snapshot of it was taken; [`Drive::run`] then goes on from
    /// there.
    ///
    /// # Errors
    /// [`SimulationError::Snapshot`] if it is one of another mesh, [`SimulationError::Compute`].
    pub fn resume(&mut self, snapshot: Snapshot) -> Result<(), SimulationError> {
        snapshot.check(&self.mesh)?;
        if self.backend.about().has_stand_in {
            self.safe.keep(snapshot.clone());
        }
        self.handle().restore(snapshot.case)?;
        if self.keeps(snapshot.state.is_even()) != Keeps::Nothing {
            self.handle().iterate(false, Plate::default(), Ask::SetEarlier(snapshot.state.u_before.clone()))?;
        }
        self.is_away = false;
        self.newton.set_force_scales(snapshot.force_scales);
        (self.state, self.place) = (snapshot.state, snapshot.place);
        self.state.place_points(&self.mesh);
        Ok(())
    }

    fn handle(&mut self) -> CaseHandle<'_> {
        CaseHandle { backend: &mut *self.backend, case: self.case }
    }

    /// Offers the observer a checkpoint of the last accepted step.
    pub fn checkpoint(&mut self, last: bool, observer: &mut dyn Observer) {
        let (mut taken, may_go_back) = (None, self.backend.about().has_stand_in);
        observer.checkpoint(last, &mut || {
            let snapshot = self.snapshot()?;
            taken = may_go_back.then(|| snapshot.clone());
            Ok(snapshot)
        });
        if let Some(snapshot) = taken {
            self.safe.keep(snapshot);
        } else if may_go_back && self.is_away && self.safe.is_due() {
            // Without a copy the run would begin anew: that is not worth an error.
            match self.snapshot() {
                Ok(snapshot) => self.safe.keep(snapshot),
                Err(error) => log::info!("no copy of the state could be taken: {error}"),
            }
        }
    }

    fn snapshot(&mut self) -> Result<Snapshot, ComputeError> {
        self.fetch()?;
        Ok(Snapshot {
            state: self.state.clone(),
            place: self.place.clone(),
            force_scales: self.newton.force_scales(),
            case: self.handle().state()?,
        })
    }

    /// Brings the displacements of the committed state here, if they are on the device.
    fn fetch(&mut self) -> Result<(), ComputeError> {
        let Self { backend, case, state, is_away, .. } = self;
        Displacement { u: &mut state.u, u_before: &mut state.u_before, is_away }.fetch(&mut **backend, *case)
    }

    /// Follows the whole path, or what is left of it. Where a device fails that had the state, it
    /// goes back to the last copy of it: steps that were shown are made again and not shown again.
    ///
    /// # Errors
    /// [`SimulationError`]: what ends a run before its path does.
    pub fn run(&mut self, observer: &mut dyn Observer) -> Result<Ending, SimulationError> {
        loop {
            let mut muted = Muted::new(observer, self.safe.lost(), self.state.record.step);
            match self.follow(&mut muted) {
                Err(error) if error.is_gone() => self.go_back(observer)?,
                ended => return ended,
            }
        }
    }

    /// Goes back to the last copy of the state, or to the beginning.
    fn go_back(&mut self, observer: &mut dyn Observer) -> Result<(), SimulationError> {
        self.backend.take_notes().iter().for_each(|note| observer.note(note));
        let snapshot = self.safe.lose(self.state.record.step, self.place.segment);
        (self.held_force, self.traffic_before, self.settled) = (None, None, None);
        match snapshot {
            Some(snapshot) => self.resume(*snapshot),
            None => {
                let virgin = CaseState::virgin(&self.mesh);
                self.handle().restore(virgin)?;
                self.newton.set_force_scales([0.0; 2]);
                (self.state, self.place) = (Committed::virgin(&self.mesh, self.newton.opponent()), PathPosition::default());
                self.is_away = false;
                Ok(())
            }
        }
    }

    fn follow(&mut self, observer: &mut dyn Observer) -> Result<Ending, SimulationError> {
        if !self.place.begun {
            observer.step(&mut self.view()).map_err(SimulationError::Observer)?;
            self.place.begun = true;
        }
        let path = self.problem.path();
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
                    let end = Target { h: *indentation, delta_t: *shear, ..start.place() };
                    self.reach(&straight_targets(&start, &end, &self.resolution()), observer)?
                }
                Segment::Motion { to, hold } => self.motion(&start, to, *hold, observer)?,
                Segment::Slip { direction, hold } => {
                    self.shear(&start, ShearTarget::FullSlip, unit(*direction), *hold, observer)?
                }
                Segment::Release { share } if *share > 0.0 => self.release_to(&start, *share, observer)?,
                Segment::Release { .. } => self.release(&start, observer)?,
                Segment::Shear { shear, hold } => self.shear(&start, *shear, [self.state.direction, 0.0], *hold, observer)?,
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
    fn begin_segment(&mut self, segment: &Segment) -> SegmentStart {
        self.state.record.segment = self.place.segment;
        self.state.last_increment = None;
        let holds_force = match segment {
            Segment::Shear { hold, .. } | Segment::Slip { hold, .. } => *hold == Hold::NormalForce,
            Segment::Motion { to, hold } => *hold == Hold::NormalForce && to.indentation.is_none(),
            _ => false,
        };
        self.place.held_force = self.place.held_force.filter(|_| holds_force);
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
            (self.state.direction, self.state.way) = (direction, [direction, 0.0, 0.0]);
        }
        if let Some(way) = self.way_of(segment, &start) {
            start.reversed = way.iter().zip(self.state.way).map(|(a, b)| a * b).sum::<f64>() < 0.0;
            self.state.way = way;
            // Whatever moves so is not even in x.
            self.state.direction = if way[0] != 0.0 { way[0].signum() } else { self.state.odd_direction() };
        }
        self.place.start = Some(start);
        start
    }

    fn start(&self) -> SegmentStart {
        let r = &self.state.record;
        SegmentStart {
            h: r.h,
            h_max: self.state.h_max,
            delta_t: r.delta_t,
            across: r.delta_t_y,
            angles: r.angles(),
            f_n: r.f_n,
            a: r.a,
            longest_recovery: self.state.longest_recovery,
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
            self.place.force_before = self.state.record.tangential_force();
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
            let failure = match attempted {
                StepOutcome::Failed(failure) => failure,
                StepOutcome::Converged(report) => {
                    let effort = report.effort();
                    match self.accept(&next, report, observer)? {
                        None => {
                            self.place.waiting.pop();
                            self.place.depth = self.place.depth.saturating_sub(1);
                            self.pace(effort);
                            self.checkpoint(false, observer);
                            continue;
                        }
                        Some(fault) => StepFailure::Invalid { fault, when: "where the step is committed" },
                    }
                }
            };
            if let Some(ending) = self.bisect(&next, &failure) {
                return Ok(ending);
            }
        }
        self.place.under_way = false;
        self.place.reached += 1;
        Ok(Ending::Done)
    }

    /// Puts half of a step that failed before what is left of it; ends the run where it has been
    /// halved too often.
    fn bisect(&mut self, next: &Target, failure: &StepFailure) -> Option<Ending> {
        let r = &self.state.record;
        log::info!("step to h = {:.5}, delta_T = {:.5} failed, bisecting: {failure}", next.h, next.delta_t);
        self.place.cutbacks += 1;
        self.place.wasted += failure.iterations();
        self.place.pace = (self.place.pace + 1).min(FINEST);
        self.place.depth += 1;
        if self.place.depth > self.problem.max_cutbacks {
            return Some(Ending::NotConverged(format!(
                "step {} of segment {} (from h = {:.6} R, delta_T = {:.6} R to h = {:.6} R, delta_T = {:.6} R): {failure}; \
                 the step was bisected {} times. {}",
                r.step + 1,
                r.segment,
                self.problem.bodies() * r.h,
                self.problem.bodies() * r.delta_t,
                self.problem.bodies() * next.h,
                self.problem.bodies() * next.delta_t,
                self.problem.max_cutbacks,
                failure.remedy(),
            )));
        }
        self.place.waiting.push(next.part(&self.start().place(), 0.5));
        None
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
        let start = self.start().place();
        let parts = 1usize << self.place.pace;
        self.place.waiting.push(*target);
        self.place.waiting.extend((1..parts).rev().map(|i| target.part(&start, i as f64 / parts as f64)));
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
        let beyond = |p: &RecordedPoint| p.status == Status::Open || p.force[0].hypot(p.force[1]) > ratio * p.force[2];
        let sliding: Vec<bool> = self.state.points.iter().map(beyond).collect();
        self.newton.set_sliding(&sliding);
        self.attempt(target)
    }

    /// One Newton solve towards a target; commits nothing, but where the iterates stay on a device.
    fn attempt(&mut self, target: &Target) -> Result<StepOutcome, SimulationError> {
        self.traffic_before = self.traffic_before.or_else(|| self.backend.about().traffic);
        self.newton.set_may_miss(self.place.depth >= SHALLOW);
        let is_even = self.state.is_even();
        let keeps = self.keeps(is_even);
        if keeps == Keeps::Nothing {
            // Of an equal pair that is sheared for the first time they are on the device.
            self.fetch()?;
        }
        let ratio = self.extrapolation(target);
        let h = self.expected_h(target, ratio);
        self.set_out_widening(target)?;
        let pose = self.state.pose_at(target);
        let mut guess = match keeps {
            Keeps::Steps => None,
            _ if pose.turn != self.state.pose.turn => ratio.map(|ratio| self.turned_guess(ratio, h, &pose)),
            _ => ratio.map(|ratio| self.guess(ratio)),
        };
        let mut control = Control { h, pose, normal_force: if target.hold_force { self.held_force } else { None } };
        let weight = match self.state.last_increment {
            Some(_) => multistep::weight(self.state.length_to(target) / self.state.last_length),
            None => 0.0,
        };
        let expected = guess.as_deref().unwrap_or(&self.state.u);
        self.newton.set_out(&self.mesh, &self.state.u, expected, is_even);
        if let Some(guess) = &mut guess {
            if !self.problem.pressed_in_full {
                self.newton.opponent().separate(&self.mesh, guess);
            }
            self.newton.opponent().leave_even(guess);
        }
        let mut lap = Lap::start();
        self.handle().begin_step(weight)?;
        lap.end(&mut self.newton.times, Phase::Commit);
        let extrapolation = ratio.map(|ratio| Extrapolation { ratio, lift: !self.problem.pressed_in_full });
        let start = SetOut {
            displacement: &self.state.u,
            h: self.state.record.h,
            pose: self.state.pose,
            guess: guess.as_deref(),
            extrapolation,
            came_off: &[],
        };
        let mut handle = CaseHandle { backend: &mut *self.backend, case: self.case };
        let outcome = equator::solve(&mut self.newton, &mut handle, &start, &mut control, self.state.equator.as_ref())?;
        self.state.stretch = control.pose.stretch;
        self.place.wasted += self.newton.take_given_up();
        if let StepOutcome::Converged(_) = outcome {
            let mut lap = Lap::start();
            self.settled = self.newton.settle(&mut handle)?;
            lap.end(&mut self.newton.times, Phase::Commit);
        }
        Ok(outcome)
    }

    /// Which iterates of a step stay on the device, which is even in x if it is `even`.
    fn keeps(&mut self, even: bool) -> Keeps {
        self.newton.keeps_on(&CaseHandle { backend: &mut *self.backend, case: self.case }, even)
    }

    /// How many times the last step of the segment is added to the committed displacement, if any:
    /// under shear, pressed at the same time or not, all
    /// of it; under pressing alone a part, so that points that are about to touch come down but are
    /// not pushed through the plane.
    ///
    /// What matters is less the guess's accuracy than that points that flow are found flowing: the
    /// first tangent is then a plastic one. A fully plastic contact is extrapolated in full, and
    /// points that come out below the plane are left there: lifted one by one they would strain the
    /// elements under them backwards. Without friction, at E/sigma_Y = 15,000 and h = 0.085 R, a
    /// press took 2,200 iterations and 37 cuts, and takes 150 and one; an oblique press at
    /// E/sigma_Y = 9000, mu = 0.5, took 19,800 and 472, and takes 300 and none.
    ///
    /// The same is done where a body is nearly incompressible, and between two bodies of which one
    /// is stiffer and one flows (see [`Problem::pressed_in_full`]).
    fn extrapolation(&self, target: &Target) -> Option<f64> {
        let last = self.state.last_increment.filter(|_| target.extrapolate)?;
        let r = &self.state.record;
        if let Some(ratio) = self.way_ratio(target, &last) {
            Some(ratio)
        } else if last.h != 0.0 {
            let share = if self.problem.pressed_in_full { 1.0 } else { PRESS_EXTRAPOLATION };
            Some(share * (target.h - r.h) / last.h)
        } else {
            None
        }
    }

    /// The displacements of such an extrapolation. A device that keeps iterates forms them itself.
    fn guess(&self, ratio: f64) -> Vec<f64> {
        self.state.u.iter().zip(&self.state.u_before).map(|(u, b)| u + ratio * (u - b)).collect()
    }

    /// The last accepted step.
    fn view(&mut self) -> StepView<'_> {
        let own = self.mesh.own_contacts();
        let displacement = Displacement { u: &mut self.state.u, u_before: &mut self.state.u_before, is_away: &mut self.is_away };
        let (points, opponent_points) = self.state.points.split_at(own);
        StepView {
            record: Scaled(self.state.record),
            report: &self.last_report,
            unfinished: std::mem::take(&mut self.newton.times),
            mesh: &self.mesh,
            displacement,
            points,
            opponent_points,
            newton: &self.newton,
            backend: &mut *self.backend,
            case: self.case,
        }
    }

    /// The contact has come within half an element of the edge of the fine zone.
    fn outgrown(&self) -> Option<Outgrowth> {
        let limit = self.mesh.fine_radius - 0.5 * self.problem.spacing;
        let StepRecord { h, delta_t, reach, a: contact_radius, .. } = self.state.record;
        let (h, delta_t) = (self.problem.bodies() * h, self.problem.bodies() * delta_t);
        (reach > limit).then_some(Outgrowth { reach, contact_radius, fine_radius: self.mesh.fine_radius, h, delta_t })
    }
}
