//! The histories of two runs side by side.
// Not every test target that compiles this file uses all of it.
#![allow(dead_code)]

use std::path::Path;

use asperity::output::{OutputDirectory, StepRecord, read_history};

/// The history as a study has it, in which no case has a companion.
pub fn history(dir: &Path) -> Vec<StepRecord> {
    let mut rows = read_history(&OutputDirectory::existing(dir).history()).expect("a history");
    rows.iter_mut().for_each(StepRecord::forget_limits);
    rows
}

/// The largest difference of F_N, F_T and a over the steps; forces by the largest F_N.
pub fn difference(ours: &[StepRecord], theirs: &[StepRecord]) -> f64 {
    assert_eq!(ours.len(), theirs.len(), "another number of steps");
    let largest = |of: fn(&StepRecord) -> f64| theirs.iter().fold(0.0_f64, |m, row| m.max(of(row).abs()));
    let (force, radius) = (largest(|row| row.f_n), largest(|row| row.a));
    ours.iter().zip(theirs).fold(0.0_f64, |m, (ours, theirs)| {
        let force = (ours.f_n - theirs.f_n).abs().max((ours.f_t - theirs.f_t).abs()) / force;
        m.max(force).max((ours.a - theirs.a).abs() / radius)
    })
}
