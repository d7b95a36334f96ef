//! The contact surface seen along its normal: status above the symmetry line, pressure mirrored below it.

use super::super::{ContactPoint, ContactStatus, OutputError};
use super::style::{BLUE, Drawn, FAINT, FONT, INK, ORANGE, draw, tick, viridis};
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::path::Path;

const SIZE: (u32, u32) = (780, 640);
/// Left, right, top and bottom of the square that holds the map, in pixels.
const FRAME: (i32, i32, i32, i32) = (84, 604, 52, 572);
/// Left and right of the colour bar.
const BAR: (i32, i32) = (640, 660);
const OPEN: RGBColor = RGBColor(0xdd, 0xdd, 0xdd);

/// The map of one step at current positions: open, stick and slip in the upper half, the pressure in the lower one. The shear runs to the right.
pub fn plot_contact(path: &Path, points: &[ContactPoint]) -> Result<(), OutputError> {
    draw(path, SIZE, |root| draw_map(root, points))
}

/// The square that is shown: everything in contact and a third more.
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
        Self { centre: 0.5 * (low + high), reach }
    }

    fn scale(&self) -> f64 {
        0.5 * f64::from(FRAME.1 - FRAME.0) / self.reach
    }

    fn pixel(&self, x: f64, y: f64) -> (i32, i32) {
        let (middle_x, middle_y) = (0.5 * f64::from(FRAME.0 + FRAME.1), 0.5 * f64::from(FRAME.2 + FRAME.3));
        ((middle_x + (x - self.centre) * self.scale()).round() as i32, (middle_y - y * self.scale()).round() as i32)
    }
}

fn status_colour(status: ContactStatus) -> RGBColor {
    match status {
        ContactStatus::Open => OPEN,
        ContactStatus::Stick => BLUE,
        ContactStatus::Slip => ORANGE,
    }
}

