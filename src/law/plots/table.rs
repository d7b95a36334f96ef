//! The table beside the simulations, and its errors.

use crate::analytical::hertz;
use crate::contact_law::path::drive;
use crate::law::LawError;
use crate::law::table::{Built, Curves, DepthErrors, Level, equivalent};
use crate::output::plots::chart::{Axis, Chart, Mark, Series, draw_charts, extent};
use crate::output::plots::style::{BLUE, GREEN, GREY, INK, VERMILION};
use crate::output::plots::{Picture, Sheet};

/// F_N0 and a0 over h with the simulations; the shears of the checked depths with what the table of
/// the others says; the errors there.
///
/// # Errors
/// [`LawError`] if it cannot be drawn.
pub fn picture(built: &Built) -> Result<Picture, LawError> {
    let charts = [normal(built)?, shears(built)?, errors(&built.table.errors)];
    let caption = "Left: the table (lines) and the depths it was made from (marks). Middle: depths between those of a table of every other depth, simulated (marks) \
                   and told by it (lines). Right: its errors there.";
    let (size, columns) = Sheet::default().charts((480 * 3, 470), 3);
    Ok(Picture::draw("tabulated", caption, size, |root| draw_charts(root, columns, &charts))?)
}

fn normal(built: &Built) -> Result<Chart, LawError> {
    let sphere = equivalent(&built.table.scaled_case()?);
    let force = |h: f64, f_n0: f64| f_n0 / hertz::force(&sphere, h);
    let area = |h: f64, a0: f64| a0 * a0 / (sphere.radius * h);
    let levels: Vec<Level> = built.curve(150);
    let series = vec![
        Series::marks(
            "F_N0 / Hertz",
            BLUE,
            Mark::Dot,
            built.measured.iter().map(|one| (one.h, force(one.h, one.f_n0))).collect(),
        ),
        Series::marks(
            "a_0² / (R* h)",
            VERMILION,
            Mark::Ring,
            built.measured.iter().map(|one| (one.h, area(one.h, one.a0))).collect(),
        ),
        Series::solid("", BLUE, levels.iter().map(|level| (level.h, force(level.h, level.f_n0))).collect()),
        Series::solid("", VERMILION, levels.iter().map(|level| (level.h, area(level.h, level.a0))).collect()),
    ];
    let y = extent(series.iter().flat_map(|s| &s.points).map(|point| point.1).chain([0.0]));
    Ok(Chart {
        title: "Pressing".into(),
        x: Axis::logarithmic("h / R", built.table.range.from, built.table.range.to),
        y: Axis::linear("F_N0 / Hertz and a_0² / (R* h)", 0.0, 1.06 * y.1),
        series,
        bar: None,
    })
}

fn shears(built: &Built) -> Result<Chart, LawError> {
    let parameters = built.coarse.contact_parameters(1.0, 1.0)?;
    let friction = built.coarse.friction().max(1e-6);
    let mut series = Vec::new();
    let checked = |h: f64| built.table.errors.iter().any(|error| error.h == h);
    let mut last: f64 = 0.0;
    for (i, one) in built.measured.iter().filter(|one| checked(one.h)).enumerate() {
        let slip = parameters.virgin(one.h).point.delta_t_end;
        let mut places = vec![[one.h, 0.0]];
        places.extend(one.curve.iter().map(|point| [one.h, point.delta_t]));
        let forces = &drive(&parameters, &places, 4)[1..];
        let name = |name: &'static str| if i == 0 { name } else { "" };
        let x = |delta_t: f64| delta_t / slip;
        last = last.max(one.curve.last().map_or(0.0, |point| x(point.delta_t)));
        let marks = |value: fn(&crate::law::data::ShearPoint) -> f64, scale: f64| {
            one.curve.iter().map(|point| (x(point.delta_t), value(point) / scale)).collect::<Vec<_>>()
        };
        let line = |k: usize, scale: f64| {
            forces.iter().zip(&one.curve).map(|(force, point)| (x(point.delta_t), force[k] / scale)).collect::<Vec<_>>()
        };
        series.push(Series::marks(name("F_N / F_N0"), BLUE, Mark::Dot, marks(|point| point.f_n, one.f_n0)));
        series.push(Series::marks(name("F_T / (μ F_N0)"), VERMILION, Mark::Ring, marks(|point| point.f_t, friction * one.f_n0)));
        series.push(Series::solid("", BLUE, line(0, one.f_n0)));
        series.push(Series::solid("", VERMILION, line(1, friction * one.f_n0)));
    }
    let x = Axis::linear("δ_T / δ_{T,end}", 0.0, 1.03 * last.clamp(0.1, 2.0));
    let y = Axis::linear("F_N / F_N0 and F_T / (μ F_N0)", 0.0, 1.1);
    Ok(Chart { title: "Shear at the checked depths".into(), x, y, series, bar: None })
}

fn errors(errors: &[DepthErrors]) -> Chart {
    let curve = |value: fn(&DepthErrors) -> f64| errors.iter().map(|error| (error.h, 100.0 * value(error).abs())).collect();
    let mut series = vec![
        Series::solid("F_N0", BLUE, curve(|error| error.f_n0)).marked(Mark::Dot),
        Series::solid("a_0", GREEN, curve(|error| error.a0)).marked(Mark::Ring),
        Series::solid("F_T, greatest", VERMILION, curve(|error| error.f_t_max)).marked(Mark::Dot),
        Series::solid("F_N, greatest", GREY, curve(|error| error.f_n_max)).marked(Mark::Ring),
    ];
    let (low, high) = extent(errors.iter().map(|error| error.h));
    let y = extent(series.iter().flat_map(|s| &s.points).map(|point| point.1).chain([2.0]));
    series.push(Series::dashed("1.5 %", INK, 6.0, vec![(1e-9, 1.5), (1.0, 1.5)]));
    Chart {
        title: "Errors at depths between".into(),
        x: Axis::logarithmic("h / R", low, high),
        y: Axis::linear("error (%)", 0.0, 1.06 * y.1),
        series,
        bar: None,
    }
}

impl Built {
    /// The levels of the table over h, for a picture.
    fn curve(&self, count: usize) -> Vec<Level> {
        let curves = Curves::new(&self.table.levels);
        let (from, to) = (self.table.range.from, self.table.range.to);
        (0..=count).map(|i| from * (to / from).powf(i as f64 / count as f64)).map(|h| curves.at(h)).collect()
    }
}
