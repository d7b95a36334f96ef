//! Iterates whose vectors are on the host.

use super::{Asked, Correction, Iterate, SetOut};
use crate::compute::handle::CaseHandle;
use crate::compute::iterate::{Reading, Vectors};
use crate::compute::{ComputeError, Evaluated};
use crate::contact::coulomb::{Friction, Status};
use crate::linalg::{LinalgError, SolverKind};
use crate::mesh::Mesh;
use crate::solver::boundary::Boundary;
use crate::solver::opponent::Opponent;
use crate::solver::opponent::rigid::RigidBody;
use crate::solver::outcome::{Halt, StepFailure, Worst};
use crate::solver::phases::PhaseTimes;
use crate::solver::systems::Systems;
use crate::solver::trial::Trial;
use crate::solver::{Control, SolverError};

/// Iterates of one case with everything that is kept of them between steps.
pub struct HostIterate {
    /// Which displacements are prescribed.
    pub(super) boundary: Boundary,
    /// What the body is pressed against.
    pub(super) opponent: Box<dyn Opponent>,
    pub(super) linear: Systems,
    pub(super) current: Trial,
    candidate: Trial,
    best: Trial,
    /// Step length of `best`.
    favoured: f64,
    tried: f64,
    /// Per contact point under full stick: it has come off in the iteration of the present step.
    came_off: Vec<bool>,
    pub(super) fixed: Vec<bool>,
    pub(super) rhs: Vec<f64>,
    /// Correction of the displacements, and of the unknowns that the linear system has: at contact
    /// nodes what the opponent makes of them.
    pub(super) delta: Vec<f64>,
    pub(super) correction: Vec<f64>,
    pub(super) delta_h: f64,
    pub(super) functional: Vec<f64>,
    pub(super) unit_rhs: Vec<f64>,
    pub(super) unit_response: Vec<f64>,
    /// Forces at the contact under a unit indentation of a body that moves as one, over those at a
    /// plate that moves alone.
    pub(super) unit_scale: f64,
    /// Krylov iterations of the step's last system and of its response to a unit indentation.
    pub(super) expected: [usize; 2],
}

impl HostIterate {
    /// Iterates on a mesh.
    pub fn new(mesh: &Mesh, linear: Systems) -> Self {
        Self {
            boundary: Boundary::new(mesh),
            opponent: Box::new(RigidBody::default()),
            linear,
            current: Trial::default(),
            candidate: Trial::default(),
            best: Trial::default(),
            favoured: 0.0,
            tried: 0.0,
            came_off: vec![false; mesh.contact_nodes.len()],
            fixed: Vec::new(),
            rhs: Vec::new(),
            delta: Vec::new(),
            correction: Vec::new(),
            delta_h: 0.0,
            functional: Vec::new(),
            unit_rhs: Vec::new(),
            unit_response: Vec::new(),
            unit_scale: 1.0,
            expected: [0; 2],
        }
    }

    /// Sets what the body is pressed against, in place of the plane.
    pub fn against(&mut self, opponent: Box<dyn Opponent>) {
        self.opponent = opponent;
    }

    /// The current iterate.
    pub fn current(&self) -> &Trial {
        &self.current
    }

    /// What the body is pressed against.
    pub fn opponent(&self) -> &dyn Opponent {
        &*self.opponent
    }

    /// Which displacements are prescribed.
    pub fn boundary(&self) -> &Boundary {
        &self.boundary
    }

    /// Lets the contact points that `points` marks slide without friction; none for an empty list.
    pub fn set_sliding(&mut self, points: &[bool]) {
        self.boundary.frictionless.fill(false);
        self.boundary.frictionless.iter_mut().zip(points).for_each(|(slides, &point)| *slides = point);
    }

    /// Sets out for a step (see [`Opponent::set_out`]).
    pub fn set_out(&mut self, mesh: &Mesh, start: &[f64], expected: &[f64], symmetric: bool) {
        self.opponent.set_out(mesh, start, expected, symmetric);
    }

