//! Whether a file is a well-formed spectral or bispectral OpenEXR file, and what is wrong.

mod samples;

use std::fmt;
use std::path::Path;

use self::samples::check_pixels;
use crate::exr::error::ExrError;
use crate::exr::header::Sample;
use crate::exr::reader::ExrReader;
use crate::spectral::channel::{
    BISPECTRAL_UNIT, BispectralUnit, EMISSIVE_UNITS, LAYOUT_VERSION, LAYOUT_VERSION_VALUE,
    SpectralChannel, SpectralNameError,
};
use crate::spectral::compact::CompactLayout;

/// How bad a finding is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(rename_all = "lowercase"))]
pub enum Severity {
    /// Readers may guess, or some will refuse the file.
    Warning,
    /// The file breaks the layout, or its numbers are not physical.
    Error,
}

/// What is checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Rule {
    /// There are spectral channels.
    Spectral,
    /// Names of spectral channels have numbers with a comma, and units.
    Name,
    /// The diagonal is `T.λ`, never `T.λ.λ`.
    Diagonal,
    /// The outgoing wavelength is longer than the incident one.
    Stokes,
    /// Samples are half or float.
    Sample,
    /// R, G, B hold a preview.
    Preview,
    /// `spectralLayoutVersion` is "1.0".
    LayoutVersion,
    /// `emissiveUnits` is there where `S0.` is.
    EmissiveUnits,
    /// `S1.` to `S3.` have the wavelengths of `S0.`.
    Polarization,
    /// Wavelengths of re-radiation are among those of `T.λ`.
    Band,
    /// Each pair of bands, incident before outgoing, has its channel.
    Pairs,
    /// No wavelength is there twice, spelled differently.
    Duplicate,
    /// All names use one unit.
    Units,
    /// The file says what re-radiation channels hold.
    BispectralUnit,
    /// A file that says it is in compact form is.
    Compact,
    /// Every sample is finite.
    Finite,
    /// Reflectance, re-radiation and `S0.` are not negative.
    Negative,
    /// No incident wavelength gives back more than it brought.
    Energy,
}

/// One thing that is wrong with a file.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Finding {
    /// The rule that is broken.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub rule: Rule,
    /// How bad that is.
    pub severity: Severity,
    /// What was found.
    pub found: String,
    /// What was expected.
    pub expected: String,
}

impl fmt::Display for Severity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Warning => "warning",
            Self::Error => "error",
        })
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}, expected {}", self.severity, self.found, self.expected)
    }
}

/// What a linter saw in a file.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Lint {
    /// Number of `T.λ` channels.
    #[cfg_attr(feature = "serde", serde(rename = "reflectance_channels"))]
    pub reflectance: usize,
    /// Number of `S0.` channels.
    #[cfg_attr(feature = "serde", serde(rename = "radiance_channels"))]
    pub radiance: usize,
    /// Number of `S1.` to `S3.` channels.
    #[cfg_attr(feature = "serde", serde(rename = "polarization_channels"))]
    pub polarization: usize,
    /// Number of `T.λ.λ'` channels.
    #[cfg_attr(feature = "serde", serde(rename = "reradiation_channels"))]
    pub reradiation: usize,
    /// Whether the file says that it is in our compact form.
    #[cfg_attr(feature = "serde", serde(rename = "compact"))]
    pub is_compact: bool,
    /// What is wrong; empty for a well-formed file.
    pub findings: Vec<Finding>,
}

impl Lint {
    /// Whether nothing worse than a warning was found.
    pub fn is_well_formed(&self) -> bool {
        self.findings.iter().all(|finding| finding.severity < Severity::Error)
    }

    pub(crate) fn error(
        &mut self,
        rule: Rule,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) {
        self.add(rule, Severity::Error, found, expected);
    }

    fn warn(&mut self, rule: Rule, found: impl Into<String>, expected: impl Into<String>) {
        self.add(rule, Severity::Warning, found, expected);
    }

