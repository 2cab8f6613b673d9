//! The material of one color in single precision, ready to evaluate.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, dispatch, f32x4, f32x8, i32x4};
use upglow_color::rounding::to_single;

use crate::bispectral::{Bispectral, FARTHEST_NM, Sample};
use crate::material::formula::{Accounting, Film, Mixing, PerLobe};
use crate::material::model::Model;
use crate::packed::curve_table::{DyeNumbers, PairedCurves, Rows};
use crate::packed::inverse_root::{twice_inverse_root, twice_inverse_root8};
use crate::packed::model::{PackedModel, Rule};
use crate::packed::node::{PackedBells, PackedDyes, PackedFilm, PackedNode, PackedReflectance};
use crate::packed::sampling::{ChosenLobe, DrawnLobe, Shares, elastic, ratio, shifted};
use crate::packed::vector::{greater_of, load, sum, sums, transposed, whole, with_baseline};

/// The four materials around a color, mixed by weight: a [`crate::Mixture`] for inner loops.
///
/// Every result is within 1e-5 of the mixture's. Nothing is allocated, and a look-up, an
/// evaluation or a draw takes tens of nanoseconds at most.
#[must_use]
#[derive(Clone, Copy, Debug)]
pub struct PackedMixture<'t> {
    model: &'t PackedModel,
    /// Whether any of the four fluoresces.
    fluorescent: bool,
    /// The dyes of all corners that fluoresce, if they are the same: their curves are then read once.
    common_dyes: Option<[u32; 2]>,
    weights: [f32; 4],
    edge_nm: [f32; 4],
    /// Coefficients of 1, d and d², `[coefficient][corner]`.
    parabola: [[f32; 4]; 3],
    /// [`PackedNode::fluorescence`], `[number][corner]`; read as [`PackedDyes`],
    /// [`PackedFilm`] or [`PackedBells`].
    fluorescence: [[f32; 4]; 4],
}

/// Runs code with the widest instructions of this processor. Functions called inside must be
/// inlined, or they are compiled for the baseline: closures, and so `map` of an array, often are not.
macro_rules! in_vectors {
    ($mixture:ident, $simd:ident => $answer:expr) => {
        dispatch!($mixture.model.simd_level, $simd => $simd.vectorize(
            #[inline(always)]
            || $answer
        ))
    };
}

/// [`with_baseline`] with the rule as a constant, so that each rule is compiled separately. Chosen
/// inside, it costs up to 7 % of an evaluation.
macro_rules! with_rules {
    ($mixture:ident, $simd:ident, $rule:ident => $answer:expr) => {
        with_baseline!($simd => match $mixture.model.rule {
            Rule::Ring(Mixing::Pooled) => {
                let $rule = Rule::Ring(Mixing::Pooled);
                $answer
            }
            Rule::Ring(Mixing::Separate) => {
                let $rule = Rule::Ring(Mixing::Separate);
                $answer
            }
            Rule::Film => {
                let $rule = Rule::Film;
                $answer
            }
        })
    };
}

impl<'t> PackedMixture<'t> {
    #[inline(always)]
    pub(crate) fn new<S: Simd>(
        simd: S,
        model: &'t PackedModel,
        weights: [f32; 4],
        nodes: [&PackedNode; 4],
    ) -> Self {
        // In vectors: a vector load has to wait for preceding stores of single numbers.
        let PackedReflectance { edge_nm, constant, linear, quadratic } =
            transposed(nodes.map(|node| load(simd, &node.reflectance))).into();
        let fluorescence = transposed(nodes.map(|node| load(simd, &node.fluorescence)));
        // The second number of every model is above 0 where a corner fluoresces. With bells the common
        // dyes are meaningless, and never read.
        let [weight, concentration, returned_nm, first] = fluorescence;
        let common = |number| common_number(simd, concentration, number);
        let common_dyes = match model.rule {
            Rule::Ring(_) => common(first).map(|first| [first, first + 1]),
            Rule::Film => common(first).zip(common(returned_nm)).map(Into::into),
        };
        Self {
            model,
            fluorescent: concentration.simd_gt(0.0).any_true(),
            common_dyes,
            weights,
            edge_nm: edge_nm.into(),
            parabola: [constant.into(), linear.into(), quadratic.into()],
            fluorescence: [weight.into(), concentration.into(), returned_nm.into(), first.into()],
        }
    }

    /// The reflectance behind what the lobes absorb.
    #[inline(always)]
    fn reflectance_through<S: Simd>(
        &self,
        simd: S,
        lambda_nm: f32,
        [one, two]: PerLobe<f32x4<S>>,
    ) -> f32 {
        let [weights, edge_nm, constant, linear, quadratic] = self.reflectance_numbers();
        let [weights, edge_nm] = [load(simd, weights), load(simd, edge_nm)];
        let constant = load(simd, constant);
        let [linear, quadratic] = [load(simd, linear), load(simd, quadratic)];
        let d = within_range(f32x4::splat(simd, lambda_nm)) - edge_nm;
        let x: f32x4<S> = d.mul_add(d.mul_add(quadratic, linear), constant);
        let root = twice_inverse_root(simd, x.mul_add(x, f32x4::splat(simd, 1.0)));
        let shown = (0.25 * x).mul_add(root, f32x4::splat(simd, 0.5));
        let passed = f32x4::splat(simd, 1.0) - (one + two);
        sum(weights * passed * shown).clamp(0.0, 1.0)
    }

