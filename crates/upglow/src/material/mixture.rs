//! Weighted mixtures of materials: what a look-up returns, ready to evaluate.

use upglow_color::{Diagonal, DonaldsonMatrix, Grid, Illuminant, MissingUltraviolet, Xyz};

use crate::bispectral::{Bispectral, FARTHEST_NM, Sample};
use crate::material::Material;
use crate::material::lobe::Lobe;
use crate::material::model::Model;
use crate::material::model_on_grid::ModelOnGrid;
use crate::material::sampling::{Shares, Shifted, ratio};

/// A convex mixture of up to four materials of one model.
///
/// A mixture reflects and re-emits the weighted mean of what its materials do, so a mixture of valid
/// materials is valid: it conserves energy, its reflectance is in 0..=1 and no steeper than theirs,
/// and its color is the weighted mean of theirs.
#[must_use]
#[derive(Clone, Copy, Debug)]
pub struct Mixture<'m> {
    model: &'m Model,
    parts: [(f64, Material); 4],
}

impl<'m> Mixture<'m> {
    /// Four materials and their weights, which are 0 or more and add up to 1.
    pub(crate) fn new(model: &'m Model, parts: [(f64, Material); 4]) -> Self {
        debug_assert!((parts.iter().map(|(w, _)| w).sum::<f64>() - 1.0).abs() < 1e-12);
        Self { model, parts }
    }

    /// One material alone.
    pub fn of(model: &'m Model, material: Material) -> Self {
        let nothing = (0.0, Material::default());
        Self { model, parts: [(1.0, material), nothing, nothing, nothing] }
    }

    /// Up to four materials of a model, each with a weight that is 0 or more; they are divided by their sum.
    /// `None` if there are more, or no weight is above 0.
    pub fn of_parts(model: &'m Model, parts: &[(f64, Material)]) -> Option<Self> {
        let sum: f64 = parts.iter().map(|(weight, _)| weight).sum();
        let is_valid =
            parts.iter().all(|(weight, _)| *weight >= 0.0) && sum > 0.0 && sum.is_finite();
        if !is_valid || parts.len() > 4 {
            return None;
        }
        let mut of = Self { model, parts: [(0.0, Material::default()); 4] };
        for (own, (weight, material)) in of.parts.iter_mut().zip(parts) {
            *own = (weight / sum, *material);
        }
        Some(of)
    }

