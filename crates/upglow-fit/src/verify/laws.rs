//! What must hold, always: one rule for each law that is checked color by color.

use upglow::{Cube, Interpolation};
use upglow_color::Adaptation;

use super::VerifyOptions;
use super::finding::Outcome;
use super::{Check, Verdict};
use crate::cube::CubeSummary;

/// A law that each color keeps or breaks by itself. A new one is a variant, an entry in
/// [`LAWS`], its [`Rule`] and the place that sees its values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Law {
    Energy,
    Bounds,
    Slope,
    GrayFlat,
    GrayPassive,
    GrayValue,
    WhiteBlack,
    Stored,
    Exact,
    Library,
}

/// Every law, in the order of the report.
pub(super) const LAWS: [Law; 10] = [
    Law::Energy,
    Law::Bounds,
    Law::Slope,
    Law::GrayFlat,
    Law::GrayPassive,
    Law::GrayValue,
    Law::WhiteBlack,
    Law::Stored,
    Law::Exact,
    Law::Library,
];

/// Rounding of a sum of four weighted shares, whose weights add up to 1 but for rounding.
const ROUNDING: f64 = 1e-12;

/// Rounding of a slope from coefficients in double precision, relative: a parabola of terms near
/// 1e7. Nothing is left for storage in single precision, which a fit must allow for itself.
const SLOPE_ROUNDING: f64 = 1e-9;

/// What storage in single precision does to a gray, with room: its level is off by 6e-8 of itself,
/// which moves a reflectance by 1.2e-8 at most. Larger would let a tint pass that 16 bits show;
/// smaller leaves no room for fits that approach a gray by steps.
const GRAY_TOLERANCE: f64 = 1e-6;

/// Half the step of single precision below 1: what it calls 1.
const WHITE_TOLERANCE: f64 = 6e-8;

/// The stored difference is rounded to single precision: off by 7.6e-6 at most for the greatest,
/// which stay below 256. Larger would let differences pass that were computed before their
/// material was rounded.
const STORED_TOLERANCE: f64 = 1e-5;

/// Rounding of sums of products in another order than the library's.
const LIBRARY_TOLERANCE: f64 = 1e-12;

/// A law for one cube and interpolation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rule {
    name: &'static str,
    about: &'static str,
    unit: &'static str,
    /// What values must not exceed; `None`: they are reported only.
    limit: Option<f64>,
    /// By how much rounding may exceed the limit.
    tolerance: f64,
    /// Whether the law says anything here.
    pub(super) applies: bool,
}

impl Law {
    pub(super) fn rule(self, cube: &Cube, options: &VerifyOptions) -> Rule {
        let rule = |name, about, unit, limit: f64, tolerance| Rule {
            name,
            about,
            unit,
            limit: Some(limit),
            tolerance,
            applies: true,
        };
        let gray = |name, about, limit| Rule {
            applies: cube.contract().adaptation == Adaptation::Bradford,
            ..rule(name, about, "", limit, 0.0)
        };
        match self {
            Self::Energy => rule(
                "energy",
                "greatest share of incident light that comes back",
                "",
                1.0,
                ROUNDING,
            ),
            Self::Bounds => {
                let about = "how far a reflected or re-radiated share lies outside 0 to 1";
                rule("bounds", about, "", 0.0, ROUNDING)
            }
            Self::Slope => {
                let limit = cube.fit().slope_max_per_nm;
                let about = "steepest reflectance";
                let tolerance = limit.unwrap_or(0.0) * SLOPE_ROUNDING;
                Rule { limit, ..rule("slope", about, "1/nm", 0.0, tolerance) }
            }
            Self::GrayFlat => {
                gray("gray-flat", "variation of a gray's reflectance", GRAY_TOLERANCE)
            }
            Self::GrayPassive => gray("gray-passive", "concentration of dyes in a gray", 0.0),
            Self::GrayValue => {
                gray("gray-value", "a gray's reflectance against its value", GRAY_TOLERANCE)
            }
            Self::WhiteBlack => {
                let about = "white's reflectance against 1, black's against 0";
                gray("white-black", about, WHITE_TOLERANCE)
            }
            Self::Stored => {
                let about = "stored CIEDE2000 of a node against the recomputed one";
                rule("stored-difference", about, "CIEDE2000", STORED_TOLERANCE, 0.0)
            }
            Self::Exact => Rule {
                applies: options.interpolation == Interpolation::Blend,
                ..rule(
                    "exact",
                    "colors between exact nodes against their targets",
                    "CIEDE2000",
                    CubeSummary::EXACT_DE2000,
                    0.0,
                )
            },
            Self::Library => {
                let about = "these sums against the run-time library's functions";
                rule("library", about, "", LIBRARY_TOLERANCE, 0.0)
            }
        }
    }
}

impl Rule {
    /// The greatest value that breaks nothing.
    pub(super) fn most(&self) -> f64 {
        self.limit.map_or(f64::INFINITY, |limit| limit + self.tolerance)
    }

    /// The report of what was found under this rule.
    pub(super) fn check(&self, found: Outcome, cube: &Cube) -> Check {
        Check {
            name: self.name,
            about: self.about,
            verdict: verdict(self.limit, found.checked, found.violations),
            value: found.worst.map_or(0.0, |worst| worst.value),
            limit: self.limit,
            unit: self.unit,
            checked: found.checked,
            violations: found.violations,
            worst: found.worst.map(|worst| worst.offender(cube)),
        }
    }
}

/// What a law's counts say.
pub(super) fn verdict(limit: Option<f64>, checked: usize, violations: usize) -> Verdict {
    match limit {
        _ if checked == 0 => Verdict::NotApplicable,
        None => Verdict::Reported,
        Some(_) if violations > 0 => Verdict::Broken,
        Some(_) => Verdict::Holds,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn laws_stand_in_their_own_order() {
        for (i, law) in LAWS.into_iter().enumerate() {
            assert_eq!(law as usize, i, "{law:?}");
        }
    }
}