    /// [`Bispectral::reflectance`] at four wavelengths, nm.
    #[inline]
    pub fn reflectance4(&self, lambda_nm: [f32; 4]) -> [f32; 4] {
        if self.fluorescent {
            self.fluorescent_four(&lambda_nm)
        } else {
            self.passive_four(&lambda_nm)
        }
    }

    /// [`Bispectral::reflectance`] at eight wavelengths, nm.
    #[inline]
    pub fn reflectance8(&self, lambda_nm: [f32; 8]) -> [f32; 8] {
        let [a, b, c, d, e, f, g, h] = lambda_nm;
        // In two halves: one load would have to wait for the two stores.
        let (low, high) = ([a, b, c, d], [e, f, g, h]);
        if self.fluorescent {
            self.fluorescent_eight(&low, &high)
        } else {
            self.passive_eight(&low, &high)
        }
    }

    /// Four corners at two wavelengths to a vector. Passive materials have functions of their own:
    /// those need not save registers.
    fn passive_four(&self, lambda_nm: &[f32; 4]) -> [f32; 4] {
        in_vectors!(self, simd => {
            let [a, b, c, d] = self.shown_by_all(simd, lambda_nm);
            at_four(simd, lambda_nm, sums([a, b, c, d])).into()
        })
    }

    fn fluorescent_four(&self, lambda_nm: &[f32; 4]) -> [f32; 4] {
        in_vectors!(self, simd => {
            let [a, b, c, d] = self.shown_by_all(simd, lambda_nm);
            let passed = self.passed(simd, within_range(f32x4::from_slice(simd, lambda_nm)));
            let [e, f, g, h] = transposed(passed);
            at_four(simd, lambda_nm, sums([a * e, b * f, c * g, d * h])).into()
        })
    }

    /// Eight wavelengths of one corner to a vector.
    fn passive_eight(&self, low_nm: &[f32; 4], high_nm: &[f32; 4]) -> [f32; 8] {
        in_vectors!(self, simd => {
            let nm = within_range(f32x4::from_slice(simd, low_nm))
                .combine(within_range(f32x4::from_slice(simd, high_nm)));
            let mut total = f32x8::splat(simd, 0.0);
            for i in 0..4 {
                total += shown(simd, nm, self.corner(simd, i));
            }
            at_eight(simd, low_nm, high_nm, total).into()
        })
    }

    fn fluorescent_eight(&self, low_nm: &[f32; 4], high_nm: &[f32; 4]) -> [f32; 8] {
        in_vectors!(self, simd => {
            let within_low = within_range(f32x4::from_slice(simd, low_nm));
            let within_high = within_range(f32x4::from_slice(simd, high_nm));
            let (low, high) = (self.passed(simd, within_low), self.passed(simd, within_high));
            let nm = within_low.combine(within_high);
            let mut total = f32x8::splat(simd, 0.0);
            for i in 0..4 {
                total += low[i].combine(high[i]) * shown(simd, nm, self.corner(simd, i));
            }
            at_eight(simd, low_nm, high_nm, total).into()
        })
    }

    /// [`shown`] of the four corners at each of four wavelengths, `[wavelength]`.
    #[inline(always)]
    fn shown_by_all<S: Simd>(&self, simd: S, nm: &[f32; 4]) -> [f32x4<S>; 4] {
        let mut corners = [f32x8::splat(simd, 0.0); 5];
        let numbers = self.reflectance_numbers();
        for k in 0..5 {
            let four = f32x4::from_slice(simd, numbers[k]);
            corners[k] = four.combine(four);
        }
        let mut at = [f32x4::splat(simd, 0.0); 4];
        for k in [0, 2] {
            let low = within_range(f32x4::splat(simd, nm[k]));
            let high = within_range(f32x4::splat(simd, nm[k + 1]));
            (at[k], at[k + 1]) = shown(simd, low.combine(high), corners).split();
        }
        at
    }

    /// The numbers of one corner for [`shown`].
    #[inline(always)]
    fn corner<S: Simd>(&self, simd: S, i: usize) -> [f32x8<S>; 5] {
        let mut corner = [f32x8::splat(simd, 0.0); 5];
        let numbers = self.reflectance_numbers();
        for k in 0..5 {
            corner[k] = f32x8::splat(simd, numbers[k][i]);
        }
        corner
    }

    #[inline(always)]
    fn reflectance_numbers(&self) -> [&[f32; 4]; 5] {
        let [constant, linear, quadratic] = &self.parabola;
        [&self.weights, &self.edge_nm, constant, linear, quadratic]
    }