    /// What Newton's method decides by of a trial, as seen from the current iterate.
    fn reading(&self, trial: &Trial, outcome: Evaluated, case: &CaseHandle<'_>, control: &Control) -> Reading {
        if outcome != Evaluated::Valid {
            return Reading::of_nothing(outcome);
        }
        let held = || trial.contact_force(&case.model().mesh, &self.boundary, &*self.opponent)[2];
        let stick = case.model().friction == Friction::Stick;
        Reading {
            outcome,
            merit: trial.merit,
            force_scale: trial.force_scale,
            plate_force: trial.plate_force,
            tangential: trial.tangential_residual(),
            normal_force: control.normal_force.map_or(0.0, |_| held()),
            slope: 0.0,
            released: if stick { self.released(trial) } else { 0.0 },
            changed: trial.rows.iter().zip(&self.current.rows).filter(|(a, b)| a.status != b.status).count(),
            landed: 0,
        }
    }

    /// Square of the tangential forces of points that come off in a trial. Under full stick a point
    /// that comes off lets go of whatever it held: the merit jumps by it, however short the step,
    /// and a line search that counts the jump creeps up to it and stays there. No point does so
    /// twice in a step (see [`Iterate::land`]).
    fn released(&self, trial: &Trial) -> f64 {
        (trial.rows.iter().zip(&self.current.rows).zip(&self.boundary.frictionless))
            .filter(|((after, before), frictionless)| {
                before.status == Status::Stick && after.status == Status::Open && !**frictionless
            })
            .map(|((after, _), _)| {
                let across = if after.fixed[1] { 0.0 } else { after.residual[1] };
                after.residual[0] * after.residual[0] + across * across
            })
            .sum()
    }

    /// Work of the free residual forces of a trial on the correction.
    fn slope(&self, trial: &Trial) -> f64 {
        let free = trial.residual.iter().zip(&self.correction).zip(&self.fixed).filter(|(_, fixed)| !**fixed);
        free.map(|((r, d), _)| r * d).sum::<f64>()
    }

    /// That of the current iterate.
    pub(super) fn slope_of_current(&self) -> f64 {
        self.slope(&self.current)
    }

    /// A step, even in x if it is `even`, whose conditions of contact backends know, its systems
    /// solved with multigrid: what a device that keeps iterates does by itself.
    pub fn is_known_by_multigrid(&self, even: bool) -> bool {
        self.opponent.is_known(even) && self.linear.kind() == SolverKind::Multigrid
    }

    /// Over a rigid body, its systems solved with multigrid.
    pub fn is_rigid_by_multigrid(&self) -> bool {
        self.opponent.is_rigid() && self.linear.kind() == SolverKind::Multigrid
    }

    /// Takes the memory of vectors and matrices, if it has not yet: on a device that keeps iterates
    /// they are not needed.
    pub(super) fn furnish(&mut self, mesh: &Mesh) -> Result<(), LinalgError> {
        self.linear.make()?;
        let n = 3 * mesh.nodes.len();
        if self.rhs.len() == n {
            return Ok(());
        }
        (self.current, self.candidate, self.best) = (Trial::new(mesh), Trial::new(mesh), Trial::new(mesh));
        self.fixed = vec![false; n];
        for vector in [
            &mut self.rhs,
            &mut self.delta,
            &mut self.correction,
            &mut self.functional,
            &mut self.unit_rhs,
            &mut self.unit_response,
        ] {
            *vector = vec![0.0; n];
        }
        Ok(())
    }

    /// Takes over an iterate from a device, and says whether it can be gone on from.
    pub(super) fn take_over(
        &mut self,
        case: &mut CaseHandle<'_>,
        vectors: &Vectors,
        h: f64,
        control: &Control,
    ) -> Result<Evaluated, SolverError> {
        self.furnish(&case.model().mesh.clone())?;
        self.current.u.copy_from_slice(&vectors.displacement);
        self.current.force.copy_from_slice(&vectors.force);
        self.current.h = h;
        if self.opponent.is_rigid() {
            self.boundary.frictionless.copy_from_slice(&vectors.sliding);
        }
        Ok(self.current.assess(case, &self.boundary, &*self.opponent, control, &mut PhaseTimes::default())?)
    }

