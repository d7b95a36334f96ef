//! The limit of fine meshes and short steps of F_T and F_N, and how far a run may be from it, step
//! by step.
//!
//! The run is compared with its companion, [`crate::simulation::scout`], at the same place on the
//! path: of a press and an oblique segment at the same share of it, of a shear and a release, in
//! which the forces go with the way from where it began, at the same displacement from there.
//!
//! What is of first order in mesh or steps is in the companion twice, so that f + (f - c) is
//! without it (Richardson, Phil. Trans. R. Soc. A 226, 1927; Roache, J. Fluids Eng. 116, 1994).
//!
//! - F_T/F_N, in which the ripple of points that come into contact one by one cancels, is
//!   extrapolated so.
//! - F_N of a press falls faster, eightfold from companion to run at 16 elements, and what is left
//!   of its difference is mostly that ripple: no correction. In a shear it has an error of first
//!   order where friction is high. What its difference there exceeds that of the press by, which
//!   was ripple, is added.
//!
//! docs/accuracy.md has the figures, and benches/limits/measure.py makes them.

use super::curve::Curve;
use super::{StepRecord, Units};
use crate::case::{Case, Friction, Motion, Scaled, Segment, ShearTarget};
use crate::simulation::scout::Scout;

/// Steps over which differences are averaged, as a root mean square: one alone may be small by
/// chance, where ripples cross.
const WINDOW: usize = 10;
/// What the difference of the two runs is multiplied with at most: one that has started over on a
/// mesh almost as coarse as its companion's is not compared.
const MOST_FACTOR: f64 = 3.0;
/// Estimated error of F_N, and of a, in the mean difference from the companion. This share and the
/// next are round numbers at which nine in ten errors of F_N are covered in the table that
/// `benches/limits/measure.py` prints, whose truth is extrapolated from 8 and 16 elements.
const NORMAL_SHARE: f64 = 0.85;
/// What is missing of F_T/F_N is missing of F_N too, as the surface yields to p and q together:
/// F_N falls with (F_T/F_N)^2. So much of F_T/F_N, times what it lacks, times F_N.
const COUPLED_SHARE: f64 = 4.0;
/// Estimated error of F_T in what F_T/F_N lacks, times F_N; that of F_N comes to it, and so does
/// the next share. Both are round numbers by `benches/limits/shares.py`: the curves of F_T of 16 of
/// 19 contacts are covered, at 3.0 times the true errors (median).
pub(super) const TANGENTIAL_SHARE: f64 = 1.5;
/// What the two runs do not show of F_T from the first shear on, in mu F_N: their difference
/// changes its sign on the way, and they share errors. Without it a third of the curves is covered.
const UNSEEN_SHARE: f64 = 0.005;

/// F_T/F_N over mu from which on a companion that was sheared to full slip counts as sliding. It is
/// nearer to mu where every point slips, but for a pair whose spheres have passed each other.
const SLIDES: f64 = 0.98;

/// The companion of a run, and how it is compared.
#[derive(Clone, Debug, PartialEq)]
pub struct Limits {
    path: Vec<Segment>,
    units: Units,
    /// mu; `None` for full stick.
    pub(super) friction: Option<f64>,
    /// Its curves, segment by segment.
    companion: Vec<SegmentCurves>,
    /// Its tangents dF_T/d delta_T at the start of shears, segment by segment.
    stiffness: Vec<Option<f64>>,
    /// Elements along the contact radius that were asked of it.
    pub coarse_elements: usize,
    coarse_spacing: f64,
    spacing: f64,
}

/// F_N, F_T along x and y, and a over the place in a segment.
#[derive(Clone, Debug, Default, PartialEq)]
struct SegmentCurves {
    f_n: Curve,
    f_t: Curve,
    f_t_y: Curve,
    a: Curve,
}

/// The companion at the place of a row.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Counterpart {
    f_n: f64,
    f_t: f64,
    f_t_y: f64,
    a: f64,
}

