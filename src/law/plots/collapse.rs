//! All curves of a study in normalised variables: as they are, and against what the law makes of
//! them.

use super::groups::lambda_bar;
use crate::law::data::{Sample, ShearPoint};
use crate::law::formulas::fit::inputs;
use crate::law::formulas::model::Parameters;
use crate::law::formulas::shear;
use crate::law::{Law, LawError};
use crate::output::plots::chart::{Axis, Chart, Line, Series, draw_chart, draw_charts};
use crate::output::plots::style::INK;
use crate::output::plots::{Picture, Sheet};

/// Curves whose F_N falls by less than this share say nothing of f_N.
const LEAST_FALL: f64 = 0.02;
/// delta_T over delta_T_end up to which curves are shown.
const END: f64 = 1.4;

/// F_T over mu F_N_slip: over x, and over the law's f_T(x).
pub fn tangential(samples: &[Sample], law: Option<&Law>, sheet: Sheet) -> Result<Picture, LawError> {
    let all: Vec<&Sample> = samples.iter().collect();
    let share = |sample: &Sample, point: &ShearPoint| point.f_t / (sample.friction * sample.f_n_slip);
    let name = "F_T / (μ F_{N,slip})";
    let mut left = panel("Tangential force", over(law), name, samples, lines(&all, law, share, |x, _| x));
    for (n, dash) in [(1.5, 12.0), (3.0, 7.0), (8.0, 3.0)] {
        let points = (0..=140).map(|i| 0.01 * f64::from(i)).map(|x| (x, shear::f_t(x, n))).collect();
        left.series.push(Series::dashed(format!("f_T, n = {n}"), INK, dash, points));
    }
    let Some(law) = law else {
        let caption = "Every shear in normalised variables. δ_T_slip is the displacement at which F_T/F_N reaches 0.99 μ.";
        return Ok(Picture::draw("collapse-tangential", caption, sheet.chart(SINGLE), |root| draw_chart(root, &left))?);
    };
    let f_t = |x: f64, p: &Parameters| shear::f_t(x, p.n);
    let right = diagonal(name, "law: f_T(x) = 1 − (1 − x)^n", samples, lines(&all, Some(law), share, f_t));
    let caption = "Every shear in normalised variables, coloured by Λ. Left: over x = δ_T/δ_T_end, with f_T for some n. Right: over \
                   the law's f_T(x) with the case's n; all curves fall on the diagonal where the law holds. \
                   δ_T_end and n are the law's, F_N_slip the simulation's.";
    let (size, columns) = sheet.charts(DOUBLE, 2);
    Ok(Picture::draw("collapse-tangential", caption, size, |root| draw_charts(root, columns, &[left, right]))?)
}

/// The fall of F_N over its whole: over x, and over the law's f_N(x). `None` if no F_N falls.
pub fn normal(samples: &[Sample], law: Option<&Law>, sheet: Sheet) -> Result<Option<Picture>, LawError> {
    let falling: Vec<&Sample> = samples.iter().filter(|s| s.f_n_slip < (1.0 - LEAST_FALL) * s.f_n0).collect();
    if falling.is_empty() {
        return Ok(None);
    }
    let share = |sample: &Sample, point: &ShearPoint| (sample.f_n0 - point.f_n) / (sample.f_n0 - sample.f_n_slip);
    let name = "(F_N0 − F_N) / (F_N0 − F_{N,slip})";
    let left = panel("Fall of the normal force", over(law), name, samples, lines(&falling, law, share, |x, _| x));
    let Some(law) = law else {
        let caption = "The fall of F_N of every case in which it falls by more than 2 per cent, in normalised variables.";
        return Ok(Some(Picture::draw("collapse-normal", caption, sheet.chart(SINGLE), |root| draw_chart(root, &left))?));
    };
    let f_n = |x: f64, p: &Parameters| shear::f_n(x, p.m_exponent, p.n_exponent);
    let right = diagonal(name, "law: f_N(x) = 1 − (1 − x^M)^N", samples, lines(&falling, Some(law), share, f_n));
    let caption = "The fall of F_N of every case in which it falls by more than 2 per cent, coloured by Λ. \
                   Left: over x = δ_T/δ_T_end. Right: over the law's f_N(x) with the case's M and N. \
                   δ_T_end, M and N are the law's, F_N0 and F_N_slip the simulation's.";
    let (size, columns) = sheet.charts(DOUBLE, 2);
    Ok(Some(Picture::draw("collapse-normal", caption, size, |root| draw_charts(root, columns, &[left, right]))?))
}

const SINGLE: (u32, u32) = (720, 540);
const DOUBLE: (u32, u32) = (1180, 540);

/// A line a sample: `across`(x, law's parameters) and `up`(sample, point), coloured by Lambda.
fn lines(
    samples: &[&Sample],
    law: Option<&Law>,
    up: impl Fn(&Sample, &ShearPoint) -> f64,
    across: impl Fn(f64, &Parameters) -> f64,
) -> Vec<Series> {
    let owned: Vec<Sample> = samples.iter().map(|&sample| sample.clone()).collect();
    let bar = lambda_bar(&owned);
    let line = |sample: &&Sample| {
        let parameters = match law {
            Some(law) => law.contact(&inputs(sample)),
            None => Parameters {
                f_n0: sample.f_n0,
                f_n_slip: sample.f_n_slip,
                delta_t_end: sample.delta_t_slip,
                k_t0: sample.k_t0,
                n: 1.5,
                m_exponent: 1.0,
                n_exponent: 1.0,
            },
        };
        let x = |point: &ShearPoint| point.delta_t / parameters.delta_t_end;
        let inside = sample.curve.iter().take_while(|point| x(point) <= 2.0 * END);
        let points = inside.map(|point| (across(x(point), &parameters), up(sample, point))).collect();
        let colour = bar.colour(sample.variables.lambda);
        Series { line: Some(Line::Solid(1.0)), opacity: 0.75, ..Series::solid("", colour, points) }
    };
    samples.iter().map(line).collect()
}

/// What the left panels are drawn over.
fn over(law: Option<&Law>) -> &'static str {
    if law.is_some() { "x = δ_T / δ_{T,end}" } else { "δ_T / δ_{T,slip}" }
}

fn panel(title: &str, x: &str, y: &str, samples: &[Sample], series: Vec<Series>) -> Chart {
    Chart {
        title: title.into(),
        x: Axis::linear(x, 0.0, END),
        y: Axis::linear(y, 0.0, 1.12),
        series,
        bar: Some(lambda_bar(samples)),
    }
}

fn diagonal(y: &str, x: &str, samples: &[Sample], series: Vec<Series>) -> Chart {
    let mut chart = panel("Against the law", x, y, samples, series);
    chart.x = Axis::linear(x, 0.0, 1.0);
    chart.series.push(Series::dashed("the law exactly", INK, 8.0, vec![(0.0, 0.0), (1.0, 1.0)]));
    chart
}
