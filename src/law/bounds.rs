//! What the numbers of a law file may be, and how one that is not is told: by its key, its value
//! and what it has to be.

use std::fmt::Display;

use serde::Serialize;
use serde_json::Value;

use super::range::Interval;

/// Whether something is as it has to be; the error begins with the key.
pub(super) type Checked = Result<(), String>;

/// From the least to the greatest value that a number may have.
#[derive(Clone, Copy, Debug)]
pub(super) struct ValueBounds {
    pub least: f64,
    pub most: f64,
}

/// Numbers that are printed and drawn, and from which nothing is computed.
pub(super) const TOLD: ValueBounds = ValueBounds { least: -1e12, most: 1e12 };

impl ValueBounds {
    /// Refuses a number beyond them, and one that is none.
    pub fn hold_one(self, key: impl Display, value: f64) -> Checked {
        let Self { least, most } = self;
        // Written so that a NaN is beyond.
        if value >= least && value <= most { Ok(()) } else { Err(format!("{key} is {value:?}, and has to be {self}")) }
    }

    /// [`hold_one`](Self::hold_one) for each number of a list.
    pub fn hold(self, key: impl Display, values: &[f64]) -> Checked {
        // A key is written for the number that is wrong alone.
        match values.iter().position(|value| self.hold_one("", *value).is_err()) {
            Some(i) => self.hold_one(format_args!("{key}[{i}]"), values[i]),
            None => Ok(()),
        }
    }

    /// Both ends of an interval, the lower one first.
    pub fn hold_interval(self, key: impl Display, range: Interval) -> Checked {
        self.hold_one(format_args!("{key}.from"), range.from)?;
        self.hold_one(format_args!("{key}.to"), range.to)?;
        if range.from <= range.to {
            return Ok(());
        }
        Err(format!("{key}.from is {:?}, and has to be {:?}, which is {key}.to, or less", range.from, range.to))
    }

    /// Every number of a part of a file.
    pub fn hold_all(self, key: &str, part: &impl Serialize) -> Checked {
        match serde_json::to_value(part) {
            Ok(value) => self.hold_value(key, &value),
            Err(error) => Err(format!("{key} cannot be read: {error}")),
        }
    }

    fn hold_value(self, key: &str, value: &Value) -> Checked {
        match value {
            Value::Number(number) => self.hold_one(key, number.as_f64().unwrap_or(f64::NAN)),
            Value::Array(values) => {
                values.iter().enumerate().try_for_each(|(i, value)| self.hold_value(&format!("{key}[{i}]"), value))
            }
            Value::Object(values) => values.iter().try_for_each(|(name, value)| self.hold_value(&format!("{key}.{name}"), value)),
            Value::Null | Value::Bool(_) | Value::String(_) => Ok(()),
        }
    }
}

impl Display for ValueBounds {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "a number from {:?} to {:?}", self.least, self.most)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_number_that_is_wrong_is_told_by_its_key() {
        let bounds = ValueBounds { least: 1.0, most: 10.0 };
        assert_eq!(bounds.hold("b", &[1.0, 2.0, 10.0]), Ok(()));
        let told = bounds.hold("b", &[1.0, 2.0, 1e308]).unwrap_err();
        assert_eq!(told, "b[2] is 1e308, and has to be a number from 1.0 to 10.0");
        assert!(bounds.hold_one("a", f64::NAN).unwrap_err().starts_with("a is NaN, "));
        assert_eq!(bounds.hold_interval("range", Interval { from: 2.0, to: 2.0 }), Ok(()));
        let told = bounds.hold_interval("range", Interval { from: 3.0, to: 2.0 }).unwrap_err();
        assert_eq!(told, "range.from is 3.0, and has to be 2.0, which is range.to, or less");
        assert!(bounds.hold_interval("range", Interval { from: 0.0, to: 2.0 }).unwrap_err().starts_with("range.from is 0.0, "));
        let part = serde_json::json!([{ "a": { "b": [2, 3.5, "x", null] } }, { "a": { "b": [2, -1] } }]);
        let told = bounds.hold_all("errors", &part).unwrap_err();
        assert_eq!(told, "errors[1].a.b[1] is -1.0, and has to be a number from 1.0 to 10.0");
    }
}
