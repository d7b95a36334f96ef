//! The four diagrams of the page, drawn as all diagrams of the program are, and what each of their
//! curves is.

use serde_json::{Value, json};

use super::curves::LawCurves;
use super::results::ShownCase;
use super::simulate::SimulatedRun;
use crate::analytical::hertz;
use crate::case::{Case, PictureWidth, WidthUnit};
use crate::output::plots::axes::{Axes, AxisUnits, Dimension, Shown};
use crate::output::plots::chart::{Axis, Chart, Mark, Series, draw_chart, extent};
use crate::output::plots::style::{BLUE, GREEN, GREY, ORANGE, PURPLE, VERMILION, tick};
use crate::output::plots::{Picture, Sheet, View, from_zero, greatest};
use crate::output::{OutputError, StepRecord};

/// The band of a law is as wide as so many times its root mean square error.
pub const BAND: f64 = 2.0;
/// Points of a closed form.
const POINTS: usize = 80;
/// A chart's width and height where there is room, pixels.
const SIZE: (u32, u32) = (620, 430);
/// Widths that are drawn, pixels.
const WIDTHS: (f64, f64) = (320.0, 620.0);

/// What lies over the law.
#[derive(Clone, Debug, Default)]
pub struct Overlay<'a> {
    /// A simulation of the same contact.
    pub run: Option<&'a SimulatedRun>,
    /// Cases of a study of the same contact.
    pub study: Vec<&'a ShownCase>,
    /// The rows of the one of the same depth, with its name.
    pub of_depth: Option<(String, Vec<StepRecord>)>,
}

/// A curve of a diagram: what it is, where it comes from, and how far it can be trusted.
struct ChartCurve {
    name: &'static str,
    source: String,
    trust: String,
}

/// A diagram and what it shows.
pub struct Drawing {
    picture: Picture,
    title: &'static str,
    curves: Vec<ChartCurve>,
}

impl Drawing {
    /// For the page.
    pub fn json(&self) -> Value {
        let curve = |curve: &ChartCurve| json!({ "name": curve.name, "source": curve.source, "trust": curve.trust });
        json!({
            "name": self.picture.name,
            "title": self.title,
            "svg": self.picture.svg,
            "words": self.picture.caption,
            "curves": self.curves.iter().map(curve).collect::<Vec<_>>(),
        })
    }
}

/// The units and the width of the page's pictures.
pub fn view(case: &Case, axes: &str, width: f64) -> View {
    let units = if axes == "none" { AxisUnits::Normalised } else { AxisUnits::Case };
    let value = if width.is_finite() { width.clamp(WIDTHS.0, WIDTHS.1).round() } else { WIDTHS.1 };
    View {
        axes: Axes::of(case, units),
        sheet: Sheet { width: Some(PictureWidth { value, unit: WidthUnit::Pixel }), untitled: false },
    }
}

/// All diagrams.
///
/// # Errors
/// A drawing fails.
pub fn drawings(curves: &LawCurves, over: &Overlay<'_>, view: &View) -> Result<Vec<Drawing>, OutputError> {
    let page = Page { curves, over, view };
    Ok(vec![page.press()?, page.tangential()?, page.normal()?, page.cycle()?])
}

struct Page<'a> {
    curves: &'a LawCurves,
    over: &'a Overlay<'a>,
    view: &'a View,
}

type Of = fn(&StepRecord) -> f64;

/// Both axes, with their factors.
struct ChartScales {
    x: Shown,
    y: Shown,
}

impl ChartScales {
    fn at(&self, x: f64, y: f64) -> (f64, f64) {
        (x * self.x.factor, y * self.y.factor)
    }

    fn of(&self, rows: &[StepRecord], x: Of, y: Of) -> Vec<(f64, f64)> {
        rows.iter().map(|row| self.at(x(row), y(row))).collect()
    }
}

fn percent([rms, most]: [f64; 2]) -> String {
    format!("{:.1} % rms, {:.1} % at worst", 100.0 * rms, 100.0 * most)
}

