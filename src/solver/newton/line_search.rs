//! How far along a correction: backtracking on the contact merit, and when the whole correction is
//! taken although the merit grows.

use super::super::Control;
use super::super::outcome::{Halt, StepFailure};
use super::Newton;
use crate::compute::Fault;
use crate::compute::handle::CaseHandle;
use crate::compute::iterate::Reading;
use crate::contact::coulomb::Friction;

/// Step lengths of the line search, longest first.
const STEP_LENGTHS: [f64; 6] = [1.0, 0.5, 0.25, 0.1, 0.03, 0.01];
/// Where points are about to flow, the whole correction may raise the merit although the energy
/// falls along it (the tangent is elastic, the answer plastic). It is taken then, if the line
/// search found nothing longer than this and the merit does not grow by more than this factor: the
/// next tangent knows of the flow. Under full stick it is taken whatever the energy does: the next
/// active set knows of the points that come off.
const CREEPING: f64 = 0.03;
const DOWNHILL_MERIT: f64 = 4.0;

impl Newton {
    /// Backtracks along the correction until the merit falls below `reference`; otherwise takes the
    /// best there was, or the whole correction where that would creep while the energy falls all
    /// the way. `slope` is the work of the free residual on the correction, `delta_h` its change of
    /// h. No length may give a trial that can be evaluated: the shortest one tells why. Returns the
    /// step length and the trial there, which is not kept yet.
    pub(super) fn line_search(
        &mut self,
        case: &mut CaseHandle<'_>,
        control: &Control,
        reference: f64,
        slope: f64,
        delta_h: f64,
    ) -> Result<(f64, Reading), Halt> {
        let mut best: Option<(f64, Reading)> = None;
        let mut best_merit = f64::INFINITY;
        let mut refused = None;
        let stick = case.model().friction == Friction::Stick;
        // The slope of the potential energy along the correction, where there is one.
        let of_plate = |force: f64| control.normal_force.map_or(0.0, |held| delta_h * (force - held));
        let slope = slope + of_plate(self.current.plate_force);
        let mut whole = None;
        for s in STEP_LENGTHS {
            let mut times = std::mem::take(&mut self.times);
            let tried = self.iterate().try_length(case, control, s, &mut times);
            self.times = times;
            let reading = tried?;
            if let Err(fault) = reading.check() {
                refused = Some(fault);
                continue;
            }
            if s == 1.0 && reading.merit < DOWNHILL_MERIT * self.current.merit {
                let left = (reading.slope + of_plate(reading.plate_force)) / slope;
                let leap = stick || reference <= self.current.merit && left < 1.0 && left > -0.25;
                whole = leap.then_some((s, reading));
            }
            let merit = if stick { without_releases(&reading) } else { reading.merit };
            if best.is_none() || merit < best_merit {
                (best, best_merit) = (Some((s, reading)), merit);
                self.iterate().favour();
            }
            if best_merit <= (1.0 - 1e-4 * s) * reference {
                break;
            }
        }
        let Some(best) = best else {
            let fault = refused.unwrap_or(Fault::Residual { at: None });
            return Err(self.refused(case, control, fault, "however short the step of the line search"));
        };
        Ok(whole.filter(|_| best.0 <= CREEPING).unwrap_or(best))
    }

    /// A step that ends because what was tried last could not be evaluated.
    pub(super) fn refused(&mut self, case: &mut CaseHandle<'_>, control: &Control, fault: Fault, when: &'static str) -> Halt {
        let located = match fault {
            Fault::Residual { at: None } => self.iterate().locate(case, control),
            _ => Ok(None),
        };
        match located {
            Ok(located) => StepFailure::Invalid { fault: located.unwrap_or(fault), when }.into(),
            Err(halt) => halt,
        }
    }
}

/// Merit of a trial without the tangential forces of points that come off in it (see
/// [`Reading::released`]).
fn without_releases(trial: &Reading) -> f64 {
    (trial.merit * trial.merit - trial.released).max(0.0).sqrt()
}
