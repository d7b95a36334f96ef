//! Who watches a run, and what is shown of a step.

use super::checkpoint::Snapshot;
use super::error::ObserverError;
use super::problem::Problem;
use super::record::{RecordedPoint, StepRecord};
use crate::case::Scaled;
use crate::compute::handle::at;
use crate::compute::iterate::{Ask, Plate, Reply};
use crate::compute::traffic::Traffic;
use crate::compute::{CaseFields, Compute, ComputeError};
use crate::contact::coulomb::Status;
use crate::mesh::Mesh;
use crate::solver::StepReport;
use crate::solver::newton::Newton;
use crate::solver::phases::PhaseTimes;

/// Watches a run.
pub trait Observer {
    /// A step was accepted. The undeformed state comes first, as step 0.
    fn step(&mut self, view: &mut StepView<'_>) -> Result<(), ObserverError>;
    /// A segment of the path has ended, or the run ends within it; `view` shows its last accepted
    /// step.
    fn segment_end(&mut self, view: &mut StepView<'_>) -> Result<(), ObserverError>;
    /// Something that the user should know and the summary should keep.
    fn note(&mut self, text: &str);
    /// The contact left the finely meshed zone: the run starts over from the undeformed state on
    /// the mesh of `problem`, which has so many unknowns.
    fn starts_over(&mut self, problem: &Problem, unknowns: usize) -> Result<(), ObserverError> {
        let _ = (problem, unknowns);
        Ok(())
    }
    /// Asks the run to end after the present step.
    fn stop_requested(&self) -> bool {
        false
    }
    /// Whether a checkpoint is wanted at the end of the path.
    fn keeps_end(&self) -> bool {
        false
    }
    /// Offers a checkpoint, after every accepted step; `take` copies the state that a run could go
    /// on from. `last`: no other is offered, because the run is interrupted or has followed its
    /// path.
    fn checkpoint(&mut self, last: bool, take: &mut dyn FnMut() -> Result<Snapshot, ComputeError>) {
        let _ = (last, take);
    }
}

/// An accepted step, for output.
pub struct StepView<'a> {
    /// Its row in the history.
    pub record: Scaled<StepRecord>,
    /// How Newton went.
    pub report: &'a StepReport,
    /// Time of attempts since then that led to no step.
    pub unfinished: PhaseTimes,
    /// The mesh.
    pub mesh: &'a Mesh,
    pub(super) newton: &'a Newton,
    pub(super) displacement: Displacement<'a>,
    /// Every point of the sphere that can touch.
    pub points: &'a [RecordedPoint],
    /// Every point of another body that deforms that can touch, in its own coordinates.
    pub opponent_points: &'a [RecordedPoint],
    pub(super) backend: &'a mut dyn Compute,
    pub(super) case: usize,
}

/// The displacements of the last accepted step and of the one before, here or on a device.
pub(super) struct Displacement<'a> {
    pub u: &'a mut Vec<f64>,
    pub u_before: &'a mut Vec<f64>,
    /// They are on the device; here they are right at contact nodes alone.
    pub is_away: &'a mut bool,
}

impl Displacement<'_> {
    /// Brings them here.
    pub fn fetch(&mut self, backend: &mut dyn Compute, case: usize) -> Result<(), ComputeError> {
        if !*self.is_away {
            return Ok(());
        }
        let asked = at(backend, case).iterate(false, Plate::default(), Ask::Displacements)?;
        if let Reply::Displacements([u, u_before]) = asked {
            (*self.u, *self.u_before) = (u, u_before);
            *self.is_away = false;
        }
        Ok(())
    }
}

impl StepView<'_> {
    /// Displacement, three a node.
    ///
    /// # Errors
    /// The device's fault.
    pub fn displacement(&mut self) -> Result<&[f64], ComputeError> {
        self.displacement.fetch(self.backend, self.case)?;
        Ok(self.displacement.u)
    }

    /// Internal forces, three a node, of a step whose vectors are on the host; empty before the
    /// first.
    pub fn internal_force(&self) -> &[f64] {
        &self.newton.accepted().force
    }

    /// What the bodies need at the points of contact (see [`Newton::needed_forces`]).
    pub fn needed_forces(&self) -> Vec<([f64; 3], Status)> {
        self.newton.needed_forces(self.mesh)
    }

    /// What has passed to the device and back so far; `None` without a device.
    pub fn traffic(&self) -> Option<Traffic> {
        self.backend.about().traffic
    }

    /// Stresses and strains of the step.
    pub fn fields(&mut self) -> Result<CaseFields, ComputeError> {
        at(&mut *self.backend, self.case).fields()
    }
}