    /// Share of the light at four wavelengths that each corner's fluorescence lets pass,
    /// `[corner]`.
    #[inline(always)]
    fn passed<S: Simd>(&self, simd: S, nm: f32x4<S>) -> [f32x4<S>; 4] {
        let all = f32x4::splat(simd, 1.0);
        let mut passed = [all; 4];
        match &self.model.model {
            Model::Reflectance => {}
            Model::Dyes(dyes) => {
                let mixing = dyes.options().mixing;
                let PackedDyes { weight, concentration, .. } = self.fluorescence.into();
                let curves = &self.model.curves;
                let rows = curves.rows(simd, nm);
                let mut pair = [all; 2];
                if let Some([dye, _]) = self.common_dyes {
                    pair = curves.absorption.pairs(simd, rows, [dye; 4]);
                }
                let [dyes, _] = self.dyes(simd);
                for i in 0..4 {
                    if self.common_dyes.is_none() {
                        pair = curves.absorption.pairs(simd, rows, [dyes[i]; 4]);
                    }
                    let concentration = f32x4::splat(simd, concentration[i]);
                    let weight = f32x4::splat(simd, weight[i]);
                    passed[i] = all - mixing.absorbed_in_all(pair, concentration, weight);
                }
            }
            Model::Film(_) => self.passed_by_films(simd, nm, &mut passed),
            Model::Analytic(_) => {
                let PackedBells { concentration, absorption_nm, .. } = self.fluorescence.into();
                let bells = self.model.absorption_bells;
                for i in 0..4 {
                    let bell = bells.at(simd, f32x4::splat(simd, absorption_nm[i]), nm);
                    passed[i] = all - bell * concentration[i];
                }
            }
        }
        passed
    }

    /// What the film of each corner that fluoresces lets pass, `[corner]`.
    #[inline(always)]
    fn passed_by_films<S: Simd>(&self, simd: S, nm: f32x4<S>, passed: &mut [f32x4<S>; 4]) {
        let PackedFilm { second_density, first_density, .. } = self.fluorescence.into();
        let curves = &self.model.curves;
        let rows = curves.rows(simd, nm);
        let pair_of = |[first, second]: [u32; 2]| {
            [first, second].map(|dye| curves.absorption.four_of(simd, rows, [dye; 4]))
        };
        let common = self.common_dyes.map(pair_of);
        let [first, second] = self.dyes(simd);
        for i in 0..4 {
            if first_density[i] > 0.0 {
                let pair = common.unwrap_or_else(|| pair_of([first[i], second[i]]));
                let densities = [first_density[i], second_density[i]];
                passed[i] =
                    Film { densities: densities.map(|d| f32x4::splat(simd, d)) }.passed(pair);
            }
        }
    }

    /// The film of each corner.
    #[inline(always)]
    fn films<S: Simd>(&self, simd: S) -> Film<f32x4<S>> {
        let PackedFilm { second_density, first_density, .. } = self.corner_numbers(simd).into();
        Film { densities: [first_density, second_density] }
    }

    /// The curves that incident wavelengths are drawn from, of each corner's lobes.
    #[inline(always)]
    fn proposed<S: Simd>(&self, simd: S, rule: Rule, in_nm: f32) -> PerLobe<f32x4<S>> {
        if rule != Rule::Film {
            return self.returned(simd, rule, in_nm);
        }
        let row = self.model.curves.row(simd, in_nm);
        let ([first, second], [a, b]) = (self.dyes(simd), self.films(simd).densities);
        let table = &self.model.curves.proposals;
        [table.proposed(simd, row, first, a), table.proposed(simd, row, second, b)]
    }

    /// The re-radiation for what the lobes return of one wavelength and emit at another, 1/nm.
    #[inline(always)]
    fn moved<S: Simd>(
        &self,
        simd: S,
        returned: PerLobe<f32x4<S>>,
        emission: PerLobe<f32x4<S>>,
    ) -> f32 {
        let weights = load(simd, &self.weights);
        sum(weights * (returned[0] * emission[0] + returned[1] * emission[1]))
    }

    /// What each corner's lobes absorb of light at `lambda_nm`.
    #[inline(always)]
    fn absorbed<S: Simd>(&self, simd: S, rule: Rule, lambda_nm: f32) -> PerLobe<f32x4<S>> {
        let none = f32x4::splat(simd, 0.0);
        match (&self.model.model, rule) {
            (Model::Dyes(_), Rule::Ring(mixing)) if self.fluorescent => {
                let PackedDyes { weight, concentration, .. } = self.corner_numbers(simd).into();
                let pair = self.pairs(simd, rule, &self.model.curves.absorption, lambda_nm);
                mixing.absorbed(pair, concentration, weight)
            }
            (_, Rule::Film) if self.fluorescent => {
                let pair = self.pairs(simd, rule, &self.model.curves.absorption, lambda_nm);
                self.films(simd).absorbed(pair)
            }
            (Model::Analytic(_), _) if self.fluorescent => {
                let PackedBells { concentration, absorption_nm, .. } =
                    self.corner_numbers(simd).into();
                let nm = f32x4::splat(simd, lambda_nm);
                [concentration * self.model.absorption_bells.at(simd, absorption_nm, nm), none]
            }
            _ => [none; 2],
        }
    }

