//! The contact surface seen along its normal: status above the symmetry line, pressure below it.

use super::super::tables::SlipPanel;
use super::super::{ContactPoint, ContactStatus, Half, OutputError};
use super::canvas::{Anchor, Canvas, Colour, Drawn, Paint, Place, Stroke, Writing};
use super::chart::{nice_step, ramp};
use super::style::{BLUE, INK, ORANGE, Picture, WHITE, rounded, tick, viridis};

const OPEN: Colour = Colour(0xdd, 0xdd, 0xdd);

/// The map of one step at current positions: open, stick and slip in the upper half, the pressure
/// in the lower one. The shear runs to the right.
pub fn plot_contact(points: &[ContactPoint]) -> Result<Picture, OutputError> {
    let caption = "The contact surface at the last saved step in contact, at current positions, with the numbers of its points on both halves; the shear runs to the \
                   right.";
    Picture::draw("contact", caption, (780, 640), |root| {
        let map = Map { view: View::of(points), highest: highest(points), square: Square { left: 88.0, top: 52.0, side: 520.0 } };
        map.draw(root, points)?;
        let Square { left, top, side } = map.square;
        root.text("Contact surface", (left, 26.0), INK, text(18.0))?;
        map.axes(root, true)?;
        root.text("status", (left + 10.0, top + 16.0), INK, text(14.0))?;
        root.text("pressure", (left + 10.0, top + side - 16.0), INK, text(14.0))?;
        status_names(root, points, (640.0, top + 14.0), true)?;
        pressure_bar(root, map.highest, 640.0, [top + 0.5 * side + 8.0, top + side])
    })
}

/// Maps of some steps of a shear side by side, all to one scale: how slip eats into the contact
/// from its edge.
pub fn plot_slip(panels: &[SlipPanel]) -> Result<Picture, OutputError> {
    const PANEL: (f64, f64) = (300.0, 322.0);
    const HEAD: f64 = 48.0;
    let columns = match panels.len() {
        4 => 2,
        count => count.clamp(1, 3),
    };
    let rows = panels.len().div_ceil(columns);
    let left = columns as f64 * PANEL.0;
    let size = (left as u32 + 196, (HEAD + rows.max(1) as f64 * PANEL.1) as u32 + 8);
    let caption = "Stick and slip (upper halves) and pressure (lower halves) at saved steps of the shear, to one scale; \
                   the shear runs to the right.";
    Picture::draw("slip", caption, size, |root| {
        let all: Vec<ContactPoint> = panels.iter().flat_map(|panel| panel.points.iter().cloned()).collect();
        let (view, highest) = (View::of(&all), highest(&all));
        root.text("Stick and slip during the shear", (24.0, 26.0), INK, text(18.0))?;
        for (i, panel) in panels.iter().enumerate() {
            // What sticks out of its square is covered in its own panel alone.
            let corner = ((i % columns) as f64 * PANEL.0, HEAD + (i / columns) as f64 * PANEL.1);
            let area = root.panel(corner, PANEL);
            let map = Map { view, highest, square: Square { left: 62.0, top: 26.0, side: 228.0 } };
            map.draw(&area, &panel.points)?;
            let ratio = panel.ratio.map_or(String::new(), |ratio| format!(", F_T/F_N = {ratio:.3}"));
            let head = format!("δ_T = {}{ratio}", tick(rounded(panel.delta_t)));
            area.text(&head, (map.square.left, map.square.top - 13.0), INK, text(14.0))?;
            // Named where no other panel stands below.
            map.axes(&area, i + columns >= panels.len())?;
        }
        let first = panels.last().map(|panel| panel.points.as_slice()).unwrap_or_default();
        status_names(root, first, (left + 20.0, HEAD + 40.0), false)?;
        pressure_bar(root, highest, left + 20.0, [HEAD + 130.0, HEAD + PANEL.1 - 68.0])
    })
}

/// Greatest finite pressure.
fn highest(points: &[ContactPoint]) -> f64 {
    points.iter().map(|point| point.pressure).filter(|p| p.is_finite()).fold(0.0, f64::max)
}

/// The square that is shown: everything in contact and a third more.
#[derive(Clone, Copy)]
struct View {
    centre: f64,
    reach: f64,
}

