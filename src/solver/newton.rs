//! One step: semismooth Newton with a backtracking line search on the contact merit, inexact linear
//! solves.

mod line_search;

use super::iterate::host::HostIterate;
use super::iterate::resident::ResidentIterate;
use super::iterate::stiffness::SetOff;
use super::iterate::{Asked, Correction, Iterate, SetOut};
use super::opponent::{Opponent, StepTaken};
use super::outcome::{Halt, Iteration, StepFailure, StepOutcome, StepReport};
use super::phases::{Lap, Phase, PhaseTimes};
use super::pose::{MODES, Pose};
use super::systems::Systems;
use super::trial::Trial;
use super::{Control, Settings, SolverError};
use crate::compute::ComputeError;
use crate::compute::handle::CaseHandle;
use crate::compute::iterate::{Keeps, Reading, Settled};
use crate::contact::coulomb::{Friction, Status};
use crate::mesh::Mesh;

/// Eisenstat & Walker (1996), choice 2: eta = gamma (m_k / m_k-1)^2. Not below what the tolerance
/// of the step asks for, and at the loosest to [`Settings::loosest_linear`]. Solving more tightly
/// (gamma 0.9, the first system to 0.01) takes a sixth more processor time for 3 % fewer
/// iterations: it is plastic loading and unloading that the iteration has to find. Half and twice
/// of it: `benches/constants`.
const FORCING_GAMMA: f64 = 2.0;
/// The first linear system of a step is solved no further than this. Half and twice of it:
/// `benches/constants`.
const TIGHTEST_FIRST: f64 = 1e-4;
/// A held normal force is met to this share of it. Half and twice of it: `benches/constants`.
const HELD_TOLERANCE: f64 = 5e-5;
/// Where a step has been bisected again and again, to this. Half and twice of it:
/// `benches/constants`.
const HELD_AT_LAST: f64 = 2e-4;
/// Tangential residuals of points in contact against the friction that the normal force can bear.
/// At mu = 0.3 the tolerance of the merit is the same.
const TANGENTIAL: f64 = 10.0 / 3.0;
/// At a kink of the merit, where a point at the edge changes its status whatever the step length,
/// no step lowers it, and the iteration would go round in circles until the step is given up. An
/// iterate so many tolerances away is then taken as it is. Half and twice of it:
/// `benches/constants`.
const KINK: f64 = 3.0;

/// A step that has used up its iterations goes on, up to twice as many, as long as so many of them
/// lowered the merit by this factor. Not where it has only a few: who asks for that means it. Half
/// and twice of each: `benches/constants`.
const LAST_ITERATIONS: usize = 3;
const CONVERGING: f64 = 0.2;
const FEW_ITERATIONS: usize = 10;

/// Steps in f32 are converged to this tolerance at the tightest; f64 does the rest.
const SINGLE: f64 = 1e-4;

/// A merit that is rounding, whatever the normal force: forces are stresses of the order of E times
/// areas of the order of R^2.
const ROUNDING: f64 = 1e-14;
/// Force by which merits are scaled before anything has ever touched (a fully plastic contact of
/// a = 0.03 R at sigma_Y = E/1000 carries it). Half and twice of this and of the next:
/// `benches/constants`.
const UNLOADED_SCALE: f64 = 1e-5;
/// Share of the largest normal force so far that measures residuals when nothing touches.
const LOST_SHARE: f64 = 1e-4;

/// The Newton iteration of one case with everything it keeps between steps. It decides by numbers;
/// the vectors are its iterates'.
pub struct Newton {
    /// Its iterates, for the host and for a device that keeps them.
    iterates: ResidentIterate,
    /// The present step's are on the device.
    is_resident: bool,
    /// The present step is even in x.
    is_even: bool,
    /// Why they stay on the host whatever the device can do: it knows a rigid plate that moves
    /// along x alone.
    at_home: Option<&'static str>,
    settings: Settings,
    /// Tolerance of the merit: that of the settings, in f32 no tighter than [`SINGLE`].
    tolerance: f64,
    /// Force scale of the last accepted step, and the largest of any.
    last_scale: f64,
    largest_scale: f64,
    /// What is known of the current iterate.
    current: Reading,
    /// Iterations from which no step has come, though they converged or were in f32.
    given_up: usize,
    /// A held normal force may be missed by [`HELD_AT_LAST`].
    may_miss: bool,
    /// Time spent since the last converged step; whoever drives the iteration adds what else a step
    /// takes.
    pub times: PhaseTimes,
}

