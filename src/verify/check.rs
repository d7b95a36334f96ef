//! One row of the table: what was computed, what it should be, and the verdict.

use serde::{Serialize, Serializer};

/// What a computed number is held against.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum HeldAgainst {
    /// A value.
    Value(f64),
    /// Anywhere from the first number to the second; an infinite end is open.
    Range(#[serde(serialize_with = "finite")] f64, #[serde(serialize_with = "finite")] f64),
    /// Nothing: the number is reported for itself.
    Nothing,
}

/// JSON has no infinity: an open end is null.
fn finite<S: Serializer>(x: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    x.is_finite().then_some(x).serialize(serializer)
}

/// What an error is measured by.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Scale {
    /// By the reference itself.
    Relative,
    /// By this amount: 1 where the compared number is a ratio already.
    By(f64),
}

/// What a row says in the end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// The error is within the tolerance.
    Pass,
    /// It is not, or is not a number.
    Fail,
    /// There is no tolerance: the number is reported, not judged.
    Information,
}

impl Verdict {
    /// As the table shows it.
    pub fn word(self) -> &'static str {
        match self {
            Self::Pass => "pass",
            Self::Fail => "FAIL",
            Self::Information => "-",
        }
    }
}

/// One comparison.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Check {
    /// The family, in a word: `hertz`.
    pub check: &'static str,
    /// What is compared, with its unit where it has one.
    pub what: String,
    /// The computed number.
    pub ours: f64,
    /// What it is held against.
    pub reference: HeldAgainst,
    /// What the error is measured by.
    pub scale: Scale,
    /// Largest error that passes; `None`: reported without a verdict.
    pub tolerance: Option<f64>,
    /// Why the tolerance is what it is, or what the number is good for; one line.
    pub because: &'static str,
}

impl Check {
    /// A number that should have the value `reference`, up to the relative error `tolerance`.
    pub fn relative(
        check: &'static str,
        what: impl Into<String>,
        ours: f64,
        reference: f64,
        tolerance: f64,
        because: &'static str,
    ) -> Self {
        let (reference, scale) = (HeldAgainst::Value(reference), Scale::Relative);
        Self { check, what: what.into(), ours, reference, scale, tolerance: Some(tolerance), because }
    }

    /// The same row with its error measured by `amount` instead of by the reference.
    pub fn by(self, amount: f64) -> Self {
        Self { scale: Scale::By(amount), ..self }
    }

    /// A number that should lie between `low` and `high`; beyond either end it may be off by
    /// `tolerance` times that end.
    pub fn range(
        check: &'static str,
        what: impl Into<String>,
        ours: f64,
        [low, high]: [f64; 2],
        tolerance: f64,
        because: &'static str,
    ) -> Self {
        let (reference, scale) = (HeldAgainst::Range(low, high), Scale::Relative);
        Self { check, what: what.into(), ours, reference, scale, tolerance: Some(tolerance), because }
    }

    /// A number that is reported for itself.
    pub fn information(check: &'static str, what: impl Into<String>, ours: f64, because: &'static str) -> Self {
        Self { check, what: what.into(), ours, reference: HeldAgainst::Nothing, scale: Scale::By(1.0), tolerance: None, because }
    }

    /// The same row without a verdict.
    pub fn without_verdict(self) -> Self {
        Self { tolerance: None, ..self }
    }

    /// Signed error: of a value its difference, of a range the distance to the nearest end (zero
    /// inside), over the scale.
    pub fn error(&self) -> f64 {
        let (difference, end) = match self.reference {
            HeldAgainst::Value(value) => (self.ours - value, value),
            HeldAgainst::Range(low, _) if self.ours < low => (self.ours - low, low),
            HeldAgainst::Range(_, high) if self.ours > high => (self.ours - high, high),
            HeldAgainst::Range(..) if self.ours.is_nan() => (f64::NAN, 1.0),
            HeldAgainst::Range(..) => return 0.0,
            HeldAgainst::Nothing => return f64::NAN,
        };
        match self.scale {
            Scale::Relative => difference / end.abs(),
            Scale::By(amount) => difference / amount.abs(),
        }
    }

    /// What the row says. An error that is not a number fails.
    pub fn verdict(&self) -> Verdict {
        match self.tolerance {
            None => Verdict::Information,
            Some(tolerance) if self.error().abs() <= tolerance => Verdict::Pass,
            Some(_) => Verdict::Fail,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(ours: f64, reference: f64) -> Check {
        Check::relative("test", "x", ours, reference, 0.01, "")
    }

    #[test]
    fn within_the_tolerance_on_either_side() {
        assert_eq!(value(100.9, 100.0).verdict(), Verdict::Pass);
        assert_eq!(value(99.1, 100.0).verdict(), Verdict::Pass);
        assert!((value(99.1, 100.0).error() + 0.009).abs() < 1e-12);
        assert!((value(-99.1, -100.0).error() - 0.009).abs() < 1e-12);
        assert_eq!(value(0.105, 0.1).by(1.0).verdict(), Verdict::Pass);
    }

    #[test]
    fn a_wrong_reference_fails() {
        for wrong in [101.1, 98.9, -100.0, 0.0, f64::NAN, f64::INFINITY] {
            assert_eq!(value(100.0, wrong).verdict(), Verdict::Fail, "{wrong}");
        }
        assert_eq!(value(f64::NAN, 100.0).verdict(), Verdict::Fail);
    }

    #[test]
    fn ranges_are_open_where_infinite() {
        let range = |ours: f64, ends: [f64; 2]| Check::range("test", "x", ours, ends, 0.1, "").verdict();
        assert_eq!(range(0.3, [0.28, 0.32]), Verdict::Pass);
        assert_eq!(range(0.255, [0.28, 0.32]), Verdict::Pass);
        assert_eq!(range(0.25, [0.28, 0.32]), Verdict::Fail);
        assert_eq!(range(0.36, [0.28, 0.32]), Verdict::Fail);
        assert_eq!(range(1e9, [0.28, f64::INFINITY]), Verdict::Pass);
        assert_eq!(range(f64::NAN, [0.28, f64::INFINITY]), Verdict::Fail);
    }

    #[test]
    fn information_is_not_judged() {
        assert_eq!(value(7.0, 100.0).without_verdict().verdict(), Verdict::Information);
        assert_eq!(Check::information("test", "x", 7.0, "").verdict(), Verdict::Information);
    }
}
