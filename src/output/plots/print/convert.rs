//! The conversions themselves: svg2pdf for PDF, resvg for PNG.

use std::sync::{Arc, OnceLock};

use resvg::tiny_skia::{Pixmap, Transform};
use svg2pdf::usvg::{Options, Tree, fontdb::Database};
use svg2pdf::{ConversionOptions, PageOptions};

/// DejaVu Sans, less the letters that no picture has (see `font/README.md`).
const FONT: &[u8] = include_bytes!("font/DejaVuSans.ttf");
/// Its slanted sister, for symbols.
const OBLIQUE: &[u8] = include_bytes!("font/DejaVuSans-Oblique.ttf");
/// Pixels of CSS to the inch, and those of a PNG whose width is a length.
const CSS: f32 = 96.0;
const PIXELS_PER_INCH: f32 = 300.0;
/// Most pixels of a PNG along a side: half a gigabyte.
const MOST_PIXELS: u32 = 12_000;

fn fonts() -> Arc<Database> {
    static FONTS: OnceLock<Arc<Database>> = OnceLock::new();
    let load = || {
        let mut fonts = Database::new();
        fonts.load_font_data(FONT.to_vec());
        fonts.load_font_data(OBLIQUE.to_vec());
        fonts.set_sans_serif_family("DejaVu Sans");
        Arc::new(fonts)
    };
    FONTS.get_or_init(load).clone()
}

fn tree(svg: &str) -> Result<Tree, String> {
    let options = Options { fontdb: fonts(), dpi: CSS, ..Options::default() };
    Tree::from_str(svg, &options).map_err(|error| format!("its SVG cannot be read: {error}"))
}

/// A page of the picture's size, text as text.
pub fn pdf(svg: &str) -> Result<Vec<u8>, String> {
    let page = PageOptions { dpi: CSS };
    svg2pdf::to_pdf(&tree(svg)?, ConversionOptions::default(), page).map_err(|error| format!("it cannot be made a PDF: {error}"))
}

/// As many pixels as the SVG is wide where that is in pixels and was asked for, else 300 to the
/// inch.
pub fn png(svg: &str) -> Result<Vec<u8>, String> {
    let tree = tree(svg)?;
    // An exact number of pixels stands in the SVG as it was asked for, a length with its unit.
    let head = svg.split('>').next().unwrap_or_default();
    let in_pixels = head.contains("px\"");
    let scale = if in_pixels { 1.0 } else { PIXELS_PER_INCH / CSS };
    let side = |length: f32| (length * scale).round().max(1.0) as u32;
    let (width, height) = (side(tree.size().width()), side(tree.size().height()));
    if width.max(height) > MOST_PIXELS {
        return Err(format!("{width} x {height} pixels are too many; ask for a width of at most {MOST_PIXELS} pixels"));
    }
    let mut pixels = Pixmap::new(width, height).ok_or_else(|| format!("{width} x {height} pixels are too many"))?;
    resvg::render(&tree, Transform::from_scale(scale, scale), &mut pixels.as_mut());
    let png = pixels.encode_png().map_err(|error| format!("it cannot be made a PNG: {error}"))?;
    Ok(with_density(png, if in_pixels { CSS } else { PIXELS_PER_INCH }))
}

