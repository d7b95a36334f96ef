//! Forces over the displacements.

use super::super::{OutputError, StepRecord};
use super::PlotInputs;
use super::style::{BLUE, Drawn, FAINT, FONT, GREEN, GREY, INK, VERMILION, draw, tick};
use crate::analytical::hertz;
use crate::analytical::olsson_larsson::OlssonLarsson;
use plotters::coord::Shift;
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use std::path::Path;

const SIZE: (u32, u32) = (760, 480);
/// Points of an analytical curve.
const CURVE_POINTS: usize = 120;

/// How a curve is told from the others without colour.
#[derive(Clone, Copy, PartialEq)]
enum Stroke {
    /// Computed: a line with a dot for every step.
    Dots,
    /// Likewise with a ring for every step.
    Rings,
    /// Analytical: dashes of that many pixels.
    Dashed(i32),
}

struct Curve {
    label: String,
    colour: RGBColor,
    stroke: Stroke,
    points: Vec<(f64, f64)>,
}

/// The records up to the start of the first shear, and those from there on with the starting one first; the latter are empty without a shear.
pub(super) fn split(history: &[StepRecord]) -> (&[StepRecord], &[StepRecord]) {
    match history.windows(2).position(|pair| pair[1].delta_t != pair[0].delta_t) {
        Some(begin) => (&history[..=begin], &history[begin..]),
        None => (history, &[]),
    }
}

/// F_N and F_T over delta_T, from the first shear on.
pub fn plot_forces(path: &Path, history: &[StepRecord]) -> Result<(), OutputError> {
    let shear = split(history).1;
    let curve = |label: &str, colour, stroke, force: fn(&StepRecord) -> f64| Curve {
        label: label.into(),
        colour,
        stroke,
        points: shear.iter().map(|record| (record.delta_t, force(record))).collect(),
    };
    let curves =
        [curve("F_N", BLUE, Stroke::Dots, |record| record.f_n), curve("F_T", VERMILION, Stroke::Rings, |record| record.f_t)];
    chart(path, "Forces during the shear", ("δ_T", "force"), &curves, f64::INFINITY)
}

/// F_T/F_N over delta_T, from the first shear on, with mu as a line to run up to.
pub fn plot_ratio(path: &Path, history: &[StepRecord], friction: Option<f64>) -> Result<(), OutputError> {
    let shear = split(history).1;
    let loaded = shear.iter().filter(|record| record.f_n > 0.0);
    let points: Vec<(f64, f64)> = loaded.map(|record| (record.delta_t, record.f_t / record.f_n)).collect();
    let (low, high) = extent(points.iter().map(|point| point.0));
    let mut curves = vec![Curve { label: "F_T/F_N".into(), colour: BLUE, stroke: Stroke::Dots, points: points.clone() }];
    for sign in [1.0, -1.0] {
        let reached = points.iter().any(|point| point.1 * sign > 0.0);
        if let Some(mu) = friction.filter(|_| reached) {
            let label = if sign > 0.0 { format!("μ = {}", tick(mu)) } else { format!("−μ = −{}", tick(mu)) };
            let points = vec![(low, sign * mu), (high, sign * mu)];
            curves.push(Curve { label, colour: INK, stroke: Stroke::Dashed(6), points });
        }
    }
    chart(path, "Friction used", ("δ_T", "F_T / F_N"), &curves, f64::INFINITY)
}

/// F_N(h) up to the first shear, with Hertz and, where the law has a counterpart, Olsson & Larsson beside it. Hertz leaves the frame at 1.5 times
/// the greatest of the other forces.
pub fn plot_indentation(path: &Path, history: &[StepRecord], inputs: &PlotInputs) -> Result<(), OutputError> {
    let pressing = split(history).0;
    let mut points = vec![(0.0, 0.0)];
    points.extend(pressing.iter().map(|record| (record.h, record.f_n)));
    let deepest = extent(points.iter().map(|point| point.0)).1;
    let sample = |force: &dyn Fn(f64) -> f64| -> Vec<(f64, f64)> {
        // Closer at the start, where the curves bend.
        (0..=CURVE_POINTS).map(|i| deepest * (i as f64 / CURVE_POINTS as f64).powi(2)).map(|h| (h, force(h))).collect()
    };
    let mut curves = vec![Curve { label: "computed".into(), colour: BLUE, stroke: Stroke::Dots, points }];
    if let Some(hardening) = inputs.hardening {
        let model = OlssonLarsson { sphere: inputs.sphere, hardening };
        let points = sample(&|h| model.force(h));
        curves.push(Curve { label: "Olsson & Larsson 2016".into(), colour: GREEN, stroke: Stroke::Dashed(7), points });
    }
    let top = 1.5 * curves.iter().flat_map(|curve| &curve.points).map(|point| point.1).fold(0.0, f64::max);
    let points = sample(&|h| hertz::force(&inputs.sphere, h));
    curves.push(Curve { label: "Hertz".into(), colour: GREY, stroke: Stroke::Dashed(3), points: below(&points, top) });
    chart(path, "Pressing", ("h", "F_N"), &curves, top)
}

/// The part of a rising curve up to `top`, cut where it crosses.
fn below(points: &[(f64, f64)], top: f64) -> Vec<(f64, f64)> {
    let inside = points.iter().take_while(|point| point.1 <= top).count();
    let mut kept = points[..inside].to_vec();
    if let (Some(last), Some(next)) = (kept.last().copied(), points.get(inside)) {
        kept.push((last.0 + (next.0 - last.0) * (top - last.1) / (next.1 - last.1), top));
    }
    kept
}

