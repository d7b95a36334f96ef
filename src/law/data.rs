//! Reads a study back: `study.csv` and the run directories in `cases/`, reduced to what a law is
//! fitted to.

use std::path::Path;

use super::LawError;
use super::study_table::StudyTable;
use super::variables::{Body, Variables};
use crate::case::{Case, Friction, Hold, Scaled, Segment};
use crate::output::{OutputDirectory, StepRecord, Summary, SummaryInputs, read_history};

/// One point of a shear, as sizes, in the case's units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShearPoint {
    /// |delta_T|.
    pub delta_t: f64,
    /// F_T in the direction of the shear.
    pub f_t: f64,
    /// F_N.
    pub f_n: f64,
}

/// A case of a study that was pressed once and sheared to full slip at constant h.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    /// The case's name in `study.csv`.
    pub id: String,
    /// The sphere.
    pub body: Body,
    /// Samples with the same number are of the same material (hardening, sigma_Y/E and nu).
    pub material: usize,
    /// mu.
    pub friction: f64,
    /// h0.
    pub h0: f64,
    /// a0.
    pub a0: f64,
    /// F_N0.
    pub f_n0: f64,
    /// F_N at full slip, the end of the shear.
    pub f_n_slip: f64,
    /// The simulation's initial tangential stiffness k_T0.
    pub k_t0: f64,
    /// delta_T at which F_T/F_N reaches 0.99 mu.
    pub delta_t_slip: f64,
    /// The normalised variables before the shear.
    pub variables: Variables,
    /// The shear, from its start (delta_T = 0, F_T = 0, F_N = F_N0) to full slip.
    pub curve: Vec<ShearPoint>,
    /// How finely it was meshed.
    pub elements_per_contact_radius: usize,
    /// The curve is that of its mesh: no limit of fine meshes is known.
    pub is_raw: bool,
}

impl Sample {
    /// Greatest F_T of the shear.
    pub fn peak(&self) -> f64 {
        self.curve.iter().fold(0.0, |peak, point| point.f_t.max(peak))
    }
}

/// A case that is of no use for a law, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Skipped {
    /// The case's name in `study.csv`.
    pub id: String,
    /// Why, in a few words.
    pub reason: String,
}

/// What a study gives.
#[derive(Clone, Debug, PartialEq)]
pub struct StudyData {
    /// Usable cases, in the order of the table.
    pub samples: Vec<Sample>,
    /// The others.
    pub skipped: Vec<Skipped>,
}

impl StudyData {
    /// Number of different materials.
    pub fn materials(&self) -> usize {
        self.samples.iter().map(|sample| sample.material + 1).max().unwrap_or(0)
    }

    /// Reads the study in `dir`. Cases that did not end well, or were not pressed once and sheared
    /// once to full slip at constant h, are left out and listed.
    ///
    /// # Errors
    /// No study there; a table, case or history that cannot be read.
    pub fn read(dir: &Path) -> Result<Self, LawError> {
        let mut data = Self { samples: Vec::new(), skipped: Vec::new() };
        let mut materials: Vec<Scaled<Case>> = Vec::new();
        for row in StudyTable::read(&dir.join("study.csv"))?.rows {
            let skipped = if row.is_done() {
                let directory = OutputDirectory::existing(dir.join(&row.directory));
                match read_sample(&row.id, &directory, &mut materials)? {
                    Usable::Yes(sample) => {
                        data.samples.push(*sample);
                        continue;
                    }
                    Usable::No(reason) => reason.to_owned(),
                }
            } else {
                row.status
            };
            data.skipped.push(Skipped { id: row.id, reason: skipped });
        }
        Ok(data)
    }

    /// Number of samples whose curve is that of its mesh.
    pub fn raw(&self) -> usize {
        self.samples.iter().filter(|sample| sample.is_raw).count()
    }

    /// The reasons for leaving out cases with their numbers, as one sentence; empty if there are
    /// none.
    pub fn skipped_sentence(&self) -> String {
        let mut reasons: Vec<(&str, usize)> = Vec::new();
        for skipped in &self.skipped {
            match reasons.iter_mut().find(|(reason, _)| *reason == skipped.reason) {
                Some((_, count)) => *count += 1,
                None => reasons.push((&skipped.reason, 1)),
            }
        }
        if reasons.is_empty() {
            return String::new();
        }
        let list: Vec<String> = reasons.iter().map(|(reason, count)| format!("{count} {reason}")).collect();
        format!("Left out: {}. ", list.join(", "))
    }
}

/// Name of the directory, even if it was given as `.`.
pub(super) fn study_name(dir: &Path) -> String {
    let dir = dir.canonicalize().unwrap_or_else(|_| dir.to_owned());
    dir.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned())
}

