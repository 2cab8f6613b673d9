//! The way from colors to materials: fits one color, builds whole cubes, verifies what was built.
//!
//! - one color: [`Fitter`], [`Fit`]
//! - what it takes to show millions of colors: [`StandingTable`]
//! - a cube: [`build_cube`], [`CubeSummary`], [`verify`]
//! - underneath: [`solve`], a bounded Levenberg-Marquardt solver for [`Residuals`]
//!
//! # Examples
//!
//! ```
//! use upglow::{DyeModel, DyeOptions, DyeSet, Model};
//! use upglow_color::{Contract, LinearRgb};
//! use upglow_fit::{FitOptions, Fitter};
//!
//! let model = Model::Dyes(DyeModel::new(DyeSet::named("seed8")?, DyeOptions::default())?);
//! let fitter = Fitter::new(&Contract::default(), &model, FitOptions::default())?;
//! let magenta = fitter.fit(LinearRgb([0.9, 0.0, 0.9]))?;
//! assert!(magenta.fluorescence.concentration() > 0.0);
//! let gray = fitter.fit(LinearRgb([0.5, 0.5, 0.5]))?;
//! assert_eq!(gray.fluorescence.concentration(), 0.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Out of scope: what a renderer needs at run time (crate `upglow`), files' names, printing.

mod build;
mod coefficients;
mod fitter;
mod job;
mod konig2020;
mod lattice;
mod least;
mod options;
mod parabola;
mod polish;
mod problem;
mod progress;
mod rounding;
mod search;
mod solver;
mod standing_table;
mod starts;
mod summary;
mod sums;
mod verify;

pub use build::{BuildError, build_cube};
pub use coefficients::{fit_coefficients, round_trip};
pub use fitter::{ColorError, Fit, Fitter};
pub use options::{FitOptions, FitOptionsError, Method};
pub use polish::Polisher;
pub use progress::{Progress, Unwatched, Watch};
pub use solver::{Jacobian, Residuals, SolverOptions, Stop, Summary, jacobian_error, solve};
pub use standing_table::{Estimate, StandingTable};
pub use summary::{CubeSummary, Spread};
pub use verify::{Check, Offender, Place, Stopped, Verdict, VerifyOptions, VerifyReport, verify};
