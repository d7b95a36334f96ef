//! A diagram: axes (linear or logarithmic), grid, curves and marks cut at the frame, a legend in
//! lines above it, a colour bar beside it.

use super::canvas::{Anchor, Canvas, Colour, Drawn, Ink, Paint, Pixel, Stroke, Writing};
use super::field::clipped;
use super::style::{FAINT, INK, PALE, WHITE, tick, viridis};
use super::text::text_width;

/// About as many intervals between ticks has an axis at most.
const MOST_TICKS: f64 = 6.0;

/// One axis of a [`Chart`].
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// What it shows, with its unit; `_x` and `_{xyz}` are subscripts, `^x` and `^{xyz}`
    /// superscripts.
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

    /// Where the grid lines are, about `count` of them on a linear axis; the labelled ones with
    /// their text.
    fn ticks(&self, count: f64) -> Vec<(f64, Option<String>)> {
        let (low, high) = self.range;
        if !self.logarithmic {
            let step = nice_step((high - low) / count);
            let (first, last) = ((low / step - 1e-9).ceil(), (high / step + 1e-9).floor());
            // Among denormal numbers steps are no longer even, or nothing; a chart without ticks is
            // still one.
            if !step.is_normal() || !(last - first <= 20.0) {
                return Vec::new();
            }
            let (first, last) = (first as i64, last as i64);
            return (first..=last).map(|i| i as f64 * step).map(|value| (value, Some(tick(value)))).collect();
        }
        let decades = (high / low).log10();
        // Where there is little room, every other decade, or fewer.
        let every = (decades / count).ceil().max(1.0) as i32;
        let mut ticks = Vec::new();
        for decade in low.log10().floor() as i32..=high.log10().ceil() as i32 {
            for digit in 1..10 {
                let value = f64::from(digit) * 10f64.powi(decade);
                let labelled =
                    digit == 1 && decade % every == 0 || decades < 2.2 && count >= MOST_TICKS && matches!(digit, 2 | 5);
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
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Line {
    /// Of that many pixels.
    Solid(f64),
    /// Dashes of that many pixels.
    Dashed(f64),
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
    pub colour: Colour,
    /// 1 for opaque.
    pub opacity: f64,
    /// The line through the points.
    pub line: Option<Line>,
    /// The mark at each point, with its radius in pixels.
    pub mark: Option<(Mark, f64)>,
    /// The points; those that are not finite are left out.
    pub points: Vec<(f64, f64)>,
    /// Whether an arrow on the line shows in which order the points follow each other.
    pub arrow: bool,
    /// Whether the area that the points go round is filled.
    pub filled: bool,
}

impl Series {
    /// A line of two pixels.
    pub fn solid(label: impl Into<String>, colour: Colour, points: Vec<(f64, f64)>) -> Self {
        let line = Some(Line::Solid(2.0));
        Self { label: label.into(), colour, opacity: 1.0, line, mark: None, points, arrow: false, filled: false }
    }

    /// The area between two curves, pale.
    pub fn band(label: impl Into<String>, colour: Colour, low: Vec<(f64, f64)>, high: Vec<(f64, f64)>) -> Self {
        let points = low.into_iter().chain(high.into_iter().rev()).collect();
        Self { line: None, opacity: 0.2, filled: true, ..Self::solid(label, colour, points) }
    }

    /// A line of dashes, `dash` pixels long.
    pub fn dashed(label: impl Into<String>, colour: Colour, dash: f64, points: Vec<(f64, f64)>) -> Self {
        Self { line: Some(Line::Dashed(dash)), ..Self::solid(label, colour, points) }
    }

    /// Marks without a line.
    pub fn marks(label: impl Into<String>, colour: Colour, mark: Mark, points: Vec<(f64, f64)>) -> Self {
        Self { line: None, mark: Some((mark, 3.0)), ..Self::solid(label, colour, points) }
    }

    /// With an arrow.
    pub fn directed(self) -> Self {
        Self { arrow: true, ..self }
    }

    /// With a mark at each point.
    pub fn marked(self, mark: Mark) -> Self {
        Self { mark: Some((mark, 3.0)), ..self }
    }
}

/// What the colours of many curves stand for: viridis from the lower end to the upper one.
#[derive(Clone, Debug, PartialEq)]
pub struct ColourBar {
    /// The quantity and its range.
    pub axis: Axis,
}

/// Share of viridis that is used: its yellow end is too light for a line on white.
const VIRIDIS_END: f64 = 0.88;

impl ColourBar {
    /// The colour of a value; the ends' beyond them.
    pub fn colour(&self, value: f64) -> Colour {
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
struct PlotArea<'a> {
    chart: &'a Chart,
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
}

impl PlotArea<'_> {
    fn x(&self, value: f64) -> f64 {
        self.left + self.chart.x.place(value) * (self.right - self.left)
    }

    fn y(&self, value: f64) -> f64 {
        self.bottom - self.chart.y.place(value) * (self.bottom - self.top)
    }

    fn holds(&self, (x, y): (f64, f64)) -> bool {
        let slack = 0.5;
        x >= self.left - slack && x <= self.right + slack && y >= self.top - slack && y <= self.bottom + slack
    }

    /// The part of the segment inside of the frame (Liang & Barsky 1984).
    fn cut(&self, from: (f64, f64), to: (f64, f64)) -> Option<[(f64, f64); 2]> {
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        let sides = [(-dx, from.0 - self.left), (dx, self.right - from.0), (-dy, from.1 - self.top), (dy, self.bottom - from.1)];
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

    /// Whether anything of a series is inside of the frame. One without points is there for its
    /// entry in the legend.
    fn shows(&self, series: &Series) -> bool {
        let finite = finite(&series.points);
        let marked = series.mark.is_some() && finite.iter().any(|&(x, y)| self.holds((self.x(x), self.y(y))));
        let drawn = series.line.is_some() && !self.pieces(&finite).is_empty();
        series.points.is_empty() || marked || drawn || series.filled && !self.area(&finite).is_empty()
    }

    /// The part of a filled area inside of the frame, in pixels.
    fn area(&self, points: &[(f64, f64)]) -> Vec<Pixel> {
        let places = points.iter().map(|&(x, y)| (self.x(x), self.y(y))).filter(|(x, y)| x.is_finite() && y.is_finite());
        clipped(&places.collect::<Vec<Pixel>>(), [(self.left, self.top), (self.right, self.bottom)])
    }

    /// The pieces of a curve inside of the frame, in pixels.
    fn pieces(&self, points: &[(f64, f64)]) -> Vec<Vec<Pixel>> {
        let mut pieces: Vec<Vec<Pixel>> = Vec::new();
        let mut open = false;
        for pair in points.windows(2) {
            let [from, to] = [pair[0], pair[1]].map(|(x, y)| (self.x(x), self.y(y)));
            let finite = [from.0, from.1, to.0, to.1].iter().all(|value| value.is_finite());
            let Some([enter, leave]) = finite.then(|| self.cut(from, to)).flatten() else {
                open = false;
                continue;
            };
            if !open || enter != from {
                pieces.push(vec![enter]);
            }
            if let Some(piece) = pieces.last_mut().filter(|piece| piece.last() != Some(&leave)) {
                piece.push(leave);
            }
            open = leave == to;
        }
        pieces.retain(|piece| piece.len() > 1);
        pieces.iter().map(|piece| thinned(piece)).collect()
    }
}

fn finite(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    points.iter().copied().filter(|point| point.0.is_finite() && point.1.is_finite()).collect()
}

/// Without points that no eye could tell from the one before; the last one stays.
fn thinned(piece: &[Pixel]) -> Vec<Pixel> {
    const CLOSE: f64 = 0.5;
    let mut kept: Vec<Pixel> = Vec::new();
    for (i, point) in piece.iter().enumerate() {
        let near = kept.last().is_some_and(|last| (point.0 - last.0).abs().max((point.1 - last.1).abs()) < CLOSE);
        if !near || i + 1 == piece.len() {
            kept.push(*point);
        }
    }
    kept
}

fn draw_line(root: &Canvas, line: Line, ink: Ink, piece: &[Pixel]) -> Drawn {
    root.line(
        piece,
        match line {
            Line::Solid(width) => Stroke::solid(ink, width),
            Line::Dashed(dash) => Stroke { dashes: Some([dash, dash.min(4.0)]), ..Stroke::solid(ink, 2.0) },
        },
    )
}

/// An arrow head in the middle of a curve, along it; none on a short one.
fn draw_arrow(root: &Canvas, ink: Ink, pieces: &[Vec<Pixel>]) -> Drawn {
    const SHORTEST: f64 = 24.0;
    let segments: Vec<[Pixel; 2]> = pieces.iter().flat_map(|piece| piece.windows(2).map(|pair| [pair[0], pair[1]])).collect();
    let length = |[from, to]: &[Pixel; 2]| (to.0 - from.0).hypot(to.1 - from.1);
    let whole: f64 = segments.iter().map(length).sum();
    if whole < SHORTEST {
        return Ok(());
    }
    let mut before = 0.0;
    for segment in &segments {
        let own = length(segment);
        if before + own >= 0.5 * whole {
            let [from, to] = *segment;
            let (along, share) = (((to.0 - from.0) / own, (to.1 - from.1) / own), (0.5 * whole - before) / own);
            let tip = (from.0 + share * (to.0 - from.0) + 6.0 * along.0, from.1 + share * (to.1 - from.1) + 6.0 * along.1);
            let back = |aside: f64| (tip.0 - 16.0 * along.0 - aside * along.1, tip.1 - 16.0 * along.1 + aside * along.0);
            return root.polygon(&[tip, back(4.0), back(-4.0)], Paint::fill(ink));
        }
        before += own;
    }
    Ok(())
}

fn draw_mark(root: &Canvas, (mark, r): (Mark, f64), ink: Ink, (x, y): Pixel) -> Drawn {
    let fill = Paint::fill(ink);
    match mark {
        Mark::Dot => root.circle((x, y), r, fill),
        Mark::Ring => {
            root.circle((x, y), r, Paint::fill(WHITE))?;
            root.circle((x, y), r, Paint::outline(ink, 2.0))
        }
        Mark::Square => root.rectangle([(x - r, y - r), (x + r, y + r)], fill),
        Mark::Triangle => root.polygon(&[(x - r - 1.0, y + r), (x + r + 1.0, y + r), (x, y - r - 1.0)], fill),
        Mark::Diamond => root.polygon(&[(x - r - 1.0, y), (x, y + r + 1.0), (x + r + 1.0, y), (x, y - r - 1.0)], fill),
    }
}

/// Height of the title.
const TITLE: f64 = 28.0;
/// Height of a line of the legend.
const LEGEND_LINE: f64 = 20.0;
const LEGEND_SIZE: f64 = 13.0;
/// Size of the numbers on axes.
const TICK_SIZE: f64 = 13.0;
const SAMPLE: f64 = 26.0;

/// Where each entry of the legend stands in lines of the given width: (series, x, line), and the
/// number of lines.
fn legend_places(series: &[Series], width: f64) -> (Vec<(&Series, f64, usize)>, usize) {
    let (mut places, mut x, mut line) = (Vec::new(), 0.0, 0);
    for entry in series.iter().filter(|entry| !entry.label.is_empty()) {
        let needs = SAMPLE + 7.0 + text_width(&entry.label, LEGEND_SIZE);
        if x > 0.0 && x + needs > width {
            (x, line) = (0.0, line + 1);
        }
        places.push((entry, x, line));
        x += needs + 18.0;
    }
    let lines = if places.is_empty() { 0 } else { line + 1 };
    (places, lines)
}

/// The size at which a text of at most `size` is no wider than `room`.
fn fitting(text: &str, size: f64, room: f64) -> f64 {
    size * (room / text_width(text, size)).min(1.0)
}

/// Draws the entries of a legend between `left` and `right`, the first line of them at `first`.
fn draw_legend(root: &Canvas, legend: &[(&Series, f64, usize)], [left, right]: [f64; 2], first: f64) -> Drawn {
    for &(entry, x, line) in legend {
        let (x, y) = (left + x, first + LEGEND_LINE * line as f64);
        if entry.filled {
            root.rectangle([(x, y - 6.0), (x + SAMPLE, y + 6.0)], Paint::fill(entry.colour.mix(entry.opacity)))?;
        }
        let ink = entry.colour.mix(entry.opacity.max(0.8));
        if let Some(stroke) = entry.line {
            draw_line(root, stroke, ink, &[(x, y), (x + SAMPLE, y)])?;
        }
        if let Some((mark, size)) = entry.mark {
            draw_mark(root, (mark, size.max(3.0)), ink, (x + 0.5 * SAMPLE, y))?;
        }
        let size = fitting(&entry.label, LEGEND_SIZE, right - x - SAMPLE - 7.0);
        root.text(&entry.label, (x + SAMPLE + 7.0, y), INK, Writing::new(size, Anchor::Start))?;
    }
    Ok(())
}

/// Draws the diagram over the whole canvas.
pub fn draw_chart(root: &Canvas, chart: &Chart) -> Drawn {
    let high = (root.height - 130.0).max(1.0);
    let y_ticks = chart.y.ticks((high / 38.0).clamp(2.0, MOST_TICKS));
    let widest = y_ticks.iter().flat_map(|tick| &tick.1).map(|label| text_width(label, TICK_SIZE)).fold(0.0, f64::max);
    let (left, right) = (38.0 + widest.max(24.0), root.width - if chart.bar.is_some() { 84.0 } else { 22.0 });
    let frame = PlotArea { chart, left, right, top: 0.0, bottom: root.height - 58.0 };
    // What is off the scale has no entry. The height of the frame does not matter for that.
    let shown: Vec<Series> = chart.series.iter().filter(|series| frame.shows(series)).cloned().collect();
    let (legend, lines) = legend_places(&shown, right - left);
    // The first line below the title, or below the edge.
    let first = if root.untitled || chart.title.is_empty() { 48.0 - TITLE } else { 48.0 };
    let frame = PlotArea { top: first - 2.0 + LEGEND_LINE * lines as f64, ..frame };
    let x_ticks = chart.x.ticks(((right - left) / 70.0).clamp(2.0, MOST_TICKS));

    if !root.untitled {
        let title = Writing::new(fitting(&chart.title, 18.0, right - left), Anchor::Start);
        root.text(&chart.title, (left, 22.0), INK, title)?;
    }
    draw_legend(root, &legend, [left, right], first)?;

    for (value, label) in x_ticks {
        let x = frame.x(value);
        let shade = if label.is_some() { FAINT } else { PALE };
        root.line(&[(x, frame.top), (x, frame.bottom)], Stroke::solid(shade, 1.0))?;
        if let Some(label) = label {
            root.line(&[(x, frame.bottom), (x, frame.bottom + 5.0)], Stroke::solid(INK, 1.0))?;
            root.text(&label, (x, frame.bottom + 15.0), INK, Writing::new(TICK_SIZE, Anchor::Middle))?;
        }
    }
    for (value, label) in y_ticks {
        let y = frame.y(value);
        root.line(&[(frame.left, y), (frame.right, y)], Stroke::solid(FAINT, 1.0))?;
        if let Some(label) = label {
            root.line(&[(frame.left - 5.0, y), (frame.left, y)], Stroke::solid(INK, 1.0))?;
            root.text(&label, (frame.left - 9.0, y), INK, Writing::new(TICK_SIZE, Anchor::End))?;
        }
    }
    chart.series.iter().try_for_each(|series| draw_series(root, &frame, series))?;
    root.rectangle([(frame.left, frame.top), (frame.right, frame.bottom)], Paint::outline(INK, 1.0))?;

    let middle = (0.5 * (frame.left + frame.right), 0.5 * (frame.top + frame.bottom));
    let name = |label: &str, room: f64| Writing::new(fitting(label, 15.0, room), Anchor::Middle);
    root.text(&chart.x.label, (middle.0, root.height - 20.0), INK, name(&chart.x.label, right - left))?;
    let up = name(&chart.y.label, frame.bottom - frame.top + 30.0);
    root.text(&chart.y.label, (16.0, middle.1), INK, Writing { upwards: true, ..up })?;
    match &chart.bar {
        Some(bar) => draw_bar(root, bar, frame.right + 20.0, [frame.top + 24.0, frame.bottom]),
        None => Ok(()),
    }
}

fn draw_series(root: &Canvas, frame: &PlotArea, series: &Series) -> Drawn {
    let ink = series.colour.mix(series.opacity);
    let finite = finite(&series.points);
    if series.filled {
        let area = frame.area(&finite);
        if area.len() > 2 {
            root.polygon(&area, Paint::fill(ink))?;
        }
    }
    if let Some(line) = series.line {
        let pieces = frame.pieces(&finite);
        for piece in &pieces {
            draw_line(root, line, ink, piece)?;
        }
        if series.arrow {
            draw_arrow(root, ink, &pieces)?;
        }
    }
    if let Some(mark) = series.mark {
        for at in finite.iter().map(|&(x, y)| (frame.x(x), frame.y(y))).filter(|&at| frame.holds(at)) {
            draw_mark(root, mark, ink, at)?;
        }
    }
    Ok(())
}

/// Draws several diagrams in panels of equal size, row by row. Their titles tell them apart, and
/// stay.
pub fn draw_charts(root: &Canvas, columns: usize, charts: &[Chart]) -> Drawn {
    root.grid(charts.len(), columns).into_iter().zip(charts).try_for_each(|(mut area, chart)| {
        area.untitled &= charts.len() == 1;
        draw_chart(&area, chart)
    })
}

fn draw_bar(root: &Canvas, bar: &ColourBar, left: f64, [top, bottom]: [f64; 2]) -> Drawn {
    root.text(&bar.axis.label, (left, top - 16.0), INK, Writing::new(14.0, Anchor::Start))?;
    root.ramp([(left, top), (left + 16.0, bottom)], true, |share| viridis(VIRIDIS_END * share))?;
    for (value, label) in bar.axis.ticks(MOST_TICKS).into_iter().filter_map(|(value, label)| Some((value, label?))) {
        let y = bottom - bar.axis.place(value) * (bottom - top);
        root.line(&[(left + 16.0, y), (left + 21.0, y)], Stroke::solid(INK, 1.0))?;
        root.text(&label, (left + 25.0, y), INK, Writing::new(13.0, Anchor::Start))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::sheet::Size;
    use super::*;

    fn labels(axis: &Axis) -> Vec<String> {
        axis.ticks(MOST_TICKS).into_iter().filter_map(|(_, label)| label).collect()
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
        let frame = PlotArea { chart: &chart, left: 0.0, right: 100.0, top: 0.0, bottom: 100.0 };
        // In, out at the top, and in again.
        let pieces = frame.pieces(&[(0.0, 0.0), (0.5, 1.0), (0.6, 2.0), (0.9, 2.0), (1.0, 0.0)]);
        assert_eq!(pieces, [vec![(0.0, 100.0), (50.0, 0.0)], vec![(95.0, 0.0), (100.0, 100.0)]]);
        assert!(frame.pieces(&[(-1.0, 0.5), (-0.5, 0.7)]).is_empty());
        // A logarithm of zero is left out.
        let chart = Chart { x: Axis::logarithmic("", 1.0, 10.0), ..chart.clone() };
        let frame = PlotArea { chart: &chart, left: 0.0, right: 100.0, top: 0.0, bottom: 100.0 };
        assert_eq!(frame.pieces(&[(0.0, 0.5), (1.0, 0.5), (10.0, 0.5)]), [vec![(0.0, 50.0), (100.0, 50.0)]]);
    }

    /// A curve is no more broken than its data: on whole pixels it would turn by up to 20 degrees
    /// from point to point here.
    #[test]
    fn a_smooth_curve_is_drawn_smoothly() {
        let (x, y) = (Axis::linear("", 0.0, 1.0), Axis::linear("", 0.0, 1.0));
        let curve = (0..=200).map(|i| 0.005 * f64::from(i)).map(|x| (x, 0.2 + 0.3 * x * x)).collect();
        let chart = Chart { title: String::new(), x, y, series: vec![Series::solid("", INK, curve)], bar: None };
        let canvas = Canvas::new(Size { width: 700.0, height: 400.0, printed: None, untitled: false });
        draw_chart(&canvas, &chart).unwrap();
        let svg = canvas.finish();
        let drawn = svg.lines().find(|line| line.contains("stroke-width=\"2\"")).unwrap();
        let places = drawn.split("points=\"").nth(1).unwrap().split('"').next().unwrap();
        let places: Vec<[f64; 2]> = places
            .split(' ')
            .map(|place| place.split_once(',').unwrap())
            .map(|(x, y)| [x.parse().unwrap(), y.parse().unwrap()])
            .collect();
        assert_eq!(places.len(), 201);
        let slopes: Vec<f64> =
            places.windows(2).map(|pair| ((pair[1][1] - pair[0][1]) / (pair[1][0] - pair[0][0])).atan()).collect();
        let turns = slopes.windows(2).map(|pair| (pair[1] - pair[0]).abs().to_degrees());
        assert!(turns.fold(0.0, f64::max) < 0.5, "{slopes:?}");
    }

    #[test]
    fn entries_of_the_legend_do_not_overlap() {
        let entry = |label: &str| Series::solid(label, INK, Vec::new());
        let series = [entry("F_{N,slip} of the simulation"), entry(""), entry("Olsson & Larsson 2016"), entry("Hertz")];
        let (places, lines) = legend_places(&series, 300.0);
        assert_eq!((places.len(), lines), (3, 2));
        assert_eq!((places[1].1, places[1].2), (0.0, 1));
        assert!(places[2].1 > SAMPLE + text_width("Olsson & Larsson 2016", LEGEND_SIZE));
    }

    /// Steps between denormal numbers are nothing, or not even: there were once 2^64 ticks to make
    /// room for.
    #[test]
    fn an_axis_over_the_least_numbers_has_few_ticks_or_none() {
        for (low, high) in
            [(0.0, 5e-324), (0.0, 1e-322), (5e-324, 1e-320), (-1e-310, 1e-308), (0.0, f64::MAX), (-f64::MAX, f64::MAX)]
        {
            assert!(Axis::linear("F", low, high).ticks(MOST_TICKS).len() <= 21, "{low:e} {high:e}");
        }
        assert!(Axis::linear("F", 0.0, 1e-300).ticks(MOST_TICKS).len() > 3);
    }
}
