//! The contact surface seen along its normal: status above the symmetry line, pressure below it.

use super::super::{ContactPoint, ContactStatus, Half, OutputError};
use super::chart::nice_step;
use super::style::{Area, BLUE, Drawn, FONT, INK, ORANGE, Picture, rounded, tick, viridis};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use serde::{Deserialize, Serialize};

const OPEN: RGBColor = RGBColor(0xdd, 0xdd, 0xdd);

/// The map of one step at current positions: open, stick and slip in the upper half, the pressure in the lower one. The shear runs to the right.
pub fn plot_contact(points: &[ContactPoint]) -> Result<Picture, OutputError> {
    let caption = "The contact surface at the last saved step in contact, at current positions, with the numbers of its points on both halves; the shear runs to the \
                   right.";
    Picture::draw("contact", caption, (780, 640), |root| {
        let map = Map { view: View::of(points), highest: highest(points), square: Square { left: 88, top: 52, side: 520 } };
        map.draw(root, points)?;
        let middle = map.square.top + map.square.side / 2;
        root.draw(&Text::new("Contact surface", (map.square.left, 26), text(18, HPos::Left)))?;
        map.axes(root, true)?;
        root.draw(&Text::new("status", (map.square.left + 10, map.square.top + 16), text(14, HPos::Left)))?;
        let below = map.square.top + map.square.side - 16;
        root.draw(&Text::new("pressure", (map.square.left + 10, below), text(14, HPos::Left)))?;
        status_names(root, points, 640, map.square.top + 14, true)?;
        pressure_bar(root, map.highest, 640, middle + 8, map.square.top + map.square.side)
    })
}

/// One panel of [`plot_slip`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SlipPanel {
    /// delta_T.
    pub delta_t: f64,
    /// F_T over F_N; `None` without a normal force.
    pub ratio: Option<f64>,
    /// The surface then.
    pub points: Vec<ContactPoint>,
}

/// Maps of some steps of a shear side by side, all to one scale: how slip eats into the contact from its edge.
pub fn plot_slip(panels: &[SlipPanel]) -> Result<Picture, OutputError> {
    const PANEL: (i32, i32) = (300, 322);
    const HEAD: i32 = 48;
    let columns = match panels.len() as i32 {
        4 => 2,
        count => count.clamp(1, 3),
    };
    let rows = (panels.len() as i32 + columns - 1) / columns;
    let size = ((columns * PANEL.0 + 196) as u32, (HEAD + rows.max(1) * PANEL.1 + 8) as u32);
    let caption = "Stick and slip (upper halves) and pressure (lower halves) at saved steps of the shear, to one scale; \
                   the shear runs to the right.";
    Picture::draw("slip", caption, size, |root| {
        let all: Vec<ContactPoint> = panels.iter().flat_map(|panel| panel.points.iter().cloned()).collect();
        let (view, highest) = (View::of(&all), highest(&all));
        root.draw(&Text::new("Stick and slip during the shear", (24, 26), text(18, HPos::Left)))?;
        for (i, panel) in panels.iter().enumerate() {
            let (column, row) = (i as i32 % columns, i as i32 / columns);
            let (left, top) = (column * PANEL.0 + 62, HEAD + row * PANEL.1 + 26);
            let map = Map { view, highest, square: Square { left, top, side: 228 } };
            // Covers what sticks out of the square, in its own panel alone.
            let (x, y) = (column * PANEL.0, HEAD + row * PANEL.1);
            let area = root.clone().shrink((x as u32, y as u32), (PANEL.0 as u32, PANEL.1 as u32));
            let inside = Map { square: Square { left: left - x, top: top - y, ..map.square }, ..map };
            inside.draw(&area, &panel.points)?;
            let ratio = panel.ratio.map_or(String::new(), |ratio| format!(", F_T/F_N = {ratio:.3}"));
            let head = format!("δ_T = {}{ratio}", tick(rounded(panel.delta_t)));
            root.draw(&Text::new(head, (left, top - 13), text(14, HPos::Left)))?;
            // Named where no other panel stands below.
            map.axes(root, i as i32 + columns >= panels.len() as i32)?;
        }
        let left = columns * PANEL.0 + 20;
        let first = panels.last().map(|panel| panel.points.as_slice()).unwrap_or_default();
        status_names(root, first, left, HEAD + 40, false)?;
        pressure_bar(root, highest, left, HEAD + 130, HEAD + PANEL.1 - 68)
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
    left: i32,
    top: i32,
    side: i32,
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
        0.5 * f64::from(self.square.side) / self.view.reach
    }

    fn pixel(&self, x: f64, y: f64) -> (i32, i32) {
        let half = 0.5 * f64::from(self.square.side);
        let (middle_x, middle_y) = (f64::from(self.square.left) + half, f64::from(self.square.top) + half);
        let (x, y) = (middle_x + (x - self.view.centre) * self.scale(), middle_y - y * self.scale());
        (x.round() as i32, y.round() as i32)
    }

    /// The points, and white over all of the area that is outside of the square.
    fn draw(&self, area: &Area<'_>, points: &[ContactPoint]) -> Drawn {
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
            let radius = (0.6 * area_shown.max(0.0).sqrt() * self.scale()).clamp(1.5, 14.0) as i32;
            let pressure = match point.status {
                ContactStatus::Open => OPEN,
                _ if self.highest > 0.0 => viridis(point.pressure / self.highest),
                _ => viridis(0.0),
            };
            let (x, y) = self.pixel(point.current_x, point.current_y);
            if point.half != Half::Mirrored {
                area.draw(&Circle::new((x, y.min(middle - radius)), radius, status_colour(point.status).filled()))?;
            }
            if point.half != Half::Meshed {
                area.draw(&Circle::new((x, y.max(middle + radius)), radius, pressure.filled()))?;
            }
        }
        let Square { left, top, side } = self.square;
        let (width, height) = area.dim_in_pixel();
        let (width, height) = (width as i32, height as i32);
        for cover in [
            [(0, 0), (width, top)],
            [(0, top + side), (width, height)],
            [(0, top), (left, top + side)],
            [(left + side, top), (width, top + side)],
        ] {
            area.draw(&Rectangle::new(cover, WHITE.filled()))?;
        }
        area.draw(&PathElement::new([(left, middle), (left + side, middle)], INK.stroke_width(1)))?;
        area.draw(&Rectangle::new([(left, top), (left + side, top + side)], INK.stroke_width(1)))?;
        Ok(())
    }

    /// Ticks and their numbers, with the names of the axes; the horizontal name only where it is wanted.
    fn axes(&self, root: &Area<'_>, named: bool) -> Drawn {
        let Square { left, top, side } = self.square;
        let (centre, reach) = (self.view.centre, self.view.reach);
        let step = nice_step(2.0 * reach / 5.0);
        for i in ((centre - reach) / step).ceil() as i64..=((centre + reach) / step).floor() as i64 {
            let x = self.pixel(i as f64 * step, 0.0).0;
            root.draw(&PathElement::new([(x, top + side), (x, top + side + 5)], INK.stroke_width(1)))?;
            root.draw(&Text::new(tick(i as f64 * step), (x, top + side + 15), text(13, HPos::Center)))?;
        }
        let count = (reach / step).floor() as i64;
        for i in -count..=count {
            let y = self.pixel(0.0, i as f64 * step).1;
            root.draw(&PathElement::new([(left - 5, y), (left, y)], INK.stroke_width(1)))?;
            root.draw(&Text::new(tick(i as f64 * step), (left - 9, y), text(13, HPos::Right)))?;
        }
        if named {
            let name = if side > 400 { "x, along the shear (case's unit of length)" } else { "x, along the shear" };
            root.draw(&Text::new(name, (left + side / 2, top + side + 38), text(15, HPos::Center)))?;
        }
        let upwards = (FONT, 15).into_font().transform(FontTransform::Rotate270).color(&INK);
        let upwards = upwards.pos(Pos::new(HPos::Center, VPos::Center));
        root.draw(&Text::new("y", (left - if side > 400 { 68 } else { 52 }, top + side / 2), upwards))?;
        Ok(())
    }
}

