//! Light that comes out at shorter wavelengths than it went in.

use upglow::{
    DyeModel, DyeOptions, DyeSet, Fluorescence, Material, Mixing, Mixture, Model, Sigmoid,
};
use upglow_color::{Colorimetry, Contract, Grid};

use crate::error::StudyError;

/// A pair of neighbors of the paper's ring at its worst weight.
#[derive(Clone, Debug)]
pub(super) struct Backward {
    /// The name of the first dye.
    pub(super) first: String,
    /// The greatest share, over all weights, of re-radiated energy that comes out at shorter
    /// wavelengths than it went in, pooled.
    pub(super) pooled: f64,
    /// The same share at that weight, each dye for itself.
    pub(super) separate: f64,
}

/// Weights tried between two dyes: 0, 0.05 … 1. The share is smooth in the weight.
const WEIGHTS: u32 = 20;

/// Every pair, under the light of the default contract.
pub(super) fn backward_shares() -> Result<Vec<Backward>, StudyError> {
    let [pooled, separate] = [model(Mixing::Pooled)?, model(Mixing::Separate)?];
    let colorimetry = Contract::default().on(Grid::FIT);
    let set = DyeSet::named("konig8")?;
    let names = set.dyes().iter().map(|dye| dye.name.clone());
    let worst = |(first, name)| {
        let share = |model: &Model, step: u32| {
            let weight = f64::from(step) / f64::from(WEIGHTS);
            let fluorescence = Fluorescence::Dyes { first, weight, concentration: 1.0 };
            let material = Material { reflectance: Sigmoid::flat(0.0), fluorescence };
            backward_share(&Mixture::of(model, material), &colorimetry)
        };
        let shares = (0..=WEIGHTS).map(|step| (step, share(&pooled, step)));
        let (step, greatest) =
            shares.max_by(|a, b| a.1.total_cmp(&b.1)).expect("weights are tried");
        Backward { first: name, pooled: greatest, separate: share(&separate, step) }
    };
    Ok(names.enumerate().map(worst).collect())
}

fn model(mixing: Mixing) -> Result<Model, StudyError> {
    let options = DyeOptions { mixing, ..DyeOptions::default() };
    Ok(Model::Dyes(DyeModel::new(DyeSet::named("konig8")?, options)?))
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
