//! The rows as a table for people.

use std::fmt::Write;

use super::{Check, HeldAgainst, Verdict, VerificationReport};

/// A number with about four digits, in the notation that is shorter.
fn number(x: f64) -> String {
    match x.abs() {
        0.0 => "0".to_owned(),
        size if !(1e-3..1e5).contains(&size) => format!("{x:.3e}"),
        size => format!("{x:.*}", (3 - size.log10().floor() as i32).max(0) as usize),
    }
}

fn reference(reference: &HeldAgainst) -> String {
    match *reference {
        HeldAgainst::Value(value) => number(value),
        HeldAgainst::Range(low, f64::INFINITY) => format!(">= {}", number(low)),
        HeldAgainst::Range(f64::NEG_INFINITY, high) => format!("<= {}", number(high)),
        HeldAgainst::Nothing => "-".to_owned(),
        HeldAgainst::Range(low, high) => format!("{} to {}", number(low), number(high)),
    }
}

/// A share as a percentage, or as a power of ten where it is tiny.
fn share(x: f64) -> String {
    match x.abs() {
        size if size.is_nan() => "-".to_owned(),
        size if size > 0.0 && size < 5e-5 => format!("{x:+.1e}"),
        _ => format!("{:+.2} %", 100.0 * x),
    }
}

/// The rows under a head, in columns; each row ends with its verdict.
pub fn table(checks: &[Check]) -> String {
    let head = ["check", "what", "ours", "reference", "error", "tolerance", "verdict"].map(str::to_owned);
    let rows = checks.iter().map(|check| {
        [
            check.check.to_owned(),
            check.what.clone(),
            number(check.ours),
            reference(&check.reference),
            share(check.error()),
            check.tolerance.map_or_else(|| "-".to_owned(), |tolerance| share(tolerance).trim_start_matches('+').to_owned()),
            check.verdict().word().to_owned(),
        ]
    });
    let rows: Vec<[String; 7]> = std::iter::once(head).chain(rows).collect();
    let width: [usize; 7] = std::array::from_fn(|column| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0));
    let mut text = String::new();
    for row in &rows {
        let [check, what, ours, reference, error, tolerance, verdict] = row;
        let [a, b, c, d, e, f, _] = width;
        let _ = writeln!(text, "{check:a$}  {what:b$}  {ours:>c$}  {reference:>d$}  {error:>e$}  {tolerance:>f$}  {verdict}");
    }
    text
}

/// Why each tolerance is what it is, a line a row.
pub fn reasons(checks: &[Check]) -> String {
    let mut text = String::new();
    for check in checks {
        let _ = writeln!(text, "{}, {}: {}", check.check, check.what, check.because);
    }
    text
}

/// The verdict on all rows in a line.
pub fn summary(report: &VerificationReport) -> String {
    let [pass, fail, information] = [Verdict::Pass, Verdict::Fail, Verdict::Information].map(|verdict| report.count(verdict));
    let VerificationReport { device, precision, wall_s, .. } = report;
    format!("{pass} passed, {fail} failed, {information} for information, in {wall_s:.0} s on {device}, {precision}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_four_digits() {
        for (x, text) in [
            (0.0, "0"),
            (0.2948, "0.2948"),
            (148.84, "148.8"),
            (1.6128, "1.613"),
            (99999.0, "99999"),
            (0.00096, "9.600e-4"),
            (-5787.2, "-5787"),
            (f64::NAN, "NaN"),
        ] {
            assert_eq!(number(x), text);
        }
    }

    #[test]
    fn shares_are_percent_unless_tiny() {
        for (x, text) in [(0.0123, "+1.23 %"), (-0.5, "-50.00 %"), (0.0, "+0.00 %"), (1e-6, "+1.0e-6"), (f64::NAN, "-")] {
            assert_eq!(share(x), text);
        }
    }

    #[test]
    fn columns_are_aligned_and_rows_end_with_the_verdict() {
        let checks = [
            Check::relative("hertz", "F_N", 1.005, 1.0, 0.01, ""),
            Check::range("models", "a longer text", 5.0, [1.0, 2.0], 0.01, ""),
            Check::range("energy", "x", 5.0, [f64::NEG_INFINITY, 2.0], 0.01, ""),
            Check::information("equator", "c", 7.0, ""),
        ];
        let text = table(&checks);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 5);
        let verdicts: Vec<&str> = lines.iter().map(|line| line.rsplit("  ").next().unwrap_or("")).collect();
        assert_eq!(verdicts, ["verdict", "pass", "FAIL", "FAIL", "-"]);
        let starts = |word: &str, line: usize| lines[line].find(word);
        assert_eq!(starts("F_N", 1), starts("a longer text", 2));
        assert!(lines[1].contains("+0.50 %") && lines[1].contains("1.00 %"));
        assert!(lines[2].contains("1.000 to 2.000") && lines[3].contains("<= 2.000"));
    }
}
