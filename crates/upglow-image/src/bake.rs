//! Bakes pictures into files of materials, spectra or light.

mod attributes;
mod blends;
mod compact;
mod half_reflectance;
pub(crate) mod hash;
mod levels;
mod maker;
mod material;
pub(crate) mod material_picture;
pub(crate) mod matrix;
mod output;
pub(crate) mod png;
mod radiance;
pub(crate) mod repair;
mod screen;
mod spectral;

use std::io;
use std::path::Path;

use rayon::prelude::*;
use upglow::{Aside, Cube, LookupError};
use upglow_color::rounding::to_single;
use upglow_color::{ContractError, Grid, Illuminant, LinearRgb, ReducedBasisError, RgbSpace};
use upglow_fit::{ColoredLightError, FitOptionsError, KindCounts, StandingTable, Stopped, Watch};

use self::compact::CompactMaker;
use self::hash::Hash;
use self::levels::{LevelRows, Levels};
use self::maker::{Filled, Maker};
use self::material::MaterialMaker;
use self::matrix::{EngineMatrices, Incident, MatrixMaker};
use self::output::Output;
use self::png::{PngBits, PngWriter};
use self::radiance::RadianceMaker;
use self::repair::{Repair, Repairer, greatest_value};
use self::screen::ScreenMaker;
use self::spectral::SpectralMaker;
use crate::exr::attribute::Attribute;
use crate::exr::header::Sample;
use crate::exr::mipmap::{MipmapWriter, TILE, Tile, tile_counts};
use crate::exr::reader::ExrReader;
use crate::exr::writer::{ExrDescription, ExrWriter, WriteExrError};
use crate::picture::Picture;
use crate::picture::band::Band;
use crate::picture::error::PictureError;
use crate::picture::linear::LinearPicture;
use crate::picture::stated::{Declared, Interpretation};
use crate::spectral::error::FormError;

/// What a baked file stores for each texel.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Form {
    /// The parameters of one material, adjusted until it matches the color if one material can.
    Material,
    /// The parameters of one material, interpolated only.
    InterpolatedMaterial,
    /// Reflectance in bands, and re-radiation between them.
    Spectral {
        /// Centers of the bands.
        grid: Grid,
        /// Whether maps of the dyes replace the channels for pairs of bands.
        compact: bool,
    },
    /// Color under a light, in the cube's RGB space.
    Radiance {
        /// The light, which is scaled to the power of the contract's light.
        light: Illuminant,
    },
    /// Of the 4×4 matrix by which the material acts on light of four numbers, what becomes of one of them.
    Matrix {
        /// The RGB space that the engine keeps light in; `None` for the cube's.
        engine: Option<RgbSpace>,
        /// The number of the light that arrives.
        incident: Incident,
    },
    /// Color under a light as PNG in sRGB, as an observer sees it who is adapted to the light; see
    /// [`Contract::seen_under`](upglow_color::Contract::seen_under). Colors outside sRGB keep their
    /// luminance and hue and become grayer; above the luminance of white they are white.
    Screen {
        /// The light.
        light: Illuminant,
        /// Bits of each sample.
        bits: PngBits,
        /// By how many powers of two the light is brighter than one whose white is the screen's.
        exposure_stops: f64,
    },
}

impl Form {
    /// The light under which colors are computed, of the forms that have one.
    pub fn light(&self) -> Option<&Illuminant> {
        match self {
            Self::Radiance { light } | Self::Screen { light, .. } => Some(light),
            _ => None,
        }
    }

    /// What the perfect diffuser is in the channels R, G and B of a file, which hold colors under a light in the RGB
    /// space of the cube; `None` for forms that have no such channels.
    ///
    /// # Errors
    ///
    /// [`ColoredLightError`] if the light is outside that space.
    pub fn white(&self, cube: &Cube) -> Option<Result<LinearRgb, ColoredLightError>> {
        let light = match self {
            Self::Radiance { light } => light,
            Self::Spectral { .. } => &cube.contract().illuminant,
            _ => return None,
        };
        let colorimetry = radiance::colorimetry(cube, light);
        Some(ColoredLightError::check(&colorimetry, colorimetry.white()))
    }

