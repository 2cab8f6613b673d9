//! Re-radiation at wavelengths shorter than those of the absorbed light.

use upglow::{Fluorescence, Material, Mixing, Mixture, Model, Sigmoid};
use upglow_color::{Colorimetry, Grid};
use upglow_study::konig2020;

/// A pair of neighboring dyes, at the weight where pooled mixing moves most energy backward.
#[derive(Clone, Debug)]
pub(super) struct Backward {
    /// The name of the first dye.
    pub(super) first: String,
    /// The share of the re-radiated energy that leaves at shorter wavelengths than it was absorbed
    /// at, for pooled mixing.
    pub(super) pooled: f64,
    /// The same for separate mixing.
    pub(super) separate: f64,
}

/// Weights tried between two dyes: 0, 0.05 … 1. The share is smooth in the weight.
const WEIGHTS: u32 = 20;

/// All pairs, under the light of the paper.
pub(super) fn backward_shares() -> Vec<Backward> {
    let colorimetry = konig2020::contract().on(Grid::FIT);
    let dyes = konig2020::dyes(Mixing::Pooled);
    let names = dyes.set().dyes().iter().map(|dye| dye.name.clone()).collect::<Vec<_>>();
    let [pooled, separate] = [dyes, konig2020::dyes(Mixing::Separate)].map(Model::Dyes);
    let worst = |(first, name)| {
        let share = |model: &Model, step: u32| {
            let weight = f64::from(step) / f64::from(WEIGHTS);
            let fluorescence = Fluorescence::Dyes { first, weight, concentration: 1.0 };
            let material = Material { reflectance: Sigmoid::flat(0.0), fluorescence };
            backward_share(&Mixture::of(model, material), &colorimetry)
        };
        let shares = (0..=WEIGHTS).map(|step| (step, share(&pooled, step)));
        let (step, greatest) =
            shares.max_by(|a, b| a.1.total_cmp(&b.1)).expect("there are weights");
        Backward { first: name, pooled: greatest, separate: share(&separate, step) }
    };
    names.into_iter().enumerate().map(worst).collect()
}

fn backward_share(material: &Mixture, colorimetry: &Colorimetry) -> f64 {
    let (mut backward, mut all) = (0.0, 0.0);
    for (out, row) in material.reradiation_matrix(colorimetry.grid()).iter().enumerate() {
        for (into, (moved, power)) in row.iter().zip(colorimetry.irradiance()).enumerate() {
            let energy = moved * power;
            all += energy;
            backward += if out < into { energy } else { 0.0 };
        }
    }
    backward / all
}
