//! What a simulation of one depth gives, in the frame that an engine has: two spheres are turned
//! into that of their centres.

use std::path::Path;

use super::against::equivalent;
use crate::analytical::ElasticSphere;
use crate::case::{Case, Friction, Segment};
use crate::contact_law::{Centres, unloading_exponent};
use crate::law::LawError;
use crate::law::data::{ShearPoint, at_the_limit};
use crate::law::study_table::StudyTable;
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
    /// The shear from its start on, as sizes, at the overlap h; the start alone without friction.
    pub curve: Vec<ShearPoint>,
    /// The shear back, from the end of the first on; empty if there is none.
    pub back: Vec<ShearPoint>,
    /// (h, F_N) of the release at the end, from its start on.
    pub release: Vec<[f64; 2]>,
}

/// A history in the frame of the centres: h is the overlap, delta_T the tangential displacement,
/// F_N and F_T those of this frame.
pub fn turned(centres: Centres, history: &[StepRecord]) -> Vec<StepRecord> {
    let (mut slid, mut before) = (0.0, [0.0; 2]);
    let row = |row: &StepRecord| {
        let place = [row.h, row.delta_t];
        slid += centres.displacement(before, place);
        before = place;
        let [f_n, f_t] = centres.turned(place, [row.f_n, row.f_t]);
        StepRecord { h: centres.overlap(place), delta_t: slid, f_n, f_t, ..*row }
    };
    history.iter().map(row).collect()
}

impl Measured {
    /// Greatest F_T.
    pub fn peak(&self) -> f64 {
        self.curve.iter().fold(0.0, |peak, point| point.f_t.max(peak))
    }

    /// Of a case that was pressed and perhaps sheared to and fro and released, and of its history.
    pub fn of(case: &Case, history: &[StepRecord]) -> Option<Self> {
        let centres = Centres::of(case);
        let history = &turned(centres, &at_the_limit(history));
        let (radius, force) = (case.sphere.radius, case.material.youngs_modulus * case.sphere.radius * case.sphere.radius);
        let start = history.iter().rfind(|row| row.segment == 0)?;
        let mut curve = vec![ShearPoint { delta_t: 0.0, f_t: 0.0, f_n: start.f_n / force }];
        let shears = matches!(case.path.get(1), Some(Segment::Shear { .. }));
        let point = |row: &StepRecord| ShearPoint { delta_t: row.delta_t / radius, f_t: row.f_t / force, f_n: row.f_n / force };
        let mut lacking = vec![0.0];
        let of = |segment: usize| history.iter().filter(move |row| row.segment == segment);
        let mut back = Vec::new();
        if shears {
            curve.extend(of(1).map(point));
            lacking.extend(of(1).map(|row| (start.h - row.h) / radius));
        }
        let returns = shears && matches!(case.path.get(2), Some(Segment::Shear { .. }));
        if returns {
            back.extend(of(1).next_back().into_iter().chain(of(2)).map(point));
        }
        let last = 1 + usize::from(shears) + usize::from(returns);
        let release = history.iter().rfind(|row| row.segment + 1 == last).into_iter().chain(of(last));
        let release = release.map(|row| [row.h / radius, row.f_n / force]).collect();
        let one = Self { h: start.h / radius, f_n0: start.f_n / force, a0: start.a / radius, curve, back, release };
        Some(match (centres.frame(), case.contact.friction) {
            (Some(_), Friction::Coefficient(mu)) => one.at_one_overlap(&equivalent(&case.scaled().0), mu, &lacking),
            _ => one,
        })
    }

    /// The shear as it would be if the overlap stayed that of its start, of which it lacks so much
    /// at each point. The elastic approach e, F_N = F_N0 (e/D)^gamma, is what a smaller overlap
    /// takes: all of F_N that it would have in an elastic contact, and the share of it that F_N has
    /// of F_N0 where flow takes up the rest. F_T of an elastic contact (Cattaneo and Mindlin) that
    /// holds on to the radius c gains mu (1 - c/a) times as much, 1 - c/a = 1 - (1 - F_T/mu
    /// F_N)^(1/3).
    ///
    /// Of three pairs that were also simulated at a constant overlap, which lacked 9 % of e at mu =
    /// 0.75 to 0.9, F_N is met to 0.9 % and F_T to 3 % of its peak (3 and 7 % without this).
    fn at_one_overlap(mut self, sphere: &ElasticSphere, friction: f64, lacking: &[f64]) -> Self {
        let a = unloading_radius(sphere, &self);
        let gamma = unloading_exponent(sphere.radius, sphere.effective_modulus(), a, self.f_n0);
        let depth = gamma * self.f_n0 / (2.0 * sphere.effective_modulus() * a);
        for (point, lacks) in self.curve.iter_mut().zip(lacking) {
            let approach = depth * (point.f_n / self.f_n0).max(0.0).powf(1.0 / gamma);
            let elastic = point.f_n * (1.0 + lacks / approach).powf(gamma);
            let gain = (elastic - point.f_n) * (elastic / self.f_n0).min(1.0);
            let held = (1.0 - point.f_t / (friction * point.f_n)).clamp(0.0, 1.0).cbrt();
            // Two spheres that have come off have no such contact, and without friction F_T is
            // none.
            if gain.is_finite() && held.is_finite() {
                *point = ShearPoint { f_t: point.f_t + friction * gain * (1.0 - held), f_n: point.f_n + gain, ..*point };
            }
        }
        self
    }
}

