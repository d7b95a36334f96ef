//! The rows as a table for people.

use std::fmt::Write;

use super::{Check, Reference};

/// A number with about four digits, in the notation that is shorter.
fn number(x: f64) -> String {
    match x.abs() {
        0.0 => "0".to_owned(),
        size if !(1e-3..1e5).contains(&size) => format!("{x:.3e}"),
        size => format!("{x:.*}", (3 - size.log10().floor() as i32).max(0) as usize),
    }
}

fn reference(reference: &Reference) -> String {
    match *reference {
        Reference::Value(value) => number(value),
        Reference::Range(low, f64::INFINITY) => format!(">= {}", number(low)),
        Reference::Range(f64::NEG_INFINITY, high) => format!("<= {}", number(high)),
        Reference::Nothing => "-".to_owned(),
        Reference::Range(low, high) => format!("{} to {}", number(low), number(high)),
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

/// The table, with its head and an empty line's worth of nothing after it; each row ends with its verdict.
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
