//! One step: semismooth Newton with a backtracking line search on the contact merit, inexact linear
//! solves.

mod line_search;
mod linearise;

use super::encounter::Encounter;
use super::outcome::{Halt, Iteration, StepFailure, StepOutcome, StepReport};
use super::pair::mirror_nodes;
use super::phases::PhaseTimes;
use super::rigid::Against;
use super::system::{Boundary, Meeting, Trial};
use super::systems::Systems;
use super::{Control, Settings, SolverError};
use crate::compute::Outcome;
use crate::compute::handle::Evaluate;
use crate::contact::coulomb::{Friction, Status};
use crate::contact::pair::leave_even;
use crate::contact::rigid::Rigid;
use crate::mesh::Mesh;
use linearise::{Asked, Linearised};

/// Eisenstat & Walker (1996), choice 2: eta = gamma (m_k / m_k-1)^2. Not below what the tolerance
/// of the step asks for, and at the loosest to [`Settings::loosest_linear`]. Solving more tightly
/// (gamma 0.9, the first system to 0.01) takes a sixth more processor time for 3 % fewer
/// iterations: it is plastic loading and unloading that the iteration has to find.
const FORCING_GAMMA: f64 = 2.0;
/// The first linear system of a step is solved no further than this.
const TIGHTEST_FIRST: f64 = 1e-4;
/// A held normal force is met to this share of it.
const HELD_TOLERANCE: f64 = 5e-5;
/// Linear systems are solved to this relative residual, or further, where the normal force is held:
/// what is missing of the solution would change the indentation, and with it which points slide. To
/// 0.1, the steps of a shear took four times the iterations.
const TIGHT_LINEAR: f64 = 0.01;
/// Tangential residuals of points in contact against the friction that the normal force can bear.
/// At mu = 0.3 the tolerance of the merit is the same.
const TANGENTIAL: f64 = 10.0 / 3.0;
/// At a kink of the merit, where a point at the edge changes its status whatever the step length,
/// no step lowers it, and the iteration would go round in circles until the step is given up. An
/// iterate so many tolerances away is then taken as it is.
const KINK: f64 = 3.0;

/// A step that has used up its iterations goes on, up to twice as many, as long as so many of them
/// lowered the merit by this factor. Not where it has only a few: who asks for that means it.
const LAST_ITERATIONS: usize = 3;
const CONVERGING: f64 = 0.2;
const FEW_ITERATIONS: usize = 10;

/// A merit that is rounding, whatever the normal force: forces are stresses of the order of E times
/// areas of the order of R^2.
const ROUNDING: f64 = 1e-14;
/// Force by which merits are scaled before anything has ever touched (a fully plastic contact of
/// a = 0.03 R at sigma_Y = E/1000 carries it).
const UNLOADED_SCALE: f64 = 1e-5;
/// Share of the largest normal force so far that measures residuals when nothing touches.
const LOST_SHARE: f64 = 1e-4;

/// The Newton iteration of one case with everything it keeps between steps.
pub struct Newton {
    boundary: Boundary,
    linear: Systems,
    settings: Settings,
    /// Force scale of the last accepted step, and the largest of any.
    last_scale: f64,
    largest_scale: f64,
    current: Trial,
    candidate: Trial,
    best: Trial,
    /// Per contact point under full stick: it has come off in the iteration of the present step.
    came_off: Vec<bool>,
    fixed: Vec<bool>,
    rhs: Vec<f64>,
    /// Correction of the displacements, and of the unknowns that the linear system has: relative
    /// displacements where the body meets its own image.
    delta: Vec<f64>,
    correction: Vec<f64>,
    functional: Vec<f64>,
    unit_rhs: Vec<f64>,
    unit_response: Vec<f64>,
    /// Forces at the contact under a unit indentation of a body that moves as one, over those at a
    /// plate that moves alone.
    unit_scale: f64,
    /// Krylov iterations of the step's last system and of its response to a unit indentation.
    expected: [usize; 2],
    /// Time spent since the last converged step; whoever drives the iteration adds what else a step
    /// takes.
    pub times: PhaseTimes,
}

