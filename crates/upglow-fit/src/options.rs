//! The options of fits.

use upglow::{FitRecord, Model};
use upglow_color::{Metric, UnknownChoice, choices};

use crate::preset::Preset;

/// The options of a fit, apart from contract and model. Default: those of [`Preset::default`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FitOptions {
    /// The color difference that is minimized.
    pub metric: Metric,
    /// Greatest |dr/dλ| of a reflectance without fluorescence, 1/nm, 0.0001 to 0.2. A color that such a
    /// reflectance matches gets no dye. `None`: 0.2, the steepest that sums over 5 nm can distinguish
    /// from a step.
    pub slope_max_per_nm: Option<f64>,
    /// Greatest |dr/dλ| of a reflectance under fluorescence, 1/nm, at most `slope_max_per_nm`.
    pub slope_under_dyes_per_nm: Option<f64>,
    /// Whether a color that no material within the limits matches may get a steeper reflectance, up to
    /// 0.2/nm. If not, the limits hold for every color.
    pub relaxed: bool,
    /// How often each node that missed its color tries its neighbors' materials.
    pub sweeps: u32,
    /// How materials are searched for.
    pub method: Method,
}

/// How materials are searched for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Method {
    /// A reflectance if one matches; else the best fit from the materials around a node or from those
    /// of a table, with the least fluorescence that matches the color.
    #[default]
    Search,
    /// Fits from more than a hundred starts for each color, to compare `Search` with.
    Exhaustive,
    /// That of König et al. 2020: from gray, then from the neighbors' materials, with each pair of dyes.
    /// The unknowns of a reflectance are c0, c1, c2; the slope limit is a penalty.
    ///
    /// # Source
    ///
    /// `konig`, sections 4 and 5; `jung` for the sweeps.
    Konig2020,
    /// As `Konig2020`, but the unknowns are shift, width, slope; the slope limit is a bound.
    Konig2020Features,
}

impl Method {
    /// The word for this method in the header of a cube.
    pub(crate) const fn file_name(self) -> &'static str {
        match self {
            Self::Search => "search",
            Self::Exhaustive => "exhaustive",
            Self::Konig2020 => "seed",
            Self::Konig2020Features => "seed-features",
        }
    }

    /// The sweeps that this method needs: two for ours, four in the paper.
    pub const fn default_sweeps(self) -> u32 {
        match self {
            Self::Search | Self::Exhaustive => 2,
            Self::Konig2020 | Self::Konig2020Features => 4,
        }
    }
}

choices!(
    Method,
    "method",
    Search = "search",
    Exhaustive = "exhaustive",
    Konig2020 = "konig2020" | "seed",
    Konig2020Features = "konig2020-features" | "seed-features",
);

impl Default for FitOptions {
    fn default() -> Self {
        Preset::default().options()
    }
}

/// The options that a cube records.
impl TryFrom<&FitRecord> for FitOptions {
    type Error = UnknownChoice;

    fn try_from(record: &FitRecord) -> Result<Self, UnknownChoice> {
        Ok(Self {
            metric: record.metric.parse()?,
            slope_max_per_nm: record.slope_max_per_nm,
            slope_under_dyes_per_nm: record.slope_under_dyes_per_nm,
            relaxed: record.relaxed,
            sweeps: record.sweeps,
            method: record.method.parse()?,
        })
    }
}

/// Why options are rejected.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FitOptionsError {
    /// A slope limit is out of range.
    #[error("slope limit {found}/nm, expected {} to {}/nm", SLOPE_RANGE_PER_NM[0], SLOPE_RANGE_PER_NM[1])]
    Slope {
        /// The limit given, 1/nm.
        found: f64,
    },
    /// The limit under dyes is above that of a reflectance alone.
    #[error("slope limit {found}/nm under dyes, expected at most that without dyes, {alone}/nm")]
    UnderDyes {
        /// The limit under dyes, 1/nm.
        found: f64,
        /// The limit without dyes, 1/nm.
        alone: f64,
    },
    /// A method of König et al. 2020 has limits that it does not know.
    #[error(
        "method {method} with two slope limits or relaxed ones, expected one hard limit for all \
         reflectances, as in the preset konig2020"
    )]
    PaperLimits {
        /// The method.
        method: Method,
    },
    /// A method of König et al. 2020 has a model that it cannot fit.
    #[error("method {method} with the model {model}, expected dyes, analytic or reflectance")]
    PaperModel {
        /// The method.
        method: Method,
        /// Name of the model.
        model: &'static str,
    },
}

