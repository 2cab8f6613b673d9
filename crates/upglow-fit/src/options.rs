//! What a fit is asked for.

use std::fmt;
use std::str::FromStr;

use upglow_color::Metric;

/// The choices in a fit, apart from contract and model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FitOptions {
    /// The color difference that is minimized. Default: CIEDE2000.
    pub metric: Metric,
    /// Greatest |dr/dλ| of any reflectance, 1/nm; default 0.01. `None`: as steep as sums over 5 nm
    /// can tell from a step, 0.2/nm.
    pub slope_max_per_nm: Option<f64>,
    /// How often each node that missed its color tries its neighbors' materials. Default: 2.
    pub sweeps: u32,
    /// How materials are searched for. Default: our own search.
    pub method: Method,
}

/// How materials are searched for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Method {
    /// Reflectance alone where that is enough; else the best of what starts lead to, the materials
    /// around a node or a table's, with the least fluorescence that shows the color.
    #[default]
    Search,
    /// As `Search`, but following a hundred starts and more to their end: the yardstick for it.
    Exhaustive,
    /// The seed paper's: from gray, then from the neighbors' materials, through all pairs of dyes.
    ///
    /// # Source
    ///
    /// `konig`, sections 4 and 5; `jung` for the sweeps.
    Seed(Parameters),
}

/// What the seed's solver moves for a reflectance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Parameters {
    /// c0, c1, c2; the slope limit is a penalty.
    #[default]
    Coefficients,
    /// Shift, width, slope; the slope limit is a bound.
    Features,
}

impl Method {
    /// The sweeps that this way of searching needs: two for ours, four as the paper has them.
    pub const fn default_sweeps(self) -> u32 {
        match self {
            Self::Search | Self::Exhaustive => 2,
            Self::Seed(_) => 4,
        }
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Search => "search",
            Self::Exhaustive => "exhaustive",
            Self::Seed(Parameters::Coefficients) => "seed",
            Self::Seed(Parameters::Features) => "seed-features",
        })
    }
}

/// A word that names no method.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unknown method {found:?}, expected search, exhaustive, seed or seed-features")]
pub struct UnknownMethod {
    /// The word given.
    pub found: String,
}

impl FromStr for Method {
    type Err = UnknownMethod;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        [
            Self::Search,
            Self::Exhaustive,
            Self::Seed(Parameters::Coefficients),
            Self::Seed(Parameters::Features),
        ]
        .into_iter()
        .find(|method| method.to_string() == name)
        .ok_or_else(|| UnknownMethod { found: name.into() })
    }
}

impl Default for FitOptions {
    fn default() -> Self {
        Self {
            metric: Metric::De2000,
            slope_max_per_nm: Some(0.01),
            sweeps: Method::Search.default_sweeps(),
            method: Method::Search,
        }
    }
}

/// Why a fit cannot start.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FitOptionsError {
    /// The slope limit is out of range.
    #[error("slope limit {found}/nm, expected {} to {}/nm", SLOPE_RANGE_PER_NM[0], SLOPE_RANGE_PER_NM[1])]
    Slope {
        /// The limit given, 1/nm.
        found: f64,
    },
}

/// Below the first every color is nearly gray. Beyond the second, where a reflectance goes from 0 to 1
/// within 5 nm, sums over 5 nm see only a step: at 1/nm they call 97.4 % of ACEScg shown instead of
/// 97.3 %, and are wrong by 0.05 ΔE00 in the mean when summed over 1 nm.
pub(crate) const SLOPE_RANGE_PER_NM: [f64; 2] = [1e-4, 0.2];

impl FitOptions {
    /// The greatest slope that the fit allows itself, 1/nm.
    ///
    /// # Errors
    ///
    /// [`FitOptionsError`] if the limit is not in 0.0001 to 0.2.
    pub(crate) fn slope_limit_per_nm(&self) -> Result<f64, FitOptionsError> {
        let [least, most] = SLOPE_RANGE_PER_NM;
        let found = self.slope_max_per_nm.unwrap_or(most);
        if (least..=most).contains(&found) {
            Ok(found)
        } else {
            Err(FitOptionsError::Slope { found })
        }
    }
}
