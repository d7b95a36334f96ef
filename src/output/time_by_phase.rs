//! What a run spent its time on, for `summary.json` and as a table.

use std::fmt::Write;

use serde::{Deserialize, Serialize};

use crate::solver::phases::{Phase, PhaseTimes};

/// Time of a phase.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct PhaseTime {
    /// Seconds on the wall.
    pub seconds: f64,
    /// Share of the whole run, 0 to 1.
    pub share: f64,
}

/// Seconds on the wall that a run spends outside its steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct OutsideSteps {
    /// Before the first step.
    pub setup: f64,
    /// Writing results.
    pub output: f64,
    /// On the coarse run before it, by which the error is estimated.
    pub error_estimate: f64,
}

/// Time on the wall by phase; together they are the whole run. Cases of a study that share a device
/// wait for each other, and that counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct TimeByPhase {
    /// Reading and meshing the case, planning the solver, starting the device.
    pub setup: PhaseTime,
    /// Element tangents, gathered into the matrix.
    pub tangent: PhaseTime,
    /// Element forces, gathered into nodes.
    pub force: PhaseTime,
    /// Contact conditions, residual and merit, contact rows of the matrix.
    pub contact: PhaseTime,
    /// Multigrid levels of each matrix (factors, with the direct solver).
    pub linear_update: PhaseTime,
    /// Krylov iterations (substitutions, with the direct solver).
    pub linear_solve: PhaseTime,
    /// Beginning and committing steps.
    pub commit: PhaseTime,
    /// History, fields, contact tables, plots, progress.
    pub output: PhaseTime,
    /// The coarse run before it, by which the error is estimated.
    pub error_estimate: PhaseTime,
    /// All else.
    pub other: PhaseTime,
}

impl TimeByPhase {
    /// From the seconds of the steps' phases, of what is outside them, and of the whole run.
    pub fn new(steps: &PhaseTimes, outside: &OutsideSteps, whole: f64) -> Self {
        let &OutsideSteps { setup, output, error_estimate } = outside;
        let part = |seconds: f64| PhaseTime { seconds, share: if whole > 0.0 { seconds / whole } else { 0.0 } };
        let of = |phase| part(steps.seconds(phase));
        Self {
            setup: part(setup),
            tangent: of(Phase::Tangent),
            force: of(Phase::Force),
            contact: of(Phase::Contact),
            linear_update: of(Phase::LinearUpdate),
            linear_solve: of(Phase::LinearSolve),
            commit: of(Phase::Commit),
            output: part(output),
            error_estimate: part(error_estimate),
            other: part((whole - setup - steps.total() - output - error_estimate).max(0.0)),
        }
    }

    /// The phases by name, in the order in which a run goes through them.
    pub fn rows(&self) -> [(&'static str, PhaseTime); 10] {
        [
            ("set-up", self.setup),
            ("element tangents", self.tangent),
            ("element forces", self.force),
            ("contact", self.contact),
            ("linear update", self.linear_update),
            ("linear solve", self.linear_solve),
            ("commit", self.commit),
            ("output", self.output),
            ("error estimate", self.error_estimate),
            ("other", self.other),
        ]
    }

    /// A table for people: seconds and per cent of each phase, and of all.
    pub fn table(&self, whole: f64, processor: Option<f64>) -> String {
        let mut text = format!("{:<18}{:>9}{:>8}\n", "time by phase", "s", "%");
        for (name, PhaseTime { seconds, share }) in self.rows() {
            // Writing to a String cannot fail.
            let _ = writeln!(text, "{name:<18}{seconds:>9.2}{:>8.1}", 100.0 * share);
        }
        let processor = processor.map(|seconds| format!("   {seconds:.2} s of processor time")).unwrap_or_default();
        let _ = writeln!(text, "{:<18}{whole:>9.2}{:>8.1}{processor}", "all", 100.0);
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn phases_add_up_to_the_whole() {
        let mut steps = PhaseTimes::default();
        Phase::ALL.iter().zip(1..).for_each(|(&phase, seconds)| steps.add(phase, f64::from(seconds)));
        let times = TimeByPhase::new(&steps, &OutsideSteps { setup: 4.0, output: 3.0, error_estimate: 2.0 }, 40.0);
        let seconds = times.rows().map(|(_, time)| time.seconds);
        assert_eq!(seconds, [4.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 3.0, 2.0, 10.0]);
        assert!((times.rows().iter().map(|(_, time)| time.share).sum::<f64>() - 1.0).abs() < 1e-15);
        let table = times.table(40.0, Some(75.25));
        assert!(table.contains("\nlinear solve           5.00    12.5\n"), "{table}");
        assert!(table.ends_with("all                   40.00   100.0   75.25 s of processor time\n"), "{table}");
        assert!(times.table(40.0, None).ends_with("all                   40.00   100.0\n"));
    }

    #[test]
    fn a_run_that_took_no_time_has_no_shares() {
        assert_eq!(TimeByPhase::new(&PhaseTimes::default(), &OutsideSteps::default(), 0.0), TimeByPhase::default());
    }
}
