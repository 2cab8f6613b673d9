//! The spectral form: reflectance in bands, and re-radiation between them.

use upglow::{Bispectral, Cube, Interpolation, Model};
use upglow_color::rounding::to_single;
use upglow_color::{BispectralUnit, Grid, LinearRgb};

use super::attributes;
use super::maker::{Filled, Maker};
use super::radiance::{NAMES, RadianceMaker};
use crate::exr::attribute::Attributes;
use crate::exr::writer::Compression;
use crate::spectral::channel::{BISPECTRAL_UNIT, SpectralChannel, rising_pairs};

/// Stores the blend of each texel: one channel per band, and one per pair of bands from a shorter to a
/// longer wavelength.
#[derive(Debug)]
pub(super) struct SpectralMaker<'c> {
    cube: &'c Cube,
    grid: Grid,
    preview: RadianceMaker<'c>,
}

/// What the channels hold.
const CHANNELS: &str = "T.<wavelength>: share of the light at a wavelength that leaves at it, with \
                        what fluorescence gives back in the same band; T.<incident>.<outgoing>: \
                        share that leaves in the band of a longer wavelength; R, G, B: linear color \
                        under the contract's light";

impl<'c> SpectralMaker<'c> {
    pub(super) fn new(cube: &'c Cube, grid: Grid) -> Self {
        let preview = RadianceMaker::new(cube, cube.contract().illuminant.clone());
        Self { cube, grid, preview }
    }

    fn is_bispectral(&self) -> bool {
        !matches!(self.cube.model(), Model::Reflectance)
    }

    /// Incident and outgoing band of each pair, in the order of the channels.
    fn pairs(&self) -> impl Iterator<Item = [usize; 2]> + use<> {
        rising_pairs(if self.is_bispectral() { self.grid.len() } else { 0 })
    }
}

impl Maker for SpectralMaker<'_> {
    fn channels(&self) -> Vec<String> {
        let nm: Vec<f64> = self.grid.wavelengths_nm().collect();
        let bands = nm.iter().map(|&nm| SpectralChannel::Reflectance { nm });
        let pairs =
            self.pairs().map(|[i, o]| SpectralChannel::Reradiation { in_nm: nm[i], out_nm: nm[o] });
        let spectral = bands.chain(pairs).map(|channel| channel.to_string());
        NAMES.map(str::to_owned).into_iter().chain(spectral).collect()
    }

    fn attributes(&self) -> Attributes {
        let mut attributes = attributes::spectral(self.cube, CHANNELS);
        if self.is_bispectral() {
            attributes.insert(BISPECTRAL_UNIT.into(), BispectralUnit::PerBand.to_string().into());
        }
        attributes
    }

    /// Blocks of one row: sixteen rows of 864 channels would take half a gigabyte for 16,384 columns.
    fn compression(&self) -> Compression {
        Compression::Zips
    }

    fn fill(&self, rgb: &[[f32; 3]], planes: &mut [&mut [f32]]) -> Filled {
        let (preview, spectral) = planes.split_at_mut(NAMES.len());
        self.preview.fill_rgb(rgb, preview);
        let (bands, moved) = spectral.split_at_mut(self.grid.len());
        let pairs: Vec<[usize; 2]> = self.pairs().collect();
        let nm: Vec<f64> = self.grid.wavelengths_nm().collect();
        let mut shares = vec![0.0; nm.len()];
        for (texel, rgb) in rgb.iter().enumerate() {
            let color = LinearRgb(rgb.map(f64::from));
            let mixture = self.cube.lookup(color, Interpolation::Blend);
            let mixture = mixture.expect("texels outside were repaired or refused");
            if mixture.is_fluorescent() {
                let matrix = mixture.reradiation_matrix(self.grid);
                for (i, band) in bands.iter_mut().enumerate() {
                    band[texel] = to_single(matrix[i][i]);
                }
                for (plane, [i, o]) in moved.iter_mut().zip(&pairs) {
                    plane[texel] = to_single(matrix[*o][*i]);
                }
            } else {
                mixture.reflectances(&nm, &mut shares);
                for (band, share) in bands.iter_mut().zip(&shares) {
                    band[texel] = to_single(*share);
                }
            }
        }
        self.preview.kinds(rgb).into()
    }
}
