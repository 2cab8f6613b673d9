//! What Exif data in PNG and JPEG state.
//!
//! # Source
//!
//! `exif`, 4.6.4 (`Orientation`) and 4.6.5 (`ColorSpace`).

use std::io::Cursor;

use upglow_color::RgbSpace;

use super::encoding::Encoding;
use super::error::PictureError;
use super::stated::{Stated, StatedColor};
use super::tiff::{Directory, EXIF, EXIF_COLOR_SPACE, ORIENTATION};

/// What Exif data state.
#[derive(Debug)]
pub(super) struct Exif {
    /// As in TIFF, 1 to 8.
    pub(super) orientation: u64,
    /// sRGB, or nothing.
    pub(super) color: StatedColor,
}

/// The value of `ColorSpace` with which a file states nothing: uncalibrated.
const UNCALIBRATED: u64 = 0xffff;

impl Exif {
    /// What absent data state.
    pub(super) const ABSENT: Self =
        Self { orientation: 1, color: StatedColor { space: Stated::No, encoding: Stated::No } };

    /// Reads the data of a file of `format`, which begin as a TIFF file does.
    ///
    /// # Errors
    ///
    /// [`PictureError`] if they are damaged: how the picture lies is then unknown.
    pub(super) fn read(data: &[u8], format: &'static str) -> Result<Self, PictureError> {
        let found = "its Exif data are invalid";
        Self::of(data).map_err(|_| PictureError::Damaged { found: found.into(), format })
    }

    fn of(data: &[u8]) -> Result<Self, PictureError> {
        let mut first = Directory::read(Cursor::new(data))?;
        let orientation = first.integer(ORIENTATION, 1)?;
        let color_space = match first.at(EXIF)? {
            Some(mut further) => further.integer(EXIF_COLOR_SPACE, UNCALIBRATED)?,
            None => UNCALIBRATED,
        };
        let color = match color_space {
            1 => {
                let space = RgbSpace::named("srgb").expect("it is built in");
                StatedColor::yes(space, Encoding::Srgb, "Exif")
            }
            UNCALIBRATED => Self::ABSENT.color,
            other => StatedColor::unread(format!("Exif with ColorSpace {other}")),
        };
        Ok(Self { orientation, color })
    }
}