/// Whether a law can be fitted to a run.
enum Usable {
    Yes(Box<Sample>),
    /// Why not, as the end of "left out: 3 ...".
    No(&'static str),
}

/// A sample from a run's directory.
fn read_sample(id: &str, directory: &OutputDirectory, materials: &mut Vec<Scaled<Case>>) -> Result<Usable, LawError> {
    let case = directory.load_case()?;
    if case.opponent.is_some() {
        return Ok(Usable::No("against another sphere, not a plane"));
    }
    if !case.sphere.equator.is_clamped() {
        return Ok(Usable::No("with a free equator"));
    }
    let friction = match case.contact.friction {
        Friction::Coefficient(mu) if mu > 0.0 => mu,
        Friction::Coefficient(_) => return Ok(Usable::No("without friction")),
        Friction::Stick => return Ok(Usable::No("with full stick")),
    };
    match case.path.as_slice() {
        [Segment::Indentation { .. }, Segment::Shear { hold: Hold::Indentation, .. }, ..] => {}
        [Segment::Indentation { .. }, Segment::Shear { hold: Hold::NormalForce, .. }, ..] => {
            return Ok(Usable::No("sheared at constant normal force"));
        }
        _ => return Ok(Usable::No("not pressed once and then sheared")),
    }
    let history = read_history(&directory.history())?;
    let is_raw = !is_known(&history, 1);
    let history = at_the_limit(&history);
    let summary = Summary::from_history(&history, &SummaryInputs::of(&case));
    let (Some(h0), Some(a0), Some(f_n0), Some(delta_t_slip), Some(_)) =
        (summary.h0, summary.a0, summary.f_n0, summary.delta_t_slip, summary.f_n_slip)
    else {
        return Ok(Usable::No("without full slip"));
    };
    let Some(k_t0) = summary.k_t0 else {
        return Ok(Usable::No("without k_T in their history, as of an earlier version"));
    };
    let curve = first_stroke(&history, f_n0);
    let f_n_slip = curve.last().map_or(f_n0, |point| point.f_n);
    if curve.len() < 5 || !(f_n0 > 0.0 && a0 > 0.0 && h0 > 0.0 && f_n_slip > 0.0) {
        return Ok(Usable::No("with too few steps"));
    }
    let body = Body::from_case(&case)?;
    let variables = body.variables(h0, a0, f_n0);
    let scaled = case.scaled();
    let material = materials.iter().position(|known| known.0.material == scaled.0.material).unwrap_or_else(|| {
        materials.push(scaled);
        materials.len() - 1
    });
    Ok(Usable::Yes(Box::new(Sample {
        id: id.to_owned(),
        body,
        material,
        friction,
        h0,
        a0,
        f_n0,
        f_n_slip,
        k_t0,
        delta_t_slip,
        variables,
        curve,
        elements_per_contact_radius: case.mesh.elements_per_contact_radius,
        is_raw,
    })))
}

/// Whether all rows of a segment have a limit of fine meshes.
pub fn is_known(history: &[StepRecord], segment: usize) -> bool {
    history.iter().filter(|row| row.segment == segment).all(|row| row.f_t_limit.is_some() && row.f_n_limit.is_some())
}

/// What a law says of so many of its cases whose curves are raw; empty if there are none.
pub fn raw_sentence(raw: usize) -> String {
    match raw {
        0 => String::new(),
        _ => format!("{raw} curves are those of their meshes, not of the limit of fine meshes, which they do not have\n"),
    }
}

/// A history at the limit of fine meshes, as far as it is known: in each segment whose rows all
/// have one, F_N and F_T are those of the limit.
pub fn at_the_limit(history: &[StepRecord]) -> Vec<StepRecord> {
    let segments: Vec<bool> =
        (0..=history.last().map_or(0, |row| row.segment)).map(|segment| is_known(history, segment)).collect();
    let limit = |row: &StepRecord| match (row.f_t_limit, row.f_n_limit) {
        (Some(f_t), Some(f_n)) if segments.get(row.segment) == Some(&true) => StepRecord { f_n, f_t, ..*row },
        _ => *row,
    };
    history.iter().map(limit).collect()
}

/// The first shear as far as it goes in one direction, its start included.
fn first_stroke(history: &[StepRecord], f_n0: f64) -> Vec<ShearPoint> {
    let mut curve = vec![ShearPoint { delta_t: 0.0, f_t: 0.0, f_n: f_n0 }];
    let first = history.iter().position(|record| record.segment == 1).unwrap_or(history.len());
    let direction = history.get(first).map_or(1.0, |record| record.delta_t.signum());
    for record in history[first..].iter().take_while(|record| record.segment == 1) {
        let point = ShearPoint { delta_t: direction * record.delta_t, f_t: direction * record.f_t, f_n: record.f_n };
        if curve.last().is_some_and(|last| point.delta_t <= last.delta_t) {
            break;
        }
        curve.push(point);
    }
    curve
}