impl Newton {
    /// Prepares the iteration on a mesh.
    pub fn new(mesh: &Mesh, linear: impl Into<Systems>, settings: Settings) -> Self {
        let n = 3 * mesh.nodes.len();
        let linear = linear.into();
        let mut boundary = Boundary::new(mesh);
        if let Systems::Pair(solver) = &linear {
            boundary.mirror = solver.mirror().to_vec();
        } else if matches!(linear, Systems::Couple(_)) {
            boundary.mirror = mirror_nodes(mesh).unwrap_or_default();
        }
        Self {
            boundary,
            linear,
            settings,
            last_scale: 0.0,
            largest_scale: 0.0,
            current: Trial::new(mesh),
            candidate: Trial::new(mesh),
            best: Trial::new(mesh),
            came_off: vec![false; mesh.contact_nodes.len()],
            fixed: vec![false; n],
            rhs: vec![0.0; n],
            delta: vec![0.0; n],
            correction: vec![0.0; n],
            functional: vec![0.0; n],
            unit_rhs: vec![0.0; n],
            unit_response: vec![0.0; n],
            unit_scale: 1.0,
            expected: [0; 2],
            times: PhaseTimes::default(),
        }
    }

    /// The same against a rigid sphere in place of the plane.
    pub fn against(mut self, rigid: Rigid) -> Self {
        self.boundary.against = Some(Against::new(rigid));
        self
    }

    /// The last accepted trial.
    pub fn accepted(&self) -> &Trial {
        &self.current
    }

    /// What merits are measured by: the sum of the normal contact forces, but where contact is
    /// being lost or is lost not less than what it was at the step's start, nor than a small share
    /// of what it ever was. Without contact there is no force to compare with.
    fn scale(&self) -> f64 {
        let scale = self.current.force_scale.max(self.last_scale).max(LOST_SHARE * self.largest_scale);
        if scale > 0.0 { scale } else { UNLOADED_SCALE }
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
        self.boundary.frictionless.fill(false);
        self.boundary.frictionless.iter_mut().zip(points).for_each(|(slides, &point)| *slides = point);
    }

    /// Sets the interface of an equal pair for the next step.
    pub fn meet(&mut self, meeting: Meeting) {
        if let Systems::Pair(solver) = &mut self.linear {
            solver.set_symmetric(meeting.symmetric);
        }
        self.boundary.pair = Some(meeting);
    }

    /// Sets the interface with another body for the next step.
    pub fn encounter(&mut self, encounter: Encounter) {
        self.boundary.encounter = Some(encounter);
    }

    /// Work that friction dissipates in the step to the accepted trial, on the meshed half, where
    /// the forces at the contact were `before` (three a node) at its start; between two bodies
    /// alone.
    pub fn interface_friction_work(&self, before: &[f64]) -> Option<f64> {
        self.boundary.encounter.as_ref().map(|encounter| encounter.friction_work(&self.current, before))
    }

    /// Leaves the even part of a guess where the step is symmetric.
    pub fn symmetrise(&self, guess: &mut [f64]) {
        if let Systems::Pair(solver) = &self.linear {
            solver.symmetrise(guess);
        } else if self.boundary.is_even() {
            leave_even(&self.boundary.mirror, guess);
        }
    }

    /// What contact exerts on each contact node at the accepted trial, what each does, and its gap.
    pub fn contact_state(&self, mesh: &Mesh) -> (Vec<[f64; 3]>, Vec<Status>, Vec<f64>) {
        let trial = &self.current;
        (trial.point_forces(mesh, &self.boundary), trial.statuses(&self.boundary), trial.gaps(mesh, &self.boundary))
    }

    /// Number of contact nodes of the sphere; those of another body follow them.
    pub fn own_contacts(&self) -> usize {
        self.boundary.own_contacts
    }

    /// Number of unknown displacements that are not prescribed.
    pub fn free_unknowns(&self) -> usize {
        self.boundary.prescribed.iter().filter(|p| !**p).count()
    }

    /// Finds equilibrium under `control` from the committed displacement `start`, trying `guess`
    /// first if there is one.
    ///
    /// On success the solution is in [`Newton::accepted`]; nothing is committed. A failure leaves
    /// the committed state as it was.
    pub fn solve(
        &mut self,
        case: &mut dyn Evaluate,
        start: &[f64],
        start_h: f64,
        guess: Option<&[f64]>,
        control: &Control,
    ) -> Result<StepOutcome, SolverError> {
        match self.iterate(case, start, start_h, guess, control) {
            Ok(report) => Ok(StepOutcome::Converged(report)),
            Err(Halt::Step(failure)) => Ok(StepOutcome::Failed(failure)),
            Err(Halt::Solver(error)) => Err(error),
        }
    }

