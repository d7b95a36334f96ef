//! A run that is left between two steps.

use super::Drive;
use crate::compute::Compute;
use crate::simulation::checkpoint::{Committed, Place};
use crate::simulation::problem::Problem;
use crate::simulation::record::ContactPoint;
use crate::solver::StepReport;
use crate::solver::newton::Newton;

/// A drive between two steps, without the problem and the backend that it borrows.
pub struct Paused {
    newton: Newton,
    state: Committed,
    place: Place,
    last_report: StepReport,
}

impl Drive<'_> {
    /// Gives problem and backend back after an interruption or at the end of the path.
    pub fn pause(self) -> Paused {
        let Self { newton, state, place, last_report, .. } = self;
        Paused { newton, state, place, last_report }
    }
}

impl Paused {
    /// Takes the path up again, with the problem and the backend that [`Drive::pause`] gave back.
    pub fn go_on<'a>(self, problem: &'a Problem, backend: &'a mut dyn Compute, case: usize) -> Drive<'a> {
        let Self { newton, state, place, last_report } = self;
        Drive { state, place, last_report, ..Drive::new(problem, backend, case, newton) }
    }

    /// Displacement of the last accepted step, three numbers a node, scaled.
    pub fn displacement(&self) -> &[f64] {
        &self.state.u
    }

    /// Every point of the sphere's meshed half that can touch, as the last accepted step left it,
    /// scaled.
    pub fn points(&self) -> &[ContactPoint] {
        &self.state.points[..self.newton.own_contacts().min(self.state.points.len())]
    }
}
