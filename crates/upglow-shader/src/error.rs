//! Why a cube makes no shader.

/// Why a cube makes no shader.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ShaderError {
    /// A texture of this many nodes has more rows than drivers take.
    #[error("resolution {found}, expected at most {most}: textures have up to 8192 rows")]
    Resolution {
        /// The cube's nodes along an axis.
        found: usize,
        /// Most that fit.
        most: usize,
    },
    /// The name cannot stand in a file's name or a line of source text.
    #[error("name {found:?}, expected letters, digits, '.', '-' or '_'")]
    Name {
        /// The name given.
        found: String,
    },
}
