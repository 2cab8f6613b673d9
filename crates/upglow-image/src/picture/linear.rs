//! A picture as linear light in one RGB space, whatever its file stores.

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

/// What is taken for granted of files that do not say it themselves.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Assumed {
    /// Their RGB space.
    pub space: Option<RgbSpace>,
    /// How they store light.
    pub encoding: Option<Encoding>,
}

/// A picture opened for reading its linear light from top to bottom.
#[derive(Debug)]
pub(crate) struct LinearPicture {
    picture: Picture,
    space: RgbSpace,
    encoding: Encoding,
    /// From its own RGB space to that which was asked for, where they differ.
    conversion: Option<Matrix3>,
}

/// Two orders of the same matrices differ by this much in single precision; what is nearer to 0
/// or 1 stands for it.
const ROUNDING: f32 = 4e-6;

impl LinearPicture {
    /// Opens a picture. What its file says goes before what is assumed.
    ///
    /// # Errors
    ///
    /// [`PictureError`] if it cannot be read, or nobody says what its numbers mean.
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

    /// The file's own facts.
    pub(crate) fn picture(&self) -> &Picture {
        &self.picture
    }

    /// The RGB space that it is stored in, by itself or as assumed.
    pub(crate) fn space(&self) -> &RgbSpace {
        &self.space
    }

    /// Has the rows that follow converted to the RGB space of a contract, under the contract's
    /// light and adaptation. What rounding alone moves beyond 0 or 1 returns there.
    pub(crate) fn convert_to(&mut self, contract: &Contract) {
        self.conversion = (self.space != contract.space).then(|| {
            let from = Contract { space: self.space.clone(), ..contract.clone() }.on(Grid::FIT);
            contract.on(Grid::FIT).rgb_from_xyz_matrix() * from.xyz_from_rgb_matrix()
        });
    }

    /// Hands the bands of the rest of the picture to `act`, each of about `rows` rows, and tells
    /// `watch` after each.
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

    /// The next rows, at least `rows` of them or what is left, as linear light in the space of the
    /// picture itself or of [`LinearPicture::convert_to`]; colors are those of the opaque picture,
    /// whatever its alpha.
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
            band.rgb.par_iter_mut().for_each(|rgb| *rgb = converted(*rgb, conversion));
        }
        Ok(Some(band))
    }
}

fn converted(rgb: [f32; 3], conversion: Matrix3) -> [f32; 3] {
    (conversion * rgb.map(f64::from)).map(|v| snapped(to_single(v)))
}

fn snapped(v: f32) -> f32 {
    let nearest = v.clamp(0.0, 1.0);
    if (v - nearest).abs() < ROUNDING { nearest } else { v }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_rounding_moved_comes_back_and_the_rest_stays() {
        assert_eq!([-1e-6, 0.5, 1.000_001].map(snapped), [0.0, 0.5, 1.0]);
        assert_eq!([-1e-3, 1.01].map(snapped), [-1e-3, 1.01]);
        assert!(snapped(f32::NAN).is_nan());
    }
}
