//! The native half of the Python package `upglow`: what Python hands over is checked and converted,
//! one call is made, and the answer is converted back. There is no science here.
//!
//! Arrays come flat: RGB is `[color][channel]`, and Python gives results their shape. Double
//! precision is answered in double, single in single. Python's lock is released while Rust works.
//!
//! Out of scope: shapes, names of files, and what Python programs read. That is
//! `python/upglow`, which is the package's public half.

mod color;
mod contract;
mod cube;
mod errors;
mod figures;
mod fit;
mod illuminant;
mod materials;
mod model;
mod observer;
mod rows;
mod sampling;
mod spectra;
mod standing;
mod threads;
mod verify;
mod watch;

use pyo3::pymodule;

/// The native half of `upglow`: use the package itself.
#[pymodule]
mod _upglow {
    #[pymodule_export]
    use crate::color::{Colors, colors};
    #[pymodule_export]
    use crate::contract::Contract;
    #[pymodule_export]
    use crate::cube::Cube;
    #[pymodule_export]
    use crate::figures::{
        chromaticity_diagram, dye_spectra, layer, mixed_reflectances, node_colors, reachability,
        solid_surface,
    };
    #[pymodule_export]
    use crate::fit::{build, fit};
    #[pymodule_export]
    use crate::illuminant::Illuminant;
    #[pymodule_export]
    use crate::materials::{corners, polish};
    #[pymodule_export]
    use crate::model::{DyeSet, Model};
    #[pymodule_export]
    use crate::observer::Observer;
    #[pymodule_export]
    use crate::rows::first_outside;
    #[pymodule_export]
    use crate::sampling::{elastic_probability, pdf_per_nm, sample};
    #[pymodule_export]
    use crate::spectra::{albedo, reflectance, reradiation, reradiation_matrix};
    #[pymodule_export]
    use crate::standing::standing;
    #[pymodule_export]
    use crate::verify::verify;

    /// Version of the package.
    #[pymodule_export]
    #[expect(non_upper_case_globals, reason = "Python's name for it")]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
