//! A diagram: axes (linear or logarithmic), grid, curves and marks cut at the frame, a legend in lines above it, a colour bar beside it.

use super::style::{Area, Drawn, FAINT, FONT, INK, PALE, tick, viridis};
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// One axis of a [`Chart`].
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// What it shows, with its unit; `_x` and `_{xyz}` are subscripts, `^x` and `^{xyz}` superscripts.
    pub label: String,
    /// Least and greatest value shown.
    pub range: (f64, f64),
    /// Whether it is logarithmic; the range is positive then.
    pub logarithmic: bool,
}

impl Axis {
    /// A linear axis over a range.
    pub fn linear(label: impl Into<String>, low: f64, high: f64) -> Self {
        Self { label: label.into(), range: widened(low, high), logarithmic: false }
    }

    /// A logarithmic axis over a range, which has to be positive.
    pub fn logarithmic(label: impl Into<String>, low: f64, high: f64) -> Self {
        let low = if low > 0.0 && low.is_finite() { low } else { 1e-3 };
        let high = if high > 1.2 * low && high.is_finite() { high } else { 10.0 * low };
        Self { label: label.into(), range: (low, high), logarithmic: true }
    }

    /// Place of a value, 0 at the lower end and 1 at the upper one; not finite where there is none.
    fn place(&self, value: f64) -> f64 {
        let (low, high) = self.range;
        if self.logarithmic { (value / low).ln() / (high / low).ln() } else { (value - low) / (high - low) }
    }

    /// Where the grid lines are; the labelled ones with their text.
    fn ticks(&self) -> Vec<(f64, Option<String>)> {
        let (low, high) = self.range;
        if !self.logarithmic {
            let step = nice_step((high - low) / 6.0);
            let (first, last) = ((low / step - 1e-9).ceil(), (high / step + 1e-9).floor());
            // Among denormal numbers steps are no longer even, or nothing; a chart without ticks is still one.
            if !step.is_normal() || !(last - first <= 20.0) {
                return Vec::new();
            }
            let (first, last) = (first as i64, last as i64);
            return (first..=last).map(|i| i as f64 * step).map(|value| (value, Some(tick(value)))).collect();
        }
        let decades = (high / low).log10();
        let mut ticks = Vec::new();
        for decade in low.log10().floor() as i32..=high.log10().ceil() as i32 {
            for digit in 1..10 {
                let value = f64::from(digit) * 10f64.powi(decade);
                let labelled = digit == 1 || decades < 2.2 && matches!(digit, 2 | 5);
                if value >= low * (1.0 - 1e-9) && value <= high * (1.0 + 1e-9) {
                    ticks.push((value, labelled.then(|| tick(value))));
                }
            }
        }
        ticks
    }
}

/// Least and greatest of the finite values; (0, 1) if there are none.
pub fn extent(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
    let (low, high) = values
        .into_iter()
        .filter(|value| value.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
    if low.is_finite() { widened(low, high) } else { (0.0, 1.0) }
}

/// The range, widened where its ends coincide.
fn widened(low: f64, high: f64) -> (f64, f64) {
    match (low.is_finite() && high.is_finite(), low < high) {
        (false, _) => (0.0, 1.0),
        (true, true) => (low, high),
        (true, false) => (low - 0.5 * low.abs().max(1e-12), high + 0.5 * high.abs().max(1e-12)),
    }
}

/// 1, 2 or 5 times a power of ten, at least `least`.
pub(super) fn nice_step(least: f64) -> f64 {
    let decade = 10f64.powf(least.log10().floor());
    [1.0, 2.0, 5.0, 10.0].into_iter().map(|digit| digit * decade).find(|&step| step >= least * (1.0 - 1e-9)).unwrap_or(decade)
}

/// How a curve is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Line {
    /// Of that many pixels.
    Solid(u32),
    /// Dashes of that many pixels.
    Dashed(i32),
}

/// The shape of a mark, so that curves are told apart without colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)] // their names say what they are
pub enum Mark {
    Dot,
    Ring,
    Square,
    Triangle,
    Diamond,
}

impl Mark {
    /// The shapes in the order in which groups get them.
    pub const ALL: [Self; 5] = [Self::Dot, Self::Square, Self::Triangle, Self::Diamond, Self::Ring];
}

