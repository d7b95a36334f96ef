//! The curves of several runs in one diagram.

use super::super::tables::split;
use super::super::{OutputError, StepRecord};
use super::chart::{Axis, Chart, Line, Series, draw_chart, extent};
use super::curves::from_zero;
use super::style::{GROUPS, Picture};

/// A run beside others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OverlaidRun<'a> {
    /// Its entry in the legend.
    pub name: &'a str,
    /// Its steps.
    pub history: &'a [StepRecord],
    /// What lengths are divided by.
    pub length: f64,
    /// What forces are divided by.
    pub force: f64,
}

/// F_N (solid) and F_T (dashed) of each run in a colour of its own: over delta_T from the first
/// shear on if every run shears, over h if one does not. `units` are those of length and force.
///
/// # Errors
/// The drawing fails.
pub fn plot_overlay(runs: &[OverlaidRun<'_>], units: [&str; 2]) -> Result<Picture, OutputError> {
    let sheared = runs.iter().all(|run| split(run.history).1.len() > 1);
    let mut series = Vec::new();
    for (run, colour) in runs.iter().zip(GROUPS.into_iter().cycle()) {
        let shown = if sheared { split(run.history).1 } else { run.history };
        let curve = |force: fn(&StepRecord) -> f64| {
            let x = |record: &StepRecord| if sheared { record.delta_t } else { record.h };
            shown.iter().map(|record| (x(record) / run.length, force(record) / run.force)).collect()
        };
        series.push(Series::solid(format!("F_N, {}", run.name), colour, curve(|record| record.f_n)));
        if sheared {
            let line = Some(Line::Dashed(7.0));
            let points = curve(|record| record.f_t);
            series.push(Series { line, ..Series::solid(format!("F_T, {}", run.name), colour, points) });
        }
    }
    let points = || series.iter().flat_map(|series| &series.points);
    let (low, high) = extent(points().map(|point| point.0));
    let y = from_zero(&format!("force ({})", units[1]), points().map(|point| point.1));
    let x_label = if sheared { "tangential displacement δ_T" } else { "indentation h" };
    let title = if sheared { "Forces during the shear" } else { "Normal forces" };
    let x = Axis::linear(format!("{x_label} ({})", units[0]), low, high);
    let chart = Chart { title: title.into(), x, y, series, bar: None };
    // A line of the legend for each run beyond the first few.
    let height = 480 + 20 * u32::try_from(runs.len()).unwrap_or(0).min(40);
    Picture::draw("compare", "The same quantities of several runs.", (760, height), |root| draw_chart(root, &chart))
}
