//! The findings of the linter: broken rules, and their severity.

use std::fmt;

use upglow_color::choices;

/// The severity of a finding.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Readers may interpret the file differently, or some may refuse it.
    Warning,
    /// The file breaks the layout, or its values are unphysical.
    Error,
}

choices!(Severity, "severity", Warning = "warning", Error = "error");

/// The rules that are checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Rule {
    /// The file has spectral channels.
    Spectral,
    /// Names of spectral channels have numbers with a comma and a unit.
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
    /// Files with `S0.` channels state `emissiveUnits`.
    EmissiveUnits,
    /// `S1.` to `S3.` have the wavelengths of `S0.`.
    Polarization,
    /// Wavelengths of re-radiation are among those of `T.λ`.
    Band,
    /// Each pair of bands, the outgoing one longer, has a channel.
    Pairs,
    /// No two channels have the same wavelength in different spellings.
    Duplicate,
    /// All names use one unit.
    Units,
    /// The file states the unit of re-radiation.
    BispectralUnit,
    /// A file that states the compact form has its attributes and channels.
    Compact,
    /// Every sample is finite.
    Finite,
    /// Reflectance, re-radiation and `S0.` are not negative.
    Negative,
    /// No more light leaves than arrives, at each incident wavelength.
    Energy,
}

impl Rule {
    /// The severity of breaking the rule.
    fn severity(self) -> Severity {
        match self {
            Self::Preview
            | Self::EmissiveUnits
            | Self::Pairs
            | Self::Units
            | Self::BispectralUnit => Severity::Warning,
            _ => Severity::Error,
        }
    }
}

/// A broken rule.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Finding {
    /// The rule.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) rule: Rule,
    /// The severity of breaking it.
    pub severity: Severity,
    /// The content of the file that breaks the rule.
    pub found: String,
    /// The content that would be valid.
    pub expected: String,
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}, expected {}", self.severity, self.found, self.expected)
    }
}

/// Checks whether a file is a well-formed spectral or bispectral OpenEXR file.
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
    /// Whether the file states upglow's compact form.
    #[cfg_attr(feature = "serde", serde(rename = "compact"))]
    pub is_compact: bool,
    /// The broken rules.
    pub findings: Vec<Finding>,
}

impl Lint {
    /// Whether there are no findings, or only warnings.
    #[must_use]
    pub fn is_well_formed(&self) -> bool {
        self.findings.iter().all(|finding| finding.severity < Severity::Error)
    }

    pub(super) fn add(
        &mut self,
        rule: Rule,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) {
        let [found, expected] = [found.into(), expected.into()].map(escaped);
        self.findings.push(Finding { rule, severity: rule.severity(), found, expected });
    }
}

/// Escapes control characters, so that the text is a single line.
fn escaped(text: String) -> String {
    if text.contains(char::is_control) { text.escape_debug().to_string() } else { text }
}
