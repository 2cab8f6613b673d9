//! Checks spectral and bispectral OpenEXR files.

mod channels;
pub(crate) mod findings;
mod samples;

use std::path::Path;

use upglow_color::{BispectralUnit, Choice as _};

use self::channels::{ListedChannel, SAME_NM, band, bands_nm, list, same, sorted_nm};
use self::findings::{Lint, Rule};
use self::samples::check_samples;
use super::channel::{
    BISPECTRAL_UNIT, EMISSIVE_UNITS, LAYOUT_VERSION, LAYOUT_VERSION_VALUE, SpectralChannel,
    key_order, number_and_unit, rising_pairs, stated_unit,
};
use super::compact::CompactLayout;
use crate::exr::error::ExrError;
use crate::exr::reader::ExrReader;

impl Lint {
    /// Checks the names and attributes of a file. Broken rules are findings, not errors.
    ///
    /// # Errors
    ///
    /// [`ExrError`] if the file cannot be read as OpenEXR.
    pub fn of_header(path: impl AsRef<Path>) -> Result<Self, ExrError> {
        let reader = ExrReader::open(path)?;
        let mut lint = Self::default();
        check_header(&reader, &mut lint);
        Ok(lint)
    }

    /// Checks the names, attributes and samples of a file, in some 64 MiB and the memory of one
    /// block.
    ///
    /// # Errors
    ///
    /// [`ExrError`] if the file cannot be read as OpenEXR, or is damaged.
    pub fn of_file(path: impl AsRef<Path>) -> Result<Self, ExrError> {
        let mut reader = ExrReader::open(path)?;
        let mut lint = Self::default();
        let channels = check_header(&reader, &mut lint);
        check_samples(&mut reader, &channels, &mut lint)?;
        Ok(lint)
    }
}

/// Checks names and attributes. Returns the spectral channels with valid names.
fn check_header(reader: &ExrReader, lint: &mut Lint) -> Vec<ListedChannel> {
    let channels = list(reader, lint);
    count(&channels, lint);
    check_attributes(reader, lint);
    check_preview(reader, lint);
    check_duplicates(&channels, lint);
    check_units(&channels, lint);
    check_polarization(&channels, lint);
    check_pairs(&channels, lint);
    channels
}

fn count(channels: &[ListedChannel], lint: &mut Lint) {
    for ListedChannel { channel, name, .. } in channels {
        match *channel {
            SpectralChannel::Reflectance { .. } => lint.reflectance += 1,
            SpectralChannel::Radiance { stokes: 0, .. } => lint.radiance += 1,
            SpectralChannel::Radiance { .. } => lint.polarization += 1,
            SpectralChannel::Reradiation { in_nm, out_nm } => {
                lint.reradiation += 1;
                if same(in_nm, out_nm) {
                    let diagonal = SpectralChannel::Reflectance { nm: in_nm };
                    lint.add(Rule::Diagonal, name.clone(), format!("{diagonal} for the diagonal"));
                } else if out_nm < in_nm {
                    let expected = "an outgoing wavelength above the incident";
                    lint.add(Rule::Stokes, name.clone(), expected);
                }
            }
        }
    }
}

fn check_attributes(reader: &ExrReader, lint: &mut Lint) {
    let attributes = reader.attributes();
    let text = |name: &str| attributes.get(name).map(|v| v.as_text().unwrap_or(&v.kind));
    let version = text(LAYOUT_VERSION);
    if version != Some(LAYOUT_VERSION_VALUE) {
        let found = format!("{LAYOUT_VERSION} {}", version.map_or("absent".into(), quoted));
        lint.add(Rule::LayoutVersion, found, quoted(LAYOUT_VERSION_VALUE));
    }
    if lint.radiance > 0 && text(EMISSIVE_UNITS).is_none_or(str::is_empty) {
        let found = format!("{EMISSIVE_UNITS} absent beside S0. channels");
        lint.add(Rule::EmissiveUnits, found, "a unit as W.m^-2.sr^-1");
    }
    lint.is_compact = CompactLayout::is_stated(attributes);
    if lint.is_compact {
        check_compact(reader, lint);
    }
    if lint.reradiation > 0 && stated_unit(attributes).is_none() {
        let found = text(BISPECTRAL_UNIT).map_or("absent".into(), quoted);
        let names = [BispectralUnit::PerBand, BispectralUnit::PerNm].map(|u| quoted(u.name()));
        let expected = format!("{}, which the layout itself leaves open", names.join(" or "));
        lint.add(Rule::BispectralUnit, format!("{BISPECTRAL_UNIT} {found}"), expected);
    }
}

fn quoted(text: &str) -> String {
    format!("{text:?}")
}

