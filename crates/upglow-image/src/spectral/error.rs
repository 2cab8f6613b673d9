//! Why a file does not hold, or cannot hold, spectra or materials.

use upglow::NodeError;

use crate::exr::error::ExrError;

/// Why a file does not hold, or cannot hold, spectra or materials.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FormError {
    /// It is no OpenEXR file that can be read.
    #[error(transparent)]
    Exr(#[from] ExrError),
    /// It has no spectral channel.
    #[error("no spectral channel, expected names as T.550,000000nm or S0.550,000000nm")]
    NotSpectral,
    /// It says nothing, or nothing sound, of the model behind its materials.
    #[error(
        "attribute {attribute} is absent or damaged, expected a file of `upglow bake --as material`"
    )]
    NotMaterial {
        /// The attribute that holds the model.
        attribute: &'static str,
    },
    /// A texel's numbers make no material of the model.
    #[error("texel {x},{y}")]
    Material {
        /// Column, from 0 at the left.
        x: usize,
        /// Row, from 0 at the top.
        y: usize,
        /// What is wrong with it.
        source: NodeError,
    },
    /// More dyes than the compact form has maps.
    #[error(
        "{found} dyes, expected 1 to {most} with a map each; the form of lobes takes any number"
    )]
    Dyes {
        /// Dyes of the ring.
        found: usize,
        /// The most maps.
        most: usize,
    },
    /// Two dyes have one name once it is spelled as a channel.
    #[error("two dyes are named {name:?} in channels, expected different names")]
    Twice {
        /// The name.
        name: String,
    },
    /// An attribute of the compact form is absent or is not what it should be.
    #[error("attribute {name} is {found}, expected {expected}")]
    Attribute {
        /// The attribute.
        name: String,
        /// Its value, or "absent".
        found: String,
        /// What it should be.
        expected: String,
    },
    /// A channel of the compact form is absent.
    #[error("no channel {name:?}, expected the channels of the compact form")]
    Channel {
        /// The channel.
        name: String,
    },
}