    fn iterate(
        &mut self,
        case: &mut dyn Evaluate,
        start: &[f64],
        start_h: f64,
        guess: Option<&[f64]>,
        control: &Control,
    ) -> Result<StepReport, Halt> {
        let mesh = case.model().mesh.clone();
        self.came_off.fill(false);
        if let Some(against) = &mut self.boundary.against {
            against.set_out(&mesh, start);
        }
        self.begin(case, start, start_h, guess, control)?;
        let mut report = StepReport::default();
        let mut previous = f64::INFINITY;
        let mut highest = 0.0_f64;
        let mut at_kink = false;
        let most = self.settings.max_iterations;
        for iteration in 0..=2 * most {
            let scale = self.scale();
            // The plate moves with the first linear solve; until then the merit knows of what is
            // missing.
            if at_kink || self.has_converged(case, control) {
                report.relaxed = at_kink;
                report.merit = if scale > 0.0 { self.current.merit / scale } else { 0.0 };
                report.times = std::mem::take(&mut self.times);
                return Ok(report);
            }
            if iteration >= most && !self.is_about_to_converge(&report) || iteration == 2 * most {
                break;
            }
            let eta = self.forcing(previous).min(if control.normal_force.is_some() { TIGHT_LINEAR } else { 1.0 });
            let asked = Asked { mesh: &mesh, control, eta, first: iteration == 0 };
            let Linearised { krylov, fallback, delta_h } = self.linearise(case, asked)?;
            report.fallbacks += usize::from(fallback);
            highest = highest.max(self.current.merit);
            // An iteration that moves the plate has no merit before it to be compared with.
            let moves_plate = iteration == 0 && !self.plate_is_placed(control);
            let reference = match iteration {
                0 if moves_plate => f64::INFINITY,
                i if i < self.settings.monotone_from => highest,
                _ => self.current.merit,
            };
            let before = self.current.merit / scale;
            previous = self.current.merit;
            let may_stay = iteration >= self.settings.monotone_from
                && self.plate_is_placed(control)
                && self.holds_force(case, control, 2.0 * HELD_TOLERANCE)
                && previous <= KINK * self.settings.tolerance * scale;
            let (step_length, changed) = self.line_search(case, control, reference, delta_h)?;
            if may_stay && self.current.merit >= previous {
                // The line search has left the iterate that it started from in `best`.
                std::mem::swap(&mut self.current, &mut self.best);
                report.iterations.push(Iteration { merit: before, step_length: 0.0, krylov, changed: 0 });
                log::debug!("  iteration {:2}: merit {before:.2e}, which no step length lowers: accepted", iteration + 1);
                at_kink = true;
                continue;
            }
            if case.model().friction == Friction::Stick {
                let landed = self.land_again();
                if landed > 0 {
                    report.landed_again += landed;
                    self.current.assess(case, &self.boundary, control, &mut self.times)?;
                }
            }
            if moves_plate {
                highest = 0.0;
                previous = f64::INFINITY;
            }
            report.iterations.push(Iteration { merit: before.min(f64::MAX), step_length, krylov, changed });
            log::debug!(
                "  iteration {:2}: merit {:.2e} -> {:.2e}, step {step_length}, krylov {krylov} (eta {eta:.1e}), {changed} changed",
                iteration + 1,
                before,
                self.current.merit / self.scale().max(f64::MIN_POSITIVE),
            );
        }
        Err(self.exhausted(&mesh, report.iterations.len()).into())
    }

    /// The merit has fallen so much in the last iterations that a few more will do: a step is not
    /// given up then.
    fn is_about_to_converge(&self, report: &StepReport) -> bool {
        let done = &report.iterations;
        done.len() >= FEW_ITERATIONS && self.current.merit < CONVERGING * done[done.len() - LAST_ITERATIONS].merit * self.scale()
    }

