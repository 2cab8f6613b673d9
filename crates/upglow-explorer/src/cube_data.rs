//! What the page knows of a cube: its shader's files, colors of its nodes, and the lights.

use rayon::prelude::*;
use serde_json::{Value, json};
use upglow::tensor::Tensor;
use upglow::{Cube, ModelOnGrid};
use upglow_color::rounding::to_single;
use upglow_color::{Adaptation, Contract, Grid, RgbSpace};
use upglow_fit::{CubeSummary, FitOptionsError};
use upglow_shader::{Language, Shader, ShaderError};

use crate::borders::{HUES, KINDS, LIGHTNESSES, borders};
use crate::lights::{ShownLight, ULTRAVIOLET_BELOW_NM, lights};

/// The name of the shader's files, and of the metadata entry with what is no array.
const NAME: &str = "explorer";

/// RGB spaces that colors can be given in, with their usual spelling; the cube's own comes first.
const SPACES: [(&str, &str); 3] = [("acescg", "ACEScg"), ("rec2020", "Rec.2020"), ("srgb", "sRGB")];

/// Why a cube cannot be explored.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ExplorerError {
    /// The cube has no shader.
    #[error(transparent)]
    Shader(#[from] ShaderError),
    /// The cube's slope limit is out of range.
    #[error(transparent)]
    Options(#[from] FitOptionsError),
}

/// What the page knows of a cube.
#[derive(Clone, Debug)]
pub struct CubeData {
    /// The cube's functions in JavaScript.
    pub script: String,
    /// The cube's functions in WGSL.
    pub shader: String,
    /// The arrays, and what is said of them, as safetensors; `page/js/cube.js` reads it.
    pub arrays: Vec<u8>,
}

impl CubeData {
    /// All but the borders, which take longer.
    ///
    /// # Errors
    ///
    /// [`ExplorerError::Shader`] if the cube has more nodes than shaders support.
    pub fn new(cube: &Cube, name: &str) -> Result<Self, ExplorerError> {
        let Shader { source: script, mut payload } = Shader::new(cube, Language::JavaScript, NAME)?;
        let shader = Shader::new(cube, Language::Wgsl, NAME)?.source;
        let textures = payload.pop().map(|file| file.bytes).unwrap_or_default();
        let shown: Vec<ShownLight> =
            lights(cube.contract()).iter().map(|light| ShownLight::new(cube, light)).collect();
        let mut tensors = vec![Tensor::bytes("textures", &[textures.len()], textures)];
        tensors.extend(node_tensors(cube));
        tensors.extend(light_tensors(&shown));
        let arrays = Tensor::file(&tensors, NAME, description(cube, name, &shown).to_string());
        Ok(Self { script, shader, arrays })
    }

    /// The greatest chroma of each kind of material, `[kind][lightness][hue]`, as little-endian floats.
    ///
    /// # Errors
    ///
    /// [`ExplorerError::Options`] if the cube's slope limit is out of range.
    pub fn borders(cube: &Cube) -> Result<Vec<u8>, ExplorerError> {
        Ok(borders(cube)?.into_iter().flat_map(f32::to_le_bytes).collect())
    }
}

/// What is no array.
fn description(cube: &Cube, name: &str, lights: &[ShownLight]) -> Value {
    let contract = cube.contract();
    let colorimetry = contract.on(Grid::FIT);
    let dyes = cube.model().dyes().map_or(&[][..], |dyes| dyes.set().dyes());
    let own = contract.space.name();
    let label =
        |space: &str| SPACES.iter().find(|(name, _)| *name == space).map(|(_, label)| *label);
    let others = SPACES.iter().map(|(space, _)| *space).filter(|space| *space != own);
    let spaces: Vec<Value> = std::iter::once(contract.clone())
        .chain(others.map(|space| Contract {
            space: RgbSpace::named(space).unwrap_or_default(),
            adaptation: Adaptation::Bradford,
            ..contract.clone()
        }))
        .map(|contract| {
            let colorimetry = contract.on(Grid::FIT);
            let name = contract.space.name();
            json!({
                "name": label(name).unwrap_or(name),
                "from_xyz": colorimetry.rgb_from_xyz_matrix().0,
                "to_xyz": colorimetry.xyz_from_rgb_matrix().0,
            })
        })
        .collect();
    json!({
        "name": name,
        "version": env!("CARGO_PKG_VERSION"),
        "resolution": cube.resolution(),
        "model": cube.model().name(),
        "observer": contract.observer.name(),
        "white": colorimetry.white().0,
        "spaces": spaces,
        "dyes": dyes.iter().map(|dye| &dye.name).collect::<Vec<_>>(),
        "fit": cube.fit(),
        "summary": CubeSummary::of(cube),
        "lights": lights.iter().map(ShownLight::description).collect::<Vec<_>>(),
        "ultraviolet_below_nm": ULTRAVIOLET_BELOW_NM,
        "borders": [KINDS, LIGHTNESSES, HUES],
    })
}

/// Color and dose of each node.
fn node_tensors(cube: &Cube) -> [Tensor; 2] {
    let sums = ModelOnGrid::new(cube.model(), &cube.contract().on(Grid::FIT));
    let count = cube.nodes().len();
    let material = |index| cube.node_material(index);
    let xyz: Vec<f64> =
        (0..count).into_par_iter().flat_map_iter(|i| sums.color(material(i)).0).collect();
    let dose = (0..count).map(|i| material(i).fluorescence.dose());
    [
        Tensor::singles("node_xyz", &[count, 3], xyz.into_iter().map(to_single)),
        Tensor::singles("node_dose", &[count], dose.map(to_single)),
    ]
}

/// What is summed under each light. The first is the contract's own.
fn light_tensors(lights: &[ShownLight]) -> [Tensor; 5] {
    let count = lights.len();
    let on_fit = &[count, Grid::FIT.len()];
    let seen = || lights.iter().map(|light| &light.seen.colorimetry);
    let matching = seen().next().map_or(&[][..], |own| own.matching());
    [
        Tensor::doubles("matching", &[matching.len(), 3], matching.iter().flatten()),
        Tensor::doubles("lights_nm", on_fit, seen().flat_map(|light| light.wavelengths_nm())),
        Tensor::doubles("lights_irradiance", on_fit, seen().flat_map(|light| light.irradiance())),
        Tensor::doubles(
            "lights_weights",
            &[count, Grid::FIT.len(), 3],
            seen().flat_map(|light| light.weights().iter().flatten()),
        ),
        Tensor::singles(
            "lights_power",
            &[count, Grid::FINE.len()],
            lights.iter().flat_map(|light| light.power.iter().copied().map(to_single)),
        ),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_cube;
    use safetensors::SafeTensors;

    #[test]
    fn nodes_have_the_colors_that_the_library_mixes() {
        let cube = test_cube();
        let CubeData { arrays, .. } = CubeData::new(&cube, "name").unwrap();
        let tensors = SafeTensors::deserialize(&arrays).unwrap();
        let nodes = tensors.tensor("node_xyz").unwrap();
        let colorimetry = cube.contract().on(Grid::FIT);
        for (index, bytes) in nodes.data().chunks_exact(12).enumerate() {
            let mut color = [[0.0; 3]];
            let rgb = cube.node_rgb(index).0.map(upglow_color::rounding::to_single);
            cube.color_table(&colorimetry).xyz(&[rgb], &mut color).unwrap();
            for (found, expected) in bytes.as_chunks::<4>().0.iter().zip(color[0]) {
                // Single precision of sums below 2.
                assert!((f32::from_le_bytes(*found) - expected).abs() < 1e-6, "{index}");
            }
        }
    }

    #[test]
    fn a_cube_in_another_space_names_it_first() {
        let contract =
            Contract { space: RgbSpace::named("p3-d65").unwrap(), ..Contract::default() };
        let nodes = vec![upglow::Node::default(); 8];
        let fit = upglow::FitRecord::default();
        let cube = Cube::new(contract, upglow::Model::Reflectance, fit, 2, nodes).unwrap();
        let lights = lights(cube.contract());
        let shown: Vec<_> = lights.iter().map(|light| ShownLight::new(&cube, light)).collect();
        let names = description(&cube, "", &shown)["spaces"].clone();
        let names: Vec<&str> =
            names.as_array().unwrap().iter().filter_map(|space| space["name"].as_str()).collect();
        assert_eq!(names, ["p3-d65", "ACEScg", "Rec.2020", "sRGB"]);
    }
}