    fn add(
        &mut self,
        rule: Rule,
        severity: Severity,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) {
        let [found, expected] = [found.into(), expected.into()].map(escaped);
        self.findings.push(Finding { rule, severity, found, expected });
    }
}

/// How far a linter looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Depth {
    /// Names and attributes.
    Header,
    /// Every sample too, by rows: the memory of one row of blocks in all channels.
    Pixels,
}

/// Checks a file. What is wrong with it is a finding, not an error.
///
/// # Errors
///
/// [`ExrError`] if it is no OpenEXR file that can be read.
pub fn lint(path: &Path, depth: Depth) -> Result<Lint, ExrError> {
    let mut reader = ExrReader::open(path)?;
    let mut lint = Lint::default();
    let channels = parse(&reader, &mut lint);
    count(&channels, &mut lint);
    check_attributes(&reader, &mut lint);
    check_preview(&reader, &mut lint);
    check_duplicates(&channels, &mut lint);
    check_units(&channels, &mut lint);
    check_polarization(&channels, &mut lint);
    check_pairs(&channels, &mut lint);
    if depth == Depth::Pixels {
        check_pixels(&mut reader, &channels, &mut lint)?;
    }
    Ok(lint)
}

/// A well-formed spectral channel of a file.
#[derive(Clone, Debug)]
pub(crate) struct Found {
    pub(crate) channel: SpectralChannel,
    pub(crate) name: String,
    /// Its number in the file.
    pub(crate) number: usize,
    pub(crate) sample: Sample,
}

/// Wavelengths nearer than this are the same, nm: names of six decimals differ by a rounding.
const SAME_NM: f64 = 1e-5;

fn same(a: f64, b: f64) -> bool {
    (a - b).abs() < SAME_NM
}

fn parse(reader: &ExrReader, lint: &mut Lint) -> Vec<Found> {
    let mut channels = Vec::new();
    for (number, stored) in reader.channels().iter().enumerate() {
        let name = stored.name.clone();
        match name.parse::<SpectralChannel>() {
            Ok(channel) => {
                channels.push(Found { channel, name, number, sample: stored.sample });
            }
            Err(SpectralNameError::NotSpectral { .. }) => continue,
            Err(error) => {
                let message = error.to_string();
                let (found, expected) = message.split_once(", expected ").unwrap_or((&message, ""));
                lint.error(Rule::Name, found, expected);
            }
        }
        if stored.sample == Sample::Uint {
            let found = format!("unsigned samples in {}", stored.name);
            lint.error(Rule::Sample, found, "half or float");
        }
    }
    let tries = reader.channels().iter().any(|c| SpectralChannel::is_spectral(&c.name));
    if !tries {
        let found = format!("{} channels, none spectral", reader.channels().len());
        lint.error(Rule::Spectral, found, "names as T.550,000000nm or S0.550,000000nm");
    }
    channels
}

fn count(channels: &[Found], lint: &mut Lint) {
    for Found { channel, name, .. } in channels {
        match *channel {
            SpectralChannel::Reflectance { .. } => lint.reflectance += 1,
            SpectralChannel::Radiance { stokes: 0, .. } => lint.radiance += 1,
            SpectralChannel::Radiance { .. } => lint.polarization += 1,
            SpectralChannel::Reradiation { in_nm, out_nm } => {
                lint.reradiation += 1;
                if same(in_nm, out_nm) {
                    let diagonal = SpectralChannel::Reflectance { nm: in_nm };
                    lint.error(
                        Rule::Diagonal,
                        name.clone(),
                        format!("{diagonal} for the diagonal"),
                    );
                } else if out_nm < in_nm {
                    lint.error(
                        Rule::Stokes,
                        name.clone(),
                        "an outgoing wavelength above the incident",
                    );
                }
            }
        }
    }
}

