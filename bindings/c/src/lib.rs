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

pub use colors::{
    UpglowColors, upglow_colors_create, upglow_colors_create_sampled, upglow_colors_destroy,
    upglow_xyz,
};
pub use cube::{
    UpglowCube, UpglowCubeFacts, upglow_cube_destroy, upglow_cube_facts, upglow_cube_from_memory,
    upglow_cube_open,
};
pub use failure::{UpglowStatus, upglow_message, upglow_status_name};
pub use material::{
    UpglowMaterial, upglow_albedo, upglow_is_fluorescent, upglow_look_up, upglow_look_up_many,
    upglow_reflectance, upglow_reflectance_4, upglow_reflectance_8, upglow_reradiation,
};
pub use sampling::{
    UpglowDraw, UpglowSample, upglow_incident_elastic_probability, upglow_incident_pdf,
    upglow_outgoing_elastic_probability, upglow_outgoing_pdf, upglow_sample_incident,
    upglow_sample_outgoing,
};
pub use version::{
    UPGLOW_VERSION_MAJOR, UPGLOW_VERSION_MINOR, UPGLOW_VERSION_PATCH, upglow_version,
};
