//! Where the time of a step goes.

use std::ops::AddAssign;
use std::time::Instant;

use serde::{Deserialize, Serialize};

/// What a step spends its time on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Element tangents, gathered into block rows.
    Tangent,
    /// Element forces, gathered into nodes.
    Force,
    /// Contact conditions, residual, merit, contact rows of the matrix, right-hand side.
    Contact,
    /// What the linear solver makes of a matrix: multigrid levels, or factors.
    LinearUpdate,
    /// Linear solves: FGMRES with its V-cycles, or substitutions.
    LinearSolve,
    /// Beginning a step and committing its state.
    Commit,
}

impl Phase {
    /// All of them, in the order of an iteration.
    pub const ALL: [Phase; 6] =
        [Phase::Tangent, Phase::Force, Phase::Contact, Phase::LinearUpdate, Phase::LinearSolve, Phase::Commit];
}

/// Seconds on the wall of each phase. A case that shares a device with others waits for them, and
/// that counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PhaseTimes([f64; Phase::ALL.len()]);

impl PhaseTimes {
    /// Adds to a phase.
    pub fn add(&mut self, phase: Phase, seconds: f64) {
        self.0[phase as usize] += seconds;
    }

    /// Seconds of a phase.
    pub fn seconds(&self, phase: Phase) -> f64 {
        self.0[phase as usize]
    }

    /// Seconds of all phases together.
    pub fn total(&self) -> f64 {
        self.0.iter().sum()
    }
}

impl AddAssign for PhaseTimes {
    fn add_assign(&mut self, other: Self) {
        self.0.iter_mut().zip(other.0).for_each(|(sum, seconds)| *sum += seconds);
    }
}

/// A watch that starts anew at the end of every lap.
#[derive(Debug)]
pub struct Lap(Instant);

impl Lap {
    /// Starts it.
    pub fn start() -> Self {
        Self(Instant::now())
    }

    /// Ends the lap, which was spent on `phase`.
    pub fn end(&mut self, times: &mut PhaseTimes, phase: Phase) {
        let now = Instant::now();
        times.add(phase, now.duration_since(self.0).as_secs_f64());
        self.0 = now;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn laps_follow_each_other_without_a_gap() {
        let begun = Instant::now();
        let (mut times, mut lap) = (PhaseTimes::default(), Lap::start());
        for phase in Phase::ALL {
            std::thread::sleep(std::time::Duration::from_millis(2));
            lap.end(&mut times, phase);
        }
        assert!(Phase::ALL.iter().all(|&phase| times.seconds(phase) >= 2e-3), "{times:?}");
        assert!(times.total() <= begun.elapsed().as_secs_f64());
        let once = times;
        times += once;
        assert_eq!(times.total(), 2.0 * once.total());
    }
}
