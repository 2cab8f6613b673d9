//! Absorption and emission of all dyes, side by side for each wavelength.

use upglow_color::{Grid, Spectrum};

use crate::lookup_table::to_single;
use crate::{DyeModel, Model};

/// The range of [`Grid::FINE`], whose step is 1 nm.
const FIRST_NM: f32 = 300.0;
const LAST_NM: f32 = 830.0;
const BINS: usize = Grid::FINE.len() - 1;

/// The curves of a ring of dyes on [`Grid::FINE`] in single precision; empty where there are none.
///
/// One wavelength touches one or two cache lines for each kind of curve, whatever the dyes.
#[derive(Clone, Debug, Default)]
pub(crate) struct CurveTable {
    /// Samples of a dye and of its neighbor in the ring, and their steps to the next wavelength,
    /// `[wavelength][dye]`: one vector load for each pair of dyes. The last wavelength's row is
    /// zero, for everything outside the grid.
    absorption: Vec<Pair>,
    emission: Vec<Pair>,
    /// `[dye]`, the first again after the last.
    dyes: Vec<DyeNumbers>,
    columns: usize,
}

type Pair = [f32; 4];

/// What the fast path needs of one dye besides its curves.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct DyeNumbers {
    pub(crate) quantum_yield: f32,
    pub(crate) mean_emission_nm: f32,
    /// ∫ returned dλ at concentration 1 of the dye by itself, nm.
    pub(crate) returned_nm: f32,
    /// ∫ ê dλ.
    pub(crate) emitted: f32,
}

/// A place in a [`CurveTable`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row {
    start: usize,
    fraction: f32,
}

impl CurveTable {
    pub(crate) fn new(model: &Model) -> Self {
        let Model::Dyes(model) = model else { return Self::default() };
        let curves = model.curves();
        let columns = curves.len();
        let rows = |of: fn(&crate::DyeCurves) -> &Spectrum| {
            let rows = (0..BINS).flat_map(|i| {
                (0..columns).map(move |dye| {
                    let values = [dye, model.partner(dye)].map(|dye| of(&curves[dye]).values());
                    let [first, second] = values.map(|v| [v[i], v[i + 1] - v[i]]);
                    [first[0], second[0], first[1], second[1]].map(to_single)
                })
            });
            rows.chain(std::iter::repeat_n([0.0; 4], columns)).collect()
        };
        Self {
            absorption: rows(|dye| &dye.absorption),
            emission: rows(|dye| &dye.emission),
            dyes: (0..=columns).map(|dye| DyeNumbers::new(model, &curves[dye % columns])).collect(),
            columns,
        }
    }

    /// Where the curves of a wavelength are.
    #[inline(always)]
    pub(crate) fn row(&self, nm: f32) -> Row {
        let inside = (FIRST_NM..=LAST_NM).contains(&nm);
        let position = if inside { nm - FIRST_NM } else { 0.0 };
        let below = whole(position).min(BINS - 1);
        let bin = if inside { below } else { BINS };
        Row { start: bin * self.columns, fraction: position - below as f32 }
    }

    /// Absorptance of dye number `dye` and of its neighbor at concentration 1.
    #[inline(always)]
    pub(crate) fn absorption(&self, row: Row, dye: usize) -> [f32; 2] {
        row.read(&self.absorption, dye)
    }

    /// Emission of dye number `dye` and of its neighbor, 1/nm.
    #[inline(always)]
    pub(crate) fn emission(&self, row: Row, dye: usize) -> [f32; 2] {
        row.read(&self.emission, dye)
    }

    /// Dye number `dye` and its neighbor.
    #[inline(always)]
    pub(crate) fn pair(&self, dye: usize) -> [&DyeNumbers; 2] {
        [&self.dyes[dye], &self.dyes[dye + 1]]
    }
}

impl Row {
    #[inline(always)]
    fn read(self, curves: &[Pair], dye: usize) -> [f32; 2] {
        let [first, second, rise, second_rise] = curves[self.start + dye];
        [first + self.fraction * rise, second + self.fraction * second_rise]
    }
}

impl DyeNumbers {
    fn new(model: &DyeModel, dye: &crate::DyeCurves) -> Self {
        let accounting = model.options().accounting;
        let absorbed_nm = dye.absorbing.shared_total(accounting, dye.mean_emission_nm);
        Self {
            quantum_yield: to_single(dye.quantum_yield),
            mean_emission_nm: to_single(dye.mean_emission_nm),
            returned_nm: to_single(dye.quantum_yield * absorbed_nm),
            emitted: to_single(dye.emitting.total()),
        }
    }
}

/// The whole part of a position in a table.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the position is at least 0 and its fraction is meant to go"
)]
#[inline(always)]
fn whole(position: f32) -> usize {
    position as i32 as usize
}
