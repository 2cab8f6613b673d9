//! From colors to materials: fits one color, builds whole cubes, verifies what was built.
mod build;
mod fitter;
mod options;
mod progress;
mod standing;
mod summary;
mod verify;

pub use build::{BuildError, build_cube};
pub use fitter::{ColorError, Fit, Fitter};
pub use options::{FitOptions, FitOptionsError};
pub use progress::{Progress, Unwatched, Watch};
pub use standing::Standing;
pub use summary::CubeSummary;
pub use verify::{Check, Offender, Place, Stopped, Verdict, VerifyOptions, VerifyReport, verify};
