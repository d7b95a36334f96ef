//! Forces, ratio and stick radius over the displacements.

use super::super::tables::split;
use super::super::{OutputError, StepRecord};
use super::PlotInputs;
use super::chart::{Axis, Chart, Line, Mark, Series, draw_chart, extent};
use super::style::{BLUE, GREEN, GREY, INK, Picture, VERMILION, tick};
use crate::analytical::hertz;
use crate::analytical::olsson_larsson::OlssonLarsson;

const SIZE: (u32, u32) = (760, 480);
/// Points of an analytical curve.
const CURVE_POINTS: usize = 120;

/// A run's numbers are in the units of its case file, whatever they are.
pub(super) const SHEAR_AXIS: &str = "tangential displacement δ_T (case's unit of length)";

/// The vertical axis over some values and zero, with room above and below.
pub(super) fn from_zero(label: &str, values: impl IntoIterator<Item = f64>) -> Axis {
    let (low, high) = extent(values.into_iter().chain([0.0]));
    let room = 0.06 * (high - low);
    Axis::linear(label, if low < 0.0 { low - room } else { 0.0 }, if high > 0.0 { high + room } else { 0.0 })
}

/// A diagram over delta_T, x from the points and y from zero.
fn over_shear(title: &str, y_label: &str, series: Vec<Series>) -> Chart {
    let points = || series.iter().flat_map(|series| &series.points);
    let (low, high) = extent(points().map(|point| point.0));
    let y = from_zero(y_label, points().map(|point| point.1));
    Chart { title: title.into(), x: Axis::linear(SHEAR_AXIS, low, high), y, series, bar: None }
}

/// F_N and F_T over delta_T, from the first shear on.
pub fn plot_forces(history: &[StepRecord]) -> Result<Picture, OutputError> {
    let shear = split(history).1;
    let curve = |label: &str, colour, mark, force: fn(&StepRecord) -> f64| {
        Series::solid(label, colour, shear.iter().map(|record| (record.delta_t, force(record))).collect()).marked(mark)
    };
    let series = vec![
        curve("F_N, normal", BLUE, Mark::Dot, |record| record.f_n),
        curve("F_T, tangential", VERMILION, Mark::Ring, |record| record.f_t),
    ];
    let chart = over_shear("Forces during the shear", "force (case's unit of force)", series);
    Picture::draw(
        "forces",
        "Forces on the whole sphere over the tangential displacement, from the first shear on.",
        SIZE,
        |root| draw_chart(root, &chart),
    )
}

/// F_T/F_N over delta_T, from the first shear on, with mu as a line to run up to.
pub fn plot_ratio(history: &[StepRecord], friction: Option<f64>) -> Result<Picture, OutputError> {
    let shear = split(history).1;
    let loaded = shear.iter().filter(|record| record.f_n > 0.0);
    let points: Vec<(f64, f64)> = loaded.map(|record| (record.delta_t, record.f_t / record.f_n)).collect();
    let (low, high) = extent(points.iter().map(|point| point.0));
    let mut series = Vec::new();
    for sign in [1.0, -1.0] {
        // Rounding is no friction: a shear to the right needs no room for -mu.
        let reached = |mu: f64| points.iter().any(|point| point.1 * sign > 0.05 * mu);
        if let Some(mu) = friction.filter(|&mu| reached(mu)) {
            let label = if sign > 0.0 { format!("μ = {}", tick(mu)) } else { format!("−μ = −{}", tick(mu)) };
            series.push(Series::dashed(label, INK, 6.0, vec![(low, sign * mu), (high, sign * mu)]));
        }
    }
    series.insert(0, Series::solid("F_T / F_N", BLUE, points).marked(Mark::Dot));
    let chart = over_shear("Friction used", "F_T / F_N", series);
    Picture::draw("ratio", "Share of the normal force that friction takes; it runs up to μ.", SIZE, |root| {
        draw_chart(root, &chart)
    })
}