impl Page<'_> {
    /// A law's curve with the band of its errors, which is as wide as `error`, a force.
    fn law(&self, scales: &ChartScales, rows: &[StepRecord], [x, y]: [Of; 2], error: impl Fn(&StepRecord) -> f64) -> Vec<Series> {
        let edge = |sign: f64| rows.iter().map(|row| scales.at(x(row), (y(row) + sign * error(row)).max(0.0))).collect();
        vec![Series::band("", BLUE, edge(-1.0), edge(1.0)), Series::solid("law", BLUE, scales.of(rows, x, y))]
    }

    fn law_curve(&self, errors: [f64; 2], what: &str) -> ChartCurve {
        let (trust, outside) = (&self.curves.trust, &self.curves.out_of_range);
        let list: Vec<String> = outside.iter().map(ToString::to_string).collect();
        let far = if list.is_empty() && !trust.is_known {
            "How far it is off is not known: compare it with a simulation".to_owned()
        } else if list.is_empty() {
            format!("{what} is off by {}, over {}. The band is twice the rms", percent(errors), trust.over)
        } else {
            format!("Outside of what the law was made from ({}): compare it with a simulation", list.join(", "))
        };
        ChartCurve { name: "law", source: trust.source.clone(), trust: far }
    }

    fn closed_form(&self, name: &'static str, whose: &str) -> ChartCurve {
        let yields = self.curves.first_yield.filter(|first| *first < self.curves.h);
        let trust = match yields {
            Some(first) => format!("This contact yields from h = {} on", tick(first)),
            None => "Exact for a small elastic contact, 1 % off in the force at a/R = 0.1".to_owned(),
        };
        ChartCurve { name, source: format!("closed form of an elastic contact ({whose})"), trust }
    }

    /// A simulation of this contact along this path, or along one that begins with the same press.
    fn simulated(&self) -> Option<(&[StepRecord], ChartCurve)> {
        let run = self.over.run?;
        let mesh = run.case.mesh.elements_per_contact_radius;
        let error = run.summary.as_ref().and_then(|summary| Some(summary.f_n0_error? / summary.f_n0?));
        let error = error.map_or_else(
            || "Its error is estimated when it has ended".to_owned(),
            |error| format!("F_N0 within {:.1} % by its own estimate", 100.0 * error),
        );
        let source = format!("finite elements, {mesh} along the contact radius ({})", run.stage.word());
        Some((&run.history, ChartCurve { name: "simulation", source, trust: error }))
    }

    fn of_study(&self) -> Option<(&[StepRecord], ChartCurve)> {
        let (id, rows) = self.over.of_depth.as_ref()?;
        let curve = ChartCurve {
            name: "study",
            source: format!("finite elements, case {id} of the study"),
            trust: "As accurate as the mesh of the study".to_owned(),
        };
        Some((rows, curve))
    }

    /// Adds marks of a simulation's rows that are left by `which`.
    fn marks(
        &self,
        scales: &ChartScales,
        [x, y]: [Of; 2],
        which: impl Fn(&[StepRecord]) -> &[StepRecord],
    ) -> (Vec<Series>, Vec<ChartCurve>) {
        let (mut series, mut curves) = (Vec::new(), Vec::new());
        for (found, colour, mark) in [(self.simulated(), VERMILION, Mark::Ring), (self.of_study(), PURPLE, Mark::Square)] {
            let Some((rows, curve)) = found else { continue };
            let points = scales.of(which(rows), x, y);
            if !points.is_empty() {
                series.push(Series::marks(curve.name, colour, mark, points));
                curves.push(curve);
            }
        }
        (series, curves)
    }

    fn length(&self, words: &str, symbol: &str, most: f64) -> Shown {
        self.view.axes.show(Dimension::Length, words, symbol, most)
    }

    fn force(&self, words: &str, symbol: &str, most: f64) -> Shown {
        self.view.axes.show(Dimension::Force, words, symbol, most)
    }

    /// F_N(h).
    fn press(&self) -> Result<Drawing, OutputError> {
        let c = self.curves;
        let rows = c.press();
        let most = greatest(rows.iter().map(|row| row.f_n));
        let scales = ChartScales { x: self.length("indentation", "h", c.h), y: self.force("normal force", "F_N", most) };
        let hertz: Vec<(f64, f64)> = (0..=POINTS)
            .map(|i| c.h * (i as f64 / POINTS as f64).powi(2))
            .map(|h| scales.at(h, hertz::force(&c.elastic, h)))
            .collect();
        let mut series = self.law(&scales, rows, [|row| row.h, |row| row.f_n], |row| BAND * c.trust.press[0] * row.f_n);
        series.push(Series::dashed("Hertz", GREY, 3.0, hertz));
        let mut curves = vec![self.law_curve(c.trust.press, "F_N0"), self.closed_form("Hertz", "Hertz 1882")];
        let (marks, of) = self.marks(&scales, [|row| row.h, |row| row.f_n], pressing);
        series.extend(marks);
        curves.extend(of);
        let others: Vec<(f64, f64)> =
            self.over.study.iter().filter_map(|one| Some(scales.at(one.summary.h0?, one.summary.f_n0?))).collect();
        if !others.is_empty() {
            let is_named = curves.iter().any(|curve| curve.name == "study");
            series.push(Series::marks(if is_named { "" } else { "study" }, PURPLE, Mark::Square, others));
            if !is_named {
                let (source, trust) =
                    ("finite elements, cases of the study of this contact", "As accurate as the mesh of the study");
                curves.push(ChartCurve { name: "study", source: source.to_owned(), trust: trust.to_owned() });
            }
        }
        let top = 1.35 * series_top(&series, &["Hertz"]).max(most * scales.y.factor);
        if let Some(first) = c.first_yield.filter(|first| *first <= c.h) {
            let x = scales.x.factor * first;
            series.push(Series::dashed("first yield", ORANGE, 5.0, vec![(x, 0.0), (x, top)]));
            let source = "closed form (Hertz's contact, Mises' criterion)".to_owned();
            curves.push(ChartCurve {
                name: "first yield",
                source,
                trust: "Exact for a small contact without friction".to_owned(),
            });
        }
        let chart = Chart {
            title: "Normal force of a press".into(),
            x: Axis::linear(&scales.x.label, 0.0, 1.02 * c.h * scales.x.factor),
            y: Axis::linear(&scales.y.label, 0.0, top),
            series,
            bar: None,
        };
        let words = format!(
            "Normal force over the indentation. The law rises to {} at h = {}; Hertz's elastic contact would have {}.",
            tick(most),
            tick(c.h),
            tick(hertz::force(&c.elastic, c.h))
        );
        self.draw("press", "F_N over h: press", chart, words, curves)
    }

    /// F_T(delta_T) at constant h.
    fn tangential(&self) -> Result<Drawing, OutputError> {
        let (c, rows) = (self.curves, self.curves.slip());
        let (end, peak) = (greatest(rows.iter().map(|row| row.delta_t)), greatest(rows.iter().map(|row| row.f_t)));
        let scales = ChartScales {
            x: self.length("tangential displacement", "δ_T", end),
            y: self.force("tangential force", "F_T", peak),
        };
        let mindlin = c.mindlin();
        let closed = (0..=POINTS).map(|i| end * (i as f64 / POINTS as f64).powi(2)).map(|d| scales.at(d, mindlin.force(d)));
        let error = BAND * c.trust.tangential[0] * peak;
        // Where the shear sets out the force is none, and no error is more than it.
        let begins = |row: &StepRecord| error.min(row.f_t);
        let mut series = self.law(&scales, rows, [|row| row.delta_t, |row| row.f_t], begins);
        series.push(Series::dashed("Mindlin", GREY, 3.0, closed.collect()));
        let mut curves = vec![
            self.law_curve(c.trust.tangential, "F_T, of its peak"),
            self.closed_form("Mindlin", "Cattaneo 1938, Mindlin 1949, at the same h"),
        ];
        let (marks, of) = self.marks(&scales, [|row| row.delta_t, |row| row.f_t], |rows| first_shear(rows, c.h));
        series.extend(marks);
        curves.extend(of);
        let words = format!(
            "Tangential force over the displacement at constant indentation. The law's peak is {}; Mindlin's elastic contact \
             slips at {}.",
            tick(peak),
            tick(mindlin.friction * mindlin.normal_force)
        );
        let chart = self.over_shear("Tangential force at constant h", &scales, end, peak, series);
        self.draw("tangential", "F_T over δ_T: shear at constant h", chart, words, curves)
    }

    /// F_N(delta_T) at constant h.
    fn normal(&self) -> Result<Drawing, OutputError> {
        let (c, rows) = (self.curves, self.curves.slip());
        let (end, most) = (greatest(rows.iter().map(|row| row.delta_t)), greatest(rows.iter().map(|row| row.f_n)));
        let scales =
            ChartScales { x: self.length("tangential displacement", "δ_T", end), y: self.force("normal force", "F_N", most) };
        let elastic = c.mindlin().normal_force;
        let error = BAND * c.trust.normal[0].hypot(c.trust.press[0]) * most;
        let mut series = self.law(&scales, rows, [|row| row.delta_t, |row| row.f_n], |_| error);
        series.push(Series::dashed("Hertz", GREY, 3.0, vec![scales.at(0.0, elastic), scales.at(end, elastic)]));
        let mut curves = vec![
            self.law_curve(c.trust.normal, "F_N, of F_N0"),
            self.closed_form("Hertz", &format!("Hertz 1882: it keeps its F_N, {}", tick(elastic))),
        ];
        let (marks, of) = self.marks(&scales, [|row| row.delta_t, |row| row.f_n], |rows| first_shear(rows, c.h));
        series.extend(marks);
        curves.extend(of);
        let last = rows.last().map_or(0.0, |row| row.f_n);
        let words = format!(
            "Normal force over the tangential displacement at constant indentation. The law falls from {} to {}.",
            tick(most),
            tick(last)
        );
        let chart = self.over_shear("Normal force at constant h", &scales, end, most, series);
        self.draw("normal", "F_N over δ_T: shear at constant h", chart, words, curves)
    }

    /// A diagram of a shear: what is off the scale of law and simulation is cut.
    fn over_shear(&self, title: &str, scales: &ChartScales, end: f64, most: f64, series: Vec<Series>) -> Chart {
        let top = series_top(&series, &["Hertz", "Mindlin"]).max(most * scales.y.factor);
        Chart {
            title: title.into(),
            x: Axis::linear(&scales.x.label, 0.0, end * scales.x.factor),
            y: from_zero(&scales.y.label, [top * if self.curves.yields() { 1.25 } else { 1.0 }]),
            series,
            bar: None,
        }
    }

    /// The whole cycle: F_T and F_N over delta_T.
    fn cycle(&self) -> Result<Drawing, OutputError> {
        let rows = &self.curves.cycle;
        let from = rows.iter().position(|row| row.delta_t != 0.0).map_or(0, |at| at.saturating_sub(1));
        let rows = &rows[from..];
        let all: Of = |row| row.delta_t;
        let scales = ChartScales {
            x: self.length("tangential displacement", "δ_T", greatest(rows.iter().map(all))),
            y: self.force("force", "F", greatest(rows.iter().flat_map(|row| [row.f_n, row.f_t]))),
        };
        let f_t = scales.of(rows, all, |row| row.f_t);
        let mut series = vec![
            Series::dashed("F_N, law", GREEN, 7.0, scales.of(rows, all, |row| row.f_n)),
            Series::solid("F_T, law", BLUE, f_t).directed(),
        ];
        let update = ChartCurve {
            name: "law",
            source: "the update that an engine calls, driven along the path".to_owned(),
            trust: "Of a whole cycle no error is known for each contact; docs/law-errors.md has those of random paths".to_owned(),
        };
        let mut curves = vec![update];
        let simulated = self.simulated().filter(|_| self.over.run.is_some_and(|run| run.case.path == self.curves.case.path));
        if let Some((rows, curve)) = simulated {
            let rows = sheared(rows);
            if rows.len() > 1 {
                series.push(Series::marks("F_N, simulation", ORANGE, Mark::Square, scales.of(rows, all, |row| row.f_n)));
                series.push(Series::marks("F_T, simulation", VERMILION, Mark::Ring, scales.of(rows, all, |row| row.f_t)));
                curves.push(curve);
            }
        }
        let points = || series.iter().flat_map(|one| &one.points);
        let (low, high) = extent(points().map(|point| point.0));
        let room = 0.03 * (high - low);
        let chart = Chart {
            title: "Cycle: press, shear, back".into(),
            x: Axis::linear(&scales.x.label, low - room, high + room),
            y: from_zero(&scales.y.label, points().map(|point| point.1)),
            series,
            bar: None,
        };
        let words = "Both forces over the tangential displacement along the whole path: press, shear, back, release.".to_owned();
        self.draw("cycle", "F_T and F_N over δ_T: cycle", chart, words, curves)
    }

    fn draw(
        &self,
        name: &'static str,
        title: &'static str,
        chart: Chart,
        words: String,
        curves: Vec<ChartCurve>,
    ) -> Result<Drawing, OutputError> {
        let size = self.view.sheet.chart(SIZE);
        let picture = Picture::draw(name, words, size, |root| draw_chart(root, &chart))?;
        Ok(Drawing { picture, title, curves })
    }
}

/// The greatest value of the series but of those of some names.
fn series_top(series: &[Series], but: &[&str]) -> f64 {
    greatest(series.iter().filter(|one| !but.contains(&one.label.as_str())).flat_map(|one| &one.points).map(|point| point.1))
}

/// The rows up to the first shear.
fn pressing(rows: &[StepRecord]) -> &[StepRecord] {
    let end = rows.iter().position(|row| row.delta_t != 0.0).unwrap_or(rows.len());
    &rows[..end]
}

/// The rows from the start of the shear.
fn sheared(rows: &[StepRecord]) -> &[StepRecord] {
    &rows[pressing(rows).len().saturating_sub(1)..]
}

/// The rows of the first shear, with where it starts, if it is one at this h.
fn first_shear(rows: &[StepRecord], h: f64) -> &[StepRecord] {
    let rows = sheared(rows);
    let Some(first) = rows.get(1) else { return &[] };
    let is_there = |row: &StepRecord| (row.h / h - 1.0).abs() < 1e-6;
    if !is_there(first) {
        return &[];
    }
    let stays = |row: &&StepRecord| row.segment == first.segment && is_there(row);
    let length = rows[1..].iter().take_while(stays).count();
    &rows[..=length]
}
