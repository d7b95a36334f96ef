//! What a run has written and measured so far: the part of its results that a checkpoint keeps.

use serde::{Deserialize, Serialize};

use super::tables::Tables;
use super::{OutsideSteps, StepRecord};
use crate::compute::traffic::Account;
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
    /// Steps whose contact table alone is written, for the plots, increasing.
    pub panels: Vec<usize>,
    /// Contact at the ends of segments and at those steps.
    pub tables: Tables,
    /// Linear systems that multigrid left to the direct solver.
    pub fallbacks: usize,
    /// Newton iterations on the host in f64 after a device's in f32, where a device works so.
    pub confirming: Option<usize>,
    /// Time of the steps by phase.
    pub times: PhaseTimes,
    /// Time beside the steps.
    pub outside: OutsideSteps,
    /// What passed between the host and the device.
    pub traffic: Account,
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

impl Ledger {
    /// How far the sphere has been moved up to the end of a step: the sum of |change of h| +
    /// |change of delta_T| over its steps. It grows with every step, is a length, and does not
    /// depend on how a path is cut into steps: the time of the fields in ParaView.
    pub fn path_length(&self, step: usize) -> f64 {
        let (mut h, mut delta_t, mut length) = (0.0, 0.0, 0.0);
        for row in self.rows.iter().take_while(|row| row.step <= step) {
            length += (row.h - h).abs() + (row.delta_t - delta_t).abs();
            (h, delta_t) = (row.h, row.delta_t);
        }
        length
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_path_is_as_long_there_and_back_however_it_is_cut() {
        let row = |step, h, delta_t| StepRecord { step, h, delta_t, ..StepRecord::default() };
        let ledger = |rows: Vec<StepRecord>| Ledger { rows, ..Ledger::default() };
        let fine = ledger(vec![row(1, 1.0, 0.0), row(2, 2.0, 0.0), row(3, 2.0, 0.5), row(4, 2.0, -0.5), row(5, 0.0, -0.5)]);
        assert_eq!([0, 1, 2, 3, 4, 5].map(|step| fine.path_length(step)), [0.0, 1.0, 2.0, 2.5, 3.5, 5.5]);
        let coarse = ledger(vec![row(1, 2.0, 0.0), row(2, 2.0, 0.5), row(3, 2.0, -0.5), row(4, 0.0, -0.5)]);
        assert_eq!(coarse.path_length(4), 5.5);
    }
}
