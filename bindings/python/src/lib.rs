//! The native half of the Python package `upglow`: each function checks and converts its arguments,
//! makes one call of a library crate, and converts the result. There is no science here.
//!
//! Arrays are flat: RGB is `[color][channel]`, and Python reshapes the results. Results for arrays
//! in double precision are double, for those in single precision single. Python's global lock is
//! released during the work.
//!
//! Shapes, names of files and documentation for users belong to `python/upglow`, the public half of
//! the package.

mod arrays;
mod color;
mod contract;
mod cube;
mod errors;
mod figures;
mod fit;
mod illuminant;
mod materials;
mod matrix;
mod metamers;
mod model;
mod nodes;
mod observer;
mod questions;
mod reduced;
mod relight;
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
        matrix::{DonaldsonMatrix, MatrixFit, fit_matrix},
        metamers::{Metamers, matrix_like, metamers},
        model::{DyeSet, Model},
        observer::Observer,
        questions::answer,
        reduced::Reduced,
        relight::relight,
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
