//! The seed paper's figures and claims, computed.
mod claims;
mod cubes;
mod field;
mod figures;
mod svg;
