//! Grids of cases: read and checked as a whole, computed side by side, one row each.
//!
//! `file` reads a base case and a grid into cases; `shard` deals them out; `run` decides which
//! there are to compute and on what; `schedule` gives each a core of its own, or `device` forms
//! batches of them, whose cases share a backend through `batch`; `simulate` takes one from its
//! directory to its summary; `room` says for how many there is memory at a time; `row` makes
//! `study.csv` of the summaries; `place` knows the directory of each case; `slurm` writes the
//! scripts of a cluster; `merge` joins directories; `report` draws them and writes `report.html`.
//! What can go wrong with one case is a row; what can go wrong with all of them is a
//! [`StudyError`].

mod batch;
mod device;
mod directory;
mod error;
mod file;
mod id;
mod merge;
mod place;
mod progress;
#[cfg(feature = "plots")]
pub mod report;
mod room;
mod row;
mod run;
mod schedule;
mod shard;
mod simulate;
pub mod slurm;
mod sweep;

#[cfg(test)]
mod tests;

pub use device::backends;
pub use directory::{EarlierStudy, StudyDirectory};
pub use error::StudyError;
pub use file::{Study, StudyCase};
pub use merge::{Merged, merge};
pub use place::{Placed, alone, hold};
pub use progress::StudyProgress;
pub use row::{FIRST_COLUMNS, NUMBERS, Row, RowStatus};
#[cfg(feature = "cli")]
pub(crate) use run::run_on;
pub use run::{Options, Report, prepare, run};
pub use shard::{Shard, cost, estimated_seconds};