    /// The model of its materials.
    pub fn model(&self) -> &'m Model {
        self.model
    }

    /// The materials that take part, with their weights.
    pub fn parts(&self) -> impl Iterator<Item = (f64, Material)> + '_ {
        self.parts.iter().copied().filter(|(weight, _)| *weight > 0.0)
    }

    /// What is to say about this material under a light: ultraviolet that is not known, where a dye in
    /// it absorbs.
    pub fn missing_ultraviolet(&self, light: &Illuminant) -> Option<MissingUltraviolet> {
        light.missing_ultraviolet().filter(|missing| {
            self.lobes().any(|(_, lobe)| missing.wavelengths_nm().any(|nm| lobe.absorbed(nm) > 0.0))
        })
    }

    /// The re-radiation (Donaldson) matrix over the bands around `grid`'s wavelengths.
    ///
    /// `[outgoing][incident]`: the share of the energy that comes in at the incident wavelength
    /// and leaves within half a step of the outgoing one. Each column adds up to at most 1, and to
    /// [`Bispectral::albedo`] where the grid holds the whole emission.
    pub fn reradiation_matrix(&self, grid: Grid) -> Vec<Vec<f64>> {
        let half = f64::from(grid.step_nm()) / 2.0;
        let mut matrix = vec![vec![0.0; grid.len()]; grid.len()];
        for (w, lobe) in self.lobes() {
            let returned: Vec<f64> =
                grid.wavelengths_nm().map(|nm| w * lobe.returned(nm)).collect();
            for (row, out_nm) in matrix.iter_mut().zip(grid.wavelengths_nm()) {
                let emitted = lobe.emission_between(out_nm - half, out_nm + half);
                row.iter_mut().zip(&returned).for_each(|(moved, back)| *moved += back * emitted);
            }
        }
        for (i, nm) in grid.wavelengths_nm().enumerate() {
            matrix[i][i] += self.reflectance(nm);
        }
        matrix
    }

    /// The mixture as a measured matrix on the axes of `measured`: at each pair of wavelengths what
    /// leaves per nm times the width of the outgoing band, and the reflectance on the diagonal, with what is
    /// re-emitted within the band if `measured` holds both together.
    pub fn matrix_like(&self, measured: &DonaldsonMatrix) -> DonaldsonMatrix {
        let lobes: Vec<(Vec<f64>, Vec<f64>)> = self
            .lobes()
            .map(|(weight, lobe)| {
                let emitted = measured.outgoing_nm().iter().map(|nm| lobe.emission(*nm));
                let per_band =
                    emitted.zip(measured.outgoing_bands_nm()).map(|(e, width)| e * width);
                let returned = measured.incident_nm().iter().map(|nm| weight * lobe.returned(*nm));
                (per_band.collect(), returned.collect())
            })
            .collect();
        let reflected: Vec<f64> =
            measured.incident_nm().iter().map(|nm| self.reflectance(*nm)).collect();
        measured.with_factors(|o, i| {
            let emitted =
                || lobes.iter().map(|(per_band, back)| per_band[o] * back[i]).sum::<f64>();
            match measured.outgoing_nm()[o] == measured.incident_nm()[i] {
                true if measured.diagonal() == Diagonal::Reflected => reflected[i],
                true => reflected[i] + emitted(),
                false => emitted(),
            }
        })
    }

    /// The color of the mixture under the light of `sums`, which must be of the same model.
    ///
    /// # Examples
    ///
    /// ```
    /// use upglow::{Material, Mixture, Model, ModelOnGrid, Sigmoid};
    /// use upglow_color::{Contract, Grid};
    ///
    /// let model = Model::Reflectance;
    /// let gray = Mixture::of(&model, Material::passive(Sigmoid::flat(0.5)));
    /// let color = gray.color(&ModelOnGrid::new(&model, &Contract::default().on(Grid::FIT)));
    /// assert!((color.0[1] - 0.5).abs() < 1e-9);
    /// ```
    pub fn color(&self, sums: &ModelOnGrid) -> Xyz {
        self.parts().map(|(weight, material)| sums.color(material) * weight).sum()
    }

    /// The color, and what of it is light that fluorescence emits.
    pub fn color_and_emission(&self, sums: &ModelOnGrid) -> (Xyz, Xyz) {
        let each = || self.parts().map(|(weight, part)| (weight, sums.color_and_emission(part)));
        let color = each().map(|(weight, (color, _))| color * weight).sum();
        (color, each().map(|(weight, (_, emitted))| emitted * weight).sum())
    }

    fn lobes(&self) -> impl Iterator<Item = (f64, Lobe<'m>)> + '_ {
        self.parts().flat_map(|(weight, material)| {
            material.fluorescence.lobes(self.model).map(move |lobe| (weight, lobe))
        })
    }

    /// The curves that incident wavelengths are drawn from, for light that leaves at `out_nm`, 1/nm.
    fn proposed_per_nm(&self, in_nm: f64, out_nm: f64) -> f64 {
        let [in_nm, out_nm] = [in_nm, out_nm].map(within_range);
        self.lobes().map(|(w, lobe)| w * lobe.proposed(in_nm) * lobe.emission(out_nm)).sum()
    }

    /// What leaves at `out_nm` under an equal-energy light of unit irradiance, as far as the curves
    /// that wavelengths are drawn from tell.
    fn shares_leaving(&self, out_nm: f64) -> Shares<Lobe<'m>> {
        self.shares(out_nm, |lobe, nm| lobe.emission(nm) * lobe.proposed_total_nm())
    }

    /// What leaves of unit light at `in_nm`.
    fn shares_arriving(&self, in_nm: f64) -> Shares<Lobe<'m>> {
        self.shares(in_nm, |lobe, nm| lobe.returned(nm) * lobe.emitted_total())
    }

    fn shares(&self, nm: f64, share: impl Fn(Lobe<'m>, f64) -> f64) -> Shares<Lobe<'m>> {
        let nm = within_range(nm);
        let carried = self.lobes().map(|(weight, lobe)| (weight * share(lobe, nm), lobe));
        Shares::new(self.reflectance(nm), carried)
    }
}

impl Bispectral for Mixture<'_> {
    type Real = f64;

    fn is_fluorescent(&self) -> bool {
        self.parts().any(|(_, material)| material.fluorescence.dose() > 0.0)
    }

    fn reflectance(&self, lambda_nm: f64) -> f64 {
        let nm = within_range(lambda_nm);
        let parts = self.parts().map(|(weight, material)| {
            let absorbed: f64 =
                material.fluorescence.lobes(self.model).map(|l| l.absorbed(nm)).sum();
            weight * (1.0 - absorbed) * material.reflectance.at(nm)
        });
        share(parts.sum())
    }

    fn reflectances(&self, lambda_nm: &[f64], shares: &mut [f64]) {
        let each = shares.iter_mut().zip(lambda_nm);
        if self.is_fluorescent() {
            return each.for_each(|(share, nm)| *share = self.reflectance(*nm));
        }
        each.for_each(|(share, _)| *share = 0.0);
        for (weight, material) in self.parts() {
            for (share, nm) in shares.iter_mut().zip(lambda_nm) {
                *share += weight * material.reflectance.at(within_range(*nm));
            }
        }
        shares.iter_mut().for_each(|found| *found = share(*found));
    }

    fn reradiation_per_nm(&self, in_nm: f64, out_nm: f64) -> f64 {
        let [from_nm, to_nm] = [in_nm, out_nm].map(within_range);
        let moved = |(w, lobe): (f64, Lobe)| w * lobe.returned(from_nm) * lobe.emission(to_nm);
        at(in_nm, at(out_nm, self.lobes().map(moved).sum()))
    }

    fn albedo(&self, in_nm: f64) -> f64 {
        let nm = within_range(in_nm);
        let fluorescent: f64 = self.lobes().map(|(w, lobe)| w * lobe.returned(nm)).sum();
        share(self.reflectance(in_nm) + fluorescent)
    }

    fn sample_incident(&self, out_nm: f64, u: [f64; 2]) -> Option<Sample<f64>> {
        self.shares_leaving(out_nm).sample(out_nm, u, |lobe, u| {
            let in_nm = lobe.sample_incident(u);
            let drawn_per_nm = self.proposed_per_nm(in_nm, out_nm);
            Shifted {
                nm: in_nm,
                carried_per_nm: self.reradiation_per_nm(in_nm, out_nm),
                drawn_per_nm,
            }
        })
    }

    fn incident_pdf_per_nm(&self, in_nm: f64, out_nm: f64) -> f64 {
        let drawn = self.proposed_per_nm(in_nm, out_nm);
        at(in_nm, at(out_nm, ratio(drawn, self.shares_leaving(out_nm).total())))
    }

    fn incident_elastic_probability(&self, out_nm: f64) -> f64 {
        at(out_nm, self.shares_leaving(out_nm).elastic_probability())
    }

    fn sample_outgoing(&self, in_nm: f64, u: [f64; 2]) -> Option<Sample<f64>> {
        let sample = self.shares_arriving(in_nm).sample(in_nm, u, |lobe, u| {
            let out_nm = lobe.sample_emitted(u);
            let carried_per_nm = self.reradiation_per_nm(in_nm, out_nm);
            Shifted { nm: out_nm, carried_per_nm, drawn_per_nm: carried_per_nm }
        })?;
        Some(Sample { throughput: share(sample.throughput), ..sample })
    }

    fn outgoing_pdf_per_nm(&self, in_nm: f64, out_nm: f64) -> f64 {
        let moved = self.reradiation_per_nm(in_nm, out_nm);
        at(in_nm, at(out_nm, ratio(moved, self.shares_arriving(in_nm).total())))
    }

    fn outgoing_elastic_probability(&self, in_nm: f64) -> f64 {
        at(in_nm, self.shares_arriving(in_nm).elastic_probability())
    }
}

