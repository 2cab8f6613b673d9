//! What all fits under one contract, with one model, have in common.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};

use upglow::{Edge, Fluorescence, Material, Model, ModelOnGrid};
use upglow_color::{Contract, Grid, Xyz};

use super::starts::StartTable;
use crate::problem::Shape;
use crate::problem::single_sums::SingleSums;
use crate::problem::sums::{CLEAR, Lanes, Sums, lanes_from};

/// The sums, starts and limits of fits, and the count of their evaluations.
#[derive(Debug)]
pub(crate) struct Context {
    pub(crate) model: ModelOnGrid,
    pub(crate) sums: Sums,
    pub(crate) single_sums: SingleSums,
    pub(crate) dye_lanes: Vec<Lanes>,
    /// How often residuals and derivatives were evaluated so far, in all fits.
    pub(crate) evaluations: AtomicU64,
}

/// A slope limit, and materials within it to start from.
#[derive(Debug)]
pub(crate) struct Stage {
    pub(crate) slope_limit_per_nm: f64,
    /// Made when a search first needs it.
    starts: OnceLock<StartTable>,
}

impl Stage {
    pub(crate) fn new(slope_limit_per_nm: f64) -> Self {
        Self { slope_limit_per_nm, starts: OnceLock::new() }
    }
}

impl Context {
    pub(crate) fn new(contract: &Contract, model: &Model) -> Self {
        let model = ModelOnGrid::new(model, &contract.on(Grid::FIT));
        let sums = Sums::new(&model);
        let single_sums = SingleSums::new(&model);
        let dyes = model.model().dyes().map_or(0, |dyes| dyes.curves().len());
        let dye_lanes: Vec<Lanes> =
            (0..dyes).map(|dye| sums.lanes(model.dye_absorption(dye))).collect();
        Self { model, sums, single_sums, dye_lanes, evaluations: AtomicU64::new(0) }
    }

    /// The starts of a stage, which fluoresce if the model does.
    pub(crate) fn starts<'s>(&self, stage: &'s Stage) -> &'s StartTable {
        let Self { model, sums, dye_lanes, .. } = self;
        let limit = stage.slope_limit_per_nm;
        stage.starts.get_or_init(|| StartTable::new(model, sums, dye_lanes, limit))
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
            (Fluorescence::Film { .. }, Model::Film(_)) => {
                let reflectance = reflectance.to_sigmoid();
                return self.model.color(Material { reflectance, fluorescence });
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
        reflected + fluorescence.dose() * emitted
    }
}
