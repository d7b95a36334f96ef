//! What share of its path a run has behind it: for a bar, not for science.

use super::StepRecord;
use super::limit::share_of;
use crate::case::{Segment, ShearTarget};
use crate::simulation::path::SHEAR_GROWTH;

/// Follows a path, in the units of the records that it is shown.
#[derive(Clone, Debug)]
pub struct PathShare {
    path: Vec<Segment>,
    /// The last record of the segment before, and the segment that is followed.
    start: StepRecord,
    segment: usize,
    last: StepRecord,
    share: f64,
}

/// F_T/(mu F_N) is 1 - (c/a)^3 where points within c stick (Cattaneo 1938): where full slip comes
/// is not known before, how much still sticks is.
const STICK_POWER: i32 = 3;
/// What is told of such a segment at the most: where it ends is known at its end.
const NEARLY: f64 = 0.99;

impl PathShare {
    /// At the start of a path.
    pub fn new(path: &[Segment]) -> Self {
        let start = StepRecord::default();
        Self { path: path.to_vec(), start, segment: 0, last: start, share: 0.0 }
    }

    /// Number of segments.
    pub fn segments(&self) -> usize {
        self.path.len()
    }

    /// The share after an accepted step, 0 to 1; never falls.
    pub fn after(&mut self, record: &StepRecord) -> f64 {
        if record.segment != self.segment {
            (self.segment, self.start) = (record.segment, self.last);
        }
        self.last = *record;
        let within = self.path.get(self.segment).map_or(0.0, |segment| self.within(segment, record));
        let within = if within.is_finite() { within.clamp(0.0, 1.0) } else { 0.0 };
        self.share = self.share.max((self.segment as f64 + within) / self.path.len().max(1) as f64);
        self.share
    }

    fn within(&self, segment: &Segment, record: &StepRecord) -> f64 {
        let part = |from: f64, now: f64, to: f64| if from == to { 1.0 } else { (now - from) / (to - from) };
        match *segment {
            // All but the first steps are equal.
            Segment::Indentation { indentation } | Segment::Oblique { indentation, .. } => {
                part(self.start.h, record.h, indentation)
            }
            Segment::Release { share } => part(self.start.f_n, record.f_n, share * self.start.f_n),
            Segment::Shear { shear: ShearTarget::Displacement(target), .. } => {
                // Increments grow as a power of their number: the number, as this power of the way.
                part(self.start.delta_t, record.delta_t, target).max(0.0).powf(1.0 / (1.0 + SHEAR_GROWTH))
            }
            Segment::Motion { to, .. } => share_of(&to, &self.start, record),
            Segment::Shear { shear: ShearTarget::FullSlip, .. } | Segment::Slip { .. } => {
                (1.0 - (record.stick_radius / record.a).powi(STICK_POWER)).min(NEARLY)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::Hold;

    #[test]
    fn rises_from_0_to_1_over_every_kind_of_segment() {
        let shear = |shear| Segment::Shear { shear, hold: Hold::Indentation };
        let path = [
            Segment::Indentation { indentation: 0.04 },
            shear(ShearTarget::FullSlip),
            shear(ShearTarget::Displacement(-1.0)),
            Segment::Indentation { indentation: 0.03 },
            Segment::Release { share: 0.5 },
            Segment::Release { share: 0.0 },
            Segment::Oblique { indentation: 0.02, shear: 0.0 },
        ];
        let record = |segment, h, delta_t, f_n| {
            // The further it is sheared, the less sticks.
            StepRecord { segment, h, delta_t, f_n, a: 1.0, stick_radius: 1.0 - delta_t.abs(), ..StepRecord::default() }
        };
        let mut share = PathShare::new(&path);
        assert_eq!(share.segments(), 7);
        let mut last = 0.0;
        for (record, expected) in [
            (record(0, 0.01, 0.0, 5.0), Some(0.25 / 7.0)),
            (record(0, 0.04, 0.0, 10.0), Some(1.0 / 7.0)),
            (record(1, 0.04, 0.1, 10.0), Some((2.0 - 0.9f64.powi(3)) / 7.0)),
            (record(1, 0.04, 0.5, 10.0), Some(1.875 / 7.0)),
            (record(2, 0.04, 0.2, 10.0), None),
            (record(2, 0.04, -1.0, 10.0), Some(3.0 / 7.0)),
            (record(3, 0.03, -1.0, 4.0), Some(4.0 / 7.0)),
            (record(4, 0.02, -1.0, 3.0), Some(4.5 / 7.0)),
            (record(4, 0.02, -1.0, 2.0), Some(5.0 / 7.0)),
            (record(5, 0.01, -1.0, 0.0), Some(6.0 / 7.0)),
            (record(6, 0.02, 0.0, 3.0), Some(1.0)),
        ] {
            let now = share.after(&record);
            assert!(now >= last && now <= 1.0, "{now} after {last}");
            if let Some(expected) = expected {
                assert!((now - expected).abs() < 1e-12, "{now} instead of {expected}");
            }
            last = now;
        }
    }
}
