//! Interpolation between two reflectances.

use upglow::{FeatureError, Features, Sigmoid};
use upglow_color::{Grid, choices};

/// What is interpolated linearly between two reflectances.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Mixing {
    /// The three coefficients of the polynomial.
    Coefficients,
    /// The reflectances themselves.
    Spectra,
    /// Shift, width and slope.
    Features,
}

choices!(
    Mixing,
    "mixing",
    Coefficients = "coefficients",
    Spectra = "spectra",
    Features = "features",
);

impl Mixing {
    /// The interpolated reflectance on [`Grid::FINE`]; `weight`, 0..=1, is that of the second end.
    ///
    /// # Errors
    ///
    /// [`FeatureError`] if the features of an end, or interpolated ones, describe no reflectance:
    /// between slopes of opposite sign the slope passes zero.
    pub fn sample(self, ends: [Features; 2], weight: f64) -> Result<Vec<f64>, FeatureError> {
        let mix = |a: f64, b: f64| (1.0 - weight) * a + weight * b;
        let [from, to] = [ends[0].to_sigmoid()?, ends[1].to_sigmoid()?];
        let on_grid = |at: &dyn Fn(f64) -> f64| Grid::FINE.wavelengths_nm().map(at).collect();
        Ok(match self {
            Self::Spectra => on_grid(&|nm| mix(from.at(nm), to.at(nm))),
            Self::Coefficients => {
                let Sigmoid { c0, c1, c2 } = from;
                let mean = Sigmoid { c0: mix(c0, to.c0), c1: mix(c1, to.c1), c2: mix(c2, to.c2) };
                on_grid(&|nm| mean.at(nm))
            }
            Self::Features => {
                let [from, to] = ends;
                let mean = Features {
                    shift_nm: mix(from.shift_nm, to.shift_nm),
                    width_nm: mix(from.width_nm, to.width_nm),
                    slope_per_nm: mix(from.slope_per_nm, to.slope_per_nm),
                };
                let mean = mean.to_sigmoid()?;
                on_grid(&|nm| mean.at(nm))
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ENDS: [Features; 2] = [
        Features { shift_nm: 450.0, width_nm: 45.0, slope_per_nm: -0.009 },
        Features { shift_nm: 620.0, width_nm: 60.0, slope_per_nm: -0.008 },
    ];

    #[test]
    fn all_kinds_agree_at_both_ends() {
        for (weight, end) in [(0.0, ENDS[0]), (1.0, ENDS[1])] {
            let expected = end.to_sigmoid().unwrap();
            for mixing in [Mixing::Coefficients, Mixing::Spectra, Mixing::Features] {
                let found = mixing.sample(ENDS, weight).unwrap();
                for (nm, value) in Grid::FINE.wavelengths_nm().zip(found) {
                    assert!((value - expected.at(nm)).abs() < 1e-12, "{mixing:?} at {nm} nm");
                }
            }
        }
    }

    #[test]
    fn features_of_opposite_slopes_have_no_mean() {
        let [from, to] = ENDS;
        let opposite = Features { slope_per_nm: -from.slope_per_nm, ..to };
        assert!(Mixing::Features.sample([from, opposite], 0.5).is_err());
        assert!(Mixing::Spectra.sample([from, opposite], 0.5).is_ok());
    }
}
