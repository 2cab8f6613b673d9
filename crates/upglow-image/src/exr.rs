//! OpenEXR images: headers, blocks of pixels, a reader by regions and a writer by bands of rows.

pub(crate) mod attribute;
mod blocks;
pub(crate) mod error;
pub(crate) mod header;
pub(crate) mod reader;
#[cfg(test)]
mod tests;
pub(crate) mod writer;
