//! Why a picture cannot be read.

use std::io;

use super::stated::{Found, Missing, StatementError};
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
    #[error("the file begins with {found:02x?}, expected a picture: {}", super::FORMATS)]
    Format {
        /// Its first bytes, four at most.
        found: Vec<u8>,
    },
    /// An OpenEXR file that cannot be read.
    #[error(transparent)]
    Exr(#[from] ExrError),
    /// A file that contradicts its format.
    #[error("damaged: {found}, expected a whole {format} picture")]
    Damaged {
        /// The contradiction.
        found: String,
        /// The name of the format.
        format: &'static str,
    },
    /// Pixels of an unsupported type.
    #[error("{found}, expected {expected}")]
    Pixels {
        /// The type.
        found: String,
        /// What is supported.
        expected: &'static str,
    },
    /// No channels of color, or not the wanted ones.
    #[error("channels {found}, expected {expected}")]
    Channels {
        /// The channels or layers of the file.
        found: String,
        /// What is supported.
        expected: String,
    },
    /// Several layers of color, of which none was chosen.
    #[error("color layers {found}, expected the name of one to be given")]
    Layers {
        /// The layers.
        found: String,
    },
    /// A layer was chosen in a file that has none.
    #[error("a file without layers, expected no layer to be given")]
    NoLayers,
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
    /// Neither the file nor the caller states an RGB space or an encoding.
    #[error("{found} {missing}, expected a declaration")]
    Unstated {
        /// What is missing.
        missing: Missing,
        /// What the file states instead.
        found: Found,
    },
    /// The file states an RGB space or encoding that is not valid.
    #[error(transparent)]
    Statement(#[from] Box<StatementError>),
    /// A curve of displays of high dynamic range.
    #[error(
        "{by} states {curve}, a curve of displays of high dynamic range, expected linear light or the \
         curve of sRGB, BT.709 or a gamma: convert the picture to linear light"
    )]
    HighDynamicRange {
        /// The part of the file that states it.
        by: &'static str,
        /// The name of the curve.
        curve: &'static str,
    },
    /// A sample beside the colors whose use the file does not state.
    #[error(
        "a sample beside the colors whose use the file does not state, expected it to be declared \
         straight or associated alpha, or none"
    )]
    Alpha,
    /// Alpha that is NaN or infinite.
    #[error("texel {x},{y}: alpha is {found}, expected a finite number")]
    AlphaValue {
        /// Column, from 0 at the left.
        x: usize,
        /// Row, from 0 at the top.
        y: usize,
        /// The alpha.
        found: f32,
    },
}

impl PictureError {
    /// What an error of reading means: a file that ends early is damaged.
    pub(super) fn read(error: io::Error, format: &'static str) -> Self {
        match error.kind() {
            io::ErrorKind::UnexpectedEof => {
                Self::Damaged { found: "it ends too early".into(), format }
            }
            _ => Self::Io(error),
        }
    }

    pub(super) fn pixels(found: impl Into<String>, expected: &'static str) -> Self {
        Self::Pixels { found: found.into(), expected }
    }
}
