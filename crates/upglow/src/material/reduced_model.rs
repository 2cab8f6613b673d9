//! A model on the four lights of a basis: what makes 4×4 matrices of its materials.

use upglow_color::{ReducedBasis, ReducedMatrix, Reduction, Xyzu};

use crate::material::Material;
use crate::material::mixture::Mixture;
use crate::material::model::Model;
use crate::material::model_on_grid::ModelOnGrid;

/// A model under each of the four lights of a [`ReducedBasis`], from which every material of it has its
/// [`ReducedMatrix`].
///
/// To make matrices of millions of looked-up colors use [`crate::Cube::reduced_table`].
///
/// # Examples
///
/// ```
/// use upglow::{Material, Mixture, Model, ReducedModel, Sigmoid};
/// use upglow_color::{Contract, Grid, Illuminant, ReducedBasis};
///
/// let basis = ReducedBasis::try_new(&Contract::default(), Grid::FIT)?;
/// let model = Model::Reflectance;
/// let gray = Mixture::of(&model, Material::passive(Sigmoid::flat(0.5)));
/// let matrix = gray.reduced_matrix(&ReducedModel::new(&model, &basis));
/// let light = basis.light(&Illuminant::named("A")?);
/// let [_, y, _, u] = (matrix * light).0;
/// assert!((y - 0.5).abs() < 1e-9 && (u - 0.5 * light.0[3]).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct ReducedModel {
    parts: [ModelOnGrid; 4],
    ultraviolet: [ModelOnGrid; 4],
    basis: ReducedBasis,
}

impl ReducedModel {
    /// Samples the model's curves for the sums of `basis`.
    pub fn new(model: &Model, basis: &ReducedBasis) -> Self {
        let on = |sums| ModelOnGrid::new(model, sums);
        Self {
            parts: basis.parts().each_ref().map(on),
            ultraviolet: basis.parts_in_ultraviolet().each_ref().map(on),
            basis: basis.clone(),
        }
    }

    /// The model.
    pub fn model(&self) -> &Model {
        self.parts[0].model()
    }

    /// How the matrices are made, and how strong light is.
    pub fn reduction(&self) -> &Reduction {
        self.basis.reduction()
    }

    /// What a material makes of each of the four lights.
    pub fn answers(&self, material: Material) -> [Xyzu; 4] {
        [0, 1, 2, 3].map(|k| {
            let [x, y, z] = self.parts[k].color(material).0;
            Xyzu([x, y, z, self.basis.u(self.ultraviolet[k].color(material).0[0])])
        })
    }

    /// The matrix of one material.
    pub fn matrix(&self, material: Material) -> ReducedMatrix {
        self.reduction().matrix(self.answers(material))
    }
}

impl Mixture<'_> {
    /// The matrix by which the mixture acts on light of four numbers: the mean of its materials' matrices. `model`
    /// must be of the same model.
    pub fn reduced_matrix(&self, model: &ReducedModel) -> ReducedMatrix {
        let parts = self.parts().map(|(weight, material)| model.matrix(material) * weight);
        parts.fold(ReducedMatrix::default(), |sum, part| sum + part)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Random, models};
    use upglow_color::{Contract, Grid, Illuminant};

    /// What 1 may be passed by for rounding.
    const GAIN: f64 = 1e-9;

    #[test]
    fn the_color_under_the_contract_is_exact_and_no_light_comes_back_stronger() {
        // Rounding, of sums of a hundred numbers and of an inverse.
        const EXACT: f64 = 1e-10;
        // Of 200 random materials; the most that are found are 3, bells that are excited below 340 nm.
        const STRONGER: usize = 4;
        for (name, seeds) in [("D65", 0), ("A", 100), ("FL11", 200)] {
            let illuminant = Illuminant::named(name).unwrap();
            let contract = Contract { illuminant, ..Contract::default() };
            let colorimetry = contract.on(Grid::FIT);
            let basis = ReducedBasis::try_new(&contract, Grid::FIT).unwrap();
            for (seed, model) in (seeds..).zip(models()) {
                let sums = ModelOnGrid::new(&model, &colorimetry);
                let reduced = ReducedModel::new(&model, &basis);
                let mut random = Random::new(seed);
                let mut stronger = 0;
                for _ in 0..200 {
                    let material = random.node(&model).material(&model);
                    let matrix = reduced.matrix(material);
                    let reduction = reduced.reduction();
                    let (found, expected) = (matrix * basis.white(), sums.color(material));
                    // What turns ultraviolet into violet, or one line into another color, can look stronger than
                    // all of the light.
                    let own = reduction.unlimited(reduced.answers(material)) * basis.white();
                    let is_weaker = reduction.strength(own) <= reduction.strength(basis.white());
                    stronger += usize::from(!is_weaker);
                    for k in (0..3).filter(|_| is_weaker) {
                        let error = found.0[k] - expected.0[k];
                        assert!(error.abs() < EXACT, "{name} {material:?} {found:?} {expected:?}");
                    }
                    let gain = reduction.gain(matrix);
                    assert!(gain <= 1.0 + GAIN, "{name} {material:?} {gain}");
                }
                assert!(name != "D65" || stronger <= STRONGER, "{model:?} {stronger}");
            }
        }
    }
}
