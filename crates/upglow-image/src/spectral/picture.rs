//! Reads spectral pictures by texel.

use std::ops::Range;
use std::path::Path;

use upglow_color::{BispectralUnit, DonaldsonError, DonaldsonMatrix};

use super::channel::{SpectralChannel, key_order, rising_pairs, stated_unit};
use super::compact::CompactLayout;
use super::error::FormError;
use crate::exr::reader::ExrReader;

/// Reads an OpenEXR file in the spectral layout or in upglow's compact form.
#[derive(Debug)]
pub struct SpectralPicture {
    reader: ExrReader,
    /// Spectral channels and their indices in the file, by kind and wavelength.
    channels: Vec<(SpectralChannel, usize)>,
    preview: Option<[usize; 3]>,
    compact: Option<(CompactLayout, Vec<usize>)>,
}

/// The values of one texel, sorted by wavelength.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct SpectralTexel {
    /// Wavelength in nm and reflectance or transmittance: the `T.` channels.
    pub reflectance: Vec<(f64, f32)>,
    /// Wavelength in nm and radiance: the `S0.` channels.
    pub radiance: Vec<(f64, f32)>,
    /// Stokes component 1 to 3, wavelength in nm, and its value.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub polarization: Vec<(u8, f64, f32)>,
    /// Incident and outgoing wavelength in nm, and the share of the incident light that leaves at the
    /// outgoing one. Computed from the maps for a compact file.
    pub reradiation: Vec<(f64, f64, f32)>,
    /// The unit of re-radiation, if the file states it.
    pub reradiation_unit: Option<BispectralUnit>,
    /// Red, green, blue of the preview.
    pub preview: Option<[f32; 3]>,
}

impl SpectralPicture {
    /// Opens a spectral picture. Channels with invalid names are omitted; [`Lint`](crate::Lint) reports
    /// them.
    ///
    /// # Errors
    ///
    /// [`FormError`] if it cannot be read or has no spectral channel.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, FormError> {
        let reader = ExrReader::open(path)?;
        let names = reader.channels().iter().enumerate();
        let mut channels: Vec<(SpectralChannel, usize)> =
            names.filter_map(|(i, c)| Some((c.name.parse().ok()?, i))).collect();
        if channels.is_empty() {
            return Err(FormError::NotSpectral);
        }
        channels.sort_by(|(a, _), (b, _)| key_order(a.key(), b.key()));
        let [red, green, blue] = ["R", "G", "B"].map(|name| reader.channel(name).ok());
        let preview = red.zip(green).zip(blue).map(|((red, green), blue)| [red, green, blue]);
        let compact = compact(&reader)?;
        Ok(Self { reader, channels, preview, compact })
    }

    /// Width and height, pixels.
    pub fn size(&self) -> [usize; 2] {
        self.reader.size()
    }

    /// The spectral channels: by Stokes component or kind, then by wavelength.
    #[cfg(test)]
    pub(super) fn channels(&self) -> impl ExactSizeIterator<Item = SpectralChannel> {
        self.channels.iter().map(|(channel, _)| *channel)
    }

    /// The unit of re-radiation; `None` if the file does not state it.
    pub(super) fn bispectral_unit(&self) -> Option<BispectralUnit> {
        if self.compact.is_some() {
            return Some(BispectralUnit::PerBand);
        }
        stated_unit(self.reader.attributes())
    }

    /// The texel in column `x` of row `y`, from the top left. Only its block is read.
    ///
    /// # Errors
    ///
    /// [`FormError`] if there is no such texel or its block is damaged.
    pub fn at(&mut self, x: usize, y: usize) -> Result<SpectralTexel, FormError> {
        let values = self.read(x..x.saturating_add(1), y)?;
        Ok(self.texel(|channel| values[channel][0]))
    }

    /// Every `step`-th texel of a row from the top. Rows are read fastest in their order.
    ///
    /// # Errors
    ///
    /// [`FormError`] if there is no such row or a block of it is damaged.
    pub fn row(&mut self, y: usize, step: usize) -> Result<Vec<SpectralTexel>, FormError> {
        let [width, _] = self.size();
        let values = self.read(0..width, y)?;
        let columns = (0..width).step_by(step.max(1));
        Ok(columns.map(|x| self.texel(|channel| values[channel][x])).collect())
    }

    /// Some columns of a row, by channel.
    fn read(&mut self, columns: Range<usize>, y: usize) -> Result<Vec<Vec<f32>>, FormError> {
        let numbers: Vec<usize> = (0..self.reader.channels().len()).collect();
        Ok(self.reader.read_region(columns, y..y.saturating_add(1), &numbers)?)
    }

    /// The re-radiation matrix of the texel in column `x` of row `y`, or the mean of all texels. `unit` is
    /// that of re-radiation where the file does not state it.
    ///
    /// The diagonal is the reflectance alone: the layout has no channel for light that is re-emitted within
    /// the band in which it arrived.
    ///
    /// # Errors
    ///
    /// [`FormError`] if there is no such texel, a block is damaged, or the channels are no matrix of a known
    /// unit.
    pub fn matrix(
        &mut self,
        at: Option<[usize; 2]>,
        unit: Option<BispectralUnit>,
    ) -> Result<DonaldsonMatrix, FormError> {
        let unit = match (self.bispectral_unit(), unit) {
            (Some(stated), Some(given)) if stated != given => {
                return Err(FormError::OtherUnit { stated, given });
            }
            (Some(unit), _) | (None, Some(unit)) => unit,
            (None, None) => return Err(FormError::Unit),
        };
        if let Some([x, y]) = at {
            return MeanTexel::of(&self.at(x, y)?).matrix(unit);
        }
        let mut mean: Option<MeanTexel> = None;
        let numbers: Vec<usize> = (0..self.reader.channels().len()).collect();
        for [columns, rows] in self.reader.pieces(numbers.len()) {
            let count = columns.len() * rows.len();
            let values = self.reader.read_region(columns, rows, &numbers)?;
            for i in 0..count {
                let texel = MeanTexel::of(&self.texel(|channel| values[channel][i]));
                match &mut mean {
                    Some(mean) => mean.add(&texel),
                    None => mean = Some(texel),
                }
            }
        }
        mean.ok_or(FormError::NotBispectral)?.matrix(unit)
    }

    /// The texel with these values of the channels.
    fn texel(&self, value: impl Fn(usize) -> f32) -> SpectralTexel {
        let mut texel = SpectralTexel {
            reradiation_unit: self.bispectral_unit(),
            preview: self.preview.map(|rgb| rgb.map(&value)),
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
                    texel.reradiation.push((in_nm, out_nm, value));
                }
            }
        }
        if let Some((layout, numbers)) = &self.compact {
            let stored: Vec<f32> = numbers.iter().map(|&number| value(number)).collect();
            let matrix = layout.expand(&stored).expect("a value for each channel");
            let nm = layout.wavelengths_nm();
            let pairs = rising_pairs(nm.len());
            texel.reradiation = pairs.map(|[i, o]| (nm[i], nm[o], matrix[o][i])).collect();
        }
        texel
    }
}