/// A wavelength that parabolas do not overflow at, nm; NaN remains.
fn within_range(nm: f64) -> f64 {
    nm.clamp(0.0, FARTHEST_NM.into())
}

/// A sum of shares that add up to at most 1, but for rounding; NaN remains.
fn share(sum: f64) -> f64 {
    sum.clamp(0.0, 1.0)
}

/// The value at a wavelength, nm; NaN if that is NaN.
fn at(nm: f64, value: f64) -> f64 {
    if nm.is_nan() { f64::NAN } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::models;
    use crate::*;
    use proptest::prelude::*;
    use upglow_color::Contract;

    fn material(model: &Model, u: [f64; 6]) -> Material {
        let features = Features {
            shift_nm: 350.0 + 400.0 * u[0],
            width_nm: 5.0 + 200.0 * u[1],
            slope_per_nm: 0.02 * (u[2] - 0.5) + 1e-6,
        };
        let fluorescence = match model {
            Model::Reflectance => Fluorescence::None,
            Model::Dyes(_) => Fluorescence::Dyes {
                first: (0..8).rev().find(|&i| i as f64 <= 8.0 * u[3]).unwrap_or(0),
                weight: u[4],
                concentration: u[5],
            },
            Model::Film(_) => {
                let dye = |u: f64| (0..8).rev().find(|&i| i as f64 <= 8.0 * u).unwrap_or(0);
                Fluorescence::film((dye(u[3]), 6.0 * u[4].powi(3)), (dye(u[0]), 6.0 * u[5]))
            }
            Model::Analytic(_) => Fluorescence::Analytic {
                emission_peak_nm: 400.0 + 310.0 * u[3],
                stokes_shift_nm: 10.0 + 110.0 * u[4],
                concentration: u[5],
            },
        };
        Material { reflectance: features.to_sigmoid().unwrap(), fluorescence }
    }

    fn unit6() -> impl Strategy<Value = [f64; 6]> {
        prop::array::uniform6(0.0..1.0)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(16))]

        #[test]
        fn no_more_energy_leaves_than_arrives(u in unit6(), v in unit6(), t in 0.0..1.0) {
            for model in models() {
                let nothing = (0.0, Material::default());
                let parts = [(t, material(&model, u)), (1.0 - t, material(&model, v)), nothing, nothing];
                let mixture = Mixture::new(&model, parts);
                for nm in Grid::FIT.wavelengths_nm() {
                    let albedo = mixture.albedo(nm);
                    prop_assert!((0.0..=1.0).contains(&albedo), "{nm} nm: {albedo}");
                }
                let matrix = mixture.reradiation_matrix(Grid::FIT);
                for (i, nm) in Grid::FIT.wavelengths_nm().enumerate() {
                    let column: f64 = matrix.iter().map(|row| row[i]).sum();
                    prop_assert!(column <= mixture.albedo(nm) + 1e-12, "{nm} nm: {column}");
                }
            }
        }

        #[test]
        fn many_reflectances_are_those_of_each_wavelength(u in unit6(), v in unit6(), t in 0.0..1.0) {
            let nm: Vec<f64> = Grid::FIT.wavelengths_nm().collect();
            let nothing = (0.0, Material::default());
            for model in models() {
                let passive = Material::passive(material(&model, v).reflectance);
                for first in [material(&model, u), Material::passive(Sigmoid::flat(u[0]))] {
                    let mixture = Mixture::new(&model, [(t, first), (1.0 - t, passive), nothing, nothing]);
                    let each: Vec<f64> = nm.iter().map(|&nm| mixture.reflectance(nm)).collect();
                    let mut together = vec![0.0; nm.len()];
                    mixture.reflectances(&nm, &mut together);
                    prop_assert_eq!(together, each);
                }
            }
        }

        #[test]
        fn the_matrix_times_the_light_is_the_color(u in unit6()) {
            // The matrix integrates the emission over each band, the sums take it at the center. Of 3,000
            // materials of each model none is further off.
            const QUADRATURE: f64 = 2.2e-3;
            let colorimetry = Contract::default().on(Grid::FIT);
            for model in models() {
                let mixture = Mixture::of(&model, material(&model, u));
                let color = mixture.color(&ModelOnGrid::new(&model, &colorimetry));
                let mut sum = [0.0; 3];
                for (row, m) in mixture.reradiation_matrix(Grid::FIT).iter().zip(colorimetry.matching()) {
                    let out: f64 = row.iter().zip(colorimetry.irradiance()).map(|(f, e)| f * e).sum();
                    (0..3).for_each(|k| sum[k] += out * m[k]);
                }
                for k in 0..3 {
                    prop_assert!((sum[k] - color.0[k]).abs() < QUADRATURE, "{sum:?} {color:?}");
                }
            }
        }
    }
}