    /// Lets the points of the current iterate slide that have come off and are down again; returns
    /// how many.
    fn let_landed_slide(&mut self) -> usize {
        let mut landed = 0;
        for ((slides, came_off), row) in self.boundary.frictionless.iter_mut().zip(&self.came_off).zip(&self.current.rows) {
            if *came_off && row.status == Status::Stick && !*slides {
                *slides = true;
                landed += 1;
            }
        }
        landed
    }

    /// Which contact points have come off within the step.
    pub fn came_off(&self) -> &[bool] {
        &self.came_off
    }

    /// Moves the body, which touches nothing, with the plate; its forces turn with it.
    fn follow_plate(&mut self, mesh: &Mesh, start: &SetOut<'_>, control: &Control) {
        let own = self.boundary.own_nodes;
        if control.pose.turn == start.pose.turn {
            let plate = self.boundary.plate.first().map_or(0, |&n| 3 * n as usize);
            let from_centre = self.boundary.from_centre.first().copied().unwrap_or_default();
            let target = control.pose.displacement(self.current.h, &from_centre);
            let shift: [f64; 3] = std::array::from_fn(|i| target[i] - start.displacement[plate + i]);
            for u in self.current.u.chunks_exact_mut(3).take(own) {
                u.iter_mut().zip(shift).for_each(|(u, s)| *u += s);
            }
            return;
        }
        let motion = start.pose.motion_to(start.h, &control.pose, self.current.h);
        for (u, x) in self.current.u.chunks_exact_mut(3).zip(&mesh.nodes).take(own) {
            let moved = motion.moved([x[0] + u[0], x[1] + u[1], x[2] + u[2]]);
            u.iter_mut().zip(moved).zip(x).for_each(|((u, moved), x)| *u = moved - x);
        }
        for f in self.current.force.chunks_exact_mut(3).take(own) {
            f.copy_from_slice(&motion.turned([f[0], f[1], f[2]]));
        }
    }

    /// Evaluates the candidate at a step length.
    fn evaluate(
        &mut self,
        case: &mut CaseHandle<'_>,
        control: &Control,
        length: f64,
        times: &mut PhaseTimes,
    ) -> Result<Evaluated, ComputeError> {
        for ((u, u0), d) in self.candidate.u.iter_mut().zip(&self.current.u).zip(&self.delta) {
            *u = u0 + length * d;
        }
        self.candidate.h = self.current.h + length * self.delta_h;
        if length == 1.0 {
            // Rounding must not leave the plate a hair from where it belongs.
            self.boundary.place_plate(&mut self.candidate.u, self.candidate.h, &control.pose);
        }
        self.candidate.evaluate(case, &self.boundary, &*self.opponent, control, times)
    }
}

impl Iterate for HostIterate {
    fn begin(
        &mut self,
        case: &mut CaseHandle<'_>,
        start: &SetOut<'_>,
        control: &Control,
        times: &mut PhaseTimes,
    ) -> Result<Reading, Halt> {
        self.came_off.fill(false);
        self.came_off.iter_mut().zip(start.came_off).for_each(|(off, came_off)| *off = *came_off);
        let mesh = case.model().mesh.clone();
        self.furnish(&mesh)?;
        if let Some(guess) = start.guess {
            self.current.h = control.h;
            self.current.u.copy_from_slice(guess);
            self.boundary.place_plate(&mut self.current.u, self.current.h, &control.pose);
            let mut outcome = self.current.evaluate(case, &self.boundary, &*self.opponent, control, times)?;
            let landed = if outcome == Evaluated::Valid { self.let_landed_slide() } else { 0 };
            if landed > 0 {
                outcome = self.current.assess(case, &self.boundary, &*self.opponent, control, times)?;
            }
            if outcome == Evaluated::Valid {
                return Ok(Reading { landed, ..self.reading(&self.current, outcome, case, control) });
            }
        }
        self.current.h = if control.normal_force.is_some() { start.h } else { control.h };
        self.current.u.copy_from_slice(start.displacement);
        // The plate's increment enters through the linear system.
        let mut outcome = self.current.evaluate(case, &self.boundary, &*self.opponent, control, times)?;
        if outcome == Evaluated::Valid && self.current.force_scale == 0.0 {
            // Nothing touches: the body follows the plate as it is.
            self.follow_plate(&mesh, start, control);
            self.boundary.place_plate(&mut self.current.u, self.current.h, &control.pose);
            // A shift leaves the forces as they are. Evaluated anew they would be those of an
            // unloaded body, nothing but rounding, and which points stick would hang on it: the
            // step would go another way on every device.
            outcome = self.current.assess(case, &self.boundary, &*self.opponent, control, times)?;
        }
        Ok(self.reading(&self.current, outcome, case, control))
    }

