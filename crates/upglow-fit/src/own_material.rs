//! A material whose dyes have yields of their own.

use upglow::{
    Accounting, Cube, CubeError, DyeSet, DyeSetError, Edge, FilmModel, FitRecord, Fluorescence,
    Material, Mixture, Model, ModelError, ModelOnGrid, Node, QuantumYield,
};
use upglow_color::rounding::to_single;
use upglow_color::{Contract, Grid, LinearRgb, MeasuredDye, Metric};

/// A material, or a blend of up to four, with the model that it is of: films of dyes whose quantum yields are
/// fitted. Its numbers are those that a cube stores.
#[derive(Clone, Debug, PartialEq)]
#[must_use]
pub struct OwnMaterial {
    model: Model,
    parts: Vec<(f64, Material)>,
}

/// Dyes in a film, each with its optical density, over a reflectance.
pub(crate) struct FilmPart {
    pub(crate) weight: f64,
    pub(crate) reflectance: Edge,
    pub(crate) dyes: Vec<(MeasuredDye, f64)>,
}

/// Why dyes make no material.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OwnMaterialError {
    /// The dyes make no set.
    #[error(transparent)]
    Dyes(Box<DyeSetError>),
    /// The set makes no model.
    #[error(transparent)]
    Model(#[from] ModelError),
}

impl From<DyeSetError> for OwnMaterialError {
    fn from(error: DyeSetError) -> Self {
        Self::Dyes(error.into())
    }
}

/// The name of the dye set.
const SET_NAME: &str = "fitted";

/// A dye with the yield that was fitted. `number` tells apart the same dye with different yields.
pub(crate) fn fitted_dye(
    dye: &MeasuredDye,
    quantum_yield: f64,
    number: Option<usize>,
) -> MeasuredDye {
    let number = number.map_or(String::new(), |number| format!("_{number}"));
    MeasuredDye {
        name: format!("{}_fitted{number}", dye.name),
        quantum_yield: Some(quantum_yield),
        provenance: format!("yield fitted; {}", dye.provenance),
        ..dye.clone()
    }
}

impl OwnMaterial {
    /// The blend of one to four films, of at most two dyes each.
    pub(crate) fn new(films: Vec<FilmPart>) -> Result<Self, OwnMaterialError> {
        let mut set = Vec::new();
        let mut parts = Vec::new();
        for FilmPart { weight, reflectance, dyes } in films {
            let first = set.len();
            let density = |k: usize| dyes.get(k).map_or(0.0, |(_, density)| *density);
            let fluorescence = Fluorescence::film((first, density(0)), (first + 1, density(1)));
            parts.push((weight, Node::new(reflectance, fluorescence, 0.0)));
            set.extend(dyes.into_iter().map(|(dye, _)| dye));
        }
        let model = if set.is_empty() {
            Model::Reflectance
        } else {
            let set = DyeSet::new(SET_NAME, set)?;
            Model::Film(FilmModel::new(set, Accounting::Photon, QuantumYield::Measured)?)
        };
        let parts = parts.into_iter().map(|(weight, node)| (weight, node.material(&model)));
        Ok(Self { parts: parts.collect(), model })
    }

    /// The model: films of the fitted dyes, whose quantum yields are those of the set.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The materials that take part, with their weights.
    #[must_use]
    pub fn parts(&self) -> &[(f64, Material)] {
        &self.parts
    }

    /// The material, to be asked.
    pub fn mixture(&self) -> Mixture<'_> {
        Mixture::of_parts(&self.model, &self.parts).expect("one to four, by construction")
    }

    /// A cube of 2³ nodes that are all the material of the greatest weight, so that all that reads cubes reads it.
    /// What it records as the distance of each node is that of the material from the node's color.
    ///
    /// # Errors
    ///
    /// [`CubeError`] if a number of the material is out of range.
    pub fn to_cube(&self, contract: &Contract, method: &str) -> Result<Cube, CubeError> {
        let heaviest = self.parts.iter().max_by(|a, b| a.0.total_cmp(&b.0));
        let (_, material) = heaviest.expect("there is at least one");
        self.cube_of([*material; 8], contract, method)
    }

    /// A cube of 2³ nodes with all parts, and the color that it blends them for, for all that asks cubes. The other
    /// colors are blended otherwise: nothing is to be known from them.
    ///
    /// # Errors
    ///
    /// [`CubeError`] if a number of a material is out of range.
    pub fn to_blending_cube(
        &self,
        contract: &Contract,
        method: &str,
    ) -> Result<(Cube, LinearRgb), CubeError> {
        let nothing = (0.0, self.parts[0].1);
        let part = |k: usize| self.parts.get(k).copied().unwrap_or(nothing);
        let [(_, black), (red_weight, red), (yellow_weight, yellow), (white_weight, white)] =
            [0, 1, 2, 3].map(part);
        // Where blue ≤ green ≤ red, these four nodes are blended.
        let nodes = [black, red, black, yellow, black, black, black, white];
        let green = white_weight + yellow_weight;
        // Weights add up to 1 but for rounding.
        let rgb = LinearRgb([(green + red_weight).min(1.0), green.min(1.0), white_weight]);
        Ok((self.cube_of(nodes, contract, method)?, rgb))
    }

    /// A cube of 2³ nodes.
    fn cube_of(
        &self,
        materials: [Material; 8],
        contract: &Contract,
        method: &str,
    ) -> Result<Cube, CubeError> {
        let colorimetry = contract.on(Grid::FIT);
        let sums = ModelOnGrid::new(&self.model, &colorimetry);
        let node = |material: Material| {
            let edge = material.reflectance.to_edge(crate::problem::parabola::MIDDLE_NM);
            Node::new(edge, material.fluorescence, 0.0)
        };
        let fit = FitRecord {
            metric: Metric::De2000.to_string(),
            method: method.into(),
            ..FitRecord::default()
        };
        let (contract, model) = (contract.clone(), self.model.clone());
        let nodes = materials.map(node);
        let cube = Cube::new(contract.clone(), model.clone(), fit.clone(), 2, nodes.to_vec())?;
        let measured = nodes.iter().zip(materials).enumerate().map(|(index, (node, material))| {
            let target = colorimetry.xyz_from_rgb(cube.node_rgb(index));
            let de2000 = Metric::De2000.distance(&colorimetry, target, sums.color(material));
            Node { de2000: to_single(de2000), ..*node }
        });
        Cube::new(contract, model, fit, 2, measured.collect())
    }
}
