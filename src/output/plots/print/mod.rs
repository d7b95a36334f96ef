//! From SVG to PDF and PNG. The font comes along, so that a machine without any makes the same
//! files.

use crate::case::PictureFormat;

#[cfg(feature = "print")]
mod convert;

/// The bytes of a picture in a format.
///
/// # Errors
/// In words: what is no SVG, a PNG too large for memory, and formats that the program was built
/// without.
pub fn print(svg: &str, format: PictureFormat) -> Result<Vec<u8>, String> {
    match format {
        PictureFormat::Svg => Ok(svg.as_bytes().to_vec()),
        #[cfg(feature = "print")]
        PictureFormat::Pdf => convert::pdf(svg),
        #[cfg(feature = "print")]
        PictureFormat::Png => convert::png(svg),
        #[cfg(not(feature = "print"))]
        PictureFormat::Pdf | PictureFormat::Png => {
            Err(format!("this program was built without the feature \"print\" and makes no {}; make SVG", format.ending()))
        }
    }
}