fn check_compact(reader: &ExrReader, lint: &mut Lint) {
    let layout = match CompactLayout::from_attributes(reader.attributes()) {
        Ok(layout) => layout,
        Err(error) => {
            let message = error.to_string();
            let (found, expected) = message.split_once(", expected ").unwrap_or((&message, ""));
            return lint.add(Rule::Compact, found, expected);
        }
    };
    let names = layout.channel_names();
    let absent: Vec<&String> = names.iter().filter(|n| reader.channel(n).is_err()).collect();
    if let [first, ..] = absent[..] {
        let found = format!("{} channels absent, the first {first}", absent.len());
        lint.add(Rule::Compact, found, "all channels of the compact form");
    }
}

fn check_preview(reader: &ExrReader, lint: &mut Lint) {
    let absent: Vec<&str> =
        ["R", "G", "B"].into_iter().filter(|name| reader.channel(name).is_err()).collect();
    if !absent.is_empty() {
        let found = format!("no channel {}", absent.join(", "));
        lint.add(Rule::Preview, found, "a preview in R, G, B");
    }
}

fn check_duplicates(channels: &[ListedChannel], lint: &mut Lint) {
    let is_twin = |a: SpectralChannel, b: SpectralChannel| {
        let ((kind, nm), (other_kind, other_nm)) = (a.key(), b.key());
        kind == other_kind && same(nm[0], other_nm[0]) && same(nm[1], other_nm[1])
    };
    // Wavelengths that are the same except for rounding become neighbors.
    let rounded = |listed: &ListedChannel| {
        let (kind, nm) = listed.channel.key();
        (kind, nm.map(|nm| (nm / SAME_NM).round()))
    };
    let mut sorted: Vec<&ListedChannel> = channels.iter().collect();
    sorted.sort_by(|a, b| key_order(rounded(a), rounded(b)));
    for pair in sorted.windows(2).filter(|pair| is_twin(pair[0].channel, pair[1].channel)) {
        let found = format!("{} and {}, the same wavelength", pair[0].name, pair[1].name);
        lint.add(Rule::Duplicate, found, "each wavelength once");
    }
}

fn check_units(channels: &[ListedChannel], lint: &mut Lint) {
    let units = channels.iter().flat_map(|found| found.name.split('.').skip(1));
    let mut units: Vec<&str> = units.map(|part| number_and_unit(part).1).collect();
    units.sort_unstable();
    units.dedup();
    if units.len() > 1 {
        lint.add(Rule::Units, format!("units {}", units.join(", ")), "one unit in all names");
    }
}

fn check_polarization(channels: &[ListedChannel], lint: &mut Lint) {
    let bands = |wanted: u8| {
        sorted_nm(channels, |channel| match channel {
            SpectralChannel::Radiance { stokes, nm } if stokes == wanted => Some(nm),
            _ => None,
        })
    };
    let plain = bands(0);
    for stokes in 1..=3 {
        let found = bands(stokes);
        let equal =
            found.len() == plain.len() && found.iter().zip(&plain).all(|(a, b)| same(*a, *b));
        if !found.is_empty() && !equal {
            let count = format!("{} channels S{stokes}.", found.len());
            lint.add(Rule::Polarization, count, format!("the {} wavelengths of S0.", plain.len()));
        }
    }
}

fn check_pairs(channels: &[ListedChannel], lint: &mut Lint) {
    if lint.reradiation == 0 {
        return;
    }
    let bands = bands_nm(channels);
    let mut present = std::collections::BTreeSet::new();
    for ListedChannel { channel, name, .. } in channels {
        let SpectralChannel::Reradiation { in_nm, out_nm } = *channel else { continue };
        match (band(&bands, in_nm), band(&bands, out_nm)) {
            (Some(incident), Some(outgoing)) => drop(present.insert([incident, outgoing])),
            (incident, _) => {
                let nm = if incident.is_none() { in_nm } else { out_nm };
                let channel = SpectralChannel::Reflectance { nm };
                let found = format!("{name} without {channel}");
                lint.add(Rule::Band, found, "both its bands on the diagonal");
            }
        }
    }
    // There may be billions of pairs: they are counted, and gone through only up to the first that is absent.
    let total = bands.len() * bands.len().saturating_sub(1) / 2;
    let rising = present.iter().filter(|[incident, outgoing]| incident < outgoing).count();
    if let Some([incident, outgoing]) = rising_pairs(bands.len()).find(|p| !present.contains(p)) {
        let first =
            SpectralChannel::Reradiation { in_nm: bands[incident], out_nm: bands[outgoing] };
        let found = format!("{} of {total} pairs absent, the first {first}", total - rising);
        lint.add(Rule::Pairs, found, "a channel for each pair; absent ones count as 0");
    }
}
