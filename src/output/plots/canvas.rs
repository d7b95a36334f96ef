//! A surface that shapes and texts are drawn on, and that becomes an SVG. Places are in pixels and
//! written with two decimals, so that a curve through close points is as smooth as its data.

use std::cell::RefCell;
use std::fmt::{self, Write};
use std::rc::Rc;

/// A colour, red, green and blue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Colour(pub u8, pub u8, pub u8);

impl Colour {
    /// With an opacity from 0 to 1.
    pub fn mix(self, opacity: f64) -> Ink {
        Ink { colour: self, opacity }
    }
}

impl fmt::Display for Colour {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "#{:02X}{:02X}{:02X}", self.0, self.1, self.2)
    }
}

/// A colour and how opaque it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ink {
    /// The colour.
    pub colour: Colour,
    /// 1 for opaque.
    pub opacity: f64,
}

impl From<Colour> for Ink {
    fn from(colour: Colour) -> Self {
        colour.mix(1.0)
    }
}

/// How a line is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// Its colour.
    pub ink: Ink,
    /// Its width in pixels.
    pub width: f64,
    /// Lengths of dashes and gaps; none where it is solid.
    pub dashes: Option<[f64; 2]>,
}

impl Stroke {
    /// A solid line.
    pub fn solid(ink: impl Into<Ink>, width: f64) -> Self {
        Self { ink: ink.into(), width, dashes: None }
    }
}

/// How a shape is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Paint {
    /// Its inside.
    Filled(Ink),
    /// Its edge, of a width in pixels.
    Outlined(Ink, f64),
}

impl Paint {
    /// The inside in a colour.
    pub fn fill(ink: impl Into<Ink>) -> Self {
        Self::Filled(ink.into())
    }

    /// The edge in a colour.
    pub fn outline(ink: impl Into<Ink>, width: f64) -> Self {
        Self::Outlined(ink.into(), width)
    }
}

/// Which part of a text stands at its place; its middle does in height.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)] // their names say what they are
pub enum Anchor {
    Start,
    Middle,
    End,
}

/// How a text is written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Writing {
    /// Height of a line in pixels.
    pub size: f64,
    /// Which part stands at the place.
    pub anchor: Anchor,
    /// From below upwards.
    pub upwards: bool,
}

impl Writing {
    /// From left to right.
    pub fn new(size: f64, anchor: Anchor) -> Self {
        Self { size, anchor, upwards: false }
    }
}

/// What a drawing function may return; it fails where a place is not a number, which no reader of
/// SVG would forgive.
pub type Drawn = Result<(), NotFinite>;

/// A number of a drawing is not finite.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("the drawing has a number that is not finite: {0}")]
pub struct NotFinite(String);

/// The reader's own font: nothing has to be loaded.
const FONT: &str = "sans-serif";
/// Height of a line over the size of its letters.
const LINE_HEIGHT: f64 = 1.24;

/// A place on a picture.
pub type Place = (f64, f64);

/// A picture, or a panel of one with places of its own.
#[derive(Clone, Debug)]
pub struct Canvas {
    svg: Rc<RefCell<String>>,
    left: f64,
    top: f64,
    /// Width in pixels.
    pub width: f64,
    /// Height in pixels.
    pub height: f64,
}

impl Canvas {
    /// An empty picture.
    pub fn new((width, height): (u32, u32)) -> Self {
        let head = format!(
            "<svg width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" xmlns=\"http://www.w3.org/2000/svg\">\n"
        );
        let [width, height] = [width, height].map(f64::from);
        Self { svg: Rc::new(RefCell::new(head)), left: 0.0, top: 0.0, width, height }
    }

    /// The whole `<svg>` element.
    pub fn finish(self) -> String {
        self.svg.borrow().clone() + "</svg>\n"
    }

    /// A panel on the same picture.
    pub fn panel(&self, (left, top): Place, (width, height): (f64, f64)) -> Self {
        Self { svg: self.svg.clone(), left: self.left + left, top: self.top + top, width, height }
    }

    /// Panels of equal width side by side.
    pub fn columns(&self, count: usize) -> Vec<Self> {
        let width = self.width / count as f64;
        (0..count).map(|i| self.panel((i as f64 * width, 0.0), (width, self.height))).collect()
    }