/// What is known of the limits at a step, in the user's units; `None` where the companion did not
/// get.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepLimits {
    /// See [`StepRecord::f_t_limit`].
    pub f_t_limit: Option<f64>,
    /// The same along y, of which the history has no column.
    pub f_t_y_limit: Option<f64>,
    /// See [`StepRecord::f_n_limit`].
    pub f_n_limit: Option<f64>,
    /// See [`StepRecord::f_t_error`].
    pub f_t_error: Option<f64>,
    /// See [`StepRecord::f_n_error`].
    pub f_n_error: Option<f64>,
    /// Estimated size of what the contact radius lacks.
    pub a_error: Option<f64>,
}

impl StepLimits {
    /// Adds them to a row that is scaled as the simulation's are.
    pub fn put_into(&self, record: &mut Scaled<StepRecord>, units: &Units) {
        let scaled = |value: Option<f64>| value.map(|value| value / units.force());
        let row = &mut record.0;
        (row.f_t_limit, row.f_n_limit) = (scaled(self.f_t_limit), scaled(self.f_n_limit));
        (row.f_t_error, row.f_n_error) = (scaled(self.f_t_error), scaled(self.f_n_error));
    }
}

impl Limits {
    /// Of a run of `case` (in the user's units) whose elements in the contact are of the (scaled)
    /// size `spacing`. `None` if the companion did not get to the end of the path.
    pub fn new(case: &Case, scout: &Scout, spacing: f64) -> Option<Self> {
        if scout.failure.is_some() {
            return None;
        }
        let units = Units::of(case);
        let rows: Vec<StepRecord> = scout.rows.iter().map(|row| row.in_units(&units)).collect();
        let stretch = |(i, segment): (usize, &Segment)| {
            let from = rows.partition_point(|row| row.segment < i);
            let to = rows.partition_point(|row| row.segment <= i);
            SegmentCurves::new(segment, &start_of(&rows[..from]), rows.get(from..to).unwrap_or_default())
        };
        let friction = match case.contact.friction {
            Friction::Coefficient(mu) => Some(mu),
            Friction::Stick => None,
        };
        let stiffness = |i: usize| rows.iter().filter(|row| row.segment == i).find_map(|row| row.k_t);
        Some(Self {
            stiffness: (0..case.path.len()).map(stiffness).collect(),
            companion: case.path.iter().enumerate().map(stretch).collect(),
            path: case.path.clone(),
            units,
            friction,
            coarse_elements: scout.elements,
            coarse_spacing: scout.spacing,
            spacing,
        })
    }

    /// Estimated error of the tangent dF_T/d delta_T at the start of a shear, of which `first` is
    /// the first row: what it lacks at first order, and half as much again, as of F_T/F_N.
    pub fn stiffness_error(&self, first: &StepRecord) -> Option<f64> {
        let there = self.stiffness.get(first.segment).copied().flatten()?;
        let error = TANGENTIAL_SHARE * self.factor() * (first.k_t? - there).abs();
        (self.is_comparable() && error.is_finite()).then_some(error)
    }

    fn is_comparable(&self) -> bool {
        self.coarse_spacing > self.spacing && self.factor() <= MOST_FACTOR
    }

    /// The run has started over on another mesh.
    pub fn meshed(&mut self, spacing: f64) {
        self.spacing = spacing;
    }

    /// What is known at a row, from it and those before it, all in the user's units.
    pub fn of(&self, before: &[StepRecord], row: &StepRecord) -> StepLimits {
        let Some(here) = self.counterpart(before, row).filter(|_| self.is_comparable()) else { return StepLimits::default() };
        let StepLimits { f_t_limit, f_t_y_limit, f_n_limit, f_t_error, f_n_error, a_error } = self.compared(before, row, here);
        let [f_t_limit, f_t_y_limit, f_n_limit, f_t_error, f_n_error, a_error] =
            [f_t_limit, f_t_y_limit, f_n_limit, f_t_error, f_n_error, a_error]
                .map(|value| value.filter(|value| value.is_finite()));
        StepLimits { f_t_limit, f_t_y_limit, f_n_limit, f_t_error, f_n_error, a_error }
    }

