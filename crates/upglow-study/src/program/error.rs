//! Why a study cannot be made.

use upglow::{DyeSetError, ModelError};
use upglow_fit::BuildError;

/// Why there is no figure or claim.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub(crate) enum StudyError {
    /// A cube was not built.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// The set of dyes is not there.
    #[error(transparent)]
    Dyes(#[from] DyeSetError),
    /// The model cannot be made.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// There is no figure of this number.
    #[error("figure {found}, expected 1 to {last}")]
    UnknownFigure {
        /// The number given.
        found: u32,
        /// The last figure's number.
        last: usize,
    },
}
