//! What verification found.

use std::fmt;

use upglow_color::LinearRgb;

/// The work was stopped by its watcher.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("stopped")]
pub struct Stopped;

/// What was found in a cube.
#[derive(Clone, Debug, PartialEq)]
#[must_use]
pub struct VerifyReport {
    /// Nodes checked.
    pub nodes: usize,
    /// Random colors between the nodes checked.
    pub points: usize,
    /// Every law and every report, in a fixed order.
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

/// One law or report.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Check {
    /// A short name that does not change, in words with hyphens.
    pub name: &'static str,
    /// What `value` is, in one line for people.
    pub about: &'static str,
    /// Whether the law holds.
    pub verdict: Verdict,
    /// The worst value found, or the figure reported.
    pub value: f64,
    /// What `value` must not exceed; `None` for reports.
    pub limit: Option<f64>,
    /// Unit of `value` and `limit`; empty for plain numbers.
    pub unit: &'static str,
    /// How many nodes, colors or curves were checked.
    pub checked: usize,
    /// How many of them break the law.
    pub violations: usize,
    /// Where the worst value was found; `None` where nothing was checked, or for a mean or share.
    pub worst: Option<Offender>,
}

/// What came of a check.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(rename_all = "lowercase"))]
pub enum Verdict {
    /// The law holds.
    Holds,
    /// The law is broken.
    Broken,
    /// No law, only a figure.
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

/// Where a value was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Offender {
    /// The node, color or dye.
    pub place: Location,
    /// The wavelength, nm, where the value belongs to one.
    pub wavelength_nm: Option<f64>,
    /// The value.
    pub found: f64,
}

/// What was checked.
#[derive(Clone, Debug, PartialEq)]
pub enum Location {
    /// A node.
    Node {
        /// Blue, green and red index.
        node: [usize; 3],
        /// Its color.
        rgb: LinearRgb,
    },
    /// A color between nodes.
    Point {
        /// The color.
        rgb: LinearRgb,
    },
    /// A dye of the cube's ring.
    Dye {
        /// Its name.
        name: String,
    },
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Node { node: [blue, green, red], rgb: LinearRgb([r, g, b]) } => {
                write!(f, "node [{blue}][{green}][{red}], RGB ({r}, {g}, {b})")
            }
            Self::Point { rgb: LinearRgb([r, g, b]) } => write!(f, "RGB ({r}, {g}, {b})"),
            Self::Dye { name } => write!(f, "dye {name}"),
        }
    }
}

impl fmt::Display for Offender {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} at {}", self.found, self.place)?;
        match self.wavelength_nm {
            Some(nm) => write!(f, ", {nm} nm"),
            None => Ok(()),
        }
    }
}

/// All that any offender has; `null` for what this one has not.
#[cfg(feature = "serde")]
impl serde::Serialize for Offender {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        use serde::ser::SerializeStruct as _;

        let (node, rgb, dye) = match &self.place {
            Location::Node { node, rgb } => (Some(node), Some(rgb.0), None),
            Location::Point { rgb } => (None, Some(rgb.0), None),
            Location::Dye { name } => (None, None, Some(name)),
        };
        let mut offender = serializer.serialize_struct("Offender", 5)?;
        offender.serialize_field("found", &self.found)?;
        offender.serialize_field("wavelength_nm", &self.wavelength_nm)?;
        offender.serialize_field("node", &node)?;
        offender.serialize_field("rgb", &rgb)?;
        offender.serialize_field("dye", &dye)?;
        offender.end()
    }
}
