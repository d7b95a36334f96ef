//! Colours, the card and the writing of numbers, common to all plots.

use super::super::{OutputError, write_own};
use super::canvas::{Canvas, Colour, Drawn, Paint};
use super::print::print;
use super::sheet::Size;
use crate::case::PictureFormat;
use std::path::Path;

/// The card.
pub const WHITE: Colour = Colour(0xff, 0xff, 0xff);
/// Text and axes.
pub const INK: Colour = Colour(0x22, 0x22, 0x22);
/// Grid lines between those with a number.
pub const PALE: Colour = Colour(0xf0, 0xf0, 0xf0);
/// Grid lines, frames.
pub const FAINT: Colour = Colour(0xdd, 0xdd, 0xdd);
/// Okabe & Ito's colours, distinguishable with every kind of colour vision and in grey.
pub const BLUE: Colour = Colour(0x00, 0x72, 0xb2);
/// Vermilion of the same.
pub const VERMILION: Colour = Colour(0xd5, 0x5e, 0x00);
/// Orange of the same.
pub const ORANGE: Colour = Colour(0xe6, 0x9f, 0x00);
/// Bluish green of the same.
pub const GREEN: Colour = Colour(0x00, 0x9e, 0x73);
/// Reddish purple of the same.
pub const PURPLE: Colour = Colour(0xcc, 0x79, 0xa7);
/// For published curves.
pub const TEAL: Colour = Colour(0x1b, 0x7f, 0x8c);
/// For published curves.
pub const VIOLET: Colour = Colour(0x8a, 0x4f, 0xa3);
/// For curves that are there for comparison.
pub const GREY: Colour = Colour(0x80, 0x80, 0x80);
/// Colours of groups, in the order in which groups get them.
pub const GROUPS: [Colour; 6] = [BLUE, VERMILION, GREEN, ORANGE, PURPLE, INK];

/// A picture that is drawn and not yet written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Name of its file, without its ending.
    pub name: &'static str,
    /// What it shows and how to read it, a sentence or two.
    pub caption: String,
    /// The whole `<svg>` element.
    pub svg: String,
}

impl Picture {
    /// Draws a white card of that size: dark text on it can be read in print and on a dark screen
    /// alike.
    ///
    /// # Errors
    /// The drawing fails; it depends on the data alone.
    pub fn draw(
        name: &'static str,
        caption: impl Into<String>,
        size: Size,
        picture: impl FnOnce(&Canvas) -> Drawn,
    ) -> Result<Self, OutputError> {
        let (canvas, caption) = (Canvas::new(size), caption.into());
        let drawn = canvas
            .rectangle([(0.0, 0.0), (canvas.width, canvas.height)], Paint::fill(WHITE))
            .and_then(|()| canvas.describe(&caption))
            .and_then(|()| picture(&canvas))
            .map_err(|error| OutputError::Inconsistent { path: format!("{name}.svg").into(), problem: error.to_string() });
        drawn.map(|()| Self { name, caption, svg: canvas.finish() })
    }

    /// Writes it as `path`, whole or not at all.
    ///
    /// # Errors
    /// The place cannot be written; a program without the feature `print` makes SVG alone.
    pub fn write(&self, path: &Path, format: PictureFormat) -> Result<(), OutputError> {
        let bytes = print(&self.svg, format).map_err(|problem| OutputError::Format { path: path.to_owned(), problem })?;
        write_own(path, |out| out.write_all(&bytes))
    }
}

/// A number on an axis: plain where that is short, with an exponent elsewhere.
pub fn tick(value: f64) -> String {
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

/// To three digits.
pub fn rounded(value: f64) -> f64 {
    if value == 0.0 || !value.is_finite() {
        return 0.0;
    }
    let unit = 10f64.powf(value.abs().log10().floor() - 2.0);
    (value / unit).round() * unit
}

fn shorten(digits: &str) -> &str {
    if digits.contains('.') { digits.trim_end_matches('0').trim_end_matches('.') } else { digits }
}

/// Viridis at `x` in \[0, 1\], from nine of its colours: rising lightness, so that it holds in
/// grey.
pub fn viridis(x: f64) -> Colour {
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
    Colour(mix(0), mix(1), mix(2))
}
