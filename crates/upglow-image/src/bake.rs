//! Turns pictures into spectral files.

mod attributes;
mod compact;
mod maker;
mod material;
pub(crate) mod material_picture;
mod radiance;
pub(crate) mod repair;
mod spectral;

use std::path::Path;

use rayon::prelude::*;
use upglow::{Cube, LookupError, Model};
use upglow_color::{Grid, Illuminant, LinearRgb};
use upglow_fit::{FitOptionsError, StandingTable, Stopped, Watch};

use self::compact::CompactMaker;
use self::maker::Maker;
use self::material::MaterialMaker;
use self::radiance::RadianceMaker;
use self::repair::{Repair, Repairer, greatest_value};
use self::spectral::SpectralMaker;
use crate::exr::header::Sample;
use crate::exr::reader::ExrReader;
use crate::exr::writer::{ExrDescription, ExrWriter, WriteExrError};
use crate::picture::Picture;
use crate::picture::band::Band;
use crate::picture::error::PictureError;
use crate::picture::linear::{Assumed, LinearPicture};
use crate::spectral::error::FormError;

/// What becomes of each texel.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Form {
    /// The parameters of one material, moved until it shows the color, where one material can.
    Material,
    /// The parameters of one material, interpolated and no more.
    InterpolatedMaterial,
    /// Reflectance in bands, and re-radiation between them.
    Spectral {
        /// The wavelengths at the middle of the bands.
        grid: Grid,
        /// Maps of the dyes instead of a channel for each pair of bands.
        compact: bool,
    },
    /// Color under a light, in the cube's RGB space.
    Radiance {
        /// The light; it brings as much power as the contract's.
        light: Illuminant,
    },
}

impl Form {
    /// The form of a baked file, as it says itself: material, spectral or radiance.
    pub fn stated(reader: &ExrReader) -> Option<&str> {
        reader.attributes().get(attributes::FORM)?.as_text()
    }
}

/// How pictures are read and files are written.
#[derive(Clone, Debug, PartialEq)]
pub struct BakeOptions {
    /// What is taken for granted of pictures that do not say it.
    pub assumed: Assumed,
    /// What to do with texels outside the cube; `None` refuses them.
    pub repair: Option<Repair>,
    /// Half or float. The compact form of lobes is always float: rounded positions on the ring
    /// of dyes are other colors.
    pub sample: Sample,
}

/// What was baked.
#[derive(Clone, Debug, PartialEq)]
pub struct Baked {
    /// Width and height of the picture.
    pub size: [usize; 2],
    /// Channels of the file.
    pub channels: usize,
    /// Texels that were repaired.
    pub repaired: u64,
    /// Bytes of the file.
    pub bytes: u64,
}

