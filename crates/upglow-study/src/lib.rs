//! The seed paper's figures and claims, computed.
mod claims;
mod cubes;
mod error;
mod field;
mod figures;
mod fonts;
mod layers;
mod raster;
mod report;
mod spread;
mod svg;

pub use claims::{Claim, Number, Verdict};
pub use cubes::{Cubes, StudyCube};
pub use error::StudyError;
pub use figures::{Display, Figure, FigureOptions, UnknownDisplay, figures};
pub use report::{reproduce, to_markdown};