impl Newton {
    /// Prepares the iteration on a mesh.
    pub fn new(mesh: &Mesh, linear: impl Into<Systems>, settings: Settings) -> Self {
        Self {
            iterates: ResidentIterate::new(HostIterate::new(mesh, linear.into())),
            is_resident: false,
            is_even: false,
            at_home: None,
            settings,
            tolerance: settings.tolerance,
            last_scale: 0.0,
            largest_scale: 0.0,
            current: Reading::default(),
            given_up: 0,
            may_miss: false,
            times: PhaseTimes::default(),
        }
    }

    /// The same against another opponent than the plane.
    pub fn against(mut self, opponent: Box<dyn Opponent>) -> Self {
        self.iterates.host.against(opponent);
        self
    }

    /// The same for a plate that a device does not know, and why.
    pub fn at_home(mut self, why: Option<&'static str>) -> Self {
        self.at_home = why;
        self
    }

    /// What the body is pressed against.
    pub fn opponent(&self) -> &dyn Opponent {
        self.iterates.host.opponent()
    }

    /// Which iterates of the case stay on this backend in a step, which is even in x if it is
    /// `even`.
    pub fn keeps_on(&self, case: &CaseHandle<'_>, even: bool) -> Keeps {
        let is_known = self.iterates.host.is_known_by_multigrid(even) && self.at_home.is_none();
        if is_known { case.keeps() } else { Keeps::Nothing }
    }

