//! What a run leaves behind: `history.csv`, `summary.json`, `fields/*.vtu` with a `.pvd`,
//! `contact/*.csv`, `plots/*.svg`, while it goes on a checkpoint, and its progress on the screen.
//!
//! The writers take plain records in the user's units; `units` makes them from the simulation's
//! scaled ones. Every file but `history.csv` is written beside its place and moved there when it is
//! whole ([`write_atomically`]); `history.csv` grows by whole rows, so that a killed job keeps what
//! it computed.

mod parquet;
#[cfg(feature = "plots")]
pub mod plots;

mod atomic;
mod checkpoint;
mod clock;
mod contact_csv;
mod contact_point;
mod curve;
mod decimal;
mod directory;
mod error;
pub mod estimate;
mod fields;
mod finite;
mod first_shear;
mod history;
mod ledger;
mod limit;
mod lock;
mod own;
mod path_share;
pub(crate) mod plain_json;
mod progress;
mod recorder;
mod report;
mod results;
mod run_log;
mod sound;
pub(crate) mod space;
mod summary;
mod tables;
mod time_by_phase;
mod units;
mod vtu;

pub use crate::compute::traffic::{DeviceTraffic, Traffic};
pub use crate::simulation::record::StepRecord;
#[cfg(feature = "law")]
pub(crate) use atomic::remove_if_there;
pub use atomic::{draft_of, write_atomically};
pub use checkpoint::{Checkpoint, case_difference};
pub use clock::Clock;
pub use contact_csv::{read_contact, write_contact};
pub use contact_point::{ContactPoint, ContactStatus, Half};
pub use decimal::decimal;
pub use directory::OutputDirectory;
pub use error::OutputError;
pub use estimate::{ErrorEstimate, ripple};
pub use fields::{mises, write_fields};
pub use first_shear::SLIP_DISPLACEMENT_RATIO;
pub use history::{HistoryWriter, history_columns, read_history};
pub use limit::{Limits, StepLimits};
#[cfg(feature = "law")]
pub(crate) use lock::is_left;
pub use lock::{DirectoryLock, LOCK_NAME, TaskLock, is_study_lock};
pub use own::{RESULT_MARKER, is_own, refuse_foreign, refuse_input, write_own};
pub use parquet::write_parquet;
pub use path_share::PathShare;
#[cfg(feature = "plots")]
pub use plots::{Picture, PlotInputs, write_plots};
#[cfg(feature = "bars")]
pub(crate) use progress::BAR_PARTS;
#[cfg(feature = "bars")]
pub use progress::BarProgress;
pub use progress::{PlainProgress, Position, Progress, SilentProgress, detail, in_words, last_line, progress};
pub use recorder::Recorder;
pub use results::{ResultWriter, Setting};
pub use run_log::LoggedProgress;
pub use summary::{FULL_SLIP_RATIO, NormalizedResults, RunStatus, Summary, SummaryInputs};
pub use time_by_phase::{OutsideSteps, PhaseTime, TimeByPhase};
pub use units::Units;
pub use vtu::{Collection, Field, Grid, Values, write_vtu};