/// Stick radius over delta_T, as a share of the contact radius, from the first shear on, with
/// Cattaneo and Mindlin's at the same F_T/F_N.
pub fn plot_stick(history: &[StepRecord], friction: Option<f64>) -> Result<Picture, OutputError> {
    let loaded = || split(history).1.iter().filter(|record| record.f_n > 0.0 && record.a > 0.0);
    let ours = loaded().map(|record| (record.delta_t, record.stick_radius / record.a)).collect();
    let mut series = vec![Series::solid("simulation", BLUE, ours).marked(Mark::Dot)];
    if let Some(mu) = friction.filter(|&mu| mu > 0.0) {
        let share = |record: &StepRecord| (1.0 - record.f_t.abs() / (mu * record.f_n)).max(0.0).cbrt();
        let points = loaded().map(|record| (record.delta_t, share(record))).collect();
        series.push(Series::dashed("∛(1 − F_T/μF_N), Cattaneo & Mindlin", GREY, 5.0, points));
    }
    let chart = over_shear("Stick radius", "stick radius / contact radius", series);
    let caption = "Radius of a disc with the area of the sticking points over the contact radius. Cattaneo and Mindlin's curve, of an \
                   elastic contact, is for the first loading at the same forces.";
    Picture::draw("stick", caption, SIZE, |root| draw_chart(root, &chart))
}

/// F_N(h) up to the first shear, with Hertz and, where the law has a counterpart, Olsson & Larsson
/// beside it. Hertz leaves the frame at 1.5 times the greatest of the other forces.
pub fn plot_indentation(history: &[StepRecord], inputs: &PlotInputs) -> Result<Picture, OutputError> {
    let pressing = split(history).0;
    let mut points = vec![(0.0, 0.0)];
    points.extend(pressing.iter().map(|record| (record.h, record.f_n)));
    let deepest = extent(points.iter().map(|point| point.0)).1;
    let sample = |force: &dyn Fn(f64) -> f64| -> Vec<(f64, f64)> {
        // Closer at the start, where the curves bend.
        (0..=CURVE_POINTS).map(|i| deepest * (i as f64 / CURVE_POINTS as f64).powi(2)).map(|h| (h, force(h))).collect()
    };
    let mut series = vec![Series::solid("simulation", BLUE, points).marked(Mark::Dot)];
    if let Some(hardening) = inputs.hardening {
        let model = OlssonLarsson { sphere: inputs.sphere, hardening };
        series.push(Series::dashed("Olsson & Larsson 2016", GREEN, 9.0, sample(&|h| model.force(h / inputs.bodies))));
    }
    let values: Vec<f64> = series.iter().flat_map(|curve| &curve.points).map(|point| point.1).collect();
    let hertz = sample(&|h| hertz::force(&inputs.sphere, h / inputs.bodies));
    let top = (1.5 * values.iter().copied().fold(0.0, f64::max)).min(hertz.iter().map(|point| point.1).fold(0.0, f64::max));
    let y = from_zero("normal force F_N (case's unit of force)", values.into_iter().chain([top]));
    series.push(Series::dashed("Hertz", GREY, 3.0, hertz));
    let x = Axis::linear("indentation h (case's unit of length)", 0.0, deepest);
    let chart = Chart { title: "Pressing".into(), x, y, series, bar: None };
    Picture::draw("indentation", "Normal force up to the first shear, with closed forms beside it.", SIZE, |root| {
        draw_chart(root, &chart)
    })
}

/// A law's F_T and F_N over delta_T beside the simulation's from the first shear on: `laws` are
/// (name, points of delta_T, F_T, F_N).
pub fn plot_law(history: &[StepRecord], laws: &[(String, Vec<[f64; 3]>)]) -> Result<Picture, OutputError> {
    let shear = split(history).1;
    let computed = |force: fn(&StepRecord) -> f64| shear.iter().map(|record| (record.delta_t, force(record))).collect();
    let mut series = vec![
        Series::marks("F_N, simulation", BLUE, Mark::Dot, computed(|record| record.f_n)),
        Series::marks("F_T, simulation", VERMILION, Mark::Ring, computed(|record| record.f_t)),
    ];
    // Told apart by their dashes.
    let dashes = [Line::Solid(2.0), Line::Dashed(8.0), Line::Dashed(3.0)];
    for ((name, points), line) in laws.iter().zip(dashes.into_iter().cycle()) {
        for (force, colour, column) in [("F_N", BLUE, 2), ("F_T", VERMILION, 1)] {
            let points = points.iter().map(|point| (point[0], point[column])).collect();
            series.push(Series { line: Some(line), ..Series::solid(format!("{force}, {name}"), colour, points) });
        }
    }
    let chart = over_shear("Law and simulation", "force (case's unit of force)", series);
    Picture::draw("law", "The forces of the simulation and what the law says of the same case.", (760, 540), |root| {
        draw_chart(root, &chart)
    })
}
