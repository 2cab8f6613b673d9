//! The run-time half of upglow: materials for any RGB color, looked up and evaluated.
//!
//! A [`Cube`] holds one [`Material`] for each node of a grid over RGB. A look-up mixes the four
//! materials around a color into a [`Mixture`], without allocation. A renderer evaluates and samples
//! the mixture through the trait [`Bispectral`].
//!
//! - reflectance: [`Sigmoid`], [`Vertex`], [`Features`], [`Edge`]
//! - fluorescence: [`Model`], [`DyeSet`], [`DyeModel`], [`AnalyticModel`]
//! - color: [`ModelOnGrid`], and [`ColorTable`] for whole images
//! - 4×4 matrices for engines without spectra: [`ReducedModel`], and [`ReducedTable`] for looked-up colors
//! - cubes: [`Cube`], [`Interpolation`]; files are described in `docs/cube-format.md`
//! - files that appear whole or not at all: [`Aside`]
//! - evaluation and sampling: [`Bispectral`], [`Sample`]
//! - inner loops: [`Cube::lookup_table`] gives a [`LookupTable`], which looks up a
//!   [`PackedMixture`], a mixture in single precision; devices read [`Cube::packed_nodes`]
//!
//! # Examples
//!
//! ```
//! use upglow::{Bispectral, Fluorescence, Material, Mixture, Model, Sigmoid};
//! use upglow::{DyeModel, DyeOptions, DyeSet};
//!
//! let dyes = DyeModel::new(DyeSet::named("konig8")?, DyeOptions::default())?;
//! let model = Model::Dyes(dyes);
//! let material = Material {
//!     reflectance: Sigmoid::flat(0.5),
//!     fluorescence: Fluorescence::Dyes { first: 2, weight: 0.5, concentration: 0.8 },
//! };
//! let mixture = Mixture::of(&model, material);
//! assert!(mixture.reradiation_per_nm(500.0, 540.0) > 0.0);
//! assert!(mixture.albedo(500.0) <= 1.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Out of scope: finding materials (crate `upglow-fit`), threads, printing.

mod aside;
mod bispectral;
mod cube;
mod input;
mod material;
mod packed;
#[cfg(test)]
mod random;
#[doc(hidden)]
pub mod tensor;

pub use aside::Aside;
pub use bispectral::{Bispectral, Draw, FARTHEST_NM, Sample};
pub use cube::coefficient_table::{CoefficientTable, CoefficientTableError};
pub use cube::error::{CubeFileError, ReadCubeError};
pub use cube::header::CubeCurves;
pub use cube::interpolation::Interpolation;
pub use cube::{Cube, CubeError, FitRecord, FitRecordError, LookupError, Node, NodeError};
pub use input::{open_input, read_input, read_text_input};
pub use material::analytic_model::AnalyticModel;
pub use material::dye_model::{DyeCurves, DyeModel, DyeOptions, QuantumYield};
pub use material::dye_set::{DyeSet, DyeSetError};
pub use material::edge::Edge;
pub use material::features::{FeatureError, Features};
pub use material::film_model::FilmModel;
pub use material::formula::{Accounting, Emitted, Mixing};
pub use material::mixture::Mixture;
pub use material::model::Model;
pub use material::model_error::ModelError;
pub use material::model_on_grid::ModelOnGrid;
pub use material::reduced_model::ReducedModel;
pub use material::sigmoid::{Sigmoid, Vertex};
pub use material::{Fluorescence, Material};
pub use packed::color_table::{ColorTable, LengthError};
pub use packed::lookup_table::LookupTable;
pub use packed::mixture::PackedMixture;
pub use packed::node::PackedNode;
pub use packed::reduced_table::ReducedTable;

#[cfg(test)]
mod tests {
    use super::*;

    /// Renderers share cubes and tables between threads, and pass materials to other threads.
    #[test]
    fn threads_share_what_a_renderer_holds() {
        const fn shared<T: Send + Sync>() {}
        const {
            shared::<Cube>();
            shared::<LookupTable>();
            shared::<ColorTable>();
            shared::<CoefficientTable>();
            shared::<ReducedTable>();
            shared::<ModelOnGrid>();
            shared::<Mixture<'_>>();
            shared::<PackedMixture<'_>>();
            shared::<CubeFileError>();
        }
    }
}