/// Below the first every color is nearly gray. Beyond the second, a reflectance goes from 0 to 1 within
/// 5 nm, which is only a step to sums over 5 nm: at 1/nm these find 97.4 % of ACEScg matched instead of
/// 97.3 %, and differ from sums over 1 nm by 0.05 ΔE00 on average.
pub(crate) const SLOPE_RANGE_PER_NM: [f64; 2] = [1e-4, 0.2];

/// Options that are given in place of those of a preset; `None` where the preset's stays.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GivenOptions {
    /// In place of [`FitOptions::metric`].
    pub metric: Option<Metric>,
    /// In place of [`FitOptions::slope_max_per_nm`], which see; the limit under dyes follows as in
    /// [`FitOptions::with_slope_max_per_nm`].
    pub slope_max_per_nm: Option<Option<f64>>,
    /// In place of [`FitOptions::slope_under_dyes_per_nm`].
    pub slope_under_dyes_per_nm: Option<Option<f64>>,
    /// In place of [`FitOptions::relaxed`].
    pub relaxed: Option<bool>,
    /// In place of [`FitOptions::sweeps`]; by default those that the method needs.
    pub sweeps: Option<u32>,
    /// In place of [`FitOptions::method`].
    pub method: Option<Method>,
}

impl FitOptions {
    /// The same with what is given in its place.
    #[must_use]
    pub fn with(self, given: GivenOptions) -> Self {
        let limited = match given.slope_max_per_nm {
            Some(limit) => self.with_slope_max_per_nm(limit),
            None => self,
        };
        let under_dyes = given.slope_under_dyes_per_nm;
        let method = given.method.unwrap_or(self.method);
        Self {
            metric: given.metric.unwrap_or(self.metric),
            slope_under_dyes_per_nm: under_dyes.unwrap_or(limited.slope_under_dyes_per_nm),
            relaxed: given.relaxed.unwrap_or(self.relaxed),
            sweeps: given.sweeps.unwrap_or(method.default_sweeps()),
            method,
            ..limited
        }
    }

    /// The same with another limit for reflectance alone. The limit under dyes becomes the same if both
    /// were one, and else is lowered to it if it is above.
    #[must_use]
    pub fn with_slope_max_per_nm(self, limit: Option<f64>) -> Self {
        let under_dyes = self.slope_under_dyes_per_nm;
        let is_above = match (under_dyes, limit) {
            (Some(under_dyes), Some(limit)) => under_dyes > limit,
            (under_dyes, limit) => under_dyes.is_none() && limit.is_some(),
        };
        let follows = under_dyes == self.slope_max_per_nm || is_above;
        let slope_under_dyes_per_nm = if follows { limit } else { under_dyes };
        Self { slope_max_per_nm: limit, slope_under_dyes_per_nm, ..self }
    }

    /// What a cube of `model` records of these options.
    pub(crate) fn record(&self, model: &Model, evaluations: u64) -> FitRecord {
        FitRecord {
            preset: Preset::of(model, self).map(|preset| preset.to_string()),
            metric: self.metric.to_string(),
            slope_max_per_nm: self.slope_max_per_nm,
            slope_under_dyes_per_nm: self.slope_under_dyes_per_nm,
            relaxed: self.relaxed,
            sweeps: self.sweeps,
            method: self.method.file_name().into(),
            evaluations,
        }
    }

