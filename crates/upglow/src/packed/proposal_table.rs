//! The curves that incident wavelengths are drawn from in a film, in single precision.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x4};
use upglow_color::Grid;
use upglow_color::rounding::to_single;

use crate::material::film_model::{FilmModel, LEVELS};
use crate::packed::curve_table::Row;
use crate::packed::quantile_table::{BINS, QuantileTable};
use crate::packed::vector::{load, transposed};

/// What each dye returns by itself at each of [`LEVELS`], as densities and to draw from.
#[derive(Clone, Debug, Default)]
pub(crate) struct ProposalTable {
    /// The quantum yield times the samples at all levels, then their steps to the next wavelength,
    /// `[dye][wavelength][sample, step]`; zeros for everything outside the grid.
    samples: Vec<[[f32; 4]; 2]>,
    /// ∫ dλ of each level, nm, `[dye][level]`.
    totals_nm: Vec<[f32; 4]>,
    /// `[dye][level]`
    quantiles: QuantileTable,
}

impl ProposalTable {
    pub(crate) fn new(model: &FilmModel) -> Self {
        let mut table = Self::default();
        let mut curves = Vec::new();
        for (dye, numbers) in model.dyes().curves().iter().enumerate() {
            let levels = model.proposals(dye);
            let of_levels = |number: &dyn Fn(usize) -> f64| {
                let mut four = [0.0; 4];
                (0..4).for_each(|k| four[k] = to_single(numbers.quantum_yield * number(k)));
                four
            };
            for bin in 0..BINS {
                let sample = |bin: usize| move |k: usize| levels[k].densities()[bin];
                let step = |k: usize| sample(bin + 1)(k) - sample(bin)(k);
                table.samples.push([of_levels(&sample(bin)), of_levels(&step)]);
            }
            table.samples.push([[0.0; 4]; 2]);
            table.totals_nm.push(of_levels(&|k| levels[k].total()));
            curves.extend(levels.iter().map(|level| level.densities()));
        }
        table.quantiles = QuantileTable::new(curves.into_iter());
        table
    }

    /// The curve of one dye of each of four corners, whose optical densities are `densities`.
    #[inline(always)]
    pub(crate) fn proposed<S: Simd>(
        &self,
        simd: S,
        row: Row,
        dyes: [u32; 4],
        densities: f32x4<S>,
    ) -> f32x4<S> {
        let fraction = f32x4::splat(simd, row.fraction);
        let mut levels = [fraction; 4];
        for k in 0..4 {
            let [sample, step] =
                &self.samples[dyes[k] as usize * Grid::FINE.len() + row.below as usize];
            levels[k] = fraction.mul_add(load(simd, step), load(simd, sample));
        }
        mixed(level_shares(simd, densities), transposed(levels))
    }

    /// ∫ of [`ProposalTable::proposed`] dλ, nm.
    #[inline(always)]
    pub(crate) fn totals_nm<S: Simd>(
        &self,
        simd: S,
        dyes: [u32; 4],
        densities: f32x4<S>,
    ) -> f32x4<S> {
        let mut levels = [densities; 4];
        for k in 0..4 {
            levels[k] = load(simd, &self.totals_nm[dyes[k] as usize]);
        }
        mixed(level_shares(simd, densities), transposed(levels))
    }

    /// An incident wavelength with the density of one dye's curve, from `u` in 0..1.
    #[inline(always)]
    pub(crate) fn draw<S: Simd>(&self, simd: S, dye: u32, density: f32, u: f32) -> f32 {
        let totals_nm = self.totals_nm[dye as usize];
        let shares = level_shares(simd, f32x4::splat(simd, density));
        let mut areas = totals_nm;
        for k in 0..4 {
            let [share, ..]: [f32; 4] = shares[k].into();
            areas[k] *= share;
        }
        let total = areas[0] + areas[1] + areas[2] + areas[3];
        let target = u * total;
        // At most two neighbors have a share: the first ends where the second starts.
        let (mut level, mut start, mut end, mut area) = (0, 0.0, areas[0], areas[0]);
        for (k, next) in (1..4).zip(&areas[1..]) {
            let is_later = target >= end && *next > 0.0;
            level = if is_later { k } else { level };
            start = if is_later { end } else { start };
            area = if is_later { *next } else { area };
            end = if is_later { end + next } else { end };
        }
        self.quantiles.quantile(simd, 4 * dye + level, (target - start) / area)
    }
}

/// [`crate::material::film_model::level_shares`] of four densities, `[level]`.
#[inline(always)]
fn level_shares<S: Simd>(simd: S, density: f32x4<S>) -> [f32x4<S>; 4] {
    let mut reached = [f32x4::splat(simd, 0.0); 5];
    for k in 0..4 {
        let below = if k == 0 { 0.0 } else { SINGLE_LEVELS[k - 1] };
        let per_step = 1.0 / (SINGLE_LEVELS[k] - below);
        reached[k] = ((density - below) * per_step).max(0.0).min(1.0);
    }
    let mut shares = [reached[4]; 4];
    for k in 0..4 {
        shares[k] = reached[k] - reached[k + 1];
    }
    shares
}

#[expect(clippy::cast_possible_truncation, reason = "they are exact in single precision")]
const SINGLE_LEVELS: [f32; 4] =
    [LEVELS[0] as f32, LEVELS[1] as f32, LEVELS[2] as f32, LEVELS[3] as f32];

#[inline(always)]
fn mixed<S: Simd>(shares: [f32x4<S>; 4], levels: [f32x4<S>; 4]) -> f32x4<S> {
    let sum = shares[0] * levels[0];
    let sum = shares[1].mul_add(levels[1], sum);
    let sum = shares[2].mul_add(levels[2], sum);
    shares[3].mul_add(levels[3], sum)
}
