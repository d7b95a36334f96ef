//! The steps of a sphere with a free equator.

use super::Drive;
use crate::case::Equator;
use crate::compute::handle::CaseHandle;
use crate::simulation::SimulationError;
use crate::simulation::equator::FreeEquator;
use crate::simulation::path::Target;
use crate::solver::iterate::SetOut;
use crate::solver::newton::Newton;
use crate::solver::{Control, SolverError, StepOutcome};

/// A step is solved so many times more at most; the error of the coefficients falls by a factor of
/// ten or more in each.
const REPEATS: usize = 4;

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

/// Solves a step; where the plate is free and something touches, again until it exerts next to
/// nothing as it widens. The pose of `control` is then that of the solution.
pub(super) fn solve(
    newton: &mut Newton,
    handle: &mut CaseHandle<'_>,
    start: &SetOut<'_>,
    control: &mut Control,
    equator: Option<&FreeEquator>,
) -> Result<StepOutcome, SolverError> {
    let mut outcome = newton.solve(handle, start, control)?;
    let Some(equator) = equator else { return Ok(outcome) };
    for repeat in 0..=REPEATS {
        let StepOutcome::Converged(mut made) = outcome else { break };
        let stretch = control.pose.stretch;
        let freed = equator.freed(&newton.outward(&control.pose), &stretch);
        let is_near = newton.accepted().force_scale == 0.0 || equator.is_near(&freed, &stretch);
        if is_near || repeat == REPEATS {
            made.relaxed |= !is_near;
            return Ok(StepOutcome::Converged(made));
        }
        let (guess, h, came_off) = (newton.accepted().u.clone(), newton.accepted_h(), newton.came_off().to_vec());
        (control.pose.stretch, control.h) = (freed, h);
        log::debug!("  the plate resists its widening: solved again with {freed:?} in place of {stretch:?}");
        let again =
            newton.solve(handle, &SetOut { guess: Some(&guess), extrapolation: None, came_off: &came_off, ..*start }, control)?;
        outcome = match again {
            StepOutcome::Converged(report) => StepOutcome::Converged(report.again_after(made)),
            StepOutcome::Failed(failure) => {
                newton.give_up(made);
                StepOutcome::Failed(failure)
            }
        };
    }
    Ok(outcome)
}
