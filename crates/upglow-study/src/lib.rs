//! The numbers behind the figures of König et al. 2020, for any cube or contract.
//!
//! The data of a figure is a plain value: [`Layer`], [`standing_layer`], [`dye_spectra`] … The program
//! `upglow-study`, in the same package, draws the figures from these values and measures the paper's
//! claims; [`konig2020`] has the paper's settings for both.

pub mod konig2020;

mod chromaticity;
mod dye_spectra;
mod layer;
mod mixing;
mod node_colors;
mod reachability;
mod solid_surface;

pub use chromaticity::ChromaticityDiagram;
pub use dye_spectra::{DyeSpectra, dye_spectra};
pub use layer::Layer;
pub use mixing::Mixing;
pub use node_colors::node_colors;
pub use reachability::standing_layer;
pub use solid_surface::solid_surface;