    fn compared(&self, before: &[StepRecord], row: &StepRecord, here: Counterpart) -> StepLimits {
        let mut window = self.last_compared(before, WINDOW - 1);
        window.push((*row, here));
        let f_n_usual = self.mean(&window, |row, there| Some(row.f_n - there.f_n));
        let a_error = Some(NORMAL_SHARE * self.mean(&window, |row, there| Some(row.a - there.a)));
        let f_n_limit = (row.f_n + self.beyond_ripple(before, row, &here)).max(0.0);
        if row.f_n <= 0.0 {
            let f_n_error = Some(NORMAL_SHARE * f_n_usual);
            let none = Some(0.0);
            let f_n_limit = Some(f_n_limit);
            return StepLimits { f_t_limit: none, f_t_y_limit: none, f_n_limit, f_t_error: none, f_n_error, a_error };
        }
        let Some([difference, across]) = ratio_difference(row, &here) else {
            return StepLimits {
                f_n_limit: Some(f_n_limit),
                f_n_error: Some(NORMAL_SHARE * f_n_usual),
                a_error,
                ..Default::default()
            };
        };
        // Here or a step ago, whichever is more: it may change its sign on the way.
        let last = window.iter().rev().take(2).filter(|(other, _)| other.segment == row.segment);
        let differences = last.filter_map(|(other, there)| ratio_difference(other, there));
        let ratio_error = self.factor() * differences.map(size).fold(0.0, f64::max);
        let ratio = size([row.f_t, row.f_t_y]) / row.f_n;
        let ripple = NORMAL_SHARE * f_n_usual;
        // By symmetry a press has no F_T.
        let scale = if row.segment < self.first_sheared() { 0.0 } else { self.friction.unwrap_or(ratio) };
        let unseen = UNSEEN_SHARE * scale * row.f_n;
        let bound = self.friction.unwrap_or(f64::INFINITY);
        let [along, across] =
            within([row.f_t / row.f_n + self.factor() * difference, row.f_t_y / row.f_n + self.factor() * across], bound);
        StepLimits {
            f_t_limit: Some(along * f_n_limit),
            f_t_y_limit: Some(across * f_n_limit),
            f_n_limit: Some(f_n_limit),
            f_t_error: Some((TANGENTIAL_SHARE * ratio_error * row.f_n).hypot(ratio * ripple).hypot(unseen)),
            f_n_error: Some(ripple.hypot(COUPLED_SHARE * ratio * ratio_error * row.f_n)),
            a_error,
        }
    }

    /// By how much more F_N of a shear differs from the companion's than it did in the last steps
    /// before the first shear, where all of the difference is ripple and what falls faster than at
    /// first order.
    fn beyond_ripple(&self, before: &[StepRecord], row: &StepRecord, here: &Counterpart) -> f64 {
        let is_shear = |segment: &Segment| match segment {
            Segment::Shear { .. } | Segment::Slip { .. } => true,
            Segment::Motion { to, .. } => to.indentation.is_none() && to.shear.is_some() && to.roll.is_none(),
            _ => false,
        };
        if !self.path.get(row.segment).is_some_and(is_shear) {
            return 0.0;
        }
        let press = before.partition_point(|earlier| earlier.segment < self.first_sheared());
        let pressed = self.last_compared(&before[..press], WINDOW);
        if pressed.is_empty() {
            return 0.0;
        }
        let difference = self.factor() * (row.f_n - here.f_n);
        // No less than where the press ends, or the limit would jump there.
        let last = pressed.last().map_or(0.0, |(row, there)| self.factor() * (row.f_n - there.f_n).abs());
        let level = self.mean(&pressed, |row, there| Some(row.f_n - there.f_n)).max(last);
        difference.signum() * (difference.abs() - level).max(0.0)
    }

