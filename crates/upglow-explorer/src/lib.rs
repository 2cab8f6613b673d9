//! A page to explore a cube: pick colors, see their spectra, and light them.
//!
//! The page is HTML, CSS and JavaScript of this crate (`page/`), without other dependencies. It evaluates
//! materials with the functions that [`upglow_shader::Language::JavaScript`] exports, so that it says no
//! formula of a model again.
//!
//! - one file that needs no program: [`offline_page`]
//! - what the page knows of a cube: [`CubeData`]
//! - with the feature `server`, the page with what needs the fitter or a file reader: `Server`
//!
//! Out of scope: reading cubes, opening a browser.

mod borders;
mod cube_data;
mod lights;
mod page;
#[cfg(feature = "server")]
mod sampled;
#[cfg(feature = "server")]
mod server;

pub use cube_data::{CubeData, ExplorerError};
pub use page::offline_page;
#[cfg(feature = "server")]
pub use server::{BuildOption, Plan, PlanOf, Planner, Server, ServerError};

/// A small cube of the default preset.
#[cfg(test)]
fn test_cube() -> upglow::Cube {
    let preset = upglow_fit::Preset::default();
    let contract = upglow_color::Contract::default();
    upglow_fit::build_cube(&contract, &preset.model(), preset.options(), 4, &upglow_fit::Unwatched)
        .expect("the preset is valid")
}
