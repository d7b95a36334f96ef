//! The contact surface seen along its normal: status above the symmetry line, pressure below it.

use super::super::tables::SlipPanel;
use super::super::{ContactPoint, ContactStatus, Half, OutputError};
use super::View;
use super::axes::{Dimension, Shown};
use super::canvas::{Anchor, Canvas, Colour, Drawn, NotFinite, Paint, Pixel, Stroke, Writing};
use super::chart::nice_step;
use super::field::{TriangleMesh, clipped};
use super::style::{BLUE, INK, ORANGE, Picture, rounded, tick, viridis};
use super::text::text_width;

const OPEN: Colour = Colour(0xdd, 0xdd, 0xdd);
/// Colours of the pressure: as many areas lie upon each other.
const LEVELS: u32 = 64;
/// Height of the colour bar, its numbers and its name.
const BAR: f64 = 74.0;
/// Room beside a square for the numbers of its axes and their names.
const MARGIN: f64 = 58.0;
const FOOT: f64 = 56.0;
/// Height of the title.
const TITLE: f64 = 30.0;

/// The title, if pictures have them; the middle of the line that follows.
fn headed(root: &Canvas, title: &str) -> Result<f64, NotFinite> {
    if root.untitled {
        return Ok(54.0 - TITLE);
    }
    root.text(title, (MARGIN, 24.0), INK, text(18.0))?;
    Ok(54.0)
}

/// What is above the maps, `head` pixels with the title.
fn below_title(head: f64, view: &View) -> f64 {
    if view.sheet.untitled { head - TITLE } else { head }
}

/// The map of one step at current positions: open, stick and slip in the upper half, the pressure
/// in the lower one. The shear runs to the right.
pub fn plot_contact(points: &[ContactPoint], view: &View) -> Result<Picture, OutputError> {
    let caption = "The contact surface at the last saved step in contact, at current positions, with the numbers of its points on both halves; the shear runs to the \
                   right.";
    let scales = Scales::of(points, view);
    let window = Window::of(points);
    let width = view.sheet.width_of(640.0);
    let side = (width - MARGIN - 24.0).min(520.0);
    let top = below_title(78.0, view);
    Picture::draw("contact", caption, view.sheet.size(width, top + side + FOOT + BAR), |root| {
        let map = MapSheet { window, scales: &scales, square: Square { left: MARGIN, top, side } };
        map.draw(root, points)?;
        let names = headed(root, "Contact surface")?;
        map.axes(root, [true, true])?;
        root.text("status", (MARGIN + 10.0, top + 16.0), INK, text(14.0))?;
        root.text("pressure", (MARGIN + 10.0, top + side - 16.0), INK, text(14.0))?;
        status_names(root, Some(points), (MARGIN, names))?;
        pressure_bar(root, &scales, (MARGIN, top + side + FOOT), side)
    })
}

/// Maps of some steps in the order of the shear, all to one scale: how slip eats into the contact
/// from its edge.
pub fn plot_slip(panels: &[SlipPanel], view: &View) -> Result<Picture, OutputError> {
    slip_maps(panels, panels, view)
}

/// The map of one of these steps, to the scale of them all: a frame of a film.
pub fn plot_slip_frame(panels: &[SlipPanel], frame: usize, view: &View) -> Result<Picture, OutputError> {
    slip_maps(panels.get(frame..=frame).unwrap_or_default(), panels, view)
}