    /// The first segment that is no press and no release.
    fn first_sheared(&self) -> usize {
        let is_sheared = |segment: &Segment| !matches!(segment, Segment::Indentation { .. } | Segment::Release { .. });
        self.path.iter().position(is_sheared).unwrap_or(self.path.len())
    }

    /// The last rows, at most so many, with their counterparts, as far back as there are some.
    fn last_compared(&self, rows: &[StepRecord], count: usize) -> Vec<(StepRecord, Counterpart)> {
        let all = (0..rows.len()).rev().take(count);
        let mut found: Vec<_> = all.map_while(|i| Some((rows[i], self.counterpart(&rows[..i], &rows[i])?))).collect();
        found.reverse();
        found
    }

    /// Root mean square of a difference over the rows that have it, as an error of first order of
    /// the finer run; none is 0.
    fn mean(&self, window: &[(StepRecord, Counterpart)], difference: impl Fn(&StepRecord, &Counterpart) -> Option<f64>) -> f64 {
        let squares: Vec<f64> = window.iter().filter_map(|(row, there)| difference(row, there)).map(|d| d * d).collect();
        self.factor() * (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt()
    }

    /// Writes what is known into all rows of a history, to the bits that they get one by one, which
    /// pass through the simulation's units.
    pub fn write_into(&self, rows: &mut [StepRecord]) {
        for i in 0..rows.len() {
            let (before, rest) = rows.split_at_mut(i);
            let mut scaled = Scaled(StepRecord::default());
            self.of(before, &rest[0]).put_into(&mut scaled, &self.units);
            let StepRecord { f_t_limit, f_n_limit, f_t_error, f_n_error, .. } = scaled.in_units(&self.units);
            rest[0] = StepRecord { f_t_limit, f_n_limit, f_t_error, f_n_error, ..rest[0] };
        }
    }

    /// What the difference of the two runs is multiplied with for an error of first order of the
    /// finer one: e = C spacing in both.
    fn factor(&self) -> f64 {
        self.spacing / (self.coarse_spacing - self.spacing)
    }

    fn counterpart(&self, before: &[StepRecord], row: &StepRecord) -> Option<Counterpart> {
        let (segment, stretch) = (self.path.get(row.segment)?, self.companion.get(row.segment)?);
        let from = before.partition_point(|earlier| earlier.segment < row.segment);
        stretch.at(segment, place(segment, &start_of(&before[..from]), row), self.friction)
    }
}

impl SegmentCurves {
    fn new(segment: &Segment, start: &StepRecord, rows: &[StepRecord]) -> Self {
        let curve = |of: fn(&StepRecord) -> f64| {
            Curve::through(rows.iter().fold(vec![[0.0, of(start)]], |mut points, row| {
                points.push([place(segment, start, row), of(row)]);
                points
            }))
        };
        Self { f_n: curve(|row| row.f_n), f_t: curve(|row| row.f_t), f_t_y: curve(|row| row.f_t_y), a: curve(|row| row.a) }
    }

    /// `None` for a segment in which the companion had nothing to do, and beyond the end of one by
    /// more than its last step. One that was sheared along x until all of it slips slides on as it
    /// is.
    fn at(&self, segment: &Segment, place: f64, friction: Option<f64>) -> Option<Counterpart> {
        let [end, step] = self.f_n.end()?;
        let full = matches!(segment, Segment::Shear { shear: ShearTarget::FullSlip, .. } | Segment::Slip { .. });
        if full && place > end {
            let last = self.all_at(end)?;
            let most = friction? * last.f_n;
            let found = size([last.f_t, last.f_t_y]);
            if found >= SLIDES * most {
                let of_most = |part: f64| if part.abs() == found { part.signum() * most } else { part / found * most };
                return Some(Counterpart { f_t: of_most(last.f_t), f_t_y: of_most(last.f_t_y), ..last });
            }
        }
        let released = matches!(segment, Segment::Release { share } if *share == 0.0);
        if released && place >= end {
            // Nothing touches any more.
            return Some(Counterpart { f_n: 0.0, f_t: 0.0, f_t_y: 0.0, a: 0.0 });
        }
        if place > end + step {
            return None;
        }
        self.all_at(place)
    }

