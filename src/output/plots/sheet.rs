//! How large a picture is: laid out anew for the width in which it will be printed, so that its
//! text stays legible.

use crate::case::{PictureWidth, WidthUnit};

/// Pixels of a layout in one pixel of paper: text of 13 pixels is then 7 points high.
const DENSITY: f64 = 1.0 / 0.89;
/// Narrowest layout; narrower pictures are this one, smaller.
const NARROWEST: f64 = 340.0;
/// Narrowest panel of a picture that has several beside each other.
const NARROWEST_PANEL: f64 = 340.0;

/// The width in which pictures are made; by default each has its own.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sheet {
    /// On paper or on the screen.
    pub width: Option<PictureWidth>,
    /// Whether diagrams have no titles, where a caption says what they show.
    pub untitled: bool,
}

/// The size of one picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Size {
    /// Width of the layout in its pixels.
    pub width: f64,
    /// Height of the layout in its pixels.
    pub height: f64,
    /// Width on paper; that of the layout if none is asked for.
    pub printed: Option<PictureWidth>,
    /// Whether its diagrams have no titles.
    pub untitled: bool,
}

impl Size {
    /// Width and height as they are printed.
    pub fn printed(&self) -> [PictureWidth; 2] {
        let width = self.printed.unwrap_or(PictureWidth { value: self.width, unit: WidthUnit::Pixel });
        [width, PictureWidth { value: width.value * self.height / self.width, ..width }]
    }
}

impl Sheet {
    /// The width of a layout that is `natural` pixels wide where nothing is asked for. A wider
    /// sheet than that enlarges it.
    pub fn width_of(&self, natural: f64) -> f64 {
        let asked = self.width.map_or(natural, |width| (width.pixels() * DENSITY).round());
        asked.clamp(NARROWEST.min(natural), natural)
    }

    /// The size of a layout whose width is known.
    pub fn size(&self, width: f64, height: f64) -> Size {
        Size { width, height: height.round(), printed: self.width, untitled: self.untitled }
    }

    /// One diagram: a narrow one is less wide for its height.
    pub fn chart(&self, natural: (u32, u32)) -> Size {
        let width = self.width_of(f64::from(natural.0));
        self.size(width, scaled_height(natural, width))
    }

    /// `count` diagrams beside each other, below each other where they would be too narrow: the
    /// size of all and the number of columns.
    pub fn charts(&self, natural: (u32, u32), count: usize) -> (Size, usize) {
        let count = count.max(1);
        let width = self.width_of(f64::from(natural.0));
        let columns = ((width / NARROWEST_PANEL) as usize).clamp(1, count);
        let panel = (natural.0 / u32::try_from(count).unwrap_or(1), natural.1);
        let height = scaled_height(panel, (width / columns as f64).min(f64::from(panel.0)));
        (self.size(width, height * count.div_ceil(columns) as f64), columns)
    }
}

fn scaled_height(natural: (u32, u32), width: f64) -> f64 {
    let (across, down) = (f64::from(natural.0), f64::from(natural.1));
    (down * (0.3 + 0.7 * width / across)).round()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sheet(width: &str) -> Sheet {
        Sheet { width: Some(width.parse().unwrap()), untitled: false }
    }

    #[test]
    fn a_narrow_picture_is_laid_out_anew_and_a_wide_one_enlarged() {
        let natural = Sheet::default().chart((760, 480));
        assert_eq!((natural.width, natural.height, natural.printed().map(|side| side.value)), (760.0, 480.0, [760.0, 480.0]));
        let column = sheet("85mm").chart((760, 480));
        assert!((column.width - 361.0).abs() < 1.0 && column.height > 0.75 * column.width, "{column:?}");
        let [width, height] = column.printed();
        assert_eq!((width.value, width.unit.symbol()), (85.0, "mm"));
        assert!((height.value / width.value - column.height / column.width).abs() < 1e-12);
        assert_eq!(sheet("2000px").chart((760, 480)).width, 760.0);
        assert_eq!(sheet("20mm").chart((760, 480)).width, NARROWEST);
    }

    #[test]
    fn panels_stand_below_each_other_where_they_would_be_too_narrow() {
        let columns = |sheet: Sheet| sheet.charts((1180, 540), 2).1;
        assert_eq!((columns(Sheet::default()), columns(sheet("170mm")), columns(sheet("85mm"))), (2, 2, 1));
        let one = sheet("85mm").charts((1180, 540), 2).0;
        assert!(one.height > 1.5 * one.width, "{one:?}");
    }
}