    /// Why vectors stay on the host whatever a device can do, and with them the linear systems,
    /// where backends do not solve those of the opponent; `None` where neither does.
    pub fn stays_on_host(&self) -> Option<&'static str> {
        let host = &self.iterates.host;
        if !host.opponent().is_rigid() && host.opponent().has_known_systems() {
            return Some(match self.at_home {
                None => {
                    "the sphere is pressed against its equal, so the vectors of Newton's method stay on the host from the \
                     first shear on"
                }
                Some(_) => {
                    "the sphere is pressed against its equal and turns, or its equator is free, so the vectors of Newton's \
                     method stay on the host, and as long as all is even in x the linear systems too"
                }
            });
        }
        if !host.opponent().is_rigid() {
            return Some(
                "the sphere is pressed against a body that deforms, so the vectors and linear systems of Newton's method \
                 stay on the host",
            );
        }
        if !host.is_rigid_by_multigrid() {
            return Some("solver.linear is \"direct\", so the vectors and linear systems of Newton's method stay on the host");
        }
        self.at_home
    }

    /// The last accepted trial, if its vectors are on the host.
    pub fn accepted(&self) -> &Trial {
        self.iterates.host.current()
    }

    /// Commits the last accepted trial, where its vectors are on the device; `None` where they are
    /// not.
    ///
    /// # Errors
    /// [`SolverError::Compute`].
    pub fn settle(&mut self, case: &mut CaseHandle<'_>) -> Result<Option<Settled>, SolverError> {
        if self.is_resident { self.iterates.settle(case).map(Some) } else { Ok(None) }
    }

    /// Indentation of the last accepted trial.
    pub fn accepted_h(&self) -> f64 {
        if self.is_resident { self.iterates.h() } else { self.iterates.host.h() }
    }

    fn iterate(&mut self) -> &mut dyn Iterate {
        if self.is_resident { &mut self.iterates } else { &mut self.iterates.host }
    }

    /// What merits are measured by: the sum of the normal contact forces, but where contact is
    /// being lost or is lost not less than what it was at the step's start, nor than a small share
    /// of what it ever was. Without contact there is no force to compare with.
    fn scale(&self) -> f64 {
        let scale = self.loaded_scale();
        if scale > 0.0 { scale } else { UNLOADED_SCALE }
    }

    /// The same where there is such a force; 0 before anything has ever touched.
    fn loaded_scale(&self) -> f64 {
        self.current.force_scale.max(self.last_scale).max(LOST_SHARE * self.largest_scale)
    }

    /// Tells that the accepted trial has been committed: its normal force is what later steps are
    /// measured by where they lose contact. A step that is not committed leaves nothing behind.
    pub fn committed(&mut self) {
        self.last_scale = self.current.force_scale;
        self.largest_scale = self.largest_scale.max(self.last_scale);
    }

    /// Sums of the normal contact forces of the last committed step and the largest of any (see
    /// [`Newton::committed`]): all that a step depends on of what the iteration keeps between
    /// steps.
    pub fn force_scales(&self) -> [f64; 2] {
        [self.last_scale, self.largest_scale]
    }

    /// Sets them, to go on from an earlier state.
    pub fn set_force_scales(&mut self, [last, largest]: [f64; 2]) {
        (self.last_scale, self.largest_scale) = (last, largest);
    }

    /// Lets the contact points that `points` marks slide without friction until it is called again;
    /// none of them for an empty list.
    pub fn set_sliding(&mut self, points: &[bool]) {
        self.iterates.host.set_sliding(points);
    }

    /// Contact points that slide so.
    pub fn sliding(&self) -> &[bool] {
        &self.iterates.host.boundary().frictionless
    }

    /// Says whether steps that have used up their iterations count as converged, and as relaxed, if
    /// a held normal force alone is missed, and by no more than [`HELD_AT_LAST`] of it.
    pub fn set_may_miss(&mut self, may_miss: bool) {
        self.may_miss = may_miss;
    }

    /// Sets out for the next step (see [`Opponent::set_out`]).
    pub fn set_out(&mut self, mesh: &Mesh, start: &[f64], expected: &[f64], symmetric: bool) {
        self.is_even = symmetric;
        self.iterates.host.set_out(mesh, start, expected, symmetric);
    }

    /// Work that friction dissipates in the step to the accepted trial, on the meshed half.
    pub fn friction_work(&self, step: &StepTaken<'_>) -> f64 {
        self.opponent().friction_work(self.accepted(), step)
    }

    /// What the bodies need at the points at which Coulomb's law is posed, in the frames in which
    /// it is (two tangential components and the normal one), and what each point does: in
    /// equilibrium the forces of contact, but not projected onto what contact can exert. Where the
    /// vectors are on the host.
    pub fn needed_forces(&self, mesh: &Mesh) -> Vec<([f64; 3], Status)> {
        self.opponent().needed_forces(self.accepted(), mesh)
    }

    /// What contact exerts on each contact node at the accepted trial, what each does, and its gap,
    /// where its vectors are on the host.
    pub fn contact_state(&self, mesh: &Mesh) -> (Vec<[f64; 3]>, Vec<Status>, Vec<f64>) {
        let (trial, opponent) = (self.accepted(), self.opponent());
        (opponent.forces(trial, mesh), opponent.statuses(trial), opponent.gaps(trial, mesh))
    }

    /// Number of contact nodes of the sphere; those of another body follow them.
    pub fn own_contacts(&self) -> usize {
        self.iterates.host.boundary().own_contacts
    }

    /// Number of unknown displacements that are not prescribed.
    pub fn free_unknowns(&self) -> usize {
        self.iterates.host.boundary().prescribed.iter().filter(|p| !**p).count()
    }

    /// The tangential stiffness of the meshed half at the start of a shear; `None` where the state
    /// has no answer.
    ///
    /// # Errors
    /// [`SolverError`].
    pub fn tangential_stiffness(&mut self, case: &mut CaseHandle<'_>, start: &SetOff<'_>) -> Result<Option<f64>, SolverError> {
        match self.iterates.host.tangential_stiffness(case, start, &mut self.times) {
            Ok(stiffness) => Ok(Some(stiffness).filter(|k| k.is_finite())),
            Err(Halt::Step(failure)) => {
                log::info!("no tangential stiffness: {failure}");
                Ok(None)
            }
            Err(Halt::Solver(error)) => Err(error),
        }
    }

    /// The outward forces that unit coefficients of the plate's widening make in the undeformed
    /// body (see [`super::pose`]).
    ///
    /// # Errors
    /// [`SolverError`]; a system without an answer is one of the mesh.
    pub fn widening_stiffness(&mut self, case: &mut CaseHandle<'_>) -> Result<[[f64; MODES]; MODES], SolverError> {
        match self.iterates.host.widening_stiffness(case, &mut self.times) {
            Ok(stiffness) => Ok(stiffness),
            Err(Halt::Step(failure)) => {
                log::info!("no stiffness of the equator: {failure}");
                Ok([[f64::NAN; MODES]; MODES])
            }
            Err(Halt::Solver(error)) => Err(error),
        }
    }

    /// Outward forces of the plate at the accepted trial, which stands in this pose.
    pub fn outward(&self, pose: &Pose) -> [f64; MODES] {
        self.iterates.host.accepted_outward(pose)
    }

    /// Finds equilibrium under `control` from the committed displacement, trying a guess first if
    /// there is one.
    ///
    /// On success the solution is the accepted trial ([`Newton::accepted`], [`Newton::settle`]);
    /// nothing is committed. A failure leaves the committed state as it was.
    pub fn solve(
        &mut self,
        case: &mut CaseHandle<'_>,
        start: &SetOut<'_>,
        control: &Control,
    ) -> Result<StepOutcome, SolverError> {
        let keeps = self.keeps_on(case, self.is_even);
        self.is_resident = keeps != Keeps::Nothing;
        self.tolerance = self.settings.tolerance.max(if keeps == Keeps::Guesses { SINGLE } else { 0.0 });
        let followed = if keeps == Keeps::Guesses {
            let sliding = self.sliding().to_vec();
            let made = self.follow(case, start, control);
            self.confirm(case, start, control, &sliding, made)
        } else {
            self.follow(case, start, control)
        };
        match followed {
            Ok(report) => Ok(StepOutcome::Converged(report)),
            Err(Halt::Step(failure)) => Ok(StepOutcome::Failed(failure)),
            Err(Halt::Solver(error)) => Err(error),
        }
    }

    /// Checks the step that a device has converged in f32 against the residual in f64, and goes on
    /// from there on the host if that is above the tolerance. If f32 did not converge, the host
    /// starts over, with these points sliding.
    fn confirm(
        &mut self,
        case: &mut CaseHandle<'_>,
        start: &SetOut<'_>,
        control: &Control,
        sliding: &[bool],
        made: Result<StepReport, Halt>,
    ) -> Result<StepReport, Halt> {
        let mut lap = Lap::start();
        let brought = made.and_then(|made| Ok((self.iterates.hand_over(case, control)?, made)));
        lap.end(&mut self.times, Phase::Force);
        (self.is_resident, self.tolerance) = (false, self.settings.tolerance);
        let (vectors, made) = match brought {
            Ok((vectors, made)) => (Some(vectors), made),
            Err(Halt::Step(failure)) => {
                log::debug!("  in f32: {failure}; the step is made in f64");
                self.given_up += failure.iterations();
                (None, StepReport::default())
            }
            // The device is lost, and the state is not.
            Err(Halt::Solver(SolverError::Compute(ComputeError::Moved))) => (None, StepReport::default()),
            Err(fault) => return Err(fault),
        };
        let followed = match &vectors {
            Some(vectors) => {
                let start = SetOut { guess: Some(&vectors.displacement), came_off: &vectors.came_off, ..*start };
                self.follow(case, &start, &Control { h: self.iterates.h(), ..*control })
            }
            None => {
                self.iterates.host.set_sliding(sliding);
                self.follow(case, start, control)
            }
        };
        match followed {
            Ok(report) => Ok(report.after(made)),
            Err(halt) => {
                self.give_up(made);
                Err(halt)
            }
        }
    }

    /// Contact points that came off in the iterations to the accepted trial, or before them as they
    /// were told.
    pub fn came_off(&self) -> &[bool] {
        self.iterates.host.came_off()
    }

    /// Counts what a solution took from which no step comes.
    pub fn give_up(&mut self, made: StepReport) {
        self.given_up += made.iterations.len();
        self.times += made.times;
    }

    /// Newton iterations since the last call from which no step has come.
    pub fn take_given_up(&mut self) -> usize {
        std::mem::take(&mut self.given_up)
    }

    fn follow(&mut self, case: &mut CaseHandle<'_>, start: &SetOut<'_>, control: &Control) -> Result<StepReport, Halt> {
        let mut times = std::mem::take(&mut self.times);
        let begun = self.iterate().begin(case, start, control, &mut times);
        self.times = times;
        self.current = begun?;
        if let Err(fault) = self.current.check() {
            return Err(self.refused(case, control, fault, "at the start of the step"));
        }
        let mut report = StepReport { landed_again: self.current.landed, ..StepReport::default() };
        let mut previous = f64::INFINITY;
        let mut highest = 0.0_f64;
        let mut at_kink = false;
        let most = self.settings.max_iterations;
        for iteration in 0..=2 * most {
            let scale = self.scale();
            // The plate moves with the first linear solve; until then the merit knows of what is
            // missing.
            if at_kink || self.has_converged(case, control, HELD_TOLERANCE) {
                report.relaxed = at_kink;
                return Ok(self.end(report));
            }
            if iteration >= most && !self.is_about_to_converge(&report) || iteration == 2 * most {
                break;
            }
            let loosest = control.normal_force.map_or(1.0, |_| self.settings.held_linear);
            let eta = self.forcing(previous).min(loosest);
            let mut times = std::mem::take(&mut self.times);
            let corrected = self.iterate().correct(case, Asked { control, eta, first: iteration == 0 }, &mut times);
            self.times = times;
            let Correction { krylov, fallback, delta_h, slope } = corrected?;
            report.fallbacks += usize::from(fallback);
            highest = highest.max(self.current.merit);
            // An iteration that moves the plate has no merit before it to be compared with.
            let moves_plate = iteration == 0 && !self.iterate().plate_is_placed(control);
            let reference = match iteration {
                0 if moves_plate => f64::INFINITY,
                i if i < self.settings.monotone_from => highest,
                _ => self.current.merit,
            };
            let before = self.current.merit / scale;
            previous = self.current.merit;
            let may_stay = iteration >= self.settings.monotone_from
                && self.iterate().plate_is_placed(control)
                && self.holds_force(control, 2.0 * HELD_TOLERANCE)
                && previous <= KINK * self.tolerance * scale;
            let (step_length, found) = self.line_search(case, control, reference, slope, delta_h)?;
            if may_stay && found.merit >= previous {
                report.iterations.push(Iteration { merit: before, step_length: 0.0, krylov, changed: 0 });
                log::debug!("  iteration {:2}: merit {before:.2e}, which no step length lowers: accepted", iteration + 1);
                at_kink = true;
                continue;
            }
            self.keep(case, control, step_length, found, &mut report)?;
            if moves_plate {
                highest = 0.0;
                previous = f64::INFINITY;
            }
            let changed = found.changed;
            report.iterations.push(Iteration { merit: before.min(f64::MAX), step_length, krylov, changed });
            log::debug!(
                "  iteration {:2}: merit {:.2e} -> {:.2e}, step {step_length}, krylov {krylov} (eta {eta:.1e}), {changed} changed",
                iteration + 1,
                before,
                self.current.merit / self.scale().max(f64::MIN_POSITIVE),
            );
        }
        if self.may_miss && self.has_converged(case, control, HELD_AT_LAST) {
            report.relaxed = true;
            return Ok(self.end(report));
        }
        let scale = self.scale();
        let worst = self.iterate().worst(case, control, scale)?;
        let merit = self.current.merit / scale.max(f64::MIN_POSITIVE);
        Err(StepFailure::Iterations { iterations: report.iterations.len(), merit, worst }.into())
    }

    /// The report of a step that ends at the current iterate.
    fn end(&mut self, report: StepReport) -> StepReport {
        let scale = self.scale();
        let merit = if scale > 0.0 { self.current.merit / scale } else { 0.0 };
        StepReport { merit, times: std::mem::take(&mut self.times), ..report }
    }

    /// Makes the trial at a step length the current iterate; under full stick with the points that
    /// land in it let go of.
    fn keep(
        &mut self,
        case: &mut CaseHandle<'_>,
        control: &Control,
        length: f64,
        found: Reading,
        report: &mut StepReport,
    ) -> Result<(), Halt> {
        let mut times = std::mem::take(&mut self.times);
        let iterate = self.iterate();
        let mut kept = iterate.keep(case, control, length, &mut times).map(|()| None);
        if kept.is_ok() && case.model().friction == Friction::Stick {
            kept = iterate.land(case, control, found.landed, &mut times);
        }
        self.times = times;
        self.current = found;
        if let Some((landed, reading)) = kept? {
            report.landed_again += landed;
            self.current = reading;
            if let Err(fault) = reading.check() {
                return Err(self.refused(case, control, fault, "where points have come down again"));
            }
        }
        Ok(())
    }

    /// The merit has fallen so much in the last iterations that a few more will do: a step is not
    /// given up then.
    fn is_about_to_converge(&self, report: &StepReport) -> bool {
        let done = &report.iterations;
        done.len() >= FEW_ITERATIONS && self.current.merit < CONVERGING * done[done.len() - LAST_ITERATIONS].merit * self.scale()
    }

    /// The merit is below the tolerance, the tangential residuals of the contact are against the
    /// friction that there can be, and a held normal force is met to this share of it.
    fn has_converged(&mut self, case: &CaseHandle<'_>, control: &Control, held: f64) -> bool {
        // Not by a force that is made up: a light contact would end the step before it carries any.
        let bound = (self.tolerance * self.loaded_scale()).max(ROUNDING);
        // Written so that a NaN has not converged.
        if !(self.current.merit <= bound) || !self.iterate().plate_is_placed(control) {
            return false;
        }
        let friction = match case.model().friction {
            Friction::Coulomb(mu) if mu > 0.0 => (TANGENTIAL * mu).min(1.0),
            _ => 1.0,
        };
        (friction == 1.0 || self.current.tangential <= (friction * bound).max(ROUNDING)) && self.holds_force(control, held)
    }

    /// A normal force that is to be held is met to this share of it.
    fn holds_force(&self, control: &Control, tolerance: f64) -> bool {
        let found = self.current.normal_force;
        control.normal_force.is_none_or(|force| (found - force).abs() <= (tolerance * force).max(ROUNDING))
    }

    fn forcing(&self, previous: f64) -> f64 {
        let (merit, loosest) = (self.current.merit, self.settings.loosest_linear);
        // A step's first system carries the whole increment: its merit says nothing about the size
        // of what is to be found.
        if merit == 0.0 {
            return loosest;
        }
        if !previous.is_finite() {
            return loosest.min((self.settings.first_linear * self.scale() / merit).max(TIGHTEST_FIRST));
        }
        let floor = 0.3 * self.tolerance * self.scale() / merit;
        let ratio = merit / previous;
        (FORCING_GAMMA * ratio * ratio).max(floor).clamp(1e-12, loosest)
    }
}
