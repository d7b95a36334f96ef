//! How far a free equator is to widen in a step.

use super::Drive;
use crate::case::Equator;
use crate::compute::handle::CaseHandle;
use crate::simulation::SimulationError;
use crate::simulation::equator::FreeEquator;
use crate::simulation::path::Target;

impl Drive<'_> {
    /// How far the plate widens at the end of the next step, as far as that is known before.
    pub(super) fn set_out_widening(&mut self, target: &Target) -> Result<(), SimulationError> {
        if self.problem.case.0.sphere.equator == Equator::Clamped {
            return Ok(());
        }
        let equator = match self.state.equator {
            Some(equator) => equator,
            None => {
                self.handle().begin_step(0.0)?;
                self.newton.set_out(&self.mesh, &self.state.u, &self.state.u, true);
                let mut handle = CaseHandle { backend: &mut *self.backend, case: self.case };
                let stiffness = self.newton.widening_stiffness(&mut handle)?;
                FreeEquator::new(stiffness).ok_or(SimulationError::Widening)?
            }
        };
        let r = &self.state.record;
        self.state.equator = Some(equator);
        if r.contact_points == 0 {
            // The body moves with the plate as it is.
            self.state.stretch = self.state.pose.stretch;
            return Ok(());
        }
        let last = self.state.last_increment.filter(|_| target.extrapolate);
        let ratio = last.and_then(|last| {
            let pressed = || (last.h != 0.0).then(|| (target.h - r.h) / last.h);
            self.way_ratio(target, &last).or_else(pressed)
        });
        self.state.stretch = equator.expected(ratio);
        Ok(())
    }
}
