//! What a plate does that moves across the x axis, or turns: the path of F_T in its plane, and the
//! moments over the angles.

use super::super::{OutputError, StepRecord};
use super::View;
use super::axes::{Dimension, Shown};
use super::chart::{Axis, Chart, Mark, Series, draw_chart, extent};
use super::curves::{from_zero, greatest};
use super::style::{BLUE, GREY, INK, Picture, TEAL, VERMILION, tick};

const SQUARE: (u32, u32) = (600, 640);
const SIZE: (u32, u32) = (760, 480);
/// Points of a circle.
const CIRCLE: usize = 120;
/// The circle at the last F_N is drawn where that is below this share of the greatest.
const FALLEN: f64 = 0.98;

/// Whether a history has something to show here.
pub(super) fn is_needed(history: &[StepRecord]) -> [bool; 2] {
    let any = |of: fn(&StepRecord) -> bool| history.iter().any(of);
    [any(|step| step.delta_t_y != 0.0), any(|step| step.angles() != [0.0; 3])]
}

/// The path of F_T in its plane, y over x, with the circles of mu F_N that it stays in: at the
/// greatest F_N and, where that has fallen, at the last.
pub fn plot_plane(history: &[StepRecord], friction: Option<f64>, view: &View) -> Result<Picture, OutputError> {
    let loaded = || history.iter().filter(|step| step.f_n > 0.0);
    let reached = greatest(loaded().map(|step| step.f_t.hypot(step.f_t_y)));
    let most = greatest(loaded().map(|step| step.f_n));
    let last = loaded().next_back().map_or(0.0, |step| step.f_n);
    let mut circles: Vec<(&str, f64)> = vec![("greatest", most), ("last", last)];
    circles.truncate(if last < FALLEN * most { 2 } else { 1 });
    let limits: Vec<(String, f64)> = friction.map_or_else(Vec::new, |mu| {
        let limit = |(when, f_n): &(&str, f64)| (format!("μ F_N, {when} F_N (μ = {})", tick(mu)), mu * f_n);
        circles.iter().map(limit).filter(|limit| limit.1 < 4.0 * reached).collect()
    });
    let edge = limits.iter().fold(reached, |most, limit| most.max(limit.1)).max(f64::MIN_POSITIVE);
    let shown = |symbol: &str| view.axes.show(Dimension::Force, "", symbol, edge);
    let (x, y) = (shown("F_T,x"), shown("F_T,y"));
    let points = loaded().map(|step| (step.f_t * x.factor, step.f_t_y * y.factor)).collect();
    let mut series = vec![Series::solid("simulation", BLUE, points).marked(Mark::Dot).directed()];
    for ((label, radius), colour) in limits.into_iter().zip([INK, GREY]) {
        let on_circle = |i: usize| {
            let angle = std::f64::consts::TAU * i as f64 / CIRCLE as f64;
            (x.factor * radius * angle.cos(), y.factor * radius * angle.sin())
        };
        series.push(Series::dashed(label, colour, 6.0, (0..=CIRCLE).map(on_circle).collect()));
    }
    let axis = |shown: &Shown| Axis::linear(&shown.label, -1.1 * edge * shown.factor, 1.1 * edge * shown.factor);
    let chart = Chart { title: "Tangential force in its plane".into(), x: axis(&x), y: axis(&y), series, bar: None };
    let caption = "Path of the tangential force along both axes, in the order of the steps. Friction keeps it within μ F_N.";
    Picture::draw("plane", caption, view.sheet.chart(SQUARE), |root| draw_chart(root, &chart))
}

/// The moments over their angles, as lengths over the contact radius: M/(F_N a).
pub fn plot_moments(history: &[StepRecord], view: &View) -> Result<Picture, OutputError> {
    type Of = fn(&StepRecord) -> f64;
    let curves: [(&str, _, Of, Of); 3] = [
        ("twist, M_twist", BLUE, |step| step.twist, |step| step.m_twist),
        ("roll about y, M_roll,y", VERMILION, |step| step.roll_y, |step| step.m_roll_y),
        ("roll about x, M_roll,x", TEAL, |step| step.roll_x, |step| step.m_roll_x),
    ];
    let mut series = Vec::new();
    for (label, colour, angle, moment) in curves {
        if history.iter().all(|step| angle(step) == 0.0) {
            continue;
        }
        // The starting step belongs to what goes on from there.
        let loaded = history.iter().filter(|step| step.f_n > 0.0 && step.a > 0.0);
        let points: Vec<(f64, f64)> = loaded.map(|step| (angle(step), moment(step) / (step.f_n * step.a))).collect();
        let first = points.iter().position(|point| point.0 != 0.0).unwrap_or(0).saturating_sub(1);
        series.push(Series::solid(label, colour, points[first..].to_vec()).marked(Mark::Dot).directed());
    }
    let points = || series.iter().flat_map(|series: &Series| &series.points);
    let (low, high) = extent(points().map(|point| point.0));
    let y = from_zero("M / (F_N a)", points().map(|point| point.1));
    let chart = Chart { title: "Moments".into(), x: Axis::linear("angle in rad", low, high), y, series, bar: None };
    let caption = "Moments that turn the sphere, over normal force and contact radius, over the angles of twist and roll.";
    Picture::draw("moments", caption, view.sheet.chart(SIZE), |root| draw_chart(root, &chart))
}
