//! Where a law holds, and what of a contact lies outside.

use serde::{Deserialize, Serialize};

use super::LawError;
use crate::case::Case;

/// A closed interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Interval {
    /// Lower end.
    pub from: f64,
    /// Upper end.
    pub to: f64,
}

impl Interval {
    /// The smallest one that holds all values; `None` for no values.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        values.into_iter().fold(None, |interval: Option<Self>, x| {
            Some(interval.map_or(Self { from: x, to: x }, |i| Self { from: i.from.min(x), to: i.to.max(x) }))
        })
    }

    /// Whether `x` lies in it, to a share `margin` of the ends.
    pub fn contains(&self, x: f64, margin: f64) -> bool {
        x >= self.from - margin * self.from.abs() && x <= self.to + margin * self.to.abs()
    }
}

/// A quantity of a contact that lies outside of what the law was fitted to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutOfRange {
    /// Its name.
    pub quantity: &'static str,
    /// Its value.
    pub value: f64,
    /// Where the law holds.
    pub range: Interval,
}

impl std::fmt::Display for OutOfRange {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { quantity, value, range } = self;
        write!(f, "{quantity} = {value:.4} is outside of {:.4} to {:.4}", range.from, range.to)
    }
}

/// Refuses a case whose equator is free: laws for many contacts are of clamped ones.
///
/// # Errors
/// [`LawError::NotCovered`].
pub fn clamped(case: &Case) -> Result<(), LawError> {
    if case.sphere.equator.is_clamped() {
        return Ok(());
    }
    Err(LawError::NotCovered {
        problem: "the case has sphere.equator = \"free\", and the law is of contacts with a clamped equator",
        remedy: "Leave sphere.equator out, or tabulate the case with `asperity law tabulate`",
    })
}

/// Share of an end by which a quantity may pass it before it is called outside.
pub(super) const MARGIN: f64 = 0.02;