/// Sums of the channels of texels, in double precision.
struct MeanTexel {
    count: f64,
    reflectance: Vec<(f64, f64)>,
    /// Incident and outgoing wavelength, nm, and the sum.
    reradiation: Vec<(f64, f64, f64)>,
}

impl MeanTexel {
    fn of(texel: &SpectralTexel) -> Self {
        let reradiation = texel.reradiation.iter().map(|&(i, o, value)| (i, o, f64::from(value)));
        Self {
            count: 1.0,
            reflectance: texel.reflectance.iter().map(|&(nm, r)| (nm, f64::from(r))).collect(),
            reradiation: reradiation.collect(),
        }
    }

    fn add(&mut self, other: &Self) {
        self.count += other.count;
        for (sum, value) in self.reflectance.iter_mut().zip(&other.reflectance) {
            sum.1 += value.1;
        }
        for (sum, value) in self.reradiation.iter_mut().zip(&other.reradiation) {
            sum.2 += value.2;
        }
    }

    fn matrix(&self, unit: BispectralUnit) -> Result<DonaldsonMatrix, FormError> {
        if self.reradiation.is_empty() {
            return Err(FormError::NotBispectral);
        }
        let reflected = || self.reflectance.iter().map(|(nm, _)| *nm);
        let incident = ascending(reflected().chain(self.reradiation.iter().map(|(i, ..)| *i)));
        let outgoing = ascending(reflected().chain(self.reradiation.iter().map(|(_, o, _)| *o)));
        for (axis, found) in [("incident", incident.len()), ("outgoing", outgoing.len())] {
            if found > DonaldsonMatrix::MOST_WAVELENGTHS {
                return Err(DonaldsonError::AxisLength { axis, found }.into());
            }
        }
        let mut values = vec![vec![0.0; incident.len()]; outgoing.len()];
        let index = |axis: &[f64], nm: f64| axis.partition_point(|at| *at < nm);
        for &(in_nm, out_nm, sum) in &self.reradiation {
            values[index(&outgoing, out_nm)][index(&incident, in_nm)] = sum / self.count;
        }
        let matrix = DonaldsonMatrix::try_new(incident, outgoing, values, unit)?;
        let means = self.reflectance.iter().map(|(nm, sum)| (*nm, sum / self.count));
        Ok(matrix.with_reflectance(&means.collect::<Vec<_>>())?)
    }
}

/// The numbers in ascending order, each once.
fn ascending(numbers: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut sorted: Vec<f64> = numbers.collect();
    sorted.sort_by(f64::total_cmp);
    sorted.dedup();
    sorted
}

/// The compact layout that a file states, and the indices of its channels.
fn compact(reader: &ExrReader) -> Result<Option<(CompactLayout, Vec<usize>)>, FormError> {
    if !CompactLayout::is_stated(reader.attributes()) {
        return Ok(None);
    }
    let layout = CompactLayout::from_attributes(reader.attributes())?;
    let names = layout.channel_names();
    let numbers = names.iter().map(|name| reader.channel(name)).collect::<Result<_, _>>()?;
    Ok(Some((layout, numbers)))
}
