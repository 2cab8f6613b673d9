//! Presets: models and options with one name.

use upglow::{
    Accounting, AnalyticModel, DyeModel, DyeOptions, DyeSet, FilmModel, Model, QuantumYield,
};
use upglow_color::{Metric, choices};

use crate::options::{FitOptions, Method};

/// A model with the options of its fit, by one word.
///
/// All search with [`Method::Search`] for the least CIEDE2000.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Preset {
    /// Films of any two dyes, which conserve photons, over reflectances no steeper than those of
    /// measured surfaces; steeper ones only where nothing else matches the color.
    ///
    /// # Source
    ///
    /// The limits are measured. The sigmoids that match the 99 object colors of CIE 224:2017 have slopes
    /// to 0.0175/nm: under dyes, 0.02. Those that match the most saturated surfaces ever measured, the
    /// border of Pointer's gamut, have slopes to 0.05/nm, and those of sRGB's red and cyan 0.063/nm:
    /// alone, 0.065, so that no color of either has a dye.
    #[default]
    Natural,
    /// The paper's model with our search: pooled neighbors in a ring of eight thin dyes, which give back
    /// all absorbed energy; no slope above 0.01/nm.
    ///
    /// # Source
    ///
    /// `konig`, sections 4.2 and 5.
    Konig2020,
    /// Absorption and emission by formula, no slope above 0.01/nm.
    ///
    /// # Source
    ///
    /// `jung`; the widths of the curves and the limit are not published there.
    Jung2019,
    /// Reflectance alone, as steep as it may be.
    ///
    /// # Source
    ///
    /// `jakob`.
    Jakob2019,
}

choices!(
    Preset,
    "preset",
    Natural = "natural",
    Konig2020 = "konig2020",
    Jung2019 = "jung2019",
    Jakob2019 = "jakob2019",
);

/// The dyes of [`Preset::Natural`].
const NATURAL_DYES: &str = "wide8";

impl Preset {
    /// What fluoresces, and by what rules.
    pub fn model(self) -> Model {
        let set = |name| DyeSet::named(name).expect("the set is built in");
        match self {
            Self::Natural => {
                let quantum_yield = QuantumYield::Fixed(1.0);
                FilmModel::new(set(NATURAL_DYES), Accounting::Photon, quantum_yield)
                    .map(Model::Film)
                    .expect("the yield is in range")
            }
            Self::Konig2020 => DyeModel::new(set("konig8"), DyeOptions::default())
                .map(Model::Dyes)
                .expect("a thin solution of every set is possible"),
            Self::Jung2019 => Model::Analytic(AnalyticModel::default()),
            Self::Jakob2019 => Model::Reflectance,
        }
    }

    /// How materials are fitted.
    pub fn options(self) -> FitOptions {
        let (slope_max_per_nm, slope_under_dyes_per_nm, relaxed) = match self {
            Self::Natural => (Some(0.065), Some(0.02), true),
            Self::Konig2020 | Self::Jung2019 => (Some(0.01), Some(0.01), false),
            Self::Jakob2019 => (None, None, false),
        };
        let method = Method::Search;
        FitOptions {
            metric: Metric::De2000,
            slope_max_per_nm,
            slope_under_dyes_per_nm,
            relaxed,
            sweeps: method.default_sweeps(),
            method,
        }
    }

    /// The preset that has this model and these options, if one does.
    pub fn of(model: &Model, options: &FitOptions) -> Option<Self> {
        use upglow_color::Choice as _;
        let is_same = |preset: &Self| preset.options() == *options && preset.model() == *model;
        Self::ALL.iter().copied().find(is_same)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use upglow_color::Choice as _;

    #[test]
    fn a_preset_is_known_by_its_model_and_options() {
        for &preset in Preset::ALL {
            let (model, options) = (preset.model(), preset.options());
            assert_eq!(Preset::of(&model, &options), Some(preset));
            let other = FitOptions { sweeps: options.sweeps + 1, ..options };
            assert_eq!(Preset::of(&model, &other), None);
        }
        let options = Preset::Natural.options();
        assert_eq!(Preset::of(&Model::Reflectance, &options), None);
    }

    #[test]
    fn every_preset_can_be_fitted() {
        for &preset in Preset::ALL {
            assert_eq!(preset.options().check(&preset.model()), Ok(()), "{preset}");
        }
    }
}