    /// Checks that `model` can be fitted with these options.
    ///
    /// # Errors
    ///
    /// [`FitOptionsError`] if a limit is out of range, or the method has a model or limits that it cannot
    /// fit.
    pub fn check(&self, model: &Model) -> Result<(), FitOptionsError> {
        self.slope_limits_per_nm()?;
        let [alone, found] = [self.slope_max_per_nm, self.slope_under_dyes_per_nm]
            .map(|limit| limit.unwrap_or(SLOPE_RANGE_PER_NM[1]));
        if found > alone {
            return Err(FitOptionsError::UnderDyes { found, alone });
        }
        let method = self.method;
        if matches!(method, Method::Search | Method::Exhaustive) {
            return Ok(());
        }
        if matches!(model, Model::Film(_)) {
            return Err(FitOptionsError::PaperModel { method, model: model.name() });
        }
        if found < alone || self.relaxed {
            return Err(FitOptionsError::PaperLimits { method });
        }
        Ok(())
    }

    /// The slope limit, 1/nm.
    ///
    /// # Errors
    ///
    /// [`FitOptionsError`] if the limit is not in 0.0001 to 0.2.
    pub(crate) fn slope_limits_per_nm(&self) -> Result<(f64, Vec<f64>), FitOptionsError> {
        let [least, most] = SLOPE_RANGE_PER_NM;
        let checked = |limit: Option<f64>| {
            let found = limit.unwrap_or(most);
            if (least..=most).contains(&found) {
                Ok(found)
            } else {
                Err(FitOptionsError::Slope { found })
            }
        };
        let alone = checked(self.slope_max_per_nm)?;
        let under_dyes = checked(self.slope_under_dyes_per_nm)?;
        let mut with_dyes = vec![under_dyes];
        if self.relaxed {
            with_dyes.extend([alone, most].into_iter().filter(|limit| *limit > under_dyes));
            with_dyes.dedup();
        }
        Ok((alone, with_dyes))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_limit_stays_one_and_the_limit_under_dyes_is_the_lower_one() {
        let limits = |preset: Preset, limit| {
            let options = preset.options().with_slope_max_per_nm(limit);
            (options.slope_max_per_nm, options.slope_under_dyes_per_nm)
        };
        assert_eq!(limits(Preset::Konig2020, Some(0.02)), (Some(0.02), Some(0.02)));
        assert_eq!(limits(Preset::Konig2020, None), (None, None));
        assert_eq!(limits(Preset::Natural, Some(0.03)), (Some(0.03), Some(0.02)));
        assert_eq!(limits(Preset::Natural, Some(0.01)), (Some(0.01), Some(0.01)));
        assert_eq!(limits(Preset::Natural, None), (None, Some(0.02)));
        assert_eq!(limits(Preset::Jakob2019, Some(0.01)), (Some(0.01), Some(0.01)));
    }

    #[test]
    fn options_that_cannot_be_fitted_are_refused() {
        let message = |options: FitOptions, preset: Preset| {
            options.check(&preset.model()).unwrap_err().to_string()
        };
        let natural = Preset::Natural.options();
        let steep = FitOptions { slope_under_dyes_per_nm: Some(0.1), ..natural };
        assert_eq!(
            message(steep, Preset::Natural),
            "slope limit 0.1/nm under dyes, expected at most that without dyes, 0.065/nm"
        );
        let unlimited = FitOptions { slope_under_dyes_per_nm: None, ..natural };
        assert!(message(unlimited, Preset::Natural).starts_with("slope limit 0.2/nm under dyes"));
        let flat = FitOptions { slope_under_dyes_per_nm: Some(0.0), ..natural };
        assert_eq!(message(flat, Preset::Natural), "slope limit 0/nm, expected 0.0001 to 0.2/nm");
        let paper = FitOptions { method: Method::Konig2020, ..natural };
        assert_eq!(
            message(paper, Preset::Natural),
            "method konig2020 with the model film, expected dyes, analytic or reflectance"
        );
        assert_eq!(
            message(paper, Preset::Konig2020),
            "method konig2020 with two slope limits or relaxed ones, expected one hard limit for all \
             reflectances, as in the preset konig2020"
        );
        let paper = FitOptions { method: Method::Konig2020, ..Preset::Konig2020.options() };
        assert_eq!(paper.check(&Preset::Konig2020.model()), Ok(()));
    }
}
