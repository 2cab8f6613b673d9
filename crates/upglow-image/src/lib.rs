//! Bakes pictures into spectral files and checks them, by bands of rows and in bounded memory.
//!
//! - pictures: [`Picture`] reads six formats ([`FORMATS`]) by [`Band`]s; [`Encoding`] makes them linear
//! - before baking: [`Checker`] determines which kind of material each texel needs
//! - baking: [`Baker`] writes materials, spectra or colors under a light, in a [`Form`]
//! - baked files: [`MaterialPicture`] and [`SpectralPicture`] read texels, [`Lint`] checks files
//! - OpenEXR: [`ExrWriter`] writes any channels by bands, [`ExrReader`] reads any region
//!
//! `docs/spectral-exr.md` and `docs/material-exr.md` describe the files.
//!
//! Files appear under their names only when they are complete, and their bytes do not depend on the
//! number of threads. Invalid files never cause a panic: they are refused with an error of one line that
//! states what was found and what was expected.
//!
//! # Examples
//!
//! ```
//! use upglow_image::{Encoding, ExrDescription, ExrWriter, Picture};
//!
//! let folder = tempfile::tempdir()?;
//! let path = folder.path().join("gray.exr");
//! let mut writer = ExrWriter::create(&path, ExrDescription::new([4, 2], ["R", "G", "B"]))?;
//! writer.write_band(&[&[0.5; 8], &[0.5; 8], &[0.5; 8]])?;
//! writer.finish()?;
//!
//! let mut picture = Picture::open(&path)?;
//! let encoding = picture.encoding().unwrap_or(Encoding::Srgb);
//! for band in picture.bands(64) {
//!     let mut band = band?;
//!     band.decode(encoding);
//!     assert_eq!(band.rgb[0], [0.5; 3]);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The materials come from cubes of the crate `upglow`.

mod bake;
mod check;
mod example_pictures;
mod exr;
mod picture;
#[cfg(test)]
mod python;
mod spectral;

pub use bake::hash::Hash;
pub use bake::material_picture::MaterialPicture;
pub use bake::matrix::Incident;
pub use bake::png::PngBits;
pub use bake::repair::Repair;
pub use bake::{BakeError, BakeOptions, Baked, Baker, Form, Layout};
pub use check::{
    BeyondOne, Cause, Change, CheckError, CheckReport, Checker, ColorDifference, Counts, CubeMatch,
    DyeUse, Flaw, FlawedTexel, MissedTexel, UsedDye, WiderSpace, WorstTexel,
};
pub use example_pictures::ExamplePicture;
pub use exr::error::ExrError;
pub use exr::header::Sample;
pub use exr::reader::ExrReader;
pub use exr::writer::{Compression, ExrDescription, ExrWriter, WriteExrError};
pub use picture::band::Band;
pub use picture::encoding::{Encoding, ParametricCurve};
pub use picture::error::PictureError;
pub use picture::excerpt::Excerpt;
pub use picture::interop::InteropSpace;
pub use picture::stated::{
    Declared, DeclaredAlpha, Found, Interpretation, Missing, StatementError, Word,
};
pub use picture::{FORMATS, Picture, SUFFIXES};
pub use spectral::error::FormError;
pub use spectral::lint::findings::{Finding, Lint, Severity};
pub use spectral::picture::{SpectralPicture, SpectralTexel};