/// A curve, or marks, or both.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Its entry in the legend; none if empty.
    pub label: String,
    /// Its colour.
    pub colour: RGBColor,
    /// 1 for opaque.
    pub opacity: f64,
    /// The line through the points.
    pub line: Option<Line>,
    /// The mark at each point, with its radius in pixels.
    pub mark: Option<(Mark, i32)>,
    /// The points; those that are not finite are left out.
    pub points: Vec<(f64, f64)>,
}

impl Series {
    /// A line of two pixels.
    pub fn solid(label: impl Into<String>, colour: RGBColor, points: Vec<(f64, f64)>) -> Self {
        Self { label: label.into(), colour, opacity: 1.0, line: Some(Line::Solid(2)), mark: None, points }
    }

    /// A line of dashes, `dash` pixels long.
    pub fn dashed(label: impl Into<String>, colour: RGBColor, dash: i32, points: Vec<(f64, f64)>) -> Self {
        Self { line: Some(Line::Dashed(dash)), ..Self::solid(label, colour, points) }
    }

    /// Marks without a line.
    pub fn marks(label: impl Into<String>, colour: RGBColor, mark: Mark, points: Vec<(f64, f64)>) -> Self {
        Self { line: None, mark: Some((mark, 3)), ..Self::solid(label, colour, points) }
    }

    /// With a mark at each point.
    pub fn marked(self, mark: Mark) -> Self {
        Self { mark: Some((mark, 3)), ..self }
    }
}

/// What the colours of many curves stand for: viridis from the lower end to the upper one, logarithmic.
#[derive(Clone, Debug, PartialEq)]
pub struct ColourBar {
    /// The quantity and its range.
    pub axis: Axis,
}

/// Share of viridis that is used: its yellow end is too light for a line on white.
const VIRIDIS_END: f64 = 0.88;

impl ColourBar {
    /// The colour of a value; the ends' beyond them.
    pub fn colour(&self, value: f64) -> RGBColor {
        let place = self.axis.place(value);
        viridis(VIRIDIS_END * if place.is_nan() { 0.0 } else { place.clamp(0.0, 1.0) })
    }
}

/// A diagram.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    /// Its heading.
    pub title: String,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// Drawn in this order.
    pub series: Vec<Series>,
    /// What the colours stand for, where they are many.
    pub bar: Option<ColourBar>,
}

/// The frame of the diagram in pixels and the way there.
struct Frame<'a> {
    chart: &'a Chart,
    left: i32,
    right: i32,
    top: i32,
    bottom: i32,
}

impl Frame<'_> {
    fn x(&self, value: f64) -> f64 {
        f64::from(self.left) + self.chart.x.place(value) * f64::from(self.right - self.left)
    }

    fn y(&self, value: f64) -> f64 {
        f64::from(self.bottom) - self.chart.y.place(value) * f64::from(self.bottom - self.top)
    }

    fn holds(&self, (x, y): (f64, f64)) -> bool {
        let slack = 0.5;
        x >= f64::from(self.left) - slack
            && x <= f64::from(self.right) + slack
            && y >= f64::from(self.top) - slack
            && y <= f64::from(self.bottom) + slack
    }

    /// The part of the segment inside of the frame (Liang & Barsky 1984).
    fn cut(&self, from: (f64, f64), to: (f64, f64)) -> Option<[(f64, f64); 2]> {
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        let sides = [
            (-dx, from.0 - f64::from(self.left)),
            (dx, f64::from(self.right) - from.0),
            (-dy, from.1 - f64::from(self.top)),
            (dy, f64::from(self.bottom) - from.1),
        ];
        for (step, room) in sides {
            if step == 0.0 {
                if room < 0.0 {
                    return None;
                }
            } else if step < 0.0 {
                enter = enter.max(room / step);
            } else {
                leave = leave.min(room / step);
            }
        }
        let at = |t: f64| (from.0 + t * dx, from.1 + t * dy);
        (enter <= leave).then(|| [at(enter), at(leave)])
    }

    /// The pieces of a curve inside of the frame, in pixels.
    fn pieces(&self, points: &[(f64, f64)]) -> Vec<Vec<(i32, i32)>> {
        let mut pieces: Vec<Vec<(i32, i32)>> = Vec::new();
        let mut open = false;
        for pair in points.windows(2) {
            let [from, to] = [pair[0], pair[1]].map(|(x, y)| (self.x(x), self.y(y)));
            let finite = [from.0, from.1, to.0, to.1].iter().all(|value| value.is_finite());
            let Some([enter, leave]) = finite.then(|| self.cut(from, to)).flatten() else {
                open = false;
                continue;
            };
            if !open || enter != from {
                pieces.push(vec![pixel(enter)]);
            }
            if let Some(piece) = pieces.last_mut().filter(|piece| piece.last() != Some(&pixel(leave))) {
                piece.push(pixel(leave));
            }
            open = leave == to;
        }
        pieces.retain(|piece| piece.len() > 1);
        pieces.iter().map(|piece| thinned(piece)).collect()
    }
}