/// What is less deep than this share of an oblique press has too few elements in its contact: half
/// as many along its radius as the last depth.
const RESOLVED: f64 = 0.25;
/// Share of mu above which F_T/F_N of an oblique press says that it slides, and not how it yields.
/// Half and twice of this and of the numbers below: `benches/constants`.
const SLIDING: f64 = 0.97;
/// Fewest steps of an oblique press that are used, its last ones.
const FEWEST: usize = 3;
/// Steps to either side over which the ripple of the mesh is taken out.
const RIPPLE: usize = 2;
/// Share of mu below which F_T/F_N is the tolerance's.
const NOTHING: f64 = 0.01;

/// Whether a press that begins a case slides at its end: then its c is a bound.
pub fn slides_to_its_end(case: &Case, history: &[StepRecord]) -> bool {
    let Friction::Coefficient(mu) = case.contact.friction else { return false };
    pressed(case, history).last().is_some_and(|row| row.f_t > SLIDING * mu * row.f_n)
}

/// The steps of the press that begins a case, at the limit of fine meshes where that is known.
fn pressed(case: &Case, history: &[StepRecord]) -> Vec<StepRecord> {
    let press: Vec<StepRecord> = history.iter().filter(|row| row.segment == 0).copied().collect();
    turned(Centres::of(case), &at_the_limit(&press))
}

/// ln h and c of the yield curve along the oblique press that begins a case, increasing in h:
/// steady flow has d(delta_T)/dh = 2 c r/(1 - c r^2), r = F_T/F_N. Where all of it slides, of the
/// last steps.
pub fn yielding(case: &Case, history: &[StepRecord]) -> Vec<[f64; 2]> {
    let Friction::Coefficient(mu) = case.contact.friction else { return Vec::new() };
    let rows = pressed(case, history);
    let deepest = rows.iter().map(|row| row.h).fold(0.0, f64::max);
    let rows: Vec<[f64; 3]> = rows
        .iter()
        .filter(|row| row.h > 0.0 && row.h >= (1.0 - 1e-9) * RESOLVED * deepest && row.f_n > 0.0)
        .map(|row| [(row.h / case.sphere.radius).ln(), row.delta_t / row.h, row.f_t / row.f_n])
        .collect();
    let sticks = rows.iter().rposition(|row| row[2] > SLIDING * mu).map_or(0, |i| i + 1);
    let used = &rows[sticks.min(rows.len().saturating_sub(FEWEST))..];
    let logarithm = |[_, slope, r]: &[f64; 3]| {
        let r = r.max(NOTHING * mu);
        (slope / (r * (2.0 + slope * r))).ln()
    };
    let mean = |i: usize| {
        let near = &used[i.saturating_sub(RIPPLE)..(i + RIPPLE + 1).min(used.len())];
        (near.iter().map(logarithm).sum::<f64>() / near.len() as f64).exp()
    };
    (0..used.len()).map(|i| [used[i][0], mean(i)]).filter(|point| point[1] > 0.0 && point[1].is_finite()).collect()
}

/// What a study gives.
pub struct MeasuredStudy {
    /// The depths that are there, increasing.
    pub depths: Vec<Measured>,
    /// [`yielding`] of its oblique presses, increasing in h; empty without one.
    pub yielding: Vec<[f64; 2]>,
    /// What is not there, with the reason.
    pub missing: Vec<Missing>,
}

/// What is there of a study.
///
/// # Errors
/// No study there, or a file that cannot be read.
pub fn measured(dir: &Path) -> Result<MeasuredStudy, LawError> {
    let (mut all, mut missing, mut oblique) = (Vec::new(), Vec::new(), Vec::new());
    for row in StudyTable::read(&dir.join("study.csv"))?.rows {
        if !row.is_done() {
            missing.push(Missing { id: row.id, reason: row.status });
            continue;
        }
        let directory = OutputDirectory::existing(dir.join(&row.directory));
        let case = directory.load_case()?;
        let history = read_history(&directory.history())?;
        if let Some(Segment::Oblique { .. }) = case.path.first() {
            oblique.extend(yielding(&case, &history));
            continue;
        }
        match Measured::of(&case, &history) {
            Some(one) => all.push(one),
            None => missing.push(Missing { id: row.id, reason: "without a step".to_owned() }),
        }
    }
    all.sort_by(|a, b| a.h.total_cmp(&b.h));
    oblique.sort_by(|a, b| a[0].total_cmp(&b[0]));
    Ok(MeasuredStudy { depths: all, yielding: oblique, missing })
}

/// The radius a with which F_N = F (e/D)^gamma, D = gamma F/(2 E* a), takes the simulated way from
/// the first force F of the release to the last.
pub fn unloading_radius(sphere: &ElasticSphere, one: &Measured) -> f64 {
    let (Some(from), Some(to)) = (one.release.first(), one.release.last()) else { return one.a0 };
    let way = from[0] - to[0];
    if !(way > 0.0 && from[1] > to[1] && to[1] > 0.0) {
        return one.a0;
    }
    let mut a = one.a0;
    for _ in 0..50 {
        let gamma = unloading_exponent(sphere.radius, sphere.effective_modulus(), a, one.f_n0);
        let depth = way / (1.0 - (to[1] / from[1]).powf(1.0 / gamma));
        a = gamma * from[1] / (2.0 * sphere.effective_modulus() * depth);
    }
    a
}
