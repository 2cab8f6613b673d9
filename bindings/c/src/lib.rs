//! The C library: every function of `include/upglow.h`.
//!
//! Each function checks and converts its arguments, calls `upglow` once, and converts the result. The
//! header is generated from this crate by `cargo xtask header`; `README.md` is the guide for C and
//! C++.
//!
//! - failures: [`UpglowStatus`], [`upglow_message`]
//! - cubes: [`UpglowCube`], [`UpglowCubeFacts`]
//! - materials: [`UpglowMaterial`], a look-up into the caller's memory, and its evaluation
//! - wavelengths drawn: [`UpglowSample`]
//! - colors of whole images: [`UpglowColors`]
//! - 4×4 matrices for engines without spectra: [`UpglowMatrices`]
//!
//! # Safety
//!
//! Every function that takes pointers is `unsafe`, with the same condition on each of them: it is
//! null, which is refused, or points to live, initialized values of its type, as many as the
//! function's documentation says; and nobody else accesses memory that the function writes to.

// Separated by blank lines, so that rustfmt keeps the header's order.
mod version;

mod failure;

mod cube;

mod material;

mod sampling;

mod colors;

mod matrices;

mod pointer;

pub use colors::*;
pub use cube::*;
pub use failure::*;
pub use material::*;
pub use matrices::*;
pub use sampling::*;
pub use version::*;
