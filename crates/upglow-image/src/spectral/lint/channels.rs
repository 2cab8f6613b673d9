//! The spectral channels of a file, as a linter lists them.

use super::findings::{Lint, Rule};
use crate::exr::header::Sample;
use crate::exr::reader::ExrReader;
use crate::spectral::channel::{SpectralChannel, SpectralNameError};

/// A well-formed spectral channel of a file.
#[derive(Clone, Debug)]
pub(super) struct ListedChannel {
    pub(super) channel: SpectralChannel,
    pub(super) name: String,
    /// Its number in the file.
    pub(super) number: usize,
    pub(super) sample: Sample,
}

/// Wavelengths nearer than this are the same, nm: names of six decimals differ by a rounding.
pub(super) const SAME_NM: f64 = 1e-5;

pub(super) fn same(a: f64, b: f64) -> bool {
    (a - b).abs() < SAME_NM
}

pub(super) fn list(reader: &ExrReader, lint: &mut Lint) -> Vec<ListedChannel> {
    let mut channels = Vec::new();
    for (number, stored) in reader.channels().iter().enumerate() {
        let name = stored.name.clone();
        match name.parse::<SpectralChannel>() {
            Ok(channel) => {
                channels.push(ListedChannel { channel, name, number, sample: stored.sample });
            }
            Err(SpectralNameError::NotSpectral) => continue,
            Err(error) => {
                let has = format_args!("channel {:?} has {error}", stored.name);
                lint.add_error(Rule::Name, has);
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

/// The wavelengths that `nm` picks, ascending, nm.
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

/// The number of the band around a wavelength that names it.
pub(super) fn band(bands_nm: &[f64], nm: f64) -> Option<usize> {
    let at = bands_nm.partition_point(|band| *band < nm - SAME_NM);
    bands_nm.get(at).filter(|band| same(**band, nm)).map(|_| at)
}