    /// What each corner's lobes return of light at `in_nm`.
    #[inline(always)]
    fn returned<S: Simd>(&self, simd: S, rule: Rule, in_nm: f32) -> PerLobe<f32x4<S>> {
        self.returned_of(simd, rule, in_nm, self.absorbed(simd, rule, in_nm))
    }

    /// What each corner's lobes return of what they absorbed at `in_nm`.
    #[inline(always)]
    fn returned_of<S: Simd>(
        &self,
        simd: S,
        rule: Rule,
        in_nm: f32,
        [one, two]: PerLobe<f32x4<S>>,
    ) -> PerLobe<f32x4<S>> {
        let (none, nm) = (f32x4::splat(simd, 0.0), within_range(f32x4::splat(simd, in_nm)));
        if !self.fluorescent {
            return [none; 2];
        }
        match &self.model.model {
            Model::Reflectance => [none; 2],
            Model::Dyes(_) | Model::Film(_) => {
                let accounting = self.model.model.accounting().unwrap_or_default();
                let yielded = self.per_lobe(simd, rule, |dye| dye.quantum_yield);
                let means_nm = match accounting {
                    Accounting::Energy => [none; 2],
                    Accounting::Photon => self.per_lobe(simd, rule, |dye| dye.mean_emission_nm),
                };
                // A second lobe of zeros would cost as much as a real one.
                let second = match rule.lobes() {
                    1 => none,
                    _ => accounting.returned(two, yielded[1], nm, means_nm[1]),
                };
                [accounting.returned(one, yielded[0], nm, means_nm[0]), second]
            }
            Model::Analytic(bells) => {
                let PackedBells { emission_nm, .. } = self.corner_numbers(simd).into();
                let yielded = f32x4::splat(simd, to_single(bells.quantum_yield()));
                [bells.accounting().returned(one, yielded, nm, emission_nm), none]
            }
        }
    }

    /// The density of each corner's emission at `out_nm`, 1/nm.
    #[inline(always)]
    fn emission<S: Simd>(&self, simd: S, rule: Rule, out_nm: f32) -> PerLobe<f32x4<S>> {
        let none = f32x4::splat(simd, 0.0);
        match &self.model.model {
            Model::Dyes(_) | Model::Film(_) if self.fluorescent => {
                let pair = self.pairs(simd, rule, &self.model.curves.emission, out_nm);
                self.lobes_of(simd, rule, pair)
            }
            Model::Analytic(_) if self.fluorescent => {
                let PackedBells { emission_nm, .. } = self.corner_numbers(simd).into();
                let nm = f32x4::splat(simd, out_nm);
                [self.model.emission_bells.at(simd, emission_nm, nm), none]
            }
            _ => [none; 2],
        }
    }

    /// What leaves at `out_nm` under an equal-energy light of unit irradiance, where the lobes'
    /// emission is `emission`.
    #[inline(always)]
    fn leaving<S: Simd>(
        &self,
        simd: S,
        rule: Rule,
        out_nm: f32,
        emission: PerLobe<f32x4<S>>,
    ) -> Shares<f32x4<S>> {
        let elastic = self.reflectance_through(simd, out_nm, self.absorbed(simd, rule, out_nm));
        Shares { elastic, lobes: self.leaving_lobes(simd, rule, emission) }
    }

    #[inline(always)]
    fn leaving_lobes<S: Simd>(
        &self,
        simd: S,
        rule: Rule,
        [one, two]: PerLobe<f32x4<S>>,
    ) -> PerLobe<f32x4<S>> {
        let none = f32x4::splat(simd, 0.0);
        if !self.fluorescent {
            return [none; 2];
        }
        let weights = load(simd, &self.weights);
        let PackedDyes { weight, concentration, returned_nm, .. } =
            self.corner_numbers(simd).into();
        match rule {
            Rule::Ring(Mixing::Pooled) => [weights * returned_nm * one, none],
            Rule::Ring(mixing) => {
                let [first, second] = mixing.concentrations(concentration, weight);
                let [a, b] = self.dye_numbers(simd, |dye| dye.returned_nm);
                [weights * first * a * one, weights * second * b * two]
            }
            Rule::Film => {
                let ([first, second], [a, b]) = (self.dyes(simd), self.films(simd).densities);
                let table = &self.model.curves.proposals;
                let totals_nm = [table.totals_nm(simd, first, a), table.totals_nm(simd, second, b)];
                [weights * totals_nm[0] * one, weights * totals_nm[1] * two]
            }
        }
    }

