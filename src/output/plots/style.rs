//! Colours, the card and the writing of numbers, common to all plots.

use super::super::{OutputError, write_atomically};
use plotters::coord::Shift;
use plotters::prelude::*;
use std::path::Path;

/// A colour.
pub type Colour = RGBColor;

/// Text and axes.
pub const INK: RGBColor = RGBColor(0x22, 0x22, 0x22);
/// Grid lines between those with a number.
pub const PALE: RGBColor = RGBColor(0xf0, 0xf0, 0xf0);
/// Grid lines, frames.
pub const FAINT: RGBColor = RGBColor(0xdd, 0xdd, 0xdd);
/// Okabe & Ito's colours, distinguishable with every kind of colour vision and in grey.
pub const BLUE: RGBColor = RGBColor(0x00, 0x72, 0xb2);
/// Vermilion of the same.
pub const VERMILION: RGBColor = RGBColor(0xd5, 0x5e, 0x00);
/// Orange of the same.
pub const ORANGE: RGBColor = RGBColor(0xe6, 0x9f, 0x00);
/// Bluish green of the same.
pub const GREEN: RGBColor = RGBColor(0x00, 0x9e, 0x73);
/// Reddish purple of the same.
pub const PURPLE: RGBColor = RGBColor(0xcc, 0x79, 0xa7);
/// For published curves.
pub const TEAL: RGBColor = RGBColor(0x1b, 0x7f, 0x8c);
/// For published curves.
pub const VIOLET: RGBColor = RGBColor(0x8a, 0x4f, 0xa3);
/// For curves that are there for comparison.
pub const GREY: RGBColor = RGBColor(0x80, 0x80, 0x80);
/// Colours of groups, in the order in which groups get them.
pub const GROUPS: [RGBColor; 6] = [BLUE, VERMILION, GREEN, ORANGE, PURPLE, INK];

/// The reader's own font: nothing has to be loaded.
pub const FONT: &str = "sans-serif";

/// Where a picture, or one of its panels, is drawn.
pub type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// What a drawing function may return.
pub type Drawn = Result<(), Box<dyn std::error::Error>>;

/// A picture that is drawn and not yet written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Name of its file, without `.svg`.
    pub name: &'static str,
    /// What it shows and how to read it, a sentence or two.
    pub caption: String,
    /// The whole `<svg>` element.
    pub svg: String,
}

impl Picture {
    /// Draws a white card of that size: dark text on it can be read in print and on a dark screen alike.
    ///
    /// # Errors
    /// The drawing fails; it depends on the data alone.
    pub fn draw(
        name: &'static str,
        caption: impl Into<String>,
        size: (u32, u32),
        picture: impl FnOnce(&Area<'_>) -> Drawn,
    ) -> Result<Self, OutputError> {
        let mut svg = String::new();
        let drawn = (|| {
            let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
            root.fill(&WHITE)?;
            picture(&root)?;
            root.present()?;
            Ok::<(), Box<dyn std::error::Error>>(())
        })();
        drawn.map_err(|error| OutputError::Inconsistent { path: format!("{name}.svg").into(), problem: error.to_string() })?;
        Ok(Self { name, caption: caption.into(), svg: with_subscripts(&svg) })
    }

    /// Writes it as `path`, whole or not at all.
    ///
    /// # Errors
    /// The place cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), OutputError> {
        write_atomically(path, |out| out.write_all(self.svg.as_bytes()))
    }
}

/// Turns `_x` and `_{xyz}` in the texts of an SVG into subscripts, `^x` and `^{xyz}` into superscripts.
fn with_subscripts(svg: &str) -> String {
    let mut out = String::with_capacity(svg.len());
    let mut rest = svg;
    while let Some(begin) = rest.find("<text") {
        let Some(open) = rest[begin..].find('>').map(|at| begin + at + 1) else { break };
        let Some(close) = rest[open..].find("</text>").map(|at| open + at) else { break };
        out.push_str(&rest[..open]);
        out.push_str(&subscripts(rest[open..close].trim()));
        rest = &rest[close..];
    }
    out + rest
}

/// One text: what follows a `_` is lowered and what follows a `^` is raised, up to the end of the word or of the braces.
fn subscripts(text: &str) -> String {
    /// Size of what is off the line.
    const SMALL: f64 = 0.75;
    let mut out = String::new();
    let mut rest = text;
    let mut height = 0.0;
    while !rest.is_empty() {
        let (plain, after) = rest.split_at(rest.find(['_', '^']).unwrap_or(rest.len()));
        if height != 0.0 && !plain.is_empty() {
            // Back to the line; without the attribute some readers drop a space at the start of a span.
            out.push_str(&format!("<tspan dy=\"{}em\" xml:space=\"preserve\">{plain}</tspan>", -height));
            height = 0.0;
        } else {
            out.push_str(plain);
        }
        let target = match after.chars().next() {
            Some('_') => 0.25,
            Some(_) => -0.375,
            None => break,
        };
        let after = &after[1..];
        let (inner, after) = match after.strip_prefix('{').and_then(|after| after.split_once('}')) {
            Some(pair) => pair,
            None => after.split_at(after.find(|c: char| !c.is_alphanumeric()).unwrap_or(after.len())),
        };
        if !inner.is_empty() {
            // Ems are those of the small letters.
            let shift = (target - height) / SMALL;
            out.push_str(&format!("<tspan dy=\"{shift:.3}em\" style=\"font-size:75%\">{inner}</tspan>"));
            height = target;
        }
        rest = after;
    }
    out
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

/// Viridis at `x` in \[0, 1\], from nine of its colours: rising lightness, so that it holds in grey.
pub fn viridis(x: f64) -> RGBColor {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn subscripts_are_lowered_and_the_line_goes_on() {
        let low = |text: &str| format!("<tspan dy=\"0.333em\" style=\"font-size:75%\">{text}</tspan>");
        let back = |text: &str| format!("<tspan dy=\"-0.25em\" xml:space=\"preserve\">{text}</tspan>");
        assert_eq!(subscripts("plain &amp; simple"), "plain &amp; simple");
        assert_eq!(subscripts("F_N"), format!("F{}", low("N")));
        assert_eq!(subscripts("F_N/δ_{T,slip} x"), format!("F{}{}{}{}", low("N"), back("/δ"), low("T,slip"), back(" x")));
        let up = "<tspan dy=\"-0.500em\" style=\"font-size:75%\">n</tspan>";
        assert_eq!(subscripts("(1 − x)^n b"), format!("(1 − x){up}<tspan dy=\"0.375em\" xml:space=\"preserve\"> b</tspan>"));
        assert_eq!(subscripts("a_"), "a");
        let svg = "<svg><text x=\"1\">\nF_T\n</text><line x_y=\"2\"/><text>b</text></svg>";
        assert_eq!(with_subscripts(svg), format!("<svg><text x=\"1\">F{}</text><line x_y=\"2\"/><text>b</text></svg>", low("T")));
    }
}
