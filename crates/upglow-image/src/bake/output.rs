//! Baked files that are being written.

use upglow::Aside;

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
    /// Completes the file but for its name.
    pub(super) fn into_file(self) -> Result<Aside, WriteExrError> {
        match self {
            Self::Exr(writer) => writer.into_file(),
            Self::Png(writer) => Ok(writer.into_file()?),
            Self::Mipmap(mipmap) => mipmap.1.into_file(),
        }
    }
}
