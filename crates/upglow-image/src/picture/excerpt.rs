//! Some texels of a picture, for a view of it on a screen.

use std::path::Path;

use upglow_color::Contract;

use super::error::PictureError;
use super::linear::LinearPicture;
use super::stated::{Declared, Interpretation};

/// Every `step`-th texel of every `step`-th row of a picture, as linear light in the RGB space of a
/// contract.
#[derive(Clone, Debug, PartialEq)]
pub struct Excerpt {
    /// Width and height of the picture.
    pub picture: [usize; 2],
    /// The distance of the texels that were kept.
    pub step: usize,
    /// Columns and rows of them.
    pub size: [usize; 2],
    /// Their colors, row by row.
    pub rgb: Vec<[f32; 3]>,
    /// How the numbers of the file were understood.
    pub interpretation: Interpretation,
}

/// Rows that are read at a time.
const BAND_ROWS: usize = 64;

impl Excerpt {
    /// Reads a picture by bands of rows and keeps at most `side` texels along a side. What is declared has
    /// priority over what the file states.
    ///
    /// # Errors
    ///
    /// [`PictureError`] if it cannot be read, or its space or encoding is unknown.
    pub fn read(
        path: &Path,
        declared: &Declared,
        contract: &Contract,
        side: usize,
    ) -> Result<Self, PictureError> {
        let mut opened = LinearPicture::open(path, declared)?;
        let picture = opened.picture().size();
        let step = Self::step(picture, side);
        opened.convert_to(contract);
        let mut rgb = Vec::new();
        while let Some(band) = opened.read_band(BAND_ROWS)? {
            for (row, texels) in (band.first_row..).zip(band.rgb.chunks(band.width)) {
                if row % step == 0 {
                    rgb.extend(texels.iter().step_by(step));
                }
            }
        }
        let size = picture.map(|side| side.div_ceil(step));
        Ok(Self { picture, step, size, rgb, interpretation: opened.interpretation().clone() })
    }

    /// The distance at which at most `side` texels remain along a side.
    #[must_use]
    pub fn step([width, height]: [usize; 2], side: usize) -> usize {
        width.max(height).div_ceil(side.max(1)).max(1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ExrDescription, ExrWriter};
    use upglow_color::RgbSpace;

    #[test]
    fn every_third_texel_is_kept_and_converted() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        let ramp = |k: usize| (0..10 * 70).map(|i| (i + k) as f32).collect::<Vec<f32>>();
        let channels = [0, 1, 2].map(ramp);
        let description = ExrDescription::new([10, 70], ["R", "G", "B"]);
        let description = description.with_space(&RgbSpace::default());
        let mut writer = ExrWriter::create(&path, description.clone()).unwrap();
        writer.write_band(&channels.each_ref().map(|channel| &channel[..])).unwrap();
        writer.finish().unwrap();
        let read =
            |side| Excerpt::read(&path, &Declared::default(), &Contract::default(), side).unwrap();
        let whole = read(70);
        assert_eq!((whole.step, whole.size, whole.rgb.len()), (1, [10, 70], 700));
        let some = read(24);
        assert_eq!((some.picture, some.step, some.size), ([10, 70], 3, [4, 24]));
        for (i, rgb) in some.rgb.iter().enumerate() {
            assert_eq!(*rgb, whole.rgb[i / 4 * 3 * 10 + i % 4 * 3]);
        }
        let declared = Declared { space: RgbSpace::named("srgb").ok(), ..Declared::default() };
        let converted = Excerpt::read(&path, &declared, &Contract::default(), 24).unwrap();
        assert_ne!(converted.rgb[1], some.rgb[1]);
    }
}
