//! Why a cube has no shader.

use upglow_color::{ContractError, ReducedBasisError};

/// Why a cube has no shader.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ShaderError {
    /// The texture of the nodes would have more rows than drivers support.
    #[error("resolution {found}, expected at most {most}: textures have up to 8192 rows")]
    Resolution {
        /// The cube's nodes along an axis.
        found: usize,
        /// The most nodes that fit.
        most: usize,
    },
    /// The name is not valid in file names and source text.
    #[error("name {found:?}, expected letters, digits, '.', '-' or '_'")]
    Name {
        /// The name given.
        found: String,
    },
    /// The cube's light has no parts that matrices could be made of.
    #[error(transparent)]
    Basis(#[from] ReducedBasisError),
    /// The engine's RGB space does not fit the cube's light.
    #[error(transparent)]
    Engine(#[from] ContractError),
}
