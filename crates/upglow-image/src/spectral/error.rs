//! Errors of files of spectra and materials.

use upglow::NodeError;
use upglow_color::{BispectralUnit, DonaldsonError};

use super::channel::BISPECTRAL_UNIT;
use crate::exr::error::ExrError;

/// Why a file does not contain, or cannot contain, spectra or materials.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FormError {
    /// The file cannot be read as OpenEXR, or has not the channels of its form.
    #[error(transparent)]
    Exr(#[from] ExrError),
    /// The file has no spectral channel.
    #[error("no spectral channel, expected names as T.550,000000nm or S0.550,000000nm")]
    NotSpectral,
    /// A texel's numbers are not a valid material of the model.
    #[error("texel {x},{y}")]
    Material {
        /// Column, from 0 at the left.
        x: usize,
        /// Row, from 0 at the top.
        y: usize,
        /// Why it is invalid.
        source: NodeError,
    },
    /// The dyes do not fit the compact form.
    #[error("{found}, expected {expected}")]
    Dyes {
        /// Their number, or a name that two dyes have.
        found: String,
        /// What would fit.
        expected: String,
    },
    /// An attribute of the form is absent or invalid.
    #[error("attribute {name} is {found}, expected {expected}")]
    Attribute {
        /// The attribute.
        name: String,
        /// Its value, or "absent".
        found: String,
        /// The values that are valid.
        expected: String,
    },
    /// The file has no channel of re-radiation.
    #[error("no channel of re-radiation, expected names as T.400,000000nm.550,000000nm")]
    NotBispectral,
    /// The file does not state the unit of re-radiation, and none was given.
    #[error(
        "the unit of re-radiation is not stated, expected the attribute {BISPECTRAL_UNIT}, or a unit given"
    )]
    Unit,
    /// The file states another unit than the one that was given.
    #[error("re-radiation {stated}, expected {given}, the unit given")]
    OtherUnit {
        /// What the file states.
        stated: BispectralUnit,
        /// What was given.
        given: BispectralUnit,
    },
    /// The channels are no matrix.
    #[error(transparent)]
    Matrix(#[from] DonaldsonError),
}
