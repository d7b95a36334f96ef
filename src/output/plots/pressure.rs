//! The pressure over the radius at the end of the press.

use super::super::{ContactPoint, ContactStatus, Half, OutputError, StepRecord};
use super::axes::Dimension;
use super::canvas::{Anchor, Canvas, Drawn, Writing};
use super::chart::{Axis, Chart, Mark, Series, draw_chart, extent};
use super::curves::from_zero;
use super::style::{BLUE, GREEN, GREY, INK, Picture, rounded, tick};
use super::text::wrapped;
use super::{PlotInputs, View};
use crate::analytical::hertz;
use std::f64::consts::PI;

/// Times the computed pressure from which Hertz's is only named.
const OFF_SCALE: f64 = 4.0;
/// Pressure on the axis over the greatest one below which the profile has a dip that is explained.
const DIP: f64 = 0.9;
const EXPLANATION: &str = "The dip on the axis is friction's, not the mesh's: the surface sticks where it first touched and cannot spread. \
                           Without friction the pressure is level there.";

/// p(r) of every contact point of one step of the press, `record`, with Hertz's of an elastic
/// sphere at the same h, unless that is far beyond the computed ones, and a Hertz pressure of the
/// same force over the same circle.
pub fn plot_pressure(
    points: &[ContactPoint],
    record: &StepRecord,
    inputs: &PlotInputs,
    view: &View,
) -> Result<Picture, OutputError> {
    let sphere = &inputs.sphere;
    // An image has the pressure and the distance of its point.
    let meshed = points.iter().filter(|p| p.half != Half::Mirrored);
    let mut ours: Vec<(f64, f64)> = meshed.map(|p| (p.current_x.hypot(p.current_y), p.pressure)).collect();
    let closed = points.iter().filter(|p| p.status != ContactStatus::Open).map(|p| p.current_x.hypot(p.current_y));
    let reach = 1.2 * closed.fold(record.a, f64::max).max(f64::MIN_POSITIVE);
    let computed = extent(ours.iter().map(|point| point.1)).1;
    ours.sort_by(|one, other| one.0.total_cmp(&other.0));
    let dips = inputs.friction.is_none_or(|mu| mu > 0.0) && ours.first().is_some_and(|axis| axis.1 < DIP * computed);

    let p_hertz = hertz::maximum_pressure(sphere, hertz::contact_radius(sphere, record.h / inputs.bodies));
    let mean = if record.a > 0.0 { record.f_n / (PI * record.a * record.a) } else { 0.0 };
    let on_scale = p_hertz < OFF_SCALE * computed;
    let top = computed.max(1.5 * mean).max(if on_scale { p_hertz } else { 0.0 });
    let across = view.axes.show(Dimension::Length, "distance from the axis", "r", reach);
    let up = view.axes.show(Dimension::Stress, "contact pressure", "p", top);
    let scaled = |points: Vec<(f64, f64)>| points.iter().map(|p| (p.0 * across.factor, p.1 * up.factor)).collect();
    let over = |a: f64, pressure: &dyn Fn(f64) -> f64| -> Vec<(f64, f64)> {
        // Closer at the edge, where the pressure falls steeply.
        let inside = (0..=60).map(|i| a * (1.0 - (1.0 - f64::from(i) / 60.0).powi(2)));
        scaled(inside.map(|r| (r, pressure(r))).collect())
    };
    let y = from_zero(&up.label, [top * up.factor]);
    let edge = record.a * across.factor;
    let mut series = vec![
        Series::dashed("contact radius a", INK, 2.0, vec![(edge, 0.0), (edge, y.range.1)]),
        Series::marks("simulation, contact points", BLUE, Mark::Dot, scaled(ours)),
    ];
    if record.a > 0.0 && record.f_n > 0.0 {
        let shape = over(record.a, &|r| 1.5 * mean * (1.0 - (r / record.a).powi(2)).max(0.0).sqrt());
        series.push(Series::dashed("Hertz's shape, same F_N and a", GREEN, 8.0, shape));
    }
    if on_scale {
        let a_hertz = hertz::contact_radius(sphere, record.h / inputs.bodies);
        let elastic = over(a_hertz, &|r| hertz::pressure(sphere, a_hertz, r));
        series.push(Series::dashed("Hertz, elastic at the same h", GREY, 3.0, elastic));
    }
    let x = Axis::linear(&across.label, 0.0, reach * across.factor);
    let chart = Chart { title: "Pressure at the end of the press".into(), x, y, series, bar: None };
    let off_scale =
        if on_scale { String::new() } else { format!(", up to {}, which is off the scale", tick(rounded(p_hertz * up.factor))) };
    let explained = if dips { format!(" {EXPLANATION}") } else { String::new() };
    let caption = format!(
        "Pressure of every contact point over its distance from the axis, before the shear. Plastic flow levels it: an elastic \
         sphere at the same h would press harder{off_scale}, and Hertz's shape at the same force and radius is higher in the middle.{explained}"
    );
    // Below the diagram, where nothing is covered.
    let size = view.sheet.chart((760, 480));
    let words = if dips { wrapped(EXPLANATION, 13.0, size.width - 40.0) } else { Vec::new() };
    let foot = if words.is_empty() { 0.0 } else { LINE * words.len() as f64 + 8.0 };
    Picture::draw("pressure", caption, view.sheet.size(size.width, size.height + foot), |root| {
        draw_chart(&root.panel((0.0, 0.0), (size.width, size.height)), &chart)?;
        explain(root, &words, size.height)
    })
}

/// Height of a line of the explanation.
const LINE: f64 = 17.0;

fn explain(root: &Canvas, words: &[String], top: f64) -> Drawn {
    for (i, line) in words.iter().enumerate() {
        root.text(line, (20.0, top + LINE * (i as f64 + 0.3)), INK, Writing::new(13.0, Anchor::Start))?;
    }
    Ok(())
}