impl View {
    fn of(points: &[ContactPoint]) -> Self {
        let closed: Vec<&ContactPoint> = points.iter().filter(|point| point.status != ContactStatus::Open).collect();
        let shown: Vec<&ContactPoint> = if closed.is_empty() { points.iter().collect() } else { closed };
        let low = shown.iter().map(|point| point.current_x).fold(f64::INFINITY, f64::min);
        let high = shown.iter().map(|point| point.current_x).fold(f64::NEG_INFINITY, f64::max);
        let side = shown.iter().map(|point| point.current_y.abs()).fold(0.0, f64::max);
        let cell = shown.iter().map(|point| point.area).fold(0.0, f64::max).sqrt();
        let reach = 1.33 * (0.5 * (high - low)).max(side).max(2.0 * cell).max(f64::MIN_POSITIVE);
        let centre = if shown.is_empty() { 0.0 } else { 0.5 * (low + high) };
        Self { centre, reach }
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
struct Map {
    view: View,
    /// The pressure at the upper end of the colours.
    highest: f64,
    square: Square,
}

impl Map {
    fn scale(&self) -> f64 {
        0.5 * self.square.side / self.view.reach
    }

    fn pixel(&self, x: f64, y: f64) -> Place {
        let half = 0.5 * self.square.side;
        (self.square.left + half + (x - self.view.centre) * self.scale(), self.square.top + half - y * self.scale())
    }

    /// The points, and white over all of the area that is outside of the square.
    fn draw(&self, area: &Canvas, points: &[ContactPoint]) -> Drawn {
        let middle = self.pixel(0.0, 0.0).1;
        let reach = self.view.reach;
        // The open ones first, so that they hide nothing of the contact.
        let (closed, open): (Vec<&ContactPoint>, _) = points.iter().partition(|point| point.status != ContactStatus::Open);
        for point in open.into_iter().chain(closed) {
            if !((point.current_x - self.view.centre).abs() <= reach && point.current_y.abs() <= reach) {
                continue;
            }
            // Discs that just overlap; each half shows half of a point on the symmetry line.
            let area_shown = if point.half == Half::Both { 0.5 * point.area } else { point.area };
            let radius = (0.6 * area_shown.max(0.0).sqrt() * self.scale()).clamp(1.5, 14.0);
            let pressure = match point.status {
                ContactStatus::Open => OPEN,
                _ if self.highest > 0.0 => viridis(point.pressure / self.highest),
                _ => viridis(0.0),
            };
            let (x, y) = self.pixel(point.current_x, point.current_y);
            if point.half != Half::Mirrored {
                area.circle((x, y.min(middle - radius)), radius, Paint::fill(status_colour(point.status)))?;
            }
            if point.half != Half::Meshed {
                area.circle((x, y.max(middle + radius)), radius, Paint::fill(pressure))?;
            }
        }
        let Square { left, top, side } = self.square;
        for cover in [
            [(0.0, 0.0), (area.width, top)],
            [(0.0, top + side), (area.width, area.height)],
            [(0.0, top), (left, top + side)],
            [(left + side, top), (area.width, top + side)],
        ] {
            area.rectangle(cover, Paint::fill(WHITE))?;
        }
        area.line(&[(left, middle), (left + side, middle)], Stroke::solid(INK, 1.0))?;
        area.rectangle([(left, top), (left + side, top + side)], Paint::outline(INK, 1.0))
    }

    /// Ticks and their numbers, with the names of the axes; the horizontal name only where it is
    /// wanted.
    fn axes(&self, root: &Canvas, named: bool) -> Drawn {
        let Square { left, top, side } = self.square;
        let (centre, reach) = (self.view.centre, self.view.reach);
        let step = nice_step(2.0 * reach / 5.0);
        for i in ((centre - reach) / step).ceil() as i64..=((centre + reach) / step).floor() as i64 {
            let x = self.pixel(i as f64 * step, 0.0).0;
            root.line(&[(x, top + side), (x, top + side + 5.0)], Stroke::solid(INK, 1.0))?;
            root.text(&tick(i as f64 * step), (x, top + side + 15.0), INK, Writing::new(13.0, Anchor::Middle))?;
        }
        let count = (reach / step).floor() as i64;
        for i in -count..=count {
            let y = self.pixel(0.0, i as f64 * step).1;
            root.line(&[(left - 5.0, y), (left, y)], Stroke::solid(INK, 1.0))?;
            root.text(&tick(i as f64 * step), (left - 9.0, y), INK, Writing::new(13.0, Anchor::End))?;
        }
        let name = Writing::new(15.0, Anchor::Middle);
        if named {
            let along = if side > 400.0 { "x, along the shear (case's unit of length)" } else { "x, along the shear" };
            root.text(along, (left + 0.5 * side, top + side + 38.0), INK, name)?;
        }
        let place = (left - if side > 400.0 { 68.0 } else { 52.0 }, top + 0.5 * side);
        root.text("y", place, INK, Writing { upwards: true, ..name })
    }
}

fn text(size: f64) -> Writing {
    Writing::new(size, Anchor::Start)
}

fn status_colour(status: ContactStatus) -> Colour {
    match status {
        ContactStatus::Open => OPEN,
        ContactStatus::Stick => BLUE,
        ContactStatus::Slip => ORANGE,
    }
}

/// The colours of the status, with the number of points of each if `counted`.
fn status_names(root: &Canvas, points: &[ContactPoint], (left, top): Place, counted: bool) -> Drawn {
    let names = [(ContactStatus::Stick, "stick"), (ContactStatus::Slip, "slip"), (ContactStatus::Open, "open")];
    for (i, (status, name)) in names.into_iter().enumerate() {
        let y = top + 24.0 * i as f64;
        let count = points.iter().filter(|point| point.status == status).count();
        root.circle((left + 8.0, y), 7.0, Paint::fill(status_colour(status)))?;
        let label = if counted { format!("{name} ({count})") } else { name.to_owned() };
        root.text(&label, (left + 24.0, y), INK, text(14.0))?;
    }
    Ok(())
}

fn pressure_bar(root: &Canvas, highest: f64, left: f64, [top, bottom]: [f64; 2]) -> Drawn {
    if highest <= 0.0 {
        return Ok(());
    }
    root.text("pressure (case's", (left, top), INK, text(14.0))?;
    root.text("unit of stress)", (left, top + 17.0), INK, text(14.0))?;
    let top = top + 36.0;
    ramp(root, left, 20.0, [top, bottom], viridis)?;
    for i in 0..=4 {
        let share = f64::from(i) / 4.0;
        let y = bottom - (bottom - top) * share;
        root.line(&[(left + 20.0, y), (left + 25.0, y)], Stroke::solid(INK, 1.0))?;
        root.text(&tick(rounded(highest * share)), (left + 29.0, y), INK, text(13.0))?;
    }
    Ok(())
}
