//! The linear system of an iteration: formed and solved on the host, or where the tangents are
//! computed.

use super::host::HostIterate;
use super::{Asked, Correction};
use crate::compute::call::OfBlocks;
use crate::compute::handle::CaseHandle;
use crate::compute::linear::{Ended, Side, SideReport, SolveRequest, Solved};
use crate::linalg::{BlockMatrix, LinalgError};
use crate::mesh::Mesh;
use crate::solver::SolverError;
use crate::solver::boundary::Boundary;
use crate::solver::contact_rows::{apply_contact, turn};
use crate::solver::opponent::Opponent;
use crate::solver::outcome::{Halt, StepFailure};
use crate::solver::phases::{Lap, Phase, PhaseTimes};
use crate::solver::system::{fixed_unknowns, plate_functional, right_hand_side};
use crate::solver::systems::Matrix;
use crate::solver::trial::Trial;

/// Share of the forces at the contact to which the response to a unit indentation is solved, which
/// gives the change of h that a missing normal force asks for. Half and twice of it:
/// `benches/constants`.
pub(super) const UNIT_RESPONSE: f64 = 0.01;

/// Krylov iterations that the first system of a step is expected to take.
pub(super) const EXPECTED: usize = 4;

/// What came of a system that the backend was asked to solve.
enum There {
    Solved(Correction),
    /// It solves no such systems, or gave up after so many Krylov iterations.
    NotSolved {
        krylov: usize,
    },
}

impl HostIterate {
    /// Forms and solves the linear system: the correction is in `self.delta`.
    pub(super) fn linearise(
        &mut self,
        case: &mut CaseHandle<'_>,
        asked: Asked<'_>,
        times: &mut PhaseTimes,
    ) -> Result<Correction, Halt> {
        self.state_system(case, times);
        let krylov = match self.solve_there(case, asked, times)? {
            There::Solved(done) => return Ok(done),
            There::NotSolved { krylov } => krylov,
        };
        let here = self.solve_here(case, asked, times)?;
        Ok(Correction { krylov: krylov + here.krylov, ..here })
    }

    /// What is fixed at the current iterate, and the right-hand sides.
    pub(super) fn state_system(&mut self, case: &CaseHandle<'_>, times: &mut PhaseTimes) {
        let mesh = &case.model().mesh;
        let mut lap = Lap::start();
        fixed_unknowns(mesh, &self.boundary, &self.current.rows, &mut self.fixed);
        right_hand_side(&self.current, mesh, &self.boundary, &mut self.rhs);
        self.unit_rhs.fill(0.0);
        for &n in &self.boundary.plate {
            self.unit_rhs[3 * n as usize + 2] = -1.0;
        }
        self.delta_h = 0.0;
        lap.end(times, Phase::Contact);
    }

