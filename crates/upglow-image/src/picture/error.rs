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
    /// The file is of none of the formats.
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
    /// A kind of pixels that is not read.
    #[error("{found}, expected {expected}")]
    Pixels {
        /// The kind.
        found: String,
        /// The kinds that are read.
        expected: &'static str,
    },
    /// An OpenEXR file without one clear set of RGB channels.
    #[error("channels {}, expected {expected}", .found.join(", "))]
    Channels {
        /// Channels or layers that there are, some of them if they are many.
        found: Vec<String>,
        /// What is read.
        expected: &'static str,
    },
    /// A picture larger than this program holds.
    #[error("{} by {} pixels, expected 1 to {MAX_SIDE} a side", .found[0], .found[1])]
    Size {
        /// Width and height.
        found: [usize; 2],
    },
    /// A piece of the file that must be unpacked at once is too large.
    #[error("{what} takes {found} bytes, expected at most {expected}")]
    Memory {
        /// The piece.
        what: &'static str,
        /// Bytes it takes.
        found: u64,
        /// The most that is given.
        expected: u64,
    },
    /// Neither the file nor the caller names an RGB space.
    #[error("the file does not name its RGB space, expected one to be given")]
    Space,
    /// Neither the file nor the caller says how light is stored.
    #[error(
        "the file does not say how it stores light, expected linear, srgb or a gamma to be given"
    )]
    Encoding,
}