    /// What the lobes return of light at `in_nm`, and what leaves of it.
    #[inline(always)]
    fn arriving<S: Simd>(
        &self,
        simd: S,
        rule: Rule,
        in_nm: f32,
    ) -> (PerLobe<f32x4<S>>, Shares<f32x4<S>>) {
        let absorbed = self.absorbed(simd, rule, in_nm);
        let returned = self.returned_of(simd, rule, in_nm, absorbed);
        let elastic = self.reflectance_through(simd, in_nm, absorbed);
        let weights = load(simd, &self.weights);
        let mut lobes = [weights * returned[0], weights * returned[1]];
        if self.fluorescent && self.model.model.dyes().is_some() {
            let emitted = self.per_lobe(simd, rule, |dye| dye.emitted);
            lobes = [lobes[0] * emitted[0], lobes[1] * emitted[1]];
        }
        (returned, Shares { elastic, lobes })
    }

    #[inline(always)]
    fn corner_numbers<S: Simd>(&self, simd: S) -> [f32x4<S>; 4] {
        let [a, b, c, d] = &self.fluorescence;
        [load(simd, a), load(simd, b), load(simd, c), load(simd, d)]
    }

    /// The numbers of each corner's two dyes, `[first, second][corner]`.
    #[inline(always)]
    fn dyes<S: Simd>(&self, simd: S) -> [[u32; 4]; 2] {
        let [_, _, second, first] = self.corner_numbers(simd);
        let first: i32x4<S> = first.to_int();
        let second = match self.model.rule {
            Rule::Ring(_) => first + 1,
            Rule::Film => second.to_int(),
        };
        let [a, b, c, d]: [i32; 4] = first.into();
        let [e, f, g, h]: [i32; 4] = second.into();
        [[a, b, c, d].map(i32::cast_unsigned), [e, f, g, h].map(i32::cast_unsigned)]
    }

    /// The curves of each corner's two dyes at one wavelength.
    #[inline(always)]
    fn pairs<S: Simd>(
        &self,
        simd: S,
        rule: Rule,
        curves: &PairedCurves,
        lambda_nm: f32,
    ) -> [f32x4<S>; 2] {
        let row = self.model.curves.row(simd, lambda_nm);
        if let Some(dyes) = self.common_dyes {
            let [a, b] = curves.pair(row, dyes);
            return [f32x4::splat(simd, a), f32x4::splat(simd, b)];
        }
        let rows: Rows<S> = row.four_times(simd);
        let [first, second] = self.dyes(simd);
        match rule {
            Rule::Ring(_) => curves.pairs(simd, rows, first),
            Rule::Film => [curves.four_of(simd, rows, first), curves.four_of(simd, rows, second)],
        }
    }

    /// A number of each corner's two dyes.
    #[inline(always)]
    fn dye_numbers<S: Simd>(&self, simd: S, number: impl Fn(&DyeNumbers) -> f32) -> [f32x4<S>; 2] {
        let curves = &self.model.curves;
        if let Some(dyes) = self.common_dyes {
            let [one, two] = curves.pair(dyes);
            return [f32x4::splat(simd, number(one)), f32x4::splat(simd, number(two))];
        }
        let mut numbers = [[0.0; 4]; 2];
        let [first, second] = self.dyes(simd);
        for i in 0..4 {
            let [one, two] = curves.pair([first[i], second[i]]);
            (numbers[0][i], numbers[1][i]) = (number(one), number(two));
        }
        [load(simd, &numbers[0]), load(simd, &numbers[1])]
    }

    /// A lobe that a draw has chosen.
    #[inline(always)]
    fn chosen(&self, lobe: ChosenLobe) -> DrawnLobe<'t> {
        let numbers = self.fluorescence.map(|numbers| numbers[lobe.corner]);
        DrawnLobe { model: self.model, numbers, lobe: lobe.lobe }
    }

    /// A number of each corner's lobes from those of its dyes.
    #[inline(always)]
    fn per_lobe<S: Simd>(
        &self,
        simd: S,
        rule: Rule,
        number: impl Fn(&DyeNumbers) -> f32,
    ) -> PerLobe<f32x4<S>> {
        self.lobes_of(simd, rule, self.dye_numbers(simd, number))
    }

    /// Numbers of the lobes from those of each corner's two dyes.
    #[inline(always)]
    fn lobes_of<S: Simd>(&self, simd: S, rule: Rule, pair: [f32x4<S>; 2]) -> PerLobe<f32x4<S>> {
        match rule {
            Rule::Ring(mixing) => {
                let PackedDyes { weight, .. } = PackedDyes::from(self.fluorescence.each_ref());
                mixing.per_lobe(pair, load(simd, weight))
            }
            Rule::Film => pair,
        }
    }
}