    /// As [`HostIterate::linearise`], by the backend. Where it stalls, the host has a direct solver
    /// to fall back on.
    fn solve_there(&mut self, case: &mut CaseHandle<'_>, asked: Asked<'_>, times: &mut PhaseTimes) -> Result<There, Halt> {
        let Asked { control, eta, first } = asked;
        let mesh = &case.model().mesh.clone();
        if !case.backend.about().solves {
            return Ok(There::NotSolved { krylov: 0 });
        }
        let tie = match self.is_rigid_by_multigrid() {
            true => None,
            false => match self.opponent.tied(&mut self.linear, &self.current, &self.boundary) {
                Some(tie) => Some(tie),
                None => return Ok(There::NotSolved { krylov: 0 }),
            },
        };
        let mut lap = Lap::start();
        if first {
            self.expected = [EXPECTED; 2];
        }
        let mut sides = vec![Side {
            rhs: self.rhs.clone(),
            tolerance: eta,
            relative_to_guess: false,
            expected: self.expected[0],
            guess: vec![0.0; self.rhs.len()],
        }];
        if control.normal_force.is_some() {
            if first {
                self.unit_response.fill(0.0);
                self.unit_response.iter_mut().skip(2).step_by(3).take(self.boundary.own_nodes).for_each(|z| *z = -1.0);
                self.opponent.contract(&self.current, mesh, &mut self.unit_response);
            }
            // The guess of the first iteration is the measure: see `unit_tolerance`.
            let share = eta.min(UNIT_RESPONSE);
            sides.push(Side {
                rhs: self.unit_rhs.clone(),
                tolerance: if first { share } else { unit_share(share, self.unit_scale) },
                relative_to_guess: first,
                expected: self.expected[1],
                guess: self.unit_response.clone(),
            });
        }
        let Trial { u, rows, frames, .. } = &self.current;
        let (rows, frames) = (rows.clone(), frames.clone());
        let system = SolveRequest { displacement: u.as_slice().into(), rows, frames, fixed: self.fixed.clone(), tie, sides };
        let Solved { outcome, solutions } = case.solve(system)?;
        if solutions.is_empty() {
            return Ok(There::NotSolved { krylov: 0 });
        }
        let reports: Vec<SideReport> = solutions.iter().map(|solution| solution.report).collect();
        for (x, solution) in [&mut self.correction, &mut self.unit_response].into_iter().zip(solutions) {
            *x = solution.x;
        }
        lap.end(times, Phase::LinearSolve);
        outcome.check().map_err(StepFailure::of_tangent)?;
        if let Some(unit) = reports.get(1).filter(|_| first) {
            self.unit_scale = if unit.rhs_norm > 0.0 { (unit.start_norm / unit.rhs_norm).min(1.0) } else { 1.0 };
        }
        self.expected.iter_mut().zip(&reports).for_each(|(expected, report)| *expected = report.iterations);
        let krylov = reports.iter().map(|report| report.iterations).sum();
        // The response to a unit indentation only says how far to move the plate: the best iterate
        // will do.
        if reports[0].ended != Ended::Converged || reports.iter().any(|report| report.ended == Ended::NotFinite) {
            log::debug!("  the device's linear solve ended {:?} after {krylov} iterations", reports[0].ended);
            return Ok(There::NotSolved { krylov });
        }
        let mut delta_h = 0.0;
        if let (Some(target), Some(unit)) = (control.normal_force, reports.get(1)) {
            delta_h = self.move_plate(target, reports[0].along, unit.along)?;
        }
        self.delta.copy_from_slice(&self.correction);
        self.opponent.expand(&self.current, mesh, &mut self.delta);
        self.delta_h = delta_h;
        Ok(There::Solved(Correction { krylov, fallback: false, delta_h, slope: 0.0 }))
    }

    /// The change of h by which the plate has the force that is to be held, given what its force
    /// changes by along the correction and along the response to a unit indentation; adds that
    /// response to the correction.
    fn move_plate(&mut self, target: f64, by_correction: f64, by_unit: f64) -> Result<f64, Halt> {
        let delta_h = (target - self.current.plate_force + by_correction) / -by_unit;
        if !delta_h.is_finite() {
            return Err(no_depth(delta_h).into());
        }
        for (d, b) in self.correction.iter_mut().zip(&self.unit_response) {
            *d += delta_h * b;
        }
        Ok(delta_h)
    }

