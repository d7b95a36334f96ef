//! A free equator: how far its plate widens.
//!
//! Where a whole sphere is pressed from both sides, its equator is a plane of symmetry: it stays
//! plane, and no shear acts in it. Its nodes move along its normal as one and outwards by a
//! polynomial (see [`crate::solver::pose`]) whose coefficients are such that the generalised force
//! of each term is zero. The body is elastic there, so one matrix, found once, says
//! what a coefficient changes of those forces. A step sets out with the coefficients that the last
//! two lead to, and is solved again where they miss by more than a share of the largest so far.

use serde::{Deserialize, Serialize};

use crate::compute::handle::CaseHandle;
use crate::solver::iterate::SetOut;
use crate::solver::newton::Newton;
use crate::solver::pose::MODES;
use crate::solver::{Control, SolverError, StepOutcome};

/// A step is taken with coefficients that are off by so much of the largest so far. The whole of
/// them takes 7 % of F_N away in an elastic contact at h = 0.1 R. Half and twice of it:
/// `benches/constants`.
const NEAR: f64 = 0.01;

/// A step is solved so many times more at most; the error of the coefficients falls by a factor of
/// ten or more in each. Half and twice of it: `benches/constants`.
const REPEATS: usize = 4;

/// The coefficients of a plate that is free.
pub type Stretch = [f64; MODES];

/// What is known of a free plate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FreeEquator {
    /// Coefficients for unit outward forces along the modes.
    compliance: [Stretch; MODES],
    /// Those at which the plate of the last step, and of the one before, had exerted nothing.
    freed: Stretch,
    freed_before: Stretch,
    /// Largest of any step.
    largest: f64,
    /// What it exerted after all at the last step and at the one before, and by how much it had
    /// widened.
    outward: [Stretch; 2],
    widened: [Stretch; 2],
}

impl FreeEquator {
    /// With the outward forces along the modes that unit coefficients make, a symmetric matrix;
    /// `None` if it has no inverse.
    pub fn new(stiffness: [Stretch; MODES]) -> Option<Self> {
        let [[a, b], [c, d]] = stiffness;
        let determinant = a * d - b * c;
        let compliance = [[d, 0.0 - b], [0.0 - c, a]].map(|row| row.map(|x| x / determinant));
        (determinant > 0.0 && compliance.iter().flatten().all(|x| x.is_finite())).then(|| Self { compliance, ..Self::default() })
    }

    /// The coefficients that a step is to set out with that is `ratio` times as long as the last
    /// one; `None` where that is not known.
    pub fn expected(&self, ratio: Option<f64>) -> Stretch {
        let ratio = ratio.unwrap_or(0.0);
        std::array::from_fn(|k| self.freed[k] + ratio * (self.freed[k] - self.freed_before[k]))
    }

    /// The coefficients at which a plate had exerted nothing that exerts these outward forces where
    /// it has widened by `stretch`.
    pub fn freed(&self, outward: &Stretch, stretch: &Stretch) -> Stretch {
        std::array::from_fn(|k| stretch[k] - self.compliance[k].iter().zip(outward).map(|(c, force)| c * force).sum::<f64>())
    }

    /// Whether a step may stand that was taken with `stretch` and not with what is `freed`.
    pub fn is_near(&self, freed: &Stretch, stretch: &Stretch) -> bool {
        let size = |x: &Stretch| x.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        size(&std::array::from_fn(|k| freed[k] - stretch[k])) <= NEAR * self.largest.max(size(freed))
    }

    /// A step has been accepted in which the plate has widened by `stretch` and exerts `outward`.
    pub fn settle(&mut self, outward: Stretch, stretch: Stretch) {
        (self.freed_before, self.freed) = (self.freed, self.freed(&outward, &stretch));
        self.largest = self.freed.iter().fold(self.largest, |most, x| most.max(x.abs()));
        self.outward = [self.outward[1], outward];
        self.widened = [self.widened[1], stretch];
    }

    /// The work that the plate has done outwards in the last step.
    pub fn work(&self) -> f64 {
        let [before, after] = &self.outward;
        let [from, to] = &self.widened;
        (0..MODES).map(|k| 0.5 * (before[k] + after[k]) * (to[k] - from[k])).sum()
    }

    /// All its numbers.
    pub fn numbers(&self) -> impl Iterator<Item = &f64> {
        let pairs = self.compliance.iter().chain(&self.outward).chain(&self.widened).flatten();
        pairs.chain(&self.freed).chain(&self.freed_before).chain([&self.largest])
    }
}

/// Solves a step; where the plate is free and something touches, again until it exerts next to
/// nothing as it widens. The pose of `control` is then that of the solution.
pub fn solve(
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_coefficients_are_those_at_which_nothing_is_exerted() {
        let stiffness = [[3.0, 1.0], [1.0, 0.5]];
        let mut equator = FreeEquator::new(stiffness).unwrap();
        let free = [0.02, -0.01];
        let outward = |stretch: Stretch| -> Stretch {
            stiffness.map(|row| row.iter().zip(stretch).zip(free).map(|((s, e), free)| s * (e - free)).sum())
        };
        let freed = equator.freed(&outward([0.0; 2]), &[0.0; 2]);
        assert!(freed.iter().zip(free).all(|(a, b)| (a - b).abs() < 1e-15), "{freed:?}");
        assert!(!equator.is_near(&freed, &[0.0; 2]) && equator.is_near(&freed, &[0.0199, -0.0099]));
        equator.settle(outward([0.0; 2]), [0.0; 2]);
        // As much again in a step as long, and nothing is known of the next segment's.
        assert_eq!(equator.expected(Some(1.0)), freed.map(|x| 2.0 * x));
        assert_eq!(equator.expected(None), freed);
        assert_eq!(equator.work(), 0.0);
        equator.settle(outward([0.01, 0.0]), [0.01, 0.0]);
        assert!((equator.work() - 0.005 * (outward([0.0; 2])[0] + outward([0.01, 0.0])[0])).abs() < 1e-17);
        assert!(FreeEquator::new([[1.0, 1.0], [1.0, 1.0]]).is_none());
    }
}
