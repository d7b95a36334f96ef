//! Colours, the card and the writing of numbers, common to all plots.

use super::super::{OutputError, write_atomically};
use plotters::coord::Shift;
use plotters::prelude::*;
use std::path::Path;

/// Text and axes.
pub(super) const INK: RGBColor = RGBColor(0x22, 0x22, 0x22);
/// Grid lines, frames.
pub(super) const FAINT: RGBColor = RGBColor(0xdd, 0xdd, 0xdd);
/// Okabe & Ito's colours, distinguishable with every kind of colour vision and in grey.
pub(super) const BLUE: RGBColor = RGBColor(0x00, 0x72, 0xb2);
pub(super) const VERMILION: RGBColor = RGBColor(0xd5, 0x5e, 0x00);
pub(super) const ORANGE: RGBColor = RGBColor(0xe6, 0x9f, 0x00);
pub(super) const GREEN: RGBColor = RGBColor(0x00, 0x9e, 0x73);
pub(super) const GREY: RGBColor = RGBColor(0x80, 0x80, 0x80);

pub(super) const FONT: &str = "sans-serif";

/// What a drawing function may return.
pub(super) type Drawn = Result<(), Box<dyn std::error::Error>>;

/// Draws a white card of that size and writes it as SVG, whole or not at all.
pub(super) fn draw(
    path: &Path,
    size: (u32, u32),
    picture: impl FnOnce(&DrawingArea<SVGBackend<'_>, Shift>) -> Drawn,
) -> Result<(), OutputError> {
    let mut svg = String::new();
    let drawn = (|| {
        let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        root.fill(&WHITE)?;
        picture(&root)?;
        root.present()?;
        Ok::<(), Box<dyn std::error::Error>>(())
    })();
    drawn.map_err(|error| OutputError::Inconsistent { path: path.to_path_buf(), problem: error.to_string() })?;
    write_atomically(path, |out| out.write_all(svg.as_bytes()))
}

/// A number on an axis: plain where that is short, with an exponent elsewhere.
pub(super) fn tick(value: f64) -> String {
    let size = value.abs();
    if size < 1e-300 {
        return "0".into();
    }
    if !(1e-4..1e6).contains(&size) {
        let text = format!("{value:.3e}");
        let (digits, exponent) = text.split_once('e').unwrap_or((&text, "0"));
        return format!("{}e{exponent}", shorten(digits));
    }
    let decimals = (5 - size.log10().floor() as i32).clamp(0, 9) as usize;
    shorten(&format!("{value:.decimals$}")).to_owned()
}

fn shorten(digits: &str) -> &str {
    if digits.contains('.') { digits.trim_end_matches('0').trim_end_matches('.') } else { digits }
}

/// Viridis at `x` in \[0, 1\], from nine of its colours: rising lightness, so that it holds in grey.
pub(super) fn viridis(x: f64) -> RGBColor {
    const STOPS: [[u8; 3]; 9] = [
        [68, 1, 84],
        [71, 44, 122],
        [59, 81, 139],
        [44, 113, 142],
        [33, 144, 141],
        [39, 173, 129],
        [92, 200, 99],
        [170, 220, 50],
        [253, 231, 37],
    ];
    let place = x.clamp(0.0, 1.0) * (STOPS.len() - 1) as f64;
    let below = (place as usize).min(STOPS.len() - 2);
    let share = place - below as f64;
    let mix = |i: usize| (f64::from(STOPS[below][i]) * (1.0 - share) + f64::from(STOPS[below + 1][i]) * share).round() as u8;
    RGBColor(mix(0), mix(1), mix(2))
}
