//! Turns pictures into spectral files.

mod attributes;
mod compact;
mod material;
pub(crate) mod material_picture;
mod radiance;
pub(crate) mod repair;
mod spectral;

use std::fmt::Debug;
use std::path::Path;

use rayon::prelude::*;
use upglow::{Cube, LookupError, Model};
use upglow_color::{Grid, Illuminant, LinearRgb};
use upglow_fit::{FitOptionsError, Progress, StandingTable, Watch};

use self::compact::CompactMaker;
use self::material::MaterialMaker;
use self::radiance::RadianceMaker;
use self::spectral::SpectralMaker;
use crate::bake::repair::{Repair, greatest_value};
use crate::exr::attribute::Attributes;
use crate::exr::header::Sample;
use crate::exr::writer::{Compression, ExrDescription, ExrWriter, WriteExrError};
use crate::picture::band::Band;
use crate::picture::linear::{Assumed, LinearPicture, LinearPictureError};
use crate::picture::{Picture, PictureError};
use crate::spectral::compact::CompactError;

/// What becomes of each texel.
#[derive(Clone, Debug, PartialEq)]
pub enum Form {
    /// The parameters of one material.
    Material(MaterialWay),
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

/// How one material is made of the four around a color.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MaterialWay {
    /// Moved until it shows the color, where one material can.
    Polished,
    /// Parameters interpolated, no more.
    Interpolated,
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
    Picture(#[from] LinearPictureError),
    /// The picture is damaged further down.
    #[error(transparent)]
    Rows(#[from] PictureError),
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
    Compact(#[from] CompactError),
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
    #[error("stopped")]
    Stopped,
}

fn and_others(count: usize) -> String {
    match count {
        0 => String::new(),
        count => format!(", and {count} more in the same rows"),
    }
}

/// The form of a baked file, by its attributes: material, spectral or radiance.
pub fn baked_form(attributes: &Attributes) -> Option<&str> {
    attributes.get(attributes::FORM)?.as_text()
}

/// Makes the channels of one form from linear RGB in the cube's space, each component in 0..=1.
trait Maker: Debug + Sync {
    /// Names, in the order in which planes are filled.
    fn channels(&self) -> Vec<String>;

    /// What the file says besides.
    fn attributes(&self) -> Attributes;

    fn compression(&self) -> Compression;

    /// Whether the channels are light, which OpenEXR has multiplied by alpha, and not properties of
    /// a material.
    fn is_light(&self) -> bool {
        false
    }

    /// The kind of number that holds the channels, where the caller asked for `asked`.
    fn sample(&self, asked: Sample) -> Sample {
        asked
    }

    /// Fills one row of each channel, `[channel][texel]`.
    fn fill(&self, rgb: &[[f32; 3]], planes: &mut [&mut [f32]]);
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
            (Form::Material(way), _) => Box::new(MaterialMaker::new(cube, way, options.sample)?),
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
    pub fn bake(&self, input: &Path, output: &Path, watch: &dyn Watch) -> Result<Baked, BakeError> {
        let mut picture = self.open(input)?;
        let size = picture.picture().size();
        let mending = self.mending(input, watch)?;
        let mut writer = ExrWriter::create(output, self.description(picture.picture()))?;
        let mut baked = Baked { size, channels: 0, repaired: 0, bytes: 0 };
        while let Some(mut band) = picture.read_band(self.band_rows(size[0]))? {
            if watch.stopped() {
                return Err(BakeError::Stopped);
            }
            baked.repaired += mending.mend(&mut band, self.cube)?;
            let planes = self.planes(&band);
            baked.channels = planes.len();
            writer.write_band(&planes.iter().map(Vec::as_slice).collect::<Vec<_>>())?;
            let done = band.first_row + band.rows();
            watch.progress(Progress { stage: "baking", done, total: size[1] });
        }
        baked.bytes = writer.finish()?;
        Ok(baked)
    }

    /// A picture whose rows come in the cube's RGB space.
    fn open(&self, input: &Path) -> Result<LinearPicture, LinearPictureError> {
        let mut picture = LinearPicture::open(input, &self.options.assumed)?;
        picture.convert_to(self.cube.contract());
        Ok(picture)
    }

    /// What is done with texels outside the cube; one way must read the whole picture first.
    fn mending(&self, input: &Path, watch: &dyn Watch) -> Result<Mending, BakeError> {
        let Some(repair) = self.options.repair else { return Ok(Mending::Refuse) };
        let mut greatest = 0.0_f32;
        if repair.reads_all_first() {
            let mut picture = self.open(input)?;
            let [_, total] = picture.picture().size();
            while let Some(band) = picture.read_band(BAND_ROWS)? {
                if watch.stopped() {
                    return Err(BakeError::Stopped);
                }
                greatest = greatest.max(greatest_value(&band.rgb));
                let done = band.first_row + band.rows();
                watch.progress(Progress { stage: "measuring", done, total });
            }
        }
        let table = StandingTable::new(self.cube.contract());
        Ok(Mending::Repair { repair, greatest, table: Box::new(table) })
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

/// What is done with texels outside the cube.
enum Mending {
    Refuse,
    Repair { repair: Repair, greatest: f32, table: Box<StandingTable> },
}

impl Mending {
    /// Leaves only colors of the cube; how many texels it changed.
    fn mend(&self, band: &mut Band, cube: &Cube) -> Result<u64, BakeError> {
        match self {
            Self::Refuse => refuse_outside(band, cube).map(|()| 0),
            Self::Repair { repair, greatest, table } => {
                Ok(repair.of(*greatest, table).repair(&mut band.rgb).changed)
            }
        }
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
