//! The native half of the Python package `upglow`: what Python hands over is checked and converted,
//! one call is made, and the answer is converted back. There is no science here.
//!
//! Arrays come flat: RGB is `[color][channel]`, and Python gives results their shape. Double
//! precision is answered in double, single in single. Python's lock is released while Rust works.
//!
//! Out of scope: shapes, names of files, and what Python programs read. That is
//! `python/upglow`, which is the package's public half.

mod arrays;
mod color;
mod contract;
mod cube;
mod errors;
mod figures;
mod fit;
mod illuminant;
mod materials;
mod model;
mod nodes;
mod observer;
mod questions;
mod rows;
mod spectra;
mod standing;
mod threads;
mod verify;
mod watch;
mod word;

use pyo3::pymodule;

/// The native half of `upglow`: use the package itself.
#[pymodule]
mod _upglow {
    #[pymodule_export]
    use crate::{
        color::{Colors, colors},
        contract::Contract,
        cube::Cube,
        figures::{
            chromaticity_diagram, dye_spectra, layer, mixed_reflectances, node_colors,
            solid_surface,
        },
        fit::{build, fit},
        illuminant::Illuminant,
        materials::{corners, polish},
        model::{DyeSet, Model},
        observer::Observer,
        questions::answer,
        rows::first_outside,
        spectra::{reradiation_matrix, spectrum},
        standing::standing,
        verify::verify,
    };

    /// Version of the package.
    #[pymodule_export]
    #[expect(non_upper_case_globals, reason = "Python's name for it")]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