    /// The form that a baked file states: material, spectral, radiance or rgbu.
    pub fn stated(reader: &ExrReader) -> Option<&str> {
        reader.attributes().get(attributes::FORM)?.as_text()
    }
}

/// How pictures are read and baked files are written.
#[derive(Clone, Debug, PartialEq)]
pub struct BakeOptions {
    /// What is declared of the pictures.
    pub declared: Declared,
    /// How to change texels outside the cube; `None` refuses them.
    pub repair: Option<Repair>,
    /// Half or float. The compact form of lobes is always float, because rounded positions on the ring
    /// of dyes would be other colors.
    pub sample: Sample,
    /// How OpenEXR files are stored.
    pub layout: Layout,
}

/// How an OpenEXR file is stored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Layout {
    /// Rows.
    #[default]
    Rows,
    /// Tiles of 64² at all levels down to one texel, as texture systems read them. The colors of a level
    /// are filtered, never what is made of them: each is the mean of the colors that it covers in the
    /// level before, by area and alpha, and every level is baked from its own.
    Mipmap,
}

/// Facts about a baked file.
#[derive(Clone, Debug, PartialEq)]
pub struct Baked {
    /// Width and height of the picture.
    pub size: [usize; 2],
    /// How the numbers of the picture were understood.
    pub interpretation: Interpretation,
    /// Channels of the file.
    pub channels: usize,
    /// Texels that a repair changed.
    pub repaired: u64,
    /// Texels of [`Form::Screen`] whose colors are outside sRGB.
    pub beyond_screen: u64,
    /// Texels of each kind of material under the cube's own light: of the single material of a texel where
    /// the form has one, else of its blend. `None` for materials that are interpolated only, because their
    /// differences are not measured.
    pub kinds: Option<KindCounts>,
    /// Size of the file, bytes.
    pub bytes: u64,
}

impl Baked {
    /// Most channels of a file that `OpenImageIO` reads, and with it most renderers.
    pub const OPENIMAGEIO_CHANNELS: usize = 1024;

    /// Whether `OpenImageIO` refuses the file for its number of channels.
    pub fn is_beyond_openimageio(&self) -> bool {
        self.channels > Self::OPENIMAGEIO_CHANNELS
    }
}

