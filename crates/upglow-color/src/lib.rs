//! Colorimetry: spectra, RGB, color differences, and which colors materials can reach.
//!
//! A [`Contract`] defines which color an RGB triple is: RGB space, illuminant, observer and chromatic
//! adaptation. A contract on a wavelength [`Grid`] is a [`Colorimetry`]: white, matrices and
//! integration weights, computed once.
//!
//! - spectra: [`Grid`], [`Spectrum`], [`Observer`], [`Illuminant`]
//! - color: [`Xyz`], [`LinearRgb`], [`Lab`], [`RgbSpace`], [`Adaptation`], [`Metric`]
//! - limits: [`ColorSolid`], the colors that materials reach; [`ColorSolids::standing`], which kind of
//!   material a color needs, and the nearest colors within reach
//! - materials as 4×4 matrices, for engines without spectra: [`ReducedBasis`], [`ReducedMatrix`]
//! - measured matrices of fluorescent samples: [`DonaldsonMatrix`], read from text
//! - measured tables: [`MeasuredDye`] and the named sets of dyes
//!
//! Wavelengths are nm. Tristimulus values are relative: Y = 1 is the perfect diffuser.
//!
//! # Examples
//!
//! ```
//! use upglow_color::{ColorSolid, Contract, Grid, LinearRgb};
//!
//! let colorimetry = Contract::default().on(Grid::FIT);
//! let magenta = colorimetry.xyz_from_rgb(LinearRgb([0.9, 0.0, 0.9]));
//! assert!(!ColorSolid::reflectance(&colorimetry).contains(magenta));
//! assert!(ColorSolid::fluorescence(&colorimetry).contains(magenta));
//! ```
//!
//! Out of scope: materials (crate `upglow`) and fitting (crate `upglow-fit`).

mod adaptation;
mod choice;
mod ciede2000;
mod color_solid;
mod colorimetry;
mod contract;
mod donaldson_matrix;
mod dyes;
mod grid;
mod illuminant;
mod jet;
mod lab;
mod light_bands;
mod matrix;
mod metric;
mod names;
mod observer;
mod reduced_basis;
mod reduced_matrix;
mod rgb_space;
#[doc(hidden)]
pub mod rounding;
mod samples;
mod screen;
mod spectrum;
mod srgb_curve;
mod standing;
mod tables;
mod values;
mod whiteness;

/// Threads share these.
const _: () = {
    const fn is_shared<T: Send + Sync>() {}
    is_shared::<Contract>();
    is_shared::<Colorimetry>();
    is_shared::<ColorSolids>();
};

#[cfg(feature = "serde")]
#[doc(hidden)]
pub use serde;

pub use adaptation::Adaptation;
pub use choice::{Choice, UnknownChoice};
pub use ciede2000::{ciede2000, ciede2000_residuals, difference_by_xyz};
pub use color_solid::{ColorSolid, Nearest};
pub use colorimetry::Colorimetry;
pub use contract::{Contract, ContractError, SeenUnder};
pub use donaldson_matrix::{
    BfcError, BispectralUnit, Diagonal, DonaldsonError, DonaldsonMatrix, MatrixCsvError, MatrixSums,
};
pub use dyes::MeasuredDye;
pub use grid::{Grid, GridError};
pub use illuminant::{Illuminant, IlluminantError, MissingUltraviolet};
pub use lab::{Lab, lab_from_xyz, xyz_from_lab};
pub use matrix::Matrix3;
pub use metric::{Goal, Metric};
pub use names::{NameError, is_plain};
pub use observer::{Observer, ObserverError};
pub use reduced_basis::{EngineSpace, ReducedBasis, ReducedBasisError};
pub use reduced_matrix::{ReducedMatrix, Reduction, Xyzu};
pub use rgb_space::{RgbSpace, RgbSpaceError};
pub use samples::{Ends, SampleRules, SamplesError};
pub use screen::{Screen, Shown};
pub use spectrum::{Spectrum, SpectrumCsvError, SpectrumError, read_columns};
pub use srgb_curve::{srgb_decoded, srgb_encoded};
pub use standing::{ColorSolids, Standing, StandingKind};
pub use values::{LinearRgb, Xyz};
pub use whiteness::{Whiteness, WhitenessScale};
