//! The tangential stiffness with which a committed state sets out for a shear.
//!
//! It is the tangent of the force: the answer of the rates to a unit rate of the plate. No point
//! slips in it. Where the body flowed up to now, at the surface of yield, the motion decides what
//! flows on and what unloads, and that decides the motion: a linear system for the elastic body
//! first, then with the flow that its answer finds, until that is the same. An ideally plastic
//! contact at E/sigma_Y = 500, h = 0.02 R gives 0.2744, 0.2202, 0.2200, 0.2200 E R so.

use super::host::HostIterate;
use super::linearise::{form, unit_share};
use crate::compute::handle::CaseHandle;
use crate::linalg::LinalgError;
use crate::mesh::Mesh;
use crate::solver::Control;
use crate::solver::outcome::{Halt, StepFailure};
use crate::solver::phases::PhaseTimes;
use crate::solver::pose::Pose;
use crate::solver::system::fixed_unknowns;
use crate::solver::systems::{Matrix, OneBody, Systems};

/// Share of the forces at the contact to which the responses to a unit motion are solved. What they
/// lack counts twice in their energies. Half and twice of it: `benches/constants`.
const UNIT_MOTION: f64 = 1e-3;
/// Systems that are solved at most, and the change of the stiffness at which another would find
/// nothing new. Half and twice of either: `benches/constants`.
const MOST_SYSTEMS: usize = 8;
const SETTLED: f64 = 1e-4;
/// Unit motions of the plate.
const ALONG_X: [f64; 3] = [1.0, 0.0, 0.0];
const DOWN: [f64; 3] = [0.0, 0.0, -1.0];

/// A committed state, and the shear that is to start from it.
#[derive(Clone, Copy, Debug)]
pub struct SetOff<'a> {
    /// The committed displacement, three a node, from which the backend's step starts.
    pub displacement: &'a [f64],
    /// Motion of the plate that tells what flows: small against the yield strain times the contact
    /// radius, above the rounding of tangents in f32.
    pub probe: f64,
    /// Along x and y, of length 1.
    pub direction: [f64; 2],
    /// The normal force is held, and not the indentation.
    pub holds_force: bool,
}

impl SetOff<'_> {
    /// A unit motion of the plate, and its sign.
    fn sideways(&self) -> ([f64; 3], f64) {
        let [x, y] = self.direction;
        if y == 0.0 { (ALONG_X, x) } else { ([x, y, 0.0], 1.0) }
    }
}

/// What unit motions of the plate make of the bodies.
#[derive(Debug, Default)]
struct Motions {
    /// Response to one sideways, in the unknowns of the linear systems.
    sideways: Vec<f64>,
    /// Response to an indentation.
    down: Vec<f64>,
    /// The motion in which the shear sets out, along the axes.
    of_both: Vec<f64>,
}

impl HostIterate {
    /// The tangential force per tangential motion of the plate, of the meshed half. Every point
    /// that touches sticks.
    ///
    /// # Errors
    /// A state or a system without an answer; what the backend says.
    pub fn tangential_stiffness(
        &mut self,
        case: &mut CaseHandle<'_>,
        start: &SetOff<'_>,
        times: &mut PhaseTimes,
    ) -> Result<f64, Halt> {
        let was_planned = matches!(self.linear, Systems::Planned(_));
        self.boundary.stuck = true;
        let found = self.stiffness_where_all_sticks(case, start, times);
        self.boundary.stuck = false;
        if was_planned {
            // The matrices are a device's: none stay here.
            self.linear = Systems::Planned(OneBody::new(&case.model().mesh, self.linear.kind()));
        }
        found
    }

    fn stiffness_where_all_sticks(
        &mut self,
        case: &mut CaseHandle<'_>,
        start: &SetOff<'_>,
        times: &mut PhaseTimes,
    ) -> Result<f64, Halt> {
        let mesh = &case.model().mesh.clone();
        self.furnish(mesh)?;
        self.current.u.copy_from_slice(start.displacement);
        let control = Control { h: self.current.h, pose: Pose::default(), normal_force: None };
        let outcome = self.current.evaluate(case, &self.boundary, &*self.opponent, &control, times)?;
        outcome.check().map_err(|fault| StepFailure::Invalid { fault, when: "at the start of a shear" })?;
        fixed_unknowns(mesh, &self.boundary, &self.current.rows, &mut self.fixed);
        let mut motions = Motions::default();
        let mut stiffness = 0.0;
        for _ in 0..MOST_SYSTEMS {
            let before = std::mem::replace(&mut stiffness, self.tangent_stiffness(case, start, &mut motions, times)?);
            log::debug!("  tangential stiffness {stiffness:.6e}");
            if (stiffness - before).abs() <= SETTLED * stiffness.abs() {
                break;
            }
            let probe = start.sideways().1 * start.probe;
            let moved = start.displacement.iter().zip(&motions.of_both).map(|(u, d)| u + probe * d);
            self.current.u.iter_mut().zip(moved).for_each(|(u, moved)| *u = moved);
        }
        Ok(stiffness)
    }

