//! Why a picture cannot be read.

use std::io;

use crate::exr::error::ExrError;
use crate::exr::header::MAX_SIDE;

/// Why a picture cannot be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PictureError {
    /// The file cannot be read.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// The file is not in one of the supported formats.
    #[error("the file begins with {found:02x?}, expected an OpenEXR, TIFF or PNG picture")]
    Format {
        /// Its first bytes, four at most.
        found: Vec<u8>,
    },
    /// An OpenEXR file that cannot be read.
    #[error(transparent)]
    Exr(#[from] ExrError),
    /// A PNG file that cannot be read.
    #[error("damaged, expected a whole PNG picture")]
    Png(#[from] ::png::DecodingError),
    /// A TIFF file that cannot be read.
    #[error("damaged, expected a whole TIFF picture")]
    Tiff(#[from] ::tiff::TiffError),
    /// Pixels of an unsupported type, or no unambiguous set of color channels.
    #[error("{found}, expected {expected}")]
    Pixels {
        /// The type, or the channels or layers of the file.
        found: String,
        /// What is supported.
        expected: &'static str,
    },
    /// An empty picture, or one larger than supported.
    #[error("{} by {} pixels, expected 1 to {MAX_SIDE} a side", .found[0], .found[1])]
    Size {
        /// Width and height.
        found: [usize; 2],
    },
    /// A part of the file that must be decompressed at once is too large.
    #[error("{what} takes {found} bytes, expected at most {expected}")]
    Memory {
        /// The part.
        what: &'static str,
        /// Bytes it takes.
        found: u64,
        /// The limit.
        expected: u64,
    },
    /// Neither the file nor the caller names an RGB space.
    #[error("the file does not name its RGB space, expected one to be given")]
    Space,
    /// Neither the file nor the caller names an encoding.
    #[error("the file does not name its encoding, expected linear, srgb or a gamma to be given")]
    Encoding,
}