/// Least and greatest of the finite values; (0, 1) if there are none, widened if they coincide.
fn extent(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) = values
        .filter(|value| value.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
    match (low.is_finite(), low < high) {
        (false, _) => (0.0, 1.0),
        (true, true) => (low, high),
        (true, false) => (low - 0.5 * low.abs().max(1e-12), high + 0.5 * high.abs().max(1e-12)),
    }
}

fn chart(path: &Path, title: &str, labels: (&str, &str), curves: &[Curve], top: f64) -> Result<(), OutputError> {
    draw(path, SIZE, |root| draw_chart(root, title, labels, curves, top))
}

fn draw_chart(
    root: &DrawingArea<SVGBackend<'_>, Shift>,
    title: &str,
    (x_label, y_label): (&str, &str),
    curves: &[Curve],
    top: f64,
) -> Drawn {
    let points = || curves.iter().flat_map(|curve| &curve.points);
    let x = extent(points().map(|point| point.0));
    let y = extent(points().map(|point| point.1).filter(|&value| value <= top).chain([0.0]));
    let room = 0.06 * (y.1 - y.0);
    let y = (if y.0 < 0.0 { y.0 - room } else { 0.0 }, if y.1 > 0.0 { y.1 + room } else { 0.0 });
    let mut chart = ChartBuilder::on(root)
        .caption(title, (FONT, 20).into_font().color(&INK))
        .margin(14)
        .margin_right(28)
        .x_label_area_size(46)
        .y_label_area_size(74)
        .build_cartesian_2d(x.0..x.1, y.0..y.1)?;
    chart
        .configure_mesh()
        .bold_line_style(FAINT)
        .light_line_style(TRANSPARENT)
        .axis_style(INK)
        .x_desc(x_label)
        .y_desc(y_label)
        .x_labels(7)
        .y_labels(7)
        .x_label_formatter(&|value| tick(*value))
        .y_label_formatter(&|value| tick(*value))
        .label_style((FONT, 14).into_font().color(&INK))
        .axis_desc_style((FONT, 16).into_font().color(&INK))
        .draw()?;
    for curve in curves {
        let finite: Vec<(f64, f64)> = curve.points.iter().copied().filter(|p| p.0.is_finite() && p.1.is_finite()).collect();
        let colour = curve.colour;
        match curve.stroke {
            Stroke::Dots | Stroke::Rings => {
                let inside = if curve.stroke == Stroke::Dots { colour.filled() } else { WHITE.filled() };
                let line = colour.stroke_width(2);
                let marker = move |at| EmptyElement::at(at) + Circle::new((0, 0), 3, inside) + Circle::new((0, 0), 3, line);
                chart.draw_series(LineSeries::new(finite.iter().copied(), line))?;
                chart.draw_series(finite.iter().map(|&point| marker(point)))?.label(&curve.label).legend(move |(x, y)| {
                    EmptyElement::at((x, y))
                        + PathElement::new([(0, 0), (26, 0)], line)
                        + Circle::new((13, 0), 3, inside)
                        + Circle::new((13, 0), 3, line)
                });
            }
            Stroke::Dashed(dash) => {
                let gap = dash.min(5);
                chart
                    .draw_series(DashedLineSeries::new(finite, dash, gap, colour.stroke_width(2)))?
                    .label(&curve.label)
                    .legend(move |(x, y)| DashedPathElement::new([(x, y), (x + 26, y)], dash, gap, colour.stroke_width(2)));
            }
        }
    }
    chart
        .configure_series_labels()
        .position(legend_place(curves, x, y))
        .legend_area_size(34)
        .margin(12)
        .background_style(WHITE.mix(0.85))
        .border_style(FAINT)
        .label_font((FONT, 14).into_font().color(&INK))
        .draw()?;
    Ok(())
}

/// The corner (or side) of the frame with the fewest points near it.
fn legend_place(curves: &[Curve], x: (f64, f64), y: (f64, f64)) -> SeriesLabelPosition {
    use SeriesLabelPosition as Place;
    let places = [
        (Place::UpperLeft, 0.15, 0.85),
        (Place::LowerRight, 0.85, 0.15),
        (Place::UpperRight, 0.85, 0.85),
        (Place::LowerLeft, 0.15, 0.15),
        (Place::MiddleRight, 0.85, 0.5),
        (Place::MiddleLeft, 0.15, 0.5),
    ];
    let crowd = |at: &(Place, f64, f64)| -> usize {
        let mut count = 0;
        for pair in curves.iter().flat_map(|curve| curve.points.windows(2)) {
            // Along the segment, so that a long straight line counts where it passes.
            for i in 0..8 {
                let along = f64::from(i) / 8.0;
                let across = (pair[0].0 + along * (pair[1].0 - pair[0].0) - x.0) / (x.1 - x.0) - at.1;
                let up = (pair[0].1 + along * (pair[1].1 - pair[0].1) - y.0) / (y.1 - y.0) - at.2;
                count += usize::from(across.abs() < 0.22 && up.abs() < 0.18);
            }
        }
        count
    };
    places.into_iter().min_by_key(crowd).map_or(Place::UpperLeft, |place| place.0)
}
