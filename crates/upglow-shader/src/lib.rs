//! Cubes for shaders: textures, and functions that look materials up, evaluate and sample them.
//!
//! [`Shader::new`] turns a [`upglow::Cube`] into source text in a [`Language`] and the files with its
//! numbers. `docs/shaders.md` describes the functions and how to load the files.
//!
//! # Examples
//!
//! ```
//! use upglow::{Cube, Edge, FitRecord, Fluorescence, Model, Node};
//! use upglow_color::Contract;
//! use upglow_shader::{Language, Shader};
//!
//! let gray = Edge { edge_nm: 550.0, level: 0.0, slope_per_nm: 0.0 };
//! let nodes = vec![Node::new(gray, Fluorescence::None, 0.0); 8];
//! let cube = Cube::new(Contract::default(), Model::Reflectance, FitRecord::default(), 2, nodes)?;
//! let shader = Shader::new(&cube, Language::Wgsl, "gray")?;
//! assert!(shader.source.contains("fn upglow_look_up(rgb: vec3f) -> UpglowMaterial {"));
//! assert_eq!(shader.payload[0].name, "gray.textures");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! For RGB renderers, [`color_node`] is a node that returns the color of a cube's material under a light,
//! [`ColorTexture`] the numbers that it reads, and [`Documents`] a surface with it in MaterialX and USD. For color
//! management, [`Lut`] is a table of colors as CLF or `.cube`.
//!
//! Out of scope: reading or writing files, talking to a driver, how surfaces scatter over angles.

mod color_node;
mod documents;
mod error;
mod javascript;
mod language;
mod lut;
mod payload;
mod shader;
mod template;
mod textures;
mod tiff;
mod translation;
mod xml;

pub use color_node::{ColorTexture, color_node};
pub use documents::{ColorMap, DocumentError, Documents};
pub use error::ShaderError;
pub use language::Language;
pub use lut::{Lut, LutError, LutFormat, LutLattice};
pub use shader::{PayloadFile, Shader};