impl Bispectral for PackedMixture<'_> {
    type Real = f32;

    fn is_fluorescent(&self) -> bool {
        let PackedDyes { concentration, .. } = PackedDyes::from(self.fluorescence);
        self.fluorescent && self.weights.iter().zip(concentration).any(|(w, c)| *w > 0.0 && c > 0.0)
    }

    #[inline]
    fn reflectance(&self, lambda_nm: f32) -> f32 {
        if lambda_nm.is_nan() {
            return f32::NAN;
        }
        with_rules!(self, simd, rule => {
            self.reflectance_through(simd, lambda_nm, self.absorbed(simd, rule, lambda_nm))
        })
    }

    fn reflectances(&self, lambda_nm: &[f32], shares: &mut [f32]) {
        for (shares, nm) in shares.chunks_mut(8).zip(lambda_nm.chunks(8)) {
            let mut eight = [nm[0]; 8];
            eight[..nm.len()].copy_from_slice(nm);
            shares
                .iter_mut()
                .zip(self.reflectance8(eight))
                .take(nm.len())
                .for_each(|(share, reflectance)| *share = reflectance);
        }
    }

    #[inline]
    fn reradiation_per_nm(&self, in_nm: f32, out_nm: f32) -> f32 {
        if in_nm.is_nan() || out_nm.is_nan() {
            return f32::NAN;
        }
        if !self.fluorescent {
            return 0.0;
        }
        with_rules!(self, simd, rule => {
            self.moved(simd, self.returned(simd, rule, in_nm), self.emission(simd, rule, out_nm))
        })
    }

    #[inline]
    fn albedo(&self, in_nm: f32) -> f32 {
        if in_nm.is_nan() {
            return f32::NAN;
        }
        with_rules!(self, simd, rule => {
            let absorbed = self.absorbed(simd, rule, in_nm);
            let [one, two] = self.returned_of(simd, rule, in_nm, absorbed);
            let weights = load(simd, &self.weights);
            let reflectance = self.reflectance_through(simd, in_nm, absorbed);
            // One number rounded up can exceed 1.
            (reflectance + sum(weights * (one + two))).min(1.0)
        })
    }

    #[inline]
    fn sample_incident(&self, out_nm: f32, u: [f32; 2]) -> Option<Sample<f32>> {
        if out_nm.is_nan() {
            return None;
        }
        with_rules!(self, simd, rule => {
            let emission = self.emission(simd, rule, out_nm);
            let shares = self.leaving(simd, rule, out_nm, emission);
            let throughput = shares.total();
            Some(match shares.choose(rule.lobes(), throughput, u[0])? {
                None => elastic(out_nm, shares.elastic, throughput),
                Some(lobe) => {
                    let in_nm = self.chosen(lobe).draw_incident(simd, u[1]);
                    let drawn = self.moved(simd, self.proposed(simd, rule, in_nm), emission);
                    let sample = shifted(in_nm, drawn, throughput);
                    if rule != Rule::Film {
                        return Some(sample);
                    }
                    let moved = self.moved(simd, self.returned(simd, rule, in_nm), emission);
                    Sample { throughput: throughput * ratio(moved, drawn), ..sample }
                }
            })
        })
    }

    #[inline]
    fn incident_pdf_per_nm(&self, in_nm: f32, out_nm: f32) -> f32 {
        if in_nm.is_nan() || out_nm.is_nan() {
            return f32::NAN;
        }
        if !self.fluorescent {
            return 0.0;
        }
        with_rules!(self, simd, rule => {
            let emission = self.emission(simd, rule, out_nm);
            let drawn = self.moved(simd, self.proposed(simd, rule, in_nm), emission);
            ratio(drawn, self.leaving(simd, rule, out_nm, emission).total())
        })
    }

    #[inline]
    fn incident_elastic_probability(&self, out_nm: f32) -> f32 {
        if out_nm.is_nan() {
            return f32::NAN;
        }
        with_rules!(self, simd, rule => {
            let shares = self.leaving(simd, rule, out_nm, self.emission(simd, rule, out_nm));
            ratio(shares.elastic, shares.total())
        })
    }

    #[inline]
    fn sample_outgoing(&self, in_nm: f32, u: [f32; 2]) -> Option<Sample<f32>> {
        if in_nm.is_nan() {
            return None;
        }
        with_rules!(self, simd, rule => {
            let (returned, shares) = self.arriving(simd, rule, in_nm);
            let total = shares.total();
            let sample = match shares.choose(rule.lobes(), total, u[0])? {
                None => elastic(in_nm, shares.elastic, total),
                Some(lobe) => {
                    let out_nm = self.chosen(lobe).draw_emitted(simd, u[1]);
                    let moved = self.moved(simd, returned, self.emission(simd, rule, out_nm));
                    shifted(out_nm, moved, total)
                }
            };
            Some(Sample { throughput: total.clamp(0.0, 1.0), ..sample })
        })
    }

    #[inline]
    fn outgoing_pdf_per_nm(&self, in_nm: f32, out_nm: f32) -> f32 {
        if in_nm.is_nan() || out_nm.is_nan() {
            return f32::NAN;
        }
        if !self.fluorescent {
            return 0.0;
        }
        with_rules!(self, simd, rule => {
            let (returned, shares) = self.arriving(simd, rule, in_nm);
            ratio(self.moved(simd, returned, self.emission(simd, rule, out_nm)), shares.total())
        })
    }

    #[inline]
    fn outgoing_elastic_probability(&self, in_nm: f32) -> f32 {
        if in_nm.is_nan() {
            return f32::NAN;
        }
        with_rules!(self, simd, rule => {
            let (_, shares) = self.arriving(simd, rule, in_nm);
            ratio(shares.elastic, shares.total())
        })
    }
}

