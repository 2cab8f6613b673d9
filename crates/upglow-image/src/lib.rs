//! Pictures in, spectral files out: whole textures by bands of rows, in bounded memory.
//!
//! - pictures: [`Picture`] reads OpenEXR, TIFF and PNG by [`Band`]s; [`Encoding`] makes them linear
//! - OpenEXR: [`ExrWriter`] writes any channels by bands, [`ExrReader`] reads any region
//! - spectral files: [`SpectralChannel`] names, [`SpectralPicture`] texels, [`lint()`]
//! - the compact bispectral form: [`CompactLayout`]; `docs/spectral-exr.md` describes it
//!
//! A file that is written appears whole or not at all, and the same pixels give the same bytes for
//! any number of threads. No content of a file panics: each error is one line that says what was
//! found and what was expected.
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
//! Out of scope: finding materials, colors under a light, and any other format.

mod bake;
mod check;
mod example_pictures;
mod exr;
mod picture;
mod rounding;
mod spectral;

pub use bake::material_picture::{MaterialPicture, MaterialPictureError};
pub use bake::repair::{Repair, Repaired, Repairer, greatest_value};
pub use bake::{BakeError, BakeOptions, Baked, Baker, Form, MaterialWay, baked_form};
pub use check::{
    CheckError, CheckReport, CheckedPicture, Checker, Counts, CubeOpinion, Flaw, Judge, JudgeError,
    Located, Raster, WorstTexel, check_page,
};
pub use example_pictures::{EXAMPLE_PICTURES, ExamplePicture};
pub use exr::attribute::{Attribute, Attributes};
pub use exr::error::ExrError;
pub use exr::header::{Channel, Sample, Window};
pub use exr::is_unpacking;
pub use exr::reader::ExrReader;
pub use exr::writer::{Compression, ExrDescription, ExrWriter, WriteExrError};
pub use picture::band::Band;
pub use picture::chromaticities::chromaticities;
pub use picture::encoding::Encoding;
pub use picture::linear::{Assumed, LinearPicture, LinearPictureError};
pub use picture::{Alpha, Picture, PictureError};
pub use spectral::channel::{
    BISPECTRAL_UNIT, BispectralUnit, EMISSIVE_UNITS, LAYOUT_VERSION, LAYOUT_VERSION_VALUE,
    SpectralChannel, SpectralNameError,
};
pub use spectral::compact::{
    CompactDye, CompactError, CompactForm, CompactLayout, Donaldson, MOST_EXTRA_CHANNELS,
};
pub use spectral::lint::{Depth, Finding, Lint, Rule, Severity, lint};
pub use spectral::picture::{Reradiation, SpectralPicture, SpectralPictureError, SpectralTexel};
