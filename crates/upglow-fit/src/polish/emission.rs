//! The emission of a pair of dyes as a function of the weight of the second.

use upglow::{Accounting, DyeModel, Mixing, ModelOnGrid};

use crate::polish::descent::Vector;

/// The emission of a pair of dyes at concentration 1, as cubics over equal intervals of the weight.
#[derive(Clone, Debug)]
pub(super) struct Emission {
    parts: u16,
    /// Colors, and their derivatives per interval, at the ends of the intervals.
    knots: Vec<(Vector, Vector)>,
}

/// Number of intervals for pooled dyes with photon accounting, where the emission has a kink at each
/// wavelength that the mean emission passes. Colors err by less than 1e-6; with 16 intervals by 1e-5,
/// which is visible in the dark.
const PHOTON_PARTS: u16 = 256;

impl Emission {
    pub(super) fn new(model: &ModelOnGrid, dyes: &DyeModel, first: usize) -> Self {
        let parts = match (dyes.options().accounting, dyes.options().mixing) {
            (Accounting::Photon, Mixing::Pooled) => PHOTON_PARTS,
            // A product of up to three linear functions, which a cubic reproduces.
            _ => 1,
        };
        let knot = |i: u16| {
            let emitted = model.emitted_by_dyes(dyes, first, f64::from(i) / f64::from(parts));
            (emitted.color, emitted.derivatives[0].map(|s| s / f64::from(parts)))
        };
        Self { parts, knots: (0..=parts).map(knot).collect() }
    }

    /// The color of the emission at a weight in 0..=1, and its derivative with respect to the weight.
    #[inline(always)]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "the weight is in 0..=1 and its fraction is to be dropped"
    )]
    pub(super) fn at(&self, weight: f64) -> (Vector, Vector) {
        let parts = f64::from(self.parts);
        let place = weight * parts;
        let part = (place as u16).min(self.parts - 1);
        let u = place - f64::from(part);
        let (a, b) = (&self.knots[usize::from(part)], &self.knots[usize::from(part) + 1]);
        let (mut color, mut slope) = ([0.0; 3], [0.0; 3]);
        for k in 0..3 {
            let rise = b.0[k] - a.0[k];
            let square = 3.0 * rise - 2.0 * a.1[k] - b.1[k];
            let cube = a.1[k] + b.1[k] - 2.0 * rise;
            color[k] = a.0[k] + u * (a.1[k] + u * (square + u * cube));
            slope[k] = (a.1[k] + u * (2.0 * square + u * 3.0 * cube)) * parts;
        }
        (color, slope)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use upglow::{DyeOptions, DyeSet, Model, QuantumYield};
    use upglow_color::{Contract, Grid};

    #[test]
    fn emissions_equal_those_of_the_model() {
        // Errors of the cubics, and of their slopes near kinks.
        const COLOR: f64 = 1e-6;
        const SLOPE: f64 = 1e-3;
        let colorimetry = Contract::default().on(Grid::FIT);
        for accounting in [Accounting::Energy, Accounting::Photon] {
            for mixing in [Mixing::Pooled, Mixing::Separate] {
                let quantum_yield = QuantumYield::Measured;
                let options =
                    DyeOptions { accounting, mixing, quantum_yield, optical_density: None };
                let dyes = DyeModel::new(DyeSet::named("wide14").unwrap(), options).unwrap();
                let model = ModelOnGrid::new(&Model::Dyes(dyes.clone()), &colorimetry);
                let (mut worst, mut worst_slope): (f64, f64) = (0.0, 0.0);
                for first in 0..dyes.pairs() {
                    let emission = Emission::new(&model, &dyes, first);
                    for i in 0..=100 {
                        let weight = f64::from(i) / 100.0;
                        let (color, slope) = emission.at(weight);
                        let exact = model.emitted_by_dyes(&dyes, first, weight);
                        for k in 0..3 {
                            worst = worst.max((color[k] - exact.color[k]).abs());
                            let off = slope[k] - exact.derivatives[0][k];
                            worst_slope = worst_slope.max(off.abs());
                        }
                    }
                }
                assert!(worst < COLOR, "{accounting} {mixing}: {worst}");
                assert!(worst_slope < SLOPE, "{accounting} {mixing}: {worst_slope}");
            }
        }
    }
}
