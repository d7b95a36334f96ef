//! All rows of a verification with what they were computed on.

use serde::Serialize;

use super::{Check, FamilyReport, Fineness, Runner, Verdict};

/// The result of a verification.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct VerificationReport {
    /// Version of the program.
    pub version: &'static str,
    /// How finely the cases were meshed.
    pub level: Fineness,
    /// Device of the last case.
    pub device: String,
    /// Precision of its residual.
    pub precision: String,
    /// Wall time of all families in seconds.
    pub wall_s: f64,
    /// The rows.
    #[serde(serialize_with = "rows")]
    pub checks: Vec<Check>,
}

/// A row as JSON has it: with its error and verdict.
#[derive(Serialize)]
struct CheckRow<'a> {
    #[serde(flatten)]
    check: &'a Check,
    error: f64,
    verdict: Verdict,
}

fn rows<S: serde::Serializer>(checks: &[Check], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(checks.iter().map(|check| CheckRow { check, error: check.error(), verdict: check.verdict() }))
}

impl VerificationReport {
    /// Appends a family.
    pub fn add(&mut self, family: FamilyReport) {
        self.wall_s += family.took.as_secs_f64();
        self.checks.extend(family.checks);
    }

    /// Notes where and how the rows were computed.
    pub fn computed_on(&mut self, runner: &Runner<'_>) {
        self.version = env!("CARGO_PKG_VERSION");
        self.level = runner.level;
        if let Some(description) = runner.computed_on() {
            (self.device, self.precision) = (description.device.clone(), description.precision.to_owned());
        }
    }

    /// Rows of one verdict.
    pub fn count(&self, verdict: Verdict) -> usize {
        self.checks.iter().filter(|check| check.verdict() == verdict).count()
    }

    /// Whether no row failed.
    pub fn passed(&self) -> bool {
        self.count(Verdict::Fail) == 0
    }

    /// The report as indented JSON with an end of line; what is not a number is null.
    pub fn to_json(&self) -> String {
        // Plain numbers, words and lists: nothing that could fail.
        serde_json::to_string_pretty(self).unwrap_or_default() + "\n"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report(wrong: f64) -> VerificationReport {
        let good = Check::relative("hertz", "F_N", 1.001, 1.0, 0.01, "because");
        let other = Check::range("models", "c^2", 2.0, [1.0, f64::INFINITY], 0.0, "");
        let info = Check::information("equator", "c", 7.0, "");
        let suspect = Check::relative("hertz", "a", 1.0, wrong, 0.01, "");
        VerificationReport { checks: vec![good, other, info, suspect], ..VerificationReport::default() }
    }

    #[test]
    fn one_wrong_reference_fails_the_whole() {
        assert!(report(1.0).passed());
        for wrong in [1.1, f64::NAN] {
            let report = report(wrong);
            assert!(!report.passed());
            assert_eq!([Verdict::Pass, Verdict::Fail, Verdict::Information].map(|verdict| report.count(verdict)), [2, 1, 1]);
        }
    }

    #[test]
    fn json_holds_error_verdict_and_reason() {
        let json: serde_json::Value = serde_json::from_str(&report(f64::NAN).to_json()).unwrap();
        let rows = json["checks"].as_array().unwrap();
        assert_eq!(rows.len(), 4);
        assert!((rows[0]["error"].as_f64().unwrap() - 1e-3).abs() < 1e-12);
        assert_eq!((rows[0]["verdict"].as_str(), rows[0]["because"].as_str()), (Some("pass"), Some("because")));
        assert_eq!(rows[1]["reference"][0], 1.0);
        assert!(rows[1]["reference"][1].is_null());
        assert_eq!(rows[2]["verdict"], "information");
        assert_eq!(rows[3]["verdict"], "fail");
    }
}
