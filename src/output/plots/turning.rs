//! What a plate does that moves across the x axis, or turns: the friction used in its plane, and
//! the moments over the angles.

use super::super::{OutputError, StepRecord};
use super::View;
use super::chart::{Axis, Chart, Mark, Series, draw_chart, extent};
use super::curves::{from_zero, greatest};
use super::style::{BLUE, INK, Picture, TEAL, VERMILION, tick};

const SQUARE: (u32, u32) = (600, 640);
const SIZE: (u32, u32) = (760, 480);
/// Points of a circle.
const CIRCLE: usize = 120;

/// Whether a history has something to show here.
pub(super) fn is_needed(history: &[StepRecord]) -> [bool; 2] {
    let any = |of: fn(&StepRecord) -> bool| history.iter().any(of);
    [any(|step| step.delta_t_y != 0.0), any(|step| step.angles() != [0.0; 3])]
}

/// F_T over F_N, y over x, with the circle of mu that it stays in.
pub fn plot_plane(history: &[StepRecord], friction: Option<f64>, view: &View) -> Result<Picture, OutputError> {
    let used = |step: &StepRecord| (step.f_n > 0.0).then(|| (step.f_t / step.f_n, step.f_t_y / step.f_n));
    let points: Vec<(f64, f64)> = history.iter().filter_map(used).collect();
    let reached = greatest(points.iter().map(|point| point.0.hypot(point.1)));
    let mut series = vec![Series::solid("simulation", BLUE, points).marked(Mark::Dot).directed()];
    let limit = friction.filter(|mu| *mu < 4.0 * reached);
    if let Some(mu) = limit {
        let on_circle = |i: usize| {
            let angle = std::f64::consts::TAU * i as f64 / CIRCLE as f64;
            (mu * angle.cos(), mu * angle.sin())
        };
        series.push(Series::dashed(format!("μ = {}", tick(mu)), INK, 6.0, (0..=CIRCLE).map(on_circle).collect()));
    }
    let edge = 1.1 * limit.unwrap_or(0.0).max(reached).max(f64::MIN_POSITIVE);
    let axis = |label: &str| Axis::linear(label, -edge, edge);
    let title = "Friction used, in its plane".into();
    let chart = Chart { title, x: axis("F_T / F_N along x"), y: axis("F_T / F_N along y"), series, bar: None };
    let caption =
        "Tangential force over the normal force, along both axes, in the order of the steps; friction keeps it in the circle.";
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
