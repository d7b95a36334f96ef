//! How a step went: what it took, or why it failed.

use super::SolverError;
use super::phases::PhaseTimes;
use crate::compute::traffic::Traffic;
use crate::compute::{ComputeError, Fault};
use crate::linalg::LinalgError;

/// How an attempt at a step went.
#[derive(Clone, Debug, PartialEq)]
pub enum StepOutcome {
    /// There is equilibrium.
    Converged(StepReport),
    /// There is none that was found; a smaller step may have one.
    Failed(StepFailure),
}

/// A converged step.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StepReport {
    /// Its Newton iterations.
    pub iterations: Vec<Iteration>,
    /// Final merit over the force scale.
    pub merit: f64,
    /// Times the linear solver fell back to the direct one.
    pub fallbacks: usize,
    /// Newton iterations on the host in f64 after a device's in f32; `None` where no device works
    /// so.
    pub confirming: Option<usize>,
    /// Iterations of the hardest of its solutions, where it was solved again.
    pub hardest: Option<usize>,
    /// Accepted above the tolerance, at a kink of the merit.
    pub relaxed: bool,
    /// Under full stick: points that stuck when the step began, came off in it and came down again.
    pub landed_again: usize,
    /// Time by phase, that of failed attempts since the last converged step included.
    pub times: PhaseTimes,
    /// What passed to the device and back, likewise.
    pub traffic: Traffic,
}

impl StepReport {
    /// Krylov iterations of the step.
    pub fn krylov(&self) -> usize {
        self.iterations.iter().map(|i| i.krylov).sum()
    }

    /// How hard the step was: its iterations; if some were in f32 and some in f64, or in several
    /// solutions, the largest of the numbers.
    pub fn effort(&self) -> usize {
        let all = self.iterations.len();
        self.hardest.unwrap_or_else(|| self.confirming.map_or(all, |confirming| confirming.max(all - confirming)))
    }

    /// This report of iterations in f64, together with that of those in f32 before them.
    pub fn after(mut self, made: Self) -> Self {
        self.confirming = Some(self.iterations.len());
        self.with(made)
    }

    /// This report of a step that was solved again, together with that of the solution before.
    pub fn again_after(mut self, made: Self) -> Self {
        self.hardest = Some(self.effort().max(made.effort()));
        self.with(made)
    }

    fn with(mut self, made: Self) -> Self {
        self.iterations.splice(0..0, made.iterations);
        self.fallbacks += made.fallbacks;
        self.landed_again += made.landed_again;
        self.times += made.times;
        self
    }
}

/// One Newton iteration, for the report.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Iteration {
    /// Merit before the iteration over the force scale.
    pub merit: f64,
    /// Step length that the line search took.
    pub step_length: f64,
    /// Krylov iterations (0 for the direct solver).
    pub krylov: usize,
    /// Contact points whose status changed.
    pub changed: usize,
}

/// Why a step failed, with where it stood.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StepFailure {
    /// The iterations are used up.
    #[error("no convergence in {iterations} iterations: merit {merit:.2e} of the normal force, worst at {worst}")]
    Iterations {
        /// Iterations made.
        iterations: usize,
        /// Last merit over the force scale.
        merit: f64,
        /// Where the residual is largest.
        worst: Worst,
    },
    /// A trial or a tangent could not be evaluated.
    #[error("{fault} {when}")]
    Invalid {
        /// Why not.
        fault: Fault,
        /// Where in the step: "however short the step of the line search", say.
        when: &'static str,
    },
    /// The linear system could not be solved.
    #[error("the linear solver failed: {0}")]
    Linear(String),
}

impl StepFailure {
    /// A fault of a tangent.
    pub fn of_tangent(fault: Fault) -> Self {
        Self::Invalid { fault, when: "in the tangent" }
    }

    /// What may help where steps were bisected in vain.
    pub fn remedy(&self) -> &'static str {
        match self {
            Self::Invalid { fault, .. } if fault.is_of_numbers() => {
                "Numbers that are not finite come from extreme values in the case, or from a device that computes wrongly: --device cpu tells which"
            }
            _ => {
                "A finer mesh ([mesh] elements_per_contact_radius) or more steps ([solver] press_steps, \
                 shear_steps) may help"
            }
        }
    }

    /// Iterations that were made, at least one.
    pub fn iterations(&self) -> usize {
        match self {
            Self::Iterations { iterations, .. } => *iterations,
            _ => 1,
        }
    }
}

/// The degree of freedom with the largest residual.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Worst {
    /// Node index.
    pub node: usize,
    /// Direction, 0 to 2.
    pub direction: usize,
    /// Its reference position.
    pub position: [f64; 3],
    /// Residual over the force scale.
    pub residual: f64,
}

impl std::fmt::Display for Worst {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [x, y, z] = self.position;
        let axis = ["x", "y", "z"].get(self.direction).copied().unwrap_or("?");
        write!(f, "node {} ({x:.4}, {y:.4}, {z:.4}) in {axis} ({:.1e})", self.node, self.residual)
    }
}

/// What ends the iteration of a step before it has converged.
#[derive(Debug)]
pub enum Halt {
    /// The step, which may do with less.
    Step(StepFailure),
    /// What no smaller step cures.
    Solver(SolverError),
}

impl From<StepFailure> for Halt {
    fn from(failure: StepFailure) -> Self {
        Self::Step(failure)
    }
}

impl From<SolverError> for Halt {
    fn from(error: SolverError) -> Self {
        Self::Solver(error)
    }
}

impl From<ComputeError> for Halt {
    fn from(error: ComputeError) -> Self {
        Self::Solver(error.into())
    }
}

/// A matrix that is singular or holds what is no number is one of this step; what else can be wrong
/// with a linear system no smaller step cures.
impl From<LinalgError> for Halt {
    fn from(error: LinalgError) -> Self {
        match error {
            LinalgError::NotFinite { .. } | LinalgError::Singular { .. } | LinalgError::Stalled { .. } => {
                Self::Step(StepFailure::Linear(error.to_string()))
            }
            error => Self::Solver(error.into()),
        }
    }
}
