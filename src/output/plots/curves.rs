//! Forces, ratio and stick radius over the displacements.

use super::super::tables::split;
use super::super::{OutputError, StepRecord};
use super::axes::{Axes, Dimension, Shown};
use super::chart::{Axis, Chart, Line, Mark, Series, draw_chart, extent};
use super::segments::{SegmentColours, SegmentSteps, segments};
use super::style::{BLUE, GREY, INK, Picture, TEAL, VERMILION, tick};
use super::{PlotInputs, View};
use crate::analytical::hertz;
use crate::analytical::olsson_larsson::OlssonLarsson;

const SIZE: (u32, u32) = (760, 480);
/// Points of an analytical curve.
const CURVE_POINTS: usize = 120;

/// The vertical axis over some values and zero, with room above and below.
pub fn from_zero(label: &str, values: impl IntoIterator<Item = f64>) -> Axis {
    let (low, high) = extent(values.into_iter().chain([0.0]));
    let room = 0.06 * (high - low);
    Axis::linear(label, if low < 0.0 { low - room } else { 0.0 }, if high > 0.0 { high + room } else { 0.0 })
}

/// Greatest magnitude of some values.
pub fn greatest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().filter(|value| value.is_finite()).fold(0.0, |most: f64, value| most.max(value.abs()))
}

/// The axis of delta_T over some steps.
pub(super) fn shear_axis(axes: &Axes, steps: &[StepRecord]) -> Shown {
    axes.show(Dimension::Length, "tangential displacement", "δ_T", greatest(steps.iter().map(|step| step.delta_t)))
}

/// A diagram over delta_T, x from the points and y from zero.
fn over_shear(title: &str, [x, y]: [&Shown; 2], series: Vec<Series>) -> Chart {
    let points = || series.iter().flat_map(|series| &series.points);
    let (low, high) = extent(points().map(|point| point.0));
    // What happens at either end, as unloading, should not hide in the frame.
    let room = if low < 0.0 && high > 0.0 { 0.03 * (high - low) } else { 0.0 };
    let (low, high) = (low - room, high + room);
    let y = from_zero(&y.label, points().map(|point| point.1));
    Chart { title: title.into(), x: Axis::linear(&x.label, low, high), y, series, bar: None }
}

/// The segments of the steps from the first shear on.
fn sheared(history: &[StepRecord]) -> Vec<SegmentSteps<'_>> {
    let from = split(history).1;
    // The starting step belongs to the segment before.
    segments(from).into_iter().filter(|segment| segment.steps.len() > 1).collect()
}

/// An entry of the legend for each segment, where there are several that are told apart by name.
fn segment_entries(all: &[SegmentSteps<'_>], colours: &SegmentColours) -> Vec<Series> {
    if all.len() < 2 || colours.bar.is_some() {
        return Vec::new();
    }
    let entry = |segment: &SegmentSteps<'_>| Series {
        line: Some(Line::Solid(6.0)),
        ..Series::solid(segment.label(), colours.colour(segment), Vec::new())
    };
    all.iter().map(entry).collect()
}

/// A directed curve a segment in its colour. Steps are marked where there are few segments.
fn by_segment(
    all: &[SegmentSteps<'_>],
    colours: &SegmentColours,
    line: Line,
    mark: Mark,
    point: impl Fn(&StepRecord) -> Option<(f64, f64)>,
) -> Vec<Series> {
    let curve = |segment: &SegmentSteps<'_>| {
        let points = segment.steps.iter().filter_map(&point).collect();
        let series = Series { line: Some(line), ..Series::solid("", colours.colour(segment), points) }.directed();
        let moves = series.points.iter().any(|point| point.0 != series.points[0].0);
        if all.len() < 3 && moves { series.marked(mark) } else { series }
    };
    all.iter().map(curve).collect()
}

