//! How pictures are made: the format of their files, their width, and the names of the user's
//! units.

use std::fmt;
use std::path::Path;
use std::str::FromStr;

use serde::{Serialize, Serializer};

use super::CaseError;
use super::reader::{Field, Reader};

/// The format of a picture's file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum PictureFormat {
    /// Scalable Vector Graphics, for browsers and drawing programs.
    #[default]
    Svg,
    /// Portable Document Format, for LaTeX and for print.
    Pdf,
    /// Portable Network Graphics, 300 pixels to the inch unless the width is in pixels.
    Png,
}

impl PictureFormat {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Svg, Self::Pdf, Self::Png];

    /// The ending of the file's name, without a point.
    pub fn ending(self) -> &'static str {
        match self {
            Self::Svg => "svg",
            Self::Pdf => "pdf",
            Self::Png => "png",
        }
    }

    /// What the ending of a file's name stands for, in large letters or small ones.
    pub fn of_file(file: &Path) -> Option<Self> {
        let ending = file.extension()?.to_str()?.to_ascii_lowercase();
        Self::ALL.into_iter().find(|format| format.ending() == ending)
    }
}

/// A unit of [`PictureWidth`]. A pixel is a 96th of an inch, as in CSS.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)] // their names say what they are
pub enum WidthUnit {
    Millimetre,
    Centimetre,
    Inch,
    Point,
    Pixel,
}

impl WidthUnit {
    const ALL: [Self; 5] = [Self::Millimetre, Self::Centimetre, Self::Inch, Self::Point, Self::Pixel];

    /// As it is written, in SVG too.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Millimetre => "mm",
            Self::Centimetre => "cm",
            Self::Inch => "in",
            Self::Point => "pt",
            Self::Pixel => "px",
        }
    }

    /// Pixels of CSS in one of it.
    pub fn pixels(self) -> f64 {
        match self {
            Self::Millimetre => 96.0 / 25.4,
            Self::Centimetre => 960.0 / 25.4,
            Self::Inch => 96.0,
            Self::Point => 96.0 / 72.0,
            Self::Pixel => 1.0,
        }
    }
}

/// The width of a picture as it is printed or shown: `85mm`, `8.5cm`, `3.3in`, `240pt`, `640px`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PictureWidth {
    /// In `unit`.
    pub value: f64,
    /// What it is measured in.
    pub unit: WidthUnit,
}

/// What a width may be, for messages.
pub const WIDTHS: &str = "a width from 60 to 10000 px (16 mm to 2.6 m) in mm, cm, in, pt or px, as in \"85mm\"";

impl PictureWidth {
    /// In pixels of CSS, of which an inch has 96.
    pub fn pixels(self) -> f64 {
        self.value * self.unit.pixels()
    }
}

impl FromStr for PictureWidth {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let refused = || format!("{text:?} is not {WIDTHS}");
        let trimmed = text.trim();
        let unit = WidthUnit::ALL.into_iter().find(|unit| trimmed.ends_with(unit.symbol())).ok_or_else(refused)?;
        let number = trimmed[..trimmed.len() - unit.symbol().len()].trim_end();
        let width = Self { value: number.parse().map_err(|_| refused())?, unit };
        if (60.0..=10_000.0).contains(&width.pixels()) { Ok(width) } else { Err(refused()) }
    }
}

impl fmt::Display for PictureWidth {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}", self.value, self.unit.symbol())
    }
}

impl Serialize for PictureWidth {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// Names of the user's units, written on the axes of pictures. They are labels: no number depends
/// on them.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct UnitLabels {
    /// Of the radius and of displacements.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub length: Option<String>,
    /// Of forces.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub force: Option<String>,
    /// Of Young's modulus and of pressures.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stress: Option<String>,
}

impl UnitLabels {
    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    pub(super) fn read(table: &Reader<'_>) -> Result<Self, CaseError> {
        table.only(&["length", "force", "stress"])?;
        let label = |name: &str| table.get(name).map(|field| read_label(&field)).transpose();
        Ok(Self { length: label("length")?, force: label("force")?, stress: label("stress")? })
    }
}

/// Most letters of a label: more would not fit beside an axis.
const LONGEST: usize = 16;

fn read_label(field: &Field<'_>) -> Result<String, CaseError> {
    let allowed = "text of 1 to 16 letters, as in \"mm\"";
    let text = field.string(allowed)?;
    let fits = (1..=LONGEST).contains(&text.chars().count()) && !text.trim().is_empty() && !text.chars().any(char::is_control);
    if fits { Ok(text.to_owned()) } else { Err(field.refuse(&format!("is {text:?}"), allowed)) }
}

pub(super) fn read_width(field: &Field<'_>) -> Result<PictureWidth, CaseError> {
    let text = field.string(WIDTHS)?;
    text.parse().map_err(|_| field.refuse(&format!("is {text:?}"), WIDTHS))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn widths_are_lengths_on_paper() {
        for (text, pixels) in [("25.4mm", 96.0), ("2.54cm", 96.0), ("1 in", 96.0), ("72pt", 96.0), ("240px", 240.0)] {
            let width: PictureWidth = text.parse().unwrap();
            assert!((width.pixels() / pixels - 1.0).abs() < 1e-12, "{text}");
            assert_eq!(width.to_string().parse::<PictureWidth>().unwrap(), width);
        }
        for text in ["", "85", "mm", "-85mm", "nanmm", "infpx", "1mm", "3m", "20000px", "85 km"] {
            let error = text.parse::<PictureWidth>().unwrap_err();
            assert!(error.contains(WIDTHS), "{text}: {error}");
        }
    }
}
