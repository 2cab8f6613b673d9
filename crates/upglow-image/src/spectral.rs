//! The spectral layout of OpenEXR: channel names, the compact form, a reader of texels, and a linter.

pub(crate) mod attribute_spectrum;
pub(crate) mod channel;
pub(crate) mod compact;
pub(crate) mod error;
pub(crate) mod lint;
pub(crate) mod picture;
pub(crate) mod stated;
#[cfg(test)]
mod tests;