/// F_N and F_T over delta_T, from the first shear on: a colour a force, or a colour a segment where
/// there are several.
pub fn plot_forces(history: &[StepRecord], view: &View) -> Result<Picture, OutputError> {
    let all = sheared(history);
    let shear = split(history).1;
    let x = shear_axis(&view.axes, shear);
    let most = greatest(shear.iter().flat_map(|step| [step.f_n, step.f_t]));
    let y = view.axes.show(Dimension::Force, "force", "F", most);
    let curves = [
        ("F_N, normal", BLUE, Line::Solid(2.0), Mark::Dot, (|step| step.f_n) as fn(&StepRecord) -> f64),
        ("F_T, tangential", VERMILION, Line::Dashed(6.0), Mark::Ring, |step| step.f_t),
    ];
    let colours = SegmentColours::of(&all);
    let mut series = Vec::new();
    for (label, colour, line, mark, force) in curves {
        let point = |step: &StepRecord| (step.delta_t * x.factor, force(step) * y.factor);
        if all.len() < 2 {
            series.push(Series::solid(label, colour, shear.iter().map(point).collect()).marked(mark).directed());
        } else {
            let sample = Series { line: Some(line), ..Series::solid(label, INK, Vec::new()) };
            series.push(if all.len() < 3 { sample.marked(mark) } else { sample });
            series.extend(by_segment(&all, &colours, line, mark, |step| Some(point(step))));
        }
    }
    series.extend(segment_entries(&all, &colours));
    let chart = Chart { bar: colours.bar, ..over_shear("Forces during the shear", [&x, &y], series) };
    let caption = "Forces on the whole sphere over the tangential displacement, from the first shear on. Arrows show the order of the steps.";
    Picture::draw("forces", caption, view.sheet.chart(SIZE), |root| draw_chart(root, &chart))
}

/// F_T/F_N over delta_T, from the first shear on, with mu as a line to run up to.
pub fn plot_ratio(history: &[StepRecord], friction: Option<f64>, view: &View) -> Result<Picture, OutputError> {
    let all = sheared(history);
    let x = shear_axis(&view.axes, split(history).1);
    let point = |step: &StepRecord| (step.f_n > 0.0).then(|| (step.delta_t * x.factor, step.f_t / step.f_n));
    let points: Vec<(f64, f64)> = split(history).1.iter().filter_map(point).collect();
    let (low, high) = extent(points.iter().map(|point| point.0));
    let colours = SegmentColours::of(&all);
    let mut series = by_segment(&all, &colours, Line::Solid(2.0), Mark::Dot, point);
    for sign in [1.0, -1.0] {
        // Rounding is no friction: a shear to the right needs no room for -mu.
        let reached = |mu: f64| points.iter().any(|point| point.1 * sign > 0.05 * mu);
        if let Some(mu) = friction.filter(|&mu| reached(mu)) {
            let label = if sign > 0.0 { format!("μ = {}", tick(mu)) } else { format!("−μ = −{}", tick(mu)) };
            series.push(Series::dashed(label, INK, 6.0, vec![(low, sign * mu), (high, sign * mu)]));
        }
    }
    series.extend(segment_entries(&all, &colours));
    let chart = Chart { bar: colours.bar, ..over_shear("Friction used", [&x, &Shown::plain("F_T / F_N")], series) };
    let caption = "Share of the normal force that friction takes; it runs up to μ.";
    Picture::draw("ratio", caption, view.sheet.chart(SIZE), |root| draw_chart(root, &chart))
}

/// Stick radius over delta_T, as a share of the contact radius, from the first shear on, with
/// Cattaneo and Mindlin's at the same F_T/F_N.
pub fn plot_stick(history: &[StepRecord], friction: Option<f64>, view: &View) -> Result<Picture, OutputError> {
    let all = sheared(history);
    let x = shear_axis(&view.axes, split(history).1);
    let loaded = |step: &StepRecord| step.f_n > 0.0 && step.a > 0.0;
    let colours = SegmentColours::of(&all);
    let ours = |step: &StepRecord| loaded(step).then(|| (step.delta_t * x.factor, step.stick_radius / step.a));
    let mut series = by_segment(&all, &colours, Line::Solid(2.0), Mark::Dot, ours);
    if all.len() < 2 {
        series.iter_mut().for_each(|curve| "simulation".clone_into(&mut curve.label));
    }
    if let Some(mu) = friction.filter(|&mu| mu > 0.0) {
        let share = |step: &StepRecord| (1.0 - step.f_t.abs() / (mu * step.f_n)).max(0.0).cbrt();
        // The formula is for the first loading.
        let first = all.first().map_or(&[][..], |segment| segment.steps);
        let points = first.iter().filter(|step| loaded(step)).map(|step| (step.delta_t * x.factor, share(step))).collect();
        series.push(Series::dashed("∛(1 − F_T/μF_N), Cattaneo & Mindlin", GREY, 5.0, points));
    }
    series.extend(segment_entries(&all, &colours));
    let y = Shown::plain("stick radius / contact radius");
    let chart = Chart { bar: colours.bar, ..over_shear("Stick radius", [&x, &y], series) };
    let caption = "Radius of a disc with the area of the sticking points over the contact radius. Cattaneo and Mindlin's curve, of an \
                   elastic contact, is for the first loading at the same forces.";
    Picture::draw("stick", caption, view.sheet.chart(SIZE), |root| draw_chart(root, &chart))
}