fn draw_map(root: &DrawingArea<SVGBackend<'_>, Shift>, points: &[ContactPoint]) -> Drawn {
    let view = View::of(points);
    let highest = points.iter().map(|point| point.pressure).filter(|p| p.is_finite()).fold(0.0, f64::max);
    let text = |size: i32| (FONT, size).into_font().color(&INK);
    let centred = |size: i32| text(size).pos(Pos::new(HPos::Center, VPos::Center));
    let right = |size: i32| text(size).pos(Pos::new(HPos::Right, VPos::Center));

    for point in points {
        let inside = (point.current_x - view.centre).abs() <= view.reach && point.current_y.abs() <= view.reach;
        if !inside {
            continue;
        }
        // Discs that just overlap; the nodes on the symmetry line stand for half a cell.
        let radius = (0.6 * point.area.max(0.0).sqrt() * view.scale()).clamp(1.5, 14.0) as i32;
        let pressure = match point.status {
            ContactStatus::Open => OPEN,
            _ if highest > 0.0 => viridis(point.pressure / highest),
            _ => viridis(0.0),
        };
        let (x, upper) = view.pixel(point.current_x, point.current_y);
        let lower = view.pixel(point.current_x, -point.current_y).1;
        let middle = view.pixel(0.0, 0.0).1;
        root.draw(&Circle::new((x, upper.min(middle - radius)), radius, status_colour(point.status).filled()))?;
        root.draw(&Circle::new((x, lower.max(middle + radius)), radius, pressure.filled()))?;
    }

    frame(root)?;
    root.draw(&Text::new("Contact surface", ((FRAME.0 + FRAME.1) / 2, 24), centred(20)))?;
    let middle = view.pixel(0.0, 0.0).1;
    root.draw(&PathElement::new([(FRAME.0, middle), (FRAME.1, middle)], INK.stroke_width(1)))?;
    root.draw(&Text::new("status", (FRAME.0 + 10, FRAME.2 + 10), text(14)))?;
    root.draw(&Text::new("pressure (mirrored)", (FRAME.0 + 10, FRAME.3 - 22), text(14)))?;

    let names = [(ContactStatus::Stick, "stick"), (ContactStatus::Slip, "slip"), (ContactStatus::Open, "open")];
    for ((status, name), y) in names.into_iter().zip((FRAME.2 + 14..).step_by(24)) {
        let count = points.iter().filter(|point| point.status == status).count();
        root.draw(&Circle::new((BAR.0 + 8, y), 7, status_colour(status).filled()))?;
        let label = text(14).pos(Pos::new(HPos::Left, VPos::Center));
        root.draw(&Text::new(format!("{name} ({count})"), (BAR.0 + 24, y), label))?;
    }
    if highest > 0.0 {
        let (top, bottom) = (middle + 30, FRAME.3);
        root.draw(&Text::new("pressure", (BAR.0, middle + 4), text(14)))?;
        for y in top..bottom {
            let share = f64::from(bottom - y) / f64::from(bottom - top);
            root.draw(&Rectangle::new([(BAR.0, y), (BAR.1, y + 1)], viridis(share).filled()))?;
        }
        for i in 0..=4 {
            let y = bottom - (bottom - top) * i / 4;
            let label = text(13).pos(Pos::new(HPos::Left, VPos::Center));
            let value = rounded(highest * f64::from(i) / 4.0);
            root.draw(&PathElement::new([(BAR.1, y), (BAR.1 + 5, y)], INK.stroke_width(1)))?;
            root.draw(&Text::new(tick(value), (BAR.1 + 9, y), label))?;
        }
    }

    let step = nice_step(view.reach);
    let first = ((view.centre - view.reach) / step).ceil() as i64;
    let last = ((view.centre + view.reach) / step).floor() as i64;
    for i in first..=last {
        let x = view.pixel(i as f64 * step, 0.0).0;
        root.draw(&PathElement::new([(x, FRAME.3), (x, FRAME.3 + 5)], INK.stroke_width(1)))?;
        root.draw(&Text::new(tick(i as f64 * step), (x, FRAME.3 + 16), centred(13)))?;
    }
    let count = (view.reach / step).floor() as i64;
    for i in -count..=count {
        let y = view.pixel(0.0, i as f64 * step).1;
        root.draw(&PathElement::new([(FRAME.0 - 5, y), (FRAME.0, y)], INK.stroke_width(1)))?;
        root.draw(&Text::new(tick(i as f64 * step), (FRAME.0 - 9, y), right(13)))?;
    }
    root.draw(&Text::new("x, along the shear", ((FRAME.0 + FRAME.1) / 2, FRAME.3 + 42), centred(15)))?;
    root.draw(&Text::new("y", (24, middle), centred(15)))?;
    Ok(())
}

/// Hides the halves of the discs that stick out and draws the border.
fn frame(root: &DrawingArea<SVGBackend<'_>, Shift>) -> Drawn {
    let (left, right, top, bottom) = FRAME;
    let (width, height) = (SIZE.0 as i32, SIZE.1 as i32);
    for cover in
        [[(0, 0), (width, top)], [(0, bottom), (width, height)], [(0, top), (left, bottom)], [(right, top), (width, bottom)]]
    {
        root.draw(&Rectangle::new(cover, WHITE.filled()))?;
    }
    root.draw(&Rectangle::new([(left, top), (right, bottom)], FAINT.stroke_width(1)))?;
    Ok(())
}

/// Three digits, for the labels of the colour bar.
fn rounded(value: f64) -> f64 {
    if value <= 0.0 {
        return 0.0;
    }
    let unit = 10f64.powf(value.log10().floor() - 2.0);
    (value / unit).round() * unit
}

/// A round distance of ticks, four to nine of them over twice the reach.
fn nice_step(reach: f64) -> f64 {
    let decade = 10f64.powf((0.5 * reach).log10().floor());
    [5.0, 2.0, 1.0].into_iter().map(|digit| digit * decade).find(|&step| step <= 0.5 * reach).unwrap_or(decade)
}