/// The one number of a dye that the corners that fluoresce have, `None` if they have several.
#[inline(always)]
fn common_number<S: Simd>(simd: S, concentration: f32x4<S>, number: f32x4<S>) -> Option<u32> {
    // Nodes without fluorescence have number 0.
    let [a, b, c, d] = number.into();
    let greatest = greater_of(greater_of(a, b), greater_of(c, d));
    let same = number.simd_eq(f32x4::splat(simd, greatest)) | concentration.simd_eq(0.0);
    same.all_true().then_some(whole(simd, greatest))
}

#[inline(always)]
fn within_range<S: Simd>(nm: f32x4<S>) -> f32x4<S> {
    nm.max(0.0).min(FARTHEST_NM)
}

/// Four shares at wavelengths, nm; NaN where those are NaN.
#[inline(always)]
fn at_four<S: Simd>(simd: S, nm: &[f32; 4], shares: f32x4<S>) -> f32x4<S> {
    let nm = f32x4::from_slice(simd, nm);
    nm.simd_eq(nm).select(shares.max(0.0).min(1.0), f32x4::splat(simd, f32::NAN))
}

/// Eight shares at wavelengths, nm; NaN where those are NaN.
#[inline(always)]
fn at_eight<S: Simd>(simd: S, low_nm: &[f32; 4], high_nm: &[f32; 4], shares: f32x8<S>) -> f32x8<S> {
    let nm = f32x4::from_slice(simd, low_nm).combine(f32x4::from_slice(simd, high_nm));
    nm.simd_eq(nm).select(shares.max(0.0).min(1.0), f32x8::splat(simd, f32::NAN))
}

