//! How far along a correction: backtracking on the contact merit, and when the whole correction is
//! taken although the merit grows.

use super::super::Control;
use super::super::outcome::{Halt, StepFailure};
use super::super::system::Trial;
use super::Newton;
use crate::compute::Outcome;
use crate::compute::handle::Evaluate;
use crate::contact::coulomb::{Friction, Status};

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
    /// Backtracks along `self.delta` until the merit falls below `reference`; otherwise takes the
    /// best there was, or the whole correction where that would creep while the energy falls all
    /// the way. Every length may invert an element: the shortest one tells which.
    pub(super) fn line_search(
        &mut self,
        case: &mut dyn Evaluate,
        control: &Control,
        reference: f64,
        delta_h: f64,
    ) -> Result<(f64, usize), Halt> {
        let mut best: Option<f64> = None;
        let mut best_merit = f64::INFINITY;
        let mut inverted = (0, 0);
        let slope = self.slope(&self.current, control, delta_h);
        let stick = case.model().friction == Friction::Stick;
        let mut leap = false;
        for s in STEP_LENGTHS {
            for ((u, u0), d) in self.candidate.u.iter_mut().zip(&self.current.u).zip(&self.delta) {
                *u = u0 + s * d;
            }
            self.candidate.h = self.current.h + s * delta_h;
            if s == 1.0 {
                // Rounding must not leave the plate a hair from where it belongs.
                self.boundary.place_plate(&mut self.candidate.u, self.candidate.h, control.delta_t);
            }
            let outcome = self.candidate.evaluate(case, &self.boundary, control, &mut self.times)?;
            if let Outcome::Inverted { element, point } = outcome {
                inverted = (element, point);
                continue;
            }
            if s == 1.0 && self.candidate.merit < DOWNHILL_MERIT * self.current.merit {
                let left = self.slope(&self.candidate, control, delta_h) / slope;
                leap = stick || reference <= self.current.merit && left < 1.0 && left > -0.25;
            }
            let merit = if stick { self.merit_without_releases() } else { self.candidate.merit };
            if best.is_none() || merit < best_merit {
                (best, best_merit) = (Some(s), merit);
                std::mem::swap(&mut self.candidate, &mut self.best);
            }
            if best_merit <= (1.0 - 1e-4 * s) * reference {
                break;
            }
        }
        let Some(mut s) = best else {
            let (element, point) = inverted;
            return Err(StepFailure::Inverted { element, point }.into());
        };
        if s <= CREEPING && leap {
            s = 1.0;
            for ((u, u0), d) in self.best.u.iter_mut().zip(&self.current.u).zip(&self.delta) {
                *u = u0 + d;
            }
            self.best.h = self.current.h + delta_h;
            self.boundary.place_plate(&mut self.best.u, self.best.h, control.delta_t);
            self.best.evaluate(case, &self.boundary, control, &mut self.times)?;
        }
        let changed = self.best.rows.iter().zip(&self.current.rows).filter(|(a, b)| a.status != b.status).count();
        std::mem::swap(&mut self.current, &mut self.best);
        Ok((s, changed))
    }

    /// Merit of the candidate without the tangential forces of points that come off in it. Under
    /// full stick a point that comes off lets go of whatever it held: the merit jumps by it,
    /// however short the step, and a line search that counts the jump creeps up to it and stays
    /// there. No point does so twice in a step (see `land_again`).
    fn merit_without_releases(&self) -> f64 {
        let released: f64 = (self.candidate.rows.iter().zip(&self.current.rows).zip(&self.boundary.frictionless))
            .filter(|((after, before), frictionless)| {
                before.status == Status::Stick && after.status == Status::Open && !**frictionless
            })
            .map(|((after, _), _)| {
                let across = if after.fixed[1] { 0.0 } else { after.residual[1] };
                after.residual[0] * after.residual[0] + across * across
            })
            .sum();
        (self.candidate.merit * self.candidate.merit - released).max(0.0).sqrt()
    }

    /// Work of the residual forces of a trial on the correction: the slope of the potential energy
    /// along it, where there is one.
    fn slope(&self, trial: &Trial, control: &Control, delta_h: f64) -> f64 {
        let held = control.normal_force.map_or(0.0, |force| delta_h * (trial.plate_force - force));
        let free = trial.residual.iter().zip(&self.correction).zip(&self.fixed).filter(|(_, fixed)| !**fixed);
        held + free.map(|((r, d), _)| r * d).sum::<f64>()
    }
}
