//! How far along a correction: to where the energy falls no further, or back until the contact
//! merit falls, and when the whole correction is taken although the merit grows.

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
/// active set knows of the points that come off. Half and twice of either: `benches/constants`.
const CREEPING: f64 = 0.03;
const DOWNHILL_MERIT: f64 = 4.0;
/// A correction from points that flow to points that do not goes too far: the energy falls along
/// its first part and rises along the rest, and the next correction leads back. The merit alone
/// does not see it and falls by a tenth an iteration. So where the whole correction leaves more
/// than `ENOUGH` of the merit and the slope of the energy at its end is below `-LEVEL` of that at
/// its start, up to so many lengths are tried at which the slope is expected to be zero, until it
/// is within `LEVEL` or the merit below `ENOUGH`. Found by `benches/newton/iterations.py`: soft
/// contacts take half the iterations, the reference case the same, and 0.1 to 0.5 for either number
/// or five lengths for three change the sum by 3 %.
const LEVEL: f64 = 0.1;
const ENOUGH: f64 = 0.3;
const LEVEL_LENGTHS: usize = 3;

/// The best trial of a line search so far.
struct Best {
    stick: bool,
    found: Option<(f64, Reading)>,
    /// Why the last trial that could not be evaluated could not.
    refused: Option<Fault>,
}

impl Best {
    fn merit(&self) -> f64 {
        self.found.as_ref().map_or(f64::INFINITY, |(_, reading)| self.merit_of(reading))
    }

    /// What a trial is judged by: under full stick without the tangential forces of points that
    /// come off in it (see [`Reading::released`]).
    fn merit_of(&self, trial: &Reading) -> f64 {
        if self.stick { (trial.merit * trial.merit - trial.released).max(0.0).sqrt() } else { trial.merit }
    }
}

impl Newton {
    /// Goes along the correction to where the energy falls no further or, where that does not take
    /// the merit below `reference`, backtracks until it falls below it; otherwise takes the best
    /// there was, or the whole correction where that would creep while the energy falls all the
    /// way. `slope` is the work of the free residual on the correction, `delta_h` its change of h.
    /// No length may give a trial that can be evaluated: the shortest one tells why. Returns the
    /// step length and the trial there, which is not kept yet.
    pub(super) fn line_search(
        &mut self,
        case: &mut CaseHandle<'_>,
        control: &Control,
        reference: f64,
        slope: f64,
        delta_h: f64,
    ) -> Result<(f64, Reading), Halt> {
        let stick = case.model().friction == Friction::Stick;
        // The slope of the potential energy along the correction, where there is one, over that at
        // its start.
        let of_plate = |force: f64| control.normal_force.map_or(0.0, |held| delta_h * (force - held));
        let at_start = slope + of_plate(self.current.plate_force);
        let left = |reading: &Reading| (reading.slope + of_plate(reading.plate_force)) / at_start;
        let mut best = Best { stick, found: None, refused: None };
        let mut whole = None;
        for s in STEP_LENGTHS {
            let tried = self.try_one(case, control, s, &mut best)?;
            if let Some(reading) = tried.filter(|_| s == 1.0) {
                let left_at_end = left(&reading);
                if reading.merit < DOWNHILL_MERIT * self.current.merit {
                    let leap = stick || reference <= self.current.merit && left_at_end < 1.0 && left_at_end > -0.25;
                    whole = leap.then_some((s, reading));
                }
                if reference.is_finite() && left_at_end < -LEVEL {
                    self.level(case, control, left, left_at_end, &mut best)?;
                }
            }
            if best.merit() <= (1.0 - 1e-4 * s) * reference {
                break;
            }
        }
        let Some(found) = best.found else {
            let fault = best.refused.unwrap_or(Fault::Residual { at: None });
            return Err(self.refused(case, control, fault, "however short the step of the line search"));
        };
        Ok(whole.filter(|_| found.0 <= CREEPING).unwrap_or(found))
    }

    /// Tries lengths at which the slope of the energy, `left` of what it is at the start, is
    /// expected to be zero: by the secant of the lengths about it, not nearer to either than a
    /// tenth of the way. `left_at_end` is that of the whole correction, which goes too far.
    fn level(
        &mut self,
        case: &mut CaseHandle<'_>,
        control: &Control,
        left: impl Fn(&Reading) -> f64,
        left_at_end: f64,
        best: &mut Best,
    ) -> Result<(), Halt> {
        let (mut before, mut after) = ((0.0, 1.0), (1.0, left_at_end));
        for _ in 0..LEVEL_LENGTHS {
            if best.merit() < ENOUGH * self.current.merit {
                break;
            }
            let share = (before.1 / (before.1 - after.1)).clamp(0.1, 0.9);
            let s = before.0 + share * (after.0 - before.0);
            let Some(reading) = self.try_one(case, control, s, best)? else { break };
            let slope = left(&reading);
            // Written so that a NaN ends the search.
            if !(slope.abs() >= LEVEL) {
                break;
            }
            *(if slope > 0.0 { &mut before } else { &mut after }) = (s, slope);
        }
        Ok(())
    }

    /// Tries one length; `None` where it cannot be evaluated.
    fn try_one(
        &mut self,
        case: &mut CaseHandle<'_>,
        control: &Control,
        length: f64,
        best: &mut Best,
    ) -> Result<Option<Reading>, Halt> {
        let mut times = std::mem::take(&mut self.times);
        let tried = self.iterate().try_length(case, control, length, &mut times);
        self.times = times;
        let reading = tried?;
        if let Err(fault) = reading.check() {
            best.refused = Some(fault);
            return Ok(None);
        }
        if best.found.is_none() || best.merit_of(&reading) < best.merit() {
            best.found = Some((length, reading));
            self.iterate().favour();
        }
        Ok(Some(reading))
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