fn pixel((x, y): (f64, f64)) -> (i32, i32) {
    (x.round() as i32, y.round() as i32)
}

/// Without points close to the one before: whole pixels would make a smooth curve of them jagged.
fn thinned(piece: &[(i32, i32)]) -> Vec<(i32, i32)> {
    const CLOSE: i32 = 10;
    let mut kept: Vec<(i32, i32)> = Vec::new();
    for (i, point) in piece.iter().enumerate() {
        let near = kept.last().is_some_and(|last| (point.0 - last.0).abs().max((point.1 - last.1).abs()) < CLOSE);
        if !near || i + 1 == piece.len() {
            kept.push(*point);
        }
    }
    kept
}

/// Width of a text in pixels, roughly: enough to keep things apart.
fn text_width(text: &str, size: i32) -> i32 {
    let shown = text.chars().filter(|c| !matches!(c, '_' | '^' | '{' | '}')).count();
    (0.52 * f64::from(size) * shown as f64).ceil() as i32
}

fn draw_line(root: &Area<'_>, line: Line, colour: RGBAColor, piece: Vec<(i32, i32)>) -> Drawn {
    match line {
        Line::Solid(width) => root.draw(&PathElement::new(piece, colour.stroke_width(width)))?,
        Line::Dashed(dash) => root.draw(&DashedPathElement::new(piece, dash, dash.min(4), colour.stroke_width(2)))?,
    }
    Ok(())
}

fn draw_mark(root: &Area<'_>, (mark, r): (Mark, i32), colour: RGBAColor, (x, y): (i32, i32)) -> Drawn {
    match mark {
        Mark::Dot => root.draw(&Circle::new((x, y), r, colour.filled()))?,
        Mark::Ring => {
            root.draw(&Circle::new((x, y), r, WHITE.filled()))?;
            root.draw(&Circle::new((x, y), r, colour.stroke_width(2)))?;
        }
        Mark::Square => root.draw(&Rectangle::new([(x - r, y - r), (x + r, y + r)], colour.filled()))?,
        Mark::Triangle => root.draw(&Polygon::new([(x - r - 1, y + r), (x + r + 1, y + r), (x, y - r - 1)], colour.filled()))?,
        Mark::Diamond => {
            root.draw(&Polygon::new([(x - r - 1, y), (x, y + r + 1), (x + r + 1, y), (x, y - r - 1)], colour.filled()))?
        }
    }
    Ok(())
}

/// Height of a line of the legend.
const LEGEND_LINE: i32 = 20;
const LEGEND_SIZE: i32 = 13;
const SAMPLE: i32 = 26;

/// Where each entry of the legend stands in lines of the given width: (series, x, line), and the number of lines.
fn legend_places(series: &[Series], width: i32) -> (Vec<(&Series, i32, i32)>, i32) {
    let (mut places, mut x, mut line) = (Vec::new(), 0, 0);
    for entry in series.iter().filter(|entry| !entry.label.is_empty()) {
        let needs = SAMPLE + 7 + text_width(&entry.label, LEGEND_SIZE);
        if x > 0 && x + needs > width {
            (x, line) = (0, line + 1);
        }
        places.push((entry, x, line));
        x += needs + 18;
    }
    let lines = if places.is_empty() { 0 } else { line + 1 };
    (places, lines)
}

