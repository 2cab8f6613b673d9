//! A material for an engine without spectra: its 4×4 matrix, and lights as four numbers.

use serde::Serialize;
use upglow::{Mixture, ReducedModel};
use upglow_color::{Contract, Grid, Illuminant, ReducedBasis, RgbSpace};
use upglow_terminal::Failure;

use crate::output::{Side, Table};

/// The matrix of a material, and the lights that it acts on.
#[derive(Debug, Serialize)]
pub(super) struct EngineReport {
    /// The RGB space that the engine keeps light in.
    engine: String,
    /// `[outgoing][incident]`, each R, G, B, U.
    matrix: [[f64; 4]; 4],
    lights: Vec<EngineLight>,
}

/// The four numbers of light.
const NUMBERS: [&str; 4] = ["R", "G", "B", "U"];

#[derive(Debug, Serialize)]
struct EngineLight {
    name: String,
    rgbu: [f64; 4],
}

impl EngineReport {
    pub(super) fn new(
        contract: &Contract,
        mixture: &Mixture<'_>,
        engine: &RgbSpace,
        lights: &[Illuminant],
    ) -> Result<Self, Failure> {
        let refused =
            |error: &dyn std::error::Error| Failure::option("--engine", error.to_string());
        let basis = ReducedBasis::try_new(contract, Grid::FIT).map_err(|error| refused(&error))?;
        let space = basis.engine_space(engine).map_err(|error| refused(&error))?;
        let matrix = mixture.reduced_matrix(&ReducedModel::new(mixture.model(), &basis));
        let others = lights.iter().filter(|light| light.name() != contract.illuminant.name());
        let light = |light: &Illuminant| EngineLight {
            name: light.name().to_owned(),
            rgbu: space.light(basis.light(light)).0,
        };
        Ok(Self {
            engine: engine.name().to_owned(),
            matrix: space.matrix(matrix).0,
            lights: std::iter::once(&contract.illuminant).chain(others).map(light).collect(),
        })
    }

    /// Two tables.
    pub(super) fn text(&self) -> String {
        let row = |name: &str, numbers: &[f64; 4]| {
            let [r, g, b, u] = numbers.map(|v| format!("{v:.4}"));
            [name.to_owned(), r, g, b, u]
        };
        let head = |name| {
            let [r, g, b, u] = NUMBERS.map(|number| (number, Side::Right));
            [(name, Side::Left), r, g, b, u]
        };
        let mut matrix = Table::new(head("leaves"));
        for (name, numbers) in NUMBERS.iter().zip(&self.matrix) {
            matrix.add(row(name, numbers));
        }
        let mut lights = Table::new(head("light"));
        for EngineLight { name, rgbu } in &self.lights {
            lights.add(row(name, rgbu));
        }
        format!(
            "In an engine with linear {} and ultraviolet, of the light that arrives\n{matrix}\n{lights}",
            self.engine
        )
    }
}
