//! The seed paper's figures and claims, computed.
//!
//! Numbers and drawings are apart: what a figure shows is plain data ([`Layer`], [`standing_layer`],
//! [`dye_spectra`] …), and the feature `drawing`, on by default, draws it.
mod claims;
mod cubes;
mod data;
mod error;
mod field;
#[cfg(feature = "drawing")]
mod figures;
#[cfg(feature = "drawing")]
mod fonts;
#[cfg(feature = "drawing")]
mod raster;
mod report;
mod spread;
#[cfg(feature = "drawing")]
mod svg;

pub use claims::{Claim, Number, Verdict};
pub use cubes::{Cubes, StudyCube};
pub use data::{
    ChromaticityDiagram, DyeSpectra, Layer, Mixing, dye_spectra, node_colors, shares,
    solid_surface, standing_layer,
};
pub use error::StudyError;
#[cfg(feature = "drawing")]
pub use figures::{Display, Figure, FigureOptions, figures};
pub use report::{reproduce, to_markdown};