    /// A line through points.
    pub fn line(&self, points: &[Place], stroke: Stroke) -> Drawn {
        let mut dashes = String::new();
        if let Some([dash, gap]) = stroke.dashes {
            dashes = format!(" stroke-dasharray=\"{},{}\"", number(dash), number(gap));
        }
        let Stroke { ink: Ink { colour, opacity }, width, .. } = stroke;
        self.add(&format!(
            "<polyline fill=\"none\" opacity=\"{}\" stroke=\"{colour}\" stroke-width=\"{}\"{dashes} points=\"{}\"/>",
            number(opacity),
            number(width),
            self.places(points)
        ))
    }

    /// A polygon.
    pub fn polygon(&self, points: &[Place], paint: Paint) -> Drawn {
        self.add(&format!("<polygon {} points=\"{}\"/>", attributes(paint), self.places(points)))
    }

    /// A rectangle between two opposite corners.
    pub fn rectangle(&self, [a, b]: [Place; 2], paint: Paint) -> Drawn {
        let (x, y) = (self.left + a.0.min(b.0), self.top + a.1.min(b.1));
        self.add(&format!(
            "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" {}/>",
            number(x),
            number(y),
            number((b.0 - a.0).abs()),
            number((b.1 - a.1).abs()),
            attributes(paint)
        ))
    }

    /// A circle.
    pub fn circle(&self, (x, y): Place, radius: f64, paint: Paint) -> Drawn {
        let (x, y) = (number(self.left + x), number(self.top + y));
        self.add(&format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{}\" {}/>", number(radius), attributes(paint)))
    }

    /// A text, its subscripts and superscripts set (see [`subscripts`]).
    pub fn text(&self, text: &str, (x, y): Place, ink: impl Into<Ink>, writing: Writing) -> Drawn {
        let Ink { colour, opacity } = ink.into();
        let (x, y) = (number(self.left + x), number(self.top + y));
        let anchor = match writing.anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let turned = if writing.upwards { format!(" transform=\"rotate(270, {x}, {y})\"") } else { String::new() };
        // Only what is written may break the rules of XML.
        self.add(&format!(
            "<text x=\"{x}\" y=\"{y}\" dy=\"0.5ex\" text-anchor=\"{anchor}\" font-family=\"{FONT}\" font-size=\"{}\" opacity=\"{}\" fill=\"{colour}\"{turned}>",
            number(writing.size / LINE_HEIGHT),
            number(opacity),
        ))?;
        let mut svg = self.svg.borrow_mut();
        // The line ends after the text.
        let end = svg.trim_end().len();
        svg.truncate(end);
        svg.push_str(&subscripts(&quick_xml::escape::partial_escape(text.trim()), writing.size / LINE_HEIGHT));
        svg.push_str("</text>\n");
        Ok(())
    }

    fn places(&self, points: &[Place]) -> String {
        let mut text = String::new();
        for (i, (x, y)) in points.iter().enumerate() {
            // Writing to a String cannot fail.
            let _ = write!(text, "{}{},{}", if i > 0 { " " } else { "" }, number(self.left + x), number(self.top + y));
        }
        text
    }

    fn add(&self, element: &str) -> Drawn {
        if element.contains("NaN") || element.contains("inf") {
            return Err(NotFinite(element.to_owned()));
        }
        let mut svg = self.svg.borrow_mut();
        svg.push_str(element);
        svg.push('\n');
        Ok(())
    }
}

fn attributes(paint: Paint) -> String {
    match paint {
        Paint::Filled(Ink { colour, opacity }) => format!("opacity=\"{}\" fill=\"{colour}\" stroke=\"none\"", number(opacity)),
        Paint::Outlined(Ink { colour, opacity }, width) => {
            format!("opacity=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{}\"", number(opacity), number(width))
        }
    }
}

/// A number with two decimals at most.
fn number(x: f64) -> String {
    let text = format!("{x:.2}");
    let short = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if short == "-0" { "0".to_owned() } else { short.to_owned() }
}

