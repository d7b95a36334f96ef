//! The curves of several runs in one diagram.

use super::super::tables::split;
use super::super::{OutputError, StepRecord};
use super::View;
use super::axes::Dimension;
use super::chart::{Axis, Chart, Line, Series, draw_chart, extent};
use super::curves::{from_zero, greatest};
use super::style::{GROUPS, Picture};
use super::text::verbatim;

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
/// shear on if every run shears, over h if one does not. `axes` are those of values that are
/// divided already.
///
/// # Errors
/// The drawing fails.
pub fn plot_overlay(runs: &[OverlaidRun<'_>], view: &View) -> Result<Picture, OutputError> {
    let sheared = runs.iter().all(|run| split(run.history).1.len() > 1);
    let shown = |run: &OverlaidRun<'_>| if sheared { split(run.history).1.to_vec() } else { run.history.to_vec() };
    let across = |record: &StepRecord| if sheared { record.delta_t } else { record.h };
    let most = |of: &dyn Fn(&StepRecord) -> f64, scale: &dyn Fn(&OverlaidRun<'_>) -> f64| {
        runs.iter().map(|run| greatest(shown(run).iter().map(of)) / scale(run)).fold(0.0, f64::max)
    };
    let words = if sheared { ("tangential displacement", "δ_T") } else { ("indentation", "h") };
    let x = view.axes.show(Dimension::Length, words.0, words.1, most(&across, &|run| run.length));
    let y =
        view.axes.show(Dimension::Force, "force", "F", most(&|record| record.f_n.abs().max(record.f_t.abs()), &|run| run.force));
    let mut series = Vec::new();
    for (run, colour) in runs.iter().zip(GROUPS.into_iter().cycle()) {
        let curve = |force: fn(&StepRecord) -> f64| {
            let point = |record: &StepRecord| (across(record) / run.length * x.factor, force(record) / run.force * y.factor);
            shown(run).iter().map(point).collect()
        };
        series.push(Series::solid(format!("F_N, {}", verbatim(run.name)), colour, curve(|record| record.f_n)));
        if sheared {
            let line = Some(Line::Dashed(7.0));
            let points = curve(|record| record.f_t);
            series.push(Series { line, ..Series::solid(format!("F_T, {}", verbatim(run.name)), colour, points) });
        }
    }
    let points = || series.iter().flat_map(|series| &series.points);
    let (low, high) = extent(points().map(|point| point.0));
    let y = from_zero(&y.label, points().map(|point| point.1));
    let title = if sheared { "Forces during the shear" } else { "Normal forces" };
    let chart = Chart { title: title.into(), x: Axis::linear(x.label, low, high), y, series, bar: None };
    // A line of the legend for each run beyond the first few.
    let size = view.sheet.chart((760, 480 + 20 * u32::try_from(runs.len()).unwrap_or(0).min(40)));
    Picture::draw("compare", "The same quantities of several runs.", size, |root| draw_chart(root, &chart))
}