/// Writes into a PNG how large it is on paper (the chunk pHYs), which the encoder leaves out: LaTeX
/// and word processors take their size from it.
fn with_density(png: Vec<u8>, per_inch: f32) -> Vec<u8> {
    /// Signature and header: what a PNG begins with.
    const HEAD: usize = 8 + 25;
    let per_metre = (f64::from(per_inch) / 0.0254).round() as u32;
    let mut chunk = b"pHYs".to_vec();
    chunk.extend(per_metre.to_be_bytes());
    chunk.extend(per_metre.to_be_bytes());
    chunk.push(1);
    let mut out = Vec::with_capacity(png.len() + 21);
    out.extend(&png[..HEAD]);
    out.extend(9_u32.to_be_bytes());
    out.extend(&chunk);
    out.extend(crc32fast::hash(&chunk).to_be_bytes());
    out.extend(&png[HEAD..]);
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn svg(head: &str, text: &str) -> String {
        format!(
            "<svg {head} viewBox=\"0 0 400 200\" xmlns=\"http://www.w3.org/2000/svg\"><rect width=\"400\" height=\"200\" fill=\"#FFFFFF\"/>\
             <text x=\"20\" y=\"100\" font-family=\"sans-serif\" font-size=\"60\" fill=\"#000000\">{text}</text></svg>"
        )
    }

    /// Width, height and pixels to the metre of a PNG.
    fn size(png: &[u8]) -> [u32; 3] {
        let number = |at: usize| u32::from_be_bytes(png[at..at + 4].try_into().unwrap());
        let chunk = png.windows(4).position(|name| name == b"pHYs").unwrap();
        [number(16), number(20), number(chunk + 4)]
    }

    #[test]
    fn a_png_has_300_pixels_to_the_inch_or_as_many_as_are_asked_for() {
        let of = |head: &str| size(&png(&svg(head, "x")).unwrap());
        assert_eq!(of("width=\"85mm\" height=\"42.5mm\""), [1004, 502, 11811]);
        assert_eq!(of("width=\"240px\" height=\"120px\""), [240, 120, 3780]);
        assert_eq!(of("width=\"400\" height=\"200\""), [1250, 625, 11811]);
        assert!(png(&svg("width=\"2000mm\" height=\"1000mm\"", "x")).unwrap_err().contains("too many"));
        assert!(Pixmap::decode_png(&png(&svg("width=\"85mm\" height=\"42.5mm\"", "x")).unwrap()).is_ok());
    }

    #[test]
    fn a_pdf_has_the_size_of_the_picture_and_its_font() {
        let bytes = pdf(&svg("width=\"85mm\" height=\"42.5mm\"", "F")).unwrap();
        let text = String::from_utf8_lossy(&bytes);
        assert!(text.starts_with("%PDF-") && text.trim_end().ends_with("%%EOF"));
        let page = text.split("/MediaBox").nth(1).unwrap().split(']').next().unwrap();
        let sides: Vec<f64> = page.trim_start_matches([' ', '[']).split_whitespace().map(|side| side.parse().unwrap()).collect();
        assert!((sides[2] - 85.0 / 25.4 * 72.0).abs() < 0.1 && (sides[3] - 42.5 / 25.4 * 72.0).abs() < 0.1, "{sides:?}");
        assert!(text.contains("/FontFile") && text.contains("DejaVuSans"), "the font comes along");
        // Letters that can be searched for, not outlines.
        assert!(text.contains("/ToUnicode"));
    }

    /// No font of the machine is ever asked: every letter of the pictures is in the font that comes
    /// along.
    #[test]
    fn every_letter_of_the_pictures_is_there() {
        let drawn = |text: &str| png(&svg("width=\"400px\" height=\"200px\"", text)).unwrap();
        let (nothing, unknown) = (drawn(""), drawn("\u{6f22}"));
        for letter in "AzFδμΛσνπε√∛−²·×≥äéЖ%=/()[]".chars() {
            let picture = drawn(&letter.to_string());
            assert!(picture != nothing && picture != unknown, "{letter} is missing");
        }
        assert_ne!(drawn("<tspan text-decoration=\"overline\">H</tspan>"), drawn("H"), "the bar is drawn");
        for text in ["H", "δ"] {
            let slanted = format!("<tspan font-style=\"italic\">{text}</tspan>");
            assert_ne!(drawn(&slanted), drawn(text), "it is slanted");
            assert_ne!(drawn(&format!("{slanted}, 3 ² ≥ ж")), drawn(&format!("{text}, 3 ² ≥ ж")), "also beside others");
        }
    }
}
