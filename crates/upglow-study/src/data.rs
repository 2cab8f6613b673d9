//! What the figures are drawn from: numbers, for whoever draws them otherwise.

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
pub use reachability::{shares, standing_layer};
pub use solid_surface::solid_surface;
