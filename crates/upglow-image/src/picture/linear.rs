//! Reads pictures as linear light in a given RGB space.

use std::path::Path;

use rayon::prelude::*;
use upglow_color::rounding::to_single;
use upglow_color::{Contract, Grid, Matrix3, RgbSpace};
use upglow_fit::{Progress, Stopped, Watch};

use super::Picture;
use super::band::Band;
use super::error::PictureError;
use super::source::Alpha;
use super::stated::{Chosen, Declared, Interpretation};

/// Reads the linear light of a picture from top to bottom.
#[derive(Debug)]
pub(crate) struct LinearPicture {
    picture: Picture,
    chosen: Chosen,
    /// From the picture's own RGB space to the one that [`LinearPicture::convert_to`] set, if different.
    conversion: Option<Matrix3>,
}

/// Converted values that are nearer to 0 or 1 become 0 or 1: conversion to a space and back has errors of
/// this size in single precision.
const ROUNDING: f32 = 4e-6;

impl LinearPicture {
    /// Opens a picture. What is declared has priority over what the file states.
    ///
    /// # Errors
    ///
    /// [`PictureError`] if it cannot be read, or its space or encoding is unknown.
    pub(crate) fn open(path: &Path, declared: &Declared) -> Result<Self, PictureError> {
        let picture = Picture::open_as(path, declared)?;
        let chosen = picture.chosen(declared)?;
        Ok(Self { picture, chosen, conversion: None })
    }

    /// The picture.
    pub(crate) fn picture(&self) -> &Picture {
        &self.picture
    }

    /// The RGB space of the file, stated or declared.
    pub(crate) fn space(&self) -> &RgbSpace {
        &self.chosen.space
    }

    /// How the numbers of the file are understood.
    pub(crate) fn interpretation(&self) -> &Interpretation {
        &self.chosen.interpretation
    }

    /// Converts the following rows to the RGB space of a contract, under the contract's light and
    /// adaptation. Values that are outside 0..=1 only by rounding become 0 or 1.
    pub(crate) fn convert_to(&mut self, contract: &Contract) {
        let space = &self.chosen.space;
        self.conversion = (*space != contract.space).then(|| {
            let from = Contract { space: space.clone(), ..contract.clone() }.on(Grid::FIT);
            contract.on(Grid::FIT).rgb_from_xyz_matrix() * from.xyz_from_rgb_matrix()
        });
    }

    /// Passes the bands of the rest of the picture to `act` in their order, each of about `rows` rows, and
    /// reports progress to `watch` after each. While one is acted on, the next is read: few formats can be
    /// decoded by several threads.
    pub(crate) fn for_each_band<E: From<PictureError> + From<Stopped> + Send>(
        &mut self,
        rows: usize,
        stage: &'static str,
        watch: &dyn Watch,
        mut act: impl FnMut(Band) -> Result<(), E> + Send,
    ) -> Result<(), E> {
        let [_, total] = self.picture.size();
        let mut next = self.read_band(rows)?;
        while let Some(band) = next {
            if watch.stopped() {
                return Err(Stopped.into());
            }
            let done = band.first_row + band.rows();
            let (acted, read) = rayon::join(|| act(band), || self.read_band(rows));
            acted?;
            watch.progress(Progress { stage, done, total });
            next = read?;
        }
        Ok(())
    }

    /// The next rows, like [`Picture::read_band`], as linear light in the picture's own space or that of
    /// [`LinearPicture::convert_to`]. Colors are not multiplied by alpha; where alpha is 0 or not finite,
    /// they are those that the file has.
    ///
    /// # Errors
    ///
    /// [`PictureError`] if the file is damaged there.
    pub(super) fn read_band(&mut self, rows: usize) -> Result<Option<Band>, PictureError> {
        let Some(mut band) = self.picture.read_band(rows)? else { return Ok(None) };
        // Encoded colors are multiplied by alpha as they are stored, so they are divided first.
        if let (Some(Alpha::Associated), Some(alpha)) = (self.picture.alpha(), &band.alpha) {
            band.rgb.par_iter_mut().zip(alpha).for_each(|(rgb, a)| {
                if *a != 0.0 && a.is_finite() {
                    *rgb = rgb.map(|v| v / a);
                }
            });
        }
        band.decode(self.chosen.encoding);
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
