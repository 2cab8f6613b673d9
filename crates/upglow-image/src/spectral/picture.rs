//! Spectral pictures, texel by texel.

use std::path::Path;

use crate::exr::error::ExrError;
use crate::exr::reader::ExrReader;
use crate::spectral::channel::{BISPECTRAL_UNIT, BispectralUnit, SpectralChannel};
use crate::spectral::compact::{CompactError, CompactLayout};

/// Why a spectral picture cannot be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SpectralPictureError {
    /// It is no OpenEXR file that can be read.
    #[error(transparent)]
    Exr(#[from] ExrError),
    /// It has no spectral channel.
    #[error("no spectral channel, expected names as T.550,000000nm or S0.550,000000nm")]
    NotSpectral,
    /// It says that it is in compact form, and is not.
    #[error(transparent)]
    Compact(#[from] CompactError),
}

/// An OpenEXR file in the spectral layout or in our compact form.
#[derive(Debug)]
pub struct SpectralPicture {
    reader: ExrReader,
    /// Well-formed channels and their numbers, by kind and wavelength.
    channels: Vec<(SpectralChannel, usize)>,
    preview: Option<[usize; 3]>,
    compact: Option<(CompactLayout, Vec<usize>)>,
}

/// Light that comes in at one wavelength and leaves at another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reradiation {
    /// Wavelength of the incident light, nm.
    pub in_nm: f64,
    /// Wavelength of the outgoing light, nm.
    pub out_nm: f64,
    /// The share, in the unit of [`SpectralPicture::bispectral_unit`].
    pub value: f32,
}

/// All that a spectral picture holds of one texel, sorted by wavelength.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SpectralTexel {
    /// Wavelength in nm and reflectance or transmittance: the `T.` channels.
    pub reflectance: Vec<(f64, f32)>,
    /// Wavelength in nm and radiance: the `S0.` channels.
    pub radiance: Vec<(f64, f32)>,
    /// Stokes component 1 to 3, wavelength in nm, and its value.
    pub polarization: Vec<(u8, f64, f32)>,
    /// Re-radiation, by incident and then by outgoing wavelength. Of a compact file: expanded, the
    /// pairs of the spectral layout.
    pub reradiation: Vec<Reradiation>,
    /// Red, green, blue of the preview.
    pub preview: Option<[f32; 3]>,
}

impl SpectralPicture {
    /// Opens a spectral picture. Channels whose names are broken are left out; [`crate::lint`]
    /// names them.
    ///
    /// # Errors
    ///
    /// [`SpectralPictureError`] if it cannot be read or has no spectral channel.
    pub fn open(path: &Path) -> Result<Self, SpectralPictureError> {
        let reader = ExrReader::open(path)?;
        let names = reader.channels().iter().enumerate();
        let mut channels: Vec<(SpectralChannel, usize)> =
            names.filter_map(|(i, c)| Some((c.name.parse().ok()?, i))).collect();
        if channels.is_empty() {
            return Err(SpectralPictureError::NotSpectral);
        }
        let key = |channel: &SpectralChannel| match *channel {
            SpectralChannel::Radiance { stokes, nm } => (stokes, nm, 0.0),
            SpectralChannel::Reflectance { nm } => (4, nm, 0.0),
            SpectralChannel::Reradiation { in_nm, out_nm } => (5, in_nm, out_nm),
        };
        channels.sort_by(|(a, _), (b, _)| {
            let (a, b) = (key(a), key(b));
            a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.total_cmp(&b.2))
        });
        let preview = match ["R", "G", "B"].map(|name| reader.channel(name).ok()) {
            [Some(red), Some(green), Some(blue)] => Some([red, green, blue]),
            _ => None,
        };
        let compact = compact(&reader)?;
        Ok(Self { reader, channels, preview, compact })
    }

    /// Width and height, pixels.
    pub fn size(&self) -> [usize; 2] {
        self.reader.size()
    }

    /// The file below, for its attributes and channels.
    pub fn reader(&self) -> &ExrReader {
        &self.reader
    }

    /// The spectral channels: by Stokes component or kind, then by wavelength.
    pub fn channels(&self) -> impl ExactSizeIterator<Item = SpectralChannel> + '_ {
        self.channels.iter().map(|(channel, _)| *channel)
    }

    /// The compact form, if the file is in it.
    pub fn compact(&self) -> Option<&CompactLayout> {
        self.compact.as_ref().map(|(layout, _)| layout)
    }

    /// What re-radiation holds; `None` where the file does not say.
    pub fn bispectral_unit(&self) -> Option<BispectralUnit> {
        if self.compact.is_some() {
            return Some(BispectralUnit::PerBand);
        }
        let stated = self.reader.attributes().get(BISPECTRAL_UNIT)?;
        BispectralUnit::named(stated.as_text()?)
    }

    /// The texel in column `x` of row `y`, from the top left. Only its block is read.
    ///
    /// # Errors
    ///
    /// [`SpectralPictureError`] if there is no such texel or its block is damaged.
    pub fn at(&mut self, x: usize, y: usize) -> Result<SpectralTexel, SpectralPictureError> {
        let [width, height] = self.size();
        let numbers: Vec<usize> = (0..self.reader.channels().len()).collect();
        let values = if x < width && y < height {
            self.reader.read_region(x..x + 1, y..y + 1, &numbers)?
        } else {
            let (columns, rows) = ([x, x.saturating_add(1)], [y, y.saturating_add(1)]);
            return Err(ExrError::Outside { columns, rows, width, height }.into());
        };
        let value = |channel: usize| values[channel][0];
        let mut texel = SpectralTexel {
            preview: self.preview.map(|rgb| rgb.map(value)),
            ..SpectralTexel::default()
        };
        for &(channel, number) in &self.channels {
            let value = value(number);
            match channel {
                SpectralChannel::Reflectance { nm } => texel.reflectance.push((nm, value)),
                SpectralChannel::Radiance { stokes: 0, nm } => texel.radiance.push((nm, value)),
                SpectralChannel::Radiance { stokes, nm } => {
                    texel.polarization.push((stokes, nm, value));
                }
                SpectralChannel::Reradiation { in_nm, out_nm } => {
                    texel.reradiation.push(Reradiation { in_nm, out_nm, value });
                }
            }
        }
        if let Some((layout, numbers)) = &self.compact {
            let stored: Vec<f32> = numbers.iter().map(|&number| value(number)).collect();
            let matrix = layout.expand(&stored)?;
            let pairs = matrix.pairs();
            let pairs = pairs.map(|(in_nm, out_nm, value)| Reradiation { in_nm, out_nm, value });
            texel.reradiation = pairs.collect();
        }
        Ok(texel)
    }
}

/// The compact form that a file states, and the numbers of its channels.
fn compact(reader: &ExrReader) -> Result<Option<(CompactLayout, Vec<usize>)>, CompactError> {
    if !CompactLayout::is_stated(reader.attributes()) {
        return Ok(None);
    }
    let layout = CompactLayout::from_attributes(reader.attributes())?;
    let names = layout.channel_names().into_iter();
    let numbers =
        names.map(|name| reader.channel(&name).map_err(|_| CompactError::Channel { name }));
    let numbers = numbers.collect::<Result<_, _>>()?;
    Ok(Some((layout, numbers)))
}