/// Turns `_x` and `_{xyz}` of a text into subscripts of an SVG, `^x` and `^{xyz}` into
/// superscripts: what follows a `_` is lowered and what follows a `^` is raised, up to the end of
/// the word or of the braces. `size` is that of the letters, in pixels: sizes in per cent or in ems
/// are not read alike everywhere.
pub fn subscripts(text: &str, size: f64) -> String {
    /// Size of what is off the line.
    const SMALL: f64 = 0.75;
    let mut out = String::new();
    let mut rest = text;
    let mut height = 0.0;
    while !rest.is_empty() {
        let (plain, after) = rest.split_at(rest.find(['_', '^']).unwrap_or(rest.len()));
        if height != 0.0 && !plain.is_empty() {
            // Back to the line; without the attribute some readers drop a space at the start of a
            // span.
            out.push_str(&format!("<tspan dy=\"{}\" xml:space=\"preserve\">{plain}</tspan>", number(-height * size)));
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
            let (shift, small) = (number((target - height) * size), number(SMALL * size));
            out.push_str(&format!("<tspan dy=\"{shift}\" font-size=\"{small}\">{inner}</tspan>"));
            height = target;
        }
        rest = after;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    const BLACK: Colour = Colour(0, 0, 0);

    #[test]
    fn places_have_two_decimals_and_panels_their_own() {
        let canvas = Canvas::new((100, 50));
        let right = canvas.columns(2).remove(1);
        assert_eq!((right.width, right.height), (50.0, 50.0));
        right
            .line(&[(0.126, 1.0), (-50.001, 1.0 / 3.0)], Stroke { dashes: Some([8.0, 4.0]), ..Stroke::solid(BLACK, 2.0) })
            .unwrap();
        right.panel((0.25, 1.0), (5.0, 5.0)).circle((1.0, 1.0), 1.5, Paint::fill(Colour(0, 114, 178).mix(0.25))).unwrap();
        canvas.rectangle([(3.0, 4.0), (1.0, 1.0)], Paint::outline(BLACK, 1.0)).unwrap();
        let svg = canvas.finish();
        for part in [
            "stroke-width=\"2\" stroke-dasharray=\"8,4\" points=\"50.13,1 0,0.33\"/>",
            "<circle cx=\"51.25\" cy=\"2\" r=\"1.5\" opacity=\"0.25\" fill=\"#0072B2\" stroke=\"none\"/>",
            "<rect x=\"1\" y=\"1\" width=\"2\" height=\"3\" opacity=\"1\" fill=\"none\" stroke=\"#000000\" stroke-width=\"1\"/>",
        ] {
            assert!(svg.contains(part), "{part} is missing in {svg}");
        }
    }

    #[test]
    fn what_is_written_is_text_and_nothing_else() {
        let canvas = Canvas::new((10, 10));
        canvas.text(" inf < a & F_N ", (1.0, 2.0), BLACK, Writing { upwards: true, ..Writing::new(12.4, Anchor::End) }).unwrap();
        let svg = canvas.finish();
        assert!(svg.contains("text-anchor=\"end\" font-family=\"sans-serif\" font-size=\"10\" opacity=\"1\""), "{svg}");
        assert!(svg.contains(" transform=\"rotate(270, 1, 2)\">inf &lt; a &amp; F<tspan "), "{svg}");
    }

    #[test]
    fn what_is_not_a_number_is_refused() {
        let canvas = Canvas::new((10, 10));
        let stroke = Stroke::solid(BLACK, 1.0);
        assert!(canvas.line(&[(0.0, f64::NAN)], stroke).unwrap_err().to_string().contains("points=\"0,NaN\""));
        assert!(canvas.circle((f64::INFINITY, 0.0), 1.0, Paint::fill(BLACK)).is_err());
        assert_eq!(canvas.finish().lines().count(), 2);
    }

    #[test]
    fn subscripts_are_lowered_and_the_line_goes_on() {
        let low = |text: &str| format!("<tspan dy=\"3\" font-size=\"9\">{text}</tspan>");
        let back = |text: &str| format!("<tspan dy=\"-3\" xml:space=\"preserve\">{text}</tspan>");
        let subscripts = |text: &str| subscripts(text, 12.0);
        assert_eq!(subscripts("plain &amp; simple"), "plain &amp; simple");
        assert_eq!(subscripts("F_N"), format!("F{}", low("N")));
        assert_eq!(subscripts("F_N/δ_{T,slip} x"), format!("F{}{}{}{}", low("N"), back("/δ"), low("T,slip"), back(" x")));
        let up = "<tspan dy=\"-4.5\" font-size=\"9\">n</tspan>";
        assert_eq!(subscripts("(1 − x)^n b"), format!("(1 − x){up}<tspan dy=\"4.5\" xml:space=\"preserve\"> b</tspan>"));
        assert_eq!(subscripts("a_"), "a");
    }
}
