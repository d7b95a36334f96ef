//! The pressure over the radius at the end of the press.

use super::super::{ContactPoint, ContactStatus, Half, OutputError, StepRecord};
use super::PlotInputs;
use super::chart::{Axis, Chart, Mark, Series, draw_chart, extent};
use super::curves::from_zero;
use super::style::{BLUE, GREEN, GREY, INK, Picture, rounded, tick};
use crate::analytical::hertz;
use std::f64::consts::PI;

/// Times the computed pressure from which Hertz's is only named.
const OFF_SCALE: f64 = 4.0;

/// p(r) of every contact point of one step of the press, `record`, with Hertz's of an elastic
/// sphere at the same h, unless that is far beyond the computed ones, and a Hertz pressure of the
/// same force over the same circle.
pub fn plot_pressure(points: &[ContactPoint], record: &StepRecord, inputs: &PlotInputs) -> Result<Picture, OutputError> {
    let sphere = &inputs.sphere;
    // An image has the pressure and the distance of its point.
    let meshed = points.iter().filter(|p| p.half != Half::Mirrored);
    let ours: Vec<(f64, f64)> = meshed.map(|p| (p.current_x.hypot(p.current_y), p.pressure)).collect();
    let closed = points.iter().filter(|p| p.status != ContactStatus::Open).map(|p| p.current_x.hypot(p.current_y));
    let reach = 1.2 * closed.fold(record.a, f64::max).max(f64::MIN_POSITIVE);
    let computed = extent(ours.iter().map(|point| point.1)).1;
    let over = |a: f64, pressure: &dyn Fn(f64) -> f64| -> Vec<(f64, f64)> {
        // Closer at the edge, where the pressure falls steeply.
        let inside = (0..=60).map(|i| a * (1.0 - (1.0 - f64::from(i) / 60.0).powi(2)));
        inside.map(|r| (r, pressure(r))).collect()
    };
    let mut series = vec![Series::marks("simulation, contact points", BLUE, Mark::Dot, ours)];
    if record.a > 0.0 && record.f_n > 0.0 {
        let greatest = 1.5 * record.f_n / (PI * record.a * record.a);
        let shape = over(record.a, &|r| greatest * (1.0 - (r / record.a).powi(2)).max(0.0).sqrt());
        series.push(Series::dashed("Hertz's shape, same F_N and a", GREEN, 8.0, shape));
    }
    let a_hertz = hertz::contact_radius(sphere, record.h / inputs.bodies);
    let p_hertz = hertz::maximum_pressure(sphere, a_hertz);
    let mut top = series.iter().map(|curve| extent(curve.points.iter().map(|p| p.1)).1).fold(computed, f64::max);
    if p_hertz < OFF_SCALE * computed {
        top = top.max(p_hertz);
        let elastic = over(a_hertz, &|r| hertz::pressure(sphere, a_hertz, r));
        series.push(Series::dashed("Hertz, elastic at the same h", GREY, 3.0, elastic));
    }
    let off_scale = if p_hertz < OFF_SCALE * computed {
        String::new()
    } else {
        format!(", up to {}, which is off the scale", tick(rounded(p_hertz)))
    };
    let y = from_zero("contact pressure p (case's unit of stress)", [top]);
    series.insert(0, Series::dashed("contact radius a", INK, 2.0, vec![(record.a, 0.0), (record.a, y.range.1)]));
    let x = Axis::linear("distance r from the axis (case's unit of length)", 0.0, reach);
    let chart = Chart { title: "Pressure at the end of the press".into(), x, y, series, bar: None };
    let caption = format!(
        "Pressure of every contact point over its distance from the axis, before the shear. Plastic flow levels it: an elastic \
                   sphere at the same h would press harder{off_scale}, and Hertz's shape at the same force and radius is higher in the middle. Where it dips on the \
                   axis friction does that: the surface sticks where it first touched, and does not spread as it would without."
    );
    Picture::draw("pressure", caption, (760, 480), |root| draw_chart(root, &chart))
}
