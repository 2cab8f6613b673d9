//! The seed paper's figures and claims, computed.
mod claims;
mod cubes;
mod error;
mod field;
mod figures;
mod svg;

pub use cubes::{Cubes, StudyCube};
pub use error::StudyError;