    /// The stiffness by the tangent at the current displacement.
    fn tangent_stiffness(
        &mut self,
        case: &mut CaseHandle<'_>,
        start: &SetOff<'_>,
        motions: &mut Motions,
        times: &mut PhaseTimes,
    ) -> Result<f64, Halt> {
        let mesh = &case.model().mesh.clone();
        match self.linear.matrix_mut() {
            None => return Err(LinalgError::NotUpdated.into()),
            Some(Matrix::Double(matrix)) => form(matrix, case, &self.boundary, &*self.opponent, &self.current, None, times)?,
            Some(Matrix::Single(matrix)) => form(matrix, case, &self.boundary, &*self.opponent, &self.current, None, times)?,
        }
        self.opponent.refresh(&mut self.linear, &self.current, &self.boundary, &self.fixed)?;
        self.respond(mesh, start.sideways().0, &mut motions.sideways)?;
        if start.holds_force {
            self.respond(mesh, DOWN, &mut motions.down)?;
        }
        let work = |x: &[f64], f: &[f64]| x.iter().zip(f).map(|(x, f)| x * f).sum::<f64>();
        let (mut motion, by_sideways) = self.forces_along(mesh, &motions.sideways)?;
        let mut stiffness = work(&motion, &by_sideways);
        if start.holds_force {
            // The plate gives way as far as keeps its normal force.
            let (down, by_down) = self.forces_along(mesh, &motions.down)?;
            let share = work(&down, &by_sideways) / work(&down, &by_down);
            stiffness -= share * work(&down, &by_sideways);
            motion.iter_mut().zip(&down).for_each(|(x, down)| *x -= share * down);
        }
        if self.opponent.is_in_matrix() {
            self.opponent.expand(&self.current, mesh, &mut motion);
        }
        motions.of_both = motion;
        Ok(stiffness)
    }

    /// Solves for the response to a unit motion of the plate. The guess is
    /// what is in `motion`, at first a body that moves as one; what that leaves at the contact is
    /// the measure (see `unit_tolerance`).
    fn respond(&mut self, mesh: &Mesh, unit: [f64; 3], motion: &mut Vec<f64>) -> Result<(), Halt> {
        self.unit_rhs.fill(0.0);
        for &n in &self.boundary.plate {
            self.unit_rhs[3 * n as usize..3 * n as usize + 3].copy_from_slice(&unit);
        }
        let mut as_one = vec![0.0; self.unit_rhs.len()];
        let alone = self.linear.residual_norm(&self.unit_rhs, &as_one)?;
        as_one.chunks_exact_mut(3).take(self.boundary.own_nodes).for_each(|u| u.copy_from_slice(&unit));
        self.opponent.contract(&self.current, mesh, &mut as_one);
        let moving = self.linear.residual_norm(&self.unit_rhs, &as_one)?;
        if motion.is_empty() {
            *motion = as_one;
        }
        let scale = if alone > 0.0 { (moving / alone).min(1.0) } else { 1.0 };
        let solved = self.linear.solve(&self.unit_rhs, unit_share(UNIT_MOTION, scale), motion, true);
        solved.map_err(|error| StepFailure::Linear(error.to_string()))?;
        Ok(())
    }

    /// A response as the matrix takes it, and the forces that it makes there: where the conditions
    /// of contact stand in the matrix, in their frames.
    pub(super) fn forces_along(&mut self, mesh: &Mesh, response: &[f64]) -> Result<(Vec<f64>, Vec<f64>), Halt> {
        let mut motion = response.to_vec();
        if !self.opponent.is_in_matrix() {
            self.opponent.expand(&self.current, mesh, &mut motion);
        }
        let mut forces = vec![0.0; motion.len()];
        match self.linear.matrix_mut() {
            None => return Err(LinalgError::NotUpdated.into()),
            Some(Matrix::Double(matrix)) => matrix.multiply(&motion, &mut forces),
            Some(Matrix::Single(matrix)) => matrix.multiply(&motion, &mut forces),
        }
        Ok((motion, forces))
    }
}
