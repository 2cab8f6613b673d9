//! The settings of König et al. 2020.
//!
//! Figures, claims and their tests take every setting from here, and none from the defaults of the
//! libraries: a default may change, the paper does not. What the paper leaves open is chosen here, and
//! said to be.

use upglow::{Accounting, AnalyticModel, DyeModel, DyeOptions, DyeSet, Mixing, QuantumYield};
use upglow_color::{Adaptation, Contract, Illuminant, Metric, Observer, RgbSpace};
use upglow_fit::{FitOptions, Method};

/// Greatest |dr/dλ| of a reflectance, 1/nm (section 5).
pub const SLOPE_MAX_PER_NM: f64 = 0.01;

/// Sweeps of the figures that state no other number; the paper calls them iterations (section 5.1).
pub const SWEEPS: u32 = 4;

/// Full widths at half maximum of the analytic absorption and emission, nm. The paper gives no widths and
/// neither do Jung et al.: these are ours.
pub const ANALYTIC_FWHM_NM: [u32; 2] = [50, 45];

/// `ACEScg` under D65 for the CIE 1931 2° observer (section 5). The paper does not say how the white of
/// `ACEScg` becomes that of D65; this is Bradford adaptation.
pub fn contract() -> Contract {
    Contract {
        space: RgbSpace::named("acescg").expect("the space is built in"),
        illuminant: Illuminant::named("D65").expect("the light is built in"),
        observer: Observer::cie_1931_2deg(),
        adaptation: Adaptation::Bradford,
    }
}

/// The eight dyes as thin solutions that give back all absorbed energy (section 4.2).
///
/// Two neighbors are [pooled](Mixing::Pooled) in the paper, which calls the other mixing more accurate.
pub fn dyes(mixing: Mixing) -> DyeModel {
    let set = DyeSet::named("konig8").expect("the set is built in");
    let options = DyeOptions {
        mixing,
        accounting: Accounting::Energy,
        quantum_yield: QuantumYield::Fixed(1.0),
        optical_density: None,
    };
    DyeModel::new(set, options).expect("a thin solution of every set is possible")
}

/// The analytic fluorescence of Jung et al. 2019, which the paper compares its dyes with, for full widths
/// at half maximum of absorption and emission; the usual ones are [`ANALYTIC_FWHM_NM`].
///
/// # Panics
///
/// If a width is not in 15 to 80 nm.
pub fn analytic(fwhm_nm: [u32; 2]) -> AnalyticModel {
    let [absorption, emission] = fwhm_nm.map(f64::from);
    AnalyticModel::new(absorption, emission, Accounting::Energy, 1.0)
        .expect("the widths are in 15 to 80 nm")
}

/// The paper's method with coefficients as the variables, under its limit of slopes.
pub fn options(metric: Metric, sweeps: u32) -> FitOptions {
    FitOptions {
        metric,
        slope_max_per_nm: Some(SLOPE_MAX_PER_NM),
        slope_under_dyes_per_nm: Some(SLOPE_MAX_PER_NM),
        relaxed: false,
        sweeps,
        method: Method::Konig2020,
    }
}
