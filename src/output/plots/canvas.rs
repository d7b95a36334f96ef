//! A surface that shapes and texts are drawn on, and that becomes an SVG. Places are in pixels and
//! written with two decimals, so that a curve through close points is as smooth as its data.

use std::cell::RefCell;
use std::fmt::{self, Write};
use std::rc::Rc;

use crate::case::WidthUnit;

use super::sheet::Size;
use super::text::{LINE_HEIGHT, number, subscripts};

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

/// A place on a picture.
pub type Pixel = (f64, f64);

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
    /// Whether diagrams on it have no titles.
    pub untitled: bool,
}

impl Canvas {
    /// An empty picture.
    pub fn new(size: Size) -> Self {
        let Size { width, height, untitled, .. } = size;
        // A width in pixels that was asked for has its unit; it stands for that many pixels of a
        // PNG.
        let [across, down] = size.printed().map(|side| match (size.printed, side.unit) {
            (None, _) => number(side.value),
            (_, WidthUnit::Pixel) => format!("{}px", number(side.value)),
            (_, unit) => format!("{:.4}{}", side.value, unit.symbol()),
        });
        let head = format!(
            "<svg width=\"{across}\" height=\"{down}\" viewBox=\"0 0 {} {}\" xmlns=\"http://www.w3.org/2000/svg\">\n",
            number(width),
            number(height)
        );
        Self { svg: Rc::new(RefCell::new(head)), left: 0.0, top: 0.0, width, height, untitled }
    }

    /// The whole `<svg>` element.
    pub fn finish(self) -> String {
        self.svg.borrow().clone() + "</svg>\n"
    }

    /// A panel on the same picture.
    pub fn panel(&self, (left, top): Pixel, (width, height): (f64, f64)) -> Self {
        Self { svg: self.svg.clone(), left: self.left + left, top: self.top + top, width, height, untitled: self.untitled }
    }

    /// `count` panels of equal size, row by row.
    pub fn grid(&self, count: usize, columns: usize) -> Vec<Self> {
        let (width, height) = (self.width / columns as f64, self.height / count.div_ceil(columns).max(1) as f64);
        (0..count).map(|i| self.panel(((i % columns) as f64 * width, (i / columns) as f64 * height), (width, height))).collect()
    }

    /// A line through points.
    pub fn line(&self, points: &[Pixel], stroke: Stroke) -> Drawn {
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
    pub fn polygon(&self, points: &[Pixel], paint: Paint) -> Drawn {
        self.add(&format!("<polygon {} points=\"{}\"/>", attributes(paint), self.places(points)))
    }

    /// The area between closed lines, holes being those that lie within others.
    pub fn area(&self, loops: &[Vec<Pixel>], paint: Paint) -> Drawn {
        let mut path = String::new();
        for points in loops.iter().filter(|points| points.len() > 2) {
            // Writing to a String cannot fail.
            let _ = write!(path, "M{}Z", self.places(points));
        }
        if path.is_empty() {
            Ok(())
        } else {
            self.add(&format!("<path {} fill-rule=\"evenodd\" d=\"{path}\"/>", attributes(paint)))
        }
    }

    /// A rectangle whose colour goes over from one side to the other: `colour` of 0 to 1, from the
    /// left, or from the foot if `upwards`.
    pub fn ramp(&self, [a, b]: [Pixel; 2], upwards: bool, colour: impl Fn(f64) -> Colour) -> Drawn {
        const STOPS: u32 = 32;
        let mut stops = String::new();
        for i in 0..=STOPS {
            let share = f64::from(i) / f64::from(STOPS);
            let _ = write!(stops, "<stop offset=\"{share}\" stop-color=\"{}\"/>", colour(share));
        }
        let [x1, y1, x2, y2] = if upwards { [0, 1, 0, 0] } else { [0, 0, 1, 0] };
        // The same name stands for the same colours, where several pictures are on one page.
        let name = format!("ramp-{:08x}", crc32fast::hash(format!("{upwards}{stops}").as_bytes()));
        let (x, y) = (self.left + a.0.min(b.0), self.top + a.1.min(b.1));
        self.add(&format!(
            "<linearGradient id=\"{name}\" x1=\"{x1}\" y1=\"{y1}\" x2=\"{x2}\" y2=\"{y2}\">{stops}</linearGradient>\n\
             <rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"url(#{name})\"/>",
            number(x),
            number(y),
            number((b.0 - a.0).abs()),
            number((b.1 - a.1).abs()),
        ))
    }

    /// Words for those who do not see the picture, and for programs.
    pub fn describe(&self, text: &str) -> Drawn {
        self.svg.borrow_mut().push_str(&format!("<desc>{}</desc>\n", quick_xml::escape::partial_escape(text.trim())));
        Ok(())
    }

    /// A rectangle between two opposite corners.
    pub fn rectangle(&self, [a, b]: [Pixel; 2], paint: Paint) -> Drawn {
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
    pub fn circle(&self, (x, y): Pixel, radius: f64, paint: Paint) -> Drawn {
        let (x, y) = (number(self.left + x), number(self.top + y));
        self.add(&format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{}\" {}/>", number(radius), attributes(paint)))
    }

    /// A text, its subscripts and superscripts set (see `text.rs`).
    pub fn text(&self, text: &str, (x, y): Pixel, ink: impl Into<Ink>, writing: Writing) -> Drawn {
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

    fn places(&self, points: &[Pixel]) -> String {
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

#[cfg(test)]
mod tests {
    use super::*;

    const BLACK: Colour = Colour(0, 0, 0);

    fn canvas(width: f64, height: f64) -> Canvas {
        Canvas::new(Size { width, height, printed: None, untitled: false })
    }

    #[test]
    fn places_have_two_decimals_and_panels_their_own() {
        let canvas = canvas(100.0, 50.0);
        let right = canvas.grid(2, 2).remove(1);
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
        let canvas = canvas(10.0, 10.0);
        canvas.text(" inf < a & F_N ", (1.0, 2.0), BLACK, Writing { upwards: true, ..Writing::new(12.4, Anchor::End) }).unwrap();
        let svg = canvas.finish();
        assert!(svg.contains("text-anchor=\"end\" font-family=\"sans-serif\" font-size=\"10\" opacity=\"1\""), "{svg}");
        let [a, f] = ["a", "F"].map(|letter| format!("<tspan font-style=\"italic\">{letter}</tspan>"));
        assert!(svg.contains(&format!(" transform=\"rotate(270, 1, 2)\">inf &lt; {a} &amp; {f}<tspan ")), "{svg}");
    }

    #[test]
    fn what_is_not_a_number_is_refused() {
        let canvas = canvas(10.0, 10.0);
        let stroke = Stroke::solid(BLACK, 1.0);
        assert!(canvas.line(&[(0.0, f64::NAN)], stroke).unwrap_err().to_string().contains("points=\"0,NaN\""));
        assert!(canvas.circle((f64::INFINITY, 0.0), 1.0, Paint::fill(BLACK)).is_err());
        assert_eq!(canvas.finish().lines().count(), 2);
    }
}