/// Why a picture was not baked.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BakeError {
    /// The picture cannot be read, or nobody says what its numbers mean.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// The cube records a slope limit that no fit can keep.
    #[error(transparent)]
    Options(#[from] FitOptionsError),
    /// The cube's model has no compact form.
    #[error("a cube with the model {found}, expected dyes for the compact form")]
    NoDyes {
        /// Name of the model.
        found: &'static str,
    },
    /// The cube's dyes have no compact form.
    #[error(transparent)]
    Compact(#[from] FormError),
    /// A texel has no material.
    #[error("texel {x},{y}{}", and_others(*.others))]
    Texel {
        /// Column, from 0 at the left.
        x: usize,
        /// Row, from 0 at the top.
        y: usize,
        /// What is wrong with it.
        source: LookupError,
        /// How many more are outside in the same rows.
        others: usize,
    },
    /// The file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteExrError),
    /// The watcher stopped the work.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}

fn and_others(count: usize) -> String {
    match count {
        0 => String::new(),
        count => format!(", and {count} more in the same rows"),
    }
}

/// Bakes pictures with one cube into one form.
#[derive(Debug)]
pub struct Baker<'c> {
    cube: &'c Cube,
    options: BakeOptions,
    maker: Box<dyn Maker + 'c>,
    /// Names, in the order in which planes are filled; alpha comes after.
    channels: Vec<String>,
}

/// Memory for the channels of a band, bytes: wide pictures of many channels are cut into fewer
/// rows. More would fill a small machine, less would leave cores waiting at the end of each band.
const BAND_BYTES: usize = 96 << 20;
/// Rows of a band at most: enough to keep every core busy.
const BAND_ROWS: usize = 64;

impl<'c> Baker<'c> {
    /// Prepares a form.
    ///
    /// # Errors
    ///
    /// [`BakeError`] if the cube has no such form.
    pub fn new(cube: &'c Cube, form: Form, options: BakeOptions) -> Result<Self, BakeError> {
        let maker: Box<dyn Maker + 'c> = match (form, cube.model()) {
            (Form::Material, _) => Box::new(MaterialMaker::new(cube, true, options.sample)?),
            (Form::InterpolatedMaterial, _) => {
                Box::new(MaterialMaker::new(cube, false, options.sample)?)
            }
            (Form::Spectral { grid, compact: false }, _) => {
                Box::new(SpectralMaker::new(cube, grid))
            }
            (Form::Spectral { grid, .. }, Model::Dyes(dyes)) => {
                Box::new(CompactMaker::new(cube, dyes, grid)?)
            }
            (Form::Spectral { .. }, model) => {
                return Err(BakeError::NoDyes { found: model.name() });
            }
            (Form::Radiance { light }, _) => Box::new(RadianceMaker::new(cube, light)),
        };
        let channels = maker.channels();
        Ok(Self { cube, options, maker, channels })
    }

    /// Bakes the picture at `input` into a file at `output`, on all threads of the current rayon
    /// pool. The file appears whole or not at all, and its bytes do not depend on the threads.
    ///
    /// Memory: two bands of at most 96 MiB besides what [`Picture`] takes, and one block of 16
    /// rows; a spectral file has blocks of one row.
    ///
    /// # Errors
    ///
    /// [`BakeError`]; `output` is then as it was.
    pub fn bake(
        &self,
        input: impl AsRef<Path>,
        output: impl AsRef<Path>,
        watch: &dyn Watch,
    ) -> Result<Baked, BakeError> {
        let input = input.as_ref();
        let mut picture = self.open(input)?;
        let size = picture.picture().size();
        let table = self.options.repair.map(|_| StandingTable::new(self.cube.contract()));
        let repairer = match (self.options.repair, &table) {
            (Some(repair), Some(table)) => Some(self.repairer(repair, table, input, watch)?),
            _ => None,
        };
        let mut writer = ExrWriter::create(output, self.description(picture.picture()))?;
        let mut baked = Baked { size, channels: 0, repaired: 0, bytes: 0 };
        picture.for_each_band(self.band_rows(size[0]), "baking", watch, |mut band| {
            match &repairer {
                Some(repairer) => baked.repaired += repairer.repair(&mut band.rgb).changed,
                None => refuse_outside(&band, self.cube)?,
            }
            let planes = self.planes(&band);
            baked.channels = planes.len();
            writer.write_band(&planes.iter().map(Vec::as_slice).collect::<Vec<_>>())?;
            Ok::<_, BakeError>(())
        })?;
        baked.bytes = writer.finish()?;
        Ok(baked)
    }

    /// A picture whose rows come in the cube's RGB space.
    fn open(&self, input: &Path) -> Result<LinearPicture, PictureError> {
        let mut picture = LinearPicture::open(input, &self.options.assumed)?;
        picture.convert_to(self.cube.contract());
        Ok(picture)
    }

    /// What repairs texels outside the cube; one repair must read the whole picture first.
    fn repairer<'t>(
        &self,
        repair: Repair,
        table: &'t StandingTable,
        input: &Path,
        watch: &dyn Watch,
    ) -> Result<Repairer<'t>, BakeError> {
        let mut greatest = 0.0_f32;
        if repair.reads_all_first() {
            self.open(input)?.for_each_band(BAND_ROWS, "measuring", watch, |band| {
                greatest = greatest.max(greatest_value(&band.rgb));
                Ok::<_, BakeError>(())
            })?;
        }
        Ok(Repairer { repair, greatest, table })
    }

    /// The channels of a band, alpha last.
    fn planes(&self, band: &Band) -> Vec<Vec<f32>> {
        let count = self.channels.len();
        let rows: Vec<Vec<f32>> = band
            .rgb
            .par_chunks(band.width)
            .map(|rgb| {
                let mut values = vec![0.0; count * rgb.len()];
                let mut planes: Vec<&mut [f32]> = values.chunks_mut(rgb.len()).collect();
                self.maker.fill(rgb, &mut planes);
                values
            })
            .collect();
        let of_channel = |channel: usize| {
            let range = channel * band.width..(channel + 1) * band.width;
            rows.iter().flat_map(|row| &row[range.clone()]).copied().collect()
        };
        let mut planes: Vec<Vec<f32>> = (0..count).into_par_iter().map(of_channel).collect();
        if let Some(values) = &band.alpha {
            if self.maker.is_light() {
                let associate = |plane: &mut Vec<f32>| {
                    plane.iter_mut().zip(values).for_each(|(v, a)| *v *= a);
                };
                planes.iter_mut().for_each(associate);
            }
            planes.push(values.clone());
        }
        planes
    }

    fn description(&self, picture: &Picture) -> ExrDescription {
        let alpha = picture.has_alpha().then(|| "A".to_owned());
        let channels = self.channels.iter().cloned().chain(alpha);
        let mut description = ExrDescription::new(picture.size(), channels);
        description.sample = self.maker.sample(self.options.sample);
        description.compression = self.maker.compression();
        description.attributes = self.maker.attributes();
        description.windows = picture.windows();
        description
    }

    fn band_rows(&self, width: usize) -> usize {
        let row_bytes = size_of::<f32>() * width * self.channels.len();
        (BAND_BYTES / row_bytes.max(1)).clamp(1, BAND_ROWS)
    }
}

fn refuse_outside(band: &Band, cube: &Cube) -> Result<(), BakeError> {
    let refusal = |rgb: &[f32; 3]| cube.corners(LinearRgb(rgb.map(f64::from))).err();
    let numbered = band.rgb.par_iter().enumerate();
    let first = numbered.find_map_first(|(i, rgb)| Some((i, refusal(rgb)?)));
    let Some((first, source)) = first else { return Ok(()) };
    let others = band.rgb[first + 1..].par_iter().filter_map(refusal).count();
    let (x, y) = (first % band.width, band.first_row + first / band.width);
    Err(BakeError::Texel { x, y, source, others })
}