fn check_attributes(reader: &ExrReader, lint: &mut Lint) {
    let attributes = reader.attributes();
    let text = |name: &str| attributes.get(name).map(|v| v.as_text().unwrap_or(v.kind()));
    let version = text(LAYOUT_VERSION);
    if version != Some(LAYOUT_VERSION_VALUE) {
        let found = format!("{LAYOUT_VERSION} {}", version.map_or("absent".into(), quoted));
        lint.error(Rule::LayoutVersion, found, quoted(LAYOUT_VERSION_VALUE));
    }
    if lint.radiance > 0 && text(EMISSIVE_UNITS).is_none_or(str::is_empty) {
        let found = format!("{EMISSIVE_UNITS} absent beside S0. channels");
        lint.warn(Rule::EmissiveUnits, found, "a unit as W.m^-2.sr^-1");
    }
    lint.is_compact = CompactLayout::is_stated(attributes);
    if lint.is_compact {
        check_compact(reader, lint);
    }
    if lint.reradiation > 0 && text(BISPECTRAL_UNIT).and_then(BispectralUnit::named).is_none() {
        let found = text(BISPECTRAL_UNIT).map_or("absent".into(), quoted);
        let names = [BispectralUnit::PerBand, BispectralUnit::PerNm].map(|u| quoted(u.name()));
        lint.warn(
            Rule::BispectralUnit,
            format!("{BISPECTRAL_UNIT} {found}"),
            format!("{}, which the layout itself leaves open", names.join(" or ")),
        );
    }
}

/// One line: control characters in names stand for themselves no more.
fn escaped(text: String) -> String {
    if text.contains(char::is_control) { text.escape_debug().to_string() } else { text }
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
            return lint.error(Rule::Compact, found, expected);
        }
    };
    let names = layout.channel_names();
    let absent: Vec<&String> = names.iter().filter(|n| reader.channel(n).is_err()).collect();
    if let [first, ..] = absent[..] {
        let found = format!("{} channels absent, the first {first}", absent.len());
        lint.error(Rule::Compact, found, "all channels of the compact form");
    }
}

fn check_preview(reader: &ExrReader, lint: &mut Lint) {
    let absent: Vec<&str> =
        ["R", "G", "B"].into_iter().filter(|name| reader.channel(name).is_err()).collect();
    if !absent.is_empty() {
        let found = format!("no channel {}", absent.join(", "));
        lint.warn(Rule::Preview, found, "a preview in R, G, B");
    }
}

fn check_duplicates(channels: &[Found], lint: &mut Lint) {
    let twin = |a: SpectralChannel, b: SpectralChannel| match (a, b) {
        (
            SpectralChannel::Radiance { stokes: s, nm: a },
            SpectralChannel::Radiance { stokes: t, nm: b },
        ) => s == t && same(a, b),
        (SpectralChannel::Reflectance { nm: a }, SpectralChannel::Reflectance { nm: b }) => {
            same(a, b)
        }
        (
            SpectralChannel::Reradiation { in_nm: a, out_nm: b },
            SpectralChannel::Reradiation { in_nm: c, out_nm: d },
        ) => same(a, c) && same(b, d),
        _ => false,
    };
    let mut sorted: Vec<&Found> = channels.iter().collect();
    sorted.sort_by(|a, b| {
        let (a, b) = (sort_key(a.channel), sort_key(b.channel));
        a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.total_cmp(&b.2))
    });
    for pair in sorted.windows(2).filter(|pair| twin(pair[0].channel, pair[1].channel)) {
        let found = format!("{} and {}, the same wavelength", pair[0].name, pair[1].name);
        lint.error(Rule::Duplicate, found, "each wavelength once");
    }
}

