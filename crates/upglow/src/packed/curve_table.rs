//! Absorption and emission of all dyes, side by side for each wavelength.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x4, i32x4};
use upglow_color::Spectrum;
use upglow_color::rounding::to_single;

use crate::material::dye_model::{DyeCurves, DyeModel};
use crate::material::model::Model;
use crate::packed::proposal_table::ProposalTable;
use crate::packed::quantile_table::{BINS, FIRST_NM, QuantileTable};
use crate::packed::vector::{smaller_of, transposed, whole};

const LAST_NM: f32 = 830.0;
/// The number before [`BINS`], so that the last wavelength is in the last bin. The error is 3e-5 of
/// a step, 1e-6 at most.
const LAST_PLACE: f32 = f32::next_down(BINS as f32);

/// The curves of a ring of dyes on [`Grid::FINE`] in single precision; empty without dyes.
///
/// One wavelength touches one or two cache lines for each kind of curve, for any dyes.
#[derive(Clone, Debug, Default)]
pub(crate) struct CurveTable {
    pub(crate) absorption: PairedCurves,
    pub(crate) emission: PairedCurves,
    pub(crate) absorbing: QuantileTable,
    pub(crate) emitting: QuantileTable,
    /// What a dye of a film is drawn from.
    pub(crate) proposals: ProposalTable,
    /// `[dye]`, the first again after the last.
    dyes: Vec<DyeNumbers>,
    /// Numbers per wavelength.
    stride: u32,
}

/// Samples and their steps to the next wavelength, `[wavelength][dye][sample, step]`, with the
/// first dye again after the last: a pair of neighbors is four numbers in a row. The last
/// wavelength's are zero, for everything outside the grid.
#[derive(Clone, Debug, Default)]
pub(crate) struct PairedCurves(Vec<f32>);

/// What the fast path needs of one dye besides its curves.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct DyeNumbers {
    pub(crate) quantum_yield: f32,
    pub(crate) mean_emission_nm: f32,
    /// ∫ a dλ, nm.
    pub(crate) absorbed_nm: f32,
    /// ∫ returned dλ at concentration 1 of the dye by itself, nm.
    pub(crate) returned_nm: f32,
    /// ∫ ê dλ.
    pub(crate) emitted: f32,
}

/// Where the curves of a wavelength are in a [`CurveTable`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row {
    pub(crate) below: u32,
    start: u32,
    pub(crate) fraction: f32,
}

/// Where the curves of four wavelengths are in a [`CurveTable`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rows<S: Simd> {
    start: [u32; 4],
    fraction: f32x4<S>,
}

impl CurveTable {
    pub(crate) fn new(model: &Model) -> Self {
        let proposals = match model {
            Model::Film(film) => ProposalTable::new(film),
            _ => ProposalTable::default(),
        };
        let Some(model) = model.dyes() else { return Self::default() };
        let curves = model.curves();
        let ring = curves.len() + 1;
        let dyes = || curves.iter().cycle().take(ring);
        let rows = |of: fn(&DyeCurves) -> &Spectrum| {
            let rows = (0..BINS).flat_map(|i| {
                (0..ring).flat_map(move |dye| {
                    let values = of(&curves[dye % curves.len()]).values();
                    [values[i], values[i + 1] - values[i]].map(to_single)
                })
            });
            PairedCurves(rows.chain(std::iter::repeat_n(0.0, 2 * ring)).collect())
        };
        Self {
            absorption: rows(|dye| &dye.absorption),
            emission: rows(|dye| &dye.emission),
            absorbing: QuantileTable::new(dyes().map(|dye| dye.absorption.values())),
            emitting: QuantileTable::new(dyes().map(|dye| dye.emission.values())),
            proposals,
            dyes: dyes().map(|dye| DyeNumbers::new(model, dye)).collect(),
            stride: u32::try_from(2 * ring).expect("a set has far fewer than 2³¹ dyes"),
        }
    }

