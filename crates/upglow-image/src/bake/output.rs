//! Baked files that are being written.

use super::levels::Levels;
use super::png::PngWriter;
use crate::exr::mipmap::MipmapWriter;
use crate::exr::writer::{ExrWriter, WriteExrError};

/// A file that takes a picture by bands of rows and appears when it is complete.
#[derive(Debug)]
pub(super) enum Output {
    Exr(ExrWriter),
    Png(PngWriter),
    /// A file of all levels.
    Mipmap(Box<(Levels, MipmapWriter)>),
}

impl Output {
    /// Completes the file; returns its size in bytes.
    pub(super) fn finish(self) -> Result<u64, WriteExrError> {
        match self {
            Self::Exr(writer) => writer.finish(),
            Self::Png(writer) => Ok(writer.finish()?),
            Self::Mipmap(mipmap) => mipmap.1.finish(),
        }
    }
}