/// Draws the diagram over the whole area.
pub fn draw_chart(root: &Area<'_>, chart: &Chart) -> Drawn {
    let (width, height) = root.dim_in_pixel();
    let (width, height) = (width as i32, height as i32);
    let (left, right) = (78, width - if chart.bar.is_some() { 96 } else { 26 });
    let (legend, lines) = legend_places(&chart.series, right - left);
    let frame = Frame { chart, left, right, top: 46 + LEGEND_LINE * lines, bottom: height - 58 };
    let text = |size: i32| (FONT, size).into_font().color(&INK);
    let at = |style: TextStyle<'static>, h, v| style.pos(Pos::new(h, v));

    root.draw(&Text::new(chart.title.clone(), (left, 22), at(text(18), HPos::Left, VPos::Center)))?;
    for (entry, x, line) in legend {
        let (x, y) = (left + x, 48 + LEGEND_LINE * line);
        let colour = entry.colour.mix(entry.opacity.max(0.8));
        if let Some(stroke) = entry.line {
            draw_line(root, stroke, colour, vec![(x, y), (x + SAMPLE, y)])?;
        }
        if let Some((mark, size)) = entry.mark {
            draw_mark(root, (mark, size.max(3)), colour, (x + SAMPLE / 2, y))?;
        }
        root.draw(&Text::new(entry.label.clone(), (x + SAMPLE + 7, y), at(text(LEGEND_SIZE), HPos::Left, VPos::Center)))?;
    }

    for (value, label) in chart.x.ticks() {
        let x = frame.x(value).round() as i32;
        let shade = if label.is_some() { FAINT } else { PALE };
        root.draw(&PathElement::new([(x, frame.top), (x, frame.bottom)], shade.stroke_width(1)))?;
        if let Some(label) = label {
            root.draw(&PathElement::new([(x, frame.bottom), (x, frame.bottom + 5)], INK.stroke_width(1)))?;
            root.draw(&Text::new(label, (x, frame.bottom + 15), at(text(13), HPos::Center, VPos::Center)))?;
        }
    }
    for (value, label) in chart.y.ticks() {
        let y = frame.y(value).round() as i32;
        root.draw(&PathElement::new([(frame.left, y), (frame.right, y)], FAINT.stroke_width(1)))?;
        if let Some(label) = label {
            root.draw(&PathElement::new([(frame.left - 5, y), (frame.left, y)], INK.stroke_width(1)))?;
            root.draw(&Text::new(label, (frame.left - 9, y), at(text(13), HPos::Right, VPos::Center)))?;
        }
    }
    for series in &chart.series {
        let colour = series.colour.mix(series.opacity);
        let finite: Vec<(f64, f64)> = series.points.iter().copied().filter(|p| p.0.is_finite() && p.1.is_finite()).collect();
        if let Some(line) = series.line {
            for piece in frame.pieces(&finite) {
                draw_line(root, line, colour, piece)?;
            }
        }
        if let Some(mark) = series.mark {
            for at in finite.iter().map(|&(x, y)| (frame.x(x), frame.y(y))).filter(|&at| frame.holds(at)) {
                draw_mark(root, mark, colour, pixel(at))?;
            }
        }
    }
    root.draw(&Rectangle::new([(frame.left, frame.top), (frame.right, frame.bottom)], INK.stroke_width(1)))?;

    let middle = ((frame.left + frame.right) / 2, (frame.top + frame.bottom) / 2);
    root.draw(&Text::new(chart.x.label.clone(), (middle.0, height - 20), at(text(15), HPos::Center, VPos::Center)))?;
    let upwards = (FONT, 15).into_font().transform(FontTransform::Rotate270).color(&INK);
    root.draw(&Text::new(chart.y.label.clone(), (16, middle.1), at(upwards, HPos::Center, VPos::Center)))?;
    if let Some(bar) = &chart.bar {
        draw_bar(root, bar, frame.right + 20, frame.top + 24, frame.bottom)?;
    }
    Ok(())
}