/// Why a picture was not baked.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BakeError {
    /// The picture cannot be read, or its RGB space or encoding is unknown.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// The cube records an invalid slope limit.
    #[error(transparent)]
    Options(#[from] FitOptionsError),
    /// The cube's model has no compact form.
    #[error("a cube with the model {found}, expected dyes or film for the compact form")]
    NoDyes {
        /// Name of the model.
        found: &'static str,
    },
    /// The cube's dyes have no compact form.
    #[error(transparent)]
    Compact(#[from] FormError),
    /// The cube's light has no parts that matrices could be made of.
    #[error(transparent)]
    Basis(#[from] ReducedBasisError),
    /// The engine's RGB space does not fit the cube's light.
    #[error(transparent)]
    Engine(#[from] ContractError),
    /// A texel is outside the cube.
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
    /// The bits of PNG files, if they are written instead of OpenEXR.
    png: Option<PngBits>,
    /// Names of the channels in the order of the planes, without alpha, which comes last.
    channels: Vec<String>,
    hash: Hash,
}

/// Most bytes of the channels of a band, which limits the rows of wide pictures with many channels.
/// More would fill the memory of small machines, less would leave cores idle at the end of each band.
const BAND_BYTES: usize = 20 << 20;
/// Texels that are made together: a task for one core.
const MADE_TOGETHER: usize = 1024;
/// Most rows of a band: enough to keep all cores busy.
const BAND_ROWS: usize = 64;

impl<'c> Baker<'c> {
    /// Prepares baking into `form`.
    ///
    /// # Errors
    ///
    /// [`BakeError`] if the cube does not support the form.
    pub fn new(cube: &'c Cube, form: Form, options: BakeOptions) -> Result<Self, BakeError> {
        Self::sharing(cube, form, options, &mut None)
    }

    /// One for each form, which share what they compute of the cube.
    ///
    /// # Errors
    ///
    /// As [`Baker::new`].
    pub fn of_forms(
        cube: &'c Cube,
        forms: &[Form],
        options: &BakeOptions,
    ) -> Result<Vec<Self>, BakeError> {
        let mut latest = None;
        let each = forms.iter().cloned();
        each.map(|form| Self::sharing(cube, form, options.clone(), &mut latest)).collect()
    }

    fn sharing(
        cube: &'c Cube,
        form: Form,
        options: BakeOptions,
        latest: &mut Option<EngineMatrices>,
    ) -> Result<Self, BakeError> {
        let (version, cube_hash) = (env!("CARGO_PKG_VERSION"), Hash::of(&cube.to_bytes()));
        let hash = Hash::of(format!("{version} {form:?} {options:?} {cube_hash}").as_bytes());
        let is_polished = form == Form::Material;
        let png = match form {
            Form::Screen { bits, .. } => Some(bits),
            _ => None,
        };
        let maker: Box<dyn Maker + 'c> = match form {
            Form::Material | Form::InterpolatedMaterial => {
                Box::new(MaterialMaker::new(cube, is_polished, options.sample)?)
            }
            Form::Spectral { grid, compact: false } => Box::new(SpectralMaker::new(cube, grid)),
            Form::Spectral { grid, compact: true } => Box::new(CompactMaker::new(cube, grid)?),
            Form::Radiance { light } => Box::new(RadianceMaker::new(cube, light)),
            Form::Matrix { engine, incident } => {
                Box::new(MatrixMaker::new(cube, engine, incident, latest)?)
            }
            Form::Screen { light, exposure_stops, .. } => {
                Box::new(ScreenMaker::new(cube, &light, exposure_stops))
            }
        };
        let channels = maker.channels();
        Ok(Self { cube, options, maker, png, channels, hash })
    }

    /// Bakes the picture at `input` into a file at `output`, on all threads of the current rayon
    /// pool. The file is replaced only once it is complete, and its bytes do not depend on the number of
    /// threads.
    ///
    /// Memory: that of [`Picture`] for two bands, a band of at most 20 MiB in single precision and twice in
    /// that of the file, and one block of 16 rows (one row in spectral files). With [`Layout::Mipmap`] a
    /// band is the channels of some tiles, and there are the colors of 64 rows of all levels: 16 bytes for
    /// each texel of 128 rows of the picture.
    ///
    /// # Errors
    ///
    /// [`BakeError`] if the picture cannot be read, a texel is outside the cube and not repaired, or the
    /// file cannot be written. `output` is then unchanged.
    pub fn bake(
        &self,
        input: impl AsRef<Path>,
        output: impl AsRef<Path>,
        watch: &dyn Watch,
    ) -> Result<Baked, BakeError> {
        let (baked, file) = self.bake_aside(input, output, watch)?;
        file.commit().map_err(WriteExrError::from)?;
        Ok(baked)
    }

    /// As [`Baker::bake`], but the file still lacks its name: files that belong together then appear together, by
    /// [`Aside::commit_together`].
    ///
    /// # Errors
    ///
    /// As [`Baker::bake`].
    pub fn bake_aside(
        &self,
        input: impl AsRef<Path>,
        output: impl AsRef<Path>,
        watch: &dyn Watch,
    ) -> Result<(Baked, Aside), BakeError> {
        let input = input.as_ref();
        let mut picture = self.open(input)?;
        let size = picture.picture().size();
        let table = self.options.repair.map(|_| StandingTable::new(self.cube.contract()));
        let repairer = match (self.options.repair, &table) {
            (Some(repair), Some(table)) => Some(self.repairer(repair, table, input, watch)?),
            _ => None,
        };
        let made = self.made_from(input).map_err(PictureError::Io)?;
        let mut writer = self.create(output.as_ref(), picture.picture(), &made)?;
        let mut baked = Baked {
            size,
            interpretation: picture.interpretation().clone(),
            channels: self.channels.len() + usize::from(picture.picture().has_alpha()),
            repaired: 0,
            beyond_screen: 0,
            kinds: None,
            bytes: 0,
        };
        let mut all = Filled::default();
        picture.for_each_band(self.band_rows(size[0]), "baking", watch, |mut band| {
            match &repairer {
                Some(repairer) => {
                    let alpha = band.alpha.as_deref_mut();
                    baked.repaired += repairer.repair(&mut band.rgb, alpha);
                }
                None => {
                    refuse_outside(&band)?;
                    band.check_alpha()?;
                }
            }
            all = all.with(&self.write(&mut writer, &band)?);
            Ok::<_, BakeError>(())
        })?;
        let mut file = writer.into_file()?;
        baked.bytes = file.bytes().map_err(WriteExrError::from)?;
        (baked.kinds, baked.beyond_screen) = (all.kinds, all.beyond_screen);
        Ok((baked, file))
    }

    /// A hash of the version of this library, the cube, the form and the options.
    pub fn hash(&self) -> &Hash {
        &self.hash
    }

    /// Whether the file at `output` was baked from the picture at `input` with the same cube, form and
    /// options, by the same version of this library.
    pub fn is_made(&self, input: impl AsRef<Path>, output: impl AsRef<Path>) -> bool {
        let stated = Hash::stated(output);
        stated.is_some_and(|stated| self.made_from(input.as_ref()).is_ok_and(|made| made == stated))
    }

    /// A hash of everything that makes the file of a picture.
    fn made_from(&self, input: &Path) -> io::Result<Hash> {
        Ok(self.hash.with_picture(&Hash::of_file(input)?))
    }

    /// Width and height of the picture at `input`.
    ///
    /// # Errors
    ///
    /// [`PictureError`] if it is no picture, or its RGB space or encoding is unknown; its texels are not read.
    pub fn size(&self, input: impl AsRef<Path>) -> Result<[usize; 2], PictureError> {
        Ok(LinearPicture::open(input.as_ref(), &self.options.declared)?.picture().size())
    }

    /// A picture that is converted to the cube's RGB space.
    fn open(&self, input: &Path) -> Result<LinearPicture, PictureError> {
        let mut picture = LinearPicture::open(input, &self.options.declared)?;
        picture.convert_to(self.cube.contract());
        Ok(picture)
    }

    /// Prepares a repair; [`Repair::Scale`] reads the whole picture for this.
    fn repairer<'t>(
        &self,
        repair: Repair,
        table: &'t StandingTable,
        input: &Path,
        watch: &dyn Watch,
    ) -> Result<Repairer<'t>, BakeError> {
        let mut greatest = 0.0_f32;
        if repair == Repair::Scale {
            self.open(input)?.for_each_band(BAND_ROWS, "measuring", watch, |band| {
                greatest = greatest.max(greatest_value(&band.rgb));
                Ok::<_, BakeError>(())
            })?;
        }
        Ok(Repairer { repair, greatest, table })
    }

    /// Makes and writes the channels of a band; returns facts about its texels.
    fn write(&self, output: &mut Output, band: &Band) -> Result<Filled, BakeError> {
        match output {
            Output::Exr(writer) => {
                let (planes, filled) = self.planes(band);
                writer.write_band(&planes.iter().map(Vec::as_slice).collect::<Vec<_>>())?;
                Ok(filled)
            }
            Output::Png(writer) => {
                let (planes, filled) = self.planes(band);
                writer.write_band(&planes).map_err(WriteExrError::Io)?;
                Ok(filled)
            }
            Output::Mipmap(mipmap) => {
                let (levels, writer) = &mut **mipmap;
                let mut all = Filled::default();
                for rows in levels.push(band) {
                    let filled = self.write_tiles(writer, &rows)?;
                    if rows.level == 0 {
                        all = all.with(&filled);
                    }
                }
                Ok(all)
            }
        }
    }

    /// Makes and writes a row of tiles, as many at a time as a band may have.
    fn write_tiles(
        &self,
        writer: &mut MipmapWriter,
        LevelRows { level, rows }: &LevelRows,
    ) -> Result<Filled, BakeError> {
        let [across, _] = tile_counts([rows.width, 1]);
        let tile_bytes = size_of::<f32>() * TILE * TILE * self.channels.len();
        let together = (BAND_BYTES / tile_bytes).max(1);
        let columns: Vec<usize> = (0..across).collect();
        let mut all = Filled::default();
        for columns in columns.chunks(together) {
            let made = columns.par_iter().map(|column| {
                let tile = rows.columns(column * TILE..rows.width.min((column + 1) * TILE));
                let (planes, filled) = self.planes(&tile);
                Ok((*column, writer.packed(tile.width, &planes)?, filled))
            });
            for (column, packed, filled) in made.collect::<Result<Vec<_>, BakeError>>()? {
                let at = [column, rows.first_row / TILE];
                writer.write(Tile { level: *level, at }, &packed)?;
                all = all.with(&filled);
            }
        }
        Ok(all)
    }

    /// The channels of a band, alpha last, and facts about them.
    fn planes(&self, band: &Band) -> (Vec<Vec<f32>>, Filled) {
        let mut planes = vec![vec![0.0; band.rgb.len()]; self.channels.len()];
        let pieces = band.rgb.len().div_ceil(MADE_TOGETHER);
        let mut parts: Vec<Vec<&mut [f32]>> = (0..pieces).map(|_| Vec::new()).collect();
        for plane in &mut planes {
            let of_plane = plane.chunks_mut(MADE_TOGETHER);
            parts.iter_mut().zip(of_plane).for_each(|(part, piece)| part.push(piece));
        }
        let all = parts
            .par_iter_mut()
            .zip(band.rgb.par_chunks(MADE_TOGETHER))
            .map(|(part, rgb)| self.maker.fill(rgb, part))
            .reduce(Filled::default, |all, filled| all.with(&filled));
        if let Some(values) = &band.alpha {
            if self.maker.is_light() {
                for plane in &mut planes {
                    plane.iter_mut().zip(values).for_each(|(v, a)| *v *= a);
                }
            }
            planes.push(values.clone());
        }
        (planes, all)
    }

    /// Starts the file of a picture.
    fn create(&self, path: &Path, picture: &Picture, made: &Hash) -> Result<Output, BakeError> {
        Ok(if let Some(bits) = self.png {
            let (size, alpha) = (picture.size(), picture.has_alpha());
            let png = PngWriter::create(path, size, alpha, bits, made.to_string());
            Output::Png(png.map_err(WriteExrError::Io)?)
        } else {
            let mut description = self.description(picture);
            description.attributes.insert(attributes::MADE.into(), made.to_string().into());
            if self.options.layout == Layout::Mipmap {
                let [width, height] = picture.size();
                let aspect = to_single(width as f64 / height as f64);
                description.attributes.extend([
                    ("fovcot".to_owned(), Attribute::singles("float", &[aspect])),
                    ("textureformat".to_owned(), "Plain Texture".into()),
                    ("wrapmodes".to_owned(), "black,black".into()),
                ]);
                let levels = Levels::new(picture.size(), picture.has_alpha());
                let writer = MipmapWriter::create(path, description)?;
                return Ok(Output::Mipmap(Box::new((levels, writer))));
            }
            Output::Exr(ExrWriter::create(path, description)?)
        })
    }

    fn description(&self, picture: &Picture) -> ExrDescription {
        let alpha = picture.has_alpha().then(|| "A".to_owned());
        let channels = self.channels.iter().cloned().chain(alpha);
        ExrDescription {
            sample: self.maker.sample(self.options.sample),
            compression: self.maker.compression(),
            attributes: self.maker.attributes(),
            windows: picture.windows(),
            ..ExrDescription::new(picture.size(), channels)
        }
    }

    fn band_rows(&self, width: usize) -> usize {
        if self.options.layout == Layout::Mipmap {
            return TILE;
        }
        let row_bytes = size_of::<f32>() * width * self.channels.len();
        (BAND_BYTES / row_bytes.max(1)).clamp(1, BAND_ROWS)
    }
}

fn refuse_outside(band: &Band) -> Result<(), BakeError> {
    let refusal = |rgb: &[f32; 3]| LookupError::check(LinearRgb(rgb.map(f64::from))).err();
    let numbered = band.rgb.par_iter().enumerate();
    let first = numbered.find_map_first(|(i, rgb)| Some((i, refusal(rgb)?)));
    let Some((first, source)) = first else { return Ok(()) };
    let others = band.rgb[first + 1..].par_iter().filter_map(refusal).count();
    let (x, y) = (first % band.width, band.first_row + first / band.width);
    Err(BakeError::Texel { x, y, source, others })
}
