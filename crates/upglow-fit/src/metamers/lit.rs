//! Films of free yields under one light.

use std::f64::consts::LN_10;

use upglow::{Model, ModelOnGrid};
use upglow_color::{Contract, Grid, Illuminant, LinearRgb, Matrix3, SeenUnder, Xyz};

use super::prior::{Numbers, SLOPE_MAX_PER_NM, UNKNOWNS, densities};
use crate::problem::parabola::edge_chart;
use crate::problem::single_sums::{SingleSums, in_double};

/// A light with the sums that the colors of metamers need.
#[derive(Clone, Debug)]
pub struct MetamerLight {
    name: String,
    model: ModelOnGrid,
    sums: SingleSums,
    seen: SeenUnder,
}

impl MetamerLight {
    /// `model` is a film of all dyes, whose yields are 1.
    pub(super) fn new(model: &Model, contract: &Contract, light: &Illuminant) -> Self {
        let seen = contract.seen_under(light, Grid::FIT);
        let model = ModelOnGrid::new(model, &seen.colorimetry);
        let sums = SingleSums::new(&model);
        Self { name: light.name().into(), model, sums, seen }
    }

    /// Name of the light.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What the observer sees as white: the perfect diffuser under the light, or under that of the contract if
    /// nobody could adapt to a light that is nearly invisible.
    pub fn white(&self) -> Xyz {
        self.seen.white
    }

    /// The color that looks like this one under the light.
    pub(super) fn xyz_from_rgb(&self, rgb: LinearRgb) -> Xyz {
        self.seen.colorimetry.xyz_from_rgb(rgb)
    }

    pub(super) fn color(&self, dyes: [usize; 2], numbers: &Numbers) -> Xyz {
        let &[edge, level, slope, .., first_yield, second_yield] = numbers;
        let (parabola, _) = edge_chart([edge, level, slope], SLOPE_MAX_PER_NM);
        let ([one, two], passed) = self.sums.film_by_dye(&self.model, dyes, densities(numbers));
        let reflected = Xyz(in_double(self.sums.color_under_film(&parabola, &passed)));
        reflected + first_yield * Xyz::from(one.color) + second_yield * Xyz::from(two.color)
    }

    /// The color, and its derivatives by the numbers.
    pub(super) fn color_by(&self, dyes: [usize; 2], numbers: &Numbers) -> (Xyz, [Xyz; UNKNOWNS]) {
        let &[edge, level, slope, .., first_yield, second_yield] = numbers;
        let densities = densities(numbers);
        let (parabola, by_numbers) = edge_chart([edge, level, slope], SLOPE_MAX_PER_NM);
        let (emitted, passed) = self.sums.film_by_dye(&self.model, dyes, densities);
        let shown = self.sums.reflect_under_film(0.0, &parabola, dyes, &passed);
        let by_parabola = Matrix3::from_columns(shown.by.map(in_double));
        let by_shape = |v: usize| Xyz(by_parabola * [0, 1, 2].map(|m| by_numbers[m][v]));
        let [one, two] = emitted.map(|dye| Xyz::from(dye.color));
        let color = Xyz(in_double(shown.color)) + first_yield * one + second_yield * two;
        let by_density = |d: usize| {
            let [one, two] = emitted.map(|dye| Xyz::from(dye.derivatives[d]));
            let lost = -LN_10 * Xyz(in_double(shown.seen[d]));
            // By the logarithm of the density.
            densities[d] * (lost + first_yield * one + second_yield * two)
        };
        let by = [by_shape(0), by_shape(1), by_shape(2), by_density(0), by_density(1), one, two];
        (color, by)
    }
}