/// F_N(h) of the whole path, unloading and the fall of F_N in a shear included, with Hertz and,
/// where the law has a counterpart, Olsson & Larsson beside it. Hertz leaves the frame at 1.5 times
/// the greatest of the other forces.
pub fn plot_indentation(history: &[StepRecord], inputs: &PlotInputs, view: &View) -> Result<Picture, OutputError> {
    let all = segments(history);
    let deepest = greatest(history.iter().map(|step| step.h));
    let sample = |force: &dyn Fn(f64) -> f64| -> Vec<(f64, f64)> {
        // Closer at the start, where the curves bend.
        (0..=CURVE_POINTS).map(|i| deepest * (i as f64 / CURVE_POINTS as f64).powi(2)).map(|h| (h, force(h))).collect()
    };
    let hertz = sample(&|h| hertz::force(&inputs.sphere, h / inputs.bodies));
    let model = inputs.hardening.map(|hardening| OlssonLarsson { sphere: inputs.sphere, hardening });
    let model = model.map(|model| sample(&|h| model.force(h / inputs.bodies)));
    let most = |points: &[(f64, f64)]| points.iter().map(|point| point.1).fold(0.0, f64::max);
    let computed = greatest(history.iter().map(|step| step.f_n)).max(model.as_deref().map_or(0.0, most));
    let lowest = history.iter().map(|step| step.f_n).filter(|force| force.is_finite()).fold(0.0, f64::min);
    let top = (1.5 * computed).min(most(&hertz)).max(computed);

    let x = view.axes.show(Dimension::Length, "indentation", "h", deepest);
    let y = view.axes.show(Dimension::Force, "normal force", "F_N", top);
    let scaled = |points: Vec<(f64, f64)>| points.iter().map(|point| (point.0 * x.factor, point.1 * y.factor)).collect();
    let colours = SegmentColours::of(&all);
    let point = |step: &StepRecord| Some((step.h * x.factor, step.f_n * y.factor));
    let mut series = by_segment(&all, &colours, Line::Solid(2.0), Mark::Dot, point);
    if let Some(first) = series.first_mut() {
        // From the first touch.
        first.points.insert(0, (0.0, 0.0));
        if all.len() < 2 {
            "simulation".clone_into(&mut first.label);
        }
    }
    series.extend(segment_entries(&all, &colours));
    series.extend(model.map(|points| Series::dashed("Olsson & Larsson 2016", TEAL, 9.0, scaled(points))));
    series.push(Series::dashed("Hertz", GREY, 3.0, scaled(hertz)));
    let y_axis = from_zero(&y.label, [lowest * y.factor, top * y.factor]);
    let x_axis = Axis::linear(&x.label, 0.0, 1.02 * deepest * x.factor);
    let chart = Chart { title: "Normal force".into(), x: x_axis, y: y_axis, series, bar: colours.bar };
    let caption = "Normal force over the indentation along the whole path, with closed forms of the press beside it. Arrows show the order of the steps.";
    Picture::draw("indentation", caption, view.sheet.chart(SIZE), |root| draw_chart(root, &chart))
}

/// A law's F_T and F_N over delta_T beside the simulation's from the first shear on: `laws` are
/// (name, points of delta_T, F_T, F_N).
pub fn plot_law(history: &[StepRecord], laws: &[(String, Vec<[f64; 3]>)], view: &View) -> Result<Picture, OutputError> {
    let shear = split(history).1;
    let x = shear_axis(&view.axes, shear);
    let y = view.axes.show(Dimension::Force, "force", "F", greatest(shear.iter().flat_map(|step| [step.f_n, step.f_t])));
    let computed =
        |force: fn(&StepRecord) -> f64| shear.iter().map(|step| (step.delta_t * x.factor, force(step) * y.factor)).collect();
    let mut series = vec![
        Series::marks("F_N, simulation", BLUE, Mark::Dot, computed(|record| record.f_n)),
        Series::marks("F_T, simulation", VERMILION, Mark::Ring, computed(|record| record.f_t)),
    ];
    // Told apart by their dashes.
    let dashes = [Line::Solid(2.0), Line::Dashed(8.0), Line::Dashed(3.0)];
    for ((name, points), line) in laws.iter().zip(dashes.into_iter().cycle()) {
        for (force, colour, column) in [("F_N", BLUE, 2), ("F_T", VERMILION, 1)] {
            let points = points.iter().map(|point| (point[0] * x.factor, point[column] * y.factor)).collect();
            series.push(Series { line: Some(line), ..Series::solid(format!("{force}, {name}"), colour, points) });
        }
    }
    let chart = over_shear("Law and simulation", [&x, &y], series);
    let caption = "The forces of the simulation and what the law says of the same case.";
    Picture::draw("law", caption, view.sheet.chart((760, 540)), |root| draw_chart(root, &chart))
}
