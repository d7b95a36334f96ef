//! The law against the simulations: some cases in full, and the greatest errors of all.

use super::groups::{by_friction, lambda_axis};
use crate::law::data::Sample;
use crate::law::formulas::fit::inputs;
use crate::law::report::{CaseErrors, FittedCase, LAMBDA_BOUNDS, case_errors};
use crate::law::variables::yield_lambda;
use crate::law::{Law, LawError};
use crate::output::plots::chart::{Axis, Chart, Mark, Series, draw_charts, extent};
use crate::output::plots::style::{BLUE, GREY, INK, VERMILION, tick};
use crate::output::plots::{Picture, Sheet};

/// Errors of the law for a sample, its F_N0 and a0 being known.
fn errors_of(law: &Law, sample: &Sample) -> CaseErrors {
    let parameters = law.contact(&inputs(sample));
    case_errors(sample, |delta_t| law.forces(&parameters, sample.friction, delta_t))
}

/// The greatest error of either force.
fn greatest(errors: &CaseErrors) -> f64 {
    errors[1].max(errors[3])
}

/// The case that the law describes best, the one in the middle and the worst one.
pub fn cases(samples: &[Sample], law: &Law, sheet: Sheet) -> Result<Picture, LawError> {
    let mut ranked: Vec<(f64, &Sample)> = samples.iter().map(|sample| (greatest(&errors_of(law, sample)), sample)).collect();
    ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
    let picks = [("Best", 0), ("Median", ranked.len() / 2), ("Worst", ranked.len().saturating_sub(1))];
    let charts: Vec<Chart> = picks
        .into_iter()
        .filter_map(|(name, place)| Some((name, ranked.get(place)?)))
        .map(|(name, (error, sample))| {
            let title = format!(
                "{name}: {}, Λ = {:.3}, μ = {}, error {:.1} %",
                sample.id,
                Short(sample.variables.lambda),
                tick(sample.friction),
                100.0 * error
            );
            Chart { title, ..case_chart(law, sample) }
        })
        .collect();
    let caption = "Marks: simulation; lines: the law, given the simulation's F_N0 and a0. Cases are ranked by their greatest error, in F_T as a share \
                   of its peak or in F_N as a share of F_N0.";
    let (size, columns) = sheet.charts((480 * 3, 470), 3);
    Ok(Picture::draw("cases", caption, size, |root| draw_charts(root, columns, &charts))?)
}

/// A number with three digits.
struct Short(f64);

impl std::fmt::Display for Short {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let decimals = if self.0 > 0.0 { (2 - self.0.log10().floor() as i32).clamp(0, 4) as usize } else { 0 };
        write!(f, "{:.decimals$}", self.0)
    }
}

fn case_chart(law: &Law, sample: &Sample) -> Chart {
    let parameters = law.contact(&inputs(sample));
    let (slip, mu, f_n0) = (parameters.delta_t_end, sample.friction, sample.f_n0);
    let computed = |value: fn(&crate::law::data::ShearPoint) -> f64, scale: f64| -> Vec<(f64, f64)> {
        sample.curve.iter().map(|point| (point.delta_t / slip, value(point) / scale)).collect()
    };
    let last = sample.curve.last().map_or(1.0, |point| point.delta_t / slip).clamp(1.0, 3.0);
    let law_points: Vec<(f64, f64, f64)> = (0..=150)
        .map(|i| last * (f64::from(i) / 150.0).powi(2))
        .map(|x| {
            let (f_t, f_n) = law.forces(&parameters, mu, x * slip);
            (x, f_t / (mu * f_n0), f_n / f_n0)
        })
        .collect();
    let series = vec![
        Series::marks("F_N/F_N0", BLUE, Mark::Dot, computed(|point| point.f_n, f_n0)),
        Series::marks("F_T/(μF_N0)", VERMILION, Mark::Ring, computed(|point| point.f_t, mu * f_n0)),
        Series::solid("law", INK, Vec::new()),
        Series::solid("", BLUE, law_points.iter().map(|point| (point.0, point.2)).collect()),
        Series::solid("", VERMILION, law_points.iter().map(|point| (point.0, point.1)).collect()),
    ];
    Chart {
        title: String::new(),
        x: Axis::linear("δ_T / law's δ_{T,end}", 0.0, 1.03 * last),
        y: Axis::linear("F_N/F_N0 and F_T/(μF_N0)", 0.0, 1.15),
        series,
        bar: None,
    }
}

/// The greatest errors of F_T, as a share of its peak, and of F_N, as a share of F_N0, of every
/// sample, F_N0 and a0 being known; and whether they are cross-validated, which they are where the
/// law was fitted to these very cases.
pub fn greatest_errors(samples: &[Sample], law: &Law) -> (Vec<[f64; 2]>, bool) {
    let known = |sample: &Sample| {
        let same = |case: &&FittedCase| (case.lambda - sample.variables.lambda).abs() <= 1e-9 * case.lambda;
        let case = law.cases.iter().find(|case| case.case == sample.id).filter(same)?;
        Some([case.law_f_t_max, case.law_f_n_max])
    };
    match samples.iter().map(known).collect() {
        Some(errors) => (errors, true),
        None => (samples.iter().map(|sample| errors_of(law, sample)).map(|errors| [errors[1], errors[3]]).collect(), false),
    }
}

/// The greatest error of every case over Lambda, by mu.
pub fn errors(samples: &[Sample], law: &Law, sheet: Sheet) -> Result<Picture, LawError> {
    let (all, cross_validated) = greatest_errors(samples, law);
    let error = |sample: &Sample| samples.iter().position(|other| other.id == sample.id).map_or([f64::NAN; 2], |i| all[i]);
    let chart = |i: usize, title: &str, label: &str| {
        let series = by_friction(samples, |sample| 100.0 * error(sample)[i]);
        let highest = extent(series.iter().flat_map(|s| &s.points).map(|point| point.1).chain([0.0])).1;
        let y = Axis::linear(label, 0.0, 1.08 * highest.max(1e-3));
        let first = samples.first().map_or(0.3, |sample| sample.body.sphere.poissons_ratio);
        let mut borders: Vec<Series> = [yield_lambda(first), LAMBDA_BOUNDS[0], LAMBDA_BOUNDS[1]]
            .into_iter()
            .map(|bound| Series::dashed("", GREY, 4.0, vec![(bound, 0.0), (bound, y.range.1)]))
            .collect();
        borders.extend(series);
        borders.push(Series::dashed("5 %", INK, 8.0, vec![(1e-9, 5.0), (1e9, 5.0)]));
        let x = lambda_axis(samples.iter().map(|sample| sample.variables.lambda));
        Chart { title: title.into(), x, y, series: borders, bar: None }
    };
    let charts =
        [chart(0, "Greatest error of F_T", "|error| / peak of F_T (%)"), chart(1, "Greatest error of F_N", "|error| / F_N0 (%)")];
    let how = if cross_validated {
        "Cross-validated: each case is predicted by constants that saw nothing of its material."
    } else {
        "The law was not fitted to these cases."
    };
    let caption = format!(
        "The greatest error along each curve, F_N0 and a0 being known. {how} Grey lines part the regions of the error table: first yield, Λ = 20 \
         and 160."
    );
    let (size, columns) = sheet.charts((1180, 480), 2);
    Ok(Picture::draw("errors", caption, size, |root| draw_charts(root, columns, &charts))?)
}
