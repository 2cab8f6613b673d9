//! What all fits under one contract, with one model, have in common.

use std::sync::atomic::{AtomicU64, Ordering};

use upglow::{Edge, Fluorescence, Model, ModelOnGrid};
use upglow_color::{Contract, Grid, Xyz};

use super::starts::StartTable;
use crate::problem::Shape;
use crate::problem::sums::{CLEAR, Lanes, Sums, lanes_from};

/// The sums, starts and limits of fits, and the count of their evaluations.
#[derive(Debug)]
pub(crate) struct Context {
    pub(crate) model: ModelOnGrid,
    pub(crate) slope_limit_per_nm: f64,
    pub(crate) sums: Sums,
    pub(crate) starts: StartTable,
    pub(crate) dye_lanes: Vec<Lanes>,
    /// How often residuals and derivatives were evaluated so far, in all fits.
    pub(crate) evaluations: AtomicU64,
}

impl Context {
    pub(crate) fn new(contract: &Contract, model: &Model, slope_limit_per_nm: f64) -> Self {
        let model = ModelOnGrid::new(model, &contract.on(Grid::FIT));
        let sums = Sums::new(&model);
        let dyes = match model.model() {
            Model::Dyes(dyes) => dyes.curves().len(),
            _ => 0,
        };
        let dye_lanes: Vec<Lanes> =
            (0..dyes).map(|dye| sums.lanes(model.dye_absorption(dye))).collect();
        let starts = StartTable::new(&model, &sums, &dye_lanes, slope_limit_per_nm);
        let evaluations = AtomicU64::new(0);
        Self { model, slope_limit_per_nm, sums, starts, dye_lanes, evaluations }
    }

    pub(crate) fn count(&self, evaluations: usize) {
        self.evaluations.fetch_add(evaluations as u64, Ordering::Relaxed);
    }

    /// The color of a material, by the sums of the fit.
    pub(crate) fn color(&self, reflectance: Edge, fluorescence: Fluorescence) -> Xyz {
        let parabola = Shape::Free.numbers(reflectance);
        let (absorbed, emitted) = match (fluorescence, self.model.model()) {
            (Fluorescence::Dyes { first, weight, concentration: c }, Model::Dyes(dyes)) => {
                let [a, b] = [first, dyes.partner(first)].map(|dye| &self.dye_lanes[dye]);
                let absorbed = lanes_from(|i| c * ((1.0 - weight) * a[i] + weight * b[i]));
                (absorbed, self.model.emitted_by_dyes(dyes, first, weight).color.into())
            }
            (
                Fluorescence::Analytic { emission_peak_nm, stokes_shift_nm, concentration: c },
                Model::Analytic(bells),
            ) => {
                let center_nm = emission_peak_nm - stokes_shift_nm;
                let [a, _] = self.sums.sample(|nm| bells.absorption(center_nm, nm));
                let emitted = self.model.emitted_by_bells(bells, emission_peak_nm, stokes_shift_nm);
                (lanes_from(|i| c * a[i]), emitted.color.into())
            }
            _ => (CLEAR, Xyz::default()),
        };
        let reflected = self.sums.reflect(parabola, &absorbed, []).color;
        reflected + fluorescence.concentration() * emitted
    }
}
