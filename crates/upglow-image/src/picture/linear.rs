//! Reads pictures as linear light in a given RGB space.

use std::path::Path;

use rayon::prelude::*;
use upglow_color::rounding::to_single;
use upglow_color::{Contract, Grid, Matrix3, RgbSpace};
use upglow_fit::{Progress, Stopped, Watch};

use super::Picture;
use super::band::Band;
use super::encoding::Encoding;
use super::error::PictureError;
use super::source::Alpha;

/// Space and encoding of pictures that do not state them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Assumed {
    /// The RGB space.
    pub space: Option<RgbSpace>,
    /// The encoding.
    pub encoding: Option<Encoding>,
}

/// Reads the linear light of a picture from top to bottom.
#[derive(Debug)]
pub(crate) struct LinearPicture {
    picture: Picture,
    space: RgbSpace,
    encoding: Encoding,
    /// From the picture's own RGB space to the one that [`LinearPicture::convert_to`] set, if different.
    conversion: Option<Matrix3>,
}

/// Converted values that are nearer to 0 or 1 become 0 or 1: conversion to a space and back has errors of
/// this size in single precision.
const ROUNDING: f32 = 4e-6;

impl LinearPicture {
    /// Opens a picture. The file's own space and encoding have priority over the assumed ones.
    ///
    /// # Errors
    ///
    /// [`PictureError`] if it cannot be read, or its space or encoding is unknown.
    pub(crate) fn open(path: &Path, assumed: &Assumed) -> Result<Self, PictureError> {
        let picture = Picture::open(path)?;
        let space = picture.space().or(assumed.space.as_ref()).cloned();
        let encoding = picture.encoding().or(assumed.encoding);
        Ok(Self {
            picture,
            space: space.ok_or(PictureError::Space)?,
            encoding: encoding.ok_or(PictureError::Encoding)?,
            conversion: None,
        })
    }

    /// The picture.
    pub(crate) fn picture(&self) -> &Picture {
        &self.picture
    }

    /// The RGB space of the file, stated or assumed.
    pub(crate) fn space(&self) -> &RgbSpace {
        &self.space
    }

    /// Converts the following rows to the RGB space of a contract, under the contract's light and
    /// adaptation. Values that are outside 0..=1 only by rounding become 0 or 1.
    pub(crate) fn convert_to(&mut self, contract: &Contract) {
        self.conversion = (self.space != contract.space).then(|| {
            let from = Contract { space: self.space.clone(), ..contract.clone() }.on(Grid::FIT);
            contract.on(Grid::FIT).rgb_from_xyz_matrix() * from.xyz_from_rgb_matrix()
        });
    }

    /// Passes the bands of the rest of the picture to `act`, each of about `rows` rows, and reports
    /// progress to `watch` after each.
    pub(crate) fn for_each_band<E: From<PictureError> + From<Stopped>>(
        &mut self,
        rows: usize,
        stage: &'static str,
        watch: &dyn Watch,
        mut act: impl FnMut(Band) -> Result<(), E>,
    ) -> Result<(), E> {
        let [_, total] = self.picture.size();
        while let Some(band) = self.read_band(rows)? {
            if watch.stopped() {
                return Err(Stopped.into());
            }
            let done = band.first_row + band.rows();
            act(band)?;
            watch.progress(Progress { stage, done, total });
        }
        Ok(())
    }

    /// The next rows, like [`Picture::read_band`], as linear light in the picture's own space or that of
    /// [`LinearPicture::convert_to`]. Colors are not multiplied by alpha.
    ///
    /// # Errors
    ///
    /// [`PictureError`] if the file is damaged there.
    fn read_band(&mut self, rows: usize) -> Result<Option<Band>, PictureError> {
        let Some(mut band) = self.picture.read_band(rows)? else { return Ok(None) };
        band.decode(self.encoding);
        if let (Some(Alpha::Associated), Some(alpha)) = (self.picture.alpha(), &band.alpha) {
            band.rgb.par_iter_mut().zip(alpha).for_each(|(rgb, a)| {
                *rgb = if *a == 0.0 { [0.0; 3] } else { rgb.map(|v| v / a) };
            });
        }
        if let Some(conversion) = self.conversion {
            band.rgb.par_iter_mut().for_each(|rgb| {
                *rgb = (conversion * rgb.map(f64::from)).map(|v| snapped(to_single(v)));
            });
        }
        Ok(Some(band))
    }
}

fn snapped(v: f32) -> f32 {
    let nearest = v.clamp(0.0, 1.0);
    if (v - nearest).abs() < ROUNDING { nearest } else { v }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_values_that_rounding_moved_become_0_or_1() {
        assert_eq!([-1e-6, 0.5, 1.000_001].map(snapped), [0.0, 0.5, 1.0]);
        assert_eq!([-1e-3, 1.01].map(snapped), [-1e-3, 1.01]);
        assert!(snapped(f32::NAN).is_nan());
    }
}