/// Maps of the steps that are `shown`, to the scale of all `panels`.
fn slip_maps(shown: &[SlipPanel], panels: &[SlipPanel], view: &View) -> Result<Picture, OutputError> {
    const NARROWEST: f64 = 170.0;
    /// Narrowest square over which what it shows stands on one line.
    const ONE_LINE: f64 = 200.0;
    let most = match shown.len() {
        4 => 2,
        count => count.clamp(1, 3),
    };
    let width = view.sheet.width_of((most as f64 * 310.0).max(380.0));
    let columns = ((width / NARROWEST) as usize).clamp(1, most);
    let across = width / columns as f64;
    let side = (across - MARGIN - 14.0).min(300.0);
    let rows = shown.len().div_ceil(columns).max(1);
    // Over a panel's square, for what it shows.
    let title = if side < ONE_LINE { 46.0 } else { 28.0 };
    let head = below_title(74.0, view);
    // Only the lowest panels name their axis.
    let down = |rows: usize| rows as f64 * (title + side + 32.0);
    let size = view.sheet.size(width, head + down(rows) + FOOT - 32.0 + BAR);
    let caption = "Stick and slip (upper halves) and pressure (lower halves) at saved steps of the shear, in their order and to one scale; \
                   the shear runs to the right.";
    let all: Vec<ContactPoint> = panels.iter().flat_map(|panel| panel.points.iter().cloned()).collect();
    let (window, scales) = (Window::of(&all), Scales::of(&all, view));
    let farthest = super::curves::greatest(panels.iter().map(|panel| panel.delta_t));
    let delta_t = view.axes.show(Dimension::Length, "", "δ_T", farthest);
    Picture::draw("slip", caption, size, |root| {
        let names = headed(root, "Stick and slip during the shear")?;
        status_names(root, None, (MARGIN, names))?;
        for (i, panel) in shown.iter().enumerate() {
            let corner = ((i % columns) as f64 * across, head + down(i / columns));
            let area = root.panel(corner, (across, title + side + FOOT));
            let map = MapSheet { window, scales: &scales, square: Square { left: MARGIN, top: title, side } };
            map.draw(&area, &panel.points)?;
            let place = format!("{} = {}", delta_t.short, tick(rounded(panel.delta_t * delta_t.factor)));
            let ratio = panel.ratio.map(|ratio| format!("F_T/F_N = {:.3}", (1e3 * ratio).round() / 1e3 + 0.0));
            let lines: Vec<String> = match ratio {
                Some(ratio) if side < ONE_LINE => vec![place, ratio],
                Some(ratio) => vec![format!("{place}, {ratio}")],
                None => vec![place],
            };
            for (i, line) in lines.iter().rev().enumerate() {
                let size = 14.0 * (side / text_width(line, 14.0)).min(1.0);
                area.text(line, (MARGIN, title - 13.0 - 18.0 * i as f64), INK, text(size))?;
            }
            map.axes(&area, [i + columns >= shown.len(), i % columns == 0])?;
        }
        let length = (width - MARGIN - 40.0).min(420.0);
        pressure_bar(root, &scales, (MARGIN, head + down(rows) - 32.0 + FOOT), length)
    })
}

/// How lengths and pressures are shown.
struct Scales {
    length: Shown,
    across: Shown,
    pressure: Shown,
    /// The pressure at the upper end of the colours, in the case's unit.
    highest: f64,
}

impl Scales {
    fn of(points: &[ContactPoint], view: &View) -> Self {
        let highest = points.iter().map(|point| point.pressure).filter(|p| p.is_finite()).fold(0.0, f64::max);
        // One unit for both directions, and for no direction a power of ten: contacts are a tenth
        // of R or so.
        let reach = f64::INFINITY;
        Self {
            length: view.axes.show(Dimension::Length, "along the shear", "x", reach),
            across: view.axes.show(Dimension::Length, "", "y", reach),
            pressure: view.axes.show(Dimension::Stress, "pressure", "p", highest),
            highest,
        }
    }
}

/// The square that is shown: everything in contact and a third more.
#[derive(Clone, Copy)]
struct Window {
    centre: f64,
    reach: f64,
}

impl Window {
    fn of(points: &[ContactPoint]) -> Self {
        let closed: Vec<&ContactPoint> = points.iter().filter(|point| point.status != ContactStatus::Open).collect();
        let shown: Vec<&ContactPoint> = if closed.is_empty() { points.iter().collect() } else { closed };
        let low = shown.iter().map(|point| point.current_x).fold(f64::INFINITY, f64::min);
        let high = shown.iter().map(|point| point.current_x).fold(f64::NEG_INFINITY, f64::max);
        let side = shown.iter().map(|point| point.current_y.abs()).fold(0.0, f64::max);
        let cell = shown.iter().map(|point| point.area).fold(0.0, f64::max).sqrt();
        let reach = 1.25 * (0.5 * (high - low)).max(side).max(2.0 * cell).max(f64::MIN_POSITIVE);
        let centre = if shown.is_empty() { 0.0 } else { 0.5 * (low + high) };
        Self { centre, reach }
    }