/// Kind and wavelengths; what is the same up to rounding stands side by side.
fn sort_key(channel: SpectralChannel) -> (u8, f64, f64) {
    let round = |nm: f64| (nm / SAME_NM).round();
    match channel {
        SpectralChannel::Radiance { stokes, nm } => (stokes, round(nm), 0.0),
        SpectralChannel::Reflectance { nm } => (4, round(nm), 0.0),
        SpectralChannel::Reradiation { in_nm, out_nm } => (5, round(in_nm), round(out_nm)),
    }
}

fn check_units(channels: &[Found], lint: &mut Lint) {
    let units = channels.iter().flat_map(|found| found.name.split('.').skip(1));
    let digits = |c: char| c.is_ascii_digit() || c == ',';
    let mut units: Vec<&str> = units.map(|part| part.trim_start_matches(digits)).collect();
    units.sort_unstable();
    units.dedup();
    if units.len() > 1 {
        lint.warn(Rule::Units, format!("units {}", units.join(", ")), "one unit in all names");
    }
}

fn check_polarization(channels: &[Found], lint: &mut Lint) {
    let bands = |wanted: u8| {
        let of = channels.iter().filter_map(move |found| match found.channel {
            SpectralChannel::Radiance { stokes, nm } if stokes == wanted => Some(nm),
            _ => None,
        });
        let mut bands: Vec<f64> = of.collect();
        bands.sort_by(f64::total_cmp);
        bands
    };
    let plain = bands(0);
    for stokes in 1..=3 {
        let found = bands(stokes);
        let equal =
            found.len() == plain.len() && found.iter().zip(&plain).all(|(a, b)| same(*a, *b));
        if !found.is_empty() && !equal {
            let count = format!("{} channels S{stokes}.", found.len());
            lint.error(
                Rule::Polarization,
                count,
                format!("the {} wavelengths of S0.", plain.len()),
            );
        }
    }
}

/// The wavelengths of the `T.λ` channels, ascending, nm.
pub(crate) fn bands_nm(channels: &[Found]) -> Vec<f64> {
    let of = channels.iter().filter_map(|found| match found.channel {
        SpectralChannel::Reflectance { nm } => Some(nm),
        _ => None,
    });
    let mut bands: Vec<f64> = of.collect();
    bands.sort_by(f64::total_cmp);
    bands.dedup_by(|a, b| same(*a, *b));
    bands
}

/// The number of the band around a wavelength that names it.
pub(crate) fn band(bands_nm: &[f64], nm: f64) -> Option<usize> {
    let at = bands_nm.partition_point(|band| *band < nm - SAME_NM);
    bands_nm.get(at).filter(|band| same(**band, nm)).map(|_| at)
}

fn check_pairs(channels: &[Found], lint: &mut Lint) {
    if lint.reradiation == 0 {
        return;
    }
    let bands = bands_nm(channels);
    let mut present = std::collections::BTreeSet::new();
    for Found { channel, name, .. } in channels {
        let SpectralChannel::Reradiation { in_nm, out_nm } = *channel else { continue };
        match (band(&bands, in_nm), band(&bands, out_nm)) {
            (Some(incident), Some(outgoing)) => drop(present.insert((incident, outgoing))),
            (incident, _) => {
                let nm = if incident.is_none() { in_nm } else { out_nm };
                let channel = SpectralChannel::Reflectance { nm };
                lint.error(
                    Rule::Band,
                    format!("{name} without {channel}"),
                    "both its bands on the diagonal",
                );
            }
        }
    }
    let all = (0..bands.len()).flat_map(|i| (i + 1..bands.len()).map(move |o| (i, o)));
    let absent: Vec<(usize, usize)> = all.filter(|pair| !present.contains(pair)).collect();
    if let [(incident, outgoing), ..] = absent[..] {
        let first =
            SpectralChannel::Reradiation { in_nm: bands[incident], out_nm: bands[outgoing] };
        let total = bands.len() * (bands.len() - 1) / 2;
        let found = format!("{} of {total} pairs absent, the first {first}", absent.len());
        lint.warn(Rule::Pairs, found, "a channel for each pair; absent ones count as 0");
    }
}
