//! The spectral layout of OpenEXR: channel names, the compact form, a reader of texels, and a linter.

mod attribute_spectrum;
pub(crate) mod channel;
pub(crate) mod compact;
pub(crate) mod error;
pub(crate) mod lint;
pub(crate) mod picture;
#[cfg(test)]
mod tests;