    /// Whether a point is so near that what is drawn may depend on it.
    fn is_near(&self, point: &ContactPoint) -> bool {
        (point.current_x - self.centre).abs().max(point.current_y.abs()) <= 2.0 * self.reach
    }
}

/// Where a map is drawn, in pixels.
#[derive(Clone, Copy)]
struct Square {
    left: f64,
    top: f64,
    side: f64,
}

#[derive(Clone, Copy)]
struct MapSheet<'a> {
    window: Window,
    scales: &'a Scales,
    square: Square,
}

impl MapSheet<'_> {
    fn scale(&self) -> f64 {
        0.5 * self.square.side / self.window.reach
    }

    fn pixel(&self, x: f64, y: f64) -> Pixel {
        let half = 0.5 * self.square.side;
        (self.square.left + half + (x - self.window.centre) * self.scale(), self.square.top + half - y * self.scale())
    }

    /// Both halves, interpolated between the points.
    fn draw(&self, area: &Canvas, points: &[ContactPoint]) -> Drawn {
        let Square { left, top, side } = self.square;
        area.rectangle([(left, top), (left + side, top + side)], Paint::fill(OPEN))?;
        for (half, upper) in [(Half::Meshed, true), (Half::Mirrored, false)] {
            let own: Vec<&ContactPoint> = points
                .iter()
                .filter(|point| point.half.is_shown_as(half) && self.window.is_near(point))
                .filter(|point| point.current_x.is_finite() && point.current_y.is_finite())
                .collect();
            let field = TriangleMesh::new(own.iter().map(|point| self.pixel(point.current_x, point.current_y)).collect());
            // Of a whole sphere half of what is interpolated is shown.
            let middle = self.pixel(0.0, 0.0).1;
            let (from, to) = match (own.iter().any(|point| point.half == Half::Whole), upper) {
                (false, _) => (top, top + side),
                (true, true) => (top, middle),
                (true, false) => (middle, top + side),
            };
            let region = |values: &[f64], level: f64, ink: Paint| {
                let inside = |points: &Vec<Pixel>| clipped(points, [(left, from), (left + side, to)]);
                area.area(&field.at_least(values, level).iter().map(inside).collect::<Vec<_>>(), ink)
            };
            // What is open has no value: the border is halfway to it.
            let of_closed = |value: &dyn Fn(&ContactPoint) -> f64| -> Vec<f64> {
                own.iter().map(|p| if p.status == ContactStatus::Open { f64::NAN } else { value(p) }).collect()
            };
            let closed = of_closed(&|_| 1.0);
            if upper {
                region(&closed, 0.5, Paint::fill(BLUE))?;
                let slips = of_closed(&|point| f64::from(u8::from(point.status == ContactStatus::Slip)));
                region(&slips, 0.5, Paint::fill(ORANGE))?;
            } else {
                let highest = if self.scales.highest > 0.0 { self.scales.highest } else { 1.0 };
                let pressures = of_closed(&|point| point.pressure / highest);
                region(&closed, 0.5, Paint::fill(viridis(0.0)))?;
                for level in 0..LEVELS {
                    let share = f64::from(level) / f64::from(LEVELS);
                    region(&pressures, share, Paint::fill(viridis(share + 0.5 / f64::from(LEVELS))))?;
                }
            }
        }
        let middle = self.pixel(0.0, 0.0).1;
        area.line(&[(left, middle), (left + side, middle)], Stroke::solid(INK, 1.0))?;
        area.rectangle([(left, top), (left + side, top + side)], Paint::outline(INK, 1.0))
    }

    /// Ticks and their numbers; the names of the axes along the shear and across it where they are
    /// wanted.
    fn axes(&self, root: &Canvas, named: [bool; 2]) -> Drawn {
        let Square { left, top, side } = self.square;
        let factor = self.scales.length.factor;
        let (centre, reach) = (self.window.centre * factor, self.window.reach * factor);
        let step = nice_step(2.0 * reach / (side / 70.0).clamp(3.0, 6.0));
        // Between denormal numbers there are no even steps.
        if !step.is_normal() {
            return Ok(());
        }
        for i in ((centre - reach) / step).ceil() as i64..=((centre + reach) / step).floor() as i64 {
            let x = self.pixel(i as f64 * step / factor, 0.0).0;
            root.line(&[(x, top + side), (x, top + side + 5.0)], Stroke::solid(INK, 1.0))?;
            root.text(&tick(i as f64 * step), (x, top + side + 15.0), INK, Writing::new(13.0, Anchor::Middle))?;
        }
        let count = (reach / step).floor() as i64;
        for i in -count..=count {
            let y = self.pixel(0.0, i as f64 * step / factor).1;
            root.line(&[(left - 5.0, y), (left, y)], Stroke::solid(INK, 1.0))?;
            root.text(&tick(i as f64 * step), (left - 9.0, y), INK, Writing::new(13.0, Anchor::End))?;
        }
        let name = |label: &str| Writing::new(15.0 * (side / text_width(label, 15.0)).min(1.0), Anchor::Middle);
        if named[0] {
            let label = &self.scales.length.label;
            root.text(label, (left + 0.5 * side, top + side + 36.0), INK, name(label))?;
        }
        if named[1] {
            let label = &self.scales.across.short;
            root.text(label, (12.0, top + 0.5 * side), INK, Writing { upwards: true, ..name(label) })?;
        }
        Ok(())
    }
}

