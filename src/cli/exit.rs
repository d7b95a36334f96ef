//! How a subcommand ends that had good input, and the exit code for it.

use super::error::NOT_CONVERGED;

/// How a subcommand that had good input ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exit {
    /// All was done: exit code 0.
    Done,
    /// A step did not converge or the contact outgrew the mesh, what was computed is kept: exit
    /// code 3.
    NotConverged,
    /// A check of a verification failed: exit code 3.
    ChecksFailed,
    /// A law is further from simulations than its goal allows: exit code 1.
    GoalMissed,
    /// Cases of a study failed, all rows are kept: exit code 3.
    CasesFailed,
    /// Interrupted, what was computed is kept: exit code 75 (EX_TEMPFAIL of sysexits.h).
    Interrupted,
}

impl Exit {
    /// The exit code of the program.
    pub fn exit_code(self) -> u8 {
        match self {
            Exit::Done => 0,
            Exit::GoalMissed => 1,
            Exit::NotConverged | Exit::ChecksFailed | Exit::CasesFailed => NOT_CONVERGED,
            Exit::Interrupted => 75,
        }
    }
}
