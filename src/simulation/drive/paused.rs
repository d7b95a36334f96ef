//! A run that is left between two steps.

use super::Drive;
use super::safe::Safe;
use crate::compute::{Compute, ComputeError};
use crate::simulation::checkpoint::{Committed, PathPosition};
use crate::simulation::problem::Problem;
use crate::simulation::record::RecordedPoint;
use crate::solver::StepReport;
use crate::solver::newton::Newton;

/// A drive between two steps, without the problem and the backend that it borrows.
pub struct Paused {
    newton: Newton,
    state: Committed,
    safe: Safe,
    place: PathPosition,
    last_report: StepReport,
}

impl Drive<'_> {
    /// Gives problem and backend back after an interruption or at the end of the path.
    ///
    /// # Errors
    /// What the device says that has the displacements.
    pub fn pause(mut self) -> Result<Paused, ComputeError> {
        self.fetch()?;
        let Self { newton, state, safe, place, last_report, .. } = self;
        Ok(Paused { newton, state, safe, place, last_report })
    }
}

impl Paused {
    /// Takes the path up again, with the problem and the backend that [`Drive::pause`] gave back.
    pub fn go_on<'a>(self, problem: &'a Problem, backend: &'a mut dyn Compute, case: usize) -> Drive<'a> {
        let Self { newton, state, safe, place, last_report } = self;
        Drive { state, safe, place, last_report, ..Drive::new(problem, backend, case, newton) }
    }

    /// What is told before the first step of a run on this backend, if anything.
    pub fn first_note(&self, backend: &dyn Compute) -> Option<&'static str> {
        let is_on_device = backend.about().traffic.is_some();
        if self.place.begun || !is_on_device { None } else { self.newton.stays_on_host() }
    }

    /// Displacement of the last accepted step, three numbers a node, scaled.
    pub fn displacement(&self) -> &[f64] {
        &self.state.u
    }

    /// Every point of the sphere's meshed half that can touch, as the last accepted step left it,
    /// scaled.
    pub fn points(&self) -> &[RecordedPoint] {
        &self.state.points[..self.newton.own_contacts().min(self.state.points.len())]
    }
}
