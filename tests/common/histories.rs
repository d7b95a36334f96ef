//! The histories of two runs side by side.
// Not every test target that compiles this file uses all of it.
#![allow(dead_code)]

use std::path::Path;

pub use asperity::internals::prove::parity::difference;
use asperity::output::{OutputDirectory, StepRecord, read_history};

/// The history as a study has it, in which no case has a companion.
pub fn history(dir: &Path) -> Vec<StepRecord> {
    let mut rows = read_history(&OutputDirectory::existing(dir).history()).expect("a history");
    rows.iter_mut().for_each(StepRecord::forget_limits);
    rows
}