    /// As [`HostIterate::linearise`], on the host.
    pub(super) fn solve_here(
        &mut self,
        case: &mut CaseHandle<'_>,
        asked: Asked<'_>,
        times: &mut PhaseTimes,
    ) -> Result<Correction, Halt> {
        let Asked { control, eta, first } = asked;
        let mesh = &case.model().mesh.clone();
        let held = control.normal_force.is_some().then_some(&mut self.functional);
        match self.linear.matrix_mut() {
            None => return Err(LinalgError::NotUpdated.into()),
            Some(Matrix::Double(matrix)) => form(matrix, case, &self.boundary, &*self.opponent, &self.current, held, times)?,
            Some(Matrix::Single(matrix)) => form(matrix, case, &self.boundary, &*self.opponent, &self.current, held, times)?,
        }
        let mut lap = Lap::start();
        self.opponent.refresh(&mut self.linear, &self.current, &self.boundary, &self.fixed)?;
        lap.end(times, Phase::LinearUpdate);
        self.correction.fill(0.0);
        let solved = match self.linear.solve(&self.rhs, eta, &mut self.correction, true) {
            Ok(report) => report,
            Err(error) => return Err(StepFailure::Linear(error.to_string()).into()),
        };
        let (mut krylov, fallback) = (solved.iterations, solved.fallback);
        let mut delta_h = 0.0;
        if let Some(target) = control.normal_force {
            // Bordered system: the response to a unit indentation, then h from the force equation.
            let tolerance = self.unit_tolerance(mesh, eta, first)?;
            // It only says how far to move the plate: an answer that is not quite so good is not
            // worth a direct solution.
            match self.linear.solve(&self.unit_rhs, tolerance, &mut self.unit_response, false) {
                Ok(report) => krylov += report.iterations,
                Err(LinalgError::Stalled { iterations, .. }) => krylov += iterations,
                Err(error) => return Err(StepFailure::Linear(error.to_string()).into()),
            }
            let (current, opponent, delta) = (&self.current, &self.opponent, &mut self.delta);
            let mut along = |x: &[f64]| {
                delta.copy_from_slice(x);
                opponent.expand(current, mesh, delta);
                self.functional.iter().zip(&*delta).map(|(w, x)| w * x).sum::<f64>()
            };
            let (by_delta, by_unit) = (along(&self.correction), along(&self.unit_response));
            delta_h = self.move_plate(target, by_delta, by_unit)?;
        }
        self.delta.copy_from_slice(&self.correction);
        self.opponent.expand(&self.current, mesh, &mut self.delta);
        self.opponent.leave_even_correction(&mut self.delta, &mut self.correction);
        lap.end(times, Phase::LinearSolve);
        self.delta_h = delta_h;
        Ok(Correction { krylov, fallback, delta_h, slope: 0.0 })
    }

    /// The relative residual to which the response to a unit indentation is solved, and the guess
    /// for it: the response of the iteration before, or at first a body that moves as one. What
    /// that leaves at the contact is the measure: the forces of the large elements at a plate that
    /// moves alone are R/a times as large, and a residual that is small beside those is not so
    /// beside the contact's.
    fn unit_tolerance(&mut self, mesh: &Mesh, eta: f64, first: bool) -> Result<f64, SolverError> {
        if first {
            let mut guess = vec![0.0; self.unit_rhs.len()];
            let alone = self.linear.residual_norm(&self.unit_rhs, &guess)?;
            guess.iter_mut().skip(2).step_by(3).take(self.boundary.own_nodes).for_each(|z| *z = -1.0);
            self.opponent.contract(&self.current, mesh, &mut guess);
            let moving = self.linear.residual_norm(&self.unit_rhs, &guess)?;
            self.unit_scale = if alone > 0.0 { (moving / alone).min(1.0) } else { 1.0 };
            self.unit_response.copy_from_slice(&guess);
        }
        Ok(unit_share(eta.min(UNIT_RESPONSE), self.unit_scale))
    }
}

/// Forms the matrix: the tangent, and the contact's rows in it if they stand there.
/// `held`, where the normal force is, receives how the plate's force follows the displacements.
pub(super) fn form<T: OfBlocks>(
    matrix: &mut BlockMatrix<T>,
    case: &mut CaseHandle<'_>,
    boundary: &Boundary,
    opponent: &dyn Opponent,
    current: &Trial,
    held: Option<&mut Vec<f64>>,
    times: &mut PhaseTimes,
) -> Result<(), Halt> {
    let mesh = &case.model().mesh.clone();
    let mut lap = Lap::start();
    case.tangent(&current.u, &mut matrix.blocks)?.check().map_err(StepFailure::of_tangent)?;
    lap.end(times, Phase::Tangent);
    if let Some(functional) = held {
        plate_functional(matrix, &boundary.plate, functional);
    }
    if opponent.is_in_matrix() {
        turn(matrix, mesh, &current.frames);
        apply_contact(matrix, mesh, &current.rows);
    }
    lap.end(times, Phase::Contact);
    Ok(())
}

/// Why a held normal force says nothing of h: the plate does not feel a change of h, or the linear
/// system's solutions are no numbers.
pub(super) fn no_depth(delta_h: f64) -> StepFailure {
    let why = match delta_h.is_nan() {
        false => "no contact carries the normal force that is to be held",
        true => "the change of h that the held normal force asks for is not a number",
    };
    StepFailure::Linear(why.to_owned())
}

/// The relative residual at which that of the contact's forces is `share`.
pub(super) fn unit_share(share: f64, unit_scale: f64) -> f64 {
    (share * unit_scale).clamp(1e-9, 0.1)
}