fn text(size: i32, place: HPos) -> TextStyle<'static> {
    (FONT, size).into_font().color(&INK).pos(Pos::new(place, VPos::Center))
}

fn status_colour(status: ContactStatus) -> RGBColor {
    match status {
        ContactStatus::Open => OPEN,
        ContactStatus::Stick => BLUE,
        ContactStatus::Slip => ORANGE,
    }
}

/// The colours of the status, with the number of points of each if `counted`.
fn status_names(root: &Area<'_>, points: &[ContactPoint], left: i32, top: i32, counted: bool) -> Drawn {
    let names = [(ContactStatus::Stick, "stick"), (ContactStatus::Slip, "slip"), (ContactStatus::Open, "open")];
    for ((status, name), y) in names.into_iter().zip((top..).step_by(24)) {
        let count = points.iter().filter(|point| point.status == status).count();
        root.draw(&Circle::new((left + 8, y), 7, status_colour(status).filled()))?;
        let label = if counted { format!("{name} ({count})") } else { name.to_owned() };
        root.draw(&Text::new(label, (left + 24, y), text(14, HPos::Left)))?;
    }
    Ok(())
}

fn pressure_bar(root: &Area<'_>, highest: f64, left: i32, top: i32, bottom: i32) -> Drawn {
    if highest <= 0.0 {
        return Ok(());
    }
    root.draw(&Text::new("pressure (case's", (left, top), text(14, HPos::Left)))?;
    root.draw(&Text::new("unit of stress)", (left, top + 17), text(14, HPos::Left)))?;
    let top = top + 36;
    for y in top..bottom {
        let share = f64::from(bottom - y) / f64::from(bottom - top);
        root.draw(&Rectangle::new([(left, y), (left + 20, y + 1)], viridis(share).filled()))?;
    }
    for i in 0..=4 {
        let y = bottom - (bottom - top) * i / 4;
        let value = rounded(highest * f64::from(i) / 4.0);
        root.draw(&PathElement::new([(left + 20, y), (left + 25, y)], INK.stroke_width(1)))?;
        root.draw(&Text::new(tick(value), (left + 29, y), text(13, HPos::Left)))?;
    }
    Ok(())
}