/// Weight times reflectance where nothing is absorbed, from weight, edge (nm) and the coefficients
/// of 1, d and d².
#[inline(always)]
fn shown<S: Simd>(
    simd: S,
    nm: f32x8<S>,
    [weight, edge_nm, constant, linear, quadratic]: [f32x8<S>; 5],
) -> f32x8<S> {
    let d = nm - edge_nm;
    let x = d.mul_add(d.mul_add(quadratic, linear), constant);
    let root = twice_inverse_root8(simd, x.mul_add(x, f32x8::splat(simd, 1.0)));
    weight * (0.25 * x).mul_add(root, f32x8::splat(simd, 0.5))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Random, models};
    use crate::{
        AnalyticModel, Cube, DyeModel, DyeOptions, DyeSet, Edge, FilmModel, FitRecord,
        Fluorescence, Interpolation, Node, QuantumYield,
    };
    use upglow_color::{Contract, LinearRgb};

    fn cube(model: Model, node: impl FnMut(usize) -> Node) -> Cube {
        let nodes = (0..27).map(node).collect();
        Cube::new(Contract::default(), model, FitRecord::default(), 3, nodes).expect("in range")
    }

    fn rgb(random: &mut Random) -> [f32; 3] {
        [random.unit(), random.unit(), random.unit()].map(to_single)
    }

    /// Every number that a mixture tells of these wavelengths, and of both samplers whether they draw.
    fn answers<M: Bispectral>(mixture: &M, known: M::Real, other: M::Real) -> [f64; 8]
    where
        f64: From<M::Real>,
    {
        let half = other;
        let draws = |drawn: bool| if drawn { 1.0 } else { 0.0 };
        [
            mixture.reflectance(known).into(),
            mixture.albedo(known).into(),
            mixture.reradiation_per_nm(known, other).into(),
            mixture.reradiation_per_nm(other, known).into(),
            mixture.incident_elastic_probability(known).into(),
            mixture.outgoing_elastic_probability(known).into(),
            draws(mixture.sample_incident(known, [half; 2]).is_some()),
            draws(mixture.sample_outgoing(known, [half; 2]).is_some()),
        ]
    }

    #[test]
    fn single_and_double_precision_answer_alike_for_odd_wavelengths() {
        // What is promised of all results.
        const SINGLE: f64 = 1e-5;
        let odd = [
            f32::NAN,
            f32::INFINITY,
            f32::NEG_INFINITY,
            f32::MAX,
            f32::MIN,
            f32::MIN_POSITIVE,
            -1.0,
            -0.0,
            299.5,
            830.5,
            FARTHEST_NM,
            1e5,
        ];
        for (seed, model) in (0..).zip(models()) {
            let mut random = Random::new(seed);
            let cube = cube(model.clone(), |_| random.node(&model));
            let table = cube.lookup_table();
            for nm in odd {
                let color = rgb(&mut random);
                let single = table.lookup(color).unwrap();
                let wide = LinearRgb(color.map(f64::from));
                let double = cube.lookup(wide, Interpolation::Blend).unwrap();
                let found = answers(&single, nm, 0.5);
                let expected = answers(&double, nm.into(), 0.5);
                for (i, (found, expected_one)) in found.into_iter().zip(expected).enumerate() {
                    let same = found == expected_one || found.is_nan() && expected_one.is_nan();
                    // Probabilities, and whether there is a draw, are of what leaves: of nearly nothing
                    // they may differ.
                    let of = if i < 4 { 1.0 } else { expected[0] };
                    let off = (found - expected_one).abs() * of;
                    assert!(same || off < SINGLE, "{nm}, {i}: {found} {expected_one}");
                }
                let shares = found[..6].iter();
                assert!(!nm.is_nan() || shares.clone().all(|share| share.is_nan()), "{found:?}");
                assert!(nm.is_nan() || shares.clone().all(|share| share.is_finite()), "{found:?}");
                let mut many = [[0.0; 8], [1.0; 8]];
                many[0] = single.reflectance8([nm; 8]);
                many[1][..4].copy_from_slice(&single.reflectance4([nm; 4]));
                let off = |found: f32| f64::from(found) - expected[0];
                let alike = |found: f32| match nm.is_nan() {
                    true => found.is_nan(),
                    false => off(found).abs() < SINGLE,
                };
                assert!(
                    many[0].into_iter().chain(many[1][..4].to_vec()).all(alike),
                    "{nm}: {many:?}"
                );
                let (mut wide, mut narrow) = ([0.0], [0.0]);
                double.reflectances(&[nm.into()], &mut wide);
                single.reflectances(&[nm], &mut narrow);
                assert!(wide[0].is_nan() == nm.is_nan() && alike(narrow[0]));
            }
            let far = cube.lookup(LinearRgb([0.5; 3]), Interpolation::Blend).unwrap();
            let end = answers(&far, FARTHEST_NM.into(), 0.5);
            assert_eq!(answers(&far, f64::MAX, 0.5), end);
        }
    }

    #[test]
    fn no_share_exceeds_one_by_a_bit() {
        /// Of each of four models, several functions each time.
        const QUESTIONS: usize = 250_000;
        let set = || DyeSet::named("konig8").expect("built in");
        let fixed = QuantumYield::Fixed(1.0);
        let separate = DyeOptions { mixing: Mixing::Separate, ..DyeOptions::default() };
        let models = [
            Model::Film(FilmModel::new(set(), Accounting::Energy, fixed).expect("in range")),
            Model::Dyes(DyeModel::new(set(), DyeOptions::default()).expect("in range")),
            Model::Dyes(DyeModel::new(set(), separate).expect("in range")),
            Model::Analytic(AnalyticModel::default()),
        ];
        let mut greatest = [0.0_f32; 3];
        for (seed, model) in (0..).zip(models) {
            let mut random = Random::new(seed);
            let bright = Edge { edge_nm: 550.0, level: 1e9, slope_per_nm: 0.0 };
            let node = |random: &mut Random| {
                let node = random.node(&model);
                let fluorescence = node.material(&model).fluorescence;
                // Half of them give all light back, at one wavelength or another.
                if random.below(2) == 0 { Node::new(bright, fluorescence, 0.0) } else { node }
            };
            for _ in 0..QUESTIONS / 250 {
                let table = cube(model.clone(), |_| node(&mut random)).lookup_table();
                for _ in 0..50 {
                    let mixture = table.lookup(rgb(&mut random)).unwrap();
                    for _ in 0..5 {
                        let nm = to_single(random.between(290.0, 840.0));
                        let u = [to_single(random.unit()).min(0.99), 0.5];
                        let drawn = mixture.sample_outgoing(nm, u).map_or(0.0, |s| s.throughput);
                        let shares = [mixture.reflectance(nm), mixture.albedo(nm), drawn];
                        assert!(shares.iter().all(|s| (0.0..=1.0).contains(s)), "{nm}: {shares:?}");
                        for (most, share) in greatest.iter_mut().zip(shares) {
                            *most = most.max(share);
                        }
                        let four = mixture.reflectance4([nm; 4]);
                        assert!(four.iter().all(|s| (0.0..=1.0).contains(s)), "{nm}: {four:?}");
                    }
                }
            }
        }
        // The bound is reached.
        assert_eq!(greatest, [1.0; 3]);
    }

    #[test]
    fn a_dark_mixture_has_no_density() {
        let edge = Edge { edge_nm: 550.0, level: 0.0, slope_per_nm: 0.01 };
        let dark = Node::new(edge, Fluorescence::None, 0.0);
        let table = cube(Model::Reflectance, |_| dark).lookup_table();
        let mixture = table.lookup([0.5; 3]).unwrap();
        assert_eq!(mixture.reradiation_per_nm(400.0, 500.0), 0.0);
        assert!(mixture.reradiation_per_nm(f32::NAN, 500.0).is_nan());
        assert!(mixture.incident_pdf_per_nm(400.0, f32::NAN).is_nan());
    }
}
