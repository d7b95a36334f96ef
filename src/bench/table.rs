//! The numbers as one table for people: each line an evaluation at a batch size, the device beside
//! one core and all cores.

use std::fmt::Write;

use super::report::{Header, Measurement, On, RateRow, RatesReport};

/// Columns of a place: its time, rate, operations and share of a copy.
const HEAD: [&str; 17] = [
    "evaluation",
    "law",
    "real",
    "batch",
    "items",
    "device ms (min-max)",
    "first ms",
    "kernels ms",
    "M/s",
    "Gop/s",
    "copy",
    "1 core ms (min-max)",
    "M/s",
    "Gop/s",
    "copy",
    "all cores ms (min-max)",
    "M/s",
];
const MORE: [&str; 3] = ["copy", "x 1 core", "x all, kernels"];

/// The header, the table and what did not fit.
pub fn table(report: &RatesReport) -> String {
    let mut text = header(&report.header);
    for setup in &report.setups {
        let _ = writeln!(
            text,
            "set-up on the device, {}, {}, batch of {}: {} ms",
            setup.evaluation,
            setup.precision,
            setup.batch,
            number(setup.ms)
        );
    }
    let mut lines: Vec<Vec<String>> = vec![HEAD.iter().chain(&MORE).map(|&h| h.to_owned()).collect()];
    let mut skipped: Vec<String> = Vec::new();
    let mut rows = report.rows.iter().peekable();
    while let Some(first) = rows.peek().copied() {
        let same = |r: &&RateRow| {
            (r.evaluation, r.law, r.precision, r.batch) == (first.evaluation, first.law, first.precision, first.batch)
        };
        // The places of an evaluation stand together for the return mapping, one place after the
        // other for the rest.
        let group: Vec<&RateRow> = report.rows.iter().filter(same).collect();
        if group.first().is_some_and(|r| std::ptr::eq(*r, first)) {
            lines.push(line(&group));
            skipped.extend(group.iter().filter_map(|row| match &row.outcome {
                Measurement::Skipped(reason) => {
                    Some(format!("{}, {}, {}, batch of {}: {reason}", row.evaluation, row.law, row.precision, row.batch))
                }
                Measurement::Measured(_) => None,
            }));
        }
        rows.next();
    }
    text.push('\n');
    align(&mut text, &lines, 3);
    skipped.dedup();
    if !skipped.is_empty() {
        let _ = writeln!(text, "\nNot measured:\n{}", skipped.join("\n"));
    }
    text
}

/// Appends lines of cells, the first the head, as a table whose first columns are words.
pub(super) fn align(text: &mut String, lines: &[Vec<String>], words: usize) {
    let columns = lines.first().map_or(0, Vec::len);
    let width: Vec<usize> = (0..columns).map(|c| lines.iter().map(|l| l[c].chars().count()).max().unwrap_or(0)).collect();
    for (i, line) in lines.iter().enumerate() {
        let cells: Vec<String> = line
            .iter()
            .zip(&width)
            .enumerate()
            .map(|(c, (cell, &w))| if c < words { format!("{cell:w$}") } else { format!("{cell:>w$}") })
            .collect();
        let _ = writeln!(text, "| {} |", cells.join(" | "));
        if i == 0 {
            let rule = |(c, w): (usize, &usize)| if c < words { "-".repeat(w + 2) } else { format!("{}:", "-".repeat(w + 1)) };
            let _ = writeln!(text, "|{}|", width.iter().enumerate().map(rule).collect::<Vec<_>>().join("|"));
        }
    }
}

fn header(h: &Header) -> String {
    let mut text = String::new();
    let gb = |rate: f64| format!("{} GB/s", number(1e-9 * rate));
    let _ = writeln!(text, "asperity {} bench, {}", h.version, h.date);
    let _ = writeln!(text, "{}", h.device_line());
    if let Some(a) = &h.adapter {
        let _ = writeln!(
            text,
            "features: {}; memory budget {:.0} MiB (ASPERITY_GPU_MEMORY)",
            a.features.join(", "),
            a.memory_budget_mib
        );
    }
    let _ = writeln!(text, "processor: {}, {} threads in the rows of all cores", h.processor, h.threads);
    let _ = writeln!(
        text,
        "mesh: {} elements along the contact radius; return mapping: {} points a case",
        h.elements_per_contact_radius, h.points_per_case
    );
    let c = &h.copy;
    let _ = write!(text, "copies of {} MiB: one core {}, all cores {}", c.length >> 20, gb(c.one_core), gb(c.all_cores));
    if let (Some(device), Some(to), Some(from)) = (c.device, c.to_device, c.from_device) {
        let _ = write!(text, ", on the device {}, to it {}, from it {}", gb(device), gb(to), gb(from));
    }
    let _ = writeln!(text, "\ncounted: {}", h.counted);
    let _ = writeln!(
        text,
        "times are medians on the wall in ms, the first call apart; M/s are million items (points, elements, contact points) a second of the call; copy is \
         the share of the rate of a copy there (beyond 100 %: from caches); x 1 core is how much faster the device's call is than one core, x all, \
         kernels how much faster its kernels alone are than all cores"
    );
    text
}

/// An evaluation in all its places.
fn line(group: &[&RateRow]) -> Vec<String> {
    let first = group[0];
    let find = |on: On| group.iter().find(|row| row.on == on).copied();
    let measured = |on: On| find(on).and_then(RateRow::measured);
    let nothing = |on: On| if find(on).is_some() { "does not fit" } else { "-" }.to_owned();
    let show = |on: On, f: &dyn Fn(&super::report::MeasuredRates) -> String| measured(on).map_or_else(|| "-".to_owned(), f);
    let time = |on: On| {
        measured(on).map_or_else(
            || nothing(on),
            |m| format!("{} ({}-{})", number(m.call.median_ms), number(m.call.min_ms), number(m.call.max_ms)),
        )
    };
    let rate = |on: On| show(on, &|m| number(1e-6 * m.items_per_s));
    let share = |on: On| show(on, &|m| format!("{} %", number(100.0 * m.share_of_copy)));
    let operations = |on: On| show(on, &|m| number(1e-9 * m.operations_per_s));
    let ratio = |ours: Option<f64>, theirs: Option<f64>| match (ours, theirs) {
        (Some(ours), Some(theirs)) => number(theirs / ours),
        _ => "-".to_owned(),
    };
    let call = |on: On| measured(on).map(|m| m.call.median_ms);
    let kernels = measured(On::Device).and_then(|m| m.kernels_ms);
    vec![
        first.evaluation.to_owned(),
        first.law.to_owned(),
        first.precision.to_owned(),
        first.batch.to_string(),
        first.items.to_string(),
        time(On::Device),
        show(On::Device, &|m| number(m.call.first_ms)),
        kernels.map_or_else(|| "-".to_owned(), number),
        rate(On::Device),
        operations(On::Device),
        share(On::Device),
        time(On::OneCore),
        rate(On::OneCore),
        operations(On::OneCore),
        share(On::OneCore),
        time(On::AllCores),
        rate(On::AllCores),
        share(On::AllCores),
        ratio(call(On::Device), call(On::OneCore)),
        ratio(kernels, call(On::AllCores)),
    ]
}

/// Three digits.
pub(super) fn number(x: f64) -> String {
    match x.abs() {
        size if !x.is_finite() || size == 0.0 => format!("{x}"),
        size if size < 1e-3 => format!("{x:.1e}"),
        size => format!("{x:.*}", (2 - size.log10().floor() as i32).max(0) as usize),
    }
}
