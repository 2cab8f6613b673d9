//! OpenEXR images: headers, blocks, a reader of regions and a writer of bands of rows.

pub(crate) mod attribute;
mod blocks;
pub(crate) mod error;
pub(crate) mod header;
pub(crate) mod mipmap;
pub(crate) mod reader;
#[cfg(test)]
mod tests;
pub(crate) mod writer;
