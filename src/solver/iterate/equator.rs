//! The forces that the widening of a free equator makes in the body.

use super::host::HostIterate;
use super::linearise::form;
use crate::compute::handle::CaseHandle;
use crate::linalg::LinalgError;
use crate::solver::Control;
use crate::solver::outcome::{Halt, StepFailure};
use crate::solver::phases::PhaseTimes;
use crate::solver::pose::{MODES, Pose, modes};
use crate::solver::system::fixed_unknowns;
use crate::solver::systems::Matrix;

/// Relative residual of the responses. Their forces only say how to go on from a plate that exerts
/// some. Half and twice of it: `benches/constants`.
const TOLERANCE: f64 = 1e-4;

impl HostIterate {
    /// The outward forces along the modes of the plate that unit coefficients make in the
    /// undeformed body, of the meshed part: row by row, a row a force.
    ///
    /// # Errors
    /// A system without an answer; what the backend says.
    pub fn widening_stiffness(
        &mut self,
        case: &mut CaseHandle<'_>,
        times: &mut PhaseTimes,
    ) -> Result<[[f64; MODES]; MODES], Halt> {
        let mesh = &case.model().mesh.clone();
        self.furnish(mesh)?;
        self.current.u.fill(0.0);
        self.current.h = 0.0;
        let control = Control { h: 0.0, pose: Pose::default(), normal_force: None };
        let outcome = self.current.evaluate(case, &self.boundary, &*self.opponent, &control, times)?;
        outcome.check().map_err(|fault| StepFailure::Invalid { fault, when: "in the undeformed body" })?;
        fixed_unknowns(mesh, &self.boundary, &self.current.rows, &mut self.fixed);
        match self.linear.matrix_mut() {
            None => return Err(LinalgError::NotUpdated.into()),
            Some(Matrix::Double(matrix)) => form(matrix, case, &self.boundary, &*self.opponent, &self.current, None, times)?,
            Some(Matrix::Single(matrix)) => form(matrix, case, &self.boundary, &*self.opponent, &self.current, None, times)?,
        }
        self.opponent.refresh(&mut self.linear, &self.current, &self.boundary, &self.fixed)?;
        let mut responses = [const { Vec::new() }; MODES];
        for (k, response) in responses.iter_mut().enumerate() {
            self.unit_rhs.fill(0.0);
            for (&n, from_centre) in self.boundary.plate.iter().zip(&self.boundary.from_centre) {
                let share = modes(from_centre)[k];
                self.unit_rhs[3 * n as usize] = share * from_centre[0];
                self.unit_rhs[3 * n as usize + 1] = share * from_centre[1];
            }
            response.resize(self.unit_rhs.len(), 0.0);
            let solved = self.linear.solve(&self.unit_rhs, TOLERANCE, response, true);
            solved.map_err(|error| StepFailure::Linear(error.to_string()))?;
        }
        let mut stiffness = [[0.0; MODES]; MODES];
        for (k, response) in responses.iter().enumerate() {
            let (_, forces) = self.forces_along(mesh, response)?;
            let outward = self.outward(&Pose::default(), &forces);
            (0..MODES).for_each(|row| stiffness[row][k] = outward[row]);
        }
        Ok(stiffness)
    }

    /// The outward forces along the modes of what acts on the nodes of a plate that stands in this
    /// pose.
    pub(super) fn outward(&self, pose: &Pose, forces: &[f64]) -> [f64; MODES] {
        let mut sum = [0.0; MODES];
        for (&n, from_centre) in self.boundary.plate.iter().zip(&self.boundary.from_centre) {
            let force = std::array::from_fn(|c| forces[3 * n as usize + c]);
            sum.iter_mut().zip(pose.outward(from_centre, &force)).for_each(|(sum, part)| *sum += part);
        }
        sum
    }

    /// The same of the accepted trial.
    pub fn accepted_outward(&self, pose: &Pose) -> [f64; MODES] {
        self.outward(pose, &self.current.force)
    }
}