    /// Where the curves of a wavelength are.
    #[inline(always)]
    pub(crate) fn row<S: Simd>(&self, simd: S, nm: f32) -> Row {
        let inside = (FIRST_NM..=LAST_NM).contains(&nm);
        let place = if inside { smaller_of(nm - FIRST_NM, LAST_PLACE) } else { BINS as f32 };
        let below = whole(simd, place);
        Row { below, start: below * self.stride, fraction: place - below as f32 }
    }

    /// Where the curves of four wavelengths are.
    #[inline(always)]
    pub(crate) fn rows<S: Simd>(&self, simd: S, nm: f32x4<S>) -> Rows<S> {
        let inside = nm.simd_ge(FIRST_NM) & nm.simd_le(LAST_NM);
        let place = (nm - FIRST_NM).min(LAST_PLACE);
        let place = inside.select(place, f32x4::splat(simd, BINS as f32));
        let below: i32x4<S> = place.to_int();
        let fraction = place - below.to_float::<f32x4<S>>();
        let below: [i32; 4] = below.into();
        let mut start = [0; 4];
        for k in 0..4 {
            start[k] = below[k].cast_unsigned() * self.stride;
        }
        Rows { start, fraction }
    }

    /// The numbers of two dyes.
    #[inline(always)]
    pub(crate) fn pair(&self, [first, second]: [u32; 2]) -> [&DyeNumbers; 2] {
        [&self.dyes[first as usize], &self.dyes[second as usize]]
    }
}

impl Row {
    /// The same row four times.
    #[inline(always)]
    pub(crate) fn four_times<S: Simd>(self, simd: S) -> Rows<S> {
        Rows { start: [self.start; 4], fraction: f32x4::splat(simd, self.fraction) }
    }
}

impl PairedCurves {
    /// Samples and steps of a dye and of its neighbor. Sums of `u32` need no check.
    #[inline(always)]
    fn four(&self, start: u32, dye: u32) -> &[f32] {
        let place = (start + 2 * dye) as usize;
        &self.0[place..place + 4]
    }

    /// The curves of two dyes.
    #[inline(always)]
    pub(crate) fn pair(&self, row: Row, dyes: [u32; 2]) -> [f32; 2] {
        let mut pair = [0.0; 2];
        for k in 0..2 {
            let place = (row.start + 2 * dyes[k]) as usize;
            let numbers = &self.0[place..place + 2];
            pair[k] = numbers[0] + row.fraction * numbers[1];
        }
        pair
    }

    /// The curves of four dyes, each at a wavelength of its own.
    #[inline(always)]
    pub(crate) fn four_of<S: Simd>(&self, simd: S, rows: Rows<S>, dyes: [u32; 4]) -> f32x4<S> {
        let [sample, _] = self.pairs(simd, rows, dyes);
        sample
    }

    /// The curves of four dyes and of their neighbors, each at a wavelength of its own.
    #[inline(always)]
    pub(crate) fn pairs<S: Simd>(&self, simd: S, rows: Rows<S>, dyes: [u32; 4]) -> [f32x4<S>; 2] {
        let mut four = [rows.fraction; 4];
        for k in 0..4 {
            four[k] = f32x4::from_slice(simd, self.four(rows.start[k], dyes[k]));
        }
        let [sample, step, next_sample, next_step] = transposed(four);
        [rows.fraction.mul_add(step, sample), rows.fraction.mul_add(next_step, next_sample)]
    }
}

impl DyeNumbers {
    fn new(model: &DyeModel, dye: &DyeCurves) -> Self {
        Self {
            quantum_yield: to_single(dye.quantum_yield),
            mean_emission_nm: to_single(dye.mean_emission_nm),
            absorbed_nm: to_single(dye.absorbing.total()),
            returned_nm: to_single(dye.returned_nm(model.options().accounting)),
            emitted: to_single(dye.emitting.total()),
        }
    }
}
