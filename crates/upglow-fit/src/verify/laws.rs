//! The laws that are checked color by color.

use upglow::{Cube, Interpolation, Node};
use upglow_color::Adaptation;

use super::VerifyOptions;
use super::finding::Outcome;
use super::{Check, Verdict};
use crate::cube::CubeSummary;
use crate::options::SLOPE_RANGE_PER_NM;

/// A law about single colors. A new one is a variant, an entry in [`LAWS`], its texts, its [`Rule`],
/// and a call of `Inspector::see` with its values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Law {
    Energy,
    Bounds,
    Slope,
    SlopeUnderDyes,
    GrayFlat,
    GrayPassive,
    GrayValue,
    WhiteBlack,
    Stored,
    Exact,
    Library,
}

/// Every law, in the order of the report.
pub(super) const LAWS: [Law; 11] = [
    Law::Energy,
    Law::Bounds,
    Law::Slope,
    Law::SlopeUnderDyes,
    Law::GrayFlat,
    Law::GrayPassive,
    Law::GrayValue,
    Law::WhiteBlack,
    Law::Stored,
    Law::Exact,
    Law::Library,
];

/// Rounding of a sum of four weighted shares, whose weights add up to 1 within rounding.
const ROUNDING: f64 = 1e-12;

/// Rounding of a slope from coefficients in double precision, relative: a parabola of terms near
/// 1e7. Storage in single precision gets no tolerance: fits must allow for it.
const SLOPE_ROUNDING: f64 = 1e-9;

/// Storage in single precision changes the level of a gray by 6e-8 of itself, and its reflectance by
/// 1.2e-8 at most. Larger would accept a tint that 16 bits resolve; smaller leaves no room for fits
/// that approach a gray iteratively.
const GRAY_TOLERANCE: f64 = 1e-6;

/// Half the step of single precision below 1: nearer numbers are rounded to 1.
const WHITE_TOLERANCE: f64 = 6e-8;

/// Rounding of the stored difference to single precision: 7.6e-6 at most, as differences are below
/// 256. Larger would accept differences that were computed before the material was rounded.
const STORED_TOLERANCE: f64 = 1e-5;

/// Rounding of sums of products in another order than the library's.
const LIBRARY_TOLERANCE: f64 = 1e-12;

/// A law for one cube and interpolation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rule {
    name: &'static str,
    about: &'static str,
    unit: &'static str,
    /// What values must not exceed; `None` if they are only reported.
    limit: Option<f64>,
    /// By how much rounding may exceed the limit.
    tolerance: f64,
    /// Whether the law applies to this cube and interpolation.
    pub(super) applies: bool,
}

impl Law {
    pub(super) fn rule(self, cube: &Cube, options: &VerifyOptions) -> Rule {
        let [name, about, unit] = self.texts();
        let fixed = |limit, tolerance| (Some(limit), tolerance, true);
        // A cube of one material, such as that of a measured matrix, has no grays of its own.
        let [first, .., last] = cube.nodes() else {
            unreachable!("a cube has eight nodes or more")
        };
        let has_grays = cube.contract().adaptation == Adaptation::Bradford
            && Node { de2000: last.de2000, ..*first } != *last;
        let gray = |limit| (Some(limit), 0.0, has_grays);
        let slope = |limit: Option<f64>| (limit, limit.unwrap_or(0.0) * SLOPE_ROUNDING, true);
        let (limit, tolerance, applies) = match self {
            Self::Energy => fixed(1.0, ROUNDING),
            Self::Bounds => fixed(0.0, ROUNDING),
            Self::Slope if cube.fit().relaxed => slope(Some(SLOPE_RANGE_PER_NM[1])),
            Self::Slope => slope(cube.fit().slope_max_per_nm),
            Self::SlopeUnderDyes => {
                let (limit, tolerance, _) = slope(cube.fit().slope_under_dyes_per_nm);
                (limit, tolerance, !cube.fit().relaxed)
            }
            Self::GrayFlat | Self::GrayValue => gray(GRAY_TOLERANCE),
            Self::GrayPassive => gray(0.0),
            Self::WhiteBlack => gray(WHITE_TOLERANCE),
            Self::Stored => fixed(STORED_TOLERANCE, 0.0),
            Self::Exact => {
                let is_blend = options.interpolation == Interpolation::Blend;
                (Some(CubeSummary::EXACT_DE2000), 0.0, is_blend)
            }
            Self::Library => fixed(LIBRARY_TOLERANCE, 0.0),
        };
        Rule { name, about, unit, limit, tolerance, applies }
    }

    /// Name, description and unit, as reports state them.
    fn texts(self) -> [&'static str; 3] {
        match self {
            Self::Energy => ["energy", "greatest share of incident light that comes back", ""],
            Self::Bounds => {
                ["bounds", "how far a reflected or re-radiated share lies outside 0 to 1", ""]
            }
            Self::Slope => ["slope", "steepest reflectance", "1/nm"],
            Self::SlopeUnderDyes => {
                ["slope-under-dyes", "steepest reflectance of a fluorescent node", "1/nm"]
            }
            Self::GrayFlat => ["gray-flat", "variation of a gray's reflectance", ""],
            Self::GrayPassive => {
                ["gray-passive", "concentration or optical density of dyes in a gray", ""]
            }
            Self::GrayValue => ["gray-value", "a gray's reflectance against its value", ""],
            Self::WhiteBlack => {
                ["white-black", "white's reflectance against 1, black's against 0", ""]
            }
            Self::Stored => {
                let about = "stored CIEDE2000 of a node against the recomputed one";
                ["stored-difference", about, "CIEDE2000"]
            }
            Self::Exact => {
                ["exact", "colors between exact nodes against their targets", "CIEDE2000"]
            }
            Self::Library => ["library", "these sums against the run-time library's functions", ""],
        }
    }
}

impl Rule {
    /// The greatest value that does not break the law.
    pub(super) fn most(&self) -> f64 {
        self.limit.map_or(f64::INFINITY, |limit| limit + self.tolerance)
    }

    /// The report of an outcome.
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

/// The verdict from the counts of a law.
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
    fn laws_are_listed_in_the_order_of_their_variants() {
        for (i, law) in LAWS.into_iter().enumerate() {
            assert_eq!(law as usize, i, "{law:?}");
        }
    }
}
