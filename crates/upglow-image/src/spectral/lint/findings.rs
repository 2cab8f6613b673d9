//! What a linter finds: rules that are broken, and how bad that is.

use std::fmt;

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
pub(crate) enum Rule {
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

impl Rule {
    /// How bad it is to break the rule.
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

/// One thing that is wrong with a file.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Finding {
    /// The rule that is broken.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) rule: Rule,
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

    /// The same for what an error says.
    pub(super) fn add_error(&mut self, rule: Rule, error: impl fmt::Display) {
        let message = error.to_string();
        let (found, expected) = message.split_once(", expected ").unwrap_or((&message, ""));
        self.add(rule, found, expected);
    }
}

/// One line: control characters in names stand for themselves no more.
fn escaped(text: String) -> String {
    if text.contains(char::is_control) { text.escape_debug().to_string() } else { text }
}
