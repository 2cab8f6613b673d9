//! From colors to materials: fits one color, builds whole cubes, and verifies them.
//!
//! - one color: [`Fitter`], [`Fit`]
//! - which kinds of material millions of colors need: [`StandingTable`]
//! - the nearest colors that materials show: [`NearestColors`]
//! - one material per texel: [`Polisher`]
//! - a measured re-radiation matrix: [`fit_matrix`]
//! - all materials that may have a color: [`MetamerSearch`]
//! - how many colors look under other lights: [`Relighting`]
//! - a cube: [`build_cube`], [`Preset`], [`CubeSummary`], [`MaterialKind`], [`verify`]
//!
//! # Examples
//!
//! ```
//! use upglow_color::{Contract, LinearRgb};
//! use upglow_fit::{Fitter, Preset};
//!
//! let preset = Preset::Konig2020;
//! let fitter = Fitter::new(&Contract::default(), &preset.model(), preset.options())?;
//! let magenta = fitter.fit(LinearRgb([0.9, 0.0, 0.9]))?;
//! assert!(magenta.fluorescence.dose() > 0.0);
//! let gray = fitter.fit(LinearRgb([0.5, 0.5, 0.5]))?;
//! assert_eq!(gray.fluorescence.dose(), 0.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Out of scope: what a renderer needs at run time (crate `upglow`), file names, printing.

mod coefficients;
mod cube;
mod fit;
mod fit_matrix;
mod fitter;
mod kind;
mod metamers;
mod nearest_colors;
mod options;
mod own_material;
mod polish;
mod preset;
mod problem;
mod progress;
mod relight;
mod seams;
mod search;
mod standing_table;
mod verify;

/// Threads share these.
const _: () = {
    const fn is_shared<T: Send + Sync>() {}
    is_shared::<Fitter>();
    is_shared::<Polisher<'_>>();
    is_shared::<StandingTable>();
    is_shared::<BuildError>();
};

pub use coefficients::{fit_coefficients, round_trip};
pub use cube::{BuildError, CubeSummary, Spread, build_cube};
pub use fit::Fit;
pub use fit_matrix::goal::MatrixDifference;
pub use fit_matrix::{
    MatrixDyes, MatrixFit, MatrixFitError, MatrixFitOptions, MatrixReflectance, fit_matrix,
};
pub use fitter::{ColorError, Fitter};
pub use kind::{BlendKinds, KindCounts, MaterialKind};
pub use metamers::{MetamerError, MetamerLight, MetamerSearch, Metamers, PaintKind};
pub use nearest_colors::{MaterialSet, NearestColor, NearestColors, ReachView};
pub use options::{FitOptions, FitOptionsError, GivenOptions, Method};
pub use own_material::{OwnMaterial, OwnMaterialError};
pub use polish::Polisher;
pub use preset::Preset;
pub use progress::{Progress, Unwatched, Watch};
pub use relight::{Appearance, ColoredLightError, Relighting, SeenBy, View};
pub use seams::{Seam, seams};
pub use standing_table::{Estimate, StandingTable};
pub use verify::{
    Check, Offender, Stopped, Verdict, VerifyOptions, VerifyReport, random_rgb, verify,
};
