//! What a simulation of one depth gives.

use std::path::Path;

use crate::case::{Case, Segment};
use crate::law::LawError;
use crate::law::data::Point;
use crate::law::table::StudyTable;
use crate::output::{OutputDirectory, StepRecord, read_history};

/// A depth that was not reached.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Missing {
    /// The case in the study.
    pub id: String,
    /// Why.
    pub reason: String,
}

/// One depth, pressed and sheared; lengths over R, forces over E R^2.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// h.
    pub h: f64,
    /// F_N0.
    pub f_n0: f64,
    /// a0.
    pub a0: f64,
    /// The shear from its start on, as sizes; the start alone without friction.
    pub curve: Vec<Point>,
    /// The shear back, from the end of the first on; empty if there is none.
    pub back: Vec<Point>,
    /// (h, F_N) of the release at the end, from its start on.
    pub release: Vec<[f64; 2]>,
}

impl Measured {
    /// Greatest F_T.
    pub fn peak(&self) -> f64 {
        self.curve.iter().fold(0.0, |peak, point| point.f_t.max(peak))
    }

    /// Of a case that was pressed and perhaps sheared to and fro and released, and of its history.
    pub fn of(case: &Case, history: &[StepRecord]) -> Option<Self> {
        let (radius, force) = (case.sphere.radius, case.material.youngs_modulus * case.sphere.radius * case.sphere.radius);
        let start = history.iter().rfind(|row| row.segment == 0)?;
        let mut curve = vec![Point { delta_t: 0.0, f_t: 0.0, f_n: start.f_n / force }];
        let shears = matches!(case.path.get(1), Some(Segment::Shear { .. }));
        let point = |row: &StepRecord| Point { delta_t: row.delta_t / radius, f_t: row.f_t / force, f_n: row.f_n / force };
        let of = |segment: usize| history.iter().filter(move |row| row.segment == segment);
        let mut back = Vec::new();
        if shears {
            curve.extend(of(1).map(point));
        }
        let returns = shears && matches!(case.path.get(2), Some(Segment::Shear { .. }));
        if returns {
            back.extend(of(1).next_back().into_iter().chain(of(2)).map(point));
        }
        let last = 1 + usize::from(shears) + usize::from(returns);
        let release = history.iter().rfind(|row| row.segment + 1 == last).into_iter().chain(of(last));
        let release = release.map(|row| [row.h / radius, row.f_n / force]).collect();
        Some(Self { h: start.h / radius, f_n0: start.f_n / force, a0: start.a / radius, curve, back, release })
    }
}

/// The depths of a study that are there, increasing; and those that are not, with the reason.
///
/// # Errors
/// No study there, or a file that cannot be read.
pub fn measured(dir: &Path) -> Result<(Vec<Measured>, Vec<Missing>), LawError> {
    let (mut all, mut missing) = (Vec::new(), Vec::new());
    for row in StudyTable::read(&dir.join("study.csv"))?.rows {
        if !row.is_done() {
            missing.push(Missing { id: row.id, reason: row.status });
            continue;
        }
        let directory = OutputDirectory::existing(dir.join(&row.directory));
        let case = Case::load(&directory.case(), &[])?;
        match Measured::of(&case, &read_history(&directory.history())?) {
            Some(one) => all.push(one),
            None => missing.push(Missing { id: row.id, reason: "without a step".to_owned() }),
        }
    }
    all.sort_by(|a, b| a.h.total_cmp(&b.h));
    Ok((all, missing))
}
