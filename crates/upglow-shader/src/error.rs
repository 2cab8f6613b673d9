//! Why a cube has no shader.

/// Why a cube has no shader.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
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
}