fn draw_bar(root: &Area<'_>, bar: &ColourBar, left: i32, top: i32, bottom: i32) -> Drawn {
    let label = (FONT, 14).into_font().color(&INK).pos(Pos::new(HPos::Left, VPos::Center));
    root.draw(&Text::new(bar.axis.label.clone(), (left, top - 16), label))?;
    for y in top..bottom {
        let share = f64::from(bottom - y) / f64::from(bottom - top);
        root.draw(&Rectangle::new([(left, y), (left + 16, y + 1)], viridis(VIRIDIS_END * share).filled()))?;
    }
    for (value, label) in bar.axis.ticks().into_iter().filter_map(|(value, label)| Some((value, label?))) {
        let y = bottom - (bar.axis.place(value) * f64::from(bottom - top)).round() as i32;
        root.draw(&PathElement::new([(left + 16, y), (left + 21, y)], INK.stroke_width(1)))?;
        let style = (FONT, 13).into_font().color(&INK).pos(Pos::new(HPos::Left, VPos::Center));
        root.draw(&Text::new(label, (left + 25, y), style))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis) -> Vec<String> {
        axis.ticks().into_iter().filter_map(|(_, label)| label).collect()
    }

    #[test]
    fn ticks_are_round_and_inside() {
        assert_eq!(labels(&Axis::linear("", 0.0, 1.0)), ["0", "0.2", "0.4", "0.6", "0.8", "1"]);
        assert_eq!(labels(&Axis::linear("", -0.003, 0.0011)), ["-0.003", "-0.002", "-0.001", "0", "0.001"]);
        assert_eq!(labels(&Axis::logarithmic("", 0.35, 3600.0)), ["1", "10", "100", "1000"]);
        assert_eq!(labels(&Axis::logarithmic("", 2.0, 40.0)), ["2", "5", "10", "20"]);
        // Nothing to show is no reason to stop.
        assert!(!labels(&Axis::linear("", f64::NAN, 1.0)).is_empty() && !labels(&Axis::logarithmic("", 0.0, 0.0)).is_empty());
    }

    #[test]
    fn curves_end_at_the_frame() {
        let (x, y) = (Axis::linear("", 0.0, 1.0), Axis::linear("", 0.0, 1.0));
        let chart = Chart { title: String::new(), x, y, series: Vec::new(), bar: None };
        let frame = Frame { chart: &chart, left: 0, right: 100, top: 0, bottom: 100 };
        // In, out at the top, and in again.
        let pieces = frame.pieces(&[(0.0, 0.0), (0.5, 1.0), (0.6, 2.0), (0.9, 2.0), (1.0, 0.0)]);
        assert_eq!(pieces, [vec![(0, 100), (50, 0)], vec![(95, 0), (100, 100)]]);
        assert!(frame.pieces(&[(-1.0, 0.5), (-0.5, 0.7)]).is_empty());
        // A logarithm of zero is left out.
        let chart = Chart { x: Axis::logarithmic("", 1.0, 10.0), ..chart.clone() };
        let frame = Frame { chart: &chart, left: 0, right: 100, top: 0, bottom: 100 };
        assert_eq!(frame.pieces(&[(0.0, 0.5), (1.0, 0.5), (10.0, 0.5)]), [vec![(0, 50), (100, 50)]]);
    }

    #[test]
    fn entries_of_the_legend_do_not_overlap() {
        let entry = |label: &str| Series::solid(label, INK, Vec::new());
        let series = [entry("F_{N,slip} of the simulation"), entry(""), entry("Olsson & Larsson 2016"), entry("Hertz")];
        let (places, lines) = legend_places(&series, 300);
        assert_eq!((places.len(), lines), (3, 2));
        assert_eq!((places[1].1, places[1].2), (0, 1));
        assert!(places[2].1 > SAMPLE + text_width("Olsson & Larsson 2016", LEGEND_SIZE));
    }

    /// Steps between denormal numbers are nothing, or not even: there were once 2^64 ticks to make room for.
    #[test]
    fn an_axis_over_the_least_numbers_has_few_ticks_or_none() {
        for (low, high) in
            [(0.0, 5e-324), (0.0, 1e-322), (5e-324, 1e-320), (-1e-310, 1e-308), (0.0, f64::MAX), (-f64::MAX, f64::MAX)]
        {
            assert!(Axis::linear("F", low, high).ticks().len() <= 21, "{low:e} {high:e}");
        }
        assert!(Axis::linear("F", 0.0, 1e-300).ticks().len() > 3);
    }
}