fn text(size: f64) -> Writing {
    Writing::new(size, Anchor::Start)
}

/// The colours of the status in a line, with the number of points of each if there are points.
fn status_names(root: &Canvas, points: Option<&[ContactPoint]>, (left, y): Pixel) -> Drawn {
    let names =
        [(ContactStatus::Stick, BLUE, "stick"), (ContactStatus::Slip, ORANGE, "slip"), (ContactStatus::Open, OPEN, "open")];
    let mut x = left;
    for (status, colour, name) in names {
        let count = points.map(|points| points.iter().filter(|point| point.status == status).count());
        let label = count.map_or(name.to_owned(), |count| format!("{name} ({count})"));
        root.rectangle([(x, y - 7.0), (x + 14.0, y + 7.0)], Paint::fill(colour))?;
        root.text(&label, (x + 20.0, y), INK, text(14.0))?;
        x += 36.0 + text_width(&label, 14.0);
    }
    Ok(())
}

/// The colours of the pressure with their numbers and their name below.
fn pressure_bar(root: &Canvas, scales: &Scales, (left, top): Pixel, length: f64) -> Drawn {
    if scales.highest <= 0.0 {
        return Ok(());
    }
    let (height, highest) = (14.0, scales.highest * scales.pressure.factor);
    root.ramp([(left, top), (left + length, top + height)], false, viridis)?;
    let step = nice_step(highest / (length / 70.0).clamp(2.0, 6.0));
    if !step.is_normal() {
        return Ok(());
    }
    for i in 0..=(highest / step * (1.0 + 1e-9)).floor() as u32 {
        let value = f64::from(i) * step;
        let x = left + length * value / highest;
        root.line(&[(x, top + height), (x, top + height + 5.0)], Stroke::solid(INK, 1.0))?;
        root.text(&tick(value), (x, top + height + 15.0), INK, Writing::new(13.0, Anchor::Middle))?;
    }
    let label = &scales.pressure.label;
    let size = 15.0 * (length / text_width(label, 15.0)).min(1.0);
    root.text(label, (left + 0.5 * length, top + height + 36.0), INK, Writing::new(size, Anchor::Middle))
}