    fn all_at(&self, place: f64) -> Option<Counterpart> {
        let (f_n, f_t, f_t_y) = (self.f_n.at(place)?, self.f_t.at(place)?, self.f_t_y.at(place)?);
        Some(Counterpart { f_n, f_t, f_t_y, a: self.a.at(place)? })
    }
}

/// F_T/F_N along x and y within Coulomb's bound.
fn within([along, across]: [f64; 2], bound: f64) -> [f64; 2] {
    if across == 0.0 {
        return [along.clamp(-bound, bound), across];
    }
    let found = along.hypot(across);
    if found <= bound { [along, across] } else { [along, across].map(|part| part / found * bound) }
}

/// How much larger F_T/F_N along x and y is in the run; `None` where the companion has no normal
/// force.
fn ratio_difference(row: &StepRecord, there: &Counterpart) -> Option<[f64; 2]> {
    let difference = |here: f64, other: f64| here / row.f_n - other / there.f_n;
    (row.f_n > 0.0 && there.f_n > 0.0).then(|| [difference(row.f_t, there.f_t), difference(row.f_t_y, there.f_t_y)])
}

/// Of a vector; along x it has the bits of the component.
pub(super) fn size([along, across]: [f64; 2]) -> f64 {
    if across == 0.0 { along.abs() } else { along.hypot(across) }
}

/// The state in which a segment begins after these rows.
fn start_of(before: &[StepRecord]) -> StepRecord {
    before.last().copied().unwrap_or_default()
}

/// The place of a row in a segment that begins at `start`: a share of a press or of one that goes
/// to several targets, a length of the others.
fn place(segment: &Segment, start: &StepRecord, row: &StepRecord) -> f64 {
    let (h, delta_t) = (row.h - start.h, row.delta_t - start.delta_t);
    let share = |whole_h: f64, whole_delta: f64| {
        let square = whole_h * whole_h + whole_delta * whole_delta;
        if square > 0.0 { (h * whole_h + delta_t * whole_delta) / square } else { 1.0 }
    };
    match *segment {
        Segment::Indentation { indentation } => share(indentation - start.h, 0.0),
        Segment::Oblique { indentation, shear } => share(indentation - start.h, shear - start.delta_t),
        Segment::Motion { to, .. } => share_of(&to, start, row),
        Segment::Slip { .. } => delta_t.hypot(row.delta_t_y - start.delta_t_y),
        // After a reversal F_T goes with the way from it, wherever it was.
        Segment::Shear { .. } => delta_t.abs(),
        Segment::Release { .. } => h.abs(),
    }
}

/// The share of a motion that is behind a row: of what it moves furthest.
pub(super) fn share_of(to: &Motion, start: &StepRecord, row: &StepRecord) -> f64 {
    let part = |to: Option<f64>, start: f64, row: f64| to.map(|to| (to - start, row - start));
    let ([x, y], [about_x, about_y]) = (both(to.shear), both(to.roll));
    let angles = [
        part(about_x, start.roll_x, row.roll_x),
        part(about_y, start.roll_y, row.roll_y),
        part(to.twist, start.twist, row.twist),
    ];
    let lengths =
        [part(to.indentation, start.h, row.h), part(x, start.delta_t, row.delta_t), part(y, start.delta_t_y, row.delta_t_y)];
    // All go in proportion, so that any of one kind tells it.
    let projected = |parts: [Option<(f64, f64)>; 3]| {
        let square: f64 = parts.iter().flatten().map(|(whole, _)| whole * whole).sum();
        let product: f64 = parts.iter().flatten().map(|(whole, done)| whole * done).sum();
        (square > 0.0).then(|| product / square)
    };
    projected(lengths).or_else(|| projected(angles)).unwrap_or(1.0)
}

fn both(pair: Option<[f64; 2]>) -> [Option<f64>; 2] {
    pair.map_or([None; 2], |pair| pair.map(Some))
}

#[cfg(test)]
mod tests;
