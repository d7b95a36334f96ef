//! What a run has written and measured so far: the part of its results that a checkpoint keeps.

use serde::{Deserialize, Serialize};

use super::plots::Tables;
use super::{OutsideSteps, StepRecord};
use crate::simulation::scout::Scout;
use crate::simulation::zone::Zone;
use crate::solver::phases::PhaseTimes;

/// The results so far, in the user's units.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Ledger {
    /// The rows of the history.
    pub rows: Vec<StepRecord>,
    /// Steps whose fields or contact table are written, increasing.
    pub saved: Vec<usize>,
    /// Contact at the ends of segments, for the plots.
    pub tables: Tables,
    /// Linear systems that multigrid left to the direct solver.
    pub fallbacks: usize,
    /// Time of the steps by phase.
    pub times: PhaseTimes,
    /// Time beside the steps.
    pub outside: OutsideSteps,
    /// Notes for the summary.
    pub messages: Vec<String>,
    /// The finely meshed zone, as far as it is known.
    pub zone: Option<Zone>,
    /// How often the run started over on a larger zone.
    pub remeshed: usize,
    /// What the coarse run before it has found.
    pub scout: Option<Scout>,
    /// Seconds on the wall that earlier parts of a resumed run took.
    pub wall_before: f64,
    /// Their processor time, `None` where the system does not tell.
    pub cpu_before: Option<f64>,
}
