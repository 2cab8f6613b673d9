//! The material form: the parameters of one material per texel.

use upglow::{Cube, Model, Node};
use upglow_fit::{FitOptionsError, KindCounts, MaterialKind, Polisher};

use super::attributes;
use super::half_reflectance::{ORIGIN_NM, in_half};
use super::maker::{Filled, Maker};
use crate::exr::attribute::Attributes;
use crate::exr::header::Sample;

/// Stores three numbers of the reflectance and, if the model fluoresces, three of the fluorescence.
#[derive(Debug)]
pub(super) struct MaterialMaker<'c> {
    cube: &'c Cube,
    polisher: Polisher<'c>,
    /// Whether materials are adjusted until they match their colors.
    is_polished: bool,
    sample: Sample,
}

/// Steepest point of the reflectance: its wavelength, level and slope; see [`upglow::Edge`].
const REFLECTANCE: [&str; 3] =
    ["reflectance.edge_from_550nm", "reflectance.level", "reflectance.slope_per_nm"];
/// Number of the first dye, share of its neighbor, concentration.
const DYES: [&str; 3] = ["fluorescence.dye", "fluorescence.weight", "fluorescence.concentration"];
/// Numbers of the two dyes of a film, the denser first, and their optical densities.
const FILM: [&str; 4] = [
    "fluorescence.dye",
    "fluorescence.second_dye",
    "fluorescence.density",
    "fluorescence.second_density",
];
/// Peak of the emission, Stokes shift, concentration.
const BELLS: [&str; 3] = [
    "fluorescence.emission_peak_from_550nm",
    "fluorescence.stokes_shift_nm",
    "fluorescence.concentration",
];

/// The channels of a model's materials, in the order of their numbers.
pub(super) fn channel_names(model: &Model) -> impl Iterator<Item = &'static str> {
    let fluorescence: &[&str] = match model {
        Model::Reflectance => &[],
        Model::Dyes(_) => &DYES,
        Model::Film(_) => &FILM,
        Model::Analytic(_) => &BELLS,
    };
    REFLECTANCE.into_iter().chain(fluorescence.iter().copied())
}

/// The name of the form.
pub(super) const MATERIAL: &str = "material";

/// What the channels hold.
const CHANNELS: &str = "one material a texel, as docs/material-exr.md of upglow describes: \
                        reflectance by its steepest point, and the fluorescence of the model in \
                        upglow.header; \
                        neighbors must not be averaged";

impl<'c> MaterialMaker<'c> {
    /// # Errors
    ///
    /// [`FitOptionsError`] if the cube records a slope limit that no fit can keep.
    pub(super) fn new(
        cube: &'c Cube,
        is_polished: bool,
        sample: Sample,
    ) -> Result<Self, FitOptionsError> {
        Ok(Self { cube, polisher: Polisher::new(cube)?, is_polished, sample })
    }
}

impl Maker for MaterialMaker<'_> {
    fn channels(&self) -> Vec<String> {
        channel_names(self.cube.model()).map(str::to_owned).collect()
    }

    fn attributes(&self) -> Attributes {
        let mut attributes = attributes::data(self.cube, MATERIAL, CHANNELS);
        attributes.extend(attributes::curves(self.cube));
        let way = if self.is_polished { "polished" } else { "interpolated" };
        attributes.insert("upglow.way".into(), way.into());
        attributes
    }

    fn fill(&self, rgb: &[[f32; 3]], planes: &mut [&mut [f32]]) -> Filled {
        let mut nodes = vec![Node::default(); rgb.len()];
        let made = if self.is_polished {
            self.polisher.polish(rgb, &mut nodes)
        } else {
            self.polisher.interpolate(rgb, &mut nodes)
        };
        made.expect("as many materials as texels");
        for (texel, node) in nodes.iter().enumerate() {
            for (plane, value) in
                planes.iter_mut().zip(stored(node, self.cube.model(), self.sample))
            {
                plane[texel] = value;
            }
        }
        if !self.is_polished {
            return Filled::default();
        }
        let kinds = nodes.iter().map(|node| MaterialKind::of_node(node, self.cube));
        kinds.collect::<KindCounts>().into()
    }
}

/// A node's numbers in the order of the channels.
fn stored(node: &Node, model: &Model, sample: Sample) -> [f32; MOST_CHANNELS] {
    let [first, second, third] = node.fluorescence;
    let [edge, level, slope_per_nm] = match sample {
        Sample::Half => in_half(node.edge()),
        _ => {
            let [edge_nm, level, slope_per_nm] = node.reflectance;
            [edge_nm - ORIGIN_NM, level, slope_per_nm]
        }
    };
    let dyes = node.dyes.map(f32::from);
    let [a, b, c, d] = match model {
        _ if first + second + third == 0.0 => [0.0; 4],
        Model::Reflectance => [0.0; 4],
        Model::Dyes(_) => [dyes[0], first, second, 0.0],
        Model::Film(_) => [dyes[0], dyes[1], first, second],
        Model::Analytic(_) => [first - ORIGIN_NM, second, third, 0.0],
    };
    [edge, level, slope_per_nm, a, b, c, d]
}

/// Channels of the model that has most.
pub(super) const MOST_CHANNELS: usize = REFLECTANCE.len() + FILM.len();

/// The node of a texel's numbers, which do not include the color difference.
pub(super) fn node_of(values: [f32; MOST_CHANNELS], model: &Model) -> Node {
    let [edge, level, slope_per_nm, a, b, c, d] = values;
    let (dyes, fluorescence) = match model {
        // Where the concentration or the first density is 0, the other numbers have no meaning.
        _ if c == 0.0 => ([0; 2], [0.0; 3]),
        Model::Reflectance => ([0; 2], [0.0; 3]),
        Model::Dyes(_) => ([dye_index(a), 0], [b, c, 0.0]),
        Model::Film(_) => ([a, b].map(dye_index), [c, d, 0.0]),
        Model::Analytic(_) => ([0; 2], [a + ORIGIN_NM, b, c]),
    };
    let reflectance = [edge + ORIGIN_NM, level, slope_per_nm];
    Node { reflectance, dyes, fluorescence, de2000: 0.0 }
}

/// The index of a dye from its channel.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a ring has at most 255 dyes; invalid numbers saturate and are rejected by the model"
)]
fn dye_index(value: f32) -> u8 {
    value as u8
}
