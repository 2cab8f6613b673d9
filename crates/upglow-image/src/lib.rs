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

mod attribute_spectrum;
mod bake;
mod band;
mod check;
mod chromaticities;
mod compact;
mod encoding;
mod example_pictures;
mod exr_attribute;
mod exr_blocks;
mod exr_error;
mod exr_header;
mod exr_reader;
mod exr_writer;
mod linear_picture;
mod lint;
mod lint_pixels;
mod material_picture;
mod picture;
mod repair;
mod rounding;
mod spectral_layout;
mod spectral_picture;

pub use bake::{BakeError, BakeOptions, Baked, Baker, Form, MaterialWay, baked_form};
pub use band::Band;
pub use check::{
    CheckError, CheckReport, CheckedPicture, Checker, Counts, CubeOpinion, Flaw, Judge, JudgeError,
    Located, Raster, WorstTexel, check_page,
};
pub use chromaticities::chromaticities;
pub use compact::{
    CompactDye, CompactError, CompactForm, CompactLayout, Donaldson, MOST_EXTRA_CHANNELS,
};
pub use encoding::Encoding;
pub use example_pictures::{EXAMPLE_PICTURES, ExamplePicture};
pub use exr_attribute::{Attribute, Attributes};
pub use exr_blocks::is_unpacking;
pub use exr_error::ExrError;
pub use exr_header::{Channel, Sample, Window};
pub use exr_reader::ExrReader;
pub use exr_writer::{Compression, ExrDescription, ExrWriter, WriteExrError};
pub use linear_picture::{Assumed, LinearPicture, LinearPictureError};
pub use lint::{Depth, Finding, Lint, Rule, Severity, lint};
pub use material_picture::{MaterialPicture, MaterialPictureError};
pub use picture::{Alpha, Picture, PictureError};
pub use repair::{Repair, Repaired, Repairer, greatest_value};
pub use spectral_layout::{
    BISPECTRAL_UNIT, BispectralUnit, EMISSIVE_UNITS, LAYOUT_VERSION, LAYOUT_VERSION_VALUE,
    SpectralChannel, SpectralNameError,
};
pub use spectral_picture::{Reradiation, SpectralPicture, SpectralPictureError, SpectralTexel};
