//! Rows of a picture.

use std::ops::Range;

use rayon::prelude::*;
use upglow_color::rounding::to_single;

use super::encoding::Encoding;
use super::error::PictureError;

/// Some rows of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Band {
    /// Its first row, from 0 at the top.
    pub first_row: usize,
    /// Pixels in a row.
    pub width: usize,
    /// Red, green, blue of each pixel, row by row, as stored: integers as fractions, 0..=1; floats
    /// unchanged, including NaN and infinities. Gray is three equal numbers.
    pub rgb: Vec<[f32; 3]>,
    /// Alpha of each pixel, if the picture has it, as stored: floats may be any, including NaN and infinities.
    pub alpha: Option<Vec<f32>>,
}

/// Pixels per parallel task.
const DECODED_TOGETHER: usize = 4096;

impl Band {
    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rgb.len().checked_div(self.width).unwrap_or(0)
    }

    /// Refuses alpha that is NaN or infinite.
    ///
    /// # Errors
    ///
    /// [`PictureError::AlphaValue`] names the first such pixel.
    pub(crate) fn check_alpha(&self) -> Result<(), PictureError> {
        let alpha = self.alpha.as_deref().unwrap_or(&[]);
        let Some(first) = alpha.iter().position(|a| !a.is_finite()) else { return Ok(()) };
        let (x, y) = (first % self.width, self.first_row + first / self.width);
        Err(PictureError::AlphaValue { x, y, found: alpha[first] })
    }

    /// Some columns of these rows.
    pub(crate) fn columns(&self, columns: Range<usize>) -> Self {
        let rgb = self.rgb.chunks(self.width).flat_map(|row| &row[columns.clone()]);
        let alpha = self.alpha.as_ref().map(|alpha| {
            alpha.chunks(self.width).flat_map(|row| &row[columns.clone()]).copied().collect()
        });
        let (width, rgb) = (columns.len(), rgb.copied().collect());
        Self { first_row: self.first_row, width, rgb, alpha }
    }

    /// Converts the stored colors to linear light. Alpha does not change.
    pub fn decode(&mut self, encoding: Encoding) {
        if encoding == Encoding::Linear {
            return;
        }
        self.rgb.par_chunks_mut(DECODED_TOGETHER).for_each(|pixels| {
            for rgb in pixels {
                *rgb = encoding.to_linear(rgb.map(f64::from)).map(to_single);
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decoding_leaves_alpha_and_linear_numbers_alone() {
        let stored =
            Band { first_row: 0, width: 1, rgb: vec![[0.5; 3]; 2], alpha: Some(vec![0.5; 2]) };
        let mut band = stored.clone();
        band.decode(Encoding::Linear);
        assert_eq!(band, stored);
        band.decode(Encoding::Gamma(2.0));
        assert_eq!((band.rgb[1], &band.alpha, band.rows()), ([0.25; 3], &stored.alpha, 2));
    }
}
