//! The C library: every function of `include/upglow.h`.
//!
//! A function here checks what it was given, converts, calls `upglow` once and converts back. The
//! header is generated from this crate by `cargo xtask header`; `README.md` beside it is the guide
//! for C and C++.
//!
//! - failures: [`UpglowStatus`], [`upglow_message`]
//! - cubes: [`UpglowCube`], [`UpglowCubeFacts`]
//! - materials: [`UpglowMaterial`], a look-up in the caller's memory, and what it answers
//! - wavelengths drawn: [`UpglowSample`]
//! - colors of whole images: [`UpglowColors`]
//!
//! # Safety
//!
//! Every function that takes pointers is `unsafe`, and asks the same of each of them: it is null,
//! which is refused, or it points to what its type says, alive and initialized, for as many values
//! as the function's text says; what it writes to, nobody else reads or writes meanwhile.

// Apart, so that they stay in the order in which the header is read.
mod version;

mod failure;

mod cube;

mod material;

mod sampling;

mod colors;

mod pointer;

pub use colors::*;
pub use cube::*;
pub use failure::*;
pub use material::*;
pub use sampling::*;
pub use version::*;
