//! The result of verification.

use std::fmt;

use upglow_color::LinearRgb;

/// The watcher stopped the work.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("stopped")]
pub struct Stopped;

/// The result of verifying a cube.
#[derive(Clone, Debug, PartialEq)]
#[must_use]
pub struct VerifyReport {
    /// Nodes checked.
    pub nodes: usize,
    /// Random colors checked.
    pub points: usize,
    /// All checks, in a fixed order.
    pub checks: Vec<Check>,
}

impl VerifyReport {
    /// Whether no law is broken.
    pub fn holds(&self) -> bool {
        self.broken().next().is_none()
    }

    /// The laws that are broken.
    pub fn broken(&self) -> impl Iterator<Item = &Check> {
        self.checks.iter().filter(|check| check.verdict == Verdict::Broken)
    }

    /// The check of this name.
    pub fn check(&self, name: &str) -> Option<&Check> {
        self.checks.iter().find(|check| check.name == name)
    }
}

/// The result for one law, or one reported number.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Check {
    /// A short name, in words with hyphens; it will not change.
    pub name: &'static str,
    /// What `value` is, in one line.
    pub about: &'static str,
    /// The verdict.
    pub verdict: Verdict,
    /// The worst value found, or the number reported.
    pub value: f64,
    /// What `value` must not exceed; `None` if it is only reported.
    pub limit: Option<f64>,
    /// Unit of `value` and `limit`; empty if dimensionless.
    pub unit: &'static str,
    /// How many nodes, colors or curves were checked.
    pub checked: usize,
    /// How many of these break the law.
    pub violations: usize,
    /// Where the worst value was found; `None` if nothing was checked, and for means and shares.
    pub worst: Option<Offender>,
}

/// The outcome of a check.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(rename_all = "lowercase"))]
pub enum Verdict {
    /// The law holds.
    Holds,
    /// The law is broken.
    Broken,
    /// There is no law; the value is only reported.
    Reported,
    /// The law does not apply to this cube or interpolation, and was not checked.
    #[cfg_attr(feature = "serde", serde(rename = "not applicable"))]
    NotApplicable,
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Holds => "holds",
            Self::Broken => "broken",
            Self::Reported => "reported",
            Self::NotApplicable => "not applicable",
        })
    }
}

/// A value, and the node, color or dye it was found for.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Offender {
    /// The value.
    pub found: f64,
    /// The wavelength, nm, for values of one wavelength.
    pub wavelength_nm: Option<f64>,
    /// Blue, green and red index, for a node.
    pub node: Option<[usize; 3]>,
    /// The color, for nodes and the colors between them.
    pub rgb: Option<LinearRgb>,
    /// The name, for a dye of the cube.
    pub dye: Option<String>,
}

impl fmt::Display for Offender {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let node = self.node.map(|[blue, green, red]| format!("node [{blue}][{green}][{red}]"));
        let rgb = self.rgb.map(|LinearRgb([r, g, b])| format!("RGB ({r}, {g}, {b})"));
        let dye = self.dye.as_ref().map(|name| format!("dye {name}"));
        let wavelength = self.wavelength_nm.map(|nm| format!("{nm} nm"));
        let parts: Vec<String> = [node, rgb, dye, wavelength].into_iter().flatten().collect();
        write!(f, "{} at {}", self.found, parts.join(", "))
    }
}
