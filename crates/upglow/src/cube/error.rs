//! Why a cube's file cannot be read or written.

use std::error::Error;
use std::fmt::Debug;
use std::io;
use std::path::PathBuf;

use safetensors::SafeTensorError;

use crate::cube::CubeError;

/// Why a cube's file cannot be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CubeFileError {
    /// The file cannot be read or written.
    #[error("{}: {cause}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's error.
        cause: io::Error,
    },
    /// The file is not a cube that this program reads.
    #[error("{}: {cause}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        cause: ReadCubeError,
    },
}

/// Why the content of a file is not a cube that this program reads.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadCubeError {
    /// The file is not a whole safetensors file.
    #[error("not a whole safetensors file: {found}, expected a cube made by upglow")]
    Container {
        /// What is wrong with it.
        found: &'static str,
    },
    /// The header has no entry `upglow`.
    #[error("no `upglow` entry in the header, expected a cube made by upglow")]
    NotACube,
    /// The container has another metadata entry.
    #[error("metadata entry {found:?}, expected `upglow` alone")]
    Metadata {
        /// Name of the entry.
        found: String,
    },
    /// The container's header is not plain JSON.
    #[error("safetensors header: {0}")]
    ContainerHeader(serde_json::Error),
    /// There is a tensor that a cube of this model and version does not have.
    #[error("tensor {found:?}, expected only {}", expected.join(", "))]
    Surplus {
        /// Name of the tensor.
        found: String,
        /// Names of the tensors that there may be.
        expected: Vec<&'static str>,
    },
    /// The file is of another version.
    #[error("format version {found}, expected 1 to {newest}")]
    Version {
        /// Version of the file.
        found: u32,
        /// The newest version that this program reads.
        newest: u32,
    },
    /// The header is not what this version writes.
    #[error("header: {0}")]
    Header(serde_json::Error),
    /// A field of the header differs from the only value that this version reads.
    #[error("header field {field} is {found}, expected {expected}")]
    Field {
        /// The field.
        field: &'static str,
        /// Its value.
        found: String,
        /// What it should be.
        expected: String,
    },
    /// A field of the header has an invalid value.
    #[error("header field {field}: {cause}")]
    Value {
        /// The field.
        field: &'static str,
        /// What is wrong with its value.
        cause: Box<dyn Error + Send + Sync>,
    },
    /// A tensor is absent or has another type or shape.
    #[error("tensor {name} is {found}, expected {expected}")]
    Tensor {
        /// The tensor.
        name: &'static str,
        /// Its type and shape, or "absent".
        found: String,
        /// What it should be.
        expected: String,
    },
    /// The content was changed after it was written.
    #[error("checksum {found}, expected {expected}: the file was altered or damaged")]
    Checksum {
        /// SHA-256 of the content, first eight digits.
        found: String,
        /// SHA-256 in the file, first eight digits.
        expected: String,
    },
    /// The numbers describe no cube.
    #[error(transparent)]
    Cube(#[from] CubeError),
}

impl From<SafeTensorError> for ReadCubeError {
    fn from(error: SafeTensorError) -> Self {
        let found = match error {
            SafeTensorError::HeaderTooSmall => "shorter than the length of a header",
            SafeTensorError::HeaderTooLarge
            | SafeTensorError::InvalidHeaderLength
            | SafeTensorError::InvalidHeader(_)
            | SafeTensorError::InvalidHeaderDeserialization(_)
            | SafeTensorError::JsonError(_) => "no header at its beginning",
            SafeTensorError::MetadataIncompleteBuffer => "not of the length that its header states",
            _ => "its header describes tensors that cannot be",
        };
        Self::Container { found }
    }
}

impl ReadCubeError {
    /// Checks that a field has the expected value.
    pub(crate) fn check<T: PartialEq + Debug + ?Sized>(
        field: &'static str,
        found: &T,
        expected: &T,
    ) -> Result<(), Self> {
        if found == expected {
            return Ok(());
        }
        let [found, expected] = [found, expected].map(|value| format!("{value:?}"));
        Err(Self::Field { field, found, expected })
    }

    /// Turns a cause into an error about a field.
    pub(crate) fn value<E: Error + Send + Sync + 'static>(
        field: &'static str,
    ) -> impl FnOnce(E) -> Self {
        move |error| Self::Value { field, cause: error.into() }
    }
}
