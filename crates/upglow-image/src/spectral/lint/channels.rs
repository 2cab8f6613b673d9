//! The spectral channels of a file.

use super::findings::{Lint, Rule};
use crate::exr::header::Sample;
use crate::exr::reader::ExrReader;
use crate::spectral::channel::{SpectralChannel, SpectralNameError};

/// A spectral channel with a valid name.
#[derive(Clone, Debug)]
pub(super) struct ListedChannel {
    pub(super) channel: SpectralChannel,
    pub(super) name: String,
    /// Its index in the file.
    pub(super) number: usize,
    pub(super) sample: Sample,
}

/// Wavelengths that differ by less are the same, nm: names with six decimals are rounded.
pub(super) const SAME_NM: f64 = 1e-5;

pub(super) fn same(a: f64, b: f64) -> bool {
    (a - b).abs() < SAME_NM
}

/// Lists the spectral channels; reports invalid names and samples.
pub(super) fn list(reader: &ExrReader, lint: &mut Lint) -> Vec<ListedChannel> {
    let mut channels = Vec::new();
    for (number, stored) in reader.channels().iter().enumerate() {
        let name = stored.name.clone();
        match name.parse() {
            Ok(channel) => {
                channels.push(ListedChannel { channel, name, number, sample: stored.sample });
            }
            Err(SpectralNameError::NotSpectral) => continue,
            Err(SpectralNameError::Invalid { found, expected }) => {
                lint.add(Rule::Name, format!("channel {name:?} has {found}"), expected);
            }
        }
        if stored.sample == Sample::Uint {
            let found = format!("unsigned samples in {}", stored.name);
            lint.add(Rule::Sample, found, "half or float");
        }
    }
    let tries = reader.channels().iter().any(|c| SpectralChannel::is_spectral(&c.name));
    if !tries {
        let found = format!("{} channels, none spectral", reader.channels().len());
        lint.add(Rule::Spectral, found, "names as T.550,000000nm or S0.550,000000nm");
    }
    channels
}

/// The wavelengths that `nm` selects, ascending, nm.
pub(super) fn sorted_nm(
    channels: &[ListedChannel],
    nm: impl Fn(SpectralChannel) -> Option<f64>,
) -> Vec<f64> {
    let mut found: Vec<f64> = channels.iter().filter_map(|listed| nm(listed.channel)).collect();
    found.sort_by(f64::total_cmp);
    found
}

/// The wavelengths of the `T.λ` channels, ascending, nm.
pub(super) fn bands_nm(channels: &[ListedChannel]) -> Vec<f64> {
    let mut bands = sorted_nm(channels, |channel| match channel {
        SpectralChannel::Reflectance { nm } => Some(nm),
        _ => None,
    });
    bands.dedup_by(|a, b| same(*a, *b));
    bands
}

/// The index of the band with this wavelength.
pub(super) fn band(bands_nm: &[f64], nm: f64) -> Option<usize> {
    let at = bands_nm.partition_point(|band| *band < nm - SAME_NM);
    bands_nm.get(at).filter(|band| same(**band, nm)).map(|_| at)
}