    fn h(&self) -> f64 {
        self.current.h
    }

    fn plate_is_placed(&self, control: &Control) -> bool {
        self.boundary.plate.iter().zip(&self.boundary.from_centre).all(|(&n, from_centre)| {
            let u = &self.current.u[3 * n as usize..3 * n as usize + 3];
            let target = control.pose.displacement(self.current.h, from_centre);
            u.iter().zip(target).all(|(u, target)| (u - target).abs() <= 1e-14)
        })
    }

    fn correct(&mut self, case: &mut CaseHandle<'_>, asked: Asked<'_>, times: &mut PhaseTimes) -> Result<Correction, Halt> {
        let found = self.linearise(case, asked, times)?;
        Ok(Correction { slope: self.slope(&self.current), ..found })
    }

    fn try_length(
        &mut self,
        case: &mut CaseHandle<'_>,
        control: &Control,
        length: f64,
        times: &mut PhaseTimes,
    ) -> Result<Reading, Halt> {
        let outcome = self.evaluate(case, control, length, times)?;
        self.tried = length;
        let reading = self.reading(&self.candidate, outcome, case, control);
        if outcome != Evaluated::Valid {
            return Ok(reading);
        }
        Ok(Reading { slope: self.slope(&self.candidate), ..reading })
    }

    fn favour(&mut self) {
        std::mem::swap(&mut self.candidate, &mut self.best);
        self.favoured = self.tried;
    }

    fn keep(&mut self, case: &mut CaseHandle<'_>, control: &Control, length: f64, times: &mut PhaseTimes) -> Result<(), Halt> {
        if length != self.favoured {
            let outcome = self.evaluate(case, control, length, times)?;
            outcome.check().map_err(|fault| StepFailure::Invalid { fault, when: "at an iterate that was valid before" })?;
            std::mem::swap(&mut self.candidate, &mut self.best);
            self.favoured = length;
        }
        // The iterate before is in `best` from now on.
        std::mem::swap(&mut self.current, &mut self.best);
        Ok(())
    }

    fn land(
        &mut self,
        case: &mut CaseHandle<'_>,
        control: &Control,
        _expected: usize,
        times: &mut PhaseTimes,
    ) -> Result<Option<(usize, Reading)>, Halt> {
        for (i, (before, after)) in self.best.rows.iter().zip(&self.current.rows).enumerate() {
            let came_off = before.status == Status::Stick && after.status == Status::Open;
            self.came_off[i] |= came_off && !self.boundary.frictionless[i];
        }
        let landed = self.let_landed_slide();
        if landed == 0 {
            return Ok(None);
        }
        let outcome = self.current.assess(case, &self.boundary, &*self.opponent, control, times)?;
        Ok(Some((landed, self.reading(&self.current, outcome, case, control))))
    }

    fn worst(&mut self, case: &mut CaseHandle<'_>, _control: &Control, scale: f64) -> Result<Worst, Halt> {
        Ok(self.current.worst(&case.model().mesh, &self.boundary, scale))
    }
}
