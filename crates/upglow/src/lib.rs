//! The run-time half of upglow: materials for any RGB color, looked up and evaluated.
//!
//! A [`Cube`] holds one [`Material`] for each node of a grid over RGB. A look-up mixes the four
//! materials around a color into a [`Mixture`], without allocation, and a mixture answers what a
//! renderer asks through the trait [`Bispectral`].
//!
//! - reflectance: [`Sigmoid`], [`Vertex`], [`Features`], [`Edge`]
//! - fluorescence: [`Model`], [`DyeSet`], [`DyeModel`], [`AnalyticModel`]
//! - color: [`ModelOnGrid`], and [`ColorTable`] for whole images
//! - cubes: [`Cube`], [`Interpolation`]; files are described in `docs/cube-format.md`
//! - files that appear whole or not at all: [`Aside`], [`write_whole`]
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
//! let dyes = DyeModel::new(DyeSet::named("seed8")?, DyeOptions::default())?;
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
mod batch;
mod bispectral;
mod bspline;
mod coefficient_table;
mod cube;
mod cube_file;
mod curve_table;
mod distribution;
mod dye;
mod edge;
mod features;
mod header;
mod interpolation;
mod inverse_root;
mod lookup_table;
mod material;
mod mixture;
mod model;
mod model_on_grid;
mod packed_mixture;
mod packed_node;
mod packed_sampling;
mod quantile_table;
#[cfg(test)]
mod random;
mod sampling;
mod sigmoid;

pub use aside::{Aside, AsideError, write_whole};
pub use batch::{ColorTable, LengthError};
pub use bispectral::Bispectral;
pub use coefficient_table::{CoefficientTable, CoefficientTableError, Integrator};
pub use cube::{Cube, CubeError, FitRecord, LookupError, Node, NodeError};
pub use cube_file::{ReadCubeError, WriteCubeError};
pub use dye::{DyeSet, DyeSetError};
pub use edge::Edge;
pub use features::{FeatureError, Features};
pub use interpolation::Interpolation;
pub use lookup_table::LookupTable;
pub use material::{Fluorescence, Material};
pub use mixture::Mixture;
pub use model::{
    Accounting, AnalyticModel, DyeCurves, DyeModel, DyeOptions, Mixing, Model, ModelError,
    QuantumYield,
};
pub use model_on_grid::{Emitted, ModelOnGrid};
pub use packed_mixture::PackedMixture;
pub use packed_node::PackedNode;
pub use sampling::{Draw, Sample};
pub use sigmoid::{Sigmoid, Vertex};