    /// Sets the first iterate: the guess if it can be evaluated, the start otherwise.
    fn begin(
        &mut self,
        case: &mut dyn Evaluate,
        start: &[f64],
        start_h: f64,
        guess: Option<&[f64]>,
        control: &Control,
    ) -> Result<(), SolverError> {
        if let Some(guess) = guess {
            self.current.h = control.h;
            self.current.u.copy_from_slice(guess);
            self.boundary.place_plate(&mut self.current.u, self.current.h, control.delta_t);
            if self.current.evaluate(case, &self.boundary, control, &mut self.times)? == Outcome::Valid {
                return Ok(());
            }
        }
        self.current.h = if control.normal_force.is_some() { start_h } else { control.h };
        self.current.u.copy_from_slice(start);
        // The committed state can always be evaluated; the plate's increment enters through the
        // linear system.
        self.current.evaluate(case, &self.boundary, control, &mut self.times)?;
        if self.current.force_scale == 0.0 {
            // Nothing touches: the body follows the plate as it is.
            let plate = self.boundary.plate.first().map_or(0, |&n| 3 * n as usize);
            let shift = [control.delta_t - start[plate], 0.0, -self.current.h - start[plate + 2]];
            for (u, s) in self.current.u.chunks_exact_mut(3).take(self.boundary.own_nodes).zip(std::iter::repeat(shift)) {
                for i in 0..3 {
                    u[i] += s[i];
                }
            }
            self.boundary.place_plate(&mut self.current.u, self.current.h, control.delta_t);
            // A shift leaves the forces as they are. Evaluated anew they would be those of an
            // unloaded body, nothing but rounding, and which points stick would hang on it: the
            // step would go another way on every device.
            self.current.assess(case, &self.boundary, control, &mut self.times)?;
        }
        Ok(())
    }

    /// The merit is below the tolerance, the tangential residuals of the contact are against the
    /// friction that there can be, and a held normal force is met.
    fn has_converged(&self, case: &mut dyn Evaluate, control: &Control) -> bool {
        let bound = (self.settings.tolerance * self.scale()).max(ROUNDING);
        if self.current.merit > bound || !self.plate_is_placed(control) {
            return false;
        }
        let friction = match case.model().friction {
            Friction::Coulomb(mu) if mu > 0.0 => (TANGENTIAL * mu).min(1.0),
            _ => 1.0,
        };
        (friction == 1.0 || self.current.tangential_residual() <= (friction * bound).max(ROUNDING))
            && self.holds_force(case, control, HELD_TOLERANCE)
    }

    /// A normal force that is to be held is met to this share of it.
    fn holds_force(&self, case: &mut dyn Evaluate, control: &Control, tolerance: f64) -> bool {
        let found = || self.current.contact_force(&case.model().mesh, &self.boundary)[2];
        control.normal_force.is_none_or(|force| (found() - force).abs() <= (tolerance * force).max(ROUNDING))
    }

    /// Under full stick a point that came off within the step and comes down again has let go of
    /// its tangential force, and carries none up to the step's end: held to where it stuck before,
    /// or open, there may be no equilibrium for it. After a line search `best` is the iterate
    /// before. Returns how many points are new.
    fn land_again(&mut self) -> usize {
        let mut landed = 0;
        for (i, (before, after)) in self.best.rows.iter().zip(&self.current.rows).enumerate() {
            if self.boundary.frictionless[i] {
                continue;
            }
            self.came_off[i] |= before.status == Status::Stick && after.status == Status::Open;
            if self.came_off[i] && after.status == Status::Stick {
                self.boundary.frictionless[i] = true;
                landed += 1;
            }
        }
        landed
    }

    fn plate_is_placed(&self, control: &Control) -> bool {
        self.boundary.plate.iter().all(|&n| {
            let base = 3 * n as usize;
            let u = &self.current.u[base..base + 3];
            (u[0] - control.delta_t).abs() <= 1e-14 && (u[2] + self.current.h).abs() <= 1e-14
        })
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
        let floor = 0.3 * self.settings.tolerance * self.scale() / merit;
        let ratio = merit / previous;
        (FORCING_GAMMA * ratio * ratio).max(floor).clamp(1e-12, loosest)
    }

    fn exhausted(&self, mesh: &Mesh, iterations: usize) -> StepFailure {
        StepFailure::Iterations {
            iterations,
            merit: self.current.merit / self.scale().max(f64::MIN_POSITIVE),
            worst: self.current.worst(mesh, &self.boundary, self.scale()),
        }
    }
}
